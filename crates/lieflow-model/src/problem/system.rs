//! What is the same for every kind: from what is its own, [`System`], to its [`ProblemSpec`] and its
//! [`Model`].

use core::fmt::{self, Debug};

use lieflow::catalog::MethodSpec;
use lieflow::methods::Wide;
use lieflow::problems::LinearSpace;
use lieflow::scalar::{Counted, Trig};
use lieflow::space::Numbers;
use lieflow::{Error, RunError};

use super::model::{
    Layer, Model, Orders, Outcome, Plan, Runnable, Steps, Watcher, drive_by, fits_by, orders_by,
};
use super::operations::operations_by;
use super::quantity::{Quantity, Value};
use super::spec::{Fact, Figure, Kind, PrincipalInertia, ProblemSpec, high_order};
use crate::formula::Formula;
use crate::reader::Refusal;
use crate::schema::Schema;

/// The numbers that a problem of vectors is made of: `f64`, and [`Counted`] where operations are counted.
/// Matrices count for themselves.
pub(crate) trait Number:
    Trig + Wide + Into<f64> + LinearSpace<Scalar = Self> + Numbers + Send + Sync
{
}
impl Number for f64 {}
impl Number for Counted {}

/// A problem with the point that it starts from.
pub(crate) type Start<P> = (P, lieflow::problems::PointOf<P>);

/// A point of a system.
pub(crate) type PointOf<S> = lieflow::problems::PointOf<<S as System>::Problem<f64>>;

/// A problem of one kind, as its scene states it and checked: what the kind's file is about.
pub(crate) trait System: Clone + Debug + Send + Sync + 'static {
    /// The problem of the library; one of matrices is the same on all numbers.
    type Problem<N: Number>: Runnable;
    /// The quantities, in the order of listings.
    const QUANTITIES: &'static [Quantity<Self>];
    /// The quantities that make up the state.
    const STATE: &'static [&'static str];
    /// The method where a scene names none, of a kind that needs another one than the rest.
    const DEFAULT_METHOD: Option<&'static str> = None;

    /// The entry in the list of kinds.
    fn kind(&self) -> &'static Kind;
    /// The layer that it is made of.
    fn layer(&self) -> Layer {
        Layer::General
    }
    /// The problem, and y(t₀).
    ///
    /// # Errors
    /// What the library refuses.
    fn problem<N: Number>(&self) -> Result<Start<Self::Problem<N>>, Error>;
    /// What is integrated, in words.
    fn modelled(&self) -> String;
    /// See [`ProblemSpec::check_start`].
    fn check_start(&self, _t0: f64) -> Vec<Refusal> {
        Vec::new()
    }
    /// See [`ProblemSpec::formula`].
    fn formula(&self) -> Option<&Formula> {
        None
    }
    /// See [`ProblemSpec::knots`].
    fn knots(&self, t_span: [f64; 2]) -> Option<Vec<f64>> {
        self.formula()?.samples().map(|samples| samples.knots(t_span).collect())
    }
    /// y at the end of a span, where it is known.
    fn exact(&self, _t_span: [f64; 2]) -> Option<Result<PointOf<Self>, Error>> {
        None
    }
    /// The figure of a run.
    fn figure(&self) -> Figure {
        Figure::Lines(Self::STATE[0])
    }
    /// See [`ProblemSpec::inertia`].
    fn inertia(&self) -> Option<PrincipalInertia> {
        None
    }
    /// The field that [`Figure::Map`] draws, from its quantity: rows from north to south, columns from
    /// west to east.
    fn field(&self, _values: &[f64]) -> Vec<Vec<f64>> {
        Vec::new()
    }
    /// What is known before any run.
    fn facts(&self) -> Vec<Fact> {
        Vec::new()
    }
    /// See [`ProblemSpec::warnings`].
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
    /// See [`ProblemSpec::notes`].
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// The problem of a scene from its system.
#[derive(Clone, Debug)]
pub(crate) struct Stated<S>(pub(crate) S);

/// The quantity of that name, where this problem has it.
fn find<S: System>(system: &S, name: &str) -> Result<&'static Quantity<S>, Error> {
    let known = S::QUANTITIES.iter().find(|quantity| quantity.info.name == name);
    let quantity = known.ok_or_else(|| system.kind().unknown_quantity(name))?;
    match (quantity.missing)(system) {
        None => Ok(quantity),
        Some(why) => {
            Err(Error::Unsupported { what: quantity.info.name, with: "this problem".into(), why })
        }
    }
}

/// Does a problem lack one of these quantities, which others of its kind have?
pub(crate) fn lacks_any(problem: &impl ProblemSpec, quantities: &[&str]) -> bool {
    let lacks = |name| matches!(problem.columns(name), Err(Error::Unsupported { .. }));
    quantities.iter().any(|name| lacks(name))
}

/// The error for a layer that a kind of one layer does not have.
pub(crate) fn no_such_layer(layer: Layer, kind: &Kind) -> Error {
    Error::Unsupported {
        what: "layer",
        with: format!("`{}` and a problem of kind `{}`", layer.name(), kind.name),
        why: "it has one layer only; leave layer out",
    }
}

