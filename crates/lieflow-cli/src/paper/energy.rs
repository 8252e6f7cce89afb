//! The energy along a run: Table 3 and Figures 3 and 4.

use lieflow::problems::RigidBody;
use lieflow::{RunError, SaveAt, TimeGrid};

use super::rows::{Body, Row, Watch};
use crate::cmd::CliError;
use crate::measure::cpu_seconds;

/// The energy error of one run, sample by sample.
#[derive(Clone, Debug)]
pub struct EnergyRun {
    /// The method.
    pub row: Row,
    /// t and E(t) − E(0), at the start and after every step.
    pub error: Vec<(f64, f64)>,
    /// CPU time of a step.
    pub seconds_per_step: f64,
}

impl EnergyRun {
    /// E(t) − E(0) at the end.
    pub fn last(&self) -> f64 {
        self.error.last().map_or(f64::NAN, |(_, error)| *error)
    }
    /// The mean of E − E(0) over all samples, the first among them.
    pub fn mean(&self) -> f64 {
        self.error.iter().map(|(_, e)| e).sum::<f64>() / self.error.len() as f64
    }
    /// The largest |E − E(0)|.
    pub fn max(&self) -> f64 {
        self.error.iter().map(|(_, e)| e.abs()).fold(0.0, f64::max)
    }
    /// The slope of the line that fits E(t) best.
    pub fn drift(&self) -> f64 {
        let n = self.error.len() as f64;
        let sum = |f: &dyn Fn(&(f64, f64)) -> f64| self.error.iter().map(f).sum::<f64>();
        let (x, y) = (sum(&|p| p.0) / n, sum(&|p| p.1) / n);
        sum(&|p| (p.0 - x) * (p.1 - y)) / sum(&|p| (p.0 - x).powi(2))
    }
}

/// The energy of the body's momentum gᵀm_s along a run. A step that fails ends it.
///
/// # Errors
/// A body or a grid that cannot be.
pub fn energy_run(body: &Body, row: Row, grid: &TimeGrid) -> Result<EnergyRun, CliError> {
    let energy = RigidBody::<f64>::new(body.inertia)?;
    let start = energy.energy(&body.momentum_body());
    let mut error = Vec::with_capacity(grid.steps() as usize + 1);
    let see = |t: f64, m: nalgebra::Vector3<f64>, _: Option<nalgebra::Matrix3<f64>>| {
        error.push((t, energy.energy(&m) - start));
    };
    let clock = cpu_seconds();
    let outcome = row.visit(body, Watch { grid, save: SaveAt::Every(1), see })?;
    let seconds_per_step = (cpu_seconds() - clock) / grid.steps() as f64;
    match outcome {
        Ok(()) => Ok(EnergyRun { row, error, seconds_per_step }),
        Err(RunError::Setup(refused)) => Err(refused.into()),
        // A run that stops has no number at its end.
        Err(_) => Ok(EnergyRun { row, error: vec![(0.0, f64::NAN)], seconds_per_step }),
    }
}
