//! The problems of the library as few types: one for each group and action, whatever the field.
//!
//! Every type of problem costs the compiler every method of the catalog with every map. So kinds share
//! a type where they share a group and an action, and the field stands behind a pointer: a call a stage,
//! around the evaluation and not inside it, is nothing beside the matrices and rotations of a stage.
//! The library has no such call.
//!
//! Those of vectors are there once more on numbers that count operations; matrices say themselves what they
//! compute.
//!
//! | family | kinds |
//! |---|---|
//! | SO(3), vectors | spin |
//! | SO(3)ᴺ, vectors | spin chains, many bodies, Euler's equations on so(3)* |
//! | SE(3), coadjoint | heavy tops, the spherical pendulum, Euler's equations on se(3)* |
//! | [`MatrixGroup`], [`MatrixAction`](super::matrix::MatrixAction) | all that is made of matrices |
//! | SO(3)ⁿ × SO(3)ᵐ × T(k), vectors and translation | what scenes compose from parts |
//! | SO(3) × T(3), SO(n) × T(2n), translation | bodies under torques, Lyapunov exponents |

use core::fmt;

use lieflow::Error;
use lieflow::actions::{Action, Coadjoint, LeftTranslation, Linear};
use lieflow::catalog::{
    LINEAR_METHODS, MethodSpec, OnEmbedded, OnMethod, with_embedded_pair, with_euler_method,
    with_implicit_method, with_linear_method,
};
use lieflow::groups::{LieAlgebra, LieGroup, MatrixGroup, Power, Product, Se3, So3, Translations};
use lieflow::methods::Metric;
use lieflow::problems::{
    AlgOf, Ambient, FromTheBody, LiePoisson, LinearField, LinearSpace, PointOf, Problem, ScalarOf,
};
use lieflow::scalar::{Counted, Real};
use nalgebra::Vector3;

use super::composed::{OnParts, Parts};
use super::matrix::MatrixAction;
use crate::erased::{Doubled, pointed, pointed_pair};
use crate::model::Catalog;

/// A field with its scratch.
pub(super) trait Field<G: LieGroup, M> {
    /// v ← f(t, y).
    fn f(&mut self, t: G::Scalar, y: &M, v: &mut G::Alg);
    /// dy ← F(t, y).
    fn ambient(&mut self, t: G::Scalar, y: &M, dy: &mut M);
    /// ξ ← ∇̄H(a, b). For Lie–Poisson systems: [`Catalog::with`] hands over no method that asks others.
    fn discrete_gradient(&mut self, _a: &M, _b: &M, _xi: &mut G::Alg) {}
}

/// What an element of 𝔤 does to a point of the linear space around M.
pub(super) trait Generator<G: LieGroup>: Action<G> {
    /// dy ← λ_*(v)(y); `scratch` is a point like y.
    fn generate(
        &self,
        v: &G::Alg,
        y: &Self::Point,
        dy: &mut Self::Point,
        scratch: &mut Self::Point,
    );
}

impl<S: Real> Generator<So3<S>> for Linear {
    fn generate(&self, v: &Vector3<S>, y: &Vector3<S>, dy: &mut Vector3<S>, _: &mut Vector3<S>) {
        So3::new().bracket(v, y, dy);
    }
}

/// H(m) of a Lie–Poisson system.
type Energy<M, S> = Box<dyn Fn(&M) -> S>;

/// A problem on M by G and Λ, whatever its field.
pub(super) struct Flow<G: LieGroup, A: Action<G>> {
    group: G,
    action: A,
    start: A::Point,
    linear: bool,
    hamiltonian: Option<Energy<A::Point, G::Scalar>>,
    field: Box<dyn Fn() -> Box<dyn Field<G, A::Point>>>,
}

impl<G: LieGroup, A: Action<G>> fmt::Debug for Flow<G, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Flow").field("group", &self.group.name()).finish_non_exhaustive()
    }
}

/// ξ ← ∇̄H(a, b), from the problem, a, b, ξ and scratch.
type Gradient<P> = fn(&P, &PointOf<P>, &PointOf<P>, &mut AlgOf<P>, &mut <P as Problem>::Work);

/// A problem of the library with its scratch; with its gradient where it is a Lie–Poisson system.
struct Running<P: Problem> {
    problem: std::rc::Rc<P>,
    work: P::Work,
    gradient: Option<Gradient<P>>,
}

