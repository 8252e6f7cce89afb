//! Which method to take: the fastest for each error, and the runs that nothing beats.

use super::{duration, scientific};
use crate::measure::{Curve, Reached, Size, WorkPoint, pareto};
use crate::page::{Column, Row, Table};
use crate::plot::{Axis, Chart, Marker, Point, Scale, Series};

/// The errors that advice is given for.
pub const ADVICE: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// A relative change of the energy that counts as rounding.
pub const KEPT: f64 = 1e-12;

/// The fastest method to an error.
#[derive(Clone, Copy, Debug)]
pub struct Choice<'a> {
    /// The error.
    pub error: f64,
    /// The method and where it reaches the error; none where no method does.
    pub best: Option<(&'a Curve, Reached)>,
}

/// The fastest to each error of those that pass.
pub fn choices(curves: &[Curve], pass: impl Fn(&Curve, &Reached) -> bool) -> Vec<Choice<'_>> {
    let best = |error: f64| {
        let reached = curves.iter().filter_map(|c| Some((c, c.reached(error)?)));
        let passing = reached.filter(|(curve, reached)| pass(curve, reached));
        passing.min_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds))
    };
    ADVICE.into_iter().map(|error| Choice { error, best: best(error) }).collect()
}

/// Does the energy stay where it is? Either the catalog says that the method keeps it, or keeps it in
/// bounds, or it was kept to rounding here.
pub fn keeps_energy(curve: &Curve, reached: &Reached) -> bool {
    curve.candidate.keeps_energy() || reached.energy_error <= KEPT
}

/// Method, step and time for each error.
pub fn choice_cells(choice: &Choice<'_>) -> [String; 5] {
    let error = format!("{:.0e}", choice.error);
    match &choice.best {
        None => [error, "none reaches it".into(), "–".into(), "–".into(), "–".into()],
        Some((curve, reached)) => [
            error,
            curve.candidate.label(),
            match reached.tolerance {
                None => format!("h = {}", scientific(reached.h)),
                Some(rtol) => format!("rtol = {}", scientific(rtol)),
            },
            duration(Some(reached.seconds)),
            scientific(reached.energy_error),
        ],
    }
}

/// The headings of [`choice_cells`].
pub const CHOICE_HEADER: [&str; 5] = ["error", "fastest", "its step", "its time", "energy error"];

/// The advice as a table.
pub fn choice_table(caption: &str, choices: &[Choice<'_>]) -> Table {
    let [error, fastest, step, time, energy] = CHOICE_HEADER;
    Table {
        caption: caption.into(),
        columns: vec![
            Column::text(error),
            Column::text(fastest),
            Column::number(step),
            Column::number(time),
            Column::number(energy),
        ],
        rows: choices.iter().map(|choice| Row::new(choice_cells(choice).into())).collect(),
    }
}

/// What a run costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// CPU time per unit of simulated time.
    Time,
    /// Evaluations of f.
    Evaluations,
}

impl Cost {
    fn of(self, point: &WorkPoint) -> Option<f64> {
        match self {
            Cost::Time => Some(point.seconds_per_unit).filter(|t| *t > 0.0),
            Cost::Evaluations => point.evaluations.map(|n| n as f64),
        }
    }
    fn axis(self) -> Axis {
        match self {
            Cost::Time => Axis::new("CPU time per unit of simulated time [s]", Scale::Log10),
            Cost::Evaluations => Axis::new("evaluations of f", Scale::Log10),
        }
    }
}

/// For each curve the places of its points on the Pareto front of error and time.
pub fn fronts(curves: &[Curve]) -> Vec<Vec<usize>> {
    let mut fronts = vec![Vec::new(); curves.len()];
    for (curve, point) in pareto(curves, |p| Cost::Time.of(p)) {
        fronts[curve].push(point);
    }
    fronts
}

/// The runs that nothing beats in both error and cost: the front, and the whole lines of the methods
/// on it.
pub fn front_chart(id: &str, title: &str, caption: &str, curves: &[Curve], cost: Cost) -> Chart {
    let front = pareto(curves, |p| cost.of(p));
    let mut on_front: Vec<usize> = front.iter().map(|(curve, _)| *curve).collect();
    on_front.sort_unstable();
    on_front.dedup();
    let place = |(i, j): (usize, usize)| {
        let point = &curves[i].points[j];
        let note = format!("{}, {}", curves[i].candidate.label(), size_of(point));
        Some(Point::new(point.error, cost.of(point)?).with_note(note))
    };
    let mut series: Vec<Series> = on_front
        .iter()
        .enumerate()
        .map(|(rank, &i)| Series {
            name: curves[i].candidate.label(),
            colour: rank,
            marker: Marker::cycle(rank),
            dash: false,
            points: (0..curves[i].points.len())
                .filter(|j| curves[i].points[*j].failure.is_none())
                .filter_map(|j| place((i, j)))
                .collect(),
            emphasised: false,
        })
        .collect();
    series.push(Series {
        name: "Pareto front".into(),
        colour: 6,
        marker: Marker::Circle,
        dash: true,
        points: front.iter().filter_map(|at| place(*at)).collect(),
        emphasised: true,
    });
    Chart {
        id: id.into(),
        title: title.into(),
        x: Axis::new("global error at the end", Scale::Log10),
        y: cost.axis(),
        series,
        caption: caption.into(),
    }
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
