//! Checks that users can run, in their own build.
//!
//! | function | what it checks |
//! |---|---|
//! | [`laws`] | the laws of a group with its coordinate maps, also of other crates |
//! | [`maps_agree`], [`steps_agree`] | the general code against the closed forms on so(3) |
//! | [`runs_agree`] | a method on a problem: orders, points within steps, events, tolerances, saved states |
//!
//! Differences of maps and steps are in units of ε·cond·size: 1 is the change by rounding the input once.

mod agreement;
mod laws;
mod runs;

pub use agreement::{AGREEMENT_BOUND, maps_agree, steps_agree};
pub use laws::{LAW_BOUND, laws};
pub use runs::{MethodOn, Record, Reference, Subject, Trial, TrialSteps, runs_agree};

/// The result of a check.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What was checked.
    pub name: String,
    /// On how many random inputs.
    pub cases: usize,
    /// The largest difference, in units of ε·cond·size.
    pub worst: f64,
    /// Where it was found.
    pub at: String,
    /// The largest that is allowed.
    pub bound: f64,
}

impl Finding {
    fn new(name: impl Into<String>, bound: f64) -> Self {
        Finding { name: name.into(), cases: 0, worst: 0.0, at: String::new(), bound }
    }

    /// A case with the difference `gap`, of a quantity of this `size` and condition number.
    fn see(&mut self, gap: f64, size: f64, cond: f64, at: impl FnOnce() -> String) {
        let units = if gap == 0.0 { 0.0 } else { gap / (f64::EPSILON * size * cond) };
        self.cases += 1;
        // `>` alone would pass over a NaN.
        if units > self.worst || units.is_nan() {
            (self.worst, self.at) = (units, at());
        }
    }

    /// A case that could not be evaluated.
    fn refuse(&mut self, at: impl FnOnce() -> String) {
        self.cases += 1;
        (self.worst, self.at) = (f64::INFINITY, at());
    }

    /// True if there was at least one case, and all are within the bound.
    pub fn holds(&self) -> bool {
        self.cases > 0 && self.worst <= self.bound
    }
}
