//! Many free rigid bodies at once.

use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

use lieflow::ensemble::{Ensemble, EnsembleMethod};
use lieflow::problems::inertia::impossible;
use nalgebra::Matrix3;
use numpy::{PyArrayDyn, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;

use crate::error::{argument, refused};
use crate::field::array;
use crate::stepper::{lock, wait_for};

/// The methods by name.
const METHODS: [(&str, EnsembleMethod); 3] = [
    ("rkmk4 exp", EnsembleMethod::Rkmk4Exp),
    ("rkmk4 cay", EnsembleMethod::Rkmk4Cay),
    ("rk4-mg", EnsembleMethod::Rk4),
];

/// Many free rigid bodies.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct FreeBodies {
    bodies: Mutex<Ensemble>,
    count: usize,
    has_attitudes: bool,
    impossible: Option<String>,
}

impl FreeBodies {
    fn bodies(&self, py: Python<'_>) -> MutexGuard<'_, Ensemble> {
        wait_for(py, &self.bodies)
    }
}

#[pymethods]
impl FreeBodies {
    #[new]
    #[pyo3(signature = (inertia, momentum, attitude = None))]
    fn new(
        py: Python<'_>,
        inertia: PyReadonlyArray2<'_, f64>,
        momentum: PyReadonlyArray2<'_, f64>,
        attitude: Option<PyReadonlyArray3<'_, f64>>,
    ) -> PyResult<Self> {
        let (inertia, momentum) = (inertia.as_slice()?, momentum.as_slice()?);
        let (inertia, _) = inertia.as_chunks::<3>();
        let (momentum, _) = momentum.as_chunks::<3>();
        let refuse = |error: lieflow::Error| refused(py, "bodies", &error);
        let mut bodies = Ensemble::new(inertia, momentum).map_err(refuse)?;
        if let Some(attitude) = &attitude {
            let rows = attitude.as_slice()?.chunks_exact(9);
            let attitudes: Vec<_> = rows.map(Matrix3::from_row_slice).collect();
            bodies = bodies.with_attitudes(&attitudes).map_err(refuse)?;
        }
        let (count, has_attitudes) = (momentum.len(), attitude.is_some());
        let mut all = inertia.iter().enumerate();
        let impossible = all.find_map(|(i, j)| Some(format!("inertia[{i}]: {}", impossible(*j)?)));
        Ok(FreeBodies { bodies: Mutex::new(bodies), count, has_attitudes, impossible })
    }
    /// What is wrong with the moments of the first body that cannot be.
    #[getter]
    fn impossible(&self) -> Option<&str> {
        self.impossible.as_deref()
    }
    fn advance(
        &self,
        py: Python<'_>,
        method: &str,
        h: f64,
        steps: u64,
        threads: usize,
    ) -> PyResult<()> {
        let known = METHODS.iter().find(|(name, _)| *name == method);
        let (_, known) = known.ok_or_else(|| {
            let names = METHODS.map(|(name, _)| name).join(", ");
            argument(py, "method", format!("{method:?}"), format!("one of {names}"))
        })?;
        // In parts of about this time, with a look at Ctrl-C after each. The bits do not depend on the parts.
        const PART: Duration = Duration::from_millis(20);
        let refuse = |error| refused(py, "bodies", &error);
        py.detach(|| {
            let mut bodies = lock(&self.bodies);
            let (mut left, mut part) = (steps, 1);
            loop {
                let start = Instant::now();
                let now = left.min(part);
                bodies.advance(*known, h, now, threads).map_err(Err)?;
                left -= now;
                if left == 0 {
                    return Ok(());
                }
                part = if start.elapsed() < PART { 2 * part } else { (part / 2).max(1) };
                Python::attach(|py| py.check_signals()).map_err(Ok)?;
            }
        })
        .map_err(|error: Result<PyErr, _>| error.unwrap_or_else(refuse))
    }
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let bodies = self.bodies(py);
        let all = (0..self.count).filter_map(|i| bodies.momentum(i));
        let numbers: Vec<f64> = all.flat_map(|m| [m.x, m.y, m.z]).collect();
        array(py, &[self.count, 3], &numbers)
    }
    fn attitude<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArrayDyn<f64>>>> {
        let bodies = self.bodies(py);
        let all = (0..self.count).filter_map(|i| bodies.attitude(i));
        let numbers: Vec<f64> = all.flat_map(|g| g.transpose().data.0.concat()).collect();
        let array = || array(py, &[self.count, 3, 3], &numbers);
        self.has_attitudes.then(array).transpose()
    }
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let bodies = self.bodies(py);
        let numbers: Vec<f64> = (0..self.count).filter_map(|i| bodies.energy(i)).collect();
        array(py, &[self.count], &numbers)
    }
}
