//! The points of a run: the part of the driver that knows the types of its problem and method.
//!
//! The rest of the driver knows numbers only ([`Timeline`](super::timeline::Timeline),
//! [`Drive`](super::drive::Drive)). It calls this part through a pointer, a few times for each step. So the compiler
//! compiles the driver once, and only this file again for each problem and method. A step itself has no such call.

use super::checks::{
    ON_M, check_residual, checked_field, checked_start, correct_to_manifold, square_of_size,
};
use super::control::StepControl;
use super::held::Held;
use super::interpolant::{Listing, Piece, no_polynomial};
use super::stats::{Cadence, RunError, Stats, power_of_two_of_rate};
use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::methods::{
    Attempt, Attempts, Embedded, EqualSteps, Facts, Method, Step, Streak, Watch, Within,
    ratio_in_algebra,
};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::{Real, smaller};
use crate::space::Metric;
use crate::tolerance::{Rule, Scales, Tolerance, Weight};

/// How far from M, relative to y, a step may move because f is not in 𝔤. Rounding of f moves it less.
const OFF_BY_A_STEP: f64 = 1e-9;

/// A place in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// Its end, or where the run was cut: y.
    End,
    /// Its start.
    Start,
    /// The part θ of it, by dense output.
    Within(f64),
    /// The end of a shorter step of this size.
    Shorter(f64),
}

/// A part of the state that is saved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Saved {
    /// The state.
    State,
    /// The start of the last step.
    Start,
    /// The point whose orbit contains the run.
    Orbit,
    /// The numbers that the method keeps from step to step.
    Memory,
}

/// The points of a run of any problem and method.
pub(super) trait AnyPoints {
    /// from ← y, y ← the end of the step. On an error y is unchanged.
    fn step(&mut self, step: Step<f64>) -> Result<(), StepError>;
    /// from ← y, y ← the end of these steps. On an error y is the start of the step that failed.
    fn steps(&mut self, steps: EqualSteps) -> Result<(), (u64, StepError)>;
    /// to ← the end of an adaptive step from y, which ends at `end`, after the steps of the streak.
    fn attempt(&mut self, step: Step<f64>, end: f64, streak: &Streak<'_>) -> Attempts;
    /// from ← y, y ← to.
    fn accept(&mut self);
    /// How fast f(t, y) moves y. Stores f.
    fn rate(&mut self, t: f64) -> f64;
    /// How fast f(t, to) − f moves `to`, with the stored f.
    fn change_of_rate(&mut self, t: f64) -> f64;
    /// h times the error of f that the rounding of t makes in a step of size h from (t, y), in units of the tolerance.
    fn noise_of_time(&mut self, t: f64, h: f64) -> f64;
    /// Sets what errors are relative to.
    fn weigh(&mut self, by: Weight);
    /// A power of two above the rate at which f(t, y) turns y, or 0 if that is not finite. It is computed for steps of one
    /// size, too.
    fn turn_rate(&mut self, t: f64) -> f64;
    /// Corrects y to M, and records how far it was. Where f may be outside of 𝔤, refuses a state that was farther from M
    /// than rounding moves it.
    fn correct(&mut self, cadence: &mut Cadence, stats: &mut Stats) -> Result<(), Error>;
    /// Checks that f(t, y) is in 𝔤, so far that steps of this size stay on M. Does nothing where no f is outside.
    fn check_field(&mut self, t: f64, size: f64, stats: &mut Stats) -> Result<(), Error>;
    /// Records how far y is from M, and leaves it as it is. If the method stays on M and f may be outside of 𝔤, refuses a y
    /// that is farther from M than rounding moves it.
    ///
    /// It does not see the determinant of SL(n) and SU(n): methods with cay leave these by the error of their order.
    fn check_end(&mut self, stays_on_manifold: bool, stats: &mut Stats) -> Result<(), Error>;
    /// Takes the last step again, so that the workspace holds it. to ← its end.
    fn repeat(&mut self, step: Step<f64>) -> Result<(), StepError>;
    /// Prepares the dense output of the last step. Its end is y, or else `to`.
    fn prepare(&mut self, step: Step<f64>, ends_at_y: bool) -> Result<(), StepError>;
    /// The iterations that the workspace has counted.
    fn iterations(&self) -> u64;
    /// The evaluations of f that the workspace did not need.
    fn reused(&self) -> u64;
    /// Forgets values of f that are kept for the next step.
    fn forget(&mut self);
    /// The name of the group.
    fn group_name(&self) -> String;
    /// Calls `each` with the numbers of this part of the state.
    fn each_number(&mut self, part: Saved, each: &mut dyn FnMut(&mut f64));
}

/// See [`Embedded::attempt`].
type AttemptOf<P, M> = for<'a> fn(&M, &P, Attempt<'a, P>, &mut <M as Method<P>>::Work) -> Attempts;

