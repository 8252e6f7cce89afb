//! Ad, ad and their duals on G_M, where an n×n matrix m stands for the functional v ↦ tr(mᵀv).

use faer::Mat;

use super::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup};
use crate::dense::{Lu, antisymmetrise, is_finite, mul, mul_add};
use crate::error::StepError;
use crate::groups::{Adjoint, LieGroup};
use crate::scalar::{Ops, tally};
use crate::space::LinearSpace;

/// Scratch for the inverse: M⁻¹gᵀ on G_M, the factors of g on GL(n) and where M is stretched.
#[derive(Debug)]
pub struct InvertingWork {
    product: Mat<f64>,
    lu: Option<Lu>,
}

/// [`big_ad`](Adjoint::big_ad) and [`coad_group`](Adjoint::coad_group) allocate. Cost: two products and the inverse,
/// which is free on SO(n) and Sp(2m), two products on G_M, and an LU on GL(n). Where ‖M‖‖M⁻¹‖ is above 10 n it is an LU on
/// G_M, too: there M⁻¹gᵀM would lose digits.
impl Adjoint for MatrixGroup {
    type Dual = Mat<f64>;
    type Inverting = InvertingWork;

    fn inverting(&self) -> InvertingWork {
        let n = self.n();
        let lu = self.inverts_by_factors().then(|| Lu::new(n));
        InvertingWork { product: Mat::zeros(n, n), lu }
    }

    fn invert(
        &self,
        g: &GroupMatrix,
        InvertingWork { product, lu }: &mut InvertingWork,
        out: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        self.fits("g", g)?;
        match self.form() {
            Form::Identity => out.copy_from(g.transpose()),
            // −JgᵀJ: blocks \[a b; c d\] become \[dᵀ −bᵀ; −cᵀ aᵀ\].
            Form::Symplectic => {
                let m = self.n() / 2;
                for j in 0..m {
                    for i in 0..m {
                        out[(i, j)] = g[(j + m, i + m)];
                        out[(i, j + m)] = -g[(j, i + m)];
                        out[(i + m, j)] = -g[(j + m, i)];
                        out[(i + m, j + m)] = g[(j, i)];
                    }
                }
            }
            Form::Bilinear { m, inverse } if !self.is_stretched() => {
                mul(product, inverse.as_ref(), g.transpose());
                mul(out, product.as_ref(), m.as_ref());
            }
            Form::Free | Form::Bilinear { .. } => {
                let lu = lu.get_or_insert_with(|| Lu::new(self.n()));
                lu.a.copy_from(&**g);
                if lu.factor() == 0.0 {
                    out.fill(f64::NAN);
                    return Err(StepError::NotFinite { what: "g⁻¹" });
                }
                out.fill(0.0);
                out.diagonal_mut().fill(1.0);
                lu.solve(out.as_mut());
            }
        }
        if is_finite(out) { Ok(()) } else { Err(StepError::NotFinite { what: "g⁻¹" }) }
    }

    fn tangent_in_body(&self, g: &GroupMatrix, v: &AlgebraMatrix, out: &mut GroupMatrix) {
        mul(out, g.as_ref(), v.as_ref());
    }

    fn big_ad(
        &self,
        g: &GroupMatrix,
        u: &AlgebraMatrix,
        out: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        self.fits("u", u)?;
        let (mut inverse, mut product) = (self.identity(), Mat::zeros(self.n(), self.n()));
        self.inverse(g, &mut inverse)?;
        mul(&mut product, g.as_ref(), u.as_ref());
        mul(out, product.as_ref(), inverse.as_ref());
        if matches!(self.form(), Form::Identity) {
            // Skew to rounding; skew exactly.
            antisymmetrise(out);
            tally(|| Ops::muls(self.n() * self.n()));
            **out *= faer::Scale(0.5);
        }
        finite(out)
    }

    fn coad_group(
        &self,
        g: &GroupMatrix,
        m: &Mat<f64>,
        out: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        self.fits("m", m)?;
        let (mut inverse, mut product) = (self.identity(), Mat::zeros(self.n(), self.n()));
        self.inverse(g, &mut inverse)?;
        mul(&mut product, g.transpose(), m.as_ref());
        mul(out, product.as_ref(), inverse.transpose());
        finite(out)
    }

    fn coad(&self, u: &AlgebraMatrix, m: &Mat<f64>, out: &mut Mat<f64>) {
        mul(out, u.transpose(), m.as_ref());
        mul_add(out, -1.0, m.as_ref(), u.transpose());
    }

    fn pair(&self, m: &Mat<f64>, v: &AlgebraMatrix) -> f64 {
        m.dot(v)
    }
}

impl MatrixGroup {
    /// True if inverses are by the LU of g, and not by the form.
    pub(crate) fn inverts_by_factors(&self) -> bool {
        matches!(self.form(), Form::Free) || self.is_stretched()
    }
}

fn finite(x: &Mat<f64>) -> Result<(), StepError> {
    if is_finite(x) { Ok(()) } else { Err(StepError::NotFinite { what: "Ad" }) }
}
