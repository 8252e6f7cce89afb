//! Runs of a field of one's own: one type for each group and action, behind a pointer.

use std::sync::Arc;

use lieflow::catalog::MethodSpec;
use lieflow::groups::LieGroup;
use lieflow::problems::{DynFlow, Flow, LinearField, PointOf, TimeAlone};
use lieflow::{Action, Error, RunError};
use lieflow_runs::run::{
    Orders, Outcome, Plan, Points, RowCurve, RowsOf, Runnable, SharedRowOf, StepByStep, Stepper,
    Watcher,
};
use lieflow_runs::schema::Schema;

use super::OwnField;
use super::layout::Layout;

/// A problem of any space. Its rows are the numbers of y.
pub trait Run: Send + Sync {
    /// As [`Own::orders`](super::Own::orders).
    ///
    /// # Errors
    /// The reason why it does not fit.
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error>;
    /// As [`Own::run`](super::Own::run).
    ///
    /// # Errors
    /// As [`Runnable::drive`].
    fn run(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError>;
    /// As [`Own::stepper`](super::Own::stepper).
    ///
    /// # Errors
    /// As [`Runnable::stepper`].
    fn stepper(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        steps: StepByStep,
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
    ) -> Result<Box<dyn RowCurve>, Error>;
}

/// A problem of one type of points.
pub(super) struct Typed<P, L> {
    problem: Arc<P>,
    layout: L,
    /// One quantity, y.
    schema: Schema,
}

/// A field as a closure, what makes its scratch, and its frame: true for the body.
pub(super) type Given = (Arc<OwnField>, bool);

/// The flow of a field; of minus the field in the body.
macro_rules! flow {
    ($group:expr, $action:expr, $layout:expr, $given:expr) => {{
        let (layout, (field, body)): (L, Given) = ($layout, $given);
        let [numbers, values] = layout.sizes(&$group);
        let scratch = move || (vec![0.0; numbers], vec![0.0; values]);
        Flow::with_work($group, $action, scratch, move |t, y: &A::Point, v, (rows, value)| {
            layout.show(y, rows);
            value.fill(0.0);
            if !field(t, rows, value) {
                value.fill(f64::NAN);
            }
            layout.value(value, v);
            if body {
                layout.reverse(v);
            }
        })
    }};
}

impl<G, A, T, H, L> Typed<DynFlow<G, A, T, H>, L>
where
    G: LieGroup<Scalar = f64> + Clone + 'static,
    A: Action<G> + Copy + 'static,
    L: Layout<G, A::Point>,
    DynFlow<G, A, T, H>: Runnable<Group = G, Action = A>,
{
    /// A problem without methods for linear equations.
    pub(super) fn field(group: G, action: A, layout: L, given: Given) -> Box<dyn Run> {
        let flow = flow!(group, action, layout, given);
        Self::boxed(DynFlow::new(flow, action), layout)
    }
}

impl<G, A, H, L> Typed<DynFlow<G, A, TimeAlone, H>, L>
where
    G: LieGroup<Scalar = f64> + Clone + 'static,
    A: Action<G> + Copy + 'static,
    L: Layout<G, A::Point>,
    DynFlow<G, A, TimeAlone, H>: Runnable<Group = G, Action = A> + LinearField,
{
    /// A problem that may be linear.
    pub(super) fn linear(
        group: G,
        action: A,
        layout: L,
        (given, linear): (Given, bool),
    ) -> Box<dyn Run> {
        if !linear {
            return Self::field(group, action, layout, given);
        }
        let flow = flow!(group, action, layout, given);
        Self::boxed(DynFlow::linear(flow.linear(), action), layout)
    }
}

impl<P: Runnable, L: Layout<P::Group, PointOf<P>>> Typed<P, L>
where
    P::Group: LieGroup<Scalar = f64>,
{
    fn boxed(problem: P, layout: L) -> Box<dyn Run> {
        let [size, _] = layout.sizes(problem.group());
        let mut schema = Schema::default();
        schema.push("y", vec![String::new(); size], None, true);
        Box::new(Typed { problem: Arc::new(problem), layout, schema })
    }

    /// The point of these rows.
    fn point(&self, y0: &[f64]) -> Result<PointOf<P>, Error> {
        self.layout.check(y0)?;
        Ok(self.layout.point(self.problem.group(), y0))
    }

    /// How points are numbers: by rows.
    fn points(&self) -> Points<P> {
        let (layout, problem) = (self.layout, self.problem.clone());
        let point = move |numbers: &[f64], y: &mut PointOf<P>| {
            layout.check(numbers)?;
            *y = layout.point(problem.group(), numbers);
            Ok(())
        };
        Points::by_rows(self.shared(), Box::new(point))
    }

    /// What appends the numbers of y.
    fn shared(&self) -> Box<SharedRowOf<P>> {
        let (layout, size) = (self.layout, self.schema.numbers());
        Box::new(move |_, y, values| {
            let first = values.len();
            values.resize(first + size, 0.0);
            layout.show(y, &mut values[first..]);
        })
    }
}

impl<P: Runnable, L: Layout<P::Group, PointOf<P>>> Run for Typed<P, L>
where
    P::Group: LieGroup<Scalar = f64>,
{
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        self.problem.orders(method)
    }

    fn run(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError> {
        let points = self.points();
        let rows = RowsOf {
            schema: &self.schema,
            row_of: &*points.row_of,
            turn_rate: &|_, _| 0.0,
            shared: &|| self.shared(),
            points: &points,
        };
        P::drive(method, &self.problem, self.point(y0)?, plan, rows, watcher)
    }

    fn stepper(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        steps: StepByStep,
    ) -> Result<Box<dyn Stepper>, RunError> {
        P::stepper(method, &self.problem, self.point(y0)?, steps, self.points())
    }

    fn curve(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        numbers: &[f64],
    ) -> Result<Box<dyn RowCurve>, Error> {
        let like = self.point(y0)?;
        P::curve(method, &self.problem, &like, numbers, &self.schema, &|_| self.shared())
    }
}
