//! Euler's equations on the dual of any Lie algebra: ṁ = ad*_{∇H(m)} m, where ∇H(m) ∈ 𝔤.
//!
//! f(m) = −∇H(m); Λ = Ad*_{g⁻¹} (coadjoint). The motion stays on its coadjoint orbit, which conserves every Casimir.
//! Invariants: H and the Casimirs.
//!
//! With g in the state: (ġ, ṁ) = (g ∇H(m), ad*_{∇H(m)} m) on G × 𝔤*, Λ(a, (g, m)) = (g a⁻¹, Ad*_{a⁻¹} m), and the same
//! f. Every method that acts by the group conserves Ad*_{g⁻¹} m, the momentum in space.

use crate::actions::{Action, Coadjoint, RightTranslation, RightWork};
use crate::error::Error;
use crate::groups::{Adjoint, worse};
use crate::problems::{
    AlgOf, Invariant, Invariants, LiePoisson, LinearSpace, MomentumTerms, PointOf, Problem,
    TaylorField,
};
use crate::scalar::{Real, larger};
use crate::tolerance::Scales;

/// A Hamiltonian H : 𝔤* → ℝ. A new Euler equation needs only an implementation of this trait.
pub trait Hamiltonian<G: Adjoint> {
    /// H(m).
    fn value(&self, group: &G, m: &G::Dual) -> G::Scalar;
    /// ξ ← ∇H(m) ∈ 𝔤: ⟨δm, ξ⟩ = dH(m)·δm.
    fn gradient(&self, m: &G::Dual, xi: &mut G::Alg);
    /// The degree of H as a polynomial of m. 0 if H is no polynomial.
    fn degree(&self) -> u32 {
        0
    }
    /// Further invariants: the Casimirs of the algebra, integrals of this flow.
    fn further(&self) -> Vec<Invariant> {
        Vec::new()
    }
    /// The values of the further invariants at m.
    fn further_values(&self, _m: &G::Dual) -> Vec<G::Scalar> {
        Vec::new()
    }
    /// The sizes of their terms, as [`Invariants::sizes`].
    fn further_sizes(&self, m: &G::Dual) -> Vec<G::Scalar> {
        self.further_values(m).into_iter().map(Real::abs).collect()
    }
}

/// A Hamiltonian with a discrete gradient, for methods that conserve the energy.
///
/// For H of degree at most 2 the default is one: `impl DiscreteGradient<G> for MyHamiltonian {}`. For any other H use
/// [`MeanGradient`](crate::problems::MeanGradient).
pub trait DiscreteGradient<G: Adjoint>: Hamiltonian<G> {
    /// ξ ← ∇̄H(a, b), symmetric in a and b: ⟨b − a, ξ⟩ = H(b) − H(a), ∇̄H(m, m) = ∇H(m). The default is
    /// (∇H(a) + ∇H(b))/2, which has these properties only if ∇H is affine.
    fn between(&self, group: &G, a: &G::Dual, b: &G::Dual, xi: &mut G::Alg, scratch: &mut G::Alg) {
        group.set_zero(xi);
        for m in [a, b] {
            self.gradient(m, scratch);
            group.axpy(G::Scalar::lit(0.5), scratch, xi);
        }
    }
}

/// A Hamiltonian of degree at most 2, so that ∇H is affine. Lie series need no more.
///
/// For a homogeneous H of degree 2 the default is right: `impl Quadratic<G> for MyHamiltonian {}`.
pub trait Quadratic<G: Adjoint>: Hamiltonian<G> {
    /// ξ ← ∇H(m) − ∇H(0).
    fn linear_gradient(&self, m: &G::Dual, xi: &mut G::Alg) {
        self.gradient(m, xi);
    }
}

/// The kinetic energy H = ½⟨m, J⁻¹m⟩ of an inertia J, from a function that writes J⁻¹m.
///
/// J⁻¹ : 𝔤* → 𝔤 must be linear and symmetric: ⟨m, J⁻¹n⟩ = ⟨n, J⁻¹m⟩. An n×n matrix m stands for the functional v ↦
/// tr(mᵀv) on 𝔤. J⁻¹m must be the same for all matrices that stand for the same functional.
#[derive(Clone, Copy, Debug)]
pub struct Kinetic<F>(pub F);

