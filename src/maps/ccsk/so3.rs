//! ccsk on so(3), closed form: any of the six orderings. The formulas are in [`crate::so3`].

use nalgebra::{Matrix3, Vector3};

use super::{Ccsk, NAMES};
use crate::error::{Error, StepError};
use crate::groups::So3;
use crate::maps::CoordinateMap;
use crate::scalar::Trig;
use crate::so3::{self, Angles, ccsk_of, dccskinv_of};

impl<S: Trig, const I: usize, const J: usize, const K: usize> CoordinateMap<So3<S>>
    for Ccsk<I, J, K>
{
    type At = Angles<S>;

    fn name(&self) -> &'static str {
        NAMES[I][J][K]
    }
    fn at(&self, _: &So3<S>) -> Result<Angles<S>, Error> {
        Ok(Angles::zero())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut Angles<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        StepError::finite((u[0].abs() + u[1].abs() + u[2].abs()).is_finite(), "u in ccsk(u)")?;
        *at = ccsk_of::<S, I, J, K>(u, g);
        Ok(())
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        _: &Vector3<S>,
        at: &mut Angles<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        dccskinv_of::<S, I, J, K>(at, self.min_cos, v)?;
        so3::finite(*v, "dccsk⁻¹").map(drop)
    }
}
