//! `lieflow paper`: the numerical section of the paper, computed again.

use std::time::Instant;

use crate::args::PaperArgs;
use crate::error::CliError;
use crate::output::{self, Progress};
use crate::paper::{PaperExtent, compute};

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
    let path = paper.write(&args.out)?;
    output::print(&format!(
        "{}\nThe page: {}\nThe data: table1.csv to table4.csv and figure3.csv to figure5.csv beside it\n\
         ({:.1} s)\n",
        paper.in_words(),
        path.display(),
        clock.elapsed().as_secs_f64()
    ))
}
