//! The driver: takes many steps, of one size or adaptive, with output, events and stops.
//!
//! | type or function | use |
//! |---|---|
//! | [`Solve`] | set up a run: problem, method, span, tolerances, output |
//! | [`Solution`] | the result |
//! | [`Integrator`] | take a run step by step |
//! | [`Continuous`] | a solution at any time |
//! | [`Interpolant`] | a solution at any time, as numbers |
//! | [`integrate`], [`integrate_adaptive`] | the same driver in one call, on a state in place |
//! | [`operations_of_a_step`] | count the operations of a method |
//!
//! A step is accepted if its error is at most its tolerance ([`tolerance`](crate::tolerance)). A step that fails
//! (outside a chart, not finite) is rejected like one with too large an error, and halved; none of its results is used.
//! Steps do not grow until time has passed the end of the failed step. So at a point that cannot be passed each halving
//! costs one rejection. With a fixed step size a step that fails ends the run.

mod bracket;
mod by_error;
mod checks;
mod continuous;
mod control;
mod drift;
mod drive;
mod ends;
mod events;
mod grid;
mod held;
mod integrator;
mod interpolant;
mod noise;
mod operations;
mod output;
mod points;
mod roots;
mod save;
mod search;
mod settings;
mod simple;
mod solution;
mod stats;
mod stops;
mod streak;
mod timeline;

pub use continuous::Continuous;
pub use control::StepControl;
pub use drift::Drift;
pub use events::{Event, LONG_STEPS};
pub use grid::{SaveAt, Steps, TimeGrid};
pub use integrator::Integrator;
pub use interpolant::{Interpolant, Reader};
pub use operations::{COUNTED_STEPS, operations_of_a_step};
pub use search::Direction;
pub use simple::{integrate, integrate_adaptive};
pub use solution::{Ended, Interrupted, Next, Occurrence, Solution, Status};
pub use stats::{RESTORE_EVERY, RunError, Stats};
pub use stops::Stops;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use crate::error::Error;
use crate::methods::{Embedded, Method};
use crate::problems::{Invariants, PointOf, Problem, ScalarOf};
use crate::space::Numbers;
use crate::tolerance::Rule;
use drive::Checkpoints;
use events::{EventFunctions, EventRule};
use held::Held;
use interpolant::Listing;
use output::{Keep, Observe, Output, SeeEnd, Watch};
use points::Estimator;
use search::{POINTS_MAX, Points};
use settings::Settings;

/// The settings of a run: a problem, a method, a span, steps, output and events.
///
/// The step size is fixed ([`dt`](Self::dt), [`steps`](Self::steps)) or adaptive ([`tolerances`](Self::tolerances) and
/// the limits, such as [`max_step`](Self::max_step)). [`run`](Self::run) returns an error for a wrong value.
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use lieflow::nalgebra::Vector3;
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
    problem: Held<'a, P>,
    method: Held<'a, M>,
    settings: Settings<'a>,
    /// For an adaptive step size.
    estimator: Option<Estimator<P, M>>,
    /// The events: what the driver knows of them, and their functions.
    rules: Vec<EventRule>,
    functions: Vec<EventFunctions<'a, PointOf<P>>>,
    /// The function that lists the numbers of a point, if the state is saved or restored.
    list: Option<Listing<P>>,
    watch: Option<Watch<P>>,
    see_end: Option<SeeEnd<'a, PointOf<P>>>,
}

impl<P: Problem, M: Method<P>> core::fmt::Debug for Solve<'_, P, M> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let events: Vec<&str> = self.rules.iter().map(|rule| rule.name.as_str()).collect();
        f.debug_struct("Solve")
            .field("t_span", &self.settings.t_span)
            .field("save", &self.settings.save)
            .field("events", &events)
            .finish_non_exhaustive()
    }
}

impl<'a, P: Problem, M: Method<P>> Solve<'a, P, M> {
    /// Solves `problem` by `method` from t₀ to t₁, forward or backward. The span may be empty. t₁ may be infinite if an
    /// event or an observer stops the run.
    pub fn new(problem: &'a P, method: &'a M, t_span: [f64; 2]) -> Self {
        Self::of(Held::Borrowed(problem), Held::Borrowed(method), t_span)
    }

