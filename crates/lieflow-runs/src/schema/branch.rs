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
    ///
    /// They are followed as the angles φ with tan φ = tan θ / scale: θ and φ are the same at multiples of π/2, and where the
    /// tangents are large numbers, φ is slow where θ is quick.
    HalfTurns {
        /// A bound of |d/dt| of the sum of φ.
        rate: f64,
        /// The size of the tangents, > 0.
        scale: f64,
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

/// What differs by less from half a turn is half a turn; in turns.
const HALF_TURN: f64 = 1e-6;

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
        let Branch::HalfTurns { rate, .. } = self else { return None };
        (rate > 0.0 && rate.is_finite()).then(|| 0.9 * FRAC_PI_2 / rate)
    }

    /// True if values that follow those `before` are so far from them that later ones should follow them instead.
    fn is_far(self, before: &[f64], values: &[f64]) -> bool {
        let pairs = || before.iter().zip(values);
        match self {
            Branch::Single => false,
            Branch::Sign => pairs().map(|(a, b)| a * b).sum::<f64>() < 0.9,
            Branch::HalfTurns { scale, .. } => {
                let far = |(a, b): (&f64, &f64)| (slowed(*a, scale) - slowed(*b, scale)).abs();
                pairs().map(far).sum::<f64>() > 0.3
            }
            Branch::Euler { .. } => pairs().any(|(a, b)| (a - b).abs() > 1.0),
        }
    }

    /// values ← the choice that is nearest to the values `before`; as they are, where one of these is NaN.
    pub fn follow(self, before: &[f64], values: &mut [f64]) {
        match self {
            Branch::Single => {}
            Branch::Sign => {
                let dot: f64 = before.iter().zip(&*values).map(|(a, b)| a * b).sum();
                if dot < 0.0 {
                    values.iter_mut().for_each(|x| *x = -*x);
                }
            }
            Branch::HalfTurns { scale, .. } => {
                // Each angle that goes from one end to the other changes the sum by π.
                let pairs = before.iter().zip(&*values);
                let sum: f64 = pairs.map(|(a, b)| slowed(*a, scale) - slowed(*b, scale)).sum();
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
                // A half turn, which a pass through the singular angle gives, is one forward whatever its rounding.
                let nearest =
                    |x: f64, before: f64| x + TAU * ((before - x) / TAU - 0.5 + HALF_TURN).ceil();
                values.copy_from_slice(&[nearest(a, *a0), b, nearest(c, *c0)]);
            }
        }
    }
}

/// φ with tan φ = tan θ / scale, in the same quarter turn.
fn slowed(theta: f64, scale: f64) -> f64 {
    let half_turns = PI * (theta / PI).round();
    let (sin, cos) = (theta - half_turns).sin_cos();
    half_turns + sin.atan2(scale * cos)
}

/// The most known points of a step.
const KNOWN_MOST: usize = 200_000;

/// A time, or its negative in a run backward, as a number whose order is that of the times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Moment(i64);

impl Moment {
    fn of(time: f64) -> Self {
        let bits = time.to_bits().cast_signed();
        Moment(if bits < 0 { bits ^ i64::MAX } else { bits })
    }
    fn time(self) -> f64 {
        let bits = if self.0 < 0 { self.0 ^ i64::MAX } else { self.0 };
        f64::from_bits(bits.cast_unsigned())
    }
}

/// The known points of a step in the order of their times, each with its values. A new step allocates nothing.
#[derive(Clone, Debug, Default)]
struct Known {
    moments: Vec<Moment>,
    /// The values of each point, one after the other.
    values: Vec<f64>,
}

