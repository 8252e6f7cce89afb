//! From what is particular to a kind, [`System`], to the form of a problem that any method runs on.

use core::fmt::{self, Debug};
use std::sync::{Arc, OnceLock};

use lieflow::catalog::MethodSpec;
use lieflow::solve::Stops;
use lieflow::space::check_within_reach;
use lieflow::tolerance::Tolerance;
use lieflow::{Error, RunError};
use lieflow_runs::run::{
    CountOnVectors, Counting, Fit, Layer, Orders, Outcome, Plan, Points, RowCurve, RowsOf,
    Runnable, SharedRowOf, StepByStep, Stepper, Steps, Watcher, numbers_of, set_numbers,
};
use lieflow_runs::schema::{Law, Schema};
use nalgebra::Matrix3;

use super::forms::{Asked, Form, Forms, Run};
use super::kind::{Figure, PrincipalInertia, Property, high_order};
use super::quantity::{Moment, Quantity, Value};
use crate::formula::Formula;
use crate::reader::Refusal;

/// A problem with the point that it starts from.
pub(crate) type Start<P> = (P, lieflow::problems::PointOf<P>);

/// A point of a system.
pub(crate) type PointOf<S> = lieflow::problems::PointOf<<S as System>::Problem>;

/// A problem of one kind, as its scene states it and checked: what the kind's file is about.
pub(crate) trait System: Clone + Debug + Send + Sync + 'static {
    /// The problem of the library.
    type Problem: Runnable;
    /// The quantities, in the order of listings.
    const QUANTITIES: &'static [Quantity<Self>];
    /// The quantities that make up the state.
    const STATE: &'static [&'static str];
    /// The method where a scene names none, of a kind that needs another one than the rest.
    const DEFAULT_METHOD: Option<&'static str> = None;

    /// The layer that it is made of.
    fn layer(&self) -> Layer {
        Layer::General
    }
    /// The problem, and y(t₀).
    ///
    /// # Errors
    /// What the library refuses.
    fn problem(&self) -> Result<Start<Self::Problem>, Error>;
    /// What is integrated, in words.
    fn modelled(&self) -> String;
    /// The problem of a kind on vectors, on numbers that count operations. None for a kind on matrices: they report their
    /// operations on `f64`.
    fn counted(&self) -> Option<Counting> {
        None
    }
    /// See [`Problem::check_start`](super::Problem::check_start).
    fn check_start(&self, _t0: f64) -> Vec<Refusal> {
        Vec::new()
    }
    /// See [`Problem::formula`](super::Problem::formula).
    fn formula(&self) -> Option<&Formula> {
        None
    }
    /// See [`Problem::knots`](super::Problem::knots).
    fn knots(&self, t_span: [f64; 2]) -> Option<Stops> {
        let samples = self.formula()?.samples()?;
        Some(Stops::at_knots(samples, t_span))
    }
    /// The axes of the body in the frame in which it is stated, where these differ, and what turns a point to other axes. The
    /// numbers of a point are read and set in the frame in which the problem is stated.
    fn axes_of_points(&self) -> Option<(Matrix3<f64>, Turned<Self>)> {
        None
    }
    /// Checks a state that a run goes on from in place of its own, which is called `arg`: is it on M, to 1e-6 of its size?
    /// What the group and the action refuse is left to them. Its numbers are finite.
    ///
    /// # Errors
    /// Mostly [`Error::OutOfRange`], with the number that is not as it is on M.
    fn check_state(&self, _arg: &str, _y: &PointOf<Self>) -> Result<(), Error> {
        Ok(())
    }
    /// y at the end of a span, where it is known.
    fn exact(&self, _t_span: [f64; 2]) -> Option<Result<PointOf<Self>, Error>> {
        None
    }
    /// The figure of a run.
    fn figure(&self) -> Figure {
        Figure::Lines(Self::STATE[0])
    }
    /// See [`Problem::inertia`](super::Problem::inertia).
    fn inertia(&self) -> Option<PrincipalInertia> {
        None
    }
    /// See [`Problem::rate`](super::Problem::rate).
    fn rate(&self) -> Option<f64> {
        None
    }
    /// The field that [`Figure::Map`] draws, from its quantity: rows from north to south, columns from
    /// west to east.
    fn field(&self, _values: &[f64]) -> Vec<Vec<f64>> {
        Vec::new()
    }
    /// What is known before any run.
    fn facts(&self) -> Vec<Property> {
        Vec::new()
    }
    /// See [`Problem::warnings`](super::Problem::warnings).
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
    /// See [`Problem::notes`](super::Problem::notes).
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// The point with the axes of the body turned by this rotation.
pub(crate) type Turned<S> = fn(&S, &PointOf<S>, &Matrix3<f64>) -> PointOf<S>;

