//! What all runs share: the steps, what watches, and what a run did.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lieflow::catalog::MethodSpec;
use lieflow::solve::{Next, Status};
use lieflow::{Direction, Error, RunError, SaveAt, Stats, StepControl, TimeGrid};
use lieflow_model::kinds::own::OwnField;
use lieflow_model::problem::{Orders, Steps, Stops, Watcher, stop_after_hardest};
use lieflow_model::scene::{beside_fixed_steps, default_tolerances};
use lieflow_model::schema::Row;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt};

use crate::error::{argument, of_run, refused};
use crate::field::{self, Callable, Raised};
use crate::formulas::Formulas;

/// How often a run asks for signals.
pub(crate) const SIGNALS: Duration = Duration::from_millis(20);

/// When signals were last asked for.
#[derive(Default)]
pub(crate) struct Signals(Option<Instant>);

impl Signals {
    /// Asks for signals, if that was not just done. An error is that of a signal, such as Ctrl-C.
    pub(crate) fn ask(&mut self) -> PyResult<()> {
        if self.0.is_none_or(|last| last.elapsed() >= SIGNALS) {
            self.0 = Some(Instant::now());
            Python::attach(|py| py.check_signals())?;
        }
        Ok(())
    }
}

/// The argument that limits the step size.
pub(crate) const LONGEST: &str = "max_step";

/// The method of this name.
pub(crate) fn spec_of(py: Python<'_>, method: &str) -> PyResult<MethodSpec> {
    let spec = method.parse::<MethodSpec>();
    spec.and_then(|spec| spec.choose().map(|_| spec.clone()))
        .map_err(|error| argument(py, "method", error.to_string(), ""))
}

/// The methods that were found to fit, with their orders: to find a method again costs more than a short run.
#[derive(Default)]
pub(crate) struct Fitting(Mutex<Vec<(String, MethodSpec, Orders)>>);

impl Fitting {
    /// The method of this name, if it fits.
    pub(crate) fn method(
        &self,
        py: Python<'_>,
        name: &str,
        orders: impl FnOnce(&MethodSpec) -> Result<Orders, String>,
    ) -> PyResult<(MethodSpec, Orders)> {
        let known = |all: &Vec<(String, MethodSpec, Orders)>| {
            all.iter().find(|(known, ..)| known == name).map(|(_, spec, o)| (spec.clone(), *o))
        };
        if let Some(found) = self.0.lock().ok().as_deref().and_then(known) {
            return Ok(found);
        }
        let spec = spec_of(py, name)?;
        let orders = orders(&spec).map_err(|error| argument(py, "method", error, ""))?;
        if let Ok(mut all) = self.0.lock() {
            all.push((name.to_owned(), spec.clone(), orders));
        }
        Ok((spec, orders))
    }
}

/// The settings of a run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings {
    rtol: Option<f64>,
    atol: Option<f64>,
    first_step: Option<f64>,
    min_step: Option<f64>,
    max_step: Option<f64>,
    pub(crate) max_steps: Option<u64>,
    dt: Option<f64>,
    steps: Option<u64>,
    split: bool,
    stops: Vec<f64>,
    kinks: Vec<f64>,
    pub(crate) dense_output: bool,
    pub(crate) linear: bool,
}

impl Settings {
    /// The times at which a step ends.
    pub(crate) fn stops(&self) -> Stops {
        Stops { jumps: self.stops.clone(), kinks: self.kinks.clone() }
    }

    /// The steps. What is left out is that of a scene, for a method of this order from this start; `function` is told of them.
    pub(crate) fn steps(
        &self,
        py: Python<'_>,
        t_span: [f64; 2],
        (orders, start): (Orders, impl FnOnce() -> Vec<f64>),
        function: &str,
    ) -> PyResult<Steps> {
        let fixed = [("dt", self.dt.is_some()), ("steps", self.steps.is_some())];
        if let Some((key, _)) = fixed.into_iter().find(|(_, given)| *given) {
            let limits = [
                ("first_step", self.first_step.is_some()),
                ("min_step", self.min_step.is_some()),
                (LONGEST, self.max_step.is_some()),
            ];
            let tolerances = self.rtol.is_some() || self.atol.is_some();
            if let Some((wrong, message)) = beside_fixed_steps(key, tolerances, &limits) {
                return Err(argument(py, wrong, message, ""));
            }
        }
        self.chosen(t_span, orders, start).map_err(|error| refused(py, function, &error))
    }

