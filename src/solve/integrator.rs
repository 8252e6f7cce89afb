//! A run that the caller takes step by step, and whose state can be read and set.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use super::drive::Patience;
use super::held::Held;
use super::points::{AnyPoints, Estimator, Points};
use super::stats::{RunError, Stats};
use super::stops::Stop;
use super::streak::{Alone, Reach};
use super::timeline::{Cancel, Looked, Pace, Timeline};
use crate::error::Error;
use crate::methods::{Method, Step};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::Metric;

/// A run that is taken step by step.
///
/// [`Solve::integrator`](super::Solve::integrator) makes one, and allocates all its memory; steps allocate nothing. The
/// state is at time t, after n accepted steps. Between steps you can compute points within the last step
/// ([`interpolate`](Self::interpolate)) and change the state ([`set_state`](Self::set_state)).
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use lieflow::nalgebra::Vector3;
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
    pub(super) points: Points<'a, P, M>,
    pub(super) times: Timeline,
    /// The times at which a step ends, in order.
    pub(super) stops: Vec<Stop>,
    patience: Patience,
}

impl<'a, P: Problem, M: Method<P>> Integrator<'a, P, M> {
    pub(super) fn new(
        held: (Held<'a, P>, Held<'a, M>),
        [t0, t1]: [f64; 2],
        (pace, estimator): (Pace, Option<Estimator<P, M>>),
        y: PointOf<P>,
    ) -> Result<Self, Error> {
        let adaptive = match &pace {
            Pace::Equal { .. } => None,
            Pace::ByError(control) => estimator.map(|estimator| (control, estimator)),
        };
        let field_at = (t0 != t1).then_some(t0);
        let (points, facts, error_order) = Points::new(held, adaptive, y, field_at)?;
        // The times of stages have the rounding of the problem's numbers.
        let epsilon = ScalarOf::<P>::EPSILON.max(f64::EPSILON);
        let times = Timeline::new([t0, t1], pace, facts, error_order, epsilon);
        Ok(Integrator { points, times, stops: Vec::new(), patience: Patience::new() })
    }

    /// The time.
    pub fn t(&self) -> f64 {
        self.times.t
    }
    /// The state.
    pub fn y(&self) -> &PointOf<P> {
        &self.points.y
    }
    /// The end of the span.
    pub fn t_end(&self) -> f64 {
        self.times.t1
    }
    /// True if the end of the span is reached.
    pub fn is_done(&self) -> bool {
        self.times.t == self.times.t1
    }
    /// The statistics of the run so far.
    pub fn stats(&self) -> Stats {
        self.times.stats(&self.points)
    }
    /// The last step, from t − h to t; its size is 0 before the first.
    pub fn last_step(&self) -> Step<f64> {
        self.times.last
    }

    /// Ends a call after a failed attempt while the flag is set, as by an f that failed finally and gives NaN. This attempt does
    /// not count in the statistics, and the next call goes on with it.
    pub fn cancel(&mut self, flag: Arc<AtomicBool>) {
        self.times.cancel = Some(Box::new(Cancel { flag, counts: self.times.stats }));
    }

    /// Takes one step, at most to the end of the span. Returns the time.
    ///
    /// No value of f is kept from the step before, since the caller may have changed what f depends on.
    ///
    /// # Errors
    /// [`RunError`]; the state is then the last accepted one. At the end of the span a step does nothing.
    pub fn step(&mut self) -> Result<f64, RunError> {
        self.forget_f();
        let stop = self.stop(self.times.t1);
        self.times.ask_for(self.times.t1);
        self.times.steps_before(&mut Alone(&mut self.points), stop, Reach::STEP)?;
        Ok(self.times.t)
    }

    /// Takes steps until the time is exactly t. The last step is shortened to end there. f is never evaluated after t, so
    /// the state or f may be changed there. The limit of attempts
    /// ([`Solve::max_steps`](super::Solve::max_steps)) is that of this call.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a t before the current time or after the end of the span; else as [`step`](Self::step).
    pub fn advance_to(&mut self, t: f64) -> Result<&PointOf<P>, RunError> {
        self.times.check_ahead(t)?;
        self.times.ask_for(t);
        self.forget_f();
        while self.times.t != t {
            self.steps_to(t, u64::MAX)?;
        }
        Ok(&self.points.y)
    }

