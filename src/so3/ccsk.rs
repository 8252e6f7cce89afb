//! ccsk for the six orderings IJK of the axes, its differentials, and the angles back.
//!
//! The odd orderings follow from the even ones by a mirror: e_I, e_J, ±e_K is a right-handed frame,
//! and in it the third angle and everything along e_K change sign.

use nalgebra::{Matrix3, Vector3};

use super::log::quaternion_of;
use super::polar;
use super::{finite, finite_matrix};
use crate::error::{Error, StepError};
use crate::scalar::{Real, Trig};

/// (sin, cos) of the first and of the second angle.
#[derive(Clone, Copy, Debug)]
pub struct Angles<S> {
    one: (S, S),
    two: (S, S),
}

impl<S: Real> Angles<S> {
    /// The angles of u = 0.
    pub(crate) fn zero() -> Self {
        let zero = (S::lit(0.0), S::lit(1.0));
        Angles { one: zero, two: zero }
    }
}

pub(crate) const GIMBAL: StepError =
    StepError::OutsideChart { map: "ccsk", what: "the cosine of a middle angle is nearly zero" };

/// x, with the sign of the ordering.
#[inline(always)]
fn signed<S: Real, const I: usize, const J: usize, const K: usize>(x: S) -> S {
    const { assert!(I < 3 && J < 3 && K < 3 && I != J && J != K && K != I) };
    if (I + 1) % 3 == J { x } else { -x }
}

/// g ← ccsk(u) for finite u.
#[inline(always)]
pub(crate) fn ccsk_of<S: Trig, const I: usize, const J: usize, const K: usize>(
    u: &Vector3<S>,
    g: &mut Matrix3<S>,
) -> Angles<S> {
    let sign = signed::<S, I, J, K>;
    let ((s1, c1), (s2, c2)) = (u[I].sin_cos(), u[J].sin_cos());
    let (s3, c3) = sign(u[K]).sin_cos();
    let (s12, c12) = (s1 * s2, c1 * s2);
    g[(I, I)] = c2 * c3;
    g[(I, J)] = -(c2 * s3);
    g[(I, K)] = sign(s2);
    g[(J, I)] = s12 * c3 + c1 * s3;
    g[(J, J)] = c1 * c3 - s12 * s3;
    g[(J, K)] = sign(-(s1 * c2));
    g[(K, I)] = sign(s1 * s3 - c12 * c3);
    g[(K, J)] = sign(c12 * s3 + s1 * c3);
    g[(K, K)] = c1 * c2;
    Angles { one: (s1, c1), two: (s2, c2) }
}

/// v ← dccsk_u⁻¹ v, the matrix (18) in the axes IJK; refused where |cos u_J| < `min_cos`.
#[inline(always)]
pub(crate) fn dccskinv_of<S: Real, const I: usize, const J: usize, const K: usize>(
    at: &Angles<S>,
    min_cos: f64,
    v: &mut Vector3<S>,
) -> Result<(), StepError> {
    let ((s1, c1), (s2, c2)) = (at.one, at.two);
    if c2.abs().any_below(min_cos) {
        return Err(GIMBAL);
    }
    let sign = signed::<S, I, J, K>;
    let (v1, v2, v3) = (v[I], v[J], sign(v[K]));
    let w = (c1 * v3 - s1 * v2) / c2;
    v[I] = v1 - s2 * w;
    v[J] = c1 * v2 + s1 * v3;
    v[K] = sign(w);
    Ok(())
}

fn angles<S: Trig, const I: usize, const J: usize, const K: usize>(
    u: &Vector3<S>,
) -> Result<Angles<S>, StepError> {
    const { assert!(I < 3 && J < 3 && K < 3 && I != J && J != K && K != I) };
    polar::check("ccsk", u)?;
    Ok(Angles { one: u[I].sin_cos(), two: u[J].sin_cos() })
}

/// ccsk(u) = exp(u_I e_I) exp(u_J e_J) exp(u_K e_K), the axes numbered from 0:
/// `ccsk::<f64, 2, 1, 0>` is the paper's ordering 321, yaw–pitch–roll.
///
/// # Errors
/// [`StepError::NotFinite`] for u with an entry that is NaN or infinite, [`StepError::NormTooLarge`]
/// when |u| overflows.
#[inline]
pub fn ccsk<S: Trig, const I: usize, const J: usize, const K: usize>(
    u: &Vector3<S>,
) -> Result<Matrix3<S>, StepError> {
    polar::check("ccsk", u)?;
    let mut g = Matrix3::from_element(S::lit(0.0));
    ccsk_of::<S, I, J, K>(u, &mut g);
    Ok(g)
}

