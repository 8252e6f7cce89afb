//! `lieflow paper`: the numerical section of the paper, computed again.

use std::time::Instant;

use lieflow_paper::{PAPER_PAGE, Paper, PaperExtent, compute};

use crate::args::PaperArgs;
use crate::error::CliError;
use crate::output::{self, Progress};

/// Run the command.
///
/// # Errors
/// A report that cannot be written.
pub fn run(args: &PaperArgs) -> Result<(), CliError> {
    let clock = Instant::now();
    // A folder that cannot be written is better known before the work than after it.
    output::make_folder(&args.out)?;
    let effort = match args.quick {
        true => PaperExtent { frames: 30, rounds: 3, finer: 3 },
        false => PaperExtent { frames: 300, rounds: 7, finer: 4 },
    };
    let bar = Progress::new();
    let paper = compute(&effort, |done, what| bar.now(done, what))?;
    drop(bar);
    for (name, text) in paper.files() {
        output::write_file(&args.out.join(name), text)?;
    }
    let path = output::write_page(&args.out, PAPER_PAGE, &paper.page())?;
    output::print(&format!(
        "{}\nThe page: {}\nThe data: table1.csv to table4.csv and figure3.csv to figure5.csv beside it\n\
         ({:.1} s)\n",
        in_words(&paper),
        path.display(),
        clock.elapsed().as_secs_f64()
    ))
}

/// Table 3 and the verdicts on what the paper says, for the terminal.
fn in_words(paper: &Paper) -> String {
    let table = output::table(["method", "energy error", "ours", "mean", "ours"], paper.table3());
    let mut text = format!("Table 3: printed, and computed again\n{table}\n");
    for verdict in paper.verdicts() {
        text += &output::wrap(&format!("{}: {}", verdict.claim, verdict.answer), " ");
    }
    text
}
