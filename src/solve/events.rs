//! Events: where a function g(t, y) of the solution passes zero.
//!
//! After each step g is evaluated at the end of the step. Between two neighbours of opposite sign the zero is found by
//! dense output, to rounding of t (`bracket.rs`).
//!
//! If the step may have two zeros, g is replaced by a polynomial in t. Its coefficients tell whether it has converged, and
//! its zeros are counted (`roots.rs`). Where g has not converged the step is halved, five times at most. Points between
//! the zeros of the polynomial separate those of g, which are then found as above.
//!
//! A long step may have many zeros, whatever g is at its ends. Steps are long by methods of order 10 and more, and those
//! that turn the state by more than a radian, as an exponential does where f is constant. A long step whose values are
//! far from 0 needs one value in its middle: with the end of the step before it shows how far the parabola through three
//! values is from g.
//!
//! | g | what is found |
//! |---|---|
//! | from < 0 to ≥ 0 | a rising zero |
//! | from > 0 to ≤ 0 | a falling zero |
//! | to 0, where it stays | a zero where that begins |
//! | 0 at the start of the run | a zero at the start: rising if g > 0 follows, falling if g < 0 follows |
//! | touches 0 and turns back | nothing, unless g is exactly 0 at a point where signs are compared |
//! | not finite | [`RunError::Event`] with the name of the event |
//!
//! After a zero that changed the state, the sign of g is taken again 2⁻¹⁶ of a step later. So the same zero is not found
//! twice.

use core::fmt;
use core::ops::Range;

use super::bracket;
use super::output::{AnyOutput, Slot};
use super::roots::{self, Proxy};
use super::stats::RunError;
use super::timeline::Timeline;

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
    fn has(self, rising: bool) -> bool {
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

pub(super) type Function<'a, Y> = Box<dyn FnMut(f64, &Y) -> f64 + 'a>;
pub(super) type Told<'a, Y> = Box<dyn FnMut(f64, &Y, bool) + 'a>;
pub(super) type Change<'a, Y> = Box<dyn FnMut(f64, &mut Y) + 'a>;

/// An event: the zeros of g(t, y), and the action there.
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use lieflow::nalgebra::Vector3;
///
/// // The flips of a free body that rotates about its middle axis, until the third.
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let method = Rkmk::new(DOPRI5, Exp);
/// let flips = Event::new("flip", |_, m: &Vector3<f64>| m.y).stop_after(3);
/// let run = Solve::new(&body, &method, [0.0, f64::INFINITY])
///     .tolerances(1e-10, 1e-12)
///     .event(flips)
///     .run(Vector3::new(0.01, 3.0, 0.01))?;
/// assert_eq!(run.events.len(), 3);
/// assert_eq!(run.t, run.events[2].t);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Event<'a, Y> {
    pub(super) rule: EventRule,
    pub(super) functions: EventFunctions<'a, Y>,
}

/// The functions of an event.
pub(super) struct EventFunctions<'a, Y> {
    pub(super) g: Function<'a, Y>,
    pub(super) change: Option<Change<'a, Y>>,
    pub(super) told: Option<Told<'a, Y>>,
}

/// What an event is besides its functions, and the zeros that it had.
pub(super) struct EventRule {
    pub(super) name: String,
    direction: Direction,
    pub(super) stop_after: Option<u64>,
    /// True if the event changes the state.
    pub(super) changes: bool,
    pub(super) points: Points,
    /// True if the steps of the run are long.
    has_long_steps: bool,
    pub(super) seen: Seen,
    /// The number of zeros found so far.
    pub(super) count: u64,
    /// g at the end of a step that may be passed.
    next: f64,
}

impl<Y> fmt::Debug for Event<'_, Y> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Event").field("name", &self.rule.name).finish_non_exhaustive()
    }
}

/// The number of points within a step where g is evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) enum Points {
    /// As many as a polynomial needs, in long steps and in those that may have two zeros.
    AsNeeded,
    /// So many in each step, and as many between them; none but the ends of steps for 0.
    Each(u32),
    /// As many as this says of the step size and of g at the two ends.
    By(fn(f64, [f64; 2]) -> u32),
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
    fn only(value: f64, anew: bool) -> Self {
        Seen { value, before: None, anew, level: 1 }
    }
}

