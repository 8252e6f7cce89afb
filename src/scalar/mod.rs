//! Number types for the closed forms.
//!
//! A formula is written once, generic in [`Real`]. It runs in `f64`, in `f32`, on [`Counted`], which counts operations,
//! and on [`DoubleDouble`], which has 32 digits.

mod counted;
mod double_double;
mod sin_cos;
mod tally;

use core::f64::consts::FRAC_PI_4;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

pub(crate) use self::sin_cos::{ROUND, SIN_COS_MAX, muladd, sin_cos, sin_cos_near_zero};
pub use counted::{Counted, Ops};
pub use double_double::DoubleDouble;
pub use tally::tally;
pub(crate) use tally::tally_by;

/// A real number, several at once (SIMD lanes), or one that counts its operations.
///
/// The trait is small, so that a new number type needs little code.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The relative rounding error of a sum or a product, at which iterations stop.
    const EPSILON: f64 = f64::EPSILON;
    /// The largest sum of squares whose products with ordinary numbers do not overflow.
    const SQUARE_MAX: f64 = 1e300;

    /// True for numbers that count operations. Methods by name take their general code for them, which compiles faster.
    const COUNTS: bool = false;

    /// A constant of the formula (Butcher coefficients, Bernoulli numbers, ½).
    fn lit(x: f64) -> Self;
    /// self·a + b, with one rounding if the machine has a fast instruction for it.
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    /// √x.
    fn sqrt(self) -> Self;
    /// |x|.
    fn abs(self) -> Self;
    /// True if x < `bound` in every lane; false if x is NaN.
    fn all_below(self, bound: f64) -> bool;
    /// True if x < `bound` in some lane.
    fn any_below(self, bound: f64) -> bool;
    /// `if self < bound { small() } else { large() }`, lane by lane.
    ///
    /// A scalar runs one branch; lanes run both and blend. The number type decides, so one formula serves both.
    fn branch<R: Select<Self>>(
        self,
        bound: f64,
        small: impl FnOnce() -> R,
        large: impl FnOnce() -> R,
    ) -> R;

    /// True if x is finite, in every lane.
    #[inline]
    fn is_finite(self) -> bool {
        self.abs().all_below(f64::INFINITY)
    }
}

/// A real number with sine and cosine. exp and ccsk need it; cay does not.
pub trait Trig: Real {
    /// (sin x, cos x).
    fn sin_cos(self) -> (Self, Self);
}

/// Several numbers that [`Real::branch`] can blend.
pub trait Select<S>: Sized {
    /// Blend lane by lane with `pick`.
    fn select(pick: &mut impl FnMut(S, S) -> S, a: Self, b: Self) -> Self;
}

impl<S: Real, const N: usize> Select<S> for [S; N] {
    fn select(pick: &mut impl FnMut(S, S) -> S, a: Self, b: Self) -> Self {
        core::array::from_fn(|i| pick(a[i], b[i]))
    }
}

macro_rules! real_for_float {
    ($($t:ty, $square_max:literal;)*) => {$(
        impl Real for $t {
            const EPSILON: f64 = <$t>::EPSILON as f64;
            const SQUARE_MAX: f64 = $square_max;

            #[inline]
            fn lit(x: f64) -> Self {
                x as $t
            }
            #[inline]
            fn sqrt(self) -> Self {
                <$t>::sqrt(self)
            }
            #[inline]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
            #[inline]
            fn all_below(self, bound: f64) -> bool {
                f64::from(self) < bound
            }
            #[inline]
            fn any_below(self, bound: f64) -> bool {
                f64::from(self) < bound
            }
            // The compiler finds the branches too long on its own, and a call here costs what exp costs.
            #[inline(always)]
            fn branch<R: Select<Self>>(
                self,
                bound: f64,
                small: impl FnOnce() -> R,
                large: impl FnOnce() -> R,
            ) -> R {
                if self.all_below(bound) { small() } else { large() }
            }
        }
    )*};
}
real_for_float! {
    f32, 1e30;
    f64, 1e300;
}

impl Trig for f32 {
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        f32::sin_cos(self)
    }
}

impl Trig for f64 {
    /// Polynomials in line up to 1e6, because a library call costs as much as they do. Most angles are below π/4; there
    /// the reduction, which is half of the work, is left out. Without the attribute the compiler does not inline this,
    /// and then exp takes half as long again.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        match self.abs() {
            x if x <= FRAC_PI_4 => sin_cos_near_zero(self),
            x if x <= SIN_COS_MAX => sin_cos::<false>(self),
            _ => f64::sin_cos(self),
        }
    }
}

/// min(a, b); NaN if b is NaN.
#[inline]
pub(crate) fn smaller<S: Real>(a: S, b: S) -> S {
    let [c] = (a - b).branch(0.0, || [a], || [b]);
    c
}

/// max(a, b); NaN if b is NaN.
#[inline]
pub(crate) fn larger<S: Real>(a: S, b: S) -> S {
    let [c] = (b - a).branch(0.0, || [a], || [b]);
    c
}

/// ±∞ or NaN, which one x is that is not finite. For messages.
#[cold]
pub(crate) fn infinite_or_nan<S: Real>(x: S) -> f64 {
    if x.any_below(f64::MIN) {
        f64::NEG_INFINITY
    } else if (S::lit(0.0) - x).any_below(f64::MIN) {
        f64::INFINITY
    } else {
        f64::NAN
    }
}

/// The power of two at or below x ≥ 0, within 2^±1000. A quotient by it has the digits of what it divides.
pub(crate) fn power_of_two(x: f64) -> f64 {
    const LOW: f64 = f64::from_bits((1023 - 1000) << 52);
    f64::from_bits(x.to_bits() & (0x7ff << 52)).clamp(LOW, 1.0 / LOW)
}
