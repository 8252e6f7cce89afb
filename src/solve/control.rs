//! Adaptive step size: tolerances, limits, and the choice of the next size.
//!
//! Let r be the ratio of the error to the tolerance of a step of size h, and k the order of the estimate + 1. The largest
//! size that the tolerance allows is about ĥ = h·r^(−1/k). The step size is kept while it is between 0.6ĥ and 0.85ĥ.
//! Otherwise the next step has 0.7ĥ. If that is more than h, it is h·(0.7ĥ/h)^0.7: where a step is so long that its error
//! grows faster than by its order, a size that grew at once would be rejected again and again. A step grows and shrinks by
//! a factor of 5 at most. A step with r > 1 is rejected. The next attempt has 0.7ĥ, at most 0.9h, and the step after it
//! does not grow.
//!
//! A step of the same size needs no power, and the processor begins it before it knows the error of the step before
//! ([`Streak`](crate::methods::Streak)). `docs/performance.md` has the measurements behind these numbers.

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

    /// Sets the tolerances. The rule is that of the new ones.
    pub fn with_tolerance(self, tolerance: Tolerance) -> Self {
        StepControl { tolerance, ..self }
    }

    /// Sets the rule of the tolerances.
    pub fn rule(self, rule: Rule) -> Self {
        StepControl { tolerance: self.tolerance.by(rule), ..self }
    }

    /// Sets the size of the first step, in either direction of time. It is shortened to the largest step and to the end of
    /// the span.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive.
    pub fn first_step(self, h: f64) -> Result<Self, Error> {
        Ok(StepControl { first_step: Some(Error::positive("first_step", h)?), ..self })
    }

    /// Ends the run with an error below this size. The last two steps to the end of the span, to a stop or to a jump may be
    /// smaller.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive, and at most the largest step.
    pub fn min_step(self, h: f64) -> Result<Self, Error> {
        StepControl { min_step: Error::positive("min_step", h)?, ..self }.limits("min_step", h)
    }

    /// Sets the largest step size.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive, and at least the smallest step.
    pub fn max_step(self, h: f64) -> Result<Self, Error> {
        StepControl { max_step: Error::positive("max_step", h)?, ..self }.limits("max_step", h)
    }

    /// The largest step size; infinite if none was set.
    pub fn longest_step(&self) -> f64 {
        self.max_step
    }

    fn limits(self, arg: &'static str, h: f64) -> Result<Self, Error> {
        if self.min_step > self.max_step {
            let expected = match arg {
                "min_step" => format!("at most max_step = {}", self.max_step),
                _ => format!("at least min_step = {}", self.min_step),
            };
            return Err(Error::out_of_range(arg, h, expected));
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

/// The next step size, from r = error/tolerance of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Controller {
    /// The order of the estimate + 1.
    k: f64,
    /// True if the next step must not be larger than this one.
    pub(super) hold: bool,
    /// The least and the largest ratio at which the step size is kept.
    pub(super) kept: [f64; 2],
}

/// The largest factor by which a step grows; 1 over it is the smallest factor by which it shrinks.
const GROWTH_MAX: f64 = 5.0;
/// A step grows by this power of the factor that its error allows.
const GROWTH_POWER: f64 = 0.7;
/// The size of the next step, in units of the largest size that the tolerance allows.
pub(super) const GOAL: f64 = 0.7;
/// The step size is kept between these, in the same units.
const KEPT: [f64; 2] = [0.6, 0.85];
/// The largest factor of an attempt after a rejected one.
const RETRY_MAX: f64 = 0.9;

impl Controller {
    pub(super) fn new(error_order: usize) -> Self {
        let k = error_order as f64 + 1.0;
        Controller { k, hold: false, kept: KEPT.map(|size| size.powf(k)) }
    }

    /// The controller at a start: it knows no step.
    pub(super) fn anew(self) -> Self {
        Controller { hold: false, ..self }
    }

    /// The order of the estimate + 1.
    pub(super) fn k(&self) -> f64 {
        self.k
    }

    /// True if steps of any size have no error.
    pub(super) fn is_exact(&self) -> bool {
        self.k >= usize::MAX as f64
    }

    /// The largest size that the tolerance allows, as a multiple of the size of a step.
    fn allowed(&self, ratio: f64) -> f64 {
        ratio.max(f64::MIN_POSITIVE).powf(-1.0 / self.k)
    }

    /// The factor of the next step after an accepted one.
    pub(super) fn accept(&mut self, ratio: f64) -> f64 {
        let most = if self.hold { 1.0 } else { GROWTH_MAX };
        self.hold = false;
        let [least_kept, most_kept] = self.kept;
        match least_kept <= ratio && ratio <= most_kept {
            true => 1.0,
            false => match GOAL * self.allowed(ratio) {
                factor if factor > 1.0 => factor.powf(GROWTH_POWER).min(most),
                factor => factor.max(1.0 / GROWTH_MAX),
            },
        }
    }

    /// The factor of the next attempt; `None` for a step that failed.
    pub(super) fn reject(&mut self, ratio: Option<f64>) -> f64 {
        self.hold = true;
        match ratio {
            Some(ratio) => (GOAL * self.allowed(ratio)).clamp(1.0 / GROWTH_MAX, RETRY_MAX),
            None => 0.5,
        }
    }

    /// The first step for a solution whose derivative of order k is about `rate` to the power of k.
    pub(super) fn first_step(&self, rate: f64, tolerance: f64) -> f64 {
        (0.01 * tolerance).powf(1.0 / self.k) / rate
    }
}
