//! The bar of a command that takes its time.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on standard error with the time that is left, where that is a terminal; it goes away with its value.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    start: Instant,
    /// The time of the last update by [`often`](Progress::often).
    updated: Option<Instant>,
    hidden: bool,
}

/// The parts of a bar.
const PARTS: f64 = 1000.0;
/// Updates sooner than this after the last are dropped.
const PAUSE: Duration = Duration::from_millis(50);
/// A bar that waits is not shown before.
const WAIT: Duration = Duration::from_secs(1);

impl Progress {
    /// An empty bar.
    pub fn new() -> Self {
        Self::on(ProgressDrawTarget::stderr())
    }

    /// An empty bar that is shown after a second.
    pub fn after_a_second() -> Self {
        let mut progress = Self::on(ProgressDrawTarget::hidden());
        progress.hidden = true;
        progress
    }

    fn on(target: ProgressDrawTarget) -> Self {
        let bar = ProgressBar::with_draw_target(Some(PARTS as u64), target);
        let bar = match ProgressStyle::with_template("{bar:40} {percent:>3}% {eta} left {msg}") {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        };
        Progress { bar, start: Instant::now(), updated: None, hidden: false }
    }

    /// This share of the work is done.
    pub fn at(&self, share: f64) {
        self.bar.set_position((PARTS * share) as u64);
    }

    /// This share of the work is done, and this is under way.
    pub fn now(&self, share: f64, what: &str) {
        self.at(share);
        self.bar.set_message(what.to_owned());
    }

    /// Like [`now`](Self::now); most calls are dropped.
    pub fn often(&mut self, share: f64, what: impl FnOnce() -> String) {
        let now = Instant::now();
        if self.updated.is_some_and(|last| now - last < PAUSE) {
            return;
        }
        self.now(share, &what());
        if self.updated.is_none() {
            // Steps before a resume do not count for the time left.
            self.bar.reset_eta();
        }
        self.updated = Some(now);
        if self.hidden && now - self.start >= WAIT {
            self.hidden = false;
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
