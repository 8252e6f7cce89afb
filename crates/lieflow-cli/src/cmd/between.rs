//! What the rows of a run say of its events: were zeros missed, is the function of an event zero, or rounding alone?

use lieflow::Direction;
use lieflow_model::scene::SceneEvent;
use lieflow_model::schema::Row;

use crate::output::{EventSummary, count_in_words, number, rough};

/// The function of an event, of t and a row.
type ValueOfRow = Box<dyn Fn(f64, Row<'_>) -> f64>;

/// A value that is this part of the largest one may be a zero that is found.
const NEAR_ZERO: f64 = 1e-9;
/// A function that is moved by as much as it is, where the columns of its row change by so many last digits of their parts,
/// is rounding, if it has many zeros.
const ROUNDING: f64 = 100.0 * f64::EPSILON;
/// Rounding has at least one zero in so many rows.
const SELDOM: u64 = 8;

/// Number of gaps that are checked, and of points in each.
const LOOKED_AT: u64 = 64;
const POINTS: u32 = 101;

/// A row before, at which the function is not 0: its time, the value, and the zeros up to there.
#[derive(Clone, Copy)]
struct Before {
    t: f64,
    value: f64,
    zeros: u64,
    /// Is a zero missed before it?
    is_missed: bool,
}

/// The function of an event at the rows of a run.
pub(super) struct Between {
    name: String,
    direction: Direction,
    value: ValueOfRow,
    before: Option<Before>,
    /// The time of the last row, and the zeros up to there, also where the function is 0.
    last_row: Option<(f64, u64)>,
    /// The rows before which zeros were missed.
    missed: u64,
    rows: u64,
    /// The largest absolute value at a row.
    largest: f64,
    /// The largest absolute value at a row, at the end of a step, or at a point that was looked at.
    largest_anywhere: f64,
    /// True if each value there that was not 0 is rounding.
    is_rounding: bool,
}

/// Is this value of a function rounding of the columns of its row? A column has the rounding of its part.
fn is_rounding_of(value: f64, t: f64, row: Row<'_>, function: &ValueOfRow) -> bool {
    let mut numbers = row.numbers().to_vec();
    let mut moved = 0.0;
    for observable in row.schema() {
        let terms = row.terms(observable);
        for part in &observable.parts {
            let entries = &row[observable][part.columns.clone()];
            let size = entries.iter().chain(&[terms]).fold(0.0, |size: f64, x| size.max(x.abs()));
            for column in part.columns.clone() {
                let place = observable.place(column);
                let before = numbers[place];
                numbers[place] += ROUNDING * size;
                let there = function(t, row.schema().row(&numbers));
                numbers[place] = before;
                if there.is_finite() {
                    moved += (there - value).abs();
                }
                if moved >= value.abs() {
                    return true;
                }
            }
        }
    }
    false
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
            last_row: None,
            missed: 0,
            rows: 0,
            largest: 0.0,
            largest_anywhere: 0.0,
            is_rounding: true,
        }
    }

    /// The next row. The run has had `zeros` zeros up to there.
    pub(super) fn see(&mut self, t: f64, row: Row<'_>, zeros: u64) {
        let value = (self.value)(t, row);
        self.rows += 1;
        self.largest = self.largest.max(value.abs());
        self.note_value(value, (t, row));
        let before = self.before.map(|before| (before.t, before.zeros)).or(self.last_row);
        if let Some((before, had)) = before
            && self.rows <= LOOKED_AT
        {
            self.look_between(before, (t, row), zeros - had);
        }
        self.last_row = Some((t, zeros));
        if value.abs() <= NEAR_ZERO * self.largest {
            return;
        }
        let counts = |before: f64| self.direction.has_change(before, value);
        let is_missed =
            self.before.is_some_and(|before| counts(before.value) && before.zeros == zeros);
        self.missed += u64::from(is_missed);
        self.before = Some(Before { t, value, zeros, is_missed });
    }

    /// The last of `zeros` zeros, at t. A row at the same time comes before it. Where the function jumps there, the row has its
    /// value after the jump.
    pub(super) fn see_zero(&mut self, t: f64, zeros: u64) {
        if let Some(before) =
            self.before.as_mut().filter(|before| before.is_missed && before.t == t)
        {
            (before.zeros, before.is_missed) = (zeros, false);
            self.missed -= 1;
        }
    }

    /// The end of a step.
    pub(super) fn see_end_of_step(&mut self, t: f64, row: Row<'_>) {
        self.note_value((self.value)(t, row), (t, row));
    }

    /// Calls `each` with the numbers that were seen where no row is, too.
    pub(super) fn each_unshown(&mut self, each: &mut dyn FnMut(&mut f64)) {
        let mut is_rounding = f64::from(u8::from(self.is_rounding));
        each(&mut self.largest_anywhere);
        each(&mut is_rounding);
        self.is_rounding = is_rounding != 0.0;
    }

    /// A value of the function with this row.
    fn note_value(&mut self, value: f64, (t, row): (f64, Row<'_>)) {
        if value != 0.0 {
            self.largest_anywhere = self.largest_anywhere.max(value.abs());
            // Once a value is not rounding, no other is asked.
            self.is_rounding = self.is_rounding && is_rounding_of(value, t, row, &self.value);
        }
    }

    /// Looks at the function of t between two rows, with the columns of the second one: it may swing fast by itself.
    fn look_between(&mut self, before: f64, (t, row): (f64, Row<'_>), found: u64) {
        let at = |k: u32| before + (t - before) * f64::from(k) / f64::from(POINTS);
        let values: Vec<f64> = (0..=POINTS).map(|k| (self.value)(at(k), row)).collect();
        let swings =
            values.windows(2).filter(|pair| (pair[0] > 0.0) != (pair[1] > 0.0)).count() as u64;
        (0..).zip(&values).for_each(|(k, value)| self.note_value(*value, (at(k), row)));
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
        self.rows > 1 && self.is_rounding && SELDOM * zeros > self.rows
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
        if self.largest_anywhere == 0.0 && self.rows > 1 {
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
