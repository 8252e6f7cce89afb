//! Ad, ad and their duals on U(n), where u(n)* is u(n) by ⟨m, v⟩ = Re tr(m†v).
//!
//! | | |
//! |---|---|
//! | Ad_g u | g u g† |
//! | Ad*_g m | g† m g |
//! | ad*_u m | \[m, u\] |

use super::Unitary;
use super::matrix::{ComplexMatrix, adjoint_mul_complex, mul_adjoint_skew, mul_complex, mul_skew};
use crate::error::StepError;
use crate::groups::{Adjoint, LieAlgebra};
use crate::space::LinearSpace;

fn finite(x: &ComplexMatrix) -> Result<(), StepError> {
    if x.is_finite() { Ok(()) } else { Err(StepError::NotFinite { what: "Ad" }) }
}

/// [`big_ad`](Adjoint::big_ad) and [`coad_group`](Adjoint::coad_group) allocate. Cost: a full product
/// and a half one.
impl Adjoint for Unitary {
    /// m ∈ u(n)*, skew-Hermitian.
    type Dual = ComplexMatrix;
    type Inverting = ();

    fn inverting(&self) {}
    fn invert(
        &self,
        g: &ComplexMatrix,
        (): &mut (),
        out: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        self.fits("g", g)?;
        out.re.copy_from(g.re.transpose());
        out.im.copy_from(g.im.transpose());
        out.im.col_iter_mut().for_each(|col| col.iter_mut().for_each(|x| *x = -*x));
        finite(out)
    }
    fn tangent_in_body(&self, g: &ComplexMatrix, v: &ComplexMatrix, out: &mut ComplexMatrix) {
        mul_complex(out, g, v);
    }
    fn big_ad(
        &self,
        g: &ComplexMatrix,
        u: &ComplexMatrix,
        out: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        self.fits("g", g)?;
        self.fits("u", u)?;
        let mut product = self.zero();
        mul_complex(&mut product, g, u);
        mul_adjoint_skew(out, &product, g);
        finite(out)
    }
    fn coad_group(
        &self,
        g: &ComplexMatrix,
        m: &ComplexMatrix,
        out: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        self.fits("g", g)?;
        self.fits("m", m)?;
        let mut product = self.zero();
        adjoint_mul_complex(&mut product, g, m);
        mul_skew(out, &product, g);
        finite(out)
    }
    fn coad(&self, u: &ComplexMatrix, m: &ComplexMatrix, out: &mut ComplexMatrix) {
        self.bracket(m, u, out);
    }
    fn pair(&self, m: &ComplexMatrix, v: &ComplexMatrix) -> f64 {
        m.dot(v)
    }
}
