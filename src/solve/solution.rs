//! The result of a run.

use core::fmt;

use super::drift::Drift;
use super::stats::{RunError, Stats};
use crate::error::Error;

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The end of the span was reached.
    Finished,
    /// An event with this name stopped the run.
    Event(String),
    /// The observer stopped the run.
    Observer,
    /// The run was cancelled.
    Cancelled,
}

impl Status {
    /// The name of the event that stopped the run.
    pub fn event(&self) -> Option<&str> {
        match self {
            Status::Event(name) => Some(name),
            _ => None,
        }
    }
}

/// The answer of an observer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Next {
    /// Go on. What the observer wrote into the state has no effect.
    #[default]
    Continue,
    /// Stop here.
    Stop,
    /// The observer changed the state, and the run continues from it. It must be on M. Zeros of events at this time are told
    /// with the new state.
    Changed,
}

impl From<()> for Next {
    fn from((): ()) -> Self {
        Next::Continue
    }
}

/// A zero of an event.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Occurrence<Y> {
    /// The number of the event, in the order in which the events were given.
    pub event: usize,
    /// The time.
    pub t: f64,
    /// The state, before the event changed it.
    pub y: Y,
    /// True if g rises through zero.
    pub rising: bool,
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution<Y> {
    /// The times of the output.
    pub times: Vec<f64>,
    /// The points at these times.
    pub points: Vec<Y>,
    /// The zeros of the events, in the order of time.
    pub events: Vec<Occurrence<Y>>,
    /// The time at the end.
    pub t: f64,
    /// The state at the end.
    pub y: Y,
    /// Why the run ended.
    pub status: Status,
    /// The statistics of the run.
    pub stats: Stats,
    /// The drifts of the invariants, if they were watched.
    pub drift: Vec<Drift>,
}

impl<Y> Solution<Y> {
    pub(super) fn new(t: f64, y: Y) -> Self {
        Solution {
            times: Vec::new(),
            points: Vec::new(),
            events: Vec::new(),
            t,
            y,
            status: Status::Finished,
            stats: Stats::default(),
            drift: Vec::new(),
        }
    }

    /// The solution of a run that ended at y, with these statistics and zeros of events.
    pub(super) fn of(
        (t, y): (f64, Y),
        stats: Stats,
        drift: Vec<Drift>,
        events: Vec<Occurrence<Y>>,
    ) -> Self {
        Solution { events, stats, drift, ..Solution::new(t, y) }
    }

    /// The result of a run that ended so.
    pub(super) fn ended(self, ended: Result<Status, RunError>) -> Ended<Y> {
        match ended {
            Ok(status) => Ok(Solution { status, ..self }),
            Err(error) => Err(Interrupted { error, solution: Some(Box::new(self)) }),
        }
    }

    /// The times of the event with this number.
    pub fn times_of(&self, event: usize) -> impl Iterator<Item = f64> {
        self.events.iter().filter(move |found| found.event == event).map(|found| found.t)
    }
}

/// The result of a run, or the error that ended it with the results so far.
pub type Ended<Y> = Result<Solution<Y>, Interrupted<Y>>;

/// The error of a run that failed, with its results so far.
pub struct Interrupted<Y> {
    /// Why.
    pub error: RunError,
    /// The output and the events so far, and the last accepted point; `None` if the run did not begin.
    pub solution: Option<Box<Solution<Y>>>,
}

impl<Y> fmt::Debug for Interrupted<Y> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl<Y> fmt::Display for Interrupted<Y> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.error.fmt(f)
    }
}

impl<Y> std::error::Error for Interrupted<Y> {}

impl<Y> From<RunError> for Interrupted<Y> {
    fn from(error: RunError) -> Self {
        Interrupted { error, solution: None }
    }
}

impl<Y> From<Error> for Interrupted<Y> {
    fn from(error: Error) -> Self {
        RunError::from(error).into()
    }
}

impl<Y> From<Interrupted<Y>> for RunError {
    fn from(interrupted: Interrupted<Y>) -> Self {
        interrupted.error
    }
}
