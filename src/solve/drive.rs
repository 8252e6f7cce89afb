//! The loop over the steps, with output, events, stops and cancellation.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::events::Events;
use super::grid::SaveAt;
use super::integrator::Integrator;
use super::save::Listing;
use super::solution::{Drift, Interrupted, Next, Occurrence, Solution, Status};
use super::stats::RunError;
use super::{Event, Solve};
use crate::actions::Action;
use crate::methods::{Method, Step};
use crate::problems::{PointOf, Problem};

/// The function that gives the invariants of a problem.
pub(super) struct Watch<P: Problem> {
    pub(super) names: fn(&P) -> Vec<String>,
    pub(super) values: fn(&P, &PointOf<P>) -> Vec<f64>,
}

/// The function that takes the bytes of a state.
type TakeBytes<'a> = Box<dyn FnMut(&[u8]) + 'a>;

/// When the state is saved, and the function that takes it.
pub(super) struct Checkpoints<'a, P: Problem> {
    pub(super) list: Listing<P>,
    pub(super) every: Duration,
    pub(super) take: TakeBytes<'a>,
    pub(super) last: Instant,
}

/// A stored step: the time up to which it is valid, the step, and its start.
pub(super) type Kept<Y> = (f64, Step<f64>, Y);

/// The function that sees the points of the output.
pub(super) type Observe<'k, Y> = dyn FnMut(f64, &mut Y) -> Next + 'k;

/// A run under way.
///
/// It is compiled once for each problem and method: the observer is behind a reference, and searches and sorts are
/// functions of numbers.
pub(super) struct Drive<'a, 'k, P: Problem, M: Method<P>> {
    pub(super) run: Integrator<'a, P, M>,
    observe: &'k mut Observe<'k, PointOf<P>>,
    pub(super) events: Events<'a, P>,
    pub(super) save: SaveAt,
    /// The start of the run.
    t0: f64,
    /// How many of the output times are done.
    pub(super) times_done: usize,
    times_by_steps: bool,
    /// The stops that are still ahead.
    stops: std::vec::IntoIter<f64>,
    next_stop: Option<f64>,
    cancel: Option<&'a AtomicBool>,
    progress: Option<Box<dyn FnMut(f64) + 'a>>,
    checkpoints: Option<Checkpoints<'a, P>>,
    resume: Option<(Listing<P>, Vec<u8>)>,
    watch: Option<Watch<P>>,
    kept: Option<&'k mut Vec<Kept<PointOf<P>>>>,
    /// A point of the output.
    shown: PointOf<P>,
    /// The time of the last output.
    pub(super) shown_at: Option<f64>,
    pub(super) solution: Solution<PointOf<P>>,
}

/// Whether and why a run ends.
type Ended = Result<Option<Status>, RunError>;

impl<'a, 'k, P: Problem, M: Method<P>> Drive<'a, 'k, P, M> {
    pub(super) fn new(
        solve: Solve<'a, P, M>,
        run: Integrator<'a, P, M>,
        kept: Option<&'k mut Vec<Kept<PointOf<P>>>>,
        observe: &'k mut Observe<'k, PointOf<P>>,
    ) -> Self {
        let Solve {
            save,
            times_by_steps,
            events,
            stops,
            cancel,
            watch,
            checkpoints,
            resume,
            progress,
            ..
        } = solve;
        let y = run.y();
        let mut stops = stops.into_iter();
        Drive {
            events: Events::new(events, y),
            shown: y.clone(),
            shown_at: None,
            solution: Solution::new(run.t(), y.clone()),
            save,
            t0: run.t(),
            times_done: 0,
            times_by_steps,
            next_stop: stops.next(),
            stops,
            cancel,
            progress,
            checkpoints,
            resume,
            watch,
            kept,
            observe,
            run,
        }
    }

    pub(super) fn run(mut self) -> Result<Solution<PointOf<P>>, Interrupted<PointOf<P>>> {
        if let Some(Watch { names, values }) = &self.watch {
            let problem = self.run.problem;
            let starts = values(problem, self.run.y());
            self.solution.drift = names(problem)
                .into_iter()
                .zip(starts)
                .map(|(name, start)| Drift { name, start, largest: 0.0, at_end: 0.0 })
                .collect();
        }
        let ended = self.steps();
        self.see(true);
        let Drive { run, mut solution, .. } = self;
        solution.t = run.t();
        solution.stats = run.stats();
        solution.y = run.y;
        match ended {
            Ok(status) => Ok(Solution { status, ..solution }),
            Err(error) => Err(Interrupted { error, solution: Some(Box::new(solution)) }),
        }
    }

