//! The elliptic functions of an orbit and the angle that it sweeps, by Jacobi's theta functions.
//!
//! v = πτ/(2K), q = exp(−πK'/K), and ϑ₁(v ± iη) vanish where m_x² + m_y² = A²(cn²τ + n sn²τ) does:
//! η = πα/(2K) with sn(α, k') = n^{−½}, n = B²/A² ≥ 1.
//!
//! sn τ = ϑ₃ϑ₁(v)/(ϑ₂ϑ₄(v)), cn τ = ϑ₄ϑ₂(v)/(ϑ₂ϑ₄(v)), dn τ = ϑ₄ϑ₃(v)/(ϑ₃ϑ₄(v)), constants ϑ_i at 0;
//! the precession angle is the mean rate times t, and ±arg(iϑ₁(v − iη) e^{−iv}), of period 2K.
//!
//! Every series is a polynomial in x = sin²v, times 1, sin v or cos v. Its coefficients depend on the orbit. For q ≤
//! [`Q_MAX`] six terms are enough, |c_6| < 1e-19. E = e^{−2η} and ρ = q/E are at most 1, and the coefficients of the
//! last series are q^{n²}ρⁿ(1 ± E^{2n+1}). So nothing overflows if the body is nearly symmetric (q → 0, η → ∞), and
//! nothing cancels for η → 0.
//!
//! Source: notes on E. T. Whittaker & G. N. Watson, A Course of Modern Analysis, ch. XXI, XXII.

use core::f64::consts::FRAC_PI_2;

use crate::elliptic::rf;
use crate::error::Error;
use crate::scalar::Trig;

/// The largest nome: 1 − k² = 0.0129.
const Q_MAX: f64 = 0.25;
/// The largest n. η is about n^{−½}, and p turns by a radian while v moves by η: more would cost digits.
const N_MAX: f64 = 1e4;
const TERMS: usize = 6;

/// Coefficients of 1, x, x², …
type Poly = [f64; TERMS];

const ONE: Poly = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];

#[inline(always)]
fn at(p: &Poly, x: f64) -> f64 {
    let x2 = x * x;
    (p[0] + p[1] * x) + x2 * ((p[2] + p[3] * x) + x2 * (p[4] + p[5] * x))
}

/// Σ w_n p_n with p_{n+1} = 2(1 − 2x)p_n − p_{n−1}, p₀ = 1: the p_n are cos 2nv from p₋₁ = cos 2v,
/// cos (2n+1)v/cos v from 1, sin (2n+1)v/sin v from −1.
fn sum(mut before: Poly, weight: impl Fn(i32) -> f64) -> Poly {
    let (mut p, mut total) = (ONE, [0.0; TERMS]);
    for n in 0..TERMS as i32 {
        let w = weight(n);
        for (t, p) in total.iter_mut().zip(p) {
            *t += w * p;
        }
        let mut next: Poly = core::array::from_fn(|i| 2.0 * p[i] - before[i]);
        for i in 1..TERMS {
            next[i] -= 4.0 * p[i - 1];
        }
        (before, p) = (p, next);
    }
    total
}

fn scaled(s: f64, p: Poly) -> Poly {
    p.map(|c| s * c)
}

/// The series of one orbit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Theta {
    /// v/τ.
    frequency: f64,
    /// The numerators of sn/sin v, cn/cos v and dn, and ϑ₄(v).
    sn: Poly,
    cn: Poly,
    dn: Poly,
    denominator: Poly,
    /// With X/cos v = `real` and Y/sin v − X/cos v = `rest` for X + iY ∝ iϑ₁(v − iη).
    real: Poly,
    rest: Poly,
}

impl Theta {
    /// From 1 − k², K and n; `None` if the nome is above [`Q_MAX`], or n above [`N_MAX`].
    pub(super) fn new(kc2: f64, quarter: f64, n: f64) -> Result<Option<Self>, Error> {
        let frequency = FRAC_PI_2 / quarter;
        let k2 = 1.0 - kc2;
        let q = match k2 > 0.0 {
            true => (-2.0 * frequency * rf(0.0, k2, 1.0)?).exp(),
            false => 0.0,
        };
        if q > Q_MAX || n > N_MAX {
            return Ok(None);
        }
        let cos2 = (n - 1.0) / n;
        let eta = match cos2 > 0.0 {
            true => frequency * rf(cos2, 1.0 - kc2 / n, 1.0)? / n.sqrt(),
            false => f64::INFINITY,
        };
        let nome = (-2.0 * eta).exp();
        let ratio = if nome > 0.0 { (q / nome).min(1.0) } else { 0.0 };

        let sign = |n: i32| if n % 2 == 0 { 1.0 } else { -1.0 };
        let half = |n: i32| q.powi(n * (n + 1));
        let whole = |n: i32| if n == 0 { 1.0 } else { 2.0 * q.powi(n * n) };
        let shifted = |n: i32| sign(n) * q.powi(n * n) * ratio.powi(n);
        let minus_one = scaled(-1.0, ONE);
        let double = [1.0, -2.0, 0.0, 0.0, 0.0, 0.0];

        let one = sum(minus_one, |n| sign(n) * half(n));
        let two = sum(ONE, half);
        let three = sum(double, whole);
        let four = sum(double, |n| sign(n) * whole(n));
        let odd = |n: i32| -2.0 * eta * f64::from(2 * n + 1);
        let real = sum(ONE, |n| -shifted(n) * odd(n).exp_m1());
        let imaginary = sum(minus_one, |n| shifted(n) * (1.0 + odd(n).exp()));
        Ok(Some(Theta {
            frequency,
            sn: scaled(three[0] / two[0], one),
            cn: scaled(four[0] / two[0], two),
            dn: scaled(four[0] / three[0], three),
            denominator: four,
            real,
            rest: core::array::from_fn(|i| imaginary[i] - real[i]),
        }))
    }

    /// (sin v, cos v).
    #[inline]
    pub(super) fn angle(&self, tau: f64) -> (f64, f64) {
        Trig::sin_cos(self.frequency * tau)
    }

    /// sn, cn and dn at (sin v, cos v).
    #[inline]
    pub(super) fn jacobi(&self, (s, c): (f64, f64)) -> (f64, f64, f64) {
        let x = s * s;
        let inverse = 1.0 / at(&self.denominator, x);
        (s * at(&self.sn, x) * inverse, c * at(&self.cn, x) * inverse, at(&self.dn, x) * inverse)
    }

    /// (sin p, cos p) of p = arg(iϑ₁(v − iη) e^{−iv}) at (sin v, cos v).
    #[inline]
    pub(super) fn periodic(&self, (s, c): (f64, f64)) -> (f64, f64) {
        let x = s * s;
        let (real, rest) = (at(&self.real, x), at(&self.rest, x));
        let (cos, sin) = (real + x * rest, s * c * rest);
        let inverse = 1.0 / (cos * cos + sin * sin).sqrt();
        (sin * inverse, cos * inverse)
    }
}
