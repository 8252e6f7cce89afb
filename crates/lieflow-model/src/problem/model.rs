//! A problem as a value: it can be asked and run, whatever its kind.

use core::fmt;
use std::sync::Arc;

use lieflow::catalog::{MethodSpec, Needs};
use lieflow::names::same;
use lieflow::samples::Samples;
use lieflow::solve::Stops;
use lieflow::tolerance::Tolerance;
use lieflow::{Error, RunError, SaveAt, Stats, TimeGrid};
use lieflow_runs::run::{
    CountOnVectors, CurvePlace, Fit, Layer, Orders, Outcome, Plan, RowCurve, Rows, Sink,
    StepByStep, Stepper, Steps, Watcher,
};
use lieflow_runs::schema::Schema;

use super::forms::{Asked, Form, Forms, Run};
use super::kind::{Figure, Kind, PrincipalInertia, Property, QuantityInfo};
use super::mapped::{Mapped, MappedCurve, MappedStepper, NumberOf, RowMap};
use crate::formula::{Constants, Formula};
use crate::reader::{Mistakes, ReadError, Refusal, Tree, Value};

/// A problem with its initial state: checked, and not yet tied to a layer or to quantities.
///
/// It is a value: it can be cloned, sent to another thread, and used by several threads at once.
#[derive(Clone, Debug)]
pub struct Problem {
    kind: &'static Kind,
    forms: Forms,
}

impl Kind {
    /// The problem of a section without `kind`.
    ///
    /// # Errors
    /// [`ReadError`] for a value that cannot be used.
    pub(crate) fn read_problem(&'static self, values: &Value) -> Result<Problem, ReadError> {
        let keys: Vec<_> = self.keys.iter().map(|key| (key.name, key.shape)).collect();
        let mut mistakes = ReadError::default();
        let forms =
            self.constants(values).read(values, &keys, &mut mistakes, |values, mistakes| {
                mistakes.keep((self.read)(values))
            });
        Ok(Problem { kind: self, forms: mistakes.or(forms)? })
    }

    /// What formulas of numbers may name in a scene with this section `problem`.
    pub(crate) fn constants(&self, section: &Value) -> Constants {
        let columns = (self.quantities)();
        let varying = columns.iter().flat_map(QuantityInfo::column_names);
        Constants::of(Some(section), varying).with_instead(self.instead)
    }

    /// The problem of this kind whose keys have these values.
    ///
    /// ```
    /// use lieflow_model::kinds;
    /// use lieflow_model::reader::Tree;
    ///
    /// let keys = [("inertia", [1.0, 2.0, 3.0]), ("omega_body", [0.1, 1.0, 0.0])];
    /// let body = kinds::named("rigid-body")?.problem(&Tree::table(keys))?;
    /// assert_eq!(body.columns("energy")?, ["energy"]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Mistakes`], by the paths of keys.
    pub fn problem(&'static self, keys: &Tree) -> Result<Problem, Mistakes> {
        keys.read(|values| self.read_problem(values))
    }
}

