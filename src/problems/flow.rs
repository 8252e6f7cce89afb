//! A problem from a closure: a group, an action and f(t, y), with further facts.
//!
//! | fact | added by | capability |
//! |---|---|---|
//! | f depends only on t, f(t, y) = A(t) | [`Flow::of_time`], [`Flow::linear`] | [`LinearField`] |
//! | and the derivatives of A are known | [`Flow::of_derivatives`] | [`LinearField`], [`TaylorField`] |
//! | f(m) = −∇H(m) | [`Flow::hamiltonian`] | [`LiePoisson`], [`Invariants`] |
//! | a quantity that is constant | [`Flow::invariant`] | [`Invariants`] |

use core::fmt;

use super::averaged::mean_of_gradients;
use super::{Invariant, Invariants, LiePoisson, LinearField, LinearSpace, Problem, TaylorField};
use crate::actions::{Action, RightTranslation};
use crate::groups::{Adjoint, LieAlgebra, LieGroup};
use crate::scalar::Real;
use crate::space::Metric;

/// A problem ẏ = λ_*(f(t, y))(y) from a group, an action and a closure that writes f(t, y) ∈ 𝔤.
///
/// It is compiled for its closure, so a step is as fast as with your own `impl` of [`Problem`].
///
/// ```
/// use lieflow::actions::Coadjoint;
/// use lieflow::groups::So3;
/// use lieflow::maps::Cay;
/// use lieflow::methods::EnergyCasimir;
/// use lieflow::problems::Flow;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
///
/// // A free rigid body: f = −J⁻¹m, H = ½ m·J⁻¹m.
/// let omega = |m: &Vector3<f64>| m.component_div(&Vector3::new(1.0, 2.0, 3.0));
/// let body = Flow::new(So3::<f64>::new(), Coadjoint, |_, m, v| *v = -omega(m))
///     .hamiltonian(|m| 0.5 * m.dot(&omega(m)));
/// let (mut m, start) = (Vector3::new(0.2, 1.0, 3.0), Vector3::new(0.2, 1.0, 3.0));
/// let grid = TimeGrid::new([0.0, 100.0], 0.1)?;
/// integrate(&body, &EnergyCasimir::new(Cay), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((m.dot(&omega(&m)) - start.dot(&omega(&start))).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A method that needs a missing fact does not compile:
/// ```compile_fail
/// # use lieflow::{actions::Coadjoint, groups::So3, maps::Cay, methods::EnergyCasimir, problems::Flow};
/// let body = Flow::new(So3::<f64>::new(), Coadjoint, |_, m, v| *v = -m);
/// lieflow::Method::facts(&EnergyCasimir::new(Cay), &body);
/// ```
#[derive(Clone, Copy)]
pub struct Flow<G, A, F, K = FlowFacts> {
    group: G,
    action: A,
    field: F,
    facts: K,
}

/// A [`Flow`] whose closure writes A(t), f(t, y) = A(t).
pub type LinearFlow<G, A, F> = Flow<G, A, OfTime<F>, FlowFacts<TimeAlone>>;

/// A [`Flow`] whose closure writes A(t) and its derivatives, f(t, y) = A(t).
pub type TaylorFlow<G, A, F> = Flow<G, A, OfDerivatives<F>, FlowFacts<WithSeries<TimeAlone>>>;

/// The facts about a [`Flow`]: whether f depends only on t and has derivatives, H, and further invariants.
#[derive(Clone, Copy, Debug, Default)]
pub struct FlowFacts<L = (), H = (), I = ()> {
    linear: L,
    energy: H,
    invariants: I,
}

/// The fact that f depends only on t.
#[derive(Clone, Copy, Debug, Default)]
pub struct TimeAlone;

/// The fact that f has Taylor coefficients, with the fact L about f.
#[derive(Clone, Copy, Debug, Default)]
pub struct WithSeries<L = ()>(L);

type With<G, A, F, L, H, I> = Flow<G, A, F, FlowFacts<L, H, I>>;

