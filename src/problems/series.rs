//! Fields whose Taylor coefficients along a solution follow from one another, as those of polynomial
//! fields do. It is what the Lie series methods ask for.

use faer::Mat;

use super::{AlgOf, PointOf, Problem, ScalarOf};
use crate::dense::{antisymmetrise, mul_add};
use crate::groups::AlgebraMatrix;
use crate::scalar::{Ops, tally};

/// A capability: the Taylor coefficients of the field along the solution through a point.
///
/// With ẏ = λ_*(f(t, y))(y) the solution from y is Λ(Ψ, y) with Ψ' = f Ψ, Ψ(0) = 𝟙. The
/// coefficients are in θ with time t + θh, so that they carry the powers of h.
pub trait TaylorField: Problem {
    /// Are the coefficients those of ω with Ψ' = Ψ ω, in the frame that moves, instead of f?
    const MOVING: bool = false;
    /// The coefficients of what f is made of.
    type Series;

    /// Storage for coefficients up to θ^order; the only call that allocates.
    fn series(&self, order: usize) -> Self::Series;

    /// f\[k\] ← the coefficient of θᵏ in f(t + θh, y(t + θh)), where y = y(t). Called with k = 0, 1, … in
    /// turn, when f\[..k\] is known.
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
    /// Are all u ∈ 𝔤 skew, and with them the momenta?
    skew: bool,
}

impl MomentumSeries {
    /// Storage for coefficients up to θ^order of momenta of size n×n.
    pub(crate) fn new(n: usize, skew: bool, order: usize) -> Self {
        MomentumSeries { m: vec![Mat::zeros(n, n); order + 1], skew }
    }

    /// m₀, to be written before the first [`next`](Self::next).
    pub(crate) fn start(&mut self) -> &mut Mat<f64> {
        &mut self.m[0]
    }

    /// m_k of ṁ = −ad*_f m, by k m_k = h Σ_{i+j=k−1} (m_i f_jᵀ − f_jᵀ m_i): 2k products, and k where
    /// 𝔤 is skew.
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
