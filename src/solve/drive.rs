//! The loop over the steps, with output, events, stops and cancellation. This part of the driver knows numbers only.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::drift::Drift;
use super::events::{Events, Zero};
use super::grid::SaveAt;
use super::output::{AnyOutput, Keeps, Slot};
use super::points::AnyPoints;
use super::search::A_LITTLE_LATER;
use super::solution::{Next, Status};
use super::stats::RunError;
use super::stops::Stop;
use super::streak::{Alone, Reach, Run};
use super::timeline::Timeline;
use crate::methods::{Attempts, Step, Streak};

/// The function that takes the bytes of a state.
type TakeBytes<'a> = Box<dyn FnMut(&[u8]) + 'a>;

/// When the state is saved, and the function that takes it.
pub(super) struct Checkpoints<'a> {
    pub(super) every: Duration,
    pub(super) take: TakeBytes<'a>,
    pub(super) last: Instant,
}

/// The number of steps without output or events that are taken in one call. The run can be cancelled between two calls.
pub(super) struct Patience(u64);

impl Patience {
    /// The largest number.
    const MOST: u64 = 1000;
    /// A call that takes longer has too many steps.
    const LONG: Duration = Duration::from_millis(20);

    pub(super) fn new() -> Self {
        Patience(1)
    }

    /// The number of steps of the next call.
    pub(super) fn steps(&self) -> u64 {
        self.0
    }

    /// Called after a call that took this time.
    pub(super) fn after(&mut self, took: Duration) {
        self.0 = if took > Self::LONG { self.0 / 4 } else { 2 * self.0 }.clamp(1, Self::MOST);
    }
}

/// The points of a run with its events.
struct Watched<'a> {
    output: &'a mut dyn AnyOutput,
    events: &'a mut Events,
}

impl Run for Watched<'_> {
    fn points(&mut self) -> &mut dyn AnyPoints {
        self.output.points()
    }
    fn attempt(&mut self, step: Step<f64>, end: f64, streak: &Streak<'_>) -> Attempts {
        self.output.attempt(step, end, streak, self.events)
    }
}

/// A run under way.
pub(super) struct Drive<'a> {
    pub(super) times: Timeline,
    pub(super) events: Events,
    pub(super) save: SaveAt,
    /// The start of the run.
    pub(super) t0: f64,
    /// How many of the output times are done.
    pub(super) times_done: usize,
    pub(super) times_by_steps: bool,
    /// The stops that are still ahead.
    pub(super) stops: std::vec::IntoIter<Stop>,
    pub(super) next_stop: Option<Stop>,
    pub(super) cancel: Option<&'a AtomicBool>,
    pub(super) progress: Option<Box<dyn FnMut(f64) + 'a>>,
    pub(super) checkpoints: Option<Checkpoints<'a>>,
    pub(super) resume: Option<Vec<u8>>,
    /// What is stored of each step.
    pub(super) keeps: Keeps,
    /// The time of the last output.
    pub(super) shown_at: Option<f64>,
    /// True while output and events of the last step are handled. A state that is saved then continues within the step.
    pub(super) is_within: bool,
    /// How many of the zeros of the last step are done.
    pub(super) zeros_done: usize,
    /// The number of steps that are taken between two looks at the clock.
    pub(super) patience: Patience,
    /// The drifts of the invariants that are watched.
    pub(super) drift: Vec<Drift>,
}

/// Whether and why a run ends.
type Ended = Result<Option<Status>, RunError>;

