//! The Taylor coefficients of a free body, of its momentum and of its rotation, and the steps from them.

use nalgebra::{Matrix3, Vector3};

use super::lanes::{INVERSE, Kernel, Lanes, Wide};
use crate::error::StepError;
use crate::scalar::Real;
use crate::space::Metric;

/// The constants of a body in the recurrences.
#[derive(Clone, Copy)]
pub(super) struct Body<S> {
    /// ṁ_i = rate_i m_j m_k.
    rate: [S; 4],
    /// ω/2 = half·m.
    half: [S; 4],
}

/// What a Taylor series is of: four numbers that follow from the momentum at the start.
pub(super) trait Unknown<S: Wide>: Copy {
    /// The recurrence of its coefficients.
    type Terms<L: Lanes<S>, const N: usize>: Recurrence<S, L>;

    /// The value at the start.
    fn start(self, m: &Vector3<S>) -> [S; 4];
}

/// The quaternion of the rotation of the body frame, from 𝟙.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quaternion;

impl<S: Wide> Unknown<S> for Quaternion {
    type Terms<L: Lanes<S>, const N: usize> = Turns<S, L, N>;

    #[inline(always)]
    fn start(self, _: &Vector3<S>) -> [S; 4] {
        unit()
    }
}

/// The momentum in the body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Momentum;

impl<S: Wide> Unknown<S> for Momentum {
    type Terms<L: Lanes<S>, const N: usize> = Momenta<S, L, N>;

    #[inline(always)]
    fn start(self, m: &Vector3<S>) -> [S; 4] {
        [m[0], m[1], m[2], S::lit(0.0)]
    }
}

/// A recurrence of Taylor coefficients.
pub(super) trait Recurrence<S, L: Lanes<S>> {
    /// The coefficients for steps of size h from the momentum m.
    fn new(l: L, body: &Body<S>, h: S, m: L::V) -> Self;
    /// The coefficient of hᵏ⁺¹, times that, from all up to k.
    fn next(&mut self, k: usize) -> L::V;
}

/// The coefficients c₁ h, …, c_N hᴺ.
#[inline(always)]
fn terms<S: Wide, L: Lanes<S>, U: Unknown<S>, const N: usize>(
    (l, _): (L, U),
    body: &Body<S>,
    h: S,
    m: L::V,
) -> [L::V; N] {
    const { assert!(4 <= N && N <= INVERSE.len(), "4 ≤ order ≤ 16") };
    let mut out = [l.splat(S::lit(0.0)); N];
    let mut to_k = U::Terms::<L, N>::new(l, body, h, m);
    // In a loop the sums of products, whose number changes from one k to the next, take a fifth more time.
    macro_rules! each {
        ($($k:literal)*) => {{$(if $k < N { out[$k] = to_k.next($k); })*}};
    }
    match L::IS_UNROLLED {
        true => each!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15),
        false => (0..N).for_each(|k| out[k] = to_k.next(k)),
    }
    out
}

/// 𝟙 as a quaternion.
#[inline(always)]
fn unit<S: Real>() -> [S; 4] {
    // No `map`: in a build without LTO it is a call.
    [S::lit(0.0), S::lit(0.0), S::lit(0.0), S::lit(1.0)]
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
}

/// m_{k+1} hᵏ⁺¹ = rate·Σ_j (m_j)_yzx (m_{k−j})_zxy, `rate` with the factor h/(k+1). `m` are the factors of m_k, `first` those of
/// m_0, and `older` is the sum for 0 < j < k.
#[inline(always)]
fn next_momentum<S, L: Lanes<S>>(
    l: L,
    k: usize,
    rate: L::V,
    [m_yzx, m_zxy]: [L::V; 2],
    first: [L::V; 2],
    older: L::V,
) -> L::V {
    let next = l.mul_add(m_yzx, l.mul(rate, first[1]), l.mul(rate, older));
    if k > 0 { l.mul_add(m_zxy, l.mul(rate, first[0]), next) } else { next }
}

/// The coefficients m_k hᵏ, and the factors of the products of all before.
pub(super) struct Momenta<S, L: Lanes<S>, const N: usize> {
    l: L,
    rate: L::V,
    h: L::V,
    /// (y, z, x) and (z, x, y) of m_0.
    first: [L::V; 2],
    m: L::V,
    /// (y, z, x) of m.
    left: [L::V; N],
    /// (z, x, y) of m.
    right: [L::V; N],
}

