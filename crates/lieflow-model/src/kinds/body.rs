//! What kinds of bodies share: the columns of an attitude, the key of the initial momentum, and checks of keys.

use lieflow::Error;
use nalgebra::{Matrix3, Vector3};

use crate::scene::values::{Reals, Rows};
use crate::scene::{Either, Refusal, exactly_one};

/// The columns of a rotation, row by row.
pub(super) const ROTATION: &[&str] =
    &["g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33"];

/// The meaning of the key `attitude`.
pub(super) const ATTITUDE: &str =
    "initial rotation from body to space, three rows; optional, the identity";

/// The entries of g go to the end of `row`, row by row.
pub(super) fn by_rows(g: &Matrix3<f64>, row: &mut Vec<f64>) {
    row.extend(g.transpose().iter());
}

/// The rotation of the key `attitude`; the identity where the key is missing.
pub(super) fn attitude(rows: Option<Rows<3>>) -> Matrix3<f64> {
    rows.map_or_else(Matrix3::identity, |rows| Matrix3::from_fn(|i, j| rows.0[i][j]))
}

/// The initial momentum from `omega_body` or `momentum_body`, with the principal moments of inertia and the
/// principal axes, where these are not the axes of the scene.
///
/// # Errors
/// A refusal where not exactly one key is given, and where the momentum is not finite.
pub(super) fn momentum_body(
    inertia: [f64; 3],
    axes: Option<&Matrix3<f64>>,
    omega_body: Option<Reals<3>>,
    momentum_body: Option<Reals<3>>,
) -> Result<Vector3<f64>, Refusal> {
    let along = |x: [f64; 3]| axes.map_or(x.into(), |axes| axes.tr_mul(&Vector3::from(x)));
    match exactly_one(("omega_body", omega_body), ("momentum_body", momentum_body))? {
        Either::Second(momentum) => Ok(along(momentum.0)),
        Either::First(omega) => {
            let momentum = Vector3::from(inertia).component_mul(&along(omega.0));
            match momentum.iter().position(|m| !m.is_finite()) {
                None => Ok(momentum),
                Some(i) => Err(Refusal::at(
                    format!("omega_body[{i}]"),
                    format!("the momentum inertia[{i}] * omega_body[{i}] is not finite"),
                )),
            }
        }
    }
}

/// That every entry of a list is in range.
///
/// # Errors
/// [`Error::OutOfRange`] for the first entry that is not.
pub(super) fn check_each(
    arg: &str,
    values: &[f64],
    expected: &str,
    good: impl Fn(f64) -> bool,
) -> Result<(), Error> {
    match values.iter().position(|&x| !good(x)) {
        None => Ok(()),
        Some(i) => Err(Error::OutOfRange {
            arg: format!("{arg}[{i}]"),
            value: values[i],
            expected: expected.into(),
        }),
    }
}

/// That a vector has length 1, to the digits that it is written with.
///
/// # Errors
/// A refusal of `key`.
pub(super) fn check_unit(key: &str, length: f64) -> Result<(), Refusal> {
    match (length - 1.0).abs() <= 1e-6 {
        true => Ok(()),
        false => Err(Refusal::at(key, format!("its length is {length}, expected 1"))),
    }
}
