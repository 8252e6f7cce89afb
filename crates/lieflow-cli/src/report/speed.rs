//! Time against error.

use std::path::Path;

use super::choice::{Cost, drawn, fronts};
use super::{Looks, number};
use crate::error::CliError;
use crate::measure::{Candidate, Curve, Size};
use crate::output::write_file;
use lieflow::catalog::Family;
use lieflow_figures::csv::{self, in_full, optional};
use lieflow_figures::fields;
use lieflow_figures::number::seconds;
use lieflow_figures::{Cell, Chart, Column, Marker, Series, Table, tell_apart};
use lieflow_model::problem::Layer;

/// The colour and marker of a method: by its map, the same in every figure; `None` for a method
/// that has no map, whose place in the figure decides.
fn look(candidate: &Candidate) -> Option<usize> {
    let maps = ["exp", "cay", "ccsk123", "ccsk321", "ccsk", "", "pade22"];
    match candidate.method.map.as_deref() {
        Some(map) => maps.iter().position(|name| *name == map),
        None => {
            let info = candidate.method.info();
            info.is_ok_and(|info| info.family == Family::RungeKutta).then_some(5)
        }
    }
}

/// Speed against error of RKMK4 by its maps: one line a method, dashed on the general layer.
pub fn maps_chart(id: &str, title: &str, curves: &[Curve]) -> Option<Chart> {
    let series = curves.iter().enumerate().map(|(place, curve)| {
        let look = look(&curve.candidate).unwrap_or(place);
        Series::line(curve.label.clone(), look, drawn(curve, Cost::Time))
            .with_marker(Marker::cycle(look))
            .with_dash(curve.candidate.layer == Layer::General)
    });
    let mut series: Vec<Series> = series.collect();
    tell_apart(&mut series);
    Cost::Time.chart(id, title, series, curves.first()?.floor)
}

/// Speed against error of some of the curves, each as it looks everywhere. None if there is nothing to draw.
pub fn speed_chart(
    id: &str,
    title: &str,
    curves: &[Curve],
    looks: &Looks,
    shown: impl Fn(&Curve) -> bool,
) -> Option<Chart> {
    let shown = (0..curves.len()).filter(|&i| shown(&curves[i]));
    let series = shown.map(|i| looks.line(curves, i, drawn(&curves[i], Cost::Run)));
    Cost::Run.chart(id, title, series.collect(), curves.first()?.floor)
}

/// A measured order above this is more than the scatter of a fit.
const MORE: f64 = 0.25;

/// Why methods measure better than their order, where some do.
pub fn above_order(curves: &[Curve]) -> Option<&'static str> {
    let is_above = |c: &Curve| match (c.measured_order(), c.order) {
        (Some(measured), Some(order)) => measured > order as f64 + MORE,
        _ => false,
    };
    let remark = "An order above that of the method is one of long times: the errors of the energy, which have the order \
                  of the method, turn the phase by an error that has one more; where both are of one size, the \
                  measured order is between the two.";
    curves.iter().any(is_above).then_some(remark)
}

/// The table of times to these errors, with the fastest method for each error said in its caption.
pub fn speed_table(curves: &[Curve], errors: &[f64]) -> Table {
    let fastest = errors.iter().map(|&error| {
        let timed = curves.iter().filter_map(|c| Some((c.seconds_to(error)?, c)));
        match timed.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((time, curve)) => {
                format!("to {error:e} {} ({})", curve.label, seconds(time))
            }
            None => format!("to {error:e} none"),
        }
    });
    let remark = above_order(curves).map_or_else(String::new, |remark| format!(" {remark}"));
    let mut columns = Column::all(["Method"], ["Order", "Measured", "Time a step"]);
    columns.extend(errors.iter().map(|error| Column::number(format!("Time to {error:e}"))));
    let or_none = |x: Option<f64>, show: fn(f64) -> String| number(x.unwrap_or(f64::NAN), show);
    let rows = curves.iter().map(|curve| {
        let order = curve.order.map_or_else(|| "exact".into(), |p| p.to_string());
        let mut cells: Vec<Cell> = vec![
            curve.label.as_str().into(),
            number(curve.order.map_or(f64::INFINITY, |p| p as f64), |_| order),
            or_none(curve.measured_order(), |p| format!("{p:.2}")),
            or_none(curve.seconds_per_step(), seconds),
        ];
        cells.extend(errors.iter().map(|&error| or_none(curve.seconds_to(error), seconds)));
        cells
    });
    let fastest = fastest.collect::<Vec<_>>().join(", ");
    let caption = format!(
        "CPU time per unit of simulated time. Fastest: {fastest}. A dash: not \
         reached, or no clean range to measure an order in.{remark}"
    );
    Table::new(caption, columns, rows)
}

/// Write every run of the curves of each scene as CSV, with whether it is on the Pareto front of them.
///
/// # Errors
/// The file cannot be written.
pub fn write_speed_csv<'a>(
    path: &Path,
    scenes: impl IntoIterator<Item = (&'a str, &'a [Curve])>,
) -> Result<(), CliError> {
    let header = "scene,method,map,tableau,layer,adaptive,order,rtol,steps,rejected,h,evaluations,operations,\
         error,energy_error,casimir_error,group_residual,seconds_per_unit,pareto,failure";
    let mut rows = Vec::new();
    for (scene, curves) in scenes {
        for (curve, front) in curves.iter().zip(fronts(curves)) {
            let Candidate { method, layer, adaptive } = &curve.candidate;
            rows.extend(curve.points.iter().enumerate().map(|(j, p)| {
                let rtol = match p.size {
                    Size::Steps(_) => String::new(),
                    Size::Tolerance(rtol) => in_full(rtol),
                };
                fields![
                    scene,
                    method.name,
                    method.map.as_deref().unwrap_or_default(),
                    method.tableau.as_deref().unwrap_or_default(),
                    layer.name(),
                    adaptive,
                    optional(curve.order),
                    rtol,
                    p.steps,
                    p.rejected,
                    in_full(p.h),
                    optional(p.evaluations),
                    optional(p.operations),
                    in_full(p.error),
                    in_full(p.energy_error),
                    in_full(p.casimir_error),
                    in_full(p.group_residual),
                    in_full(p.seconds_per_unit),
                    front.contains(&j),
                    p.failure.as_deref().unwrap_or_default(),
                ]
            }));
        }
    }
    write_file(path, csv::table(header.split(','), rows))
}
