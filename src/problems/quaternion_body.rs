//! The free rigid body with its attitude as a unit quaternion: q̇ = f(q)·q on S³,
//! f(q) = ω_s = q J⁻¹(q̄ m_s q) q̄, equation (11) on the double cover; Λ is left translation.
//!
//! Invariants: |q| (the action), the energy (the flow). The body momentum is q̄ m_s q.

use nalgebra::{UnitQuaternion, Vector3};

use super::rigid_body::check_finite;
use super::{Invariant, Invariants, Problem, RigidBody};
use crate::actions::LeftTranslation;
use crate::error::Error;
use crate::groups::{LieGroup, UnitQuaternions};

/// The free rigid body by the quaternion of its attitude, from body to space.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{Exact, RigidBodyQuaternion};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use nalgebra::{Matrix3, UnitQuaternion};
/// let (inertia, momentum) = ([1.0, 2.0, 3.0], [0.2, 0.0, 3.0]);
/// let body = RigidBodyQuaternion::new(inertia, momentum)?;
/// let mut q = UnitQuaternion::identity();
/// let grid = TimeGrid::new([0.0, 1.0], 0.01)?;
/// integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut q, |_, _| {})?;
/// let (_, exact) = Exact::new(inertia, momentum, Matrix3::identity())?.state(1.0)?;
/// assert!((q.to_rotation_matrix().matrix() - exact).norm() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RigidBodyQuaternion {
    body: RigidBody,
    momentum_space: Vector3<f64>,
}

impl RigidBodyQuaternion {
    /// From the principal moments of inertia, and the angular momentum in space.
    ///
    /// # Errors
    /// As [`RigidBodyAttitude::new`](super::RigidBodyAttitude::new).
    pub fn new(inertia: [f64; 3], momentum_space: [f64; 3]) -> Result<Self, Error> {
        check_finite("momentum_space", &momentum_space)?;
        let body = RigidBody::new(inertia)?;
        Ok(RigidBodyQuaternion { body, momentum_space: momentum_space.into() })
    }

    /// The body alone.
    pub fn body(&self) -> &RigidBody {
        &self.body
    }

    /// m = q̄ m_s q, the angular momentum in the body.
    #[inline]
    pub fn momentum_body(&self, q: &UnitQuaternion<f64>) -> Vector3<f64> {
        let mut m = Vector3::zeros();
        UnitQuaternions.apply(&q.conjugate(), &self.momentum_space, &mut m);
        m
    }
}

impl Problem for RigidBodyQuaternion {
    type Group = UnitQuaternions;
    type Action = LeftTranslation;
    type Work = ();

    fn group(&self) -> &UnitQuaternions {
        &UnitQuaternions
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, _: f64, q: &UnitQuaternion<f64>, v: &mut Vector3<f64>, _: &mut ()) {
        UnitQuaternions.apply(q, &self.body.omega(&self.momentum_body(q)), v);
    }
}

impl Invariants for RigidBodyQuaternion {
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::of_the_action("|q|²"), Invariant::of_the_flow("energy")]
    }
    fn values(&self, q: &UnitQuaternion<f64>) -> Vec<f64> {
        vec![q.coords.norm_squared(), self.body.energy(&self.momentum_body(q))]
    }
}
