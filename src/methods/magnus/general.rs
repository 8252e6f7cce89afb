//! Triple products of n×n matrices, real and complex.

use super::TripleProduct;
use crate::dense::{antisymmetrise, mul, mul_add};
use crate::groups::{
    AlgebraMatrix, ComplexMatrix, Form, MatrixGroup, Unitary, minus_adjoint, mul_complex,
};

/// Two products on so(n), where (uvw)ᵀ = −wvu; four elsewhere.
impl TripleProduct for MatrixGroup {
    fn triple(
        &self,
        u: &AlgebraMatrix,
        v: &AlgebraMatrix,
        w: &AlgebraMatrix,
        work: &mut AlgebraMatrix,
        out: &mut AlgebraMatrix,
    ) {
        mul(work, u.as_ref(), v.as_ref());
        mul(out, work.as_ref(), w.as_ref());
        match self.form() {
            Form::Identity => antisymmetrise(out),
            _ => {
                mul(work, w.as_ref(), v.as_ref());
                mul_add(out, 1.0, work.as_ref(), u.as_ref());
            }
        }
    }
}

/// Two products: (uvw)† = −wvu.
impl TripleProduct for Unitary {
    fn triple(
        &self,
        u: &ComplexMatrix,
        v: &ComplexMatrix,
        w: &ComplexMatrix,
        work: &mut ComplexMatrix,
        out: &mut ComplexMatrix,
    ) {
        mul_complex(work, u, v);
        mul_complex(out, work, w);
        minus_adjoint(out);
    }
}
