//! Runs of a field of the user.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use lieflow::catalog::MethodSpec;
use lieflow::solve::Status;
use lieflow::{Direction, RunError, SaveAt, StepControl, TimeGrid};
use lieflow_model::kinds::own::{self, Frame, GroupName, OwnEvent, OwnField, OwnPlan, Pace, Ran};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::curve::Curve;
use crate::error::{argument, of_run, refused};
use crate::field::{self, Callable, Raised};

/// How often a run asks for signals.
const SIGNALS: Duration = Duration::from_millis(20);

/// The space of a run: a group, an action, and the shapes of y and f.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Space(own::Space);

#[pymethods]
impl Space {
    #[new]
    #[pyo3(signature = (group, form, action, frame, shape))]
    fn new(
        py: Python<'_>,
        group: String,
        form: Option<(usize, Vec<f64>)>,
        action: &str,
        frame: Option<&str>,
        shape: Vec<usize>,
    ) -> PyResult<Self> {
        let group = match form {
            Some((n, form)) if form.len() == n * n => GroupName::Form(n, form),
            _ => GroupName::Named(group),
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
            .map(Space)
            .map_err(|wrong| argument(py, wrong.argument, wrong.value, wrong.expected))
    }
    /// The shape of y.
    #[getter]
    fn point(&self) -> Vec<usize> {
        self.0.point().to_vec()
    }
    /// The shape of f.
    #[getter]
    fn value(&self) -> Vec<usize> {
        self.0.value().to_vec()
    }
    /// The curve of these numbers. f is not called.
    fn curve(
        &self,
        py: Python<'_>,
        method: &str,
        linear: bool,
        y0: Vec<f64>,
        numbers: Vec<f64>,
    ) -> PyResult<Curve> {
        let nothing: Arc<OwnField> = Arc::new(|_, _, _| false);
        let made = self
            .0
            .problem(nothing, linear)
            .and_then(|problem| problem.curve(&method.parse::<MethodSpec>()?, &y0, &numbers));
        let curve: Box<dyn own::Curve> = made.map_err(|error| refused(py, "curve", &error))?;
        Ok(Curve { curve: curve.into(), shape: self.0.point().to_vec() })
    }
}

/// The method in the words of the library.
#[pyfunction]
pub(crate) fn check_method(py: Python<'_>, method: &str) -> PyResult<String> {
    let spec = spec_of(py, method)?;
    Ok(spec.label())
}

fn spec_of(py: Python<'_>, method: &str) -> PyResult<MethodSpec> {
    let spec = method.parse::<MethodSpec>();
    spec.and_then(|spec| spec.choose().map(|_| spec.clone()))
        .map_err(|error| argument(py, "method", format!("{method:?}"), error.to_string()))
}

/// An event: the function, its name, direction, the zero that ends the run or 0, what changes y, points.
type EventParts = (Py<PyAny>, String, f64, u64, Option<Py<PyAny>>, Option<u32>);

/// The settings of the steps.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings {
    rtol: f64,
    atol: f64,
    first_step: Option<f64>,
    min_step: Option<f64>,
    max_step: Option<f64>,
    max_steps: Option<u64>,
    dt: Option<f64>,
    steps: Option<u64>,
    t_eval: Option<Vec<f64>>,
    stops: Vec<f64>,
    dense_output: bool,
    linear: bool,
}

impl Settings {
    fn pace(&self, t_span: [f64; 2]) -> Result<Pace, lieflow::Error> {
        Ok(match (self.dt, self.steps) {
            (Some(dt), _) => Pace::Equal(TimeGrid::new(t_span, dt)?),
            (None, Some(steps)) => Pace::Equal(TimeGrid::with_steps(t_span, steps)?),
            (None, None) => {
                let mut control = StepControl::new(self.rtol, self.atol)?;
                if let Some(h) = self.max_step {
                    control = control.max_step(h)?;
                }
                if let Some(h) = self.min_step {
                    control = control.min_step(h)?;
                }
                if let Some(h) = self.first_step {
                    control = control.first_step(h)?;
                }
                Pace::ByError(control)
            }
        })
    }
}

