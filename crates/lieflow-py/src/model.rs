//! Problems by the name of their kind, and their runs.

use std::sync::Arc;

use lieflow::catalog::{MethodSpec, all_methods};
use lieflow::{RunError, SaveAt, TimeGrid};
use lieflow_model::kinds::{KINDS, named};
use lieflow_model::problem::{
    self, CurvePlace, EventPlan, KNOTS_MAX, Kept, KeyInfo, Layer, Orders, Outcome, Plan,
    StepByStep, Steps, Stops,
};
use lieflow_model::reader::{ReadError, Shape, Tree};
use lieflow_model::scene::{Columns, OnRows, RowFormula};
use lieflow_model::schema::{Dimension, Numbers, Observable, Part, Row, Schema};
use numpy::{PyArray1, PyArrayDyn, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::curve::Curve;
use crate::error::{argument, refused};
use crate::field::{self, Raised};
use crate::run::{
    EventParts, Fitting, Function, LONGEST, Settings, Signals, Watch, Watched, Watching, save_of,
};
use crate::solve::knots;
use crate::stepper::Stepper;
use crate::tree::{in_python, mistake, mistakes, tree};

/// What a value of this shape is, in words.
fn shape_words(shape: Shape) -> String {
    match shape {
        Shape::Bool => "True or False".into(),
        Shape::Whole => "a whole number".into(),
        Shape::Number => "a number".into(),
        Shape::Numbers(n) => format!("shape ({n},)"),
        Shape::List => "shape (n,)".into(),
        Shape::Rows => "shape (n, k)".into(),
        Shape::Square(n) => format!("shape ({n}, {n})"),
        Shape::Text => "a text".into(),
        Shape::Formula => "a formula: a text or a number".into(),
        Shape::Formulas => "a formula or a list of them".into(),
        Shape::ListOf(entry) => format!("a list, of each {}", shape_words(*entry)),
        Shape::TableOf(entry) => format!("a dict of names, each {}", shape_words(*entry)),
        Shape::Keys(keys) => {
            let names: Vec<&str> = keys.iter().map(|(name, _)| *name).collect();
            format!("a dict of {}", names.join(", "))
        }
        Shape::Or(a, b) => format!("{}, or {}", shape_words(*a), shape_words(*b)),
        Shape::Samples => "lieflow.Samples, or the name of a CSV file".into(),
    }
}

/// The type of a value of this shape, for type checkers.
fn shape_type(shape: Shape) -> String {
    match shape {
        Shape::Bool => "bool".into(),
        Shape::Whole => "int | str".into(),
        Shape::Number => "float | str".into(),
        Shape::Numbers(_) | Shape::List | Shape::Rows | Shape::Square(_) => "Numbers".into(),
        Shape::Text => "str".into(),
        Shape::Formula => "str | float".into(),
        Shape::Formulas => "str | float | Numbers".into(),
        Shape::ListOf(_) => "Sequence[Any]".into(),
        Shape::TableOf(_) | Shape::Keys(_) => "Mapping[str, Any]".into(),
        Shape::Or(a, b) => format!("{} | {}", shape_type(*a), shape_type(*b)),
        Shape::Samples => "Samples | str".into(),
    }
}

/// A dimension in words; empty where it is not known.
fn words(dimension: Option<Dimension>) -> String {
    dimension.map(|dimension| dimension.to_string()).unwrap_or_default()
}

/// What every kind states: its name, equation, summary, keys and quantities.
#[pyfunction]
pub(crate) fn kinds(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let kind = |kind: &problem::Kind| {
        let all = PyDict::new(py);
        all.set_item("name", kind.name)?;
        all.set_item("equation", kind.equation)?;
        all.set_item("summary", kind.summary)?;
        let keys = kind.keys.iter().map(|key| {
            let KeyInfo { name, meaning, shape, optional, dimension } = *key;
            (name, meaning, shape_words(shape), optional, shape_type(shape), words(dimension))
        });
        all.set_item("keys", keys.collect::<Vec<_>>())?;
        let quantities = (kind.quantities)().into_iter();
        let quantities =
            quantities.map(|q| (q.name, q.column_names(), q.meaning, words(q.dimension)));
        all.set_item("quantities", quantities.collect::<Vec<_>>())?;
        let laws = (kind.quantities)().into_iter().filter(|q| q.kept != Kept::Never);
        let laws = laws.map(|q| (q.name, q.kept == Kept::Always));
        all.set_item("laws", laws.collect::<Vec<_>>())?;
        Ok(all)
    };
    KINDS.iter().map(kind).collect()
}

/// A problem of a kind.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Problem {
    problem: problem::Problem,
    keys: Tree,
}