    fn chosen(
        &self,
        t_span: [f64; 2],
        orders: Orders,
        start: impl FnOnce() -> Vec<f64>,
    ) -> Result<Steps, Error> {
        let dt = self.dt.map(|dt| TimeGrid::new(t_span, dt));
        let grid = dt.or_else(|| self.steps.map(|steps| TimeGrid::with_steps(t_span, steps)));
        if let Some(grid) = grid.transpose()? {
            return Ok(Steps::Equal(if self.split { grid.split() } else { grid }));
        }
        let [rtol, atol] = match (self.rtol, self.atol) {
            (None, None) => default_tolerances(orders.step, &start()),
            (None, Some(0.0)) => {
                let expected = "a number > 0, or an rtol beside it".into();
                return Err(Error::OutOfRange { arg: "atol".into(), value: 0.0, expected });
            }
            // As in scenes.
            given => [given.0.unwrap_or(0.0), given.1.unwrap_or(0.0)],
        };
        let mut control = StepControl::new(rtol, atol)?;
        if let Some(h) = self.max_step {
            control = control.max_step(h)?;
        }
        if let Some(h) = self.min_step {
            control = control.min_step(h)?;
        }
        if let Some(h) = self.first_step {
            control = control.first_step(h)?;
        }
        Ok(Steps::ByError { t_span, control })
    }
}

/// The rows of the output.
pub(crate) fn save_of(times: Option<PyReadonlyArray1<'_, f64>>) -> PyResult<SaveAt> {
    Ok(match times {
        Some(times) => SaveAt::Times(times.as_slice()?.to_vec()),
        None => SaveAt::Every(1),
    })
}

/// The times and the numbers of the output or of an event.
#[derive(Default)]
pub(crate) struct Rows {
    times: Vec<f64>,
    points: Vec<f64>,
}

impl Rows {
    pub(crate) fn push(&mut self, t: f64, y: &[f64]) {
        self.times.push(t);
        self.points.extend_from_slice(y);
    }

    pub(crate) fn into_arrays<'py>(
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

/// The value of a Python `int`. Another object with `__index__`, such as a callable, is refused.
pub(crate) fn integer(x: &Bound<'_, PyAny>) -> PyResult<usize> {
    x.cast::<PyInt>()?.extract()
}

/// The function of an event.
#[derive(FromPyObject)]
pub(crate) enum EventFunction {
    /// Formulas in t and the numbers of y.
    Formulas(Py<Formulas>),
    /// The number of a formula of the columns of a model.
    Column(#[pyo3(from_py_with = integer)] usize),
    /// A callable.
    Callable(Py<PyAny>),
}

/// An event: the function, its name, direction, the zero that ends the run or 0, what changes y, points.
pub(crate) type EventParts = (EventFunction, String, f64, u64, Option<Py<PyAny>>, Option<u32>);

/// The function of an event that can be called without the interpreter.
pub(crate) enum Function {
    Formulas(Arc<OwnField>),
    Column(usize),
    Callable(Callable),
}

/// An event of a run.
pub(crate) struct Watched {
    pub(crate) name: String,
    pub(crate) function: Function,
    pub(crate) direction: Direction,
    pub(crate) stop_after: Option<u64>,
    pub(crate) change: Option<Callable>,
    pub(crate) points: Option<u32>,
}

impl Watched {
    /// The value at (t, y), by rows; NaN if the function raised.
    pub(crate) fn value(&self, t: f64, y: &[f64]) -> f64 {
        match &self.function {
            Function::Formulas(formulas) => {
                let mut value = [f64::NAN];
                formulas(t, y, &mut value);
                value[0]
            }
            Function::Callable(g) => {
                let read = |value: &Bound<'_, PyAny>| field::number(&self.name, t, value);
                g.call(t, y, read).unwrap_or(f64::NAN)
            }
            Function::Column(_) => f64::NAN,
        }
    }

