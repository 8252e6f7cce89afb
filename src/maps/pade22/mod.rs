//! Ψ = the diagonal Padé approximant (2,2) of exp: order 4 of exp, and in G_M exactly for every M.
//!
//! | | Ψ(u) | dΨ_u⁻¹ w |
//! |---|---|---|
//! | any n | D(u)⁻¹ D(−u), D(u) = 𝟙 − u/2 + u²/12 | the solution v of v − uvu/12 = D(u) w D(−u) |
//! | so(3) | 𝟙 + (q u + u²/2)/(q² + α²/4), q = 1 − α²/12 | q w − ½ u×w + (1 + α²/6)/(12 + α²) (u·w) u |
//!
//! D(u) = (𝟙 − au)(𝟙 − āu) with a + ā = ½ and aā = 1/12, so that Ψ is a product of two Cayley maps
//! with complex conjugate factors; their differentials, dcay_u v = (𝟙 − u/2)⁻¹ v (𝟙 + u/2)⁻¹ for
//! each, add up to D(u)·dΨ_u(v)·D(−u) = v − uvu/12. Both lines are exact. On so(3)
//! u v u = −(u·v) u closes the equation, and neither Ψ nor dΨ⁻¹ is ever singular there; on so(n)
//! dΨ is singular where two angles have a_j a_k = 12.
//!
//! The equation is solved by doubling (v ← v + s v s, s ← s²) for ‖u‖² ≤ 3, and in Schur coordinates
//! beyond, where a conjugate pair of eigenvalues of a skew u does not count.

#[cfg(feature = "dense")]
mod general;

use nalgebra::{Matrix3, Vector3};

use super::CoordinateMap;
use crate::error::{Error, StepError};
use crate::groups::So3;
use crate::scalar::Real;
use crate::so3::{cross, finite, rodrigues, rodrigues_on};

/// The diagonal Padé map (2,2): Ψ(u) = (𝟙 − u/2 + u²/12)⁻¹(𝟙 + u/2 + u²/12).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pade22;

/// Above this α² the fourth powers of the closed form overflow.
const SQUARE_MAX: f64 = 1e150;

/// (q, 1/(q² + α²/4)) at α².
#[inline(always)]
pub(in crate::maps) fn factors<S: Real>(u: &Vector3<S>) -> Result<(S, S), StepError> {
    let l = S::lit;
    let alpha2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    if !alpha2.all_below(SQUARE_MAX) {
        return Err(StepError::NormTooLarge { map: "pade22" });
    }
    let q = l(1.0) - l(1.0 / 12.0) * alpha2;
    Ok((q, l(1.0) / (q * q + l(0.25) * alpha2)))
}

impl<S: Real> CoordinateMap<So3<S>> for Pade22 {
    type At = ();

    fn name(&self) -> &'static str {
        "pade22"
    }
    fn at(&self, _: &So3<S>) -> Result<(), Error> {
        Ok(())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        let (q, c) = factors(u)?;
        *g = rodrigues(u, q * c, S::lit(0.5) * c);
        Ok(())
    }
    #[inline]
    fn psi_on(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        _: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let (q, c) = factors(u)?;
        *y = finite(rodrigues_on(u, q * c, S::lit(0.5) * c, x), "pade22(u)·x")?;
        Ok(())
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let l = S::lit;
        let alpha2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        let dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let q = l(1.0) - l(1.0 / 12.0) * alpha2;
        let c = (l(1.0) + l(1.0 / 6.0) * alpha2) / (l(12.0) + alpha2) * dot;
        let w = cross(u, v);
        let next = Vector3::new(
            q * v[0] - l(0.5) * w[0] + c * u[0],
            q * v[1] - l(0.5) * w[1] + c * u[1],
            q * v[2] - l(0.5) * w[2] + c * u[2],
        );
        *v = finite(next, "dΨ⁻¹ of pade22")?;
        Ok(())
    }
}
