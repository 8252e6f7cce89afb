//! Hard cases by number, adaptive runs that must end, and random bytes for every public entry.

mod adaptive_ends;
#[path = "../../fuzz/src/draw.rs"]
mod draw;
mod fuzz;
mod maps;
mod rigid;
mod scales;
#[path = "../support/mod.rs"]
mod support;
