//! Counts the operations of a run, by running it.
//!
//! Matrices report their operations ([`lieflow::scalar::tally`]). A problem on vectors runs on numbers that count, and its
//! methods are compiled for these elsewhere: the caller brings them.

use std::any::Any;

use lieflow::catalog::MethodSpec;
use lieflow::problems::{PointOf, Problem};
use lieflow::solve::{Steps, operations_of_a_step};

use super::Runnable;

/// A problem on numbers that count operations and its y(t₀), as a pair.
pub type Counting = Box<dyn Any>;

/// Counts the mean number of operations of a step on a problem on vectors: `lieflow_counting::operations`.
pub type CountOnVectors = fn(Box<dyn Any>, &MethodSpec, &Steps) -> Option<f64>;

/// A problem on numbers that count, and y(t₀).
pub fn counting<P: Problem + 'static>(problem: P, y: PointOf<P>) -> Option<Counting>
where
    PointOf<P>: 'static,
{
    Some(Box::new((problem, y)))
}

/// The operations of a step of a problem on matrices.
pub(super) fn operations_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    steps: &Steps,
) -> Option<f64> {
    operations_of_a_step(problem, &problem.method(spec).ok()?, y, steps)
}
