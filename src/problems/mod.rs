//! Problems: differential equations given by f : M → 𝔤, with further facts.
//!
//! | problem | group, action | types |
//! |---|---|---|
//! | free rigid body in ℝ³ and ℝⁿ | SO(3), SO(n); coadjoint or translation | [`RigidBody`], [`RigidBodyAttitude`], [`RigidBodyState`], [`RigidBodyN`] |
//! | and its attitude as a quaternion | S³; translation | [`RigidBodyQuaternion`] |
//! | Lie–Poisson: Euler's equations of any Hamiltonian | any; coadjoint | [`Euler`], [`EulerGroup`], [`Kinetic`] |
//! | heavy tops | SE(3); coadjoint | [`HeavyTop`] |
//! | rigid body under torques | SO(3) × T(3); translation | [`TorqueBody`], [`inertia`] |
//! | isospectral flows: Toda, QR, double bracket | SO(n); conjugation | [`IsospectralFlow`] |
//! | spherical pendulum, spin chain | SE(3); coadjoint; SO(3)ᴺ; vectors | [`SphericalPendulum`], [`SpinChain`] |
//! | spins on any bonds, with couplings in time | SO(3)ᴺ; vectors | [`CoupledSpins`] |
//! | Oja's flow | SO(n); n×k matrices | [`Oja`] |
//! | subspaces, the Grassmann manifold | SO(n); conjugation of projectors | [`SubspaceFlow`] |
//! | Lyapunov exponents of a vector field | SO(n) × T(2n); translation | [`Lyapunov`] |
//! | a closure of (t, y) or of t | any | [`Flow`]; [`DynFlow`] behind a pointer; [`TryFlow`] that may fail |
//! | Hill, Mathieu; beam lines | Sp(2m); translation | [`hill`], [`mathieu`], [`beam`]; [`floquet`](crate::floquet) |
//! | Riccati | Sp(2m); [`Lagrangian`](crate::actions::Lagrangian) | [`Flow::of_time`] |
//! | Schrödinger's equation, n levels | U(n) ⊂ SO(2n); vectors | [`schrodinger`](fn@schrodinger) |
//! | von Neumann's equation, n levels | U(n) ⊂ SO(2n); density matrices | [`von_neumann`] |
//! | ideal fluids on a sphere and a torus, Zeitlin's model | U(N); conjugation | [`Zeitlin`] |
//! | charged particle | SO(3,1); vectors | [`ChargedParticle`] |
//!
//! To add a problem: one file with an `impl` of [`Problem`], one line here.

mod averaged;
#[cfg(feature = "dense")]
pub mod beam;
mod capability;
mod coupled_spins;
mod dyn_flow;
mod euler;
mod fallible;
mod flow;
#[cfg(feature = "dense")]
mod grassmann;
mod heavy_top;
pub mod inertia;
mod invariants;
#[cfg(feature = "dense")]
mod isospectral;
#[cfg(feature = "dense")]
mod lorentz;
#[cfg(feature = "dense")]
mod lyapunov;
#[cfg(feature = "dense")]
mod momentum;
#[cfg(feature = "dense")]
mod oja;
#[cfg(feature = "dense")]
mod periodic;
mod quaternion_body;
mod rigid_body;
#[cfg(feature = "dense")]
mod schrodinger;
mod series;
mod spheres;
mod torque;
#[cfg(feature = "dense")]
mod zeitlin;

pub use crate::space::LinearSpace;
pub use averaged::MeanGradient;
pub use capability::{LiePoisson, LinearField, Orthogonal, Projection, Split};
pub use coupled_spins::{Bond, Constant, CoupledSpins, Couplings, CouplingsAt, Site};
pub use dyn_flow::{DynFlow, WithHamiltonian};
pub use euler::{
    DiscreteGradient, Euler, EulerGroup, FromTheBody, Hamiltonian, Kinetic, Quadratic,
};
pub use fallible::{Fallible, InAlgebra, TryFlow, TryProblem};
pub use flow::{
    BodyValue, Energy, Field, Flow, FlowFacts, InBody, LinearFlow, TaylorFlow, TimeAlone,
    WithSeries,
};
#[cfg(feature = "dense")]
pub use grassmann::SubspaceFlow;
pub use heavy_top::HeavyTop;
pub use invariants::{Invariant, Invariants, Law, Origin, Scale, explained_by_rounding};
#[cfg(feature = "dense")]
pub use isospectral::{IsospectralFlow, toda_lattice};
#[cfg(feature = "dense")]
pub use lorentz::{ChargedParticle, four_velocity, lorentz_transformation};
#[cfg(feature = "dense")]
pub use lyapunov::Lyapunov;
#[cfg(feature = "dense")]
pub(crate) use momentum::MomentumSeries;
#[cfg(feature = "dense")]
pub use oja::Oja;
#[cfg(feature = "dense")]
pub use periodic::{LinearHamiltonian, hill, mathieu};
pub use quaternion_body::RigidBodyQuaternion;
pub use rigid_body::{
    BodyFrame, BodyState, Exact, Frame, FreeBody, RigidBody, RigidBodyAttitude, RigidBodyState,
};
pub(crate) use rigid_body::{Place, check_moment};
#[cfg(feature = "dense")]
pub use rigid_body::{RigidBodyN, RigidBodyNAttitude, manakov_integrals};
#[cfg(feature = "dense")]
pub use schrodinger::{
    Schrodinger, VonNeumann, amplitudes, density_matrix, populations, populations_of, schrodinger,
    von_neumann,
};
pub use series::{MomentumTerms, TaylorField};
pub use spheres::{SphericalPendulum, SpinChain};
pub use torque::{BodyMotion, BodyTorque, SpaceTorque, Torque, TorqueBody};
#[cfg(feature = "dense")]
pub use zeitlin::{Sphere, Surface, Torus, Vortex, Zeitlin};

