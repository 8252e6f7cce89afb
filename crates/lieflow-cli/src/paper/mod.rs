//! The numerical section of the paper, computed again, as one edition of which a command takes a part:
//! `lieflow paper` the tables and figures beside what is printed ([`Paper`]), what is wrong in the print,
//! and what it does not have; `lieflow` the three experiments with speed against error on both layers
//! ([`speed`]), and the accuracy of the maps ([`maps`]).

pub mod accuracy;
pub mod counts;
pub mod energy;
pub mod experiments;
mod files;
pub mod findings;
pub mod maps;
pub mod methods;
mod news;
mod page;
pub mod printed;
pub mod speed;
pub mod trace;
mod verdicts;

use std::path::{Path, PathBuf};

use self::accuracy::{Accuracy, accuracy};
use self::counts::{Count, table2};
use self::energy::EnergyRun;
use self::experiments::{EXAMPLE1, EXPERIMENTS, SEED};
use self::findings::{DriftOrder, Frames, Separatrix};
use self::methods::PaperMethod;
use self::trace::Trace;
use crate::error::CliError;
use crate::output;

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
pub fn compute(effort: &PaperExtent, mut tick: impl FnMut(f64, &str)) -> Result<Paper, CliError> {
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

/// The page.
pub const PAPER_PAGE: &str = "paper.html";

impl Paper {
    /// Write the page, its figures as SVG and the data as CSV; the path of the page.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, CliError> {
        let mut links = Vec::new();
        for (name, header, rows) in files::all(self) {
            output::write_csv(&folder.join(name), header.split(','), rows)?;
            links.push((name, name));
        }
        output::write_page(folder, PAPER_PAGE, &page::page(self).with_links(links))
    }

    /// What a terminal is told.
    pub fn in_words(&self) -> String {
        let rows = self.energy[2].iter().filter_map(|run| {
            let [last, mean] = printed::table3(run.method)?.map(String::from);
            let ours = |x: f64| format!("{:.6e}", x.abs());
            Some([run.method.name().into(), last, ours(run.last()), mean, ours(run.mean())])
        });
        let table = output::table(["method", "energy error", "ours", "mean", "ours"], rows);
        let mut text = format!("Table 3: printed, and computed again\n{table}\n");
        for verdict in verdicts::all(self) {
            text += &output::wrap(&format!("{}: {}", verdict.claim, verdict.answer), " ");
        }
        text
    }
}
