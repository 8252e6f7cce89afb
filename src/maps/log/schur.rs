//! The real Schur form a = q t qᵀ, t quasi-triangular, by nalgebra. The complex one is the dense layer's.

use faer::Mat;
use nalgebra::{DMatrix, DVector, Schur};

use crate::dense::NEGLIGIBLE;
use crate::error::StepError;

/// QR sweeps allowed per row; two or three are usual.
const SWEEPS: usize = 40;
/// Where eigenvalues cluster on the real axis, as at half turns, the shifts of the iteration are
/// rounding; around the cluster they are not.
const CENTRES: [f64; 3] = [0.0, -1.0, 1.0];

/// (t, q) of a matrix of finite numbers.
///
/// The iteration has no exceptional shifts: where it stalls (on a cyclic permutation, say), another
/// centre starts it from another matrix, and another basis from another vector.
fn form(a: &DMatrix<f64>) -> Result<(DMatrix<f64>, DMatrix<f64>), StepError> {
    let n = a.nrows();
    let mut basis = DMatrix::<f64>::identity(n, n);
    for attempt in 0..3 {
        for centre in CENTRES {
            let shift = DMatrix::<f64>::from_diagonal_element(n, n, centre);
            let turned = basis.transpose() * (a - &shift) * &basis;
            if let Some(schur) = Schur::try_new(turned, f64::EPSILON, SWEEPS * n + 100) {
                let (q, t) = schur.unpack();
                return Ok((t + shift, basis * q));
            }
        }
        // A reflection in a vector that no matrix of small integers knows.
        let entry = |i: usize, _| (1.0 + (i * (attempt + 2)) as f64).sqrt().sin();
        let x = DVector::<f64>::from_fn(n, entry);
        let two = 2.0 / x.norm_squared();
        basis = DMatrix::identity(n, n) - (&x * x.transpose()) * two;
    }
    Err(StepError::NotConverged { what: "the Schur form of g" })
}

/// a without what is no matter of its rounding: products of such entries underflow, and the iteration
/// then sees no end.
fn significant(a: &Mat<f64>) -> DMatrix<f64> {
    let negligible = NEGLIGIBLE * a.norm_max();
    DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| match a[(i, j)] {
        x if x.abs() < negligible => 0.0,
        x => x,
    })
}

/// t has 1×1 and 2×2 blocks on its diagonal.
pub(super) fn real(a: &Mat<f64>) -> Result<(Mat<f64>, Mat<f64>), StepError> {
    let n = a.nrows();
    let (t, q) = form(&significant(a))?;
    let mat = |x: DMatrix<f64>| Mat::from_fn(n, n, |i, j| x[(i, j)]);
    Ok((mat(t), mat(q)))
}
