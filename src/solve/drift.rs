//! The drift of an invariant along a run.

use crate::problems::{Invariant, Law, explained_by_rounding};

/// The drift of an invariant: what its values did along a run.
///
/// [`Solve::watch_invariants`](super::Solve::watch_invariants) makes one for each invariant of a problem. For a value of your
/// own, show it the value of each row.
///
/// ```
/// use lieflow::problems::{Invariant, Law};
/// use lieflow::solve::Drift;
///
/// let mut drift = Drift::new(Invariant::new("energy", Law::by_the_flow(2)), 2.0, 2.0);
/// drift.see(2.5, 2.5);
/// drift.see(1.75, 1.75);
/// assert_eq!((drift.start, drift.largest, drift.at_end), (2.0, 0.5, -0.25));
/// assert!(drift.explained_by_rounding(100) < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Drift {
    /// The name of the invariant.
    pub name: String,
    /// The reason why the invariant is constant.
    pub law: Law,
    /// The value at the start.
    pub start: f64,
    /// The largest |value − start| at the points of the output and at the end. NaN if a value is NaN.
    pub largest: f64,
    /// value − start at the end.
    pub at_end: f64,
    /// The largest |value − start| at the ends of the steps that have points of the output within them. `None` if these were
    /// not seen.
    pub largest_at_ends_of_steps: Option<f64>,
    /// The largest size that rounding is relative to.
    pub size: f64,
}

impl Drift {
    /// Starts from the first value. `terms` is the size of its terms, for a law on [`Scale::Terms`](crate::problems::Scale::Terms).
    pub fn new(invariant: Invariant, value: f64, terms: f64) -> Self {
        let Invariant { name, law } = invariant;
        Drift {
            name,
            law,
            start: value,
            largest: 0.0,
            at_end: 0.0,
            largest_at_ends_of_steps: None,
            size: law.scale.size(value, terms),
        }
    }

    /// Sees the next value, with the size of its terms.
    pub fn see(&mut self, value: f64, terms: f64) {
        self.at_end = value - self.start;
        self.largest = larger(self.largest, self.at_end.abs());
        self.size = self.size.max(self.law.scale.size(value, terms));
    }

    /// Sees the value at the end of a step that has points of the output within it.
    pub fn see_end_of_step(&mut self, value: f64) {
        let before = self.largest_at_ends_of_steps.unwrap_or(0.0);
        self.largest_at_ends_of_steps = Some(larger(before, (value - self.start).abs()));
    }

    /// The drift that rounding explains after this number of steps.
    pub fn explained_by_rounding(&self, steps: u64) -> f64 {
        explained_by_rounding(steps, self.size)
    }
}

/// The larger of two numbers. NaN if one of them is NaN.
fn larger(before: f64, now: f64) -> f64 {
    if now > before || now.is_nan() { now } else { before }
}
