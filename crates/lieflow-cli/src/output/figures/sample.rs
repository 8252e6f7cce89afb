//! The rows of a run that figures are drawn from.

use lieflow_model::schema::{Row, Schema};

/// Spans that are kept: some for each pixel. The number is even, so that they can be joined in pairs.
const KEPT: usize = 2048;
/// Numbers that are kept: a row may have many.
const NUMBERS: usize = 1 << 22;

/// Rows that follow each other: the first of them, and the extremes of each number.
#[derive(Clone, Debug)]
struct Span {
    t: f64,
    row: Vec<f64>,
    /// The least and the greatest of each number, in the order in which they came: the earlier ones, and the later
    /// ones. Empty where the span is one row.
    extremes: [Vec<f64>; 2],
}

impl Span {
    fn of(t: f64, row: &[f64]) -> Self {
        Span { t, row: row.into(), extremes: [Vec::new(), Vec::new()] }
    }

    /// Takes the numbers of the next row, or the extremes of the next span, in.
    fn take(&mut self, next: [&[f64]; 2]) {
        if self.extremes[0].is_empty() {
            self.extremes = [self.row.clone(), self.row.clone()];
        }
        let [early, late] = &mut self.extremes;
        for (i, (early, late)) in early.iter_mut().zip(late).enumerate() {
            [*early, *late] = extremes([*early, *late, next[0][i], next[1][i]]);
        }
    }

    fn join(&mut self, next: &Span) {
        match &next.extremes {
            [early, _] if early.is_empty() => self.take([&next.row, &next.row]),
            [early, late] => self.take([early, late]),
        }
    }
}

/// The least and the greatest of some numbers, in their order. NaN is ignored.
fn extremes(numbers: [f64; 4]) -> [f64; 2] {
    let [mut least, mut greatest] = [0; 2];
    for (i, x) in numbers.iter().enumerate() {
        if *x < numbers[least] || numbers[least].is_nan() {
            least = i;
        }
        if *x > numbers[greatest] || numbers[greatest].is_nan() {
            greatest = i;
        }
    }
    [least.min(greatest), least.max(greatest)].map(|i| numbers[i])
}

/// Rows of numbers in spans of the same length, so that a long run needs no more memory than a short one.
#[derive(Clone, Debug)]
pub struct Sample {
    spans: Vec<Span>,
    /// The first rows, none left out, where there are fewer spans than rows.
    first: Vec<Span>,
    last: Option<(f64, Vec<f64>)>,
    /// The rows of a span.
    every: usize,
    seen: usize,
}

impl Default for Sample {
    fn default() -> Self {
        Sample { spans: Vec::new(), first: Vec::new(), last: None, every: 1, seen: 0 }
    }
}

