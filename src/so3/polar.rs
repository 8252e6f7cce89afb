//! The same maps where |u|² leaves the range: u = α n with |n| = 1, and every formula in α and n.
//!
//! | | |
//! |---|---|
//! | exp | 𝟙 + sin α n̂ + (1−cos α) n̂² |
//! | dexp | 𝟙 + ((1−cos α)/α) n̂ + (1−sin α/α) n̂² |
//! | dexp⁻¹ | 𝟙 − û/2 + (1−(α/2)cot(α/2)) n̂² |
//! | cay | 𝟙 + 4/(α + 4/α) n̂ + 2/(1 + 4/α²) n̂², 4/α² being below rounding |
//! | dcay | (4/α²)(𝟙 + û/2) |

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::cross;
use super::{all_finite, dot3, finite, rodrigues, rodrigues_on, rotation};
use crate::error::StepError;
use crate::scalar::{Real, Trig};

pub(super) const SINGULAR: StepError =
    StepError::OutsideChart { map: "exp", what: "dexp is singular at ‖u‖ = 2πk" };

/// n and α.
fn polar<S: Real>(map: &'static str, u: &Vector3<S>) -> Result<(Vector3<S>, S), StepError> {
    let size = u[0].abs() + u[1].abs() + u[2].abs();
    if !size.is_finite() {
        let what = "u in a map on so(3)";
        return Err(match all_finite(u) {
            true => StepError::NormTooLarge { map },
            false => StepError::NotFinite { what },
        });
    }
    let v = u.map(|x| x / size);
    let norm = dot3(&v, &v).sqrt();
    // 1/√3 ≤ norm ≤ 1, except in a lane that holds 0 beside one that holds a huge u.
    let [x, y, z] = norm.branch(
        0.5,
        || [S::lit(0.0), S::lit(0.0), S::lit(0.0)],
        || [v[0] / norm, v[1] / norm, v[2] / norm],
    );
    let [alpha] = norm.branch(0.5, || [S::lit(1.0)], || [size * norm]);
    Ok((Vector3::new(x, y, z), alpha))
}

/// sin α and 1 − cos α.
fn sine_versine<S: Trig>(alpha: S) -> (S, S) {
    let (s, c) = (S::lit(0.5) * alpha).sin_cos();
    (S::lit(2.0) * s * c, S::lit(2.0) * s * s)
}

#[cold]
pub(crate) fn exp_huge<S: Trig>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    let (n, alpha) = polar("exp", u)?;
    let (s, c) = (S::lit(0.5) * alpha).sin_cos();
    Ok(rotation(c, &n.map(|x| s * x)))
}

#[cold]
pub(crate) fn exp_huge_on<S: Trig>(
    u: &Vector3<S>,
    x: &Vector3<S>,
) -> Result<Vector3<S>, StepError> {
    let (n, alpha) = polar("exp", u)?;
    let (a, b) = sine_versine(alpha);
    finite(rodrigues_on(&n, a, b, x), "exp(u)·x")
}

#[cold]
pub(super) fn dexp_huge<S: Trig>(u: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    let (n, alpha) = polar("exp", u)?;
    let (a, b) = sine_versine(alpha);
    finite(rodrigues_on(&n, b / alpha, S::lit(1.0) - a / alpha, v), "dexp")
}

#[cold]
pub(crate) fn dexpinv_huge<S: Trig>(
    u: &Vector3<S>,
    v: &Vector3<S>,
) -> Result<Vector3<S>, StepError> {
    let l = S::lit;
    let (n, alpha) = polar("exp", u)?;
    let (s, c) = (l(0.5) * alpha).sin_cos();
    if s.abs().any_below(1e-12) {
        return Err(SINGULAR);
    }
    let (nv, k) = (cross(&n, v), l(1.0) - l(0.5) * alpha * c / s);
    let nnv = cross(&n, &nv);
    let half = l(0.5) * alpha;
    finite(Vector3::from_fn(|i, _| v[i] - half * nv[i] + k * nnv[i]), "dexpinv")
}

#[cold]
pub(crate) fn cay_huge<S: Real>(u: &Vector3<S>) -> Result<Matrix3<S>, StepError> {
    let (w, a, b) = cay_scaled(u)?;
    Ok(rodrigues(&w, a, b))
}

/// cay(u) = 𝟙 + a·w + b·w² as (w, a, b), w = u/s: by the |w|² of the w that there is, so that the
/// result is a rotation to rounding.
fn cay_scaled<S: Real>(u: &Vector3<S>) -> Result<(Vector3<S>, S, S), StepError> {
    let l = S::lit;
    let s = l(1.0) + u[0].abs() + u[1].abs() + u[2].abs();
    if !s.is_finite() {
        return Err(StepError::NotFinite { what: "u in cay(u)" });
    }
    let (w, r) = (Vector3::new(u[0] / s, u[1] / s, u[2] / s), l(1.0) / s);
    let c = l(1.0) / (r * r + l(0.25) * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
    Ok((w, r * c, l(0.5) * c))
}

#[cold]
pub(crate) fn cay_huge_on<S: Real>(
    u: &Vector3<S>,
    x: &Vector3<S>,
) -> Result<Vector3<S>, StepError> {
    let (w, a, b) = cay_scaled(u)?;
    finite(rodrigues_on(&w, a, b, x), "cay(u)·x")
}

#[cold]
pub(super) fn dcay_huge<S: Real>(u: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    let (n, alpha) = polar("cay", u)?;
    let (nv, two) = (cross(&n, v), S::lit(2.0) / alpha);
    finite(Vector3::from_fn(|i, _| two * (two * v[i] + nv[i])), "dcay")
}

/// The matrix whose columns are the images of e₁, e₂, e₃.
pub(super) fn columns<S: Real>(
    image: impl Fn(&Vector3<S>) -> Result<Vector3<S>, StepError>,
) -> Result<Matrix3<S>, StepError> {
    let (o, i) = (S::lit(0.0), S::lit(1.0));
    let x = image(&Vector3::new(i, o, o))?;
    let y = image(&Vector3::new(o, i, o))?;
    let z = image(&Vector3::new(o, o, i))?;
    Ok(Matrix3::new(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]))
}

#[cold]
pub(super) fn exp_huge_quaternion(u: &Vector3<f64>) -> Result<UnitQuaternion<f64>, StepError> {
    let (n, alpha) = polar("exp", u)?;
    let (s, c) = (0.5 * alpha).sin_cos();
    Ok(UnitQuaternion::new_unchecked(Quaternion::from_parts(c, n * s)))
}

/// Is u finite, and its norm?
pub(super) fn check<S: Real>(map: &'static str, u: &Vector3<S>) -> Result<(), StepError> {
    if (u[0].abs() + u[1].abs() + u[2].abs()).is_finite() {
        Ok(())
    } else {
        polar(map, u).map(drop)
    }
}
