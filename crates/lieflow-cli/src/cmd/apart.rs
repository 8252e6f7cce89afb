//! How far the rows and the zeros of a run are from those of another motion.

use std::collections::VecDeque;
use std::fs::File;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use lieflow::solve::Next;
use lieflow_model::model::{EventPlan, Watcher};
use lieflow_model::schema::{Observable, Part, Row};

use super::watch::Watch;
use crate::output::{Kind, Records, ShownRows};

/// The part of a step at the end of a run where a zero may be of one run only, by rounding.
const NEAR: f64 = 1e-3;
/// The part of a step over which the slope of an event is taken.
const SLOPE: f64 = 1e-4;

/// The parts of the state, with their quantities.
pub(super) fn parts_of<'a>(
    watch: &'a Watch<'_>,
) -> impl Iterator<Item = (&'a Observable, &'a Part)> {
    watch
        .state
        .iter()
        .flat_map(|observable| observable.parts.iter().map(move |part| (*observable, part)))
}

/// The distances of a run from another motion.
#[derive(Clone, Debug)]
pub(super) struct Apart {
    /// The number of rows that were compared.
    pub(super) rows: u64,
    /// The distance of each part of the state.
    pub(super) parts: Vec<Largest>,
    /// The distance of the zeros of each event.
    pub(super) events: Vec<ZerosApart>,
}

/// The largest distance over rows, and that of the last row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Largest {
    /// The largest one; not a number, if one is not.
    pub(super) distance: f64,
    /// Its time.
    pub(super) t: f64,
    /// The last one.
    pub(super) last: f64,
}

impl Largest {
    fn see(&mut self, t: f64, distance: f64) {
        self.last = distance;
        // A comparison with NaN is false, so a NaN stays.
        if distance >= self.distance || distance.is_nan() {
            (self.distance, self.t) = (distance, t);
        }
    }
}

/// The zeros of an event in two runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ZerosApart {
    /// The largest distance of two zeros of the same number.
    pub(super) distance: f64,
    /// The zeros of the run.
    pub(super) own: Count,
    /// The zeros of the other one.
    pub(super) other: Count,
}

/// A number of zeros, if some are so near to the end that they may be of one run only.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Count {
    /// Those before the end.
    sure: u64,
    /// These and those at the end.
    pub(super) possible: u64,
}

impl ZerosApart {
    /// Do both runs have the same number of zeros?
    pub(super) fn agree(&self) -> bool {
        self.own.sure <= self.other.possible && self.other.sure <= self.own.possible
    }
}

impl Apart {
    /// No rows yet, and so many events.
    fn new(watch: &Watch<'_>, events: usize) -> Self {
        let none = Largest { distance: 0.0, t: f64::NAN, last: 0.0 };
        let parts = parts_of(watch).map(|_| none).collect();
        Apart { rows: 0, parts, events: vec![ZerosApart::default(); events] }
    }

    /// The distances of one row from another.
    pub(super) fn of_one_row(watch: &Watch<'_>, t: f64, a: &[f64], b: &[f64]) -> Self {
        let mut apart = Apart::new(watch, 0);
        apart.see(watch, t, a, b);
        apart
    }

    /// The distances of a run from the exact motion. Zeros are compared with those of the exact motion beside them.
    pub(super) fn from_exact(watch: &Watch<'_>, run: &Shown<'_>) -> Result<Self, String> {
        let schema = watch.model.schema();
        let events = run.events(watch)?;
        let mut apart = Apart::new(watch, events.len());
        let mut own = run.reader()?;
        let (mut row, mut zero) = (0, 0);
        while own.read()? {
            let (kind, t, numbers) = own.records.shown();
            match kind {
                Kind::Row => {
                    let exact = run.rows.has(row).then(|| watch.exact(t)).flatten();
                    exact.iter().for_each(|exact| apart.see(watch, t, numbers, exact));
                    row += 1;
                }
                Kind::Event(event) if run.zeros.has(zero) => {
                    let g = |t: f64| match watch.exact(t) {
                        Some(exact) => (events[event].value)(t, schema.row(&exact)),
                        None => f64::NAN,
                    };
                    let aside = SLOPE * run.step;
                    let slope = (g(t + aside) - g(t - aside)) / (2.0 * aside);
                    let distance = &mut apart.events[event].distance;
                    *distance = larger(*distance, (g(t) / slope).abs());
                    zero += 1;
                }
                Kind::Event(_) => zero += 1,
            }
        }
        Ok(apart)
    }