/// The ratio of an error in 𝔤 of a step from a point to the tolerance. The last argument is the length of the step.
type RatioOf<P> = fn(&P, &AlgOf<P>, &PointOf<P>, &Tolerance, ScalarOf<P>) -> f64;

/// What an adaptive run needs from its method.
pub(super) struct Estimator<P: Problem, M: Method<P>> {
    attempt: AttemptOf<P, M>,
    /// How fast v moves y.
    rate: fn(&P, &AlgOf<P>, &PointOf<P>, Rule) -> f64,
    ratio: RatioOf<P>,
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
        // Where sizes count, that of a translation is relative to the vector that it moves, unless this is 0.
        let rate = |problem: &P, v: &AlgOf<P>, y: &PointOf<P>, rule| {
            let (group, action) = (problem.group(), problem.action());
            let rate = group.norm(v);
            match rule {
                Rule::PerLength => rate.into(),
                Rule::PerStep => {
                    smaller(rate, action.error_ratio(group, v, y, &mut Scales::relative())).into()
                }
            }
        };
        let ratio = |problem: &P, e: &AlgOf<P>, y: &PointOf<P>, tolerance: &Tolerance, length| {
            ratio_in_algebra(problem, tolerance, e, [y, y], length).into()
        };
        Estimator { attempt: M::attempt, rate, ratio }
    }
}

/// What adaptive steps need besides the method: the estimator with its tolerance, and a value of f for the choice of a
/// first step.
struct Rates<P: Problem, M: Method<P>> {
    estimator: Estimator<P, M>,
    tolerance: Tolerance,
    f: AlgOf<P>,
}

/// The points of a run.
pub(super) struct Points<'a, P: Problem, M: Method<P>> {
    pub(super) problem: Held<'a, P>,
    method: Held<'a, M>,
    /// The state.
    pub(super) y: PointOf<P>,
    /// The start of the last step.
    pub(super) from: PointOf<P>,
    /// The end of an attempt, or of a repeated step.
    to: PointOf<P>,
    work: M::Work,
    /// For an adaptive step size.
    rates: Option<Rates<P, M>>,
    /// The start of the run. The state is corrected to its orbit.
    orbit: PointOf<P>,
    restore: <P::Action as Action<P::Group>>::Work,
    /// A value of f, and the scratch of f.
    v: AlgOf<P>,
    field: P::Work,
    /// The function that lists the numbers of a point, if the state is saved.
    pub(super) list: Option<Listing<P>>,
}

fn lit<P: Problem>(Step { n, t, h }: Step<f64>) -> Step<ScalarOf<P>> {
    Step { n, t: ScalarOf::<P>::lit(t), h: ScalarOf::<P>::lit(h) }
}

fn finite(is: bool) -> Result<(), StepError> {
    StepError::finite(is, "the state")
}

impl<'a, P: Problem, M: Method<P>> Points<'a, P, M> {
    /// Makes the points of a run that starts at y. Checks f(t, y) at the time `field_at`. Returns them with the costs of a
    /// step and, for an adaptive step size, the order of the error.
    pub(super) fn new(
        (problem, method): (Held<'a, P>, Held<'a, M>),
        adaptive: Option<(&StepControl, Estimator<P, M>)>,
        mut y: PointOf<P>,
        field_at: Option<f64>,
    ) -> Result<(Self, Facts, Option<usize>), Error> {
        let held = (problem, method);
        let (problem, method) = (&*held.0, &*held.1);
        let restore = checked_start(
            problem,
            &mut y,
            adaptive.as_ref().map(|(control, _)| control.tolerance()),
        )?;
        let facts = method.facts(problem);
        let mut error_order = None;
        let rates = match adaptive {
            None => None,
            Some((control, estimator)) => {
                error_order = Some(facts.order_of_estimate()?);
                let tolerance = control.tolerance().of_run(control.min_step > 0.0);
                Some(Rates { estimator, tolerance, f: problem.group().zero() })
            }
        };
        let work = method.work(problem, &y)?;
        let (v, field) = checked_field(problem, field_at, &y)?;
        let [from, to, orbit] = [y.clone(), y.clone(), y.clone()];
        let (problem, method) = held;
        let list = None;
        let points =
            Points { problem, method, y, from, to, work, rates, orbit, restore, v, field, list };
        Ok((points, facts, error_order))
    }

