//! Matrices in scenes: the checks of their entries, the names of the columns that show them, and what several
//! kinds compute from them.

use faer::MatRef;
use lieflow::dense::{largest_entry, multiply, norm, squared_norm, symmetric_eigenvalues};
use lieflow::groups::{GroupMatrix, LieGroup, MatrixGroup};
use lieflow_runs::schema::{Law, Scale};
use lieflow_runs::spaces::OnMatrices;

use super::prelude::*;
use crate::formula::entry_name;

/// The asymmetry that the rounding of written entries explains, relative to the largest entry.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The rows of a matrix whose entries have names in formulas: one digit for the row and one for the column.
pub(super) const NAMED_MAX: usize = 9;

/// The n×n matrix under a key.
///
/// # Errors
/// A refusal of `key` for another shape.
pub(super) fn square(key: &str, table: &Table, n: Option<usize>) -> Result<Mat<f64>, ReadError> {
    let x = table.matrix(key, n)?;
    check_rows(key, &x, x.ncols())?;
    Ok(x)
}

/// The symmetric matrix under a key, n×n where n is known, up to this part of the largest entry.
///
/// # Errors
/// A refusal of `key` for another shape, and of the entry of `key` where it is not symmetric.
pub(super) fn symmetric(
    key: &str,
    table: &Table,
    n: Option<usize>,
    tolerance: f64,
) -> Result<Mat<f64>, ReadError> {
    let x = square(key, table, n)?;
    check_symmetric(key, &x, tolerance)?;
    Ok(symmetric_part(&x))
}

/// ½(x + xᵀ): x without the rounding of its entries.
pub(super) fn symmetric_part(x: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(x.nrows(), x.ncols(), |i, j| 0.5 * (x[(i, j)] + x[(j, i)]))
}

/// Does a matrix have n rows?
///
/// # Errors
/// A refusal of `key`.
pub(super) fn check_rows(key: &str, x: &Mat<f64>, n: usize) -> Result<(), Refusal> {
    match x.nrows() == n {
        true => Ok(()),
        false => {
            Err(Refusal::at(key, format!("found {}, expected {n}", amount(x.nrows(), "rows"))))
        }
    }
}

/// The n of n×n matrices with this number of entries above the diagonal, n(n − 1)/2.
pub(super) fn side_of(count: usize) -> Option<usize> {
    (2..).take_while(|n| n * (n - 1) / 2 <= count).find(|n| n * (n - 1) / 2 == count)
}

/// The places above the diagonal of n×n matrices, row by row.
pub(super) fn above_diagonal(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (i + 1..n).map(move |j| (i, j)))
}

/// The antisymmetric matrix with these entries above the diagonal, row by row; none for another number of them.
pub(super) fn antisymmetric(above: &[f64]) -> Option<Mat<f64>> {
    let n = side_of(above.len())?;
    let mut x = Mat::zeros(n, n);
    for ((i, j), &entry) in above_diagonal(n).zip(above) {
        (x[(i, j)], x[(j, i)]) = (entry, -entry);
    }
    Some(x)
}

/// Is xᵀ = x up to this part of the largest entry?
///
/// # Errors
/// A refusal of the entry of `key` where it is not.
pub(super) fn check_symmetric(key: &str, x: &Mat<f64>, tolerance: f64) -> Result<(), Refusal> {
    check_symmetry(key, x, 1.0, tolerance)
}

/// Is xᵀ = −x?
///
/// # Errors
/// As [`check_symmetric`].
pub(super) fn check_antisymmetric(key: &str, x: &Mat<f64>, tolerance: f64) -> Result<(), Refusal> {
    check_symmetry(key, x, -1.0, tolerance)
}

fn check_symmetry(key: &str, x: &Mat<f64>, sign: f64, tolerance: f64) -> Result<(), Refusal> {
    let allowed = tolerance * largest_entry(x.as_ref());
    let Some((i, j)) = unlike(x.as_ref(), sign, allowed) else { return Ok(()) };
    let what = if sign > 0.0 { "a symmetric" } else { "an antisymmetric" };
    let mut message = format!("expected {what} matrix, but {} is {}", key.cell(j, i), x[(j, i)]);
    if i != j {
        message += &format!(" and {} is {}", key.cell(i, j), x[(i, j)]);
    }
    Err(Refusal::at(key.cell(i, j), message))
}

