//! Counts the operations of a step, by taking the first steps of a run.

use super::{Integrator, Solve, Stats, Steps, TimeGrid};
use crate::methods::Embedded;
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Counted;

/// The number of steps of a run that are counted, with rejected attempts. A longer run has their mean for each of its
/// steps.
pub const COUNTED_STEPS: u64 = 256;
/// The number of operations that is enough, because large problems need few steps.
const COUNTED_OPERATIONS: u64 = 2_000_000;
/// The least number of steps that are counted.
const COUNTED_AT_LEAST: u64 = 8;

/// The mean number of operations of a step from y, over the first [`COUNTED_STEPS`] steps of a run.
///
/// An addition, a multiplication, a division, a root, a sine and a cosine is one each. The numbers of the problem are
/// [`Counted`], or its matrices report their operations ([`tally`](crate::scalar::tally()), feature `tally`). Steps of one
/// size have the operations of the method, and not those of the driver between steps. `None` if nothing is counted, if a
/// step fails, and for steps of one size of a method that is exact.
pub fn operations_of_a_step<P: Problem, M: Embedded<P>>(
    problem: &P,
    method: &M,
    y: PointOf<P>,
    steps: &Steps,
) -> Option<f64>
where
    ScalarOf<P>: Into<f64>,
{
    match steps {
        Steps::Equal(_) if method.facts(problem).order == usize::MAX => None,
        Steps::Equal(grid) => of_equal_steps(problem, method, y, grid),
        Steps::ByError { t_span, control } => {
            let solve = Solve::new(problem, method, *t_span).control(control.clone());
            of_a_run(solve.integrator(y).ok()?)
        }
    }
}

/// True if these steps with these operations are enough.
fn enough(steps: u64, operations: u64) -> bool {
    steps >= COUNTED_STEPS || (steps >= COUNTED_AT_LEAST && operations > COUNTED_OPERATIONS)
}

/// The operations of a step. None if nothing was counted.
fn mean(steps: u64, operations: u64) -> Option<f64> {
    (steps > 0 && operations > 0).then(|| operations as f64 / steps as f64)
}

fn of_equal_steps<P: Problem, M: Embedded<P>>(
    problem: &P,
    method: &M,
    mut y: PointOf<P>,
    grid: &TimeGrid,
) -> Option<f64> {
    let mut work = method.work(problem, &y).ok()?;
    let (mut n, mut operations) = (0, 0);
    while n < grid.steps() && !enough(n, operations) {
        let (done, counted) =
            Counted::count(|| method.step(problem, grid.step(n), &mut y, &mut work));
        done.ok()?;
        (n, operations) = (n + 1, operations + counted.total());
    }
    mean(n, operations)
}

/// The operations of the attempts of a run.
fn of_a_run<P: Problem, M: Embedded<P>>(mut run: Integrator<'_, P, M>) -> Option<f64> {
    let attempts = |stats: Stats| stats.accepted + stats.rejected;
    let mut operations = 0;
    while !run.is_done() && !enough(attempts(run.stats()), operations) {
        let (done, counted) = Counted::count(|| run.step().map(drop));
        done.ok()?;
        operations += counted.total();
    }
    mean(attempts(run.stats()), operations)
}
