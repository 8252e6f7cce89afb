//! A number type of 32 digits, the sum of two doubles, for references and for tests of high orders.
//!
//! Sums by Knuth, products by Dekker (T. J. Dekker, A floating-point technique for extending the
//! available precision, Numer. Math. 18, 1971), without fused operations, so all machines give
//! the same results. Relative errors of +, −, ·, /, √ are a few units of 2⁻¹⁰⁴; sin and cos by π/2 to 48 digits
//! and Taylor series, for |x| up to 1e9. Cost: 20 to 70 operations of `f64` each.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::{Real, Select, Trig};

/// hi + lo, with |lo| at most half an ulp of hi.
///
/// The closed forms of the library run on it, and the methods that are generic in the number type. Steps by Lie series on
/// [`Se3`](crate::groups::Se3) and by [`Taylor`](crate::methods::Taylor) have its digits, and those by `magnus6` and
/// `cayley-magnus6` about 25: some of their coefficients are f64. Coefficients of Runge–Kutta tableaus, of Padé approximants,
/// of `magnus8` and of commutator-free methods are f64, so steps by them are those of coefficients that are rounded: their
/// results have 16 digits, and tolerances below that are not reached. Numbers that a problem takes as f64, such as moments of
/// inertia, are rounded too.
///
/// Times and step sizes are f64. A run over a span has the digits of a double double only if its steps add up to the span
/// exactly, as 64 equal steps over \[0, 1\] do; 100 steps, and steps by error, end up to ε/2·|t| beside t, with ε of f64.
///
/// ∞ and NaN are as in f64. Numbers whose products are beyond 1e300 may have 16 digits.
///
/// ```
/// use lieflow::scalar::{DoubleDouble, Real};
/// use lieflow::so3;
/// use lieflow::nalgebra::Vector3;
/// let u = Vector3::new(0.3, -1.2, 0.5).map(DoubleDouble::lit);
/// let r = so3::exp(&u)?;
/// let column = r[(0, 0)] * r[(0, 0)] + r[(1, 0)] * r[(1, 0)] + r[(2, 0)] * r[(2, 0)];
/// assert!((column - DoubleDouble::lit(1.0)).value().abs() < 1e-30);
/// # Ok::<(), lieflow::StepError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

/// a + b without error, for any a and b.
#[inline]
const fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    let b_kept = hi - a;
    DoubleDouble { hi, lo: (a - (hi - b_kept)) + (b - b_kept) }
}

/// a + b without error, for |a| ≥ |b|.
#[inline]
const fn quick_two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    DoubleDouble { hi, lo: b - (hi - a) }
}

/// The upper 26 bits of a and the rest.
#[inline]
const fn split(a: f64) -> (f64, f64) {
    let t = 134_217_729.0 * a; // 2²⁷ + 1
    let upper = t - (t - a);
    (upper, a - upper)
}

/// a·b without error, if nothing over- or underflows.
#[inline]
const fn two_prod(a: f64, b: f64) -> DoubleDouble {
    let hi = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    DoubleDouble { hi, lo: ((a1 * b1 - hi) + a1 * b2 + a2 * b1) + a2 * b2 }
}

/// The operators as `const` functions.
impl DoubleDouble {
    #[inline]
    const fn new(x: f64) -> Self {
        DoubleDouble { hi: x, lo: 0.0 }
    }
    #[inline]
    const fn plus(self, other: Self) -> Self {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        if !s.hi.is_finite() {
            return Self::new(s.hi);
        }
        let s = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(s.hi, s.lo + t.lo)
    }
    #[inline]
    const fn times(self, other: Self) -> Self {
        let p = two_prod(self.hi, other.hi);
        let lo = p.lo + (self.hi * other.lo + self.lo * other.hi);
        if !p.hi.is_finite() || !lo.is_finite() {
            return Self::new(p.hi);
        }
        quick_two_sum(p.hi, lo)
    }
    #[inline]
    const fn minus(self) -> Self {
        DoubleDouble { hi: -self.hi, lo: -self.lo }
    }
    /// Long division, three digits of 53 bits.
    const fn over(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        if !first.is_finite() || other.hi.is_infinite() {
            return Self::new(first);
        }
        let rest = self.plus(other.times(Self::new(-first)));
        let second = rest.hi / other.hi;
        let rest = rest.plus(other.times(Self::new(-second)));
        quick_two_sum(first, second).plus(Self::new(rest.hi / other.hi))
    }

    /// The nearest double.
    pub const fn value(self) -> f64 {
        self.hi
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> Self {
        Self::new(x)
    }
}
impl From<DoubleDouble> for f64 {
    fn from(x: DoubleDouble) -> f64 {
        x.hi
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.plus(other)
    }
}
impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.minus()
    }
}
impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.plus(other.minus())
    }
}
impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.times(other)
    }
}
impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.over(other)
    }
}
impl AddAssign for DoubleDouble {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for DoubleDouble {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// The bound of a branch, which is smaller than for `f64`.
///
/// A series that replaces a closed form near 0 is exact to the rounding of `f64` up to its bound. It is exact to the
/// rounding of double doubles up to a smaller bound. Above that the cancellation in the closed form is small.
const NEARER: f64 = 1e-14;

impl Real for DoubleDouble {
    const EPSILON: f64 = 4.930380657631324e-32; // 2⁻¹⁰⁴
    /// Dekker's products need room below the overflow.
    const SQUARE_MAX: f64 = 1e290;

