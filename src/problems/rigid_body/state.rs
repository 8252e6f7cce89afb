//! The free rigid body by momentum and attitude together: y = (m, g).
//!
//! The group acts from the body's side, Λ(a, (m, g)) = (a m, g aᵀ), a left action; with
//! f(m, g) = −J⁻¹m it gives ṁ = m × ω, ġ = g ω̂, and the left version of the paper's methods,
//! g⁺ = g Ψ(v), m⁺ = Ad*_{Ψ(v)} m = Ψ(v)⁻¹m. Every method that acts by the group conserves gm = m_s to rounding. m is
//! stored and not recomputed from g. This matters near the separatrix, where a momentum that is recomputed from g
//! crosses it.

use nalgebra::{Matrix3, Vector3};

use super::RigidBody;
use crate::actions::Action;
use crate::error::Error;
use crate::groups::{Adjoint, LieGroup, So3, worse};
use crate::problems::Problem;
use crate::scalar::Real;
use crate::so3::{apply3, cross};
use crate::space::{LinearSpace, Metric, Numbers};

/// The body momentum m and the attitude g.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState<S = f64> {
    /// m, in the body.
    pub m: Vector3<S>,
    /// g, from body to space.
    pub g: Matrix3<S>,
}

impl<S: Real + Numbers> Numbers for BodyState<S> {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.m.each_number(each);
        self.g.each_number(each);
    }
}

/// (|m|² + ‖g‖²)^½.
impl<S: Real> Metric for BodyState<S> {
    type Scalar = S;
    #[inline]
    fn assign(&mut self, x: &Self) {
        *self = *x;
    }
    #[inline]
    fn size(&self) -> S {
        let (m, g) = (self.m.size(), self.g.size());
        (m * m + g * g).sqrt()
    }
    #[inline]
    fn distance(&self, x: &Self) -> S {
        let (m, g) = (self.m.distance(&x.m), Metric::distance(&self.g, &x.g));
        (m * m + g * g).sqrt()
    }
    #[inline]
    fn is_same(&self, x: &Self) -> bool {
        self == x
    }
}

impl<S: Real> LinearSpace for BodyState<S> {
    #[inline]
    fn clear(&mut self) {
        self.m.clear();
        self.g.clear();
    }
    #[inline]
    fn add(&mut self, a: S, x: &Self) {
        self.m.add(a, &x.m);
        self.g.add(a, &x.g);
    }
    #[inline]
    fn dot(&self, x: &Self) -> S {
        LinearSpace::dot(&self.m, &x.m) + LinearSpace::dot(&self.g, &x.g)
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.m.is_finite() && self.g.is_finite()
    }
}

/// Λ(a, (m, g)) = (a m, g aᵀ).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyFrame;

impl<S: Real> Action<So3<S>> for BodyFrame {
    type Point = BodyState<S>;
    /// For [`restore`](Action::restore).
    type Work = [Matrix3<S>; 2];

    fn work(&self, group: &So3<S>) -> Self::Work {
        [group.identity(), group.identity()]
    }
    #[inline]
    fn check(&self, group: &So3<S>, p: &BodyState<S>) -> Result<(), Error> {
        group.check_vector(&p.m)?;
        group.check_elem(&p.g)
    }
    #[inline]
    fn act(
        &self,
        group: &So3<S>,
        a: &Matrix3<S>,
        p: &BodyState<S>,
        q: &mut BodyState<S>,
        _: &mut Self::Work,
    ) {
        group.apply(a, &p.m, &mut q.m);
        group.compose(&p.g, &a.transpose(), &mut q.g);
    }
    /// (v × m, −g v̂): row by row r v̂ = r × v.
    #[inline]
    fn generate(
        &self,
        group: &So3<S>,
        v: &Vector3<S>,
        y: &BodyState<S>,
        dy: &mut BodyState<S>,
        _: &mut Self::Work,
    ) {
        dy.m = cross(v, &y.m);
        group.tangent_in_body(&y.g, &-v, &mut dy.g);
    }
    /// Corrects g to SO(3). m has no constraint.
    fn restore(&self, group: &So3<S>, p: &mut BodyState<S>, work: &mut Self::Work) -> Option<S> {
        Some(group.correct(&mut p.g, work.each_mut()))
    }
    /// Corrects g to SO(3), and m to its sphere.
    fn restore_to(
        &self,
        group: &So3<S>,
        from: &BodyState<S>,
        p: &mut BodyState<S>,
        work: &mut Self::Work,
    ) -> Option<S> {
        worse(group.correct_vector(&from.m, &mut p.m), self.restore(group, p, work))
    }
}

/// The free rigid body on 𝔰𝔬(3)* × SO(3): ṁ = m × J⁻¹m, ġ = g ω̂ with ω = J⁻¹m.
///
/// As an [`Ambient`](crate::problems::Ambient) problem it has 12 components.
///
/// ```
/// use lieflow::methods::{Splitting, YOSHIDA4};
/// use lieflow::problems::{Exact, RigidBodyState};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Matrix3;
///
/// let body = RigidBodyState::new([1.0, 2.0, 3.0])?;
/// let mut y = body.state([0.2, 0.5, 3.0], Matrix3::identity())?;
/// let grid = TimeGrid::new([0.0, 10.0], 0.02)?;
/// let method = Splitting::new([0, 1, 2], YOSHIDA4);
/// integrate(&body, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
/// let (m, g) = Exact::new([1.0, 2.0, 3.0], [0.2, 0.5, 3.0], Matrix3::identity())?.state(10.0)?;
/// assert!((y.m - m).norm() < 1e-5 && (y.g - g).norm() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RigidBodyState<S = f64> {
    body: RigidBody<S>,
}

impl<S: Real> RigidBodyState<S> {
    /// Makes a body from the principal moments of inertia J₁, J₂, J₃.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment that is not finite and positive.
    pub fn new(inertia: [f64; 3]) -> Result<Self, Error> {
        Ok(RigidBodyState { body: RigidBody::new(inertia)? })
    }

    /// The body by its momentum only.
    pub fn body(&self) -> &RigidBody<S> {
        &self.body
    }

    /// E = ½ m·J⁻¹m.
    pub fn energy(&self, y: &BodyState<S>) -> S {
        self.body.energy(&y.m)
    }

    /// gm, the angular momentum in space.
    pub fn momentum_space(&self, y: &BodyState<S>) -> Vector3<S> {
        apply3(&y.g, &y.m)
    }
}

impl RigidBodyState<f64> {
    /// Makes a state from a body momentum and an attitude.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a momentum that is not finite, and [`So3::check_element`]'s errors
    /// for an attitude that is not a rotation within 1e-6.
    pub fn state(
        &self,
        momentum_body: [f64; 3],
        attitude: Matrix3<f64>,
    ) -> Result<BodyState, Error> {
        Error::all_finite("momentum_body", &momentum_body)?;
        self.group().check_element("attitude", &attitude, 1e-6)?;
        Ok(BodyState { m: momentum_body.into(), g: attitude })
    }
}

impl<S: Real> Problem for RigidBodyState<S> {
    type Group = So3<S>;
    type Action = BodyFrame;
    type Work = ();

    fn group(&self) -> &So3<S> {
        self.body.group()
    }
    fn action(&self) -> &BodyFrame {
        &BodyFrame
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, t: S, y: &BodyState<S>, v: &mut Vector3<S>, work: &mut ()) {
        self.body.f(t, &y.m, v, work);
    }
}