/// The steps of methods of this order and more are long: each is searched for all zeros of an event.
pub const LONG_STEPS: usize = 10;
/// The largest number of points within a step that a caller may ask for ([`Event::points`]).
pub(super) const POINTS_MAX: u32 = 100_000;
/// How often a part of a long step is halved, where no polynomial describes g.
const HALVINGS: u32 = 5;
/// The part of a step after which the sign of g is taken again.
const A_LITTLE_LATER: f64 = 1.0 / 65536.0;

impl<'a, Y> Event<'a, Y> {
    /// Finds all zeros of `g(t, y)`, rising and falling. The run continues after them.
    pub fn new(name: impl Into<String>, g: impl FnMut(f64, &Y) -> f64 + 'a) -> Self {
        let rule = EventRule {
            name: name.into(),
            direction: Direction::Both,
            stop_after: None,
            changes: false,
            points: Points::AsNeeded,
            has_long_steps: false,
            seen: Seen::default(),
            count: 0,
            next: 0.0,
        };
        Event { rule, functions: EventFunctions { g: Box::new(g), change: None, told: None } }
    }
    /// Finds only zeros of this direction.
    pub fn direction(mut self, direction: Direction) -> Self {
        self.rule.direction = direction;
        self
    }
    /// Finds only rising zeros.
    pub fn rising(self) -> Self {
        self.direction(Direction::Rising)
    }
    /// Finds only falling zeros.
    pub fn falling(self) -> Self {
        self.direction(Direction::Falling)
    }
    /// Stops the run at the zero with this number, from 1. [`Solve::run`](super::Solve::run) refuses 0. By default the
    /// run goes on.
    pub fn stop_after(mut self, count: u64) -> Self {
        self.rule.stop_after = Some(count);
        self
    }
    /// Changes the state at each zero. Examples: an impulse, a reset. The new state must be on M.
    pub fn change(mut self, change: impl FnMut(f64, &mut Y) + 'a) -> Self {
        self.rule.changes = true;
        self.functions.change = Some(Box::new(change));
        self
    }
    /// Calls `told(t, y, rising)` at each zero when it is found, and stores no zeros.
    pub fn tell(mut self, told: impl FnMut(f64, &Y, bool) + 'a) -> Self {
        self.functions.told = Some(Box::new(told));
        self
    }
    /// Evaluates g at this many points within every step, at most 100 000; with 0 at the ends of steps only.
    ///
    /// By default g is evaluated at as many points as a polynomial needs that describes it, in steps that may have two zeros
    /// and in long steps, see `docs/driver.md`. A step may have two zeros if |g| at one end is at most twice the change of
    /// the slope of g over this step and the one before, times the step size.
    pub fn points(mut self, points: u32) -> Self {
        self.rule.points = Points::Each(points);
        self
    }
    /// Evaluates g at `points(h, [g₀, g₁])` points within each step, at most 100 000. h > 0 is the step size, g₀ and g₁ are
    /// the values of g at the start and at the end of the step.
    ///
    /// Example: g > 0 is a rate that the state knows, and the points are so many that h · g / points stays below a bound. Such
    /// an event has no zeros; it sees the state often enough.
    pub fn points_by(mut self, points: fn(f64, [f64; 2]) -> u32) -> Self {
        self.rule.points = Points::By(points);
        self
    }
    /// The name.
    pub fn name(&self) -> &str {
        &self.rule.name
    }
}

impl EventRule {
    /// True if it may have zeros.
    pub(super) fn has_zeros(&self) -> bool {
        !matches!(self.points, Points::By(_))
    }

    /// The search for zeros in a step at whose end g is `last`. `turns` says that the state turns by more than a radian.
    #[inline(always)]
    fn search(&self, span: [f64; 2], last: f64, (first_step, turns): (bool, bool)) -> Search {
        let EventRule { direction, points, has_long_steps, seen, .. } = *self;
        let is_long = match points {
            Points::AsNeeded => has_long_steps || turns,
            Points::Each(points) => points > 0 && turns,
            Points::By(_) => false,
        };
        Search { direction, points, is_long, seen, first_step, span, last }
    }

