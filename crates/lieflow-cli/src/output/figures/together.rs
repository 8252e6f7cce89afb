//! Columns of runs that were written before, those of several runs in one figure.

use std::collections::BTreeMap;

use lieflow_figures::{Axis, Block};

use super::lines::CONSTANT;
use super::lines::{LINES, in_rows};
use super::sample::Sample;
use super::swings::{Curve, Drawn, constants, drawn};
use super::words;
use crate::output::TIME;

/// Figures that are open; the others are in a fold.
const OPEN: usize = 12;

/// The rows of a run that was written before.
#[derive(Clone, Debug)]
pub struct Written {
    /// What the run is called in a legend.
    pub name: String,
    /// The columns, without t.
    pub columns: Vec<String>,
    /// The units of t and of the columns, by their names, where they are known.
    pub units: BTreeMap<String, String>,
    /// The rows.
    pub rows: Sample,
}

/// The unit of t or of a column, where all of these runs have the same.
///
/// # Errors
/// Two of them that have different units.
pub fn unit_of<'a>(runs: &'a [Written], column: &str) -> Result<Option<&'a str>, [&'a Written; 2]> {
    let known = |run: &&Written| run.units.contains_key(column);
    let Some(first) = runs.iter().find(known) else { return Ok(None) };
    let unit = &first.units[column];
    match runs.iter().filter(known).find(|run| run.units[column] != *unit) {
        Some(other) => Err([first, other]),
        None => Ok(runs.iter().all(|run| known(&run)).then_some(unit)),
    }
}

impl Written {
    /// The points of a column.
    fn points<'a>(
        &self,
        column: &str,
        rows: impl Iterator<Item = (f64, &'a [f64])>,
    ) -> Vec<(f64, f64)> {
        match self.columns.iter().position(|name| name == column) {
            Some(place) => rows.map(|(t, row)| (t, row[place])).collect(),
            None => Vec::new(),
        }
    }

    fn curve(&self, name: String, column: &str) -> Curve {
        let whole = self.points(column, self.rows.columns());
        let sizes = whole.iter().map(|point| point.1.abs()).filter(|size| size.is_finite());
        let size = sizes.fold(0.0, f64::max);
        Curve { name, whole, first: self.points(column, self.rows.first()), size }
    }
}

/// Figures of columns: a column with a line for each run, or, of one run, columns of one name and one unit together. An
/// axis has a unit where [`unit_of`] the runs is one.
pub fn together(runs: &[Written], columns: &[String]) -> Vec<Block> {
    let groups: Vec<&[String]> = match runs {
        [_] => {
            let unit = |column: &String| unit_of(runs, column);
            let same = |a: &String, b: &String| {
                words::stem(a) == words::stem(b) && unit(a).ok() == unit(b).ok()
            };
            columns.chunk_by(same).flat_map(|group| group.chunks(LINES)).collect()
        }
        _ => columns.chunks(1).collect(),
    };
    let figure = |(number, group): (usize, &&[String])| {
        let named: Vec<String> = group.iter().map(|name| words::column(name)).collect();
        let title = named.join(", ");
        let mut curves: Vec<Curve> = match runs {
            [run] => {
                group.iter().zip(named).map(|(column, name)| run.curve(name, column)).collect()
            }
            _ => runs.iter().map(|run| run.curve(run.name.clone(), &group[0])).collect(),
        };
        // All are in one figure, so that the rounding of the largest is the rounding of each.
        let size = curves.iter().map(|curve| curve.size).fold(0.0, f64::max);
        curves.iter_mut().for_each(|curve| curve.size = size);
        if let Some(values) = constants(&mut curves, CONSTANT) {
            let names = curves.iter().map(|curve| &curve.name);
            let told = |(name, value)| format!("{name}: {value}");
            return Drawn::Constant(
                title,
                names.zip(values).map(told).collect::<Vec<_>>().join("; "),
            );
        }
        let rows = runs.iter().map(|run| run.rows.seen()).min().unwrap_or(0);
        let axes = [(TIME, TIME), (&title, &group[0])].map(|(name, column)| {
            let unit = unit_of(runs, column).ok().flatten().unwrap_or_default();
            Axis::linear(name).with_unit(unit.to_string())
        });
        drawn(&format!("plot-{}", number + 1), &title, axes, &curves, rows)
    };
    let mut figures: Vec<Drawn> = groups.iter().enumerate().map(figure).collect();
    let closed = figures.split_off(figures.len().min(OPEN));
    let mut blocks = in_rows(figures);
    if !closed.is_empty() {
        blocks.push(Block::fold(format!("{} more", closed.len()), in_rows(closed)));
    }
    blocks
}
