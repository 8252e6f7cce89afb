//! The operations of a run, by running it: on numbers that count what is done to them, where a problem is
//! made of vectors, and by what matrices say that they have computed ([`lieflow::scalar::tally`]), where it
//! is made of those.

use core::cell::Cell;
use std::rc::Rc;

use lieflow::adaptive::{AdaptiveError, integrate_adaptive};
use lieflow::catalog::MethodSpec;
use lieflow::methods::{AnyMethod, Embedded, Method};
use lieflow::problems::{PointOf, ScalarOf};
use lieflow::scalar::{Counted, Real};
use lieflow::{Error, SaveAt, Step, StepError, TimeGrid};

use crate::model::{Observer, Runnable, Steps};

/// So many steps of a run are counted, attempts that are rejected among them; a longer run is charged
/// their mean for each of its steps.
pub const COUNTED_STEPS: u64 = 256;
/// Steps that take so many operations together are enough of them: large problems need few.
const COUNTED_OPERATIONS: u64 = 2_000_000;
/// But these many at least.
const COUNTED_AT_LEAST: u64 = 8;

/// How a run goes through time.
#[derive(Clone, Copy, Debug)]
pub enum Pace<'a> {
    /// In steps of one size.
    Fixed(&'a TimeGrid),
    /// In steps that are chosen by their error.
    Chosen(&'a Steps),
}

/// What was counted of the steps of a method.
#[derive(Debug, Default)]
struct Tally {
    operations: Cell<u64>,
    steps: Cell<u64>,
}

impl Tally {
    fn count<T>(&self, step: impl FnOnce() -> T) -> T {
        let (done, operations) = Counted::count(step);
        self.operations.update(|n| n + operations.total());
        self.steps.update(|n| n + 1);
        done
    }
    /// Operations of a step; none where nothing was counted.
    fn mean(&self) -> Option<f64> {
        let (steps, operations) = (self.steps.get(), self.operations.get());
        (steps > 0 && operations > 0).then(|| operations as f64 / steps as f64)
    }
}

/// A method whose steps are counted.
struct CountedMethod<P: Runnable> {
    method: AnyMethod<'static, P>,
    tally: Rc<Tally>,
}

impl<P: Runnable> Clone for CountedMethod<P> {
    fn clone(&self) -> Self {
        CountedMethod { method: self.method.clone(), tally: self.tally.clone() }
    }
}

impl<P: Runnable> Method<P> for CountedMethod<P> {
    type Work = <AnyMethod<'static, P> as Method<P>>::Work;

    fn order(&self, problem: &P) -> usize {
        self.method.order(problem)
    }
    fn evaluations(&self, problem: &P) -> Option<u64> {
        self.method.evaluations(problem)
    }
    fn stays_on_manifold(&self) -> bool {
        self.method.stays_on_manifold()
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        self.method.work(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        self.tally.count(|| self.method.step(problem, step, y, work))
    }
}

impl<P: Runnable> Embedded<P> for CountedMethod<P> {
    fn error_order(&self, problem: &P) -> Result<usize, Error> {
        self.method.error_order(problem)
    }
    fn evaluations_with_error(&self, problem: &P) -> Option<u64> {
        self.method.evaluations_with_error(problem)
    }
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &lieflow::tolerance::Tolerance,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        self.tally.count(|| self.method.step_with_error(problem, step, tolerance, from, work, to))
    }
}

/// The mean operations of a step of `problem` from `y`, over the first of the run: what a
/// [`Model::operations`](crate::model::Model::operations) calls. None where nothing is counted, as of the
/// exact motion, or the method fails.
pub fn operations_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    pace: Pace<'_>,
) -> Option<f64> {
    let method = problem.method(spec).ok()?;
    match pace {
        Pace::Fixed(_) if method.order(problem) == usize::MAX => None,
        Pace::Fixed(grid) => operations_fixed(problem, method, y, grid),
        Pace::Chosen(steps) => operations_chosen(problem, &method, &y, steps),
    }
}

fn operations_fixed<P: Runnable>(
    problem: &P,
    method: AnyMethod<'static, P>,
    mut y: PointOf<P>,
    grid: &TimeGrid,
) -> Option<f64> {
    let tally = Tally::default();
    let mut work = method.work(problem, &y).ok()?;
    let lit = ScalarOf::<P>::lit;
    for n in 0..grid.steps().min(COUNTED_STEPS) {
        if n >= COUNTED_AT_LEAST && tally.operations.get() > COUNTED_OPERATIONS {
            break;
        }
        let step = Step { n, t: lit(grid.time(n)), h: lit(grid.h()) };
        tally.count(|| method.step(problem, step, &mut y, &mut work)).ok()?;
    }
    tally.mean()
}

fn operations_chosen<P: Runnable>(
    problem: &P,
    method: &AnyMethod<'static, P>,
    y: &PointOf<P>,
    Steps { t_span, control }: &Steps,
) -> Option<f64> {
    let upto = |steps: u64| {
        let tally = Rc::new(Tally::default());
        // Behind a pointer again: the driver is compiled for one type of method.
        let counted = CountedMethod { method: method.clone(), tally: tally.clone() };
        let counted = AnyMethod::embedded(counted);
        let (mut y, control) = (y.clone(), control.clone().max_steps(steps).ok()?);
        let see: &mut Observer<'_, P> = &mut |_, _| {};
        match integrate_adaptive(problem, &counted, *t_span, &control, &SaveAt::Ends, &mut y, see) {
            Ok(_) | Err(AdaptiveError::TooManySteps { .. }) => tally.mean(),
            Err(_) => None,
        }
    };
    // A first look says how many steps are enough.
    let first = upto(COUNTED_AT_LEAST)?;
    let enough = (COUNTED_OPERATIONS as f64 / first) as u64;
    match enough.min(COUNTED_STEPS) {
        steps if steps > COUNTED_AT_LEAST => upto(steps),
        _ => Some(first),
    }
}
