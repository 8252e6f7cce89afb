//! The Schur form a = q t q*, real (quasi-triangular) or complex (triangular), by nalgebra.

use faer::{Mat, c64};
use nalgebra::{Complex, ComplexField, DMatrix, DVector, Schur};

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
fn form<T: ComplexField<RealField = f64>>(
    a: &DMatrix<T>,
) -> Result<(DMatrix<T>, DMatrix<T>), StepError> {
    let n = a.nrows();
    let mut basis = DMatrix::<T>::identity(n, n);
    for attempt in 0..3 {
        for centre in CENTRES {
            let shift = DMatrix::<T>::from_diagonal_element(n, n, T::from_real(centre));
            let turned = basis.adjoint() * (a - &shift) * &basis;
            if let Some(schur) = Schur::try_new(turned, f64::EPSILON, SWEEPS * n + 100) {
                let (q, t) = schur.unpack();
                return Ok((t + shift, basis * q));
            }
        }
        // A reflection in a vector that no matrix of small integers knows.
        let entry = |i: usize, _| T::from_real((1.0 + (i * (attempt + 2)) as f64).sqrt().sin());
        let x = DVector::<T>::from_fn(n, entry);
        let two = T::from_real(2.0 / x.norm_squared());
        basis = DMatrix::identity(n, n) - (&x * x.adjoint()) * two;
    }
    Err(StepError::NotConverged { what: "the Schur form of g" })
}

/// t has 1×1 and 2×2 blocks on its diagonal.
pub(super) fn real(a: &Mat<f64>) -> Result<(Mat<f64>, Mat<f64>), StepError> {
    let n = a.nrows();
    let (t, q) = form(&DMatrix::from_fn(n, n, |i, j| a[(i, j)]))?;
    let mat = |x: DMatrix<f64>| Mat::from_fn(n, n, |i, j| x[(i, j)]);
    Ok((mat(t), mat(q)))
}

/// t is upper triangular.
pub(super) fn complex(a: &Mat<f64>) -> Result<(Mat<c64>, Mat<c64>), StepError> {
    let n = a.nrows();
    let (t, q) = form(&DMatrix::from_fn(n, n, |i, j| Complex::new(a[(i, j)], 0.0)))?;
    let mat =
        |x: DMatrix<Complex<f64>>| Mat::from_fn(n, n, |i, j| c64::new(x[(i, j)].re, x[(i, j)].im));
    Ok((mat(t), mat(q)))
}
