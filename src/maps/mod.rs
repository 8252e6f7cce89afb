//! Ψ : 𝔤 → G, the coordinate maps, each with its inverse differential dΨ⁻¹.
//!
//! The differential is right trivialised, as in the paper (8):
//! d/dε Ψ(u + εv)|₀ = dΨ_u(v)·Ψ(u). In robotics' words dexp is the *left* Jacobian.
//!
//! As functions, on a value of any group that has them:
//!
//! | formula | call | on |
//! |---|---|---|
//! | exp(u) | [`exp(&group, &u)`](exp()) | every group |
//! | log(g) | [`log(&group, &g)`](log()) | `So3`, `UnitQuaternions`, `Se3`, `Se23`, `MatrixGroup` |
//! | dexp_u(v) | [`dexp(&group, &u, &v)`](dexp()) | `So3`, `UnitQuaternions`, `Se3`, `Se23`, `MatrixGroup`, `Unitary` |
//! | dexp_u⁻¹(v) | [`dexpinv(&group, &u, &v)`](dexpinv()) | every group |
//! | dexp_u⁻¹(v), cut after q brackets | [`dexpinv_truncated(&group, &u, &v, q)`](dexpinv_truncated()) | `MatrixGroup` |
//! | cay(u) | [`cay(&group, &u)`](cay()) | every group |
//! | cay⁻¹(g) | [`cay_inv(&group, &g)`](cay_inv()) | `So3`, `MatrixGroup` |
//! | dcay_u(v) | [`dcay(&group, &u, &v)`](dcay()) | `So3`, `MatrixGroup` |
//! | dcay_u⁻¹(v) | [`dcayinv(&group, &u, &v)`](dcayinv()) | every group |
//!
//! On rotations in space [`so3`](crate::so3) has the same functions without the group, `so3::exp(&u)`, and
//! [`so3::batch`](crate::so3::batch) has them on arrays. In a loop, [`CoordinateMap`] keeps its storage.
//!
//! To add a map: one file with an `impl` of [`CoordinateMap`] per layer (the general one over any
//! n, and the closed form), one line here, its registration in the catalog, one line in the law
//! tests.

mod alternating;
mod cay;
mod ccsk;
mod exp;
mod functions;
#[cfg(feature = "dense")]
mod log;
mod named;
mod pade22;
mod parts;
mod quaternions;
#[cfg(feature = "dense")]
mod quotient;
mod se3;
mod translations;
#[cfg(feature = "dense")]
mod unitary;

pub use alternating::{Alternating, CCSK};
pub use cay::{Cay, cay_inv, dcay};
pub use ccsk::{CCSK123, CCSK321, Ccsk};
#[cfg(feature = "dense")]
pub use exp::{BakerSum, Dexpinv, dexpinv_truncated, dexpinv_with_remainder, distance_to_singular};
pub use exp::{Exp, TruncatedExp};
pub use functions::{
    cay, dcayinv, dexp, dexpinv, exp, left_jacobian_inv_se3, left_jacobian_inv_se23,
    left_jacobian_se3, left_jacobian_se23, log,
};
pub use named::{AllMaps, ExpOrCay, Groups, MAPS, MapInfo, MapsByName, NamedMap};
#[cfg(feature = "dense")]
pub(crate) use named::{EXPECTED_Q, FromName, Serves};
pub use pade22::Pade22;
pub use parts::{Each, Pair};

use crate::error::{Error, StepError};
use crate::groups::LieGroup;

/// A coordinate map Ψ with Ψ(0) = 𝟙 and Ψ'(0) = id, together with dΨ⁻¹ (right trivialised).
pub trait CoordinateMap<G: LieGroup>: Send + Sync {
    /// The values that Ψ stores at u, so that dΨ_u⁻¹ costs little more ("Both" in Table 2), and the workspace.
    type At: Send;

    /// The name of the map, as in scene files.
    fn name(&self) -> &'static str;

    /// Storage for [`At`](Self::At); the only call that allocates.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when the map has no formula on this group.
    fn at(&self, group: &G) -> Result<Self::At, Error>;

    /// Step number `n` of a run begins: a map that differs from step to step chooses here.
    #[inline]
    fn begin_step(&self, _at: &mut Self::At, _n: u64) {}