    /// The values of the invariants at the point of the output, or at the end.
    fn see(&mut self, end: bool) {
        let Some(Watch { values, .. }) = &self.watch else { return };
        let y = if end { self.run.y() } else { &self.shown };
        for (drift, value) in self.solution.drift.iter_mut().zip(values(self.run.problem, y)) {
            let moved = value - drift.start;
            drift.largest = drift.largest.max(moved.abs());
            if end {
                drift.at_end = moved;
            }
        }
    }

    fn is_before(&self, a: f64, b: f64) -> bool {
        if self.run.t1 >= self.run.last.t { a < b } else { a > b }
    }

    fn steps(&mut self) -> Result<Status, RunError> {
        let (t0, t1) = (self.run.t(), self.run.t1);
        self.times_done = match &self.save {
            SaveAt::Times(times) => times.len() - self.save.times_after(t0).len(),
            _ => 0,
        };
        if let Some((list, bytes)) = self.resume.take() {
            self.read(list, &bytes)?;
        } else {
            self.events.start(t0, self.run.y())?;
            if self.save.start(t0)
                && let Some(status) = self.show_end_of_step()?
            {
                return Ok(status);
            }
        }
        while self.run.t() != t1 {
            if self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                self.save_state(true);
                return Ok(Status::Cancelled);
            }
            if let Some(progress) = &mut self.progress {
                progress(self.run.t());
            }
            self.pass_stops();
            self.skip()?;
            let stop = self.next_stop.unwrap_or(t1);
            self.run.step_before(stop, self.next_stop.is_some())?;
            if let Some(kept) = self.kept.as_deref_mut() {
                kept.push((self.run.t(), self.run.last, self.run.from.clone()));
            }
            if !self.events.all.is_empty() {
                let first_step = self.run.stats.accepted == 1;
                self.events.search(&mut self.run, first_step)?;
            }
            if let Some(status) = self.look_within()? {
                return Ok(status);
            }
            self.save_state(false);
        }
        if self.shown_at != Some(t1) && !matches!(self.save, SaveAt::Times(_)) {
            self.show_end_of_step()?;
        }
        Ok(Status::Finished)
    }

    /// Save the state where it is time to, or `now`.
    fn save_state(&mut self, now: bool) {
        let Some(Checkpoints { list, every, last, .. }) = &mut self.checkpoints else { return };
        if !now && !every.is_zero() && last.elapsed() < *every {
            return;
        }
        *last = Instant::now();
        let list = *list;
        let bytes = self.write(list);
        if let Some(Checkpoints { take, .. }) = &mut self.checkpoints {
            take(&bytes);
        }
    }

    /// Sets the next stop to the first one ahead. A step that an event cut has not reached its stop.
    fn pass_stops(&mut self) {
        while self.next_stop.is_some_and(|stop| !self.is_before(self.run.t(), stop)) {
            self.next_stop = self.stops.next();
        }
    }

    /// Takes steps without output or events in one call.
    fn skip(&mut self) -> Result<(), RunError> {
        if !self.events.all.is_empty() || self.kept.is_some() {
            return Ok(());
        }
        let steps = self.run.stats.accepted;
        let mut end = self.save.next_after(steps);
        if self.cancel.is_some() || self.progress.is_some() {
            end = end.min(steps.saturating_add(1000));
        }
        let time = [self.next_time(), self.next_stop].into_iter().flatten();
        let time = time.reduce(|a, b| if self.is_before(a, b) { a } else { b });
        self.run.quietly(end, time)?;
        Ok(())
    }

    fn next_time(&self) -> Option<f64> {
        match self.save {
            SaveAt::Times(ref times) => times.get(self.times_done).copied(),
            SaveAt::Interval(length) => {
                let (t0, t1) = (self.t0, self.run.t1);
                let time = t0 + (length * (self.times_done + 1) as f64).copysign(t1 - t0);
                // The end is shown as such, also where rounding puts the last time beside it.
                let last = self.is_before(t1, time) || (t1 - time).abs() < 1e-9 * length;
                (!last).then_some(time)
            }
            _ => None,
        }
    }

    /// Handles the output times and the zeros of the last step in the order of time, and then its end.
    fn look_within(&mut self) -> Ended {
        let mut zeros = 0;
        loop {
            let end = self.run.t();
            let time = self.next_time().filter(|time| !self.is_before(end, *time));
            let zero = self.events.found.get(zeros).copied();
            let zero = zero.filter(|zero| !self.is_before(end, zero.t));
            match (time, zero) {
                (None, None) => break,
                (Some(time), zero) if zero.is_none_or(|zero| !self.is_before(zero.t, time)) => {
                    self.times_done += 1;
                    if let Some(status) = self.show(time)? {
                        return Ok(Some(status));
                    }
                }
                (_, Some(zero)) => {
                    zeros += 1;
                    if let Some(status) = self.occur(zero.event, zero.t, zero.rising, &mut zeros)? {
                        return Ok(Some(status));
                    }
                }
                (Some(_), None) => break,
            }
        }
        let shown = matches!(self.save, SaveAt::Every(every) if self.run.stats.accepted.is_multiple_of(every));
        if shown && self.shown_at != Some(self.run.t()) {
            self.show_end_of_step()
        } else {
            Ok(None)
        }
    }

    /// Shows the point at a time within the last step.
    fn show(&mut self, time: f64) -> Ended {
        self.look_at(time)?;
        self.shown_at = Some(time);
        self.see(false);
        match (self.observe)(time, &mut self.shown) {
            Next::Continue => Ok(None),
            Next::Stop => {
                self.look_at(time)?; // whatever the observer wrote there
                self.run.cut(time, &self.shown);
                Ok(Some(Status::Observer))
            }
            Next::Changed => {
                let Self { run, shown, events, .. } = self;
                let (action, group) = (run.problem.action(), run.problem.group());
                run.cut(time, shown);
                run.change("the observer", |y| action.assign(group, shown, y))?;
                events.restart(time, run.y(), 0..0)?;
                self.end_of_kept();
                Ok(None)
            }
        }
    }

    /// `shown` ← the point at a time within the last step.
    fn look_at(&mut self, time: f64) -> Result<(), RunError> {
        match self.times_by_steps {
            true => self.run.at_by_a_step(time, &mut self.shown),
            false => self.run.at(time, &mut self.shown),
        }
    }

    fn show_end_of_step(&mut self) -> Ended {
        self.show(self.run.t())
    }

    /// Lets the last stored step end where the run was cut.
    fn end_of_kept(&mut self) {
        if let Some(last) = self.kept.as_deref_mut().and_then(|kept| kept.last_mut()) {
            last.0 = self.run.t();
        }
    }

    /// Handles a zero of an event, and all others at the same time.
    fn occur(&mut self, event: usize, t: f64, rising: bool, zeros: &mut usize) -> Ended {
        let mut next = Some((event, rising));
        let mut stopped = None;
        let mut acts = false;
        let at = *zeros - 1;
        while let Some((event, rising)) = next {
            self.run.at(t, &mut self.shown)?;
            let this = &mut self.events.all[event];
            match &mut this.told {
                Some(told) => told(t, &self.shown, rising),
                None => {
                    let y = self.shown.clone();
                    self.solution.events.push(Occurrence { event, t, y, rising });
                }
            }
            this.count += 1;
            acts |= this.change.is_some() || this.stops();
            if this.stops() && stopped.is_none() {
                stopped = Some(this.name.clone());
            }
            // Zeros at one time, up to rounding, belong together.
            let near = |u: f64| (u - t).abs() <= 4.0 * f64::EPSILON * t.abs();
            next = self.events.found.get(*zeros).filter(|zero| near(zero.t)).map(|zero| {
                *zeros += 1;
                (zero.event, zero.rising)
            });
        }
        if !acts {
            return Ok(None);
        }
        self.run.at(t, &mut self.shown)?;
        self.run.cut(t, &self.shown);
        for zero in &self.events.found[at..*zeros] {
            let Event { name, change, .. } = &mut self.events.all[zero.event];
            if let Some(change) = change {
                self.run.change(&format!("event `{name}`"), |y| change(t, y))?;
            }
        }
        self.end_of_kept();
        if let Some(name) = stopped {
            if self.shown_at != Some(t) && !matches!(self.save, SaveAt::Times(_)) {
                self.show_end_of_step()?;
            }
            return Ok(Some(Status::Event(name)));
        }
        self.events.restart(t, self.run.y(), at..*zeros)?;
        Ok(None)
    }
}
