//! Time against error.

use super::choice::{Cost, drawn, size_of};
use super::{duration, order};
use crate::measure::{Candidate, Curve, Size};
use lieflow_figures::page::{Column, Row, Table};
use lieflow_figures::plot::format::seconds;
use lieflow_figures::plot::{Axis, Chart, Marker, Scale, Series, tell_apart};
use lieflow_model::model::Layer;

/// The errors for which tables give the time.
const ERRORS: [f64; 4] = super::ADVICE;

/// The colour and marker of a method: by its map, the same in every figure; `None` for a method
/// that has no map, whose place in the figure decides.
pub(super) fn look(candidate: &Candidate) -> Option<usize> {
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
    caption: &str,
    curves: impl IntoIterator<Item = &'a Curve>,
) -> Chart {
    let series = curves.into_iter().enumerate().map(|(place, curve)| {
        let candidate = &curve.candidate;
        let look = look(candidate).unwrap_or(place);
        let points =
            curve.points.iter().filter_map(|point| drawn(point, Cost::Time, || size_of(point)));
        Series {
            name: candidate.label(),
            colour: look,
            marker: Marker::cycle(look),
            dash: candidate.layer == Layer::General || candidate.adaptive,
            points: points.collect(),
            emphasised: false,
        }
    });
    let mut series: Vec<Series> = series.filter(|line| !line.points.is_empty()).collect();
    tell_apart(&mut series);
    Chart {
        id: id.into(),
        title: title.into(),
        x: Axis::new("global error at the end", Scale::Log10),
        y: Cost::Time.axis(),
        series,
        caption: caption.into(),
    }
}

/// The columns that [`SpeedRow`] fills.
pub fn tolerance_header() -> Vec<Column> {
    let mut columns = vec![
        Column::text("Method"),
        Column::number("Order"),
        Column::number("Measured"),
        Column::number("Time a step"),
    ];
    columns.extend(ERRORS.map(|error| Column::number(format!("Time to {error:.0e}"))));
    columns
}

/// A line of the table of times.
#[derive(Clone, Copy, Debug)]
pub struct SpeedRow<'a>(pub &'a Curve);

impl SpeedRow<'_> {
    /// Its cells.
    pub fn cells(&self) -> Vec<String> {
        let curve = self.0;
        let mut cells = vec![
            curve.candidate.label(),
            curve.order.map_or_else(|| "exact".into(), |p| p.to_string()),
            order(curve.measured_order()),
            duration(curve.seconds_per_step()),
        ];
        cells.extend(ERRORS.map(|error| duration(curve.seconds_to(error))));
        cells
    }
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
    Table {
        caption: format!(
            "CPU time per unit of simulated time. Fastest: {}. A dash: not reached.{remark}",
            fastest.join(", ")
        ),
        columns: tolerance_header(),
        rows: curves.iter().map(|curve| Row::new(SpeedRow(curve).cells())).collect(),
    }
}

/// Every run as CSV.
///
/// Each curve comes with the name of its scene and the places of its points on the Pareto front.
pub fn speed_csv<'a>(curves: impl IntoIterator<Item = (&'a str, &'a Curve, Vec<usize>)>) -> String {
    let mut text = String::from(
        "scene,method,map,tableau,layer,adaptive,order,rtol,steps,rejected,h,evaluations,operations,\
         error,energy_error,casimir_error,group_residual,seconds_per_unit,pareto,failure\n",
    );
    for (scene, curve, front) in curves {
        let Candidate { method, layer, adaptive } = &curve.candidate;
        let (map, tableau) = (method.map.as_deref(), method.tableau.as_deref());
        for (j, p) in curve.points.iter().enumerate() {
            let rtol = match p.size {
                Size::Steps(_) => String::new(),
                Size::Tolerance(rtol) => format!("{rtol:e}"),
            };
            text += &format!(
                "{scene},{},{},{},{},{adaptive},{},{rtol},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                method.name,
                map.unwrap_or_default(),
                tableau.unwrap_or_default(),
                layer.name(),
                curve.order.map_or(String::new(), |p| p.to_string()),
                p.steps,
                p.rejected,
                number(p.h),
                p.evaluations.map_or(String::new(), |n| n.to_string()),
                p.operations.map_or(String::new(), |n| n.to_string()),
                number(p.error),
                number(p.energy_error),
                number(p.casimir_error),
                number(p.group_residual),
                number(p.seconds_per_unit),
                front.contains(&j),
                quoted(p.failure.as_deref().unwrap_or_default()),
            );
        }
    }
    text
}

/// A number; nothing where there is none.
fn number(x: f64) -> String {
    if x.is_finite() { format!("{x:e}") } else { String::new() }
}

/// A CSV field in quotes, where it needs them.
fn quoted(field: &str) -> String {
    match field.contains([',', '"', '\n']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.into(),
    }
}
