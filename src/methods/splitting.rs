//! Splitting into exact flows, after McLachlan and Reich.
//!
//! F = F₁ + … + F_K with exact flows φᵏ. The symmetric step of order 2 is
//! S_h = φ¹_{h/2} ∘ … ∘ φᴷ⁻¹_{h/2} ∘ φᴷ_h ∘ φᴷ⁻¹_{h/2} ∘ … ∘ φ¹_{h/2}, in any order of the parts. A
//! [`Scheme`] composes it to higher order. Neighbouring flows of one part are joined.
//!
//! For the free rigid body the parts are rotations about the principal axes, θ = t m_k/J_k,
//! m ← R_k(θ)ᵀm, g ← g R_k(θ). Order: that of the scheme. Preserves: |m| and the group to rounding, the symplectic
//! structure, time symmetry; the energy error stays bounded at the order of h. Cost with S stages:
//! 4S + 1 flows, each one sine-cosine pair and one plane rotation (mr2: 5, mr4: 13).
//! Source: R. McLachlan, Phys. Rev. Lett. 71 (1993); S. Reich, Fields Inst. Commun. 10 (1996).

use super::{Facts, MapCounts, Method, STRANG, Scheme, Step, Symmetric, YOSHIDA4};
use crate::error::{Error, StepError};
use crate::problems::{PointOf, ScalarOf, Split};
use crate::scalar::Real;
use crate::space::{LinearSpace, Metric};

/// A symmetric splitting method over K parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splitting<const K: usize> {
    parts: [usize; K],
    scheme: Scheme,
}

/// McLachlan–Reich of order 2, ordering 123.
pub const MR2: Splitting<3> = Splitting::new([0, 1, 2], STRANG);
/// McLachlan–Reich of order 4 by the triple jump, ordering 123: the MR of the paper.
pub const MR4: Splitting<3> = Splitting::new([0, 1, 2], YOSHIDA4);

impl<const K: usize> Splitting<K> {
    /// Sets the order of the parts, which are numbered from 0. The first is outermost and is halved.
    pub const fn new(parts: [usize; K], scheme: Scheme) -> Self {
        Splitting { parts, scheme }
    }
}

impl<const K: usize> Symmetric for Splitting<K> {}

impl<P: Split, const K: usize> Method<P> for Splitting<K> {
    /// The state before the step.
    type Work = PointOf<P>;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(self.scheme.order).cost(None, MapCounts::default())
    }
    /// Also [`Error::Unsupported`] unless the ordering names each part of the problem once.
    fn work(&self, _: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let each_once = K == P::PARTS && (0..K).all(|part| self.parts.contains(&part));
        match each_once && K > 0 {
            true => Ok(like.clone()),
            false => Err(Error::Unsupported {
                what: "this ordering",
                with: format!("a splitting into {} parts", P::PARTS),
                why: "name each part once, from 0",
            }),
        }
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        before: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let lit = ScalarOf::<P>::lit;
        let [outer, inner @ ..] = self.parts.as_slice() else { return Ok(()) };
        before.assign(y);
        let mut flow = |part: usize, weight: f64| problem.flow(part, h * lit(weight), y);
        let Some((last, middle)) = inner.split_last() else {
            self.scheme.weights.iter().for_each(|&w| flow(*outer, w));
            return finish::<P>(before, y);
        };
        let mut pending = 0.0; // of the outermost part
        for &w in self.scheme.weights {
            flow(*outer, pending + 0.5 * w);
            middle.iter().for_each(|&part| flow(part, 0.5 * w));
            flow(*last, w);
            middle.iter().rev().for_each(|&part| flow(part, 0.5 * w));
            pending = 0.5 * w;
        }
        flow(*outer, pending);
        finish::<P>(before, y)
    }
}

#[inline]
fn finish<P: Split>(before: &PointOf<P>, y: &mut PointOf<P>) -> Result<(), StepError> {
    if !y.is_finite() {
        y.assign(before);
        return Err(StepError::NotFinite { what: "the state" });
    }
    Ok(())
}
