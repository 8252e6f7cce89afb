//! Adaptive step size: accepted steps, and the choice of the first step.

use core::cell::Cell;
use core::sync::atomic::Ordering;

use super::control::{Controller, StepControl};
use super::events::LONG_STEPS;
use super::points::AnyPoints;
use super::stats::{RunError, Stats};
use super::stops::Stop;
use super::streak::{Reach, Run};
use super::timeline::{Chooser, Pacer, Timeline, Turns};
use crate::error::StepError;
use crate::methods::{Attempts, FARTHEST, Resize, Step, Streak};
use crate::tolerance::{Rule, Weight};

/// By [`Rule::PerLength`] a step below this part of the largest one of the run is a short one. Behind a jump of f, the rounding of
/// short steps keeps them short, since it does not fall with their length.
const SHORT: f64 = 1e-4;
/// Of so many short steps one is followed by a step of this many times its size.
const SHORT_STEPS: u64 = 8;
const SHORT_GROWTH: f64 = 2.0;
/// A short step that would be lost in the rounding of t has this size, in roundings of t.
const LEAST_SIZE: f64 = 8.0;
/// The number of rejections in a row that ends a run.
const REJECTIONS_MAX: u32 = 60;
/// The radians by which an exact step with events, or without an end, turns.
const EXACT_TURN: f64 = 1.0;
/// The radians by which other steps turn at most, if events have zeros to search for. Then some forty zeros of a function
/// of the state are in a step, and a search finds twice as many.
const FARTHEST_TURN: f64 = 64.0;

/// Before a wall, a step that is larger than this part of the way there does not grow.
const NEAR_WALL: f64 = 0.01;

/// The size, the wall and the controller of a [`Chooser`].
type Choice = (Option<f64>, Option<f64>, Controller);

/// The choice of a step size within a streak. It stops where the step may not have the size that its error allows.
struct Sizes {
    controller: Controller,
    /// The least and the largest size of a step that was not kept.
    found: Cell<[f64; 2]>,
    /// The time of the first step, and the time at which it begins: after a jump its stages are a rounding later.
    first: [f64; 2],
    stop: f64,
    /// The least and the largest size.
    limits: [f64; 2],
    /// The largest size so far, where shorter steps than a part of it are counted ([`Timeline::is_short`]).
    largest: Option<f64>,
}

impl Sizes {
    /// The choice of sizes up to `largest`, after steps of up to `taken`.
    fn new(
        Chooser { controller, control, .. }: &Chooser,
        first: [f64; 2],
        stop: f64,
        [largest, taken]: [f64; 2],
    ) -> Self {
        let found = Cell::new([f64::INFINITY, 0.0]);
        let limits = [control.min_step, largest];
        let largest = (control.tolerance.rule() == Rule::PerLength).then_some(taken);
        Sizes { controller: *controller, found, first, stop, limits, largest }
    }

    /// Notes the size of an accepted step.
    fn note(&self, h: f64) {
        let [least, largest] = self.found.get();
        self.found.set([least.min(h.abs()), largest.max(h.abs())]);
    }
}

impl Resize for Sizes {
    fn after(&self, step: Step<f64>, end: f64, ratio: f64) -> Option<f64> {
        let mut controller = self.controller;
        let [moved, begin] = self.first;
        let size = (end - if step.t == moved { begin } else { step.t }).abs();
        let [least, largest] = self.limits;
        let next = (size * controller.accept(ratio)).max(least);
        let is_free = next <= largest && (self.stop - end).abs() >= 2.0 * next;
        let size = next.copysign(self.stop - end);
        // The caller counts short steps.
        let is_short = |taken: f64| next < SHORT * taken.max(self.found.get()[1]).max(step.h.abs());
        if !is_free || end + size == end || self.largest.is_some_and(is_short) {
            return None;
        }
        self.note(step.h);
        Some(size)
    }
}

