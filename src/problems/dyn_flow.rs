//! One type for all problems on a group and an action: f is behind a pointer.
//!
//! The compiler compiles every method again for each type of problem. A program with many problems and many methods
//! compiles faster if problems with the same group and action share one type. The cost is one call for each evaluation
//! of f.

use core::fmt;
use core::marker::PhantomData;
use std::sync::Arc;

use super::flow::{TimeAlone, WithSeries};
use super::{AlgOf, LiePoisson, LinearField, LinearSpace, PointOf, Problem, ScalarOf, TaylorField};
use crate::actions::Action;
use crate::groups::{LieAlgebra, LieGroup};
use crate::problems::FieldStore;
use crate::scalar::Real;

/// A problem on M with any field. Its further facts are known at run time.
///
/// With L = [`TimeAlone`] some problems of the type may be linear. With L = [`WithSeries`] some may have Taylor
/// coefficients, and with L = `WithSeries<TimeAlone>` some may be linear, too. With H = [`WithHamiltonian`] some may be
/// Lie–Poisson systems. [`is_linear`](Self::is_linear), [`has_series`](Self::has_series) and
/// [`is_lie_poisson`](Self::is_lie_poisson) are facts of each problem. Methods by name use them.
///
/// ```
/// use lieflow::actions::Linear;
/// use lieflow::groups::So3;
/// use lieflow::methods::{Rk, tableau::RK4};
/// use lieflow::problems::{DynFlow, Flow, TimeAlone};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
/// let so3 = So3::<f64>::new();
/// let problems: [DynFlow<_, _, TimeAlone>; 2] = [
///     DynFlow::new(Flow::new(so3, Linear, |_, x, v| *v = Vector3::new(0.0, 0.0, x[0])), Linear),
///     DynFlow::linear(Flow::of_time(so3, Linear, |t, v| *v = Vector3::new(0.0, 0.0, t)), Linear),
/// ];
/// let grid = TimeGrid::new([0.0, 1.0], 0.1)?;
/// for problem in &problems {
///     let mut x = Vector3::x();
///     integrate(problem, &Rk(RK4), &grid, &SaveAt::Ends, &mut x, |_, _| {})?;
///     assert!((x.norm() - 1.0).abs() < 1e-5);
/// }
/// assert!(problems[1].is_linear());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct DynFlow<G: LieGroup, A: Action<G>, L = (), H = ()> {
    known: PhantomData<fn() -> (L, H)>,
    group: G,
    action: A,
    linear: bool,
    series: Option<MakeSeries<G, A::Point>>,
    energy: Option<Energy<A::Point, G::Scalar>>,
    work: Box<dyn Fn() -> DynWork<G, A::Point> + Send + Sync>,
}

/// Marks a type of problems of which some have a Hamiltonian.
#[derive(Clone, Copy, Debug, Default)]
pub struct WithHamiltonian;

/// [`TaylorField::coefficient`] with its storage.
type Coefficient<G, M> =
    Box<dyn FnMut([<G as LieAlgebra>::Scalar; 2], &M, usize, &mut [<G as LieAlgebra>::Alg]) + Send>;
/// [`TaylorField::series`].
type MakeSeries<G, M> = Box<dyn Fn(usize) -> Coefficient<G, M> + Send + Sync>;

/// The Taylor coefficients of a [`DynFlow`].
#[allow(missing_debug_implementations)] // nothing of it is known
pub struct DynSeries<G: LieGroup, M> {
    coefficient: Option<Coefficient<G, M>>,
    zero: G::Alg,
}

/// H(m).
type Energy<M, S> = Box<dyn Fn(&M) -> S + Send + Sync>;

/// The problem of a [`DynFlow`] with its scratch.
#[allow(missing_debug_implementations)] // nothing of it is known
pub struct DynWork<G: LieGroup, M>(Box<dyn DynField<G, M> + Send>);

/// A problem with its scratch.
trait DynField<G: LieGroup, M> {
    fn f(&mut self, t: G::Scalar, y: &M, v: &mut G::Alg);
    fn field(&mut self, t: G::Scalar, y: &M, dy: &mut M);
    fn discrete_gradient(&mut self, a: &M, b: &M, xi: &mut G::Alg, scratch: (&mut M, &mut G::Alg));
}

/// [`LiePoisson::discrete_gradient`] of a problem.
type Gradient<P> = fn(
    &P,
    &PointOf<P>,
    &PointOf<P>,
    &mut AlgOf<P>,
    (&mut PointOf<P>, &mut AlgOf<P>),
    &mut <P as Problem>::Work,
);

