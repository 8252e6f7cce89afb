//! Which method to take: the fastest for each error, and the runs that nothing beats.

use crate::measure::{Curve, Reached, Reference, Size, WorkPoint, pareto};
use lieflow_figures::number::{DASH, scientific, seconds};
use lieflow_figures::{Axis, Chart, Column, Marker, Point, Series, Table, tell_apart};

/// The errors that advice is given for.
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
    /// The method and where it reaches the error; none where no method does, or nobody can tell.
    pub best: Option<(&'a Curve, Reached)>,
}

/// The fastest to each error of those that pass, as far as the reference can tell.
pub fn choices<'a>(
    curves: &'a [Curve],
    reference: &Reference,
    pass: impl Fn(&Curve, &Reached) -> bool,
) -> Vec<Choice<'a>> {
    let choice = |error: f64| {
        let judged = reference.error().is_none_or(|of_reference| of_reference <= error);
        let reached = |curve: &'a Curve| {
            let reached = curve.reached_where(error, |reached| judged && pass(curve, reached))?;
            Some((curve, reached))
        };
        let passing = curves.iter().filter_map(reached);
        Choice { error, judged, best: passing.min_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds)) }
    };
    ADVICE.into_iter().map(choice).collect()
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
pub fn choice_cells(choice: &Choice<'_>) -> [String; 5] {
    let error = format!("{:.0e}", choice.error);
    match &choice.best {
        None => {
            let why = match choice.judged {
                true => "none reaches it",
                false => "below the error of the reference",
            };
            [error, why.into(), DASH.into(), DASH.into(), DASH.into()]
        }
        Some((curve, reached)) => [
            error,
            curve.candidate.label(),
            match reached.tolerance {
                None => format!("h = {}", scientific(reached.h)),
                Some(rtol) => format!("rtol = {}", scientific(rtol)),
            },
            seconds(reached.seconds),
            scientific(reached.energy_error),
        ],
    }
}

/// The headings of [`choice_cells`].
pub const CHOICE_HEADER: [&str; 5] = ["error", "fastest", "its step", "its time", "energy error"];

/// The advice as a table.
pub fn choice_table(caption: &str, choices: &[Choice<'_>]) -> Table {
    let [error, fastest, step, time, energy] = CHOICE_HEADER;
    let columns = Column::all([error, fastest], [step, time, energy]);
    Table::new(caption, columns, choices.iter().map(choice_cells))
}

/// What a run costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// CPU time per unit of simulated time.
    Time,
    /// Evaluations of f.
    Evaluations,
    /// Operations on numbers.
    Operations,
}

impl Cost {
    fn of(self, point: &WorkPoint) -> Option<f64> {
        match self {
            Cost::Time => Some(point.seconds_per_unit).filter(|t| *t > 0.0),
            Cost::Evaluations => point.evaluations.map(|n| n as f64),
            Cost::Operations => point.operations.map(|n| n as f64),
        }
    }
    fn axis(self) -> Axis {
        match self {
            Cost::Time => Axis::log("CPU time per unit of simulated time [s]"),
            Cost::Evaluations => Axis::log("evaluations of f"),
            Cost::Operations => Axis::log("operations"),
        }
    }
    /// A chart of error and cost.
    pub(super) fn chart(self, id: &str, title: &str, series: Vec<Series>) -> Chart {
        Chart::new(id, title, [Axis::log("global error at the end"), self.axis()], series)
    }
}

/// The front of the methods that go in steps; of the exact motion where there is no other.
fn front(curves: &[Curve], cost: Cost) -> Vec<(usize, usize)> {
    let any = curves.iter().any(steps);
    pareto(curves, |curve, point| cost.of(point).filter(|_| !any || steps(curve)))
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

/// A run as a point of error and cost; none where it failed, has no such cost or is too far off.
pub(super) fn drawn(point: &WorkPoint, cost: Cost, note: impl FnOnce() -> String) -> Option<Point> {
    let fit = point.failure.is_none() && point.error <= DRAWN;
    let cost = cost.of(point).filter(|_| fit)?;
    Some(Point::new(point.error, cost).with_note(note()))
}

/// The runs that no other method with steps beats in both error and cost: the front, and the whole
/// lines of the methods on it, beside that of the exact motion.
pub fn front_chart(id: &str, title: &str, curves: &[Curve], cost: Cost) -> Chart {
    let front = front(curves, cost);
    let exact = (0..curves.len()).filter(|&i| !steps(&curves[i]));
    let mut shown: Vec<usize> = front.iter().map(|(curve, _)| *curve).chain(exact).collect();
    shown.sort_unstable();
    shown.dedup();
    let place = |(i, j): (usize, usize)| {
        let point = &curves[i].points[j];
        drawn(point, cost, || format!("{}, {}", curves[i].candidate.label(), size_of(point)))
    };
    let of_curve = |i: usize| (0..curves[i].points.len()).filter_map(move |j| place((i, j)));
    let lines = shown.iter().map(|&i| (i, of_curve(i).collect::<Vec<_>>()));
    let lines = lines.filter(|(_, points)| !points.is_empty()).enumerate();
    let mut series: Vec<Series> = lines
        .map(|(rank, (i, points))| {
            Series::line(curves[i].candidate.label(), rank, points).with_marker(Marker::cycle(rank))
        })
        .collect();
    tell_apart(&mut series);
    let front = Series::line("Pareto front", 6, front.iter().filter_map(|at| place(*at)));
    series.push(Series { emphasised: true, ..front.with_marker(Marker::Circle).with_dash(true) });
    cost.chart(id, title, series)
}

/// The size of a run's steps, for a reader.
pub(super) fn size_of(point: &WorkPoint) -> String {
    match point.size {
        Size::Steps(steps) => {
            format!("h = {}, {steps} steps", scientific(point.h))
        }
        Size::Tolerance(rtol) => {
            format!("rtol = {rtol:e}, {} steps, {} rejected", point.steps, point.rejected)
        }
    }
}