/// f(t, y) of a [`Flow`]: a closure, or one with scratch.
pub trait Field<G: LieGroup, A: Action<G>> {
    /// Scratch.
    type Work: Send;
    /// Scratch for [`f`](Self::f).
    fn work(&self) -> Self::Work;
    /// v ← f(t, y).
    fn f(&self, t: G::Scalar, y: &A::Point, v: &mut G::Alg, work: &mut Self::Work);
}

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, &A::Point, &mut G::Alg)> Field<G, A> for F {
    type Work = ();

    fn work(&self) {}
    #[inline]
    fn f(&self, t: G::Scalar, y: &A::Point, v: &mut G::Alg, _: &mut ()) {
        self(t, y, v);
    }
}

/// A closure of t only.
#[derive(Clone, Copy, Debug)]
pub struct OfTime<F>(F);

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, &mut G::Alg)> Field<G, A> for OfTime<F> {
    type Work = ();

    fn work(&self) {}
    #[inline]
    fn f(&self, t: G::Scalar, _: &A::Point, v: &mut G::Alg, _: &mut ()) {
        (self.0)(t, v);
    }
}

/// A closure of t and the number of a derivative.
#[derive(Clone, Copy, Debug)]
pub struct OfDerivatives<F>(F);

impl<G, A, F> Field<G, A> for OfDerivatives<F>
where
    G: LieGroup,
    A: Action<G>,
    F: Fn(G::Scalar, usize, &mut G::Alg),
{
    type Work = ();

    fn work(&self) {}
    #[inline]
    fn f(&self, t: G::Scalar, _: &A::Point, v: &mut G::Alg, _: &mut ()) {
        (self.0)(t, 0, v);
    }
}

/// A closure with scratch, and a closure that makes the scratch.
#[derive(Clone, Copy, Debug)]
pub struct WithWork<M, F> {
    make: M,
    field: F,
}

impl<G, A, W, M, F> Field<G, A> for WithWork<M, F>
where
    G: LieGroup,
    A: Action<G>,
    W: Send,
    M: Fn() -> W,
    F: Fn(G::Scalar, &A::Point, &mut G::Alg, &mut W),
{
    type Work = W;

    fn work(&self) -> W {
        (self.make)()
    }
    #[inline]
    fn f(&self, t: G::Scalar, y: &A::Point, v: &mut G::Alg, work: &mut W) {
        (self.field)(t, y, v, work);
    }
}

const UNKNOWN: FlowFacts = FlowFacts { linear: (), energy: (), invariants: () };

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, &A::Point, &mut G::Alg)> Flow<G, A, F> {
    /// Makes the problem. `field(t, y, v)` writes f(t, y) into v, which is 0 before: entries that are 0 may be left
    /// out.
    ///
    /// A closure of t alone is for [`of_time`](Self::of_time): methods for linear equations need it.
    #[doc(alias = "from_fn")]
    pub const fn new(group: G, action: A, field: F) -> Self {
        Flow { group, action, field, facts: UNKNOWN }
    }
}

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, &mut G::Alg)> LinearFlow<G, A, F> {
    /// Makes a linear equation ẏ = λ_*(A(t))(y); on a matrix group this is Ẏ = A(t)Y. `field(t, v)` writes A(t)
    /// into v, which is 0 before.
    ///
    /// ```
    /// use lieflow::actions::Linear;
    /// use lieflow::groups::So3;
    /// use lieflow::methods::magnus::Magnus4;
    /// use lieflow::problems::Flow;
    /// use lieflow::{SaveAt, TimeGrid, integrate};
    /// use lieflow::nalgebra::Vector3;
    ///
    /// // A spin in a rotating field.
    /// let spin = Flow::of_time(So3::<f64>::new(), Linear, |t, v| {
    ///     *v = Vector3::new(t.cos(), t.sin(), 2.0);
    /// });
    /// let mut x = Vector3::new(0.0, 0.0, 1.0);
    /// let grid = TimeGrid::new([0.0, 1.0], 0.01)?;
    /// integrate(&spin, &Magnus4, &grid, &SaveAt::Ends, &mut x, |_, _| {})?;
    /// assert!((x.norm() - 1.0).abs() < 1e-13);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn of_time(group: G, action: A, field: F) -> Self {
        let facts = FlowFacts { linear: TimeAlone, energy: (), invariants: () };
        Flow { group, action, field: OfTime(field), facts }
    }
}

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, usize, &mut G::Alg)> TaylorFlow<G, A, F> {
    /// Makes a linear equation ẏ = λ_*(A(t))(y) whose A has known derivatives. Lie series methods need them, and
    /// Magnus methods take A(t) alone.
    ///
    /// `field(t, k, v)` writes the k-th derivative of A at t into v, without 1/k!, and A(t) itself for k = 0. v is 0
    /// before. A method of order p calls it with k = 0, …, p − 1, and p is at most 16. A derivative that is left out
    /// counts as 0. So write NaN for one that you do not know: then a method that needs it fails. Lie series, and
    /// methods by name with them, are for SO(3), SE(3) and matrix groups.
    ///
    /// ```
    /// use lieflow::methods::LieSeries;
    /// use lieflow::nalgebra::Vector3;
    /// use lieflow::prelude::*;
    ///
    /// // A spin in a rotating field. A derivative of cos t and sin t turns them by a right angle.
    /// let spin = Flow::of_derivatives(So3::<f64>::new(), Linear, |t, k, v| {
    ///     let (sin, cos) = (t + k as f64 * std::f64::consts::FRAC_PI_2).sin_cos();
    ///     *v = Vector3::new(cos, sin, if k == 0 { 2.0 } else { 0.0 });
    /// });
    /// let method = LieSeries::new(16)?;
    /// let run = Solve::new(&spin, &method, [0.0, 10.0]).tolerances(1e-12, 0.0).run(Vector3::z())?;
    /// // In the frame of the field the spin turns about (1, 0, 1) at the rate √2.
    /// let exact = 0.5 + 0.5 * (10.0 * 2f64.sqrt()).cos();
    /// assert!((run.y.z - exact).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn of_derivatives(group: G, action: A, field: F) -> Self {
        let facts = FlowFacts { linear: WithSeries(TimeAlone), energy: (), invariants: () };
        Flow { group, action, field: OfDerivatives(field), facts }
    }
}

