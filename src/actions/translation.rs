//! Translations: M = G, Λ(g, p) = g·p from the left, Λ(g, p) = p·g⁻¹ from the right. One `impl` for every group.

use super::Action;
use crate::error::Error;
use crate::groups::{Adjoint, LieGroup};
use crate::scalar::Real;
use crate::tolerance::Scales;

/// What is the same from both sides: points are elements of G.
macro_rules! on_the_group {
    () => {
        #[inline]
        fn check(&self, group: &G, p: &G::Elem) -> Result<(), Error> {
            group.check_elem(p)
        }
        fn check_member(&self, group: &G, p: &G::Elem) -> Result<(), Error> {
            group.check_member(p)
        }
        #[inline]
        fn error_ratio(
            &self,
            group: &G,
            e: &G::Alg,
            g: &G::Elem,
            scales: &mut Scales<'_>,
        ) -> G::Scalar {
            group.error_ratio(e, g, self.is_right(), scales)
        }
        fn residual_size(&self, group: &G, g: &G::Elem) -> G::Scalar {
            group.residual_size(g)
        }
    };
}

/// G acting on itself from the left: ġ = f(g)·g, equation (12).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftTranslation;

impl LeftTranslation {
    fn is_right(self) -> bool {
        false
    }
}

impl<G: LieGroup> Action<G> for LeftTranslation {
    type Point = G::Elem;
    /// For [`restore`](Action::restore).
    type Work = [G::Elem; 2];

    fn work(&self, group: &G) -> Self::Work {
        [group.identity(), group.identity()]
    }
    on_the_group!();
    #[inline]
    fn act(&self, group: &G, g: &G::Elem, p: &G::Elem, q: &mut G::Elem, _: &mut Self::Work) {
        group.compose(g, p, q);
    }
    #[inline]
    fn generate(&self, group: &G, v: &G::Alg, g: &G::Elem, dg: &mut G::Elem, _: &mut Self::Work) {
        group.tangent(v, g, dg);
    }
    fn restore(&self, group: &G, p: &mut G::Elem, work: &mut Self::Work) -> Option<G::Scalar> {
        Some(group.correct(p, work.each_mut()))
    }
}

/// G acting on itself from the right: Λ(g, p) = p·g⁻¹, so that ġ = −g·f(g).
///
/// A field in the body frame is −f ([`Flow::in_body`](crate::problems::Flow::in_body)): its steps need no Ad_g, and no
/// size of g enters them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RightTranslation;

/// Scratch of [`RightTranslation`].
#[allow(missing_debug_implementations)] // the parts belong to the group
pub struct RightWork<G: Adjoint> {
    inverse: G::Elem,
    inverting: G::Inverting,
    minus: G::Alg,
    /// For [`restore`](Action::restore).
    restore: [G::Elem; 2],
}

impl RightTranslation {
    fn is_right(self) -> bool {
        true
    }
}

impl<G: Adjoint> Action<G> for RightTranslation {
    type Point = G::Elem;
    type Work = RightWork<G>;

    fn work(&self, group: &G) -> RightWork<G> {
        let one = || group.identity();
        let (inverting, minus) = (group.inverting(), group.zero());
        RightWork { inverse: one(), inverting, minus, restore: [one(), one()] }
    }
    on_the_group!();
    #[inline]
    fn act(&self, group: &G, g: &G::Elem, p: &G::Elem, q: &mut G::Elem, work: &mut RightWork<G>) {
        // A singular g is not in G; its numbers are not finite, and the step ends with that.
        let _ = group.invert(g, &mut work.inverting, &mut work.inverse);
        group.compose(p, &work.inverse, q);
    }
    /// −g·v.
    #[inline]
    fn generate(
        &self,
        group: &G,
        v: &G::Alg,
        g: &G::Elem,
        dg: &mut G::Elem,
        RightWork { minus, .. }: &mut RightWork<G>,
    ) {
        group.set_zero(minus);
        group.axpy(G::Scalar::lit(-1.0), v, minus);
        group.tangent_in_body(g, minus, dg);
    }
    fn restore(&self, group: &G, p: &mut G::Elem, work: &mut RightWork<G>) -> Option<G::Scalar> {
        Some(group.correct(p, work.restore.each_mut()))
    }
}

/// A translation whose side is chosen at run time, so that problems in both frames have one type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Translation {
    /// [`LeftTranslation`], of a field in space.
    Left,
    /// [`RightTranslation`], of minus a field in the body.
    Right,
}

impl Translation {
    fn is_right(self) -> bool {
        matches!(self, Translation::Right)
    }
}

impl<G: Adjoint> Action<G> for Translation {
    type Point = G::Elem;
    type Work = RightWork<G>;

    fn work(&self, group: &G) -> RightWork<G> {
        RightTranslation.work(group)
    }
    on_the_group!();
    #[inline]
    fn act(&self, group: &G, g: &G::Elem, p: &G::Elem, q: &mut G::Elem, work: &mut RightWork<G>) {
        match self {
            Translation::Left => group.compose(g, p, q),
            Translation::Right => RightTranslation.act(group, g, p, q, work),
        }
    }
    #[inline]
    fn generate(
        &self,
        group: &G,
        v: &G::Alg,
        g: &G::Elem,
        dg: &mut G::Elem,
        work: &mut RightWork<G>,
    ) {
        match self {
            Translation::Left => group.tangent(v, g, dg),
            Translation::Right => RightTranslation.generate(group, v, g, dg, work),
        }
    }
    fn restore(&self, group: &G, p: &mut G::Elem, work: &mut RightWork<G>) -> Option<G::Scalar> {
        RightTranslation.restore(group, p, work)
    }
}
