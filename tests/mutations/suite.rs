//! The checks fail on what is broken on purpose: each fault must be found, for the reason it should.

#[path = "../support/mod.rs"]
mod support;

mod actions;
mod families;
mod faults;
mod groups;
mod maps;
mod methods;
mod products;
mod runs;
