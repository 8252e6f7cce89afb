//! The maps on the unit quaternions S³.
//!
//! | | |
//! |---|---|
//! | Ψ(u) | the quaternion of the rotation that Ψ is on SO(3) |
//! | dΨ_u⁻¹ | that of SO(3): the covering is a local isomorphism |
//!
//! exp: (cos(α/2), (sin(α/2)/α) u), α = |u|. cay: (1, u/2)/√(1 + α²/4).

use nalgebra::{UnitQuaternion, Vector3};

use super::{Cay, CoordinateMap, Exp};
use crate::error::{Error, StepError};
use crate::groups::UnitQuaternions;
use crate::scalar::{Counted, Ops, tally, tally_by};
use crate::so3;

/// Both maps: Ψ by its quaternion, the rest by so(3).
macro_rules! map {
    ($map:ty, $name:literal, $psi:path, $dpsi_inv:path, |$u:ident| $tally:expr) => {
        impl CoordinateMap<UnitQuaternions> for $map {
            type At = ();

            fn name(&self) -> &'static str {
                $name
            }
            fn at(&self, _: &UnitQuaternions) -> Result<(), Error> {
                Ok(())
            }
            #[inline]
            fn psi(
                &self,
                _: &UnitQuaternions,
                u: &Vector3<f64>,
                _: &mut (),
                q: &mut UnitQuaternion<f64>,
            ) -> Result<(), StepError> {
                let $u = u;
                $tally;
                *q = $psi(u)?;
                Ok(())
            }
            #[inline]
            fn dpsi_inv(
                &self,
                _: &UnitQuaternions,
                u: &Vector3<f64>,
                _: &mut (),
                v: &mut Vector3<f64>,
            ) -> Result<(), StepError> {
                tally_by(|| $dpsi_inv(&u.map(Counted), &v.map(Counted)));
                *v = $dpsi_inv(u, v)?;
                Ok(())
            }
        }
    };
}
map!(Exp, "exp", so3::exp_quaternion, so3::dexpinv, |u| {
    tally_by(|| so3::half_angle(&u.map(Counted)));
    tally(|| Ops::muls(3));
});
// Scaled: four divisions, the norm, four more.
map!(Cay, "cay", so3::cay_quaternion, so3::dcayinv, |_u| {
    tally(|| Ops::divs(8) + Ops::dots(1, 4) + Ops::sqrts(1));
});
