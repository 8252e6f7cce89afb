//! (sin x, cos x) without a branch, so that a loop over many x runs in SIMD lanes.
//!
//! x = kπ/2 + r, |r| ≤ π/4: π/2 in three parts of 33, 33 and 53 bits (W. J. Cody, W. Waite). The
//! products of k with the first two are exact, so r is accurate relative to itself near multiples of π/2.
//! sin r = r − r³/6 + … and cos r = 1 − r²/2 + … by polynomials in r² that interpolate in Chebyshev
//! nodes, with relative errors of 1.3e-17 for sin and 5e-19 for cos. The total error is below 1 ε.

use core::f64::consts::FRAC_2_PI;

/// Up to this |x| the products with k are exact.
pub(crate) const SIN_COS_MAX: f64 = 1e6;

/// 1.5·2⁵². Adding it rounds to an integer, which is then in the last bits.
pub(crate) const ROUND: f64 = 6755399441055744.0;
/// π/2.
const HALF_PI: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];
/// (sin √z/√z − 1)/z.
#[rustfmt::skip]
const SIN: [f64; 6] = [
    -0.16666666666666666, 0.008333333333330925, -0.00019841269836722418,
    2.755731608381636e-06, -2.5051127944014188e-08, 1.5917848524808262e-10,
];
/// (cos √z − 1 + z/2)/z².
#[rustfmt::skip]
const COS: [f64; 6] = [
    0.041666666666666664, -0.0013888888888887382, 2.480158729874307e-05,
    -2.7557317260008837e-07, 2.0876143827993133e-09, -1.1382456778061306e-11,
];

/// a·b + c; fused if the caller has an instruction for it.
#[inline(always)]
pub(crate) fn muladd<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// The polynomials in z = r² at the end of [`SIN`] and [`COS`]. Their terms are paired, so that few of
/// them wait for one another.
#[inline(always)]
fn polynomials<const FUSED: bool>(z: f64) -> (f64, f64) {
    let z2 = z * z;
    let z4 = z2 * z2;
    let poly = |c: &[f64; 6]| {
        let pair = |i: usize| muladd::<FUSED>(c[i + 1], z, c[i]);
        muladd::<FUSED>(pair(4), z4, muladd::<FUSED>(pair(2), z2, pair(0)))
    };
    (poly(&SIN), z2 * poly(&COS))
}

/// (sin x, cos x) for |x| ≤ π/4, where there is nothing to reduce.
#[inline(always)]
pub(crate) fn sin_cos_near_zero(x: f64) -> (f64, f64) {
    let z = x * x;
    let (sin, cos) = polynomials::<false>(z);
    let half = 0.5 * z;
    let lead = 1.0 - half;
    (x + sin * (x * z), lead + (((1.0 - lead) - half) + cos))
}

/// (sin x, cos x) for |x| ≤ [`SIN_COS_MAX`]. Beyond, the result is finite but wrong.
#[inline(always)]
pub(crate) fn sin_cos<const FUSED: bool>(x: f64) -> (f64, f64) {
    let shifted = x * FRAC_2_PI + ROUND;
    let (quarter, k) = (shifted.to_bits(), shifted - ROUND);
    // r = x − kP₁ − kP₂, and what its rounding and kP₃ leave: it joins late, where it is small.
    let a = x - k * HALF_PI[0];
    let p = k * HALF_PI[1];
    let r = a - p;
    let low = ((a - r) - p) - k * HALF_PI[2];

    let z = r * r;
    let (sin, cos) = polynomials::<FUSED>(z);
    let sin = r + muladd::<FUSED>(sin, r * z, low - 0.5 * z * low);
    let half = 0.5 * z;
    let lead = 1.0 - half;
    let cos = lead + (((1.0 - lead) - half) + (cos - r * low));

    let (s, c) = if quarter & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let sign = |bit: u64, x: f64| f64::from_bits(x.to_bits() ^ ((bit & 2) << 62));
    (sign(quarter, s), sign(quarter.wrapping_add(1), c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::FRAC_PI_4;

    /// Within 1 ε of the results of the platform, also near multiples of π/2. Those are within ½ ε.
    #[test]
    fn agrees_with_the_platform() {
        let mut x = 0.37f64;
        for k in 0..200_000u32 {
            x = (x * 997.13 + 0.17).fract();
            let size = [1.0, 10.0, 1e3, 1e6][k as usize % 4];
            let mut at = size * (2.0 * x - 1.0);
            if k % 3 == 0 {
                let quarter = core::f64::consts::FRAC_PI_2 * (at / 1.6).round();
                at = quarter + quarter * f64::EPSILON * f64::from(k % 7);
            }
            let near_zero = sin_cos_near_zero(at.clamp(-FRAC_PI_4, FRAC_PI_4));
            let (sin, cos) = at.clamp(-FRAC_PI_4, FRAC_PI_4).sin_cos();
            assert!((near_zero.0 - sin).abs() <= f64::EPSILON * sin.abs(), "sin {at:?}");
            assert!((near_zero.1 - cos).abs() <= f64::EPSILON * cos.abs(), "cos {at:?}");
            for (s, c) in [sin_cos::<false>(at), sin_cos::<true>(at)] {
                let (sin, cos) = at.sin_cos();
                assert!((s - sin).abs() <= f64::EPSILON * sin.abs(), "sin {at:?}: {s:?} {sin:?}");
                assert!((c - cos).abs() <= f64::EPSILON * cos.abs(), "cos {at:?}: {c:?} {cos:?}");
            }
        }
    }
}
