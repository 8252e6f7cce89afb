//! The driver: many steps, of one size or by their error, with output, events and stops.
//!
//! [`Solve`] says what to do, [`Solution`] what came out, [`Integrator`] is a run in one's hands,
//! [`Continuous`] a solution that can be asked for any time. [`integrate`] and [`integrate_adaptive`] are the same
//! driver in one call, on a state in place.
//!
//! A step is accepted when its error is at most its tolerance ([`tolerance`](crate::tolerance)). A step that fails
//! (outside a chart, not finite) is rejected like one with too large an error, and halved: no result of it is used.
//! Until time has passed its end no step grows, so that a wall that cannot be passed is closed in on with one
//! rejection for each halving. With steps of one size a step that fails ends the run.

mod by_error;
mod continuous;
mod control;
mod drive;
mod events;
mod grid;
mod integrator;
mod save;
mod simple;
mod solution;
mod stats;
mod within;

pub use continuous::Continuous;
pub use control::StepControl;
pub use events::{Direction, Event};
pub use grid::{SaveAt, TimeGrid};
pub use integrator::Integrator;
pub use simple::{integrate, integrate_adaptive};
pub use solution::{Drift, Interrupted, Next, Occurrence, Solution, Status};
pub use stats::{RESTORE_EVERY, RunError, Stats};

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use crate::error::Error;
use crate::methods::{Embedded, Method};
use crate::problems::{Invariants, PointOf, Problem, ScalarOf};
use crate::space::Numbers;
use crate::tolerance::Rule;
use drive::{Checkpoints, Drive, Watch};
use integrator::{Estimator, Pace};
use save::Listing;

/// A run that is to be made: a problem, a method, a span, and what is asked for.
///
/// Steps are of one size ([`dt`](Self::dt), [`steps`](Self::steps)), or chosen by their error
/// ([`tolerances`](Self::tolerances) and the limits beside it). A wrong value is told by [`run`](Self::run).
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let run = Solve::new(&body, &Rkmk::new(DOPRI5, Exp), [0.0, 10.0])
///     .tolerances(1e-9, 1e-12)
///     .times([2.5, 5.0, 7.5])
///     .watch_invariants()
///     .run(Vector3::new(0.2, 0.0, 3.0))?;
/// assert_eq!(run.times, [2.5, 5.0, 7.5]);
/// assert!(run.drift.iter().all(|drift| drift.largest < 1e-8));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "solve_ivp")]
pub struct Solve<'a, P: Problem, M: Method<P>> {
    problem: &'a P,
    method: &'a M,
    t_span: [f64; 2],
    pace: Option<Pace<P, M>>,
    save: SaveAt,
    times_by_steps: bool,
    events: Vec<Event<'a, PointOf<P>>>,
    stops: Vec<f64>,
    max_steps: Option<u64>,
    cancel: Option<&'a AtomicBool>,
    progress: Option<Box<dyn FnMut(f64) + 'a>>,
    checkpoints: Option<Checkpoints<'a, P>>,
    resume: Option<(Listing<P>, Vec<u8>)>,
    watch: Option<Watch<P>>,
    /// The first value that was wrong.
    wrong: Option<Error>,
}

impl<P: Problem, M: Method<P>> core::fmt::Debug for Solve<'_, P, M> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Solve")
            .field("t_span", &self.t_span)
            .field("save", &self.save)
            .field("events", &self.events)
            .finish_non_exhaustive()
    }
}

impl<'a, P: Problem, M: Method<P>> Solve<'a, P, M> {
    /// Solve `problem` by `method` from t₀ to t₁, forward or backward. The span may be empty, and t₁ may be
    /// infinite where an event or an observer stops the run.
    pub fn new(problem: &'a P, method: &'a M, t_span: [f64; 2]) -> Self {
        Solve {
            problem,
            method,
            t_span,
            pace: None,
            save: SaveAt::End,
            times_by_steps: false,
            events: Vec::new(),
            stops: Vec::new(),
            max_steps: None,
            cancel: None,
            progress: None,
            checkpoints: None,
            resume: None,
            watch: None,
            wrong: None,
        }
    }

    fn or_wrong<T>(&mut self, value: Result<T, Error>) -> Option<T> {
        match value {
            Ok(value) => Some(value),
            Err(error) => {
                self.wrong.get_or_insert(error);
                None
            }
        }
    }

