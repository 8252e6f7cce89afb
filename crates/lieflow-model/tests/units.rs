//! The unit tests of what needs no integrator. The library holds every method for every problem; a second
//! one for its unit tests would cost the compiler as much again, so it has none (`test = false`), and its
//! modules with tests are compiled here.
#![allow(dead_code, unused_imports, unused_macros, unreachable_pub, missing_docs)] // modules are here for their tests

#[path = "../src/formula/mod.rs"]
mod formula;
#[path = "../src/reader/mod.rs"]
mod reader;
