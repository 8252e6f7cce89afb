//! The compiled part of the Python package `lieflow`: maps on arrays, and runs.
//!
//! The package in `python/lieflow` has the documented interface. It imports this module as `lieflow._lieflow`. `unsafe` is
//! used only to read and write arrays whose layout was checked (arguments, `out=`, new arrays), and for addresses of C
//! functions.

mod arrays;
mod bodies;
mod curve;
mod error;
mod expm;
mod field;
mod formulas;
mod group;
mod in_turn;
mod model;
mod run;
mod scene;
mod se3;
mod so3;
mod solve;
mod stepper;
mod tree;

use pyo3::prelude::*;

#[pymodule(gil_used = true)]
fn _lieflow(m: &Bound<'_, PyModule>) -> PyResult<()> {
    so3::add(m)?;
    se3::add(m)?;
    expm::add(m)?;
    m.add_class::<group::MatrixGroup>()?;
    m.add_class::<bodies::FreeBodies>()?;
    m.add_class::<curve::Curve>()?;
    m.add_class::<formulas::Formulas>()?;
    m.add_class::<model::Model>()?;
    m.add_class::<model::Problem>()?;
    m.add_class::<solve::SampledField>()?;
    m.add_class::<solve::Space>()?;
    m.add_class::<stepper::Stepper>()?;
    m.add_function(wrap_pyfunction!(model::kinds, m)?)?;
    m.add_class::<scene::Scene>()?;
    m.add_function(wrap_pyfunction!(scene::bundled, m)?)?;
    m.add_function(wrap_pyfunction!(solve::solve, m)?)?;
    m.add_function(wrap_pyfunction!(solve::check_method, m)?)?;
    m.add_function(wrap_pyfunction!(solve::time_to_search, m)?)?;
    m.add_function(wrap_pyfunction!(solve::other_tolerance, m)?)?;
    m.add_function(wrap_pyfunction!(solve::finer, m)?)?;
    m.add_function(wrap_pyfunction!(solve::search_step, m)?)?;
    m.add_function(wrap_pyfunction!(solve::is_elsewhere, m)?)?;
    m.add_function(wrap_pyfunction!(solve::near_ends, m)?)?;
    m.add_function(wrap_pyfunction!(solve::stays, m)?)?;
    m.add("LAST_DIGITS", lieflow_model::problem::LAST_DIGITS)?;
    m.add("SHORT_STEPS", lieflow_model::problem::SHORT_STEPS)?;
    m.add("GRADED_MOST", lieflow_model::problem::GRADED_MOST)?;
    m.add("__version__", env!("CARGO_PKG_VERSION"))
}