impl Timeline {
    /// Takes accepted steps: one, or those of a streak. After an error the choice of the step size is as before the attempt
    /// that failed, so that a caller who has mended f goes on with the same attempt.
    pub(super) fn chosen_steps(
        &mut self,
        run: &mut dyn Run,
        stop: Stop,
        reach: Reach,
    ) -> Result<(), RunError> {
        let Pacer::ByError(Chooser { h, wall, controller, .. }) = self.pacer else { return Ok(()) };
        let mut before = (h, wall, controller);
        self.keep_counts();
        let done = self.attempt_steps(run, stop, reach, &mut before);
        if let (Err(_), Pacer::ByError(chooser)) = (&done, &mut self.pacer) {
            (chooser.h, chooser.wall, chooser.controller) = before;
        }
        done
    }

    fn attempt_steps(
        &mut self,
        run: &mut dyn Run,
        Stop { t: stop, jumps }: Stop,
        reach: Reach,
        before: &mut Choice,
    ) -> Result<(), RunError> {
        let Pacer::ByError(chooser) = &self.pacer else { return Ok(()) };
        let StepControl { min_step, max_steps, first_step, .. } = chooser.control;
        run.points().weigh(chooser.noise.weight());
        let mut h = match chooser.h.or(first_step) {
            _ if self.is_exact() => self.exact_step(run.points(), stop),
            Some(h) => h,
            None => self.first_step(run.points(), stop),
        };
        let mut in_a_row = 0;
        // Beside a jump of f the error of a step falls like its length. Where no step is short enough by an error relative to that,
        // it is relative to the whole of a part.
        let (mut is_whole, mut first_size) = (false, 0.0_f64);
        loop {
            h = h.max(min_step);
            if in_a_row == 0 && !self.is_exact() {
                self.see_turns(run.points(), h);
            }
            let (end, size) = self.propose(h, stop, jumps);
            if self.attempts_left(max_steps) == 0 {
                return Err(self.too_many(size, max_steps));
            }
            if end == self.t {
                if !is_whole && in_a_row == 0 && self.is_short(h) {
                    (is_whole, h) = (true, LEAST_SIZE * f64::EPSILON * self.t.abs());
                    continue;
                }
                // A step that failed, if it was to end beyond here, is the reason.
                let Pacer::ByError(Chooser { wall, obstacle, .. }) = self.pacer else {
                    return Ok(());
                };
                let h = h.min(self.largest_size(self.farthest_turn()));
                return Err(self.underflow(h, obstacle.filter(|_| wall.is_some())));
            }
            self.see_noise_again(run.points(), size);
            if is_whole {
                run.points().weigh(Weight::Jump);
            }
            first_size = first_size.max(size);
            let step = self.step_to(end, end - self.t, jumps && end == stop);
            let Pacer::ByError(chooser) = &self.pacer else { return Ok(()) };
            let largest = [self.largest_size(1.0), self.stats.largest_step];
            let sizes = Sizes::new(chooser, [step.t, self.t], stop, largest);
            let streak = self.streak(chooser, (h, end), reach, &sizes);
            let reused = self.cancel.is_some().then(|| run.points().reused());
            let tried = run.attempt(step, end, &streak);
            let mut size = size;
            if tried.accepted > 0 {
                self.attempted(tried.accepted);
                h = tried.size.abs();
                self.went_on(&tried, &sizes);
                *before = (Some(h), None, sizes.controller);
                self.keep_counts();
                size = (tried.end - self.t).abs();
            }
            self.attempted(1);
            let Attempts { step, end, ratio, .. } = tried;
            if ratio.as_ref().is_ok_and(|ratio| self.is_noise(run.points(), *ratio, size)) {
                continue; // the same attempt: its end is lost
            }
            match ratio.map(|ratio| self.beyond_noise(ratio, size)) {
                Ok(ratio) if ratio <= 1.0 => {
                    let forward = self.t1 > self.t;
                    run.points().accept();
                    self.accepted(run.points(), step, end)?;
                    let smallest = self.stats.after_rejection.map_or(f64::INFINITY, |[_, h]| h);
                    if in_a_row > 0 && size < smallest {
                        self.stats.after_rejection = Some([end, size]);
                    }
                    let grows = in_a_row == 0
                        && self.is_short(size)
                        && self.stats.accepted.is_multiple_of(SHORT_STEPS);
                    let Pacer::ByError(chooser) = &mut self.pacer else { return Ok(()) };
                    let passed = |wall: &f64| if forward { end >= *wall } else { end <= *wall };
                    chooser.wall = chooser.wall.filter(|wall| !passed(wall));
                    let is_near = |wall: f64| size > NEAR_WALL * (wall - end).abs();
                    chooser.controller.hold |= chooser.wall.is_some_and(is_near);
                    let factor = chooser.controller.accept(ratio);
                    let factor = if grows { factor.max(SHORT_GROWTH) } else { factor };
                    let next = size * factor;
                    // A step that was shortened to end at `stop` says nothing against the size before, and one that
                    // goes half the way nothing against the other half.
                    chooser.h = Some(match size / h {
                        part if part < 0.5 => next.max(h),
                        part if part < 0.99 => next.max(size),
                        _ if factor == 1.0 => h, // without the rounding of t
                        _ => next,
                    });
                    return Ok(());
                }
                Err(error) if self.is_cancelled() => {
                    let error = self.underflow(h, Some(error));
                    // The last attempt took one value of f at most from the step before it.
                    let reused = reused.map(|n| run.points().reused().wrapping_sub(n).min(1));
                    if let (Some(cancel), Some(again)) = (&self.cancel, reused) {
                        let evaluations = cancel.counts.evaluations;
                        let evaluations = evaluations.map(|n| n.wrapping_add(again));
                        self.stats = Stats { evaluations, ..cancel.counts };
                    }
                    return Err(error);
                }
                rejected => {
                    self.stats.rejected += 1;
                    in_a_row += 1;
                    let Pacer::ByError(chooser) = &mut self.pacer else { return Ok(()) };
                    if let Err(error) = rejected {
                        (chooser.wall, chooser.obstacle) = (Some(end), Some(error));
                    }
                    h = size * chooser.controller.reject(rejected.ok());
                    // The least step is tried before the run ends.
                    if size > min_step {
                        h = h.max(min_step);
                    }
                    chooser.h = Some(h);
                    // Next to t two steps of different sizes may be one after rounding.
                    let smaller = self.propose(h, stop, jumps).0;
                    let stuck = smaller == self.t || smaller == end;
                    let is_hard = stuck || 2 * in_a_row == REJECTIONS_MAX;
                    if !is_whole && rejected.is_ok() && h >= min_step && is_hard {
                        (is_whole, h) = (true, first_size);
                        continue;
                    }
                    if in_a_row >= REJECTIONS_MAX || h < min_step || stuck {
                        // Of a step that may not be smaller it is the size that was tried.
                        let h = if h < min_step { size } else { h };
                        return Err(self.underflow(h, rejected.err()));
                    }
                }
            }
        }
    }

