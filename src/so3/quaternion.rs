//! The maps on unit quaternions, and the order of their components by name.
//!
//! Quaternions are Hamilton's and act as R x = q x q̄. nalgebra's [`UnitQuaternion`] stores x, y, z, w
//! and is constructed from w, x, y, z; here every function that meets bare numbers says which.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::angle::Angle;
use super::log::{POLAR_MAX, log_of, quaternion_of};
use super::polar;
use crate::error::{Error, StepError};

/// The unit quaternion of [`exp`](super::exp()): (cos(α/2), (sin(α/2)/α)·u). Its sign follows u: a
/// turn by 2π gives −1.
///
/// # Errors
/// As [`exp`](super::exp()).
#[inline]
pub fn exp_quaternion(u: &Vector3<f64>) -> Result<UnitQuaternion<f64>, StepError> {
    let angle = Angle::with_half(u);
    if !angle.in_range() {
        return polar::exp_huge_quaternion(u);
    }
    let (c, s) = angle.quaternion_coefficients();
    Ok(UnitQuaternion::new_unchecked(Quaternion::new(c, s * u[0], s * u[1], s * u[2])))
}

/// cos(α/2) and sin(α/2)/α: what [`exp_quaternion`] takes of u, for any number; none for huge u.
pub(crate) fn half_angle<S: crate::scalar::Trig>(u: &Vector3<S>) -> Option<(S, S)> {
    let angle = Angle::of(u);
    angle.in_range().then(|| angle.quaternion_coefficients())
}

/// log of the rotation of q, |log| ≤ π: q and −q give the same. A rotation by exactly π has two
/// logarithms; then the first component that is not zero is positive.
///
/// # Errors
/// [`Error::OutOfRange`] when a component is not finite or |q|² is not 1 to [`POLAR_MAX`]; within
/// that, q counts as q/|q|.
#[inline]
pub fn log_quaternion(q: &UnitQuaternion<f64>) -> Result<Vector3<f64>, Error> {
    let c = q.coords;
    let squares = c.norm_squared();
    if squares.is_nan() || (squares - 1.0).abs() > POLAR_MAX {
        return Err(Error::out_of_range("|q|²", squares, "a unit quaternion"));
    }
    Ok(log_of(c[3], c.xyz()))
}

/// The unit quaternion of [`cay`](super::cay()): (1, u/2)/√(1 + α²/4).
///
/// # Errors
/// As [`cay`](super::cay()).
pub fn cay_quaternion(u: &Vector3<f64>) -> Result<UnitQuaternion<f64>, StepError> {
    polar::check("cay", u)?;
    // Scaled so that no square leaves the range.
    let size = u.amax().max(2.0);
    let (w, v) = (2.0 / size, u / size);
    let norm = (w * w + v.norm_squared()).sqrt();
    Ok(UnitQuaternion::new_unchecked(Quaternion::from_parts(w / norm, v / norm)))
}

/// The unit quaternion of [`ccsk`](super::ccsk()): the product of the three rotations about the axes
/// I, J, K.
///
/// # Errors
/// As [`ccsk`](super::ccsk()).
pub fn ccsk_quaternion<const I: usize, const J: usize, const K: usize>(
    u: &Vector3<f64>,
) -> Result<UnitQuaternion<f64>, StepError> {
    polar::check("ccsk", u)?;
    let about = |i: usize| {
        let (s, c) = (0.5 * u[i]).sin_cos();
        let mut v = Vector3::zeros();
        v[i] = s;
        UnitQuaternion::new_unchecked(Quaternion::from_parts(c, v))
    };
    Ok(about(I) * about(J) * about(K))
}

/// The unit quaternion of R (of its polar factor, see [`log`](super::log())), with its largest
/// component, or nearly the largest, positive.
///
/// # Errors
/// As [`log`](super::log()).
pub fn quaternion_from_matrix(r: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, Error> {
    let [w, x, y, z] = quaternion_of("R", r)?;
    let q = Quaternion::new(w, x, y, z);
    Ok(UnitQuaternion::new_unchecked(q / q.norm()))
}

/// The rotation of the quaternion w + xi + yj + zk, brought to unit length.
///
/// # Errors
/// [`Error::OutOfRange`] when its length is 0 or not finite.
pub fn quaternion_from_wxyz([w, x, y, z]: [f64; 4]) -> Result<UnitQuaternion<f64>, Error> {
    let q = Quaternion::new(w, x, y, z);
    let size = q.coords.amax();
    // amax passes over a NaN, the sum does not.
    let sum = w.abs() + x.abs() + y.abs() + z.abs();
    if size == 0.0 || !sum.is_finite() {
        return Err(Error::out_of_range("|q|", sum, "a finite positive length"));
    }
    let q = q.coords / size;
    Ok(UnitQuaternion::new_unchecked(Quaternion::from(q / q.norm())))
}

/// [`quaternion_from_wxyz`] for numbers in the order x, y, z, w.
///
/// # Errors
/// As [`quaternion_from_wxyz`].
pub fn quaternion_from_xyzw([x, y, z, w]: [f64; 4]) -> Result<UnitQuaternion<f64>, Error> {
    quaternion_from_wxyz([w, x, y, z])
}

/// \[w, x, y, z\].
pub fn quaternion_to_wxyz(q: &UnitQuaternion<f64>) -> [f64; 4] {
    let c = q.coords;
    [c[3], c[0], c[1], c[2]]
}

/// \[x, y, z, w\].
pub fn quaternion_to_xyzw(q: &UnitQuaternion<f64>) -> [f64; 4] {
    q.coords.into()
}
