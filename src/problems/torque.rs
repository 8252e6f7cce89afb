//! The rigid body under torques: gravity, thrusters, damping, control laws; y = (g, m_s).
//!
//! ġ = ω̂_s g, ṁ_s = τ_s(t, g, m_s), with the attitude g from body to space, the momentum m_s in space
//! and ω_s = g J⁻¹ gᵀ m_s. The group is SO(3) × T(3), acting by left translation of g and addition to
//! m_s: f = (ω_s, τ_s). Without a torque m_s is constant, bit for bit.
//!
//! Invariants: none in general; ‖gᵀg − 𝟙‖ = 0 by the action.

use nalgebra::{Matrix3, Vector3};

use super::rigid_body::{check_finite, check_inertia};
use super::{Ambient, Problem, space::linear_space};
use crate::actions::LeftTranslation;
use crate::error::Error;
use crate::groups::{Product, So3, Translations, hat};

/// What a torque may depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// t.
    pub t: f64,
    /// g, from body to space.
    pub attitude: Matrix3<f64>,
    /// m_s, the angular momentum in space.
    pub momentum_space: Vector3<f64>,
    /// ω_b = J⁻¹gᵀm_s, the angular velocity in the body.
    pub omega_body: Vector3<f64>,
}

/// A torque, in the frame where it is simple.
pub trait Torque {
    /// τ_s, the torque in space.
    fn in_space(&self, at: &Motion) -> Vector3<f64>;
}

/// A torque that is given in space: a function of the [`Motion`].
#[derive(Clone, Copy, Debug)]
pub struct SpaceTorque<F>(pub F);

impl<F: Fn(&Motion) -> Vector3<f64>> Torque for SpaceTorque<F> {
    #[inline]
    fn in_space(&self, at: &Motion) -> Vector3<f64> {
        (self.0)(at)
    }
}

/// A torque that is given in the body, τ_s = gτ_b: thrusters, damping −cω_b, control laws.
#[derive(Clone, Copy, Debug)]
pub struct BodyTorque<F>(pub F);

impl<F: Fn(&Motion) -> Vector3<f64>> Torque for BodyTorque<F> {
    #[inline]
    fn in_space(&self, at: &Motion) -> Vector3<f64> {
        at.attitude * (self.0)(at)
    }
}

/// The sum of two torques.
impl<A: Torque, B: Torque> Torque for (A, B) {
    #[inline]
    fn in_space(&self, at: &Motion) -> Vector3<f64> {
        self.0.in_space(at) + self.1.in_space(at)
    }
}

/// A rigid body under a torque.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{BodyTorque, TorqueBody};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use nalgebra::{Matrix3, Vector3};
/// // Damping brings the body to rest.
/// let body = TorqueBody::new([1.0, 2.0, 3.0], BodyTorque(|at: &_| damping(at)))?;
/// # fn damping(at: &lieflow::problems::Motion) -> Vector3<f64> { -2.0 * at.omega_body }
/// let mut y = (Matrix3::identity(), Vector3::new(0.2, 0.5, 3.0));
/// let grid = TimeGrid::new([0.0, 20.0], 0.02)?;
/// integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
/// assert!(y.1.norm() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct TorqueBody<T> {
    group: Product<So3, Translations<Vector3<f64>>>,
    inertia: Vector3<f64>,
    inverse_inertia: Vector3<f64>,
    torque: T,
}

impl<T: Torque> TorqueBody<T> {
    /// From the principal moments of inertia and the torque.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment that is not finite and positive.
    pub fn new(inertia: [f64; 3], torque: T) -> Result<Self, Error> {
        check_inertia(&inertia)?;
        Ok(TorqueBody {
            group: Product(So3::new(), Translations::new(Vector3::zeros(), 3)),
            inertia: inertia.into(),
            inverse_inertia: inertia.map(|j| 1.0 / j).into(),
            torque,
        })
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
        check_finite("omega_body", &omega_body)?;
        let m = self.inertia.component_mul(&Vector3::from(omega_body));
        Ok((attitude, attitude * m))
    }

    /// What a torque sees at (t, y).
    #[inline]
    pub fn motion(&self, t: f64, y: &(Matrix3<f64>, Vector3<f64>)) -> Motion {
        let omega_body = self.inverse_inertia.component_mul(&y.0.tr_mul(&y.1));
        Motion { t, attitude: y.0, momentum_space: y.1, omega_body }
    }

    /// ½ ω·Jω.
    pub fn kinetic_energy(&self, y: &(Matrix3<f64>, Vector3<f64>)) -> f64 {
        let omega = self.motion(0.0, y).omega_body;
        0.5 * omega.dot(&self.inertia.component_mul(&omega))
    }
}

impl<T: Torque> Problem for TorqueBody<T> {
    type Group = Product<So3, Translations<Vector3<f64>>>;
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
    fn f(
        &self,
        t: f64,
        y: &(Matrix3<f64>, Vector3<f64>),
        v: &mut (Vector3<f64>, Vector3<f64>),
        _: &mut (),
    ) {
        let at = self.motion(t, y);
        *v = (y.0 * at.omega_body, self.torque.in_space(&at));
    }
}

impl<T: Torque> Ambient for TorqueBody<T> {
    fn field(
        &self,
        t: f64,
        y: &(Matrix3<f64>, Vector3<f64>),
        dy: &mut (Matrix3<f64>, Vector3<f64>),
        _: &mut (),
    ) {
        let at = self.motion(t, y);
        *dy = (y.0 * hat(&at.omega_body), self.torque.in_space(&at));
    }
    linear_space!();
}