    /// Steps towards t for about this time on the clock, but at least one step. Returns true if t is reached.
    ///
    /// The last step ends at t, as in [`advance_to`](Self::advance_to). A caller that has other work in between, or can be
    /// cancelled, calls it until then. The limit of attempts is that of all these calls.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn advance_for(&mut self, t: f64, limit: Duration) -> Result<bool, RunError> {
        self.times.check_ahead(t)?;
        if self.times.goal != t {
            self.times.ask_for(t);
        }
        self.forget_f();
        let start = Instant::now();
        while self.times.t != t {
            let clock = Instant::now();
            let most = self.times.stats.accepted.saturating_add(self.patience.steps());
            // After an error the next call is another one.
            self.steps_to(t, most).inspect_err(|_| self.times.goal = f64::NAN)?;
            self.patience.after(clock.elapsed());
            if start.elapsed() >= limit {
                break;
            }
        }
        Ok(self.times.t == t)
    }

    /// Forgets values of f. The caller may have changed what f depends on since the last step.
    fn forget_f(&mut self) {
        self.points.forget();
    }

    /// Takes steps of one call of the method, at most to t, and to this number of steps of the run.
    fn steps_to(&mut self, t: f64, steps: u64) -> Result<(), RunError> {
        let (stop, reach) = (self.stop(t), Reach { steps, time: None });
        self.times.steps_before(&mut Alone(&mut self.points), stop, reach)?;
        if self.times.t == t {
            // The caller may change f now.
            (self.times.jumped_at, self.times.jumped_by_stop) = (t, false);
        }
        Ok(())
    }

    /// Passes the stops up to the time. Returns the next stop; `end` if that is before it.
    fn stop(&mut self, end: f64) -> Stop {
        let passed = |stop: &Stop| !self.times.is_before(self.times.t, stop.t);
        let (passed, ahead) = self.stops.split_at(self.stops.partition_point(passed));
        if let Some(stop) = passed.last() {
            self.times.pass(*stop);
        }
        let next = ahead.first().copied();
        let next = next.filter(|stop| !self.times.is_before(end, stop.t));
        next.unwrap_or(Stop { t: end, jumps: false })
    }

    /// `at` ← the state at a time within the last step, by dense output.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time outside the last step, [`Error::Shape`] or [`Error::Length`] where `at` has another
    /// size than the state, [`RunError::Within`] where the point cannot be computed.
    pub fn interpolate(&mut self, t: f64, at: &mut PointOf<P>) -> Result<(), RunError> {
        at.check_sizes("at", &self.points.y)?;
        let place = self.times.known_place(&mut self.points, t)?;
        self.points.look(place, self.times.last, at).map_err(|source| self.times.no_point(source))
    }

    /// Sets the state, at the same time. The run continues from it, on its orbit. It must be on M. An adaptive run
    /// chooses a first step again.
    ///
    /// # Errors
    /// [`RunError::Changed`] for a state that is not on M; then the state is unchanged.
    pub fn set_state(&mut self, y: &PointOf<P>) -> Result<(), RunError> {
        let changed = self.points.change_to(y);
        self.times.changed("the caller", changed)
    }

    /// Goes to another earlier step, for a continuous solution.
    pub(super) fn look_at(&mut self, step: Step<f64>, from: &PointOf<P>) {
        self.points.start_at(from);
        self.times.last = step;
        self.times.looked_at = Looked::Stale;
    }

    /// `at` ← the dense output of the last step at t, before its end.
    pub(super) fn within(&mut self, t: f64, at: &mut PointOf<P>) -> Result<(), RunError> {
        let place = self.times.within(&mut self.points, t)?;
        self.points.look(place, self.times.last, at).map_err(|source| self.times.no_point(source))
    }
}
