//! A run that the caller takes step by step, and whose state can be read and set.

use super::control::{Controller, StepControl};
use super::grid::TimeGrid;
use super::stats::{Mender, RunError, Stats};
use crate::actions::Action;
use crate::error::{Error, Failure, StepError};
use crate::groups::LieAlgebra;
use crate::methods::{Embedded, EqualSteps, MapCounts, Method, Step};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::tolerance::Tolerance;

/// A step with its error in units of the tolerance, as a number.
type Attempt<P, M> = fn(
    &M,
    &P,
    Step<ScalarOf<P>>,
    &Tolerance,
    &PointOf<P>,
    &mut <M as Method<P>>::Work,
    &mut PointOf<P>,
) -> Result<f64, StepError>;

/// What an adaptive run needs from its method.
pub(super) struct Estimator<P: Problem, M: Method<P>> {
    pub(super) attempt: Attempt<P, M>,
    pub(super) error_order: fn(&M, &P) -> Result<usize, Error>,
    pub(super) evaluations: fn(&M, &P) -> Option<u64>,
    pub(super) norm: fn(&P, &AlgOf<P>) -> f64,
}

impl<P: Problem, M: Method<P>> Clone for Estimator<P, M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<P: Problem, M: Method<P>> Copy for Estimator<P, M> {}

impl<P: Problem, M: Embedded<P>> Estimator<P, M>
where
    ScalarOf<P>: Into<f64>,
{
    pub(super) fn of_method() -> Self {
        Estimator {
            attempt: |method, problem, step, tolerance, from, work, to| {
                method.step_with_error(problem, step, tolerance, from, work, to).map(Into::into)
            },
            error_order: |method, problem| method.error_order(problem),
            evaluations: |method, problem| method.evaluations_with_error(problem),
            norm: |problem, v| problem.group().norm(v).into(),
        }
    }
}

/// The choice of the steps of a run.
pub(super) enum Pace<P: Problem, M: Method<P>> {
    /// One size, with a largest number of steps.
    Equal { grid: TimeGrid, max_steps: u64 },
    /// By their error (adaptive).
    ByError(StepControl, Estimator<P, M>),
}

impl<P: Problem, M: Method<P>> Clone for Pace<P, M> {
    fn clone(&self) -> Self {
        match self {
            Pace::Equal { grid, max_steps } => Pace::Equal { grid: *grid, max_steps: *max_steps },
            Pace::ByError(control, estimator) => Pace::ByError(control.clone(), *estimator),
        }
    }
}

/// The state of the choice of steps.
pub(super) enum Pacer<P: Problem, M: Method<P>> {
    /// Equal steps: the grid, and the number of its steps that are done. A run that left its grid gets a new one.
    Equal { grid: TimeGrid, done: u64, max_steps: u64 },
    /// Steps by their error.
    ByError(Box<Chooser<P, M>>),
}

/// The state of the choice of steps by their error.
pub(super) struct Chooser<P: Problem, M: Method<P>> {
    pub(super) control: StepControl,
    pub(super) estimator: Estimator<P, M>,
    pub(super) evaluations: Option<u64>,
    pub(super) maps: Option<MapCounts>,
    pub(super) controller: Controller,
    /// The size of the next attempt, without its sign; `None` before the first step.
    pub(super) h: Option<f64>,
    /// The end of the last step that failed, until the run has passed it.
    pub(super) wall: Option<f64>,
    /// Two values of f and its scratch, for the choice of a first step.
    pub(super) first: Option<(AlgOf<P>, AlgOf<P>, P::Work)>,
}

/// What the workspace holds of the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Looked {
    /// Nothing: there was no step, or the state was changed since.
    Nothing,
    /// The step: the workspace was last used for it.
    Fresh,
    /// Something else: the workspace was used since.
    Stale,
    /// The step with its dense output.
    Prepared,
}

