//! cay, its inverse, and their differentials. The factor ½ makes dcay_0 the identity.

use nalgebra::{Matrix3, Vector3};

use super::cross;
use super::log::quaternion_of;
use super::{dot3, finite, finite_matrix, polar, rodrigues};
use crate::error::{Error, RCOND_MIN, StepError};
use crate::scalar::Real;

/// a and a/2 with a = 1/(1 + α²/4): cay(u) = 𝟙 + a û + (a/2) û². `None` where α² leaves the range.
#[inline(always)]
pub(crate) fn cay_coefficients<S: Real>(u: &Vector3<S>) -> Option<(S, S)> {
    let alpha2 = dot3(u, u);
    if !alpha2.all_below(S::SQUARE_MAX) {
        return None;
    }
    let a = S::lit(1.0) / (S::lit(1.0) + S::lit(0.25) * alpha2);
    Some((a, S::lit(0.5) * a))
}

/// cay(u)·x = x + a(w + ½ u×w) with w = u×x and the a of [`cay_coefficients`]. `None` where α² leaves the range. A stage
/// waits for the quotient a the longest, so it is used last.
#[inline(always)]
pub(crate) fn cay_on<S: Real>(u: &Vector3<S>, x: &Vector3<S>) -> Option<Vector3<S>> {
    let (a, _) = cay_coefficients(u)?;
    let w = cross(u, x);
    let (half, uw) = (S::lit(0.5), cross(u, &w));
    Some(Vector3::new(
        x[0] + a * (w[0] + half * uw[0]),
        x[1] + a * (w[1] + half * uw[1]),
        x[2] + a * (w[2] + half * uw[2]),
    ))
}

/// cay(u) = 𝟙 + (û + û²/2)/(1 + α²/4) = (𝟙 − û/2)⁻¹(𝟙 + û/2): the rotation about u by
/// 2 atan(α/2).
///
/// # Errors
/// [`StepError::NotFinite`] for u with an entry that is NaN or infinite, [`StepError::NormTooLarge`]
/// when |u| overflows.
#[inline]
pub fn cay<S: Real>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    match cay_coefficients(u) {
        Some((a, b)) => Ok(rodrigues(u, a, b)),
        None => polar::cay_huge(u),
    }
}

/// dcay_u(v) = (v + ½ u×v)/(1 + α²/4), right trivialised.
///
/// # Errors
/// As [`cay`]; [`StepError::NotFinite`] when the result is not finite.
#[inline]
pub fn dcay<S: Real>(u: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    match cay_coefficients(u) {
        Some((a, b)) => {
            let w = cross(u, v);
            finite(Vector3::from_fn(|i, _| a * v[i] + b * w[i]), "dcay")
        }
        None => polar::dcay_huge(u, v),
    }
}

/// The matrix of [`dcay`] at u.
///
/// # Errors
/// As [`cay`].
pub fn dcay_matrix<S: Real>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    polar::columns(|e| dcay(u, e))
}

/// v − w×v + (w·v)w = v − ½ u×v + ¼(u·v)u with w = u/2, which is exact.
#[inline(always)]
pub(crate) fn dcayinv_of<S: Real>(u: &Vector3<S>, v: &Vector3<S>) -> Vector3<S> {
    let half = S::lit(0.5);
    let w = Vector3::new(half * u[0], half * u[1], half * u[2]);
    let (c, wv) = (dot3(&w, v), cross(&w, v));
    Vector3::new(v[0] - wv[0] + c * w[0], v[1] - wv[1] + c * w[1], v[2] - wv[2] + c * w[2])
}

/// dcay_u⁻¹(v) = v + ¼(u·v)u − ½ u×v.
///
/// # Errors
/// [`StepError::NotFinite`] when the result is not finite.
#[inline]
pub fn dcayinv<S: Real>(u: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    finite(dcayinv_of(u, v), "dcayinv")
}

/// The matrix of [`dcayinv`] at u: 𝟙 + uuᵀ/4 − û/2.
///
/// # Errors
/// As [`dcayinv`].
pub fn dcayinv_matrix<S: Real>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    finite_matrix(polar::columns(|e| Ok(dcayinv_of(u, e)))?, "dcayinv")
}

/// cay⁻¹(R): the u with cay(u) = R, u = 2q/q_w in the quaternion of R.
///
/// # Errors
/// As [`log`](super::log()); [`Error::Singular`] for a rotation by π to rounding, which cay does not
/// reach.
pub fn cay_inv(r: &Matrix3<f64>) -> Result<Vector3<f64>, Error> {
    let [w, x, y, z] = quaternion_of("R", r)?;
    let v = Vector3::new(x, y, z);
    let rcond = w.abs() / w.hypot(v.norm());
    if rcond.is_nan() || rcond < RCOND_MIN {
        return Err(Error::Singular { arg: "R + 𝟙", rcond, minimum: RCOND_MIN });
    }
    Ok(v.map(|x| 2.0 * x / w))
}
