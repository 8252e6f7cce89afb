//! Problems, whatever their kind: what a kind states, and a model of it that any method runs on.

mod forms;
mod keys;
mod kind;
mod mapped;
mod model;
mod pulses;
mod quantity;
mod system;

pub use forms::Forms;
pub(crate) use keys::*;
pub use kind::*;
pub use lieflow_runs::run::*;
pub use model::{Model, Problem};
pub use pulses::{SHORT_STEPS, stop_after_hardest, time_to_search};
pub(crate) use quantity::*;
pub(crate) use system::*;
