//! Runs of a problem of any type: their arguments and their results.

use core::cell::RefCell;
use core::fmt::{self, Debug};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::groups::LieAlgebra;
use lieflow::methods::{AnyMethod, Facts, Method, Within};
use lieflow::names::same;
use lieflow::problems::PointOf;
use lieflow::solve::{Interpolant, Interrupted, LONG_STEPS, Next, Solution, Status};
use lieflow::space::Numbers;
use lieflow::{Action, Direction, Error, Event, RunError, SaveAt, Solve, Stats};

pub use lieflow::solve::{Steps, Stops};

use super::following::following;
use crate::schema::{Branches, Row, Schema};

/// Which code a problem runs on. Methods that stay on the group agree on the two to rounding; the
/// stages of a classical one leave it, and what it makes of an attitude agrees to its order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// Closed formulas on so(3) ≅ ℝ³.
    #[default]
    Closed,
    /// Matrices of any size.
    General,
}

impl Layer {
    /// Every layer.
    pub const ALL: [Layer; 2] = [Layer::Closed, Layer::General];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Layer::Closed => "closed",
            Layer::General => "general",
        }
    }

    /// The layer of that name.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn named(name: &str) -> Result<Self, Error> {
        Self::ALL.into_iter().find(|layer| same(layer.name(), name)).ok_or_else(|| {
            let expected = Self::ALL.map(Layer::name).to_vec();
            Error::UnknownName { kind: "layer", name: name.into(), expected }
        })
    }
}

/// An event: where a function of the rows passes zero.
pub struct EventPlan<'a> {
    /// Its name.
    pub name: String,
    /// The places in a row of the numbers that the function needs; others may be anything.
    pub places: Vec<usize>,
    /// The function of t and the row.
    pub value: Box<dyn Fn(f64, Row<'_>) -> f64 + 'a>,
    /// Which zeros count.
    pub direction: Direction,
    /// The zero that ends the run, from 1.
    pub stop_after: Option<u64>,
    /// The number of points within each step where the function is evaluated; that of the library where there is none.
    pub points: Option<u32>,
    /// What changes the numbers of the point at each zero ([`Model::start`](super::Model::start) has their order).
    pub change: Option<Change<'a>>,
}

/// What changes the numbers of a point at time t.
pub type Change<'a> = Box<dyn FnMut(f64, &mut [f64]) + 'a>;

impl<'a> EventPlan<'a> {
    /// An event that every zero counts for, and that no zero ends.
    pub fn new(
        name: impl Into<String>,
        places: Vec<usize>,
        value: impl Fn(f64, Row<'_>) -> f64 + 'a,
    ) -> Self {
        EventPlan {
            name: name.into(),
            places,
            value: Box::new(value),
            direction: Direction::Both,
            stop_after: None,
            points: None,
            change: None,
        }
    }
}

impl Debug for EventPlan<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EventPlan").field("name", &self.name).finish_non_exhaustive()
    }
}

/// Everything that a run is asked for besides the problem and the method.
#[derive(Debug)]
pub struct Plan<'a> {
    /// The steps.
    pub steps: Steps,
    /// Where rows are shown.
    pub save: SaveAt,
    /// Are output times reached by shorter steps, and not by the continuous extension?
    pub times_by_steps: bool,
    /// Times at which a step ends.
    pub stops: Stops,
    /// The events.
    pub events: Vec<EventPlan<'a>>,
    /// The limit of the attempts, where it is not that of the library.
    pub max_steps: Option<u64>,
    /// What cancels the run.
    pub cancel: Option<&'a AtomicBool>,
    /// How often the state is saved.
    pub checkpoints: Option<Duration>,
    /// The state to go on from.
    pub resume: Option<Vec<u8>>,
    /// The numbers of another point to start from ([`Model::start`](super::Model::start) has their order).
    pub start: Option<Vec<f64>>,
    /// The place of the rows at all times, if they are kept. A method whose points within a step call f again is refused.
    pub curve: Option<CurvePlace<'a>>,
}

