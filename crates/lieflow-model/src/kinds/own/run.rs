//! Runs of a field of one's own: one type for each group and action, behind a pointer.

use core::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::groups::LieGroup;
use lieflow::methods::{AnyMethod, Method};
use lieflow::problems::{AlgOf, DynFlow, Flow, PointOf, Problem, TimeAlone, WithHamiltonian};
use lieflow::solve::{Interpolant, Interrupted, Next, Solution, Status, Stops};
use lieflow::space::Numbers;
use lieflow::{Action, Direction, Error, Event, RunError, SaveAt, Solve, Stats};

use super::OwnField;
use super::layout::Layout;
use crate::problem::{Orders, Points, StepByStep, Stepper, Steps, orders_by, stepper_by};

/// A function of t and the numbers of y.
type OfRows<'a, V> = Box<dyn FnMut(f64, &[f64]) -> V + 'a>;

/// A function that changes the numbers of y at t.
type ChangeRows<'a> = Box<dyn FnMut(f64, &mut [f64]) + 'a>;

/// An event: the zeros of a function of t and the numbers of y.
pub struct OwnEvent<'a> {
    /// Its name.
    pub name: String,
    /// The function.
    pub value: OfRows<'a, f64>,
    /// The zeros that count.
    pub direction: Direction,
    /// The zero that ends the run, from 1.
    pub stop_after: Option<u64>,
    /// What changes y at a zero, if anything does.
    pub change: Option<ChangeRows<'a>>,
    /// At how many points of each step the function is evaluated.
    pub points: Option<u32>,
    /// What sees the zeros, before a change.
    pub tell: OfRows<'a, ()>,
}

impl core::fmt::Debug for OwnEvent<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("OwnEvent").field("name", &self.name).finish_non_exhaustive()
    }
}

/// What a run is asked for.
#[allow(missing_debug_implementations)] // closures
pub struct OwnPlan<'a> {
    /// The steps.
    pub steps: Steps,
    /// The rows of the output.
    pub save: SaveAt,
    /// Times at which a step ends.
    pub stops: Stops,
    /// The limit of the attempts, if it is not that of the library.
    pub max_steps: Option<u64>,
    /// True if the points at all times are kept.
    pub dense: bool,
    /// The events.
    pub events: Vec<OwnEvent<'a>>,
    /// What is called now and then with the time that the run has reached.
    pub progress: Option<Box<dyn FnMut(f64) + 'a>>,
}

/// The end of a run.
#[derive(Clone, Debug)]
pub struct End {
    /// The time.
    pub t: f64,
    /// The numbers of y.
    pub y: Vec<f64>,
    /// What the run did.
    pub stats: Stats,
}

/// What a run did.
#[allow(missing_debug_implementations)] // the curve
pub struct Ran {
    /// Why it ended.
    pub status: Result<Status, RunError>,
    /// Its end; none if it did not begin.
    pub end: Option<End>,
    /// The points at all times, if they are kept.
    pub curve: Option<Box<dyn Curve>>,
}

impl From<Error> for Ran {
    fn from(error: Error) -> Self {
        Ran { status: Err(error.into()), end: None, curve: None }
    }
}

/// The points of a run at all times.
pub trait Curve: Send + Sync {
    /// The first and the last time.
    fn t_span(&self) -> [f64; 2];
    /// The number of steps.
    fn steps(&self) -> usize;
    /// out ← the numbers of y at these times, one after the other. f is not called.
    ///
    /// # Errors
    /// The number of the time that failed, and why.
    fn at(&self, times: &[f64], out: &mut [f64]) -> Result<(), (usize, RunError)>;
    /// All its numbers, to store it.
    fn numbers(&self) -> Vec<f64>;
}

