//! Everything that the page of the paper shows, computed.

use lieflow::RunError;

use crate::accuracy::{Accuracy, accuracy};
use crate::counts::{Count, table2};
use crate::energy::EnergyRun;
use crate::experiments::{EXAMPLE1, EXPERIMENTS, SEED};
use crate::findings::{self, DriftOrder, Frames, Separatrix};
use crate::methods::PaperMethod;
use crate::trace::{self, Trace};

/// Everything that the page shows.
#[derive(Debug)]
pub struct Paper {
    /// Table 1 as one step, closed and general.
    pub trace: [Trace; 2],
    /// Table 2.
    pub counts: Vec<Count>,
    /// The energy in examples 1, 2 and 3; the third is Table 3.
    pub energy: [Vec<EnergyRun>; 3],
    /// The two accuracy tests of Table 4.
    pub accuracy: [Vec<Accuracy>; 2],
    /// The drift in random frames.
    pub frames: Vec<Frames>,
    /// The drift over the step.
    pub drift: Vec<DriftOrder>,
    /// Near the separatrix.
    pub separatrix: Vec<Separatrix>,
}

/// How much is computed.
#[derive(Clone, Copy, Debug)]
pub struct PaperExtent {
    /// Random space frames.
    pub frames: usize,
    /// Rounds of timing.
    pub rounds: u32,
    /// Doublings of the number of steps beyond the paper's, for the times.
    pub finer: u32,
}

/// Compute everything. `tick` gets the share of the work that is done and what is under way.
///
/// # Errors
/// A body that cannot be, or a step that fails.
pub fn compute(effort: &PaperExtent, mut tick: impl FnMut(f64, &str)) -> Result<Paper, RunError> {
    tick(0.0, "Tables 1 and 2");
    let trace = trace::both_layers(&EXAMPLE1.body, EXAMPLE1.dt)?;
    let counts = table2()?;
    tick(0.02, "Table 3, Figures 3 and 4");
    let [first, second, third] =
        EXPERIMENTS.map(|experiment| experiment.energy(PaperMethod::all()));
    let energy = [first?, second?, third?];
    tick(0.3, "Table 4, Figure 5");
    let [first, second] = [0, 1].map(|test| accuracy(test, effort.finer, effort.rounds));
    let accuracy = [first?, second?];
    let frames =
        findings::frames(effort.frames, SEED, |done| tick(0.5 + 0.4 * done, "space frames"))?;
    tick(0.9, "drift and separatrix");
    let drift = findings::drift_orders()?;
    let separatrix = findings::separatrix()?;
    Ok(Paper { trace, counts, energy, accuracy, frames, drift, separatrix })
}