    /// The end and the size of a step of about this size. A step ends at `stop` if that is near. It ends half way to
    /// `stop` if otherwise the next step would be short, or would lose time that counts.
    fn propose(&self, h: f64, stop: f64, jumps: bool) -> (f64, f64) {
        let max_step = self.largest_size(self.farthest_turn());
        let left = (stop - self.t).abs();
        let h = h.min(max_step);
        let within = |h: f64| {
            let end = self.t + h.copysign(stop - self.t);
            (end, (end - self.t).abs())
        };
        if left <= h || (left <= 1.01 * h && left <= max_step) {
            return if self.loses_time(stop, jumps) { within(0.5 * left) } else { (stop, left) };
        }
        let h = if left < 2.0 * h { 0.5 * left } else { h };
        within(h)
    }

    /// Computes how fast the state turns, if that was long ago or a step of this size is a long one. Steps of methods of a
    /// high order are searched for zeros whatever they turn, so only those near the longest one are long here.
    pub(super) fn see_turns(&mut self, points: &mut dyn AnyPoints, size: f64) {
        let (accepted, is_searched) = (self.stats.accepted, self.facts.order >= LONG_STEPS);
        let near = if is_searched { self.farthest_turn() / FARTHEST } else { 1.0 };
        let is_due = |turns: &Turns| accepted >= turns.next || size.abs() > near * turns.radian;
        if self.turns.as_ref().is_some_and(is_due) {
            let radian = 1.0 / points.turn_rate(self.start_of(size.abs()));
            self.turns = Some(Turns { radian, next: accepted + Turns::EVERY });
            self.stats.evaluations = self.stats.evaluations.map(|n| n + 1);
        }
    }