    fn equal(mut self, grid: Result<TimeGrid, Error>) -> Self {
        if let Some(grid) = self.or_wrong(grid) {
            if self.pace.is_some() {
                let why =
                    "the size of the steps was chosen already: give one of dt, steps, tolerances";
                self.wrong.get_or_insert(Error::out_of_range("dt", grid.h().abs(), why));
            }
            self.pace = Some(Pace::Equal { grid, max_steps: u64::MAX });
        }
        self
    }

    /// Steps of this size. Where it does not divide the span the last step is shorter.
    pub fn dt(self, dt: f64) -> Self {
        let grid = TimeGrid::new(self.t_span, dt);
        self.equal(grid)
    }

    /// So many steps of one size.
    pub fn steps(self, steps: u64) -> Self {
        let grid = TimeGrid::with_steps(self.t_span, steps);
        self.equal(grid)
    }

    /// The steps of this grid, and its span.
    pub fn grid(mut self, grid: TimeGrid) -> Self {
        self.t_span = grid.t_span();
        self.equal(Ok(grid))
    }

    /// Where points are shown or stored. The default is the end.
    pub fn save(mut self, save: SaveAt) -> Self {
        self.save = save;
        self
    }

    /// Output at these times and no others, by the continuous extension of the method.
    pub fn times(self, times: impl Into<Vec<f64>>) -> Self {
        self.save(SaveAt::Times(times.into()))
    }

    /// Output at the start, after every so many steps, and at the end.
    pub fn every(self, steps: u64) -> Self {
        self.save(SaveAt::Every(steps))
    }

    /// Output at the start, at equal intervals of this length from there on, and at the end.
    pub fn interval(self, length: f64) -> Self {
        self.save(SaveAt::Interval(length))
    }

    /// Output at both ends of so many equal intervals: 100 intervals have 101 times.
    ///
    /// ```
    /// use lieflow::prelude::*;
    /// use nalgebra::Matrix3;
    /// let turn = Flow::of_time(So3::new(), LeftTranslation, |t: f64, v| v.z = t);
    /// let method = Rkmk::new(DOPRI5, Exp);
    /// let solve = Solve::new(&turn, &method, [0.0, 2.0]).tolerances(1e-9, 1e-12);
    /// let run = solve.count(4).run(Matrix3::identity())?;
    /// assert_eq!(run.times, [0.0, 0.5, 1.0, 1.5, 2.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "linspace")]
    #[doc(alias = "t_eval")]
    pub fn count(mut self, intervals: u64) -> Self {
        let [t0, t1] = self.t_span;
        if intervals == 0 {
            self.wrong.get_or_insert(Error::out_of_range("count", 0.0, "at least 1"));
            return self;
        }
        self.interval((t1 - t0).abs() / intervals as f64)
    }

    /// Reach output times within a step by a shorter step of the method from its start, and not by the continuous
    /// extension. It costs a whole step for each time, and has the order of the method.
    pub fn times_by_steps(mut self) -> Self {
        self.times_by_steps = true;
        self
    }

    /// Look for the zeros of an event. Events are numbered in the order in which they are given.
    pub fn event(mut self, event: Event<'a, PointOf<P>>) -> Self {
        if event.stop_after == Some(0) {
            let arg = format!("stop_after of event `{}`", event.name);
            self.wrong.get_or_insert(Error::out_of_range(arg, 0.0, "at least 1"));
        }
        self.events.push(event);
        self
    }

    /// Let a step end at each of these times: where f or one of its derivatives jumps, as at the knots of sampled
    /// data. The step that ends there does not ask for f at that time, but a few rounding units before; the next one
    /// does: f(t) is the value after the jump. The times may lie outside the span, in any order.
    pub fn stops(mut self, times: impl Into<Vec<f64>>) -> Self {
        self.stops = times.into();
        self
    }

    /// End with an error after this many attempts. The default is a million, and no limit for steps of one size
    /// over a finite span.
    pub fn max_steps(mut self, attempts: u64) -> Self {
        if attempts == 0 {
            self.wrong.get_or_insert(Error::out_of_range("max_steps", 0.0, "at least 1"));
        }
        self.max_steps = Some(attempts);
        self
    }

