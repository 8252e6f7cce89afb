//! The points of a run at all times.

use std::sync::Arc;

use lieflow_model::problem::RowCurve;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Input, output};
use crate::error::argument;

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
        let times = t.numbers();
        let mut fill = || {
            let mut values = Vec::with_capacity(numbers.len());
            self.kept.rows(times, &mut values)?;
            numbers.copy_from_slice(&values);
            Ok(())
        };
        let done = if times.len() < 64 { fill() } else { py.detach(fill) };
        done.map_err(|(index, error)| {
            let [start, end] = self.kept.t_span();
            match start.min(end) <= times[index] && times[index] <= start.max(end) {
                true => pyo3::exceptions::PyRuntimeError::new_err(error.to_string()),
                false => {
                    let expected = format!("a time of the run, from {start} to {end}");
                    argument(py, "t", times[index].to_string(), expected)
                }
            }
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