impl<P: Ambient> Field<P::Group, PointOf<P>> for Running<P> {
    fn f(&mut self, t: ScalarOf<P>, y: &PointOf<P>, v: &mut AlgOf<P>) {
        self.problem.f(t, y, v, &mut self.work);
    }
    fn ambient(&mut self, t: ScalarOf<P>, y: &PointOf<P>, dy: &mut PointOf<P>) {
        self.problem.field(t, y, dy, &mut self.work);
    }
    fn discrete_gradient(&mut self, a: &PointOf<P>, b: &PointOf<P>, xi: &mut AlgOf<P>) {
        if let Some(gradient) = self.gradient {
            gradient(&self.problem, a, b, xi, &mut self.work);
        }
    }
}

/// An equation of linear type with its scratch, and its action.
struct RunningLinear<P: Problem, A: Action<P::Group>> {
    equation: std::rc::Rc<P>,
    work: P::Work,
    action: A,
    /// A(t).
    a: AlgOf<P>,
    scratch: A::Point,
}

impl<P, A> Field<P::Group, A::Point> for RunningLinear<P, A>
where
    P: LinearField,
    A: Generator<P::Group>,
{
    fn f(&mut self, t: ScalarOf<P>, _: &A::Point, v: &mut AlgOf<P>) {
        self.equation.a(t, v, &mut self.work);
    }
    fn ambient(&mut self, t: ScalarOf<P>, y: &A::Point, dy: &mut A::Point) {
        self.equation.a(t, &mut self.a, &mut self.work);
        self.action.generate(&self.a, y, dy, &mut self.scratch);
    }
}

impl<G, A> Flow<G, A>
where
    G: LieGroup + Clone + 'static,
    A: Action<G> + Clone + 'static,
{
    /// A problem of the library, and `start`; `action` is its action.
    pub(super) fn nonlinear<P>(problem: P, action: A, start: A::Point) -> (Self, A::Point)
    where
        P: Ambient<Group = G> + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        Self::of(std::rc::Rc::new(problem), action, start, None)
    }

    /// A Lie–Poisson system of the library, and `start`; `action` is its action.
    pub(super) fn lie_poisson<P>(problem: P, action: A, start: A::Point) -> (Self, A::Point)
    where
        P: LiePoisson + Problem<Group = G> + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        let problem = std::rc::Rc::new(problem);
        let gradient: Gradient<P> = P::discrete_gradient;
        let (mut flow, start) = Self::of(problem.clone(), action, start, Some(gradient));
        flow.hamiltonian = Some(Box::new(move |m| problem.hamiltonian(m)));
        (flow, start)
    }

    fn of<P>(
        problem: std::rc::Rc<P>,
        action: A,
        start: A::Point,
        gradient: Option<Gradient<P>>,
    ) -> (Self, A::Point)
    where
        P: Ambient<Group = G> + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        let group = problem.group().clone();
        let field = Box::new(move || -> Box<dyn Field<G, A::Point>> {
            Box::new(Running { problem: problem.clone(), work: problem.work(), gradient })
        });
        let flow =
            Flow { group, action, start: start.clone(), linear: false, hamiltonian: None, field };
        (flow, start)
    }

    /// An equation of linear type, A(t) of `equation` by `action`, and `start`.
    pub(super) fn linear<P>(equation: P, action: A, start: A::Point) -> (Self, A::Point)
    where
        P: LinearField<Group = G> + 'static,
        A: Generator<G>,
    {
        let (group, of_run, like) = (equation.group().clone(), action.clone(), start.clone());
        let equation = std::rc::Rc::new(equation);
        let field = Box::new(move || -> Box<dyn Field<G, A::Point>> {
            Box::new(RunningLinear {
                equation: equation.clone(),
                work: equation.work(),
                action: of_run.clone(),
                a: equation.group().zero(),
                scratch: like.clone(),
            })
        });
        let flow =
            Flow { group, action, start: start.clone(), linear: true, hamiltonian: None, field };
        (flow, start)
    }
}

