//! The Taylor coefficients of the rotation of a free body, and what is made of them.

use nalgebra::{Matrix3, Vector3};

use super::lanes::{INVERSE, Kernel, Lanes, Wide};
use crate::error::StepError;
use crate::scalar::Real;

/// What the recurrences need of a body.
#[derive(Clone, Copy)]
pub(super) struct Body<S> {
    /// ṁ_i = rate_i m_j m_k.
    rate: [S; 4],
    /// ω/2 = half·m.
    half: [S; 4],
}

/// 𝟙 as a quaternion.
#[inline(always)]
fn unit<S: Real>() -> [S; 4] {
    [0.0, 0.0, 0.0, 1.0].map(S::lit)
}

impl<S: Wide> Body<S> {
    #[inline(always)]
    pub(super) fn new(j: &Vector3<S>) -> Self {
        let (zero, half) = (S::lit(0.0), S::lit(0.5));
        Body {
            rate: [j[2] - j[1], j[0] - j[2], j[1] - j[0], zero],
            half: [half * j[0], half * j[1], half * j[2], zero],
        }
    }

    /// The coefficients q₁ hᵏ, …, q_N hᵏ of the quaternion.
    #[inline(always)]
    fn terms<L: Lanes<S>, const N: usize>(&self, l: L, h: S, m: L::V) -> [L::V; N] {
        const { assert!(4 <= N && N <= INVERSE.len(), "4 ≤ order ≤ 16") };
        let zero = l.splat(S::lit(0.0));
        let (rate, half, h) = (l.load(self.rate), l.load(self.half), l.splat(h));
        let mut ms = [[zero; 2]; N];
        let mut ws = [[zero; 3]; N];
        // q_j ∘ e_i.
        let mut turned = [[zero; 3]; N];
        let mut out = [zero; N];
        let (mut m, mut q) = (m, l.load(unit()));
        for k in 0..N {
            ms[k] = l.cycled(m);
            ws[k] = l.spread(l.mul(half, m));
            turned[k] = l.products(q);
            let mut sum = zero;
            let mut sums = [zero; 3];
            for i in 0..=k {
                sum = l.mul_add(ms[i][0], ms[k - i][1], sum);
                for a in 0..3 {
                    sums[a] = l.mul_add(turned[i][a], ws[k - i][a], sums[a]);
                }
            }
            let scale = l.mul(h, l.splat(S::inverse(k)));
            q = l.mul(scale, l.add(sums[0], l.add(sums[1], sums[2])));
            m = l.mul(l.mul(scale, rate), sum);
            out[k] = q;
        }
        out
    }
}

/// |v|².
#[inline(always)]
fn square<S: Real, L: Lanes<S>>(l: L, v: L::V) -> S {
    let [x, y, z, w] = l.store(l.mul(v, v));
    (x + y) + (z + w)
}

/// One step: the quaternion at h, not yet of length 1, and the squares of its last two terms.
pub(super) struct OneStep<'a, S, const N: usize> {
    pub(super) body: &'a Body<S>,
    pub(super) h: S,
    pub(super) m: Vector3<S>,
}

impl<S: Wide, const N: usize> Kernel<S> for OneStep<'_, S, N> {
    type Out = ([S; 4], [S; 2]);

    #[inline(always)]
    fn run<L: Lanes<S>>(self, l: L) -> Self::Out {
        let m = l.load([self.m[0], self.m[1], self.m[2], S::lit(0.0)]);
        let terms = self.body.terms::<L, N>(l, self.h, m);
        let mut sum = l.splat(S::lit(0.0));
        for term in terms.iter().rev() {
            sum = l.add(sum, *term); // small terms first
        }
        let q = l.add(sum, l.load(unit()));
        (l.store(q), [square(l, terms[N - 2]), square(l, terms[N - 1])])
    }
}

/// The rotation of a quaternion of any length.
#[inline(always)]
pub(super) fn rotation<S: Real>([x, y, z, w]: [S; 4]) -> Matrix3<S> {
    let one = S::lit(1.0);
    let s = S::lit(2.0) / ((x * x + y * y) + (z * z + w * w));
    let (sx, sy, sz) = (s * x, s * y, s * z);
    let (xx, yy, zz) = (sx * x, sy * y, sz * z);
    let (xy, xz, yz) = (sx * y, sx * z, sy * z);
    let (wx, wy, wz) = (sx * w, sy * w, sz * w);
    #[rustfmt::skip]
    let g = Matrix3::new(
        one - yy - zz, xy - wz, xz + wy,
        xy + wz, one - xx - zz, yz - wx,
        xz - wy, yz + wx, one - xx - yy,
    );
    g
}

/// Many steps, each as long as the tolerance allows.
pub(super) struct Advance<'a, const N: usize> {
    pub(super) body: &'a Body<f64>,
    pub(super) span: f64,
    pub(super) tolerance: f64,
    /// A guess of the first step, of the sign of the span.
    pub(super) guess: f64,
    pub(super) m: Vector3<f64>,
}

