//! The three experiments of section 5.2: bodies, steps, and over which span speed is set against error.

use lieflow::{RunError, TimeGrid};

use crate::energy::{EnergyRun, energy_run};
use crate::methods::{Body, PaperMethod};

/// An experiment. Its body and its step are those of a bundled scene; a test of the command line holds them equal.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// The name of the bundled scene.
    pub scene: &'static str,
    /// The body with its initial data.
    pub body: Body,
    /// The step of the energy runs, over t = 0 … 400.
    pub dt: f64,
    /// The span over which speed is set against error.
    pub window: [f64; 2],
    /// Numbers of steps over that span, each twice the one before.
    pub steps: &'static [u64],
}

/// J = diag(1, 2, 3), ω(0) = (0.2, 0, 1).
pub const EXAMPLE1: Experiment = Experiment {
    scene: "asymmetric-top",
    body: Body::new([1.0, 2.0, 3.0], [0.2, 0.0, 3.0]),
    dt: 0.05,
    window: [0.0, 20.0],
    steps: &[50, 100, 200, 400, 800, 1600, 3200, 6400, 12800],
};
/// J = diag(1, 1, 2), ω(0) = (0.2, 0, 1).
pub const EXAMPLE2: Experiment = Experiment {
    scene: "symmetric-top",
    body: Body::new([1.0, 1.0, 2.0], [0.2, 0.0, 2.0]),
    ..EXAMPLE1
};
/// J⁻¹ = diag(1, 4, 18): the paper prints it as J.
pub const EXAMPLE3: Experiment = Experiment {
    scene: "high-energy",
    body: Body::new([1.0, 0.25, 1.0 / 18.0], [0.0, 2.75, 2.75]),
    dt: 0.004,
    window: [0.0, 4.0],
    steps: &[250, 500, 1000, 2000, 4000, 8000, 16000, 32000],
};

/// All three.
pub const EXPERIMENTS: [Experiment; 3] = [EXAMPLE1, EXAMPLE2, EXAMPLE3];

/// The seed of all that is random: the same inputs on every machine.
pub const SEED: u64 = 2003;

impl Experiment {
    /// The end of the energy runs.
    pub const END: f64 = 400.0;

    /// The steps of the energy runs.
    ///
    /// # Errors
    /// A step that cannot be.
    pub fn grid(&self) -> Result<TimeGrid, RunError> {
        Ok(TimeGrid::new([0.0, Self::END], self.dt)?)
    }

    /// The energy along a run of each method.
    pub fn energy(
        &self,
        methods: impl IntoIterator<Item = PaperMethod>,
    ) -> Result<Vec<EnergyRun>, RunError> {
        let grid = self.grid()?;
        methods.into_iter().map(|method| energy_run(&self.body, method, &grid)).collect()
    }
}
