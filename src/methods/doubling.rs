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

impl<Me> Doubling<Me> {
    /// y ← two steps of h/2. On an error y may be half way.
    fn halves<P: Problem>(
        &self,
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        inner: &mut Me::Work,
    ) -> Result<(), StepError>
    where
        Me: Method<P>,
    {
        let half = ScalarOf::<P>::lit(0.5) * h;
        let first = Step { n: 2 * n, t, h: half };
        self.0.step(problem, first, y, inner)?;
        self.0.step(problem, Step { n: 2 * n + 1, t: t + half, h: half }, y, inner)
    }
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
        self.halves(problem, step, once, inner)?;
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
        once.assign(from);
        self.0.step(problem, step, once, inner)?;
        to.assign(from);
        self.halves(problem, step, to, inner)?;
        let weight = 0.5f64.powi(self.0.order(problem).min(60) as i32);
        let error = once.distance(to) * ScalarOf::<P>::lit(weight / (1.0 - weight));
        Ok(between(error, from, to))
    }
}
