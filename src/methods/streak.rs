//! Streaks: steps by error that are taken in one call.
//!
//! Where a step size is kept, the end of a step, its error and the next step are one loop of typed code. The processor
//! begins the next step there before it knows the error of the last one. Where it is not kept, the caller, which knows
//! numbers only, tells the next size ([`Resize`]). The caller decides on the last attempt of a streak. The steps of a run
//! do not depend on where its streaks end.

use super::{Embedded, Step};
use crate::actions::Action;
use crate::error::StepError;
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::Metric;
use crate::tolerance::Tolerance;

/// The size of the next step after an accepted one, where it is not kept.
pub trait Resize {
    /// The size of the step after one that ended at `end` with this ratio of error and tolerance, negative when time runs
    /// backward. None ends the streak.
    fn after(&self, step: Step<f64>, end: f64, ratio: f64) -> Option<f64>;
}

/// The conditions under which the next step is attempted, too.
#[derive(Clone, Copy)]
#[allow(missing_debug_implementations)] // the sizes are the caller's
pub struct Streak<'a> {
    /// The largest number of attempts.
    pub most: u64,
    /// The size of the first step; negative when time runs backward.
    pub size: f64,
    /// The least and the largest ratio of error and tolerance at which the size is kept.
    pub kept: [f64; 2],
    /// A size is kept if this time is at least two sizes away.
    pub stop: f64,
    /// The streak ends with a step that reaches this time.
    pub time: Option<f64>,
    /// Tells the size where it is not kept.
    pub resize: Option<&'a dyn Resize>,
}

impl Streak<'_> {
    /// One attempt.
    pub const ONE: Self =
        Streak { most: 1, size: 0.0, kept: [0.0; 2], stop: 0.0, time: None, resize: None };

    /// True if the step size is kept after this ratio.
    #[inline(always)]
    fn keeps(&self, ratio: f64) -> bool {
        self.kept[0] <= ratio && ratio <= self.kept[1]
    }

    /// True if a step that ends at t may be followed by another attempt, after so many.
    #[inline(always)]
    fn continues(&self, attempts: u64, t: f64, size: f64) -> bool {
        let is_before = |a: f64, b: f64| if size > 0.0 { a < b } else { a > b };
        attempts < self.most && self.time.is_none_or(|time| is_before(t, time))
    }

    /// True if a step of this size from t keeps it.
    #[inline(always)]
    fn has_room(&self, t: f64, size: f64) -> bool {
        (self.stop - t).abs() >= 2.0 * size.abs() && t + size != t
    }
}

/// The attempts of a streak: the steps that were accepted, and one more attempt, on which the caller decides.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempts {
    /// The number of accepted steps.
    pub accepted: u64,
    /// True if the last attempt has the size of the step before it.
    pub is_kept: bool,
    /// The last attempt.
    pub step: Step<f64>,
    /// The time at the end of the last attempt.
    pub end: f64,
    /// The size that was chosen for the last attempt: that of `step` but for rounding, if a step was accepted.
    pub size: f64,
    /// The error of the last attempt in units of the tolerance.
    ///
    /// # Errors
    /// Why the step could not be taken.
    pub ratio: Result<f64, StepError>,
}

impl Attempts {
    /// The attempt of a method that has no estimate of its error.
    pub(crate) fn without_estimate(step: Step<f64>, end: f64) -> Self {
        let ratio = Err(StepError::NotFinite { what: "the error estimate" });
        Attempts { accepted: 0, is_kept: false, step, end, size: step.h, ratio }
    }
}

/// Sees the start, the end and the point at the end of a step of a streak. Returns false if the step must be the last one.
pub type Watch<'w, Y> = dyn FnMut([f64; 2], &Y) -> bool + 'w;