    /// The next row of both.
    fn see(&mut self, watch: &Watch<'_>, t: f64, a: &[f64], b: &[f64]) {
        let [a, b] = [a, b].map(|numbers| watch.model.schema().row(numbers));
        self.rows += 1;
        for (largest, (observable, part)) in self.parts.iter_mut().zip(parts_of(watch)) {
            let columns = || part.columns.clone();
            let distance =
                part.measure.distance(&a[observable][columns()], &b[observable][columns()]);
            largest.see(t, distance);
        }
    }
}

/// The larger of two distances; NaN, if one is.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The rows, or the zeros, that are compared: every so many of them, and the last.
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
    fn has(self, number: u64) -> bool {
        number.is_multiple_of(self.every) || number + 1 == self.all
    }

    /// How many are compared.
    fn count(self) -> u64 {
        let last = self.all.saturating_sub(1);
        self.all.div_ceil(self.every) + u64::from(!last.is_multiple_of(self.every))
    }
}

/// What a run has shown, and what of it is compared.
pub(super) struct Shown<'a> {
    pub(super) records: ShownRows,
    pub(super) rows: Choice,
    pub(super) zeros: Choice,
    /// The start and the end of the run.
    pub(super) t_span: [f64; 2],
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

    /// The events of the scene. None of them ends a run.
    pub(super) fn events(&self, watch: &Watch<'a>) -> Result<Vec<EventPlan<'static>>, String> {
        let plan = |event: &lieflow_model::scene::SceneEvent| {
            let plan = event.plan(watch.model.schema()).map_err(|error| error.to_string())?;
            Ok(EventPlan { stop_after: None, ..plan })
        };
        watch.scene.events.iter().map(plan).collect()
    }

    fn reader(&self) -> Result<Reader<'a>, String> {
        let records = self.records.open().map_err(unreadable)?;
        Ok(Reader { records, stop: self.stop })
    }

    fn own_rows(&self) -> Result<OwnRows<'a>, String> {
        Ok(OwnRows { reader: self.reader()?, choice: self.rows, next: 0 })
    }

    fn own_zeros(&self, events: usize) -> Result<OwnZeros<'a>, String> {
        // Without events there is nothing to read.
        let reader = (events > 0).then(|| self.reader()).transpose()?;
        Ok(OwnZeros { reader, ahead: vec![VecDeque::new(); events] })
    }

    /// Counts a zero at t.
    fn count(&self, count: &mut Count, t: f64) {
        let [t0, end] = self.t_span;
        let (before, near) = ((end - t) * (end - t0).signum(), NEAR * self.step);
        count.sure += u64::from(before > near);
        count.possible += u64::from(before >= -near);
    }
}

fn unreadable(error: io::Error) -> String {
    format!("the rows of the run cannot be read: {error}")
}

/// A reader of what the run has shown, until it is stopped.
struct Reader<'a> {
    records: Records<File>,
    stop: &'a AtomicBool,
}

impl Reader<'_> {
    fn read(&mut self) -> Result<bool, String> {
        if self.stop.load(Ordering::Relaxed) {
            return Err("it was stopped".into());
        }
        self.records.read().map_err(unreadable)
    }
}