/// The place where a run leaves its rows at all times.
pub struct CurvePlace<'a>(pub &'a mut Option<Box<dyn RowCurve>>);

impl Debug for CurvePlace<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("CurvePlace")
    }
}

/// The rows of a run at all times. f is not called.
pub trait RowCurve: Send + Sync {
    /// The first and the last time.
    fn t_span(&self) -> [f64; 2];
    /// The number of steps.
    fn steps(&self) -> usize;
    /// Appends the values of the schema at these times to `values`, one row after the other.
    ///
    /// # Errors
    /// The number of the time that failed, and why: a time outside of the run.
    fn rows(&self, times: &[f64], values: &mut Vec<f64>) -> Result<(), (usize, RunError)>;
    /// All its numbers, for [`Model::curve`](super::Model::curve).
    fn numbers(&self) -> Vec<f64>;
}

impl Plan<'_> {
    /// These steps and rows, and nothing else.
    pub fn new(steps: Steps, save: SaveAt) -> Self {
        Plan {
            steps,
            save,
            times_by_steps: false,
            stops: Stops::default(),
            events: Vec::new(),
            max_steps: None,
            cancel: None,
            checkpoints: None,
            resume: None,
            start: None,
            curve: None,
        }
    }

    /// The number of rows, where it is known before the run. It is not known where an event may end the run, and where
    /// the rows are those of steps that are chosen by their error.
    pub fn rows(&self) -> Option<u64> {
        let [t0, t1] = self.steps.t_span();
        let may_end_early = self.events.iter().any(|event| event.stop_after.is_some());
        match (&self.save, &self.steps) {
            (SaveAt::End, _) => Some(1),
            (SaveAt::Ends, _) => Some(2),
            (SaveAt::Times(times), _) => Some(times.len() as u64),
            (SaveAt::TimesAndEnds(times), _) => {
                let ends = [t0, t1].into_iter().filter(|t| t.is_finite() && !times.contains(t));
                Some((times.len() + ends.count()) as u64)
            }
            _ if may_end_early || !t1.is_finite() => None,
            // An interval that is left of rounding alone has no row.
            (SaveAt::Interval(length), _) => {
                Some(1 + ((t1 - t0).abs() / length - 1e-9).ceil() as u64)
            }
            (SaveAt::Every(every), Steps::Equal(grid)) => {
                let steps = grid.steps() + self.stops.len() as u64;
                Some(1 + steps.div_ceil(*every))
            }
            _ => None,
        }
    }
}

/// What gets the rows of a run, each with its t.
pub type Sink<'a> = dyn FnMut(f64, Row<'_>) + 'a;

