//! How far two values of columns are from each other, and how long columns are as a vector.

use core::borrow::Borrow;

/// How far two values of columns are from each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// The length of their difference.
    #[default]
    Length,
    /// The angle between two rotations, given by their nine entries.
    Rotation,
    /// The angle between two rotations, given by quaternions.
    Quaternion,
}

impl Measure {
    /// Is the distance an angle, in radians?
    pub fn is_angle(self) -> bool {
        self != Measure::Length
    }

    /// The distance.
    pub fn distance(self, a: &[f64], b: &[f64]) -> f64 {
        let apart = |sign: f64| length(a.iter().zip(b).map(|(a, b)| a - sign * b));
        match self {
            Measure::Length => apart(1.0),
            // ‖A − B‖ = √8 sin(angle/2), and |p − q| = 2 sin(angle/4).
            Measure::Rotation => 2.0 * asin(apart(1.0) / 8.0_f64.sqrt()),
            Measure::Quaternion => 4.0 * asin(apart(1.0).min(apart(-1.0)) / 2.0),
        }
    }
}

/// The angle with this sine, which rounding may have put above 1. NaN stays.
fn asin(sine: f64) -> f64 {
    if sine > 1.0 { core::f64::consts::FRAC_PI_2 } else { sine.asin() }
}

/// The length of a vector.
///
/// The squares of its numbers may leave the range of `f64`. Then the numbers are divided by the largest one first. So the
/// result is infinite only where the length itself is out of that range. It is NaN if a number is NaN.
pub fn length<I>(x: I) -> f64
where
    I: IntoIterator<IntoIter: Clone, Item: Borrow<f64>>,
{
    let x = x.into_iter().map(|x| *x.borrow());
    let square: f64 = x.clone().map(|x| x * x).sum();
    if square.is_normal() || square.is_nan() {
        return square.sqrt();
    }
    let largest = x.clone().fold(0.0, |most: f64, x| most.max(x.abs()));
    if largest == 0.0 || largest.is_infinite() {
        return largest;
    }
    largest * x.map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the smallest sizes to the largest ones.
    #[test]
    fn the_squares_of_a_length_may_leave_the_range() {
        for power in [-1070, -1000, -530, -510, 0, 510, 520, 1000, 1021] {
            let size = 2.0_f64.powi(power);
            assert_eq!(length([3.0 * size, 0.0, -4.0 * size]), 5.0 * size, "2^{power}");
            let (a, b) = ([3.0 * size, size], [0.0, -3.0 * size]);
            assert_eq!(Measure::Length.distance(&a, &b), 5.0 * size, "2^{power}");
        }
        // Usual sizes have the bits of the plain formula.
        let x = [0.1, -0.7, 1.3];
        assert_eq!(length(x), x.iter().map(|x| x * x).sum::<f64>().sqrt());
        assert_eq!((length([0.0; 0]), length([0.0, -0.0])), (0.0, 0.0));
    }

    /// Nothing that is out of the range looks like a number.
    #[test]
    fn a_length_that_is_no_number_stays_so() {
        assert_eq!(length([f64::MAX, f64::MAX]), f64::INFINITY);
        assert_eq!(length([1.0, f64::NEG_INFINITY]), f64::INFINITY);
        assert!(length([1e200, f64::NAN, 1.0]).is_nan());
        assert!(Measure::Length.distance(&[f64::INFINITY], &[f64::INFINITY]).is_nan());
    }
}
