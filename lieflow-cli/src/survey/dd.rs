//! Twice the precision of `f64`: a number as the sum of two doubles, about 32 digits.
//!
//! Sums by Knuth, products by Dekker (T. J. Dekker, A floating-point technique for extending the
//! available precision, 1971), without fused operations, so that every machine gives the same.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// hi + lo, with |lo| at most half an ulp of hi.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dd {
    hi: f64,
    lo: f64,
}

/// a + b without error, for any a and b.
fn two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    let b_kept = hi - a;
    Dd { hi, lo: (a - (hi - b_kept)) + (b - b_kept) }
}

/// a + b without error, for |a| ≥ |b|.
fn quick_two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    Dd { hi, lo: b - (hi - a) }
}

/// The upper 26 bits of a and the rest.
fn split(a: f64) -> (f64, f64) {
    let t = 134_217_729.0 * a; // 2^27 + 1
    let upper = t - (t - a);
    (upper, a - upper)
}

/// a·b without error, where nothing over- or underflows.
fn two_prod(a: f64, b: f64) -> Dd {
    let hi = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    Dd { hi, lo: ((a1 * b1 - hi) + a1 * b2 + a2 * b1) + a2 * b2 }
}

impl Dd {
    /// The nearest double.
    pub fn value(self) -> f64 {
        self.hi
    }
}

impl From<f64> for Dd {
    fn from(x: f64) -> Self {
        Dd { hi: x, lo: 0.0 }
    }
}

impl Add for Dd {
    type Output = Dd;
    fn add(self, other: Dd) -> Dd {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let s = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(s.hi, s.lo + t.lo)
    }
}

impl Neg for Dd {
    type Output = Dd;
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Dd {
    type Output = Dd;
    fn sub(self, other: Dd) -> Dd {
        self + -other
    }
}

impl Mul for Dd {
    type Output = Dd;
    fn mul(self, other: Dd) -> Dd {
        let p = two_prod(self.hi, other.hi);
        quick_two_sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for Dd {
    type Output = Dd;
    /// Long division, three digits of 53 bits.
    fn div(self, other: Dd) -> Dd {
        let first = self.hi / other.hi;
        let rest = self - other * first.into();
        let second = rest.hi / other.hi;
        let rest = rest - other * second.into();
        quick_two_sum(first, second) + (rest.hi / other.hi).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_keep_what_a_double_loses() {
        let (one, tiny) = (Dd::from(1.0), Dd::from(1e-25));
        assert_eq!((one + tiny - one).value(), 1e-25);
        let x = Dd::from(0.1);
        // 0.1 as a double is 3602879701896397/2^55; its square needs 104 bits.
        let exact = Dd { hi: 0.1 * 0.1, lo: 0.1f64.mul_add(0.1, -(0.1 * 0.1)) };
        assert_eq!(x * x, exact);
    }

    #[test]
    fn a_quotient_times_its_divisor_is_back_to_31_digits() {
        let (a, b) = (Dd::from(1.0) + 1e-20.into(), Dd::from(3.0) + 7e-19.into());
        let gap = a / b * b - a;
        assert!(gap.value().abs() < 1e-31, "{gap:?}");
    }
}