fn names(quantities: &[String]) -> Vec<&str> {
    quantities.iter().map(String::as_str).collect()
}

#[pymethods]
impl Problem {
    #[new]
    fn new(kind: &str, keys: &Bound<'_, PyDict>) -> PyResult<Self> {
        let py = keys.py();
        let kind = named(kind).map_err(|error| refused(py, "kind", &error))?;
        let keys = tree("", keys)?;
        let problem = kind.problem(&keys).map_err(|error| mistakes(py, &error))?;
        Ok(Problem { problem, keys })
    }
    /// The name of the default method.
    #[getter]
    fn method(&self) -> String {
        self.problem.default_method().label()
    }
    /// The quantities that are given where none are asked for.
    #[getter]
    fn quantities(&self) -> Vec<&'static str> {
        self.problem.default_state().to_vec()
    }
    /// The layers.
    #[getter]
    fn layers(&self) -> Vec<&'static str> {
        self.problem.layers().into_iter().map(Layer::name).collect()
    }
    /// What is known before a run.
    #[getter]
    fn facts(&self) -> Vec<(&'static str, f64)> {
        self.problem.facts().iter().map(|fact| (fact.name, fact.value)).collect()
    }
    /// What a reader should know: changed numbers, and warnings.
    #[getter]
    fn notes(&self) -> Vec<String> {
        [self.problem.notes(), self.problem.warnings()].concat()
    }
    /// What is wrong with the numbers, though they can be integrated.
    #[getter]
    fn warnings(&self) -> &[String] {
        self.problem.warnings()
    }
    /// What the exact motion keeps, of what follows from these quantities.
    fn invariants(&self, quantities: Vec<String>) -> Vec<&'static str> {
        self.problem.invariants(&names(&quantities))
    }
    /// The quantities of the state that these are made of.
    fn state(&self, quantities: Vec<String>) -> Vec<&'static str> {
        self.problem.state(&names(&quantities)).to_vec()
    }
    /// The columns of a quantity.
    fn columns(&self, py: Python<'_>, quantity: &str) -> PyResult<Vec<String>> {
        let found = self.problem.columns(quantity);
        found.map_err(|error| argument(py, "quantities", error.to_string(), ""))
    }
    /// The name of a quantity that may be spelled in another way, as in a scene.
    fn named(&self, py: Python<'_>, quantity: &str) -> PyResult<&'static str> {
        self.columns(py, quantity)?;
        let found = self.problem.kind().quantity(quantity);
        found
            .map(|quantity| quantity.name)
            .map_err(|error| argument(py, "quantities", error.to_string(), ""))
    }
    /// The times at which the right-hand side jumps, and those at which only its derivatives do.
    fn knots(&self, py: Python<'_>, t_span: [f64; 2]) -> PyResult<(Vec<f64>, Vec<f64>)> {
        if let Some(samples) = self.problem.samples() {
            knots(py, samples, t_span)?;
        }
        let stops = self.problem.knots(t_span).unwrap_or_default();
        if stops.len() > KNOTS_MAX {
            let [start, end] = t_span;
            let expected = match end.is_finite() {
                true => format!("a span in which f jumps at most {KNOTS_MAX} times"),
                false => "a finite end: f jumps again and again".into(),
            };
            return Err(argument(py, "t_span", format!("({start}, {end})"), expected));
        }
        let Stops { jumps, kinks } = stops;
        Ok((jumps, kinks))
    }
    /// The problem with these quantities on a layer. `events` are formulas of its columns, each with its path.
    #[pyo3(signature = (quantities, layer = None, events = vec![]))]
    fn model(
        &self,
        py: Python<'_>,
        quantities: Vec<String>,
        layer: Option<&str>,
        events: Vec<(String, String)>,
    ) -> PyResult<Model> {
        let layer = match layer {
            Some(name) => Layer::named(name).map_err(|error| refused(py, "layer", &error))?,
            None => self.problem.layers()[0],
        };
        let formulas: Vec<RowFormula> = if events.is_empty() {
            Vec::new()
        } else {
            let columns = Columns::of_keys(&self.problem, &self.keys, &quantities);
            let columns = columns.map_err(|error| mistakes(py, &error))?;
            let read = |(path, text): &(String, String)| columns.read(path, text);
            let formulas = events.iter().map(read).collect::<Result<_, _>>();
            formulas.map_err(|error: ReadError| mistakes(py, &error.into()))?
        };
        let mut all = names(&quantities);
        for name in formulas.iter().flat_map(RowFormula::quantities) {
            if !all.contains(&name) {
                all.push(name);
            }
        }
        let model = self.problem.model(layer, &all);
        let model = model.map_err(|error| refused(py, "quantities", &error))?;
        let formulas = formulas.iter().map(|formula| formula.on(model.schema()).map(Arc::new));
        let formulas = formulas.collect::<Result<_, _>>();
        let formulas = formulas.map_err(|error| refused(py, "events", &error))?;
        Ok(Model { problem: self.problem.clone(), model, formulas, fitting: Fitting::default() })
    }
}