/// dccsk_u(v) = v_I e_I + v_J R_I e_J + v_K R_I R_J e_K, right trivialised.
///
/// # Errors
/// As [`ccsk`]; [`StepError::NotFinite`] when the result is not finite.
#[inline]
pub fn dccsk<S: Trig, const I: usize, const J: usize, const K: usize>(
    u: &Vector3<S>,
    v: &Vector3<S>,
) -> Result<Vector3<S>, StepError> {
    let Angles { one: (s1, c1), two: (s2, c2) } = angles::<S, I, J, K>(u)?;
    let sign = signed::<S, I, J, K>;
    // In the frame e_I, e_J, ±e_K: R_I e_J = (0, c₁, s₁), R_I R_J e_K = (s₂, −s₁c₂, c₁c₂).
    let (v1, v2, v3) = (v[I], v[J], sign(v[K]));
    let mut w = *v;
    w[I] = v1 + s2 * v3;
    w[J] = c1 * v2 - s1 * (c2 * v3);
    w[K] = sign(s1 * v2 + c1 * (c2 * v3));
    finite(w, "dccsk")
}

/// The matrix of [`dccsk`] at u.
///
/// # Errors
/// As [`ccsk`].
pub fn dccsk_matrix<S: Trig, const I: usize, const J: usize, const K: usize>(
    u: &Vector3<S>,
) -> Result<Matrix3<S>, StepError> {
    polar::columns(|e| dccsk::<S, I, J, K>(u, e))
}

/// dccsk_u⁻¹(v), the matrix (18) in the axes IJK, up to its singularity cos u_J = 0.
///
/// # Errors
/// As [`ccsk`]; [`StepError::NotFinite`] when the result is not finite.
#[inline]
pub fn dccskinv<S: Trig, const I: usize, const J: usize, const K: usize>(
    u: &Vector3<S>,
    v: &Vector3<S>,
) -> Result<Vector3<S>, StepError> {
    let (at, mut w) = (angles::<S, I, J, K>(u)?, *v);
    dccskinv_of::<S, I, J, K>(&at, 0.0, &mut w)?;
    finite(w, "dccskinv")
}

/// The matrix of [`dccskinv`] at u.
///
/// # Errors
/// As [`dccskinv`].
pub fn dccskinv_matrix<S: Trig, const I: usize, const J: usize, const K: usize>(
    u: &Vector3<S>,
) -> Result<Matrix3<S>, StepError> {
    finite_matrix(polar::columns(|e| dccskinv::<S, I, J, K>(u, e))?, "dccskinv")
}

/// The angles u with ccsk(u) = R and |u_J| ≤ π/2, |u_I| ≤ π, |u_K| ≤ π (Euler angles of the
/// Tait–Bryan kind).
///
/// At |u_J| = π/2 only u_I ± u_K is determined: then u_I is what rounding leaves of it, and u_K is
/// such that ccsk(u) = R still holds to rounding.
///
/// # Errors
/// As [`log`](super::log()).
pub fn ccsk_inv<const I: usize, const J: usize, const K: usize>(
    r: &Matrix3<f64>,
) -> Result<Vector3<f64>, Error> {
    let sign = signed::<f64, I, J, K>;
    quaternion_of("R", r)?;
    let one = (-sign(r[(J, K)])).atan2(r[(K, K)]);
    let (s1, c1) = one.sin_cos();
    // R_Iᵀ R = R_J R_K has sin u_K, cos u_K in its row J, at every u_J.
    let s3 = c1 * r[(J, I)] + s1 * sign(r[(K, I)]);
    let c3 = c1 * r[(J, J)] + s1 * sign(r[(K, J)]);
    let mut u = Vector3::zeros();
    u[I] = one;
    let cos = (r[(I, I)] * r[(I, I)] + r[(I, J)] * r[(I, J)]).sqrt();
    u[J] = sign(r[(I, K)]).atan2(cos);
    u[K] = sign(s3.atan2(c3));
    Ok(u)
}
