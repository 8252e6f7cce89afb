//! What each method keeps, at about the same error of the state.

use super::choice::size_of;
use crate::measure::{Curve, WorkPoint};
use lieflow_figures::number::scientific;
use lieflow_figures::{Column, Table};

/// The error of the state at which methods are compared.
const AT: f64 = 1e-6;

/// The run whose error is nearest to [`AT`]; none where no run ended.
fn nearest(curve: &Curve) -> Option<&WorkPoint> {
    let off = |point: &WorkPoint| (point.error.max(1e-17) / AT).ln().abs();
    let ended = curve.points.iter().filter(|point| point.error.is_finite());
    ended.min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// The errors of the invariants beside that of the state, method by method; a dash where the problem
/// has none.
pub fn kept_table(curves: &[Curve]) -> Table {
    let rows = curves.iter().filter_map(|curve| {
        let run = nearest(curve)?;
        let errors = [run.error, run.energy_error, run.casimir_error, run.group_residual];
        let texts = [curve.candidate.label(), size_of(run)];
        Some(texts.into_iter().chain(errors.map(scientific)).collect::<Vec<_>>())
    });
    let caption = format!(
        "The run of each method whose error is nearest to {AT:.0e}: the relative error of its state, \
         energy and Casimir at the end, and its distance from the group."
    );
    Table::new(
        caption,
        Column::all(["Method", "Run"], ["State", "Energy", "Casimir", "Group"]),
        rows,
    )
}
