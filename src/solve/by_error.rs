//! Adaptive step size: one accepted step, and the choice of the first step.

use super::integrator::{Chooser, Integrator, Looked, Pacer, lit, size_to};
use super::stats::{RunError, Stats};
use crate::actions::Action;
use crate::error::StepError;
use crate::groups::LieAlgebra;
use crate::methods::{Method, Step};
use crate::problems::{AlgOf, Problem, ScalarOf};
use crate::scalar::Real;

/// The number of rejections in a row that ends a run.
const REJECTIONS_MAX: u32 = 60;

impl<P: Problem, M: Method<P>> Integrator<'_, P, M> {
    pub(super) fn chosen_step(&mut self, stop: f64, jumps: bool) -> Result<(), RunError> {
        let Pacer::ByError(chooser) = &self.pacer else { return Ok(()) };
        let (min_step, max_steps) = (chooser.control.min_step, chooser.control.max_steps);
        let mut h = match (chooser.h, chooser.control.first_step) {
            (Some(h), _) | (None, Some(h)) => h,
            (None, None) => self.first_step(stop),
        };
        let mut in_a_row = 0;
        loop {
            h = h.max(min_step);
            let (end, size) = self.propose(h, stop);
            if self.stats.accepted + self.stats.rejected >= max_steps {
                return Err(self.too_many(size, max_steps));
            }
            if end == self.t {
                return Err(self.underflow(h, None));
            }
            let h_to_end = size_to(self.t, end, jumps && end == stop);
            let step = Step { n: self.stats.accepted, t: self.t, h: h_to_end };
            match self.attempt(step) {
                Ok(ratio) if ratio <= 1.0 => {
                    let forward = self.t1 > self.t;
                    core::mem::swap(&mut self.from, &mut self.y);
                    core::mem::swap(&mut self.y, &mut self.to);
                    self.accepted(step, end);
                    let Pacer::ByError(chooser) = &mut self.pacer else { return Ok(()) };
                    let passed = |wall: &f64| if forward { end >= *wall } else { end <= *wall };
                    chooser.wall = chooser.wall.filter(|wall| !passed(wall));
                    chooser.controller.hold |= chooser.wall.is_some();
                    let next = size * chooser.controller.accept(ratio);
                    // A step that was shortened to end at `stop` says nothing against the size before, and one that
                    // goes half the way nothing against the other half.
                    chooser.h = Some(match size / h {
                        part if part < 0.5 => next.max(h),
                        part if part < 0.99 => next.max(size),
                        _ => next,
                    });
                    return Ok(());
                }
                rejected => {
                    self.stats.rejected += 1;
                    in_a_row += 1;
                    let Pacer::ByError(chooser) = &mut self.pacer else { return Ok(()) };
                    if rejected.is_err() {
                        chooser.wall = Some(end);
                    }
                    h = size * chooser.controller.reject(rejected.ok());
                    chooser.h = Some(h);
                    // Next to t two steps of different sizes may be one after rounding.
                    let smaller = self.propose(h, stop).0;
                    let stuck = smaller == self.t || smaller == end;
                    if in_a_row >= REJECTIONS_MAX || h < min_step || stuck {
                        return Err(self.underflow(h, rejected.err()));
                    }
                }
            }
        }
    }

    /// The end and the size of a step of about this size. A step ends at `stop` if that is near. It ends half way to
    /// `stop` if otherwise the next step would be short.
    fn propose(&self, h: f64, stop: f64) -> (f64, f64) {
        let Pacer::ByError(chooser) = &self.pacer else { return (self.t, 0.0) };
        let max_step = chooser.control.max_step;
        let left = (stop - self.t).abs();
        let h = h.min(max_step);
        if left <= h || (left <= 1.01 * h && left <= max_step) {
            return (stop, left);
        }
        let h = if left < 2.0 * h { 0.5 * left } else { h };
        let end = self.t + h.copysign(stop - self.t);
        (end, (end - self.t).abs())
    }

    /// `to` ← the step from y. Returns its error in units of the tolerance.
    fn attempt(&mut self, step: Step<f64>) -> Result<f64, StepError> {
        let Pacer::ByError(chooser) = &self.pacer else {
            return Err(StepError::NotFinite { what: "the error estimate" });
        };
        let Chooser { control, estimator, evaluations, maps, .. } = &**chooser;
        self.stats.evaluations = self.stats.evaluations.zip(*evaluations).map(|(n, more)| n + more);
        self.stats.maps = self.stats.maps.zip(*maps).map(|(n, more)| n + more);
        self.looked_at = Looked::Nothing;
        let (tolerance, work) = (&control.tolerance, &mut self.work);
        let ratio = (estimator.attempt)(
            self.method,
            self.problem,
            lit::<P>(step),
            tolerance,
            &self.y,
            work,
            &mut self.to,
        )?;
        if !self.problem.action().is_finite(self.problem.group(), &self.to) {
            return Err(StepError::NotFinite { what: "the state" });
        }
        match ratio.is_finite() {
            true => Ok(ratio),
            false => Err(StepError::NotFinite { what: "the error estimate" }),
        }
    }

    /// The first step, by Hairer, Nørsett, Wanner I, II.4, in the norm of 𝔤. A trial step moves by 1/100 and shows how
    /// much f changes.
    fn first_step(&mut self, stop: f64) -> f64 {
        let Pacer::ByError(chooser) = &mut self.pacer else { return 0.0 };
        let Some(mut store) = chooser.first.take() else { return 0.0 };
        let h = self.first_step_with(stop, &mut store);
        if let Pacer::ByError(chooser) = &mut self.pacer {
            chooser.first = Some(store);
        }
        h
    }

    fn first_step_with(
        &mut self,
        stop: f64,
        (f0, f1, work): &mut (AlgOf<P>, AlgOf<P>, P::Work),
    ) -> f64 {
        let Pacer::ByError(chooser) = &self.pacer else { return 0.0 };
        let (k, tolerance) = (chooser.controller.k, chooser.control.tolerance.of_unit_size());
        let (group, one) = (self.problem.group(), ScalarOf::<P>::lit);
        let norm = chooser.estimator.norm;
        let span = (stop - self.t).abs();
        self.problem.f(one(self.t), &self.y, f0, work);
        self.stats.evaluations = self.stats.evaluations.map(|n| n + 1);
        let d1 = norm(self.problem, f0);
        if !d1.is_finite() {
            return 1e-3 * span.min(1.0); // the first attempt will say what is wrong
        }
        let still = d1 * span <= 1e-5;
        let h0 = if still { 1e-6 * span } else { (0.01 / d1).min(span) };
        if h0.is_infinite() {
            return 1.0; // nothing moves, and nothing ends
        }
        let end = self.t + h0.copysign(stop - self.t);
        if end == self.t {
            return if still { span } else { h0 };
        }
        if self.attempt(Step { n: self.stats.accepted, t: self.t, h: end - self.t }).is_err() {
            return h0;
        }
        self.problem.f(one(end), &self.to, f1, work);
        self.stats.evaluations = self.stats.evaluations.map(|n| n + 1);
        group.axpy(one(-1.0), f0, f1);
        // Rates: f itself, and the root of its derivative.
        let rate = d1.max((norm(self.problem, f1) / h0).sqrt());
        let h1 = (0.01 * tolerance).powf(1.0 / k) / rate;
        match h1.is_finite() {
            true => h1.min(100.0 * h0),
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
        RunError::TooManySteps { t: self.t, h, accepted, rejected, max_steps }
    }
}