/// A step by its error, to be attempted with those of its streak.
#[allow(missing_debug_implementations)] // the points belong to the problem's types
pub struct Attempt<'a, P: Problem> {
    /// The allowed error.
    pub tolerance: &'a Tolerance,
    /// The first step.
    pub step: Step<f64>,
    /// The time at the end of the first step.
    pub end: f64,
    /// The conditions of the steps after the first one.
    pub streak: &'a Streak<'a>,
    /// The start of the last accepted step, the start of the attempt, and its end.
    pub points: [&'a mut PointOf<P>; 3],
    /// Looks at each accepted step.
    pub watch: Option<&'a mut Watch<'a, PointOf<P>>>,
}

impl<'a, P: Problem> Attempt<'a, P> {
    /// One attempt alone. It leaves the first point as it is.
    pub fn one(tolerance: &'a Tolerance, step: Step<f64>, points: [&'a mut PointOf<P>; 3]) -> Self {
        let end = step.t + step.h;
        Attempt { tolerance, step, end, streak: &Streak::ONE, points, watch: None }
    }
}

/// Attempts the steps of a streak, as [`Embedded::attempt`] does.
#[inline(always)]
pub(super) fn attempt_steps<P: Problem, M: Embedded<P> + ?Sized>(
    method: &M,
    problem: &P,
    attempt: Attempt<'_, P>,
    work: &mut M::Work,
) -> Attempts
where
    ScalarOf<P>: Into<f64>,
{
    let Attempt { tolerance, mut step, mut end, streak, points: [from, y, to], mut watch } =
        attempt;
    let (action, group) = (problem.action(), problem.group());
    let (mut accepted, mut is_kept, mut size) = (0, false, streak.size);
    // Points of a few numbers stay in registers from step to step. They are not in an array: numbers that are moved within
    // one may be loaded in pairs of which one half was just stored, and wait for it.
    let is_small = PointOf::<P>::IS_SMALL;
    let copy = |y: &PointOf<P>| is_small.then(|| y.clone());
    let (mut from_copy, mut y_copy, mut to_copy) = (copy(from), copy(y), copy(to));
    let [a, b, c] = match (&mut from_copy, &mut y_copy, &mut to_copy) {
        (Some(a), Some(b), Some(c)) => [a, b, c],
        _ => [&mut *from, &mut *y, &mut *to],
    };
    let attempts = loop {
        let Step { n, t, h } = step;
        let exact = Step { n, t: ScalarOf::<P>::lit(t), h: ScalarOf::<P>::lit(h) };
        let ratio = method.step_with_error(problem, exact, tolerance, b, work, c);
        let ratio = ratio.and_then(|ratio| {
            let not_finite = |what| StepError::NotFinite { what };
            let ratio: f64 = ratio.into();
            match (action.is_finite(group, c), ratio.is_finite()) {
                (true, true) => Ok(ratio),
                (false, _) => Err(not_finite("the state")),
                (true, false) => Err(not_finite("the error estimate")),
            }
        });
        // The size of the next step, and whether it is that of this one.
        let next = match ratio {
            Ok(ratio) if streak.continues(accepted + 1, end, size) => match streak.keeps(ratio) {
                true => streak.has_room(end, size).then_some((size, true)),
                false => {
                    let resize = streak.resize.filter(|_| ratio <= 1.0);
                    resize.and_then(|sizes| Some((sizes.after(step, end, ratio)?, false)))
                }
            },
            _ => None,
        };
        let next = next.filter(|_| match &mut watch {
            None => true,
            Some(watch) if is_small => watch([t, end], &c.clone()),
            Some(watch) => watch([t, end], c),
        });
        let Some(next) = next else {
            break Attempts { accepted, is_kept, step, end, size, ratio };
        };
        match is_small {
            true => {
                a.assign(b);
                b.assign(c);
            }
            false => {
                core::mem::swap(a, b);
                core::mem::swap(b, c);
            }
        }
        accepted += 1;
        (size, is_kept) = next;
        let next = end + size;
        (step, end) = (Step { n: n + 1, t: end, h: next - end }, next);
    };
    if let (Some(a), Some(b), Some(c)) = (&from_copy, &y_copy, &to_copy) {
        from.assign(a);
        y.assign(b);
        to.assign(c);
    }
    attempts
}
