//! α = |u| and the coefficients of exp, dexp and dexp⁻¹.
//!
//! Below α² = 1 they are polynomials in α²: no root, no division, no trigonometric function. Above,
//! half angles: sin α = 2 sin(α/2)cos(α/2), 1 − cos α = 2 sin²(α/2). exp as a matrix is the rotation of
//! the quaternion (cos(α/2), sin(α/2)/α u), which forgives the rounding of α.

use nalgebra::{Matrix3, Vector3};

use super::{dot, rotation};
use crate::scalar::{Real, Trig};

/// α² = |u|² and, from [`SERIES`] on, α, sin(α/2), cos(α/2).
#[derive(Clone, Copy, Debug)]
pub struct Angle<S> {
    pub(crate) alpha2: S,
    alpha: S,
    sin_half: S,
    cos_half: S,
}

/// Below this α² all coefficients are polynomials.
pub(super) const SERIES: f64 = 1.0;
/// Below this |sin(α/2)| the rounding of α is taken back.
pub(super) const REFINE: f64 = 0.1;

// Polynomials in α² that interpolate in the 8 Chebyshev nodes of [0, 1]: the relative error is below
// 5e-17, where a Taylor polynomial would need two terms more. `make_so3.py --series` prints them.
/// sin α/α.
#[rustfmt::skip]
const SINC: [f64; 8] = [
    1.0, -0.16666666666666666, 0.008333333333333106, -0.0001984126984108742,
    2.7557319152292533e-06, -2.5052093081256153e-08, 1.605723315933452e-10, -7.535482987408254e-13,
];
/// (1 − cos α)/α².
#[rustfmt::skip]
const COSC: [f64; 8] = [
    0.5, -0.041666666666666664, 0.0013888888888888761, -2.480158730148584e-05,
    2.755731918411258e-07, -2.087674847675659e-09, 1.1469738737883868e-11, -4.7173894321989566e-14,
];
/// (α − sin α)/α³.
#[rustfmt::skip]
const SINCC: [f64; 8] = [
    0.16666666666666666, -0.008333333333333333, 0.00019841269841269773, -2.7557319223932436e-06,
    2.5052108364436048e-08, -1.605903935332227e-10, 7.646633386654242e-13, -2.7787599811497133e-15,
];
/// (1 − (α/2)cot(α/2))/α².
#[rustfmt::skip]
const COTC: [f64; 8] = [
    0.08333333333333333, 0.001388888888888926, 3.306878306800382e-05, 8.267195829413588e-07,
    2.087673262520767e-08, 5.284707066441219e-10, 1.332202514478385e-11, 3.754788167247988e-13,
];
/// d/dα² of (1 − (α/2)cot(α/2))/α².
#[rustfmt::skip]
const COTC_SLOPE: [f64; 8] = [
    0.0013888888888888887, 6.613756613757471e-05, 2.480158729979068e-06, 8.350702938564351e-08,
    2.64208945557739e-09, 8.030712340508873e-11, 2.35885576085506e-12, 7.706946286242862e-14,
];
/// sin(α/2)/α.
#[rustfmt::skip]
const HALF_SINC: [f64; 8] = [
    0.5, -0.020833333333333332, 0.00026041666666666666, -1.5500992063491924e-06,
    5.382288910879596e-09, -1.2232474679909654e-11, 1.960318589399966e-14, -2.3251641588806655e-17,
];
/// cos(α/2).
#[rustfmt::skip]
const HALF_COS: [f64; 8] = [
    1.0, -0.125, 0.0026041666666666665, -2.1701388888888412e-05,
    9.688120039495094e-08, -2.691144415471956e-10, 5.096817217095995e-13, -6.972072418915916e-16,
];

impl<S: Trig> Angle<S> {
    /// The angle of u = 0.
    pub(crate) fn zero() -> Self {
        let (o, i) = (S::lit(0.0), S::lit(1.0));
        Angle { alpha2: o, alpha: o, sin_half: o, cos_half: i }
    }

    /// Does α² lie within the range of these formulas? Not where u is not finite; beyond see
    /// [`super::polar`].
    #[inline(always)]
    pub(crate) fn in_range(&self) -> bool {
        self.alpha2.all_below(S::SQUARE_MAX)
    }

    /// The angle of u and exp(u), the rotation of the quaternion (cos(α/2), (sin(α/2)/α)·u). Out of
    /// range they mean nothing.
    #[inline(always)]
    pub(crate) fn with_matrix(u: &Vector3<S>) -> (Self, Matrix3<S>) {
        let angle = Self::of(u);
        let (c, k) = angle.quaternion_coefficients();
        (angle, rotation(c, &Vector3::new(k * u[0], k * u[1], k * u[2])))
    }

    /// The angle of u, with a = sin α/α and b = (1 − cos α)/α², for exp(u)·x without exp(u). Out of
    /// range they mean nothing.
    #[inline(always)]
    pub(crate) fn with_exp(u: &Vector3<S>) -> (Self, S, S) {
        let l = S::lit;
        let alpha2 = dot(u, u);
        let [a, b, alpha, sin_half, cos_half] = alpha2.branch(
            SERIES,
            || [estrin(alpha2, &SINC), estrin(alpha2, &COSC), l(0.0), l(0.0), l(1.0)],
            || {
                let (alpha, s, c) = half_angle(u, alpha2);
                let k = l(2.0) * s / alpha2; // not by squaring 2s/α: that doubles the rounding of α
                [k * alpha * c, k * s, alpha, s, c]
            },
        );
        (Angle { alpha2, alpha, sin_half, cos_half }, a, b)
    }

