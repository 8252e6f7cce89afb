//! The Taylor coefficients of a momentum in 𝔤*, as an n×n matrix.

use faer::Mat;

use super::MomentumTerms;
use crate::dense::{antisymmetrise, mul_add};
use crate::groups::{AlgebraMatrix, MatrixGroup};
use crate::scalar::{Ops, tally};

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

impl MomentumTerms for MatrixGroup {
    type Momenta = MomentumSeries;

    fn momenta(&self, order: usize) -> MomentumSeries {
        MomentumSeries::new(self.n(), self.is_skew(), order)
    }
    fn next<'s>(
        &self,
        h: f64,
        m: &Mat<f64>,
        k: usize,
        f: &[AlgebraMatrix],
        momenta: &'s mut MomentumSeries,
    ) -> &'s Mat<f64> {
        if k == 0 {
            momenta.start().copy_from(m);
        }
        momenta.next(h, k, f)
    }
}
