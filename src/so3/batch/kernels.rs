//! The maps: by formulas without a branch, and by the scalar form.

use nalgebra::{Matrix3, Vector3};

use super::super::angle::Angle;
use super::super::cay::dcayinv_of;
use super::super::{cay_coefficients, cross, dot3, rodrigues, rodrigues_on};
use crate::error::Error;
use crate::scalar::{Real, Trig};
use crate::so3;

/// A map of IN numbers, the first three of which are u, to OUT numbers.
pub(super) trait Kernel<const IN: usize, const OUT: usize> {
    /// True if the formulas depend on the size of u.
    const HAS_SIZES: bool = true;

    /// The value by formulas without a branch, and |sin(α/2)|² or what else must not be small for them
    /// to hold; NaN where a result is not finite.
    fn lane<S: Trig>(x: &[S; IN]) -> ([S; OUT], S);
    /// The value by the scalar form.
    fn one(x: &[f64; IN]) -> Result<[f64; OUT], Error>;
}

pub(super) fn u_of<S: Real>(x: &[S]) -> Vector3<S> {
    Vector3::new(x[0], x[1], x[2])
}

fn by_rows<S: Real>(g: &Matrix3<S>) -> [S; 9] {
    let g = g.as_slice();
    [g[0], g[3], g[6], g[1], g[4], g[7], g[2], g[5], g[8]]
}

/// w, and `guard` unless w is not finite.
#[inline(always)]
fn finite<S: Real>(w: Vector3<S>, guard: S) -> ([S; 3], S) {
    let zero = S::lit(0.0);
    ([w[0], w[1], w[2]], guard + (zero * w[0] + zero * w[1] + zero * w[2]))
}

pub(super) struct ExpOf;
impl Kernel<3, 9> for ExpOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 3]) -> ([S; 9], S) {
        let (angle, g) = Angle::with_matrix(&u_of(x));
        (by_rows(&g), angle.regular())
    }
    fn one(x: &[f64; 3]) -> Result<[f64; 9], Error> {
        so3::exp(&u_of(x)).map(|g| by_rows(&g)).map_err(Error::from)
    }
}

pub(super) struct ExpOnOf;
impl Kernel<6, 3> for ExpOnOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        let u = u_of(x);
        let (angle, a, b) = Angle::with_exp(&u);
        finite(rodrigues_on(&u, a, b, &u_of(&x[3..])), angle.regular())
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], Error> {
        so3::exp_on(&u_of(x), &u_of(&x[3..])).map(Into::into).map_err(Error::from)
    }
}

pub(super) struct DexpOf;
impl Kernel<6, 3> for DexpOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        let u = u_of(x);
        let angle = Angle::with_half(&u);
        let (b, d) = angle.dexp_coefficients();
        finite(rodrigues_on(&u, b, d, &u_of(&x[3..])), angle.regular())
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], Error> {
        so3::dexp(&u_of(x), &u_of(&x[3..])).map(Into::into).map_err(Error::from)
    }
}

pub(super) struct DexpinvOf;
impl Kernel<6, 3> for DexpinvOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        let u = u_of(x);
        let angle = Angle::of(&u);
        let w = rodrigues_on(&u, S::lit(-0.5), angle.dexpinv_coefficient(), &u_of(&x[3..]));
        finite(w, angle.regular())
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], Error> {
        so3::dexpinv(&u_of(x), &u_of(&x[3..])).map(Into::into).map_err(Error::from)
    }
}

pub(super) struct CayOf;
impl Kernel<3, 9> for CayOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 3]) -> ([S; 9], S) {
        let u = u_of(x);
        // In range: the block has been looked at.
        let (a, b) = cay_coefficients(&u).unwrap_or((S::lit(0.0), S::lit(0.0)));
        (by_rows(&rodrigues(&u, a, b)), S::lit(1.0))
    }
    fn one(x: &[f64; 3]) -> Result<[f64; 9], Error> {
        so3::cay(&u_of(x)).map(|g| by_rows(&g)).map_err(Error::from)
    }
}

pub(super) struct DcayOf;
impl Kernel<6, 3> for DcayOf {
    const HAS_SIZES: bool = false;

    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        let (u, v) = (u_of(x), u_of(&x[3..]));
        let (a, b) = cay_coefficients(&u).unwrap_or((S::lit(0.0), S::lit(0.0)));
        let w = cross(&u, &v);
        finite(Vector3::from_fn(|i, _| a * v[i] + b * w[i]), S::lit(1.0))
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], Error> {
        so3::dcay(&u_of(x), &u_of(&x[3..])).map(Into::into).map_err(Error::from)
    }
}

pub(super) struct DcayinvOf;
impl Kernel<6, 3> for DcayinvOf {
    const HAS_SIZES: bool = false;

    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        finite(dcayinv_of(&u_of(x), &u_of(&x[3..])), S::lit(1.0))
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], Error> {
        so3::dcayinv(&u_of(x), &u_of(&x[3..])).map(Into::into).map_err(Error::from)
    }
}

/// `if x < 0 { a } else { b }`, lane by lane.
#[inline(always)]
fn if_negative<S: Real, const N: usize>(x: S, a: [S; N], b: [S; N]) -> [S; N] {
    x.branch(0.0, || a, || b)
}

