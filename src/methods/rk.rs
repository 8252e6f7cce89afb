//! Classical explicit Runge–Kutta on the linear space around M: the comparison method of the paper.
//!
//! It leaves the group: gᵀg − 𝟙 and |m| drift with the order of the method. Order: the tableau's.
//! Preserves: linear invariants only. Cost: S evaluations of F.
//! Source: Hairer, Nørsett, Wanner I, p. 138.

use super::{Method, Step, Tableau};
use crate::error::{Error, StepError};
use crate::problems::{Ambient, PointOf, ScalarOf};
use crate::scalar::Real;

/// An explicit Runge–Kutta method on the entries of y.
#[derive(Clone, Copy, Debug)]
pub struct Rk<const S: usize>(pub Tableau<S>);

/// Stages, a point, and the field's scratch.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct RkWork<P: Ambient, const S: usize> {
    k: [PointOf<P>; S],
    z: PointOf<P>,
    field: P::Work,
}

impl<P: Ambient, const S: usize> Method<P> for Rk<S> {
    type Work = RkWork<P, S>;

    fn stays_on_manifold(&self) -> bool {
        false
    }
    fn order(&self, _: &P) -> usize {
        self.0.order
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok(RkWork {
            k: core::array::from_fn(|_| like.clone()),
            z: like.clone(),
            field: problem.work(),
        })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { t, h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        RkWork { k, z, field }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (tab, lit) = (&self.0, ScalarOf::<P>::lit);
        let sum = |z: &mut PointOf<P>, weights: &[f64], k: &[PointOf<P>]| {
            problem.copy(y, z);
            for (&w, k) in weights.iter().zip(k) {
                if w != 0.0 {
                    problem.add(h * lit(w), k, z);
                }
            }
        };
        for i in 0..S {
            sum(z, &tab.a[i][..i], k);
            problem.field(t + h * lit(tab.c[i]), z, &mut k[i], field);
        }
        sum(z, &tab.b, k);
        if !problem.is_finite(z) {
            return Err(match k.iter().position(|k| !problem.is_finite(k)) {
                Some(stage) => StepError::NonFiniteRhs { stage: stage + 1 },
                None => StepError::NotFinite { what: "the state" },
            });
        }
        core::mem::swap(y, z);
        Ok(())
    }
}
