//! What the rows of a run say of its events: were zeros missed, is the function of an event zero, or rounding alone?

use lieflow::Direction;
use lieflow_model::scene::SceneEvent;
use lieflow_model::schema::Row;

use crate::output::{EventSummary, count_in_words, number, rough};

/// The function of an event, of t and a row.
type ValueOfRow = Box<dyn Fn(f64, Row<'_>) -> f64>;

/// A value that is this part of the largest one may be a zero that is found.
const NEAR_ZERO: f64 = 1e-9;
/// A function that stays below this many last digits of the largest number of its row is rounding, if it has many zeros.
const ROUNDING: f64 = 100.0 * f64::EPSILON;
/// Rounding has at least one zero in so many rows.
const SELDOM: u64 = 8;

/// Number of gaps that are checked, and of points in each.
const LOOKED_AT: u64 = 64;
const POINTS: u32 = 101;

/// A row before: its time, the value, and the zeros up to there.
#[derive(Clone, Copy)]
struct Before {
    t: f64,
    value: f64,
    zeros: u64,
}

/// The function of an event at the rows of a run.
pub(super) struct Between {
    name: String,
    direction: Direction,
    value: ValueOfRow,
    before: Option<Before>,
    /// The rows before which zeros were missed.
    missed: u64,
    rows: u64,
    /// The largest absolute value at a row.
    largest: f64,
    /// The largest absolute value at a row, at the end of a step, or at a point that was looked at.
    largest_anywhere: f64,
    /// The largest value there in units of the largest number of its row.
    largest_share: f64,
}

impl Between {
    /// No row yet. `value` is the function of the event.
    pub(super) fn new(event: &SceneEvent, value: ValueOfRow) -> Self {
        let (name, direction) = (event.name.clone(), event.direction);
        Between {
            name,
            direction,
            value,
            before: None,
            missed: 0,
            rows: 0,
            largest: 0.0,
            largest_anywhere: 0.0,
            largest_share: 0.0,
        }
    }

    /// The next row. The run has had `zeros` zeros up to there.
    pub(super) fn see(&mut self, t: f64, row: Row<'_>, zeros: u64) {
        let value = (self.value)(t, row);
        self.rows += 1;
        self.largest = self.largest.max(value.abs());
        self.note_value(value, row);
        if let Some(before) = self.before
            && self.rows <= LOOKED_AT
        {
            self.look_between(before.t, (t, row), zeros - before.zeros);
        }
        if value.abs() <= NEAR_ZERO * self.largest {
            return;
        }
        let counts = |before: f64| self.direction.has_change(before, value);
        if self.before.is_some_and(|before| counts(before.value) && before.zeros == zeros) {
            self.missed += 1;
        }
        self.before = Some(Before { t, value, zeros });
    }

    /// The end of a step.
    pub(super) fn see_end_of_step(&mut self, t: f64, row: Row<'_>) {
        self.note_value((self.value)(t, row), row);
    }

    /// A value of the function with this row.
    fn note_value(&mut self, value: f64, row: Row<'_>) {
        if value != 0.0 {
            let size = row.values().iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            self.largest_anywhere = self.largest_anywhere.max(value.abs());
            self.largest_share = self.largest_share.max(value.abs() / size);
        }
    }

    /// Looks at the function of t between two rows, with the columns of the second one: it may swing fast by itself.
    fn look_between(&mut self, before: f64, (t, row): (f64, Row<'_>), found: u64) {
        let at = |k: u32| before + (t - before) * f64::from(k) / f64::from(POINTS);
        let values: Vec<f64> = (0..=POINTS).map(|k| (self.value)(at(k), row)).collect();
        let swings =
            values.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count() as u64;
        values.iter().for_each(|value| self.note_value(*value, row));
        // In one direction every second zero counts, and the columns move a little.
        if swings > 2 * found + 2 {
            self.missed += 1;
        }
    }

    /// Were zeros missed?
    pub(super) fn has_missed(&self) -> bool {
        self.missed > 0
    }

    /// Are the values of the function rounding alone, with this many zeros?
    pub(super) fn is_rounding(&self, zeros: u64) -> bool {
        self.rows > 1 && self.largest_share <= ROUNDING && SELDOM * zeros > self.rows
    }

    /// The warning about zeros that were missed.
    pub(super) fn warning(&self, zeros: u64) -> Option<String> {
        (self.has_missed() && !self.is_rounding(zeros)).then(|| {
            format!(
                "event {}: zeros were missed, before {} of the rows. Its function changes faster than the steps: take \
                 shorter steps (dt, or h_max)",
                self.name,
                number(self.missed as f64)
            )
        })
    }

    /// The note about an event that is zero or rounding all the time, that never comes, or whose `stop_after` was not
    /// reached.
    pub(super) fn note(&self, seen: &EventSummary, stop_after: Option<u64>) -> Option<String> {
        let name = &self.name;
        if self.largest == 0.0 && self.rows > 1 {
            return Some(format!("event `{name}`: its function is zero all the time"));
        }
        if self.is_rounding(seen.count) {
            let largest = rough(self.largest_anywhere);
            return Some(format!(
                "event `{name}`: its function is zero up to rounding, at most {largest}. Its zeros have no meaning"
            ));
        }
        match (seen.count, stop_after) {
            (count, Some(stop_after)) => Some(format!(
                "event `{name}`: stop_after = {stop_after} was not reached, it came {}",
                count_in_words(count)
            )),
            (0, None) => Some(format!("event `{name}`: no zero")),
            _ => None,
        }
    }
}
