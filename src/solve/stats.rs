//! The statistics of a run, and its errors.

use core::fmt;

use crate::error::{Error, Failure, Plain, StepError, debug_is_display};
use crate::groups::RESIDUAL_MAX;
use crate::methods::MapCounts;
use crate::scalar::Real;

/// The statistics of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Stats {
    /// Accepted steps.
    pub accepted: u64,
    /// Rejected attempts: the error was too large, or the step failed. 0 with a fixed step size.
    pub rejected: u64,
    /// Points computed within a step, for output and events.
    pub points_within: u64,
    /// Searches of one event in one step that may have missed zeros, because the function of the event is much faster than
    /// the state, or hardly passes 0. Long steps are searched, and those that may have two zeros. Shorter steps help
    /// ([`max_step`](crate::Solve::max_step)).
    pub unsure_steps: u64,
    /// Evaluations of f, also in rejected attempts and within steps; `None` if the method does not count them.
    pub evaluations: Option<u64>,
    /// Evaluations of Ψ, dΨ⁻¹ and brackets in the attempts, but not in points within a step; `None` if the method does
    /// not count them.
    pub maps: Option<MapCounts>,
    /// Iterations of implicit steps, Newton's or fixed-point, also in rejected attempts and within steps; 0 for explicit
    /// methods.
    pub iterations: u64,
    /// The smallest accepted step, without its sign.
    pub smallest_step: f64,
    /// The largest accepted step, without its sign.
    pub largest_step: f64,
    /// The end and the size of the smallest step that followed a rejected attempt. There the motion is the hardest, as
    /// within a short pulse of f. Another run that passes over it can be made to see it by a stop at this end.
    pub after_rejection: Option<[f64; 2]>,
    /// How often the state was checked, and corrected to M if it had left it ([`Action::restore_to`](crate::Action::restore_to)).
    pub restored: u64,
    /// How often the state was too far from M to be corrected ([`RESIDUAL_MAX`](crate::groups::RESIDUAL_MAX)).
    pub not_restored: u64,
    /// A power of two above all residuals found in these checks and at the end of the run; 0 if there was none. For a
    /// method that does not stay on M it is that of the end.
    ///
    /// The residual is ‖M⁻¹gᵀMg − 𝟙‖ on a group, and ||x|²/|x₀|² − 1| for a vector under SO(3). On a compact group it
    /// stays near 1e-14. On a non-compact group compare it with the rounding level ε‖g‖².
    pub residual: f64,
}

impl Stats {
    /// The warning about zeros of events that may be missed ([`unsure_steps`](Self::unsure_steps)), if there is a reason.
    /// `limit` is the name of the setting that limits the step size, `ended_by` the event that ended the run.
    pub fn unsure_in_words(&self, limit: &str, ended_by: Option<&str>) -> Option<String> {
        let ended = ended_by.map_or(String::new(), |name| {
            format!(" The event {name} may have ended the run at a wrong zero.")
        });
        (self.unsure_steps > 0).then(|| {
            format!(
                "zeros of events may be missed in {} of the steps: the function of an event is much faster than the \
                 state, or hardly passes 0.{ended} Take shorter steps (dt, or {limit})",
                self.unsure_steps
            )
        })
    }

    pub(super) fn saw<S: Real>(&mut self, residual: S) {
        match residual.all_below(RESIDUAL_MAX) {
            true => self.restored += 1,
            false => self.not_restored += 1,
        }
        self.saw_residual(residual);
    }

    pub(super) fn saw_residual<S: Real>(&mut self, residual: S) {
        if !residual.all_below(self.residual) && residual.any_below(f64::INFINITY) {
            self.residual = power_of_two_above(residual);
        }
    }
}

/// A power of two above a number that is not negative, and at least ε/4. For numbers that are not f64.
pub(super) fn power_of_two_above<S: Real>(x: S) -> f64 {
    power_of_two_from(f64::EPSILON / 4.0, x)
}

/// A power of two above a number that is not negative, of any size.
pub(super) fn power_of_two_of_rate<S: Real>(x: S) -> f64 {
    let mut least = f64::EPSILON / 4.0;
    while x.all_below(f64::EPSILON * least) && least > f64::MIN_POSITIVE {
        least *= f64::EPSILON;
    }
    power_of_two_from(least, x)
}

fn power_of_two_from<S: Real>(least: f64, x: S) -> f64 {
    if !x.any_below(f64::INFINITY) {
        return f64::INFINITY;
    }
    let mut bound = least;
    while !x.all_below(bound) && bound < f64::MAX / 2.0 {
        bound *= 2.0;
    }
    bound
}

/// The largest number of steps between two calls of [`Action::restore_to`](crate::Action::restore_to).
///
/// Rounding moves g off its group by some ε a step. After a hundred steps this is still below 2e-14, and the correction
/// costs a hundredth of a step.
pub const RESTORE_EVERY: u64 = 100;
/// The first number of steps between two corrections, and the smallest one.
const RESTORE_EVERY_MIN: u64 = 8;

/// The number of steps between two checks of the state.
///
/// It is doubled after a residual below 4e-15, and halved after one above 1e-14. A state that drifts evenly stays below
/// 1e-14.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cadence {
    pub(super) every: u64,
    pub(super) next: u64,
}