impl<G: LieGroup, A: Action<G>, F: Field<G, A>, L> Flow<G, A, F, FlowFacts<L>>
where
    Self: LinearField,
{
    /// The equation with the same A(t) and another action.
    pub fn by<B: Action<G>>(self, action: B) -> Flow<G, B, F, FlowFacts<L>> {
        Flow { group: self.group, action, field: self.field, facts: self.facts }
    }
}

/// A closure that writes f(t, y) in the body frame, and the group. The field of a [`RightTranslation`] is −f.
#[derive(Clone, Copy, Debug)]
pub struct InBody<G, F> {
    group: G,
    field: F,
}

impl<G, F> Field<G, RightTranslation> for InBody<G, F>
where
    G: Adjoint,
    F: Fn(G::Scalar, &G::Elem, &mut G::Alg),
{
    type Work = BodyValue<G::Alg>;

    fn work(&self) -> BodyValue<G::Alg> {
        BodyValue(self.group.zero())
    }
    #[inline]
    fn f(&self, t: G::Scalar, y: &G::Elem, v: &mut G::Alg, body: &mut BodyValue<G::Alg>) {
        let BodyValue(body) = body;
        self.group.set_zero(body);
        (self.field)(t, y, body);
        self.group.set_zero(v);
        self.group.axpy(G::Scalar::lit(-1.0), body, v);
    }
}

/// The value of a field in the body frame.
#[derive(Clone, Debug)]
pub struct BodyValue<V>(V);

impl<G, F> Flow<G, RightTranslation, InBody<G, F>>
where
    G: Adjoint + Clone,
    F: Fn(G::Scalar, &G::Elem, &mut G::Alg),
{
    /// Makes the problem ẏ = y·f(t, y) on a group, with f in the body frame: an angular velocity that a gyroscope measures,
    /// or the twist of a robot in its own axes. `field(t, y, v)` writes f(t, y) into v, which is 0 before.
    ///
    /// It is the action Λ(g, y) = y·g⁻¹ with the field −f. So f is not turned into space, and where it depends on t alone
    /// the equation is linear ([`linear`](Self::linear)), and Magnus methods fit. Events and rows see −f nowhere.
    ///
    /// ```
    /// use lieflow::groups::Se3;
    /// use lieflow::nalgebra::{Matrix3, Vector3};
    /// use lieflow::prelude::*;
    ///
    /// // A robot that drives forward at speed 1 and turns left at rate 1: a circle of radius 1.
    /// let robot = Flow::in_body(Se3::new(), |_, _, twist| *twist = (Vector3::z(), Vector3::x()));
    /// let (method, start) = (Rkmk::new(RK4, Exp), (Matrix3::identity(), Vector3::zeros()));
    /// let end = Solve::new(&robot, &method, [0.0, std::f64::consts::PI]).steps(100).run(start)?.y;
    /// assert!((end.1 - Vector3::new(0.0, 2.0, 0.0)).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn in_body(group: G, field: F) -> Self {
        let field = InBody { group: group.clone(), field };
        Flow { group, action: RightTranslation, field, facts: UNKNOWN }
    }
}

