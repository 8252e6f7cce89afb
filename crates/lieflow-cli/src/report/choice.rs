//! Which method to take: the fastest for each error, and the runs that nothing beats.

use super::{Looks, number, size_of, step_of};
use crate::measure::{Curve, Reached, Reference, WorkPoint, pareto};
use lieflow_figures::number::{DASH, scientific, seconds};
use lieflow_figures::{Axis, Cell, Chart, Column, Marker, Point, Series, Table};

/// The errors that advice is always given for.
pub const ADVICE: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// A relative change of the energy that counts as rounding.
pub const KEPT: f64 = 1e-12;

/// The fastest method to an error.
#[derive(Clone, Copy, Debug)]
pub struct Choice<'a> {
    /// The error.
    pub error: f64,
    /// Can the reference tell such an error from none?
    pub judged: bool,
    /// The method, and where it reaches the error. None if no method does, or if that is not known.
    pub best: Option<(&'a Curve, Reached)>,
}

/// The fastest to each error of those that pass, as far as the reference can tell.
pub fn choices<'a>(
    curves: &'a [Curve],
    reference: &Reference,
    errors: &[f64],
    pass: impl Fn(&Curve, &Reached) -> bool,
) -> Vec<Choice<'a>> {
    let choice = |&error: &f64| {
        let judged = reference.floor() <= error;
        let reached = |curve: &'a Curve| {
            let reached = curve.reached_where(error, |reached| judged && pass(curve, reached))?;
            Some((curve, reached))
        };
        let passing = curves.iter().filter_map(reached);
        Choice { error, judged, best: passing.min_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds)) }
    };
    errors.iter().map(choice).collect()
}

/// Does the energy stay where it is? Either the catalog says that the method keeps it, or keeps it in
/// bounds, or it was kept to rounding here.
pub fn keeps_energy(curve: &Curve, reached: &Reached) -> bool {
    curve.candidate.keeps_energy() || reached.energy_error <= KEPT
}

/// Does it go in steps? The exact motion is there at once, and serves no other problem.
pub fn steps(curve: &Curve) -> bool {
    curve.order.is_some()
}

/// Method, step and time for each error.
fn choice_cells(choice: &Choice<'_>) -> [Cell; 5] {
    let error = Cell::number(choice.error, |error| format!("{error:e}"));
    match &choice.best {
        None => {
            let why = if choice.judged { "no method reaches it" } else { "cannot be seen" };
            [error, why.into(), DASH.into(), DASH.into(), DASH.into()]
        }
        Some((curve, reached)) => [
            error,
            curve.label.as_str().into(),
            match curve.order {
                Some(_) => step_of(reached).into(),
                None => DASH.into(),
            },
            Cell::number(reached.seconds, seconds),
            number(reached.energy_error, scientific),
        ],
    }
}

/// The advice as a table.
pub fn choice_table(caption: &str, choices: &[Choice<'_>]) -> Table {
    let columns = Column::all(["Error", "Fastest", "Its step"], ["Time per unit", "Energy error"]);
    Table::new(caption, columns, choices.iter().map(choice_cells))
}

/// What a run costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// CPU time per unit of simulated time, without rows of output.
    Time,
    /// CPU time of the whole run, without rows of output.
    Run,
    /// Evaluations of f.
    Evaluations,
    /// Operations on numbers.
    Operations,
}