impl Problem {
    /// The kind.
    pub fn kind(&self) -> &'static Kind {
        self.kind
    }

    /// The layers that it runs on; the first where a scene names none.
    pub fn layers(&self) -> Vec<Layer> {
        let mut layers: Vec<Layer> = self.forms.forms.iter().map(|form| form.layer).collect();
        layers.dedup();
        layers
    }

    /// The number of a quantity in the list of the kind.
    fn number(&self, quantity: &str) -> Result<usize, Error> {
        let known = (self.kind.quantities)().iter().position(|info| same(info.name, quantity));
        known.ok_or_else(|| self.kind.unknown_quantity(quantity))
    }

    /// The forms of a layer that have all of these quantities, the one to take first.
    fn having(&self, layer: Layer, quantities: &[usize]) -> impl Iterator<Item = &Form> {
        self.forms.forms.iter().filter(move |form| {
            form.layer == layer && quantities.iter().all(|&q| form.run.missing(q).is_none())
        })
    }

    /// The form of these quantities on the first layer; the first form where none has them.
    fn form(&self, quantities: &[&str]) -> &Form {
        let first = &self.forms.forms[0];
        let known: Vec<usize> =
            quantities.iter().filter_map(|name| self.number(name).ok()).collect();
        self.having(first.layer, &known).next().unwrap_or(first)
    }

    /// The columns of a quantity.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a quantity that the kind does not have, and [`Error::Unsupported`] for one that this
    /// problem lacks.
    pub fn columns(&self, quantity: &str) -> Result<Vec<String>, Error> {
        let number = self.number(quantity)?;
        let mut forms = self.forms.forms.iter();
        let form = forms.find(|form| form.run.missing(number).is_none());
        form.map(|form| form.run.columns(number)).ok_or_else(|| self.lacks(number))
    }

    /// The error for a quantity that no form has.
    fn lacks(&self, number: usize) -> Error {
        let mut forms = self.forms.forms.iter();
        let why = forms.find_map(|form| form.run.missing(number)).unwrap_or_default();
        let what = (self.kind.quantities)()[number].name;
        Error::Unsupported { what, with: "this problem".into(), why }
    }

    /// The problem on a layer, modelling what the quantities need and no more.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a quantity that the kind does not have, [`Error::Unsupported`] for one that this
    /// problem lacks, and for a layer that it does not run on.
    pub fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Model, Error> {
        if !self.layers().contains(&layer) {
            return Err(Error::Unsupported {
                what: "layer",
                with: format!("`{}` and this problem of kind `{}`", layer.name(), self.kind.name),
                why: "it has one layer only; leave layer out",
            });
        }
        let numbers = quantities.iter().map(|name| self.number(name));
        let numbers = numbers.collect::<Result<Vec<_>, _>>()?;
        let Some(form) = self.having(layer, &numbers).find(|form| !form.whole_state) else {
            let missing = |&&q: &&usize| self.having(layer, &[q]).next().is_none();
            return Err(self.lacks(numbers.iter().find(missing).copied().unwrap_or_default()));
        };
        let mut schema = Schema::default();
        numbers.iter().for_each(|&quantity| form.run.describe(quantity, &mut schema));
        let mut forms = self.forms.forms.iter();
        let whole = forms.find(|f| f.whole_state && f.layer == layer && f.state == form.state);
        let whole_state = whole.map(|form| form.run.clone());
        let source = Source::Form { quantities: numbers, run: form.run.clone(), whole_state };
        Ok(Model { schema, source })
    }

    /// The refusals of the formulas that have no finite value at the start.
    pub fn check_start(&self, t0: f64) -> Vec<Refusal> {
        self.forms.forms[0].run.check_start(t0)
    }

    /// One of its formulas. All of them have the same samples, and keep together what has no value in a run.
    pub fn formula(&self) -> Option<&Formula> {
        self.forms.formula.as_ref()
    }

    /// The samples that its formulas name: a run stays in their span.
    pub fn samples(&self) -> Option<&Samples> {
        self.formula()?.samples()
    }

    /// The times within a span at which the right-hand side is not smooth: a step across one loses its order. None
    /// where the kind has no such times.
    pub fn knots(&self, t_span: [f64; 2]) -> Option<Stops> {
        self.forms.forms[0].run.knots(t_span)
    }

    /// The quantities that make up what these quantities model: those to compare with the exact solution.
    pub fn state(&self, quantities: &[&str]) -> &'static [&'static str] {
        self.form(quantities).state
    }

    /// The state that is written where a scene asks for no quantities.
    pub fn default_state(&self) -> &'static [&'static str] {
        self.forms.default_state.unwrap_or_else(|| self.state(&[]))
    }

    /// The method of a scene that names none: of high order, with an estimate of its error, and on the group.
    pub fn default_method(&self) -> MethodSpec {
        self.forms.default_method.clone()
    }

    /// The quantities that the exact motion conserves, of those that follow from what these quantities model.
    pub fn invariants(&self, quantities: &[&str]) -> Vec<&'static str> {
        let run = &self.form(quantities).run;
        let infos = (self.kind.quantities)();
        let kept = infos
            .iter()
            .enumerate()
            .filter(|&(number, _)| run.missing(number).is_none() && run.law(number).is_some());
        kept.map(|(_, info)| info.name).collect()
    }

    /// The figure of a run that computes these quantities.
    pub fn figure(&self, quantities: &[&str]) -> Figure {
        self.form(quantities).figure
    }

    /// The inertia of the body whose attitude or quaternion is a quantity.
    pub fn inertia(&self) -> Option<PrincipalInertia> {
        self.forms.inertia
    }

    /// The angular velocity at the start, of a body: its length.
    pub fn rate(&self) -> Option<f64> {
        self.forms.rate
    }

    /// The field that [`Figure::Map`] draws, from the values of its quantity: rows from north to south, columns from
    /// west to east.
    pub fn field(&self, values: &[f64]) -> Vec<Vec<f64>> {
        self.forms.forms[0].run.field(values)
    }

    /// What is known before any run.
    pub fn facts(&self) -> &[Property] {
        &self.forms.facts
    }

    /// What a reader of the scene should know, though it can be run.
    pub fn warnings(&self) -> &[String] {
        &self.forms.warnings
    }

    /// Changes that were made to numbers of the scene, such as a quaternion that was normalised.
    pub fn notes(&self) -> &[String] {
        &self.forms.notes
    }

    /// The values of the keys, by a type that the kind makes public.
    pub fn spec<T: 'static>(&self) -> Option<&T> {
        self.forms.spec.as_ref()?.downcast_ref()
    }
}

