//! Step doubling: an error estimate for a method that has none.
//!
//! y₁ is the result of one step of size h, y₂ that of two steps of size h/2. ‖y₂ − y₁‖/(2^p − 1), taken in M, estimates
//! the error of y₂, and the step returns y₂. There is no extrapolation, because it would leave the manifold.
//!
//! Order: that of the method. Preserves: the same as the method. Cost: three steps of the method, or two without an error
//! estimate. Source: Hairer, Nørsett, Wanner I, II.4.

use super::embedded::ratio_between;
use super::{Embedded, Facts, Method, Metric, Step};
use crate::error::{Error, StepError};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::tolerance::Tolerance;

/// A method that takes each step in two halves, with an error estimate.
#[derive(Clone, Copy, Debug)]
pub struct Doubling<Me>(pub Me);

/// The method's workspace, and two points.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct DoublingWork<P: Problem, Me: Method<P>> {
    inner: Me::Work,
    order: usize,
    /// The point after one long step.
    once: PointOf<P>,
    /// The point after the first half.
    half: PointOf<P>,
}

/// The two halves of a step.
fn halves<S: Real>(Step { n, t, h }: Step<S>) -> [Step<S>; 2] {
    let half = S::lit(0.5) * h;
    [Step { n: 2 * n, t, h: half }, Step { n: 2 * n + 1, t: t + half, h: half }]
}

/// y ← two steps of h/2, each by `take`, and `half` ← the point between them. If the second step fails, y is half way.
fn take_halves<S: Real, Y: Metric<Scalar = S>>(
    step: Step<S>,
    y: &mut Y,
    half: &mut Y,
    mut take: impl FnMut(Step<S>, &mut Y) -> Result<(), StepError>,
) -> Result<(), StepError> {
    let [first, second] = halves(step);
    take(first, y)?;
    half.assign(y);
    take(second, y)
}

/// `at` ← the point at t + θh of a step in two halves, by a shorter step from the start of its half.
pub(super) fn within_halves<S: Real, Y: Metric<Scalar = S>>(
    step: Step<S>,
    theta: f64,
    [from, half]: [&Y; 2],
    at: &mut Y,
    mut take: impl FnMut(Step<S>, &mut Y) -> Result<(), StepError>,
) -> Result<(), StepError> {
    let [first, second] = halves(step);
    let (start, part, theta) =
        if theta < 0.5 { (from, first, 2.0 * theta) } else { (half, second, 2.0 * theta - 1.0) };
    at.assign(start);
    if theta > 0.0 { take(part.part(theta), at) } else { Ok(()) }
}

/// `to` ← two steps of h/2 of a method of this order from `from`. `once` is the storage of the one step of h that
/// estimates the error. `half` ← the point between the two.
pub(super) fn doubled<S: Real, Y: Metric<Scalar = S>>(
    order: usize,
    step: Step<S>,
    tolerance: &Tolerance,
    from: &Y,
    [once, half]: [&mut Y; 2],
    to: &mut Y,
    mut take: impl FnMut(Step<S>, &mut Y) -> Result<(), StepError>,
) -> Result<S, StepError> {
    once.assign(from);
    take(step, once)?;
    to.assign(from);
    take_halves(step, to, half, take)?;
    let weight = 0.5f64.powi(order.min(60) as i32);
    Ok(ratio_between(tolerance, once, weight / (1.0 - weight), from, to))
}

impl<P: Problem, Me: Method<P>> Method<P> for Doubling<Me>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    type Work = DoublingWork<P, Me>;

    fn facts(&self, problem: &P) -> Facts {
        self.0.facts(problem).doubled()
    }
    fn iterations(&self, work: &Self::Work) -> u64 {
        self.0.iterations(&work.inner)
    }
    fn reused(&self, work: &Self::Work) -> u64 {
        self.0.reused(&work.inner)
    }
    fn forget(&self, work: &mut Self::Work) {
        self.0.forget(&mut work.inner);
    }
    fn each_memory(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        self.0.each_memory(&mut work.inner, each);
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok(DoublingWork {
            inner: self.0.work(problem, like)?,
            order: self.0.facts(problem).order,
            once: like.clone(),
            half: like.clone(),
        })
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        DoublingWork { inner, once, half, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        once.assign(y);
        take_halves(step, once, half, |step, y| self.0.step(problem, step, y, inner))?;
        core::mem::swap(y, once);
        Ok(())
    }
    fn interpolate(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        DoublingWork { inner, half, .. }: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        within_halves(step, theta, [from, half], at, |step, y| self.0.step(problem, step, y, inner))
    }
}

impl<P: Problem, Me: Method<P>> Embedded<P> for Doubling<Me>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        DoublingWork { inner, order, once, half }: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        doubled(*order, step, tolerance, from, [once, half], to, |step, y| {
            self.0.step(problem, step, y, inner)
        })
    }
}