/// Where a run came to.
pub(super) struct Reached {
    pub(super) steps: u64,
    /// The last step.
    pub(super) h: f64,
    pub(super) m: Vector3<f64>,
    /// The rotation since the start, of any length.
    pub(super) q: [f64; 4],
    /// Why it stopped before the end.
    pub(super) failed: Option<StepError>,
}

/// More steps than this count as a mistake in the input.
const STEPS_MAX: u64 = 1_000_000_000;
/// The most that one step grows against the one before.
const GROWTH: f64 = 4.0;
/// Attempts at the size of one step.
const TRIES: u32 = 200;

/// x^(1/k) for x > 0, by the exponent and a straight line through the mantissa: within 6 %, and
/// better next to 1. It chooses steps, and is a tenth of the time of `powf`.
#[inline(always)]
fn coarse_root(x: f64, k: usize) -> f64 {
    const ONE: i64 = 1.0f64.to_bits() as i64;
    f64::from_bits((ONE + (x.to_bits() as i64 - ONE) / k as i64) as u64)
}

/// The θ at which the last two terms fall to the tolerance, by their squares; infinite when they
/// vanish, NaN when they are not finite.
#[inline(always)]
pub(super) fn reach<const N: usize>(squares: [f64; 2], tolerance: f64) -> f64 {
    let one = |square: f64, k: usize| {
        let x = tolerance * tolerance / square;
        if x.is_normal() { coarse_root(x, 2 * k) } else { x }
    };
    let (a, b) = (one(squares[0], N - 1), one(squares[1], N));
    if a < b || a.is_nan() { a } else { b }
}

impl<const N: usize> Kernel<f64> for Advance<'_, N> {
    type Out = Reached;

    #[inline(always)]
    fn run<L: Lanes<f64>>(self, l: L) -> Reached {
        let Advance { body, span, tolerance, mut guess, m } = self;
        let unit = l.load(unit());
        let mut m = l.load([m[0], m[1], m[2], 0.0]);
        let mut whole = unit;
        let mut passed = 0.0;
        let (mut steps, mut tries, mut failed) = (0, 0, None);
        while passed != span {
            let left = span - passed;
            let terms = body.terms::<L, N>(l, guess, m);
            let theta = reach::<N>([square(l, terms[N - 2]), square(l, terms[N - 1])], tolerance);
            // A guess that is far off is made again, nearer: the terms are not to overflow.
            if !(1.0 / GROWTH..).contains(&theta) && tries < TRIES {
                guess *= if theta > 0.0 { theta.max(1e-3) } else { 1e-3 };
                tries += 1;
                continue;
            }
            tries = 0;
            let step = guess * theta.min(GROWTH);
            if step == 0.0 || step.is_nan() || steps == STEPS_MAX {
                let what = if steps == STEPS_MAX { "the span in 1e9 steps" } else { "the step" };
                failed = Some(StepError::NotConverged { what });
                break;
            }
            let last = step.abs() >= left.abs();
            let theta = if last { left / guess } else { step / guess };
            // Even and odd powers each by Horner's rule.
            let (t, t2) = (l.splat(theta), l.splat(theta * theta));
            let (mut even, mut odd) = (l.splat(0.0), l.splat(0.0));
            for k in (0..N).rev() {
                match k % 2 {
                    0 => odd = l.mul_add(odd, t2, terms[k]),
                    _ => even = l.mul_add(even, t2, terms[k]),
                }
            }
            let q = l.mul_add(even, t2, l.mul_add(odd, t, unit));
            let length = square(l, q);
            if !length.is_finite() {
                failed = Some(StepError::NotFinite { what: "the rotation" });
                break;
            }
            m = turn_back(l, q, length, m);
            whole = product(l, whole, q);
            passed = if last { span } else { passed + step };
            guess = step;
            steps += 1;
        }
        let [x, y, z, _] = l.store(m);
        Reached { steps, h: guess, m: Vector3::new(x, y, z), q: l.store(whole), failed }
    }
}

/// p ∘ q.
#[inline(always)]
fn product<L: Lanes<f64>>(l: L, p: L::V, q: L::V) -> L::V {
    let [x, y, z] = l.spread(q);
    let [a, b, c] = l.products(p);
    let w = l.splat(l.store(q)[3]);
    l.add(l.mul_add(a, x, l.mul(b, y)), l.mul_add(c, z, l.mul(p, w)))
}

/// Rᵀm for the rotation R of q = (v, w): m + 2/|q|² (v × (v × m) − w v × m).
#[inline(always)]
fn turn_back<L: Lanes<f64>>(l: L, q: L::V, length: f64, m: L::V) -> L::V {
    let cross = |a: L::V, b: L::V| {
        let minus = l.splat(-1.0);
        let crossed = l.mul_add(a, l.cycled(b)[0], l.mul(minus, l.mul(l.cycled(a)[0], b)));
        l.cycled(crossed)[0]
    };
    let v = l.mul(q, l.load([1.0, 1.0, 1.0, 0.0]));
    let vm = cross(v, m);
    let minus_w = l.splat(-l.store(q)[3]);
    let turn = l.mul_add(minus_w, vm, cross(v, vm));
    l.mul_add(l.splat(2.0 / length), turn, m)
}
