//! The times of a run: its steps, and the places within them. This part of the driver knows numbers only.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::control::{Controller, StepControl};
use super::grid::TimeGrid;
use super::noise::Noise;
use super::points::{AnyPoints, Place, Saved};
use super::stats::{Cadence, RunError, Stats};
use super::stops::{MARGIN, Stop, unit};
use super::streak::{Reach, Run};
use crate::error::{Error, Failure, StepError};
use crate::methods::{Facts, Halves, MapCounts, Step, StepCost};

/// The choice of the steps of a run.
#[derive(Clone, Debug)]
pub(super) enum Pace {
    /// One size, with a largest number of steps.
    Equal { grid: TimeGrid, max_steps: u64 },
    /// By their error (adaptive).
    ByError(StepControl),
}

/// The state of the choice of steps.
pub(super) enum Pacer {
    /// Equal steps: the grid, and the number of its steps that are done. A run that left its grid gets a new one.
    /// Of a grid, the size of its steps, those that are done, and the limit. A run that is taken off its grid has another one
    /// from there, of the same size.
    Equal { grid: TimeGrid, size: f64, done: u64, max_steps: u64 },
    /// Steps by their error.
    ByError(Chooser),
}

/// The state of the choice of steps by their error.
pub(super) struct Chooser {
    pub(super) control: StepControl,
    pub(super) controller: Controller,
    /// The size of the next attempt, without its sign; `None` before the first step.
    pub(super) h: Option<f64>,
    /// The end of the last step that failed, until the run has passed it. Steps grow only while they are short beside
    /// the way there.
    pub(super) wall: Option<f64>,
    /// Why that step failed. A saved state does not have it.
    pub(super) obstacle: Option<StepError>,
    /// True if the run has events. Exact steps are then short enough to show them.
    pub(super) has_events: bool,
    /// What the rounding of t makes of a step.
    pub(super) noise: Noise,
}

/// How fast the state turns. Steps that turn it by more than a radian are searched for all zeros of events.
pub(super) struct Turns {
    /// The size of a step that turns the state by a radian.
    pub(super) radian: f64,
    /// The number of accepted steps at which it is computed again.
    pub(super) next: u64,
}

impl Turns {
    /// The number of steps after which it is computed again. It is computed before each longer step, too.
    pub(super) const EVERY: u64 = 16;
}

/// What the workspace holds of the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Looked {
    /// Nothing: there was no step, or the state was changed since.
    Nothing,
    /// The step: the workspace was last used for it.
    Fresh,
    /// Something else: the workspace was used since.
    Stale,
    /// Something else: the state was restored from one with dense output, whose cost is counted.
    Restored,
    /// The step with its dense output.
    Prepared,
}

/// The times of a run: its time, its last step, the choice of the next step, and its statistics.
pub(super) struct Timeline {
    pub(super) t: f64,
    pub(super) t1: f64,
    /// The time that the caller asked for: the end, where it asked for a run.
    pub(super) goal: f64,
    /// The attempts before it asked for that.
    before: u64,
    /// The last time at which f may jump: the start, a stop, or a time at which the caller could change it.
    pub(super) jumped_at: f64,
    /// True if that is a stop at which f jumps: f may have the value of either side there, or another one.
    pub(super) jumped_by_stop: bool,
    /// The time at which the last step began. Its stages may be a little later, after a jump.
    pub(super) begun: f64,
    /// The last step.
    pub(super) last: Step<f64>,
    pub(super) looked_at: Looked,
    pub(super) pacer: Pacer,
    /// How fast the state turns, if events have zeros to search for, or steps have to turn it little.
    pub(super) turns: Option<Turns>,
    pub(super) cadence: Cadence,
    pub(super) stats: Stats,
    pub(super) facts: Facts,
    pub(super) cancel: Option<Box<Cancel>>,
    /// The rounding of the times of stages, relative to them: that of the numbers of the problem.
    pub(super) epsilon: f64,
}

/// Who cancels a run.
pub(super) struct Cancel {
    /// While it is set, a failed attempt is the last one, and does not count.
    pub(super) flag: Arc<AtomicBool>,
    /// The statistics before that attempt.
    pub(super) counts: Stats,
}

/// n + more, if both are counted.
fn plus(n: Option<u64>, more: Option<u64>) -> Option<u64> {
    n.zip(more).map(|(n, more)| n + more)
}

