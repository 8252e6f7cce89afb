//! Conjugation Λ(g, p) = g p g† of U(n), which is also the coadjoint action.
//!
//! The reason is that u(n)* is u(n) by ⟨m, v⟩ = Re tr(m†v).

use super::conjugation::{keep_length, keep_trace};
use super::{Action, Coadjoint, Conjugation};
use crate::error::Error;
use crate::groups::{ComplexMatrix, LieAlgebra, Unitary, mul_adjoint_skew, mul_complex};

/// Λ(g, p) = g p g† on the skew-Hermitian matrices. It conserves the eigenvalues of p.
impl Action<Unitary> for Conjugation {
    type Point = ComplexMatrix;
    /// g p.
    type Work = ComplexMatrix;

    fn work(&self, group: &Unitary) -> ComplexMatrix {
        group.zero()
    }
    fn check(&self, group: &Unitary, p: &ComplexMatrix) -> Result<(), Error> {
        p.check("y", group.n(), group.n())?;
        group.check("y", p)
    }
    #[inline]
    fn is_finite(&self, group: &Unitary, p: &ComplexMatrix) -> bool {
        group.is_finite(p)
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
    /// The Frobenius norm and the trace of p are constant.
    fn restore_to(
        &self,
        _: &Unitary,
        from: &ComplexMatrix,
        p: &mut ComplexMatrix,
        _: &mut ComplexMatrix,
    ) -> Option<f64> {
        keep_trace(&from.im, &mut p.im);
        Some(keep_length(from.parts(), p.parts_mut()))
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
    fn restore_to(
        &self,
        group: &Unitary,
        from: &ComplexMatrix,
        m: &mut ComplexMatrix,
        work: &mut ComplexMatrix,
    ) -> Option<f64> {
        Conjugation.restore_to(group, from, m, work)
    }
}
