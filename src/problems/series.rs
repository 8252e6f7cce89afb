//! Fields with Taylor coefficients by recurrence, such as polynomial fields. Lie series methods need them.

use faer::Mat;

use super::{AlgOf, PointOf, Problem, ScalarOf};
use crate::dense::{antisymmetrise, mul_add};
use crate::groups::{Adjoint, AlgebraMatrix, LieAlgebra, Se3};
use crate::scalar::{Ops, Real, tally};

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

/// The coefficients of a momentum in 𝔤*.
#[derive(Clone, Debug)]
pub struct MomentumSeries {
    m: Vec<Mat<f64>>,
    /// True if all u ∈ 𝔤 are skew, and so the momenta.
    skew: bool,
}

impl MomentumSeries {
    /// Storage for coefficients up to θ^order of momenta of size n×n.
    pub(crate) fn new(n: usize, skew: bool, order: usize) -> Self {
        MomentumSeries { m: vec![Mat::zeros(n, n); order + 1], skew }
    }

    /// m₀. Write it before the first [`next`](Self::next).
    pub(crate) fn start(&mut self) -> &mut Mat<f64> {
        &mut self.m[0]
    }

    /// m_k of ṁ = −ad*_f m, by k m_k = h Σ_{i+j=k−1} (m_i f_jᵀ − f_jᵀ m_i): 2k products, and k where
    /// 𝔤 is skew.
    #[inline(never)]
    #[expect(clippy::disallowed_methods, reason = "not inlined, so each reference has one role")]
    pub(crate) fn next(&mut self, h: f64, k: usize, f: &[AlgebraMatrix]) -> &Mat<f64> {
        if k == 0 {
            if self.skew {
                // The symmetric part of a momentum vanishes on 𝔤.
                antisymmetrise(&mut self.m[0]);
                tally(|| Ops::muls(self.m[0].nrows() * self.m[0].ncols()));
                self.m[0] *= faer::Scale(0.5);
            }
            return &self.m[0];
        }
        let (known, rest) = self.m.split_at_mut(k);
        let next = &mut rest[0];
        next.fill(0.0);
        let scale = h / k as f64;
        for (m, f) in known.iter().zip(f[..k].iter().rev()) {
            mul_add(next, scale, m.as_ref(), f.transpose());
            if !self.skew {
                mul_add(next, -scale, f.transpose(), m.as_ref());
            }
        }
        if self.skew {
            antisymmetrise(next);
        }
        next
    }
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
