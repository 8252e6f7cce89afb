//! Runs that are taken step by step.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, ThreadId};
use std::time::Duration;

use lieflow::RunError;
use lieflow_model::problem;
use numpy::{PyArray1, PyArrayDyn, PyReadonlyArray1};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{of_run, of_state, refused};
use crate::field::{self, Raised};

/// A run that is taken step by step.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Stepper {
    run: Mutex<Box<dyn problem::Stepper>>,
    /// The thread that is taking steps.
    taken_by: Mutex<Option<ThreadId>>,
    shape: Vec<usize>,
    raised: Arc<Raised>,
    attached: bool,
}

/// The value behind a lock. A thread waits for it without the interpreter, which the thread that has it may need.
pub(crate) fn wait_for<'m, T: Send>(py: Python<'_>, mutex: &'m Mutex<T>) -> MutexGuard<'m, T> {
    loop {
        match mutex.try_lock() {
            Ok(value) => return value,
            Err(TryLockError::Poisoned(value)) => return value.into_inner(),
            Err(TryLockError::WouldBlock) => py.detach(|| drop(lock(mutex))),
        }
    }
}

/// The value behind a lock, also after a panic.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Stepper {
    pub(crate) fn new(
        py: Python<'_>,
        run: Result<Box<dyn problem::Stepper>, RunError>,
        shape: &[usize],
        (raised, attached): (Arc<Raised>, bool),
    ) -> PyResult<Self> {
        let run = Mutex::new(run.map_err(|error| of_run(py, &error))?);
        Ok(Stepper { run, taken_by: Mutex::default(), shape: shape.to_vec(), raised, attached })
    }

    /// The run. RuntimeError in f itself, which would wait for its own step.
    fn run(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, Box<dyn problem::Stepper>>> {
        if self.run.try_lock().is_err() && *lock(&self.taken_by) == Some(thread::current().id()) {
            return Err(PyRuntimeError::new_err("f cannot use the integrator that calls it"));
        }
        Ok(wait_for(py, &self.run))
    }

    /// Does something with the run. An exception of f leaves, and the run is at its last accepted step.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut dyn problem::Stepper) -> Result<T, RunError> + Send,
    ) -> PyResult<T> {
        let done = if self.attached {
            let mut run = self.run(py)?;
            *lock(&self.taken_by) = Some(thread::current().id());
            let done = act(&mut **run);
            *lock(&self.taken_by) = None;
            done
        } else {
            py.detach(|| act(&mut **lock(&self.run)))
        };
        if let Some(error) = self.raised.take() {
            self.raised.stop.store(false, core::sync::atomic::Ordering::Relaxed);
            return Err(error);
        }
        done.map_err(|error| match &error {
            RunError::Setup(error) => refused(py, "t", error),
            error => PyRuntimeError::new_err(error.to_string()),
        })
    }

    fn array<'py>(
        &self,
        py: Python<'py>,
        numbers: &[f64],
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        field::array(py, &self.shape, numbers)
    }
}

#[pymethods]
impl Stepper {
    #[getter]
    fn t(&self, py: Python<'_>) -> PyResult<f64> {
        self.run(py).map(|run| run.t())
    }
    #[getter]
    fn t_end(&self, py: Python<'_>) -> PyResult<f64> {
        self.run(py).map(|run| run.t_end())
    }
    /// The numbers of the row.
    fn row<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let mut values = Vec::new();
        self.run(py)?.row(&mut values);
        self.array(py, &values)
    }
    /// The numbers of the state.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.run(py)?.state()))
    }
    fn set_state(&self, py: Python<'_>, numbers: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        let numbers = numbers.as_slice()?;
        self.with(py, |run| match run.set_state(numbers) {
            Err(RunError::Setup(error) | RunError::Changed { source: error, .. }) => Ok(Err(error)),
            done => done.map(Ok),
        })?
        .map_err(|error| of_state(py, &error))
    }
    fn step(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |run| run.step())
    }
    fn advance_to(&self, py: Python<'_>, t: f64) -> PyResult<()> {
        while !self.with(py, |run| run.advance_for(t, Duration::from_millis(20)))? {
            py.check_signals()?;
        }
        Ok(())
    }
    fn interpolate<'py>(&self, py: Python<'py>, t: f64) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let values = self.with(py, |run| {
            let mut values = Vec::new();
            run.interpolate(t, &mut values)?;
            Ok(values)
        })?;
        self.array(py, &values)
    }
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.run(py)?.save()))
    }
    fn restore(&self, py: Python<'_>, bytes: &[u8]) -> PyResult<()> {
        let done = self.run(py)?.restore(bytes);
        done.map_err(|error| refused(py, "bytes", &error))
    }
    /// (nfev, nsteps, nrejected, iterations of implicit steps).
    fn stats(&self, py: Python<'_>) -> PyResult<(Option<u64>, u64, u64, u64)> {
        let stats = self.run(py)?.stats();
        Ok((stats.evaluations, stats.accepted, stats.rejected, stats.iterations))
    }
}
