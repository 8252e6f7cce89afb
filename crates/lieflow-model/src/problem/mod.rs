//! Problems, whatever their kind: what a kind states, and a model of it that any method runs on.

mod forms;
mod keys;
mod kind;
mod mapped;
mod model;
mod quantity;
mod second_run;
mod system;

pub use forms::Forms;
pub(crate) use keys::*;
pub use kind::*;
pub use lieflow_runs::run::*;
pub use model::{Model, Problem};
pub(crate) use quantity::*;
pub use second_run::{
    GOLDEN, GRADED_MOST, LAST_DIGITS, SHORT_STEPS, finer, is_elsewhere, near_ends, other_tolerance,
    search_step, stays, stop_after_hardest, time_to_search,
};
pub(crate) use system::*;
