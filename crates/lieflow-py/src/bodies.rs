//! Many free rigid bodies at once.

use std::time::Instant;

use lieflow::ensemble::{Ensemble, EnsembleMethod};
use lieflow::problems::inertia::impossible;
use nalgebra::Matrix3;
use numpy::{PyArrayDyn, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;

use crate::error::{argument, refused};
use crate::field::array;
use crate::in_turn::InTurn;
use crate::run::SIGNALS;

/// The methods by name.
const METHODS: [(&str, EnsembleMethod); 3] = [
    ("rkmk4 exp", EnsembleMethod::Rkmk4Exp),
    ("rkmk4 cay", EnsembleMethod::Rkmk4Cay),
    ("rk4-mg", EnsembleMethod::Rk4),
];

type Numbers<'py> = Bound<'py, PyArrayDyn<f64>>;

/// The bodies after some steps.
#[derive(Clone)]
struct Bodies {
    now: Ensemble,
    steps: u64,
}

impl Bodies {
    fn momenta(&self) -> Vec<f64> {
        let all = (0..self.now.len()).filter_map(|i| self.now.momentum(i));
        all.flat_map(|m| [m.x, m.y, m.z]).collect()
    }
    fn attitudes(&self) -> Vec<f64> {
        let all = (0..self.now.len()).filter_map(|i| self.now.attitude(i));
        all.flat_map(|g| g.transpose().data.0.concat()).collect()
    }
    fn energies(&self) -> Vec<f64> {
        (0..self.now.len()).filter_map(|i| self.now.energy(i)).collect()
    }
}

/// Many free rigid bodies.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct FreeBodies {
    bodies: InTurn<Bodies>,
    /// The bodies before the call that takes steps.
    before: InTurn<Bodies>,
    count: usize,
    has_attitudes: bool,
    impossible: Option<String>,
}

impl FreeBodies {
    /// The array of attitudes, if there are any.
    fn rotations<'py>(&self, py: Python<'py>, numbers: &[f64]) -> PyResult<Option<Numbers<'py>>> {
        self.has_attitudes.then(|| array(py, &[self.count, 3, 3], numbers)).transpose()
    }

    /// Takes steps in parts of about the time that signals may wait. The bits do not depend on the parts. After an error the
    /// bodies are as before.
    fn take_steps(
        &self,
        py: Python<'_>,
        before: &mut Bodies,
        (method, h): (EnsembleMethod, f64),
        steps: u64,
        threads: usize,
    ) -> PyResult<()> {
        let (mut left, mut part) = (steps, 1);
        loop {
            let count = left.min(part);
            let done = self.bodies.with(py, |bodies| {
                let clock = Instant::now();
                let done = py.detach(|| {
                    if left == steps {
                        before.now.clone_from(&bodies.now);
                        before.steps = bodies.steps;
                    }
                    bodies.now.advance(method, h, count, threads)
                });
                match done {
                    Ok(()) => bodies.steps += count,
                    Err(_) => core::mem::swap(bodies, before),
                }
                done.map(|()| clock.elapsed())
            })?;
            let took = done.map_err(|error| refused(py, "bodies", &error))?;
            left -= count;
            if left == 0 {
                return Ok(());
            }
            part = if took < SIGNALS { 2 * part } else { (part / 2).max(1) };
            py.check_signals()?;
        }
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
        const BUSY: &str =
            "a signal handler cannot use the bodies that its thread uses or waits for";
        let bodies = Bodies { now: bodies, steps: 0 };
        let [bodies, before] = [bodies.clone(), bodies].map(|bodies| InTurn::new(bodies, BUSY));
        Ok(FreeBodies { bodies, before, count, has_attitudes, impossible })
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
        self.before.with(py, |before| self.take_steps(py, before, (*known, h), steps, threads))?
    }
    /// The steps of all calls.
    #[getter]
    fn nsteps(&self, py: Python<'_>) -> PyResult<u64> {
        self.bodies.with(py, |bodies| bodies.steps)
    }
    fn momentum<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        array(py, &[self.count, 3], &self.bodies.with(py, |bodies| bodies.momenta())?)
    }
    fn attitude<'py>(&self, py: Python<'py>) -> PyResult<Option<Numbers<'py>>> {
        self.rotations(py, &self.bodies.with(py, |bodies| bodies.attitudes())?)
    }
    /// The momenta and the attitudes after the same step.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<(Numbers<'py>, Option<Numbers<'py>>)> {
        let read = |bodies: &mut Bodies| (bodies.momenta(), bodies.attitudes());
        let (momenta, attitudes) = self.bodies.with(py, read)?;
        Ok((array(py, &[self.count, 3], &momenta)?, self.rotations(py, &attitudes)?))
    }
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        array(py, &[self.count], &self.bodies.with(py, |bodies| bodies.energies())?)
    }
}
