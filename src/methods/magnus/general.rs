//! Triple products of n×n matrices, real and complex.

use super::TripleProduct;
use crate::dense::{antisymmetrise, mul, mul_add};
use crate::groups::{AlgebraMatrix, ComplexMatrix, Form, MatrixGroup, Unitary, mul_complex};
use crate::scalar::{Ops, tally};

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
        antisymmetrise(&mut out.re);
        tally(|| Ops::adds(self.n() * (self.n() + 1) / 2));
        for j in 0..self.n() {
            for i in 0..=j {
                let sum = out.im[(i, j)] + out.im[(j, i)];
                (out.im[(i, j)], out.im[(j, i)]) = (sum, sum);
            }
        }
    }
}