impl<G: LieGroup, A: Action<G>, M, F> Flow<G, A, WithWork<M, F>> {
    /// Makes the problem of a field with scratch. `make()` makes the scratch once for a run. `field(t, y, v, scratch)`
    /// writes f(t, y) into v, which is 0 before.
    pub const fn with_work<W>(group: G, action: A, make: M, field: F) -> Self
    where
        M: Fn() -> W,
        F: Fn(G::Scalar, &A::Point, &mut G::Alg, &mut W),
    {
        Flow { group, action, field: WithWork { make, field }, facts: UNKNOWN }
    }
}

impl<G: LieGroup, A: Action<G>, F, L, H, I> With<G, A, F, L, H, I> {
    /// Adds the fact that f depends only on t. Magnus methods then apply, and are wrong if it is not true.
    pub fn linear(self) -> With<G, A, F, TimeAlone, H, I> {
        let Flow { group, action, field, facts: FlowFacts { energy, invariants, .. } } = self;
        Flow { group, action, field, facts: FlowFacts { linear: TimeAlone, energy, invariants } }
    }

    /// Adds the Hamiltonian of f(m) = −∇H(m) under the coadjoint action. f must not depend on t: methods that conserve H take
    /// f at t = 0.
    ///
    /// H becomes the invariant `energy`. Methods that conserve it take the mean of −f between two points as discrete
    /// gradient.
    pub fn hamiltonian<E: Fn(&A::Point) -> G::Scalar>(
        self,
        value: E,
    ) -> With<G, A, F, L, Energy<E>, I> {
        let Flow { group, action, field, facts: FlowFacts { linear, invariants, .. } } = self;
        Flow {
            group,
            action,
            field,
            facts: FlowFacts { linear, energy: Energy(value), invariants },
        }
    }

    /// Adds an invariant: its name and its value.
    pub fn invariant<Q: Fn(&A::Point) -> G::Scalar>(
        self,
        invariant: Invariant,
        value: Q,
    ) -> With<G, A, F, L, H, Quantity<I, Q>> {
        let Flow { group, action, field, facts: FlowFacts { linear, energy, invariants } } = self;
        let invariants = Quantity { before: invariants, invariant, value };
        Flow { group, action, field, facts: FlowFacts { linear, energy, invariants } }
    }
}

/// The Hamiltonian of a [`Flow`].
#[derive(Clone, Copy, Debug)]
pub struct Energy<E>(E);

/// An invariant of a [`Flow`], after the earlier ones.
#[derive(Clone, Debug)]
pub struct Quantity<I, Q> {
    before: I,
    invariant: Invariant,
    value: Q,
}

/// A list of invariants.
pub trait Quantities<M, S> {
    /// Calls `take` with each and its value at y.
    fn each(&self, y: &M, take: &mut dyn FnMut(S));
    /// The names of all of them.
    fn names(&self) -> Vec<Invariant>;
}

impl<M, S> Quantities<M, S> for () {
    fn each(&self, _: &M, _: &mut dyn FnMut(S)) {}
    fn names(&self) -> Vec<Invariant> {
        Vec::new()
    }
}

impl<M, S, E: Fn(&M) -> S> Quantities<M, S> for Energy<E> {
    fn each(&self, y: &M, take: &mut dyn FnMut(S)) {
        take((self.0)(y));
    }
    fn names(&self) -> Vec<Invariant> {
        vec![Invariant::of_the_flow("energy", 0)]
    }
}

impl<M, S, I: Quantities<M, S>, Q: Fn(&M) -> S> Quantities<M, S> for Quantity<I, Q> {
    fn each(&self, y: &M, take: &mut dyn FnMut(S)) {
        self.before.each(y, take);
        take((self.value)(y));
    }
    fn names(&self) -> Vec<Invariant> {
        let mut names = self.before.names();
        names.push(self.invariant.clone());
        names
    }
}

