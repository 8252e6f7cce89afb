//! The points of a run at all times.

use std::sync::Arc;

use lieflow::RunError;
use lieflow_model::problem::RowCurve;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::arrays::{Input, output};
use crate::error::argument;
use crate::run::Signals;

/// The points of a run of a field at all times, or the rows of one of a model, as numbers.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Curve {
    kept: Arc<dyn RowCurve>,
    shape: Vec<usize>,
}

impl Curve {
    pub(crate) fn new(curve: Box<dyn RowCurve>, shape: &[usize]) -> Self {
        Curve { kept: curve.into(), shape: shape.to_vec() }
    }

    /// The exception of a time that has no point.
    fn refused(&self, t: f64, error: &RunError) -> PyErr {
        let [start, end] = self.kept.t_span();
        if start.min(end) <= t && t <= start.max(end) {
            return PyRuntimeError::new_err(error.to_string());
        }
        let expected = format!("a time of the run, from {start} to {end}");
        Python::attach(|py| argument(py, "t", t.to_string(), expected))
    }
}

/// From this number of times on the interpreter is released.
const MANY: usize = 64;
/// So many times are a part.
const PART: usize = 1024;

/// Fills the numbers of all times by parts, and hears signals between them.
pub(crate) fn at_times(
    py: Python<'_>,
    times: &[f64],
    numbers: &mut [f64],
    mut fill: impl FnMut(&[f64], &mut [f64]) -> PyResult<()> + Send,
) -> PyResult<()> {
    if times.len() < MANY {
        return fill(times, numbers);
    }
    let width = numbers.len() / times.len();
    let mut signals = Signals::default();
    py.detach(|| {
        let parts = numbers.chunks_mut((PART * width).max(1));
        for (times, numbers) in times.chunks(PART).zip(parts) {
            signals.ask()?;
            fill(times, numbers)?;
        }
        Ok(())
    })
}

#[pymethods]
impl Curve {
    /// The points at these times.
    fn at<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let py = t.py();
        let t = Input::any("t", t, 0)?;
        let lead = t.shape().to_vec();
        let out = output(py, (&lead, &self.shape), None, &mut [])?;
        // SAFETY: the array is new.
        let numbers = unsafe { out.as_slice_mut()? };
        at_times(py, t.numbers(), numbers, |times, numbers| {
            let mut values = Vec::with_capacity(numbers.len());
            let done = self.kept.rows(times, &mut values);
            done.map_err(|(index, error)| self.refused(times[index], &error))?;
            numbers.copy_from_slice(&values);
            Ok(())
        })?;
        Ok(out)
    }
    #[getter]
    fn t_span(&self) -> (f64, f64) {
        let [start, end] = self.kept.t_span();
        (start, end)
    }
    #[getter]
    fn steps(&self) -> usize {
        self.kept.steps()
    }
    /// All its numbers, to store it.
    fn numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.kept.numbers())
    }
}
