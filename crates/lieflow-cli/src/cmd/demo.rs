//! The main job: speed against error in the paper's experiments, and the accuracy of the maps.

use std::time::Instant;

use lieflow_timing::machine;

use crate::args::DemoArgs;
use crate::error::CliError;
use crate::main_job::Speed;
use crate::output::{self, Progress};

/// Run the command.
///
/// # Errors
/// A report that cannot be written, or a check that does not hold.
pub fn run(args: &DemoArgs) -> Result<(), CliError> {
    let clock = Instant::now();
    // A folder that cannot be written is better known before the work than after it.
    output::make_folder(&args.out)?;
    output::print(&format!(
        "lieflow {}: three bodies that turn freely, on {}\n",
        env!("CARGO_PKG_VERSION"),
        machine()
    ))?;
    let bar = Progress::new();
    let speed = Speed::compute(args.quick, |done, what| bar.now(done, what))?;
    drop(bar);
    let [page, maps] = speed.write(&args.out)?;
    output::print(&format!(
        "{}\nThe page with its figures: {}\nHow accurate and fast each map is: {}\n({:.1} s)\n\n\
         What next?\n  \
         simulate a body         lieflow run wing-nut\n  \
         state your own equation lieflow scenes rotating-drive > mine.toml\n  \
         which method?           lieflow compare wing-nut --quick\n",
        speed.in_words(),
        page.display(),
        maps.display(),
        clock.elapsed().as_secs_f64()
    ))?;
    match speed.broken() {
        0 => Ok(()),
        broken => {
            Err(CliError::Failed(format!("{broken} checks are out of bounds; see `lieflow check`")))
        }
    }
}
