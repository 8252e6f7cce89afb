//! Ψ = cay, the Cayley map (paper 4.3), on any matrix group.
//!
//! | | cay(u) | dcay_u⁻¹ v |
//! |---|---|---|
//! | any n | (𝟙 − u/2)⁻¹(𝟙 + u/2) | (𝟙 − u/2) v (𝟙 + u/2) |
//! | so(3) | 𝟙 + (u + u²/2)/(1 + α²/4) | ((1 + α²/4)𝟙 − u/2 + u²/4) v = v + ¼(u·v)u − ½ u×v |
//!
//! The factor ½ makes dcay_0 the identity. cay maps 𝔤_M into G_M for every M, since
//! r(z) = (1 + z/2)/(1 − z/2) has r(z)r(−z) = 1 (Celledoni & Iserles).

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use super::CoordinateMap;
use super::exp::{SQUARE_MAX, rodrigues, rodrigues_on};
use crate::dense::{Lu, is_finite, mul, orthogonalise, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{
    AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup, RCOND_MIN, So3, cross,
};
use crate::scalar::Real;

/// The Cayley map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cay;

/// 1/(1 + α²/4).
#[inline(always)]
fn shrink<S: Real>(u: &Vector3<S>) -> Result<S, StepError> {
    let alpha2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    if !alpha2.all_below(SQUARE_MAX) {
        return Err(StepError::NormTooLarge { map: "cay" });
    }
    Ok(S::lit(1.0) / (S::lit(1.0) + S::lit(0.25) * alpha2))
}

impl<S: Real> CoordinateMap<So3<S>> for Cay {
    type At = ();

    fn name(&self) -> &'static str {
        "cay"
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
        let a = shrink(u)?;
        *g = rodrigues(u, a, S::lit(0.5) * a);
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
        let a = shrink(u)?;
        *y = rodrigues_on(u, a, S::lit(0.5) * a, x);
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
        let (half, quarter) = (S::lit(0.5), S::lit(0.25));
        let c = quarter * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
        let w = cross(u, v);
        *v = Vector3::new(
            v[0] + c * u[0] - half * w[0],
            v[1] + c * u[1] - half * w[1],
            v[2] + c * u[2] - half * w[2],
        );
        Ok(())
    }
}

/// Above this ‖u‖ nothing of 𝟙 is left in 𝟙 − u/2 on so(n).
const NORM_MAX: f64 = 1e15;
/// Up to this ‖u‖ the solve alone keeps cay(u) orthogonal to rounding.
const ORTHOGONAL_TO: f64 = 4.0;

/// What cay keeps at u ∈ 𝔤 ⊂ gl(n): 𝟙 ± u/2, and the LU of 𝟙 − u/2.
#[derive(Debug)]
pub struct CayAt {
    /// Is the group SO(n)?
    is_rotation: bool,
    minus: Mat<f64>,
    plus: Mat<f64>,
    product: Mat<f64>,
    gap: Mat<f64>,
    lu: Lu,
}

impl CayAt {
    /// 𝟙 ± u/2, and the LU of 𝟙 − u/2.
    fn prepare(&mut self, group: &MatrixGroup, u: &AlgebraMatrix) -> Result<(), StepError> {
        if !group.is_finite(u) {
            return Err(StepError::NotFinite { what: "the argument of cay" });
        }
        scaled_sum(&mut self.minus, [-0.5], [u], 1.0);
        scaled_sum(&mut self.plus, [0.5], [u], 1.0);
        self.lu.a.copy_from(&self.minus);
        let pivots = self.lu.factor();
        // On so(n) the eigenvalues of 𝟙 − u/2 are 1 − iα/2, never zero, until the 1 is lost beside α.
        match self.is_rotation {
            true if group.norm(u) > NORM_MAX => Err(StepError::NormTooLarge { map: "cay" }),
            false if pivots < RCOND_MIN => {
                Err(StepError::OutsideChart { map: "cay", what: "𝟙 − u/2 is singular" })
            }
            _ => Ok(()),
        }
    }
}

impl CoordinateMap<MatrixGroup> for Cay {
    type At = CayAt;

    fn name(&self) -> &'static str {
        "cay"
    }
    fn at(&self, group: &MatrixGroup) -> Result<CayAt, Error> {
        let n = group.n();
        let z = || Mat::zeros(n, n);
        let is_rotation = matches!(group.form(), Form::Identity);
        Ok(CayAt { is_rotation, minus: z(), plus: z(), product: z(), gap: z(), lu: Lu::new(n) })
    }
    fn psi(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CayAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        g.copy_from(&at.plus);
        at.lu.solve(g.as_mut());
        // The solve loses cond(𝟙 − u/2) ≤ 1 + ‖u‖/2 units of rounding.
        if at.is_rotation && group.norm(u) > ORTHOGONAL_TO {
            orthogonalise(g, [&mut at.product, &mut at.gap]);
        }
        match is_finite(g) {
            true => Ok(()),
            false => Err(StepError::NotFinite { what: "cay(u)" }),
        }
    }
    /// Solves for as many columns as x has.
    fn psi_on(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CayAt,
        g: &mut GroupMatrix,
        x: &Mat<f64>,
        y: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        if at.is_rotation && group.norm(u) > ORTHOGONAL_TO {
            self.psi(group, u, at, g)?;
            mul(y, g.as_ref(), x.as_ref());
            return Ok(());
        }
        at.prepare(group, u)?;
        mul(y, at.plus.as_ref(), x.as_ref());
        at.lu.solve(y.as_mut());
        match is_finite(y) {
            true => Ok(()),
            false => Err(StepError::NotFinite { what: "cay(u)·x" }),
        }
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        _: &AlgebraMatrix,
        at: &mut CayAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        mul(&mut at.product, at.minus.as_ref(), v.as_ref());
        mul(v, at.product.as_ref(), at.plus.as_ref());
        match group.is_finite(v) {
            true => Ok(()),
            false => Err(StepError::NotFinite { what: "dcay⁻¹" }),
        }
    }
}
