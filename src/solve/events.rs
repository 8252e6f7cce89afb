//! Events: where a function g(t, y) of the solution passes zero.
//!
//! After each step g is evaluated at the end of the step. Between two neighbours of opposite sign the zero is found by
//! dense output, to rounding of t (`bracket.rs`). A step with more zeros is taken apart by points between them, which a
//! polynomial in place of g gives (`roots.rs`). `docs/driver.md` says which steps are looked at so, and in which order.
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

use super::output::{AnyOutput, Slot};
use super::roots;
use super::search::{Direction, Points, Search, Seen, is_far};
use super::stats::RunError;
use super::timeline::Timeline;

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
    /// The rounding of the numbers of the problem.
    epsilon: f64,
}

impl<Y> fmt::Debug for Event<'_, Y> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Event").field("name", &self.rule.name).finish_non_exhaustive()
    }
}

/// The steps of methods of this order and more are long: each is searched for all zeros of an event.
pub const LONG_STEPS: usize = 10;

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
            epsilon: f64::EPSILON,
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
    /// Example: g > 0 is a rate that the state knows, and the number of points is chosen so that h · g / points
    /// stays below a bound. Such an event has no zeros; it sees the state often enough.
    pub fn points_by(mut self, points: fn(f64, [f64; 2]) -> u32) -> Self {
        self.rule.points = Points::By(points, |_, _| false);
        self
    }
    /// As [`points_by`](Self::points_by), and g is evaluated in the middle of each part between two of these points, and again
    /// in the middles of its halves, while `is_halved(h, [g₀, g₁])`. h > 0 is the size of the part, and g₀ and g₁ are the
    /// values of g at its ends. A step has at most 100 000 points.
    ///
    /// Example: g > 0 is a rate that is large for a short while only, and h · max(g₀, g₁) shall stay below a bound.
    pub fn points_by_halves(
        mut self,
        points: fn(f64, [f64; 2]) -> u32,
        is_halved: fn(f64, [f64; 2]) -> bool,
    ) -> Self {
        self.rule.points = Points::By(points, is_halved);
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
        !matches!(self.points, Points::By(..))
    }

    /// The search for zeros in a step at whose end g is `last`. `turns` says that the state turns by more than a radian.
    #[inline(always)]
    fn search(&self, span: [f64; 2], last: f64, (first_step, turns): (bool, bool)) -> Search {
        let EventRule { direction, points, has_long_steps, seen, epsilon, .. } = *self;
        let is_long = match points {
            Points::AsNeeded => has_long_steps || turns,
            Points::Each(points) => points > 0 && turns,
            Points::By(..) => false,
        };
        Search { direction, points, is_long, seen, first_step, span, last, epsilon }
    }

    /// Passes a step at whose end g is `last`, if g is far from 0: what [`Search::is_idle`] finds of nearly all steps, in a
    /// third of the instructions.
    #[inline(always)]
    fn passes_quickly(&mut self, [start, end]: [f64; 2], last: f64) -> bool {
        let Seen { value, before, anew, .. } = &mut self.seen;
        let is_simple = matches!(self.points, Points::AsNeeded) && !self.has_long_steps && !*anew;
        let Some([older, length]) = before.filter(|_| is_simple) else { return false };
        let size = (end - start).abs();
        let passes =
            *value * last > 0.0 && is_far([*value, last], [older, *value, last], [length, size]);
        if passes {
            (*before, *value) = (Some([*value, size]), last);
        }
        passes
    }

    /// The value of g at t, if it is finite.
    #[inline]
    fn finite(&self, t: f64, value: f64) -> Result<f64, RunError> {
        match value.is_finite() {
            true => Ok(value),
            false => Err(RunError::Event { name: self.name.clone(), t, value }),
        }
    }

    /// True if a value of g within the last step is the rounding of those at its ends.
    pub(super) fn is_rounding(&self, value: f64) -> bool {
        let Seen { value: last, before, .. } = self.seen;
        let size = before.map_or(0.0, |[start, _]| last.abs().max(start.abs()));
        value.abs() <= 64.0 * self.epsilon * size
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

/// The events of a run.
pub(super) struct Events {
    pub(super) all: Vec<EventRule>,
    /// The zeros of the last step, in the order of time.
    pub(super) found: Vec<Zero>,
}

impl Events {
    /// The events of a run by a method of this order, on numbers with this rounding.
    pub(super) fn new(mut all: Vec<EventRule>, order: usize, epsilon: f64) -> Self {
        for event in &mut all {
            (event.has_long_steps, event.epsilon) = (order >= LONG_STEPS, epsilon);
        }
        let found = Vec::with_capacity(2 * all.len() * roots::MOST);
        Events { all, found }
    }

    /// True if each step needs a search, whatever the values at its end.
    pub(super) fn search_always(&self) -> bool {
        let always = |event: &EventRule| match event.points {
            Points::Each(points) => points > 0,
            Points::AsNeeded => event.has_long_steps,
            Points::By(..) => false,
        };
        self.all.iter().any(always)
    }

    /// Passes a step of a streak, which is not the first step of a run, if no event can have a zero in it. `values` are g
    /// at the end of the step. Returns false if the step needs a search; then nothing is passed.
    #[inline(always)]
    pub(super) fn pass(&mut self, span: [f64; 2], values: impl Iterator<Item = f64>) -> bool {
        let is_alone = self.all.len() == 1;
        for (event, last) in self.all.iter_mut().zip(values) {
            if is_alone && event.passes_quickly(span, last) {
                return true;
            }
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
            // Its zero was just passed, or may have been, up to rounding.
            let anew = event.is_rounding(value)
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
        let (start, end) = (times.begun, times.t);
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

/// Sorts zeros by time in the direction of the run; those at one time by the number of their event.
fn sort(zeros: &mut [Zero], forward: bool) {
    let sign = if forward { 1.0 } else { -1.0 };
    zeros
        .sort_unstable_by(|a, b| (sign * a.t).total_cmp(&(sign * b.t)).then(a.event.cmp(&b.event)));
}
