//! Arrays in and out: real numbers in C order, with the last axes of one element.

use core::ops::Range;
use std::time::Instant;

use lieflow::Error;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::error::{argument, words};
use crate::run::SIGNALS;

/// From this number of elements on a map releases the interpreter.
const MANY: usize = 512;
/// A result of more numbers may not fit into memory.
const LARGE: usize = 1 << 24;

/// An argument: its numbers in C order, and the shape of its leading axes.
pub(crate) struct Input<'py> {
    array: Bound<'py, PyArrayDyn<f64>>,
    /// A copy, if the result overwrites the array.
    copy: Option<Vec<f64>>,
    tail: usize,
}

/// The array as it is, if its numbers can be read as a slice and all of them count: those of a class other than NumPy's own
/// may be masked.
pub(crate) fn unmasked<'py>(x: &Bound<'py, PyAny>) -> Option<Bound<'py, PyArrayDyn<f64>>> {
    x.cast_exact::<PyUntypedArray>().ok()?;
    plain(x)
}

/// The array as it is, if its numbers can be read as a slice.
fn plain<'py>(x: &Bound<'py, PyAny>) -> Option<Bound<'py, PyArrayDyn<f64>>> {
    let array = x.cast::<PyArrayDyn<f64>>().ok()?;
    let aligned = (array.data() as usize).is_multiple_of(align_of::<f64>());
    (array.is_c_contiguous() && aligned).then(|| array.clone())
}

