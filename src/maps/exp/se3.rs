//! exp on SE(3). With J = dexp_ω of so(3), its left Jacobian:
//!
//! | | |
//! |---|---|
//! | exp(ω, v) | (exp ω, J v) |
//! | dexp⁻¹ (a, b) | (J⁻¹a, J⁻¹b + D a) |
//! | dexp (a, b) | (J a, J b + E a) |
//! | E a = d/dε dexp_{ω+εv} a | β v×a + δ (v×(ω×a) + ω×(v×a)) + 2(ω·v)(β′ ω×a + δ′ ω×(ω×a)) |
//! | D a = d/dε dexp⁻¹_{ω+εv} a | −½ v×a + c (v×(ω×a) + ω×(v×a)) + 2c′ (ω·v) ω×(ω×a) |
//!
//! c = (1 − (α/2)cot(α/2))/α² as in (16), β = (1 − cos α)/α², δ = (α − sin α)/α³, and ′ is d/dα². For ad_{(ω, v)} = \[ω̂ 0; v̂ ω̂\], and a power
//! series in such a matrix has its own derivative in the direction v as its lower left block.

use nalgebra::{Matrix3, Vector3};

use super::series::baker;
use super::{Exp, TruncatedExp};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, Se3, finite_pair};
use crate::maps::CoordinateMap;
use crate::scalar::Trig;
use crate::so3::{self, Angle, rodrigues, rodrigues_on};
use crate::so3::{add3, cross};

type Twist<S> = (Vector3<S>, Vector3<S>);
type BodyMotion<S> = (Matrix3<S>, Vector3<S>);

impl<S: Trig> CoordinateMap<Se3<S>> for Exp {
    type At = Angle<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, _: &Se3<S>) -> Result<Angle<S>, Error> {
        Ok(Angle::zero())
    }
    #[inline]
    fn psi(
        &self,
        _: &Se3<S>,
        (omega, v): &Twist<S>,
        at: &mut Angle<S>,
        g: &mut BodyMotion<S>,
    ) -> Result<(), StepError> {
        let (angle, a, b) = Angle::with_exp(omega);
        *at = angle;
        if angle.in_range() {
            let (b_of_j, d) = angle.dexp_coefficients();
            *g = (rodrigues(omega, a, b), rodrigues_on(omega, b_of_j, d, v));
        } else {
            *g = (so3::exp_huge(omega)?, so3::dexp(omega, v)?);
        }
        match g.1.iter().all(|x| x.is_finite()) {
            true => Ok(()),
            false => Err(StepError::NotFinite { what: "exp(u)" }),
        }
    }
    /// Refused for α² ≥ 1e300, where squares leave the range.
    #[inline]
    fn dpsi_inv(
        &self,
        _: &Se3<S>,
        (omega, v): &Twist<S>,
        at: &mut Angle<S>,
        (a, b): &mut Twist<S>,
    ) -> Result<(), StepError> {
        if !at.in_range() {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        let l = S::lit;
        let (c, slope) = (at.dexpinv_regular()?, at.dexpinv_slope());
        let (wa, va) = (cross(omega, a), cross(v, a));
        let (wwa, mixed) = (cross(omega, &wa), add3(&cross(v, &wa), &cross(omega, &va)));
        let turn = l(2.0) * slope * (omega[0] * v[0] + omega[1] * v[1] + omega[2] * v[2]);
        let moved = rodrigues_on(omega, l(-0.5), c, b);
        *b = Vector3::from_fn(|i, _| moved[i] - l(0.5) * va[i] + c * mixed[i] + turn * wwa[i]);
        *a = Vector3::from_fn(|i, _| a[i] - l(0.5) * wa[i] + c * wwa[i]);
        finite_pair(&(*a, *b), "dexp⁻¹")
    }
}

/// dexp_u w for u = (ω, v), w = (a, b). Refused for α² ≥ 1e300, where squares leave the range.
pub(crate) fn dexp<S: Trig>(
    (omega, v): &Twist<S>,
    (a, b): &Twist<S>,
) -> Result<Twist<S>, StepError> {
    let (angle, _, _) = Angle::with_exp(omega);
    if !angle.in_range() {
        return Err(StepError::NormTooLarge { map: "exp" });
    }
    let ((beta, delta), (slope_beta, slope_delta)) =
        (angle.dexp_coefficients(), angle.dexp_slopes());
    let (wa, va) = (cross(omega, a), cross(v, a));
    let (wwa, mixed) = (cross(omega, &wa), add3(&cross(v, &wa), &cross(omega, &va)));
    let turn = S::lit(2.0) * (omega[0] * v[0] + omega[1] * v[1] + omega[2] * v[2]);
    let (first, second) = (turn * slope_beta, turn * slope_delta);
    let moved = rodrigues_on(omega, beta, delta, b);
    let moved = Vector3::from_fn(|i, _| {
        moved[i] + beta * va[i] + delta * mixed[i] + first * wa[i] + second * wwa[i]
    });
    let w = (rodrigues_on(omega, beta, delta, a), moved);
    finite_pair(&w, "dexp").map(|()| w)
}

impl<S: Trig> CoordinateMap<Se3<S>> for TruncatedExp {
    type At = Angle<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &Se3<S>) -> Result<Angle<S>, Error> {
        Exp.at(group)
    }
    #[inline]
    fn psi(
        &self,
        group: &Se3<S>,
        u: &Twist<S>,
        at: &mut Angle<S>,
        g: &mut BodyMotion<S>,
    ) -> Result<(), StepError> {
        Exp.psi(group, u, at, g)
    }
    #[inline]
    fn dpsi_inv(
        &self,
        group: &Se3<S>,
        u: &Twist<S>,
        _: &mut Angle<S>,
        v: &mut Twist<S>,
    ) -> Result<(), StepError> {
        let mut ad = *v;
        for k in 1..=self.q {
            let last = ad;
            group.bracket(u, &last, &mut ad);
            if k == 1 || k % 2 == 0 {
                group.axpy(S::lit(baker(k)), &ad, v);
            }
        }
        finite_pair(v, "dexp⁻¹")
    }
    fn order(&self, _: &Se3<S>) -> usize {
        self.order_kept()
    }
}
