//! exp on so(3), closed form.

use nalgebra::{Matrix3, Vector3};

use super::general::baker;
use super::{Exp, TruncatedExp};
use crate::error::{Error, StepError};
use crate::groups::{So3, cross};
use crate::maps::CoordinateMap;
use crate::scalar::{Real, Trig};

/// What exp keeps at u ∈ so(3): α² = ‖û‖² and, from [`SERIES`] on, α, sin(α/2), cos(α/2).
#[derive(Clone, Copy, Debug)]
pub struct At3<S> {
    alpha2: S,
    alpha: S,
    sin_half: S,
    cos_half: S,
}

/// Below this α² all coefficients are series: no root, no division, no trigonometric function.
const SERIES: f64 = 0.25;
/// Above this coefficient dexp⁻¹ is singular: the condition number there exceeds 1e12.
const COEFFICIENT_MAX: f64 = 1e12;
/// Above this α² the squares of the closed forms overflow.
pub(in crate::maps) const SQUARE_MAX: f64 = 1e300;

/// sin α/α by α².
#[rustfmt::skip]
const SINC: [f64; 8] = [
    1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0, -1.0 / 39916800.0,
    1.0 / 6227020800.0, -1.0 / 1307674368000.0,
];
/// (1 − cos α)/α² by α².
#[rustfmt::skip]
const COSC: [f64; 8] = [
    0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40320.0, 1.0 / 3628800.0, -1.0 / 479001600.0,
    1.0 / 87178291200.0, -1.0 / 20922789888000.0,
];
/// (1 − (α/2)cot(α/2))/α² by α²: |B_2k|/(2k)!.
#[rustfmt::skip]
const COTC: [f64; 8] = [
    1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0,
    691.0 / 1307674368000.0, 1.0 / 74724249600.0, 3617.0 / 10670622842880000.0,
];

impl<S: Trig> At3<S> {
    fn new() -> Self {
        let (o, i) = (S::lit(0.0), S::lit(1.0));
        At3 { alpha2: o, alpha: o, sin_half: o, cos_half: i }
    }

    /// Remember α; return a = sin α/α and b = (1 − cos α)/α².
    #[inline(always)]
    fn fill(&mut self, u: &Vector3<S>) -> Result<(S, S), StepError> {
        let l = S::lit;
        let alpha2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        if !alpha2.all_below(SQUARE_MAX) {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        let [a, b, alpha, sin_half, cos_half] = alpha2.branch(
            SERIES,
            || [estrin(alpha2, &SINC), estrin(alpha2, &COSC), l(0.0), l(0.0), l(1.0)],
            || {
                let alpha = alpha2.sqrt();
                let (s, c) = (l(0.5) * alpha).sin_cos();
                let k = l(2.0) * s / alpha; // sin(α/2)/(α/2)
                [k * c, l(0.5) * k * k, alpha, s, c]
            },
        );
        *self = At3 { alpha2, alpha, sin_half, cos_half };
        Ok((a, b))
    }

    /// (1 − (α/2)cot(α/2))/α².
    #[inline(always)]
    fn dexpinv_coefficient(&self) -> S {
        let l = S::lit;
        let [c] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &COTC)],
            || [(l(1.0) - l(0.5) * self.alpha * self.cos_half / self.sin_half) / self.alpha2],
        );
        c
    }
}

/// Σ c_k x^k in Estrin's order: a step waits for the longest chain of operations, and Horner's is
/// three times as long.
#[inline(always)]
fn estrin<S: Real>(x: S, c: &[f64; 8]) -> S {
    let pair = |k: usize| S::lit(c[k]) + S::lit(c[k + 1]) * x;
    let x2 = x * x;
    (pair(0) + pair(2) * x2) + (pair(4) + pair(6) * x2) * (x2 * x2)
}

impl<S: Trig> CoordinateMap<So3<S>> for Exp {
    type At = At3<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, _: &So3<S>) -> Result<At3<S>, Error> {
        Ok(At3::new())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        let (a, b) = at.fill(u)?;
        *g = rodrigues(u, a, b);
        Ok(())
    }
    #[inline]
    fn psi_on(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        _: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let (a, b) = at.fill(u)?;
        *y = rodrigues_on(u, a, b, x);
        Ok(())
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let c = at.dexpinv_coefficient();
        if !c.all_below(COEFFICIENT_MAX) {
            return Err(StepError::OutsideChart {
                map: "exp",
                what: "dexp is singular at ‖u‖ = 2πk",
            });
        }
        *v = rodrigues_on(u, S::lit(-0.5), c, v);
        Ok(())
    }
}

/// 𝟙 + a·u + b·u², u ∈ so(3).
#[inline(always)]
pub(in crate::maps) fn rodrigues<S: Real>(u: &Vector3<S>, a: S, b: S) -> Matrix3<S> {
    let (x, y, z) = (u[0], u[1], u[2]);
    let (ax, ay, az) = (a * x, a * y, a * z);
    let (bx, by, bz) = (b * x, b * y, b * z);
    let (bxy, bxz, byz) = (bx * y, bx * z, by * z);
    let (bxx, byy, bzz) = (bx * x, by * y, bz * z);
    let one = S::lit(1.0);
    #[rustfmt::skip]
    let g = Matrix3::new(
        one - (byy + bzz), bxy - az, bxz + ay,
        bxy + az, one - (bxx + bzz), byz - ax,
        bxz - ay, byz + ax, one - (bxx + byy),
    );
    g
}

/// (𝟙 + a·u + b·u²)·x by two cross products.
#[inline(always)]
pub(in crate::maps) fn rodrigues_on<S: Real>(
    u: &Vector3<S>,
    a: S,
    b: S,
    x: &Vector3<S>,
) -> Vector3<S> {
    let ux = cross(u, x);
    let uux = cross(u, &ux);
    Vector3::new(
        x[0] + a * ux[0] + b * uux[0],
        x[1] + a * ux[1] + b * uux[1],
        x[2] + a * ux[2] + b * uux[2],
    )
}

impl<S: Trig> CoordinateMap<So3<S>> for TruncatedExp {
    type At = At3<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &So3<S>) -> Result<At3<S>, Error> {
        Exp.at(group)
    }
    #[inline]
    fn psi(
        &self,
        group: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        Exp.psi(group, u, at, g)
    }
    #[inline]
    fn psi_on(
        &self,
        group: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        g: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        Exp.psi_on(group, u, at, g, x, y)
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut At3<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let mut ad = *v;
        for k in 1..=self.q {
            ad = cross(u, &ad);
            let c = S::lit(baker(k));
            if k == 1 || k % 2 == 0 {
                *v = Vector3::new(v[0] + c * ad[0], v[1] + c * ad[1], v[2] + c * ad[2]);
            }
        }
        Ok(())
    }
    fn order(&self, _: &So3<S>) -> usize {
        self.order_kept()
    }
}
