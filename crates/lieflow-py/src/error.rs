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
    let (of, value, expected) = words(name, error);
    argument(py, &of, value, expected)
}

/// The exception of a state that was set: its name is y, not that of a start.
pub(crate) fn of_state(py: Python<'_>, error: &Error) -> PyErr {
    let (of, value, expected) = words("y", error);
    let of = of.strip_prefix("y0").map_or(of.clone(), |place| format!("y{place}"));
    argument(py, &of, value, expected)
}

/// The argument that an error of the library is about, its value and what was expected. `name` is that of an argument
/// where the error has none.
pub(crate) fn words(name: &str, error: &Error) -> (String, String, String) {
    let at_most = |tolerance: &f64| format!("at most {tolerance:e}");
    // Times have the name of the argument that they come from.
    let with_times = |arg: &str| match arg.strip_prefix("times") {
        Some(rest) if name == "solve_ivp" => format!("t_eval{rest}"),
        Some(rest) => format!("{name}{rest}"),
        None => match arg.strip_prefix("y[") {
            Some(rest) => format!("y0[{rest}"),
            None => of(arg).to_owned(),
        },
    };
    match error {
        Error::OutOfRange { arg, value, expected } => {
            (with_times(arg), Plain(value).to_string(), expected.clone())
        }
        Error::Length { arg, found, expected } => {
            (with_times(arg), format!("length {found}"), expected.clone())
        }
        Error::NotSymmetric { arg, skew } => {
            let value = format!("{arg} − {arg}ᵀ with an entry {}", Plain(skew));
            (of(arg).into(), value, format!("0: a symmetric {arg}"))
        }
        Error::NotOnGroup { arg, group, residual, tolerance } => {
            let value = format!("a point at a relative distance of {residual:.1e} from {group}");
            (of(arg).into(), value, at_most(tolerance))
        }
        Error::Reflection { arg } => {
            (of(arg).into(), "determinant −1".into(), "a rotation, determinant +1".into())
        }
        Error::NotInAlgebra { arg, group, expected, residual, tolerance } => {
            let value = format!(
                "not in the Lie algebra of {group}, at a relative distance of {residual:.1e}"
            );
            (of(arg).into(), value, format!("{expected}, to {tolerance:e} of its size"))
        }
        Error::Determinant { arg, group, re, im } => {
            let value = format!("a matrix of determinant {}", plain_complex(*re, *im));
            (of(arg).into(), value, format!("1, as in {group}"))
        }
        Error::Trace { arg, group, distance } => {
            let value = format!("a matrix whose trace is {} away from 0", Plain(distance));
            (of(arg).into(), value, format!("an element of the Lie algebra of {group}"))
        }
        Error::Singular { arg: "g + 𝟙", rcond, .. } => {
            let value = format!("a matrix with an eigenvalue −1 (g + 𝟙 has rcond = {rcond:.1e})");
            ("g".into(), value, "a matrix cay(u), which has no eigenvalue −1".into())
        }
        Error::Singular { arg, rcond, minimum } => {
            let value = format!("columns that depend on each other (rcond = {rcond:.1e})");
            (of(arg).into(), value, format!("rcond of at least {minimum:e}"))
        }
        Error::NotFiniteEntry { arg, row, col, value } => (
            format!("{}[{row}, {col}]", of(arg)),
            Plain(value).to_string(),
            "a finite number".into(),
        ),
        Error::Unsupported { what: "dense output as data", with, why } => {
            ("dense_output".into(), format!("True with {with}"), format!("False: {why}"))
        }
        Error::Unsupported { what: "Lagrangian", with, .. } => {
            let expected = "the group Sp(2m): other matrices do not keep P symmetric";
            ("action".into(), format!("lagrangian with {with}"), expected.into())
        }
        Error::Unsupported { what, with, why } if name == "solve_ivp" => {
            ("method".into(), format!("{what} with {with}"), format!("what fits it: {why}"))
        }
        Error::NoLogarithm { re, im, why, .. } => {
            let value = format!("a matrix with the eigenvalue {}: {why}", plain_complex(*re, *im));
            ("g".into(), value, "a matrix with a real logarithm".into())
        }
        error => (name.into(), error.to_string(), String::new()),
    }
}

/// The name of an argument of the library in Python.
fn of(name: &str) -> &str {
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
