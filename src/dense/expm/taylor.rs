//! Taylor polynomials of exp with few products.
//!
//! | degree | products | θ | form |
//! |---|---|---|---|
//! | 1, 2 | 0, 1 | 2.2e-16, 2.6e-8 | the sum |
//! | 4 | 2 | 3.4e-4 | 𝟙 + a + a²(½ + a/6 + a²/24) |
//! | 8 | 3 | 5.0e-2 | a⁴ = a²(x₁a + x₂a²), a⁸ = (x₃a² + a⁴)(x₄ + x₅a + x₆a² + x₇a⁴), 𝟙 + a + y₂a² + a⁸ |
//! | 12 | 4 | 0.30 | s = b₂ + b₃², b₀ + (b₁ + s)s, the b over 𝟙, a, a², a³ |
//! | 18 | 5 | 1.09 | s = b₃ + b₀b₄, b₁ + (b₂ + s)s, the b over 𝟙, a, a², a³, a⁶ |
//!
//! Source: P. Bader, S. Blanes, F. Casas, Computing the matrix exponential with an optimized Taylor
//! polynomial approximation, Mathematics 7 (2019) 1174. There s has a constant term σ, and 𝟙 is a
//! sum of products of constants, with the same rounding error at every call. This is a bias of ε/2 in every step of a
//! long run. Here s has no constant term, and 𝟙 is exact. The coefficients are those of the source, combined in 40
//! digits. Expanded, the forms agree with 1/k! to 1e-40 (8), 1e-19 (12), 5e-17 (18). For norms up to θ the relative
//! backward error is at most 2⁻⁵³. θ was recomputed from the series of log(e⁻ˣT(x)).

use pulp::Simd;

pub(super) const THETA_1: f64 = 2.220446049250313e-16;
pub(super) const THETA_2: f64 = 2.5809568029463e-8;
pub(super) const THETA_4: f64 = 3.3971688399769620e-4;
pub(super) const THETA_8: f64 = 4.9912288711153227e-2;
pub(super) const THETA_12: f64 = 2.9961589138115805e-1;
pub(super) const THETA_18: f64 = 1.0908637192900362;

/// x₁, …, x₇, y₂ of degree 8: in ℚ(√177).
pub(super) const T8: [f64; 8] = [
    0.10836465678522780852,
    0.027091164196306952131,
    2.0 / 3.0,
    0.54676145797072405251,
    0.16112557339541759283,
    0.014090917158378207731,
    0.033792797010870504141,
    0.13549236135285063166,
];

/// b₀, …, b₃ of degree 12 over 𝟙, a, a², a³.
#[rustfmt::skip]
pub(super) const B12: [[f64; 4]; 4] = [
    [1.0, 0.687454455781804513611, -0.198849242670684445058, -0.044222598444663095082],
    [5.67975635724212133671, 1.19926790417132231573, 0.01179296240992997031, 0.01108844528519167989],
    [0.0, 0.0550279843993089855663, 0.0935159077053626104287, 0.00610700528898340254956],
    [0.0, -0.13181061013830184015, -0.02027855540589259079, -0.00675951846863086359],
];

/// b₀, …, b₄ of degree 18 over 𝟙, a, a², a³, a⁶.
#[rustfmt::skip]
pub(super) const B18: [[f64; 5]; 5] = [
    [0.0, -1.00365581030144618291e-1, -8.02924648241156932449e-3, -8.92138498045729985177e-4, 0.0],
    [1.0, 0.245910220901108626013, 1.36266708320819048533, 0.498921025691694264521,
        -0.000640927430058536609195],
    [-11.148502971774368303, 1.68015813878906206114, 5.71779846478865511061e-2,
        -6.98210122488052056106e-3, 3.34975017086070470649e-5],
    [0.0, -6.76404519071381882256e-2, 6.75961301770459654925e-2, 2.95552570429315521194e-2,
        -1.39180257516060693404e-5],
    [0.0, 0.0, -9.23364619367118555360e-2, -1.69364939002081722752e-2, -1.40086798182036094347e-5],
];

const fn power(x: f64, p: u32) -> f64 {
    if p == 0 { 1.0 } else { x * power(x, p - 1) }
}

/// θ₁₈⁶.
pub(super) const THETA_18_6: f64 = power(THETA_18, 6);
/// θ₁₈^(18+r) for r = 1, …, 5.
const TAIL: [f64; 5] = [
    power(THETA_18, 19),
    power(THETA_18, 20),
    power(THETA_18, 21),
    power(THETA_18, 22),
    power(THETA_18, 23),
];

