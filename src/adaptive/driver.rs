//! The loop: propose, step, accept or reject; output times and the end are hit exactly.

use super::{Adaptive, Controller};
use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::integrate::{Mender, SaveAt, Stats, TimeGrid, check_field};
use crate::methods::{Embedded, Step};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;

/// What a run did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AdaptiveStats {
    /// Steps accepted.
    pub accepted: u64,
    /// Attempts rejected, for their error or because the step failed.
    pub rejected: u64,
    /// Shorter steps taken to output times within a step.
    pub side_steps: u64,
    /// Evaluations of f ([`Embedded::evaluations_with_error`] for each attempt, also for one that
    /// failed early, and those of the choice of the first step); `None` where the method does not know
    /// them.
    pub evaluations: Option<u64>,
    /// The smallest accepted step, without its sign.
    pub smallest_step: f64,
    /// The largest accepted step, without its sign.
    pub largest_step: f64,
    /// How often the state was taken back to M ([`Stats::restored`]).
    pub restored: u64,
    /// How often the state was too far off M for that ([`Stats::not_restored`]).
    pub not_restored: u64,
    /// A power of two above every residual that was seen there ([`Stats::residual`]).
    pub residual: f64,
}

/// Why a run ended before its time. The state handed to the driver is the last accepted one, that of
/// time t; what was observed stands.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AdaptiveError {
    /// The method does not fit the problem, the times are not usable, or the first value of f is not
    /// in 𝔤.
    #[error(transparent)]
    Setup(#[from] Error),
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
}

fn reason(source: &Option<StepError>) -> String {
    match source {
        Some(error) => error.to_string(),
        None => "the error stays above the tolerance".into(),
    }
}

/// The number of rejections in a row that ends a run.
const REJECTIONS_MAX: u32 = 60;