/// A quantity of a row: its name, its columns, its shape, whether the exact motion keeps it, and the parts of its complex
/// numbers.
type Quantity = (&'static str, Vec<String>, Vec<usize>, bool, Vec<[Part; 2]>);

/// The quantities of a row.
pub(crate) fn schema_of(schema: &Schema) -> Vec<Quantity> {
    let each = |o: &Observable| {
        let parts = o.numbers.parts(o.columns.len());
        (o.name, o.columns.clone(), o.shape.clone(), o.law.is_some(), parts)
    };
    schema.iter().map(each).collect()
}

/// A problem with the quantities that are asked for.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Model {
    problem: problem::Problem,
    model: problem::Model,
    /// The functions of events.
    formulas: Vec<Arc<OnRows>>,
    fitting: Fitting,
}

/// A function of t and a row.
type RowValue<'a> = Box<dyn Fn(f64, Row<'_>) -> f64 + 'a>;

impl Model {
    /// The row at the start of a run from t0, if it has one: it has the signs that the keys say.
    fn start_row(&self, method: &MethodSpec, t0: f64) -> Option<Vec<f64>> {
        let grid = TimeGrid::new([t0, t0 + 1.0], 1.0).ok()?;
        let run = self.model.stepper(method, None, Steps::Equal(grid)).ok()?;
        let mut row = Vec::with_capacity(self.width());
        run.row(&mut row);
        Some(row)
    }
    fn width(&self) -> usize {
        self.model.schema().columns().count()
    }

    fn method(&self, py: Python<'_>, method: &str) -> PyResult<(MethodSpec, Orders)> {
        self.fitting.method(py, method, |spec| {
            let orders = self.model.fits(spec).and_then(|_| self.model.orders(spec));
            orders.map_err(|error| format!("{error}{}", self.other_state(spec)))
        })
    }

    /// The quantities whose state a method integrates that does not fit these, in words: all, or the first ones.
    fn other_state(&self, method: &MethodSpec) -> String {
        let fits = |name: &&str| {
            let model = self.problem.model(self.problem.layers()[0], &[name]);
            model.is_ok_and(|model| model.fits(method).is_ok())
        };
        let quantities = (self.problem.kind().quantities)().into_iter().map(|q| q.name);
        match *quantities.filter(fits).collect::<Vec<_>>() {
            [] => String::new(),
            [a, b, c, _, _, ..] => format!("; it runs where quantities are among {a}, {b}, {c}, …"),
            ref names => format!("; it runs where quantities are among {}", names.join(", ")),
        }
    }

