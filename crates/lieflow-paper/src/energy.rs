//! The energy along a run: Table 3 and Figures 3 and 4.

use lieflow::groups::{LieGroup, So3};
use lieflow::problems::RigidBody;
use lieflow::{RunError, SaveAt, TimeGrid};
use lieflow_figures::{Axis, Chart, Series};
use nalgebra::Matrix3;

use crate::methods::{Body, PaperMethod};
use lieflow_timing::{Fit, cpu_seconds, larger};

/// The energy error of one run, sample by sample.
#[derive(Clone, Debug)]
pub struct EnergyRun {
    /// The method.
    pub method: PaperMethod,
    /// t and E(t) − E(0), at the start and after every step.
    pub error: Vec<(f64, f64)>,
    /// t and ‖gᵀg − 𝟙‖, how far the attitude is from a rotation, where it is in the state: some samples.
    pub defect: Vec<(f64, f64)>,
    /// The attitude at the end, where it is in the state.
    pub end: Option<Matrix3<f64>>,
    /// CPU time of a step.
    pub seconds_per_step: f64,
}

/// The defect is computed once in this many samples.
const EVERY: usize = 16;

impl EnergyRun {
    /// E(t) − E(0) at the end.
    pub fn last(&self) -> f64 {
        self.error.last().map_or(f64::NAN, |(_, error)| *error)
    }
    /// The mean of E − E(0) over all samples, the first among them.
    pub fn mean(&self) -> f64 {
        self.mean_of(|error| error)
    }
    /// The mean of |E − E(0)|.
    pub fn mean_size(&self) -> f64 {
        self.mean_of(f64::abs)
    }
    fn mean_of(&self, f: fn(f64) -> f64) -> f64 {
        self.error.iter().map(|(_, e)| f(*e)).sum::<f64>() / self.error.len() as f64
    }
    /// The largest |E − E(0)|; NaN if one of them is NaN, as in a run that failed.
    pub fn max(&self) -> f64 {
        self.error.iter().map(|(_, e)| e.abs()).fold(0.0, larger)
    }
    /// The slope of the line that fits E(t) best.
    pub fn drift(&self) -> f64 {
        self.error.iter().copied().collect::<Fit>().slope().unwrap_or(f64::NAN)
    }
    /// Its line in a chart of energies, over t in these units: the largest error up to each time. The error itself
    /// swings through 0, and on a logarithm the lines would cover each other.
    pub fn line(&self, unit: f64) -> Series {
        let largest = self.error.iter().scan(0.0, |largest: &mut f64, (t, error)| {
            *largest = larger(*largest, error.abs());
            Some((t * unit, *largest))
        });
        // An error of exactly zero, as at the start, has no place on a logarithm.
        self.method.line(largest.filter(|(_, error)| *error != 0.0))
    }
}

/// The largest |E − E(0)| up to each time, or up to what stands for it.
pub fn energy_chart(
    id: &str,
    title: &str,
    time: Axis,
    lines: impl IntoIterator<Item = Series>,
) -> Chart {
    Chart::new(id, title, [time, Axis::log("largest |E − E(0)| so far")], lines)
}

/// The energy of the body's momentum gᵀm_s along a run. A step that fails ends it.
///
/// # Errors
/// A body or a grid that cannot be.
pub fn energy_run(
    body: &Body,
    method: PaperMethod,
    grid: &TimeGrid,
) -> Result<EnergyRun, RunError> {
    let energy = RigidBody::<f64>::new(body.inertia)?;
    let start = energy.energy(&body.momentum_body());
    let mut error = Vec::with_capacity(grid.steps() as usize + 1);
    let (mut defect, mut end) = (Vec::new(), None);
    let clock = cpu_seconds();
    let outcome = method.run(body, grid, SaveAt::Every(1), &mut |t, m, g| {
        error.push((t, energy.energy(&m) - start));
        if let Some(g) = g.filter(|_| error.len().is_multiple_of(EVERY)) {
            defect.push((t, So3::new().defect(&g)));
        }
        end = g;
    });
    let seconds_per_step = (cpu_seconds() - clock) / grid.steps() as f64;
    match outcome {
        Ok(()) => {}
        Err(RunError::Setup(refused)) => return Err(refused.into()),
        // A run that stops has no number at its end.
        Err(_) => (error, end) = (vec![(0.0, f64::NAN)], None),
    }
    Ok(EnergyRun { method, error, defect, end, seconds_per_step })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_fails_has_no_largest_error() {
        let run = |error: &[f64]| EnergyRun {
            method: PaperMethod::Exp,
            error: error.iter().map(|error| (0.0, *error)).collect(),
            defect: Vec::new(),
            end: None,
            seconds_per_step: 1.0,
        };
        assert_eq!(run(&[0.0, -3.0, 2.0]).max(), 3.0);
        assert!(run(&[f64::NAN]).max().is_nan());
        assert!(run(&[0.0, f64::NAN, 1.0]).max().is_nan());
    }
}