impl Timeline {
    /// The times of a run over a span, by a method with these facts. The error of its steps has this order.
    pub(super) fn new(
        [t0, t1]: [f64; 2],
        pace: Pace,
        facts: Facts,
        error_order: Option<usize>,
        epsilon: f64,
    ) -> Self {
        let pacer = match pace {
            Pace::Equal { grid, max_steps } => {
                Pacer::Equal { grid, size: grid.h().abs(), done: 0, max_steps }
            }
            Pace::ByError(control) => {
                let controller = Controller::new(error_order.unwrap_or(facts.order));
                let (h, wall, obstacle, has_events) = (None, None, None, false);
                let noise = Noise::default();
                Pacer::ByError(Chooser {
                    control,
                    controller,
                    h,
                    wall,
                    obstacle,
                    has_events,
                    noise,
                })
            }
        };
        let cadence = Cadence::new(facts.stays_on_manifold);
        let stats = Stats {
            evaluations: Some(0),
            maps: Some(MapCounts::default()),
            smallest_step: f64::INFINITY,
            ..Stats::default()
        };
        let last = Step { n: 0, t: t0, h: 0.0 };
        let mut times = Timeline {
            looked_at: Looked::Nothing,
            turns: None,
            t: t0,
            t1,
            goal: t1,
            before: 0,
            jumped_at: t0,
            jumped_by_stop: false,
            begun: t0,
            last,
            pacer,
            cadence,
            stats,
            facts,
            cancel: None,
            epsilon,
        };
        times.expect_events(false, false);
        times
    }

    /// Lets exact steps be short enough to show events, and tells long steps to the search for their zeros.
    ///
    /// Where steps by error have to be short, it is known how fast the state turns, too.
    pub(super) fn expect_events(&mut self, has_events: bool, has_zeros: bool) {
        let asks = has_zeros || self.is_by_error() && self.facts.short_turns;
        self.turns = asks.then_some(Turns { radian: f64::INFINITY, next: 0 });
        if let Pacer::ByError(chooser) = &mut self.pacer {
            chooser.has_events = has_events;
        }
    }

    /// True if a step of this size turns the state by more than a radian, as far as events ask.
    pub(super) fn is_long(&self, size: f64) -> bool {
        self.turns.as_ref().is_some_and(|turns| size.abs() > turns.radian)
    }

    /// The statistics of the run so far.
    pub(super) fn stats(&self, points: &dyn AnyPoints) -> Stats {
        let mut stats = self.stats;
        stats.iterations = stats.iterations.wrapping_add(points.iterations());
        stats.evaluations = stats.evaluations.map(|n| n.wrapping_sub(points.reused()));
        if stats.accepted == 0 {
            stats.smallest_step = 0.0;
        }
        if let Pacer::Equal { .. } = &self.pacer {
            let StepCost { evaluations, maps } = self.facts.step.times(stats.accepted);
            stats.evaluations = plus(stats.evaluations, evaluations);
            stats.maps = maps;
        }
        stats
    }

    /// True if a is before b in the direction of the last step.
    pub(super) fn is_before(&self, a: f64, b: f64) -> bool {
        if self.t1 >= self.last.t { a < b } else { a > b }
    }

    /// Records that the state was changed. Returns the error if the new state cannot be used.
    pub(super) fn changed(&mut self, by: &str, done: Result<(), Error>) -> Result<(), RunError> {
        done.map_err(|source| RunError::Changed { by: by.into(), t: self.t, source })?;
        self.looked_at = Looked::Nothing;
        (self.jumped_at, self.jumped_by_stop) = (self.t, false);
        self.turns.iter_mut().for_each(|turns| turns.next = 0);
        if let Pacer::ByError(chooser) = &mut self.pacer {
            chooser.h = None;
            chooser.wall = None;
            chooser.controller = chooser.controller.anew();
            chooser.noise = Noise::default();
        }
        Ok(())
    }

    /// Notes a stop that the run has reached.
    pub(super) fn pass(&mut self, stop: Stop) {
        if stop.jumps && stop.t == self.t {
            (self.jumped_at, self.jumped_by_stop) = (stop.t, true);
        }
    }

    /// Checks that a run can go on to t.
    pub(super) fn check_ahead(&self, t: f64) -> Result<(), Error> {
        match t.is_finite() && !self.is_before(t, self.t) && !self.is_before(self.t1, t) {
            true => Ok(()),
            false => {
                let Timeline { t: now, t1, .. } = self;
                let expected =
                    format!("a finite time between {now}, the time of the run, and {t1}, its end");
                Err(Error::out_of_range("t", t, expected))
            }
        }
    }