impl<S: Wide, L: Lanes<S>, const N: usize> Recurrence<S, L> for Momenta<S, L, N> {
    #[inline(always)]
    fn new(l: L, body: &Body<S>, h: S, m: L::V) -> Self {
        let none = [l.splat(S::lit(0.0)); N];
        let (rate, first) = (l.load(body.rate), l.cycled(m));
        Momenta { l, rate, h: l.splat(h), first, m, left: none, right: none }
    }

    /// m_{k+1} hᵏ⁺¹.
    #[inline(always)]
    fn next(&mut self, k: usize) -> L::V {
        let Momenta { l, rate, h, first, m, ref mut left, ref mut right } = *self;
        let factors = l.cycled(m);
        [left[k], right[k]] = factors;
        // As in `Turns`.
        let mut sums = [l.splat(S::lit(0.0)); 2];
        for j in k.div_ceil(2)..k {
            sums[0] = l.mul_add(left[j], right[k - j], sums[0]);
            if j != k - j {
                sums[1] = l.mul_add(left[k - j], right[j], sums[1]);
            }
        }
        let rate = l.mul(l.mul(h, l.splat(S::inverse(k))), rate);
        self.m = next_momentum(l, k, rate, factors, first, l.add(sums[0], sums[1]));
        self.m
    }
}

/// The coefficients m_k hᵏ and q_k hᵏ, and the factors of the products of all before.
pub(super) struct Turns<S, L: Lanes<S>, const N: usize> {
    l: L,
    rate: L::V,
    half: L::V,
    h: L::V,
    /// (y, z, x) and (z, x, y) of m_0.
    first: [L::V; 2],
    /// ω_0/2, each number in all lanes.
    omega: [L::V; 3],
    m: L::V,
    q: L::V,
    /// q ∘ e_i, and (y, z, x) of m.
    left: [[L::W; 2]; N],
    /// ω/2, each number in all lanes, and (z, x, y) of m.
    right: [[L::W; 2]; N],
}

impl<S: Wide, L: Lanes<S>, const N: usize> Recurrence<S, L> for Turns<S, L, N> {
    #[inline(always)]
    fn new(l: L, body: &Body<S>, h: S, m: L::V) -> Self {
        let (rate, half) = (l.load(body.rate), l.load(body.half));
        let (first, omega) = (l.cycled(m), l.spread(l.mul(half, m)));
        let q = l.splat(S::lit(0.0));
        let none = [[l.pair([q; 2]); 2]; N];
        Turns { l, rate, half, h: l.splat(h), first, omega, m, q, left: none, right: none }
    }

    /// q_{k+1} hᵏ⁺¹.
    #[inline(always)]
    fn next(&mut self, k: usize) -> L::V {
        let Turns { l, rate, half, h, first, omega, m, q, ref mut left, ref mut right } = *self;
        let w = l.mul(half, m);
        let [m_yzx, m_zxy] = l.cycled(m);
        let [w_x, w_y, w_z] = l.spread(w);
        let [q_x, q_y, q_z] = l.products(q);
        left[k] = [l.pair([q_x, q_y]), l.pair([q_z, m_yzx])];
        right[k] = [l.pair([w_x, w_y]), l.pair([w_z, m_zxy])];
        // What is older than m_k and q_k is summed while these are on their way; q_0 ∘ ω = ω. Two sums do not wait for
        // each other.
        let mut sums = [[l.pair([l.splat(S::lit(0.0)); 2]); 2]; 2];
        for j in k.div_ceil(2)..k {
            for a in [0, 1] {
                sums[0][a] = l.mul_add_pairs(left[j][a], right[k - j][a], sums[0][a]);
                if j != k - j {
                    sums[1][a] = l.mul_add_pairs(left[k - j][a], right[j][a], sums[1][a]);
                }
            }
        }
        let [[xy, z_m], [xy_2, z_m_2]] = sums;
        let ([x, y], [z, of_m]) = (l.halves(xy), l.halves(z_m));
        let ([x_2, y_2], [z_2, of_m_2]) = (l.halves(xy_2), l.halves(z_m_2));
        let older = l.add(l.add(z, z_2), l.add(l.add(x, x_2), l.add(y, y_2)));
        let of_m = l.add(of_m, of_m_2);

        let scale = l.mul(h, l.splat(S::inverse(k)));
        self.m = next_momentum(l, k, l.mul(scale, rate), [m_yzx, m_zxy], first, of_m);
        // No `map`: in a build of many units without LTO it leaves the lanes.
        let omega = [l.mul(scale, omega[0]), l.mul(scale, omega[1]), l.mul(scale, omega[2])];
        self.q = l.add(
            l.mul_add(q_x, omega[0], l.mul_add(scale, w, l.mul(scale, older))),
            l.mul_add(q_y, omega[1], l.mul(q_z, omega[2])),
        );
        self.q
    }
}

