//! Ctrl-C and SIGTERM: the first asks a command to stop, the second ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::error::CliError;

/// The exit code of a command that was interrupted.
pub(super) const INTERRUPTED: u8 = 130;

/// A flag that is raised by the first signal.
///
/// # Errors
/// The program cannot listen to signals.
pub(super) fn listen() -> Result<Arc<AtomicBool>, CliError> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // The second signal ends the program at once: it finds that the first was there.
        flag::register_conditional_shutdown(signal, INTERRUPTED.into(), Arc::clone(&stop))
            .and_then(|_| flag::register(signal, Arc::clone(&stop)))
            .map_err(CliError::Signals)?;
    }
    // A file that becomes larger than the limit of the shell is a failed write then, and not the end of the program.
    #[cfg(unix)]
    flag::register(signal_hook::consts::SIGXFSZ, Arc::default()).map_err(CliError::Signals)?;
    Ok(stop)
}

/// An error if the first signal came, for a command that keeps nothing.
///
/// # Errors
/// [`CliError::Stopped`].
pub(super) fn ended(stop: &AtomicBool) -> Result<(), CliError> {
    match stop.load(Ordering::Relaxed) {
        true => Err(CliError::Stopped { message: "interrupted".into(), code: INTERRUPTED }),
        false => Ok(()),
    }
}