impl<G: Adjoint, F: Fn(&G::Dual, &mut G::Alg)> Hamiltonian<G> for Kinetic<F> {
    fn value(&self, group: &G, m: &G::Dual) -> G::Scalar {
        let mut xi = group.zero();
        (self.0)(m, &mut xi);
        G::Scalar::lit(0.5) * group.pair(m, &xi)
    }
    #[inline]
    fn gradient(&self, m: &G::Dual, xi: &mut G::Alg) {
        (self.0)(m, xi);
    }
    fn degree(&self) -> u32 {
        2
    }
}

impl<G: Adjoint, F: Fn(&G::Dual, &mut G::Alg)> DiscreteGradient<G> for Kinetic<F> {}

impl<G: Adjoint, F: Fn(&G::Dual, &mut G::Alg)> Quadratic<G> for Kinetic<F> {}

/// A Hamiltonian from two functions, its value and its gradient.
impl<G, H, D> Hamiltonian<G> for (H, D)
where
    G: Adjoint,
    H: Fn(&G::Dual) -> G::Scalar,
    D: Fn(&G::Dual, &mut G::Alg),
{
    fn value(&self, _: &G, m: &G::Dual) -> G::Scalar {
        (self.0)(m)
    }
    #[inline]
    fn gradient(&self, m: &G::Dual, xi: &mut G::Alg) {
        (self.1)(m, xi);
    }
}

/// Euler's equation ṁ = ad*_{∇H(m)} m, from a group and a Hamiltonian.
///
/// ```
/// use lieflow::groups::Se3;
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{Euler, Kinetic};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
/// type Pair = (Vector3<f64>, Vector3<f64>);
///
/// // Kirchhoff's equations: an ellipsoid in an ideal fluid.
/// let body = Kinetic(|m: &Pair, u: &mut Pair| {
///     u.0 = m.0.component_div(&Vector3::new(1.0, 2.0, 3.0));
///     u.1 = m.1.component_div(&Vector3::new(1.5, 1.2, 1.0));
/// });
/// let problem = Euler::new(Se3::<f64>::new(), body);
/// let mut m = (Vector3::new(0.3, 0.1, 1.0), Vector3::new(0.0, 0.4, 1.0));
/// let start = (problem.energy(&m), m.0.dot(&m.1));
/// let grid = TimeGrid::new([0.0, 10.0], 0.01)?;
/// integrate(&problem, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((problem.energy(&m) - start.0).abs() < 1e-9);
/// assert!((m.0.dot(&m.1) - start.1).abs() < 1e-13); // a Casimir
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Euler<G, H> {
    group: G,
    hamiltonian: H,
}

impl<G: Adjoint, H: Hamiltonian<G>> Euler<G, H> {
    /// The equation.
    pub const fn new(group: G, hamiltonian: H) -> Self {
        Euler { group, hamiltonian }
    }
    /// The energy H.
    pub fn hamiltonian(&self) -> &H {
        &self.hamiltonian
    }
    /// H(m).
    pub fn energy(&self, m: &G::Dual) -> G::Scalar {
        self.hamiltonian.value(&self.group, m)
    }
    /// The same system with the group element g in the state.
    pub const fn with_group(self) -> EulerGroup<G, H> {
        EulerGroup { system: self }
    }
    /// v ← −∇H(m).
    fn minus_gradient(&self, m: &G::Dual, v: &mut G::Alg, xi: &mut G::Alg) {
        self.hamiltonian.gradient(m, xi);
        self.group.set_zero(v);
        self.group.axpy(G::Scalar::lit(-1.0), xi, v);
    }
}

impl<G: Adjoint, H: Hamiltonian<G>> Problem for Euler<G, H>
where
    Coadjoint: Action<G, Point = G::Dual>,
{
    type Group = G;
    type Action = Coadjoint;
    /// ∇H.
    type Work = G::Alg;

    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &Coadjoint {
        &Coadjoint
    }
    fn work(&self) -> G::Alg {
        self.group.zero()
    }
    #[inline]
    fn f(&self, _: G::Scalar, m: &G::Dual, v: &mut G::Alg, xi: &mut G::Alg) {
        self.minus_gradient(m, v, xi);
    }
}

