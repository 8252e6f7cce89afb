//! The free rigid body with its attitude as a unit quaternion q, on S³.
//!
//! q̇ = f(q)·q, f(q) = ω_s = q J⁻¹(q̄ m_s q) q̄, equation (11) for quaternions; Λ is left translation. In ℝ⁴ q̇ = ½ (0,
//! ω_s) q. So every method that conserves quadratic invariants conserves |q|. The flow about the axis e_k is
//! q ← q (cos θ/2, sin θ/2 e_k), θ = t m_k/J_k.
//!
//! Invariants: |q| (by the action), the energy (by the flow). The body momentum is q̄ m_s q.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::{Frame, FreeBody, Invariant, Invariants, Problem, RigidBody, Split};
use crate::actions::LeftTranslation;
use crate::error::Error;
use crate::groups::{LieGroup, UnitQuaternions};
use crate::scalar::{Ops, tally};
use crate::so3;

/// The free rigid body by the quaternion of its attitude, from body to space.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{Exact, RigidBodyQuaternion};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::{Matrix3, UnitQuaternion};
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
    /// Makes a body from the principal moments of inertia and the angular momentum in space.
    ///
    /// # Errors
    /// As [`RigidBodyAttitude::new`](super::RigidBodyAttitude::new).
    pub fn new(inertia: [f64; 3], momentum_space: [f64; 3]) -> Result<Self, Error> {
        Error::all_finite("momentum_space", &momentum_space)?;
        let body = RigidBody::new(inertia)?;
        Ok(RigidBodyQuaternion { body, momentum_space: momentum_space.into() })
    }

    /// The body by its momentum only.
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
        tally(|| Ops::muls(3)); // ω of m
        UnitQuaternions.apply(q, &self.body.omega(&self.momentum_body(q)), v);
    }
}

impl Frame<f64> for UnitQuaternion<f64> {
    const TURNS: bool = true;
    /// By the quaternion of Ψ that is nearer to 1. NaN if Ψ is not a rotation.
    #[inline]
    fn turn(&mut self, psi: &Matrix3<f64>) {
        let turned = match so3::quaternion_from_matrix(psi) {
            Ok(step) => self.quaternion() * step.quaternion() * 1f64.copysign(step.w),
            Err(_) => Quaternion::from(self.coords * f64::NAN),
        };
        *self = UnitQuaternion::new_unchecked(turned);
    }
}

impl FreeBody for RigidBodyQuaternion {
    type Frame = UnitQuaternion<f64>;
    #[inline]
    fn inverse_inertia(&self) -> &Vector3<f64> {
        FreeBody::inverse_inertia(&self.body)
    }
    #[inline]
    fn load(&self, q: &UnitQuaternion<f64>) -> (Vector3<f64>, UnitQuaternion<f64>) {
        (self.momentum_body(q), *q)
    }
    /// m follows from q.
    #[inline]
    fn store(&self, _: &Vector3<f64>, frame: &UnitQuaternion<f64>, q: &mut UnitQuaternion<f64>) {
        *q = *frame;
    }
}

impl Split for RigidBodyQuaternion {
    const PARTS: usize = 3;
    #[inline]
    fn flow(&self, k: usize, t: f64, q: &mut UnitQuaternion<f64>) {
        let rate = FreeBody::inverse_inertia(&self.body)[k] * self.momentum_body(q)[k];
        let (s, c) = (0.5 * t * rate).sin_cos();
        let mut axis = Vector3::zeros();
        axis[k] = s;
        let product = q.quaternion() * Quaternion::from_parts(c, axis);
        *q = UnitQuaternion::new_unchecked(product);
    }
}

impl Invariants for RigidBodyQuaternion {
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::of_the_action("|q|²", 2), Invariant::of_the_flow("energy", 0)]
    }
    fn values(&self, q: &UnitQuaternion<f64>) -> Vec<f64> {
        vec![q.coords.norm_squared(), self.body.energy(&self.momentum_body(q))]
    }
}
