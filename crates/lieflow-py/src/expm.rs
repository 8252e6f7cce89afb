//! exp of square matrices, real and complex.

use std::cell::Cell;

use faer::{Mat, c64};
use lieflow::Error;
use lieflow::dense::{ComplexExponential, Exponential, ExponentialBatch, Structure};
use numpy::{Complex64, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Input, Stopped, element, fill, in_parts, output, shape_text};
use crate::error::{argument, refused, words};

/// Up to this size many matrices are taken in lanes.
const LANES_MAX: usize = 6;
/// Below this number they are taken one by one.
const FEW: usize = 8;
/// Matrices of a block in lanes.
const BLOCK: usize = 64;
/// Up to this size a thread keeps its workspace.
const KEPT_MAX: usize = 16;

/// What the exponential of one matrix needs.
struct Workspace {
    exponential: Exponential,
    u: Mat<f64>,
    g: Mat<f64>,
}

thread_local! {
    /// The workspace of the last call. Making one takes ten times as long as the exponential of a small matrix.
    static KEPT: Cell<Option<Workspace>> = const { Cell::new(None) };
}

impl Workspace {
    /// The workspace for n×n matrices: the one that is kept, or a new one.
    fn of(n: usize) -> Self {
        let new = || Workspace {
            exponential: Exponential::new(n),
            u: Mat::zeros(n, n),
            g: Mat::zeros(n, n),
        };
        KEPT.take().filter(|kept| kept.u.nrows() == n).unwrap_or_else(new)
    }

    /// Keeps the workspace for the next call.
    fn keep(self) {
        if self.u.nrows() <= KEPT_MAX {
            KEPT.set(Some(self));
        }
    }
}

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
    let mut workspace = Workspace::of(n);
    let Workspace { exponential, u, g } = &mut workspace;
    let rows = numbers.chunks_exact(n * n).zip(out.chunks_exact_mut(n * n)).enumerate();
    for (index, (row, out)) in rows {
        for j in 0..n {
            for (i, u) in u.col_as_slice_mut(j).iter_mut().enumerate() {
                *u = row[i * n + j];
            }
        }
        exponential.exp(u, structure, g).map_err(|error| (index, error))?;
        for j in 0..n {
            for (i, g) in g.col_as_slice(j).iter().enumerate() {
                out[i * n + j] = *g;
            }
        }
    }
    workspace.keep();
    Ok(())
}

/// out ← exp of each complex matrix.
fn complex(
    n: usize,
    numbers: &[Complex64],
    structure: Structure,
    out: &mut [Complex64],
) -> Result<(), Error> {
    let size = (n * n).max(1);
    let mut exponential = ComplexExponential::new(n);
    let mut g = Mat::<c64>::zeros(n, n);
    let rows = numbers.chunks_exact(size).zip(out.chunks_exact_mut(size));
    for (index, (row, out)) in rows.enumerate() {
        let u = Mat::from_fn(n, n, |i, j| c64::new(row[i * n + j].re, row[i * n + j].im));
        exponential
            .exp(&u, structure, &mut g)
            .map_err(|source| Error::Element { index, source: Box::new(source.into()) })?;
        for i in 0..n {
            for j in 0..n {
                out[i * n + j] = Complex64::new(g[(i, j)].re, g[(i, j)].im);
            }
        }
    }
    Ok(())
}

/// How far a matrix may be from a skew one, relative to its largest entry.
const OFF_SKEW: f64 = 1e-12;

