//! Conjugation on n×n matrices: Λ(g, p) = g p g⁻¹, which conserves the eigenvalues of p.
//!
//! M is the set of all matrices that are similar to one matrix. With G = SO(n) and p symmetric, Λ(g, p) = g p gᵀ is
//! symmetric, too.

use faer::Mat;

use super::Action;
use crate::dense::{Lu, congruence, mul, mul_add, skew_commutator};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup};

/// Λ(g, p) = g p g⁻¹: isospectral flows, ṗ = \[f(p), p\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Conjugation;

/// Scratch of conjugation.
#[derive(Debug)]
pub struct ConjugationWork {
    product: Mat<f64>,
    /// Solves q g = product by its transpose; not needed on SO(n).
    lu: Option<Lu>,
}

impl Action<MatrixGroup> for Conjugation {
    type Point = Mat<f64>;
    type Work = ConjugationWork;

    fn work(&self, group: &MatrixGroup) -> ConjugationWork {
        let n = group.n();
        let lu = (!matches!(group.form(), Form::Identity)).then(|| Lu::new(n));
        ConjugationWork { product: Mat::zeros(n, n), lu }
    }
    fn check(&self, group: &MatrixGroup, p: &Mat<f64>) -> Result<(), Error> {
        group.rows_fit("y", p, group.n())
    }
    fn assign(&self, _: &MatrixGroup, p: &Mat<f64>, q: &mut Mat<f64>) {
        q.copy_from(p);
    }
    fn act(
        &self,
        _: &MatrixGroup,
        g: &GroupMatrix,
        p: &Mat<f64>,
        q: &mut Mat<f64>,
        ConjugationWork { product, lu }: &mut ConjugationWork,
    ) {
        let Some(lu) = lu else { return congruence(q, g, p, product) };
        mul(product, g.as_ref(), p.as_ref());
        // gᵀ qᵀ = (g p)ᵀ.
        lu.a.copy_from(g.transpose());
        lu.factor();
        q.copy_from(product.transpose());
        lu.solve(q.as_mut());
        for j in 0..q.ncols() {
            for i in 0..j {
                let swapped = q[(i, j)];
                q[(i, j)] = q[(j, i)];
                q[(j, i)] = swapped;
            }
        }
    }
    /// v p − p v.
    fn generate(
        &self,
        group: &MatrixGroup,
        v: &AlgebraMatrix,
        p: &Mat<f64>,
        dp: &mut Mat<f64>,
        _: &mut ConjugationWork,
    ) {
        if matches!(group.form(), Form::Identity) {
            return skew_commutator(dp, v, p);
        }
        mul(dp, v.as_ref(), p.as_ref());
        mul_add(dp, -1.0, p.as_ref(), v.as_ref());
    }
}
