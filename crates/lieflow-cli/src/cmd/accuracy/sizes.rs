//! The sizes of the parts of the state, which errors are relative to.

use lieflow_model::problem::GOLDEN;
use lieflow_model::schema::{Component, Observable, Row, length};

use super::{Check, FEW, OWN};
use crate::cmd::apart::{Size, parts_of};
use crate::measure::RETURNS;
use crate::output::RowSample;

/// At so many times between the rows such a part is looked at.
const BETWEEN: usize = 32;

/// The size of a part in these rows.
pub(super) fn size((observable, part): (&Observable, &Component), rows: &RowSample<'_>) -> Size {
    let norm = |row: Row<'_>| length(&row[observable][part.columns.clone()]);
    let mut sizes: Vec<f64> = rows.rows().map(|(_, row)| norm(row)).collect();
    let ends = rows.ends().map_or([0.0; 2], |ends| ends.map(|(_, row)| norm(row)));
    sizes.sort_by(f64::total_cmp);
    // What comes to rest has no smaller digits than those of its motion.
    let most = sizes.iter().copied().filter(|size| size.is_finite()).fold(0.0, f64::max);
    let middle = sizes.get(sizes.len() / 2).map_or(0.0, |middle| middle.max(f64::EPSILON * most));
    Size { largest: ends[0].max(ends[1]).max(middle), middle }
}

impl Check<'_> {
    /// Takes the size of a part between the rows, where it returns to nearly 0 at each of them, as once in a period: its
    /// size there is rounding.
    pub(super) fn see_sizes_between(&mut self) {
        let whole = self.run.sizes.iter().map(|size| size.largest).fold(1.0, f64::max);
        let is_small = |size: &Size| size.largest < RETURNS * whole;
        if self.own.steps > FEW || !self.run.sizes.iter().any(is_small) {
            return;
        }
        let [t0, end] = self.run.t_span;
        let part = |i: usize| (i as f64 + GOLDEN) / BETWEEN as f64;
        let times: Vec<f64> = (0..BETWEEN).map(|i| t0 + part(i) * (end - t0)).collect();
        let Ok((rows, _)) = self.rows_at(OWN, &times) else { return };
        let schema = self.watch.model.schema();
        let there = parts_of(self.watch).map(|(observable, part)| {
            let norms =
                rows.iter().map(|row| length(&schema.row(row)[observable][part.columns.clone()]));
            norms.fold(0.0, f64::max)
        });
        let there: Vec<f64> = there.collect();
        for (size, there) in self.run.sizes.iter_mut().zip(there) {
            if there > size.largest / RETURNS {
                *size = Size { largest: there, middle: there };
            }
        }
    }
}
