//! The forms of a problem: ways to represent its state, and what is known of it before any run.

use core::any::Any;
use core::fmt::Debug;
use std::sync::Arc;

use lieflow::catalog::MethodSpec;
use lieflow::solve::Stops;
use lieflow::tolerance::Tolerance;
use lieflow::{Error, RunError};
use lieflow_runs::run::{
    CountOnVectors, Fit, Layer, Orders, Outcome, Plan, RowCurve, StepByStep, Stepper, Steps,
    Watcher,
};
use lieflow_runs::schema::{Law, Schema};

use super::kind::{Figure, PrincipalInertia, Property, high_order};
use crate::formula::Formula;
use crate::reader::Refusal;

/// The quantities of a row, by their numbers in the list of the kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    pub(crate) quantities: &'a [usize],
    pub(crate) schema: &'a Schema,
}

/// A problem in one form, on which any method runs. Quantities are numbered as in the list of the kind.
pub(crate) trait Run: Debug + Send + Sync {
    /// The reason why the form lacks a quantity. None if it has the quantity.
    fn missing(&self, quantity: usize) -> Option<&'static str>;
    /// The names of the columns of a quantity.
    fn columns(&self, quantity: usize) -> Vec<String>;
    /// The law of a quantity.
    fn law(&self, quantity: usize) -> Option<Law>;
    /// Adds a quantity to a schema.
    fn describe(&self, quantity: usize, schema: &mut Schema);
    /// What is integrated, in words.
    fn modelled(&self) -> String;
    /// See [`Model::start`](super::Model::start).
    fn start(&self) -> Result<Vec<f64>, Error>;
    /// See [`Model::drive`](super::Model::drive).
    fn drive(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError>;
    /// See [`Model::stepper`](super::Model::stepper).
    fn stepper(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        start: Option<&[f64]>,
        steps: StepByStep,
    ) -> Result<Box<dyn Stepper>, RunError>;
    /// See [`Model::curve`](super::Model::curve).
    fn curve(
        &self,
        asked: Asked<'_>,
        method: &MethodSpec,
        numbers: &[f64],
    ) -> Result<Box<dyn RowCurve>, Error>;
    /// See [`Model::exact`](super::Model::exact).
    fn exact(&self, asked: Asked<'_>, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>>;
    /// See [`Model::orders`](super::Model::orders).
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error>;
    /// See [`Model::problem_type`](super::Model::problem_type).
    fn problem_type(&self) -> &'static str;
    /// See [`Model::fits`](super::Model::fits).
    fn fits(&self, method: &MethodSpec) -> Result<Fit, Error>;
    /// See [`Model::check_tolerance`](super::Model::check_tolerance).
    fn check_tolerance(&self, tolerance: &Tolerance) -> Result<(), Error>;
    /// See [`Model::operations`](super::Model::operations).
    fn operations(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        on_vectors: CountOnVectors,
    ) -> Option<f64>;
    /// See [`Problem::check_start`](super::Problem::check_start).
    fn check_start(&self, _t0: f64) -> Vec<Refusal> {
        Vec::new()
    }
    /// See [`Problem::knots`](super::Problem::knots).
    fn knots(&self, _t_span: [f64; 2]) -> Option<Stops> {
        None
    }
    /// See [`Problem::field`](super::Problem::field).
    fn field(&self, _values: &[f64]) -> Vec<Vec<f64>> {
        Vec::new()
    }
}

/// A form with what follows from it.
#[derive(Clone, Debug)]
pub(crate) struct Form {
    pub(crate) layer: Layer,
    /// True for a form that only the methods run on that need the whole state as one point.
    pub(crate) whole_state: bool,
    /// The quantities that make up the state.
    pub(crate) state: &'static [&'static str],
    pub(crate) figure: Figure,
    pub(crate) run: Arc<dyn Run>,
}

/// The forms of a problem with what is known of it: what the file of a kind makes of its keys.
///
/// A run takes the first form of its layer that has the quantities that are asked for.
#[derive(Clone, Debug)]
pub struct Forms {
    pub(crate) forms: Vec<Form>,
    pub(crate) default_method: MethodSpec,
    pub(crate) default_state: Option<&'static [&'static str]>,
    pub(crate) formula: Option<Formula>,
    pub(crate) inertia: Option<PrincipalInertia>,
    pub(crate) rate: Option<f64>,
    pub(crate) facts: Vec<Property>,
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
    pub(crate) spec: Option<Arc<dyn Any + Send + Sync>>,
}

impl Forms {
    /// One form, of which nothing else is known.
    pub(crate) fn one(form: Form) -> Self {
        Forms {
            forms: vec![form],
            default_method: high_order(),
            default_state: None,
            formula: None,
            inertia: None,
            rate: None,
            facts: Vec::new(),
            warnings: Vec::new(),
            notes: Vec::new(),
            spec: None,
        }
    }

    /// Adds the forms of other ones at the end.
    pub(crate) fn or(mut self, other: Forms) -> Self {
        self.forms.extend(other.forms);
        self
    }

    /// Leaves the forms to the methods that need the whole state as one point.
    pub(crate) fn for_whole_state(mut self) -> Self {
        self.forms.iter_mut().for_each(|form| form.whole_state = true);
        self
    }

    /// The quantities that are written where a scene asks for none.
    pub(crate) fn written(self, state: &'static [&'static str]) -> Self {
        Forms { default_state: Some(state), ..self }
    }

    /// Keeps the values of the keys, for who knows their type.
    pub(crate) fn with_spec(self, spec: impl Any + Send + Sync) -> Self {
        Forms { spec: Some(Arc::new(spec)), ..self }
    }
}