/// 1 if the numbers are a rotation to rounding, else 0.
#[inline(always)]
fn is_rotation<S: Real>(r: &[S; 9]) -> S {
    let one = S::lit(1.0);
    let [a, b, c] = [0, 1, 2].map(|j| Vector3::new(r[j], r[3 + j], r[6 + j]));
    let [d, e, f] = [dot3(&a, &a) - one, dot3(&b, &b) - one, dot3(&c, &c) - one];
    let [g, h, i] = [dot3(&a, &b), dot3(&a, &c), dot3(&b, &c)];
    let off = (d * d + e * e + f * f) + S::lit(2.0) * (g * g + h * h + i * i);
    let det = dot3(&cross(&a, &b), &c);
    let bound = S::lit(so3::ORTHOGONAL * so3::ORTHOGONAL);
    let [near] = if_negative(off - bound, [one], [S::lit(0.0)]);
    let [proper] = if_negative(-det, [near], [S::lit(0.0)]);
    proper
}

/// A multiple of the unit quaternion of a rotation, twice to four times as long, with w ≥ 0 or the sign of the case.
///
/// The four cases of Shepperd, of which the one with the largest component is selected.
#[inline(always)]
fn quaternion<S: Real>(r: &[S; 9]) -> [S; 4] {
    let one = S::lit(1.0);
    let [a, b, c] = [r[0], r[4], r[8]];
    let [x, y, z] = [r[7] - r[5], r[2] - r[6], r[3] - r[1]];
    let [xy, xz, yz] = [r[1] + r[3], r[2] + r[6], r[5] + r[7]];
    let by_w = [one + a + b + c, x, y, z];
    let by_x = [x, one + a - b - c, xy, xz];
    let by_y = [y, xy, one - a + b - c, yz];
    let by_z = [z, xz, yz, one - a - b + c];
    // The case of the largest of a, b, c, unless the trace is the largest.
    let first = if_negative(b - a, by_x, by_y);
    let [larger] = if_negative(b - a, [a], [b]);
    let second = if_negative(c - larger, first, by_z);
    if_negative(a + b + c, second, by_w)
}

/// atan(y/x)/y·s for x, y ≥ 0: the numbers of fdlibm for |t| < 7/16, after the reduction by π/4.
#[inline(always)]
fn atan2<S: Real>(y: S, x: S) -> S {
    const C: [f64; 11] = [
        3.333_333_333_333_293_18e-01,
        -1.999_999_999_987_648_32e-01,
        1.428_571_427_250_346_64e-01,
        -1.111_111_040_546_235_58e-01,
        9.090_887_133_436_506_57e-02,
        -7.691_876_205_044_829_99e-02,
        6.661_073_137_387_531_21e-02,
        -5.833_570_133_790_573_49e-02,
        4.976_877_994_615_932_36e-02,
        -3.653_157_274_421_691_55e-02,
        1.628_582_011_536_578_24e-02,
    ];
    let swap = y - x;
    let [low, high] = if_negative(swap, [y, x], [x, y]);
    // tan(π/8): above it, atan t = π/4 + atan((t − 1)/(t + 1)).
    let [p, q, turned] = if_negative(
        low - S::lit(0.414_213_562_373_095_05) * high,
        [low, high, S::lit(0.0)],
        [low - high, low + high, S::lit(core::f64::consts::FRAC_PI_4)],
    );
    let t = p / q;
    let (z, last) = (t * t, C.len() - 1);
    let sum = (0..last).rev().fold(S::lit(C[last]), |sum, k| sum.mul_add(z, S::lit(C[k])));
    let angle = turned + (t - t * z * sum);
    let [angle] = if_negative(swap, [angle], [S::lit(core::f64::consts::FRAC_PI_2) - angle]);
    angle
}

pub(super) struct LogOf;
impl Kernel<9, 3> for LogOf {
    const HAS_SIZES: bool = false;

    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 9]) -> ([S; 3], S) {
        let [w, a, b, c] = quaternion(x);
        let norm = (a * a + b * b + c * c).sqrt();
        let [sign] = if_negative(w, [S::lit(-2.0)], [S::lit(2.0)]);
        let factor = sign * atan2(norm, w.abs()) / norm;
        // Next to 𝟙, and next to a turn by π, the scalar form decides.
        let [regular] = if_negative(norm - S::lit(1e-100), [S::lit(0.0)], [is_rotation(x)]);
        let [regular] = if_negative(w.abs() - S::lit(1e-12), [S::lit(0.0)], [regular]);
        finite(Vector3::new(factor * a, factor * b, factor * c), regular)
    }
    fn one(x: &[f64; 9]) -> Result<[f64; 3], Error> {
        so3::log(&Matrix3::from_row_slice(x)).map(Into::into)
    }
}

pub(super) struct CayInvOf;
impl Kernel<9, 3> for CayInvOf {
    const HAS_SIZES: bool = false;

    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 9]) -> ([S; 3], S) {
        let [w, a, b, c] = quaternion(x);
        let factor = S::lit(2.0) / w;
        let [regular] = if_negative(w.abs() - S::lit(1e-6), [S::lit(0.0)], [is_rotation(x)]);
        finite(Vector3::new(factor * a, factor * b, factor * c), regular)
    }
    fn one(x: &[f64; 9]) -> Result<[f64; 3], Error> {
        so3::cay_inv(&Matrix3::from_row_slice(x)).map(Into::into)
    }
}
