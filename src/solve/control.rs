//! Adaptive step size: tolerances, limits, and a PI controller.
//!
//! The next step is h·min(5, max(1/5, 0.9·r^(−0.7/k)·r₋^(0.4/k))), where r is the ratio of the error to
//! the tolerance, k the order of the estimate + 1, and r₋ the r of the step before (Hairer, Nørsett, Wanner II, IV.2;
//! Gustafsson's PI controller). The step after a rejected one does not grow.
//!
//! Where r stays at 0.9^(k/0.3), the step size does too. It is kept while both r and r₋ are between
//! 1/3 and 1.4 of that: with k = 5 the step size would grow by 17 % or shrink by 5 % at most. A larger error is not kept,
//! because it costs accuracy. A step of the same size needs no powers, and the processor begins it before it knows the
//! error of the step before ([`Streak`](crate::methods::Streak)).

use crate::error::Error;
use crate::tolerance::{Rule, Tolerance};

/// Tolerances and limits of a run with adaptive step size.
#[derive(Clone, Debug, PartialEq)]
pub struct StepControl {
    pub(super) tolerance: Tolerance,
    pub(super) first_step: Option<f64>,
    pub(super) min_step: f64,
    pub(super) max_step: f64,
    pub(super) max_steps: u64,
}

fn positive(arg: &'static str, x: f64) -> Result<f64, Error> {
    match x > 0.0 && x.is_finite() {
        true => Ok(x),
        false => Err(Error::out_of_range(arg, x, "a finite number > 0")),
    }
}

impl StepControl {
    /// The largest number of attempts in a run, unless [`max_steps`](Self::max_steps) sets another.
    pub const MAX_STEPS: u64 = 1_000_000;

    /// One rtol and one atol for all parts. The first step is by Hairer's rule. Step sizes have no limit except the
    /// rounding of t. A run has at most a million attempts.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tolerance that is negative or not finite, and when both are 0.
    pub fn new(rtol: f64, atol: f64) -> Result<Self, Error> {
        Ok(Tolerance::new(rtol, atol)?.into())
    }

    /// The tolerances.
    pub fn tolerance(&self) -> &Tolerance {
        &self.tolerance
    }

    /// Sets the rule of the tolerances.
    pub fn rule(self, rule: Rule) -> Self {
        StepControl { tolerance: self.tolerance.by(rule), ..self }
    }

    /// Sets the size of the first step, in either direction of time.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive.
    pub fn first_step(self, h: f64) -> Result<Self, Error> {
        Ok(StepControl { first_step: Some(positive("first_step", h)?), ..self })
    }

    /// Ends the run with an error below this size. Steps that are cut at the end of the span or at an output may be
    /// smaller.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive, and at most the largest step.
    pub fn min_step(self, h: f64) -> Result<Self, Error> {
        StepControl { min_step: positive("min_step", h)?, ..self }.limits("min_step", h)
    }

    /// Sets the largest step size.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive, and at least the smallest step.
    pub fn max_step(self, h: f64) -> Result<Self, Error> {
        StepControl { max_step: positive("max_step", h)?, ..self }.limits("max_step", h)
    }

    /// The largest step size; infinite if none was set.
    pub fn longest_step(&self) -> f64 {
        self.max_step
    }

    fn limits(self, arg: &'static str, h: f64) -> Result<Self, Error> {
        if self.min_step > self.max_step {
            let expected = format!("{} ≤ max_step = {}", self.min_step, self.max_step);
            return Err(Error::out_of_range(arg, h, format!("min_step = {expected}")));
        }
        Ok(self)
    }

    /// Ends the run with an error after this many attempts, accepted or not.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for 0.
    pub fn max_steps(self, n: u64) -> Result<Self, Error> {
        match n {
            0 => Err(Error::out_of_range("max_steps", 0.0, "at least 1")),
            _ => Ok(StepControl { max_steps: n, ..self }),
        }
    }
}

impl From<Tolerance> for StepControl {
    fn from(tolerance: Tolerance) -> Self {
        StepControl {
            tolerance,
            first_step: None,
            min_step: 0.0,
            max_step: f64::INFINITY,
            max_steps: Self::MAX_STEPS,
        }
    }
}

/// The PI controller: the next step size from r = error/tolerance of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Controller {
    /// The order of the estimate + 1.
    pub(super) k: f64,
    /// r of the last accepted step.
    pub(super) last: f64,
    /// True if the next step must not be larger than this one.
    pub(super) hold: bool,
    /// The least and the largest ratio at which the step size is kept.
    pub(super) kept: [f64; 2],
}

/// The largest factor by which a step grows; 1 over it is the smallest factor by which it shrinks.
const GROWTH_MAX: f64 = 5.0;
const SAFETY: f64 = 0.9;
/// The powers of r and r₋, times k.
const POWERS: [f64; 2] = [0.7, 0.4];
/// The step size is kept where the ratio is between these multiples of the one that keeps it.
const NEAR: [f64; 2] = [1.0 / 3.0, 1.4];

impl Controller {
    pub(super) fn new(error_order: usize) -> Self {
        let k = error_order as f64 + 1.0;
        let [power, memory] = POWERS;
        let goal = SAFETY.powf(k / (power - memory));
        Controller { k, last: 1.0, hold: false, kept: NEAR.map(|near| near * goal) }
    }

    /// The controller at a start: it knows no step.
    pub(super) fn anew(self) -> Self {
        Controller { last: 1.0, hold: false, ..self }
    }

    /// True if steps of any size have no error.
    pub(super) fn is_exact(&self) -> bool {
        self.k >= usize::MAX as f64
    }

    /// True if the ratio is near that at which the step size stays.
    fn is_near(&self, ratio: f64) -> bool {
        let [least, most] = self.kept;
        least <= ratio && ratio <= most
    }

    /// True if the step size is kept, unless the next ratio is far away.
    pub(super) fn keeps(&self) -> bool {
        self.is_near(self.last)
    }

    /// The factor of the next step after an accepted one.
    pub(super) fn accept(&mut self, ratio: f64) -> f64 {
        if self.is_near(self.last) && self.is_near(ratio) {
            self.last = ratio;
            self.hold = false;
            return 1.0;
        }
        let r = ratio.max(1e-10); // an error of 0 says "grow"
        // One exponential for both powers.
        let [power, memory] = POWERS;
        let factor = SAFETY * ((memory * self.last.ln() - power * r.ln()) / self.k).exp();
        let cap = if self.hold { 1.0 } else { GROWTH_MAX };
        self.last = r.max(1e-4);
        self.hold = false;
        factor.clamp(1.0 / GROWTH_MAX, cap)
    }

    /// The factor of the next attempt; `None` for a step that failed.
    pub(super) fn reject(&mut self, ratio: Option<f64>) -> f64 {
        self.hold = true;
        match ratio {
            Some(r) => (SAFETY * r.powf(-1.0 / self.k)).clamp(1.0 / GROWTH_MAX, SAFETY),
            None => 0.5,
        }
    }
}
