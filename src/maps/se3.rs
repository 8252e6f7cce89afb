//! cay, pade22 and ccsk on SE(3), the maps of its 4×4 matrices: Ψ(ω, v) = (ψ(ω), x), x = φ(ω)v, with
//! the map ψ of SO(3). On SE₂(3) there are two such v.
//!
//! dΨ⁻¹(a, b) = (ω̇, v̇): ω̇ = dψ_ω⁻¹a, and v̇ from ẋ = z = b + a × x:
//!
//! | | φ(ω)⁻¹ | v̇ |
//! |---|---|---|
//! | cay | 𝟙 − ω̂/2 | z − ½ ω×z − ½ ω̇×x |
//! | pade22 | 𝟙 − ω̂/2 + ω̂²/12 | z − ½ ω×z − ½ ω̇×x + (ω×(ω×z) + ω̇×(ω×x) + ω×(ω̇×x))/12 |
//! | ccsk | 𝟙: the translations are the first three factors | z |

use nalgebra::{Matrix3, Vector3};

use super::{Cay, Ccsk, CoordinateMap, Pade22, pade22};
use crate::error::{Error, StepError};
use crate::groups::{Se3, Se23, So3, finite_pair, finite_three};
use crate::scalar::{Real, Trig};
use crate::so3::{Angles, cay_coefficients, rodrigues_on};
use crate::so3::{add3, cross};

type Twist<S> = (Vector3<S>, Vector3<S>);
type BodyMotion<S> = (Matrix3<S>, Vector3<S>);
type TwoTwist<S> = (Vector3<S>, Twist<S>);
type ExtendedPose<S> = (Matrix3<S>, Twist<S>);

/// The values that a map stores: those of ψ, and x.
#[derive(Clone, Copy, Debug)]
pub struct ScrewAt<T, X> {
    turn: T,
    x: X,
}

/// −½ ω×z − ½ ω̇×x, with the sign of cay.
#[inline(always)]
fn half<S: Real>(
    omega: &Vector3<S>,
    z: &Vector3<S>,
    rate: &Vector3<S>,
    x: &Vector3<S>,
) -> Vector3<S> {
    let (a, b) = (cross(omega, z), cross(rate, x));
    Vector3::from_fn(|i, _| S::lit(-0.5) * (a[i] + b[i]))
}

/// One `impl`: the map, its parameters, what ψ keeps, x from (ω, v), v̇ from (ω, z, ω̇, x).
macro_rules! on_se3 {
    ($map:ty, [$($parameters:tt)*], $at:ty, $translate:expr, $pull:expr) => {
        impl<$($parameters)*> CoordinateMap<Se3<S>> for $map {
            type At = ScrewAt<$at, Vector3<S>>;

            fn name(&self) -> &'static str {
                CoordinateMap::<So3<S>>::name(self)
            }
            fn at(&self, _: &Se3<S>) -> Result<Self::At, Error> {
                let o = S::lit(0.0);
                Ok(ScrewAt { turn: self.at(&So3::<S>::new())?, x: Vector3::new(o, o, o) })
            }
            #[inline]
            fn psi(
                &self,
                _: &Se3<S>,
                (omega, v): &Twist<S>,
                at: &mut Self::At,
                g: &mut BodyMotion<S>,
            ) -> Result<(), StepError> {
                self.psi(&So3::new(), omega, &mut at.turn, &mut g.0)?;
                at.x = $translate(omega, v)?;
                g.1 = at.x;
                StepError::finite(at.x.iter().all(|x| x.is_finite()), "Ψ(u)")
            }
            #[inline]
            fn dpsi_inv(
                &self,
                _: &Se3<S>,
                (omega, _): &Twist<S>,
                at: &mut Self::At,
                (a, b): &mut Twist<S>,
            ) -> Result<(), StepError> {
                let z = add3(b, &cross(a, &at.x));
                self.dpsi_inv(&So3::new(), omega, &mut at.turn, a)?;
                *b = $pull(omega, &z, &*a, &at.x);
                finite_pair(&(*a, *b), "dΨ⁻¹")
            }
        }

        impl<$($parameters)*> CoordinateMap<Se23<S>> for $map {
            type At = ScrewAt<$at, Twist<S>>;

            fn name(&self) -> &'static str {
                CoordinateMap::<So3<S>>::name(self)
            }
            fn at(&self, _: &Se23<S>) -> Result<Self::At, Error> {
                let o = Vector3::repeat(S::lit(0.0));
                Ok(ScrewAt { turn: self.at(&So3::<S>::new())?, x: (o, o) })
            }
            #[inline]
            fn psi(
                &self,
                _: &Se23<S>,
                (omega, (v, p)): &TwoTwist<S>,
                at: &mut Self::At,
                g: &mut ExtendedPose<S>,
            ) -> Result<(), StepError> {
                self.psi(&So3::new(), omega, &mut at.turn, &mut g.0)?;
                at.x = ($translate(omega, v)?, $translate(omega, p)?);
                g.1 = at.x;
                finite_pair(&at.x, "Ψ(u)")
            }
            #[inline]
            fn dpsi_inv(
                &self,
                _: &Se23<S>,
                (omega, _): &TwoTwist<S>,
                at: &mut Self::At,
                (a, (b, c)): &mut TwoTwist<S>,
            ) -> Result<(), StepError> {
                let z = (add3(b, &cross(a, &at.x.0)), add3(c, &cross(a, &at.x.1)));
                self.dpsi_inv(&So3::new(), omega, &mut at.turn, a)?;
                *b = $pull(omega, &z.0, &*a, &at.x.0);
                *c = $pull(omega, &z.1, &*a, &at.x.1);
                finite_three(&(*a, (*b, *c)), "dΨ⁻¹")
            }
        }
    };
}

