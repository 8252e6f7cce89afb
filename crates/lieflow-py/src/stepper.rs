//! Runs that are taken step by step.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lieflow::RunError;
use lieflow_model::problem;
use numpy::{PyArray1, PyArrayDyn, PyReadonlyArray1};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::{argument, of_run, refused};
use crate::field::{self, Raised};

/// A run that is taken step by step.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Stepper {
    run: Mutex<Box<dyn problem::Stepper>>,
    shape: Vec<usize>,
    raised: Arc<Raised>,
    attached: bool,
}

impl Stepper {
    pub(crate) fn new(
        py: Python<'_>,
        run: Result<Box<dyn problem::Stepper>, RunError>,
        shape: &[usize],
        (raised, attached): (Arc<Raised>, bool),
    ) -> PyResult<Self> {
        let run = Mutex::new(run.map_err(|error| of_run(py, &error))?);
        Ok(Stepper { run, shape: shape.to_vec(), raised, attached })
    }

    /// The run. Another thread that has it may need the interpreter for f.
    fn run(&self, py: Python<'_>) -> MutexGuard<'_, Box<dyn problem::Stepper>> {
        if let Ok(run) = self.run.try_lock() {
            return run;
        }
        py.detach(|| drop(self.run.lock()));
        self.run.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does something with the run. An exception of f leaves, and the run is where it was.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut dyn problem::Stepper) -> Result<T, RunError> + Send,
    ) -> PyResult<T> {
        let done = if self.attached {
            act(&mut **self.run(py))
        } else {
            py.detach(|| act(&mut **self.run.lock().unwrap_or_else(PoisonError::into_inner)))
        };
        if let Some(error) = self.raised.take() {
            self.raised.stop.store(false, core::sync::atomic::Ordering::Relaxed);
            return Err(error);
        }
        done.map_err(|error| match &error {
            RunError::Setup(error) => refused(py, "t", error),
            RunError::Changed { .. } => argument(py, "y", error.to_string(), "a point on M"),
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
    fn t(&self, py: Python<'_>) -> f64 {
        self.run(py).t()
    }
    #[getter]
    fn t_end(&self, py: Python<'_>) -> f64 {
        self.run(py).t_end()
    }
    /// The numbers of the row.
    fn row<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let mut values = Vec::new();
        self.run(py).row(&mut values);
        self.array(py, &values)
    }
    /// The numbers of the state.
    fn state<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.run(py).state())
    }
    fn set_state(&self, py: Python<'_>, numbers: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        let numbers = numbers.as_slice()?;
        self.with(py, |run| run.set_state(numbers))
    }
    fn step(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |run| run.step())
    }
    fn advance_to(&self, py: Python<'_>, t: f64) -> PyResult<()> {
        self.with(py, |run| run.advance_to(t))
    }
    fn interpolate<'py>(&self, py: Python<'py>, t: f64) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let values = self.with(py, |run| {
            let mut values = Vec::new();
            run.interpolate(t, &mut values)?;
            Ok(values)
        })?;
        self.array(py, &values)
    }
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.run(py).save())
    }
    fn restore(&self, py: Python<'_>, bytes: &[u8]) -> PyResult<()> {
        let done = self.run(py).restore(bytes);
        done.map_err(|error| refused(py, "bytes", &error))
    }
    /// (nfev, nsteps, nrejected, iterations of implicit steps).
    fn stats(&self, py: Python<'_>) -> (Option<u64>, u64, u64, u64) {
        let stats = self.run(py).stats();
        (stats.evaluations, stats.accepted, stats.rejected, stats.iterations)
    }
}