    fn event<'a>(&'a self, event: &'a Watched) -> EventPlan<'a> {
        let (places, value): (_, RowValue<'a>) = match event.function {
            Function::Column(number) => {
                let formula = self.formulas[number].clone();
                (formula.places().collect(), Box::new(move |t, row| formula.value(t, row)))
            }
            _ => ((0..self.width()).collect(), Box::new(|t, row| event.value(t, row.values()))),
        };
        EventPlan {
            direction: event.direction,
            stop_after: event.stop_after,
            points: event.points,
            change: event.change.is_some().then(|| -> problem::Change<'a> {
                Box::new(|t, numbers| event.change(t, numbers))
            }),
            ..EventPlan::new(event.name.clone(), places, value)
        }
    }

    /// The numbers of this start, or of that of the problem.
    fn numbers(&self, spec: &MethodSpec, start: Option<&[f64]>) -> Vec<f64> {
        start.map_or_else(|| self.model.start(spec).unwrap_or_default(), <[f64]>::to_vec)
    }

    fn drive(
        &self,
        (spec, start): (&MethodSpec, Option<Vec<f64>>),
        (steps, save): (Steps, SaveAt),
        settings: &Settings,
        watch: &mut Watch,
    ) -> (Result<Outcome, RunError>, Option<Curve>) {
        let (events, callback, raised, seen) = watch.parts();
        let mut curve = None;
        let plan = Plan {
            stops: settings.stops(),
            max_steps: settings.max_steps,
            events: events.iter().map(|event| self.event(event)).collect(),
            cancel: Some(&*raised.stop),
            curve: settings.dense_output.then_some(CurvePlace(&mut curve)),
            start,
            ..Plan::new(steps, save)
        };
        let mut watcher = Watching { callback, raised, seen };
        let done = self.model.drive(spec, plan, &mut watcher);
        let curve = curve.map(|curve| Curve::new(curve, &[self.width()]));
        (done, curve)
    }
}