/// A problem of any space.
pub trait Run: Send + Sync {
    /// As [`Own::orders`](super::Own::orders).
    ///
    /// # Errors
    /// The reason why it does not fit.
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error>;
    /// As [`Own::run`](super::Own::run).
    fn run(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        plan: OwnPlan<'_>,
        observe: &mut dyn FnMut(f64, &[f64]),
        stop: &AtomicBool,
    ) -> Ran;
    /// As [`Own::stepper`](super::Own::stepper).
    ///
    /// # Errors
    /// As [`Solve::integrator`].
    fn stepper(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        steps: StepByStep<'_>,
    ) -> Result<Box<dyn Stepper>, RunError>;
    /// As [`Own::curve`](super::Own::curve).
    ///
    /// # Errors
    /// [`Error::Length`] for another number of them.
    fn curve(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        numbers: &[f64],
    ) -> Result<Box<dyn Curve>, Error>;
}

/// A problem of one type of points.
pub(super) struct Typed<P, L> {
    problem: Arc<P>,
    layout: L,
}

/// The scratch of a field: the numbers of y and of f.
type Scratch = (Vec<f64>, Vec<f64>);

/// The closure that makes the scratch.
fn scratch_of<G: LieGroup, Y, L: Layout<G, Y>>(
    group: &G,
    layout: L,
) -> impl Fn() -> Scratch + Send + Sync + use<G, Y, L> {
    let [y, f] = layout.sizes(group);
    move || (vec![0.0; y], vec![0.0; f])
}

/// The closure that evaluates the field; minus a field in the body.
fn field_of<G, Y, L>(
    layout: L,
    field: Arc<OwnField>,
    body: bool,
) -> impl Fn(f64, &Y, &mut G::Alg, &mut Scratch) + Send + Sync + use<G, Y, L>
where
    G: LieGroup<Scalar = f64> + Clone + 'static,
    L: Layout<G, Y>,
{
    move |t, y, v, (rows, value)| {
        layout.show(y, rows);
        value.fill(0.0);
        if !field(t, rows, value) {
            value.fill(f64::NAN);
        }
        layout.value(value, v);
        if body {
            layout.reverse(v);
        }
    }
}

impl<G, A, L> Typed<DynFlow<G, A, TimeAlone>, L>
where
    G: LieGroup<Scalar = f64> + Clone + 'static,
    A: Action<G> + Copy + 'static,
    L: Layout<G, A::Point>,
    DynFlow<G, A, TimeAlone>: MethodsByName<Group = G, Action = A>,
    A::Point: Numbers,
    G::Alg: Numbers,
{
    /// A problem that may be linear.
    pub(super) fn linear(
        group: G,
        action: A,
        layout: L,
        (field, body, linear): (Arc<OwnField>, bool, bool),
    ) -> Box<dyn Run> {
        let make = scratch_of(&group, layout);
        let f = field_of::<G, A::Point, L>(layout, field, body);
        let flow = Flow::with_work(group, action, make, f);
        let problem = match linear {
            true => DynFlow::linear(flow.linear(), action),
            false => DynFlow::new(flow, action),
        };
        Box::new(Typed { problem: Arc::new(problem), layout })
    }
}

impl<G, A, L> Typed<DynFlow<G, A, TimeAlone, WithHamiltonian>, L>
where
    G: LieGroup<Scalar = f64> + Clone + 'static,
    A: Action<G> + Copy + 'static,
    L: Layout<G, A::Point>,
    DynFlow<G, A, TimeAlone, WithHamiltonian>: MethodsByName<Group = G, Action = A>,
    A::Point: Numbers,
    G::Alg: Numbers,
{
    /// A problem of matrices, of a type in which some are Lie–Poisson systems.
    pub(super) fn linear_or_poisson(
        group: G,
        action: A,
        layout: L,
        (field, body, linear): (Arc<OwnField>, bool, bool),
    ) -> Box<dyn Run> {
        let make = scratch_of(&group, layout);
        let f = field_of::<G, A::Point, L>(layout, field, body);
        let flow = Flow::with_work(group, action, make, f);
        let problem = match linear {
            true => DynFlow::linear(flow.linear(), action),
            false => DynFlow::new(flow, action),
        };
        Box::new(Typed { problem: Arc::new(problem), layout })
    }
}

