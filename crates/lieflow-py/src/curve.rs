//! The points of a run at all times.

use std::sync::Arc;

use lieflow::RunError;
use lieflow_model::kinds::own;
use lieflow_model::problem::RowCurve;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Input, output};
use crate::error::argument;

/// The points of a run of a field, or the rows of one of a model.
enum Kept {
    Points(Box<dyn own::Curve>),
    Rows(Box<dyn RowCurve>),
}

/// The points of a run at all times, as numbers.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Curve {
    kept: Arc<Kept>,
    shape: Vec<usize>,
}

impl Kept {
    fn t_span(&self) -> [f64; 2] {
        match self {
            Kept::Points(curve) => curve.t_span(),
            Kept::Rows(curve) => curve.t_span(),
        }
    }

    fn at(&self, times: &[f64], out: &mut [f64]) -> Result<(), (usize, RunError)> {
        match self {
            Kept::Points(curve) => curve.at(times, out),
            Kept::Rows(curve) => {
                let mut values = Vec::with_capacity(out.len());
                curve.rows(times, &mut values)?;
                out.copy_from_slice(&values);
                Ok(())
            }
        }
    }
}

impl Curve {
    pub(crate) fn new(curve: Box<dyn own::Curve>, shape: &[usize]) -> Self {
        Curve { kept: Arc::new(Kept::Points(curve)), shape: shape.to_vec() }
    }

    pub(crate) fn of_rows(curve: Box<dyn RowCurve>, width: usize) -> Self {
        Curve { kept: Arc::new(Kept::Rows(curve)), shape: vec![width] }
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
        let done = match times.len() < 64 {
            true => self.kept.at(times, numbers),
            false => py.detach(|| self.kept.at(times, numbers)),
        };
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
        match &*self.kept {
            Kept::Points(curve) => curve.steps(),
            Kept::Rows(curve) => curve.steps(),
        }
    }
    /// All its numbers, to store it.
    fn numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(
            py,
            match &*self.kept {
                Kept::Points(curve) => curve.numbers(),
                Kept::Rows(curve) => curve.numbers(),
            },
        )
    }
}