struct ProblemWithWork<P: Problem> {
    problem: Arc<P>,
    store: FieldStore<P>,
    gradient: Option<Gradient<P>>,
}

impl<P: Problem> DynField<P::Group, PointOf<P>> for ProblemWithWork<P> {
    fn f(&mut self, t: ScalarOf<P>, y: &PointOf<P>, v: &mut AlgOf<P>) {
        self.problem.f(t, y, v, &mut self.store.work);
    }
    fn field(&mut self, t: ScalarOf<P>, y: &PointOf<P>, dy: &mut PointOf<P>) {
        self.problem.field(t, y, dy, &mut self.store);
    }
    fn discrete_gradient(
        &mut self,
        a: &PointOf<P>,
        b: &PointOf<P>,
        xi: &mut AlgOf<P>,
        scratch: (&mut PointOf<P>, &mut AlgOf<P>),
    ) {
        match self.gradient {
            Some(gradient) => gradient(&self.problem, a, b, xi, scratch, &mut self.store.work),
            None => {
                let (group, lit) = (self.problem.group(), ScalarOf::<P>::lit);
                group.set_zero(scratch.1);
                group.set_zero(xi);
                group.axpy(lit(f64::NAN), scratch.1, xi);
            }
        }
    }
}

impl<G: LieGroup + Clone + 'static, A: Action<G> + 'static, L, H> DynFlow<G, A, L, H> {
    /// Makes it from a problem. `action` is its action, or another one with the same values: of [`Flow::new`] the one that
    /// was given there, of [`Flow::in_body`] `RightTranslation`. With any other the run is wrong, which no check can see.
    ///
    /// [`Flow::new`]: super::Flow::new
    /// [`Flow::in_body`]: super::Flow::in_body
    pub fn new<P>(problem: P, action: A) -> Self
    where
        P: Problem<Group = G> + Send + Sync + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        Self::of(Arc::new(problem), action, None)
    }

    fn of<P>(problem: Arc<P>, action: A, gradient: Option<Gradient<P>>) -> Self
    where
        P: Problem<Group = G> + Send + Sync + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        let group = problem.group().clone();
        let work = Box::new(move || {
            let (problem, store) = (problem.clone(), FieldStore::new(&*problem));
            DynWork(Box::new(ProblemWithWork { problem, store, gradient })
                as Box<dyn DynField<G, A::Point> + Send>)
        });
        DynFlow {
            known: PhantomData,
            group,
            action,
            linear: false,
            series: None,
            energy: None,
            work,
        }
    }
}

impl<G: LieGroup + Clone + 'static, A: Action<G> + 'static, L, H> DynFlow<G, A, L, H>
where
    Self: LinearField,
{
    /// Makes it from a linear equation.
    pub fn linear<P>(problem: P, action: A) -> Self
    where
        P: LinearField<Group = G> + Send + Sync + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        DynFlow { linear: true, ..Self::new(problem, action) }
    }
}

impl<G, A, H> DynFlow<G, A, WithSeries<TimeAlone>, H>
where
    G: LieGroup + Clone + 'static,
    A: Action<G> + 'static,
{
    /// Makes it from a linear equation whose A(t) has Taylor coefficients, as [`of_derivatives`] makes it.
    ///
    /// [`of_derivatives`]: super::Flow::of_derivatives
    pub fn linear_with_series<P>(problem: P, action: A) -> Self
    where
        P: LinearField + TaylorField + Problem<Group = G> + Send + Sync + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        let problem = Arc::new(problem);
        let series = Some(series_of(problem.clone()));
        DynFlow { linear: true, series, ..Self::of(problem, action, None) }
    }
}

impl<G: LieGroup + Clone + 'static, A: Action<G> + 'static, L> DynFlow<G, A, L, WithHamiltonian> {
    /// Makes it from a Lie–Poisson system.
    pub fn lie_poisson<P>(problem: P, action: A) -> Self
    where
        P: LiePoisson + Problem<Group = G> + Send + Sync + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        let problem = Arc::new(problem);
        let energy: Energy<_, _> = Box::new({
            let problem = problem.clone();
            move |m| problem.hamiltonian(m)
        });
        DynFlow { energy: Some(energy), ..Self::of(problem, action, Some(P::discrete_gradient)) }
    }
}

