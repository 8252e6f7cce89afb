//! The unit tests of what the library does not show. They are beside what they test, and its modules are compiled here:
//! a second library for its unit tests would cost the compiler as much again, so it has none (`test = false`).
#![allow(dead_code, unused_imports, unreachable_pub, missing_docs)] // modules are here for their tests

// The modules find here what they use.
use lieflow::scalar::{Real, Select, Trig};
use lieflow::{error, scalar, space};

#[path = "../../src/scalar/double_double.rs"]
mod double_double;
#[path = "../../src/methods/taylor/lanes.rs"]
mod lanes;
#[path = "../../src/dense/linear_algebra.rs"]
mod linear_algebra;
#[path = "../../src/dense/schur.rs"]
mod schur;
#[path = "../../src/methods/taylor/series.rs"]
mod series;
#[path = "../../src/scalar/sin_cos.rs"]
mod sin_cos;
#[path = "../../src/methods/tableau/trees.rs"]
mod trees;