/// A shape as Python writes it.
pub(crate) fn shape_text(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        shape => {
            let sizes: Vec<_> = shape.iter().map(usize::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// The shape (..., tail) as Python writes it.
fn trailing(tail: &[usize]) -> String {
    let sizes: Vec<_> = tail.iter().map(usize::to_string).collect();
    format!("shape (..., {})", sizes.join(", "))
}

impl<'py> Input<'py> {
    /// The argument `name`, with these last axes.
    pub(crate) fn new(name: &str, x: &Bound<'py, PyAny>, tail: &[usize]) -> PyResult<Self> {
        let input = Self::any(name, x, tail.len())?;
        let shape = input.array.shape();
        match shape[shape.len() - tail.len()..] == *tail {
            true => Ok(input),
            false => {
                let value = format!("shape {}", shape_text(shape));
                Err(argument(x.py(), name, value, trailing(tail)))
            }
        }
    }

    /// The argument `name` with at least so many axes.
    pub(crate) fn any(name: &str, x: &Bound<'py, PyAny>, axes: usize) -> PyResult<Self> {
        let array = match unmasked(x) {
            Some(array) => array,
            None => {
                let real = x.py().import("lieflow._arrays")?.getattr("real")?;
                real.call1((name, x))?.cast_into::<PyArrayDyn<f64>>()?
            }
        };
        if array.ndim() < axes {
            let value = format!("shape {}", shape_text(array.shape()));
            return Err(argument(x.py(), name, value, format!("at least {axes} axes")));
        }
        Ok(Input { array, copy: None, tail: axes })
    }

    /// The leading axes.
    pub(crate) fn lead(&self) -> &[usize] {
        let shape = self.array.shape();
        &shape[..shape.len() - self.tail]
    }

    /// The shape.
    pub(crate) fn shape(&self) -> &[usize] {
        self.array.shape()
    }

    /// The numbers.
    pub(crate) fn numbers(&self) -> &[f64] {
        match &self.copy {
            Some(copy) => copy,
            // SAFETY: `plain` and `real` give aligned arrays of float64 in C order. Code that writes into an argument
            // from another thread during the call races, as with NumPy itself.
            None => unsafe { self.array.as_slice().unwrap_or(&[]) },
        }
    }

    /// Copies the numbers if the array shares memory with `out`.
    fn keep_from(&mut self, out: &Bound<'py, PyArrayDyn<f64>>) {
        let range = |array: &Bound<'py, PyArrayDyn<f64>>| {
            let start = array.data() as usize;
            start..start + size_of::<f64>() * array.len()
        };
        let (a, b) = (range(&self.array), range(out));
        if a.start < b.end && b.start < a.end {
            self.copy = Some(self.numbers().to_vec());
        }
    }
}

/// The place of a result with these leading and last axes: `out`, or a new array.
pub(crate) fn output<'py>(
    py: Python<'py>,
    (lead, tail): (&[usize], &[usize]),
    out: Option<&Bound<'py, PyAny>>,
    inputs: &mut [&mut Input<'py>],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let mut shape = [0usize; 32];
    let axes = lead.len() + tail.len();
    let shape = match shape.get_mut(..axes) {
        Some(shape) => shape,
        None => return Err(argument(py, "out", format!("{axes} axes"), "at most 32")),
    };
    shape[..lead.len()].copy_from_slice(lead);
    shape[lead.len()..].copy_from_slice(tail);
    let Some(out) = out.filter(|out| !out.is_none()) else {
        if shape.iter().try_fold(1usize, |size, n| size.checked_mul(*n)).is_none_or(|n| n > LARGE) {
            // NumPy's own function has an error for memory that is not there.
            let empty = py.import("numpy")?.call_method1("empty", (PyTuple::new(py, &*shape)?,))?;
            return Ok(empty.cast_into::<PyArrayDyn<f64>>()?);
        }
        // SAFETY: every number is written before the array is returned, or the array is dropped with an exception.
        return Ok(unsafe { PyArrayDyn::<f64>::new(py, &*shape, false) });
    };
    let fits = |array: &Bound<'py, PyArrayDyn<f64>>| {
        array.shape() == shape && array.try_readwrite().is_ok()
    };
    let Some(array) = plain(out).filter(fits) else {
        let wrong = py.import("lieflow._arrays")?.getattr("wrong_out")?;
        let error = wrong.call1((out, "float64", PyTuple::new(py, &*shape)?))?;
        return Err(PyErr::from_value(error));
    };
    for input in inputs {
        input.keep_from(&array);
    }
    Ok(array)
}

/// An argument by its name, with its numbers and the size of one element. A single element stands for all.
pub(crate) type Named<'a> = (&'a str, &'a [f64], usize);

/// Runs f on the numbers of the arguments and of the result. Many elements are taken in parts, without the interpreter.
pub(crate) fn fill<'py, const N: usize>(
    py: Python<'py>,
    inputs: &[Named<'_>; N],
    (out, lead): (Bound<'py, PyArrayDyn<f64>>, &[usize]),
    mut f: impl FnMut([&[f64]; N], &mut [f64]) -> Result<(), Error> + Send,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    // SAFETY: `output` gives a writeable array in C order, and what shares memory with it was copied.
    let numbers = unsafe { out.as_slice_mut()? };
    let count = lead.iter().product::<usize>();
    let of_part = |part: Range<usize>| {
        inputs.map(|(_, numbers, size)| match numbers.len() == size && count != 1 {
            true => numbers,
            false => &numbers[size * part.start..size * part.end],
        })
    };
    let done = match count >= MANY {
        true => py.detach(|| in_parts(count, numbers, |part, out| f(of_part(part), out))),
        false => f(inputs.map(|(_, numbers, _)| numbers), numbers).map_err(Stopped::Refused),
    };
    match done {
        Ok(()) => Ok(out),
        Err(Stopped::Refused(error)) => Err(of_element(py, inputs, lead, &error)),
        Err(Stopped::Interrupted(error)) => Err(error),
    }
}

/// The result of f on the numbers of an argument of this name. An element has the last axes `from`, and its result `to`.
pub(crate) fn map_one<'py>(
    (name, from, to): (&str, &[usize], &[usize]),
    x: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    mut f: impl FnMut(&[f64], &mut [f64]) -> Result<(), Error> + Send,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = x.py();
    let mut x = Input::new(name, x, from)?;
    let lead = x.lead().to_vec();
    let out = output(py, (&lead, to), out, &mut [&mut x])?;
    let size = from.iter().product();
    fill(py, &[(name, x.numbers(), size)], (out, &lead), |[x], out| f(x, out))
}

/// The same of two arguments. Their elements and the results have these last axes.
pub(crate) fn map_two<'py>(
    (names, tail): ([&str; 2], &[usize]),
    (a, b): (&Bound<'py, PyAny>, &Bound<'py, PyAny>),
    out: Option<&Bound<'py, PyAny>>,
    f: impl FnMut([&[f64]; 2], &mut [f64]) -> Result<(), Error> + Send,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = a.py();
    let both = (Input::new(names[0], a, tail)?, Input::new(names[1], b, tail)?);
    let (lead, mut a, mut b) = common(names, both)?;
    let out = output(py, (&lead, tail), out, &mut [&mut a, &mut b])?;
    let size = tail.iter().product();
    let inputs = [(names[0], a.numbers(), size), (names[1], b.numbers(), size)];
    fill(py, &inputs, (out, &lead), f)
}

/// f on each element of `size` numbers, and on its result of `to` numbers. A single element stands for all.
pub(crate) fn each<const N: usize>(
    inputs: [&[f64]; N],
    out: &mut [f64],
    [size, to]: [usize; 2],
    mut f: impl FnMut([&[f64]; N], &mut [f64]) -> Result<(), Error>,
) -> Result<(), Error> {
    let count = out.len() / to;
    for (index, out) in out.chunks_exact_mut(to).enumerate() {
        let element = inputs.map(|x| match x.len() == size && count != 1 {
            true => x,
            false => &x[size * index..][..size],
        });
        f(element, out).map_err(|error| Error::Element { index, source: Box::new(error) })?;
    }
    Ok(())
}

/// Why elements were not all taken.
pub(crate) enum Stopped {
    /// One of them cannot be used.
    Refused(Error),
    /// A signal came.
    Interrupted(PyErr),
}

