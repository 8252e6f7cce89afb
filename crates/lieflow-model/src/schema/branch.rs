//! Values that the state gives only up to a choice: a run chooses so that they are continuous.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use core::ops::Range;

use super::Schema;

/// The choices for the columns of a quantity that stand for the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Branch {
    /// There is none.
    #[default]
    Single,
    /// The sign of all columns: q and −q are the same attitude.
    Sign,
    /// Angles in ascending order, each known up to π: the first + π may stand at the end, or the last − π at the start.
    HalfTurns {
        /// A bound of |d/dt| of their sum.
        rate: f64,
    },
    /// Three Euler angles. The first and the third are known up to a turn; the second stays within its range, so that it
    /// does not depend on the rows before. At the singular β only α + γ or α − γ is known.
    Euler {
        /// True if the first axis is the third.
        is_proper: bool,
        /// True if α + γ is known at the lower end of the range of β, which is 0 or −π/2, and α − γ at the upper end;
        /// false if it is the other way round.
        rises: bool,
    },
}

impl Branch {
    /// Euler angles are singular where the second is so near to an end of its range.
    pub const SINGULAR: f64 = 1e-7;

    /// How far three Euler angles are from where they are singular: an angle from 0 to π/2.
    pub fn distance_to_singular(self, values: &[f64]) -> Option<f64> {
        let Branch::Euler { is_proper, .. } = self else { return None };
        let beta = if is_proper { values[1] } else { values[1] + FRAC_PI_2 };
        Some((beta - PI * (beta / PI).round()).abs())
    }

    /// The time in which the values surely change by less than half of the way to another choice, if a bound is known. Points
    /// that are further apart may lose half turns.
    pub fn longest_gap(self) -> Option<f64> {
        let Branch::HalfTurns { rate } = self else { return None };
        (rate > 0.0 && rate.is_finite()).then(|| 0.9 * FRAC_PI_2 / rate)
    }

    /// values ← the choice that is nearest to the values `before`; as they are, where one of these is NaN.
    pub(crate) fn follow(self, before: &[f64], values: &mut [f64]) {
        match self {
            Branch::Single => {}
            Branch::Sign => {
                let dot: f64 = before.iter().zip(&*values).map(|(a, b)| a * b).sum();
                if dot < 0.0 {
                    values.iter_mut().for_each(|x| *x = -*x);
                }
            }
            Branch::HalfTurns { .. } => {
                // Each angle that goes from one end to the other changes the sum by π.
                let sum: f64 = before.iter().zip(&*values).map(|(a, b)| a - b).sum();
                let moved = (sum / PI).round();
                if !moved.is_finite() || values.is_empty() {
                    return;
                }
                let count = values.len() as f64;
                let around = moved.div_euclid(count);
                let first = (moved - around * count) as usize;
                values[..first].iter_mut().for_each(|x| *x += PI);
                values.rotate_left(first);
                values.iter_mut().for_each(|x| *x += around * PI);
            }
            Branch::Euler { is_proper, rises } => {
                let ([a0, _, c0], [a, b, c]) = (before, &*values) else { return };
                if before.iter().any(|x| x.is_nan()) {
                    return;
                }
                let (mut a, b, mut c) = (*a, *b, *c);
                if self.distance_to_singular(values).is_some_and(|far| far <= Branch::SINGULAR) {
                    // The third angle keeps its value.
                    let low = if is_proper { b.cos() > 0.0 } else { b.sin() < 0.0 };
                    let moved = c0 - c;
                    a -= if low == rises { moved } else { -moved };
                    c = *c0;
                }
                let nearest = |x: f64, before: f64| x + TAU * ((before - x) / TAU).round();
                values.copy_from_slice(&[nearest(a, *a0), b, nearest(c, *c0)]);
            }
        }
    }
}

/// The columns with choices, and their values at both ends of a step.
///
/// All points of a step follow its start, so that a value does not depend on which points were seen before it. A point that
/// is further than all others is taken as the end of a step.
#[derive(Clone, Debug)]
pub(crate) struct Branches {
    columns: Vec<(Branch, Range<usize>)>,
    is_forward: bool,
    /// The time at the end of the step.
    front: f64,
    /// The values of these columns at the start, one after the other; NaN before the first point.
    start: Vec<f64>,
    /// Those at the end.
    end: Vec<f64>,
}

impl Branches {
    /// Those of a model, before its first point.
    pub(crate) fn new(schema: &Schema, [t0, t1]: [f64; 2]) -> Self {
        let with_choices = schema.iter().filter(|observable| observable.branch != Branch::Single);
        let columns: Vec<_> = with_choices.map(|o| (o.branch, o.places())).collect();
        let count = columns.iter().map(|(_, places)| places.len()).sum();
        let unknown = vec![f64::NAN; count];
        Branches {
            columns,
            is_forward: t1 > t0,
            front: f64::NAN,
            start: unknown.clone(),
            end: unknown,
        }
    }

    /// True if no value has a choice.
    pub(crate) fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// True if turns between two points count, so that each step has to be seen. A sign follows the point before.
    pub(crate) fn count_turns(&self) -> bool {
        self.columns.iter().any(|(branch, _)| *branch != Branch::Sign)
    }

