//! α = |u| and the coefficients of exp, dexp and dexp⁻¹.
//!
//! With c = cos(α/2) and k = sin(α/2)/α:
//!
//! | | α² < 1 | beyond |
//! |---|---|---|
//! | sin α/α | 2kc | |
//! | (1 − cos α)/α² | 2k² | |
//! | (α − sin α)/α³ | a polynomial in α² | (1 − 2kc)/α² |
//! | (1 − (α/2)cot(α/2))/α² | a polynomial in α² | (1 − c/2k)/α² |
//! | its derivative in α² | a polynomial in α² | (c/2k + 1/4k² − 2)/2α⁴ |
//! | b′ of b = (1 − cos α)/α² | a polynomial in α² | (2kc − 2b)/2α² |
//! | d′ of d = (α − sin α)/α³ | a polynomial in α² | (b − 3d)/2α² |
//!
//! c and k themselves are polynomials in α² for all rotations by up to π and a little more: no root, no
//! division, no trigonometric function. exp as a matrix is the rotation of the quaternion (c, k·u), which
//! forgives the rounding of α.

use nalgebra::{Matrix3, Vector3};

use super::{dot3, rotation};
use crate::scalar::{Real, Trig};

/// α² = |u|² and, where they have been asked for or α² is not below [`SERIES`], cos(α/2) and sin(α/2)/α.
#[derive(Clone, Copy, Debug)]
pub struct Angle<S> {
    pub(crate) alpha2: S,
    cos_half: S,
    half_sinc: S,
}

/// Below this α² the coefficients of dexp and dexp⁻¹ are polynomials, whose other form cancels there.
pub(crate) const SERIES: f64 = 1.0;
/// Below this α², π² and a little more, cos(α/2) and sin(α/2)/α are polynomials.
pub(super) const TURN: f64 = 10.0;
/// Below this |sin(α/2)| the rounding of α is taken back.
pub(super) const REFINE: f64 = 0.1;

// Polynomials in α² that interpolate in the Chebyshev nodes of [0, 1] or [0, 10]: the error is below
// 5e-17, where a Taylor polynomial would need two terms more. `tests/references/make/so3.py` has them (`series`).
/// cos(α/2) for α² < 10.
#[rustfmt::skip]
const HALF_COS: [f64; 9] = [
    1.0, -0.12499999999999993, 0.002604166666666476, -2.1701388888693032e-05, 9.688120029603478e-08,
    -2.691144164002177e-10, 5.096814958637438e-13, -6.99627421852193e-16, 7.029362648743178e-19,
];
/// sin(α/2)/α for α² < 10.
#[rustfmt::skip]
const HALF_SINC: [f64; 9] = [
    0.5, -0.020833333333333332, 0.0002604166666666616, -1.550099206344038e-06, 5.382288908275181e-09,
    -1.2232474028563473e-11, 1.9603194306661677e-14, -2.3324333693681166e-17, 2.0755049949455216e-20,
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
/// d/dα² of (1 − cos α)/α², by Taylor: the next term is below 4e-18 for α² < 1.
const COSC_SLOPE: [f64; 8] = [
    -1.0 / 24.0,
    1.0 / 360.0,
    -1.0 / 13_440.0,
    1.0 / 907_200.0,
    -1.0 / 95_800_320.0,
    1.0 / 14_529_715_200.0,
    -1.0 / 2_988_969_984_000.0,
    1.0 / 800_296_713_216_000.0,
];
/// d/dα² of (α − sin α)/α³, by Taylor.
const SINCC_SLOPE: [f64; 8] = [
    -1.0 / 120.0,
    1.0 / 2_520.0,
    -1.0 / 120_960.0,
    1.0 / 9_979_200.0,
    -1.0 / 1_245_404_160.0,
    1.0 / 217_945_728_000.0,
    -1.0 / 50_812_489_728_000.0,
    1.0 / 15_205_637_551_104_000.0,
];
impl<S: Trig> Angle<S> {
    /// The angle of u = 0.
    pub(crate) fn zero() -> Self {
        Angle { alpha2: S::lit(0.0), cos_half: S::lit(1.0), half_sinc: S::lit(0.5) }
    }

    /// Does α² lie within the range of these formulas? Not where u is not finite; beyond see
    /// [`super::polar`].
    #[inline(always)]
    pub(crate) fn in_range(&self) -> bool {
        self.alpha2.all_below(S::SQUARE_MAX)
    }

    /// The angle of u with cos(α/2) and sin(α/2)/α. Out of range they mean nothing.
    #[inline(always)]
    pub(super) fn with_half(u: &Vector3<S>) -> Self {
        let alpha2 = dot3(u, u);
        let [cos_half, half_sinc] = half(u, alpha2);
        Angle { alpha2, cos_half, half_sinc }
    }

    /// The angle of u and exp(u), the rotation of the quaternion (cos(α/2), (sin(α/2)/α)·u). Out of
    /// range they mean nothing.
    #[inline(always)]
    pub(crate) fn with_matrix(u: &Vector3<S>) -> (Self, Matrix3<S>) {
        let angle = Self::with_half(u);
        let k = angle.half_sinc;
        (angle, rotation(angle.cos_half, &Vector3::new(k * u[0], k * u[1], k * u[2])))
    }

    /// The angle of u, with a = sin α/α and b = (1 − cos α)/α², for exp(u)·x without exp(u). Out of
    /// range they mean nothing.
    #[inline(always)]
    pub(crate) fn with_exp(u: &Vector3<S>) -> (Self, S, S) {
        let angle = Self::with_half(u);
        let twice = angle.half_sinc + angle.half_sinc;
        (angle, twice * angle.cos_half, twice * angle.half_sinc)
    }

    /// The angle of u alone.
    #[inline(always)]
    pub(super) fn of(u: &Vector3<S>) -> Self {
        let alpha2 = dot3(u, u);
        let [cos_half, half_sinc] =
            alpha2.branch(SERIES, || [S::lit(1.0), S::lit(0.5)], || half(u, alpha2));
        Angle { alpha2, cos_half, half_sinc }
    }

    /// Of the order of |sin(α/2)|² where α² is not below [`TURN`], else 1: where it is below [`REFINE`] the
    /// rounding of α has to be taken back.
    #[inline(always)]
    pub(super) fn regular(&self) -> S {
        let k = self.half_sinc;
        let [r] =
            self.alpha2.branch(TURN, || [S::lit(1.0)], || [S::lit(10.0) * self.alpha2 * k * k]);
        r
    }

    /// (1 − (α/2)cot(α/2))/α².
    #[inline(always)]
    pub(crate) fn dexpinv_coefficient(&self) -> S {
        let l = S::lit;
        let [c] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &COTC)],
            || [(l(1.0) - l(0.5) * self.cos_half / self.half_sinc) / self.alpha2],
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
                let k = l(0.5) / self.half_sinc;
                [(k * self.cos_half + k * k - l(2.0)) / (l(2.0) * self.alpha2 * self.alpha2)]
            },
        );
        c
    }

    /// (1 − cos α)/α² and (α − sin α)/α³, of an angle that has its half.
    #[inline(always)]
    pub(crate) fn dexp_coefficients(&self) -> (S, S) {
        let twice = self.half_sinc + self.half_sinc;
        let [d] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &SINCC)],
            || [(S::lit(1.0) - twice * self.cos_half) / self.alpha2],
        );
        (twice * self.half_sinc, d)
    }

    /// The derivatives in α² of (1 − cos α)/α² and (α − sin α)/α³, of an angle that has its half. Let b and d be the two:
    /// b′ = (sin α/α − 2b)/(2α²), d′ = (b − 3d)/(2α²).
    #[inline(always)]
    pub(crate) fn dexp_slopes(&self) -> (S, S) {
        let l = S::lit;
        let [slope_b, slope_d] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &COSC_SLOPE), estrin(self.alpha2, &SINCC_SLOPE)],
            || {
                let twice = self.half_sinc + self.half_sinc;
                let (sinc, b) = (twice * self.cos_half, twice * self.half_sinc);
                let d = (l(1.0) - sinc) / self.alpha2;
                let over = l(0.5) / self.alpha2;
                [(sinc - l(2.0) * b) * over, (b - l(3.0) * d) * over]
            },
        );
        (slope_b, slope_d)
    }

    /// cos(α/2) and sin(α/2)/α: the unit quaternion of exp(u) is (cos(α/2), (sin(α/2)/α)·u).
    #[inline(always)]
    pub(super) fn quaternion_coefficients(&self) -> (S, S) {
        (self.cos_half, self.half_sinc)
    }
}

