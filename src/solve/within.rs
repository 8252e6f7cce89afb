//! Points within the last step, by dense output.

use super::integrator::{Integrator, Looked, Pacer, lit};
use super::stats::RunError;
use crate::actions::Action;
use crate::error::StepError;
use crate::methods::{Method, Step};
use crate::problems::{PointOf, Problem};

impl<P: Problem, M: Method<P>> Integrator<'_, P, M> {
    /// `at` ← the state at t in the last step.
    pub(super) fn at(&mut self, t: f64, at: &mut PointOf<P>) -> Result<(), RunError> {
        let (action, group) = (self.problem.action(), self.problem.group());
        if t == self.t {
            action.assign(group, &self.y, at);
            return Ok(());
        }
        self.within(t, at)
    }

    /// `at` ← the dense output of the last step at t, strictly within it.
    pub(super) fn within(&mut self, t: f64, at: &mut PointOf<P>) -> Result<(), RunError> {
        let (action, group) = (self.problem.action(), self.problem.group());
        let Step { t: start, h, .. } = self.last;
        if t == start {
            action.assign(group, &self.from, at);
            return Ok(());
        }
        let within = |source| RunError::Within { t: start, h, source };
        self.prepare().map_err(within)?;
        let (step, theta) = (lit::<P>(self.last), ((t - start) / h).clamp(0.0, 1.0));
        let [_, each] = self.method.dense_evaluations(self.problem);
        self.stats.points_within += 1;
        self.stats.evaluations = self.stats.evaluations.zip(each).map(|(n, more)| n + more);
        self.method
            .interpolate(self.problem, step, theta, &self.from, &mut self.work, at)
            .map_err(within)?;
        match action.is_finite(group, at) {
            true => Ok(()),
            false => Err(within(StepError::NotFinite { what: "the state" })),
        }
    }

    /// `at` ← the state at t in the last step, by a shorter step from its start.
    pub(super) fn at_by_a_step(&mut self, t: f64, at: &mut PointOf<P>) -> Result<(), RunError> {
        if t == self.t || t == self.last.t {
            return self.at(t, at);
        }
        let Step { n, t: start, h } = self.last;
        self.problem.action().assign(self.problem.group(), &self.from, at);
        let step = lit::<P>(Step { n, t: start, h: t - start });
        self.looked_at = Looked::Stale;
        self.stats.points_within += 1;
        let each = self.method.evaluations(self.problem);
        self.stats.evaluations = self.stats.evaluations.zip(each).map(|(n, more)| n + more);
        self.method
            .step(self.problem, step, at, &mut self.work)
            .map_err(|source| RunError::Within { t: start, h, source })
    }

    /// Prepares the dense output of the last step.
    fn prepare(&mut self) -> Result<(), StepError> {
        if self.looked_at == Looked::Prepared {
            return Ok(());
        }
        if self.looked_at == Looked::Stale {
            self.repeat()?;
        }
        let [once, _] = self.method.dense_evaluations(self.problem);
        self.stats.evaluations = self.stats.evaluations.zip(once).map(|(n, more)| n + more);
        let step = lit::<P>(self.last);
        // A step that was cut is prepared, or was taken again.
        let to = if self.looked_at == Looked::Fresh { &self.y } else { &self.to };
        self.method.prepare(self.problem, step, &self.from, to, &mut self.work)?;
        self.looked_at = Looked::Prepared;
        Ok(())
    }

    /// Records that the workspace no longer holds the last step.
    pub(super) fn forget_workspace(&mut self) {
        if self.looked_at != Looked::Nothing {
            self.looked_at = Looked::Stale;
        }
    }

    /// Repeats the last step, so that the workspace holds it. Its iterations are not counted again.
    fn repeat(&mut self) -> Result<(), StepError> {
        let step = lit::<P>(self.last);
        let counted = self.method.iterations(&self.work);
        let repeated = match &self.pacer {
            Pacer::Equal { .. } => {
                let (action, group) = (self.problem.action(), self.problem.group());
                action.assign(group, &self.from, &mut self.to);
                self.method.step(self.problem, step, &mut self.to, &mut self.work)
            }
            Pacer::ByError(chooser) => (chooser.estimator.attempt)(
                self.method,
                self.problem,
                step,
                &chooser.control.tolerance,
                &self.from,
                &mut self.work,
                &mut self.to,
            )
            .map(drop),
        };
        let again = self.method.iterations(&self.work).wrapping_sub(counted);
        self.stats.iterations = self.stats.iterations.wrapping_sub(again);
        repeated
    }

    /// Goes to another earlier step, for a continuous solution.
    pub(super) fn look_at(&mut self, step: Step<f64>, from: &PointOf<P>) {
        self.problem.action().assign(self.problem.group(), from, &mut self.from);
        self.last = step;
        self.looked_at = Looked::Stale;
    }
}
