//! The free rigid body in ℝ³.

use nalgebra::{Matrix3, Vector3};

use super::check_inertia;
use crate::actions::{Coadjoint, LeftTranslation};
use crate::error::Error;
use crate::groups::So3;
use crate::problems::FieldStore;
use crate::problems::Problem;
use crate::scalar::Real;
use crate::so3::apply3;

/// J⁻¹·m for diagonal J.
#[inline(always)]
fn scale<S: Real>(inverse_inertia: &Vector3<S>, m: &Vector3<S>) -> Vector3<S> {
    Vector3::new(inverse_inertia[0] * m[0], inverse_inertia[1] * m[1], inverse_inertia[2] * m[2])
}

/// gᵀ·m.
#[inline(always)]
pub(in crate::problems) fn apply_transpose<S: Real>(g: &Matrix3<S>, m: &Vector3<S>) -> Vector3<S> {
    let row = |j| g[(0, j)] * m[0] + g[(1, j)] * m[1] + g[(2, j)] * m[2];
    Vector3::new(row(0), row(1), row(2))
}

/// ½ m·J⁻¹m.
#[inline]
fn kinetic_energy<S: Real>(inverse_inertia: &Vector3<S>, m: &Vector3<S>) -> S {
    let w = scale(inverse_inertia, m);
    S::lit(0.5) * (m[0] * w[0] + m[1] * w[1] + m[2] * w[2])
}

/// The free rigid body by its momentum in the body: ṁ = m × J⁻¹m, equation (5).
///
/// f(m) = −J⁻¹m; Λ(g, m) = g m. The motion stays on the sphere |m| = const, a coadjoint orbit.
///
/// Invariants: the energy, and |m|², a Casimir that every method that acts by the group conserves.
#[derive(Clone, Copy, Debug)]
pub struct RigidBody<S = f64> {
    group: So3<S>,
    inverse_inertia: Vector3<S>,
    /// 1/J₃ − 1/J₂, 1/J₁ − 1/J₃, 1/J₂ − 1/J₁.
    differences: Vector3<S>,
}

impl<S: Real> RigidBody<S> {
    /// Makes a body from the principal moments of inertia J₁, J₂, J₃.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment that is not finite and positive.
    pub fn new(inertia: [f64; 3]) -> Result<Self, Error> {
        check_inertia(&inertia)?;
        let [a, b, c] = inertia.map(|j| S::lit(1.0 / j));
        let differences = Vector3::new(c - b, a - c, b - a);
        Ok(RigidBody { group: So3::new(), inverse_inertia: Vector3::new(a, b, c), differences })
    }

    /// The diagonal of J⁻¹.
    #[inline]
    pub(super) fn inverse_inertia(&self) -> &Vector3<S> {
        &self.inverse_inertia
    }

    /// ω = J⁻¹m, the angular velocity in the body.
    #[inline]
    pub fn omega(&self, m: &Vector3<S>) -> Vector3<S> {
        scale(&self.inverse_inertia, m)
    }

    /// E = ½ m·J⁻¹m. It may overflow to infinity, as for |m| = 1e200 with J = 1, or underflow to 0. The motion has no
    /// such limits.
    pub fn energy(&self, m: &Vector3<S>) -> S {
        kinetic_energy(&self.inverse_inertia, m)
    }
}

impl<S: Real> Problem for RigidBody<S> {
    type Group = So3<S>;
    type Action = Coadjoint;
    type Work = ();

    fn group(&self) -> &So3<S> {
        &self.group
    }
    fn action(&self) -> &Coadjoint {
        &Coadjoint
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, _: S, m: &Vector3<S>, v: &mut Vector3<S>, _: &mut ()) {
        *v = -self.omega(m);
    }
    /// m × J⁻¹m by its components: ṁ₁ = (1/J₃ − 1/J₂) m₂m₃, and so on. It is exactly 0 along the axis of a symmetric body.
    /// These products depend on each other less than those of m × ω, so a step is shorter.
    #[inline]
    fn field(&self, _: S, m: &Vector3<S>, dm: &mut Vector3<S>, _: &mut FieldStore<Self>) {
        let d = &self.differences;
        *dm = Vector3::new(d[0] * (m[1] * m[2]), d[1] * (m[2] * m[0]), d[2] * (m[0] * m[1]));
    }
}

/// The free rigid body by its attitude, as in the paper: ġ = f(g)·g on SO(3).
///
/// f(g) = ω_s = g J⁻¹ gᵀ m_s, equation (11). m_s is constant, and the body momentum is gᵀm_s.
#[derive(Clone, Copy, Debug)]
pub struct RigidBodyAttitude<S = f64> {
    body: RigidBody<S>,
    momentum_space: Vector3<S>,
}

impl<S: Real> RigidBodyAttitude<S> {
    /// Makes a body from the principal moments of inertia and the angular momentum in space.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment that is not finite and positive, or a momentum that is
    /// not finite.
    pub fn new(inertia: [f64; 3], momentum_space: [f64; 3]) -> Result<Self, Error> {
        Error::all_finite("momentum_space", &momentum_space)?;
        let [a, b, c] = momentum_space.map(S::lit);
        Ok(RigidBodyAttitude {
            body: RigidBody::new(inertia)?,
            momentum_space: Vector3::new(a, b, c),
        })
    }

    /// The body by its momentum only.
    pub fn body(&self) -> &RigidBody<S> {
        &self.body
    }

    /// m_s, the angular momentum in space.
    #[inline]
    pub fn momentum_space(&self) -> &Vector3<S> {
        &self.momentum_space
    }

    /// m = gᵀm_s, the angular momentum in the body.
    #[inline]
    pub fn momentum_body(&self, g: &Matrix3<S>) -> Vector3<S> {
        apply_transpose(g, &self.momentum_space)
    }

    /// ω_s = g J⁻¹ gᵀ m_s.
    #[inline(always)]
    fn omega_space(&self, g: &Matrix3<S>) -> Vector3<S> {
        apply3(g, &self.body.omega(&self.momentum_body(g)))
    }
}

impl<S: Real> Problem for RigidBodyAttitude<S> {
    type Group = So3<S>;
    type Action = LeftTranslation;
    type Work = ();

    fn group(&self) -> &So3<S> {
        self.body.group()
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, _: S, g: &Matrix3<S>, v: &mut Vector3<S>, _: &mut ()) {
        *v = self.omega_space(g);
    }
}
