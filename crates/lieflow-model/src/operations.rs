//! The operations of a run, by running it: on numbers that count what is done to them, where a problem is
//! made of vectors, and by what matrices say that they have computed ([`lieflow::scalar::tally`]), where it
//! is made of those.

use lieflow::catalog::MethodSpec;
use lieflow::methods::Method;
use lieflow::problems::PointOf;
use lieflow::scalar::Counted;
use lieflow::{Solve, Stats};

use crate::model::{Runnable, Steps};

/// So many steps of a run are counted, attempts that are rejected among them; a longer run is charged
/// their mean for each of its steps.
pub const COUNTED_STEPS: u64 = 256;
/// Steps that take so many operations together are enough of them: large problems need few.
const COUNTED_OPERATIONS: u64 = 2_000_000;
/// But these many at least.
const COUNTED_AT_LEAST: u64 = 8;

/// The mean operations of a step of `problem` from `y`, over the first of the run: what a
/// [`Model::operations`](crate::model::Model::operations) calls. None where nothing is counted, as of the
/// exact motion, or the method fails.
pub fn operations_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    steps: &Steps,
) -> Option<f64> {
    let method = problem.method(spec).ok()?;
    let solve = Solve::new(problem, &method, steps.t_span());
    let solve = match steps {
        Steps::Equal(_) if method.order(problem) == usize::MAX => return None,
        Steps::Equal(grid) => solve.grid(*grid),
        Steps::ByError { control, .. } => solve.control(control.clone()),
    };
    let mut run = solve.integrator(y).ok()?;
    let attempts = |stats: Stats| stats.accepted + stats.rejected;
    let mut operations = 0;
    while !run.is_done() && attempts(run.stats()) < COUNTED_STEPS {
        if attempts(run.stats()) >= COUNTED_AT_LEAST && operations > COUNTED_OPERATIONS {
            break;
        }
        let (done, counted) = Counted::count(|| run.step().map(drop));
        done.ok()?;
        operations += counted.total();
    }
    let steps = attempts(run.stats());
    (steps > 0 && operations > 0).then(|| operations as f64 / steps as f64)
}
