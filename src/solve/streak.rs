//! The way from the driver to streaks of attempts.

use super::points::AnyPoints;
use crate::methods::{Attempts, Step, Streak};

/// How far a run may go before the driver looks at it again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// The number of steps of the run then, at most.
    pub(super) steps: u64,
    /// Only the last step may reach this time.
    pub(super) time: Option<f64>,
}

impl Reach {
    /// One step at a time.
    pub(super) const STEP: Reach = Reach { steps: 0, time: None };
}

/// The points of a run, with or without events.
pub(super) trait Run {
    /// The points.
    fn points(&mut self) -> &mut dyn AnyPoints;
    /// Attempts a step that ends at `end`, and those of the streak after it. A step in which an event may have a zero is
    /// the last attempt.
    fn attempt(&mut self, step: Step<f64>, end: f64, streak: &Streak<'_>) -> Attempts;
}

/// The points of a run without events.
pub(super) struct Alone<'a>(pub(super) &'a mut dyn AnyPoints);

impl Run for Alone<'_> {
    fn points(&mut self) -> &mut dyn AnyPoints {
        &mut *self.0
    }
    fn attempt(&mut self, step: Step<f64>, end: f64, streak: &Streak<'_>) -> Attempts {
        self.0.attempt(step, end, streak)
    }
}