/// What sees a run.
pub trait Watcher {
    /// A row of the output.
    fn row(&mut self, t: f64, row: Row<'_>) -> Next;
    /// A zero of the event of this number.
    fn event(&mut self, _event: usize, _t: f64, _rising: bool, _row: Row<'_>) {}
    /// The end of a step that had rows within it, after these.
    fn end_of_step(&mut self, _t: f64, _row: Row<'_>) {}
    /// A point at which the choices of values ([`Branch`](crate::schema::Branch)) are followed.
    fn followed(&mut self, _t: f64, _row: Row<'_>) {}
    /// The time that the run has reached. Called now and then.
    fn progress(&mut self, _t: f64) {}
    /// The state, to go on from.
    fn state(&mut self, _bytes: &[u8]) {}
    /// The end of a run that began, also of one that failed: the time, and what the run did.
    fn end(&mut self, _t: f64, _stats: &Stats) {}
}

/// A sink as a watcher.
#[allow(missing_debug_implementations)] // a closure
pub struct Rows<'a, 'b>(pub &'a mut Sink<'b>);

impl Watcher for Rows<'_, '_> {
    fn row(&mut self, t: f64, row: Row<'_>) -> Next {
        (self.0)(t, row);
        Next::Continue
    }
}

/// What a run did, and why it ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The time at the end.
    pub t: f64,
    /// Why the run ended.
    pub status: Status,
    /// What it did.
    pub stats: Stats,
    /// The numbers of the state at the end. Another run may start from them ([`Plan::start`]).
    pub state: Vec<f64>,
    /// The numbers of the row at the end.
    pub row: Vec<f64>,
}

/// What is known of a method on a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orders {
    /// The order of its steps; none if they are exact.
    pub step: Option<usize>,
    /// The order of the points within a step.
    pub within: usize,
    /// True if steps, and the points within them, stay on M.
    pub stays_on_manifold: bool,
}

/// What a method offers on a problem that it runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fit {
    /// True if the points within a step can be kept as numbers: for steps of given size, and for steps by error.
    pub keeps_points: [bool; 2],
}

/// A problem that runs are made of: its methods by name, on numbers that a file can hold.
pub trait Runnable:
    MethodsByName<
        Group: LieAlgebra<Scalar: Into<f64>, Alg: Numbers>,
        Action: Action<Self::Group, Point: Numbers>,
    > + Send
    + Sync
    + 'static
{
}
impl<P> Runnable for P where
    P: MethodsByName<
            Group: LieAlgebra<Scalar: Into<f64>, Alg: Numbers>,
            Action: Action<<P as lieflow::Problem>::Group, Point: Numbers>,
        > + Send
        + Sync
        + 'static
{
}

/// The numbers of the row at (t, y). Behind a pointer, so that every kind with a type of problem shares
/// what is compiled for it.
pub type RowOf<'a, P> = dyn Fn(f64, &PointOf<P>, &mut Vec<f64>) + 'a;

/// The values of the row at (t, y), for a curve that outlives its run.
pub type SharedRowOf<P> = dyn Fn(f64, &PointOf<P>, &mut Vec<f64>) + Send + Sync;

/// The rows of a run: their schema, their numbers, and what makes their values for a curve.
pub(crate) struct RowsOf<'a, P: Runnable> {
    pub(crate) schema: &'a Schema,
    pub(crate) row_of: &'a RowOf<'a, P>,
    /// How fast the state turns at (t, y), in radians per time.
    pub(crate) turn_rate: &'a dyn Fn(f64, &PointOf<P>) -> f64,
    pub(crate) shared: &'a dyn Fn() -> Box<SharedRowOf<P>>,
}

/// The rows of a run of this type of problem at all times.
struct CurveOf<P: Runnable> {
    points: Interpolant<'static, P, AnyMethod<'static, P>>,
    row_of: Box<SharedRowOf<P>>,
    branches: Branches,
}

impl<P: Runnable> RowCurve for CurveOf<P> {
    fn t_span(&self) -> [f64; 2] {
        self.points.t_span()
    }
    fn steps(&self) -> usize {
        self.points.steps()
    }
    fn rows(&self, times: &[f64], values: &mut Vec<f64>) -> Result<(), (usize, RunError)> {
        let mut reader = self.points.reader().map_err(|error| (0, error.into()))?;
        for (i, &t) in times.iter().enumerate() {
            let row = values.len();
            (self.row_of)(t, reader.at(t).map_err(|error| (i, error))?, values);
            self.branches.follow_known(t, &mut values[row..]);
        }
        Ok(())
    }
    /// Those of the points, those of the choices, and how many the last are.
    fn numbers(&self) -> Vec<f64> {
        let (mut numbers, choices) = (self.points.numbers(), self.branches.numbers());
        numbers.extend_from_slice(&choices);
        numbers.push(choices.len() as f64);
        numbers
    }
}

