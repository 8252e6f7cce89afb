//! Counts the operations of a run, by running it.
//!
//! Matrices report their operations ([`lieflow::scalar::tally`]). A problem on vectors runs on numbers that count; its methods
//! are compiled in the library.

use lieflow::catalog::{CountingMethods, MethodSpec};
use lieflow::methods::{AnyMethod, Method};
use lieflow::problems::{PointOf, ScalarOf};
use lieflow::scalar::{Counted, Real};
use lieflow::{Integrator, Solve, Stats, Step, TimeGrid};

use super::run::{Runnable, Steps};

/// The number of steps of a run that are counted, with rejected attempts. A longer run has their mean for each of its
/// steps.
pub const COUNTED_STEPS: u64 = 256;
/// The number of operations that is enough, because large problems need few steps.
const COUNTED_OPERATIONS: u64 = 2_000_000;
/// The least number of steps that are counted.
const COUNTED_AT_LEAST: u64 = 8;

/// The mean number of operations of a step of `problem` from `y`, over the first steps of the run: see
/// [`Model::operations`](super::Model::operations). None if nothing is counted (the exact motion), or if the method fails.
pub(crate) fn operations_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    steps: &Steps,
) -> Option<f64> {
    counted(&problem.method(spec).ok()?, problem, y, steps)
}

/// A problem on numbers that count operations, ready to run from its start.
pub(crate) struct Counting(Box<Operations>);

/// The mean number of operations of a step.
type Operations = dyn FnOnce(&MethodSpec, &Steps) -> Option<f64>;

/// The problem on numbers that count, and y(t₀).
pub(crate) fn counting<P>(problem: P, y: PointOf<P>) -> Option<Counting>
where
    P: Runnable + CountingMethods,
    PointOf<P>: 'static,
{
    Some(Counting(Box::new(move |spec, steps| {
        counted(&problem.counting_method(spec).ok()?, &problem, y, steps)
    })))
}

impl Counting {
    /// The mean number of operations of a step, as of [`operations_by`].
    pub(crate) fn operations(self, spec: &MethodSpec, steps: &Steps) -> Option<f64> {
        (self.0)(spec, steps)
    }
}

fn counted<P: Runnable>(
    method: &AnyMethod<'static, P>,
    problem: &P,
    y: PointOf<P>,
    steps: &Steps,
) -> Option<f64> {
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

/// The operations of the method. Those of the driver between steps are not counted.
fn of_equal_steps<P: Runnable>(
    problem: &P,
    method: &AnyMethod<'static, P>,
    mut y: PointOf<P>,
    grid: &TimeGrid,
) -> Option<f64> {
    let mut work = method.work(problem, &y).ok()?;
    let lit = ScalarOf::<P>::lit;
    let (mut n, mut operations) = (0, 0);
    while n < grid.steps() && !enough(n, operations) {
        let step = Step { n, t: lit(grid.time(n)), h: lit(grid.h()) };
        let (done, counted) = Counted::count(|| method.step(problem, step, &mut y, &mut work));
        done.ok()?;
        (n, operations) = (n + 1, operations + counted.total());
    }
    mean(n, operations)
}

/// The operations of the attempts of a run.
fn of_a_run<P: Runnable>(mut run: Integrator<'_, P, AnyMethod<'static, P>>) -> Option<f64> {
    let attempts = |stats: Stats| stats.accepted + stats.rejected;
    let mut operations = 0;
    while !run.is_done() && !enough(attempts(run.stats()), operations) {
        let (done, counted) = Counted::count(|| run.step().map(drop));
        done.ok()?;
        operations += counted.total();
    }
    mean(attempts(run.stats()), operations)
}
