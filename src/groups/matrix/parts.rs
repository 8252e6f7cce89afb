//! The symmetric and the skew part of M: what of M is rounding, and what is a form.
//!
//! uᵀM + Mu = 0 holds exactly if it holds for both parts of M. So 𝔤 is the intersection of the algebras of both.
//! Example: a program computes M = AᵀJA, and rounding makes M skew only to 1e-16. The symmetric part is rounding, and no
//! element keeps it. So this part is left out when the group is made.

use faer::Mat;

use crate::dense::{Lu, norm_frobenius};

/// A part of M is rounding if it is at most this part of M. 𝔤 and its dimension are decided to the same accuracy.
pub(super) const NOISE: f64 = 1e-10;
/// A part is kept if M without it changes by more than this, as its inverse sees it. Example: diag(1, 10⁻¹¹J) needs its
/// small skew part.
const CHANGE_MAX: f64 = 1e-3;
/// A multiple of 𝟙 is a form for skew u only if it is at least this part of M in the 1-norm. Then an element accepted
/// within 1e-12 is skew to 1e-9.
const SCALAR_MIN: f64 = 1e-3;

/// Products with M and M⁻¹ lose about as many roundings as the stretch of M. Above this one other formulas are taken.
pub(super) const STRETCHED: f64 = 10.0;

/// ‖M‖‖M⁻¹‖/n in the Frobenius norm: 1 for a multiple of an orthogonal matrix, and about the condition number of others.
pub(super) fn stretch(m: &Mat<f64>, inverse: &Mat<f64>) -> f64 {
    norm_frobenius(m) * norm_frobenius(inverse) / m.nrows() as f64
}

/// Mᵀ = ±M.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symmetry {
    Symmetric,
    Skew,
}

impl Symmetry {
    /// 1 for the symmetric part, −1 for the skew one.
    pub(super) fn sign(self) -> f64 {
        match self {
            Symmetry::Symmetric => 1.0,
            Symmetry::Skew => -1.0,
        }
    }
}

/// The symmetry of M, to the last bit.
pub(super) fn symmetry(m: &Mat<f64>) -> Option<Symmetry> {
    if m.as_ref() == m.transpose() {
        Some(Symmetry::Symmetric)
    } else if *m == -m.transpose() {
        Some(Symmetry::Skew)
    } else {
        None
    }
}

/// (M ± Mᵀ)/2, with its symmetry to the last bit.
pub(super) fn part(m: &Mat<f64>, symmetry: Symmetry) -> Mat<f64> {
    let half = 0.5 * symmetry.sign();
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| 0.5 * m[(i, j)] + half * m[(j, i)])
}

/// The inverse of a regular matrix.
pub(super) fn inverse_of(m: &Mat<f64>) -> Mat<f64> {
    let n = m.nrows();
    let mut lu = Lu::new(n);
    lu.a.copy_from(m);
    lu.factor();
    let mut inverse = Mat::identity(n, n);
    lu.solve(inverse.as_mut());
    inverse
}

/// M without a symmetric or skew part that is rounding.
pub(super) fn without_rounding(m: Mat<f64>) -> Mat<f64> {
    if symmetry(&m).is_some() {
        return m;
    }
    let size = norm_frobenius(&m);
    for symmetry in [Symmetry::Symmetric, Symmetry::Skew] {
        let kept = part(&m, symmetry);
        let noise = &m - &kept;
        if norm_frobenius(&noise) <= NOISE * size
            && norm_frobenius(&(inverse_of(&kept) * noise)) <= CHANGE_MAX
        {
            return kept;
        }
    }
    m
}

/// True if the symmetric part of M is exactly a multiple of 𝟙, and not small beside M.
pub(super) fn has_scalar_part(m: &Mat<f64>) -> bool {
    let n = m.nrows();
    let symmetric = part(m, Symmetry::Symmetric);
    let c = symmetric[(0, 0)];
    c.abs() >= SCALAR_MIN * crate::dense::norm1(m.as_ref())
        && norm_frobenius(&(symmetric - Mat::<f64>::identity(n, n) * faer::Scale(c))) == 0.0
}
