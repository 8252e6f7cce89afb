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

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use super::CoordinateMap;
use super::quotient::{Quotient, finite};
use crate::dense::{AdSchur, mul, norm_frobenius, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, GroupMatrix, LieAlgebra, MatrixGroup, So3};
use crate::scalar::Real;
use crate::so3::cross;
use crate::so3::{finite as finite3, rodrigues, rodrigues_on};

/// The diagonal Padé map (2,2): Ψ(u) = (𝟙 − u/2 + u²/12)⁻¹(𝟙 + u/2 + u²/12).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pade22;

/// Above this α² the fourth powers of the closed form overflow.
const SQUARE_MAX: f64 = 1e150;
/// Doubling converges fast up to this ‖u‖².
const DOUBLING_MAX: f64 = 3.0;
/// dΨ counts as singular where |1 − λ_jλ_k/12| is smaller than this times max(1, ‖u‖²).
const SINGULAR: f64 = 1e-12;

/// (q, 1/(q² + α²/4)) at α².
#[inline(always)]
pub(super) fn factors<S: Real>(u: &Vector3<S>) -> Result<(S, S), StepError> {
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
        *y = finite3(rodrigues_on(u, q * c, S::lit(0.5) * c, x), "pade22(u)·x")?;
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
        *v = finite3(next, "dΨ⁻¹ of pade22")?;
        Ok(())
    }
}

/// The values that the Padé map stores at u ∈ 𝔤 ⊂ gl(n): u²/12, D(±u), the LU of D(u), and workspace.
#[derive(Debug)]
pub struct Pade22At {
    quotient: Quotient,
    square: Mat<f64>,
    power: Mat<f64>,
    schur: Box<AdSchur>,
}

impl Pade22At {
    /// u²/12, D(±u), and the LU of D(u).
    fn prepare(&mut self, group: &MatrixGroup, u: &AlgebraMatrix) -> Result<(), StepError> {
        group.operand("u in pade22(u)", u)?;
        let Pade22At { quotient, square, .. } = self;
        mul(&mut quotient.product, u.as_ref(), u.as_ref());
        scaled_sum(square, [1.0 / 12.0], [&quotient.product], 0.0);
        if !norm_frobenius(square).is_finite() {
            return Err(StepError::NormTooLarge { map: "pade22" });
        }
        scaled_sum(&mut quotient.minus, [-0.5, 1.0], [u, square], 1.0);
        scaled_sum(&mut quotient.plus, [0.5, 1.0], [u, square], 1.0);
        quotient.factor("pade22", "𝟙 − u/2 + u²/12")
    }
}

impl CoordinateMap<MatrixGroup> for Pade22 {
    type At = Pade22At;

    fn name(&self) -> &'static str {
        "pade22"
    }
    fn at(&self, group: &MatrixGroup) -> Result<Pade22At, Error> {
        let n = group.n();
        Ok(Pade22At {
            quotient: Quotient::new(n),
            square: Mat::zeros(n, n),
            power: Mat::zeros(n, n),
            schur: Box::new(AdSchur::new(n, group.ad_form())),
        })
    }
    fn psi(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut Pade22At,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        at.quotient.form("pade22(u)", g)
    }
    fn psi_on(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut Pade22At,
        _: &mut GroupMatrix,
        x: &Mat<f64>,
        y: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        at.quotient.on("pade22(u)·x", x, y)
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut Pade22At,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        let Pade22At { quotient, square, power, schur } = at;
        quotient.conjugate(v);
        let Quotient { minus, product, .. } = quotient;
        let norm = group.norm(u);
        if norm * norm > DOUBLING_MAX {
            schur.factor(u)?;
            let singular = SINGULAR * (norm * norm);
            schur.solve_pade22(singular, v).map_err(|_| StepError::OutsideChart {
                map: "pade22",
                what: "a product of two eigenvalues of u is 12",
            })?;
        } else {
            // v ← Σ s^k v s^k with s = u/√12: two terms with s² = u²/12, then doubling.
            mul(product, u.as_ref(), v.as_ref());
            mul(power, product.as_ref(), u.as_ref());
            scaled_sum(product, [1.0, 1.0 / 12.0], [v, power], 0.0);
            v.copy_from(&*product);
            power.copy_from(&*square);
            while norm_frobenius(power) > 1e-9 {
                mul(product, power.as_ref(), v.as_ref());
                mul(minus, product.as_ref(), power.as_ref());
                scaled_sum(product, [1.0, 1.0], [v, minus], 0.0);
                v.copy_from(&*product);
                mul(product, power.as_ref(), power.as_ref());
                power.copy_from(&*product);
            }
            // D(u) was lent as scratch.
            scaled_sum(minus, [-0.5, 1.0], [u, square], 1.0);
        }
        finite(v, "dΨ⁻¹ of pade22")
    }
}