/// The halvings that degree 18 needs, by ‖a‖, ‖a²‖, ‖a³‖, ‖a⁶‖ ≤ 1e50.
///
/// The error is a series of aᵏ, k ≥ 19, and ‖a^(18+r)‖ ≤ ‖a⁶‖³·‖aʳ‖; so the norms of the powers
/// decide. At most two halvings fewer than by the norm itself are taken, to limit rounding errors.
#[inline(always)]
pub(super) fn halvings_18(n1: f64, n2: f64, n3: f64, n6: f64) -> u32 {
    let by_norm = halvings(n1, THETA_18, 1);
    let rests = [n1, n2, n3, n3 * n1, n3 * n2];
    let mut s = by_norm.saturating_sub(2);
    for r in 0..5 {
        s = s.max(halvings(n6 * n6 * n6 * rests[r], TAIL[r], 19 + r as i32));
    }
    s.min(by_norm)
}

/// The smallest s with x ≤ limit·2^(p·s), for finite x ≥ 0.
#[inline(always)]
pub(super) fn halvings(x: f64, limit: f64, p: i32) -> u32 {
    let ratio = x / limit;
    if ratio <= 1.0 {
        return 0;
    }
    // ⌈log₂ ratio⌉ from the exponent; then ⌈⌈y⌉/p⌉ = ⌈y/p⌉.
    let bits = ratio.to_bits();
    let floor = (bits >> 52) as i32 - 1023;
    let log2 = floor + i32::from(bits << 12 != 0);
    ((log2 + p - 1) / p) as u32
}

/// 2⁻ˢ, for s ≤ 1022.
#[inline(always)]
pub(super) fn half_to_the(s: u32) -> f64 {
    f64::from_bits((1023 - u64::from(s.min(1022))) << 52)
}

/// The operations that the polynomials need, for matrices in registers.
pub(in crate::dense) trait Packed<S: Simd>: Copy {
    /// a·b.
    fn mul(simd: S, a: &Self, b: &Self) -> Self;
    /// self ← self + a·b.
    fn mul_add(&mut self, simd: S, a: &Self, b: &Self);
    /// Σ c_i·x_i + d·𝟙.
    fn sum<const M: usize>(simd: S, c: [f64; M], x: [&Self; M], d: f64) -> Self;
}

#[inline(always)]
pub(super) fn degree_8<S: Simd, M: Packed<S>>(simd: S, a: &M, a2: &M) -> M {
    let [x1, x2, x3, x4, x5, x6, x7, y2] = T8;
    let a4 = M::mul(simd, a2, &M::sum(simd, [x1, x2], [a, a2], 0.0));
    let left = M::sum(simd, [x3, 1.0], [a2, &a4], 0.0);
    let right = M::sum(simd, [x5, x6, x7], [a, a2, &a4], x4);
    let mut g = M::sum(simd, [1.0, y2], [a, a2], 1.0);
    g.mul_add(simd, &left, &right);
    g
}

#[inline(always)]
pub(super) fn degree_12<S: Simd, M: Packed<S>>(simd: S, a: &M, a2: &M, a3: &M) -> M {
    let all = [a, a2, a3];
    let [c0, c1, c2, c3] = B12;
    let b3 = M::sum(simd, [c3[1], c3[2], c3[3]], all, c3[0]);
    let mut s = M::sum(simd, [c2[1], c2[2], c2[3]], all, c2[0]);
    s.mul_add(simd, &b3, &b3);
    let left = M::sum(simd, [c1[1], c1[2], c1[3], 1.0], [a, a2, a3, &s], c1[0]);
    let mut g = M::sum(simd, [c0[1], c0[2], c0[3]], all, c0[0]);
    g.mul_add(simd, &left, &s);
    g
}

/// Degree 18 with the coefficients `c`, which are [`B18`] times powers of a scale.
#[inline(always)]
pub(super) fn degree_18<S: Simd, M: Packed<S>>(
    simd: S,
    c: &[[f64; 5]; 5],
    [a, a2, a3, a6]: [&M; 4],
) -> M {
    let all = [a, a2, a3, a6];
    let b0 = M::sum(simd, [c[0][1], c[0][2], c[0][3]], [a, a2, a3], 0.0);
    let b4 = M::sum(simd, [c[4][2], c[4][3], c[4][4]], [a2, a3, a6], 0.0);
    let mut s = M::sum(simd, [c[3][1], c[3][2], c[3][3], c[3][4]], all, c[3][0]);
    s.mul_add(simd, &b0, &b4);
    let c2 = c[2];
    let left = M::sum(simd, [c2[1], c2[2], c2[3], c2[4], 1.0], [a, a2, a3, a6, &s], c2[0]);
    let mut g = M::sum(simd, [c[1][1], c[1][2], c[1][3], c[1][4]], all, c[1][0]);
    g.mul_add(simd, &left, &s);
    g
}
