//! The steps to and from times at which f jumps, and to the end: no stage is on the other side.

use super::stops::{MARGIN, unit};
use super::timeline::{Pacer, Timeline};
use crate::methods::Step;

/// Of a step by error from one jump to the next, the time that may be lost, as a part of the tolerance.
const LOST: f64 = 1e-3;

impl Timeline {
    /// Is t a stop at which f jumps, and may a stage be there?
    pub(super) fn is_after_jump(&self) -> bool {
        self.jumped_by_stop && self.t == self.jumped_at && !self.facts.stages_within
    }

    /// Does a step by error to `end` lose time that counts? One from a jump to the next, or to the end of the run, has no room for
    /// its whole size. Two steps have.
    pub(super) fn loses_time(&self, end: f64, jumps: bool) -> bool {
        let Pacer::ByError(chooser) = &self.pacer else { return false };
        let is_last = end == self.goal || end == self.t1;
        let (left, tolerance) = (end - self.t, chooser.control.tolerance().of_unit_size());
        let no_room = (jumps && self.t == self.jumped_at && !self.facts.stages_within)
            || (is_last && self.is_after_jump());
        no_room
            && self.unit(self.t, self.t + 0.5 * left) != 0.0
            && 2.0 * self.unit(self.t, end).abs() > LOST * tolerance * left.abs()
    }

    /// [`unit`] of the times of stages.
    fn unit(&self, t: f64, end: f64) -> f64 {
        unit([t, end], self.epsilon)
    }

    /// The step to `end`, of size h. If f jumps there, no stage is at `end`, and if t is a stop at which f jumps, none is at t.
    /// No stage is after the end of the run, nor after the time that the caller asked for.
    ///
    /// A step to a jump has its whole size, and begins a few rounding units before t. One to the end begins so where its last
    /// stage would be after it. One from a jump begins as much after t. If f may jump at t, too, the step is shorter by a
    /// rounding of t at each of both.
    pub(super) fn step_to(&self, end: f64, mut h: f64, jumps: bool) -> Step<f64> {
        let (n, mut t) = (self.stats.accepted, self.t);
        let unit = self.unit(t, end);
        let is_last = end == self.goal || end == self.t1;
        if self.is_after_jump() && unit != 0.0 {
            if !jumps && !is_last {
                return Step { n, t: t + MARGIN * unit, h };
            }
            let next = if unit > 0.0 { t.next_up() } else { t.next_down() };
            let late = if t == 0.0 { unit } else { (next - t) * (self.epsilon / f64::EPSILON) };
            (t, h) = (t + late, h - late);
        }
        if !jumps && (!is_last || self.facts.stages_within) {
            return Step { n, t, h };
        }
        // How far the last stage is after `end`. The step may be taken in two halves, whose times are rounded, too.
        let late = |t: f64, h: f64| {
            let [whole, halves] =
                [t + h, t + 0.5 * h + 0.5 * h].map(|at| (at - end) * unit.signum());
            Some(whole.max(halves)).filter(|&late| late > 0.0 || jumps && late == 0.0)
        };
        if self.t != self.jumped_at {
            let (first, margin) = if jumps { (MARGIN * unit, MARGIN * unit) } else { (0.0, unit) };
            t -= first;
            // Times of a grid that begins far from 0 have the rounding of its start: h may end after `end`.
            while unit != 0.0
                && let Some(late) = late(t, h)
            {
                t -= late.copysign(unit) + margin;
            }
            return Step { n, t, h };
        }
        // The end of a step of a grid may be a rounding after `end`. Half a unit is no change of a step that is longer than
        // both times, across t = 0.
        let mut less = 0.5 * unit;
        while unit != 0.0 && late(t, h).is_some() {
            if h - less == h {
                less *= 2.0;
            }
            h -= less;
        }
        Step { n, t, h }
    }
}
