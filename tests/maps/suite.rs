//! The coordinate maps, their differentials and inverses: references, hard matrices, batches, and the
//! agreement of both layers.

#[path = "../support/mod.rs"]
mod support;

mod cayley;
mod ccsk;
mod cross_check;
mod dexp;
mod embedding;
mod expm;
mod expm_batch;
mod expm_complex;
mod forms;
mod functions;
mod log;
mod references;
mod se3;
mod so3_batch;
mod stretched;
mod structured;
