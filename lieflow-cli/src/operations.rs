//! The operations of a run, by running it on numbers that count them.

use core::cell::Cell;

use lieflow::adaptive::{AdaptiveError, integrate_adaptive};
use lieflow::catalog::{MethodSpec, OnEmbedded, OnMethod};
use lieflow::methods::{Embedded, LocalError, Method};
use lieflow::problems::{PointOf, Problem, ScalarOf};
use lieflow::scalar::{Counted, Real};
use lieflow::{Error, SaveAt, Step, StepError, TimeGrid};

use crate::erased::{Erased, ErasedPair};
use crate::model::{Catalog, Steps};

/// So many steps of a run are counted, attempts that are rejected among them; a longer run is charged
/// their mean for each of its steps.
pub const COUNTED_STEPS: u64 = 256;

/// How a run goes through time.
#[derive(Clone, Copy, Debug)]
pub enum Pace<'a> {
    /// In steps of one size.
    Fixed(&'a TimeGrid),
    /// In steps that are chosen by their error.
    Chosen(&'a Steps),
}

/// What was counted.
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
    fn mean(&self) -> Option<f64> {
        let steps = self.steps.get();
        (steps > 0).then(|| self.operations.get() as f64 / steps as f64)
    }
}

/// A method whose steps are counted.
struct Watched<'a, M>(M, &'a Tally);

impl<P: Problem, M: Method<P>> Method<P> for Watched<'_, M> {
    type Work = M::Work;

    fn order(&self, problem: &P) -> usize {
        self.0.order(problem)
    }
    fn stays_on_manifold(&self) -> bool {
        self.0.stays_on_manifold()
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<M::Work, Error> {
        self.0.work(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut M::Work,
    ) -> Result<(), StepError> {
        self.1.count(|| self.0.step(problem, step, y, work))
    }
}

impl<P: Problem, M: Embedded<P>> Embedded<P> for Watched<'_, M> {
    fn error_order(&self, problem: &P) -> Result<usize, Error> {
        self.0.error_order(problem)
    }
    fn evaluations_with_error(&self, problem: &P) -> Option<u64> {
        self.0.evaluations_with_error(problem)
    }
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        work: &mut M::Work,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError> {
        self.1.count(|| self.0.step_with_error(problem, step, from, work, to))
    }
}

/// A run to be counted.
struct Run<'a, P: Problem, How> {
    problem: &'a P,
    y: PointOf<P>,
    how: &'a How,
}

impl<P: Catalog + 'static> OnMethod<P> for Run<'_, P, TimeGrid> {
    type Out = Option<f64>;
    fn call<M: Method<P>>(self, method: M) -> Option<f64> {
        self.fixed(Erased(&method))
    }
}

impl<P: Catalog + 'static> OnEmbedded<P> for Run<'_, P, Steps> {
    type Out = Option<f64>;
    fn call<M: Embedded<P>>(self, method: M) -> Option<f64> {
        self.chosen(ErasedPair(&method))
    }
}

impl<P: Catalog> Run<'_, P, TimeGrid> {
    fn fixed(mut self, method: Erased<'_, P>) -> Option<f64> {
        if method.order(self.problem) == usize::MAX {
            return None;
        }
        let tally = Tally::default();
        let method = Watched(method, &tally);
        let mut work = method.work(self.problem, &self.y).ok()?;
        let lit = ScalarOf::<P>::lit;
        for n in 0..self.how.steps().min(COUNTED_STEPS) {
            let step = Step { n, t: lit(self.how.time(n)), h: lit(self.how.h()) };
            method.step(self.problem, step, &mut self.y, &mut work).ok()?;
        }
        tally.mean()
    }
}

impl<P: Catalog> Run<'_, P, Steps> {
    fn chosen(mut self, method: ErasedPair<'_, P>) -> Option<f64> {
        let (tally, Steps { t_span, control }) = (Tally::default(), self.how);
        let method = Watched(method, &tally);
        let control = control.max_steps(COUNTED_STEPS).ok()?;
        let see = |_: f64, _: &PointOf<P>| {};
        let (problem, y, save) = (self.problem, &mut self.y, &SaveAt::Ends);
        match integrate_adaptive(problem, &method, *t_span, &control, save, y, see) {
            Ok(_) | Err(AdaptiveError::TooManySteps { .. }) => tally.mean(),
            Err(_) => None,
        }
    }
}

/// The mean operations of a step of `problem` from `y`, over the first of the run: what a
/// [`Model::operations`](crate::model::Model::operations) calls. None where the method does nothing
/// with such numbers, as the exact motion, or fails.
pub fn operations_by<P: Catalog<Group: lieflow::groups::LieAlgebra<Scalar = Counted>> + 'static>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    pace: Pace<'_>,
) -> Option<f64> {
    match pace {
        Pace::Fixed(how) => problem.with(spec, Run { problem, y, how }).ok()?,
        Pace::Chosen(how) => problem.with_estimate(spec, Run { problem, y, how }).ok()?,
    }
}
