//! Ad, ad and their duals on U(n), where u(n)* is u(n) by ⟨m, v⟩ = Re tr(m†v).
//!
//! | | |
//! |---|---|
//! | Ad_g u | g u g† |
//! | Ad*_g m | g† m g |
//! | ad*_u m | \[m, u\] |
//! | Λ(g, p) | g p g†, conjugation and the coadjoint action at once |

use super::Unitary;
use super::matrix::{ComplexMatrix, adjoint_mul_complex, mul_adjoint_skew, mul_complex, mul_skew};
use crate::actions::{Action, Coadjoint, Conjugation};
use crate::error::{Error, StepError};
use crate::groups::{Adjoint, LieAlgebra};
use crate::space::{LinearSpace, Metric};

fn finite(x: &ComplexMatrix) -> Result<(), StepError> {
    if x.is_finite() { Ok(()) } else { Err(StepError::NotFinite { what: "Ad" }) }
}

/// [`big_ad`](Adjoint::big_ad) and [`coad_group`](Adjoint::coad_group) allocate. Cost: two products,
/// one of them by halves.
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
        Conjugation.act(self, g, u, out, &mut self.zero());
        finite(out)
    }
    fn coad_group(
        &self,
        g: &ComplexMatrix,
        m: &ComplexMatrix,
        out: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
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

/// Λ(g, p) = g p g† on the skew-Hermitian matrices. The eigenvalues of p are kept.
impl Action<Unitary> for Conjugation {
    type Point = ComplexMatrix;
    /// g p.
    type Work = ComplexMatrix;

    fn work(&self, group: &Unitary) -> ComplexMatrix {
        group.zero()
    }
    fn check(&self, group: &Unitary, p: &ComplexMatrix) -> Result<(), Error> {
        group.check("p", p)
    }
    #[inline]
    fn is_finite(&self, group: &Unitary, p: &ComplexMatrix) -> bool {
        group.is_finite(p)
    }
    fn assign(&self, _: &Unitary, p: &ComplexMatrix, q: &mut ComplexMatrix) {
        q.assign(p);
    }
    fn act(
        &self,
        _: &Unitary,
        g: &ComplexMatrix,
        p: &ComplexMatrix,
        q: &mut ComplexMatrix,
        product: &mut ComplexMatrix,
    ) {
        mul_complex(product, g, p);
        mul_adjoint_skew(q, product, g);
    }
    /// \[v, p\].
    fn generate(
        &self,
        group: &Unitary,
        v: &ComplexMatrix,
        p: &ComplexMatrix,
        dp: &mut ComplexMatrix,
        _: &mut ComplexMatrix,
    ) {
        group.bracket(v, p, dp);
    }
}

/// Ad*_{g⁻¹} m = g m g†: conjugation.
impl Action<Unitary> for Coadjoint {
    type Point = ComplexMatrix;
    type Work = ComplexMatrix;

    fn work(&self, group: &Unitary) -> ComplexMatrix {
        group.zero()
    }
    fn check(&self, group: &Unitary, m: &ComplexMatrix) -> Result<(), Error> {
        Conjugation.check(group, m)
    }
    #[inline]
    fn is_finite(&self, group: &Unitary, m: &ComplexMatrix) -> bool {
        group.is_finite(m)
    }
    fn assign(&self, group: &Unitary, m: &ComplexMatrix, q: &mut ComplexMatrix) {
        Conjugation.assign(group, m, q);
    }
    fn act(
        &self,
        group: &Unitary,
        g: &ComplexMatrix,
        m: &ComplexMatrix,
        q: &mut ComplexMatrix,
        product: &mut ComplexMatrix,
    ) {
        Conjugation.act(group, g, m, q, product);
    }
    fn generate(
        &self,
        group: &Unitary,
        v: &ComplexMatrix,
        m: &ComplexMatrix,
        dm: &mut ComplexMatrix,
        work: &mut ComplexMatrix,
    ) {
        Conjugation.generate(group, v, m, dm, work);
    }
}