/// The curve of these numbers. `shared` makes the values of its rows, for a run that starts at a time.
///
/// # Errors
/// As [`MethodsByName::method`] and [`Interpolant::from_numbers`].
pub(crate) fn curve_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &Arc<P>,
    like: &PointOf<P>,
    numbers: &[f64],
    schema: &Schema,
    shared: &dyn Fn(f64) -> Box<SharedRowOf<P>>,
) -> Result<Box<dyn RowCurve>, Error> {
    let method = Arc::new(problem.method(spec)?);
    let (choices, numbers) = numbers
        .split_last()
        .map_or((0, numbers), |(&choices, numbers)| (choices as usize, numbers));
    let (numbers, choices) = numbers.split_at(numbers.len().saturating_sub(choices));
    let points = Interpolant::from_numbers(problem.clone(), method, like, numbers)?;
    let mut branches = Branches::new(schema, points.t_span());
    branches.set_numbers(choices);
    let row_of = shared(points.t_span()[0]);
    Ok(Box::new(CurveOf { points, row_of, branches }))
}

/// Integrate `problem` from `y` by the method that `spec` names: see [`Model::drive`](super::Model::drive).
///
/// # Errors
/// As [`MethodsByName::method`] and [`Solve::run`].
pub(crate) fn drive_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &Arc<P>,
    y: PointOf<P>,
    plan: Plan<'_>,
    RowsOf { schema, row_of, turn_rate, shared }: RowsOf<'_, P>,
    watcher: &mut dyn Watcher,
) -> Result<Outcome, RunError> {
    let method = Arc::new(problem.method(spec)?);
    let Plan { steps, save, times_by_steps, stops, .. } = plan;
    let Plan { events, max_steps, cancel, checkpoints, resume, curve, .. } = plan;
    let (watcher, numbers) = (RefCell::new(watcher), RefCell::new(Vec::new()));
    let mut branches = Branches::new(schema, steps.t_span());
    let resume = resume.map(|bytes| branches.take_from(bytes));
    if curve.is_some() {
        branches.keep_all();
    }
    let branches = RefCell::new(branches);
    let fill = |t: f64, y: &PointOf<P>| {
        let mut numbers = numbers.borrow_mut();
        row_of(t, y, &mut numbers);
        branches.borrow_mut().follow(t, &mut numbers);
    };
    let gap = schema.longest_gap();
    let is_long = method.facts(problem).order >= LONG_STEPS;
    let [t0, t1] = steps.t_span();
    let mut solve = Solve::shared(problem.clone(), method, steps.t_span()).save(save).stops(stops);
    solve = match steps {
        Steps::Equal(grid) => solve.grid(grid),
        Steps::ByError { control, .. } => solve.control(match gap {
            Some(gap) if gap < control.longest_step() => {
                control.clone().max_step(gap).unwrap_or(control)
            }
            _ => control,
        }),
    };
    if times_by_steps {
        solve = solve.times_by_steps();
    }
    if let Some(attempts) = max_steps {
        solve = solve.max_steps(attempts);
    }
    if let Some(flag) = cancel {
        solve = solve.cancel(flag);
    }
    if let Some(bytes) = resume {
        solve = solve.resume(bytes);
    }
    if let Some(every) = checkpoints {
        solve = solve.checkpoints(every, |bytes| {
            watcher.borrow_mut().state(&branches.borrow().append_to(bytes));
        });
    }
    let (fill, numbers) = (&fill, &numbers);
    let follow = &|t: f64, y: &PointOf<P>| {
        fill(t, y);
        watcher.borrow_mut().followed(t, schema.row(&numbers.borrow()));
    };
    if !branches.borrow().is_empty() {
        let least = gap.map_or(0.0, |gap| 1.0 / gap);
        let rate = move |t: f64, y: &PointOf<P>| turn_rate(t, y).max(least);
        solve = solve.event(following(follow, rate, [t1 > t0, is_long]));
    }
    for (index, event) in events.into_iter().enumerate() {
        let EventPlan { name, value, direction, stop_after, points, change, .. } = event;
        let (watcher, branches, changes) = (&watcher, &branches, change.is_some());
        let mut event = Event::new(name, move |t, y: &PointOf<P>| {
            fill(t, y);
            value(t, schema.row(&numbers.borrow()))
        })
        .direction(direction)
        .tell(move |t, y, rising| {
            fill(t, y);
            let numbers = numbers.borrow();
            if changes {
                branches.borrow_mut().cut(t, &numbers);
            }
            watcher.borrow_mut().event(index, t, rising, schema.row(&numbers));
        });
        if let Some(count) = stop_after {
            event = event.stop_after(count);
        }
        if let Some(points) = points {
            event = event.points(points);
        }
        if let Some(mut change) = change {
            event = event.change(move |t, y| {
                let mut numbers = numbers_of(y);
                change(t, &mut numbers);
                let mut next = numbers.into_iter();
                y.each_number(&mut |x| *x = next.next().unwrap_or(*x));
            });
        }
        solve = solve.event(event);
    }
    let solve = solve.progress(|t| watcher.borrow_mut().progress(t)).ends_of_steps(|t, y| {
        fill(t, y);
        watcher.borrow_mut().end_of_step(t, schema.row(&numbers.borrow()));
    });
    let see = |t: f64, y: &mut PointOf<P>| {
        fill(t, y);
        watcher.borrow_mut().row(t, schema.row(&numbers.borrow()))
    };
    let done = match curve {
        None => solve.run_with(y, see),
        Some(CurvePlace(place)) => {
            let (done, points) = solve.run_interpolant_with(y, see);
            *place = points.into_shared().map(|points| {
                let branches = branches.borrow().clone().of_run();
                Box::new(CurveOf { points, row_of: shared(), branches }) as Box<dyn RowCurve>
            });
            done
        }
    };
    let end = match &done {
        Ok(done) => Some(done),
        Err(Interrupted { solution, .. }) => solution.as_deref(),
    };
    if let Some(end) = end {
        watcher.borrow_mut().end(end.t, &end.stats);
    }
    let Solution { t, mut y, status, stats, .. } = done?;
    fill(t, &y);
    Ok(Outcome { t, status, stats, state: numbers_of(&mut y), row: numbers.take() })
}

