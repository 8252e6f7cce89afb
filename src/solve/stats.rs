//! What a run did, why it ended, and what takes its state back to M.

use core::fmt;

use crate::actions::Action;
use crate::error::{Error, Failure, StepError, debug_is_display};
use crate::groups::RESIDUAL_MAX;
use crate::methods::MapCounts;
use crate::problems::{PointOf, Problem};
use crate::scalar::Real;

/// What a run did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Stats {
    /// Steps of the run: those that were accepted.
    pub accepted: u64,
    /// Attempts rejected, for their error or because the step failed; 0 with steps of one size.
    pub rejected: u64,
    /// Points computed within a step, for output and events.
    pub points_within: u64,
    /// Evaluations of f, in rejected attempts and within steps too; `None` where the method does not know them.
    pub evaluations: Option<u64>,
    /// Ψ, dΨ⁻¹ and brackets in the attempts, not in points within a step; `None` where the method does not know
    /// them.
    pub maps: Option<MapCounts>,
    /// Iterations of implicit steps, by Newton's method or by a fixed point, in rejected attempts and within steps
    /// too; 0 for explicit methods.
    pub iterations: u64,
    /// The smallest accepted step, without its sign.
    pub smallest_step: f64,
    /// The largest accepted step, without its sign.
    pub largest_step: f64,
    /// How often the state was looked at, and taken back to M where it had left it
    /// ([`Action::restore_to`]).
    pub restored: u64,
    /// How often the state was left where it was, because it was too far off
    /// ([`RESIDUAL_MAX`](crate::groups::RESIDUAL_MAX)).
    pub not_restored: u64,
    /// A power of two above every residual that was seen there, ‖M⁻¹gᵀMg − 𝟙‖ on a group,
    /// ||x|²/|x₀|² − 1| of a vector under SO(3); 0 when none was. On a compact group it stays near 1e-14. On a
    /// non-compact one rounding level is ε‖g‖²: compare with that.
    pub residual: f64,
}

impl Stats {
    fn saw<S: Real>(&mut self, residual: S) {
        match residual.all_below(RESIDUAL_MAX) {
            true => self.restored += 1,
            false => self.not_restored += 1,
        }
        if !residual.all_below(self.residual) && residual.any_below(f64::INFINITY) {
            self.residual = self.residual.max(f64::EPSILON / 4.0);
            while !residual.all_below(self.residual) && self.residual < f64::MAX / 2.0 {
                self.residual *= 2.0;
            }
        }
    }
}

/// The driver calls [`Action::restore_to`] after every so many steps at most: rounding takes g off its
/// group by some ε a step, and a hundred steps stay below 2e-14 at a hundredth of the cost of one.
pub const RESTORE_EVERY: u64 = 100;
/// The number of steps in between at first, and the least there can be.
const RESTORE_EVERY_MIN: u64 = 8;

/// When to look at the state again: twice as many steps after a residual below 4e-15, half as many
/// after one above 1e-14. What drifts at an even rate stays below the second of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cadence {
    pub(super) every: u64,
    pub(super) next: u64,
}

impl Cadence {
    fn new() -> Self {
        Cadence { every: RESTORE_EVERY_MIN, next: RESTORE_EVERY_MIN }
    }
    fn saw<S: Real>(&mut self, residual: S) {
        if residual.all_below(4e-15) {
            self.every = (2 * self.every).min(RESTORE_EVERY);
        } else if !residual.all_below(1e-14) {
            self.every = (self.every / 2).max(RESTORE_EVERY_MIN);
        }
        self.next += self.every;
    }
}

/// What takes the state of a run back to M.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub(super) struct Mender<P: Problem> {
    work: <P::Action as Action<P::Group>>::Work,
    /// The start of the run: its orbit is where the state is taken back to.
    pub(super) from: PointOf<P>,
    pub(super) cadence: Cadence,
}

