//! Energy over time, and the path of the momentum.

use super::speed::look;
use crate::measure::Candidate;
use lieflow_figures::plot::{Axis, Chart, Marker, Path, Point, Scale, Series, Sphere};

/// The energy and momentum of one run over the whole span.
#[derive(Clone, Debug)]
pub struct EnergyRun {
    /// The method.
    pub candidate: Candidate,
    /// t and E(t) − E(0).
    pub energy_error: Vec<(f64, f64)>,
    /// The body momentum at the first thousands of points.
    pub momentum: Vec<[f64; 3]>,
    /// Relative error of the state at the end.
    pub error: f64,
    /// ‖gᵀg − 𝟙‖ at the end.
    pub defect: f64,
}

impl EnergyRun {
    /// E(t) − E(0) at the end.
    pub fn energy_at_end(&self) -> f64 {
        self.energy_error.last().map_or(f64::NAN, |(_, error)| *error)
    }

    /// The largest |E(t) − E(0)|.
    pub fn energy_max(&self) -> f64 {
        self.energy_error.iter().map(|(_, error)| error.abs()).fold(0.0, f64::max)
    }

    /// The mean of |E(t) − E(0)|, over all points, the first among them.
    pub fn energy_mean(&self) -> f64 {
        let sum: f64 = self.energy_error.iter().map(|(_, error)| error.abs()).sum();
        sum / self.energy_error.len() as f64
    }
}

/// |E(t) − E(0)| against time, one line a method.
pub fn energy_chart(id: &str, title: &str, caption: &str, runs: &[EnergyRun]) -> Chart {
    let series = runs.iter().map(|run| Series {
        name: run.candidate.label(),
        colour: look(&run.candidate).unwrap_or_default(),
        marker: Marker::None,
        dash: false,
        // A point where the error is exactly zero, as at the start, has no place on a logarithm.
        points: run
            .energy_error
            .iter()
            .filter(|(_, error)| *error != 0.0)
            .map(|&(t, error)| Point::new(t, error.abs()))
            .collect(),
        emphasised: false,
    });
    Chart {
        id: id.into(),
        title: title.into(),
        x: Axis::new("time t", Scale::Linear),
        y: Axis::new("energy error |E(t) − E(0)|", Scale::Log10),
        series: series.collect(),
        caption: caption.into(),
    }
}

/// The path of the body momentum on its sphere, with the energy ellipsoid.
pub fn momentum_sphere(
    id: &str,
    title: &str,
    inertia: [f64; 3],
    energy: f64,
    path: &[[f64; 3]],
) -> Sphere {
    let radius = path.first().map_or(0.0, |m| m.iter().map(|x| x * x).sum::<f64>().sqrt());
    Sphere {
        id: id.into(),
        title: title.into(),
        radius,
        inertia,
        energy,
        paths: vec![Path { name: "body momentum m(t)".into(), colour: 0, points: path.to_vec() }],
        caption: "The momentum stays on the sphere |m| = const and on the ellipsoid of constant \
                  energy: it runs along their intersection."
            .into(),
        view: (35.0, 25.0),
    }
}