impl<G: Adjoint, H: Hamiltonian<G>> Invariants for Euler<G, H>
where
    Coadjoint: Action<G, Point = G::Dual>,
{
    fn invariants(&self) -> Vec<Invariant> {
        let energy = Invariant::of_the_flow("energy", self.hamiltonian.degree());
        core::iter::once(energy).chain(self.hamiltonian.further()).collect()
    }
    fn values(&self, m: &G::Dual) -> Vec<G::Scalar> {
        let further = self.hamiltonian.further_values(m);
        core::iter::once(self.energy(m)).chain(further).collect()
    }
    fn sizes(&self, m: &G::Dual) -> Vec<G::Scalar> {
        let further = self.hamiltonian.further_sizes(m);
        core::iter::once(self.energy(m).abs()).chain(further).collect()
    }
}

impl<G: Adjoint, H: DiscreteGradient<G>> LiePoisson for Euler<G, H>
where
    Coadjoint: Action<G, Point = G::Dual>,
    G::Dual: LinearSpace<Scalar = G::Scalar>,
{
    fn hamiltonian(&self, m: &G::Dual) -> G::Scalar {
        self.energy(m)
    }
    fn discrete_gradient(
        &self,
        a: &G::Dual,
        b: &G::Dual,
        xi: &mut G::Alg,
        _: (&mut G::Dual, &mut G::Alg),
        work: &mut G::Alg,
    ) {
        self.hamiltonian.between(&self.group, a, b, xi, work);
    }
}

/// The Taylor coefficients of m and of −∇H(m).
#[allow(missing_debug_implementations)] // the parts belong to the group's types
pub struct EulerSeries<G: MomentumTerms> {
    momenta: G::Momenta,
    xi: G::Alg,
}

/// The Taylor coefficients of −∇H(m).
impl<G: MomentumTerms, H: Quadratic<G>> TaylorField for Euler<G, H>
where
    Coadjoint: Action<G, Point = G::Dual>,
{
    type Series = EulerSeries<G>;

    fn series(&self, order: usize) -> EulerSeries<G> {
        EulerSeries { momenta: self.group.momenta(order), xi: self.group.zero() }
    }
    fn coefficient(
        &self,
        [_, h]: [G::Scalar; 2],
        m: &PointOf<Self>,
        k: usize,
        f: &mut [AlgOf<Self>],
        EulerSeries { momenta, xi }: &mut EulerSeries<G>,
    ) {
        let m = self.group.next(h, m, k, f, momenta);
        match k {
            0 => self.hamiltonian.gradient(m, xi),
            _ => self.hamiltonian.linear_gradient(m, xi),
        }
        self.group.set_zero(&mut f[k]);
        self.group.axpy(G::Scalar::lit(-1.0), xi, &mut f[k]);
    }
}

/// Euler's equations with the motion of g: points (g, m).
#[derive(Clone, Copy, Debug)]
pub struct EulerGroup<G, H> {
    system: Euler<G, H>,
}

impl<G, H> EulerGroup<G, H> {
    /// The system without g.
    pub fn system(&self) -> &Euler<G, H> {
        &self.system
    }
}

/// The action Λ(a, (g, m)) = (g a⁻¹, Ad*_{a⁻¹} m) of G from the side of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FromTheBody;

