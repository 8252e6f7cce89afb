//! The Cayley map of n×n matrices.

use faer::Mat;

use super::{Cay, CayleyGroup};
use crate::dense::{Lu, norm_frobenius, scaled_sum};
use crate::error::{Error, RCOND_MIN, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup};
use crate::maps::CoordinateMap;
use crate::maps::quotient::{Quotient, finite, well_conditioned};

/// The values that cay stores at u ∈ 𝔤 ⊂ gl(n): 𝟙 ± u/2, and the LU of 𝟙 − u/2.
#[derive(Debug)]
pub struct CayAt {
    quotient: Quotient,
}

impl CayAt {
    /// 𝟙 ± u/2, and the LU of 𝟙 − u/2.
    fn prepare(&mut self, group: &MatrixGroup, u: &AlgebraMatrix) -> Result<(), StepError> {
        group.operand("u in cay(u)", u)?;
        let quotient = &mut self.quotient;
        scaled_sum(&mut quotient.minus, [-0.5], [u], 1.0);
        scaled_sum(&mut quotient.plus, [0.5], [u], 1.0);
        if matches!(group.form(), Form::Identity) {
            // The eigenvalues of 𝟙 − u/2 are 1 − iα/2: never zero, however large u. Beyond 1/ε the
            // 1 is lost next to u, and with it the axis.
            if norm_frobenius(u) > NORM_MAX_SKEW {
                return Err(StepError::NormTooLarge { map: "cay" });
            }
            quotient.factor_regular();
            return Ok(());
        }
        quotient.factor("cay", "𝟙 − u/2")
    }
}

/// Above this norm of a skew u no digit of cay(u) has a meaning in the dense arithmetic.
const NORM_MAX_SKEW: f64 = 1e15;

/// The trace of u on SL(n), relative to ‖u‖, that counts as rounding. For n > 2 most g are no cay(u) of a u ∈ sl(n).
const OFF_TRACE: f64 = 1e-10;

impl CoordinateMap<MatrixGroup> for Cay {
    type At = CayAt;

    fn name(&self) -> &'static str {
        "cay"
    }
    fn at(&self, group: &MatrixGroup) -> Result<CayAt, Error> {
        Ok(CayAt { quotient: Quotient::new(group.n()) })
    }
    fn psi(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CayAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        at.quotient.form((group, u), "cay(u)", g)
    }
    fn psi_on(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CayAt,
        g: &mut GroupMatrix,
        x: &Mat<f64>,
        y: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        at.quotient.on((group, u), "cay(u)·x", g, x, y)
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        _: &AlgebraMatrix,
        at: &mut CayAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        at.quotient.conjugate(v);
        finite(v, "dcay⁻¹")
    }
}

impl CayleyGroup for MatrixGroup {
    fn cay_inv(&self, g: &GroupMatrix) -> Result<AlgebraMatrix, Error> {
        let n = self.n();
        self.shape("g", g.as_ref())?;
        let plus = g.as_ref() + Mat::<f64>::identity(n, n);
        let rcond = Lu::rcond(plus.as_ref());
        if rcond < RCOND_MIN {
            return Err(Error::Singular { arg: "g + 𝟙", rcond, minimum: RCOND_MIN });
        }
        // (g − 𝟙)(g + 𝟙)⁻¹ = (g + 𝟙)⁻¹(g − 𝟙)
        let mut u = g.as_ref() - Mat::<f64>::identity(n, n);
        let mut lu = Lu::new(n);
        lu.a.copy_from(&plus);
        lu.factor();
        lu.solve(u.as_mut());
        for x in u.col_iter_mut() {
            x.iter_mut().for_each(|x| *x *= 2.0);
        }
        match self.form() {
            Form::Free if self.is_special() => {
                let trace: f64 = (0..n).map(|i| u[(i, i)]).sum();
                let size = norm_frobenius(&u);
                // Near 𝟙 the trace is the rounding of g.
                let rounding = 8.0 * n as f64 * f64::EPSILON;
                match trace.abs() <= OFF_TRACE * size + rounding {
                    true => Ok(self.project_algebra(u.as_ref())),
                    false => Err(Error::Trace {
                        arg: "cay⁻¹(g)",
                        group: self.name(),
                        distance: trace.abs(),
                    }),
                }
            }
            Form::Free => Ok(AlgebraMatrix::new_unchecked(u)),
            _ => Ok(self.project_algebra(u.as_ref())),
        }
    }

    fn dcay(&self, u: &AlgebraMatrix, v: &AlgebraMatrix) -> Result<AlgebraMatrix, Error> {
        self.shape("u", u.as_ref())?;
        self.shape("v", v.as_ref())?;
        let (mut at, mut w) = (Cay.at(self)?, v.clone());
        at.prepare(self, u)?;
        let Quotient { plus, product, lu, .. } = &mut at.quotient;
        lu.solve(w.as_mut());
        // w ← w (𝟙 + u/2)⁻¹ by the transposed system.
        let mut transposed = w.transpose().to_owned();
        lu.a.copy_from(plus.transpose());
        well_conditioned(lu, plus, product, "cay", "𝟙 + u/2")?;
        lu.solve(transposed.as_mut());
        w.copy_from(transposed.transpose());
        finite(&w, "dcay(u, v)")?;
        Ok(w)
    }
}
