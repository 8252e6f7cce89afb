//! Long runs: drift of groups, vectors and invariants, and what the catalog promises to preserve.

#[path = "../support/mod.rs"]
mod support;

mod drift;
mod drift_laws;
mod drift_vectors;
mod energy_casimir;
mod lie_poisson;
mod time_stepping;