#[pymethods]
impl Model {
    /// Does the point state a matrix by all its real and then all its imaginary parts?
    #[getter]
    fn by_parts(&self) -> bool {
        self.model.schema().iter().any(|o| o.numbers == Numbers::SkewHermitian)
    }
    /// The quantities of a row.
    #[getter]
    fn schema(&self) -> Vec<Quantity> {
        schema_of(self.model.schema())
    }
    /// The names of the methods that fit.
    fn methods(&self) -> Vec<&'static str> {
        let fits = |name: &str| self.model.fits(&MethodSpec::new(name, None)).is_ok();
        all_methods().map(|info| info.name).filter(|name| fits(name)).collect()
    }
    /// The order of the steps of a method, None if they are exact, and of the points within a step.
    fn orders(&self, py: Python<'_>, method: &str) -> PyResult<(Option<usize>, Option<usize>)> {
        let (_, orders) = self.method(py, method)?;
        Ok((orders.step, Some(orders.within).filter(|order| *order != usize::MAX)))
    }
    /// True if the points within its steps can be kept as numbers: of steps of given size, and of steps by error.
    fn keeps_points(&self, py: Python<'_>, method: &str) -> PyResult<[bool; 2]> {
        let (spec, _) = self.method(py, method)?;
        let fit = self.model.fits(&spec).map_err(|error| refused(py, "method", &error))?;
        Ok(fit.keeps_points)
    }
    /// The numbers of the state at the start.
    fn start<'py>(&self, py: Python<'py>, method: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let start = self.model.start(&self.method(py, method)?.0);
        let start = start.map_err(|error| refused(py, "problem", &error))?;
        Ok(PyArray1::from_vec(py, start))
    }
    /// Runs it.
    #[pyo3(signature = (method, t_span, start, settings, t_eval, events, callback = None))]
    fn solve<'py>(
        &self,
        py: Python<'py>,
        method: &str,
        t_span: [f64; 2],
        start: Option<PyReadonlyArray1<'py, f64>>,
        settings: Settings,
        t_eval: Option<PyReadonlyArray1<'py, f64>>,
        events: Vec<EventParts>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (spec, orders) = self.method(py, method)?;
        if let Some(refusal) = self.problem.check_start(t_span[0]).into_iter().next() {
            return Err(mistake(py, refusal));
        }
        let start = start.map(|start| start.as_slice().map(<[f64]>::to_vec)).transpose()?;
        let numbers = || self.numbers(&spec, start.as_deref());
        let steps = settings.steps(py, t_span, (orders, numbers), "solve_ivp")?;
        let (raised, shape) = (Arc::new(Raised::default()), [self.width()]);
        let state = match events.iter().any(|(.., change, _)| change.is_some()) {
            true => self.model.start(&spec).map_or(0, |numbers| numbers.len()),
            false => 0,
        };
        let parts = (events, callback);
        let mut watch = Watch::new(py, parts, &[], (&shape, &[state]), raised.clone());
        let (attached, save) = (watch.has_callables(), save_of(t_eval)?);
        if let Some(formula) = self.problem.formula() {
            formula.forget();
        }
        let mut run = || {
            let (steps, save) = (steps.clone(), save.clone());
            self.drive((&spec, start.clone()), (steps, save), &settings, &mut watch)
        };
        let (done, curve) = if attached { run() } else { py.detach(run) };
        let status = done.map(|outcome| outcome.status);
        let lost = status.as_ref().err().and_then(|error| self.problem.formula()?.lost_by(error));
        let result = watch.seen.into_dict(py, &raised, status, (&shape, LONGEST), Some(&steps))?;
        result.set_item("lost", lost.map(|lost| in_python(lost).to_string()))?;
        result.set_item("curve", curve.map(|curve| Py::new(py, curve)).transpose()?)?;
        Ok(result)
    }
    /// The name of the form of the problem that a method runs on. The numbers of a state are those of one form.
    fn form(&self, py: Python<'_>, method: &str) -> PyResult<&'static str> {
        Ok(self.model.problem_type(&self.method(py, method)?.0))
    }
    /// The rows of the exact motion at these times; None where it is not known.
    #[pyo3(signature = (t0, t, method, rows = None))]
    fn exact<'py>(
        &self,
        py: Python<'py>,
        t0: f64,
        t: PyReadonlyArray1<'py, f64>,
        method: &str,
        rows: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
        let times = t.as_slice()?;
        let rows = rows.as_ref().map(|rows| rows.as_slice()).transpose()?;
        let method = self.method(py, method)?.0;
        let found = py.detach(|| {
            let mut numbers: Vec<f64> = Vec::with_capacity(self.width() * times.len());
            let mut signals = Signals::default();
            for (i, &t) in times.iter().enumerate() {
                signals.ask().map_err(Ok)?;
                let mut row = match self.model.exact([t0, t]) {
                    None => return Ok(None),
                    Some(row) => row.map_err(|error| Err((i, error)))?,
                };
                let start;
                let before = match (rows, numbers.len().checked_sub(row.len())) {
                    (Some(rows), _) => rows.get(i * row.len()..(i + 1) * row.len()),
                    (None, Some(before)) => numbers.get(before..),
                    (None, None) => {
                        start = self.start_row(&method, t0);
                        start.as_deref()
                    }
                };
                if let Some(before) = before {
                    self.model.schema().follow(before, &mut row);
                }
                numbers.append(&mut row);
            }
            Ok(Some(numbers))
        });
        let refuse = |(i, error)| refused(py, &format!("t[{i}]"), &error);
        let found = found.map_err(|error: Result<PyErr, _>| error.unwrap_or_else(refuse))?;
        let array = |x: Vec<f64>| field::array(py, &[times.len(), self.width()], &x);
        found.map(array).transpose()
    }
    /// The curve of these numbers.
    fn curve(
        &self,
        py: Python<'_>,
        method: &str,
        numbers: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Curve> {
        let curve = self.model.curve(&self.method(py, method)?.0, numbers.as_slice()?);
        let curve = curve.map_err(|error| refused(py, "curve", &error))?;
        Ok(Curve::new(curve, &[self.width()]))
    }
    /// A run that is taken step by step.
    fn stepper(
        &self,
        py: Python<'_>,
        method: &str,
        t_span: [f64; 2],
        start: Option<PyReadonlyArray1<'_, f64>>,
        settings: Settings,
    ) -> PyResult<Stepper> {
        let (spec, orders) = self.method(py, method)?;
        let start = start.as_ref().map(|start| start.as_slice()).transpose()?;
        let numbers = || self.numbers(&spec, start);
        let steps = settings.steps(py, t_span, (orders, numbers), "Integrator")?;
        let (stops, max_steps) = (settings.stops(), settings.max_steps);
        let run = StepByStep { steps, stops, max_steps, cancel: None };
        let run = self.model.stepper(&spec, start, run);
        Stepper::new(py, run, &[self.width()], (Arc::default(), None))
    }
}
