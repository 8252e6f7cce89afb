//! The coadjoint action of n×n matrices.

use faer::Mat;

use super::Coadjoint;
use crate::actions::Action;
use crate::actions::conjugation::keep_length;
use crate::dense::{Lu, congruence, mul, mul_add, skew_commutator};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup};

/// Scratch of the coadjoint action on n×n matrices.
#[derive(Debug)]
pub struct CoadjointWork {
    left: Mat<f64>,
    product: Mat<f64>,
    lu: Option<Lu>,
}

impl Action<MatrixGroup> for Coadjoint {
    type Point = Mat<f64>;
    type Work = CoadjointWork;

    fn work(&self, group: &MatrixGroup) -> CoadjointWork {
        let n = group.n();
        let lu = group.inverts_by_factors().then(|| Lu::new(n));
        CoadjointWork { left: Mat::zeros(n, n), product: Mat::zeros(n, n), lu }
    }
    fn check(&self, group: &MatrixGroup, p: &Mat<f64>) -> Result<(), Error> {
        group.rows_fit("y", p, group.n())
    }
    fn act(
        &self,
        group: &MatrixGroup,
        g: &GroupMatrix,
        p: &Mat<f64>,
        q: &mut Mat<f64>,
        work: &mut CoadjointWork,
    ) {
        let CoadjointWork { left, product, lu } = work;
        match (group.form(), lu) {
            (_, Some(lu)) => {
                lu.a.copy_from(g.transpose());
                lu.factor();
                product.copy_from(p);
                lu.solve(product.as_mut());
            }
            (Form::Bilinear { m, inverse }, _) => {
                mul(product, m.as_ref(), g.as_ref());
                mul(left, product.as_ref(), inverse.as_ref());
                mul(product, left.as_ref(), p.as_ref());
            }
            (Form::Symplectic, _) => {
                conjugate_by_j(g, left);
                mul(product, left.as_ref(), p.as_ref());
            }
            _ => return congruence(q, g, p, product),
        }
        mul(q, product.as_ref(), g.transpose());
    }
    fn generate(
        &self,
        group: &MatrixGroup,
        v: &AlgebraMatrix,
        m: &Mat<f64>,
        dm: &mut Mat<f64>,
        _: &mut CoadjointWork,
    ) {
        if matches!(group.form(), Form::Identity) {
            return skew_commutator(dm, v, m);
        }
        mul(dm, m.as_ref(), v.transpose());
        mul_add(dm, -1.0, v.transpose(), m.as_ref());
    }
    /// On SO(n) the Frobenius norm of m is constant, as for [`Conjugation`](crate::actions::Conjugation).
    fn restore_to(
        &self,
        group: &MatrixGroup,
        from: &Mat<f64>,
        m: &mut Mat<f64>,
        _: &mut CoadjointWork,
    ) -> Option<f64> {
        matches!(group.form(), Form::Identity).then(|| keep_length([from], [m]))
    }
}

/// out ← J g J⁻¹: blocks \[a b; c d\] become \[d −c; −b a\].
fn conjugate_by_j(g: &Mat<f64>, out: &mut Mat<f64>) {
    let m = g.nrows() / 2;
    for j in 0..m {
        for i in 0..m {
            out[(i, j)] = g[(i + m, j + m)];
            out[(i, j + m)] = -g[(i + m, j)];
            out[(i + m, j)] = -g[(i, j + m)];
            out[(i + m, j + m)] = g[(i, j)];
        }
    }
}
