//! D(u)⁻¹·D(−u) by one LU: what cay and the Padé map have in common.

use faer::Mat;

use crate::dense::{Lu, RCOND_MIN, is_finite, mul, norm_frobenius, norm1, orthogonalise};
use crate::error::StepError;
use crate::groups::{AlgebraMatrix, Form, MatrixGroup};

/// D(u), D(−u), the LU of D(u), and a product.
#[derive(Debug)]
pub(super) struct Quotient {
    /// D(u); write it here, then [`factor`](Self::factor).
    pub(super) minus: Mat<f64>,
    /// D(−u).
    pub(super) plus: Mat<f64>,
    /// Scratch.
    pub(super) product: Mat<f64>,
    /// More scratch.
    pub(super) power: Mat<f64>,
    pub(super) lu: Lu,
}

/// Below this ratio of pivots the condition number is looked at.
const PIVOTS_SAFE: f64 = 1e-3;

impl Quotient {
    pub(super) fn new(n: usize) -> Self {
        let z = || Mat::zeros(n, n);
        Quotient { minus: z(), plus: z(), product: z(), power: z(), lu: Lu::new(n) }
    }

    /// The LU of D(u), for a D(u) that is known to be regular.
    pub(super) fn factor_regular(&mut self) {
        self.lu.a.copy_from(&self.minus);
        self.lu.factor();
    }

    /// The LU of D(u), which `what` names.
    ///
    /// # Errors
    /// [`StepError::NearlySingular`].
    pub(super) fn factor(
        &mut self,
        map: &'static str,
        what: &'static str,
    ) -> Result<(), StepError> {
        self.lu.a.copy_from(&self.minus);
        well_conditioned(&mut self.lu, &self.minus, &mut self.product, map, what)
    }

    /// g ← D(u)⁻¹·D(−u), put back on SO(n) where the solve has lost more than rounding of it.
    pub(super) fn form(
        &mut self,
        (group, u): (&MatrixGroup, &AlgebraMatrix),
        what: &'static str,
        g: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        g.copy_from(&self.plus);
        self.lu.solve(g.as_mut());
        finite(g, what)?;
        if is_put_back(group, u) {
            orthogonalise(g, [&mut self.product, &mut self.power]);
        }
        Ok(())
    }

    /// y ← D(u)⁻¹·D(−u)·x: solves for as many columns as x has, or makes g where that is put back.
    pub(super) fn on(
        &mut self,
        (group, u): (&MatrixGroup, &AlgebraMatrix),
        what: &'static str,
        g: &mut Mat<f64>,
        x: &Mat<f64>,
        y: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        if is_put_back(group, u) {
            self.form((group, u), what, g)?;
            mul(y, g.as_ref(), x.as_ref());
            return Ok(());
        }
        mul(y, self.plus.as_ref(), x.as_ref());
        self.lu.solve(y.as_mut());
        finite(y, what)
    }

    /// v ← D(u)·v·D(−u).
    pub(super) fn conjugate(&mut self, v: &mut Mat<f64>) {
        mul(&mut self.product, self.minus.as_ref(), v.as_ref());
        mul(v, self.product.as_ref(), self.plus.as_ref());
    }
}

/// Above this norm of a skew u a solve loses more than rounding of SO(n): the quotient is put back.
const NORM_EXACT_SKEW: f64 = 4.0;

/// Is the quotient of u put back on SO(n)?
fn is_put_back(group: &MatrixGroup, u: &AlgebraMatrix) -> bool {
    matches!(group.form(), Form::Identity) && norm_frobenius(u) > NORM_EXACT_SKEW
}

/// Is every entry finite?
pub(super) fn finite(x: &Mat<f64>, what: &'static str) -> Result<(), StepError> {
    if is_finite(x) { Ok(()) } else { Err(StepError::NotFinite { what }) }
}

/// Factor `lu.a`, a copy of `a`, and refuse it when its reciprocal condition number is below
/// [`RCOND_MIN`]. `scratch` is for the inverse, which is formed only where the pivots are suspicious.
pub(super) fn well_conditioned(
    lu: &mut Lu,
    a: &Mat<f64>,
    scratch: &mut Mat<f64>,
    map: &'static str,
    what: &'static str,
) -> Result<(), StepError> {
    let pivots = lu.factor();
    if pivots > PIVOTS_SAFE {
        return Ok(());
    }
    let mut rcond = 0.0;
    if pivots > 0.0 {
        scratch.fill(0.0);
        scratch.diagonal_mut().fill(1.0);
        lu.solve(scratch.as_mut());
        rcond = 1.0 / (norm1(a.as_ref()) * norm1(scratch.as_ref()));
    }
    match rcond >= RCOND_MIN {
        true => Ok(()),
        false => {
            let rcond = if rcond.is_nan() { 0.0 } else { rcond };
            Err(StepError::NearlySingular { map, what, rcond })
        }
    }
}