    /// y ← what the event changes it to.
    pub(crate) fn change(&self, t: f64, y: &mut [f64]) {
        if let Some(change) = &self.change {
            field::change(change, &format!("change of {}", self.name), t, y);
        }
    }
}

/// What watches a run: its events and its callback, with what they saw.
pub(crate) struct Watch {
    pub(crate) events: Vec<Watched>,
    callback: Option<Callable>,
    pub(crate) raised: Arc<Raised>,
    pub(crate) seen: Seen,
}

/// The end of a run, also of one that failed.
struct End {
    t: f64,
    state: Vec<f64>,
    row: Vec<f64>,
    stats: Stats,
}

/// What was seen of a run.
#[derive(Default)]
pub(crate) struct Seen {
    rows: Rows,
    pub(crate) found: Vec<Rows>,
    end: Option<End>,
    signals: Signals,
}

impl Watch {
    /// The events and the callback of a run whose callables get y of this shape, and whose changes get the state.
    pub(crate) fn new(
        py: Python<'_>,
        (events, callback): (Vec<EventParts>, Option<Py<PyAny>>),
        args: &[Py<PyAny>],
        (shape, state): (&[usize], &[usize]),
        raised: Arc<Raised>,
    ) -> Self {
        let make = |g: Py<PyAny>, args: &[Py<PyAny>], shape: &[usize]| {
            let args = args.iter().map(|arg| arg.clone_ref(py)).collect();
            Callable::new(g, args, (shape, false), raised.clone())
        };
        let watched = |(g, name, direction, stop, change, points): EventParts| Watched {
            name,
            function: match g {
                EventFunction::Formulas(formulas) => Function::Formulas(formulas.get().0.field()),
                EventFunction::Column(place) => Function::Column(place),
                EventFunction::Callable(g) => Function::Callable(make(g, args, shape)),
            },
            direction: match direction {
                d if d > 0.0 => Direction::Rising,
                d if d < 0.0 => Direction::Falling,
                _ => Direction::Both,
            },
            stop_after: (stop > 0).then_some(stop),
            change: change.map(|change| make(change, args, state)),
            points,
        };
        let events: Vec<Watched> = events.into_iter().map(watched).collect();
        let found = events.iter().map(|_| Rows::default()).collect();
        let seen = Seen { found, ..Seen::default() };
        Watch {
            events,
            callback: callback.map(|callback| make(callback, &[], shape)),
            raised,
            seen,
        }
    }

    /// Does it call Python?
    pub(crate) fn has_callables(&self) -> bool {
        let calls = |event: &Watched| {
            event.change.is_some() || matches!(event.function, Function::Callable(_))
        };
        self.callback.is_some() || self.events.iter().any(calls)
    }
}

impl Seen {
    /// Sees a row of the output. The run stops at the row where the callback says so.
    pub(crate) fn row(&mut self, callback: Option<&Callable>, t: f64, y: &[f64]) -> Next {
        self.rows.push(t, y);
        let is_last = |f: &Callable| f.call(t, y, |value| value.is_truthy()) == Some(true);
        if callback.is_some_and(is_last) { Next::Stop } else { Next::Continue }
    }

    /// Asks for signals now and then.
    pub(crate) fn signals(&mut self, raised: &Raised) {
        if let Err(error) = self.signals.ask() {
            raised.keep(error);
        }
    }

