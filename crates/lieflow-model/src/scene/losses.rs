//! Which formula ended a run: one that had no value, or one with a pole.

use lieflow::RunError;

use super::events::SceneEvent;
use super::run::Scene;
use crate::formula::{Formula, Lost, NEAR, Which};

impl Scene {
    /// Forgets which formulas had no value: what [`lost`](Self::lost) tells is of the run after this.
    pub fn forget_losses(&self) {
        let of_rows = self.events.iter().map(SceneEvent::formula);
        self.problem.formula().into_iter().chain(of_rows).for_each(Formula::forget);
    }

    /// The error in words, where a run ended with it by a formula.
    pub fn lost_in_words(&self, error: &RunError) -> Option<String> {
        let lost = self.lost(error)?;
        let RunError::Event { name, t, .. } = error else {
            return Some(format!("{error}: {lost}"));
        };
        // The formula has the value, and mostly the time.
        let at = if lost.t().is_some() { String::new() } else { format!(" at t = {t}") };
        Some(format!("event `{name}`{at}: {lost}, expected a finite number"))
    }

    /// The formula by which a run ended with this error.
    pub fn lost(&self, error: &RunError) -> Option<Lost> {
        if let RunError::Event { name, .. } = error {
            let event = self.events.iter().find(|event| event.name == *name)?;
            return event.formula().lost(Which::Last);
        }
        self.problem.formula()?.lost_by(error)
    }

    /// The formula with a pole at which the steps became too small, in words: one that has no finite value at a time of
    /// few digits close by, with the rest as at the start.
    pub fn pole(&self, error: &RunError) -> Option<String> {
        let RunError::StepSizeUnderflow { t, .. } = *error else { return None };
        let rounded = (0..=POLE_DIGITS).map(|digits| {
            let scale = 10_f64.powi(digits);
            (t * scale).round() / scale
        });
        let mut close = rounded.filter(|at| (at - t).abs() <= NEAR * (1.0 + t.abs()));
        close.find_map(|at| {
            let key = self.problem.check_start(at).into_iter().next()?.key?;
            Some(format!("`{key}` has a pole there: it has no finite value at t = {at}"))
        })
    }
}

/// The decimal digits of a time at which a pole is looked for.
const POLE_DIGITS: i32 = 6;