impl Known {
    /// The number of values at each point.
    fn width(&self) -> usize {
        self.values.len().checked_div(self.moments.len()).unwrap_or(0)
    }
    /// The values of the last point up to this moment, or else of the first one. None without points.
    fn up_to(&self, moment: Moment) -> Option<&[f64]> {
        let after = self.moments.partition_point(|known| *known <= moment);
        self.values.chunks_exact(self.width().max(1)).nth(after.saturating_sub(1))
    }
    /// A point more.
    fn add(&mut self, moment: Moment, values: &[f64]) {
        // Rows come in the order of time: the first points are not needed again.
        if self.moments.len() >= KNOWN_MOST {
            let width = self.width();
            self.moments.drain(..KNOWN_MOST / 2);
            self.values.drain(..KNOWN_MOST / 2 * width);
        }
        let place = self.moments.partition_point(|known| *known < moment);
        self.moments.insert(place, moment);
        let first = place * values.len();
        self.values.splice(first..first, values.iter().copied());
    }
    /// This point alone.
    fn restart(&mut self, moment: Moment, values: &[f64]) {
        self.moments.clear();
        self.values.clear();
        self.add(moment, values);
    }
    /// The points of a later step, too.
    fn append(&mut self, later: &Known) {
        self.moments.extend_from_slice(&later.moments);
        self.values.extend_from_slice(&later.values);
    }
}

/// The columns with choices, and their values in the last step.
///
/// Each point follows the last known one before it in the step, so that rows are continuous where neighbours are. Points
/// that lie close to a known one are not kept: there the choice is the same. A point that is further than all others is
/// taken as the end of a new step.
#[derive(Clone, Debug)]
pub struct Branches {
    columns: Vec<(Branch, Range<usize>)>,
    is_forward: bool,
    /// The time at the end of the step.
    front: f64,
    /// The values of these columns at the end, one after the other. They have no choice yet, because what lies within the
    /// step may be seen later.
    end: Vec<f64>,
    /// The known points from the start of the step on.
    known: Known,
    /// The known points of all steps before, if they are kept.
    before: Option<Known>,
    /// The values of a point, as they are followed.
    values: Vec<f64>,
    /// The values at the start of a step.
    start: Vec<f64>,
}

impl Branches {
    /// Those of a model, before its first point.
    pub fn new(schema: &Schema, [t0, t1]: [f64; 2]) -> Self {
        let with_choices = schema.iter().filter(|observable| observable.branch != Branch::Single);
        let columns: Vec<_> = with_choices.map(|o| (o.branch, o.places())).collect();
        Branches {
            columns,
            is_forward: t1 > t0,
            front: f64::NAN,
            end: Vec::new(),
            known: Known::default(),
            before: None,
            values: Vec::new(),
            start: Vec::new(),
        }
    }

    /// Keeps the known points of all steps, for [`of_run`](Self::of_run).
    pub fn keep_all(&mut self) {
        self.before = Some(Known::default());
    }

    /// The choices of a whole run that kept its points.
    pub fn of_run(mut self) -> Self {
        self.known = self.before.take().map_or(Known::default(), |mut all| {
            all.append(&self.known);
            all
        });
        self
    }

    /// The step ends at this point, where the next one starts.
    fn restart(&mut self, moment: Moment, values: &[f64]) {
        if let Some(before) = &mut self.before {
            before.append(&self.known);
        }
        self.known.restart(moment, values);
    }

    /// True if no value has a choice.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The places of all columns with choices in a row.
    fn places(&self) -> impl Iterator<Item = usize> {
        self.columns.iter().flat_map(|(_, places)| places.clone())
    }

    /// The number of these columns.
    fn count(&self) -> usize {
        self.columns.iter().map(|(_, places)| places.len()).sum()
    }

    /// Is `t` after `front`?
    fn is_after(&self, t: f64, front: f64) -> bool {
        if self.is_forward { t > front } else { t < front }
    }

    /// values ← the choice at t that is nearest to the last known point up to t. Returns true if it is far from that.
    fn choose(&self, t: f64, values: &mut [f64]) -> bool {
        let Some(before) = self.known.up_to(self.moment(t)) else { return true };
        let (mut first, mut is_far) = (0, false);
        for (branch, places) in &self.columns {
            let place = first..first + places.len();
            branch.follow(&before[place.clone()], &mut values[place.clone()]);
            is_far |= branch.is_far(&before[place.clone()], &values[place]);
            first += places.len();
        }
        is_far
    }

    fn moment(&self, t: f64) -> Moment {
        Moment::of(if self.is_forward { t } else { -t })
    }

