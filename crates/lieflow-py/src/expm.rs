//! exp of square matrices, real and complex.

use faer::{Mat, c64};
use lieflow::Error;
use lieflow::dense::{ComplexExponential, Exponential, ExponentialBatch, Structure};
use numpy::{Complex64, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Input, fill, output, shape_text};
use crate::error::argument;

/// Up to this size many matrices are taken in lanes.
const LANES_MAX: usize = 6;
/// Below this number they are taken one by one.
const FEW: usize = 8;
/// Matrices of a block in lanes.
const BLOCK: usize = 64;

fn structure_of(py: Python<'_>, name: Option<&str>) -> PyResult<Structure> {
    match name {
        None => Ok(Structure::General),
        Some("skew") => Ok(Structure::Skew),
        Some(other) => Err(argument(py, "structure", format!("{other:?}"), "None or \"skew\"")),
    }
}

fn square(py: Python<'_>, shape: &[usize]) -> PyResult<usize> {
    match shape {
        [.., n, m] if n == m => Ok(*n),
        shape => {
            Err(argument(py, "A", format!("shape {}", shape_text(shape)), "shape (..., n, n)"))
        }
    }
}

/// out ← exp of each matrix.
pub(crate) fn real(
    n: usize,
    numbers: &[f64],
    structure: Structure,
    out: &mut [f64],
) -> Result<(), Error> {
    let size = n * n;
    if size == 0 {
        return Ok(());
    }
    let at = |index: usize| {
        move |source: lieflow::StepError| Error::Element { index, source: Box::new(source.into()) }
    };
    let count = numbers.len() / size;
    if n <= LANES_MAX && count >= FEW {
        let mut batch = ExponentialBatch::new(n);
        let mut block = [vec![0.0; size * BLOCK], vec![0.0; size * BLOCK]];
        for start in (0..count).step_by(BLOCK) {
            let len = BLOCK.min(count - start);
            let rows = &numbers[size * start..size * (start + len)];
            let [u, g] = block.each_mut().map(|block| &mut block[..size * len]);
            for (m, row) in rows.chunks_exact(size).enumerate() {
                for (k, x) in row.iter().enumerate() {
                    u[k * len + m] = *x;
                }
            }
            if batch.exp(u, structure, g).is_err() {
                one_by_one(n, rows, structure, &mut out[size * start..size * (start + len)])
                    .map_err(|(index, error)| at(start + index)(error))?;
                continue;
            }
            let out = &mut out[size * start..size * (start + len)];
            for (m, row) in out.chunks_exact_mut(size).enumerate() {
                for (k, x) in row.iter_mut().enumerate() {
                    *x = g[k * len + m];
                }
            }
        }
        return Ok(());
    }
    one_by_one(n, numbers, structure, out).map_err(|(index, error)| at(index)(error))
}

fn one_by_one(
    n: usize,
    numbers: &[f64],
    structure: Structure,
    out: &mut [f64],
) -> Result<(), (usize, lieflow::StepError)> {
    let mut exponential = Exponential::new(n);
    let (mut u, mut g) = (Mat::zeros(n, n), Mat::zeros(n, n));
    let rows = numbers.chunks_exact(n * n).zip(out.chunks_exact_mut(n * n)).enumerate();
    for (index, (row, out)) in rows {
        for j in 0..n {
            for (i, u) in u.col_as_slice_mut(j).iter_mut().enumerate() {
                *u = row[i * n + j];
            }
        }
        exponential.exp(&u, structure, &mut g).map_err(|error| (index, error))?;
        for j in 0..n {
            for (i, g) in g.col_as_slice(j).iter().enumerate() {
                out[i * n + j] = *g;
            }
        }
    }
    Ok(())
}

/// The same in so many threads.
fn in_threads(
    threads: usize,
    n: usize,
    numbers: &[f64],
    structure: Structure,
    out: &mut [f64],
) -> Result<(), Error> {
    let size = (n * n).max(1);
    // Whole blocks, so that the result does not depend on the number of threads.
    let each = (numbers.len() / size).div_ceil(threads.max(1)).next_multiple_of(BLOCK);
    if threads <= 1 || numbers.is_empty() || each * size >= numbers.len() {
        return real(n, numbers, structure, out);
    }
    std::thread::scope(|scope| {
        let parts = numbers.chunks(each * size).zip(out.chunks_mut(each * size)).enumerate();
        let running: Vec<_> = parts
            .map(|(part, (numbers, out))| {
                scope.spawn(move || {
                    real(n, numbers, structure, out).map_err(|error| match error {
                        Error::Element { index, source } => {
                            Error::Element { index: index + part * each, source }
                        }
                        error => error,
                    })
                })
            })
            .collect();
        let mut first = Ok(());
        for part in running {
            let done = part.join().unwrap_or(Ok(()));
            first = first.and(done);
        }
        first
    })
}

#[pyfunction]
#[pyo3(signature = (a, structure = None, threads = 1, out = None))]
fn expm<'py>(
    a: &Bound<'py, PyAny>,
    structure: Option<&str>,
    threads: usize,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = a.py();
    let structure = structure_of(py, structure)?;
    let mut a = Input::any("A", a, 2)?;
    let n = square(py, a.shape())?;
    let lead = a.lead().to_vec();
    let out = output(py, (&lead, &[n, n]), out, &mut [&mut a])?;
    let numbers = a.numbers();
    fill(py, "A", (out, &lead), |out| in_threads(threads, n, numbers, structure, out))
}

#[pyfunction]
#[pyo3(signature = (a, structure = None))]
fn expm_complex<'py>(
    a: &Bound<'py, PyArrayDyn<Complex64>>,
    structure: Option<&str>,
) -> PyResult<Bound<'py, PyArrayDyn<Complex64>>> {
    let py = a.py();
    let structure = structure_of(py, structure)?;
    let shape = a.shape().to_vec();
    let n = square(py, &shape)?;
    let numbers = a.to_vec()?;
    let mut out = Vec::with_capacity(numbers.len());
    let mut exponential = ComplexExponential::new(n);
    let mut g = Mat::<c64>::zeros(n, n);
    for (index, row) in numbers.chunks_exact((n * n).max(1)).enumerate() {
        let u = Mat::from_fn(n, n, |i, j| c64::new(row[i * n + j].re, row[i * n + j].im));
        if let Err(error) = exponential.exp(&u, structure, &mut g) {
            return Err(argument(py, &format!("A, matrix number {index}"), error.to_string(), ""));
        }
        for i in 0..n {
            out.extend((0..n).map(|j| Complex64::new(g[(i, j)].re, g[(i, j)].im)));
        }
    }
    numpy::PyArray1::from_vec(py, out).reshape(shape)
}

pub(crate) fn add(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(expm, m)?)?;
    m.add_function(wrap_pyfunction!(expm_complex, m)?)
}
