//! f, events and changes of a run: Python callables, and addresses of C functions.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use lieflow_model::kinds::own::OwnField;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::pyclass::{PyTraverseError, PyVisit};
use pyo3::types::{PyFloat, PyList, PyTuple};

use crate::arrays::unmasked;

/// The first exception of the callables of a run, the flag that ends the run, and the calls of f.
#[derive(Default)]
pub(crate) struct Raised {
    first: Mutex<Option<PyErr>>,
    pub(crate) stop: Arc<AtomicBool>,
    calls: AtomicU64,
}

impl Raised {
    pub(crate) fn keep(&self, error: PyErr) {
        if let Ok(mut first) = self.first.lock() {
            first.get_or_insert(error);
        }
        self.stop.store(true, Ordering::Relaxed);
    }

    /// The exception, if there is one.
    pub(crate) fn take(&self) -> Option<PyErr> {
        self.first.lock().ok().and_then(|mut first| first.take())
    }

    /// The calls of a function of Python after the first one, which checks its value; None where f is no such function.
    pub(crate) fn calls(&self) -> Option<u64> {
        self.calls.load(Ordering::Relaxed).checked_sub(1)
    }
}

/// A function and its further arguments.
struct Held {
    f: Py<PyAny>,
    args: Vec<Py<PyAny>>,
}

/// A function of (t, y, *args).
pub(crate) struct Callable {
    /// None after [`clear`](Self::clear). A run has one call of it at a time.
    held: Mutex<Option<Held>>,
    /// The shape of y.
    shape: Vec<usize>,
    /// True for a function of t alone.
    of_time: bool,
    raised: Arc<Raised>,
}

/// A new array with these numbers.
pub(crate) fn array<'py>(
    py: Python<'py>,
    shape: &[usize],
    numbers: &[f64],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    // SAFETY: all numbers of the new array are written here; it has as many as the slice, which is checked.
    let array = unsafe { PyArrayDyn::<f64>::new(py, shape, false) };
    unsafe { array.as_slice_mut()? }.copy_from_slice(numbers);
    Ok(array)
}

impl Callable {
    pub(crate) fn new(
        f: Py<PyAny>,
        args: Vec<Py<PyAny>>,
        (shape, of_time): (&[usize], bool),
        raised: Arc<Raised>,
    ) -> Self {
        let held = Mutex::new(Some(Held { f, args }));
        Callable { held, shape: shape.to_vec(), of_time, raised }
    }

    /// Shows the cycle collector of Python what it holds.
    pub(crate) fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        // A call has the lock until it ends: the function is then in use.
        let Ok(held) = self.held.try_lock() else { return Ok(()) };
        let Some(Held { f, args }) = &*held else { return Ok(()) };
        visit.call(f)?;
        args.iter().try_for_each(|arg| visit.call(arg))
    }

    /// Lets go of the function, which cannot be called any more.
    pub(crate) fn clear(&self) {
        let held = self.held.try_lock().ok().and_then(|mut held| held.take());
        // Their ends may run code of Python: not under the lock.
        drop(held);
    }

    /// Calls it, and reads its value. An exception ends the run.
    pub(crate) fn call<T>(
        &self,
        t: f64,
        y: &[f64],
        read: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
    ) -> Option<T> {
        if self.raised.stop.load(Ordering::Relaxed) {
            return None;
        }
        Python::attach(|py| {
            let done = self.value(py, t, y).and_then(|value| read(&value));
            done.map_err(|error| self.raised.keep(error)).ok()
        })
    }

    fn value<'py>(&self, py: Python<'py>, t: f64, y: &[f64]) -> PyResult<Bound<'py, PyAny>> {
        let held = self.held.try_lock().ok();
        let Some(Held { f, args }) = held.as_deref().and_then(Option::as_ref) else {
            let freed = "f: it was freed with its run, expected a run in use";
            return Err(PyRuntimeError::new_err(freed));
        };
        let f = f.bind(py);
        if self.of_time && args.is_empty() {
            return f.call1((t,));
        }
        if args.is_empty() {
            return f.call1((t, array(py, &self.shape, y)?));
        }
        let mut all: Vec<Bound<'py, PyAny>> = vec![PyFloat::new(py, t).into_any()];
        if !self.of_time {
            all.push(array(py, &self.shape, y)?.into_any());
        }
        all.extend(args.iter().map(|arg| arg.bind(py).clone()));
        f.call1(PyTuple::new(py, all)?)
    }
}

