//! The numbers of a state that a run goes on from in place of its own: are they on M?
//!
//! The group and its action see to groups and their orbits. Here are the checks of what they do not see, as that a matrix is
//! symmetric; a kind asks for them in [`System::check_state`]. Entries count from 0, as those of arrays do.

use faer::MatRef;
use lieflow::dense::largest_entry;
use lieflow::error::Plain;

use super::entries::{unlike, whole};
use super::prelude::*;

/// How far from M numbers may be, relative to their size: those with seven digits are as near.
pub(super) const OFF_M: f64 = 1e-6;

/// Is a number of the state what it is on M, up to a part of `size`? `of` says what it belongs to there.
///
/// # Errors
/// [`Error::OutOfRange`] of `arg`, also for a NaN.
pub(super) fn check_number(
    arg: String,
    value: f64,
    expected: f64,
    size: f64,
    of: &str,
) -> Result<(), Error> {
    match (value - expected).abs() <= OFF_M * size {
        true => Ok(()),
        false => Err(Error::OutOfRange { arg, value, expected: format!("{expected}, {of}") }),
    }
}

/// Is a number of the state large enough?
///
/// # Errors
/// [`Error::OutOfRange`] of `arg`.
pub(super) fn check_least(is: bool, arg: String, value: f64, expected: &str) -> Result<(), Error> {
    match is {
        true => Ok(()),
        false => Err(Error::OutOfRange { arg, value, expected: expected.into() }),
    }
}

/// Is a vector of length 1? `what` names it.
///
/// # Errors
/// [`Error::OutOfRange`].
pub(super) fn check_unit(what: &str, arg: &str, length: f64) -> Result<(), Error> {
    check_number(format!("the length of {what} in {arg}"), length, 1.0, 1.0, "that of a direction")
}

/// Is the state a symmetric matrix?
///
/// # Errors
/// [`Error::OutOfRange`] of the entry where it is not.
pub(super) fn check_symmetric(arg: &str, x: &Mat<f64>) -> Result<(), Error> {
    check_symmetry(arg, "a symmetric", x.as_ref(), 1.0, largest_entry(x.as_ref()))
}

/// Is the state an antisymmetric matrix?
///
/// # Errors
/// As [`check_symmetric`].
pub(super) fn check_antisymmetric(arg: &str, x: &Mat<f64>) -> Result<(), Error> {
    check_symmetry(arg, "an antisymmetric", x.as_ref(), -1.0, largest_entry(x.as_ref()))
}

/// Is the state the real matrix \[X −Y; Y X\] of a Hermitian X + iY?
///
/// # Errors
/// As [`check_symmetric`].
pub(super) fn check_hermitian(arg: &str, x: &Mat<f64>) -> Result<(), Error> {
    check_complex(arg, x)?;
    let (n, size) = (x.ncols() / 2, largest_entry(x.as_ref()));
    let part = |name: &str, rows, sign| {
        let name = format!("the {name} part of {arg}");
        check_symmetry(&name, "a Hermitian", x.get(rows, ..n), sign, size)
    };
    part("real", 0..n, 1.0)?;
    part("imaginary", n..2 * n, -1.0)
}

/// Is the state \[X −Y; Y X\], the real matrix of X + iY?
///
/// # Errors
/// [`Error::OutOfRange`] of the entry that is farthest from it.
pub(super) fn check_complex(arg: &str, x: &Mat<f64>) -> Result<(), Error> {
    let n = x.ncols() / 2;
    let expected = whole(x.subcols(0, n));
    let right = (n..2 * n).flat_map(|j| (0..2 * n).map(move |i| (i, j)));
    let away = |&(i, j): &(usize, usize)| (x[(i, j)] - expected[(i, j)]).abs();
    let Some((i, j)) = right.max_by(|a, b| away(a).total_cmp(&away(b))) else { return Ok(()) };
    let of = "as the real matrix [X −Y; Y X] of X + iY has";
    let size = largest_entry(x.as_ref());
    check_number(format!("{arg}[{i}, {j}]"), x[(i, j)], expected[(i, j)], size, of)
}

fn check_symmetry(
    name: &str,
    what: &str,
    x: MatRef<'_, f64>,
    sign: f64,
    size: f64,
) -> Result<(), Error> {
    let Some((i, j)) = unlike(x, sign, OFF_M * size) else { return Ok(()) };
    let mut expected = format!("{what} matrix");
    if i != j {
        expected += &format!(", but {name}[{j}, {i}] is {}", Plain(&x[(j, i)]));
    }
    Err(Error::OutOfRange { arg: format!("{name}[{i}, {j}]"), value: x[(i, j)], expected })
}
