//! Methods with an error estimate.
//!
//! | method | error | length, for [`Rule::PerLength`] |
//! |---|---|---|
//! | [`Rkmk`](super::Rkmk) with a pair | ‖h Σ (b_j − b̂_j) k_j‖ in 𝔤 | ‖v‖ in 𝔤 |
//! | commutator-free, low storage, Magnus 4(3), [`Rk`](super::Rk) | the distance of both results in M | the length of the step in M |
//! | Lie series, [`Taylor`](super::Taylor) | the last terms of the series, as a number relative to the point | the same |
//! | [`TaylorMomentum`](super::TaylorMomentum) | the last terms of the series, as a number relative to the point | the length of the step in M |
//! | any other, by [`Doubling`](super::Doubling) | one step against two halves, in M | the same |
//!
//! An error e in 𝔤 is always relative to the point: λ_p(v + e) ≈ Λ(Ψ(e), λ_p(v)).

use super::streak::attempt_steps;
use super::{Attempt, Attempts, Method, Step};
use crate::actions::Action;
use crate::error::StepError;
use crate::groups::LieAlgebra;
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::{Real, smaller};
use crate::space::{Gap, Metric};
use crate::tolerance::{Rule, Scales, Tolerance, ratio};

/// A method whose steps have an error estimate. [`Facts`](super::Facts) has the order of the estimate and its cost.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no error estimate for `{P}`",
    note = "give a step size by `.dt(h)` or `.steps(n)`, wrap the method in `Doubling(method)`, or take a pair such as `Rkmk::new(DOPRI5, Exp)`"
)]
pub trait Embedded<P: Problem>: Method<P> {
    /// `to` ← the approximation at t + h from the point `from` at t. Returns its estimated error in units of the
    /// tolerance, or infinity without an estimate. If the step fails, `to` is undefined.
    ///
    /// # Errors
    /// The reason why the step failed. A smaller step may succeed.
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError>;

    /// Attempts a step from the second point to the third, and then those of the streak after it. Each accepted step moves
    /// the points on: the first is then its start, the second its end.
    ///
    /// A step is accepted and the next one attempted, while the error keeps the step size, the streak allows another
    /// attempt, and `watch` has nothing to look at in the step.
    fn attempt(&self, problem: &P, attempt: Attempt<'_, P>, work: &mut Self::Work) -> Attempts
    where
        ScalarOf<P>: Into<f64>,
    {
        attempt_steps(self, problem, attempt, work)
    }
}

/// The ratio of an error e ∈ 𝔤 of a step from y to z, whose increment has this length.
#[inline]
pub(crate) fn ratio_in_algebra<P: Problem>(
    problem: &P,
    tolerance: &Tolerance,
    e: &AlgOf<P>,
    [y, z]: [&PointOf<P>; 2],
    length: ScalarOf<P>,
) -> ScalarOf<P> {
    let group = problem.group();
    match tolerance.rule() {
        Rule::PerLength => ratio(group.norm(e), tolerance.per_length(length)),
        Rule::PerStep => {
            problem.action().error_ratio_of_step(group, e, [y, z], &mut tolerance.scales())
        }
    }
}

/// The largest error that e ∈ 𝔤 is of a part, relative to the part's own size in the first of two points. From a part that is
/// 0 it is relative to its size in the second one, to which the step leads.
#[inline]
pub(super) fn relative_error_of_parts<P: Problem>(
    problem: &P,
    e: &AlgOf<P>,
    [from, to]: [&PointOf<P>; 2],
) -> ScalarOf<P> {
    let of = |y| problem.action().error_ratio(problem.group(), e, y, &mut Scales::relative());
    let error = of(from);
    if error.is_finite() { error } else { of(to) }
}

/// The ratio of an error given as a number, relative to the point.
#[inline]
pub(super) fn ratio_of_relative<S: Real, M: Metric<Scalar = S>>(
    tolerance: &Tolerance,
    e: S,
    y: &M,
    length: S,
) -> S {
    match tolerance.rule() {
        Rule::PerLength => ratio(e, tolerance.per_length(length)),
        Rule::PerStep => y.error_ratio(Gap::relative(e), &mut tolerance.scales()),
    }
}

/// The ratio of the error of a step to the point `to`, given as a number relative to that point.
#[inline]
pub(super) fn ratio_of_relative_step<M: Metric>(
    tolerance: &Tolerance,
    e: M::Scalar,
    from: &M,
    to: &M,
) -> M::Scalar {
    match tolerance.rule() {
        Rule::PerLength => ratio(e * to.size(), tolerance.per_length(to.distance(from))),
        Rule::PerStep => {
            to.error_ratio(Gap::relative(e).of_step_from(from), &mut tolerance.scales())
        }
    }
}

/// The ratio of a step that is far too long is no larger: where it were infinite, no next size would follow from it.
pub(super) const LARGEST_RATIO: f64 = 1e30;

/// The largest ratio of an error that may be rounding. Such a step is accepted, and from order 4 to 12 its size is kept. If
/// the ratio were 0, the next step would have five times the size. Where the tolerance is near the rounding, that step would
/// be rejected.
const ROUNDING: f64 = 0.1;

/// The ratio of `weight` times the distance of `other` from the result `to` of a step. A distance that may be rounding
/// counts as [`ROUNDING`] at most.
#[inline]
pub(super) fn ratio_between<S: Real, M: Metric<Scalar = S>>(
    tolerance: &Tolerance,
    other: &M,
    weight: f64,
    from: &M,
    to: &M,
) -> S {
    let weight = S::lit(weight);
    let ratio = match tolerance.rule() {
        Rule::PerLength => {
            ratio(weight * to.distance(other), tolerance.per_length(to.distance(from)))
        }
        Rule::PerStep => {
            weight * to.error_ratio(Gap::to(other).of_step_from(from), &mut tolerance.scales())
        }
    };
    if (ratio - S::lit(ROUNDING)).all_below(0.0) {
        return ratio;
    }
    // The rounding of a large part says nothing of the others.
    let relative = weight * to.error_ratio(Gap::to(other), &mut Scales::relative());
    let may_be_rounding = (relative - S::lit(8.0 * S::EPSILON)).all_below(0.0);
    if may_be_rounding { smaller(ratio, S::lit(ROUNDING)) } else { ratio }
}
