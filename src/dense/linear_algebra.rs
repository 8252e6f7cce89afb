//! Linear algebra on single matrices, outside of a step. Each function allocates its result.
//!
//! The functions are those of faer. faer's functions are generic, so every crate that calls them compiles them again,
//! for each instruction set. These are compiled once. They are for the crates of this workspace, and not part of the
//! interface: matrices whose shapes do not fit are a defect of the caller.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, MatRef, Side, c64};

use crate::error::StepError;

/// a b. Cost: O(n³).
pub fn multiply(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    a * b
}

/// The Frobenius norm √Σ x_ij², without overflow.
pub fn norm(x: MatRef<'_, f64>) -> f64 {
    x.norm_l2()
}

/// Σ x_ij².
pub fn squared_norm(x: MatRef<'_, f64>) -> f64 {
    x.squared_norm_l2()
}

/// max |x_ij|; NaN if an entry is NaN.
pub fn largest_entry(x: MatRef<'_, f64>) -> f64 {
    // faer's largest entry is that of the others where one is NaN.
    let has_nan = x.col_iter().any(|column| column.iter().any(|x| x.is_nan()));
    if has_nan { f64::NAN } else { x.norm_max() }
}

/// det a of a square matrix. Cost: O(n³).
pub fn determinant(a: MatRef<'_, f64>) -> f64 {
    a.determinant()
}

/// a⁻¹ of a square matrix; with entries that are not finite if a is singular. Cost: O(n³).
pub fn inverse(a: MatRef<'_, f64>) -> Mat<f64> {
    a.partial_piv_lu().inverse()
}

/// Q and R of a = QR, where Q has orthonormal columns and R is upper triangular, for a with at least as many rows as
/// columns. Cost: O(mn²).
pub fn qr(a: MatRef<'_, f64>) -> (Mat<f64>, Mat<f64>) {
    let qr = a.qr();
    (qr.compute_thin_Q(), qr.thin_R().to_owned())
}

/// The singular values in descending order. Cost: O(n³).
///
/// # Errors
/// [`StepError::NotConverged`].
pub fn singular_values(a: MatRef<'_, f64>) -> Result<Vec<f64>, StepError> {
    let failed = |_| StepError::NotConverged { what: "the singular values" };
    a.singular_values().map_err(failed)
}

/// Why the eigenvalues of a symmetric or Hermitian matrix were not found.
const NO_EIGENVALUES: StepError =
    StepError::NotConverged { what: "the eigenvalues of a symmetric matrix" };

/// The eigenvalues of a symmetric matrix in ascending order, from its lower triangle. Cost: O(n³).
///
/// # Errors
/// [`StepError::NotConverged`].
pub fn symmetric_eigenvalues(a: MatRef<'_, f64>) -> Result<Vec<f64>, StepError> {
    a.self_adjoint_eigenvalues(Side::Lower).map_err(|_| NO_EIGENVALUES)
}

/// The eigenvalues of a symmetric matrix in ascending order and its eigenvectors, the columns of an orthogonal matrix.
/// Only the lower triangle is read. Cost: O(n³).
///
/// # Errors
/// [`StepError::NotConverged`].
pub fn symmetric_eigen(a: MatRef<'_, f64>) -> Result<(Vec<f64>, Mat<f64>), StepError> {
    let eigen = a.self_adjoint_eigen(Side::Lower).map_err(|_| NO_EIGENVALUES)?;
    Ok((eigen.S().column_vector().iter().copied().collect(), eigen.U().to_owned()))
}

/// The eigenvalues of a Hermitian matrix in ascending order, from its lower triangle. Cost: O(n³).
///
/// # Errors
/// [`StepError::NotConverged`].
pub fn hermitian_eigenvalues(a: MatRef<'_, c64>) -> Result<Vec<f64>, StepError> {
    a.self_adjoint_eigenvalues(Side::Lower).map_err(|_| NO_EIGENVALUES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_entry_is_nan_where_one_is() {
        let finite = Mat::from_fn(7, 5, |i, j| (i as f64 - 2.0 * j as f64).sin());
        for (i, j) in (0..7).flat_map(|i| (0..5).map(move |j| (i, j))) {
            let mut x = finite.clone();
            x[(i, j)] = -3.0;
            assert_eq!(largest_entry(x.as_ref()), 3.0);
            assert_eq!(largest_entry(x.transpose()), 3.0);
            x[(6 - i, 4 - j)] = f64::NAN;
            assert!(largest_entry(x.as_ref()).is_nan(), "{i}, {j}");
            assert!(largest_entry(x.transpose()).is_nan(), "{i}, {j}");
        }
    }

    #[test]
    fn decompositions_give_back_their_matrix() -> Result<(), StepError> {
        let a = Mat::from_fn(4, 3, |i, j| ((3 * i + 5 * j) % 7) as f64 - 2.5);
        let (q, r) = qr(a.as_ref());
        assert!(norm((multiply(q.as_ref(), r.as_ref()) - &a).as_ref()) < 1e-14);
        let s = multiply(a.transpose(), a.as_ref());
        let (lambda, v) = symmetric_eigen(s.as_ref())?;
        let scaled = Mat::from_fn(3, 3, |i, j| lambda[j] * v[(i, j)]);
        let back = multiply(scaled.as_ref(), v.transpose());
        assert!(largest_entry((back - &s).as_ref()) < 1e-13);
        assert!((lambda.iter().product::<f64>() / determinant(s.as_ref()) - 1.0).abs() < 1e-13);
        let sigma = singular_values(a.as_ref())?;
        let values = symmetric_eigenvalues(s.as_ref())?;
        for (sigma, lambda) in sigma.iter().rev().zip(&values) {
            assert!((sigma * sigma / lambda - 1.0).abs() < 1e-13);
        }
        let one = multiply(s.as_ref(), inverse(s.as_ref()).as_ref());
        assert!((squared_norm(one.as_ref()) - 3.0).abs() < 1e-12);
        let complex = Mat::from_fn(3, 3, |i, j| c64::new(s[(i, j)], 0.0));
        let close = |(x, y): (&f64, &f64)| (x - y).abs() < 1e-13 * s.norm_l2();
        assert!(hermitian_eigenvalues(complex.as_ref())?.iter().zip(&values).all(close));
        Ok(())
    }
}
