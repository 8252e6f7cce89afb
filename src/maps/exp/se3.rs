//! exp on SE(3), and on SE₂(3), whose translations are two that do not see each other. With J = dexp_ω of so(3), its left
//! Jacobian:
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
use crate::groups::{LieAlgebra, Se3, Se23, finite_pair, finite_three};
use crate::maps::CoordinateMap;
use crate::scalar::Trig;
use crate::so3::{self, Angle, rodrigues_on};
use crate::so3::{add3, cross};

type Twist<S> = (Vector3<S>, Vector3<S>);
type BodyMotion<S> = (Matrix3<S>, Vector3<S>);
type TwoTwist<S> = (Vector3<S>, Twist<S>);
type ExtendedPose<S> = (Matrix3<S>, Twist<S>);

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
        let (angle, rotation) = Angle::with_matrix(omega);
        *at = angle;
        if angle.in_range() {
            let (b, d) = angle.dexp_coefficients();
            *g = (rotation, rodrigues_on(omega, b, d, v));
        } else {
            *g = (so3::exp_huge(omega)?, so3::dexp(omega, v)?);
        }
        StepError::finite(g.1.iter().all(|x| x.is_finite()), "exp(u)")
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
        let back = Back::new(omega, at, a)?;
        *b = back.translation(omega, v, a, b);
        *a = back.rotation(a);
        finite_pair(&(*a, *b), "dexp⁻¹")
    }
}

/// What dexp⁻¹ needs of ω and a, for each translation.
struct Back<S> {
    c: S,
    slope: S,
    /// ω × a and ω × (ω × a).
    wa: Vector3<S>,
    wwa: Vector3<S>,
}

impl<S: Trig> Back<S> {
    #[inline(always)]
    fn new(omega: &Vector3<S>, at: &Angle<S>, a: &Vector3<S>) -> Result<Self, StepError> {
        let (c, slope) = (at.dexpinv_regular()?, at.dexpinv_slope());
        let wa = cross(omega, a);
        let wwa = cross(omega, &wa);
        Ok(Back { c, slope, wa, wwa })
    }
    /// J⁻¹a.
    #[inline(always)]
    fn rotation(&self, a: &Vector3<S>) -> Vector3<S> {
        Vector3::from_fn(|i, _| a[i] - S::lit(0.5) * self.wa[i] + self.c * self.wwa[i])
    }
    /// J⁻¹b + D a.
    #[inline(always)]
    fn translation(
        &self,
        omega: &Vector3<S>,
        v: &Vector3<S>,
        a: &Vector3<S>,
        b: &Vector3<S>,
    ) -> Vector3<S> {
        let l = S::lit;
        let Back { c, slope, wa, wwa } = self;
        let va = cross(v, a);
        let mixed = add3(&cross(v, wa), &cross(omega, &va));
        let turn = l(2.0) * *slope * (omega[0] * v[0] + omega[1] * v[1] + omega[2] * v[2]);
        let moved = rodrigues_on(omega, l(-0.5), *c, b);
        Vector3::from_fn(|i, _| moved[i] - l(0.5) * va[i] + *c * mixed[i] + turn * wwa[i])
    }
}

/// What dexp needs of ω and a, for each translation.
struct Forth<S> {
    beta: S,
    delta: S,
    slopes: (S, S),
    /// ω × a and ω × (ω × a).
    wa: Vector3<S>,
    wwa: Vector3<S>,
}

