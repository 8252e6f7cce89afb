//! What a run has shown: its rows and zeros, and which of them are compared.

use std::collections::VecDeque;
use std::fs::File;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};

use lieflow::solve::LONG_STEPS;
use lieflow_model::problem::EventPlan;

use super::apart::Size;
use super::watch::Watch;
use crate::output::{Kind, Records, ShownRows};

/// The number of points in each step where a second run looks at an event, beside those that the library needs. A ninth of
/// half a step is no multiple of most periods that the steps of the first run hide.
const POINTS: u32 = 8;

/// The rows, or the zeros, that are compared: each `every`-th, and the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    every: u64,
    all: u64,
}

impl Choice {
    /// About `most` of them all, at equal distances.
    pub(super) fn new(all: u64, most: u64) -> Self {
        Choice { every: all.div_ceil(most.max(1)).max(1), all }
    }

    /// Is the one of this number, from 0, compared?
    pub(super) fn has(self, number: u64) -> bool {
        number.is_multiple_of(self.every) || number + 1 == self.all
    }

    /// How many are compared.
    pub(super) fn count(self) -> u64 {
        let last = self.all.saturating_sub(1);
        self.all.div_ceil(self.every) + u64::from(!last.is_multiple_of(self.every))
    }
}

/// What a run has shown, and what of it is compared.
pub(super) struct Shown<'a> {
    pub(super) records: ShownRows,
    pub(super) rows: Choice,
    pub(super) zeros: Choice,
    /// The size of each part of the state.
    pub(super) sizes: Vec<Size>,
    /// The start and the end of the run.
    pub(super) t_span: [f64; 2],
    /// 1, or −1 where time runs backward.
    pub(super) direction: f64,
    /// The largest step of the run.
    pub(super) step: f64,
    /// The flag that ends a comparison.
    pub(super) stop: &'a AtomicBool,
}

impl<'a> Shown<'a> {
    /// The times of the rows that are compared.
    pub(super) fn times(&self) -> Result<Vec<f64>, String> {
        let mut own = self.own_rows()?;
        let mut times = Vec::with_capacity(self.rows.count() as usize);
        while let Some((t, _)) = own.next_chosen()? {
            times.push(t);
        }
        Ok(times)
    }

    /// The events of the scene, which are looked at within each step, too. None of them ends a run.
    pub(super) fn events(&self, watch: &Watch<'a>) -> Result<Vec<EventPlan<'static>>, String> {
        let order = watch.model.order(&watch.scene.method).ok().flatten();
        let points = order.is_some_and(|order| order < LONG_STEPS).then_some(POINTS);
        let plan = |event: &lieflow_model::scene::SceneEvent| {
            let plan = event.plan(watch.model.schema()).map_err(|error| error.to_string())?;
            Ok(EventPlan { stop_after: None, points, ..plan })
        };
        watch.scene.events.iter().map(plan).collect()
    }

    /// A reader of its rows and zeros from the first one.
    pub(super) fn reader(&self) -> Result<Reader<'a>, String> {
        let records = self.records.open().map_err(unreadable)?;
        Ok(Reader { records, stop: self.stop })
    }

    /// Its rows that are compared.
    pub(super) fn own_rows(&self) -> Result<OwnRows<'a>, String> {
        Ok(OwnRows { reader: self.reader()?, choice: self.rows, next: 0 })
    }

    /// Its zeros. `events` is the number of events.
    pub(super) fn own_zeros(&self, events: usize) -> Result<OwnZeros<'a>, String> {
        // Without events there is nothing to read.
        let reader = (events > 0).then(|| self.reader()).transpose()?;
        Ok(OwnZeros { reader, ahead: vec![VecDeque::new(); events] })
    }

    /// The length of the run.
    pub(super) fn length(&self) -> f64 {
        (self.t_span[1] - self.t_span[0]).abs()
    }
}

fn unreadable(error: io::Error) -> String {
    format!("the rows of the run cannot be read: {error}")
}

/// A reader of what the run has shown, until it is stopped.
pub(super) struct Reader<'a> {
    pub(super) records: Records<File>,
    stop: &'a AtomicBool,
}

impl Reader<'_> {
    /// Goes on to the next one; false after the last.
    pub(super) fn read(&mut self) -> Result<bool, String> {
        if self.stop.load(Ordering::Relaxed) {
            return Err("it was stopped".into());
        }
        self.records.read().map_err(unreadable)
    }
}

/// The rows of the run that are compared, one after the other.
pub(super) struct OwnRows<'a> {
    reader: Reader<'a>,
    choice: Choice,
    /// The number of the next row.
    next: u64,
}

impl OwnRows<'_> {
    /// The next row, with its time.
    pub(super) fn next_chosen(&mut self) -> Result<Option<(f64, &[f64])>, String> {
        while self.reader.read()? {
            let is_row = self.reader.records.shown().0 == Kind::Row;
            self.next += u64::from(is_row);
            if is_row && self.choice.has(self.next - 1) {
                let (_, t, numbers) = self.reader.records.shown();
                return Ok(Some((t, numbers)));
            }
        }
        Ok(None)
    }
}

/// The zeros of the run, event by event.
pub(super) struct OwnZeros<'a> {
    reader: Option<Reader<'a>>,
    /// Those that were read while one of another event was looked for.
    ahead: Vec<VecDeque<f64>>,
}

impl OwnZeros<'_> {
    /// The time of the next zero of an event.
    pub(super) fn next_of(&mut self, event: usize) -> Result<Option<f64>, String> {
        if let Some(t) = self.ahead[event].pop_front() {
            return Ok(Some(t));
        }
        let Some(reader) = &mut self.reader else { return Ok(None) };
        while reader.read()? {
            match reader.records.shown() {
                (Kind::Event(of), t, _) if of == event => return Ok(Some(t)),
                (Kind::Event(other), t, _) => self.ahead[other].push_back(t),
                (Kind::Row, ..) => {}
            }
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_has_the_first_and_the_last() {
        for (all, most) in [(1, 5), (10, 10), (11, 10), (100, 7), (1000, 1), (5, 0)] {
            let choice = Choice::new(all, most);
            let chosen: Vec<u64> = (0..all).filter(|number| choice.has(*number)).collect();
            assert_eq!((chosen[0], chosen[chosen.len() - 1]), (0, all - 1));
            assert_eq!(chosen.len() as u64, choice.count());
            assert!(choice.count() <= most.max(1) + 1);
        }
    }
}
