//! Errors of the library as exceptions.

use lieflow::error::{Plain, plain_complex};
use lieflow::{Error, RunError};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// The class `lieflow.ArgumentError`.
static CLASS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// An `ArgumentError` with the name of the argument, its value and what was expected.
pub(crate) fn argument(
    py: Python<'_>,
    argument: &str,
    value: impl Into<String>,
    expected: impl Into<String>,
) -> PyErr {
    let class = CLASS.get_or_try_init(py, || {
        py.import("lieflow._errors")?.getattr("ArgumentError").map(Bound::unbind)
    });
    let made =
        class.and_then(|class| class.bind(py).call1((argument, value.into(), expected.into())));
    match made {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// The exception of an error of the library about an argument.
pub(crate) fn refused(py: Python<'_>, name: &str, error: &Error) -> PyErr {
    match error {
        Error::OutOfRange { arg, value, expected } => {
            // Times have the name of the argument that they come from.
            let arg = match arg.strip_prefix("times") {
                Some(rest) if name == "solve_ivp" => format!("t_eval{rest}"),
                Some(rest) => format!("{name}{rest}"),
                None => arg.clone(),
            };
            argument(py, &arg, Plain(value).to_string(), expected.clone())
        }
        Error::NotOnGroup { arg, group, residual, tolerance } => {
            let value = format!("a point at a relative distance of {residual:.1e} from {group}");
            argument(py, of(arg), value, format!("at most {tolerance:e}"))
        }
        Error::Reflection { arg } => {
            argument(py, of(arg), "determinant −1", "a rotation, determinant +1")
        }
        Error::NotInAlgebra { arg, group, residual, tolerance } => {
            let value = format!(
                "not in the Lie algebra of {group}, at a relative distance of {residual:.1e}"
            );
            argument(py, of(arg), value, format!("at most {tolerance:e}"))
        }
        Error::Determinant { arg, group, re, im } => {
            let value = format!("a matrix of determinant {}", plain_complex(*re, *im));
            argument(py, of(arg), value, format!("1, as in {group}"))
        }
        Error::Trace { arg, group, distance } => {
            let value = format!("a matrix whose trace is {} away from 0", Plain(distance));
            argument(py, of(arg), value, format!("an element of the Lie algebra of {group}"))
        }
        error => argument(py, name, error.to_string(), ""),
    }
}

/// The name of an argument of the library in Python.
fn of(name: &'static str) -> &'static str {
    match name {
        "y" => "y0",
        "f" => "fun",
        name => name,
    }
}

/// The exception of a run that could not begin.
pub(crate) fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    match error {
        RunError::Setup(error) => refused(py, "solve_ivp", error),
        error => PyRuntimeError::new_err(error.to_string()),
    }
}