    /// The angle of u alone.
    #[inline(always)]
    pub(super) fn of(u: &Vector3<S>) -> Self {
        let l = S::lit;
        let alpha2 = dot(u, u);
        let [alpha, sin_half, cos_half] = alpha2.branch(
            SERIES,
            || [l(0.0), l(0.0), l(1.0)],
            || {
                let (alpha, s, c) = half_angle(u, alpha2);
                [alpha, s, c]
            },
        );
        Angle { alpha2, alpha, sin_half, cos_half }
    }

    /// |sin(α/2)| where α² is not below [`SERIES`], else 1: where it is below [`REFINE`] the rounding
    /// of α has to be taken back.
    #[inline(always)]
    pub(super) fn regular(&self) -> S {
        let [r] = self.alpha2.branch(SERIES, || [S::lit(1.0)], || [self.sin_half.abs()]);
        r
    }

    /// (1 − (α/2)cot(α/2))/α².
    #[inline(always)]
    pub(crate) fn dexpinv_coefficient(&self) -> S {
        let l = S::lit;
        let [c] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &COTC)],
            || [(l(1.0) - l(0.5) * self.alpha * self.cos_half / self.sin_half) / self.alpha2],
        );
        c
    }

    /// The derivative of (1 − (α/2)cot(α/2))/α² in α²: ((α/2)cot(α/2) + (α/2)²/sin²(α/2) − 2)/(2α⁴).
    #[inline(always)]
    pub(crate) fn dexpinv_slope(&self) -> S {
        let l = S::lit;
        let [c] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &COTC_SLOPE)],
            || {
                let k = l(0.5) * self.alpha / self.sin_half;
                [(k * self.cos_half + k * k - l(2.0)) / (l(2.0) * self.alpha2 * self.alpha2)]
            },
        );
        c
    }

    /// (1 − cos α)/α² and (α − sin α)/α³.
    #[inline(always)]
    pub(crate) fn dexp_coefficients(&self) -> (S, S) {
        let l = S::lit;
        let [b, d] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &COSC), estrin(self.alpha2, &SINCC)],
            || {
                let k = l(2.0) * self.sin_half / self.alpha;
                [l(0.5) * k * k, (l(1.0) - k * self.cos_half) / self.alpha2]
            },
        );
        (b, d)
    }

    /// cos(α/2) and sin(α/2)/α: the unit quaternion of exp(u) is (cos(α/2), (sin(α/2)/α)·u).
    #[inline(always)]
    pub(super) fn quaternion_coefficients(&self) -> (S, S) {
        let l = S::lit;
        let [c, s] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &HALF_COS), estrin(self.alpha2, &HALF_SINC)],
            // The quotient does not wait for the sine.
            || [self.cos_half, self.sin_half * (l(1.0) / self.alpha)],
        );
        (c, s)
    }
}

/// α, sin(α/2), cos(α/2).
#[inline(always)]
fn half_angle<S: Trig>(u: &Vector3<S>, alpha2: S) -> (S, S, S) {
    let alpha = alpha2.sqrt();
    let (s, c) = (S::lit(0.5) * alpha).sin_cos();
    // |sin| < 0.1 says |cos| > 0.9; asked together, both are wanted here, and come from one call.
    if s.abs().any_below(REFINE) & !c.abs().all_below(0.9) {
        return refined(u, alpha, s, c);
    }
    (alpha, s, c)
}

/// u is exact, α = fl|u| is not. Near α = 2πk that rounding would be magnified by α/|α − 2πk|;
/// turning by what is missing takes it back.
#[cold]
#[inline(never)]
fn refined<S: Trig>(u: &Vector3<S>, alpha: S, s: S, c: S) -> (S, S, S) {
    let (se, ce) = (S::lit(0.5) * norm_remainder(u, alpha)).sin_cos();
    (alpha, s * ce + c * se, c * ce - s * se)
}

/// |u| − alpha for alpha = fl|u|, to working accuracy: (Σu_i² − alpha²)/(2 alpha), the squares and
/// their sum without error.
fn norm_remainder<S: Real>(u: &Vector3<S>, alpha: S) -> S {
    let (p, e) = square_exactly(alpha);
    // -alpha² first: every partial sum is then exact up to a rounding of what is left.
    let (mut sum, mut rest) = (-p, -e);
    for x in [u[0], u[1], u[2]] {
        let (p, e) = square_exactly(x);
        let (s, r) = add_exactly(sum, p);
        sum = s;
        rest += r + e;
    }
    (sum + rest) / (S::lit(2.0) * alpha)
}

/// x² = p + e (Veltkamp, Dekker). In a number of 24 bits the constant leaves e = 0.
fn square_exactly<S: Real>(x: S) -> (S, S) {
    let t = S::lit(134217729.0) * x; // 2²⁷ + 1
    let high = t - (t - x);
    let low = x - high;
    let p = x * x;
    (p, ((high * high - p) + S::lit(2.0) * high * low) + low * low)
}

/// a + b = s + r (Knuth).
fn add_exactly<S: Real>(a: S, b: S) -> (S, S) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// Σ c_k x^k in Estrin's order: a step waits for the longest chain of operations, and Horner's is
/// three times as long.
#[inline(always)]
fn estrin<S: Real>(x: S, c: &[f64; 8]) -> S {
    let pair = |k: usize| S::lit(c[k + 1]).mul_add(x, S::lit(c[k]));
    let x2 = x * x;
    let (low, high) = (pair(2).mul_add(x2, pair(0)), pair(6).mul_add(x2, pair(4)));
    high.mul_add(x2 * x2, low)
}
