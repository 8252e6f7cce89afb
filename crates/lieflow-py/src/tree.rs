//! Values of Python as values of the keys of a problem.

use lieflow_model::formula::Lost;
use lieflow_model::reader::{KeyPath, Mistakes, Refusal, Tree};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use crate::error::argument;

/// The tree of numbers, texts, lists and dicts. `path` is that of the key, counted from 0 as in Python.
pub(crate) fn tree(path: &str, x: &Bound<'_, PyAny>) -> PyResult<Tree> {
    if x.is_instance_of::<PyBool>() {
        return Ok(Tree::Bool(x.extract()?));
    }
    if x.is_instance_of::<PyInt>() {
        let number = x.extract::<i64>().map(Tree::Whole);
        return number.or_else(|_| x.extract::<f64>().map(Tree::Number)).map_err(|_| {
            argument(x.py(), path, "a number beyond the range of float64", "at most 1.8e308")
        });
    }
    if x.is_instance_of::<PyFloat>() {
        return Ok(Tree::Number(x.extract()?));
    }
    if x.is_instance_of::<PyString>() {
        return Ok(Tree::Text(x.extract()?));
    }
    if let Ok(table) = x.cast::<PyDict>() {
        let entries = table.iter().map(|(key, value)| {
            let key: String = key.extract()?;
            let value =
                tree(&if path.is_empty() { key.clone() } else { path.entry(&key) }, &value)?;
            Ok((key, value))
        });
        return Ok(Tree::table(entries.collect::<PyResult<Vec<_>>>()?));
    }
    let entry = |(i, x): (usize, Bound<'_, PyAny>)| tree(&format!("{path}[{i}]"), &x);
    if let Ok(list) = x.cast::<PyList>() {
        return Ok(Tree::List(list.iter().enumerate().map(entry).collect::<PyResult<_>>()?));
    }
    if let Ok(list) = x.cast::<PyTuple>() {
        return Ok(Tree::List(list.iter().enumerate().map(entry).collect::<PyResult<_>>()?));
    }
    let what = x.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "{path}: a value of type {what}, expected numbers, texts, lists or dicts"
    )))
}

/// A tree as numbers, texts, lists and dicts.
pub(crate) fn untree<'py>(py: Python<'py>, x: &Tree) -> PyResult<Bound<'py, PyAny>> {
    Ok(match x {
        Tree::Bool(x) => PyBool::new(py, *x).to_owned().into_any(),
        Tree::Whole(n) => n.into_pyobject(py)?.into_any(),
        Tree::Number(x) => PyFloat::new(py, *x).into_any(),
        Tree::Text(text) => PyString::new(py, text).into_any(),
        Tree::List(list) => {
            let list = list.iter().map(|x| untree(py, x)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, list)?.into_any()
        }
        Tree::Table(entries) => {
            let table = PyDict::new(py);
            for (key, value) in entries {
                table.set_item(key, untree(py, value)?)?;
            }
            table.into_any()
        }
    })
}

/// A text with its places of entries, such as `a[1,2]`, counted from 0. A list of numbers, which stands behind no name, is
/// left as it is.
fn from_zero(text: &str) -> String {
    let mut parts = text.split('[');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| {
        let is_place = all.ends_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | ']'));
        let less = part.split_once(']').filter(|_| is_place).and_then(|(index, rest)| {
            let less = index.split(',').map(|i| i.trim().parse::<usize>().ok()?.checked_sub(1));
            let less: Option<Vec<usize>> = less.collect();
            Some((less?.iter().map(usize::to_string).collect::<Vec<_>>().join(", "), rest))
        });
        match less {
            Some((index, rest)) => format!("{all}[{index}]{rest}"),
            None => format!("{all}[{part}"),
        }
    })
}

/// A formula without a value, with its keys counted from 0.
pub(crate) fn in_python(lost: Lost) -> Lost {
    let through = lost.through.as_deref().map(from_zero);
    Lost { key: from_zero(&lost.key), through, ..lost }
}

/// A mistake as (argument, what is wrong, advice).
type Parts = (String, String, String);

fn parts(Refusal { key, message, help }: &Refusal) -> Parts {
    let key = key.as_deref().unwrap_or_default();
    // A message tells the value as `key = value`.
    let message = message
        .strip_prefix(key)
        .map_or(message.as_str(), |rest| rest.trim_start_matches([':', '=', ' ']));
    (from_zero(key), of_values(message), of_values(help.as_deref().unwrap_or_default()))
}

/// The words about the tables of a scene file as words about arguments.
fn of_values(text: &str) -> String {
    let text = from_zero(text).replace("a line `", "an entry `");
    text.replace("[problem.parameters]", "`parameters`").replace("[problem.let]", "`let`")
}

/// The `ArgumentError` of mistakes in the keys of a problem.
pub(crate) fn mistakes(py: Python<'_>, Mistakes(all): &Mistakes) -> PyErr {
    let all: Vec<Parts> = all.iter().map(parts).collect();
    let made = py.import("lieflow._errors").and_then(|m| m.getattr("mistakes")?.call1((all,)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// The same of one mistake.
pub(crate) fn mistake(py: Python<'_>, refusal: Refusal) -> PyErr {
    mistakes(py, &Mistakes(vec![refusal]))
}
