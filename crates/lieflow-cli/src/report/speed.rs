//! Time against error.

use std::path::Path;

use super::choice::{Cost, drawn, fronts, size_of};
use crate::cmd::CliError;
use crate::measure::{Candidate, Curve, Size};
use crate::output::{fields, in_full, optional, write_csv};
use lieflow_figures::number::{or_dash, seconds};
use lieflow_figures::{Chart, Column, Marker, Series, Table, tell_apart};
use lieflow_model::model::Layer;

/// The errors for which tables give the time.
const ERRORS: [f64; 4] = super::ADVICE;

/// The colour and marker of a method: by its map, the same in every figure; `None` for a method
/// that has no map, whose place in the figure decides.
fn look(candidate: &Candidate) -> Option<usize> {
    let maps = ["exp", "cay", "ccsk123", "ccsk321", "ccsk", "", "pade22"];
    match candidate.method.map.as_deref() {
        Some(map) => maps.iter().position(|name| *name == map),
        None if candidate.method.name.starts_with("rk") => Some(5),
        None => None,
    }
}

/// The plot of time against error: one line a method, dashed on the general layer and where steps are
/// chosen by their error.
pub fn speed_chart<'a>(
    id: &str,
    title: &str,
    curves: impl IntoIterator<Item = &'a Curve>,
) -> Chart {
    let series = curves.into_iter().enumerate().map(|(place, curve)| {
        let candidate = &curve.candidate;
        let look = look(candidate).unwrap_or(place);
        let points =
            curve.points.iter().filter_map(|point| drawn(point, Cost::Time, || size_of(point)));
        Series::line(candidate.label(), look, points)
            .with_marker(Marker::cycle(look))
            .with_dash(candidate.layer == Layer::General || candidate.adaptive)
    });
    let mut series: Vec<Series> = series.filter(|line| !line.points.is_empty()).collect();
    tell_apart(&mut series);
    Cost::Time.chart(id, title, series)
}

/// The table of times to given errors, with the fastest method for each error said in its caption.
pub fn speed_table(curves: &[Curve]) -> Table {
    let fastest = ERRORS.map(|error| {
        let timed = curves.iter().filter_map(|c| Some((c.seconds_to(error)?, c)));
        match timed.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((time, curve)) => {
                format!("to {error:.0e} {} ({})", curve.candidate.label(), seconds(time))
            }
            None => format!("to {error:.0e} none"),
        }
    });
    let above = |c: &Curve| match (c.measured_order(), c.order) {
        (Some(measured), Some(order)) => measured > order as f64 + 0.5,
        _ => false,
    };
    let remark = match curves.iter().any(above) {
        true => {
            " A measured order one above the stated: over a long time the phase follows the drift of \
             the energy, which for exp, cay and RK4 has that order."
        }
        false => "",
    };
    let mut columns = Column::all(["Method"], ["Order", "Measured", "Time a step"]);
    columns.extend(ERRORS.map(|error| Column::number(format!("Time to {error:.0e}"))));
    let rows = curves.iter().map(|curve| {
        let mut cells = vec![
            curve.candidate.label(),
            curve.order.map_or_else(|| "exact".into(), |p| p.to_string()),
            or_dash(curve.measured_order(), |p| format!("{p:.2}")),
            or_dash(curve.seconds_per_step(), seconds),
        ];
        cells.extend(ERRORS.map(|error| or_dash(curve.seconds_to(error), seconds)));
        cells
    });
    let fastest = fastest.join(", ");
    let caption = format!(
        "CPU time per unit of simulated time. Fastest: {fastest}. A dash: not reached.{remark}"
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
    write_csv(path, header.split(','), rows)
}