impl Drive<'_> {
    /// Runs to the end, or to an error.
    pub(super) fn run(&mut self, output: &mut dyn AnyOutput) -> Result<Status, RunError> {
        let starts = output.invariants().into_iter().zip(output.values(None));
        self.drift = starts.map(|(of, [value, terms])| Drift::new(of, value, terms)).collect();
        let ended = self.steps(output).and_then(|status| {
            self.times.check_end(output.points())?;
            Ok(status)
        });
        self.see(output, true);
        ended
    }

    /// The values of the invariants at the point of the output, or at the end.
    fn see(&mut self, output: &dyn AnyOutput, end: bool) {
        if self.drift.is_empty() {
            return;
        }
        let values = output.values((!end).then_some(Slot::Shown));
        let drifts = self.drift.iter_mut().zip(values);
        drifts.for_each(|(drift, [value, terms])| drift.see(value, terms));
    }

    fn steps(&mut self, output: &mut dyn AnyOutput) -> Result<Status, RunError> {
        let (t0, t1) = (self.times.t, self.times.t1);
        self.times_done = self.save.times().len() - self.save.times_after(t0).len();
        if let Some(bytes) = self.resume.take() {
            self.read(output.points(), &bytes)?;
        } else {
            self.events.start(t0, output)?;
            if self.save.start(t0)
                && let Some(status) = self.show_end_of_step(output)?
            {
                return Ok(status);
            }
        }
        // A state that was saved within a step.
        if self.is_within {
            self.keep_step(output)?;
            if let Some(status) = self.look_within(output)? {
                return Ok(status);
            }
        }
        while self.times.t != t1 {
            if self.is_cancelled(output, self.times.t) {
                return Ok(Status::Cancelled);
            }
            self.pass_stops();
            self.step(output)?;
            self.keep_step(output)?;
            if !self.events.all.is_empty() {
                let first_step = self.times.stats.accepted == 1;
                self.events.search(&mut self.times, output, first_step)?;
            }
            (self.is_within, self.zeros_done) = (true, 0);
            if let Some(status) = self.look_within(output)? {
                return Ok(status);
            }
            self.save_state(output, false);
        }
        if self.shown_at != Some(t1) && self.save.end() {
            self.show_end_of_step(output)?;
        }
        Ok(Status::Finished)
    }

    /// Keeps the last step, if steps are kept.
    fn keep_step(&mut self, output: &mut dyn AnyOutput) -> Result<(), RunError> {
        if self.keeps == Keeps::Pieces {
            self.times.prepare_last(output.points())?;
        }
        match self.keeps {
            Keeps::Nothing => Ok(()),
            _ => output.keep([self.times.begun, self.times.t], self.times.last),
        }
    }

    /// Tells the time that the run has reached. True if the run is cancelled, also by who is told. Then its state is saved.
    fn is_cancelled(&mut self, output: &mut dyn AnyOutput, t: f64) -> bool {
        if let Some(progress) = &mut self.progress {
            progress(t);
        }
        let cancelled = self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
        if cancelled {
            self.save_state(output, true);
        }
        cancelled
    }

    /// Save the state where it is time to, or `now`.
    fn save_state(&mut self, output: &mut dyn AnyOutput, now: bool) {
        let Some(Checkpoints { every, last, .. }) = &mut self.checkpoints else { return };
        // Zero means after each step.
        let due = if every.is_zero() { !self.is_within } else { last.elapsed() >= *every };
        if !now && !due {
            return;
        }
        *last = Instant::now();
        let bytes = self.write(output.points());
        if let Some(Checkpoints { take, .. }) = &mut self.checkpoints {
            take(&bytes);
        }
    }

    /// Sets the next stop to the first one ahead. A step that an event cut has not reached its stop.
    fn pass_stops(&mut self) {
        let passed = |times: &Timeline, stop: &Stop| !times.is_before(times.t, stop.t);
        while let Some(stop) = self.next_stop.filter(|stop| passed(&self.times, stop)) {
            self.times.pass(stop);
            self.next_stop = self.stops.next();
        }
    }

    /// Takes a step, and steps without output or zeros of events before it.
    fn step(&mut self, output: &mut dyn AnyOutput) -> Result<(), RunError> {
        let stop = self.next_stop.unwrap_or(Stop { t: self.times.t1, jumps: false });
        if self.keeps != Keeps::Nothing {
            return self.times.steps_before(&mut Alone(output.points()), stop, Reach::STEP);
        }
        let taken = self.times.stats.accepted;
        let mut steps = self.save.next_after(taken);
        let checkpoints = self.checkpoints.as_ref().map(|checkpoints| checkpoints.every);
        let is_watched = self.cancel.is_some() || self.progress.is_some() || checkpoints.is_some();
        if is_watched {
            // A state after each step is asked for by a time of zero.
            let each = checkpoints.is_some_and(|every| every.is_zero());
            let most = if each { 1 } else { self.patience.steps() };
            steps = steps.min(taken.saturating_add(most));
        }
        let time = [self.next_time(), self.next_stop.map(|stop| stop.t)].into_iter().flatten();
        let time = time.reduce(|a, b| if self.times.is_before(a, b) { a } else { b });
        let clock = is_watched.then(Instant::now);
        if self.events.all.is_empty() {
            self.times.quietly(output.points(), steps, time)?;
        }
        let run = &mut Watched { output, events: &mut self.events };
        self.times.steps_before(run, stop, Reach { steps, time })?;
        if let Some(clock) = clock {
            self.patience.after(clock.elapsed());
        }
        Ok(())
    }

    fn next_time(&self) -> Option<f64> {
        match self.save {
            SaveAt::Times(ref times) | SaveAt::TimesAndEnds(ref times) => {
                times.get(self.times_done).copied()
            }
            SaveAt::Interval(length) => {
                let (t0, t1) = (self.t0, self.times.t1);
                let time = t0 + (length * (self.times_done + 1) as f64).copysign(t1 - t0);
                // The end is shown as such, also where rounding puts the last time beside it.
                let last = self.times.is_before(t1, time) || (t1 - time).abs() < 1e-9 * length;
                (!last).then_some(time)
            }
            _ => None,
        }
    }

    /// Handles the output times and the zeros of the last step in the order of time, and then its end.
    fn look_within(&mut self, output: &mut dyn AnyOutput) -> Ended {
        let (mut is_first, mut has_rows) = (true, false);
        loop {
            let end = self.times.t;
            let time = self.next_time().filter(|time| !self.times.is_before(end, *time));
            let zero = self.events.found.get(self.zeros_done).copied();
            let zero = zero.filter(|zero| !self.times.is_before(end, zero.t));
            // A step may have many rows.
            if !is_first && let Some(t) = time.or(zero.map(|zero| zero.t)) {
                if self.is_cancelled(output, t) {
                    return Ok(Some(Status::Cancelled));
                }
                self.save_state(output, false);
            }
            is_first = false;
            match (time, zero) {
                (None, None) => break,
                (Some(time), zero)
                    if zero.is_none_or(|zero| !self.times.is_before(zero.t, time)) =>
                {
                    self.times_done += 1;
                    has_rows |= time != end;
                    if let Some(status) = self.show(output, time)? {
                        return Ok(Some(status));
                    }
                }
                (_, Some(zero)) => {
                    if let Some(status) = self.occur(output, zero.t)? {
                        return Ok(Some(status));
                    }
                }
                (Some(_), None) => break,
            }
        }
        self.is_within = false;
        if has_rows {
            output.see_end(self.times.t);
        }
        let shown = matches!(self.save, SaveAt::Every(every) if self.times.stats.accepted.is_multiple_of(every));
        if shown && self.shown_at != Some(self.times.t) {
            self.show_end_of_step(output)
        } else {
            Ok(None)
        }
    }

    /// Shows the point at a time within the last step.
    fn show(&mut self, output: &mut dyn AnyOutput, time: f64) -> Ended {
        self.look_at(output, time, self.times_by_steps)?;
        self.shown_at = Some(time);
        self.see(output, false);
        match output.observe(time) {
            Next::Continue => Ok(None),
            Next::Stop => {
                self.look_at(output, time, self.times_by_steps)?;
                self.cut(output, time);
                Ok(Some(Status::Observer))
            }
            Next::Changed => {
                let changed = output.take_changed();
                match changed {
                    Ok(()) => self.times.t = time,
                    // The run ends at the state that the observer was shown.
                    Err(_) => {
                        self.look_at(output, time, self.times_by_steps)?;
                        self.cut(output, time);
                    }
                }
                self.times.changed("the observer", changed)?;
                let at = self.zeros_done..self.zeros_done + self.zeros_at(time);
                self.events.restart(time, output, at)?;
                output.cut_kept(time);
                Ok(None)
            }
        }
    }

    /// The point of the output ← the point at a time within the last step, by a shorter step or by dense output.
    fn look_at(
        &mut self,
        output: &mut dyn AnyOutput,
        time: f64,
        by_a_step: bool,
    ) -> Result<(), RunError> {
        let place = match by_a_step {
            true => self.times.by_a_step(output.points(), time)?,
            false => self.times.place(output.points(), time)?,
        };
        let looked = output.look(place, self.times.last, Slot::Shown);
        looked.map_err(|source| self.times.no_point(source))
    }

    /// Cuts the last step at t. The run continues from the point of the output.
    fn cut(&mut self, output: &mut dyn AnyOutput, t: f64) {
        if t != self.times.t {
            output.take_shown();
            self.times.t = t;
        }
    }

    fn show_end_of_step(&mut self, output: &mut dyn AnyOutput) -> Ended {
        self.show(output, self.times.t)
    }

    /// The number of zeros at t, up to rounding, that come next. They belong together.
    fn zeros_at(&self, t: f64) -> usize {
        // Zeros are found in terms of the step.
        let Step { t: start, h, .. } = self.times.last;
        let rounding = 4.0 * f64::EPSILON * start.abs().max((start + h).abs());
        let found = self.events.found.get(self.zeros_done..).unwrap_or_default();
        found.iter().take_while(|zero| zero.t == t || (zero.t - t).abs() <= rounding).count()
    }

    /// The number of zeros that come next and are handled at t: those at t and, if one of them changes the state, those of
    /// functions that are rounding at t. After the change their values would tell nothing.
    fn zeros_with(&mut self, output: &mut dyn AnyOutput, t: f64) -> Result<usize, RunError> {
        let mut count = self.zeros_at(t);
        let next = &self.events.found[self.zeros_done..];
        if !next[..count].iter().any(|zero| self.events.all[zero.event].changes) {
            return Ok(count);
        }
        self.look_at(output, t, false)?;
        let Events { all, found } = &self.events;
        let (next, near) = (&found[self.zeros_done..], A_LITTLE_LATER * self.times.last.h.abs());
        // Another zero of an event that is handled here is one of its own.
        let is_new = |zero: &Zero, at: &[Zero]| at.iter().all(|other| other.event != zero.event);
        while let Some(zero) = next.get(count)
            && (zero.t - t).abs() <= near
            && is_new(zero, &next[..count])
            && all[zero.event].is_rounding(output.event(zero.event, t, Some(Slot::Shown)))
        {
            count += 1;
        }
        Ok(count)
    }

    /// Handles a zero of an event, and all others at the same time.
    fn occur(&mut self, output: &mut dyn AnyOutput, t: f64) -> Ended {
        let mut stopped = None;
        let (mut acts, mut changes) = (false, false);
        let at = self.zeros_done..self.zeros_done + self.zeros_with(output, t)?;
        for zero in at.clone() {
            self.look_at(output, t, false)?;
            let Zero { event, rising, .. } = self.events.found[zero];
            output.tell(event, t, rising);
            let this = &mut self.events.all[event];
            this.count += 1;
            changes |= this.changes;
            acts |= this.changes || this.stops();
            if this.stops() && stopped.is_none() {
                stopped = Some(this.name.clone());
            }
        }
        self.zeros_done = at.end;
        if !acts {
            return Ok(None);
        }
        self.look_at(output, t, false)?;
        if changes && t != self.times.t && output.shows_other_orbit() {
            // Within a step some methods leave M by the error of their order. A shorter step ends on M.
            self.look_at(output, t, true)?;
        }
        if t != self.times.t {
            // The point at t is one within a step.
            output.see_end(self.times.t);
        }
        self.cut(output, t);
        for zero in &self.events.found[at.clone()] {
            let event = &self.events.all[zero.event];
            if event.changes {
                let changed = output.change(zero.event, t);
                self.times.changed(&format!("event `{}`", event.name), changed)?;
            }
        }
        output.cut_kept(t);
        if let Some(name) = stopped {
            if self.shown_at != Some(t) && self.save.end() {
                self.show_end_of_step(output)?;
            }
            return Ok(Some(Status::Event(name)));
        }
        self.events.restart(t, output, at)?;
        Ok(None)
    }
}