    /// numbers ← the row at t with the choices that go on from the points before it.
    pub fn follow(&mut self, t: f64, numbers: &mut [f64]) {
        if self.is_empty() {
            return;
        }
        let mut values = core::mem::take(&mut self.values);
        values.clear();
        values.extend(self.places().map(|place| numbers[place]));
        let has_values = values.iter().all(|x| x.is_finite());
        if self.front.is_nan() || self.is_after(t, self.front) {
            if !self.front.is_nan() && !self.end.is_empty() {
                let mut start = core::mem::take(&mut self.start);
                core::mem::swap(&mut start, &mut self.end);
                self.end.clear();
                self.choose(self.front, &mut start);
                self.restart(self.moment(self.front), &start);
                self.start = start;
            }
            self.front = t;
            // A point without values is skipped.
            if has_values {
                self.end.clone_from(&values);
            }
        }
        let is_far = self.choose(t, &mut values);
        for (place, value) in self.places().zip(&values) {
            numbers[place] = *value;
        }
        if is_far && has_values && !self.known.moments.is_empty() && t != self.front {
            self.known.add(self.moment(t), &values);
        }
        self.values = values;
    }

    /// Ends the step at t, where the numbers are these: what comes next starts there.
    pub fn cut(&mut self, t: f64, numbers: &[f64]) {
        let end: Vec<f64> = self.places().map(|place| numbers[place]).collect();
        self.restart(self.moment(t), &end);
        (self.end, self.front) = (end, t);
    }

    /// numbers ← the row at any t of a run whose points are all known.
    pub fn follow_known(&self, t: f64, numbers: &mut [f64]) {
        let mut values: Vec<f64> = self.places().map(|place| numbers[place]).collect();
        self.choose(t, &mut values);
        for (place, value) in self.places().zip(values) {
            numbers[place] = value;
        }
    }

    /// The known points as numbers.
    pub fn numbers(&self) -> Vec<f64> {
        let all = self.known.values.chunks_exact(self.count().max(1)).zip(&self.known.moments);
        all.flat_map(|(values, moment)| [&[moment.time()], values].concat()).collect()
    }

    /// Knows the points of these [`numbers`](Self::numbers), too.
    pub fn set_numbers(&mut self, numbers: &[f64]) {
        for point in numbers.chunks_exact(self.count() + 1) {
            self.known.append(&Known {
                moments: vec![Moment::of(point[0])],
                values: point[1..].to_vec(),
            });
        }
    }

    /// The state of a run: that of its driver, and the values of the last step after it.
    pub fn append_to(&self, driver: &[u8]) -> Vec<u8> {
        let mut bytes = driver.to_vec();
        if !self.is_empty() {
            let mut write = |x: f64| bytes.extend(x.to_le_bytes());
            let all = self.known.values.chunks_exact(self.known.width().max(1));
            for (moment, values) in self.known.moments.iter().zip(all) {
                values.iter().copied().chain([moment.time()]).for_each(&mut write);
            }
            self.end.iter().copied().for_each(&mut write);
            [self.front, self.end.len() as f64, self.known.moments.len() as f64]
                .into_iter()
                .for_each(write);
        }
        bytes
    }

    /// Goes on from [`append_to`](Self::append_to); the state of the driver. Bytes that are too short are left to the
    /// driver to refuse.
    pub fn take_from(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        if self.is_empty() {
            return bytes;
        }
        let count = self.count();
        let mut last = |count: usize| -> Option<Vec<f64>> {
            let start = bytes.len().checked_sub(count.checked_mul(8)?)?;
            let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap_or_default());
            let numbers = bytes[start..].chunks_exact(8).map(number).collect();
            bytes.truncate(start);
            Some(numbers)
        };
        let mut taken = || {
            let [front, end, points] = last(3)?[..] else { return None };
            let end = last(end as usize)?;
            let mut known = Known::default();
            for _ in 0..points as usize {
                let mut values = last(count + 1)?;
                let moment = Moment::of(values.pop()?);
                known.add(moment, &values);
            }
            Some((front, end, known))
        };
        if let Some((front, end, known)) = taken() {
            (self.front, self.end, self.known) = (front, end, known);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_TURNS: Branch = Branch::HalfTurns { rate: 1.0, scale: 1.0 };

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
    fn moments_have_the_order_of_times() {
        let times = [f64::NEG_INFINITY, -3.5, -1e-300, 0.0, 5e-324, 2.0, 1e300, f64::INFINITY];
        assert!(times.map(Moment::of).is_sorted());
        assert_eq!(times.map(|t| Moment::of(t).time()), times);
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
