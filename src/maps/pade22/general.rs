//! The Padé map of n×n matrices.

use faer::Mat;

use super::Pade22;
use crate::dense::{AdSchur, mul, norm_frobenius, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup};
use crate::maps::CoordinateMap;
use crate::maps::quotient::{Quotient, finite};

/// Doubling converges fast up to this ‖u‖².
const DOUBLING_MAX: f64 = 3.0;
/// dΨ counts as singular where |1 − λ_jλ_k/12| is smaller than this times max(1, ‖u‖²).
const SINGULAR: f64 = 1e-12;
/// Above this norm of u²/12, for a skew u, no digit of pade22(u) has a meaning: the 𝟙 is lost next to it.
const SQUARE_MAX_SKEW: f64 = 5e14;

/// The values that the Padé map stores at u ∈ 𝔤 ⊂ gl(n): u²/12, D(±u), the LU of D(u), and workspace.
#[derive(Debug)]
pub struct Pade22At {
    quotient: Quotient,
    square: Mat<f64>,
    schur: Box<AdSchur>,
}

impl Pade22At {
    /// u²/12, D(±u), and the LU of D(u).
    fn prepare(&mut self, group: &MatrixGroup, u: &AlgebraMatrix) -> Result<(), StepError> {
        group.operand("u in pade22(u)", u)?;
        let Pade22At { quotient, square, .. } = self;
        mul(&mut quotient.product, u.as_ref(), u.as_ref());
        scaled_sum(square, [1.0 / 12.0], [&quotient.product], 0.0);
        let is_skew = matches!(group.form(), Form::Identity);
        let norm = norm_frobenius(square);
        if !norm.is_finite() || (is_skew && norm > SQUARE_MAX_SKEW) {
            return Err(StepError::NormTooLarge { map: "pade22" });
        }
        scaled_sum(&mut quotient.minus, [-0.5, 1.0], [u, square], 1.0);
        scaled_sum(&mut quotient.plus, [0.5, 1.0], [u, square], 1.0);
        if is_skew {
            // The eigenvalues 1 − iα/2 − α²/12 of D(u) are at least 1 in size.
            quotient.factor_regular();
            return Ok(());
        }
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
            schur: Box::new(AdSchur::new(n, group.ad_coordinates())),
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
        at.quotient.form((group, u), "pade22(u)", g)
    }
    fn psi_on(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut Pade22At,
        g: &mut GroupMatrix,
        x: &Mat<f64>,
        y: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        at.quotient.on((group, u), "pade22(u)·x", g, x, y)
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut Pade22At,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        let Pade22At { quotient, square, schur } = at;
        quotient.conjugate(v);
        let Quotient { minus, product, power, .. } = quotient;
        let norm = group.norm(u);
        if norm * norm > DOUBLING_MAX {
            let singular = SINGULAR * (norm * norm);
            let apply = |schur: &mut AdSchur| schur.solve_pade22(singular, v);
            group.function_of_ad(schur, u, apply)?.map_err(|_| StepError::OutsideChart {
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