    /// Takes one step, at most to `stop`; steps by error may be several, within their reach. No stage evaluates f exactly
    /// at `stop` if f jumps there.
    pub(super) fn steps_before(
        &mut self,
        run: &mut dyn Run,
        mut stop: Stop,
        reach: Reach,
    ) -> Result<(), RunError> {
        if self.t == stop.t {
            return Ok(());
        }
        forget_after(self.jumped_at, self.t, run.points());
        // Where all stages are within a step, none is at the stop.
        stop.jumps &= !self.facts.stages_within;
        match &mut self.pacer {
            Pacer::Equal { .. } => self.equal_step(run.points(), stop),
            Pacer::ByError(_) => self.chosen_steps(run, stop, reach),
        }
    }

    /// The caller asks for a state at this time. The limit of attempts begins anew.
    pub(super) fn ask_for(&mut self, goal: f64) {
        self.goal = goal;
        self.before = self.stats.accepted + self.stats.rejected;
    }

    /// How many of these attempts are left.
    pub(super) fn attempts_left(&self, most: u64) -> u64 {
        let Stats { accepted, rejected, .. } = self.stats;
        most.saturating_sub((accepted + rejected).saturating_sub(self.before))
    }

    fn equal_step(
        &mut self,
        points: &mut dyn AnyPoints,
        Stop { t: stop, jumps }: Stop,
    ) -> Result<(), RunError> {
        if let Pacer::Equal { grid, max_steps, .. } = &self.pacer
            && self.attempts_left(*max_steps) == 0
        {
            return Err(self.too_many(grid.h().abs(), *max_steps));
        }
        let Pacer::Equal { grid, size, done, .. } = &mut self.pacer else { return Ok(()) };
        if self.t != grid.time(*done) {
            let anew = TimeGrid::new([self.t, self.t1], *size)?;
            *grid = if grid.is_split() { anew.split() } else { anew };
            *done = 0;
        }
        let end = grid.time(*done + 1);
        let before = if self.t1 >= self.t { stop < end } else { stop > end };
        // No step is as short as rounding, which is that of the start of the grid, too. And the last stage may be at t + h, a
        // rounding after the end of the step.
        let largest = stop.abs().max(end.abs()).max(grid.t_span()[0].abs());
        let rounding = 4.0 * f64::EPSILON * largest;
        let near = stop == end || (stop - end).abs() < rounding;
        let before = before || (near && stop != end);
        let n = self.stats.accepted;
        let (grid, first) = (*grid, *done);
        *done += u64::from(!before);
        let (step, end) = match before || (near && jumps) {
            true => (self.step_to(stop, grid.size_to(first, stop), jumps), stop),
            false => (self.step_to(end, grid.step::<f64>(first).h, false), end),
        };
        self.see_turns(points, step.h);
        if let Err(source) = points.step(step) {
            self.looked_at = Looked::Nothing;
            return Err(Failure { step: n, t: self.t, h: step.h, source }.into());
        }
        self.accepted(points, step, end)
    }

    /// Records that y is the state after `step`, at `end`.
    ///
    /// # Errors
    /// [`RunError::LeftManifold`].
    pub(super) fn accepted(
        &mut self,
        points: &mut dyn AnyPoints,
        step: Step<f64>,
        end: f64,
    ) -> Result<(), RunError> {
        (self.begun, self.last) = (self.t, step);
        self.looked_at = Looked::Fresh;
        self.t = end;
        self.stats.accepted += 1;
        self.stats.smallest_step = self.stats.smallest_step.min(step.h.abs());
        self.stats.largest_step = self.stats.largest_step.max(step.h.abs());
        if self.stats.accepted != self.cadence.next {
            return Ok(());
        }
        self.check_field(points)?;
        let corrected = points.correct(&mut self.cadence, &mut self.stats);
        corrected.map_err(|source| RunError::LeftManifold { t: end, source })
    }

    /// Checks that f, just before the end of the last step, is in 𝔤.
    fn check_field(&mut self, points: &mut dyn AnyPoints) -> Result<(), RunError> {
        let t = self.t - MARGIN * unit([self.last.t, self.t], self.epsilon);
        let checked = points.check_field(t, self.stats.largest_step, &mut self.stats);
        checked.map_err(|source| RunError::LeftManifold { t: self.t, source })
    }

