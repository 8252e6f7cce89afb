//! Every method of the catalog on every problem, under an allocator that counts: which methods fit, that
//! their steps allocate nothing, that what they promise is preserved.

mod allocations;
#[path = "../support/counting.rs"]
mod counting;
#[path = "../support/mod.rs"]
mod support;
mod symmetry;
mod symplectic;
mod table;
