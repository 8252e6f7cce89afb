//! exp in `f32`.

use faer::Mat;

use super::{ExpmChoice, Exponential, Structure};
use crate::error::StepError;

/// exp of n×n matrices of `f32`.
///
/// It computes in `f64`. So the result is exp(u) rounded to `f32`, if the condition number of exp at u is below 1e8.
/// Arithmetic in `f32` would never be so accurate. Up to n = 16 this costs almost nothing; for large n a product in
/// `f64` takes twice as long as in `f32`.
#[derive(Debug)]
pub struct ExponentialF32 {
    wide: Exponential,
    u: Mat<f64>,
    g: Mat<f64>,
}

impl ExponentialF32 {
    /// Makes the workspace for n×n matrices. Nothing allocates after this.
    pub fn new(n: usize) -> Self {
        let z = || Mat::zeros(n, n);
        ExponentialF32 { wide: Exponential::new(n), u: z(), g: z() }
    }

    /// out ← exp(u), and which approximant was taken.
    ///
    /// # Errors
    /// As [`Exponential::exp`]; [`StepError::NotFinite`] also if exp(u) overflows `f32`.
    pub fn exp(
        &mut self,
        u: &Mat<f32>,
        structure: Structure,
        out: &mut Mat<f32>,
    ) -> Result<ExpmChoice, StepError> {
        let n = self.u.nrows();
        StepError::check_shape("u", u.shape(), (n, n))?;
        StepError::check_shape("out", out.shape(), (n, n))?;
        for j in 0..n {
            for (to, from) in self.u.col_as_slice_mut(j).iter_mut().zip(u.col_as_slice(j)) {
                *to = f64::from(*from);
            }
        }
        let choice = self.wide.exp(&self.u, structure, &mut self.g)?;
        let mut finite = true;
        for j in 0..n {
            for (to, from) in out.col_as_slice_mut(j).iter_mut().zip(self.g.col_as_slice(j)) {
                *to = *from as f32;
                finite &= to.is_finite();
            }
        }
        if finite { Ok(choice) } else { Err(StepError::NotFinite { what: "exp(u)" }) }
    }
}
