//! The linear action on vectors: M = ℝⁿ (or k vectors as columns), Λ(g, x) = g·x.
//!
//! There is one `impl` for all groups. Ψ(u) is applied without forming it, if the map has a formula for that.

use super::Action;
use crate::error::{Error, StepError};
use crate::groups::LieGroup;
use crate::maps::CoordinateMap;
use crate::maps::PsiOf;
use crate::tolerance::Scales;

/// The standard representation: ẋ = f(x)·x.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Linear;

impl<G: LieGroup> Action<G> for Linear {
    type Point = G::Vector;
    type Work = ();

    fn work(&self, _: &G) {}
    #[inline]
    fn check(&self, group: &G, p: &G::Vector) -> Result<(), Error> {
        group.check_vector(p)
    }
    #[inline]
    fn act(&self, group: &G, g: &G::Elem, p: &G::Vector, q: &mut G::Vector, _: &mut ()) {
        group.apply(g, p, q);
    }
    #[inline]
    fn generate(&self, group: &G, v: &G::Alg, x: &G::Vector, dx: &mut G::Vector, _: &mut ()) {
        group.apply_algebra(v, x, dx);
    }
    #[inline]
    fn error_ratio(
        &self,
        group: &G,
        e: &G::Alg,
        x: &G::Vector,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        group.vector_error_ratio(e, x, scales)
    }
    #[inline(always)]
    fn lambda<Psi: CoordinateMap<G>>(
        &self,
        psi_u: PsiOf<'_, G, Psi>,
        p: &G::Vector,
        q: &mut G::Vector,
        _: &mut (),
    ) -> Result<(), StepError> {
        psi_u.on(p, q)
    }
    #[inline]
    fn restore_to(
        &self,
        group: &G,
        from: &G::Vector,
        p: &mut G::Vector,
        _: &mut (),
    ) -> Option<G::Scalar> {
        group.correct_vector(from, p)
    }
}