impl Cadence {
    /// For methods that do not stay on M there is no check.
    pub(super) fn new(stays_on_manifold: bool) -> Self {
        let next = if stays_on_manifold { RESTORE_EVERY_MIN } else { u64::MAX };
        Cadence { every: RESTORE_EVERY_MIN, next }
    }
    pub(super) fn saw<S: Real>(&mut self, residual: S) {
        if residual.all_below(4e-15) {
            self.every = (2 * self.every).min(RESTORE_EVERY);
        } else if !residual.all_below(1e-14) {
            self.every = (self.every / 2).max(RESTORE_EVERY_MIN);
        }
        self.next += self.every;
    }
}

/// Why a run failed.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The method does not fit the problem, the times or tolerances are not usable, or the first value
    /// of f is not in 𝔤 ([`LieAlgebra::check`](crate::LieAlgebra::check)).
    #[error(transparent)]
    Setup(#[from] Error),
    /// A step of a fixed size failed. The state is the last accepted one, and earlier output is valid.
    #[error(transparent)]
    Step(#[from] Failure),
    /// No step from t was small enough.
    #[error(
        "no step from t = {} succeeded, down to h = {} ({accepted} steps accepted, {rejected} rejected): {}",
        Plain(.t),
        Plain(.h),
        reason(.source, .t + .h == *.t)
    )]
    StepSizeUnderflow {
        /// The time of the last accepted point.
        t: f64,
        /// The last step size that was tried, or the next one.
        h: f64,
        /// Steps accepted.
        accepted: u64,
        /// Attempts rejected.
        rejected: u64,
        /// The failure of the last attempt; `None` if its error was too large.
        source: Option<StepError>,
    },
    /// The attempts were used up.
    #[error(
        "{max_steps} attempt{} did not reach the end: t = {}, next step h = {} ({accepted} accepted, {rejected} rejected{}){}",
        if *max_steps == 1 { "" } else { "s" },
        Plain(.t),
        Plain(.h),
        // The limit is that of a call, and these are the numbers of the run.
        if accepted + rejected > *max_steps { " since the start of the run" } else { "" },
        still_to_take(*left, *h, *by_error)
    )]
    TooManySteps {
        /// The time of the last accepted point.
        t: f64,
        /// The time from there to the end of the run.
        left: f64,
        /// The size of the next step.
        h: f64,
        /// Steps accepted.
        accepted: u64,
        /// Attempts rejected.
        rejected: u64,
        /// The limit.
        max_steps: u64,
        /// True if the steps were chosen by their error.
        by_error: bool,
    },
    /// The function of an event is not finite.
    #[error("event `{name}`: its value at t = {} is {value}, expected a finite number", Plain(.t))]
    Event {
        /// The event.
        name: String,
        /// Where.
        t: f64,
        /// The value.
        value: f64,
    },
    /// An event or an observer left a state that is not on M.
    #[error("the state that {by} set at t = {} cannot be used: {source}", Plain(.t))]
    Changed {
        /// Who changed the state.
        by: String,
        /// When.
        t: f64,
        /// What is wrong with it.
        source: Error,
    },
    /// The run left M, because f is not in 𝔤: f or the state say so.
    ///
    /// It is checked where the storage of f can hold more than 𝔤 ([`LieAlgebra::off_algebra`](crate::LieAlgebra::off_algebra)):
    /// at each correction ([`RESTORE_EVERY`]), by one evaluation of f, and at the end.
    #[error("the run leaves M before t = {}: {source}", Plain(.t))]
    LeftManifold {
        /// The time of the last accepted point.
        t: f64,
        /// What is not in its group or algebra.
        source: Error,
    },
    /// A point within an accepted step could not be computed.
    #[error("no point within the step from t = {} with h = {}: {source}", Plain(.t), Plain(.h))]
    Within {
        /// The start of the step.
        t: f64,
        /// The size of the step.
        h: f64,
        /// Why.
        source: StepError,
    },
}
debug_is_display!(RunError);

/// The number of steps of this size to the end, with one digit, and what to do.
fn still_to_take(left: f64, h: f64, by_error: bool) -> String {
    if left == f64::INFINITY {
        return "; the span has no end, and no event ended the run: give t_span an end, or look at the function and the \
                direction of the event"
            .into();
    }
    let steps = (left / h.abs()).ceil();
    let about: f64 = format!("{steps:.0e}").parse().unwrap_or(steps);
    let rest = match steps < 1e15 {
        true => format!(", the rest is about {about} steps of this size"),
        false => String::new(),
    };
    let or = if by_error { "the tolerances" } else { "the step size" };
    format!("{rest}; raise max_steps or {or}")
}

fn reason(source: &Option<StepError>, is_lost: bool) -> String {
    match source {
        Some(error) => error.to_string(),
        None if is_lost => "t + h is t after rounding; f may have a jump or a pole near t, or a part is 0 and its atol is 0".into(),
        None => "the error stays above the tolerance; the tolerance or a least step size may be too strict for f, or a part is 0 \
                 and its atol is 0"
            .into(),
    }
}

impl RunError {
    /// The number of accepted steps, if the error has it.
    pub fn accepted(&self) -> Option<u64> {
        match self {
            RunError::Step(failure) => Some(failure.step),
            RunError::StepSizeUnderflow { accepted, .. }
            | RunError::TooManySteps { accepted, .. } => Some(*accepted),
            _ => None,
        }
    }
}