    /// End when this is set, from another thread or a signal: the status is [`Status::Cancelled`].
    pub fn cancel(mut self, flag: &'a AtomicBool) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Tell the time to `progress` now and then: at least every thousand steps.
    pub fn progress(mut self, progress: impl FnMut(f64) + 'a) -> Self {
        self.progress = Some(Box::new(progress));
        self
    }

    /// Give the state of the run to `take` as bytes from time to time, between steps; after every step for a zero
    /// duration. A run that is cancelled gives it at its end, too. [`resume`](Self::resume) goes on from them.
    pub fn checkpoints(mut self, every: Duration, take: impl FnMut(&[u8]) + 'a) -> Self
    where
        PointOf<P>: Numbers,
    {
        let (take, last) = (Box::new(take), Instant::now());
        self.checkpoints = Some(Checkpoints { list: Numbers::each_number, every, take, last });
        self
    }

    /// Go on from a state that [`checkpoints`](Self::checkpoints) gave of the same run, to the same bits. What the
    /// run showed before is not shown again. Bytes that are damaged or of another run are refused by
    /// [`run`](Self::run).
    pub fn resume(mut self, bytes: impl Into<Vec<u8>>) -> Self
    where
        PointOf<P>: Numbers,
    {
        self.resume = Some((Numbers::each_number, bytes.into()));
        self
    }

    /// Report how far the invariants of the problem move, at the points of the output and at the end.
    pub fn watch_invariants(mut self) -> Self
    where
        P: Invariants,
        ScalarOf<P>: Into<f64>,
    {
        self.watch = Some(Watch {
            names: |problem| {
                problem.invariants().into_iter().map(|invariant| invariant.name).collect()
            },
            values: |problem, y| problem.values(y).into_iter().map(Into::into).collect(),
        });
        self
    }

    fn check(&mut self) -> Result<Pace<P, M>, Error> {
        grid::length_of(self.t_span)?;
        if let Some(error) = self.wrong.take() {
            return Err(error);
        }
        self.save.check(self.t_span)?;
        if let Some(i) = self.stops.iter().position(|t| t.is_nan()) {
            return Err(Error::out_of_range(format!("stops[{i}]"), f64::NAN, "a number"));
        }
        let Some(mut pace) = self.pace.clone() else {
            let expected = "one of dt, steps, or tolerances";
            return Err(Error::out_of_range("steps", f64::NAN, expected));
        };
        match &mut pace {
            Pace::Equal { max_steps, .. } => {
                let unbounded =
                    if self.t_span[1].is_finite() { u64::MAX } else { control::MAX_STEPS };
                *max_steps = self.max_steps.unwrap_or(unbounded);
            }
            Pace::ByError(control, _) => {
                control.max_steps = self.max_steps.unwrap_or(control.max_steps);
            }
        }
        let [t0, t1] = self.t_span;
        let forward = t1 >= t0;
        self.stops.retain(|t| if forward { t0 < *t && *t < t1 } else { t1 < *t && *t < t0 });
        self.stops.sort_by(|a, b| if forward { a.total_cmp(b) } else { b.total_cmp(a) });
        Ok(pace)
    }

    /// The run, in one's hands, from y₀. Output, events, stops and cancellation do not belong to it.
    ///
    /// # Errors
    /// [`RunError::Setup`] for what is wrong with the arguments.
    pub fn integrator(mut self, y0: PointOf<P>) -> Result<Integrator<'a, P, M>, RunError> {
        let pace = self.check()?;
        Ok(Integrator::new(self.problem, self.method, self.t_span, pace, y0)?)
    }

    /// Run from y₀, and store the points of the output.
    ///
    /// # Errors
    /// [`Interrupted`]: why, and the solution up to there.
    pub fn run(self, y0: PointOf<P>) -> Result<Solution<PointOf<P>>, Interrupted<PointOf<P>>> {
        let (mut times, mut points) = (Vec::new(), Vec::new());
        let done = self.run_with(y0, |t, y| {
            times.push(t);
            points.push(y.clone());
            Next::Continue
        });
        stored(done, times, points)
    }

    /// Run from y₀, and show (t, y) to an observer at the points of the output. It says whether to go on, to stop,
    /// or that it changed the state. No point is stored.
    ///
    /// # Errors
    /// [`Interrupted`]: why, and the solution up to there.
    pub fn run_with<N: Into<Next>>(
        mut self,
        y0: PointOf<P>,
        mut observe: impl FnMut(f64, &mut PointOf<P>) -> N,
    ) -> Result<Solution<PointOf<P>>, Interrupted<PointOf<P>>> {
        let pace = self.check()?;
        let run = Integrator::new(self.problem, self.method, self.t_span, pace, y0)?;
        Drive::new(self, run, |t, y| observe(t, y).into()).run()
    }

    /// Run from y₀, and keep what a continuous solution needs: a point for each step.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_continuous(
        mut self,
        y0: PointOf<P>,
    ) -> Result<Continuous<'a, P, M>, Interrupted<PointOf<P>>> {
        let pace = self.check()?;
        let again =
            Integrator::new(self.problem, self.method, self.t_span, pace.clone(), y0.clone())?;
        let run = Integrator::new(self.problem, self.method, self.t_span, pace, y0)?;
        let (mut times, mut points, mut steps) = (Vec::new(), Vec::new(), Vec::new());
        let mut drive = Drive::new(self, run, |t, y| {
            times.push(t);
            points.push(y.clone());
            Next::Continue
        });
        drive.keep(&mut steps);
        let solution = stored(drive.run(), times, points)?;
        Ok(Continuous::new(solution, steps, again))
    }
}

