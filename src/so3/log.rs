//! log on SO(3): the quaternion of R by its largest component, and atan2.
//!
//! Source: S. W. Shepperd, Quaternion from rotation matrix, J. Guid. Control 1 (1978); left without
//! its normalisation, which the angle 2 atan2(|q|, q_w) does not need.

use nalgebra::{Matrix3, Vector3};

use crate::error::Error;

/// How far from orthogonal, ‖RᵀR − 𝟙‖ (Frobenius), a matrix may be for its polar factor to be taken:
/// what a rotation stored in single precision or printed with six digits has.
pub const POLAR_MAX: f64 = 1e-5;

/// Up to this defect R counts as orthogonal, what products of rotations have; the logarithm is then
/// off by no more than the defect.
pub(super) const ORTHOGONAL: f64 = 16.0 * f64::EPSILON;

/// log(R): the u with exp(u) = R and |u| ≤ π. A rotation by exactly π has two; then the first
/// component of u that is not zero is positive.
///
/// A matrix slightly off the group, up to [`POLAR_MAX`], is first taken to the rotation nearest to
/// it, its polar factor.
///
/// # Errors
/// [`Error::NotFiniteEntry`]; [`Error::NotOnGroup`] with the residual ‖RᵀR − 𝟙‖;
/// [`Error::Reflection`] for determinant −1.
pub fn log(r: &Matrix3<f64>) -> Result<Vector3<f64>, Error> {
    let [w, x, y, z] = quaternion_of("R", r)?;
    Ok(log_of(w, Vector3::new(x, y, z)))
}

/// 2 atan2(|v|, w)/|v| · v for a quaternion (w, v) of any length between 1/2 and 8.
#[inline]
pub(super) fn log_of(w: f64, v: Vector3<f64>) -> Vector3<f64> {
    let squares = v.norm_squared();
    if squares < 1e-17 * (w * w) {
        return v * (2.0 / w); // atan x = x to rounding, and squares may have underflowed
    }
    let norm = squares.sqrt();
    let angle = 2.0 * norm.atan2(w.abs());
    let negative = match w == 0.0 {
        true => v.iter().find(|x| **x != 0.0).is_some_and(|x| *x < 0.0),
        false => w < 0.0,
    };
    v * if negative { -(angle / norm) } else { angle / norm }
}

/// RᵀR − 𝟙: its diagonal, and the entries 12, 13, 23.
#[inline(always)]
fn gram_defect(r: &Matrix3<f64>) -> ([f64; 3], [f64; 3]) {
    let dot =
        |i: usize, j: usize| r[(0, i)] * r[(0, j)] + r[(1, i)] * r[(1, j)] + r[(2, i)] * r[(2, j)];
    ([dot(0, 0) - 1.0, dot(1, 1) - 1.0, dot(2, 2) - 1.0], [dot(0, 1), dot(0, 2), dot(1, 2)])
}

#[inline(always)]
fn norm_squared((d, o): &([f64; 3], [f64; 3])) -> f64 {
    let square = |x: &[f64; 3]| x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    square(d) + 2.0 * square(o)
}

/// (w, x, y, z), a multiple of the unit quaternion of R between 1 and 4 times as long.
///
/// # Errors
/// As [`log`].
#[inline(always)]
pub(super) fn quaternion_of(arg: &'static str, r: &Matrix3<f64>) -> Result<[f64; 4], Error> {
    let defect = gram_defect(r);
    let residual2 = norm_squared(&defect);
    let det = triple(r);
    if residual2 <= ORTHOGONAL * ORTHOGONAL && det > 0.0 {
        return Ok(shepperd(r));
    }
    off_the_group(arg, r, defect, residual2.sqrt(), det)
}

/// det R.
#[inline(always)]
fn triple(r: &Matrix3<f64>) -> f64 {
    let minor = |j: usize, k: usize| r[(1, j)] * r[(2, k)] - r[(1, k)] * r[(2, j)];
    r[(0, 0)] * minor(1, 2) + r[(0, 1)] * minor(2, 0) + r[(0, 2)] * minor(0, 1)
}

#[cold]
#[inline(never)]
fn off_the_group(
    arg: &'static str,
    r: &Matrix3<f64>,
    defect: ([f64; 3], [f64; 3]),
    residual: f64,
    det: f64,
) -> Result<[f64; 4], Error> {
    if residual.is_nan() || residual > POLAR_MAX {
        return Err(refuse(arg, r, residual));
    }
    if det < 0.0 {
        return Err(Error::Reflection { arg });
    }
    Ok(shepperd(&polar_factor(r, defect)))
}

fn refuse(arg: &'static str, r: &Matrix3<f64>, residual: f64) -> Error {
    for col in 0..3 {
        for row in 0..3 {
            let value = r[(row, col)];
            if !value.is_finite() {
                return Error::NotFiniteEntry { arg, row, col, value };
            }
        }
    }
    Error::NotOnGroup { arg, group: "SO(3)".into(), residual, tolerance: POLAR_MAX }
}

/// R ← R − R(RᵀR − 𝟙)/2 (Newton–Schulz, in residual form): quadratic, so that two or three steps
/// take [`POLAR_MAX`] to rounding.
fn polar_factor(r: &Matrix3<f64>, mut defect: ([f64; 3], [f64; 3])) -> Matrix3<f64> {
    let mut r = *r;
    for _ in 0..3 {
        let last = norm_squared(&defect) < 1e-18;
        let ([a, b, c], [d, e, f]) = defect;
        r -= r * Matrix3::new(a, d, e, d, b, f, e, f, c) * 0.5;
        if last {
            break;
        }
        defect = gram_defect(&r);
    }
    r
}

/// The quaternion times four of its largest component, or nearly the largest.
#[inline(always)]
fn shepperd(r: &Matrix3<f64>) -> [f64; 4] {
    let (a, b, c) = (r[(0, 0)], r[(1, 1)], r[(2, 2)]);
    let skew = [r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]];
    let trace = a + b + c;
    if trace >= 0.0 {
        return [1.0 + trace, skew[0], skew[1], skew[2]];
    }
    let (xy, xz, yz) = (r[(0, 1)] + r[(1, 0)], r[(0, 2)] + r[(2, 0)], r[(1, 2)] + r[(2, 1)]);
    if a >= b && a >= c {
        [skew[0], 1.0 + a - b - c, xy, xz]
    } else if b >= c {
        [skew[1], xy, 1.0 - a + b - c, yz]
    } else {
        [skew[2], xz, yz, 1.0 - a - b + c]
    }
}