on_se3!(Cay, [S: Real], (), translate_cay, pull_cay);
on_se3!(Pade22, [S: Real], (), translate_pade, pull_pade);
on_se3!(
    Ccsk<I, J, K>,
    [S: Trig, const I: usize, const J: usize, const K: usize],
    Angles<S>,
    |_: &Vector3<S>, v: &Vector3<S>| Ok::<_, StepError>(*v),
    |_: &Vector3<S>, z: &Vector3<S>, _: &Vector3<S>, _: &Vector3<S>| *z
);

/// (𝟙 − ω̂/2)⁻¹ v = v + (ω̂/2 + ω̂²/4) v/(1 + α²/4).
#[inline(always)]
fn translate_cay<S: Real>(omega: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    match cay_coefficients(omega) {
        Some((a, b)) => Ok(rodrigues_on(omega, b, S::lit(0.25) * a, v)),
        None => Err(StepError::NormTooLarge { map: "cay" }),
    }
}

#[inline(always)]
fn pull_cay<S: Real>(
    omega: &Vector3<S>,
    z: &Vector3<S>,
    rate: &Vector3<S>,
    x: &Vector3<S>,
) -> Vector3<S> {
    add3(z, &half(omega, z, rate, x))
}

/// (𝟙 − ω̂/2 + ω̂²/12)⁻¹ v = v + c (½ ω̂ + (¼ − q/12) ω̂²) v, c = 1/(q² + α²/4).
#[inline(always)]
fn translate_pade<S: Real>(omega: &Vector3<S>, v: &Vector3<S>) -> Result<Vector3<S>, StepError> {
    let (q, c) = pade22::factors(omega)?;
    let square = c * (S::lit(0.25) - S::lit(1.0 / 12.0) * q);
    Ok(rodrigues_on(omega, S::lit(0.5) * c, square, v))
}

#[inline(always)]
fn pull_pade<S: Real>(
    omega: &Vector3<S>,
    z: &Vector3<S>,
    rate: &Vector3<S>,
    x: &Vector3<S>,
) -> Vector3<S> {
    let twice = add3(&cross(omega, z), &cross(rate, x));
    let inner = add3(&cross(omega, &twice), &cross(rate, &cross(omega, x)));
    let first = add3(z, &half(omega, z, rate, x));
    Vector3::from_fn(|i, _| first[i] + S::lit(1.0 / 12.0) * inner[i])
}
