//! dexp, dexp⁻¹ and what is known of them, as functions on n×n matrices: fresh storage at each call.

use core::f64::consts::TAU;

use super::general::{ExpAt, ad_bound};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup};
use crate::maps::functions::DexpGroup;

fn check(group: &MatrixGroup, arg: &'static str, x: &AlgebraMatrix) -> Result<(), Error> {
    let (n, rows, cols) = (group.n(), x.nrows(), x.ncols());
    if (rows, cols) != (n, n) {
        return Err(Error::Shape { arg, rows, cols, expected_rows: n, expected_cols: n });
    }
    for col in 0..n {
        for row in 0..n {
            let value = x[(row, col)];
            if !value.is_finite() {
                return Err(Error::NotFiniteEntry { arg, row, col, value });
            }
        }
    }
    Ok(())
}

fn finite(
    group: &MatrixGroup,
    w: AlgebraMatrix,
    what: &'static str,
) -> Result<AlgebraMatrix, Error> {
    match group.is_finite(&w) {
        true => Ok(w),
        false => Err(StepError::NotFinite { what }.into()),
    }
}

/// dexpinv(u, v, q) of Table 1: Σ_{k=0}^{q} B_k/k! ad_u^k v, the truncated series (15), any n.
///
/// `u` and `v` are elements of the algebra of `group`; q brackets. q = 0 returns v. The series
/// converges where the eigenvalues of ad_u are smaller than 2π in modulus;
/// [`dexpinv_with_remainder`] says how far it got, and [`dexpinv`](crate::maps::dexpinv) is exact at any u.
///
/// # Errors
/// [`Error::Shape`], [`Error::NotFiniteEntry`], [`Error::Map`] when the result is not finite.
pub fn dexpinv_truncated(
    group: &MatrixGroup,
    u: &AlgebraMatrix,
    v: &AlgebraMatrix,
    q: usize,
) -> Result<AlgebraMatrix, Error> {
    dexpinv_with_remainder(group, u, v, q).map(|truncated| truncated.value)
}

/// The sum of the Baker series of dexp⁻¹, cut after some terms.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BakerSum {
    /// The sum.
    pub value: AlgebraMatrix,
    /// A bound of ‖what was cut off‖ (Frobenius), rounding apart; infinite where the bound of ad_u
    /// does not show that the series converges, and where ‖v‖ leaves the range of `f64`.
    pub remainder: f64,
}

/// [`dexpinv_truncated`] with a bound of what was cut off.
///
/// With r ≥ ‖ad_u‖ (r = 2‖u‖, and ‖u‖ on so(n)) and k the first even number above q ≥ 1:
/// ‖Σ_{j ≥ k} B_j/j! ad_u^j v‖ ≤ 2ζ(k) (r/2π)^k / (1 − (r/2π)²) · ‖ad_u^q v‖/r^q, since
/// |B_j|/j! = 2ζ(j)/(2π)^j for even j.
///
/// # Errors
/// As [`dexpinv_truncated`].
pub fn dexpinv_with_remainder(
    group: &MatrixGroup,
    u: &AlgebraMatrix,
    v: &AlgebraMatrix,
    q: usize,
) -> Result<BakerSum, Error> {
    check(group, "u", u)?;
    check(group, "v", v)?;
    let (mut at, mut w) = (ExpAt::new(group, false), v.clone());
    let last = at.truncated(group, u, q, &mut w)?;
    let value = finite(group, w, "dexpinv(u, v, q)")?;
    let radius = ad_bound(group, u);
    let ratio = radius / TAU;
    let remainder = if last == 0.0 {
        0.0
    } else if ratio < 1.0 {
        let first = if q.is_multiple_of(2) { q + 2 } else { q + 1 };
        // B_1 = −1/2 is left out as well at q = 0. ζ(k) ≤ π²/6.
        let linear = if q == 0 { 0.5 * radius * last } else { 0.0 };
        let growth = radius.powi((first - q) as i32) * TAU.powi(-(first as i32));
        let bound = linear + 2.0 * 1.645 * growth / (1.0 - ratio * ratio) * last;
        // 0·∞ where u is tiny and ‖ad_u^q v‖ leaves the range: nothing is known.
        if bound.is_nan() { f64::INFINITY } else { bound }
    } else {
        f64::INFINITY
    };
    Ok(BakerSum { value, remainder })
}

/// dexp_u v on n×n matrices, to rounding at any ‖u‖: the series, and beyond it the eigen form on so(n) or
/// halvings in Schur coordinates. O(n³).
pub(in crate::maps) fn dexp(
    group: &MatrixGroup,
    u: &AlgebraMatrix,
    v: &AlgebraMatrix,
) -> Result<AlgebraMatrix, Error> {
    check(group, "u", u)?;
    check(group, "v", v)?;
    let (mut at, mut w) = (ExpAt::new(group, true), v.clone());
    at.forward(group, u, &mut w)?;
    finite(group, w, "dexp(u, v)")
}

/// The smallest distance of an eigenvalue of ad_u on 𝔤 to the singular set 2πik, k ≠ 0, of dexp_u.
///
/// It allocates; the storage that exp makes by [`CoordinateMap::at`](crate::CoordinateMap::at) has the same
/// without.
///
/// # Errors
/// [`Error::Shape`], [`Error::NotFiniteEntry`], [`Error::Map`].
pub fn distance_to_singular(group: &MatrixGroup, u: &AlgebraMatrix) -> Result<f64, Error> {
    check(group, "u", u)?;
    Ok(ExpAt::new(group, false).distance_to_singular(group, u)?)
}

impl DexpGroup for MatrixGroup {
    fn dexp_of(&self, u: &AlgebraMatrix, v: &AlgebraMatrix) -> Result<AlgebraMatrix, Error> {
        dexp(self, u, v)
    }
}
