//! Real logarithms that are not principal: negative eigenvalues that come in pairs.
//!
//! V is the sum of the eigenspaces of negative eigenvalues, P the projector onto it along the rest, and
//! K ∈ 𝔤 a turn of it: K² = −P, Kg = gK. Then g(𝟙 − 2P) has a principal logarithm, and
//!
//! ```text
//!     log g = log(g(𝟙 − 2P)) + πK.
//! ```
//!
//! With X a basis of the eigenspace of λ, Y its dual basis (YX = 𝟙, Y(g − λ) = 0) and J the turn of
//! neighbours, J² = −𝟙:
//!
//! | eigenvalue | K |
//! |---|---|
//! | λ on GL(n) | XJY |
//! | λ and 1/λ ≠ λ on G_M | XJY − M⁻¹(XJY)ᵀM |
//! | −1, M symmetric | XJY with XᵀMX = diag(±1), J between vectors of one sign |
//! | −1, M skew | XJY with J = B(BᵀB)^{−1/2}, B = XᵀMX |
//!
//! An eigenvalue of odd multiplicity has no real logarithm (W. J. Culver, Proc. AMS 17 (1966)).

use core::f64::consts::PI;

use faer::{Mat, c64};
use nalgebra::{DMatrix, SVD, SymmetricEigen};

use super::triangular::Negative;
use crate::dense::{AdForm, AdKind};
use crate::error::NoLogarithm;

/// A basis and its dual whose product is closer to singular than this belong to an eigenvalue that is
/// defective, or that rounding does not tell from one.
const DEFECTIVE: f64 = 1e-7;

/// Iterations of a decomposition; a few a column are usual.
const SWEEPS: usize = 10_000;

type Matrix = DMatrix<f64>;

/// (g(𝟙 − 2P), πK), or the eigenvalue that has no logarithm.
pub(super) fn apart(
    g: &Mat<f64>,
    form: Option<&AdForm>,
    negative: &Negative,
) -> Result<(Mat<f64>, Mat<f64>), (c64, NoLogarithm)> {
    let n = g.nrows();
    let dense = |x: &Mat<f64>| Matrix::from_fn(n, n, |i, j| x[(i, j)]);
    let form = form.map(|form| (form.kind, dense(&form.m), dense(&form.inverse)));
    let together = 16.0 * negative.margin;
    let mut negative = negative.eigenvalues.clone();
    negative.sort_by(|a, b| a.re.total_cmp(&b.re));
    let (mut p, mut k) = (Matrix::zeros(n, n), Matrix::zeros(n, n));
    for cluster in negative.chunk_by(|a, b| b.re - a.re <= together) {
        let (mean, count) = (cluster.iter().sum::<c64>() / cluster.len() as f64, cluster.len());
        if count % 2 == 1 {
            return Err((mean, NoLogarithm::Odd));
        }
        let refused = |why| (mean, why);
        let undecided = || refused(NoLogarithm::Undecided);
        let (x, y) = eigenspace(g, mean.re, count, together).ok_or_else(undecided)?;
        match &form {
            None => {
                p += &x * &y;
                k += &x * neighbours(count) * &y;
            }
            Some((kind, m, _)) if (mean.re + 1.0).abs() <= together => {
                let (x, y, turn) = match kind {
                    AdKind::Skew => with_signature(x, m).map_err(refused)?,
                    _ => with_area(x, m).ok_or_else(undecided)?,
                };
                p += &x * &y;
                k += x * turn * y;
            }
            // 1/λ comes with λ.
            Some(_) if mean.re > -1.0 => {}
            Some((_, m, inverse)) => {
                let (one, turned) = (&x * &y, &x * neighbours(count) * &y);
                p += &one + inverse * one.transpose() * m;
                k += &turned - inverse * turned.transpose() * m;
            }
        }
    }
    let faer = |x: Matrix| Mat::from_fn(n, n, |i, j| x[(i, j)]);
    Ok((faer(dense(g) * (Matrix::identity(n, n) - p * 2.0)), faer(k * PI)))
}

/// X with gX = λX and Y with Yg = λY, YX = 𝟙, where λ has `count` eigenvectors: the singular vectors of
/// g − λ that it takes to zero.
fn eigenspace(g: &Mat<f64>, lambda: f64, count: usize, zero: f64) -> Option<(Matrix, Matrix)> {
    let n = g.nrows();
    let shifted = Mat::from_fn(n, n, |i, j| g[(i, j)] - if i == j { lambda } else { 0.0 });
    let svd = shifted.svd().ok()?;
    let first = n - count;
    if svd.S()[first].is_nan() || svd.S()[first] > zero {
        return None;
    }
    let x = Matrix::from_fn(n, count, |i, j| svd.V()[(i, first + j)]);
    let left = Matrix::from_fn(count, n, |i, j| svd.U()[(j, first + i)]);
    let both = &left * &x;
    let smallest = SVD::try_new(both.clone(), false, false, f64::EPSILON, SWEEPS)?;
    let smallest = smallest.singular_values.min();
    let inverse = (smallest > DEFECTIVE).then(|| both.try_inverse())??;
    Some((x, inverse * left))
}

/// J: the turn from the first to the second, from the third to the fourth, ….
fn neighbours(count: usize) -> Matrix {
    Matrix::from_fn(count, count, |i, j| match (i, j) {
        _ if i == j + 1 && j % 2 == 0 => 1.0,
        _ if j == i + 1 && i % 2 == 0 => -1.0,
        _ => 0.0,
    })
}

/// X with XᵀMX = diag(−1, …, 1), its dual and J. With an odd number of either sign no turn keeps M.
fn with_signature(x: Matrix, m: &Matrix) -> Result<(Matrix, Matrix, Matrix), NoLogarithm> {
    let count = x.ncols();
    let eigen = SymmetricEigen::try_new(x.transpose() * m * &x, f64::EPSILON, SWEEPS)
        .ok_or(NoLogarithm::Undecided)?;
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    if order.iter().filter(|&&i| eigen.eigenvalues[i] < 0.0).count() % 2 == 1 {
        return Err(NoLogarithm::Outside);
    }
    let mut x = x * eigen.eigenvectors.select_columns(&order);
    let mut y = x.transpose() * m;
    for (i, &from) in order.iter().enumerate() {
        let value = eigen.eigenvalues[from];
        x.column_mut(i).scale_mut(1.0 / value.abs().sqrt());
        y.row_mut(i).scale_mut(value.signum() / value.abs().sqrt());
    }
    Ok((x, y, neighbours(count)))
}

/// X as it is, its dual by the area XᵀMX, and J with JᵀXᵀMXJ = XᵀMX.
fn with_area(x: Matrix, m: &Matrix) -> Option<(Matrix, Matrix, Matrix)> {
    let area = x.transpose() * m * &x;
    let eigen = SymmetricEigen::try_new(area.transpose() * &area, f64::EPSILON, SWEEPS)?;
    let lengths = eigen.eigenvalues.map(|square| 1.0 / square.sqrt());
    let q = &eigen.eigenvectors;
    let turn = &area * (q * Matrix::from_diagonal(&lengths) * q.transpose());
    let y = area.try_inverse()? * x.transpose() * m;
    Some((x, y, turn))
}