impl<G: LieAlgebra, A, F, K> fmt::Debug for Flow<G, A, F, K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Flow").field("group", &self.group.name()).finish_non_exhaustive()
    }
}

impl<G: LieGroup, A: Action<G>, F: Field<G, A>, K> Problem for Flow<G, A, F, K> {
    type Group = G;
    type Action = A;
    type Work = F::Work;

    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &A {
        &self.action
    }
    fn work(&self) -> F::Work {
        self.field.work()
    }
    #[inline]
    fn f(&self, t: G::Scalar, y: &A::Point, v: &mut G::Alg, work: &mut F::Work) {
        self.group.set_zero(v);
        self.field.f(t, y, v, work);
        if self.group.check_shape("f", v).is_err() {
            // A function that stored a value of another size: no number of it is used, and the run ends with that.
            *v = self.group.zero();
            self.group.axpy(G::Scalar::lit(f64::NAN), &self.group.zero(), v);
        }
    }
}

impl<G, A, F, H, I> LinearField for Flow<G, A, F, FlowFacts<TimeAlone, H, I>>
where
    G: LieGroup,
    A: Action<G>,
    F: Field<G, A>,
{
}

impl<G, A, F, H, I> LinearField for Flow<G, A, F, FlowFacts<WithSeries<TimeAlone>, H, I>>
where
    G: LieGroup,
    A: Action<G>,
    F: Field<G, A>,
{
}

/// The coefficient of θᵏ in A(t + θh) is A⁽ᵏ⁾(t) hᵏ/k!.
impl<G, A, F, L, H, I> TaylorField for Flow<G, A, OfDerivatives<F>, FlowFacts<WithSeries<L>, H, I>>
where
    G: LieGroup,
    A: Action<G>,
    F: Fn(G::Scalar, usize, &mut G::Alg),
{
    type Series = G::Alg;

    fn series(&self, _: usize) -> G::Alg {
        self.group.zero()
    }
    fn coefficient(
        &self,
        [t, h]: [G::Scalar; 2],
        _: &A::Point,
        k: usize,
        f: &mut [G::Alg],
        derivative: &mut G::Alg,
    ) {
        let lit = G::Scalar::lit;
        let scale = (1..=k).fold(lit(1.0), |scale, i| scale * h / lit(i as f64));
        self.group.set_zero(derivative);
        (self.field.0)(t, k, derivative);
        self.group.combine(scale, &[1.0], core::slice::from_ref(derivative), &mut f[k]);
    }
}

impl<G, A, F, L, E, I> LiePoisson for Flow<G, A, F, FlowFacts<L, Energy<E>, I>>
where
    G: LieGroup,
    A: Action<G, Point: LinearSpace<Scalar = G::Scalar>>,
    F: Field<G, A>,
    E: Fn(&A::Point) -> G::Scalar,
{
    fn hamiltonian(&self, m: &A::Point) -> G::Scalar {
        (self.facts.energy.0)(m)
    }
    /// At t = 0, because a Hamiltonian system does not depend on t.
    fn discrete_gradient(
        &self,
        a: &A::Point,
        b: &A::Point,
        xi: &mut G::Alg,
        (m, v): (&mut A::Point, &mut G::Alg),
        work: &mut F::Work,
    ) {
        let lit = G::Scalar::lit;
        mean_of_gradients(&self.group, xi, v, |s, v| {
            m.assign(a);
            m.add(-s, a);
            m.add(s, b);
            self.f(lit(0.0), m, v, work);
        });
        self.group.set_zero(v);
        self.group.axpy(lit(-1.0), xi, v);
        core::mem::swap(v, xi);
    }
}

impl<G, A, F, L, H, I> Invariants for Flow<G, A, F, FlowFacts<L, H, I>>
where
    G: LieGroup,
    A: Action<G>,
    F: Field<G, A>,
    H: Quantities<A::Point, G::Scalar>,
    I: Quantities<A::Point, G::Scalar>,
{
    fn invariants(&self) -> Vec<Invariant> {
        let mut all = self.facts.energy.names();
        all.extend(self.facts.invariants.names());
        all
    }
    fn values(&self, y: &A::Point) -> Vec<G::Scalar> {
        let mut all = Vec::new();
        self.facts.energy.each(y, &mut |x| all.push(x));
        self.facts.invariants.each(y, &mut |x| all.push(x));
        all
    }
}
