//! f and events as formulas.

use lieflow_model::kinds::own;
use lieflow_model::reader::Tree;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::solve::knots;
use crate::tree::{mistakes, tree};

/// Formulas in t and the numbers of y.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Formulas(pub(crate) own::Formulas);

#[pymethods]
impl Formulas {
    #[new]
    fn new(variables: Vec<String>, counts: Vec<usize>, keys: &Bound<'_, PyDict>) -> PyResult<Self> {
        let py = keys.py();
        let keys: Tree = tree("", keys)?;
        let read = own::Formulas::read(&variables, &counts, &keys);
        read.map(Formulas).map_err(|error| mistakes(py, &error))
    }
    /// True if a formula has a number of y in it.
    #[getter]
    fn depends_on_y(&self) -> bool {
        self.0.depends_on_y()
    }
    /// The times at which the samples are not smooth.
    fn knots(&self, py: Python<'_>, t_span: [f64; 2]) -> PyResult<Vec<f64>> {
        self.0.samples().map_or(Ok(Vec::new()), |samples| knots(py, samples, t_span))
    }
    /// The formula that had no value first.
    fn lost(&self) -> Option<String> {
        self.0.lost()
    }
}