/// A run that is taken step by step.
///
/// [`Solve::integrator`](super::Solve::integrator) makes one, and allocates all its memory; steps allocate nothing. The
/// state is at time t, after n accepted steps. Between steps you can compute points within the last step
/// ([`interpolate`](Self::interpolate)) and change the state ([`set_state`](Self::set_state)).
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let method = Rkmk::new(DOPRI5, Exp);
/// let solve = Solve::new(&body, &method, [0.0, f64::INFINITY]).tolerances(1e-9, 1e-12);
/// let mut run = solve.integrator(Vector3::new(0.2, 0.0, 3.0))?;
/// for k in 1..=10 {
///     run.advance_to(f64::from(k))?; // a controller may read the state here, and change it
/// }
/// assert_eq!(run.t(), 10.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct Integrator<'a, P: Problem, M: Method<P>> {
    pub(super) problem: &'a P,
    pub(super) method: &'a M,
    pub(super) t: f64,
    pub(super) y: PointOf<P>,
    /// The start of the last step.
    pub(super) from: PointOf<P>,
    /// The last step.
    pub(super) last: Step<f64>,
    /// The end of an attempt, or of a repeated step.
    pub(super) to: PointOf<P>,
    pub(super) looked_at: Looked,
    pub(super) work: M::Work,
    pub(super) pacer: Pacer<P, M>,
    pub(super) t1: f64,
    pub(super) mender: Mender<P>,
    pub(super) stats: Stats,
}

/// Checks once, before the first step, that f(t, y) is in 𝔤.
fn check_field<P: Problem>(problem: &P, t: f64, y: &PointOf<P>) -> Result<(), Error> {
    let mut v = problem.group().zero();
    problem.f(ScalarOf::<P>::lit(t), y, &mut v, &mut problem.work());
    problem.group().check("f", &v)
}

/// The size of a step from t to `end`, or to a few rounding units before it.
pub(super) fn size_to(t: f64, end: f64, before: bool) -> f64 {
    let unit = f64::EPSILON * t.abs().max(end.abs());
    let size = end - t;
    if before && size.abs() > 100.0 * unit { size - (4.0 * unit).copysign(size) } else { size }
}

pub(super) fn lit<P: Problem>(Step { n, t, h }: Step<f64>) -> Step<ScalarOf<P>> {
    Step { n, t: ScalarOf::<P>::lit(t), h: ScalarOf::<P>::lit(h) }
}

impl<'a, P: Problem, M: Method<P>> Integrator<'a, P, M> {
    pub(super) fn new(
        problem: &'a P,
        method: &'a M,
        [t0, t1]: [f64; 2],
        pace: Pace<P, M>,
        y: PointOf<P>,
    ) -> Result<Self, Error> {
        problem.action().check(problem.group(), &y)?;
        let pacer = match pace {
            Pace::Equal { grid, max_steps } => Pacer::Equal { grid, done: 0, max_steps },
            Pace::ByError(control, estimator) => {
                let mut parts = control.tolerance.scales();
                let at = problem.group().zero();
                let none = problem.action().error_ratio(problem.group(), &at, &y, &mut parts);
                control.tolerance.check(parts.asked(), none.any_below(f64::INFINITY))?;
                Pacer::ByError(Box::new(Chooser {
                    control,
                    estimator,
                    evaluations: (estimator.evaluations)(method, problem),
                    maps: method.map_counts(problem, true),
                    controller: Controller::new((estimator.error_order)(method, problem)?),
                    h: None,
                    wall: None,
                    first: Some((problem.group().zero(), problem.group().zero(), problem.work())),
                }))
            }
        };
        let work = method.work(problem, &y)?;
        if t0 != t1 {
            check_field(problem, t0, &y)?;
        }
        let mender = Mender::new(problem, &y, method.stays_on_manifold());
        let stats = Stats {
            evaluations: Some(0),
            maps: Some(MapCounts::default()),
            smallest_step: f64::INFINITY,
            ..Stats::default()
        };
        Ok(Integrator {
            problem,
            method,
            t: t0,
            from: y.clone(),
            to: y.clone(),
            y,
            last: Step { n: 0, t: t0, h: 0.0 },
            looked_at: Looked::Nothing,
            work,
            pacer,
            t1,
            mender,
            stats,
        })
    }

