//! The best methods of a comparison: their table, and what each looks like in every figure.

use super::{Found, number, ranking, step_of};
use crate::measure::Curve;
use lieflow_figures::number::{DASH, seconds, typed};
use lieflow_figures::{Cell, Column, LINE_COLOURS, Marker, Point, Row, Series, Table};

/// The number of methods that are shown by default.
const BEST: usize = 10;
/// The largest number of them that are of one kind.
const OF_A_KIND: usize = 3;

/// The methods of a comparison, the best first.
#[derive(Clone, Debug)]
pub struct Best<'a> {
    /// The errors that were asked for.
    errors: &'a [f64],
    /// The error by which they are ranked: the smallest of them that a method reaches.
    pub by: f64,
    /// Those that are shown.
    pub shown: Vec<Found<'a>>,
    /// The number of methods in the figure: the best, whatever the table shows.
    drawn_count: usize,
    /// How many methods reach the error.
    reaching: usize,
    /// Does the problem have an energy?
    energy: bool,
    /// Does a method leave M?
    leaving: bool,
    /// The look of each curve.
    pub looks: Looks,
}

impl<'a> Best<'a> {
    /// The best to the smallest of `errors` that is reached, or `all` that reach it.
    pub fn new(curves: &'a [Curve], errors: &'a [f64], all: bool) -> Self {
        let rankings = errors.iter().map(|&error| (error, ranking(curves, error)));
        let reached = rankings.filter(|(_, found)| !found.is_empty());
        let by = reached.min_by(|a, b| a.0.total_cmp(&b.0));
        let (by, ranked) = by.unwrap_or_else(|| (f64::NAN, Vec::new()));
        let mut drawn: Vec<Found<'a>> = Vec::new();
        for found in &ranked {
            let kind = found.0.candidate.kind();
            let alike = drawn.iter().filter(|(curve, _)| curve.candidate.kind() == kind).count();
            if alike < OF_A_KIND && drawn.len() < BEST {
                drawn.push(*found);
            }
        }
        let looks = Looks::new(curves, drawn.iter().chain(&ranked));
        let (reaching, drawn_count) = (ranked.len(), drawn.len());
        let shown = if all { ranked } else { drawn };
        let energy = curves.iter().flat_map(|c| &c.points).any(|p| !p.energy_error.is_nan());
        let leaving = curves.iter().any(Curve::leaves);
        Best { errors, by, shown, drawn_count, reaching, energy, leaving, looks }
    }

    /// The headings of [`rows`](Self::rows), and which of them are of numbers.
    pub fn columns(&self) -> Vec<Column> {
        let mut columns = Column::all(["Method", "Kind"], ["Order"]);
        for error in self.errors {
            columns.push(Column::text(format!("Step to {error:e}")));
            columns.push(Column::number(format!("Time to {error:e}")));
        }
        if self.energy {
            columns.push(Column::number("Energy error"));
        }
        if self.leaving {
            columns.push(Column::number("Off M"));
        }
        columns
    }

    /// A row for each method that is shown.
    pub fn rows(&self) -> Vec<Vec<Cell>> {
        let about = |error: f64| typed(error, 1);
        let rows = self.shown.iter().map(|(curve, by)| {
            let kind = curve.candidate.kind().map_or("", lieflow::catalog::Family::name);
            let order = match curve.order {
                Some(order) => number(order as f64, |_| order.to_string()),
                None => number(f64::INFINITY, |_| "exact".into()),
            };
            let mut cells: Vec<Cell> = vec![curve.label.as_str().into(), kind.into(), order];
            for &error in self.errors {
                match curve.run_to(error) {
                    None => cells.extend([DASH, DASH].map(Cell::from)),
                    Some(reached) => {
                        let step = match curve.order {
                            Some(_) => step_of(&reached),
                            None => DASH.into(),
                        };
                        cells.extend([step.into(), number(reached.run_seconds(), seconds)]);
                    }
                }
            }
            if self.energy {
                cells.push(number(by.energy_error, about));
            }
            if self.leaving {
                cells.push(number(by.off_manifold, about));
            }
            cells
        });
        rows.collect()
    }

    /// Is curve i in the figure of the best?
    pub fn draws(&self, i: usize) -> bool {
        self.looks.rank(i) < self.drawn_count
    }

    /// Are there methods that reach the error and are not shown?
    pub fn is_cut(&self) -> bool {
        self.shown.len() < self.reaching
    }

    /// The caption of the table.
    pub fn caption(&self, curves: usize) -> String {
        let (error, shown) = (self.by, self.shown.len());
        match self.reaching {
            0 => format!("None of {curves} methods reaches such an error."),
            1 => format!("One method of {curves} reaches an error of {error:e}."),
            n if n == shown => {
                format!("{n} of {curves} methods reach an error of {error:e}, the fastest first.")
            }
            n => format!(
                "The best {shown} of {n} methods that reach an error of {error:e}, at most {OF_A_KIND} of a kind, \
                 the fastest first."
            ),
        }
    }

    /// The table for a page.
    pub fn table(&self, caption: String) -> Table {
        let rows = self.rows().into_iter().enumerate();
        Table::new(
            caption,
            self.columns(),
            rows.map(|(i, row)| Row::new(row).with_emphasis(i == 0)),
        )
    }
}

/// The look of each curve, by its place in the ranking. It is the same in all figures of a page.
#[derive(Clone, Debug)]
pub struct Looks(Vec<usize>);

impl Looks {
    /// The places: first come these, in their order, then all others.
    fn new<'a>(curves: &'a [Curve], first: impl Iterator<Item = &'a Found<'a>>) -> Self {
        let mut order: Vec<&Curve> = Vec::new();
        for curve in first.map(|(curve, _)| *curve).chain(curves) {
            if !order.iter().any(|ranked| core::ptr::eq(*ranked, curve)) {
                order.push(curve);
            }
        }
        let rank = |curve| order.iter().position(|ranked| core::ptr::eq(*ranked, curve));
        Looks(curves.iter().map(|curve| rank(curve).unwrap_or_default()).collect())
    }

    /// The place of curve i in the ranking.
    pub fn rank(&self, i: usize) -> usize {
        self.0[i]
    }

    /// The line of curve i through these points, with its colour and its mark, dashed where it chooses its steps.
    pub fn line(&self, curves: &[Curve], i: usize, points: Vec<Point>) -> Series {
        let (curve, rank) = (&curves[i], self.0[i]);
        // After the last colour the first comes again, with another mark.
        Series::line(curve.label.clone(), rank, points)
            .with_marker(Marker::cycle(rank + rank / LINE_COLOURS))
            .with_dash(curve.candidate.adaptive)
    }
}
