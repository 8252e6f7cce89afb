//! The driver: output, events, stops, tolerances, and whatever may go wrong in a run.

mod controller;
mod hard_cases;
mod modes;
mod physics;
mod scipy;
#[path = "../support/mod.rs"]
mod support;
mod tolerances;