impl<S: Trig> Forth<S> {
    fn new(omega: &Vector3<S>, a: &Vector3<S>) -> Result<Self, StepError> {
        let (angle, _, _) = Angle::with_exp(omega);
        if !angle.in_range() {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        let ((beta, delta), slopes) = (angle.dexp_coefficients(), angle.dexp_slopes());
        let wa = cross(omega, a);
        Ok(Forth { beta, delta, slopes, wa, wwa: cross(omega, &wa) })
    }
    /// J a.
    fn rotation(&self, omega: &Vector3<S>, a: &Vector3<S>) -> Vector3<S> {
        rodrigues_on(omega, self.beta, self.delta, a)
    }
    /// J b + E a.
    fn translation(
        &self,
        omega: &Vector3<S>,
        v: &Vector3<S>,
        a: &Vector3<S>,
        b: &Vector3<S>,
    ) -> Vector3<S> {
        let Forth { beta, delta, slopes, wa, wwa } = self;
        let va = cross(v, a);
        let mixed = add3(&cross(v, wa), &cross(omega, &va));
        let turn = S::lit(2.0) * (omega[0] * v[0] + omega[1] * v[1] + omega[2] * v[2]);
        let (first, second) = (turn * slopes.0, turn * slopes.1);
        let moved = rodrigues_on(omega, *beta, *delta, b);
        Vector3::from_fn(|i, _| {
            moved[i] + *beta * va[i] + *delta * mixed[i] + first * wa[i] + second * wwa[i]
        })
    }
}

/// dexp_u w for u = (ω, v), w = (a, b). Refused for α² ≥ 1e300, where squares leave the range.
pub(crate) fn dexp<S: Trig>(
    (omega, v): &Twist<S>,
    (a, b): &Twist<S>,
) -> Result<Twist<S>, StepError> {
    let forth = Forth::new(omega, a)?;
    let w = (forth.rotation(omega, a), forth.translation(omega, v, a, b));
    finite_pair(&w, "dexp").map(|()| w)
}

/// The same on SE₂(3).
pub(crate) fn dexp_two<S: Trig>(
    (omega, (v, p)): &TwoTwist<S>,
    (a, (b, c)): &TwoTwist<S>,
) -> Result<TwoTwist<S>, StepError> {
    let forth = Forth::new(omega, a)?;
    let moved = (forth.translation(omega, v, a, b), forth.translation(omega, p, a, c));
    let w = (forth.rotation(omega, a), moved);
    finite_three(&w, "dexp").map(|()| w)
}

impl<S: Trig> CoordinateMap<Se23<S>> for Exp {
    type At = Angle<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, _: &Se23<S>) -> Result<Angle<S>, Error> {
        Ok(Angle::zero())
    }
    #[inline]
    fn psi(
        &self,
        _: &Se23<S>,
        (omega, (v, p)): &TwoTwist<S>,
        at: &mut Angle<S>,
        g: &mut ExtendedPose<S>,
    ) -> Result<(), StepError> {
        let mut first = (g.0, g.1.0);
        Exp.psi(&Se3::new(), &(*omega, *v), at, &mut first)?;
        g.0 = first.0;
        g.1.0 = first.1;
        g.1.1 = match at.in_range() {
            true => {
                let (b, d) = at.dexp_coefficients();
                rodrigues_on(omega, b, d, p)
            }
            false => so3::dexp(omega, p)?,
        };
        StepError::finite(g.1.1.iter().all(|x| x.is_finite()), "exp(u)")
    }
    /// Refused for α² ≥ 1e300, where squares leave the range.
    #[inline]
    fn dpsi_inv(
        &self,
        _: &Se23<S>,
        (omega, (v, p)): &TwoTwist<S>,
        at: &mut Angle<S>,
        (a, (b, c)): &mut TwoTwist<S>,
    ) -> Result<(), StepError> {
        if !at.in_range() {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        let back = Back::new(omega, at, a)?;
        *b = back.translation(omega, v, a, b);
        *c = back.translation(omega, p, a, c);
        *a = back.rotation(a);
        finite_three(&(*a, (*b, *c)), "dexp⁻¹")
    }
}

/// One `impl` for each group: exp, and dexp⁻¹ by brackets.
macro_rules! truncated {
    ($group:ident, $twist:ident, $pose:ident, $finite:ident) => {
        impl<S: Trig> CoordinateMap<$group<S>> for TruncatedExp {
            type At = Angle<S>;

            fn name(&self) -> &'static str {
                "exp"
            }
            fn at(&self, group: &$group<S>) -> Result<Angle<S>, Error> {
                Exp.at(group)
            }
            #[inline]
            fn psi(
                &self,
                group: &$group<S>,
                u: &$twist<S>,
                at: &mut Angle<S>,
                g: &mut $pose<S>,
            ) -> Result<(), StepError> {
                Exp.psi(group, u, at, g)
            }
            #[inline]
            fn dpsi_inv(
                &self,
                group: &$group<S>,
                u: &$twist<S>,
                _: &mut Angle<S>,
                v: &mut $twist<S>,
            ) -> Result<(), StepError> {
                let mut ad = *v;
                for k in 1..=self.q {
                    let last = ad;
                    group.bracket(u, &last, &mut ad);
                    if k == 1 || k % 2 == 0 {
                        group.axpy(S::lit(baker(k)), &ad, v);
                    }
                }
                $finite(v, "dexp⁻¹")
            }
            fn order(&self, _: &$group<S>) -> usize {
                self.order_kept()
            }
        }
    };
}
truncated!(Se3, Twist, BodyMotion, finite_pair);
truncated!(Se23, TwoTwist, ExtendedPose, finite_three);