impl<G: Adjoint> Action<G> for FromTheBody
where
    Coadjoint: Action<G, Point = G::Dual>,
{
    type Point = (G::Elem, G::Dual);
    type Work = (RightWork<G>, <Coadjoint as Action<G>>::Work);

    fn work(&self, group: &G) -> Self::Work {
        (RightTranslation.work(group), Action::<G>::work(&Coadjoint, group))
    }
    fn check(&self, group: &G, p: &Self::Point) -> Result<(), Error> {
        group.check_elem(&p.0)?;
        Coadjoint.check(group, &p.1)
    }
    fn check_member(&self, group: &G, p: &Self::Point) -> Result<(), Error> {
        group.check_member(&p.0)
    }
    #[inline]
    fn act(
        &self,
        group: &G,
        a: &G::Elem,
        p: &Self::Point,
        q: &mut Self::Point,
        (right, coadjoint): &mut Self::Work,
    ) {
        RightTranslation.act(group, a, &p.0, &mut q.0, right);
        Coadjoint.act(group, a, &p.1, &mut q.1, coadjoint);
    }
    /// (−g v, −ad*_v m).
    #[inline]
    fn generate(
        &self,
        group: &G,
        v: &G::Alg,
        (g, m): &Self::Point,
        (dg, dm): &mut Self::Point,
        (right, coadjoint): &mut Self::Work,
    ) {
        RightTranslation.generate(group, v, g, dg, right);
        Coadjoint.generate(group, v, m, dm, coadjoint);
    }
    #[inline]
    fn error_ratio(
        &self,
        group: &G,
        e: &G::Alg,
        p: &Self::Point,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        let first = RightTranslation.error_ratio(group, e, &p.0, scales);
        larger(first, Coadjoint.error_ratio(group, e, &p.1, scales))
    }
    #[inline]
    fn error_ratio_of_step(
        &self,
        group: &G,
        e: &G::Alg,
        [p, q]: [&Self::Point; 2],
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        let first = RightTranslation.error_ratio_of_step(group, e, [&p.0, &q.0], scales);
        larger(first, Coadjoint.error_ratio_of_step(group, e, [&p.1, &q.1], scales))
    }
    fn residual_size(&self, group: &G, p: &Self::Point) -> G::Scalar {
        group.residual_size(&p.0)
    }
    /// Corrects g to G.
    fn restore(&self, group: &G, p: &mut Self::Point, work: &mut Self::Work) -> Option<G::Scalar> {
        RightTranslation.restore(group, &mut p.0, &mut work.0)
    }
    /// Corrects g to G, and m to its orbit.
    fn restore_to(
        &self,
        group: &G,
        from: &Self::Point,
        p: &mut Self::Point,
        work: &mut Self::Work,
    ) -> Option<G::Scalar> {
        let moved = Coadjoint.restore_to(group, &from.1, &mut p.1, &mut work.1);
        worse(moved, self.restore(group, p, work))
    }
}

impl<G: Adjoint, H: Hamiltonian<G>> Problem for EulerGroup<G, H>
where
    Coadjoint: Action<G, Point = G::Dual>,
{
    type Group = G;
    type Action = FromTheBody;
    type Work = G::Alg;

    fn group(&self) -> &G {
        &self.system.group
    }
    fn action(&self) -> &FromTheBody {
        &FromTheBody
    }
    fn work(&self) -> G::Alg {
        self.group().zero()
    }
    #[inline]
    fn f(&self, _: G::Scalar, y: &PointOf<Self>, v: &mut G::Alg, xi: &mut G::Alg) {
        self.system.minus_gradient(&y.1, v, xi);
    }
}

impl<G: Adjoint, H: Hamiltonian<G>> Invariants for EulerGroup<G, H>
where
    Coadjoint: Action<G, Point = G::Dual>,
{
    fn invariants(&self) -> Vec<Invariant> {
        self.system.invariants()
    }
    fn values(&self, y: &PointOf<Self>) -> Vec<G::Scalar> {
        self.system.values(&y.1)
    }
    fn sizes(&self, y: &PointOf<Self>) -> Vec<G::Scalar> {
        self.system.sizes(&y.1)
    }
}

/// f is that of the system without g.
impl<G: MomentumTerms, H: Quadratic<G>> TaylorField for EulerGroup<G, H>
where
    Coadjoint: Action<G, Point = G::Dual>,
{
    type Series = EulerSeries<G>;

    fn series(&self, order: usize) -> EulerSeries<G> {
        self.system.series(order)
    }
    fn coefficient(
        &self,
        time: [G::Scalar; 2],
        (_, m): &PointOf<Self>,
        k: usize,
        f: &mut [AlgOf<Self>],
        series: &mut EulerSeries<G>,
    ) {
        self.system.coefficient(time, m, k, f, series);
    }
}
