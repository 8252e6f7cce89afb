//! Problems, whatever their kind: what a kind states, and a model of it that any method runs on.

mod following;
mod forms;
mod keys;
mod kind;
mod mapped;
mod model;
mod operations;
mod pulses;
mod quantity;
mod run;
mod stepper;
mod system;

pub use forms::Forms;
pub(crate) use keys::*;
pub use kind::*;
pub use model::{Model, Problem};
pub use operations::CountOnVectors;
pub(crate) use operations::{Counting, counting};
pub use pulses::{SHORT_STEPS, stop_after_hardest, time_to_search};
pub(crate) use quantity::*;
pub use run::*;
pub(crate) use stepper::{Points, stepper_by};
pub use stepper::{StepByStep, Stepper};
pub(crate) use system::*;
