//! The way from the driver to streaks of attempts.

use super::events::Events;
use super::output::AnyOutput;
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
pub(super) enum Run<'a> {
    Points(&'a mut dyn AnyPoints),
    Watched(&'a mut dyn AnyOutput, &'a mut Events),
}

impl Run<'_> {
    pub(super) fn points(&mut self) -> &mut dyn AnyPoints {
        match self {
            Run::Points(points) => &mut **points,
            Run::Watched(output, _) => output.points(),
        }
    }

    /// Attempts a step that ends at `end`, and those of the streak after it. A step in which an event may have a zero is
    /// the last attempt.
    pub(super) fn attempt(&mut self, step: Step<f64>, end: f64, streak: &Streak) -> Attempts {
        match self {
            Run::Points(points) => points.attempt(step, end, streak),
            Run::Watched(output, events) => output.attempt(step, end, streak, events),
        }
    }
}