    /// Checks at the end of a run that it has stayed on M, and would further do so.
    pub(super) fn check_end(&mut self, points: &mut dyn AnyPoints) -> Result<(), RunError> {
        if self.stats.accepted == 0 {
            return Ok(());
        }
        self.check_field(points)?;
        let checked = points.check_end(self.facts.stays_on_manifold, &mut self.stats);
        checked.map_err(|source| RunError::LeftManifold { t: self.t, source })
    }

    /// Takes equal steps up to number `end` of the run, or fewer, in one call of the method. Afterwards only the last
    /// step has dense output. Returns false if there is no such call.
    pub(super) fn quietly(
        &mut self,
        points: &mut dyn AnyPoints,
        end: u64,
        time: Option<f64>,
    ) -> Result<bool, RunError> {
        let Pacer::Equal { grid, done, max_steps, .. } = &mut self.pacer else { return Ok(false) };
        let (grid, first) = (*grid, *done);
        let is_other =
            grid.is_split() || self.stats.accepted != first || self.t != grid.time(first);
        if is_other || self.jumped_by_stop && self.t == self.jumped_at {
            return Ok(false);
        }
        let most = self.before.saturating_add(*max_steps);
        let mut end = end.min(self.cadence.next).min(grid.steps()).min(most);
        if let Some(time) = time {
            end = end.min(grid.last_before(first, time));
        }
        // The last step of the run may be a short one.
        end -= u64::from(end == grid.steps() && grid.size(end - 1) != grid.h());
        // The last step of the call is taken alone, so that its start is known.
        let before = end.saturating_sub(1);
        if before <= first {
            return Ok(false);
        }
        forget_after(self.jumped_at, self.t, points);
        let taken = points.steps(grid.equal(first, before));
        let reached = taken.as_ref().map_or_else(|(step, _)| *step, |()| before);
        if reached > first {
            self.stats.smallest_step = self.stats.smallest_step.min(grid.h().abs());
            self.stats.largest_step = self.stats.largest_step.max(grid.h().abs());
        }
        self.looked_at = Looked::Nothing;
        self.t = grid.time(reached);
        self.stats.accepted = reached;
        match taken {
            Ok(()) => {
                *done = before;
                Ok(true)
            }
            // The state of an error is the last accepted one.
            Err((step, source)) => Err(Failure { step, t: self.t, h: grid.h(), source }.into()),
        }
    }

    /// The place of t in the last step, for [`Points::look`](super::points::Points::look). Prepares the dense output if
    /// the place needs it.
    pub(super) fn place(&mut self, points: &mut dyn AnyPoints, t: f64) -> Result<Place, RunError> {
        match t == self.t {
            true => Ok(Place::End),
            false => self.within(points, t),
        }
    }

    /// The place of t, which must be in the last step.
    pub(super) fn known_place(
        &mut self,
        points: &mut dyn AnyPoints,
        t: f64,
    ) -> Result<Place, RunError> {
        let start = self.begun;
        let inside =
            self.looked_at != Looked::Nothing && start.min(self.t) <= t && t <= start.max(self.t);
        match inside || t == self.t {
            true => self.place(points, t),
            false => {
                let expected = match self.looked_at {
                    Looked::Nothing => format!(
                        "the time of the state, {}: after a change, or in a run that goes on from bytes, the last step is not \
                         known",
                        self.t
                    ),
                    _ => format!("a time of the last step, from {start} to {}", self.t),
                };
                Err(Error::out_of_range("t", t, expected).into())
            }
        }
    }

    /// The place of t before the end of the last step, with dense output.
    pub(super) fn within(&mut self, points: &mut dyn AnyPoints, t: f64) -> Result<Place, RunError> {
        let Step { t: start, h, .. } = self.last;
        if t == start || t == self.begun {
            return Ok(Place::Start);
        }
        if self.looked_at != Looked::Prepared {
            self.prepare(points).map_err(|source| self.no_point(source))?;
        }
        let theta = ((t - start) / h).clamp(0.0, 1.0);
        // A step in two halves has the point between them.
        let is_known = self.is_doubled() && theta == 0.5;
        self.looked_within(if is_known { Some(0) } else { self.dense_evaluations()[1] });
        Ok(Place::Within(theta))
    }

