//! The compiled part of the Python package `lieflow`: maps on arrays, and runs.
//!
//! The package in `python/lieflow` has the documented interface. It imports this module as `lieflow._lieflow`. `unsafe` is
//! used only to write into new arrays, to read arrays whose layout was checked, and for addresses of C functions.

mod arrays;
mod curve;
mod error;
mod expm;
mod field;
mod group;
mod se3;
mod so3;
mod solve;

use pyo3::prelude::*;

#[pymodule(gil_used = true)]
fn _lieflow(m: &Bound<'_, PyModule>) -> PyResult<()> {
    so3::add(m)?;
    se3::add(m)?;
    expm::add(m)?;
    m.add_class::<group::MatrixGroup>()?;
    m.add_class::<curve::Curve>()?;
    m.add_class::<solve::Space>()?;
    m.add_function(wrap_pyfunction!(solve::solve, m)?)?;
    m.add_function(wrap_pyfunction!(solve::check_method, m)?)?;
    m.add("__version__", env!("CARGO_PKG_VERSION"))
}
