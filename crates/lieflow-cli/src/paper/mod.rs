//! The numerical section of the paper, computed again: its tables and figures beside what is printed,
//! what is wrong in the print, and what it does not have.

pub mod accuracy;
pub mod counts;
pub mod energy;
mod files;
pub mod findings;
mod news;
mod page;
pub mod printed;
pub mod rows;
pub mod trace;
mod verdicts;

use std::path::{Path, PathBuf};

use lieflow::TimeGrid;

use self::accuracy::{Accuracy, TESTS, accuracy};
use self::counts::{Count, table2};
use self::energy::{EnergyRun, energy_run};
use self::findings::{DriftOrder, Frames, Separatrix};
use self::rows::{EXAMPLE1, EXAMPLE2, EXAMPLE3, Row};
use self::trace::Trace;
use crate::cmd::CliError;

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
pub struct Effort {
    /// Random space frames.
    pub frames: usize,
    /// Rounds of timing.
    pub rounds: u32,
    /// Doublings of the number of steps beyond the paper's, for the times.
    pub finer: u32,
}

/// The seed of the random frames.
const SEED: u64 = 2003;

/// The energy of an example with the paper's step.
///
/// # Errors
/// None with the paper's bodies.
pub fn example(number: u8) -> Result<Vec<EnergyRun>, CliError> {
    let (body, dt) = match number {
        1 => (EXAMPLE1, 0.05),
        2 => (EXAMPLE2, 0.05),
        _ => (EXAMPLE3, 0.004),
    };
    let grid = TimeGrid::new([0.0, 400.0], dt)?;
    Row::all().map(|row| energy_run(&body, row, &grid)).collect()
}

/// Compute everything. `tick` gets the share of the work that is done and what is under way.
///
/// # Errors
/// None with the paper's bodies.
pub fn compute(effort: &Effort, mut tick: impl FnMut(f64, &str)) -> Result<Paper, CliError> {
    tick(0.0, "Tables 1 and 2");
    let trace = trace::both_layers(&EXAMPLE1, 0.05)?;
    let counts = table2()?;
    tick(0.02, "Table 3, Figures 3 and 4");
    let energy = [example(1)?, example(2)?, example(3)?];
    tick(0.3, "Table 4, Figure 5");
    let accuracy = [
        accuracy(&TESTS[0], effort.finer, effort.rounds)?,
        accuracy(&TESTS[1], effort.finer, effort.rounds)?,
    ];
    let frames =
        findings::frames(effort.frames, SEED, |done| tick(0.5 + 0.4 * done, "space frames"))?;
    tick(0.9, "drift and separatrix");
    let drift = findings::drift_orders()?;
    let separatrix = findings::separatrix()?;
    Ok(Paper { trace, counts, energy, accuracy, frames, drift, separatrix })
}

/// The page.
pub const PAPER_PAGE: &str = "paper.html";

impl Paper {
    /// Write the page, its figures as SVG and the data as CSV; the path of the page.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, CliError> {
        crate::output::make_folder(folder)?;
        for (name, text) in files::all(self) {
            crate::output::write_file(&folder.join(name), &text)?;
        }
        crate::report::write_page_as(folder, PAPER_PAGE, &page::page(self))
    }

    /// What a terminal is told.
    pub fn in_words(&self) -> String {
        let mut text = String::from("Table 3: printed, and computed again\n");
        let rows = printed::TABLE3.iter().filter_map(|(row, last, mean)| {
            let run = self.energy[2].iter().find(|run| run.row == *row)?;
            let ours = |x: f64| format!("{:.6e}", x.abs());
            let [a, b] = [ours(run.last()), ours(run.mean())];
            Some([row.name().into(), (*last).into(), a, (*mean).into(), b])
        });
        let header = ["method", "energy error", "ours", "mean", "ours"];
        text += &crate::output::table(header, rows);
        text += "\n";
        for verdict in verdicts::all(self) {
            text += &crate::output::wrap(&format!("{}: {}", verdict.claim, verdict.answer), " ");
        }
        text
    }
}