/// |v|².
#[inline(always)]
fn square<S: Real, L: Lanes<S>>(l: L, v: L::V) -> S {
    square_of(l.store(v))
}

/// A step: the unknown at h, not yet of its length. `terms` ← the coefficients of θ, …, θᴺ of the unknown at θh.
pub(super) struct OneStep<'a, S, U, const N: usize> {
    pub(super) of: U,
    pub(super) body: &'a Body<S>,
    pub(super) h: S,
    pub(super) m: Vector3<S>,
    pub(super) terms: &'a mut [[S; 4]; N],
}

impl<S: Wide, U: Unknown<S>, const N: usize> Kernel<S> for OneStep<'_, S, U, N> {
    type Out = [S; 4];

    #[inline(always)]
    fn run<L: Lanes<S>>(self, l: L) -> [S; 4] {
        let OneStep { of, body, h, m, terms } = self;
        let found: [L::V; N] = self::terms((l, of), body, h, l.load(Momentum.start(&m)));
        // As `At` has it for θ = 1.
        let mut sums = [l.splat(S::lit(0.0)); 2];
        for k in (0..N).rev() {
            terms[k] = l.store(found[k]);
            sums[k % 2] = l.add(sums[k % 2], found[k]);
        }
        l.store(l.add(l.add(sums[0], sums[1]), l.load(of.start(&m))))
    }
}

/// The unknown at θh, not of its length: odd and even powers each by Horner's rule.
pub(super) struct At<'a, S, const N: usize> {
    /// The unknown at 0.
    pub(super) start: [S; 4],
    pub(super) terms: &'a [[S; 4]; N],
    pub(super) theta: S,
}

impl<S: Wide, const N: usize> Kernel<S> for At<'_, S, N> {
    type Out = [S; 4];

    #[inline(always)]
    fn run<L: Lanes<S>>(self, l: L) -> [S; 4] {
        let At { start, terms, theta } = self;
        let (theta, square) = (l.splat(theta), l.splat(theta * theta));
        let mut sums = [l.splat(S::lit(0.0)); 2];
        for k in (0..N).rev() {
            sums[k % 2] = l.mul_add(sums[k % 2], square, l.load(terms[k]));
        }
        let [odd, even] = sums;
        l.store(l.mul_add(l.mul_add(even, theta, odd), theta, l.load(start)))
    }
}

/// The error of a step of an unknown of this size: the last term, or the one before to the power N/(N − 1), because one of
/// both may vanish where the motion is even or odd.
#[inline(always)]
pub(super) fn error<S: Real + Into<f64>, const N: usize>(terms: &[[S; 4]; N], size: f64) -> f64 {
    let (before, last): (f64, f64) =
        (square_of(terms[N - 2]).into(), square_of(terms[N - 1]).into());
    let root = coarse_root(before, size * size, 2 * (N - 1));
    last.sqrt().max(before.sqrt() * root)
}

/// |term|².
#[inline(always)]
pub(super) fn square_of<S: Real>([x, y, z, w]: [S; 4]) -> S {
    (x * x + y * y) + (z * z + w * w)
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

/// A run of many steps, each as long as the tolerance allows.
pub(super) struct Advance<'a, const N: usize> {
    pub(super) body: &'a Body<f64>,
    pub(super) span: f64,
    pub(super) tolerance: f64,
    /// A guess of the first step, with the sign of the span.
    pub(super) guess: f64,
    pub(super) m: Vector3<f64>,
}

/// The end of a run.
pub(super) struct EndPoint {
    pub(super) steps: u64,
    /// The last step.
    pub(super) h: f64,
    pub(super) m: Vector3<f64>,
    /// The rotation since the start, of any length.
    pub(super) q: [f64; 4],
    /// Why it stopped before the end.
    pub(super) failed: Option<StepError>,
}

/// The largest number of steps; more are a mistake in the input.
const STEPS_MAX: u64 = 1_000_000_000;
/// The largest factor from one step size to the next.
const GROWTH: f64 = 4.0;
/// The largest number of attempts to find the size of a step.
const TRIES: u32 = 200;

