//! Group actions Λ : G × M → M.
//!
//! To add an action: one file with an `impl` of [`Action`], one line here, one in the law tests.

mod coadjoint;
#[cfg(feature = "dense")]
mod conjugation;
#[cfg(feature = "dense")]
mod lagrangian;
mod linear;
mod parts;
mod translation;
#[cfg(feature = "dense")]
mod unitary;

pub use coadjoint::Coadjoint;
#[cfg(feature = "dense")]
pub use conjugation::Conjugation;
#[cfg(feature = "dense")]
pub use lagrangian::Lagrangian;
pub use linear::Linear;
pub use parts::{Each, Pair};
#[doc(hidden)]
pub use translation::RightWork;
pub use translation::{LeftTranslation, RightTranslation, Translation};

use crate::error::{Error, StepError};
use crate::groups::LieGroup;
use crate::maps::CoordinateMap;
use crate::maps::PsiOf;
use crate::scalar::{Real, infinite_or_nan};
use crate::space::{Gap, Metric};
use crate::tolerance::Scales;

/// A left action Λ of G on M: Λ(𝟙, p) = p and Λ(ab, p) = Λ(a, Λ(b, p)).
pub trait Action<G: LieGroup>: Send + Sync {
    /// A point y ∈ M.
    type Point: Metric<Scalar = G::Scalar> + Clone;
    /// Scratch.
    type Work: Send;

    /// Makes the scratch for [`act`](Self::act). Only this call allocates.
    fn work(&self, group: &G) -> Self::Work;

    /// Checks before a run that p has the size that `group` acts on, and finite numbers. The default checks that ‖p‖² is
    /// finite, so ‖p‖ has to be below 1e154.
    ///
    /// # Errors
    /// [`Error::Shape`] with both sizes, [`Error::NotFiniteEntry`].
    #[inline]
    fn check(&self, _group: &G, p: &Self::Point) -> Result<(), Error> {
        let size = p.size();
        let square = size * size;
        let expected = "finite numbers, and ‖y‖ below 1e154";
        match square.is_finite() {
            true => Ok(()),
            false => Err(Error::out_of_range("y", infinite_or_nan(square), expected)),
        }
    }

    /// Checks, at the start of a run, what [`restore`](Self::restore) does not see ([`LieGroup::check_member`]).
    ///
    /// # Errors
    /// As [`LieGroup::check_member`].
    fn check_member(&self, _group: &G, _p: &Self::Point) -> Result<(), Error> {
        Ok(())
    }

    /// Checks after every step that the numbers of p are finite. A state that overflows ends the run. The default is
    /// [`check`](Self::check).
    #[inline(always)]
    fn is_finite(&self, group: &G, p: &Self::Point) -> bool {
        self.check(group, p).is_ok()
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

    /// dy ← λ_*(v)(y) = d/dε Λ(Ψ(εv), y) at ε = 0, equation (13): the velocity of y by v, a
    /// tangent of M in the storage of a point.
    fn generate(
        &self,
        group: &G,
        v: &G::Alg,
        y: &Self::Point,
        dy: &mut Self::Point,
        work: &mut Self::Work,
    );

    /// An error e ∈ 𝔤 at y in units of the tolerance: the largest of the ratios of the parts. By default ‖e‖ is a
    /// relative error: ‖e‖‖y‖/(atol + rtol·‖y‖). That is right where λ_*(e) moves each part of y by at most ‖e‖ times its
    /// size; an action that moves a part by the size of another one has a formula of its own.
    #[inline]
    fn error_ratio(
        &self,
        group: &G,
        e: &G::Alg,
        y: &Self::Point,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        y.error_ratio(Gap::relative(group.norm(e)), scales)
    }

    /// An error e ∈ 𝔤 of a step from y to z in units of the tolerance. By default the ratio at y. If y is 0 and atol is 0, the
    /// ratio at z.
    #[inline]
    fn error_ratio_of_step(
        &self,
        group: &G,
        e: &G::Alg,
        [y, z]: [&Self::Point; 2],
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        let start = scales.clone();
        let ratio = self.error_ratio(group, e, y, scales);
        if ratio.is_finite() {
            return ratio;
        }
        *scales = start;
        self.error_ratio(group, e, z, scales)
    }

    /// q ← λ_p(u) = Λ(Ψ(u), p), equation (6).
    ///
    /// The argument `psi_u` has u, and Ψ(u) is not yet computed. An action on vectors calls [`PsiOf::on`], which needs no
    /// group element.
    ///
    /// # Errors
    /// As [`CoordinateMap::psi`].
    #[inline(always)]
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

    /// Moves p back to M, from where rounding errors moved it over many steps.
    ///
    /// The driver calls it every [`RESTORE_EVERY`](crate::RESTORE_EVERY) steps or more often. Returns the distance that p
    /// had. The default does nothing and returns `None`. Left translation corrects by [`LieGroup::correct`].
    #[inline]
    fn restore(
        &self,
        _group: &G,
        _p: &mut Self::Point,
        _work: &mut Self::Work,
    ) -> Option<G::Scalar> {
        None
    }

    /// The size that a residual of p is relative to ([`LieGroup::residual_size`]): 1 where rounding does not grow with p.
    #[inline]
    fn residual_size(&self, _group: &G, _p: &Self::Point) -> G::Scalar {
        G::Scalar::lit(1.0)
    }

    /// Moves p back to M and to the orbit of `from`, the start of the run.
    ///
    /// Example: |x| of a vector under SO(3) is constant. The driver calls this; the default is
    /// [`restore`](Self::restore).
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
