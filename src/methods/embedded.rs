//! Methods that estimate their own error.
//!
//! | method | error | length |
//! |---|---|---|
//! | [`Rkmk`](super::Rkmk) with a pair | ‖h Σ (b_j − b̂_j) k_j‖ in 𝔤 | ‖v‖ in 𝔤 |
//! | low storage, Magnus 4(3) | the difference of the last two increments in 𝔤 | Σ ‖u_i‖ in 𝔤 |
//! | commutator-free, [`Rk`](super::Rk) | the distance of both results in M | the distance gone in M |
//! | any other, by [`Doubling`](super::Doubling) | one step against two halves, in M | the same |
//!
//! In 𝔤 an error is relative to the point by nature: λ_p(v + e) ≈ Λ(Ψ(e), λ_p(v)).

use super::{Method, Step};
use crate::error::{Error, StepError};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::Metric;

/// What a step says of its own error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalError<S> {
    /// The estimated error of the step.
    pub error: S,
    /// How far the step went, in the same norm: what a relative tolerance is relative to.
    pub length: S,
}

/// A method whose steps estimate their own error.
pub trait Embedded<P: Problem>: Method<P> {
    /// The estimate behaves like h to the power `error_order + 1`.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when the tableau has no embedded row.
    fn error_order(&self, problem: &P) -> Result<usize, Error>;

    /// [`evaluations`](Method::evaluations) of a [`step_with_error`](Self::step_with_error).
    fn evaluations_with_error(&self, problem: &P) -> Option<u64>;

    /// `to` ← the approximation at t + h from the point `from` at t, with its estimated error, which
    /// is infinite when there is no estimate. On an error of the step, `to` holds nothing of use.
    ///
    /// # Errors
    /// Why the step could not be taken; a smaller one may.
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError>;
}

/// The error between two results in M, and the way from the start to the second of them. What
/// rounding alone may do to the difference is no error of the step: it counts as 0.
#[inline]
pub(super) fn between<S: Real, M: Metric<Scalar = S>>(error: S, from: &M, to: &M) -> LocalError<S> {
    let noise = S::lit(8.0 * S::EPSILON) * to.size();
    let error = if (error - noise).all_below(0.0) { S::lit(0.0) } else { error };
    LocalError { error, length: to.distance(from) }
}

/// What [`Embedded::error_order`] says of a tableau without an embedded row.
pub(super) fn without_pair(tableau: &'static str) -> Error {
    Error::Unsupported {
        what: "a step size of its own choice",
        with: format!("tableau `{tableau}`"),
        why: "it has no embedded row; use a pair such as `dopri5`, or step doubling",
    }
}
