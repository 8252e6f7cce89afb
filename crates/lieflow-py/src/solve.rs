//! Runs of a field of the user.

use std::sync::Arc;

use lieflow::catalog::MethodSpec;
use lieflow::samples::{Interpolation, Samples};
use lieflow::solve::{Status, Stops};
use lieflow::{Error, RunError, SaveAt, TimeGrid};
use lieflow_model::kinds::own::{self, Frame, GroupName, Own, OwnField};
use lieflow_model::problem::{Change, CurvePlace, EventPlan, Plan, RowCurve, StepByStep, Steps};
use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{Input, element, output};
use crate::curve::{Curve, at_times};
use crate::error::{argument, refused, words};
use crate::field::{self, Callable, Raised};
use crate::formulas::Formulas;
use crate::run::{
    EventParts, Fitting, LONGEST, Settings, Watch, Watching, integer, save_of, spec_of,
};
use crate::stepper::Stepper;

/// The space of a run: a group, an action, and the shapes of y and f.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Space {
    space: own::Space,
    /// The methods of its fields, and of those that depend on t alone.
    fitting: [Fitting; 2],
}

/// A group: its name, its form M of size n by rows, or numbers of parts.
#[derive(FromPyObject)]
pub(crate) enum GroupParts {
    Named(String),
    Parts([usize; 3]),
    Form(usize, Vec<f64>),
}

