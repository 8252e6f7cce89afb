//! The settings of a run that do not depend on the types of its problem and method.

use std::sync::atomic::AtomicBool;

use super::control::StepControl;
use super::drive::{Checkpoints, Drive, Patience};
use super::events::{EventRule, Events};
use super::grid::{SaveAt, TimeGrid, length_of};
use super::output::Keeps;
use super::stops::{Stop, Stops};
use super::timeline::{Pace, Timeline};
use crate::error::Error;

/// The default rtol and atol.
const DEFAULT: (f64, f64) = (1e-6, 1e-9);

/// What is expected of settings that choose the size of the steps twice.
const ONE_CHOICE: &str = "only one of dt, steps and tolerances in a run";

/// The settings of a run that do not depend on the types of its problem and method.
pub(super) struct Settings<'a> {
    pub(super) t_span: [f64; 2],
    pub(super) pace: Option<Pace>,
    pub(super) save: SaveAt,
    pub(super) times_by_steps: bool,
    pub(super) stops: Stops,
    /// The stops within the span, in order. Made when the settings are checked.
    pub(super) ends: Vec<Stop>,
    pub(super) max_steps: Option<u64>,
    pub(super) cancel: Option<&'a AtomicBool>,
    pub(super) progress: Option<Box<dyn FnMut(f64) + 'a>>,
    pub(super) checkpoints: Option<Checkpoints<'a>>,
    pub(super) resume: Option<Vec<u8>>,
    /// The number of equal intervals of the output, which the span decides.
    pub(super) count: Option<u64>,
    /// The error of the first wrong value.
    pub(super) wrong: Option<Error>,
}

impl<'a> Settings<'a> {
    pub(super) fn new(t_span: [f64; 2]) -> Self {
        Settings {
            t_span,
            pace: None,
            save: SaveAt::End,
            times_by_steps: false,
            stops: Stops::default(),
            ends: Vec::new(),
            max_steps: None,
            cancel: None,
            progress: None,
            checkpoints: None,
            resume: None,
            count: None,
            wrong: None,
        }
    }

    pub(super) fn or_wrong<T>(&mut self, value: Result<T, Error>) -> Option<T> {
        match value {
            Ok(value) => Some(value),
            Err(error) => {
                self.wrong.get_or_insert(error);
                None
            }
        }
    }

    pub(super) fn equal(&mut self, grid: Result<TimeGrid, Error>) {
        if let Some(grid) = self.or_wrong(grid) {
            if self.pace.is_some() {
                self.wrong.get_or_insert(Error::out_of_range("dt", grid.h().abs(), ONE_CHOICE));
            }
            self.pace = Some(Pace::Equal { grid, max_steps: u64::MAX });
        }
    }

    pub(super) fn control(&mut self, control: StepControl) {
        if let Some(Pace::Equal { grid, .. }) = &self.pace {
            let error = Error::out_of_range("dt", grid.h().abs(), ONE_CHOICE);
            self.wrong.get_or_insert(error);
        }
        self.pace = Some(Pace::ByError(control));
    }

    /// Changes the tolerances and limits.
    pub(super) fn with(&mut self, change: impl FnOnce(StepControl) -> Result<StepControl, Error>) {
        let control = match &self.pace {
            Some(Pace::ByError(control)) => Ok(control.clone()),
            _ => StepControl::new(DEFAULT.0, DEFAULT.1),
        };
        if let Some(control) = self.or_wrong(control.and_then(change)) {
            self.control(control);
        }
    }

    pub(super) fn check(&mut self) -> Result<Pace, Error> {
        length_of(self.t_span)?;
        if let Some(error) = self.wrong.take() {
            return Err(error);
        }
        if let Some(count) = self.count {
            self.save = SaveAt::count(count, self.t_span)?;
        }
        self.save.check(self.t_span)?;
        self.ends = self.stops.clone().in_order(self.t_span)?;
        let Some(mut pace) = self.pace.clone() else {
            let expected = "a step size by `dt`, a number of steps by `steps`, or steps chosen by \
                            their error by `tolerances`";
            return Err(Error::NotGiven { arg: "steps", expected });
        };
        match &mut pace {
            Pace::Equal { max_steps, .. } => {
                let unbounded =
                    if self.t_span[1].is_finite() { u64::MAX } else { StepControl::MAX_STEPS };
                *max_steps = self.max_steps.unwrap_or(unbounded);
            }
            Pace::ByError(control) => {
                control.max_steps = self.max_steps.unwrap_or(control.max_steps);
            }
        }
        Ok(pace)
    }

    /// The run with these settings and events.
    pub(super) fn drive(
        self,
        mut times: Timeline,
        events: Vec<EventRule>,
        keeps: Keeps,
    ) -> Drive<'a> {
        let has_zeros = events.iter().any(EventRule::has_zeros);
        times.expect_events(!events.is_empty(), has_zeros);
        let events = Events::new(events, times.facts.order, times.epsilon);
        let Settings { save, times_by_steps, cancel, progress, checkpoints, resume, .. } = self;
        let mut stops = self.ends.into_iter();
        let (t0, next_stop) = (times.t, stops.next());
        Drive {
            times,
            events,
            save,
            t0,
            times_done: 0,
            times_by_steps,
            stops,
            next_stop,
            cancel,
            progress,
            checkpoints,
            resume,
            keeps,
            shown_at: None,
            is_within: false,
            zeros_done: 0,
            patience: Patience::new(),
            drift: Vec::new(),
        }
    }
}