    /// numbers ← the row at t whose choices are nearest to those of the start of the step.
    pub(crate) fn follow(&mut self, t: f64, numbers: &mut [f64]) {
        let Branches { front, start, end, .. } = self;
        let is_end = front.is_nan() || if self.is_forward { t > *front } else { t < *front };
        if is_end {
            start.copy_from_slice(end);
            *front = t;
        }
        let mut first = 0;
        for (branch, places) in &self.columns {
            let place = first..first + places.len();
            let values = &mut numbers[places.clone()];
            branch.follow(&start[place.clone()], values);
            // A point without values is skipped.
            if is_end && values.iter().all(|x| x.is_finite()) {
                end[place].copy_from_slice(values);
            }
            first += places.len();
        }
    }

    /// Ends the step at t, where the numbers are these: what comes next starts there.
    pub(crate) fn cut(&mut self, t: f64, numbers: &[f64]) {
        self.front = t;
        let values = self.columns.iter().flat_map(|(_, places)| &numbers[places.clone()]);
        for (end, value) in self.end.iter_mut().zip(values) {
            *end = *value;
        }
    }

    /// The state of a run: that of its driver, and the last values after it.
    pub(crate) fn append_to(&self, driver: &[u8]) -> Vec<u8> {
        let mut bytes = driver.to_vec();
        if !self.is_empty() {
            let numbers = self.start.iter().chain(&self.end).chain([&self.front]);
            numbers.for_each(|x| bytes.extend(x.to_le_bytes()));
        }
        bytes
    }

    /// Goes on from [`append_to`](Self::append_to); the state of the driver. Bytes that are too short are left to the
    /// driver to refuse.
    pub(crate) fn take_from(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        let count = if self.is_empty() { 0 } else { self.start.len() + self.end.len() + 1 };
        let Some(of_driver) = bytes.len().checked_sub(8 * count) else { return bytes };
        let places = self.start.iter_mut().chain(&mut self.end).chain([&mut self.front]);
        for (x, bytes) in places.zip(bytes[of_driver..].chunks_exact(8)) {
            *x = f64::from_le_bytes(bytes.try_into().unwrap_or_default());
        }
        bytes.truncate(of_driver);
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_TURNS: Branch = Branch::HalfTurns { rate: 1.0 };

    #[test]
    fn angles_go_on_over_a_half_turn() {
        let (slow, fast) = (0.3, 1.1);
        let mut last = [-0.2, 0.4];
        for step in 0..400 {
            let t = 0.05 * f64::from(step);
            // Both rise and go through ±π/2; they never meet, as they differ by less than π.
            let exact = [-0.2 + slow * t, 0.4 + slow * t + 0.5 * (fast * t).sin()];
            let mut values = exact.map(|x| (x + 0.5 * PI).rem_euclid(PI) - 0.5 * PI);
            values.sort_by(f64::total_cmp);
            HALF_TURNS.follow(&last, &mut values);
            for (x, exact) in values.iter().zip(exact) {
                assert!((x - exact).abs() < 1e-12, "t = {t}: {values:?}, expected {exact}");
            }
            last = values;
        }
        // Both fall, and one after the other goes through −π/2.
        let mut falling = [-1.5, 1.5];
        HALF_TURNS.follow(&[-4.6, -1.7], &mut falling);
        assert_eq!(falling, [-1.5 - PI, 1.5 - PI]);
        let mut falling = [-1.5, 1.5];
        HALF_TURNS.follow(&[-1.7, -1.45], &mut falling);
        assert_eq!(falling, [1.5 - PI, -1.5]);
    }

    /// At the singular angle the first and the third angle are not known alone. Only their sum or difference is known.
    #[test]
    fn euler_angles_go_on_at_the_singular_one() {
        let follow = |is_proper, rises, before: [f64; 3], values: [f64; 3]| {
            let mut values = values;
            Branch::Euler { is_proper, rises }.follow(&before, &mut values);
            values
        };
        let close = |a: [f64; 3], b: [f64; 3]| {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?}, expected {b:?}");
        };
        let before = [0.4, 1.5, 0.7];
        close(follow(false, false, before, [1.1, FRAC_PI_2, 0.0]), [0.4, FRAC_PI_2, 0.7]);
        close(follow(false, true, before, [-0.3, FRAC_PI_2, 0.0]), [0.4, FRAC_PI_2, 0.7]);
        let before = [0.4, 0.1, 0.7 + TAU];
        close(follow(true, true, before, [1.1, 0.0, 0.0]), [0.4, 0.0, 0.7 + TAU]);
        // Beyond it the first and the third jump, and the second stays in its range.
        close(follow(true, true, before, [-2.6, 0.1, -2.3]), [-2.6, 0.1, TAU - 2.3]);
        close(follow(false, true, [3.0, 1.5, -3.0], [-3.0, 1.4, 3.0]), [TAU - 3.0, 1.4, 3.0 - TAU]);
        close(follow(true, true, [f64::NAN; 3], [3.0, 0.1, 0.7]), [3.0, 0.1, 0.7]);
    }

    #[test]
    fn a_point_without_values_is_passed_over() {
        let mut q = [-1.0, 0.0];
        Branch::Sign.follow(&[f64::NAN; 2], &mut q);
        assert_eq!(q, [-1.0, 0.0]);
        Branch::Sign.follow(&[0.6, 0.8], &mut q);
        assert_eq!(q, [1.0, 0.0]);
        let mut angles = [f64::NAN, 0.0];
        HALF_TURNS.follow(&[0.0, 0.0], &mut angles);
        assert!(angles[0].is_nan() && angles[1] == 0.0);
    }
}
