//! The driver: output, events, stops, tolerances, and whatever may go wrong in a run.

mod clock;
mod controller;
mod events;
mod hard_cases;
mod interpolant;
mod jumps;
mod leaves;
mod modes;
mod orbits;
mod physics;
mod points;
mod restore;
mod roots;
mod scalars;
mod scipy;
mod scipy_events;
mod series;
mod small_parts;
mod step_by_step;
mod streaks;
#[path = "../support/mod.rs"]
mod support;
mod tolerances;
mod weights;
