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
use crate::dense::{Lu, mul, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup, RCOND_MIN, So3};
use crate::scalar::Real;
use crate::so3;

/// The Cayley map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cay;

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
        *g = so3::cay(u)?;
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
        *y = match so3::cay_coefficients(u) {
            Some((a, b)) => so3::rodrigues_on(u, a, b, x),
            None => so3::cay_huge_on(u, x)?,
        };
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
        *v = so3::dcayinv_of(u, v);
        Ok(())
    }
}

/// What cay keeps at u ∈ 𝔤 ⊂ gl(n): 𝟙 ± u/2, and the LU of 𝟙 − u/2.
#[derive(Debug)]
pub struct CayAt {
    minus: Mat<f64>,
    plus: Mat<f64>,
    product: Mat<f64>,
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
        // On so(n) the eigenvalues of 𝟙 − u/2 are 1 − iα/2: never zero, however large u.
        if pivots < RCOND_MIN && !matches!(group.form(), Form::Identity) {
            return Err(StepError::OutsideChart { map: "cay", what: "𝟙 − u/2 is singular" });
        }
        Ok(())
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
        Ok(CayAt { minus: z(), plus: z(), product: z(), lu: Lu::new(n) })
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
        Ok(())
    }
    /// Solves for as many columns as x has.
    fn psi_on(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CayAt,
        _: &mut GroupMatrix,
        x: &Mat<f64>,
        y: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        mul(y, at.plus.as_ref(), x.as_ref());
        at.lu.solve(y.as_mut());
        Ok(())
    }
    fn dpsi_inv(
        &self,
        _: &MatrixGroup,
        _: &AlgebraMatrix,
        at: &mut CayAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        mul(&mut at.product, at.minus.as_ref(), v.as_ref());
        mul(v, at.product.as_ref(), at.plus.as_ref());
        Ok(())
    }
}