/// A problem with the quantities that are asked of it, ready to run with any method.
#[derive(Clone, Debug)]
pub struct Model {
    schema: Schema,
    source: Source,
}

/// Where the rows come from.
#[derive(Clone)]
enum Source {
    /// From a form of the problem.
    Form {
        /// The numbers of the quantities.
        quantities: Vec<usize>,
        run: Arc<dyn Run>,
        /// For the methods that need the whole state as one point.
        whole_state: Option<Arc<dyn Run>>,
    },
    /// From the rows of another model.
    Model { base: Arc<Model>, number: Arc<NumberOf<'static>> },
}

impl fmt::Debug for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Source::Form { run, .. } => run.fmt(f),
            Source::Model { base, .. } => base.fmt(f),
        }
    }
}

impl Model {
    /// Lets a run follow the choices of these quantities, as the sign of a quaternion, from row to row alone. This is enough for
    /// a figure. Otherwise they are followed between rows, too: twice for each radian by which
    /// they change.
    pub fn follow_from_row_to_row(&mut self, names: &[&str]) {
        self.schema.follow_from_row_to_row(names);
        if let Source::Model { base, .. } = &mut self.source {
            Arc::make_mut(base).follow_from_row_to_row(names);
        }
    }

    /// The model with other rows: each number is made of a row of this one.
    pub(crate) fn mapped(self, schema: Schema, number: Arc<NumberOf<'static>>) -> Model {
        Model { schema, source: Source::Model { base: Arc::new(self), number } }
    }

    /// The form that a method runs on.
    fn form(&self, method: &MethodSpec) -> &dyn Run {
        match &self.source {
            Source::Model { base, .. } => base.form(method),
            Source::Form { whole_state: Some(whole), .. }
                if method.info().is_ok_and(|info| info.needs == Needs::State) =>
            {
                &**whole
            }
            Source::Form { run, .. } => &**run,
        }
    }

    /// The observables of its rows.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// What a method integrates, in words. Nothing else is computed.
    pub fn modelled(&self, method: &MethodSpec) -> Vec<String> {
        vec![self.form(method).modelled()]
    }

    /// The numbers of the initial point that a method runs on. [`Plan::start`] and [`EventPlan::change`] have the same
    /// order: a vector in its order, a matrix column by column, the parts of a pair one after the other.
    ///
    /// [`EventPlan::change`]: super::EventPlan::change
    ///
    /// # Errors
    /// What the library refuses of the problem.
    pub fn start(&self, method: &MethodSpec) -> Result<Vec<f64>, Error> {
        self.form(method).start()
    }