    /// The time.
    pub fn t(&self) -> f64 {
        self.t
    }
    /// The state.
    pub fn y(&self) -> &PointOf<P> {
        &self.y
    }
    /// The end of the span.
    pub fn t_end(&self) -> f64 {
        self.t1
    }
    /// True if the end of the span is reached.
    pub fn is_done(&self) -> bool {
        self.t == self.t1
    }
    /// The statistics of the run so far.
    pub fn stats(&self) -> Stats {
        let mut stats = self.stats;
        stats.iterations = stats.iterations.wrapping_add(self.method.iterations(&self.work));
        if stats.accepted == 0 {
            stats.smallest_step = 0.0;
        }
        if let Pacer::Equal { .. } = &self.pacer {
            let each = self.method.evaluations(self.problem);
            stats.evaluations =
                stats.evaluations.zip(each).map(|(more, each)| more + each * stats.accepted);
            let each = self.method.map_counts(self.problem, false);
            stats.maps = each.map(|each| each.times(stats.accepted));
        }
        stats
    }
    /// The last step, from t − h to t; its size is 0 before the first.
    pub fn last_step(&self) -> Step<f64> {
        self.last
    }
    pub(super) fn forward(&self) -> bool {
        self.t1 >= self.t
    }

    /// Takes one step, at most to the end of the span. Returns the time.
    ///
    /// # Errors
    /// [`RunError`]; the state is then the last accepted one. At the end of the span a step does nothing.
    pub fn step(&mut self) -> Result<f64, RunError> {
        self.step_before(self.t1, false)?;
        Ok(self.t)
    }

    /// Takes steps until the time is exactly t. The last step is shortened to end there. f is never evaluated after t, so
    /// the state or f may be changed there.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a t before the current time or after the end of the span; else as [`step`](Self::step).
    pub fn advance_to(&mut self, t: f64) -> Result<&PointOf<P>, RunError> {
        let ahead =
            if self.forward() { self.t <= t && t <= self.t1 } else { self.t >= t && t >= self.t1 };
        if !(ahead && t.is_finite()) {
            let expected = format!("a time from {} to {}", self.t, self.t1);
            return Err(Error::out_of_range("t", t, expected).into());
        }
        while self.t != t {
            self.step_before(t, false)?;
        }
        Ok(&self.y)
    }

    /// `at` ← the state at a time within the last step, by dense output.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time outside the last step, [`RunError::Within`] where the point cannot be
    /// computed.
    pub fn interpolate(&mut self, t: f64, at: &mut PointOf<P>) -> Result<(), RunError> {
        let start = self.last.t;
        let inside =
            self.looked_at != Looked::Nothing && start.min(self.t) <= t && t <= start.max(self.t);
        match inside || t == self.t {
            true => self.at(t, at),
            false => {
                let expected = format!("a time of the last step, from {start} to {}", self.t);
                Err(Error::out_of_range("t", t, expected).into())
            }
        }
    }

    /// Sets the state, at the same time. The run continues from it, on its orbit. It must be on M. An adaptive run
    /// chooses a first step again.
    ///
    /// # Errors
    /// [`RunError::Changed`] for a state that is not on M; then the state is unchanged.
    pub fn set_state(&mut self, y: &PointOf<P>) -> Result<(), RunError> {
        let (action, group) = (self.problem.action(), self.problem.group());
        self.change("the caller", |z| action.assign(group, y, z))
    }

    /// y ← y changed by `change`, if the result is on M.
    pub(super) fn change(
        &mut self,
        by: &str,
        change: impl FnOnce(&mut PointOf<P>),
    ) -> Result<(), RunError> {
        let (action, group) = (self.problem.action(), self.problem.group());
        action.assign(group, &self.y, &mut self.to);
        change(&mut self.to);
        let moved = self.mender.move_to(self.problem, &mut self.to);
        moved.map_err(|source| RunError::Changed { by: by.into(), t: self.t, source })?;
        action.assign(group, &self.to, &mut self.y);
        self.looked_at = Looked::Nothing;
        if let Pacer::ByError(chooser) = &mut self.pacer {
            chooser.h = None;
            chooser.wall = None;
            chooser.controller = Controller { last: 1.0, hold: false, ..chooser.controller };
        }
        Ok(())
    }

    /// Cuts the last step at t. The run continues from the point `at` there.
    pub(super) fn cut(&mut self, t: f64, at: &PointOf<P>) {
        if t != self.t {
            self.problem.action().assign(self.problem.group(), at, &mut self.y);
            self.t = t;
        }
    }

    /// Takes one accepted step, at most to `stop`. No stage evaluates f exactly at `stop`, where f may jump.
    pub(super) fn step_before(&mut self, stop: f64, jumps: bool) -> Result<(), RunError> {
        if self.t == stop {
            return Ok(());
        }
        match &mut self.pacer {
            Pacer::Equal { .. } => self.equal_step(stop, jumps),
            Pacer::ByError(_) => self.chosen_step(stop, jumps),
        }
    }