    #[inline]
    fn lit(x: f64) -> Self {
        Self::new(x)
    }
    /// The root of the upper part, and one Newton step without a division (A. H. Karp, P. Markstein,
    /// 1997).
    fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        if root == 0.0 || !root.is_finite() {
            return Self::new(root);
        }
        let rest = self - two_prod(root, root);
        quick_two_sum(root, rest.hi * (0.5 / root))
    }
    fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }
    fn all_below(self, bound: f64) -> bool {
        self.hi < bound || (self.hi == bound && self.lo < 0.0)
    }
    fn any_below(self, bound: f64) -> bool {
        self.all_below(bound)
    }
    fn branch<R: Select<Self>>(
        self,
        bound: f64,
        small: impl FnOnce() -> R,
        large: impl FnOnce() -> R,
    ) -> R {
        if self.all_below(NEARER * bound) { small() } else { large() }
    }
}

/// π/2 = Σ of three doubles.
const HALF_PI: [f64; 3] = [FRAC_PI_2, 6.123233995736766e-17, -1.4973849048591698e-33];

/// (−1)^(k/2)/k!.
const INVERSE_FACTORIAL: [DoubleDouble; 30] = {
    let mut table = [DoubleDouble::new(1.0); 30];
    let mut k = 1;
    while k < table.len() {
        table[k] =
            table[k - 1].over(DoubleDouble::new(if k % 2 == 0 { -1.0 } else { 1.0 } * k as f64));
        k += 1;
    }
    table
};

impl Trig for DoubleDouble {
    /// x = kπ/2 + r, |r| ≤ π/4; the series of sin r and cos r end below 1e-32.
    fn sin_cos(self) -> (Self, Self) {
        let k = (self.hi * FRAC_2_PI).round();
        let part = |p: f64| two_prod(-k, p);
        let r = self + part(HALF_PI[0]) + part(HALF_PI[1]) + part(HALF_PI[2]);
        let z = r * r;
        let series = |first: usize| {
            let terms = INVERSE_FACTORIAL.iter().skip(first).step_by(2).rev();
            terms.fold(Self::default(), |sum, &c| sum * z + c)
        };
        let (s, c) = (r * series(1), series(0));
        match k.rem_euclid(4.0) {
            1.0 => (c, -s),
            2.0 => (-s, -c),
            3.0 => (-c, s),
            _ => (s, c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dd(hi: f64, lo: f64) -> DoubleDouble {
        DoubleDouble { hi, lo }
    }

    #[test]
    fn sums_and_products_keep_what_a_double_loses() {
        let (one, tiny) = (DoubleDouble::from(1.0), DoubleDouble::from(1e-25));
        assert_eq!((one + tiny - one).value(), 1e-25);
        let x = DoubleDouble::from(0.1);
        // 0.1 as a double is 3602879701896397/2^55; its square needs 104 bits.
        assert_eq!(x * x, dd(0.1 * 0.1, 0.1f64.mul_add(0.1, -(0.1 * 0.1))));
    }

    #[test]
    fn a_quotient_times_its_divisor_is_back_to_31_digits() {
        let (a, b) =
            (DoubleDouble::from(1.0) + 1e-20.into(), DoubleDouble::from(3.0) + 7e-19.into());
        let gap = a / b * b - a;
        assert!(gap.value().abs() < 1e-31, "{gap:?}");
    }

    #[test]
    fn roots() {
        for x in [2.0, 3.0, 1e-200, 7e120] {
            let x = DoubleDouble::from(x);
            let gap = x.sqrt() * x.sqrt() - x;
            assert!((gap / x).value().abs() < 1e-31, "{x:?}: {gap:?}");
        }
        assert_eq!(DoubleDouble::default().sqrt().value(), 0.0);
        assert!(!DoubleDouble::from(-1.0).sqrt().is_finite());
        assert!(!(DoubleDouble::from(1e308) * 10.0.into()).is_finite());
    }

    /// ∞ is a signal of tolerances and of step sizes.
    #[test]
    fn infinities_and_large_numbers() {
        let [one, zero, infinity, large] = [1.0, 0.0, f64::INFINITY, 1e305].map(DoubleDouble::from);
        for x in [infinity + one, infinity / 2.0.into(), one / zero, infinity.sqrt(), large * large]
        {
            assert_eq!((x.hi, x.lo), (f64::INFINITY, 0.0));
        }
        assert_eq!((one / infinity, zero * large), (zero, zero));
        assert_eq!((large * 0.5.into()).value(), 5e304);
        for x in [infinity - infinity, zero / zero, zero * infinity] {
            assert!(x.value().is_nan());
        }
    }

    /// By mpmath, to 36 digits: sums of two doubles.
    #[test]
    fn sines_and_cosines() {
        let known = SINES;
        for (x, sin, cos) in known {
            let (s, c) = DoubleDouble::from(x).sin_cos();
            let gap = |a: DoubleDouble, b: [f64; 2]| (a - dd(b[0], b[1])).value().abs();
            assert!(gap(s, sin) < 1e-31 && gap(c, cos) < 1e-31, "{x}: {s:?} {c:?}");
        }
    }

    #[rustfmt::skip]
    const SINES: [(f64, [f64; 2], [f64; 2]); 5] = [
        (0.3, [0.29552020666133955, 1.8315357276792536e-17], [0.955336489125606, 4.1935600297907467e-17]),
        (-0.78, [-0.7032794192004101, -5.363975116463942e-17], [0.7109135380122773, 3.667412669706698e-17]),
        (1.9, [0.9463000876874145, 4.6531737366356815e-17], [-0.32328956686350335, 1.4359001896805716e-17]),
        (100.25, [-0.2772828564548513, -1.361336774720287e-17], [0.9607883312760612, -2.1441388741342008e-17]),
        (-12345.678, [0.7040813137533816, 1.9646969196301474e-17], [0.7101193587160628, -2.4815747415365305e-17]),
    ];
}