/// Integrate `problem` over `t_span` from y with steps that meet the tolerances of `control`, showing
/// (t, y) to `observe` where `save` says; [`SaveAt::Every`] counts accepted steps, and a time of
/// [`SaveAt::Times`] within a step is reached by a shorter step of the same method from its start. On
/// return y is the state at the end, or the last accepted one. Time runs backward when t₁ < t₀. The
/// state is taken back to M from time to time, as by [`integrate`](crate::integrate()).
///
/// Memory is allocated before the first step only.
///
/// ```
/// use lieflow::adaptive::{Adaptive, integrate_adaptive};
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::DOPRI5};
/// use lieflow::problems::RigidBody;
/// use lieflow::SaveAt;
/// use nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let mut m = Vector3::new(0.2, 0.0, 3.0);
/// let start = body.energy(&m);
/// let (method, control) = (Rkmk::new(DOPRI5, Exp), Adaptive::new(1e-9, 1e-12)?);
/// let stats =
///     integrate_adaptive(&body, &method, [0.0, 10.0], &control, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((body.energy(&m) - start).abs() < 1e-7);
/// assert!(stats.rejected <= stats.accepted / 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AdaptiveError`]: before anything is observed for what is wrong with the arguments, later when
/// no step succeeds within 60 attempts or above the smallest step, or attempts run out.
pub fn integrate_adaptive<P: Problem, Me: Embedded<P>>(
    problem: &P,
    method: &Me,
    t_span: [f64; 2],
    control: &Adaptive,
    save: &SaveAt,
    y: &mut PointOf<P>,
    mut observe: impl FnMut(f64, &PointOf<P>),
) -> Result<AdaptiveStats, AdaptiveError>
where
    ScalarOf<P>: Into<f64>,
{
    let empty = t_span[0] == t_span[1];
    save.check(&TimeGrid::with_steps(t_span, if empty { 0 } else { 1 })?)?;
    problem.action().check(problem.group(), y)?;
    let mut controller = Controller::new(method.error_order(problem)?);
    let mut run = Run {
        problem,
        method,
        control,
        t: t_span[0],
        t1: t_span[1],
        work: method.work(problem, y)?,
        next: y.clone(),
        stats: AdaptiveStats {
            evaluations: Some(0),
            smallest_step: f64::INFINITY,
            ..Default::default()
        },
    };
    let mut aside = y.clone();
    let mut times = match save {
        SaveAt::Times(times) => times.as_slice(),
        _ => &[],
    };
    times = times.strip_prefix(&[run.t]).unwrap_or(times);
    observe(run.t, y);
    if empty {
        run.stats.smallest_step = 0.0;
        return Ok(run.stats);
    }
    check_field(problem, run.t, y)?;
    let mut mender = Mender::new(problem, y, method.stays_on_manifold());
    let mut mended = Stats::default();
    let forward = run.t1 > run.t;
    let mut h = match control.first_step {
        Some(h) => h,
        None => run.first_step(&controller, y),
    }
    .max(control.min_step);
    let mut in_a_row = 0;
    // The end of the last step that failed, until it is passed.
    let mut wall = None;
    while run.t != run.t1 {
        let (end, size) = run.propose(h);
        if run.stats.accepted + run.stats.rejected >= control.max_steps {
            return Err(run.too_many(size));
        }
        if end == run.t {
            return Err(run.underflow(h, None));
        }
        let mut outcome = run.attempt(end, y);
        if let Ok(ratio) = outcome
            && ratio <= 1.0
        {
            // Output times within this step. Where one cannot be reached the step is rejected; what
            // was shown before it stands, for it was reached.
            while let [time, rest @ ..] = times
                && (if forward { *time < end } else { *time > end })
            {
                if let Err(error) = run.side_step(*time, y, &mut aside) {
                    outcome = Err(error);
                    break;
                }
                observe(*time, &aside);
                times = rest;
            }
        }
        match outcome {
            Ok(ratio) if ratio <= 1.0 => {
                core::mem::swap(y, &mut run.next);
                run.accepted(end, size);
                mender.after(run.stats.accepted, problem, y, &mut mended);
                wall = wall.filter(|wall| if forward { end < *wall } else { end > *wall });
                controller.hold |= wall.is_some();
                h = (size * controller.accept(ratio)).max(control.min_step);
                in_a_row = 0;
                let shown = match save {
                    SaveAt::Every(every) => run.stats.accepted.is_multiple_of(*every),
                    SaveAt::Times(_) => times.first() == Some(&end),
                    SaveAt::Ends => false,
                };
                if shown {
                    times = times.get(1..).unwrap_or_default();
                }
                if shown || run.t == run.t1 {
                    observe(run.t, y);
                }
            }
            rejected => {
                run.stats.rejected += 1;
                in_a_row += 1;
                if rejected.is_err() {
                    wall = Some(end);
                }
                h = size * controller.reject(rejected.ok());
                // Next to t two steps of different sizes may be one after rounding.
                let smaller = run.propose(h).0;
                let stuck = smaller == run.t || smaller == end;
                if in_a_row >= REJECTIONS_MAX || h < control.min_step || stuck {
                    return Err(run.underflow(h, rejected.err()));
                }
            }
        }
    }
    let Stats { restored, not_restored, residual, .. } = mended;
    Ok(AdaptiveStats { restored, not_restored, residual, ..run.stats })
}

/// A run under way.
struct Run<'a, P: Problem, Me: Embedded<P>> {
    problem: &'a P,
    method: &'a Me,
    control: &'a Adaptive,
    t: f64,
    t1: f64,
    work: Me::Work,
    next: PointOf<P>,
    stats: AdaptiveStats,
}