#[pymethods]
impl Space {
    #[new]
    #[pyo3(signature = (group, action, frame, shape))]
    fn new(
        py: Python<'_>,
        group: GroupParts,
        action: &str,
        frame: Option<&str>,
        shape: Vec<usize>,
    ) -> PyResult<Self> {
        let group = match group {
            GroupParts::Form(n, form) if form.len() == n * n => GroupName::Form(n, form),
            GroupParts::Form(n, _) => {
                return Err(argument(py, "group", format!("M of size {n}"), "n×n numbers"));
            }
            GroupParts::Parts(counts) => GroupName::Parts(counts),
            GroupParts::Named(name) => GroupName::Named(name),
        };
        let frame = match frame {
            None => None,
            Some("space") => Some(Frame::Space),
            Some("body") => Some(Frame::Body),
            Some(other) => {
                let expected = "\"space\" (ẏ = f y) or \"body\" (ẏ = y f)";
                return Err(argument(py, "frame", format!("{other:?}"), expected));
            }
        };
        own::Space::new(&group, action, frame, &shape)
            .map(|space| Space { space, fitting: Default::default() })
            .map_err(|wrong| argument(py, wrong.argument, wrong.value, wrong.expected))
    }
    /// The shape of y.
    #[getter]
    fn point(&self) -> Vec<usize> {
        self.space.point().to_vec()
    }
    /// The shape of f.
    #[getter]
    fn value(&self) -> Vec<usize> {
        self.space.value().to_vec()
    }
    /// True if methods for linear equations are there.
    #[getter]
    fn has_linear_methods(&self) -> bool {
        self.space.has_linear_methods()
    }
    /// The curve of these numbers. f is not called.
    fn curve(
        &self,
        py: Python<'_>,
        method: &str,
        linear: bool,
        y0: Vec<f64>,
        numbers: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Curve> {
        let nothing: Arc<OwnField> = Arc::new(|_, _, _| false);
        let numbers = numbers.as_slice()?;
        let made = self
            .space
            .problem(nothing, linear)
            .and_then(|problem| problem.curve(&method.parse::<MethodSpec>()?, &y0, numbers));
        let curve = made.map_err(|error| refused(py, "curve", &error))?;
        Ok(Curve::new(curve, self.space.point()))
    }
    /// A run that is taken step by step.
    fn stepper(
        &self,
        py: Python<'_>,
        field: FieldParts,
        method: &str,
        t_span: [f64; 2],
        y0: Vec<f64>,
        settings: Settings,
    ) -> PyResult<Stepper> {
        let raised = Arc::new(Raised::default());
        let ready = Ready::new(py, self, field, method, (t_span, &y0, &settings), &raised)?;
        let (stops, max_steps) = (settings.stops(), settings.max_steps);
        let cancel = Some(raised.stop.clone());
        let run = StepByStep { steps: ready.steps, stops, max_steps, cancel };
        let run = ready.problem.stepper(&ready.spec, &y0, run);
        if let Some(error) = raised.take() {
            return Err(error);
        }
        Stepper::new(py, run, self.space.point(), (raised, ready.callable))
    }
}

/// The method in the words of the library.
#[pyfunction]
pub(crate) fn check_method(py: Python<'_>, method: &str) -> PyResult<String> {
    Ok(spec_of(py, method)?.label())
}

/// The time in seconds that the search for short pulses may take, after a run of so many steps and seconds.
#[pyfunction]
pub(crate) fn time_to_search(steps: u64, seconds: f64) -> Option<f64> {
    lieflow_model::problem::time_to_search(steps, seconds)
}

/// The tolerance of a second run in that of the first: a tenth, or ten times.
#[pyfunction]
pub(crate) fn other_tolerance(rtol: f64, atol: f64) -> f64 {
    lieflow_model::problem::other_tolerance([rtol, atol])
}

/// How many times shorter the steps of a second search are, after a first one that took so many seconds.
#[pyfunction]
pub(crate) fn finer(seconds: f64, most: f64) -> Option<f64> {
    lieflow_model::problem::finer(seconds, most)
}

/// The size of the steps of a search beside steps of one size.
#[pyfunction]
pub(crate) fn search_step(length: f64, largest: f64) -> f64 {
    lieflow_model::problem::search_step(length, largest)
}

/// Has a search at this distance found something that the run has passed over?
#[pyfunction]
pub(crate) fn is_elsewhere(distance: f64, known: f64) -> bool {
    lieflow_model::problem::is_elsewhere(distance, known)
}

/// Does the distance of a run from a search stay in a finer one?
#[pyfunction]
pub(crate) fn stays(finer: f64, distance: f64) -> bool {
    lieflow_model::problem::stays(finer, distance)
}

/// The times near the ends of steps of this size.
#[pyfunction]
pub(crate) fn near_ends(py: Python<'_>, t_span: [f64; 2], dt: f64) -> PyResult<Vec<f64>> {
    let grid = TimeGrid::new(t_span, dt).map_err(|error| refused(py, "dt", &error))?;
    Ok(lieflow_model::problem::near_ends(&grid).collect())
}

/// f: a callable with its further arguments, the address of a C function with its parameters, formulas, or samples.
#[derive(FromPyObject)]
pub(crate) enum FieldParts {
    Formulas(Py<Formulas>),
    Samples(Py<SampledField>),
    Address(#[pyo3(from_py_with = integer)] usize, Vec<f64>),
    Callable(Py<PyAny>, Vec<Py<PyAny>>),
}

/// Samples as f, a function of time.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct SampledField(Arc<Samples>);

#[pymethods]
impl SampledField {
    #[new]
    fn new(
        py: Python<'_>,
        t: PyReadonlyArray1<'_, f64>,
        columns: Vec<PyReadonlyArray1<'_, f64>>,
        interpolation: &str,
    ) -> PyResult<Self> {
        let columns = columns.iter().map(|x| x.as_slice()).collect::<Result<Vec<_>, _>>()?;
        let t = t.as_slice()?;
        let kind = Interpolation::named(interpolation)
            .map_err(|error| refused(py, "interpolation", &error))?;
        let made = Samples::new(t, &columns, kind);
        made.map(|samples| SampledField(samples.into())).map_err(|error| of_samples(py, &error))
    }
    /// The times within a span at which the samples jump, and those at which only their derivatives do. A span beyond the
    /// samples is refused.
    fn knots(&self, py: Python<'_>, t_span: [f64; 2]) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let Stops { jumps, kinks } = knots(py, &self.0, t_span)?;
        Ok((jumps, kinks))
    }
    /// The values at these times, by rows.
    fn at<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let py = t.py();
        let t = Input::any("t", t, 0)?;
        let (lead, columns) = (t.shape().to_vec(), self.0.columns());
        let out = output(py, (&lead, &[columns]), None, &mut [])?;
        // SAFETY: the array is new.
        let numbers = unsafe { out.as_slice_mut()? };
        let times = t.numbers();
        at_times(py, times, numbers, |part, numbers| {
            let mut rows = part.iter().zip(numbers.chunks_exact_mut(columns));
            rows.try_for_each(|(t, out)| self.0.value(*t, out)).map_err(|outside| {
                let [first, last] = outside.span;
                let expected = format!("a time within the samples, from {first} to {last}");
                let wrong = |t: &f64| !(first <= *t && *t <= last);
                let i = times.iter().position(wrong).unwrap_or_default();
                let name = element("t", &lead, i);
                Python::attach(|py| argument(py, &name, times[i].to_string(), expected))
            })
        })?;
        Ok(out)
    }
}

/// The exception of samples that cannot be used: `columns[j][k]` is `values[k, j]`.
fn of_samples(py: Python<'_>, error: &Error) -> PyErr {
    let (arg, value, expected) = words("t", error);
    let place = arg.strip_prefix("columns[").and_then(|rest| rest.strip_suffix(']'));
    let arg = match place.and_then(|place| place.split_once("][")) {
        Some((column, row)) => format!("values[{row}, {column}]"),
        None => arg,
    };
    argument(py, &arg, value, expected)
}

/// The times within a span at which samples are not smooth. A span beyond them is refused.
pub(crate) fn knots(py: Python<'_>, samples: &Samples, t_span: [f64; 2]) -> PyResult<Stops> {
    samples.covers(t_span).map_err(|outside| {
        let ([start, end], [first, last]) = (t_span, outside.span);
        let expected = format!("a span within that of the samples, {first} to {last}");
        argument(py, "t_span", format!("({start}, {end})"), expected)
    })?;
    Ok(Stops::at_knots(samples, t_span))
}

/// A run that is set up.
struct Ready {
    problem: Own,
    spec: MethodSpec,
    steps: Steps,
    /// f, if it calls Python.
    callable: Option<Arc<Callable>>,
}

impl Ready {
    fn new(
        py: Python<'_>,
        space: &Space,
        field: FieldParts,
        method: &str,
        (t_span, y0, settings): ([f64; 2], &[f64], &Settings),
        raised: &Arc<Raised>,
    ) -> PyResult<Self> {
        let (fitting, space) = (&space.fitting[usize::from(settings.linear)], &space.space);
        let shape = space.point();
        let mut callable = None;
        let field = match field {
            FieldParts::Address(0, _) => {
                return Err(argument(py, "fun", "a null address", "the address of a C function"));
            }
            FieldParts::Address(address, parameters) => {
                field::of_address(address, parameters, raised.clone())
            }
            FieldParts::Formulas(formulas) => formulas.get().0.field(),
            FieldParts::Samples(samples) => {
                let samples = samples.get().0.clone();
                Arc::new(move |t: f64, _: &[f64], v: &mut [f64]| samples.value(t, v).is_ok())
            }
            FieldParts::Callable(f, args) => {
                let f = Callable::new(f, args, (shape, settings.linear), raised.clone());
                field::of_callable(callable.insert(Arc::new(f)).clone(), space.value())
            }
        };
        if t_span[0] == t_span[1] {
            // A run without steps does not call f.
            field(t_span[0], y0, &mut vec![0.0; space.value().iter().product()]);
        }
        let refuse = |error: Error| refused(py, "fun", &error);
        let problem = space.problem(field, settings.linear).map_err(refuse)?;
        let orders = |spec: &MethodSpec| {
            let orders = space.check_linear(spec).and_then(|()| problem.orders(spec));
            orders.map_err(|error| error.to_string())
        };
        let (spec, orders) = fitting.method(py, method, orders)?;
        let steps = settings.steps(py, t_span, (orders, || y0.into()), "fun")?;
        Ok(Ready { problem, spec, steps, callable })
    }
}

#[pyfunction]
#[pyo3(signature = (space, field, args, method, t_span, y0, settings, t_eval, events, callback = None))]
pub(crate) fn solve<'py>(
    py: Python<'py>,
    space: &Space,
    field: FieldParts,
    args: Vec<Py<PyAny>>,
    method: &str,
    t_span: [f64; 2],
    y0: Vec<f64>,
    settings: Settings,
    t_eval: Option<PyReadonlyArray1<'py, f64>>,
    events: Vec<EventParts>,
    callback: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (raised, shape) = (Arc::new(Raised::default()), space.space.point());
    let formulas = match &field {
        FieldParts::Formulas(formulas) => Some(formulas.clone_ref(py)),
        _ => None,
    };
    let ready = Ready::new(py, space, field, method, (t_span, &y0, &settings), &raised)?;
    formulas.iter().for_each(|formulas| formulas.get().0.forget());
    let mut watch = Watch::new(py, (events, callback), &args, (shape, shape), raised.clone());
    let save = save_of(t_eval)?;
    let attached = ready.callable.is_some() || watch.has_callables();
    let mut run = || drive(&ready, &y0, (&settings, save.clone()), &mut watch);
    let (status, curve) = if attached { run() } else { py.detach(run) };
    // The points at all times need no call of f. It may refer to the result, in a cycle that Python does not see.
    ready.callable.iter().for_each(|f| f.clear());
    let lost = status.as_ref().err().zip(formulas.as_ref());
    let lost = lost.and_then(|(error, formulas)| formulas.get().lost_by(py, error));
    let result = watch.seen.into_dict(py, &raised, status, (shape, LONGEST), Some(&ready.steps))?;
    result.set_item("lost", lost.transpose()?)?;
    let curve = curve.map(|curve| Py::new(py, Curve::new(curve, shape))).transpose()?;
    result.set_item("curve", curve)?;
    Ok(result)
}

/// Runs it. Returns why it ended, and its points at all times, if they are kept.
fn drive(
    ready: &Ready,
    y0: &[f64],
    (settings, save): (&Settings, SaveAt),
    watch: &mut Watch,
) -> (Result<Status, RunError>, Option<Box<dyn RowCurve>>) {
    let (events, callback, raised, seen) = watch.parts();
    let events = events.iter().map(|event| EventPlan {
        direction: event.direction,
        stop_after: event.stop_after,
        points: event.points,
        change: event
            .change
            .is_some()
            .then(|| -> Change<'_> { Box::new(|t, y| event.change(t, y)) }),
        ..EventPlan::new(event.name.clone(), Vec::new(), |t, row| event.value(t, row.values()))
    });
    let mut curve = None;
    let plan = Plan {
        stops: settings.stops(),
        max_steps: settings.max_steps,
        events: events.collect(),
        cancel: Some(&*raised.stop),
        curve: settings.dense_output.then_some(CurvePlace(&mut curve)),
        ..Plan::new(ready.steps.clone(), save)
    };
    let mut watcher = Watching { callback, raised, seen };
    let done = ready.problem.run(&ready.spec, y0, plan, &mut watcher);
    (done.map(|outcome| outcome.status), curve)
}
