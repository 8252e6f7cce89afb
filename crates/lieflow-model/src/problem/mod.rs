//! Problems, whatever their kind: what a kind states, and a model of it that any method runs on.

mod forms;
mod keys;
mod kind;
mod mapped;
mod model;
mod operations;
mod quantity;
mod run;
mod stepper;
mod system;

pub use forms::Forms;
pub(crate) use forms::{Asked, Form, Run};
pub(crate) use keys::*;
pub use kind::*;
pub use model::{Model, Problem};
pub use operations::COUNTED_STEPS;
pub(crate) use operations::{Counting, counting};
pub(crate) use quantity::*;
pub use run::*;
pub use stepper::Stepper;
pub(crate) use stepper::{Points, stepper_by};
pub(crate) use system::*;
