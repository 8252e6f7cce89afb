//! The operations of a run, by running it: on numbers that count what is done to them, where a problem is
//! made of vectors, and by what matrices say that they have computed ([`lieflow::scalar::tally`]), where it
//! is made of those.

use lieflow::TimeGrid;
use lieflow::adaptive::{AdaptiveError, integrate_adaptive};
use lieflow::catalog::{MethodSpec, OnEmbedded, OnMethod};
use lieflow::methods::{Embedded, Method};
use lieflow::problems::{PointOf, ScalarOf};
use lieflow::scalar::Real;
use lieflow::{SaveAt, Step};

use crate::erased::{Erased, Tally, with_pair, with_plain};
use crate::model::{Catalog, Steps};

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

/// A run to be counted.
struct Run<'a, P: Catalog, How> {
    problem: &'a P,
    y: PointOf<P>,
    how: &'a How,
}

impl<P: Catalog + 'static> OnMethod<P> for Run<'_, P, TimeGrid> {
    type Out = Option<f64>;
    fn call<M: Method<P>>(self, method: M) -> Option<f64> {
        let tally = Tally::default();
        with_plain(&method, Some(&tally), |method| self.fixed(&method, &tally))
    }
}

impl<P: Catalog + 'static> OnEmbedded<P> for Run<'_, P, Steps> {
    type Out = Option<f64>;
    fn call<M: Embedded<P>>(self, method: M) -> Option<f64> {
        let tally = Tally::default();
        with_pair(&method, Some(&tally), |method| self.chosen(&method, &tally))
    }
}

impl<P: Catalog> Run<'_, P, TimeGrid> {
    fn fixed(mut self, method: &Erased<'_, P>, tally: &Tally) -> Option<f64> {
        if method.order(self.problem) == usize::MAX {
            return None;
        }
        let mut work = method.work(self.problem, &self.y).ok()?;
        let lit = ScalarOf::<P>::lit;
        for n in 0..self.how.steps().min(COUNTED_STEPS) {
            if n >= COUNTED_AT_LEAST && tally.operations() > COUNTED_OPERATIONS {
                break;
            }
            let step = Step { n, t: lit(self.how.time(n)), h: lit(self.how.h()) };
            method.step(self.problem, step, &mut self.y, &mut work).ok()?;
        }
        tally.mean()
    }
}

impl<P: Catalog> Run<'_, P, Steps> {
    fn chosen(self, method: &Erased<'_, P>, tally: &Tally) -> Option<f64> {
        let Steps { t_span, control } = self.how;
        let upto = |steps: u64| {
            tally.clear();
            let (mut y, control) = (self.y.clone(), control.max_steps(steps).ok()?);
            let see = |_: f64, _: &PointOf<P>| {};
            let (problem, save) = (self.problem, &SaveAt::Ends);
            match integrate_adaptive(problem, method, *t_span, &control, save, &mut y, see) {
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
}

/// The mean operations of a step of `problem` from `y`, over the first of the run: what a
/// [`Model::operations`](crate::model::Model::operations) calls. None where nothing is counted, as of the
/// exact motion, or the method fails.
pub fn operations_by<P: Catalog + 'static>(
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