/// The first entry on or below the diagonal that is farther than `allowed` from `sign` times the one across the diagonal.
pub(super) fn unlike(x: MatRef<'_, f64>, sign: f64, allowed: f64) -> Option<(usize, usize)> {
    let mut lower = (0..x.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j)));
    lower.find(|&(i, j)| (x[(i, j)] - sign * x[(j, i)]).abs() > allowed)
}

/// The real matrix \[X −Y; Y X\] of X + iY, from \[X; Y\].
pub(super) fn whole(x: MatRef<'_, f64>) -> Mat<f64> {
    let n = x.ncols();
    Mat::from_fn(2 * n, 2 * n, |i, j| match j < n {
        true => x[(i, j)],
        false if i < n => -x[(n + i, j - n)],
        false => x[(i - n, j - n)],
    })
}

/// The columns x1, …, xn.
pub(super) fn numbered(letter: &str, n: usize) -> Vec<String> {
    (1..=n).map(|i| format!("{letter}{i}")).collect()
}

/// The columns xij of entries of an n×n matrix at these places, from 0.
pub(super) fn columns_at(
    letter: &str,
    n: usize,
    places: impl Iterator<Item = (usize, usize)>,
) -> Vec<String> {
    places.map(|(i, j)| entry_name(letter, [n, n], [i + 1, j + 1])).collect()
}

/// The columns x11, …, xnn, on and above the diagonal, row by row.
pub(super) fn upper_columns(letter: &str, n: usize) -> Vec<String> {
    columns_at(letter, n, (0..n).flat_map(|i| (i..n).map(move |j| (i, j))))
}

/// The entries, row by row.
pub(super) fn rows(x: &Mat<f64>) -> impl Iterator<Item = f64> {
    (0..x.nrows()).flat_map(move |i| (0..x.ncols()).map(move |j| x[(i, j)]))
}

/// The entries on and above the diagonal, row by row.
pub(super) fn upper(x: &Mat<f64>) -> impl Iterator<Item = f64> {
    (0..x.nrows()).flat_map(move |i| (i..x.ncols()).map(move |j| x[(i, j)]))
}

/// The entries on the diagonal.
pub(super) fn diagonal(x: &Mat<f64>) -> impl Iterator<Item = f64> {
    (0..x.nrows()).map(|i| x[(i, i)])
}

/// tr x.
pub(super) fn trace(x: &Mat<f64>) -> f64 {
    diagonal(x).sum()
}

/// gᵏ by squarings.
pub(super) fn power(mut g: Mat<f64>, mut k: u64) -> Mat<f64> {
    let mut product = Mat::identity(g.nrows(), g.nrows());
    while k > 0 {
        if k % 2 == 1 {
            product = multiply(g.as_ref(), product.as_ref());
        }
        g = multiply(g.as_ref(), g.as_ref());
        k /= 2;
    }
    product
}

/// tr x, tr x², …, tr xⁿ.
pub(super) fn traces(x: &Mat<f64>) -> impl Iterator<Item = f64> {
    let mut power = Mat::<f64>::identity(x.nrows(), x.nrows());
    (0..x.nrows()).map(move |_| {
        power = multiply(power.as_ref(), x.as_ref());
        trace(&power)
    })
}

/// |x|ⁿ, at least 1: a bound of what the traces of the powers of x are summed from.
pub(super) fn size_of_traces(x: &Mat<f64>) -> f64 {
    norm(x.as_ref()).max(1.0).powi(x.nrows() as i32)
}

/// The eigenvalues of a symmetric matrix in ascending order; NaN where their iteration does not converge.
pub(super) fn eigenvalues(x: &Mat<f64>) -> Vec<f64> {
    symmetric_eigenvalues(x.as_ref()).unwrap_or_else(|_| vec![f64::NAN; x.nrows()])
}

/// The distance of gᵀJg from J, of a problem whose point is g.
pub(super) const fn symplectic_defect<S: System<Problem = OnMatrices>>() -> Quantity<S> {
    Quantity::number("symplectic_defect", "distance of g'Jg from J", |_, _, g: &Mat<f64>| {
        let element = GroupMatrix::new_unchecked(g.clone());
        MatrixGroup::sp(element.nrows()).map_or(f64::NAN, |group| group.defect(&element))
    })
    .kept(Law::by_the_action(2).on_scale(Scale::Terms))
    .of_distance()
    .in_terms(|_, g: &Mat<f64>| squared_norm(g.as_ref()))
}
