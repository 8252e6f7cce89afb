//! The driver: output, events, stops, tolerances, and whatever may go wrong in a run.

mod hard_cases;
mod modes;
mod scipy;
#[path = "../support/mod.rs"]
mod support;
