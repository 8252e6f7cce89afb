//! Step doubling: an error estimate for a method that has none.
//!
//! One step of h against two of h/2, compared in M: ‖y₂ − y₁‖/(2^p − 1) estimates the error of y₂,
//! which is what the step returns. There is no extrapolation: it would leave the manifold.
//!
//! Order: the method's. Preserves: what the method preserves. Cost: three steps of the method, and
//! two of them when no error is asked for. Source: Hairer, Nørsett, Wanner I, II.4.

use super::embedded::between;
use super::{Embedded, LocalError, Method, Metric, Step};
use crate::error::{Error, StepError};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;

/// A method with steps of half the size, and with an error estimate.
#[derive(Clone, Copy, Debug)]
pub struct Doubling<Me>(pub Me);

/// The method's workspace, and the point after one long step.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct DoublingWork<P: Problem, Me: Method<P>> {
    inner: Me::Work,
    once: PointOf<P>,
}

/// y ← two steps of h/2, each by `take`. On an error y may be half way.
fn halves<S: Real, Y>(
    Step { n, t, h }: Step<S>,
    y: &mut Y,
    mut take: impl FnMut(Step<S>, &mut Y) -> Result<(), StepError>,
) -> Result<(), StepError> {
    let half = S::lit(0.5) * h;
    take(Step { n: 2 * n, t, h: half }, y)?;
    take(Step { n: 2 * n + 1, t: t + half, h: half }, y)
}

/// `to` ← two steps of h/2 of a method of this order from `from`, with the error by one step of h, which
/// `once` is for.
pub(super) fn doubled<S: Real, Y: Metric<Scalar = S>>(
    order: usize,
    step: Step<S>,
    from: &Y,
    once: &mut Y,
    to: &mut Y,
    mut take: impl FnMut(Step<S>, &mut Y) -> Result<(), StepError>,
) -> Result<LocalError<S>, StepError> {
    once.assign(from);
    take(step, once)?;
    to.assign(from);
    halves(step, to, take)?;
    let weight = 0.5f64.powi(order.min(60) as i32);
    let error = once.distance(to) * S::lit(weight / (1.0 - weight));
    Ok(between(error, from, to))
}

impl<P: Problem, Me: Method<P>> Method<P> for Doubling<Me>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    type Work = DoublingWork<P, Me>;

    fn order(&self, problem: &P) -> usize {
        self.0.order(problem)
    }
    fn stays_on_manifold(&self) -> bool {
        self.0.stays_on_manifold()
    }
    fn evaluations(&self, problem: &P) -> Option<u64> {
        Some(2 * self.0.evaluations(problem)?)
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok(DoublingWork { inner: self.0.work(problem, like)?, once: like.clone() })
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        DoublingWork { inner, once }: &mut Self::Work,
    ) -> Result<(), StepError> {
        once.assign(y);
        halves(step, once, |step, y| self.0.step(problem, step, y, inner))?;
        core::mem::swap(y, once);
        Ok(())
    }
}

impl<P: Problem, Me: Method<P>> Embedded<P> for Doubling<Me>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    fn error_order(&self, problem: &P) -> Result<usize, Error> {
        Ok(self.0.order(problem))
    }
    fn evaluations_with_error(&self, problem: &P) -> Option<u64> {
        Some(3 * self.0.evaluations(problem)?)
    }
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        DoublingWork { inner, once }: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError> {
        doubled(self.0.order(problem), step, from, once, to, |step, y| {
            self.0.step(problem, step, y, inner)
        })
    }
}