/// The numbers of a point, in the order of [`Numbers`].
pub(crate) fn numbers_of<Y: Numbers>(y: &mut Y) -> Vec<f64> {
    let mut numbers = Vec::new();
    y.each_number(&mut |x| numbers.push(*x));
    numbers
}

/// y ← the point of these numbers; `arg` names them.
///
/// # Errors
/// [`Error::Length`] for another number of them.
pub(crate) fn set_numbers<Y: Numbers>(y: &mut Y, arg: &str, numbers: &[f64]) -> Result<(), Error> {
    let mut count = 0;
    y.each_number(&mut |_| count += 1);
    if numbers.len() != count {
        let (found, expected) = (numbers.len(), format!("{count}, the length of a state"));
        return Err(Error::Length { arg: arg.into(), found, expected });
    }
    let mut next = numbers.iter();
    y.each_number(&mut |x| *x = next.next().copied().unwrap_or(*x));
    Ok(())
}

/// The orders of the method that `spec` names: see [`Model::orders`](super::Model::orders).
///
/// # Errors
/// As [`MethodsByName::method`].
pub fn orders_by<P: Runnable>(spec: &MethodSpec, problem: &P) -> Result<Orders, Error> {
    let method = problem.method(spec)?;
    let Facts { order, dense_order, stays_on_manifold, .. } = method.facts(problem);
    let step = (order != usize::MAX).then_some(order);
    Ok(Orders { step, within: dense_order, stays_on_manifold })
}

/// Can the method that `spec` names run on the problem? See [`Model::fits`](super::Model::fits).
///
/// # Errors
/// The reason why it cannot.
pub fn fits_by<P: Runnable>(spec: &MethodSpec, problem: &P, y: &PointOf<P>) -> Result<Fit, Error> {
    let method = problem.method(spec)?;
    let keeps_points = method.within(&method.work(problem, y)?) != Within::Steps;
    Ok(Fit { keeps_points: [keeps_points, keeps_points && method.has_pair(problem)] })
}
