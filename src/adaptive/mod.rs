//! Steps of their own size: an error estimate, a tolerance and a PI controller.
//!
//! With the estimate ‖e‖ of a step of length ℓ (both in 𝔤 or both in M, see
//! [`methods::Embedded`](crate::methods::Embedded)) the step is accepted when
//!
//! r = ‖e‖/(atol + rtol·ℓ) ≤ 1.
//!
//! So atol bounds the error of each step, relative to the point when it is measured in 𝔤, and rtol
//! the error for each unit of the way gone: the error of a run is about rtol times its length. The
//! next step is h·min(5, max(1/5, 0.9·r^(−0.7/k)·r₋^(0.4/k))), with k = the order of the estimate + 1
//! and r₋ the r of the step before (Hairer, Nørsett, Wanner II, IV.2; Gustafsson's PI controller). It
//! never grows right after a rejection.
//!
//! A step that fails (outside a chart, not finite) is rejected like one with too large an error, and
//! halved: no result of it is used. Until time has passed its end no step grows, so that a wall that
//! cannot be passed is closed in on with one rejection for each halving.

mod driver;

pub use driver::{AdaptiveError, AdaptiveStats, integrate_adaptive};

use crate::error::Error;
use crate::tolerance::Tolerance;

/// Tolerances and limits of a run that chooses its steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Adaptive {
    tolerance: Tolerance,
    first_step: Option<f64>,
    min_step: f64,
    max_step: f64,
    max_steps: u64,
}

fn positive(arg: &'static str, x: f64) -> Result<f64, Error> {
    match x > 0.0 && x.is_finite() {
        true => Ok(x),
        false => Err(Error::out_of_range(arg, x, "a finite number > 0")),
    }
}

impl Adaptive {
    /// With these tolerances, the first step by Hairer's rule, no limits on the size of steps but
    /// the rounding of t, and at most a million attempts.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tolerance that is negative or not finite, and when both are 0.
    pub fn new(rtol: f64, atol: f64) -> Result<Self, Error> {
        Ok(Adaptive::with(Tolerance::new(rtol, atol)?))
    }

    /// With these tolerances.
    pub fn with(tolerance: Tolerance) -> Self {
        let max_steps = 1_000_000;
        let (min_step, max_step) = (0.0, f64::INFINITY);
        Adaptive { tolerance, first_step: None, min_step, max_step, max_steps }
    }

    /// Try this size first, in either direction of time.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive.
    pub fn first_step(self, h: f64) -> Result<Self, Error> {
        Ok(Adaptive { first_step: Some(positive("first_step", h)?), ..self })
    }

    /// Give up below this size, though not at the end of the span or before an output.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive, and at most the largest step.
    pub fn min_step(self, h: f64) -> Result<Self, Error> {
        Adaptive { min_step: positive("min_step", h)?, ..self }.limits("min_step", h)
    }

    /// Never take a step larger than this.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive, and at least the smallest step.
    pub fn max_step(self, h: f64) -> Result<Self, Error> {
        Adaptive { max_step: positive("max_step", h)?, ..self }.limits("max_step", h)
    }

    fn limits(self, arg: &'static str, h: f64) -> Result<Self, Error> {
        if self.min_step > self.max_step {
            let expected = format!("{} ≤ max_step = {}", self.min_step, self.max_step);
            return Err(Error::out_of_range(arg, h, format!("min_step = {expected}")));
        }
        Ok(self)
    }

    /// Give up after this many attempts, accepted or not.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for 0.
    pub fn max_steps(self, n: u64) -> Result<Self, Error> {
        match n {
            0 => Err(Error::out_of_range("max_steps", 0.0, "at least 1")),
            _ => Ok(Adaptive { max_steps: n, ..self }),
        }
    }
}

/// The PI controller: what a step's r = error/tolerance says of the size of the next.
#[derive(Clone, Copy, Debug)]
struct Controller {
    /// The order of the estimate + 1.
    k: f64,
    /// r of the last accepted step.
    last: f64,
    /// May the next step not be larger than this one?
    hold: bool,
}

/// The most that a step grows, and the inverse of the most that it shrinks.
const GROWTH_MAX: f64 = 5.0;
const SAFETY: f64 = 0.9;

impl Controller {
    fn new(error_order: usize) -> Self {
        Controller { k: error_order as f64 + 1.0, last: 1.0, hold: false }
    }

    /// The factor of the next step after an accepted one.
    fn accept(&mut self, ratio: f64) -> f64 {
        let r = ratio.max(1e-10); // an error of 0 says "grow"
        let factor = SAFETY * r.powf(-0.7 / self.k) * self.last.powf(0.4 / self.k);
        let cap = if self.hold { 1.0 } else { GROWTH_MAX };
        self.last = r.max(1e-4);
        self.hold = false;
        factor.clamp(1.0 / GROWTH_MAX, cap)
    }

    /// The factor of the next attempt; `None` is a step that failed.
    fn reject(&mut self, ratio: Option<f64>) -> f64 {
        self.hold = true;
        match ratio {
            Some(r) => (SAFETY * r.powf(-1.0 / self.k)).clamp(1.0 / GROWTH_MAX, SAFETY),
            None => 0.5,
        }
    }
}