/// The numbers of a point, in the frame in which the problem is stated and in the order of
/// [`Numbers`](lieflow::space::Numbers).
fn numbers<S: System>(system: &S, y: &PointOf<S>) -> Vec<f64> {
    let mut y = match system.axes_of_points() {
        None => y.clone(),
        Some((axes, turned)) => turned(system, y, &axes),
    };
    numbers_of(&mut y)
}

/// y ← the point of these [`numbers`], which are called `arg`: a start, what an event makes of the state, or what the caller of
/// a run sets.
///
/// # Errors
/// [`Error::Length`] for another number of them, and [`System::check_state`].
fn set_point<S: System>(
    system: &S,
    y: &mut PointOf<S>,
    arg: &str,
    numbers: &[f64],
) -> Result<(), Error> {
    set_numbers(y, arg, numbers)?;
    if let Some((axes, turned)) = system.axes_of_points() {
        *y = turned(system, y, &axes.transpose());
    }
    // A run refuses other numbers.
    match numbers.iter().all(|x| x.is_finite()) {
        true => system.check_state(arg, y),
        false => Ok(()),
    }
}

/// A problem that is set up, with its start.
type Ready<S> = (Arc<<S as System>::Problem>, PointOf<S>);

/// A system as a form of its problem. Its problem is set up when it is needed first.
struct On<S: System> {
    system: S,
    ready: OnceLock<Result<Ready<S>, Error>>,
}

impl Forms {
    /// The form of a system, and what is known of it.
    pub(crate) fn of<S: System>(system: S) -> Forms {
        let default_method =
            S::DEFAULT_METHOD.map_or_else(high_order, |name| MethodSpec::new(name, None));
        let (formula, inertia, facts) =
            (system.formula().cloned(), system.inertia(), system.facts());
        let (warnings, notes, rate) = (system.warnings(), system.notes(), system.rate());
        let (layer, figure) = (system.layer(), system.figure());
        let run = Arc::new(On { system, ready: OnceLock::new() });
        let form = Form { layer, whole_state: false, state: S::STATE, figure, run };
        Forms { default_method, formula, inertia, rate, facts, warnings, notes, ..Forms::one(form) }
    }
}

impl<S: System> Debug for On<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.system.fmt(f)
    }
}

/// The values of the quantities of these numbers at y go to the end of `numbers`.
fn append_values<S: System>(
    system: &S,
    quantities: &[usize],
    at: Moment,
    y: &PointOf<S>,
    numbers: &mut Vec<f64>,
) {
    for &quantity in quantities {
        match S::QUANTITIES[quantity].value {
            Value::Number(value) => numbers.push(value(system, at, y)),
            Value::Numbers(values) => values(system, at, y, numbers),
        }
    }
}

impl<S: System> On<S> {
    /// The problem and its start.
    fn ready(&self) -> Result<&Ready<S>, Error> {
        let ready = || self.system.problem().map(|(problem, start)| (Arc::new(problem), start));
        self.ready.get_or_init(ready).as_ref().map_err(Error::clone)
    }

    /// The start, or the point of these numbers.
    fn start_at(&self, numbers: Option<&[f64]>) -> Result<PointOf<S>, Error> {
        let mut y = self.ready()?.1.clone();
        if let Some(numbers) = numbers {
            set_point(&self.system, &mut y, "y0", numbers)?;
        }
        Ok(y)
    }

    /// What appends the values of these quantities, for what outlives a run that starts at t0.
    fn shared(&self, quantities: &[usize], t0: f64) -> Box<SharedRowOf<S::Problem>> {
        let (system, quantities) = (self.system.clone(), quantities.to_vec());
        Box::new(move |t, y, numbers| {
            append_values(&system, &quantities, Moment::of_run(t, t0), y, numbers);
        })
    }

    /// How the points of a run that starts at t0 are numbers.
    fn points(&self, quantities: &[usize], t0: f64) -> Points<S::Problem> {
        let [of, from] = [self.system.clone(), self.system.clone()];
        let numbers_of_point = Box::new(move |y: &PointOf<S>| numbers(&of, y));
        let point = move |x: &[f64], y: &mut PointOf<S>| set_point(&from, y, "state", x);
        Points::by(self.shared(quantities, t0), numbers_of_point, Box::new(point))
    }

    /// The sizes of terms at y go to the end of `numbers`.
    fn sizes(&self, asked: Asked<'_>, y: &PointOf<S>, numbers: &mut Vec<f64>) {
        let with_size = asked.quantities.iter().zip(asked.schema).filter(|(_, o)| o.has_size());
        let terms = with_size.map(|(&quantity, _)| S::QUANTITIES[quantity].terms);
        numbers.extend(terms.map(|of| of.map_or(f64::NAN, |of| of(&self.system, y))));
    }
}