/// (x/y)^(1/k) for x, y > 0, within 6 %, and better near 1. It uses the exponents, and a straight line through the
/// mantissas. It chooses step sizes, and takes a tenth of the time of `powf`.
#[inline(always)]
fn coarse_root(x: f64, y: f64, k: usize) -> f64 {
    const ONE: i64 = 1.0f64.to_bits() as i64;
    match x.is_normal() && y.is_normal() {
        true => f64::from_bits((ONE + (x.to_bits() as i64 - y.to_bits() as i64) / k as i64) as u64),
        false => x / y,
    }
}

/// The θ at which the last two terms equal the tolerance, from their squares; infinite if they vanish, NaN if they are
/// not finite.
#[inline(always)]
pub(super) fn reach<const N: usize>(squares: [f64; 2], tolerance: f64) -> f64 {
    let one = |square: f64, k: usize| coarse_root(tolerance * tolerance, square, 2 * k);
    let (a, b) = (one(squares[0], N - 1), one(squares[1], N));
    if a < b || a.is_nan() { a } else { b }
}

impl<const N: usize> Kernel<f64> for Advance<'_, N> {
    type Out = EndPoint;

    #[inline(always)]
    fn run<L: Lanes<f64>>(self, l: L) -> EndPoint {
        let Advance { body, span, tolerance, mut guess, m } = self;
        let unit = l.load(unit());
        let mut m = l.load([m[0], m[1], m[2], 0.0]);
        let mut whole = unit;
        let mut passed = 0.0;
        let (mut steps, mut tries, mut failed) = (0, 0, None);
        while passed != span {
            let left = span - passed;
            let terms: [L::V; N] = self::terms((l, Quaternion), body, guess, m);
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
            // Each fourth power by Horner's rule.
            let (t, t2) = (l.splat(theta), l.splat(theta * theta));
            let t4 = l.mul(t2, t2);
            let mut sums = [l.splat(0.0); 4];
            for k in (0..N).rev() {
                sums[k % 4] = l.mul_add(sums[k % 4], t4, terms[k]);
            }
            let low = l.mul_add(sums[0], t, unit);
            let high = l.mul_add(sums[2], t, sums[1]);
            let q = l.mul_add(l.mul_add(sums[3], t2, high), t2, low);
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
        EndPoint { steps, h: guess, m: Vector3::new(x, y, z), q: l.store(whole), failed }
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
    // The last number of m is 0, and so are those of the products.
    let cross = |a: L::V, b: L::V| {
        let crossed = l.mul_sub(a, l.cycled(b)[0], l.mul(l.cycled(a)[0], b));
        l.cycled(crossed)[0]
    };
    let vm = cross(q, m);
    let minus_w = l.splat(-l.store(q)[3]);
    let turn = l.mul_add(minus_w, vm, cross(q, vm));
    l.mul_add(l.splat(2.0 / length), turn, m)
}

/// The terms of the last step, for the points within it.
#[derive(Clone, Debug)]
pub(super) struct Terms<S, U, const N: usize> {
    unknown: U,
    pub(super) terms: [[S; 4]; N],
    /// The size of that step, and the momentum at its start.
    pub(super) of: Option<(S, Vector3<S>)>,
}

impl<S: Wide, U: Unknown<S>, const N: usize> Terms<S, U, N> {
    pub(super) fn new(unknown: U) -> Self {
        Terms { unknown, terms: [[S::lit(0.0); 4]; N], of: None }
    }

    /// The sum of the series of a step of size h from the momentum m. The terms are then those of this step.
    #[inline(always)]
    pub(super) fn step(&mut self, j: &Vector3<S>, h: S, m: Vector3<S>) -> [S; 4] {
        self.of = Some((h, m));
        let (of, body) = (self.unknown, &Body::new(j));
        S::dispatch(OneStep { of, body, h, m, terms: &mut self.terms })
    }

    /// True if the terms are those of this step.
    pub(super) fn is_of(&self, h: S, m: &Vector3<S>) -> bool {
        self.of.is_some_and(|(of, from)| of == h && from.is_same(m))
    }

    /// The sum of the series at θh, for a step from the momentum m.
    #[inline(always)]
    pub(super) fn at(&self, m: &Vector3<S>, theta: S) -> [S; 4] {
        S::dispatch(At { start: self.unknown.start(m), terms: &self.terms, theta })
    }

    pub(super) fn each_term(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.of = None;
        self.terms.iter_mut().flatten().for_each(|x| x.each_number(each));
    }
}