    fn equal_step(&mut self, stop: f64, jumps: bool) -> Result<(), RunError> {
        let Pacer::Equal { grid, done, max_steps } = &mut self.pacer else { return Ok(()) };
        let max_steps = *max_steps;
        if self.stats.accepted >= max_steps {
            let h = grid.h().abs();
            return Err(self.too_many(h, max_steps));
        }
        if self.t != grid.time(*done) {
            // The run was taken off its grid: equal steps from here, of the same size.
            *grid = TimeGrid::new([self.t, self.t1], grid.h().abs())?;
            *done = 0;
        }
        let end = grid.time(*done + 1);
        let before = if self.t1 >= self.t { stop < end } else { stop > end };
        let n = self.stats.accepted;
        let (step, end) = match before || (jumps && stop == end) {
            true => (Step { n, t: self.t, h: size_to(self.t, stop, jumps) }, stop),
            false => (Step { n, ..grid.step(*done) }, end),
        };
        *done += u64::from(!before);
        let (action, group) = (self.problem.action(), self.problem.group());
        action.assign(group, &self.y, &mut self.from);
        let taken = self.method.step(self.problem, lit::<P>(step), &mut self.y, &mut self.work);
        let taken = taken.and_then(|()| match action.is_finite(group, &self.y) {
            true => Ok(()),
            false => Err(StepError::NotFinite { what: "the state" }),
        });
        if let Err(source) = taken {
            self.looked_at = Looked::Nothing;
            action.assign(group, &self.from, &mut self.y);
            return Err(Failure { step: n, t: self.t, h: step.h, source }.into());
        }
        self.accepted(step, end);
        Ok(())
    }

    /// Records that y is the state after `step`, at `end`.
    #[inline]
    pub(super) fn accepted(&mut self, step: Step<f64>, end: f64) {
        self.last = step;
        self.looked_at = Looked::Fresh;
        self.t = end;
        self.stats.accepted += 1;
        self.stats.smallest_step = self.stats.smallest_step.min(step.h.abs());
        self.stats.largest_step = self.stats.largest_step.max(step.h.abs());
        self.mender.after(self.stats.accepted, self.problem, &mut self.y, &mut self.stats);
    }

    /// Takes equal steps up to number `end` of the run, or fewer, in one call of the method. Afterwards only the last
    /// step has dense output. Returns false if there is no such call.
    pub(super) fn quietly(&mut self, end: u64, time: Option<f64>) -> Result<bool, RunError> {
        let Pacer::Equal { grid, done, max_steps } = &self.pacer else { return Ok(false) };
        let (grid, first, max_steps) = (*grid, *done, *max_steps);
        if self.stats.accepted != first || self.t != grid.time(first) {
            return Ok(false);
        }
        let mut end = end.min(self.mender.next()).min(grid.steps()).min(max_steps);
        if let Some(time) = time {
            end = end.min(grid.last_before(first, time));
        }
        // The last step of the run may be a short one.
        end -= u64::from(end == grid.steps() && grid.size(end - 1) != grid.h());
        // The last step of the call is taken alone, so that its start is known.
        let before = end.saturating_sub(1);
        if before <= first {
            return Ok(false);
        }
        self.problem.action().assign(self.problem.group(), &self.y, &mut self.from);
        let equal = grid.equal(first, before);
        let done = self.method.steps(self.problem, equal, &mut self.y, &mut self.work);
        let taken = done.map_or_else(|(step, _)| step, |()| before);
        if taken > first {
            self.stats.smallest_step = self.stats.smallest_step.min(grid.h().abs());
            self.stats.largest_step = self.stats.largest_step.max(grid.h().abs());
        }
        if let Err((step, source)) = done {
            // The state of an error is the last accepted one.
            self.problem.action().assign(self.problem.group(), &self.from, &mut self.y);
            let again = EqualSteps { end: step, ..equal };
            let _ = self.method.steps(self.problem, again, &mut self.y, &mut self.work);
            self.looked_at = Looked::Nothing;
            self.t = grid.time(step);
            self.stats.accepted = step;
            return Err(Failure { step, t: self.t, h: grid.h(), source }.into());
        }
        if let Pacer::Equal { done, .. } = &mut self.pacer {
            *done = before;
        }
        self.t = grid.time(before);
        self.stats.accepted = before;
        self.looked_at = Looked::Nothing;
        Ok(true)
    }
}
