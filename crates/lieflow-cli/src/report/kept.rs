//! What each method keeps, at about the same error of the state.

use super::{number, size_of};
use crate::measure::{Curve, WorkPoint};
use lieflow_figures::number::scientific;
use lieflow_figures::{Cell, Column, Table};

/// The error of the state at which methods are compared.
const AT: f64 = 1e-6;

/// The run whose error is nearest to [`AT`]. None if no run ended.
fn nearest(curve: &Curve) -> Option<&WorkPoint> {
    let off = |point: &WorkPoint| (point.error.max(1e-17) / AT).ln().abs();
    let ended = curve.points.iter().filter(|point| point.error.is_finite());
    ended.min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// An error of a run.
type ErrorOf = fn(&WorkPoint) -> f64;

/// The errors of the invariants beside that of the state, method by method. Only what the problem has is there.
pub fn kept_table(curves: &[Curve]) -> Table {
    let runs: Vec<(&Curve, &WorkPoint)> =
        curves.iter().filter_map(|curve| Some((curve, nearest(curve)?))).collect();
    let errors: [(&str, ErrorOf); 4] = [
        ("State", |run| run.error),
        ("Energy", |run| run.energy_error),
        ("Casimir", |run| run.casimir_error),
        ("Group", |run| run.group_residual),
    ];
    let known: Vec<_> = errors
        .into_iter()
        .filter(|(_, of)| runs.iter().any(|(_, run)| !of(run).is_nan()))
        .collect();
    let rows = runs.iter().map(|(curve, run)| {
        let texts = [Cell::from(curve.label.as_str()), size_of(run).into()];
        let numbers = known.iter().map(|(_, of)| number(of(run), scientific));
        texts.into_iter().chain(numbers).collect::<Vec<_>>()
    });
    let caption = format!(
        "The run of each method whose error is nearest to {AT:e}: the relative error of its state and of \
         what it should keep, at the end."
    );
    let mut columns = Column::all(["Method", "Run"], []);
    columns.extend(known.iter().map(|(name, _)| Column::number(*name)));
    Table::new(caption, columns, rows)
}
