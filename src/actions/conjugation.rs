//! Conjugation on n×n matrices: Λ(g, p) = g p g⁻¹, which conserves the eigenvalues of p.
//!
//! M is the set of all matrices that are similar to one matrix. With G = SO(n) and p symmetric, Λ(g, p) = g p gᵀ is
//! symmetric, too.

use faer::{Mat, Scale};

use super::Action;
use crate::dense::{Lu, congruence, mul, mul_add, skew_commutator, squared_norm};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup, RESIDUAL_MAX};
use crate::so3::in_range;

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
    /// On SO(n) the Frobenius norm of p is constant: p ← p + ½p(‖from‖² − ‖p‖²)/‖from‖², as for vectors. So is the trace.
    fn restore_to(
        &self,
        group: &MatrixGroup,
        from: &Mat<f64>,
        p: &mut Mat<f64>,
        _: &mut ConjugationWork,
    ) -> Option<f64> {
        matches!(group.form(), Form::Identity).then(|| {
            keep_trace(from, p);
            keep_length([from], [p])
        })
    }
}

/// Corrects the trace of p to that of `from`: a multiple of 𝟙 is added.
pub(super) fn keep_trace(from: &Mat<f64>, p: &mut Mat<f64>) {
    let n = p.nrows();
    let missing = (0..n).map(|i| from[(i, i)] - p[(i, i)]).sum::<f64>() / n as f64;
    let size = squared_norm(from.as_ref()).sqrt();
    if missing.abs() < RESIDUAL_MAX * size {
        (0..n).for_each(|i| p[(i, i)] += missing);
    }
}

/// Corrects the length of p to that of `from`, both in parts, and returns the relative error of its square.
pub(super) fn keep_length<const N: usize>(from: [&Mat<f64>; N], p: [&mut Mat<f64>; N]) -> f64 {
    let square = |sum: f64, x: &Mat<f64>| sum + squared_norm(x.as_ref());
    let from2 = from.iter().fold(0.0, |sum, x| square(sum, x));
    if !in_range(from2) {
        return 0.0;
    }
    let missing = (from2 - p.iter().fold(0.0, |sum, x| square(sum, x))) / from2;
    if missing.abs() < RESIDUAL_MAX {
        p.into_iter().for_each(|p| *p *= Scale(1.0 + 0.5 * missing));
    }
    missing.abs()
}
