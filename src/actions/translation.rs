//! Left translation: M = G, Λ(g, p) = g·p. One `impl` for every group.

use super::Action;
use crate::groups::LieGroup;

/// G acting on itself from the left: ġ = f(g)·g, equation (12).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftTranslation;

impl<G: LieGroup> Action<G> for LeftTranslation {
    type Point = G::Elem;
    type Work = ();

    fn work(&self, _: &G) {}
    #[inline]
    fn act(&self, group: &G, g: &G::Elem, p: &G::Elem, q: &mut G::Elem, _: &mut ()) {
        group.compose(g, p, q);
    }
}