/// A list or a tuple, which may hold floats.
enum Floats<'a, 'py> {
    List(&'a Bound<'py, PyList>),
    Tuple(&'a Bound<'py, PyTuple>),
}

impl<'a, 'py> Floats<'a, 'py> {
    fn of(value: &'a Bound<'py, PyAny>) -> Option<Self> {
        let list = value.cast_exact::<PyList>().ok().map(Floats::List);
        list.or_else(|| value.cast_exact::<PyTuple>().ok().map(Floats::Tuple))
    }

    fn len(&self) -> usize {
        match self {
            Floats::List(list) => list.len(),
            Floats::Tuple(tuple) => tuple.len(),
        }
    }

    /// The entry, if it is a float and nothing else.
    fn get(&self, i: usize) -> Option<f64> {
        let entry = match self {
            Floats::List(list) => list.get_item(i),
            Floats::Tuple(tuple) => tuple.get_item(i),
        };
        entry.ok()?.cast_exact::<PyFloat>().ok().map(|x| x.value())
    }
}

/// out ← the numbers of a value of f.
fn read_value(
    value: &Bound<'_, PyAny>,
    (name, t): (&str, f64),
    shape: &[usize],
    out: &mut [f64],
) -> PyResult<()> {
    if let Some(array) = unmasked(value)
        && array.shape() == shape
    {
        // SAFETY: the array is in C order and aligned, and nothing runs that could change it while it is read.
        out.copy_from_slice(unsafe { array.as_slice()? });
        return Ok(());
    }
    if let [n] = shape
        && let Some(list) = Floats::of(value)
        && list.len() == *n
        && (0..*n).all(|i| {
            list.get(i).is_some_and(|x| {
                out[i] = x;
                true
            })
        })
    {
        return Ok(());
    }
    let py = value.py();
    let real = py.import("lieflow._arrays")?.getattr("value")?;
    let array = real.call1((name, value, PyTuple::new(py, shape)?, t))?;
    let array = array.cast_into::<PyArrayDyn<f64>>()?;
    // SAFETY: as above; `value` gives an array of this shape in C order.
    out.copy_from_slice(unsafe { array.as_slice()? });
    Ok(())
}

/// The field of a callable.
pub(crate) fn of_callable(f: Arc<Callable>, shape: &[usize]) -> Arc<OwnField> {
    let shape = shape.to_vec();
    Arc::new(move |t, y, v| {
        let called = !f.raised.stop.load(Ordering::Relaxed);
        f.raised.calls.fetch_add(u64::from(called), Ordering::Relaxed);
        f.call(t, y, |value| read_value(value, ("f", t), &shape, v)).is_some()
    })
}

/// The number of an event.
pub(crate) fn number(name: &str, t: f64, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    if let Ok(value) = value.cast_exact::<PyFloat>() {
        return Ok(value.value());
    }
    let mut out = [0.0];
    read_value(value, (name, t), &[], &mut out)?;
    Ok(out[0])
}

/// y ← the value of a change.
pub(crate) fn change(f: &Callable, name: &str, t: f64, y: &mut [f64]) {
    let (shape, before) = (f.shape.clone(), y.to_vec());
    let done = f.call(t, &before, |value| read_value(value, (name, t), &shape, y));
    if done.is_none() {
        y.copy_from_slice(&before);
    }
}

/// void f(double t, const double *y, double *v, const double *p).
type CFunction = unsafe extern "C" fn(f64, *const f64, *mut f64, *const f64);

/// The field of a C function at this address, which must not be 0.
pub(crate) fn of_address(
    address: usize,
    parameters: Vec<f64>,
    raised: Arc<Raised>,
) -> Arc<OwnField> {
    // SAFETY: the caller of `solve_ivp` says that a function of this type is at the address, and keeps it alive. This
    // cannot be checked. A null address is refused before.
    let f: CFunction = unsafe { core::mem::transmute::<usize, CFunction>(address) };
    Arc::new(move |t, y, v| {
        // SAFETY: as above; the slices have the sizes of the space, and the parameters those that the user gave.
        unsafe { f(t, y.as_ptr(), v.as_mut_ptr(), parameters.as_ptr()) };
        !raised.stop.load(Ordering::Relaxed)
    })
}
