//! The search for the zeros of an event in a step. It knows numbers only.

use super::bracket;
use super::roots::{self, Proxy, Rounding};
use super::stats::RunError;

/// The direction of the zeros that count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// From negative to positive, in the direction of the run.
    Rising,
    /// From positive to negative.
    Falling,
    /// Both.
    #[default]
    Both,
}

impl Direction {
    pub(super) fn has(self, rising: bool) -> bool {
        match self {
            Direction::Rising => rising,
            Direction::Falling => !rising,
            Direction::Both => true,
        }
    }

    /// True if the values of g before and after have opposite signs, in this direction.
    pub fn has_change(self, before: f64, after: f64) -> bool {
        (before < 0.0 && after > 0.0 || before > 0.0 && after < 0.0) && self.has(after > 0.0)
    }
}

/// The number of points within a step where g is evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) enum Points {
    /// As many as a polynomial needs, in long steps and in those that may have two zeros.
    AsNeeded,
    /// So many in each step, and as many between them; none but the ends of steps for 0.
    Each(u32),
    /// As many as the first says of the step size and of g at the two ends. Between them a part is halved while the second
    /// says so of its size and of g at its ends.
    By(fn(f64, [f64; 2]) -> u32, fn(f64, [f64; 2]) -> bool),
}

/// The values of g up to the last point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    /// g at the last point.
    pub(super) value: f64,
    /// g at the start of the step before, and its size; none at the start and after a change.
    pub(super) before: Option<[f64; 2]>,
    /// True if the sign of g has to be taken again, a little later.
    pub(super) anew: bool,
    /// The level of the polynomials that described g in the last step that needed them.
    pub(super) level: usize,
}

impl Seen {
    /// Nothing is known but g at a point.
    pub(super) fn only(value: f64, anew: bool) -> Self {
        Seen { value, before: None, anew, level: 1 }
    }
}

/// The largest number of points within a step that a caller may ask for ([`Event::points`](super::Event::points)).
pub(super) const POINTS_MAX: u32 = 100_000;

/// How often a part of a long step is halved, where no polynomial describes g.
const HALVINGS: u32 = 5;

/// The part of a step after which the sign of g is taken again.
pub(super) const A_LITTLE_LATER: f64 = 1.0 / 65536.0;

/// Whether g rises or falls through zero from one value to the next.
fn passes(before: f64, after: f64) -> Option<bool> {
    if before < 0.0 && after >= 0.0 {
        Some(true)
    } else if before > 0.0 && after <= 0.0 {
        Some(false)
    } else {
        None
    }
}

/// Are both values of g, at points of a step, far from 0, beside how g bends? It bends as its values at the start of the step
/// before and at both ends of this step tell, of these sizes.
#[inline(always)]
pub(super) fn is_far([a, b]: [f64; 2], [before, first, last]: [f64; 3], sizes: [f64; 2]) -> bool {
    // Times the length of the step before: a division takes as long as the rest.
    let [length, size] = sizes;
    let bend = (last - first) * length - (first - before) * size;
    let near = if a.abs() < b.abs() { a.abs() } else { b.abs() };
    near * length > 2.0 * bend.abs()
}

/// The search for the zeros of one event in a step. It knows numbers only, so it is compiled once.
pub(super) struct Search {
    pub(super) direction: Direction,
    pub(super) points: Points,
    /// Is g looked at more closely, because the step is long?
    pub(super) is_long: bool,
    pub(super) seen: Seen,
    /// Is it the first step of the run?
    pub(super) first_step: bool,
    /// The start and the end of the step.
    pub(super) span: [f64; 2],
    /// g at the end.
    pub(super) last: f64,
    /// The rounding of the numbers of the problem.
    pub(super) epsilon: f64,
}

impl Search {
    /// True if the ends of the step tell that there is no zero.
    #[inline]
    pub(super) fn is_idle(&self) -> bool {
        let Search { seen: Seen { value, anew, .. }, span: [start, end], last, .. } = *self;
        let is_simple = !self.is_long
            && self.points(value) == 0
            && !self.may_have_two(value)
            && !self.is_halved([(start, value), (end, last)]);
        !anew && is_simple && passes(value, last).is_none()
    }

    /// The number of points within the step that a caller asks for, if g is `first` at its start.
    #[inline]
    fn points(&self, first: f64) -> u32 {
        let Search { span: [start, end], last, .. } = *self;
        match self.points {
            Points::AsNeeded => 0,
            Points::Each(points) => points,
            Points::By(points, _) => points((end - start).abs(), [first, last]).min(POINTS_MAX),
        }
    }