impl<P: Problem, Me: Embedded<P>> Run<'_, P, Me>
where
    ScalarOf<P>: Into<f64>,
{
    /// A step from t to `end`.
    fn step(&self, end: f64) -> Step<ScalarOf<P>> {
        let lit = ScalarOf::<P>::lit;
        Step { n: self.stats.accepted, t: lit(self.t), h: lit(end - self.t) }
    }

    /// Is a step of this size lost in rounding next to t?
    fn lost(&self, h: f64) -> bool {
        self.t + h.copysign(self.t1 - self.t) == self.t
    }

    /// Where a step of about this size ends, and its size. It is the end of the span when that is
    /// near, and half way when two steps would be needed of which one is short.
    fn propose(&self, h: f64) -> (f64, f64) {
        let left = (self.t1 - self.t).abs();
        let h = h.min(self.control.max_step);
        if left <= h || (left <= 1.01 * h && left <= self.control.max_step) {
            return (self.t1, left);
        }
        let h = if left < 2.0 * h { 0.5 * left } else { h };
        let end = self.t + h.copysign(self.t1 - self.t);
        (end, (end - self.t).abs())
    }

    /// next ← the step from y to `end`; its error in units of the tolerance.
    fn attempt(&mut self, end: f64, y: &PointOf<P>) -> Result<f64, StepError> {
        let step = self.step(end);
        self.evaluated(self.method.evaluations_with_error(self.problem));
        let tolerance = &self.control.tolerance;
        let ratio = self.method.step_with_error(
            self.problem,
            step,
            tolerance,
            y,
            &mut self.work,
            &mut self.next,
        )?;
        let ratio: f64 = ratio.into();
        if !self.problem.action().is_finite(self.problem.group(), &self.next) {
            return Err(StepError::NotFinite { what: "the state" });
        }
        if !ratio.is_finite() {
            return Err(StepError::NotFinite { what: "the error estimate" });
        }
        Ok(ratio)
    }

    /// aside ← the state at `time`, by a step from y.
    fn side_step(
        &mut self,
        time: f64,
        y: &PointOf<P>,
        aside: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let step = self.step(time);
        self.evaluated(self.method.evaluations_with_error(self.problem));
        self.method.step_with_error(
            self.problem,
            step,
            &self.control.tolerance,
            y,
            &mut self.work,
            aside,
        )?;
        self.stats.side_steps += 1;
        Ok(())
    }

    fn evaluated(&mut self, more: Option<u64>) {
        self.stats.evaluations = self.stats.evaluations.zip(more).map(|(n, more)| n + more);
    }

    fn accepted(&mut self, end: f64, size: f64) {
        self.t = end;
        self.stats.accepted += 1;
        self.stats.smallest_step = self.stats.smallest_step.min(size);
        self.stats.largest_step = self.stats.largest_step.max(size);
    }

    /// Hairer, Nørsett, Wanner I, II.4, with the norm of 𝔤, where 1 is the natural unit: a step that
    /// moves by 1/100, looked at for how much f changes over it.
    fn first_step(&mut self, controller: &Controller, y: &PointOf<P>) -> f64 {
        let (group, lit) = (self.problem.group(), ScalarOf::<P>::lit);
        let (mut f0, mut f1, mut work) = (group.zero(), group.zero(), self.problem.work());
        let span = (self.t1 - self.t).abs();
        self.problem.f(lit(self.t), y, &mut f0, &mut work);
        self.evaluated(Some(1));
        let d1: f64 = group.norm(&f0).into();
        if !d1.is_finite() {
            return 1e-3 * span; // the first attempt will say what is wrong
        }
        let still = d1 * span <= 1e-5;
        let h0 = if still { 1e-6 * span } else { (0.01 / d1).min(span) };
        if self.lost(h0) {
            return if still { span } else { h0 };
        }
        let end = self.t + h0.copysign(self.t1 - self.t);
        if self.attempt(end, y).is_err() {
            return h0;
        }
        self.problem.f(lit(end), &self.next, &mut f1, &mut work);
        self.evaluated(Some(1));
        group.axpy(lit(-1.0), &f0, &mut f1);
        // Rates: f itself, and the root of its derivative.
        let change: f64 = group.norm(&f1).into();
        let rate = d1.max((change / h0).sqrt());
        let tolerance = self.control.tolerance.of_unit_size();
        let h1 = (0.01 * tolerance).powf(1.0 / controller.k) / rate;
        match h1.is_finite() {
            true => h1.min(100.0 * h0),
            false => h0,
        }
    }

    #[cold]
    fn underflow(&self, h: f64, source: Option<StepError>) -> AdaptiveError {
        let AdaptiveStats { accepted, rejected, .. } = self.stats;
        let h = h.copysign(self.t1 - self.t);
        AdaptiveError::StepSizeUnderflow { t: self.t, h, accepted, rejected, source }
    }

    #[cold]
    fn too_many(&self, h: f64) -> AdaptiveError {
        let AdaptiveStats { accepted, rejected, .. } = self.stats;
        let (h, max_steps) = (h.copysign(self.t1 - self.t), self.control.max_steps);
        AdaptiveError::TooManySteps { t: self.t, h, accepted, rejected, max_steps }
    }
}
