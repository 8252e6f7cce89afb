//! f and events as formulas.

use lieflow::RunError;
use lieflow::solve::Stops;
use lieflow_model::formula::Lost;
use lieflow_model::kinds::own;
use lieflow_model::reader::Tree;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::solve::knots;
use crate::tree::{in_python, mistakes, tree};

/// Formulas in t and the numbers of y.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Formulas(pub(crate) own::Formulas, Py<PyAny>);

#[pymethods]
impl Formulas {
    #[new]
    /// `place` turns the key of a formula into the place that the user knows.
    fn new(
        variables: Vec<String>,
        counts: Vec<usize>,
        keys: &Bound<'_, PyDict>,
        place: Py<PyAny>,
    ) -> PyResult<Self> {
        let py = keys.py();
        let keys: Tree = tree("", keys)?;
        let read = own::Formulas::read(&variables, &counts, &keys);
        read.map(|read| Formulas(read, place)).map_err(|error| mistakes(py, &error))
    }
    /// True if a formula has a number of y in it.
    #[getter]
    fn depends_on_y(&self) -> bool {
        self.0.depends_on_y()
    }
    /// The times at which the samples jump, and those at which only their derivatives do.
    fn knots(&self, py: Python<'_>, t_span: [f64; 2]) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let stops = self.0.samples().map(|samples| knots(py, samples, t_span)).transpose()?;
        let Stops { jumps, kinks } = stops.unwrap_or_default();
        Ok((jumps, kinks))
    }
}

impl Formulas {
    /// The formula by which a run ended with this error, in words.
    pub(crate) fn lost_by(&self, py: Python<'_>, error: &RunError) -> Option<PyResult<String>> {
        let lost = in_python(self.0.lost_by(error)?);
        let place = self.1.bind(py).call1((&lost.key,)).and_then(|key| key.extract());
        Some(place.map(|key| Lost { key, ..lost }.to_string()))
    }
}