impl<S: System> Run for On<S> {
    fn missing(&self, quantity: usize) -> Option<&'static str> {
        (S::QUANTITIES[quantity].missing)(&self.system)
    }
    fn columns(&self, quantity: usize) -> Vec<String> {
        S::QUANTITIES[quantity].column_names(&self.system)
    }
    fn law(&self, quantity: usize) -> Option<Law> {
        S::QUANTITIES[quantity].law(&self.system)
    }
    fn describe(&self, quantity: usize, schema: &mut Schema) {
        let (system, quantity) = (&self.system, &S::QUANTITIES[quantity]);
        let columns = quantity.column_names(system);
        schema.push(quantity.info.name, columns, quantity.law(system), quantity.is_state);
        schema.set_distance(quantity.is_distance);
        if let Some(parts) = quantity.parts {
            schema.set_parts(parts(system));
        }
        schema.set_numbers((quantity.numbers)(system), quantity.matrix(system));
        schema.set_branch((quantity.branch)(system));
    }
    fn modelled(&self) -> String {
        self.system.modelled()
    }
    fn start(&self) -> Result<Vec<f64>, Error> {
        Ok(numbers(&self.system, &self.ready()?.1))
    }
    fn drive(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError> {
        let problem = &self.ready()?.0;
        let [t0, _] = plan.steps.t_span();
        let row_of = |t: f64, y: &PointOf<S>, numbers: &mut Vec<f64>| {
            append_values(&self.system, asked.quantities, Moment::of_run(t, t0), y, numbers);
            self.sizes(asked, y, numbers);
        };
        let turn_rate = |t: f64, y: &PointOf<S>| {
            let followed = asked.quantities.iter().zip(asked.schema).filter(|(_, o)| o.is_followed);
            let rates = followed.map(|(&q, _)| (S::QUANTITIES[q].turn_rate)(&self.system, t, y));
            rates.fold(0.0, f64::max)
        };
        let shared = || self.shared(asked.quantities, t0);
        let points = self.points(asked.quantities, t0);
        let rows = RowsOf {
            schema: asked.schema,
            row_of: &row_of,
            turn_rate: &turn_rate,
            shared: &shared,
            points: &points,
        };
        let start = self.start_at(plan.start.as_deref())?;
        S::Problem::drive(method, problem, start, plan, rows, watcher)
    }
    fn stepper(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        start: Option<&[f64]>,
        steps: StepByStep,
    ) -> Result<Box<dyn Stepper>, RunError> {
        let problem = &self.ready()?.0;
        let points = self.points(asked.quantities, steps.steps.t_span()[0]);
        let y = self.start_at(start)?;
        S::Problem::stepper(method, problem, y, steps, points)
    }
    fn curve(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        numbers: &[f64],
    ) -> Result<Box<dyn RowCurve>, Error> {
        let (problem, like) = self.ready()?;
        let shared = |t0: f64| self.shared(asked.quantities, t0);
        S::Problem::curve(method, problem, like, numbers, asked.schema, &shared)
    }
    fn exact(&self, asked: Asked<'_>, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        let mut values = Vec::with_capacity(asked.schema.numbers());
        let end = self.system.exact(t_span)?;
        let at = Moment::of_run(t_span[1], t_span[0]);
        Some(
            end.map(|y| append_values(&self.system, asked.quantities, at, &y, &mut values))
                .map(|()| values),
        )
    }
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        self.ready()?.0.orders(method)
    }
    fn problem_type(&self) -> &'static str {
        core::any::type_name::<S::Problem>()
    }
    fn fits(&self, method: &MethodSpec) -> Result<Fit, Error> {
        let (problem, start) = self.ready()?;
        problem.fits(method, start)
    }
    fn check_tolerance(&self, tolerance: &Tolerance) -> Result<(), Error> {
        check_within_reach(tolerance, &self.ready()?.1)
    }
    fn operations(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        on_vectors: CountOnVectors,
    ) -> Option<f64> {
        if let Some(start) = self.system.counted() {
            return on_vectors(start, method, steps);
        }
        let (problem, start) = self.ready().ok()?;
        problem.operations(method, start.clone(), steps)
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        self.system.check_start(t0)
    }
    fn knots(&self, t_span: [f64; 2]) -> Option<Stops> {
        self.system.knots(t_span)
    }
    fn field(&self, values: &[f64]) -> Vec<Vec<f64>> {
        self.system.field(values)
    }
}
