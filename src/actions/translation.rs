//! Left translation: M = G, Λ(g, p) = g·p. One `impl` for every group.

use super::Action;
use crate::error::Error;
use crate::groups::LieGroup;
use crate::tolerance::Scales;

/// G acting on itself from the left: ġ = f(g)·g, equation (12).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftTranslation;

impl<G: LieGroup> Action<G> for LeftTranslation {
    type Point = G::Elem;
    /// For [`restore`](Action::restore).
    type Work = [G::Elem; 2];

    fn work(&self, group: &G) -> Self::Work {
        [group.identity(), group.identity()]
    }
    #[inline]
    fn check(&self, group: &G, p: &G::Elem) -> Result<(), Error> {
        group.check_elem(p)
    }
    fn check_member(&self, group: &G, p: &G::Elem) -> Result<(), Error> {
        group.check_member(p)
    }
    fn assign(&self, group: &G, p: &G::Elem, q: &mut G::Elem) {
        group.assign(p, q);
    }
    #[inline]
    fn act(&self, group: &G, g: &G::Elem, p: &G::Elem, q: &mut G::Elem, _: &mut Self::Work) {
        group.compose(g, p, q);
    }
    #[inline]
    fn generate(&self, group: &G, v: &G::Alg, g: &G::Elem, dg: &mut G::Elem, _: &mut Self::Work) {
        group.tangent(v, g, dg);
    }
    #[inline]
    fn error_ratio(
        &self,
        group: &G,
        e: &G::Alg,
        g: &G::Elem,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        group.error_ratio(e, g, scales)
    }
    fn restore(&self, group: &G, p: &mut G::Elem, work: &mut Self::Work) -> Option<G::Scalar> {
        Some(group.correct(p, work.each_mut()))
    }
}
