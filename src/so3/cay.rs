//! cay, its inverse, and their differentials. The factor ½ makes dcay_0 the identity.

use nalgebra::{Matrix3, Vector3};

use super::cross;
use super::log::quaternion_of;
use super::{dot3, finite, finite_matrix, polar, rodrigues};
use crate::dense::RCOND_MIN;
use crate::error::{Error, StepError};
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

/// v + ¼(u·v)u − ½ u×v.
#[inline(always)]
pub(crate) fn dcayinv_of<S: Real>(u: &Vector3<S>, v: &Vector3<S>) -> Vector3<S> {
    let (half, c) = (S::lit(0.5), S::lit(0.25) * dot3(u, v));
    let w = cross(u, v);
    Vector3::new(
        v[0] + c * u[0] - half * w[0],
        v[1] + c * u[1] - half * w[1],
        v[2] + c * u[2] - half * w[2],
    )
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