    /// True if a part between two points is halved.
    #[inline]
    fn is_halved(&self, [left, right]: [(f64, f64); 2]) -> bool {
        match self.points {
            Points::By(_, is_halved) => is_halved((right.0 - left.0).abs(), [left.1, right.1]),
            _ => false,
        }
    }

    /// Calls `found` with the zeros in a part, and looks at g in its middle, and in the middles of its halves, while these are
    /// halved. So many points are left.
    fn zeros_of_halves(
        &self,
        [left, right]: [(f64, f64); 2],
        points_left: &mut u32,
        g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
        found: &mut dyn FnMut(f64, bool),
    ) -> Result<(), RunError> {
        let t = left.0 + 0.5 * (right.0 - left.0);
        if *points_left == 0 || t == left.0 || t == right.0 || !self.is_halved([left, right]) {
            return self.zero_between([left, right], g, found);
        }
        *points_left -= 1;
        let middle = (t, g(t)?);
        self.zeros_of_halves([left, middle], points_left, g, found)?;
        self.zeros_of_halves([middle, right], points_left, g, found)
    }

    /// True if the step may have two zeros, if g is `first` at its start, and these are searched for.
    #[inline]
    fn may_have_two(&self, first: f64) -> bool {
        let Search { seen, span: [start, end], last, .. } = *self;
        match (self.points, seen.before) {
            (Points::Each(0) | Points::By(..), _) => false,
            (_, None) => true,
            (_, Some([before, length])) => {
                let sizes = [length, (end - start).abs()];
                !is_far([first, last], [before, seen.value, last], sizes)
            }
        }
    }

    /// What is known of g at the end of the step.
    #[inline]
    pub(super) fn seen_at_end(&self) -> Seen {
        let [start, end] = self.span;
        let before = Some([self.seen.value, (end - start).abs()]);
        Seen { value: self.last, before, anew: false, level: self.seen.level }
    }

    /// Calls `found` with t and the direction of each zero. Returns what is known at the end of the step, and false if it
    /// may have more zeros.
    #[inline(never)]
    pub(super) fn zeros(
        &self,
        g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
        found: &mut dyn FnMut(f64, bool),
    ) -> Result<(Seen, bool), RunError> {
        let Search { seen, span: [start, end], last, .. } = *self;
        let mut left = (start, seen.value);
        if seen.anew {
            // Later than start by some digits of it, also in a step as short as these.
            let least = (4.0 * f64::EPSILON * start.abs()).copysign(end - start);
            let later = A_LITTLE_LATER * (end - start);
            let t = start + if later.abs() < least.abs() { least } else { later };
            let is_within = (t - end) * (end - start) < 0.0;
            let (t, value) = if is_within { (t, g(t)?) } else { (end, last) };
            // A zero at the very start of the run, and its direction.
            if self.first_step && left.1 == 0.0 && value != 0.0 && self.direction.has(value > 0.0) {
                found(start, value > 0.0);
            }
            left = (t, value);
        }
        let mut seen = self.seen_at_end();
        let points = self.points(left.1);
        let (begin, whole) = (left.0, end - left.0);
        let places = (1..=points).map(|i| begin + whole * f64::from(i) / (f64::from(points) + 1.0));
        if let Points::By(..) = self.points {
            let mut points_left = POINTS_MAX - points;
            for t in places.chain([end]) {
                let right = (t, if t == end { last } else { g(t)? });
                self.zeros_of_halves([left, right], &mut points_left, g, found)?;
                left = right;
            }
            return Ok((seen, true));
        }
        if !self.is_long && !self.may_have_two(left.1) {
            self.zeros_among([left, (end, last)], places, g, found)?;
            return Ok((seen, true));
        }
        let (mut before, mut coarsest, mut is_sure) = (self.seen.before, 0, true);
        for t in places.chain([end]) {
            let right = (t, if t == end { last } else { g(t)? });
            if t != left.0 {
                let level = self.zeros_by_polynomials([left, right], before.take(), g, found)?;
                coarsest = coarsest.max(level.unwrap_or(roots::FINEST));
                is_sure &= level.is_some();
            }
            left = right;
        }
        seen.level = coarsest;
        Ok((seen, is_sure))
    }

