//! Runs that are taken step by step.

use std::sync::Arc;

use lieflow::RunError;
use lieflow_model::problem;
use numpy::{PyArray1, PyArrayDyn, PyReadonlyArray1};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::pyclass::{PyTraverseError, PyVisit};
use pyo3::types::PyBytes;

use crate::error::{of_run, of_state, refused};
use crate::field::{self, Callable, Raised};
use crate::in_turn::InTurn;
use crate::run::SIGNALS;

/// A run that is taken step by step.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Stepper {
    run: InTurn<Box<dyn problem::Stepper>>,
    shape: Vec<usize>,
    raised: Arc<Raised>,
    /// f, if it calls Python.
    callable: Option<Arc<Callable>>,
}

impl Stepper {
    pub(crate) fn new(
        py: Python<'_>,
        run: Result<Box<dyn problem::Stepper>, RunError>,
        shape: &[usize],
        (raised, callable): (Arc<Raised>, Option<Arc<Callable>>),
    ) -> PyResult<Self> {
        let run = InTurn::new(
            run.map_err(|error| of_run(py, &error))?,
            "f cannot use the integrator that calls it",
        );
        Ok(Stepper { run, shape: shape.to_vec(), raised, callable })
    }

    /// Reads the run.
    fn read<T>(
        &self,
        py: Python<'_>,
        read: impl FnOnce(&mut dyn problem::Stepper) -> T,
    ) -> PyResult<T> {
        self.run.with(py, |run| read(&mut **run))
    }

    /// Does something with the run. An exception of f leaves, and the run is at its last accepted step.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut dyn problem::Stepper) -> Result<T, RunError> + Send,
    ) -> PyResult<T> {
        let done = self.read(py, |run| {
            let done = if self.callable.is_some() { act(run) } else { py.detach(|| act(run)) };
            match self.raised.take() {
                None => Ok(done),
                Some(error) => {
                    self.raised.stop.store(false, core::sync::atomic::Ordering::Relaxed);
                    Err(error)
                }
            }
        })?;
        done?.map_err(|error| match &error {
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
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.callable.iter().try_for_each(|f| f.traverse(&visit))
    }
    fn __clear__(&self) {
        self.callable.iter().for_each(|f| f.clear());
    }
    #[getter]
    fn t(&self, py: Python<'_>) -> PyResult<f64> {
        self.read(py, |run| run.t())
    }
    #[getter]
    fn t_end(&self, py: Python<'_>) -> PyResult<f64> {
        self.read(py, |run| run.t_end())
    }
    /// The numbers of the row.
    fn row<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let mut values = Vec::new();
        self.read(py, |run| run.row(&mut values))?;
        self.array(py, &values)
    }
    /// The numbers of the state.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.read(py, |run| run.state())?))
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
        while !self.with(py, |run| run.advance_for(t, SIGNALS))? {
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
        Ok(PyBytes::new(py, &self.read(py, |run| run.save())?))
    }
    fn restore(&self, py: Python<'_>, bytes: &[u8]) -> PyResult<()> {
        let done = self.read(py, |run| run.restore(bytes))?;
        done.map_err(|error| refused(py, "bytes", &error))
    }
    /// (nfev, nsteps, nrejected, iterations of implicit steps).
    fn stats(&self, py: Python<'_>) -> PyResult<(Option<u64>, u64, u64, u64)> {
        let stats = self.read(py, |run| run.stats())?;
        Ok((stats.evaluations, stats.accepted, stats.rejected, stats.iterations))
    }
}
