//! Runs of a problem of any type: their arguments and their results.

mod drive;
mod following;
mod operations;
mod stepper;
mod types;

pub use operations::{CountOnVectors, Counting, counting};
pub use stepper::{NumbersOf, PointFrom, Points, StepByStep, Stepper};

use core::fmt::{self, Debug};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::groups::LieAlgebra;
use lieflow::names::same;
use lieflow::problems::PointOf;
use lieflow::solve::{Next, Status};
use lieflow::space::Numbers;
use lieflow::{Action, Direction, Error, RunError, SaveAt, Stats};

pub use lieflow::solve::{Steps, Stops};

use crate::schema::{Row, Schema};

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
    /// What changes the numbers of the point at each zero (as [`Outcome::state`] has them).
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
    /// The numbers of another point to start from (as [`Outcome::state`] has them).
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
    /// All its numbers, for [`Runnable::curve`].
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
    /// A point at which the choices of values ([`Branch`](crate::schema::Branch)) are followed. These points come in the order
    /// of time, and those of a step before its rows and events. `is_sure` is false where the values may have changed by half a
    /// turn and more since the point before.
    fn followed(&mut self, _t: f64, _row: Row<'_>, _is_sure: bool) {}
    /// The time that the run has reached. Called now and then.
    fn progress(&mut self, _t: f64) {}
    /// The state, to go on from.
    fn state(&mut self, _bytes: &[u8]) {}
    /// The end of a run that began, also of one that failed: the time, the numbers of the state, the row, and what the
    /// run did.
    fn end(&mut self, _t: f64, _state: &[f64], _row: Row<'_>, _stats: &Stats) {}
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
///
/// Each function is compiled in this crate, for each type of problem once.
pub trait Runnable:
    MethodsByName<
        Group: LieAlgebra<Scalar: Into<f64>, Alg: Numbers>,
        Action: Action<Self::Group, Point: Numbers>,
    > + Sized
    + Send
    + Sync
    + 'static
{
    /// Integrates `problem` from `y` by the method that `spec` names.
    ///
    /// # Errors
    /// As [`MethodsByName::method`] and [`Solve::run`](lieflow::Solve::run).
    fn drive(
        spec: &MethodSpec,
        problem: &Arc<Self>,
        y: PointOf<Self>,
        plan: Plan<'_>,
        rows: RowsOf<'_, Self>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError>;

    /// The run of a problem from y that the caller takes step by step.
    ///
    /// # Errors
    /// As [`MethodsByName::method`] and [`Solve::integrator`](lieflow::Solve::integrator).
    fn stepper(
        spec: &MethodSpec,
        problem: &Arc<Self>,
        y: PointOf<Self>,
        steps: StepByStep,
        points: Points<Self>,
    ) -> Result<Box<dyn Stepper>, RunError>;

    /// The curve of these numbers. `shared` makes the values of its rows, for a run that starts at a time.
    ///
    /// # Errors
    /// As [`MethodsByName::method`] and [`Interpolant::from_numbers`](lieflow::solve::Interpolant::from_numbers).
    fn curve(
        spec: &MethodSpec,
        problem: &Arc<Self>,
        like: &PointOf<Self>,
        numbers: &[f64],
        schema: &Schema,
        shared: &dyn Fn(f64) -> Box<SharedRowOf<Self>>,
    ) -> Result<Box<dyn RowCurve>, Error>;

    /// The orders of the method that `spec` names.
    ///
    /// # Errors
    /// As [`MethodsByName::method`].
    fn orders(&self, spec: &MethodSpec) -> Result<Orders, Error>;

    /// Can the method that `spec` names run on the problem?
    ///
    /// # Errors
    /// The reason why it cannot.
    fn fits(&self, spec: &MethodSpec, y: &PointOf<Self>) -> Result<Fit, Error>;

    /// The mean number of operations of a step from y, of a problem on matrices.
    fn operations(&self, spec: &MethodSpec, y: PointOf<Self>, steps: &Steps) -> Option<f64>;
}

/// A function that appends the numbers of the row at (t, y). It is behind a pointer, so that every kind with a type of
/// problem shares what is compiled for it.
pub type RowOf<'a, P> = dyn Fn(f64, &PointOf<P>, &mut Vec<f64>) + 'a;

/// The values of the row at (t, y), for a curve that outlives its run.
pub type SharedRowOf<P> = dyn Fn(f64, &PointOf<P>, &mut Vec<f64>) + Send + Sync;

/// The rows of a run: their schema, their numbers, and what makes their values for a curve.
#[allow(missing_debug_implementations)] // closures
pub struct RowsOf<'a, P: Runnable> {
    /// Their schema.
    pub schema: &'a Schema,
    /// What appends the numbers of a row.
    pub row_of: &'a RowOf<'a, P>,
    /// A bound of how fast the values with choices change at (t, y), in radians per time.
    pub turn_rate: &'a dyn Fn(f64, &PointOf<P>) -> f64,
    /// What makes the values of the rows of a curve.
    pub shared: &'a dyn Fn() -> Box<SharedRowOf<P>>,
    /// How the points are numbers: those of the start, of changes by events, and of the end.
    pub points: &'a Points<P>,
}

/// The numbers of a point, in the order of [`Numbers`].
pub fn numbers_of<Y: Numbers>(y: &mut Y) -> Vec<f64> {
    let mut numbers = Vec::new();
    y.each_number(&mut |x| numbers.push(*x));
    numbers
}

/// y ← the point of these numbers; `arg` names them.
///
/// # Errors
/// [`Error::Length`] for another number of them.
pub fn set_numbers<Y: Numbers>(y: &mut Y, arg: &str, numbers: &[f64]) -> Result<(), Error> {
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
