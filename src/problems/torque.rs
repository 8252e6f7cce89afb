//! The rigid body under torques, such as gravity, thrusters, damping or control laws. y = (g, m_s).
//!
//! ġ = ω̂_s g, ṁ_s = τ_s(t, g, m_s), with the attitude g from body to space, the momentum m_s in space
//! and ω_s = g J⁻¹ gᵀ m_s. The group is SO(3) × T(3), acting by left translation of g and addition to
//! m_s: f = (ω_s, τ_s). Without a torque m_s is constant to the bit.
//!
//! Invariants: only ‖gᵀg − 𝟙‖ = 0, by the action.

use nalgebra::{Matrix3, Vector3};

use super::Problem;
use super::rigid_body::{apply_transpose, check_inertia};
use crate::actions::LeftTranslation;
use crate::error::Error;
use crate::groups::{Adjoint, Product, So3, Translations};
use crate::problems::FieldStore;
use crate::scalar::Real;
use crate::so3::{add3, apply3};

/// The motion that a torque may depend on: t, attitude, momentum, angular velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion<S = f64> {
    /// The time.
    pub t: S,
    /// g, from body to space.
    pub attitude: Matrix3<S>,
    /// m_s, the angular momentum in space.
    pub momentum_space: Vector3<S>,
    /// ω_b = J⁻¹gᵀm_s, the angular velocity in the body.
    pub omega_body: Vector3<S>,
}

/// A torque in space or in the body.
pub trait Torque<S = f64> {
    /// τ_s, the torque in space.
    fn in_space(&self, at: &BodyMotion<S>) -> Vector3<S>;
}

/// A torque in the space frame, from a function of the [`BodyMotion`].
#[derive(Clone, Copy, Debug)]
pub struct SpaceTorque<F>(pub F);

impl<S, F: Fn(&BodyMotion<S>) -> Vector3<S>> Torque<S> for SpaceTorque<F> {
    #[inline]
    fn in_space(&self, at: &BodyMotion<S>) -> Vector3<S> {
        (self.0)(at)
    }
}

/// A torque in the body frame, τ_s = gτ_b. Examples: thrusters, damping −cω_b, control laws.
#[derive(Clone, Copy, Debug)]
pub struct BodyTorque<F>(pub F);

impl<S: Real, F: Fn(&BodyMotion<S>) -> Vector3<S>> Torque<S> for BodyTorque<F> {
    #[inline]
    fn in_space(&self, at: &BodyMotion<S>) -> Vector3<S> {
        apply3(&at.attitude, &(self.0)(at))
    }
}

/// The sum of two torques.
impl<S: Real, A: Torque<S>, B: Torque<S>> Torque<S> for (A, B) {
    #[inline]
    fn in_space(&self, at: &BodyMotion<S>) -> Vector3<S> {
        add3(&self.0.in_space(at), &self.1.in_space(at))
    }
}

/// A rigid body under a torque.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{BodyTorque, TorqueBody};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::{Matrix3, Vector3};
/// // Damping brings the body to rest.
/// let body = TorqueBody::new([1.0, 2.0, 3.0], BodyTorque(|at: &_| damping(at)))?;
/// # fn damping(at: &lieflow::problems::BodyMotion) -> Vector3<f64> { -2.0 * at.omega_body }
/// let mut y = (Matrix3::identity(), Vector3::new(0.2, 0.5, 3.0));
/// let grid = TimeGrid::new([0.0, 20.0], 0.02)?;
/// integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
/// assert!(y.1.norm() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TorqueBody<T, S = f64> {
    group: Product<So3<S>, Translations<Vector3<S>>>,
    inertia: Vector3<S>,
    inverse_inertia: Vector3<S>,
    torque: T,
}

impl<T: Torque> TorqueBody<T> {
    /// Makes a body from the principal moments of inertia and the torque.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment that is not finite and positive.
    pub fn new(inertia: [f64; 3], torque: T) -> Result<Self, Error> {
        check_inertia(&inertia)?;
        Ok(Self::of(inertia.into(), torque))
    }

    /// The state with this attitude and angular velocity in the body: (g, gJω_b).
    ///
    /// # Errors
    /// As [`So3::check_element`], and [`Error::OutOfRange`] for ω that is not finite.
    pub fn state(
        &self,
        attitude: Matrix3<f64>,
        omega_body: [f64; 3],
    ) -> Result<(Matrix3<f64>, Vector3<f64>), Error> {
        So3::new().check_element("attitude", &attitude, crate::groups::MEMBERSHIP)?;
        Error::all_finite("omega_body", &omega_body)?;
        let m = self.inertia.component_mul(&Vector3::from(omega_body));
        Ok((attitude, attitude * m))
    }

    /// This body in other numbers, under a torque in those.
    pub fn on<S: Real, U: Torque<S>>(&self, torque: U) -> TorqueBody<U, S> {
        TorqueBody::of(self.inertia, torque)
    }
}

/// g and m_s.
type Point<S> = (Matrix3<S>, Vector3<S>);

impl<S: Real, T: Torque<S>> TorqueBody<T, S> {
    fn of(inertia: Vector3<f64>, torque: T) -> Self {
        let zero = Vector3::from_element(S::lit(0.0));
        TorqueBody {
            group: Product(So3::new(), Translations::new(zero, 3)),
            inertia: inertia.map(S::lit),
            inverse_inertia: inertia.map(|j| S::lit(1.0 / j)),
            torque,
        }
    }

    /// The motion at (t, y), for a torque.
    #[inline]
    pub fn motion(&self, t: S, y: &Point<S>) -> BodyMotion<S> {
        let momentum = apply_transpose(&y.0, &y.1);
        let omega_body = Vector3::from_fn(|i, _| self.inverse_inertia[i] * momentum[i]);
        BodyMotion { t, attitude: y.0, momentum_space: y.1, omega_body }
    }

    /// ½ ω·Jω.
    pub fn kinetic_energy(&self, y: &Point<S>) -> S {
        let omega = self.motion(S::lit(0.0), y).omega_body;
        let of = |i: usize| self.inertia[i] * omega[i] * omega[i];
        S::lit(0.5) * (of(0) + of(1) + of(2))
    }
}

impl<S: Real, T: Torque<S>> Problem for TorqueBody<T, S> {
    type Group = Product<So3<S>, Translations<Vector3<S>>>;
    type Action = LeftTranslation;
    type Work = ();

    fn group(&self) -> &Self::Group {
        &self.group
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, t: S, y: &Point<S>, v: &mut (Vector3<S>, Vector3<S>), _: &mut ()) {
        let at = self.motion(t, y);
        *v = (apply3(&y.0, &at.omega_body), self.torque.in_space(&at));
    }
    /// (gω̂, τ_s), with ω in the body. This saves a product with g.
    #[inline]
    fn field(&self, t: S, y: &Point<S>, dy: &mut Point<S>, _: &mut FieldStore<Self>) {
        let at = self.motion(t, y);
        self.group.0.tangent_in_body(&y.0, &at.omega_body, &mut dy.0);
        dy.1 = self.torque.in_space(&at);
    }
}
