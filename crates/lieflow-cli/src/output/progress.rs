//! The bar of a command that takes its time.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on standard error with the time that is left; it goes away with its value.
#[derive(Debug)]
pub struct Progress(ProgressBar);

/// The parts of a bar.
const PARTS: f64 = 1000.0;

impl Progress {
    /// An empty bar.
    pub fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(PARTS as u64), ProgressDrawTarget::stderr());
        Progress(match ProgressStyle::with_template("{bar:40} {percent:>3}% {eta} left {msg}") {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        })
    }

    /// This share of the work is done.
    pub fn at(&self, share: f64) {
        self.0.set_position((PARTS * share) as u64);
    }

    /// This share of the work is done, and this is under way.
    pub fn now(&self, share: f64, what: &str) {
        self.at(share);
        self.0.set_message(what.to_owned());
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
