//! Moments of inertia of simple bodies, and the principal axes of any tensor of inertia.
//!
//! | body, of mass M about its centre | J₁, J₂, J₃ |
//! |---|---|
//! | ellipsoid of semi-axes a, b, c | M/5 (b² + c², a² + c², a² + b²) |
//! | box of edges a, b, c | M/12 (b² + c², a² + c², a² + b²) |
//! | cylinder of radius r and height h about e₃ | M/12 (3r² + h², 3r² + h², 6r²) |
//!
//! Moments of a body satisfy the triangle inequality J_i ≤ J_j + J_k, with equality for a flat body.

use nalgebra::{Matrix3, Vector3};

use super::rigid_body::check_inertia;
use crate::error::Error;

/// The rounding error allowed in the triangle inequality, relative to the largest moment.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// `scale`·M (b² + c², a² + c², a² + b²).
fn of_axes(mass: f64, scale: f64, axes: [f64; 3], name: &str) -> Result<[f64; 3], Error> {
    let m = scale * Error::positive("mass", mass)?;
    for (i, &x) in axes.iter().enumerate() {
        Error::positive(format!("{name}[{i}]"), x)?;
    }
    let [a, b, c] = axes.map(|x| x * x);
    let moments = [m * (b + c), m * (a + c), m * (a + b)];
    check_inertia(&moments).map(|()| moments)
}

/// The principal moments of a solid ellipsoid.
///
/// # Errors
/// [`Error::OutOfRange`] for a mass or semi-axis that is not finite and positive.
pub fn ellipsoid(mass: f64, semi_axes: [f64; 3]) -> Result<[f64; 3], Error> {
    of_axes(mass, 0.2, semi_axes, "semi_axes")
}

/// The principal moments of a solid box.
///
/// # Errors
/// [`Error::OutOfRange`] for a mass or edge that is not finite and positive.
pub fn cuboid(mass: f64, sides: [f64; 3]) -> Result<[f64; 3], Error> {
    of_axes(mass, 1.0 / 12.0, sides, "sides")
}

/// The principal moments of a solid cylinder about e₃.
///
/// # Errors
/// [`Error::OutOfRange`] for a mass, radius or height that is not finite and positive.
pub fn cylinder(mass: f64, radius: f64, height: f64) -> Result<[f64; 3], Error> {
    let m = Error::positive("mass", mass)? / 12.0;
    let (r2, h2) =
        (Error::positive("radius", radius)?.powi(2), Error::positive("height", height)?.powi(2));
    let moments = [m * (3.0 * r2 + h2), m * (3.0 * r2 + h2), 6.0 * m * r2];
    check_inertia(&moments).map(|()| moments)
}

/// The amount by which principal moments violate the triangle inequality, relative to the largest moment.
///
/// `Some` means that no rigid body has these moments. Euler's equations are defined even then; the caller should warn.
///
/// ```
/// use lieflow::problems::inertia::violates_triangle;
/// assert_eq!(violates_triangle([1.0, 2.0, 2.5]), None);
/// assert_eq!(violates_triangle([1.0, 2.0, 4.0]), Some(0.25));
/// ```
pub fn violates_triangle(inertia: [f64; 3]) -> Option<f64> {
    let largest = inertia.iter().fold(0.0, |a: f64, b| a.max(*b));
    let others: f64 = inertia.iter().map(|j| j / largest).sum::<f64>() - 1.0;
    let missed = 1.0 - others;
    (missed > ROUNDING).then_some(missed)
}

/// [`violates_triangle`] in words, as `J3 > J1 + J2 (4 > 1 + 2): impossible for a real body`.
pub fn impossible(inertia: [f64; 3]) -> Option<String> {
    violates_triangle(inertia)?;
    let largest = (0..3).fold(0, |k, i| if inertia[i] > inertia[k] { i } else { k });
    let order = [[0, 1, 2], [1, 0, 2], [2, 0, 1]][largest];
    let [(i, a), (j, b), (k, c)] = order.map(|i| (i + 1, inertia[i]));
    Some(format!("J{i} > J{j} + J{k} ({a} > {b} + {c}): impossible for a real body"))
}

/// [`violates_triangle`] as an error.
///
/// # Errors
/// [`Error::OutOfRange`] for the largest moment.
pub fn check_triangle(inertia: [f64; 3]) -> Result<(), Error> {
    check_inertia(&inertia)?;
    let Some(_) = violates_triangle(inertia) else { return Ok(()) };
    let largest = (0..3).fold(0, |k, i| if inertia[i] > inertia[k] { i } else { k });
    let expected = "at most the sum of the others, as every rigid body has";
    Err(Error::out_of_range(format!("inertia[{largest}]"), inertia[largest], expected))
}

/// The principal moments of a tensor in ascending order, and the rotation Q whose columns are the principal axes.
///
/// tensor = Q diag(J) Qᵀ. In the frame of the principal axes the body momentum is Qᵀm and the attitude gQ.
///
/// # Errors
/// [`Error::NotFiniteEntry`]; [`Error::OutOfRange`] for a tensor that is not symmetric to rounding,
/// and for a moment that is not positive.
pub fn principal_axes(tensor: &Matrix3<f64>) -> Result<([f64; 3], Matrix3<f64>), Error> {
    for i in 0..3 {
        for j in 0..3 {
            if !tensor[(i, j)].is_finite() {
                let value = tensor[(i, j)];
                return Err(Error::NotFiniteEntry { arg: "inertia", row: i, col: j, value });
            }
        }
    }
    let size = tensor.amax();
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (above, below) = (tensor[(i, j)], tensor[(j, i)]);
        if (above - below).abs() > 64.0 * f64::EPSILON * size {
            let (arg, expected) = (
                format!("inertia[{},{}]", i + 1, j + 1),
                format!("{below}, as inertia[{},{}]", j + 1, i + 1),
            );
            return Err(Error::out_of_range(arg, above, expected));
        }
    }
    if size == 0.0 {
        return Err(Error::out_of_range("inertia", 0.0, "a tensor with moments > 0"));
    }
    // Scaled, so that squares stay in range.
    let eigen = (tensor / size).symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let moments = order.map(|k| eigen.eigenvalues[k] * size);
    if moments[0] <= 0.0 {
        let arg = "the least principal moment of inertia";
        let expected = "a number > 0: a positive definite tensor";
        return Err(Error::out_of_range(arg, moments[0], expected));
    }
    check_inertia(&moments)?;
    let mut axes = Matrix3::from_columns(&order.map(|k| eigen.eigenvectors.column(k).into_owned()));
    if axes.determinant() < 0.0 {
        let flipped: Vector3<f64> = -axes.column(2);
        axes.set_column(2, &flipped);
    }
    Ok((moments, axes))
}
