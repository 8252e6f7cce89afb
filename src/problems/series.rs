//! Fields with Taylor coefficients: by recurrence, such as polynomial fields, or by derivatives of A(t). Lie series
//! methods need them.

use super::{AlgOf, PointOf, Problem, ScalarOf};
use crate::groups::{Adjoint, LieAlgebra, Se3, So3};
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

/// A group whose momenta have Taylor coefficients along ṁ = −ad*_f m.
pub trait MomentumTerms: Adjoint {
    /// The coefficients of a momentum.
    type Momenta: Send;

    /// Storage for coefficients up to θ^order. Only this call allocates.
    fn momenta(&self, order: usize) -> Self::Momenta;

    /// m_k from m and f\[..k\], by k m_k = −h Σ_{i+j=k−1} ad*_{f_j} m_i. Called for k = 0, 1, … in turn.
    fn next<'s>(
        &self,
        h: Self::Scalar,
        m: &Self::Dual,
        k: usize,
        f: &[Self::Alg],
        momenta: &'s mut Self::Momenta,
    ) -> &'s Self::Dual;
}

/// On vectors 𝔤* is 𝔤 with other products.
macro_rules! on_vectors {
    ($($group:ident),*) => {$(
        impl<S: Real> MomentumTerms for $group<S> {
            type Momenta = Vec<Self::Dual>;

            fn momenta(&self, order: usize) -> Vec<Self::Dual> {
                vec![self.zero(); order + 1]
            }
            fn next<'s>(
                &self,
                h: S,
                m: &Self::Dual,
                k: usize,
                f: &[Self::Alg],
                momenta: &'s mut Vec<Self::Dual>,
            ) -> &'s Self::Dual {
                let [mut sum, mut term, mut next] = [self.zero(); 3];
                for (m, f) in momenta[..k].iter().zip(f[..k].iter().rev()) {
                    self.coad(f, m, &mut term);
                    self.axpy(S::lit(1.0), &term, &mut sum);
                }
                match k {
                    0 => next = *m,
                    _ => self.axpy(-h / S::lit(k as f64), &sum, &mut next),
                }
                momenta[k] = next;
                &momenta[k]
            }
        }
    )*};
}
on_vectors!(So3, Se3);