    /// Solves a shared problem by a shared method, as [`new`](Self::new) does. So an [`Integrator`] or a [`Continuous`] may
    /// outlive the scope that made it, and move to another thread.
    ///
    /// ```
    /// use lieflow::prelude::*;
    /// use lieflow::problems::RigidBody;
    /// use lieflow::nalgebra::Vector3;
    /// use std::sync::Arc;
    ///
    /// let body = Arc::new(RigidBody::<f64>::new([1.0, 2.0, 3.0])?);
    /// let method = Arc::new(Rkmk::new(DOPRI5, Exp));
    /// let solve = Solve::shared(body, method, [0.0, 10.0]).tolerances(1e-9, 1e-12);
    /// let mut run = solve.integrator(Vector3::new(0.2, 0.0, 3.0))?;
    /// let thread = std::thread::spawn(move || run.advance_to(10.0).map(|m| m.norm()));
    /// assert!((thread.join().unwrap()? - 9.04f64.sqrt()).abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn shared(problem: Arc<P>, method: Arc<M>, t_span: [f64; 2]) -> Self {
        Self::of(Held::Shared(problem), Held::Shared(method), t_span)
    }

    fn of(problem: Held<'a, P>, method: Held<'a, M>, t_span: [f64; 2]) -> Self {
        let settings = Settings::new(t_span);
        Solve {
            problem,
            method,
            settings,
            estimator: None,
            rules: Vec::new(),
            functions: Vec::new(),
            list: None,
            watch: None,
            see_end: None,
        }
    }

    /// Sets a fixed step size. If it does not divide the span, the last step is shorter.
    pub fn dt(mut self, dt: f64) -> Self {
        self.settings.equal(TimeGrid::new(self.settings.t_span, dt));
        self
    }

    /// Sets the number of steps, all of one size.
    pub fn steps(mut self, steps: u64) -> Self {
        self.settings.equal(TimeGrid::with_steps(self.settings.t_span, steps));
        self
    }

    /// Takes the steps and the span of a grid.
    pub fn grid(mut self, grid: TimeGrid) -> Self {
        self.settings.t_span = grid.t_span();
        self.settings.equal(Ok(grid));
        self
    }

    /// Sets the points that are shown or stored. The default is the end only.
    pub fn save(mut self, save: SaveAt) -> Self {
        self.settings.count = None;
        self.settings.save = save;
        self
    }

    /// Sets the times of output. Times within a step come from dense output.
    pub fn times(self, times: impl Into<Vec<f64>>) -> Self {
        self.save(SaveAt::Times(times.into()))
    }

    /// Sets output at the start, at each multiple of this number of steps, and at the end.
    pub fn every(self, steps: u64) -> Self {
        self.save(SaveAt::Every(steps))
    }

    /// Sets output at the start, at equal intervals of this length from there on, and at the end.
    pub fn interval(self, length: f64) -> Self {
        self.save(SaveAt::Interval(length))
    }

    /// Sets output at both ends of this number of equal intervals: 100 intervals have 101 times.
    ///
    /// ```
    /// use lieflow::prelude::*;
    /// use lieflow::nalgebra::Matrix3;
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
        self.settings.count = Some(intervals);
        self
    }

    /// Computes output times within a step by a shorter step of the method, not by dense output. Each time costs a whole
    /// step, and has the order of the method.
    pub fn times_by_steps(mut self) -> Self {
        self.settings.times_by_steps = true;
        self
    }

    /// Adds an event. Events are numbered in the order in which they are added.
    pub fn event(mut self, event: Event<'a, PointOf<P>>) -> Self {
        if event.rule.stop_after == Some(0) {
            let arg = format!("stop_after of event `{}`", event.name());
            self.settings.wrong.get_or_insert(Error::out_of_range(arg, 0.0, "at least 1"));
        }
        if let Points::Each(points) = event.rule.points
            && points > POINTS_MAX
        {
            let arg = format!("points of event `{}`", event.name());
            let expected = format!("at most {POINTS_MAX} in each step");
            let error = Error::out_of_range(arg, f64::from(points), expected);
            self.settings.wrong.get_or_insert(error);
        }
        self.rules.push(event.rule);
        self.functions.push(event.functions);
        self
    }

    /// Lets a step end at each of these times, where f or one of its derivatives jumps.
    ///
    /// Where f jumps, f is not evaluated: it may have the value of either side there, or another one. The stages of the step
    /// that ends there are 4 ε|t| earlier than otherwise, those of the next step as much later. A step from one jump to the
    /// next has no such room. By error it is taken in two where ε|t| counts beside the tolerance. A step of one size is ε|t|
    /// shorter than the way, unless all stages are within a step, as those of Magnus methods
    /// ([`Facts`](crate::methods::Facts)). At times of a clock let such steps be shorter than the time between jumps. Where
    /// only derivatives of f jump ([`Stops::at_kinks`]), nothing is changed. [`Stops::at_knots`] has the times of samples.
    ///
    /// The times may be in any order, and also outside the span. The ends of the span count.
    pub fn stops(mut self, times: impl Into<Stops>) -> Self {
        self.settings.stops = times.into();
        self
    }

    /// Ends the run with an error after this many attempts. The default is a million. A fixed step size over a finite
    /// span has no limit. An [`Integrator`] has it for each call.
    pub fn max_steps(mut self, attempts: u64) -> Self {
        if attempts == 0 {
            let error = Error::out_of_range("max_steps", 0.0, "at least 1");
            self.settings.wrong.get_or_insert(error);
        }
        self.settings.max_steps = Some(attempts);
        self
    }

    /// Ends the run when the flag is set, from another thread or a signal. The status is [`Status::Cancelled`].
    ///
    /// The flag is read before each step and each row. Steps without rows or events are taken in calls of about 20 ms at
    /// most, and the flag is read between two calls. A run that is cancelled between two rows of a step has taken the step.
    pub fn cancel(mut self, flag: &'a AtomicBool) -> Self {
        self.settings.cancel = Some(flag);
        self
    }

    /// Calls `progress` with the time, each time before the flag of [`cancel`](Self::cancel) is read.
    pub fn progress(mut self, progress: impl FnMut(f64) + 'a) -> Self {
        self.settings.progress = Some(Box::new(progress));
        self
    }

    /// Calls a function with (t, y) at the end of each step that has rows within it, after these rows. So rows by dense
    /// output can be compared with ends of steps.
    pub fn ends_of_steps(mut self, see: impl FnMut(f64, &PointOf<P>) + 'a) -> Self {
        self.see_end = Some(Box::new(see));
        self
    }

    /// Calls `take` with the state of the run as bytes, between steps, at intervals of this duration.
    ///
    /// Zero means after every step. Otherwise the state is also saved between two rows of a step. A cancelled run also calls
    /// it at its end. [`resume`](Self::resume) continues from the
    /// bytes.
    pub fn checkpoints(mut self, every: Duration, take: impl FnMut(&[u8]) + 'a) -> Self
    where
        PointOf<P>: Numbers,
    {
        let (take, last) = (Box::new(take), Instant::now());
        self.list = Some(Numbers::each_number);
        self.settings.checkpoints = Some(Checkpoints { every, take, last });
        self
    }

    /// Continues from a state of the same run that [`checkpoints`](Self::checkpoints) saved, with the same results to
    /// the bit.
    ///
    /// Earlier output is not shown again. [`run`](Self::run) refuses bytes that are damaged or of another run.
    pub fn resume(mut self, bytes: impl Into<Vec<u8>>) -> Self
    where
        PointOf<P>: Numbers,
    {
        self.list = Some(Numbers::each_number);
        self.settings.resume = Some(bytes.into());
        self
    }

    /// Reports the drift of the invariants of the problem, at the points of the output and at the end.
    pub fn watch_invariants(mut self) -> Self
    where
        P: Invariants,
        ScalarOf<P>: Into<f64>,
    {
        self.watch = Some(Watch {
            invariants: Invariants::invariants,
            values: |problem, y| {
                let pairs = problem.values(y).into_iter().zip(problem.sizes(y));
                pairs.map(|(value, terms)| [value.into(), terms.into()]).collect()
            },
        });
        self
    }

    fn start(&mut self, y0: PointOf<P>) -> Result<Integrator<'a, P, M>, Error> {
        let pace = (self.settings.check()?, self.estimator);
        let held = (self.problem.clone(), self.method.clone());
        Integrator::new(held, self.settings.t_span, pace, y0)
    }

    /// Starts a run from y₀, or from the bytes of [`resume`](Self::resume), that you take step by step. It has stops, but no
    /// output, events or cancellation.
    ///
    /// # Errors
    /// [`RunError::Setup`] for wrong arguments.
    pub fn integrator(mut self, y0: PointOf<P>) -> Result<Integrator<'a, P, M>, RunError> {
        let resume = self.settings.resume.take();
        let mut run = self.start(y0)?;
        run.stops = core::mem::take(&mut self.settings.ends);
        if let Some(bytes) = resume {
            run.points.list = self.list;
            run.times.restore(&mut run.points, &bytes)?;
            run.times.ask_for(run.times.t1);
        }
        Ok(run)
    }

    /// Runs from y₀ and stores the points of the output.
    ///
    /// # Errors
    /// [`Interrupted`]: why, and the solution up to there.
    pub fn run(self, y0: PointOf<P>) -> Ended<PointOf<P>> {
        let (mut times, mut points) = (Vec::new(), Vec::new());
        let done = self.run_with(y0, |t, y| {
            times.push(t);
            points.push(y.clone());
            Next::Continue
        });
        stored(done, times, points)
    }

    /// Runs from y₀ and calls an observer with (t, y) at the points of the output. Stores no points.
    ///
    /// The observer returns whether the run goes on or stops, or that it changed the state.
    ///
    /// # Errors
    /// [`Interrupted`]: why, and the solution up to there.
    pub fn run_with<N: Into<Next>>(
        self,
        y0: PointOf<P>,
        mut observe: impl FnMut(f64, &mut PointOf<P>) -> N,
    ) -> Ended<PointOf<P>> {
        self.drive(y0, Keep::Nothing, &mut |t, y| observe(t, y).into())
    }

    /// Runs from y₀, and keeps the steps where there is a list for them.
    fn drive<'k>(
        mut self,
        y0: PointOf<P>,
        kept: Keep<'k, P>,
        observe: &'k mut Observe<'k, PointOf<P>>,
    ) -> Ended<PointOf<P>> {
        let Integrator { mut points, times, .. } = self.start(y0)?;
        points.list = self.list;
        let Solve { settings, rules, functions, watch, see_end, .. } = self;
        let mut drive = settings.drive(times, rules, kept.keeps());
        let mut output = Output::new(points, functions, (watch, see_end), kept, observe);
        let ended = drive.run(&mut output);
        let stats = drive.times.stats(&output.points);
        let Output { points, occurrences, .. } = output;
        Solution::of((drive.times.t, points.y), stats, drive.drift, occurrences).ended(ended)
    }

    /// Runs from y₀ and returns a continuous solution, which stores a point for each step.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_continuous(
        mut self,
        y0: PointOf<P>,
    ) -> Result<Continuous<'a, P, M>, Interrupted<PointOf<P>>> {
        let again = self.start(y0.clone())?;
        let (mut times, mut points, mut steps) = (Vec::new(), Vec::new(), Vec::new());
        let done = self.drive(y0, Keep::Starts(&mut steps), &mut |t, y| {
            times.push(t);
            points.push(y.clone());
            Next::Continue
        });
        let solution = stored(done, times, points)?;
        Ok(Continuous::new(solution, steps, again))
    }

    /// Runs from y₀ and returns the solution at all times as numbers, besides the result. It stores the start and eight
    /// elements of 𝔤 for each step. Cost: the extra stages of dense output in each step.
    ///
    /// # Errors
    /// As [`run`](Self::run); [`Error::Unsupported`] for a method whose points within a step are shorter steps.
    pub fn run_interpolant(
        self,
        y0: PointOf<P>,
    ) -> Result<SolutionWithCurve<'a, P, M>, Interrupted<PointOf<P>>>
    where
        PointOf<P>: Numbers,
    {
        let (mut times, mut points) = (Vec::new(), Vec::new());
        let (done, curve) = self.run_interpolant_with(y0, |t, y| {
            times.push(t);
            points.push(y.clone());
            Next::Continue
        });
        Ok((stored(done, times, points)?, curve))
    }

    /// Runs from y₀ with an observer, as [`run_with`](Self::run_with) does, and returns the end and the interpolant. An
    /// interrupted run has its interpolant up to there.
    pub fn run_interpolant_with<N: Into<Next>>(
        mut self,
        y0: PointOf<P>,
        mut observe: impl FnMut(f64, &mut PointOf<P>) -> N,
    ) -> (Ended<PointOf<P>>, Interpolant<'a, P, M>)
    where
        PointOf<P>: Numbers,
    {
        self.list = Some(Numbers::each_number);
        let held = (self.problem.clone(), self.method.clone());
        let (t0, start, mut pieces) = (self.settings.t_span[0], y0.clone(), Vec::new());
        let done = self.drive(y0, Keep::Pieces(&mut pieces), &mut |t, y| observe(t, y).into());
        let solution = match &done {
            Ok(solution) => Some(solution),
            Err(Interrupted { solution, .. }) => solution.as_deref(),
        };
        let end = solution.map_or((t0, start), |solution| (solution.t, solution.y.clone()));
        (done, Interpolant::new(held, pieces, end))
    }
}

