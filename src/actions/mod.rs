//! Λ : G × M → M, the group actions.
//!
//! To add an action: one file with an `impl` of [`Action`], one line here, one in the law tests.

mod coadjoint;
mod conjugation;
mod lagrangian;
mod linear;
mod parts;
mod translation;
mod unitary;

pub use coadjoint::Coadjoint;
pub use conjugation::Conjugation;
pub use lagrangian::Lagrangian;
pub use linear::Linear;
pub use parts::{Each, Pair};
pub use translation::LeftTranslation;

use crate::error::{Error, StepError};
use crate::groups::LieGroup;
use crate::maps::CoordinateMap;
use crate::maps::PsiOf;
use crate::space::{Gap, Metric};
use crate::tolerance::Scales;

/// A left action Λ of G on M: Λ(𝟙, p) = p and Λ(ab, p) = Λ(a, Λ(b, p)).
pub trait Action<G: LieGroup> {
    /// A point y ∈ M.
    type Point: Metric<Scalar = G::Scalar> + Clone;
    /// Scratch.
    type Work;

    /// Scratch for [`act`](Self::act); the only call that allocates.
    fn work(&self, group: &G) -> Self::Work;

    /// Has p the size that `group` acts on, and are its numbers finite? Asked before a run.
    ///
    /// # Errors
    /// [`Error::Shape`] with both sizes, [`Error::NotFiniteEntry`].
    fn check(&self, _group: &G, _p: &Self::Point) -> Result<(), Error> {
        Ok(())
    }

    /// Are the numbers of p finite? Asked after every step of a run, so that a state that leaves the range of
    /// the arithmetic ends it. The default is [`check`](Self::check).
    #[inline]
    fn is_finite(&self, group: &G, p: &Self::Point) -> bool {
        self.check(group, p).is_ok()
    }

    /// q ← p, into the storage that there is. The default is `clone_from`, which allocates for storage
    /// that does not know better; the driver copies where it takes a step aside.
    #[inline]
    fn assign(&self, _group: &G, p: &Self::Point, q: &mut Self::Point) {
        q.clone_from(p);
    }

    /// q ← Λ(g, p).
    fn act(
        &self,
        group: &G,
        g: &G::Elem,
        p: &Self::Point,
        q: &mut Self::Point,
        work: &mut Self::Work,
    );

    /// dy ← λ_*(v)(y) = d/dε Λ(Ψ(εv), y) at ε = 0, equation (13): the velocity that v gives to y, a
    /// tangent of M in the storage of a point.
    fn generate(
        &self,
        group: &G,
        v: &G::Alg,
        y: &Self::Point,
        dy: &mut Self::Point,
        work: &mut Self::Work,
    );

    /// An error e ∈ 𝔤 at y in units of the tolerance, the largest of the ratios of the parts. The default takes
    /// ‖e‖ for relative: ‖e‖‖y‖/(atol + rtol·‖y‖).
    #[inline]
    fn error_ratio(
        &self,
        group: &G,
        e: &G::Alg,
        y: &Self::Point,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        y.error_ratio(Gap::Relative(group.norm(e)), scales)
    }

    /// q ← λ_p(u) = Λ(Ψ(u), p), equation (6). Ψ(u) arrives not yet formed: an action on vectors
    /// answers with [`PsiOf::on`], and then no group element is formed.
    ///
    /// # Errors
    /// As [`CoordinateMap::psi`].
    #[inline]
    fn lambda<Psi: CoordinateMap<G>>(
        &self,
        psi_u: PsiOf<'_, G, Psi>,
        p: &Self::Point,
        q: &mut Self::Point,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (group, g) = psi_u.form()?;
        self.act(group, g, p, q, work);
        Ok(())
    }

    /// Take p back to M, where rounding carried it off over many steps; the driver does so every
    /// [`RESTORE_EVERY`](crate::RESTORE_EVERY) steps or sooner. Returns how far p was, `None` where nothing is
    /// done, which is the default. Left translation corrects by [`LieGroup::correct`].
    #[inline]
    fn restore(
        &self,
        _group: &G,
        _p: &mut Self::Point,
        _work: &mut Self::Work,
    ) -> Option<G::Scalar> {
        None
    }

    /// Take p back to M, and to the orbit of `from`, which a run that starts there never leaves: |x| of a
    /// vector under SO(3). The driver calls this; the default is [`restore`](Self::restore).
    #[inline]
    fn restore_to(
        &self,
        group: &G,
        _from: &Self::Point,
        p: &mut Self::Point,
        work: &mut Self::Work,
    ) -> Option<G::Scalar> {
        self.restore(group, p, work)
    }
}
