//! Fields with Taylor coefficients: by recurrence, such as polynomial fields, or by derivatives of A(t). Lie series
//! methods need them.

use super::{AlgOf, PointOf, Problem, ScalarOf};
use crate::groups::{Adjoint, LieAlgebra, Se3};
use crate::scalar::Real;

/// A field with Taylor coefficients along the solution through a point.
///
/// With ẏ = λ_*(f(t, y))(y) the solution from y is Λ(Ψ, y) with Ψ' = f Ψ, Ψ(0) = 𝟙. The
/// coefficients are in θ with time t + θh, so they contain the powers of h.
pub trait TaylorField: Problem {
    /// True if the coefficients are those of ω with Ψ' = Ψ ω, in the moving frame, instead of f.
    const MOVING: bool = false;
    /// The coefficients of the quantities in f.
    type Series: Send;

    /// Makes storage for coefficients up to θ^order. Only this call allocates.
    fn series(&self, order: usize) -> Self::Series;

    /// f\[k\] ← the coefficient of θᵏ in f(t + θh, y(t + θh)), where y = y(t). Called for k = 0, 1, … in
    /// turn, after f\[..k\] is known.
    fn coefficient(
        &self,
        time: [ScalarOf<Self>; 2],
        y: &PointOf<Self>,
        k: usize,
        f: &mut [AlgOf<Self>],
        series: &mut Self::Series,
    );
}

/// The coefficients of a momentum in se(3)*.
#[derive(Clone, Debug)]
pub struct Se3Series<S>(Vec<<Se3<S> as Adjoint>::Dual>)
where
    S: Real;

impl<S: Real> Se3Series<S> {
    /// Storage for coefficients up to θ^order.
    pub(crate) fn new(order: usize) -> Self {
        Se3Series(vec![Se3::new().zero(); order + 1])
    }

    /// m_k of ṁ = −ad*_f m from m, by k m_k = −h Σ_{i+j=k−1} ad*_{f_j} m_i.
    pub(crate) fn next(
        &mut self,
        h: S,
        m: &<Se3<S> as Adjoint>::Dual,
        k: usize,
        f: &[<Se3<S> as LieAlgebra>::Alg],
    ) -> &<Se3<S> as Adjoint>::Dual {
        let group = Se3::new();
        let [mut sum, mut term, mut next] = [group.zero(); 3];
        for (m, f) in self.0[..k].iter().zip(f[..k].iter().rev()) {
            group.coad(f, m, &mut term);
            group.axpy(S::lit(1.0), &term, &mut sum);
        }
        match k {
            0 => next = *m,
            _ => group.axpy(-h / S::lit(k as f64), &sum, &mut next),
        }
        self.0[k] = next;
        &self.0[k]
    }
}
