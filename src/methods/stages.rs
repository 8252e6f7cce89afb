//! The parts that all methods with stages in 𝔤 share, and the end of their steps.

use crate::chart::ChartStore;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::CoordinateMap;
use crate::problems::{AlgOf, PointOf, Problem};
use crate::scalar::Real;
use crate::space::{LinearSpace, Metric};

/// Makes S copies. One function serves all methods, because each closure would compile to another function.
pub(super) fn copies<T: Clone, const S: usize>(of: T) -> [T; S] {
    core::array::from_fn(|_| of.clone())
}

/// z ← y + h Σ_j w_j k_j. The last term is that of `newest`, if there is one: the same stage in a copy that stays in registers.
/// A stage that was just stored as two numbers and one, and is loaded as one and two, would wait for the store.
#[inline(always)]
pub(super) fn sum<Y: LinearSpace>(
    y: &Y,
    h: Y::Scalar,
    weights: &[f64],
    k: &[Y],
    newest: Option<&Y>,
    z: &mut Y,
) {
    let (Some(newest), Some((&last, before))) = (newest, weights.split_last()) else {
        return z.set_sum(y, h, weights, k);
    };
    z.set_sum(y, h, before, k);
    if last != 0.0 {
        z.add(h * Y::Scalar::lit(last), newest);
    }
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

    /// p ← y if the step was taken. Otherwise p is unchanged, and [`blame`](Self::blame) gives the error.
    #[inline(always)]
    pub(super) fn conclude(
        &mut self,
        problem: &P,
        done: Result<(), StepError>,
        p: &mut PointOf<P>,
        y: &PointOf<P>,
    ) -> Result<(), StepError> {
        done.map_err(|error| self.blame(problem, error))?;
        p.assign(y); // a swap of small points goes through memory
        Ok(())
    }

    /// The error of the step: the stage whose f is not finite, if there is one, else `error`. Clears the stages, so
    /// that the next attempt does not see their numbers.
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

/// The point and the time at which the value of f is known, because the last stage of a step was taken there.
///
/// Another step begins there only if both are the same, to the last bit. So it depends on its arguments alone. Dense output
/// takes the value as its first extra stage.
pub(super) struct Known<Y: Metric> {
    /// The time, if there is a known value.
    t: Option<Y::Scalar>,
    y: Y,
    /// True if steps end with the first stage of the next.
    pub(super) is_offered: bool,
    /// How often the value was used.
    pub(super) used: u64,
}

impl<Y: Metric + Clone> Known<Y> {
    pub(super) fn new(like: &Y, is_offered: bool) -> Self {
        Known { t: None, y: like.clone(), is_offered, used: 0 }
    }

    /// True if the value is known there.
    #[inline(always)]
    pub(super) fn has(&self, t: Y::Scalar, y: &Y) -> bool {
        self.is_offered && self.t == Some(t) && self.y.is_same(y)
    }

    /// True if the value is known there. Then it is used, and no longer known.
    #[inline(always)]
    pub(super) fn take(&mut self, t: Y::Scalar, y: &Y) -> bool {
        let is_there = self.has(t, y);
        self.t = None;
        self.used += u64::from(is_there);
        is_there
    }

    /// No value is known.
    pub(super) fn forget(&mut self) {
        self.t = None;
    }

    /// The value is known there.
    #[inline(always)]
    pub(super) fn set(&mut self, t: Y::Scalar, y: &Y) {
        self.t = Some(t);
        self.y.assign(y);
    }
}
