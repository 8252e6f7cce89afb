//! A step of one body, generic in the number type: SIMD lanes or a scalar.

use nalgebra::Vector3;

use crate::error::StepError;
use crate::maps::{Cay, Exp};
use crate::methods::tableau::RK4;
use crate::methods::{Method, Rk, Rkmk, Step};
use crate::problems::{BodyState, RigidBodyState};
use crate::scalar::{Real, Trig};
use crate::so3::cross;
use crate::so3::{Angle, cay_coefficients, rodrigues_on};

/// The numbers that a step leaves for the attitude.
pub(super) const MOTION: usize = 12;

/// What a step makes of the momentum.
pub(super) struct MomentumStep<S> {
    pub(super) m: Vector3<S>,
    pub(super) motion: [S; MOTION],
    /// The largest |u|² of the stages.
    pub(super) largest: S,
}

/// A method in SIMD lanes, and the same method on scalars.
pub(super) trait OneStep {
    const KEEPS_GROUP: bool;
    /// A step of m, with the reciprocals j of the inertias.
    fn step<S: Trig>(h: S, j: &Vector3<S>, m: &Vector3<S>) -> MomentumStep<S>;
    /// What a step does to another vector that is fixed in space.
    fn carry<S: Trig>(h: S, motion: &[S; MOTION], x: &Vector3<S>) -> Vector3<S>;
    fn one(inverse_inertia: [f64; 3], h: f64, y: &mut BodyState) -> Result<(), StepError>;
}

fn scalar<M: Method<RigidBodyState>>(
    method: &M,
    inverse_inertia: [f64; 3],
    h: f64,
    y: &mut BodyState,
) -> Result<(), StepError> {
    // What was checked when the ensemble was made.
    let refused = |_| StepError::NotFinite { what: "the inertia" };
    let body = RigidBodyState::new(inverse_inertia.map(|x| 1.0 / x)).map_err(refused)?;
    let mut work = method.work(&body, y).map_err(refused)?;
    method.step(&body, Step { n: 0, t: 0.0, h }, y, &mut work)
}

/// −J⁻¹m.
#[inline(always)]
fn field<S: Real>(j: &Vector3<S>, m: &Vector3<S>) -> Vector3<S> {
    Vector3::new(-(j[0] * m[0]), -(j[1] * m[1]), -(j[2] * m[2]))
}

#[inline(always)]
fn scaled<S: Real>(a: S, x: &Vector3<S>) -> Vector3<S> {
    Vector3::new(a * x[0], a * x[1], a * x[2])
}

#[inline(always)]
fn sum<S: Real>(x: &Vector3<S>, a: S, y: &Vector3<S>) -> Vector3<S> {
    Vector3::new(a.mul_add(y[0], x[0]), a.mul_add(y[1], x[1]), a.mul_add(y[2], x[2]))
}

/// max, without a branch.
#[inline(always)]
fn larger<S: Real>(a: S, b: S) -> S {
    let half = S::lit(0.5);
    half * (a + b + (a - b).abs())
}

/// Ψ at u: Ψ(u) = 𝟙 + a û + b û², dΨ_u⁻¹ = (1 + s)𝟙 − û/2 + c û².
pub(super) struct MapAt<S> {
    u: Vector3<S>,
    alpha2: S,
    a: S,
    b: S,
    c: S,
    s: S,
}

pub(super) trait InChart {
    fn at<S: Trig>(u: Vector3<S>) -> MapAt<S>;
    fn one(inverse_inertia: [f64; 3], h: f64, y: &mut BodyState) -> Result<(), StepError>;
}

pub(super) struct InExp;
impl InChart for InExp {
    #[inline(always)]
    fn at<S: Trig>(u: Vector3<S>) -> MapAt<S> {
        let (angle, a, b) = Angle::with_exp(&u);
        MapAt { u, alpha2: angle.alpha2, a, b, c: angle.dexpinv_coefficient(), s: S::lit(0.0) }
    }
    fn one(inverse_inertia: [f64; 3], h: f64, y: &mut BodyState) -> Result<(), StepError> {
        scalar(&Rkmk::new(RK4, Exp), inverse_inertia, h, y)
    }
}

pub(super) struct InCay;
impl InChart for InCay {
    #[inline(always)]
    fn at<S: Trig>(u: Vector3<S>) -> MapAt<S> {
        // In lanes it always has a value; where it is none the body is done again.
        let (a, b) = cay_coefficients(&u).unwrap_or((S::lit(0.0), S::lit(0.0)));
        let alpha2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        MapAt { u, alpha2, a, b, c: S::lit(0.25), s: S::lit(0.25) * alpha2 }
    }
    fn one(inverse_inertia: [f64; 3], h: f64, y: &mut BodyState) -> Result<(), StepError> {
        scalar(&Rkmk::new(RK4, Cay), inverse_inertia, h, y)
    }
}