    /// The place of t in the last step, by a shorter step from its start.
    pub(super) fn by_a_step(
        &mut self,
        points: &mut dyn AnyPoints,
        t: f64,
    ) -> Result<Place, RunError> {
        if t == self.t || t == self.last.t {
            return self.place(points, t);
        }
        self.looked_at = Looked::Stale;
        self.looked_within(match &self.pacer {
            Pacer::Equal { .. } => self.facts.step.evaluations,
            Pacer::ByError(_) => self.facts.step_with_error.evaluations,
        });
        Ok(Place::Shorter(t - self.last.t))
    }

    /// The evaluations that prepare the dense output of a step, and those of a point.
    fn dense_evaluations(&self) -> [Option<u64>; 2] {
        match self.facts.halves {
            Halves::ForError if self.is_by_error() => [Some(0), self.facts.step.evaluations],
            _ => self.facts.dense_evaluations,
        }
    }

    /// Is each step taken in two halves?
    fn is_doubled(&self) -> bool {
        match self.facts.halves {
            Halves::Never => false,
            Halves::ForError => self.is_by_error(),
            Halves::Always => true,
        }
    }

    fn is_by_error(&self) -> bool {
        matches!(self.pacer, Pacer::ByError(_))
    }

    /// Counts a point within a step.
    fn looked_within(&mut self, evaluations: Option<u64>) {
        self.stats.points_within += 1;
        self.stats.evaluations = plus(self.stats.evaluations, evaluations);
    }

    /// The error of a point within the last step.
    pub(super) fn no_point(&self, source: StepError) -> RunError {
        RunError::Within { t: self.last.t, h: self.last.h, source }
    }

    /// Prepares the dense output of the last step, to store it.
    pub(super) fn prepare_last(&mut self, points: &mut dyn AnyPoints) -> Result<(), RunError> {
        self.prepare(points).map_err(|source| self.no_point(source))
    }

    /// Prepares the dense output of the last step.
    fn prepare(&mut self, points: &mut dyn AnyPoints) -> Result<(), StepError> {
        if self.looked_at == Looked::Prepared {
            return Ok(());
        }
        if matches!(self.looked_at, Looked::Stale | Looked::Restored) {
            self.repeat(points)?;
        }
        let reused = points.reused();
        // A step that was cut is prepared, or was taken again.
        let prepared = points.prepare(self.last, self.looked_at == Looked::Fresh);
        let evaluations = match self.looked_at {
            // They are counted already, without those that were not needed.
            Looked::Restored => Some(points.reused().wrapping_sub(reused)),
            _ => self.dense_evaluations()[0],
        };
        self.stats.evaluations = plus(self.stats.evaluations, evaluations);
        prepared?;
        self.looked_at = Looked::Prepared;
        Ok(())
    }

    /// Records that the workspace no longer holds the last step.
    pub(super) fn forget_workspace(&mut self) {
        self.begun = self.last.t;
        self.looked_at = match self.looked_at {
            Looked::Nothing => Looked::Nothing,
            Looked::Prepared | Looked::Restored => Looked::Restored,
            Looked::Fresh | Looked::Stale => Looked::Stale,
        };
    }

    /// Repeats the last step, so that the workspace holds it. Its iterations are not counted again.
    fn repeat(&mut self, points: &mut dyn AnyPoints) -> Result<(), StepError> {
        let (counted, reused) = (points.iterations(), points.reused());
        // What a method remembers is that of the step, not of its repetition.
        let mut memory = Vec::new();
        points.each_number(Saved::Memory, &mut |x| memory.push(*x));
        let repeated = points.repeat(self.last);
        let mut memory = memory.into_iter();
        points.each_number(Saved::Memory, &mut |x| *x = memory.next().unwrap_or(*x));
        let again = points.iterations().wrapping_sub(counted);
        self.stats.iterations = self.stats.iterations.wrapping_sub(again);
        let again = points.reused().wrapping_sub(reused);
        self.stats.evaluations = self.stats.evaluations.map(|n| n.wrapping_add(again));
        repeated
    }

    /// Counts attempts.
    pub(super) fn attempted(&mut self, count: u64) {
        self.looked_at = Looked::Nothing;
        let StepCost { evaluations, maps } = self.facts.step_with_error.times(count);
        self.stats.evaluations = plus(self.stats.evaluations, evaluations);
        self.stats.maps = self.stats.maps.zip(maps).map(|(n, more)| n + more);
    }
}

/// Forgets values of f that are kept for the step from t, where f has jumped at that time.
fn forget_after(jump: f64, t: f64, points: &mut dyn AnyPoints) {
    if t == jump {
        points.forget();
    }
}
