//! Ψ = cay, the Cayley map (paper 4.3), on any matrix group.
//!
//! | | cay(u) | dcay_u⁻¹ v |
//! |---|---|---|
//! | any n | (𝟙 − u/2)⁻¹(𝟙 + u/2) | (𝟙 − u/2) v (𝟙 + u/2) |
//! | so(3) | 𝟙 + (u + u²/2)/(1 + α²/4) | ((1 + α²/4)𝟙 − u/2 + u²/4) v = v + ¼(u·v)u − ½ u×v |
//!
//! The factor ½ makes dcay_0 the identity. cay maps 𝔤_M into G_M for every M, since
//! r(z) = (1 + z/2)/(1 − z/2) has r(z)r(−z) = 1 (Celledoni & Iserles).

#[cfg(feature = "dense")]
mod general;

use nalgebra::{Matrix3, Vector3};

use super::CoordinateMap;
use crate::error::{Error, StepError};
use crate::groups::{LieGroup, So3};
use crate::scalar::Real;
use crate::so3;

/// The Cayley map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cay;

impl<S: Real> CoordinateMap<So3<S>> for Cay {
    type At = ();

    fn name(&self) -> &'static str {
        "cay"
    }
    fn at(&self, _: &So3<S>) -> Result<(), Error> {
        Ok(())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        *g = so3::cay(u)?;
        Ok(())
    }
    #[inline(always)] // the largest part of a short step
    fn psi_on(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        _: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        *y = match so3::cay_on(u, x) {
            Some(y) => so3::finite(y, "cay(u)·x")?,
            None => so3::cay_huge_on(u, x)?,
        };
        Ok(())
    }
    #[inline(always)]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        *v = so3::finite(so3::dcayinv_of(u, v), "dcay⁻¹")?;
        Ok(())
    }
}

/// A group on which cay has an inverse and a differential in closed form.
pub trait CayleyGroup: LieGroup {
    /// [`cay_inv`] on this group.
    ///
    /// # Errors
    /// As [`cay_inv`].
    fn cay_inv(&self, g: &Self::Elem) -> Result<Self::Alg, Error>;
    /// [`dcay`] on this group.
    ///
    /// # Errors
    /// As [`dcay`].
    fn dcay(&self, u: &Self::Alg, v: &Self::Alg) -> Result<Self::Alg, Error>;
}

/// u with cay(u) = g: u = 2(g − 𝟙)(g + 𝟙)⁻¹. Fresh storage; O(n³).
///
/// # Errors
/// [`Error::Singular`] where −1 is an eigenvalue of g, a rotation by π: it is not in the image.
///
/// ```
/// use lieflow::CoordinateMap;
/// use lieflow::groups::So3;
/// use lieflow::maps::{Cay, cay_inv};
/// use lieflow::nalgebra::{Matrix3, Vector3};
/// let so3 = So3::new();
/// let u = Vector3::new(0.3, -0.4, 1.2);
/// assert!((cay_inv(&so3, &Cay.eval(&so3, &u)?)? - u).norm() < 1e-15);
/// assert!(cay_inv(&so3, &Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))).is_err());
/// # Ok::<(), lieflow::Error>(())
/// ```
pub fn cay_inv<G: CayleyGroup>(group: &G, g: &G::Elem) -> Result<G::Alg, Error> {
    group.cay_inv(g)
}

/// dcay_u v = (𝟙 − u/2)⁻¹ v (𝟙 + u/2)⁻¹, right trivialised: d/dε cay(u + εv)|₀ = dcay_u(v)·cay(u).
/// Fresh storage; O(n³).
///
/// # Errors
/// [`Error::Map`] where 𝟙 − u/2 or 𝟙 + u/2 is singular, and when numbers leave the range.
pub fn dcay<G: CayleyGroup>(group: &G, u: &G::Alg, v: &G::Alg) -> Result<G::Alg, Error> {
    group.dcay(u, v)
}

impl CayleyGroup for So3<f64> {
    fn cay_inv(&self, g: &Matrix3<f64>) -> Result<Vector3<f64>, Error> {
        so3::cay_inv(g)
    }
    fn dcay(&self, u: &Vector3<f64>, v: &Vector3<f64>) -> Result<Vector3<f64>, Error> {
        Ok(so3::dcay(u, v)?)
    }
}