/// The rows of the run that are compared, one after the other.
struct OwnRows<'a> {
    reader: Reader<'a>,
    choice: Choice,
    /// The number of the next row.
    next: u64,
}

impl OwnRows<'_> {
    fn next_chosen(&mut self) -> Result<Option<(f64, &[f64])>, String> {
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
struct OwnZeros<'a> {
    reader: Option<Reader<'a>>,
    /// Those that were read while one of another event was looked for.
    ahead: Vec<VecDeque<f64>>,
}

impl OwnZeros<'_> {
    fn next_of(&mut self, event: usize) -> Result<Option<f64>, String> {
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

/// What ends a run early.
pub(super) struct Limits<'a> {
    /// The flag that cancels this run.
    pub(super) cancel: &'a AtomicBool,
    /// The flag that ends all runs.
    pub(super) stop: &'a AtomicBool,
    pub(super) deadline: Option<Instant>,
}

impl Limits<'_> {
    /// Cancels the run, if it is time to.
    pub(super) fn look(&self) {
        let late = self.deadline.is_some_and(|deadline| Instant::now() > deadline);
        if late || self.stop.load(Ordering::Relaxed) {
            self.cancel.store(true, Ordering::Relaxed);
        }
    }
}

/// Compares a second run with the first as it goes. It shows the rows that are compared.
pub(super) struct Beside<'a> {
    watch: &'a Watch<'a>,
    run: &'a Shown<'a>,
    rows: OwnRows<'a>,
    zeros: OwnZeros<'a>,
    limits: Limits<'a>,
    apart: Apart,
    failure: Option<String>,
}

impl<'a> Beside<'a> {
    pub(super) fn new(
        watch: &'a Watch<'a>,
        run: &'a Shown<'a>,
        limits: Limits<'a>,
    ) -> Result<Self, String> {
        let events = watch.scene.events.len();
        let (rows, zeros) = (run.own_rows()?, run.own_zeros(events)?);
        let apart = Apart::new(watch, events);
        Ok(Beside { watch, run, rows, zeros, limits, apart, failure: None })
    }

    /// The distances, once the second run has ended. None: it did not show all rows.
    pub(super) fn finish(mut self) -> Result<Option<Apart>, String> {
        for event in 0..self.apart.events.len() {
            while let Some(t) = self.zeros.next_of(event)? {
                self.run.count(&mut self.apart.events[event].own, t);
            }
        }
        match self.failure {
            Some(failure) => Err(failure),
            None => Ok((self.apart.rows == self.run.rows.count()).then_some(self.apart)),
        }
    }

    fn see_row(&mut self, t: f64, row: Row<'_>) -> Result<(), String> {
        if let Some((own_t, own)) = self.rows.next_chosen()?
            && own_t == t
        {
            self.apart.see(self.watch, t, own, row.numbers());
        }
        Ok(())
    }

    fn see_zero(&mut self, event: usize, t: f64) -> Result<(), String> {
        let apart = &mut self.apart.events[event];
        self.run.count(&mut apart.other, t);
        if let Some(own) = self.zeros.next_of(event)? {
            self.run.count(&mut apart.own, own);
            apart.distance = larger(apart.distance, (own - t).abs());
        }
        Ok(())
    }

    fn keep(&mut self, seen: Result<(), String>) {
        if let Err(failure) = seen {
            self.failure.get_or_insert(failure);
            self.limits.cancel.store(true, Ordering::Relaxed);
        }
    }
}

impl Watcher for Beside<'_> {
    fn row(&mut self, t: f64, row: Row<'_>) -> Next {
        let seen = self.see_row(t, row);
        self.keep(seen);
        if self.failure.is_some() { Next::Stop } else { Next::Continue }
    }

    fn event(&mut self, event: usize, t: f64, _rising: bool, _row: Row<'_>) {
        let seen = self.see_zero(event, t);
        self.keep(seen);
    }

    fn progress(&mut self, _t: f64) {
        self.limits.look();
    }
}