/// The result of a run, or an error with the results so far.
fn stored<Y>(mut done: Ended<Y>, times: Vec<f64>, points: Vec<Y>) -> Ended<Y> {
    let solution = match &mut done {
        Ok(solution) => Some(solution),
        Err(Interrupted { solution, .. }) => solution.as_deref_mut(),
    };
    if let Some(solution) = solution {
        (solution.times, solution.points) = (times, points);
    }
    done
}

/// A solution, and the same at all times.
type SolutionWithCurve<'a, P, M> = (Solution<PointOf<P>>, Interpolant<'a, P, M>);

impl<P: Problem, M: Embedded<P>> Solve<'_, P, M>
where
    ScalarOf<P>: Into<f64>,
{
    /// Sets an adaptive step size with these tolerances and limits.
    pub fn control(mut self, control: StepControl) -> Self {
        self.settings.control(control);
        self.adaptive()
    }

    fn with(mut self, change: impl FnOnce(StepControl) -> Result<StepControl, Error>) -> Self {
        self.settings.with(change);
        self.adaptive()
    }

    fn adaptive(self) -> Self {
        Solve { estimator: Some(Estimator::of_method()), ..self }
    }

    /// Sets an adaptive step size, with rtol and atol for all parts of a point.
    pub fn tolerances(self, rtol: f64, atol: f64) -> Self {
        self.with(|control| {
            let rule = control.tolerance.rule();
            Ok(control.with_tolerance(StepControl::new(rtol, atol)?.tolerance.by(rule)))
        })
    }

    /// Sets an adaptive step size, with tolerances by part, by component, or by another rule.
    pub fn tolerance(self, tolerance: crate::tolerance::Tolerance) -> Self {
        self.with(|control| Ok(StepControl { tolerance, ..control }))
    }

    /// Sets what rtol is relative to.
    pub fn rule(self, rule: Rule) -> Self {
        self.with(|control| Ok(control.rule(rule)))
    }

    /// Sets the size of the first step.
    pub fn first_step(self, h: f64) -> Self {
        self.with(|control| control.first_step(h))
    }

    /// Ends the run with an error below this step size. The last two steps to the end of the span, to a stop or to a jump
    /// may be smaller.
    pub fn min_step(self, h: f64) -> Self {
        self.with(|control| control.min_step(h))
    }

    /// Sets the largest step size.
    pub fn max_step(self, h: f64) -> Self {
        self.with(|control| control.max_step(h))
    }
}