impl<P: Problem> Mender<P> {
    /// For a method that stays on M, or does not: that one is left as it is.
    pub(super) fn new(problem: &P, from: &PointOf<P>, stays_on_manifold: bool) -> Self {
        let mut cadence = Cadence::new();
        if !stays_on_manifold {
            cadence.next = u64::MAX;
        }
        Mender { work: problem.action().work(problem.group()), from: from.clone(), cadence }
    }
    /// The number of steps after which y is looked at again.
    #[inline]
    pub(super) fn next(&self) -> u64 {
        self.cadence.next
    }
    /// After so many steps: is it time to look at y?
    #[inline]
    pub(super) fn after(&mut self, steps: u64, problem: &P, y: &mut PointOf<P>, stats: &mut Stats) {
        if steps == self.cadence.next {
            let (action, group) = (problem.action(), problem.group());
            match action.restore_to(group, &self.from, y, &mut self.work) {
                Some(residual) => {
                    stats.saw(residual);
                    self.cadence.saw(residual);
                }
                None => self.cadence.next = u64::MAX,
            }
        }
    }
    /// Go on from another point: it must be on M, to 1e-6, and is taken there; its orbit is the new one.
    pub(super) fn move_to(&mut self, problem: &P, y: &mut PointOf<P>) -> Result<(), Error> {
        let (action, group) = (problem.action(), problem.group());
        action.check(group, y)?;
        if let Some(residual) = action.restore(group, y, &mut self.work)
            && !residual.all_below(1e-6)
        {
            return Err(Error::OutOfRange {
                arg: "y".into(),
                value: f64::NAN,
                expected: format!("a point of M; ‖M⁻¹gᵀMg − 𝟙‖ is {residual:?}"),
            });
        }
        action.assign(group, y, &mut self.from);
        Ok(())
    }
}

/// Why a run ended before its time.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The method does not fit the problem, the times or tolerances are not usable, or the first value
    /// of f is not in 𝔤 ([`LieAlgebra::check`](crate::LieAlgebra::check)).
    #[error(transparent)]
    Setup(#[from] Error),
    /// A step of a given size failed. The state is the last accepted one; what was observed stands.
    #[error(transparent)]
    Step(#[from] Failure),
    /// No step from t was small enough.
    #[error(
        "no step from t = {t} succeeded, down to h = {h} ({accepted} steps accepted, {rejected} rejected): {}",
        reason(.source)
    )]
    StepSizeUnderflow {
        /// The time of the last accepted point.
        t: f64,
        /// The last step that was tried, or would have been.
        h: f64,
        /// Steps accepted.
        accepted: u64,
        /// Attempts rejected.
        rejected: u64,
        /// What the last attempt failed with; `None` when its error was too large.
        source: Option<StepError>,
    },
    /// The attempts were used up.
    #[error(
        "{max_steps} attempts did not reach the end: t = {t}, last step h = {h} ({accepted} accepted, {rejected} rejected); raise max_steps or the tolerances"
    )]
    TooManySteps {
        /// The time of the last accepted point.
        t: f64,
        /// The last step that was tried.
        h: f64,
        /// Steps accepted.
        accepted: u64,
        /// Attempts rejected.
        rejected: u64,
        /// The limit.
        max_steps: u64,
    },
    /// The function of an event is not finite.
    #[error("event `{name}`: its value at t = {t} is {value}, expected a finite number")]
    Event {
        /// The event.
        name: String,
        /// Where.
        t: f64,
        /// The value.
        value: f64,
    },
    /// An event or an observer left a state that is not on M.
    #[error("the state that {by} set at t = {t} cannot be used: {source}")]
    Changed {
        /// Who changed the state.
        by: String,
        /// When.
        t: f64,
        /// What is wrong with it.
        source: Error,
    },
    /// A point within an accepted step could not be computed.
    #[error("no point within the step from t = {t} with h = {h}: {source}")]
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

fn reason(source: &Option<StepError>) -> String {
    match source {
        Some(error) => error.to_string(),
        None => "the error stays above the tolerance".into(),
    }
}

impl RunError {
    /// The steps that were accepted, where the error knows them.
    pub fn accepted(&self) -> Option<u64> {
        match self {
            RunError::Step(failure) => Some(failure.step),
            RunError::StepSizeUnderflow { accepted, .. }
            | RunError::TooManySteps { accepted, .. } => Some(*accepted),
            _ => None,
        }
    }
}