/// cos(α/2) and sin(α/2)/α.
#[inline(always)]
fn half<S: Trig>(u: &Vector3<S>, alpha2: S) -> [S; 2] {
    alpha2.branch(
        TURN,
        || {
            let ([c @ .., c8], [s @ .., s8]) = (&HALF_COS, &HALF_SINC);
            [longer(alpha2, c, *c8), longer(alpha2, s, *s8)]
        },
        || {
            let alpha = alpha2.sqrt();
            let (s, c) = (S::lit(0.5) * alpha).sin_cos();
            // |sin| < 0.1 says |cos| > 0.9; asked together, both are wanted here, and come from one call.
            let (s, c) = match s.abs().any_below(REFINE) & !c.abs().all_below(0.9) {
                true => refined(u, alpha, s, c),
                false => (s, c),
            };
            [c, s * (S::lit(1.0) / alpha)] // the quotient does not wait for the sine
        },
    )
}

/// u is exact, α = fl|u| is not. Near α = 2πk that rounding would be magnified by α/|α − 2πk|;
/// turning by what is missing takes it back.
#[cold]
#[inline(never)]
fn refined<S: Trig>(u: &Vector3<S>, alpha: S, s: S, c: S) -> (S, S) {
    let (se, ce) = (S::lit(0.5) * norm_remainder(u, alpha)).sin_cos();
    (s * ce + c * se, c * ce - s * se)
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
    let x2 = x * x;
    even(x, x2, c, pair(x, c[6], c[7]))
}

/// Σ c_k x^k + `last`·x⁸ in Estrin's order.
#[inline(always)]
fn longer<S: Real>(x: S, c: &[f64; 8], last: f64) -> S {
    let x2 = x * x;
    even(x, x2, c, S::lit(last).mul_add(x2, pair(x, c[6], c[7])))
}

/// c₀ + … + c₅x⁵ + x⁶·rest.
#[inline(always)]
fn even<S: Real>(x: S, x2: S, c: &[f64; 8], rest: S) -> S {
    let low = pair(x, c[2], c[3]).mul_add(x2, pair(x, c[0], c[1]));
    let high = rest.mul_add(x2, pair(x, c[4], c[5]));
    high.mul_add(x2 * x2, low)
}

/// a + bx.
#[inline(always)]
fn pair<S: Real>(x: S, a: f64, b: f64) -> S {
    S::lit(b).mul_add(x, S::lit(a))
}