    /// The time of f at the start of a step of this size: t, or a little after it if t is a stop at which f jumps.
    pub(super) fn start_of(&self, size: f64) -> f64 {
        let end = self.t + size.copysign(self.t1 - self.t);
        self.step_to(end, end - self.t, false).t
    }

    /// The radians by which a step turns the state at most, as far as it is known how fast that turns.
    fn farthest_turn(&self) -> f64 {
        if self.facts.short_turns { FARTHEST } else { FARTHEST_TURN }
    }

    /// The largest size of a step that turns the state by this number of radians at most, as far as it is known how fast that
    /// turns. It is not below the least size.
    fn largest_size(&self, turn: f64) -> f64 {
        let by_turn = self.turns.as_ref().map_or(f64::INFINITY, |turns| turn * turns.radian);
        match &self.pacer {
            Pacer::ByError(Chooser { control, .. }) => {
                control.max_step.min(by_turn.max(control.min_step))
            }
            Pacer::Equal { .. } => by_turn,
        }
    }

    /// The streak that an attempt of size h, which ends at `end`, may begin.
    fn streak<'a>(
        &self,
        Chooser { controller, control, wall, noise, .. }: &Chooser,
        (h, end): (f64, f64),
        Reach { steps, time }: Reach,
        sizes: &'a Sizes,
    ) -> Streak<'a> {
        let stop = sizes.stop;
        let size = h.copysign(stop - self.t);
        let is_free = (stop - self.t).abs() >= 2.0 * h && end == self.t + size;
        let is_alone =
            controller.hold || controller.is_exact() || wall.is_some() || noise.per_size > 0.0;
        if !is_free || is_alone || self.is_long(h) {
            return Streak::ONE;
        }
        let accepted = self.stats.accepted;
        let most = steps.min(self.cadence.next).saturating_sub(accepted);
        let most =
            self.turns.as_ref().map_or(most, |turns| most.min(turns.next.saturating_sub(accepted)));
        let most = most.min(noise.next.saturating_sub(accepted));
        let most =
            if self.is_short(h) { most.min(SHORT_STEPS - accepted % SHORT_STEPS) } else { most };
        let most = most.min(self.attempts_left(control.max_steps)).max(1);
        Streak { most, size, kept: controller.kept, stop, time, resize: Some(sizes) }
    }

    /// Records the accepted steps of a streak, but for the last attempt.
    fn went_on(&mut self, tried: &Attempts, sizes: &Sizes) {
        self.t = tried.step.t;
        if tried.is_kept {
            sizes.note(tried.step.h);
        }
        let Stats { accepted, smallest_step, largest_step, .. } = &mut self.stats;
        let [least, largest] = sizes.found.get();
        *accepted += tried.accepted;
        *smallest_step = smallest_step.min(least);
        *largest_step = largest_step.max(largest);
    }

    /// Is a step of this size a short one, whose error relative to its length may be rounding?
    fn is_short(&self, size: f64) -> bool {
        let Pacer::ByError(Chooser { control, .. }) = &self.pacer else { return false };
        control.tolerance.rule() == Rule::PerLength && size < SHORT * self.stats.largest_step
    }

    /// Is no attempt to follow a failed one?
    fn is_cancelled(&self) -> bool {
        self.cancel.as_ref().is_some_and(|cancel| cancel.flag.load(Ordering::Relaxed))
    }

    /// Keeps the counts before an attempt that may be cancelled.
    #[inline]
    fn keep_counts(&mut self) {
        if let Some(cancel) = &mut self.cancel {
            cancel.counts = self.stats;
        }
    }

    /// True if steps of any size have no error.
    fn is_exact(&self) -> bool {
        matches!(&self.pacer, Pacer::ByError(chooser) if chooser.controller.is_exact())
    }

    /// A step of a method that is exact at any size.
    fn exact_step(&mut self, points: &mut dyn AnyPoints, stop: f64) -> f64 {
        let Pacer::ByError(chooser) = &self.pacer else { return 0.0 };
        if stop.is_finite() && !chooser.has_events {
            return f64::INFINITY;
        }
        let rate = points.rate(self.start_of((stop - self.t).abs()));
        self.stats.evaluations = self.stats.evaluations.map(|n| n + 1);
        match rate > 0.0 {
            true => EXACT_TURN / rate,
            false if stop.is_finite() => f64::INFINITY,
            false => 1.0, // nothing moves, and nothing ends
        }
    }

    /// The first step, by Hairer, Nørsett, Wanner I, II.4. Rates are in the norm of 𝔤, those of translations relative to
    /// the vector. A trial step moves by 1/100 and shows how much f changes.
    fn first_step(&mut self, points: &mut dyn AnyPoints, stop: f64) -> f64 {
        let Pacer::ByError(chooser) = &self.pacer else { return 0.0 };
        let (controller, tolerance) =
            (chooser.controller, chooser.control.tolerance.of_unit_size());
        let span = (stop - self.t).abs();
        let d1 = points.rate(self.start_of(span));
        self.stats.evaluations = self.stats.evaluations.map(|n| n + 1);
        if !d1.is_finite() {
            return 1e-3 * span.min(1.0); // the first attempt will say what is wrong
        }
        let still = d1 * span <= 1e-5;
        let h0 = if still { 1e-6 * span } else { (0.01 / d1).min(span) };
        if h0.is_infinite() {
            return 1.0; // nothing moves, and nothing ends
        }
        let is_whole = h0 == span;
        let end = if is_whole { stop } else { self.t + h0.copysign(stop - self.t) };
        if end == self.t {
            return if still { span } else { h0 };
        }
        // No stage is at `stop`, where f may jump.
        let trial = self.step_to(end, end - self.t, is_whole);
        let end = trial.t + trial.h;
        self.attempted(1);
        if points.attempt(trial, end, &Streak::ONE).ratio.is_err() {
            return h0;
        }
        let change = points.change_of_rate(end);
        self.stats.evaluations = self.stats.evaluations.map(|n| n + 1);
        // Rates: f itself, and the root of its derivative.
        let rate = d1.max((change / h0).sqrt());
        let h1 = controller.first_step(rate, tolerance);
        // From rest, h0 is a guess. What it allows depends on the tolerance, so that runs by two tolerances differ: f may grow
        // like a root of t, where no estimate sees the error of the first step.
        let most =
            if still { (5e5 * tolerance).powf(1.0 / controller.k()).clamp(0.1, 3.0) } else { 1.0 };
        match h1.is_finite() {
            true => h1.min(100.0 * most * h0),
            false => h0,
        }
    }

    #[cold]
    fn underflow(&self, h: f64, source: Option<StepError>) -> RunError {
        let Stats { accepted, rejected, .. } = self.stats;
        let h = h.copysign(self.t1 - self.t);
        RunError::StepSizeUnderflow { t: self.t, h, accepted, rejected, source }
    }

    #[cold]
    pub(super) fn too_many(&self, h: f64, max_steps: u64) -> RunError {
        let Stats { accepted, rejected, .. } = self.stats;
        let h = h.copysign(self.t1 - self.t);
        let left = (self.goal - self.t).abs();
        let by_error = matches!(self.pacer, Pacer::ByError(_));
        RunError::TooManySteps { t: self.t, left, h, accepted, rejected, max_steps, by_error }
    }
}
