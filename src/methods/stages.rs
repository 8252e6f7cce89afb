//! What every method with stages in 𝔤 has, and how its step ends.

use crate::chart::ChartStore;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::CoordinateMap;
use crate::problems::{AlgOf, PointOf, Problem};

/// S copies. One function for all methods: a closure at each place would be a function at each.
pub(super) fn copies<T: Clone, const S: usize>(of: T) -> [T; S] {
    core::array::from_fn(|_| of.clone())
}

/// The stages k, an increment u and the chart.
pub(super) struct Stages<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> {
    pub(super) k: [AlgOf<P>; S],
    pub(super) u: AlgOf<P>,
    pub(super) chart: ChartStore<P, Psi>,
}

impl<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> Stages<P, Psi, S> {
    pub(super) fn new(problem: &P, psi: &Psi, like: &PointOf<P>) -> Result<Self, Error> {
        let zero = || problem.group().zero();
        let chart = ChartStore::new(problem, psi, like)?;
        Ok(Stages { k: copies(zero()), u: zero(), chart })
    }

    /// p ← y where the step was taken; else p stays, and the error is [`blame`](Self::blame)d.
    #[inline(always)]
    pub(super) fn conclude(
        &mut self,
        problem: &P,
        done: Result<(), StepError>,
        p: &mut PointOf<P>,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        done.map_err(|error| self.blame(problem, error))?;
        core::mem::swap(p, y);
        Ok(())
    }

    /// The error of the step: the stage whose f was not finite where there is one, else `error`. The stages
    /// are cleared, so that the next attempt does not see the numbers of this one.
    #[cold]
    pub(super) fn blame(&mut self, problem: &P, error: StepError) -> StepError {
        let alg = problem.group();
        let mut error = error;
        for i in (0..S).rev() {
            if !alg.is_finite(&self.k[i]) {
                error = StepError::NonFiniteRhs { stage: i + 1 };
            }
            alg.set_zero(&mut self.k[i]);
        }
        error
    }
}