    /// Integrates from the initial state by a plan; `watcher` sees the rows and the events.
    ///
    /// # Errors
    /// As [`Solve::run`](lieflow::Solve::run).
    pub fn drive(
        &self,
        method: &MethodSpec,
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError> {
        match &self.source {
            Source::Form { quantities, .. } => {
                let asked = Asked { quantities, schema: &self.schema };
                self.form(method).drive(asked, method, plan, watcher)
            }
            Source::Model { base, number } => {
                let mapped = Mapped { base, schema: &self.schema, number: &**number };
                let mut plan = plan;
                let Some(CurvePlace(place)) = plan.curve.take() else {
                    return mapped.drive(method, plan, watcher);
                };
                let mut of_base = None;
                let plan = Plan { curve: Some(CurvePlace(&mut of_base)), ..plan };
                let done = mapped.drive(method, plan, watcher);
                let map = || self.map_of(base, number);
                *place = of_base
                    .map(|curve| Box::new(MappedCurve { curve, map: map() }) as Box<dyn RowCurve>);
                done
            }
        }
    }

    /// The rows at all times of these numbers, of a run of this model by this method.
    ///
    /// # Errors
    /// [`Error::Length`] for another number of them.
    pub fn curve(&self, method: &MethodSpec, numbers: &[f64]) -> Result<Box<dyn RowCurve>, Error> {
        match &self.source {
            Source::Form { quantities, .. } => {
                let asked = Asked { quantities, schema: &self.schema };
                self.form(method).curve(asked, method, numbers)
            }
            Source::Model { base, number } => {
                let (curve, map) = (base.curve(method, numbers)?, self.map_of(base, number));
                Ok(Box::new(MappedCurve { curve, map }))
            }
        }
    }

    /// A run that the caller takes step by step, from the state of the problem or from another one of these numbers (as
    /// [`Outcome::state`] has them).
    ///
    /// # Errors
    /// As [`Solve::integrator`](lieflow::Solve::integrator).
    pub fn stepper(
        &self,
        method: &MethodSpec,
        start: Option<&[f64]>,
        steps: impl Into<StepByStep>,
    ) -> Result<Box<dyn Stepper>, RunError> {
        let steps = steps.into();
        match &self.source {
            Source::Form { quantities, .. } => {
                let asked = Asked { quantities, schema: &self.schema };
                self.form(method).stepper(asked, method, start, steps)
            }
            Source::Model { base, number } => {
                let (run, map) = (base.stepper(method, start, steps)?, self.map_of(base, number));
                Ok(Box::new(MappedStepper { run, map }))
            }
        }
    }

    /// What makes the values of its rows of those of the base.
    fn map_of(&self, base: &Arc<Model>, number: &Arc<NumberOf<'static>>) -> RowMap {
        RowMap::new(base.schema(), &self.schema, number.clone())
    }

    /// Integrates from the initial state in steps of one size; `sink` gets a row where `save` says.
    ///
    /// # Errors
    /// As [`Solve::run`](lieflow::Solve::run).
    pub fn run(
        &self,
        method: &MethodSpec,
        grid: &TimeGrid,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<Stats, RunError> {
        let plan = Plan::new(Steps::Equal(*grid), save.clone());
        self.drive(method, plan, &mut Rows(sink)).map(|outcome| outcome.stats)
    }

    /// The orders of a method on this problem.
    ///
    /// # Errors
    /// As [`MethodsByName::method`](lieflow::catalog::MethodsByName::method).
    pub fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        self.form(method).orders(method)
    }

    /// The order of a method on this problem. None if the method is exact.
    ///
    /// # Errors
    /// As [`orders`](Self::orders).
    pub fn order(&self, method: &MethodSpec) -> Result<Option<usize>, Error> {
        Ok(self.orders(method)?.step)
    }

    /// The name of the type of the problem that the method runs on. The methods are compiled once for each type.
    pub fn problem_type(&self, method: &MethodSpec) -> &'static str {
        self.form(method).problem_type()
    }

    /// The values of the schema at the end of a span by the exact solution; `None` where none is known.
    pub fn exact(&self, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        match &self.source {
            Source::Form { quantities, run, .. } => {
                run.exact(Asked { quantities, schema: &self.schema }, t_span)
            }
            Source::Model { base, number } => {
                let (schema, number) = (&self.schema, &**number);
                Mapped { base, schema, number }.exact(t_span)
            }
        }
    }

    /// The operations of a step (additions, multiplications, divisions, square roots, sines and cosines, each as one), in
    /// the mean over the first [`COUNTED_STEPS`](lieflow::solve::COUNTED_STEPS); `None` where the method has none to
    /// count, as the exact motion. A problem on vectors is counted by `on_vectors`.
    pub fn operations(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        on_vectors: CountOnVectors,
    ) -> Option<f64> {
        self.form(method).operations(method, steps, on_vectors)
    }

    /// What a method offers on this problem, if it can run there. Nothing is integrated.
    ///
    /// # Errors
    /// The reason why it cannot.
    pub fn fits(&self, method: &MethodSpec) -> Result<Fit, Error> {
        self.form(method).fits(method)
    }

    /// Checks that the steps of a method from the start can meet a tolerance.
    ///
    /// # Errors
    /// As [`check_within_reach`](lieflow::space::check_within_reach).
    pub fn check_tolerance(&self, method: &MethodSpec, tolerance: &Tolerance) -> Result<(), Error> {
        self.form(method).check_tolerance(tolerance)
    }
}
