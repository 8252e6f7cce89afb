//! Runs that the caller takes step by step, of a problem of any type.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use lieflow::catalog::MethodSpec;
use lieflow::methods::AnyMethod;
use lieflow::problems::PointOf;
use lieflow::solve::{Integrator, Stops};
use lieflow::space::Numbers;
use lieflow::{Error, RunError, Solve, Stats};

use super::{Runnable, SharedRowOf, Steps};

/// A run that the caller takes step by step. It owns its problem.
pub trait Stepper: Send {
    /// The time.
    fn t(&self) -> f64;
    /// The end of the span.
    fn t_end(&self) -> f64;
    /// What the run did so far.
    fn stats(&self) -> Stats;
    /// Appends the values of the row at t.
    fn row(&self, values: &mut Vec<f64>);
    /// The numbers of the state, as [`Outcome::state`](super::Outcome::state) has them.
    fn state(&self) -> Vec<f64>;
    /// Sets the state at the same time. The run goes on from it.
    ///
    /// # Errors
    /// [`RunError`] for numbers that are no point; then the state is unchanged.
    fn set_state(&mut self, numbers: &[f64]) -> Result<(), RunError>;
    /// Takes one step, at most to the end of the span. Returns the time.
    ///
    /// # Errors
    /// As [`Integrator::step`].
    fn step(&mut self) -> Result<f64, RunError>;
    /// Takes steps until the time is t.
    ///
    /// # Errors
    /// As [`Integrator::advance_to`].
    fn advance_to(&mut self, t: f64) -> Result<(), RunError> {
        self.advance_for(t, Duration::MAX).map(drop)
    }
    /// Takes steps toward t for about this time on the clock. Returns true if t is reached.
    ///
    /// # Errors
    /// As [`Integrator::advance_to`].
    fn advance_for(&mut self, t: f64, limit: Duration) -> Result<bool, RunError>;
    /// Appends the values of the row at a time within the last step.
    ///
    /// # Errors
    /// As [`Integrator::interpolate`].
    fn interpolate(&mut self, t: f64, values: &mut Vec<f64>) -> Result<(), RunError>;
    /// The state as bytes.
    fn save(&mut self) -> Vec<u8>;
    /// Goes on from a state of [`save`](Self::save) of a run with the same problem, method and steps.
    ///
    /// # Errors
    /// As [`Integrator::restore`].
    fn restore(&mut self, bytes: &[u8]) -> Result<(), Error>;
}

/// The numbers of a point.
pub type NumbersOf<Y> = Box<dyn Fn(&Y) -> Vec<f64> + Send + Sync>;
/// Sets a point by its numbers.
pub type PointFrom<Y> = Box<dyn Fn(&[f64], &mut Y) -> Result<(), Error> + Send + Sync>;

/// A run that is taken step by step: its steps, and the times at which a step ends.
#[derive(Clone, Debug)]
pub struct StepByStep {
    /// The steps.
    pub steps: Steps,
    /// Times at which a step ends.
    pub stops: Stops,
    /// The limit of the attempts of a call, where it is not that of the library.
    pub max_steps: Option<u64>,
    /// While it is set, no attempt follows a failed one.
    pub cancel: Option<Arc<AtomicBool>>,
}

impl From<Steps> for StepByStep {
    fn from(steps: Steps) -> Self {
        StepByStep { steps, stops: Stops::default(), max_steps: None, cancel: None }
    }
}

/// How the points of a run are numbers.
#[allow(missing_debug_implementations)] // closures
pub struct Points<P: Runnable> {
    /// The values of the row.
    pub row_of: Box<SharedRowOf<P>>,
    /// Makes the numbers of a point. Without it they are the numbers of the row.
    numbers: Option<NumbersOf<PointOf<P>>>,
    /// The point of numbers.
    pub point: PointFrom<PointOf<P>>,
}

impl<P: Runnable> Points<P> {
    /// By the numbers of a point, and the point of numbers.
    pub fn by(
        row_of: Box<SharedRowOf<P>>,
        numbers: NumbersOf<PointOf<P>>,
        point: PointFrom<PointOf<P>>,
    ) -> Self {
        Points { row_of, numbers: Some(numbers), point }
    }

    /// The numbers of a point are those of its row.
    pub fn by_rows(row_of: Box<SharedRowOf<P>>, point: PointFrom<PointOf<P>>) -> Self {
        Points { row_of, numbers: None, point }
    }

    /// The numbers of a point.
    pub fn numbers_of(&self, t: f64, y: &PointOf<P>) -> Vec<f64> {
        if let Some(numbers) = &self.numbers {
            return numbers(y);
        }
        let mut numbers = Vec::new();
        (self.row_of)(t, y, &mut numbers);
        numbers
    }
}

/// A run of one type of problem.
struct Typed<P: Runnable> {
    run: Integrator<'static, P, AnyMethod<'static, P>>,
    /// A point to write to.
    at: PointOf<P>,
    points: Points<P>,
}

/// The run of a problem from y that the caller takes step by step.
///
/// # Errors
/// As [`MethodsByName::method`](lieflow::catalog::MethodsByName::method) and [`Solve::integrator`].
pub(super) fn stepper_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &Arc<P>,
    y: PointOf<P>,
    StepByStep { steps, stops, max_steps, cancel }: StepByStep,
    points: Points<P>,
) -> Result<Box<dyn Stepper>, RunError>
where
    Integrator<'static, P, AnyMethod<'static, P>>: Send,
    PointOf<P>: Send,
{
    let method = Arc::new(problem.method(spec)?);
    let solve = Solve::shared(problem.clone(), method, steps.t_span()).stops(stops);
    let solve = match steps {
        Steps::Equal(grid) => solve.grid(grid),
        Steps::ByError { control, .. } => solve.control(control),
    };
    let solve = match max_steps {
        Some(attempts) => solve.max_steps(attempts),
        None => solve,
    };
    let mut run = solve.integrator(y.clone())?;
    if let Some(flag) = cancel {
        run.cancel(flag);
    }
    Ok(Box::new(Typed { run, at: y, points }))
}

impl<P: Runnable> Stepper for Typed<P>
where
    Integrator<'static, P, AnyMethod<'static, P>>: Send,
    PointOf<P>: Send + Numbers,
{
    fn t(&self) -> f64 {
        self.run.t()
    }
    fn t_end(&self) -> f64 {
        self.run.t_end()
    }
    fn stats(&self) -> Stats {
        self.run.stats()
    }
    fn row(&self, values: &mut Vec<f64>) {
        (self.points.row_of)(self.run.t(), self.run.y(), values);
    }
    fn state(&self) -> Vec<f64> {
        self.points.numbers_of(self.run.t(), self.run.y())
    }
    fn set_state(&mut self, numbers: &[f64]) -> Result<(), RunError> {
        (self.points.point)(numbers, &mut self.at)?;
        self.run.set_state(&self.at)
    }
    fn step(&mut self) -> Result<f64, RunError> {
        self.run.step()
    }
    fn advance_for(&mut self, t: f64, limit: Duration) -> Result<bool, RunError> {
        self.run.advance_for(t, limit)
    }
    fn interpolate(&mut self, t: f64, values: &mut Vec<f64>) -> Result<(), RunError> {
        self.run.interpolate(t, &mut self.at)?;
        (self.points.row_of)(t, &self.at, values);
        Ok(())
    }
    fn save(&mut self) -> Vec<u8> {
        self.run.save()
    }
    fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.run.restore(bytes)
    }
}