use crate::actions::Action;
use crate::groups::{LieAlgebra, LieGroup};

/// The type of the elements of 𝔤 of a problem.
pub type AlgOf<P> = <<P as Problem>::Group as LieAlgebra>::Alg;
/// The type of the elements of G of a problem.
pub type ElemOf<P> = <<P as Problem>::Group as LieGroup>::Elem;
/// The scalar type of a problem.
pub type ScalarOf<P> = <<P as Problem>::Group as LieAlgebra>::Scalar;
/// The type of the points of M of a problem.
pub type PointOf<P> = <<P as Problem>::Action as Action<<P as Problem>::Group>>::Point;

/// A differential equation on M by a group action: ẏ = F(t, y) = λ_*(f(t, y))(y), equation (13).
///
/// ```
/// use lieflow::actions::Linear;
/// use lieflow::groups::So3;
/// use lieflow::problems::Problem;
/// use lieflow::nalgebra::Vector3;
///
/// /// A vector that turns about e₃ at the rate t.
/// struct Spin(So3, Linear);
/// impl Problem for Spin {
///     type Group = So3;
///     type Action = Linear;
///     type Work = ();
///     fn group(&self) -> &So3 { &self.0 }
///     fn action(&self) -> &Linear { &self.1 }
///     fn work(&self) {}
///     fn f(&self, t: f64, _x: &Vector3<f64>, v: &mut Vector3<f64>, _: &mut ()) {
///         *v = Vector3::new(0.0, 0.0, t);
///     }
/// }
/// ```
pub trait Problem {
    /// The group G.
    type Group: LieGroup;
    /// The action Λ.
    type Action: Action<Self::Group>;
    /// Scratch of f; `()` when it needs none.
    type Work: Send;

    /// G as a value.
    fn group(&self) -> &Self::Group;
    /// Λ as a value.
    fn action(&self) -> &Self::Action;
    /// Makes the scratch for [`f`](Self::f). Only this call allocates.
    fn work(&self) -> Self::Work;
    /// v ← f(t, y) ∈ 𝔤.
    ///
    /// If f has no value at (t, y), write NaN: the step then fails with
    /// [`StepError::NonFiniteRhs`](crate::StepError::NonFiniteRhs). For your own type of error use a [`TryProblem`].
    fn f(&self, t: ScalarOf<Self>, y: &PointOf<Self>, v: &mut AlgOf<Self>, work: &mut Self::Work);

    /// dy ← F(t, y) = λ_*(f(t, y))(y), equation (13), a tangent of M in the storage of a point. Override
    /// it if F is cheaper than f and λ_*.
    #[inline]
    fn field(
        &self,
        t: ScalarOf<Self>,
        y: &PointOf<Self>,
        dy: &mut PointOf<Self>,
        store: &mut FieldStore<Self>,
    ) {
        let FieldStore { v, action, work } = store;
        self.f(t, y, v, work);
        self.action().generate(self.group(), v, y, dy, action);
    }
}

/// The storage of [`Problem::field`], made once.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct FieldStore<P: Problem + ?Sized> {
    /// f(t, y).
    pub v: AlgOf<P>,
    /// Scratch of the action.
    pub action: <P::Action as Action<P::Group>>::Work,
    /// Scratch of f.
    pub work: P::Work,
}

impl<P: Problem> FieldStore<P> {
    /// Makes storage for `problem`.
    pub fn new(problem: &P) -> Self {
        let group = problem.group();
        FieldStore { v: group.zero(), action: problem.action().work(group), work: problem.work() }
    }
}

/// A problem on an M in a linear space, so that classical methods apply, too.
///
/// Every problem whose points are a [`LinearSpace`] has this trait.
pub trait Ambient:
    Problem<Action: Action<Self::Group, Point: LinearSpace<Scalar = ScalarOf<Self>>>>
{
}

impl<P: Problem> Ambient for P where
    P::Action: Action<P::Group, Point: LinearSpace<Scalar = ScalarOf<P>>>
{
}