    /// The start of the last step ← the point.
    pub(super) fn start_at(&mut self, point: &PointOf<P>) {
        self.from.assign(point);
    }

    /// y ← the point.
    pub(super) fn set(&mut self, point: &PointOf<P>) {
        self.y.assign(point);
    }

    /// `at` ← the point at a place in the last step.
    pub(super) fn look(
        &mut self,
        place: Place,
        last: Step<f64>,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let Points { problem, method, y, from, to, work, rates, .. } = self;
        let (problem, method) = (&**problem, &**method);
        let (action, group) = (problem.action(), problem.group());
        match place {
            Place::End => at.assign(y),
            Place::Start => at.assign(from),
            Place::Within(theta) => {
                method.interpolate(problem, lit::<P>(last), theta, from, work, at)?;
                finite(action.is_finite(group, at))?;
            }
            Place::Shorter(h) => {
                match rates {
                    // As the steps of the run are taken: in two halves, if the method has no estimate.
                    Some(Rates { estimator, tolerance, .. }) => {
                        let (step, points) = (Step { h, ..last }, [to, from, at]);
                        let one = Attempt::one(tolerance, step, points);
                        (estimator.attempt)(method, problem, one, work).ratio?;
                    }
                    None => {
                        at.assign(from);
                        method.step(problem, lit::<P>(Step { h, ..last }), at, work)?;
                    }
                }
                finite(action.is_finite(group, at))?;
            }
        }
        Ok(())
    }

    /// The last step, which is prepared for dense output, as a polynomial.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a method without one, [`RunError::Within`].
    pub(super) fn record(
        &mut self,
        last: Step<f64>,
        span: [f64; 2],
        at: &mut PointOf<P>,
    ) -> Result<Piece<P>, RunError> {
        let Points { problem, method, from, work, list, .. } = self;
        let (problem, method) = (&**problem, &**method);
        let (Some(list), true) = (*list, method.within(work) != Within::Steps) else {
            return Err(no_polynomial().into());
        };
        Piece::record((problem, method), (last, span), from, work, (at, list))
            .map_err(|source| RunError::Within { t: last.t, h: last.h, source })
    }

    /// Is the state on the orbit of the run, up to rounding, and a point within the last step not?
    pub(super) fn leaves_orbit_at(&mut self, at: &PointOf<P>) -> bool {
        let Points { problem, y, to, orbit, restore, .. } = self;
        let (group, action) = (problem.group(), problem.action());
        let mut is_on = |point: &PointOf<P>| {
            to.assign(point);
            let residual = action.restore_to(group, orbit, to, restore);
            let relative = residual.map(|residual| residual / action.residual_size(group, point));
            relative.is_none_or(|residual| residual.all_below(ON_M * ScalarOf::<P>::EPSILON))
        };
        !is_on(at) && is_on(y)
    }

    /// y ← y changed by `change`, and corrected to M. It must be on M, or not be much farther from it than y was, which some
    /// methods leave, else y is unchanged. The run continues on the orbit of the new y.
    pub(super) fn change(&mut self, change: &mut dyn FnMut(&mut PointOf<P>)) -> Result<(), Error> {
        let Points { problem, y, to, orbit, restore, .. } = self;
        let problem = &**problem;
        let (action, group) = (problem.action(), problem.group());
        to.assign(y);
        let was_off = correct_to_manifold(problem, to, restore);
        to.assign(y);
        change(to);
        let checked = to.check_sizes("y", y).and_then(|()| action.check(group, to));
        if checked.is_err() {
            to.clone_from(y); // also its size
            return checked;
        }
        let is_same = to.is_same(y);
        if let (Some(is_off), Some(was_off)) = (correct_to_manifold(problem, to, restore), was_off)
            && !(is_off - ScalarOf::<P>::lit(2.0) * was_off).all_below(0.0)
        {
            check_residual(problem, is_off)?;
        }
        // The run itself may have left it, by the errors of its steps.
        if !is_same && action.check_member(group, y).is_ok() {
            action.check_member(group, to)?;
        }
        orbit.assign(to);
        y.assign(to);
        Ok(())
    }