impl<G: LieGroup + Clone + 'static, A: Action<G> + 'static>
    DynFlow<G, A, WithSeries, WithHamiltonian>
{
    /// Makes it from a Lie–Poisson system whose f has Taylor coefficients.
    pub fn lie_poisson_with_series<P>(problem: P, action: A) -> Self
    where
        P: LiePoisson + TaylorField + Problem<Group = G> + Clone + Send + Sync + 'static,
        P::Action: Action<G, Point = A::Point>,
    {
        let series = Some(series_of(Arc::new(problem.clone())));
        DynFlow { series, ..Self::lie_poisson(problem, action) }
    }
}

/// What makes the Taylor coefficients of a problem.
fn series_of<P>(problem: Arc<P>) -> MakeSeries<P::Group, PointOf<P>>
where
    P: TaylorField + Send + Sync + 'static,
{
    const { assert!(!P::MOVING, "the coefficients are those of f") };
    Box::new(move |order| {
        let (problem, mut series) = (problem.clone(), problem.series(order));
        Box::new(move |time, y, k, f| problem.coefficient(time, y, k, f, &mut series))
    })
}

impl<G: LieGroup, A: Action<G>, L, H> DynFlow<G, A, L, H> {
    /// True if f has Taylor coefficients.
    pub fn has_series(&self) -> bool {
        self.series.is_some()
    }

    /// True if f depends only on t.
    pub fn is_linear(&self) -> bool {
        self.linear
    }

    /// True for a Lie–Poisson system.
    pub fn is_lie_poisson(&self) -> bool {
        self.energy.is_some()
    }
}

impl<G: LieGroup, A: Action<G>, L, H> fmt::Debug for DynFlow<G, A, L, H> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DynFlow").field("group", &self.group.name()).finish_non_exhaustive()
    }
}

impl<G: LieGroup, A: Action<G>, L, H> Problem for DynFlow<G, A, L, H> {
    type Group = G;
    type Action = A;
    type Work = DynWork<G, A::Point>;

    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &A {
        &self.action
    }
    fn work(&self) -> Self::Work {
        (self.work)()
    }
    fn f(&self, t: G::Scalar, y: &A::Point, v: &mut G::Alg, work: &mut Self::Work) {
        work.0.f(t, y, v);
    }
    fn field(&self, t: G::Scalar, y: &A::Point, dy: &mut A::Point, store: &mut FieldStore<Self>) {
        store.work.0.field(t, y, dy);
    }
}

/// For problems from [`DynFlow::linear`].
impl<G: LieGroup, A: Action<G>, H> LinearField for DynFlow<G, A, TimeAlone, H> {}

/// For problems from [`DynFlow::linear`] and [`DynFlow::linear_with_series`].
impl<G: LieGroup, A: Action<G>, H> LinearField for DynFlow<G, A, WithSeries<TimeAlone>, H> {}

/// For problems from [`DynFlow::linear_with_series`] and [`DynFlow::lie_poisson_with_series`]. For others the
/// coefficients are NaN.
impl<G: LieGroup, A: Action<G>, L, H> TaylorField for DynFlow<G, A, WithSeries<L>, H> {
    type Series = DynSeries<G, A::Point>;

    fn series(&self, order: usize) -> Self::Series {
        let coefficient = self.series.as_ref().map(|make| make(order));
        DynSeries { coefficient, zero: self.group.zero() }
    }
    fn coefficient(
        &self,
        time: [G::Scalar; 2],
        y: &A::Point,
        k: usize,
        f: &mut [G::Alg],
        DynSeries { coefficient, zero }: &mut Self::Series,
    ) {
        match coefficient {
            Some(coefficient) => coefficient(time, y, k, f),
            None => self.group.axpy(G::Scalar::lit(f64::NAN), zero, &mut f[k]),
        }
    }
}

/// For problems from [`DynFlow::lie_poisson`]. For others H and its gradient are NaN.
impl<G: LieGroup, A, L> LiePoisson for DynFlow<G, A, L, WithHamiltonian>
where
    A: Action<G, Point: LinearSpace<Scalar = G::Scalar>>,
{
    fn hamiltonian(&self, m: &A::Point) -> G::Scalar {
        self.energy.as_ref().map_or(G::Scalar::lit(f64::NAN), |energy| energy(m))
    }
    fn discrete_gradient(
        &self,
        a: &A::Point,
        b: &A::Point,
        xi: &mut G::Alg,
        scratch: (&mut A::Point, &mut G::Alg),
        work: &mut Self::Work,
    ) {
        work.0.discrete_gradient(a, b, xi, scratch);
    }
}
