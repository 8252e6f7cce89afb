//! Suites that walk the catalog's lists over the rigid body in all its forms and over Lie–Poisson systems:
//! orders, promises, what is kept, what a step allocates. They are one program, for each of its own would be
//! the same methods on the same problems once more to compile.

#[path = "support/counting.rs"]
mod counting;
mod support;
mod systems;

#[path = "special/lie_poisson.rs"]
mod lie_poisson;
#[path = "special/no_alloc.rs"]
mod no_alloc;
#[path = "special/orders.rs"]
mod orders;
#[path = "special/promises.rs"]
mod promises;