impl<G, A> Problem for Flow<G, A>
where
    G: LieGroup,
    A: Action<G>,
{
    type Group = G;
    type Action = A;
    type Work = Box<dyn Field<G, A::Point>>;

    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &A {
        &self.action
    }
    fn work(&self) -> Self::Work {
        (self.field)()
    }
    fn f(&self, t: G::Scalar, y: &A::Point, v: &mut G::Alg, work: &mut Self::Work) {
        work.f(t, y, v);
    }
}

/// For those of linear type: [`Catalog::with`] hands over no such method for others.
impl<G, A> LinearField for Flow<G, A>
where
    G: LieGroup,
    A: Action<G>,
{
    fn a(&self, t: G::Scalar, v: &mut G::Alg, work: &mut Self::Work) {
        work.f(t, &self.start, v);
    }
}

impl<G, A> Ambient for Flow<G, A>
where
    G: LieGroup,
    A: Action<G, Point: LinearSpace<Scalar = G::Scalar>>,
{
    fn field(&self, t: G::Scalar, y: &A::Point, dy: &mut A::Point, work: &mut Self::Work) {
        work.ambient(t, y, dy);
    }
    fn copy(&self, x: &A::Point, y: &mut A::Point) {
        y.assign(x);
    }
    fn add(&self, a: G::Scalar, x: &A::Point, y: &mut A::Point) {
        y.add(a, x);
    }
    fn is_finite(&self, y: &A::Point) -> bool {
        y.is_finite()
    }
}

/// For Lie–Poisson systems: [`Catalog::with`] hands over no such method for others.
impl<G, A> LiePoisson for Flow<G, A>
where
    G: LieGroup,
    A: Action<G, Point: LinearSpace<Scalar = G::Scalar>>,
{
    fn hamiltonian(&self, m: &A::Point) -> G::Scalar {
        self.hamiltonian.as_ref().map_or(G::Scalar::lit(f64::NAN), |hamiltonian| hamiltonian(m))
    }
    fn discrete_gradient(
        &self,
        a: &A::Point,
        b: &A::Point,
        xi: &mut G::Alg,
        work: &mut Self::Work,
    ) {
        work.discrete_gradient(a, b, xi);
    }
}

macro_rules! family {
    (@find $self:ident, $spec:ident, $on:expr, linear) => {{
        let name = $spec.info()?.name;
        match $self.linear && LINEAR_METHODS.iter().any(|linear| linear.name == name) {
            true => with_linear_method(name, $on),
            false => family!(@find $self, $spec, $on, lie_poisson),
        }
    }};
    (@find $self:ident, $spec:ident, $on:expr, lie_poisson) => {
        match $self.hamiltonian {
            Some(_) => with_euler_method($spec, $on),
            None => with_implicit_method($spec, $on),
        }
    };
    (@find $self:ident, $spec:ident, $on:expr, general) => { with_implicit_method($spec, $on) };
    ($($group:ty, $action:ty, $type:ident;)*) => {$(
        impl Catalog for Flow<$group, $action> {
            fn with<V: OnMethod<Self>>(
                &self,
                spec: &MethodSpec,
                on: V,
            ) -> Result<V::Out, Error> {
                pointed(on, |found| family!(@find self, spec, found, $type))
            }
            fn with_estimate<V: OnEmbedded<Self>>(
                &self,
                spec: &MethodSpec,
                on: V,
            ) -> Result<V::Out, Error> {
                let pair = spec.has_pair()?;
                pointed_pair(on, |found| match pair {
                    true => with_embedded_pair(spec, found),
                    false => family!(@find self, spec, Doubled(found), $type),
                })
            }
        }
    )*};
}

/// (σ, x) of Lyapunov exponents.
pub(super) type Growth = (faer::Mat<f64>, faer::Mat<f64>);

family! {
    So3, Linear, linear;
    Power<So3>, Linear, lie_poisson;
    Se3, Coadjoint, lie_poisson;
    MatrixGroup, MatrixAction, linear;
    MatrixGroup, FromTheBody, general;
    Product<So3, Translations<Vector3<f64>>>, LeftTranslation, general;
    Product<MatrixGroup, Translations<Growth>>, LeftTranslation, general;
    Parts, OnParts, general;
    So3<Counted>, Linear, linear;
    Power<So3<Counted>>, Linear, lie_poisson;
    Se3<Counted>, Coadjoint, lie_poisson;
    Product<So3<Counted>, Translations<Vector3<Counted>>>, LeftTranslation, general;
    Parts<Counted>, OnParts, general;
}
