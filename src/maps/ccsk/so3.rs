//! ccsk on so(3), closed form: any of the six orderings.

use nalgebra::{Matrix3, Vector3};

use super::{Ccsk, GIMBAL, NAMES};
use crate::error::{Error, StepError};
use crate::groups::So3;
use crate::maps::CoordinateMap;
use crate::scalar::Trig;

/// (sin, cos) of the first and of the second angle.
#[derive(Clone, Copy, Debug)]
pub struct At3<S> {
    one: (S, S),
    two: (S, S),
}

impl<S: Trig, const I: usize, const J: usize, const K: usize> CoordinateMap<So3<S>>
    for Ccsk<I, J, K>
{
    type At = At3<S>;

    fn name(&self) -> &'static str {
        NAMES[I][J][K]
    }
    fn at(&self, _: &So3<S>) -> Result<At3<S>, Error> {
        let zero = (S::lit(0.0), S::lit(1.0));
        Ok(At3 { one: zero, two: zero })
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        if !(u[0].abs() + u[1].abs() + u[2].abs()).is_finite() {
            return Err(StepError::NotFinite { what: "the argument of ccsk" });
        }
        let sign = Self::signed::<S>;
        let ((s1, c1), (s2, c2)) = (u[I].sin_cos(), u[J].sin_cos());
        let (s3, c3) = sign(u[K]).sin_cos();
        *at = At3 { one: (s1, c1), two: (s2, c2) };
        let (s12, c12) = (s1 * s2, c1 * s2);
        g[(I, I)] = c2 * c3;
        g[(I, J)] = -(c2 * s3);
        g[(I, K)] = sign(s2);
        g[(J, I)] = s12 * c3 + c1 * s3;
        g[(J, J)] = c1 * c3 - s12 * s3;
        g[(J, K)] = sign(-(s1 * c2));
        g[(K, I)] = sign(s1 * s3 - c12 * c3);
        g[(K, J)] = sign(c12 * s3 + s1 * c3);
        g[(K, K)] = c1 * c2;
        Ok(())
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        _: &Vector3<S>,
        at: &mut At3<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let ((s1, c1), (s2, c2)) = (at.one, at.two);
        if c2.abs().any_below(self.min_cos) {
            return Err(GIMBAL);
        }
        let sign = Self::signed::<S>;
        let (v1, v2, v3) = (v[I], v[J], sign(v[K]));
        let w = (c1 * v3 - s1 * v2) / c2;
        v[I] = v1 - s2 * w;
        v[J] = c1 * v2 + s1 * v3;
        v[K] = sign(w);
        Ok(())
    }
}