/// dΨ_u⁻¹ f(Ψ(u) m) at u = a·k, and |u|². A function, because a closure is not always inlined.
#[inline(always)]
fn stage<S: Trig, Psi: InChart>(
    a: S,
    k: &Vector3<S>,
    j: &Vector3<S>,
    m: &Vector3<S>,
) -> (Vector3<S>, S) {
    let MapAt { u, alpha2, a, b, c, s } = Psi::at(scaled(a, k));
    let v = field(j, &rodrigues_on(&u, a, b, m));
    (sum(&rodrigues_on(&u, S::lit(-0.5), c, &v), s, &v), alpha2)
}

impl<Psi: InChart> OneStep for Psi {
    const KEEPS_GROUP: bool = true;

    #[inline(always)]
    fn step<S: Trig>(h: S, j: &Vector3<S>, m: &Vector3<S>) -> MomentumStep<S> {
        let half = S::lit(0.5) * h;
        let k1 = field(j, m);
        let (k2, first) = stage::<S, Psi>(half, &k1, j, m);
        let (k3, second) = stage::<S, Psi>(half, &k2, j, m);
        let (k4, third) = stage::<S, Psi>(h, &k3, j, m);
        let largest = larger(larger(larger(S::lit(0.0), first), second), third);
        let two = S::lit(2.0);
        let increment = sum(&sum(&sum(&k1, two, &k2), two, &k3), S::lit(1.0), &k4);
        let MapAt { u: v, alpha2, a, b, .. } = Psi::at(scaled(h * S::lit(1.0 / 6.0), &increment));
        let mut motion = [S::lit(0.0); MOTION];
        (motion[0], motion[1], motion[2], motion[3], motion[4]) = (v[0], v[1], v[2], a, b);
        MomentumStep { m: rodrigues_on(&v, a, b, m), motion, largest: larger(largest, alpha2) }
    }
    #[inline(always)]
    fn carry<S: Trig>(_: S, motion: &[S; MOTION], x: &Vector3<S>) -> Vector3<S> {
        rodrigues_on(&Vector3::new(motion[0], motion[1], motion[2]), motion[3], motion[4], x)
    }
    fn one(inverse_inertia: [f64; 3], h: f64, y: &mut BodyState) -> Result<(), StepError> {
        <Psi as InChart>::one(inverse_inertia, h, y)
    }
}

/// A step of ẋ = x × ω by the classical tableau.
#[inline(always)]
fn classical<S: Real>(
    h: S,
    x: &Vector3<S>,
    mut omega: impl FnMut(&Vector3<S>) -> Vector3<S>,
) -> Vector3<S> {
    let mut rate = |x: &Vector3<S>| cross(x, &omega(x));
    let half = S::lit(0.5) * h;
    let k1 = rate(x);
    let k2 = rate(&sum(x, half, &k1));
    let k3 = rate(&sum(x, half, &k2));
    let k4 = rate(&sum(x, h, &k3));
    let two = S::lit(2.0);
    let k = sum(&sum(&sum(&k1, two, &k2), two, &k3), S::lit(1.0), &k4);
    sum(x, h * S::lit(1.0 / 6.0), &k)
}

pub(super) struct Classical;
impl OneStep for Classical {
    const KEEPS_GROUP: bool = false;

    #[inline(always)]
    fn step<S: Trig>(h: S, j: &Vector3<S>, m: &Vector3<S>) -> MomentumStep<S> {
        let mut motion = [S::lit(0.0); MOTION];
        let mut stage = 0;
        let m = classical(h, m, |m| {
            let omega = -field(j, m);
            for k in 0..3 {
                motion[stage + k] = omega[k];
            }
            stage += 3;
            omega
        });
        MomentumStep { m, motion, largest: S::lit(0.0) }
    }
    #[inline(always)]
    fn carry<S: Trig>(h: S, motion: &[S; MOTION], x: &Vector3<S>) -> Vector3<S> {
        let mut stage = 0;
        classical(h, x, |_| {
            stage += 3;
            Vector3::new(motion[stage - 3], motion[stage - 2], motion[stage - 1])
        })
    }
    fn one(inverse_inertia: [f64; 3], h: f64, y: &mut BodyState) -> Result<(), StepError> {
        scalar(&Rk(RK4), inverse_inertia, h, y)
    }
}