    /// The dict of a result. `shape` is that of the points, `limit` the name of the setting that limits the step size.
    pub(crate) fn into_dict<'py>(
        self,
        py: Python<'py>,
        raised: &Raised,
        status: Result<Status, RunError>,
        (shape, limit): (&[usize], &str),
        steps: Option<&Steps>,
    ) -> PyResult<Bound<'py, PyDict>> {
        if let Some(error) = raised.take() {
            return Err(error);
        }
        let Some(End { t: t_end, state, row: y_end, stats }) = self.end else {
            let error =
                status.err().map_or_else(|| argument(py, "fun", "", ""), |e| of_run(py, &e));
            return Err(error);
        };
        if let Err(RunError::Setup(error)) = &status {
            return Err(refused(py, "solve_ivp", error));
        }
        let (code, message) = match &status {
            Ok(Status::Finished) => (0, "The end of the span was reached.".to_owned()),
            Ok(Status::Event(name)) => (1, format!("The event {name} ended the run.")),
            Ok(Status::Observer) => (1, "The callback ended the run.".to_owned()),
            Ok(status) => (-1, format!("The run was ended: {status:?}.")),
            Err(error) => (-1, error.to_string()),
        };
        let result = PyDict::new(py);
        let (t, y) = self.rows.into_arrays(py, shape)?;
        let (mut t_events, mut y_events) = (Vec::new(), Vec::new());
        for found in self.found {
            let (t, y) = found.into_arrays(py, shape)?;
            t_events.push(t);
            y_events.push(y);
        }
        result.set_item("t", t)?;
        result.set_item("y", y)?;
        result.set_item("t_events", t_events)?;
        result.set_item("y_events", y_events)?;
        result.set_item("status", code)?;
        result.set_item("message", message)?;
        result.set_item("_by_callback", matches!(status, Ok(Status::Observer)))?;
        result.set_item("t_end", t_end)?;
        result.set_item("y_end", field::array(py, shape, &y_end)?)?;
        result.set_item("state", PyArray1::from_vec(py, state))?;
        // An implicit method does not count them.
        result.set_item("nfev", stats.evaluations.or_else(|| raised.calls()))?;
        result.set_item("nsteps", stats.accepted)?;
        result.set_item("nrejected", stats.rejected)?;
        result.set_item("largest_step", stats.largest_step)?;
        let tolerances = match steps {
            Some(Steps::ByError { control, .. }) => {
                let mut parts = control.tolerance().scales();
                let part = parts.part();
                Some((part.rtol(), part.atol()))
            }
            _ => None,
        };
        result.set_item("_tolerances", tolerances)?;
        let hardest = steps.and_then(|steps| stop_after_hardest(&stats, steps.t_span()));
        result.set_item("_hardest", hardest)?;
        result.set_item("residual", stats.residual)?;
        result.set_item("restored", stats.restored)?;
        result.set_item("unsure_steps", stats.unsure_steps)?;
        let ended_by = status.as_ref().ok().and_then(Status::event);
        result.set_item("_unsure", stats.unsure_in_words(limit, ended_by))?;
        Ok(result)
    }
}

/// Gives what a run shows to what was seen of it.
pub(crate) struct Watching<'a> {
    pub(crate) callback: Option<&'a Callable>,
    pub(crate) raised: &'a Raised,
    pub(crate) seen: &'a mut Seen,
}

impl Watcher for Watching<'_> {
    fn row(&mut self, t: f64, row: Row<'_>) -> Next {
        self.seen.row(self.callback, t, row.values())
    }
    fn event(&mut self, event: usize, t: f64, _: bool, row: Row<'_>) {
        self.seen.found[event].push(t, row.values());
    }
    fn progress(&mut self, _: f64) {
        self.seen.signals(self.raised);
    }
    fn end(&mut self, t: f64, state: &[f64], row: Row<'_>, stats: &Stats) {
        let (state, row) = (state.to_vec(), row.values().to_vec());
        self.seen.end = Some(End { t, state, row, stats: *stats });
    }
}

impl Watch {
    /// Its parts: the events, and what sees the rows.
    pub(crate) fn parts(&mut self) -> (&[Watched], Option<&Callable>, &Arc<Raised>, &mut Seen) {
        (&self.events, self.callback.as_ref(), &self.raised, &mut self.seen)
    }
}