impl<G, A, L> Typed<DynFlow<G, A>, L>
where
    G: LieGroup<Scalar = f64> + Clone + 'static,
    A: Action<G> + Copy + 'static,
    L: Layout<G, A::Point>,
    DynFlow<G, A>: MethodsByName<Group = G, Action = A>,
    A::Point: Numbers,
    G::Alg: Numbers,
{
    /// A problem without methods for linear equations.
    pub(super) fn field(
        group: G,
        action: A,
        layout: L,
        (field, body): (Arc<OwnField>, bool),
    ) -> Box<dyn Run> {
        let make = scratch_of(&group, layout);
        let f = field_of::<G, A::Point, L>(layout, field, body);
        let problem = DynFlow::new(Flow::with_work(group, action, make, f), action);
        Box::new(Typed { problem: Arc::new(problem), layout })
    }
}

impl<G, A, L> Typed<DynFlow<G, A, (), WithHamiltonian>, L>
where
    G: LieGroup<Scalar = f64> + Clone + 'static,
    A: Action<G> + Copy + 'static,
    L: Layout<G, A::Point>,
    DynFlow<G, A, (), WithHamiltonian>: MethodsByName<Group = G, Action = A>,
    A::Point: Numbers,
    G::Alg: Numbers,
{
    /// A problem of a type in which some are Lie–Poisson systems.
    pub(super) fn poisson(group: G, action: A, layout: L, field: Arc<OwnField>) -> Box<dyn Run> {
        let make = scratch_of(&group, layout);
        let f = field_of::<G, A::Point, L>(layout, field, false);
        let problem = DynFlow::new(Flow::with_work(group, action, make, f), action);
        Box::new(Typed { problem: Arc::new(problem), layout })
    }
}

impl<P, L> Typed<P, L>
where
    P: MethodsByName + 'static,
    L: Layout<P::Group, PointOf<P>>,
{
    fn method(&self, method: &MethodSpec) -> Result<Arc<AnyMethod<'static, P>>, Error> {
        Ok(Arc::new(self.problem.method(method)?))
    }

    fn rows(&self, y: &PointOf<P>) -> Vec<f64> {
        let mut rows = vec![0.0; self.layout.sizes(self.problem.group())[0]];
        self.layout.show(y, &mut rows);
        rows
    }
}