    /// The value of g at t, if it is finite.
    #[inline]
    fn finite(&self, t: f64, value: f64) -> Result<f64, RunError> {
        match value.is_finite() {
            true => Ok(value),
            false => Err(RunError::Event { name: self.name.clone(), t, value }),
        }
    }

    /// True if the run stops at this zero.
    pub(super) fn stops(&self) -> bool {
        self.stop_after.is_some_and(|count| self.count >= count)
    }
}

/// A zero that was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Zero {
    pub(super) t: f64,
    pub(super) event: usize,
    pub(super) rising: bool,
}

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

/// The events of a run.
pub(super) struct Events {
    pub(super) all: Vec<EventRule>,
    /// The zeros of the last step, in the order of time.
    pub(super) found: Vec<Zero>,
}

impl Events {
    /// The events of a run by a method of this order.
    pub(super) fn new(mut all: Vec<EventRule>, order: usize) -> Self {
        all.iter_mut().for_each(|event| event.has_long_steps = order >= LONG_STEPS);
        let found = Vec::with_capacity(2 * all.len() * roots::MOST);
        Events { all, found }
    }

    /// True if each step needs a search, whatever the values at its end.
    pub(super) fn search_always(&self) -> bool {
        let always = |event: &EventRule| match event.points {
            Points::Each(points) => points > 0,
            Points::AsNeeded => event.has_long_steps,
            Points::By(_) => false,
        };
        self.all.iter().any(always)
    }

    /// Passes a step of a streak, which is not the first step of a run, if no event can have a zero in it. `values` are g
    /// at the end of the step. Returns false if the step needs a search; then nothing is passed.
    #[inline(always)]
    pub(super) fn pass(&mut self, span: [f64; 2], values: impl Iterator<Item = f64>) -> bool {
        for (event, last) in self.all.iter_mut().zip(values) {
            if !(last.is_finite() && event.search(span, last, (false, false)).is_idle()) {
                return false;
            }
            event.next = last;
        }
        for event in &mut self.all {
            event.seen = event.search(span, event.next, (false, false)).seen_at_end();
        }
        true
    }

    /// At the start of a run.
    pub(super) fn start(&mut self, t: f64, output: &mut dyn AnyOutput) -> Result<(), RunError> {
        for (index, event) in self.all.iter_mut().enumerate() {
            event.count = 0;
            let value = event.finite(t, output.event(index, t, None))?;
            event.seen = Seen::only(value, value == 0.0);
        }
        Ok(())
    }

    /// Called after the state was changed at t. `at` are the zeros of the last step at that time. Drops the zeros after
    /// them.
    pub(super) fn restart(
        &mut self,
        t: f64,
        output: &mut dyn AnyOutput,
        at: Range<usize>,
    ) -> Result<(), RunError> {
        for (index, event) in self.all.iter_mut().enumerate() {
            let value = event.finite(t, output.event(index, t, None))?;
            let Seen { value: last, before, .. } = event.seen;
            let size = before.map_or(0.0, |[start, _]| last.abs().max(start.abs()));
            // Its zero was just passed, or may have been, up to rounding.
            let anew = value.abs() <= 64.0 * f64::EPSILON * size
                || self.found[at.clone()].iter().any(|zero| zero.event == index);
            event.seen = Seen::only(value, anew);
        }
        self.found.truncate(at.end);
        self.found[at].iter_mut().for_each(|zero| zero.t = t);
        Ok(())
    }

    /// Finds the zeros in the last step of the run, up to its time.
    #[inline]
    pub(super) fn search(
        &mut self,
        times: &mut Timeline,
        output: &mut dyn AnyOutput,
        first_step: bool,
    ) -> Result<(), RunError> {
        self.found.clear();
        let (start, end) = (times.last.t, times.t);
        let turns = times.is_long(times.last.h);
        let Events { all, found, .. } = self;
        for (index, event) in all.iter_mut().enumerate() {
            let last = event.finite(end, output.event(index, end, None))?;
            let search = event.search([start, end], last, (first_step, turns));
            if search.is_idle() {
                event.seen = search.seen_at_end();
                continue;
            }
            let mut g = |t: f64| {
                let place = times.place(output.points(), t)?;
                output.look(place, times.last, Slot::Search).map_err(|e| times.no_point(e))?;
                event.finite(t, output.event(index, t, Some(Slot::Search)))
            };
            let zeros = &mut |t, rising| found.push(Zero { t, event: index, rising });
            let (seen, is_sure) = search.zeros(&mut g, zeros)?;
            event.seen = seen;
            times.stats.unsure_steps += u64::from(!is_sure);
        }
        sort(found, end >= start);
        Ok(())
    }
}

