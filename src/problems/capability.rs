//! Capabilities: facts about a problem in addition to f.
//!
//! Each capability is a trait. A method that needs one does not compile for a problem without it.
//!
//! | capability | fact | methods |
//! |---|---|---|
//! | [`Split`] | F = Σ F_k with exact flows | [`Splitting`](crate::methods::Splitting) |
//! | [`LiePoisson`] | ṁ = ad*_{∇H(m)} m with a discrete gradient | [`EnergyCasimir`](crate::methods::EnergyCasimir) |
//! | [`LinearField`] | f depends only on t | [`magnus`](crate::methods::magnus) |
//! | [`TaylorField`](super::TaylorField) | Taylor coefficients of f | [`LieSeries`](crate::methods::LieSeries) |
//! | [`Orthogonal`] | the place of the orthogonal matrix in y | [`ProjectionMethod`](crate::methods::ProjectionMethod) |
//! | [`FreeBody`](super::FreeBody) | a free rigid body in ℝ³ | Simo–Wong, Buss, DMV, exact, Taylor |

use super::{AlgOf, Ambient, PointOf, Problem, ScalarOf};
use crate::error::StepError;

/// A sum F = F₁ + … + F_K in which each F_k has an exact flow.
pub trait Split: Ambient {
    /// The number K of parts.
    const PARTS: usize;
    /// y ← φ_t(y), the exact flow of F_k over the time t; `part` = k − 1 < [`PARTS`](Self::PARTS).
    fn flow(&self, part: usize, t: ScalarOf<Self>, y: &mut PointOf<Self>);
}

/// A Lie–Poisson system on 𝔤*: ṁ = ad*_{∇H(m)} m, in the convention of
/// [`Coadjoint`](crate::actions::Coadjoint), f(m) = −∇H(m).
pub trait LiePoisson: Ambient {
    /// H(m).
    fn hamiltonian(&self, m: &PointOf<Self>) -> ScalarOf<Self>;
    /// ξ ← ∇̄H(a, b) ∈ 𝔤, a symmetric discrete gradient: ⟨b − a, ξ⟩ = H(b) − H(a) and
    /// ∇̄H(m, m) = ∇H(m). For quadratic H it is ∇H((a + b)/2). `scratch` is a point and an element of 𝔤.
    fn discrete_gradient(
        &self,
        a: &PointOf<Self>,
        b: &PointOf<Self>,
        xi: &mut AlgOf<Self>,
        scratch: (&mut PointOf<Self>, &mut AlgOf<Self>),
        work: &mut Self::Work,
    );
}

/// A linear equation: f(t, y) = A(t) does not depend on y. Magnus methods need it.
pub trait LinearField: Problem {}

/// The projection of a matrix near SO(n) onto it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// The factor Q of g = QR with positive diagonal R, by Gram–Schmidt twice.
    Qr,
    /// The orthogonal polar factor, the nearest orthogonal matrix, by Newton–Schulz.
    Polar,
}

/// A problem whose point holds an orthogonal matrix in a linear space.
pub trait Orthogonal: Ambient {
    /// Projects the matrix in y onto the group. The rest of y is unchanged.
    ///
    /// # Errors
    /// [`StepError::OutsideChart`] when it is too far from every rotation.
    fn project(&self, how: Projection, y: &mut PointOf<Self>) -> Result<(), StepError>;
}
