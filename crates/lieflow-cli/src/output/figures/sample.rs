//! The rows of a run that figures are drawn from.

use lieflow_model::schema::{Row, Schema};

/// Rows that are kept: some for each pixel.
const KEPT: usize = 2048;
/// Numbers that are kept: a row may have many.
const NUMBERS: usize = 1 << 22;

/// The rows of a run, at regular distances, so that a long run needs no more memory than a short one.
#[derive(Clone, Debug)]
pub struct RowSample<'a> {
    schema: &'a Schema,
    rows: Vec<(f64, Vec<f64>)>,
    /// The first rows, none left out, where some of `rows` were left out later.
    first: Vec<(f64, Vec<f64>)>,
    last: Option<(f64, Vec<f64>)>,
    every: usize,
    seen: usize,
}

impl<'a> RowSample<'a> {
    /// No rows yet.
    pub fn new(schema: &'a Schema) -> Self {
        RowSample { schema, rows: Vec::new(), first: Vec::new(), last: None, every: 1, seen: 0 }
    }

    /// The next row.
    pub fn see(&mut self, t: f64, row: Row<'_>) {
        let row = row.numbers();
        if self.seen.is_multiple_of(self.every) {
            let room = KEPT.min(NUMBERS / row.len().max(1)).max(2);
            if self.rows.len() >= room {
                if self.first.is_empty() {
                    self.first = self.rows.clone();
                }
                let mut odd = true;
                self.rows.retain(|_| {
                    odd = !odd;
                    !odd
                });
                self.every *= 2;
            }
            if self.seen.is_multiple_of(self.every) {
                self.rows.push((t, row.into()));
            }
        }
        match &mut self.last {
            Some((time, last)) => {
                *time = t;
                last.copy_from_slice(row);
            }
            None => self.last = Some((t, row.into())),
        }
        self.seen += 1;
    }

    /// The first row, and the last.
    pub fn ends(&self) -> Option<[(f64, Row<'_>); 2]> {
        Some([self.rows.first()?, self.last.as_ref()?].map(|row| self.named(row)))
    }

    /// The first rows, none left out.
    pub(super) fn first(&self) -> impl Iterator<Item = (f64, Row<'_>)> {
        let first = if self.first.is_empty() { &self.rows } else { &self.first };
        first.iter().map(|row| self.named(row))
    }

    /// Those that were kept, and the last.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (f64, Row<'_>)> {
        let kept = self.rows.last().map(|(t, _)| *t);
        let last = self.last.iter().filter(move |(t, _)| kept != Some(*t));
        self.rows.iter().chain(last).map(|row| self.named(row))
    }

    /// The schema of a row.
    pub(super) fn schema(&self) -> &'a Schema {
        self.schema
    }

    /// How many were kept.
    pub(super) fn kept(&self) -> usize {
        self.rows.len()
    }

    fn named<'s>(&'s self, (t, numbers): &'s (f64, Vec<f64>)) -> (f64, Row<'s>) {
        (*t, self.schema.row(numbers))
    }
}