/// The search for the zeros of one event in a step. It knows numbers only, so it is compiled once.
struct Search {
    direction: Direction,
    points: Points,
    /// Is g looked at more closely, because the step is long?
    is_long: bool,
    seen: Seen,
    /// Is it the first step of the run?
    first_step: bool,
    /// The start and the end of the step.
    span: [f64; 2],
    /// g at the end.
    last: f64,
}

impl Search {
    /// True if the ends of the step tell that there is no zero.
    #[inline]
    fn is_idle(&self) -> bool {
        let Seen { value, anew, .. } = self.seen;
        let is_simple = !self.is_long && self.points(value) == 0 && !self.may_have_two(value);
        !anew && is_simple && passes(value, self.last).is_none()
    }

    /// The number of points within the step that a caller asks for, if g is `first` at its start.
    #[inline]
    fn points(&self, first: f64) -> u32 {
        let Search { span: [start, end], last, .. } = *self;
        match self.points {
            Points::AsNeeded => 0,
            Points::Each(points) => points,
            Points::By(points) => points((end - start).abs(), [first, last]).min(POINTS_MAX),
        }
    }

    /// True if the step may have two zeros, if g is `first` at its start, and these are searched for.
    #[inline]
    fn may_have_two(&self, first: f64) -> bool {
        let Search { seen, span: [start, end], last, .. } = *self;
        match (self.points, seen.before) {
            (Points::Each(0) | Points::By(_), _) => false,
            (_, None) => true,
            (_, Some([before, length])) => {
                // Times the length of the step before: a division takes as long as the rest.
                let size = (end - start).abs();
                let bend = (last - seen.value) * length - (seen.value - before) * size;
                let near = if first.abs() < last.abs() { first.abs() } else { last.abs() };
                near * length <= 2.0 * bend.abs()
            }
        }
    }

    /// What is known of g at the end of the step.
    #[inline]
    fn seen_at_end(&self) -> Seen {
        let [start, end] = self.span;
        let before = Some([self.seen.value, (end - start).abs()]);
        Seen { value: self.last, before, anew: false, level: self.seen.level }
    }

    /// Calls `found` with t and the direction of each zero. Returns what is known at the end of the step, and false if it
    /// may have more zeros.
    #[inline(never)]
    fn zeros(
        &self,
        g: &mut dyn FnMut(f64) -> Result<f64, RunError>,
        found: &mut dyn FnMut(f64, bool),
    ) -> Result<(Seen, bool), RunError> {
        let Search { seen, span: [start, end], last, .. } = *self;
        let mut left = (start, seen.value);
        if seen.anew {
            let t = start + A_LITTLE_LATER * (end - start);
            let value = g(t)?;
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
            && roots::has_none([left.1, values[middle], right.1], (size / length.abs(), before))
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
        let middle = roots::MOST / 2;
        let mut known = middle;
        for level in level..=roots::FINEST {
            let stride = roots::stride(level);
            for j in (0..roots::MOST).step_by(stride).filter(|j| j % known != 0) {
                values[j] = g(at(roots::place(j)))?;
            }
            known = stride;
            let proxy = Proxy::new(&values, level, noise);
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
        let noise = if halvings == HALVINGS { roots::noise_of(&values) } else { noise };
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

/// Sorts zeros by time in the direction of the run; those at one time by the number of their event.
fn sort(zeros: &mut [Zero], forward: bool) {
    let sign = if forward { 1.0 } else { -1.0 };
    zeros
        .sort_unstable_by(|a, b| (sign * a.t).total_cmp(&(sign * b.t)).then(a.event.cmp(&b.event)));
}
