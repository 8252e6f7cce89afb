//! Runs with and without what takes their state back to M.

use lieflow::methods::Facts;
use lieflow::problems::{PointOf, ScalarOf};
use lieflow::{Error, Method, Problem, Step, StepError};

/// A method whose state the driver leaves alone.
pub(crate) struct Uncorrected<M>(pub(crate) M);

impl<P: Problem, M: Method<P>> Method<P> for Uncorrected<M> {
    type Work = M::Work;
    fn facts(&self, problem: &P) -> Facts {
        Facts { stays_on_manifold: false, ..self.0.facts(problem) }
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<M::Work, Error> {
        self.0.work(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut M::Work,
    ) -> Result<(), StepError> {
        self.0.step(problem, step, y, work)
    }
}

/// CPU time of this thread where the system tells (Linux), else 0.
pub(crate) fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|x| x.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}