/// The numbers of the first part, about.
const FIRST: usize = 1 << 16;
/// A part of so many elements is whole blocks of lanes, so that no bit depends on the parts.
const LANES: usize = 64;

/// Runs f on parts of `count` elements, which all have as many numbers of `out`. Hears signals between parts, which take
/// about as long as signals may wait.
pub(crate) fn in_parts<T>(
    count: usize,
    out: &mut [T],
    mut f: impl FnMut(Range<usize>, &mut [T]) -> Result<(), Error>,
) -> Result<(), Stopped> {
    let size = out.len() / count.max(1);
    let part = (FIRST / size.max(1)).max(1);
    let mut part = if part > LANES { part - part % LANES } else { part };
    let mut start = 0;
    while start < count {
        let clock = Instant::now();
        // No part is shorter than the lanes.
        let end = if count - start < part + LANES { count } else { start + part };
        f(start..end, &mut out[size * start..size * end]).map_err(|error| {
            Stopped::Refused(match error {
                Error::Element { index, source } => Error::Element { index: start + index, source },
                error => error,
            })
        })?;
        start = end;
        if clock.elapsed() < SIGNALS {
            part *= 2;
        }
        if start < count {
            Python::attach(|py| py.check_signals()).map_err(Stopped::Interrupted)?;
        }
    }
    Ok(())
}

/// The exception of an error at an element of arguments with these leading axes. An argument with a number that is not
/// finite is to blame, then the one that the error names, then the first.
fn of_element(py: Python<'_>, inputs: &[Named<'_>], lead: &[usize], error: &Error) -> PyErr {
    let first = inputs.first().map_or("out", |input| input.0);
    let Error::Element { index, source } = error else {
        return crate::error::refused(py, first, error);
    };
    let named = |name: &str, is_single: bool| match is_single {
        true => name.to_owned(),
        false => element(name, lead, *index),
    };
    let single = |input: &&Named<'_>| input.1.len() == input.2;
    let is_wrong = |input: &&Named<'_>| {
        let start = if single(input) { 0 } else { index * input.2 };
        let numbers = input.1.get(start..start + input.2);
        numbers.is_some_and(|numbers| numbers.iter().any(|x| !x.is_finite()))
    };
    if let Some(input) = inputs.iter().find(is_wrong) {
        let name = named(input.0, inputs.len() > 1 && single(&input));
        return argument(py, &name, "a number that is not finite", "finite numbers");
    }
    let (of, value, expected) = words(first, source);
    // The place of an entry stands after that of its matrix: the 3, 0 of g[2, 3, 0].
    let (of, entry) = of.split_once('[').unwrap_or((of.as_str(), ""));
    let input = inputs.iter().find(|input| input.0 == of);
    let name = named(input.map_or(first, |input| input.0), false);
    let name = if input.is_none() || entry.is_empty() {
        name
    } else if let Some(place) = name.strip_suffix(']') {
        format!("{place}, {entry}")
    } else {
        format!("{name}[{entry}")
    };
    argument(py, &name, value, expected)
}

/// The name of an element of an argument with these leading axes, as `u[2, 0]`.
pub(crate) fn element(name: &str, lead: &[usize], mut index: usize) -> String {
    let mut place = vec![0; lead.len()];
    for (axis, size) in lead.iter().enumerate().rev() {
        place[axis] = index % size.max(&1);
        index /= size.max(&1);
    }
    let place: Vec<_> = place.iter().map(usize::to_string).collect();
    match place.is_empty() {
        true => name.to_owned(),
        false => format!("{name}[{}]", place.join(", ")),
    }
}

/// The leading axes of two arguments. An argument of one element stands for all. Otherwise both are broadcast by NumPy.
pub(crate) fn common<'py>(
    [name_a, name_b]: [&str; 2],
    (a, b): (Input<'py>, Input<'py>),
) -> PyResult<(Vec<usize>, Input<'py>, Input<'py>)> {
    let one = |input: &Input<'_>| input.lead().iter().product::<usize>() == 1;
    if a.lead() == b.lead() || (one(&b) && b.lead().len() <= a.lead().len()) {
        return Ok((a.lead().to_vec(), a, b));
    }
    if one(&a) && a.lead().len() <= b.lead().len() {
        return Ok((b.lead().to_vec(), a, b));
    }
    let py = a.array.py();
    let (tail_a, tail_b) = (a.tail, b.tail);
    let together = py.import("lieflow._arrays")?.getattr("together")?;
    let both = together.call1((name_a, &a.array, tail_a, name_b, &b.array, tail_b))?;
    let (x, y): (Bound<'py, PyAny>, Bound<'py, PyAny>) = both.extract()?;
    let (a, b) = (Input::any(name_a, &x, tail_a)?, Input::any(name_b, &y, tail_b)?);
    Ok((a.lead().to_vec(), a, b))
}