/// The result of a run with its output.
fn stored<Y>(
    mut done: Result<Solution<Y>, Interrupted<Y>>,
    times: Vec<f64>,
    points: Vec<Y>,
) -> Result<Solution<Y>, Interrupted<Y>> {
    let solution = match &mut done {
        Ok(solution) => Some(solution),
        Err(Interrupted { solution, .. }) => solution.as_deref_mut(),
    };
    if let Some(solution) = solution {
        (solution.times, solution.points) = (times, points);
    }
    done
}

/// The tolerances of a run when none are given.
const DEFAULT: (f64, f64) = (1e-6, 1e-9);

impl<P: Problem, M: Embedded<P>> Solve<'_, P, M>
where
    ScalarOf<P>: Into<f64>,
{
    /// Steps by their error, with these tolerances and limits.
    pub fn control(mut self, control: StepControl) -> Self {
        if let Some(Pace::Equal { grid, .. }) = &self.pace {
            let why = "the size of the steps was chosen already: give one of dt, steps, tolerances";
            let error = Error::out_of_range("dt", grid.h().abs(), why);
            self.wrong.get_or_insert(error);
        }
        self.pace = Some(Pace::ByError(control, Estimator::of_method()));
        self
    }

    fn with(mut self, change: impl FnOnce(StepControl) -> Result<StepControl, Error>) -> Self {
        let control = match &self.pace {
            Some(Pace::ByError(control, _)) => Ok(control.clone()),
            _ => StepControl::new(DEFAULT.0, DEFAULT.1),
        };
        match self.or_wrong(control.and_then(change)) {
            Some(control) => self.control(control),
            None => self,
        }
    }

    /// Steps by their error: rtol and atol for all parts of a point.
    pub fn tolerances(self, rtol: f64, atol: f64) -> Self {
        self.with(|control| {
            Ok(StepControl { tolerance: StepControl::new(rtol, atol)?.tolerance, ..control })
        })
    }

    /// Steps by their error: tolerances by part, by component, or by another rule.
    pub fn tolerance(self, tolerance: crate::tolerance::Tolerance) -> Self {
        self.with(|control| Ok(StepControl { tolerance, ..control }))
    }

    /// What rtol is relative to.
    pub fn rule(self, rule: Rule) -> Self {
        self.with(|control| Ok(control.rule(rule)))
    }

    /// Try this size first.
    pub fn first_step(self, h: f64) -> Self {
        self.with(|control| control.first_step(h))
    }

    /// Give up below this size, though not at the end of the span.
    pub fn min_step(self, h: f64) -> Self {
        self.with(|control| control.min_step(h))
    }

    /// Never take a step larger than this.
    pub fn max_step(self, h: f64) -> Self {
        self.with(|control| control.max_step(h))
    }
}
