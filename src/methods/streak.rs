//! Streaks: steps by error that are taken in one call, while their size is kept.
//!
//! Where a step size is kept, the end of a step, its error and the next step are one loop of typed code. The processor
//! begins the next step there before it knows the error of the last one. The caller, which knows numbers only, decides on
//! the last attempt of a streak. The steps of a run do not depend on where its streaks end.

use super::{Embedded, Step};
use crate::actions::Action;
use crate::error::StepError;
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::Metric;
use crate::tolerance::Tolerance;

/// The conditions under which the next step of the same size is attempted, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Streak {
    /// The largest number of attempts.
    pub most: u64,
    /// The size of each step; negative when time runs backward.
    pub size: f64,
    /// The least and the largest ratio of error and tolerance at which the size is kept.
    pub kept: [f64; 2],
    /// The streak ends when this time is closer than two sizes.
    pub stop: f64,
    /// The streak ends with a step that reaches this time.
    pub time: Option<f64>,
}

impl Streak {
    /// One attempt.
    pub const ONE: Streak = Streak { most: 1, size: 0.0, kept: [0.0; 2], stop: 0.0, time: None };

    /// True if the step size is kept after this ratio.
    #[inline(always)]
    fn keeps(&self, ratio: f64) -> bool {
        self.kept[0] <= ratio && ratio <= self.kept[1]
    }

    /// The end of the next step, after one that reached t, if the streak continues there.
    #[inline(always)]
    fn next(&self, t: f64) -> Option<f64> {
        let Streak { size, stop, time, .. } = *self;
        let is_before = |a: f64, b: f64| if size > 0.0 { a < b } else { a > b };
        let continues = (stop - t).abs() >= 2.0 * size.abs()
            && time.is_none_or(|time| is_before(t, time))
            && t + size != t;
        continues.then_some(t + size)
    }
}

/// The attempts of a streak: the steps that were accepted, and one more attempt, on which the caller decides.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempts {
    /// The number of accepted steps.
    pub accepted: u64,
    /// The ratio of the last accepted step.
    pub accepted_ratio: f64,
    /// The last attempt.
    pub step: Step<f64>,
    /// Its end.
    pub end: f64,
    /// Its error in units of the tolerance.
    ///
    /// # Errors
    /// Why the step could not be taken.
    pub ratio: Result<f64, StepError>,
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
    /// Its end.
    pub end: f64,
    /// The conditions of the steps after it.
    pub streak: &'a Streak,
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
    let (mut accepted, mut accepted_ratio) = (0, 0.0);
    // Points of a few numbers stay in registers from step to step.
    let is_small = PointOf::<P>::IS_SMALL;
    let mut copies = if is_small { Some([from.clone(), y.clone(), to.clone()]) } else { None };
    let [a, b, c] = match &mut copies {
        Some(copies) => copies.each_mut(),
        None => [&mut *from, &mut *y, &mut *to],
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
        let next = match ratio {
            Ok(ratio) if streak.keeps(ratio) && accepted + 1 < streak.most => streak.next(end),
            _ => None,
        };
        let next = next.filter(|_| watch.as_mut().is_none_or(|watch| watch([t, end], c)));
        let (Some(next), Ok(kept)) = (next, &ratio) else {
            break Attempts { accepted, accepted_ratio, step, end, ratio };
        };
        core::mem::swap(a, b);
        core::mem::swap(b, c);
        (accepted, accepted_ratio) = (accepted + 1, *kept);
        (step, end) = (Step { n: n + 1, t: end, h: next - end }, next);
    };
    if let Some([a, b, c]) = &copies {
        from.assign(a);
        y.assign(b);
        to.assign(c);
    }
    attempts
}