    /// g ← Ψ(u), remembering in `at` what dΨ_u⁻¹ shares with it.
    ///
    /// # Errors
    /// A [`StepError`] when u lies outside the map's domain or the range of the arithmetic.
    fn psi(
        &self,
        group: &G,
        u: &G::Alg,
        at: &mut Self::At,
        g: &mut G::Elem,
    ) -> Result<(), StepError>;

    /// y ← Ψ(u)·x, by a shorter way than forming Ψ(u) where the map has one. `g` is scratch.
    ///
    /// # Errors
    /// As [`psi`](Self::psi).
    #[inline]
    fn psi_on(
        &self,
        group: &G,
        u: &G::Alg,
        at: &mut Self::At,
        g: &mut G::Elem,
        x: &G::Vector,
        y: &mut G::Vector,
    ) -> Result<(), StepError> {
        self.psi(group, u, at, g)?;
        group.apply(g, x, y);
        StepError::finite(group.is_finite_vector(y), "Ψ(u)·x")
    }

    /// v ← dΨ_u⁻¹ v, at the u of the last [`psi`](Self::psi) or [`psi_on`](Self::psi_on) on `at`.
    ///
    /// # Errors
    /// [`StepError::OutsideChart`] near a singularity of dΨ.
    fn dpsi_inv(
        &self,
        group: &G,
        u: &G::Alg,
        at: &mut Self::At,
        v: &mut G::Alg,
    ) -> Result<(), StepError>;

    /// The highest order that a method can have with the dΨ⁻¹ of this map. It is `usize::MAX` if dΨ⁻¹ is exact.
    fn order(&self, _group: &G) -> usize {
        usize::MAX
    }

    /// Ψ(u) on its own, with fresh storage.
    ///
    /// # Errors
    /// As [`LieAlgebra::check_shape`](crate::LieAlgebra::check_shape), [`at`](Self::at) and [`psi`](Self::psi).
    fn eval(&self, group: &G, u: &G::Alg) -> Result<G::Elem, Error> {
        group.check_shape("u", u)?;
        let (mut at, mut g) = (self.at(group)?, group.identity());
        self.psi(group, u, &mut at, &mut g)?;
        Ok(g)
    }

    /// dΨ_u⁻¹ v on its own, with fresh storage.
    ///
    /// # Errors
    /// As [`eval`](Self::eval) and [`dpsi_inv`](Self::dpsi_inv).
    fn eval_dpsi_inv(&self, group: &G, u: &G::Alg, v: &G::Alg) -> Result<G::Alg, Error> {
        group.check_shape("u", u)?;
        group.check_shape("v", v)?;
        let (mut at, mut g, mut v) = (self.at(group)?, group.identity(), v.clone());
        self.psi(group, u, &mut at, &mut g)?;
        self.dpsi_inv(group, u, &mut at, &mut v)?;
        Ok(v)
    }
}

/// Ψ(u), not yet formed: an action on vectors never forms it.
#[derive(Debug)]
pub struct PsiOf<'a, G: LieGroup, Psi: CoordinateMap<G>> {
    group: &'a G,
    psi: &'a Psi,
    u: &'a G::Alg,
    at: &'a mut Psi::At,
    g: &'a mut G::Elem,
}

impl<'a, G: LieGroup, Psi: CoordinateMap<G>> PsiOf<'a, G, Psi> {
    /// Ψ(u) with the storage that forming it needs.
    #[inline(always)]
    pub(crate) fn new(
        group: &'a G,
        psi: &'a Psi,
        u: &'a G::Alg,
        at: &'a mut Psi::At,
        g: &'a mut G::Elem,
    ) -> Self {
        PsiOf { group, psi, u, at, g }
    }

    /// The group, and Ψ(u) as an element of it.
    ///
    /// # Errors
    /// As [`CoordinateMap::psi`].
    #[inline(always)]
    pub fn form(self) -> Result<(&'a G, &'a G::Elem), StepError> {
        self.psi.psi(self.group, self.u, self.at, self.g)?;
        Ok((self.group, self.g))
    }

    /// y ← Ψ(u)·x.
    ///
    /// # Errors
    /// As [`CoordinateMap::psi_on`].
    #[inline(always)]
    pub fn on(self, x: &G::Vector, y: &mut G::Vector) -> Result<(), StepError> {
        self.psi.psi_on(self.group, self.u, self.at, self.g, x, y)
    }
}