impl Cost {
    pub(super) fn of(self, curve: &Curve, point: &WorkPoint) -> Option<f64> {
        match self {
            Cost::Time => Some(curve.seconds(point)).filter(|t| *t > 0.0),
            Cost::Run => Cost::Time.of(curve, point).map(|t| t * point.length()),
            Cost::Evaluations => point.evaluations.map(|n| n as f64),
            Cost::Operations => point.operations.map(|n| n as f64),
        }
    }
    fn axis(self) -> Axis {
        match self {
            Cost::Time => Axis::log("CPU time per unit of simulated time").of_durations(),
            Cost::Run => Axis::log("CPU time of the run").of_durations(),
            Cost::Evaluations => Axis::log("evaluations of f"),
            Cost::Operations => Axis::log("operations"),
        }
    }
    /// A chart of error and cost: lines that end at the floor, which is a line of its own. `None` if there is
    /// nothing to draw.
    pub(super) fn chart(
        self,
        id: &str,
        title: &str,
        mut series: Vec<Series>,
        floor: f64,
    ) -> Option<Chart> {
        series.retain(|line| !line.points.is_empty());
        let points = || series.iter().flat_map(|line| &line.points);
        let lowest = points().map(|p| p.y).reduce(f64::min)?;
        let highest = points().map(|p| p.y).fold(lowest, f64::max);
        if points().any(|p| p.x <= floor) {
            let ends = [(floor, lowest), (floor, highest)];
            series.push(
                Series::line("rounding: nothing to see beyond", 0, ends).in_ink().with_dash(true),
            );
        }
        let axes = [Axis::log("error at the end"), self.axis()];
        Some(Chart::new(id, title, axes, series))
    }
}

/// The front of the methods that go in steps; of the exact motion where there is no other.
fn front(curves: &[Curve], cost: Cost) -> Vec<(usize, usize)> {
    let any = curves.iter().any(steps);
    pareto(curves, |curve, point| cost.of(curve, point).filter(|_| !any || steps(curve)))
}

/// For each curve the places of its points on the Pareto front of error and time.
pub fn fronts(curves: &[Curve]) -> Vec<Vec<usize>> {
    let mut fronts = vec![Vec::new(); curves.len()];
    for (curve, point) in front(curves, Cost::Time) {
        fronts[curve].push(point);
    }
    fronts
}

/// A run with a larger error has nothing to do with the solution, and is not drawn.
const DRAWN: f64 = 1.0;

/// The runs of a curve that are drawn: those that ended and have a cost, down to the first at the floor.
pub(super) fn drawn(curve: &Curve, cost: Cost) -> Vec<Point> {
    let fit =
        |p: &&WorkPoint| p.failure.is_none() && p.error <= DRAWN && cost.of(curve, p).is_some();
    let mut points = Vec::new();
    for run in curve.points.iter().filter(fit) {
        points.extend(point(curve, run, cost));
        if run.error <= curve.floor {
            break;
        }
    }
    points
}

/// A run as a point of error and cost.
fn point(curve: &Curve, run: &WorkPoint, cost: Cost) -> Option<Point> {
    let note = format!("{}, {}", curve.label, size_of(run));
    Some(Point::new(curve.error(run), cost.of(curve, run)?).with_note(note))
}

/// The lines of some curves, and through the runs that no other method with steps beats in both error and
/// cost. `None` if there is nothing to draw.
pub fn front_chart(
    id: &str,
    title: &str,
    curves: &[Curve],
    cost: Cost,
    looks: &Looks,
    shown: impl Fn(usize) -> bool,
) -> Option<Chart> {
    let mut shown: Vec<usize> = (0..curves.len()).filter(|&i| shown(i)).collect();
    shown.sort_by_key(|&i| looks.rank(i));
    let line = |i: usize| looks.line(curves, i, drawn(&curves[i], cost));
    let mut series: Vec<Series> = shown.into_iter().map(line).collect();
    let front = front(curves, cost).into_iter();
    let front = front.filter_map(|(i, j)| point(&curves[i], &curves[i].points[j], cost));
    let front =
        Series::line("the best of all methods", 0, front).in_ink().with_marker(Marker::Circle);
    series.push(Series { emphasised: true, ..front.with_dash(true) });
    cost.chart(id, title, series, curves.iter().map(|curve| curve.floor).fold(0.0, f64::max))
}

/// Which curves have a run on the front of a cost?
pub fn on_front(curves: &[Curve], cost: Cost) -> Vec<bool> {
    let front = front(curves, cost);
    (0..curves.len()).map(|i| front.iter().any(|(curve, _)| *curve == i)).collect()
}