/// Refuses a matrix of n×n `numbers` that is not skew. `off` is |a_ij + conj a_ji|.
fn check_skew<T: Copy>(
    py: Python<'_>,
    (n, lead): (usize, &[usize]),
    numbers: &[T],
    off: impl Fn(T, T) -> f64,
    size: impl Fn(T) -> f64,
) -> PyResult<()> {
    for (index, a) in numbers.chunks_exact((n * n).max(1)).enumerate() {
        let most = a.iter().map(|&x| size(x)).fold(0.0, f64::max);
        let pairs = (0..n * n).map(|k| off(a[k], a[(k % n) * n + k / n]));
        let distance = pairs.fold(0.0, f64::max);
        // A matrix that is not finite has no exponential, and is refused there.
        if most.is_finite() && distance > OFF_SKEW * most {
            let name = element("A", lead, index);
            let value = format!("a matrix with an entry {distance:.1e} of A + A†");
            return Err(argument(py, &name, value, "a skew matrix, A† = −A"));
        }
    }
    Ok(())
}

/// The same in so many threads.
fn in_threads<T: Copy + Send + Sync>(
    threads: usize,
    n: usize,
    numbers: &[T],
    out: &mut [T],
    exp: impl Fn(&[T], &mut [T]) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    let size = (n * n).max(1);
    let exp = &exp;
    let each = (numbers.len() / size).div_ceil(threads.max(1));
    // Whole blocks, so that the result does not depend on the number of threads.
    let each = if n <= LANES_MAX { each.next_multiple_of(BLOCK) } else { each };
    if threads <= 1 || numbers.is_empty() || each * size >= numbers.len() {
        return exp(numbers, out);
    }
    std::thread::scope(|scope| {
        let parts = numbers.chunks(each * size).zip(out.chunks_mut(each * size)).enumerate();
        let running: Vec<_> = parts
            .map(|(part, (numbers, out))| {
                scope.spawn(move || {
                    exp(numbers, out).map_err(|error| match error {
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
            let done = part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
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
    if structure == Structure::Skew {
        check_skew(py, (n, &lead), a.numbers(), |x, y| (x + y).abs(), f64::abs)?;
    }
    let out = output(py, (&lead, &[n, n]), out, &mut [&mut a])?;
    let numbers = a.numbers();
    fill(py, &[("A", numbers, n * n)], (out, &lead), |[numbers], out| {
        in_threads(threads, n, numbers, out, |a, out| real(n, a, structure, out))
    })
}

#[pyfunction]
#[pyo3(signature = (a, structure = None, threads = 1))]
fn expm_complex<'py>(
    a: &Bound<'py, PyArrayDyn<Complex64>>,
    structure: Option<&str>,
    threads: usize,
) -> PyResult<Bound<'py, PyArrayDyn<Complex64>>> {
    let py = a.py();
    let structure = structure_of(py, structure)?;
    let shape = a.shape().to_vec();
    let n = square(py, &shape)?;
    let lead = &shape[..shape.len() - 2];
    let numbers = a.readonly();
    let numbers = numbers.as_slice()?;
    if structure == Structure::Skew {
        let off = |x: Complex64, y: Complex64| (x + y.conj()).norm();
        check_skew(py, (n, lead), numbers, off, Complex64::norm)?;
    }
    let out = PyArrayDyn::<Complex64>::zeros(py, &*shape, false);
    let mut written = out.readwrite();
    let places = written.as_slice_mut()?;
    let (count, size) = (lead.iter().product(), n * n);
    let done = py.detach(|| {
        in_parts(count, places, |part, out| {
            let numbers = &numbers[size * part.start..size * part.end];
            in_threads(threads, n, numbers, out, |a, out| complex(n, a, structure, out))
        })
    });
    match done {
        Ok(()) => {
            drop(written);
            Ok(out)
        }
        Err(Stopped::Refused(Error::Element { index, source })) => {
            let (_, value, expected) = words("A", &source);
            Err(argument(py, &element("A", lead, index), value, expected))
        }
        Err(Stopped::Refused(error)) => Err(refused(py, "A", &error)),
        Err(Stopped::Interrupted(error)) => Err(error),
    }
}

pub(crate) fn add(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(expm, m)?)?;
    m.add_function(wrap_pyfunction!(expm_complex, m)?)
}