/// The times and the points of the output or of an event.
#[derive(Default)]
struct Rows {
    times: Vec<f64>,
    points: Vec<f64>,
}

impl Rows {
    fn push(&mut self, t: f64, y: &[f64]) {
        self.times.push(t);
        self.points.extend_from_slice(y);
    }

    fn into_arrays<'py>(
        self,
        py: Python<'py>,
        shape: &[usize],
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let shape: Vec<usize> =
            core::iter::once(self.times.len()).chain(shape.iter().copied()).collect();
        let points = PyArray1::from_vec(py, self.points).reshape(shape)?;
        Ok((PyArray1::from_vec(py, self.times).into_any(), points.into_any()))
    }
}

/// f: a callable with its further arguments, or the address of a C function with its parameters.
#[derive(FromPyObject)]
pub(crate) enum FieldParts {
    Address(usize, Vec<f64>),
    Callable(Py<PyAny>, Vec<Py<PyAny>>),
}

#[pyfunction]
#[pyo3(signature = (space, field, method, t_span, y0, settings, events, callback = None))]
pub(crate) fn solve<'py>(
    py: Python<'py>,
    space: &Space,
    field: FieldParts,
    method: &str,
    t_span: [f64; 2],
    y0: Vec<f64>,
    settings: Settings,
    events: Vec<EventParts>,
    callback: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (spec, shape) = (spec_of(py, method)?, space.0.point());
    let raised = Arc::new(Raised::default());
    let has_callables = callback.is_some() || !events.is_empty();
    let args = match &field {
        FieldParts::Address(..) => Vec::new(),
        FieldParts::Callable(_, args) => args.iter().map(|arg| arg.clone_ref(py)).collect(),
    };
    let (field, attached) = match field {
        FieldParts::Address(0, _) => {
            return Err(argument(py, "fun", "a null address", "the address of a C function"));
        }
        FieldParts::Address(address, parameters) => {
            (field::of_address(address, parameters, raised.clone()), has_callables)
        }
        FieldParts::Callable(f, args) => {
            let f = Callable::new(f, args, (shape, settings.linear), raised.clone());
            (field::of_callable(f, space.0.value()), true)
        }
    };
    let refuse = |error: lieflow::Error| refused(py, "fun", &error);
    let problem = space.0.problem(field, settings.linear).map_err(refuse)?;
    problem
        .fits(&spec)
        .map_err(|error| argument(py, "method", format!("{method:?}"), error.to_string()))?;
    let pace = settings.pace(t_span).map_err(refuse)?;

    let found: Vec<RefCell<Rows>> = events.iter().map(|_| RefCell::default()).collect();
    let make = |g: Py<PyAny>, args: &[Py<PyAny>]| {
        let args = args.iter().map(|arg| arg.clone_ref(py)).collect();
        Callable::new(g, args, (shape, false), raised.clone())
    };
    let mut planned = Vec::new();
    for ((g, name, direction, stop, change, points), found) in events.into_iter().zip(&found) {
        let (g, told) = (make(g, &args), name.clone());
        let value = move |t: f64, y: &[f64]| {
            g.call(t, y, |value| field::number(&told, t, value)).unwrap_or(f64::NAN)
        };
        let change = change.map(|change| {
            let (change, name) = (make(change, &args), format!("change of {name}"));
            Box::new(move |t: f64, y: &mut [f64]| field::change(&change, &name, t, y))
                as Box<dyn FnMut(f64, &mut [f64])>
        });
        planned.push(OwnEvent {
            name,
            value: Box::new(value),
            direction: match direction {
                d if d > 0.0 => Direction::Rising,
                d if d < 0.0 => Direction::Falling,
                _ => Direction::Both,
            },
            stop_after: (stop > 0).then_some(stop),
            change,
            points,
            tell: Box::new(|t, y| found.borrow_mut().push(t, y)),
        });
    }

    let mut rows = Rows::default();
    let callback = callback.map(|callback| make(callback, &[]));
    let mut ended_by_callback = false;
    let mut last = Instant::now();
    let signals = raised.clone();
    let mut check = move || {
        if last.elapsed() >= SIGNALS {
            last = Instant::now();
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                signals.keep(error);
            }
        }
    };
    let mut observe = |t: f64, y: &[f64]| {
        rows.push(t, y);
        if let Some(callback) = &callback {
            let ends = callback.call(t, y, |value| value.is_truthy());
            if ends == Some(true) {
                ended_by_callback = true;
                raised.stop.store(true, Ordering::Relaxed);
            }
        }
    };
    let save = match &settings.t_eval {
        Some(times) => SaveAt::Times(times.clone()),
        None => SaveAt::Every(1),
    };
    let ran = if attached {
        let plan = OwnPlan {
            t_span,
            pace,
            save,
            stops: settings.stops,
            max_steps: settings.max_steps,
            dense: settings.dense_output,
            events: planned,
            progress: Some(Box::new(move |_| check())),
        };
        problem.run(&spec, &y0, plan, &mut observe, &raised.stop)
    } else {
        let (stops, max_steps, dense) = (settings.stops, settings.max_steps, settings.dense_output);
        let rows = &mut rows;
        let (problem, spec, y0, stop) = (&problem, &spec, &y0, &raised.stop);
        py.detach(move || {
            let plan = OwnPlan {
                t_span,
                pace,
                save,
                stops,
                max_steps,
                dense,
                events: Vec::new(),
                progress: Some(Box::new(move |_| check())),
            };
            problem.run(spec, y0, plan, &mut |t, y| rows.push(t, y), stop)
        })
    };
    if let Some(error) = raised.take() {
        return Err(error);
    }
    let Ran { status, end, curve } = ran;
    let Some(end) = end else {
        let error = status.err().map_or_else(|| argument(py, "fun", "", ""), |e| of_run(py, &e));
        return Err(error);
    };
    let result = PyDict::new(py);
    let (code, message) = match &status {
        Ok(Status::Finished) => (0, "The end of the span was reached.".to_owned()),
        Ok(Status::Event(name)) => (1, format!("The event {name} ended the run.")),
        Ok(_) if ended_by_callback => (1, "The callback ended the run.".to_owned()),
        Ok(status) => (-1, format!("The run was ended: {status:?}.")),
        Err(error) => (-1, error.to_string()),
    };
    if let Err(RunError::Setup(error)) = &status {
        return Err(refused(py, "solve_ivp", error));
    }
    result.set_item("status", code)?;
    result.set_item("message", message)?;
    let (t, y) = rows.into_arrays(py, shape)?;
    result.set_item("t", t)?;
    result.set_item("y", y)?;
    let (mut t_events, mut y_events) = (Vec::new(), Vec::new());
    for found in &found {
        let (t, y) = found.take().into_arrays(py, shape)?;
        t_events.push(t);
        y_events.push(y);
    }
    result.set_item("t_events", t_events)?;
    result.set_item("y_events", y_events)?;
    result.set_item("t_end", end.t)?;
    result.set_item("y_end", field::array(py, shape, &end.y)?)?;
    result.set_item("nfev", end.stats.evaluations)?;
    result.set_item("nsteps", end.stats.accepted)?;
    result.set_item("nrejected", end.stats.rejected)?;
    result.set_item("residual", end.stats.residual)?;
    result.set_item("restored", end.stats.restored)?;
    let curve = curve.map(|curve| Curve { curve: curve.into(), shape: shape.to_vec() });
    result.set_item("curve", curve.map(|curve| Py::new(py, curve)).transpose()?)?;
    Ok(result)
}