impl Sample {
    /// The next row, of as many numbers as the others.
    pub fn see(&mut self, t: f64, row: &[f64]) {
        let room = (KEPT.min(NUMBERS / row.len().max(1)) & !1).max(2);
        match self.spans.last_mut() {
            Some(span) if !self.seen.is_multiple_of(self.every) => span.take([row, row]),
            _ => {
                if self.spans.len() >= room {
                    self.join_pairs();
                }
                self.spans.push(Span::of(t, row));
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

    fn join_pairs(&mut self) {
        if self.first.is_empty() {
            self.first = self.spans.clone();
        }
        let pairs = self.spans.chunks_exact(2).map(|pair| {
            let mut span = pair[0].clone();
            span.join(&pair[1]);
            span
        });
        self.spans = pairs.collect();
        self.every *= 2;
    }

    /// The first rows, none left out.
    pub(super) fn first(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let first = if self.first.is_empty() { &self.spans } else { &self.first };
        first.iter().map(|span| (span.t, &span.row[..]))
    }

    /// The first row of each span, and the last row.
    fn rows(&self) -> impl Iterator<Item = (f64, &[f64])> {
        self.spans.iter().map(|span| (span.t, &span.row[..])).chain(self.end())
    }

    /// The same with the extremes of each span within it: a line through them has every peak. The numbers of such a
    /// row are of different times; each column alone is that of the run.
    pub(super) fn columns(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let starts = self.spans.iter().skip(1).map(|span| span.t);
        let ends = starts.chain(self.last.iter().map(|(t, _)| *t));
        let spans = self.spans.iter().zip(ends).flat_map(|(span, end)| {
            let within = |part: usize| {
                let row = Some(&span.extremes[part][..]).filter(|row| !row.is_empty());
                row.map(|row| (span.t + (end - span.t) * (part + 1) as f64 / 3.0, row))
            };
            core::iter::once((span.t, &span.row[..])).chain(within(0)).chain(within(1))
        });
        spans.chain(self.end())
    }

    /// The last row, where it is not the first of a span.
    fn end(&self) -> Option<(f64, &[f64])> {
        let kept = self.spans.last().map(|span| span.t);
        self.last.as_ref().filter(|(t, _)| kept != Some(*t)).map(|(t, row)| (*t, &row[..]))
    }

    /// The number of the rows.
    pub fn seen(&self) -> usize {
        self.seen
    }
}

/// The rows of a run, with the names of their numbers.
#[derive(Clone, Debug)]
pub struct RowSample<'a> {
    schema: &'a Schema,
    sample: Sample,
}

impl<'a> RowSample<'a> {
    /// No rows yet.
    pub fn new(schema: &'a Schema) -> Self {
        RowSample { schema, sample: Sample::default() }
    }

    /// The next row.
    pub fn see(&mut self, t: f64, row: Row<'_>) {
        self.sample.see(t, row.numbers());
    }

    /// The first row, and the last.
    pub fn ends(&self) -> Option<[(f64, Row<'_>); 2]> {
        let first = self.sample.rows().next()?;
        let (t, last) = self.sample.last.as_ref()?;
        Some([first, (*t, &last[..])].map(|row| self.named(row)))
    }

    /// The first rows, none left out.
    pub(super) fn first(&self) -> impl Iterator<Item = (f64, Row<'_>)> {
        self.sample.first().map(|row| self.named(row))
    }

    /// Rows at regular distances, with the first and the last.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (f64, Row<'_>)> {
        self.sample.rows().map(|row| self.named(row))
    }

    /// See [`Sample::columns`].
    pub(super) fn columns(&self) -> impl Iterator<Item = (f64, Row<'_>)> {
        self.sample.columns().map(|row| self.named(row))
    }

    /// The schema of a row.
    pub(super) fn schema(&self) -> &'a Schema {
        self.schema
    }

    /// How many of the rows are kept.
    pub(super) fn kept(&self) -> usize {
        self.sample.spans.len()
    }

    /// The number of the rows.
    pub(super) fn seen(&self) -> usize {
        self.sample.seen
    }

    fn named<'s>(&'s self, (t, numbers): (f64, &'s [f64])) -> (f64, Row<'s>) {
        (t, self.schema.row(numbers))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_keep_every_peak_and_the_order_of_extremes() {
        let wave = |i: usize| match i {
            7001 => 5.0,
            7002 => -5.0,
            _ => (0.9 * i as f64).sin(),
        };
        let (mut rows, count) = (Sample::default(), 20_001);
        (0..count).for_each(|i| rows.see(i as f64, &[f64::NAN, wave(i)]));
        let line: Vec<_> = rows.columns().map(|(t, row)| (t, row[1])).collect();
        assert!(rows.spans.len() <= KEPT && rows.seen() == count);
        assert!(line.windows(2).all(|pair| pair[0].0 < pair[1].0), "times rise");
        let at = |x: f64| line.iter().position(|point| point.1 == x).unwrap();
        assert!(at(5.0) < at(-5.0), "the peaks are there, in their order");
        assert!((line[at(5.0)].0 - 7001.0).abs() < 32.0);
        assert_eq!(line[0], (0.0, wave(0)));
        assert_eq!(line[line.len() - 1], ((count - 1) as f64, wave(count - 1)));
        // Each span of sixteen rows has more than a swing.
        let highest = |span: &[(f64, f64)]| span.iter().map(|p| p.1).fold(f64::NAN, f64::max);
        assert!(line.chunks(3).take(1200).all(|span| highest(span) > 0.9));
        assert_eq!(rows.first().count(), KEPT);
    }

    #[test]
    fn what_is_no_number_is_no_extreme() {
        assert_eq!(extremes([f64::NAN, 1.0, 3.0, 2.0]), [1.0, 3.0]);
        assert_eq!(extremes([3.0, f64::NAN, f64::NAN, 2.0]), [3.0, 2.0]);
        assert!(extremes([f64::NAN; 4])[0].is_nan());
    }
}