    /// [`AnyPoints::attempt`], where `watch` sees the steps of the streak.
    #[inline]
    pub(super) fn attempt_watched<'w>(
        &'w mut self,
        step: Step<f64>,
        end: f64,
        streak: &'w Streak<'w>,
        watch: Option<&'w mut Watch<'w, PointOf<P>>>,
    ) -> Attempts {
        let Points { problem, method, y, from, to, work, rates, .. } = self;
        match rates {
            Some(Rates { estimator, tolerance, .. }) => {
                let points = [from, y, to];
                let attempt = Attempt { tolerance, step, end, streak, points, watch };
                (estimator.attempt)(method, problem, attempt, work)
            }
            None => Attempts::without_estimate(step, end),
        }
    }

    /// y ← the point, like [`change`](Self::change).
    pub(super) fn change_to(&mut self, point: &PointOf<P>) -> Result<(), Error> {
        let problem = self.problem.clone();
        point.check_sizes("y", &self.y)?;
        problem.action().check(problem.group(), point)?;
        self.change(&mut |y| y.assign(point))
    }
}

impl<P: Problem, M: Method<P>> AnyPoints for Points<'_, P, M> {
    fn step(&mut self, step: Step<f64>) -> Result<(), StepError> {
        let Points { problem, method, y, from, work, .. } = self;
        let (problem, method) = (&**problem, &**method);
        let (action, group) = (problem.action(), problem.group());
        from.assign(y);
        let taken = method.step(problem, lit::<P>(step), y, work);
        let taken = taken.and_then(|()| finite(action.is_finite(group, y)));
        if taken.is_err() {
            y.assign(from);
        }
        taken
    }
    fn steps(&mut self, steps: EqualSteps) -> Result<(), (u64, StepError)> {
        let Points { problem, method, y, from, work, .. } = self;
        let (problem, method) = (&**problem, &**method);
        from.assign(y);
        method.steps(problem, steps, y, work).inspect_err(|(failed, _)| {
            y.assign(from);
            let _ = method.steps(problem, EqualSteps { end: *failed, ..steps }, y, work);
        })
    }
    fn attempt(&mut self, step: Step<f64>, end: f64, streak: &Streak<'_>) -> Attempts {
        self.attempt_watched(step, end, streak, None)
    }
    fn accept(&mut self) {
        core::mem::swap(&mut self.from, &mut self.y);
        core::mem::swap(&mut self.y, &mut self.to);
    }
    fn rate(&mut self, t: f64) -> f64 {
        let Points { problem, y, rates, field, .. } = self;
        let problem = &**problem;
        rates.as_mut().map_or(0.0, |Rates { estimator, tolerance, f, .. }| {
            problem.f(ScalarOf::<P>::lit(t), y, f, field);
            (estimator.rate)(problem, f, y, tolerance.rule())
        })
    }
    fn change_of_rate(&mut self, t: f64) -> f64 {
        let Points { problem, to, rates, v, field, .. } = self;
        let problem = &**problem;
        rates.as_mut().map_or(0.0, |Rates { estimator, tolerance, f, .. }| {
            problem.f(ScalarOf::<P>::lit(t), to, v, field);
            problem.group().axpy(ScalarOf::<P>::lit(-1.0), f, v);
            (estimator.rate)(problem, v, to, tolerance.rule())
        })
    }
    fn noise_of_time(&mut self, t: f64, h: f64) -> f64 {
        let Points { problem, y, rates, v, field, .. } = self;
        let problem = &**problem;
        let group = problem.group();
        rates.as_mut().map_or(0.0, |Rates { estimator, tolerance, f, .. }| {
            problem.f(ScalarOf::<P>::lit(t), y, f, field);
            let length = ScalarOf::<P>::lit(h.abs()) * group.norm(f);
            // The change over half the step: f may jump at its end.
            problem.f(ScalarOf::<P>::lit(t + 0.5 * h), y, v, field);
            group.axpy(ScalarOf::<P>::lit(-1.0), f, v);
            // h·(ε/2)|t|·∂f/∂t
            group.set_zero(f);
            group.axpy(ScalarOf::<P>::lit(f64::EPSILON * t.abs()), v, f);
            (estimator.ratio)(problem, f, y, tolerance, length)
        })
    }
    fn weigh(&mut self, by: Weight) {
        if let Some(rates) = &mut self.rates {
            rates.tolerance.weigh(by);
        }
    }
    fn turn_rate(&mut self, t: f64) -> f64 {
        let Points { problem, y, v, field, .. } = self;
        let problem = &**problem;
        let (group, action) = (problem.group(), problem.action());
        problem.f(ScalarOf::<P>::lit(t), y, v, field);
        let relative = action.error_ratio(group, v, y, &mut Scales::relative());
        let rate = smaller(group.norm(v), relative);
        if rate.any_below(f64::INFINITY) { power_of_two_of_rate(rate) } else { 0.0 }
    }
    fn correct(&mut self, cadence: &mut Cadence, stats: &mut Stats) -> Result<(), Error> {
        let Points { problem, y, orbit, restore, .. } = self;
        let problem = &**problem;
        let is_checked = problem.group().holds_more();
        let Some(residual) = problem.action().restore_to(problem.group(), orbit, y, restore) else {
            match is_checked {
                true => cadence.saw(0.0),
                false => cadence.next = u64::MAX,
            }
            return Ok(());
        };
        stats.saw(residual);
        cadence.saw(residual);
        match is_checked {
            true => {
                let size = problem.action().residual_size(problem.group(), y);
                check_residual(problem, residual / size)
            }
            false => Ok(()),
        }
    }
    fn check_field(&mut self, t: f64, size: f64, stats: &mut Stats) -> Result<(), Error> {
        let Points { problem, y, v, field, .. } = self;
        let problem = &**problem;
        let group = problem.group();
        if !group.holds_more() {
            return Ok(());
        }
        problem.f(ScalarOf::<P>::lit(t), y, v, field);
        stats.evaluations = stats.evaluations.map(|n| n + 1);
        // An f that y turns, Ad_y w, has a rounding of ε‖y‖².
        let square = square_of_size::<P>(y);
        let allowed = if square.all_below(1e6) { square } else { ScalarOf::<P>::lit(1e6) };
        let moved = group.off_algebra(v) * ScalarOf::<P>::lit(size) / allowed;
        match moved.all_below(OFF_BY_A_STEP) {
            true => Ok(()),
            false => group.check("f", v),
        }
    }
    fn check_end(&mut self, stays_on_manifold: bool, stats: &mut Stats) -> Result<(), Error> {
        let Points { problem, y, orbit, restore, .. } = self;
        let problem = &**problem;
        let (group, action) = (problem.group(), problem.action());
        let Some(residual) = action.restore_to(group, orbit, &mut y.clone(), restore) else {
            return Ok(());
        };
        stats.saw_residual(residual);
        match stays_on_manifold && group.holds_more() {
            true => check_residual(problem, residual / action.residual_size(group, y)),
            false => Ok(()),
        }
    }
    fn repeat(&mut self, step: Step<f64>) -> Result<(), StepError> {
        let Points { problem, method, y, from, to, work, rates, .. } = self;
        let (problem, method) = (&**problem, &**method);
        match rates {
            Some(Rates { estimator, tolerance, .. }) => {
                // One attempt leaves y alone.
                let one = Attempt::one(tolerance, step, [y, from, to]);
                (estimator.attempt)(method, problem, one, work).ratio.map(drop)
            }
            None => {
                to.assign(from);
                method.step(problem, lit::<P>(step), to, work)
            }
        }
    }
    fn prepare(&mut self, step: Step<f64>, ends_at_y: bool) -> Result<(), StepError> {
        let Points { problem, method, y, from, to, work, .. } = self;
        let (problem, method) = (&**problem, &**method);
        method.prepare(problem, lit::<P>(step), from, if ends_at_y { y } else { to }, work)
    }
    fn iterations(&self) -> u64 {
        self.method.iterations(&self.work)
    }
    fn reused(&self) -> u64 {
        self.method.reused(&self.work)
    }
    fn forget(&mut self) {
        self.method.forget(&mut self.work);
    }
    fn group_name(&self) -> String {
        self.problem.group().name()
    }
    fn each_number(&mut self, part: Saved, each: &mut dyn FnMut(&mut f64)) {
        let Points { method, y, from, work, orbit, list, .. } = self;
        let method = &**method;
        let Some(list) = list else { return };
        match part {
            Saved::State => list(y, each),
            Saved::Start => list(from, each),
            Saved::Orbit => list(orbit, each),
            Saved::Memory => method.each_memory(work, each),
        }
    }
}