impl<S: System> ProblemSpec for Stated<S> {
    fn kind(&self) -> &'static Kind {
        self.0.kind()
    }
    fn layers(&self) -> &'static [Layer] {
        match self.0.layer() {
            Layer::Closed => &[Layer::Closed],
            Layer::General => &[Layer::General],
        }
    }
    fn columns(&self, quantity: &str) -> Result<Vec<String>, Error> {
        Ok(find(&self.0, quantity)?.column_names(&self.0))
    }
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error> {
        let system = &self.0;
        if layer != system.layer() {
            return Err(no_such_layer(layer, system.kind()));
        }
        let (problem, start) = system.problem()?;
        let quantities: Vec<_> =
            quantities.iter().map(|name| find(system, name)).collect::<Result<_, Error>>()?;
        let mut schema = Schema::default();
        for quantity in &quantities {
            let columns = quantity.column_names(system);
            schema.push(quantity.info.name, columns, quantity.law(system), quantity.is_state);
            if let Some(parts) = quantity.parts {
                schema.set_parts(parts(system));
            }
            schema.set_branch((quantity.branch)(system));
        }
        Ok(Box::new(SystemModel { system: system.clone(), problem, start, quantities, schema }))
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        self.0.check_start(t0)
    }
    fn formula(&self) -> Option<&Formula> {
        self.0.formula()
    }
    fn knots(&self, t_span: [f64; 2]) -> Option<Vec<f64>> {
        self.0.knots(t_span)
    }
    fn default_method(&self) -> MethodSpec {
        S::DEFAULT_METHOD.map_or_else(high_order, |name| MethodSpec::new(name, None))
    }
    fn state(&self, _: &[&str]) -> &'static [&'static str] {
        S::STATE
    }
    fn invariants(&self, _: &[&str]) -> Vec<&'static str> {
        let present = S::QUANTITIES.iter().filter(|quantity| (quantity.missing)(&self.0).is_none());
        let kept = present.filter(|quantity| quantity.law(&self.0).is_some());
        kept.map(|quantity| quantity.info.name).collect()
    }
    fn figure(&self, _: &[&str]) -> Figure {
        self.0.figure()
    }
    fn inertia(&self) -> Option<PrincipalInertia> {
        self.0.inertia()
    }
    fn field(&self, values: &[f64]) -> Vec<Vec<f64>> {
        self.0.field(values)
    }
    fn facts(&self) -> Vec<Fact> {
        self.0.facts()
    }
    fn warnings(&self) -> Vec<String> {
        self.0.warnings()
    }
    fn notes(&self) -> Vec<String> {
        self.0.notes()
    }
}

/// The model of a [`System`].
struct SystemModel<S: System> {
    system: S,
    problem: S::Problem<f64>,
    start: PointOf<S>,
    /// The quantities of the schema.
    quantities: Vec<&'static Quantity<S>>,
    schema: Schema,
}

impl<S: System> Debug for SystemModel<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SystemModel").field(&self.system).field(&self.schema).finish()
    }
}

impl<S: System> SystemModel<S> {
    /// numbers ← the values of the quantities at y, `t` after the start.
    fn values(&self, t: f64, y: &PointOf<S>, numbers: &mut Vec<f64>) {
        numbers.clear();
        for quantity in &self.quantities {
            match quantity.value {
                Value::Number(value) => numbers.push(value(&self.system, t, y)),
                Value::Numbers(values) => values(&self.system, t, y, numbers),
            }
        }
    }

    /// The sizes of terms at y go to the end of `numbers`.
    fn sizes(&self, y: &PointOf<S>, numbers: &mut Vec<f64>) {
        let with_size = self.quantities.iter().zip(&self.schema).filter(|(_, o)| o.has_size());
        let terms = with_size.map(|(quantity, _)| quantity.terms);
        numbers.extend(terms.map(|of| of.map_or(f64::NAN, |of| of(&self.system, y))));
    }
}

impl<S: System> Model for SystemModel<S> {
    fn schema(&self) -> &Schema {
        &self.schema
    }
    fn modelled(&self, _: &MethodSpec) -> Vec<String> {
        vec![self.system.modelled()]
    }
    fn drive(
        &self,
        method: &MethodSpec,
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError> {
        let [t0, _] = plan.steps.t_span();
        let row_of = |t: f64, y: &PointOf<S>, numbers: &mut Vec<f64>| {
            self.values(t - t0, y, numbers);
            self.sizes(y, numbers);
        };
        drive_by(method, &self.problem, self.start.clone(), plan, (&self.schema, &row_of), watcher)
    }
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        orders_by(method, &self.problem)
    }
    fn problem_type(&self, _: &MethodSpec) -> &'static str {
        core::any::type_name::<S::Problem<f64>>()
    }
    fn fits(&self, method: &MethodSpec) -> Result<(), Error> {
        fits_by(method, &self.problem, &self.start)
    }
    fn operations(&self, method: &MethodSpec, steps: &Steps) -> Option<f64> {
        let (problem, start) = self.system.problem::<Counted>().ok()?;
        operations_by(method, &problem, start, steps)
    }
    fn exact(&self, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        let mut values = Vec::new();
        let end = self.system.exact(t_span)?;
        Some(end.map(|y| self.values(t_span[1] - t_span[0], &y, &mut values)).map(|()| values))
    }
}