    /// Calls `found` with the zeros between two points. `before` is g at the start of the step before, and its size.
    /// Returns the level that describes g there; none if no polynomial does, so that there may be more zeros.
    fn zeros_by_polynomials(
        &self,
        [left, right]: [(f64, f64); 2],
        before: Option<[f64; 2]>,
        g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
        found: &mut dyn FnMut(f64, bool),
    ) -> Result<Option<usize>, RunError> {
        let length = right.0 - left.0;
        let mut values = [0.0; roots::MOST];
        (values[0], values[roots::MOST - 1]) = (left.1, right.1);
        let middle = roots::MOST / 2;
        values[middle] = g(left.0 + 0.5 * length)?;
        if let (0, Some([before, size])) = (self.seen.level, before)
            && roots::has_none(
                [left.1, values[middle], right.1],
                (size / length.abs(), before),
                self.epsilon,
            )
        {
            return Ok(Some(0));
        }
        self.zeros_between([left, right], values, (self.seen.level, HALVINGS, 0.0), g, found)
    }

    /// Calls `found` with the zeros between two points, from the values of g there and in the middle. Polynomials of
    /// this level and finer describe g, else those of halves, which are halved so often at most. `noise` is the rounding of g
    /// in the whole step, once that is known. Returns as
    /// [`zeros_by_polynomials`](Self::zeros_by_polynomials).
    fn zeros_between(
        &self,
        ends: [(f64, f64); 2],
        mut values: [f64; roots::MOST],
        (level, halvings, noise): (usize, u32, f64),
        g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
        found: &mut dyn FnMut(f64, bool),
    ) -> Result<Option<usize>, RunError> {
        let [left, right] = ends;
        let at = |place: f64| left.0 + place * (right.0 - left.0);
        // The rounding of t, in parts of the length.
        let blur = f64::EPSILON * left.0.abs().max(right.0.abs()) / (right.0 - left.0).abs();
        let middle = roots::MOST / 2;
        let mut known = middle;
        for level in level..=roots::FINEST {
            let stride = roots::stride(level);
            for j in (0..roots::MOST).step_by(stride).filter(|j| j % known != 0) {
                values[j] = g(at(roots::place(j)))?;
            }
            known = stride;
            let rounding = Rounding { noise, blur, epsilon: self.epsilon };
            let proxy = Proxy::new(&values, level, rounding);
            if let Some(separators) = proxy.separators() {
                let places = separators.places().iter().map(|&place| at(place));
                self.zeros_among(ends, places, g, found)?;
                return Ok(Some(proxy.level.unwrap_or(level)));
            }
        }
        let (half, value) = (at(0.5), values[middle]);
        if halvings == 0 || half == left.0 || half == right.0 {
            let places = (1..roots::MOST - 1).map(|j| at(roots::place(j)));
            self.zeros_among(ends, places, g, found)?;
            return Ok(roots::shows_all(&values).then_some(roots::FINEST));
        }
        let noise =
            if halvings == HALVINGS { roots::noise_of(&values, self.epsilon) } else { noise };
        let of_halves = (roots::FINEST, halvings - 1, noise);
        let mut is_sure = true;
        for [a, b] in [[left, (half, value)], [(half, value), right]] {
            let mut values = [0.0; roots::MOST];
            (values[0], values[middle], values[roots::MOST - 1]) =
                (a.1, g(0.5 * (a.0 + b.0))?, b.1);
            let of_half = self.zeros_between([a, b], values, of_halves, g, found)?;
            is_sure &= of_half.is_some();
        }
        Ok(is_sure.then_some(roots::FINEST))
    }

    /// Calls `found` with one zero between each two neighbours of opposite sign, of the ends and the points between.
    fn zeros_among(
        &self,
        [mut left, end]: [(f64, f64); 2],
        points: impl Iterator<Item = f64>,
        g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
        found: &mut dyn FnMut(f64, bool),
    ) -> Result<(), RunError> {
        for t in points {
            if t == left.0 || t == end.0 {
                continue;
            }
            let right = (t, g(t)?);
            self.zero_between([left, right], g, found)?;
            left = right;
        }
        self.zero_between([left, end], g, found)
    }

    /// Calls `found` with the zero between two points of opposite sign. A pole may be infinite there.
    fn zero_between(
        &self,
        [left, right]: [(f64, f64); 2],
        g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
        found: &mut dyn FnMut(f64, bool),
    ) -> Result<(), RunError> {
        if let Some(rising) = passes(left.1, right.1)
            && self.direction.has(rising)
        {
            let mut g = |t: f64| match g(t) {
                Err(RunError::Event { value, .. }) if value.is_infinite() => {
                    Ok(f64::MAX.copysign(value))
                }
                value => value,
            };
            found(bracket::zero(left, right, &mut g)?, rising);
        }
        Ok(())
    }
}
