//! The zero of a function between two points of opposite sign, to rounding. It knows numbers only.
//!
//! Source: T. R. Chandrupatla, Adv. Eng. Software 28 (1997).

use super::stats::RunError;

/// The zero between two points of opposite sign, to rounding of t: the end of the last bracket where g has the sign
/// of `b`, or 0.
pub(super) fn zero(
    a: (f64, f64),
    b: (f64, f64),
    g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
) -> Result<f64, RunError> {
    // The bracket is (near, far); `old` is the point before.
    let ((mut near, mut far), mut s) = ((b, a), 0.5);
    for _ in 0..200 {
        if near.1 == 0.0 {
            break;
        }
        let middle = 0.5 * (near.0 + far.0);
        if middle == near.0 || middle == far.0 {
            break;
        }
        let t = near.0 + s * (far.0 - near.0);
        let new = (t, g(t)?);
        let old = if (new.1 > 0.0) == (near.1 > 0.0) && new.1 != 0.0 {
            near
        } else {
            core::mem::replace(&mut far, near)
        };
        near = new;
        // Inverse quadratic interpolation where it is known to be safe, else bisection.
        let ([x1, x2, x3], [f1, f2, f3]) = ([near.0, far.0, old.0], [near.1, far.1, old.1]);
        let (xi, phi) = ((x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2));
        s = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            f1 / (f2 - f1) * f3 / (f2 - f3)
                + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        } else {
            0.5
        };
        // Never closer to an end than rounding of t.
        let least = f64::EPSILON * near.0.abs().max(far.0.abs()) / (far.0 - near.0).abs();
        s = if least < 0.5 { s.clamp(least, 1.0 - least) } else { 0.5 };
    }
    if near.1 == 0.0 {
        return start_of_zeros(near.0, far.0, g);
    }
    // The side of b, so that the sign after the zero is that of g at b.
    let of_b = |x: (f64, f64)| x.1 == 0.0 || (x.1 > 0.0) == (b.1 > 0.0) && b.1 != 0.0;
    Ok(if of_b(near) { near.0 } else { far.0 })
}

/// The time from which on g is 0, up to `zero`, where it is 0. At `other`, on the side of the point before, it is not 0.
fn start_of_zeros(
    mut zero: f64,
    mut other: f64,
    g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
) -> Result<f64, RunError> {
    // One look beside a zero tells that it is alone.
    let beside = (4.0 * f64::EPSILON * zero.abs().max(other.abs())).copysign(other - zero);
    if beside.abs() >= (other - zero).abs() || g(zero + beside)? != 0.0 {
        return Ok(zero);
    }
    loop {
        let middle = 0.5 * (zero + other);
        if middle == zero || middle == other {
            return Ok(zero);
        }
        *(if g(middle)? == 0.0 { &mut zero } else { &mut other }) = middle;
    }
}
