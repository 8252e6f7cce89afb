//! The order harness: test problems, a reference that owes nothing to the methods, and an estimator
//! that is told the grid before it sees an error.

mod by_name;
mod ensemble;
mod estimate;
mod flow;
mod suite;
mod tree;

pub(crate) use by_name::{
    clocks, every_explicit_method_on, every_linear_method_on, every_method_on, waves,
};
pub(crate) use ensemble::{MEMBERS, Run, measure_over, order_over};
pub(crate) use estimate::{Estimate, estimate, grid, in_units_of_one, slopes};
pub(crate) use flow::{
    Field, Flow, Reference, clock, family, flow, inertia, measure, measure_as, reference,
    reference_after, start, wave,
};
pub(crate) use suite::{Outcome, Problems, Report, specs};
pub(crate) use tree::{order_conditions, row_conditions};