impl<P, L> Run for Typed<P, L>
where
    P: MethodsByName + Send + Sync + 'static,
    P::Group: LieGroup<Scalar = f64>,
    P::Action: Action<P::Group, Point: Numbers>,
    AlgOf<P>: Numbers,
    L: Layout<P::Group, PointOf<P>>,
{
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        orders_by(method, &*self.problem)
    }

    fn run(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        plan: OwnPlan<'_>,
        observe: &mut dyn FnMut(f64, &[f64]),
        stop: &AtomicBool,
    ) -> Ran {
        let (layout, group) = (self.layout, self.problem.group());
        let [size, _] = layout.sizes(group);
        let method = match self.method(method) {
            Ok(method) => method,
            Err(error) => return error.into(),
        };
        let start = layout.point(group, y0);
        let OwnPlan { steps, save, stops, max_steps, dense, events, progress } = plan;
        let rows = RefCell::new(vec![0.0; size]);
        let show = |y: &PointOf<P>, see: &mut dyn FnMut(&[f64]) -> f64| {
            let mut rows = rows.borrow_mut();
            layout.show(y, &mut rows);
            see(&rows)
        };
        let mut solve = Solve::shared(self.problem.clone(), method, steps.t_span())
            .save(save)
            .stops(stops)
            .cancel(stop);
        solve = match steps {
            Steps::Equal(grid) => solve.grid(grid),
            Steps::ByError { control, .. } => solve.control(control),
        };
        if let Some(attempts) = max_steps {
            solve = solve.max_steps(attempts);
        }
        if let Some(progress) = progress {
            solve = solve.progress(progress);
        }
        for OwnEvent { name, mut value, direction, stop_after, change, points, mut tell } in events
        {
            let show = &show;
            let mut event =
                Event::new(name, move |t, y: &PointOf<P>| show(y, &mut |rows| value(t, rows)))
                    .direction(direction)
                    .tell(move |t, y, _| {
                        show(y, &mut |rows| {
                            tell(t, rows);
                            0.0
                        });
                    });
            if let Some(count) = stop_after {
                event = event.stop_after(count);
            }
            if let Some(points) = points {
                event = event.points(points);
            }
            if let Some(mut change) = change {
                let mut rows = vec![0.0; size];
                event = event.change(move |t, y: &mut PointOf<P>| {
                    layout.show(y, &mut rows);
                    change(t, &mut rows);
                    *y = layout.point(group, &rows);
                });
            }
            solve = solve.event(event);
        }
        let see = |t: f64, y: &mut PointOf<P>| {
            show(y, &mut |rows| {
                observe(t, rows);
                0.0
            });
            Next::Continue
        };
        let (done, curve) = match dense {
            false => (solve.run_with(start, see), None),
            true => {
                let (done, curve) = solve.run_interpolant_with(start, see);
                let curve = curve.into_shared().map(|curve| OwnCurve::boxed(curve, layout, size));
                (done, curve)
            }
        };
        let end =
            |Solution { t, y, stats, .. }: Solution<PointOf<P>>| End { t, y: self.rows(&y), stats };
        let (status, end) = match done {
            Ok(solution) => (Ok(solution.status.clone()), Some(end(solution))),
            Err(Interrupted { error, solution }) => (Err(error), solution.map(|s| end(*s))),
        };
        Ran { status, end, curve }
    }

    fn stepper(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        steps: StepByStep<'_>,
    ) -> Result<Box<dyn Stepper>, RunError> {
        let (layout, problem) = (self.layout, self.problem.clone());
        let [size, _] = layout.sizes(problem.group());
        let start = layout.point(problem.group(), y0);
        let show = move |_: f64, y: &PointOf<P>, values: &mut Vec<f64>| {
            let first = values.len();
            values.resize(first + size, 0.0);
            layout.show(y, &mut values[first..]);
        };
        let point = move |numbers: &[f64], y: &mut PointOf<P>| {
            *y = layout.point(problem.group(), numbers);
            Ok(())
        };
        let points = Points::by_rows(Box::new(show), Box::new(point));
        stepper_by(method, &self.problem, start, steps, points)
    }

    fn curve(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        numbers: &[f64],
    ) -> Result<Box<dyn Curve>, Error> {
        let group = self.problem.group();
        let (layout, like) = (self.layout, self.layout.point(group, y0));
        let curve =
            Interpolant::from_numbers(self.problem.clone(), self.method(method)?, &like, numbers)?;
        Ok(OwnCurve::boxed(curve, layout, layout.sizes(group)[0]))
    }
}

/// An interpolant with its layout.
struct OwnCurve<P: Problem + 'static, M: Method<P> + 'static, L> {
    curve: Interpolant<'static, P, M>,
    layout: L,
    size: usize,
}

impl<P, M, L> OwnCurve<P, M, L>
where
    P: Problem<Action: Action<<P as Problem>::Group, Point: Numbers>> + Send + Sync + 'static,
    AlgOf<P>: Numbers,
    M: Method<P> + Send + Sync + 'static,
    L: Layout<P::Group, PointOf<P>>,
{
    fn boxed(curve: Interpolant<'static, P, M>, layout: L, size: usize) -> Box<dyn Curve> {
        Box::new(OwnCurve { curve, layout, size })
    }
}

impl<P, M, L> Curve for OwnCurve<P, M, L>
where
    P: Problem<Action: Action<<P as Problem>::Group, Point: Numbers>> + Send + Sync + 'static,
    AlgOf<P>: Numbers,
    M: Method<P> + Send + Sync + 'static,
    L: Layout<P::Group, PointOf<P>>,
{
    fn t_span(&self) -> [f64; 2] {
        self.curve.t_span()
    }
    fn steps(&self) -> usize {
        self.curve.steps()
    }
    fn at(&self, times: &[f64], out: &mut [f64]) -> Result<(), (usize, RunError)> {
        let mut reader = self.curve.reader().map_err(|error| (0, error.into()))?;
        let rows = out.chunks_exact_mut(self.size.max(1));
        for (i, (t, rows)) in times.iter().zip(rows).enumerate() {
            self.layout.show(reader.at(*t).map_err(|error| (i, error))?, rows);
        }
        Ok(())
    }
    fn numbers(&self) -> Vec<f64> {
        self.curve.numbers()
    }
}
