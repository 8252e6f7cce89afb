//! exp, dexp and dexp⁻¹.

use nalgebra::{Matrix3, Vector3};

use super::angle::Angle;
use super::polar;
use super::{finite, finite_matrix, rodrigues, rodrigues_on};
use crate::error::StepError;
use crate::scalar::Trig;

/// Above this coefficient dexp⁻¹ is singular: |u| is within about 1e-12/|u| of 2πk.
const COEFFICIENT_MAX: f64 = 1e12;

impl<S: Trig> Angle<S> {
    /// (1 − (α/2)cot(α/2))/α², or that dexp is singular here.
    #[inline(always)]
    pub(crate) fn dexpinv_regular(&self) -> Result<S, StepError> {
        let c = self.dexpinv_coefficient();
        if c.abs().all_below(COEFFICIENT_MAX) { Ok(c) } else { Err(polar::SINGULAR) }
    }
}

/// exp(u) = 𝟙 + (sin α/α) û + ((1−cos α)/α²) û², equation (14): the rotation about u by α = |u|.
///
/// # Errors
/// [`StepError::NotFinite`] for u with an entry that is NaN or infinite, [`StepError::NormTooLarge`]
/// when |u| overflows.
#[inline]
pub fn exp<S: Trig>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    let (angle, g) = Angle::with_matrix(u);
    if angle.in_range() { Ok(g) } else { polar::exp_huge(u) }
}

/// exp(u)·x without forming exp(u): two cross products.
///
/// # Errors
/// As [`exp`]; [`StepError::NotFinite`] when the result is not finite.
#[inline]
pub fn exp_on<S: Trig>(u: &Vector3<S>, x: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    let (angle, a, b) = Angle::with_exp(u);
    match angle.in_range() {
        true => finite(rodrigues_on(u, a, b, x), "exp(u)·x"),
        false => polar::exp_huge_on(u, x),
    }
}

/// dexp_u(v) = v + ((1−cos α)/α²) u×v + ((α−sin α)/α³) u×(u×v), right trivialised.
///
/// # Errors
/// As [`exp`]; [`StepError::NotFinite`] when the result is not finite.
#[inline]
pub fn dexp<S: Trig>(u: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    let angle = Angle::with_half(u);
    if !angle.in_range() {
        return polar::dexp_huge(u, v);
    }
    let (b, d) = angle.dexp_coefficients();
    finite(rodrigues_on(u, b, d, v), "dexp")
}

/// The matrix of [`dexp`] at u: the left Jacobian J_l(u). J_r(u) = J_l(−u) = J_l(u)ᵀ.
///
/// # Errors
/// As [`exp`].
#[inline]
pub fn dexp_matrix<S: Trig>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    let angle = Angle::with_half(u);
    if !angle.in_range() {
        return polar::columns(|e| polar::dexp_huge(u, e));
    }
    let (b, d) = angle.dexp_coefficients();
    Ok(rodrigues(u, b, d))
}

/// dexp_u⁻¹(v) = v − ½ u×v + ((1−(α/2)cot(α/2))/α²) u×(u×v), equation (16).
///
/// # Errors
/// As [`exp`]; [`StepError::OutsideChart`] next to |u| = 2πk, k ≥ 1, within about 1e-12/|u|; [`StepError::NotFinite`] when the
/// result is not finite.
#[inline]
pub fn dexpinv<S: Trig>(u: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    let angle = Angle::of(u);
    if !angle.in_range() {
        return polar::dexpinv_huge(u, v);
    }
    finite(rodrigues_on(u, S::lit(-0.5), angle.dexpinv_regular()?, v), "dexpinv")
}

/// The matrix of [`dexpinv`] at u: J_l(u)⁻¹. Its transpose is J_r(u)⁻¹.
///
/// # Errors
/// As [`dexpinv`].
#[inline]
pub fn dexpinv_matrix<S: Trig>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    let angle = Angle::of(u);
    if !angle.in_range() {
        return polar::columns(|e| polar::dexpinv_huge(u, e));
    }
    finite_matrix(rodrigues(u, S::lit(-0.5), angle.dexpinv_regular()?), "dexpinv")
}
