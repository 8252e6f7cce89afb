//! exp on so(3): the formulas are in [`so3`].

use nalgebra::{Matrix3, Vector3};

use super::series::baker;
use super::{Exp, TruncatedExp};
use crate::error::{Error, StepError};
use crate::groups::So3;
use crate::maps::CoordinateMap;
use crate::scalar::Trig;
use crate::so3::cross;
use crate::so3::{self, Angle, rodrigues_on};

impl<S: Trig> CoordinateMap<So3<S>> for Exp {
    type At = Angle<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, _: &So3<S>) -> Result<Angle<S>, Error> {
        Ok(Angle::zero())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut Angle<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        let (angle, exp) = Angle::with_matrix(u);
        *at = angle;
        *g = if angle.in_range() { exp } else { so3::exp_huge(u)? };
        Ok(())
    }
    #[inline(always)] // the largest part of a short step
    fn psi_on(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut Angle<S>,
        _: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let (angle, a, b) = Angle::with_exp(u);
        *at = angle;
        *y = match angle.in_range() {
            true => so3::finite(rodrigues_on(u, a, b, x), "exp(u)·x")?,
            false => so3::exp_huge_on(u, x)?,
        };
        Ok(())
    }
    #[inline(always)]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut Angle<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        *v = match at.in_range() {
            true => so3::finite(rodrigues_on(u, S::lit(-0.5), at.dexpinv_regular()?, v), "dexp⁻¹")?,
            false => so3::dexpinv_huge(u, v)?,
        };
        Ok(())
    }
}

impl<S: Trig> CoordinateMap<So3<S>> for TruncatedExp {
    type At = Angle<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &So3<S>) -> Result<Angle<S>, Error> {
        Exp.at(group)
    }
    #[inline]
    fn psi(
        &self,
        group: &So3<S>,
        u: &Vector3<S>,
        at: &mut Angle<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        Exp.psi(group, u, at, g)
    }
    #[inline]
    fn psi_on(
        &self,
        group: &So3<S>,
        u: &Vector3<S>,
        at: &mut Angle<S>,
        g: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        Exp.psi_on(group, u, at, g, x, y)
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut Angle<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let mut ad = *v;
        for k in 1..=self.q {
            ad = cross(u, &ad);
            let c = S::lit(baker(k));
            if k == 1 || k % 2 == 0 {
                *v = Vector3::new(v[0] + c * ad[0], v[1] + c * ad[1], v[2] + c * ad[2]);
            }
        }
        so3::finite(*v, "dexp⁻¹").map(drop)
    }
    fn order(&self, _: &So3<S>) -> usize {
        self.order_kept()
    }
}
