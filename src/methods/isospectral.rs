//! Isospectral symplectic Runge–Kutta methods, for Lie–Poisson systems on matrix algebras and other flows by conjugation.
//!
//! Ẇ = \[B, W\] with B = f(t, W) ∈ 𝔤, by the action of conjugation Λ(g, W) = g W g⁻¹, or by the
//! coadjoint action Λ(g, m) = g⁻ᵀ m gᵀ for W = mᵀ. With a Gauss tableau (a, b, c)
//!
//! Q_i = 𝟙 + h Σ_j a_ij B_j Q_j, P_i = 𝟙 − h Σ_j a_ij P_j B_j, B_j = f(t + c_j h, Q_j W P_j);
//! Q⁺ = 𝟙 + h Σ_i b_i B_i Q_i, P⁺ = 𝟙 − h Σ_i b_i P_i B_i, W⁺ = Q⁺ W P⁺.
//!
//! On 𝔲(n), of complex matrices, ᵀ is †.
//!
//! The Gauss methods conserve quadratic invariants. So P⁺Q⁺ = 𝟙, and the spectrum of m (every Casimir of GL(n)) is
//! conserved to rounding. If G conserves a form, Q⁺ ∈ G_M and P_i = M⁻¹Q_iᵀM. If every u ∈ 𝔤 is skew, as on SO(n), P_i
//! is Q_iᵀ and is not computed.
//!
//! Order 2S. Preserves: Casimirs and group to rounding, time symmetry, and the Lie–Poisson structure, so the energy
//! error stays bounded. Fixed-point iteration finds the stages. It converges while h‖B‖ and h times the Lipschitz
//! constant of m ↦ f(m) are below about 1; else it returns [`StepError::FixedPointDidNotConverge`]. Cost: 8 to 25
//! iterations, each with S f and 3S products (4S if P is computed). S = 1 is the isospectral midpoint rule.
//! Source: K. Modin & M. Viviani, Lie–Poisson methods for isospectral flows, Found. Comput. Math. 20
//! (2020).

use faer::Mat;

use super::gauss::ImplicitTableau;
use super::newton::Progress;
use super::{Facts, MapCounts, Method, Step, Symmetric};
use crate::actions::{Action, Coadjoint, Conjugation};
use crate::dense::mul;
use crate::error::{Error, StepError};
use crate::groups::{
    ComplexMatrix, LieAlgebra, LieGroup, MatrixGroup, Unitary, mul_adjoint_skew, mul_complex,
};
use crate::problems::{AlgOf, LinearSpace, PointOf, Problem};
use crate::scalar::{Ops, tally};

/// An isospectral method on a Gauss tableau.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsospectralGauss<const S: usize>(pub ImplicitTableau<S>);

impl<const S: usize> Symmetric for IsospectralGauss<S> {}

/// A group of n×n matrices, real or complex, for isospectral methods.
pub trait ConjugationGroup: LieGroup<Scalar = f64> {
    /// A stage Q_i or P_i, an n×n matrix that need not be in G.
    type Stage: LinearSpace<Scalar = f64> + Send;

    /// The number n of rows.
    fn rows(&self) -> usize;
    /// Makes new storage.
    fn stage(&self) -> Self::Stage;
    /// True if u† = −u for every u ∈ 𝔤. Then P_i = Q_i†.
    fn is_skew(&self) -> bool;
    /// x ← x + 𝟙.
    fn add_identity(&self, x: &mut Self::Stage);
    /// x ← x + a·b.
    fn add_algebra(&self, a: f64, b: &Self::Alg, x: &mut Self::Stage);
    /// out ← b·q.
    fn slope_of_q(&self, b: &Self::Alg, q: &Self::Stage, out: &mut Self::Stage);
    /// out ← −p·b.
    fn slope_of_p(&self, p: &Self::Stage, b: &Self::Alg, out: &mut Self::Stage);
}

/// An action that conjugates matrices, or their transposes.
pub trait ConjugationAction<G: ConjugationGroup>:
    Action<G, Point: LinearSpace<Scalar = f64>>
{
    /// out ← q m p, or pᵀ m qᵀ if m is transposed. Without p, p = q†. `half` is scratch.
    fn conjugate(
        q: &G::Stage,
        p: Option<&G::Stage>,
        m: &Self::Point,
        half: &mut G::Stage,
        out: &mut Self::Point,
    );
}

type StageOf<P> = <<P as Problem>::Group as ConjugationGroup>::Stage;

/// Stages and scratch.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct IsospectralWork<P: Problem<Group: ConjugationGroup>, const S: usize> {
    q: Factor<StageOf<P>, S>,
    /// `None` if it is Q†.
    p: Option<Factor<StageOf<P>, S>>,
    b: AlgOf<P>,
    half: StageOf<P>,
    m: PointOf<P>,
    field: P::Work,
    iterations: u64,
}

/// The stages Q_i (or P_i) and their slopes B_i Q_i (or −P_i B_i).
struct Factor<X, const S: usize> {
    stages: [X; S],
    slopes: [X; S],
}

impl<X: LinearSpace<Scalar = f64>, const S: usize> Factor<X, S> {
    fn new<G: ConjugationGroup<Stage = X>>(group: &G) -> Self {
        let zeros = || core::array::from_fn(|_| group.stage());
        Factor { stages: zeros(), slopes: zeros() }
    }

    /// out ← 𝟙 + h Σ c_j slope_j.
    fn sum<G>(group: &G, slopes: &[X; S], h: f64, c: &[f64; S], out: &mut X)
    where
        G: ConjugationGroup<Stage = X>,
    {
        out.clear();
        for (c, x) in c.iter().zip(slopes) {
            out.add(h * c, x);
        }
        group.add_identity(out);
    }

    /// Every slope is ±b.
    fn start<G>(&mut self, group: &G, sign: f64, b: &G::Alg, h: f64, a: &[[f64; S]; S])
    where
        G: ConjugationGroup<Stage = X>,
    {
        for slope in &mut self.slopes {
            slope.clear();
            group.add_algebra(sign, b, slope);
        }
        for (row, stage) in a.iter().zip(&mut self.stages) {
            Self::sum(group, &self.slopes, h, row, stage);
        }
    }

    /// Makes the slope in `half` that of stage i, and updates the stage. Returns its change.
    fn replace<G>(&mut self, group: &G, i: usize, h: f64, a: &[f64; S], half: &mut X) -> f64
    where
        G: ConjugationGroup<Stage = X>,
    {
        core::mem::swap(half, &mut self.slopes[i]);
        Self::sum(group, &self.slopes, h, a, half);
        core::mem::swap(half, &mut self.stages[i]);
        half.add(-1.0, &self.stages[i]);
        half.size()
    }
}

impl ConjugationGroup for MatrixGroup {
    type Stage = Mat<f64>;

    fn rows(&self) -> usize {
        self.n()
    }
    fn stage(&self) -> Mat<f64> {
        Mat::zeros(self.n(), self.n())
    }
    fn is_skew(&self) -> bool {
        MatrixGroup::is_skew(self)
    }
    fn add_identity(&self, x: &mut Mat<f64>) {
        add_one(x);
    }
    fn add_algebra(&self, a: f64, b: &Self::Alg, x: &mut Mat<f64>) {
        LinearSpace::add(x, a, b);
    }
    fn slope_of_q(&self, b: &Self::Alg, q: &Mat<f64>, out: &mut Mat<f64>) {
        mul(out, b.as_ref(), q.as_ref());
    }
    fn slope_of_p(&self, p: &Mat<f64>, b: &Self::Alg, out: &mut Mat<f64>) {
        mul(out, p.as_ref(), b.as_ref());
        *out *= faer::Scale(-1.0);
    }
}

impl ConjugationGroup for Unitary {
    type Stage = ComplexMatrix;

    fn rows(&self) -> usize {
        self.n()
    }
    fn stage(&self) -> ComplexMatrix {
        self.zero()
    }
    fn is_skew(&self) -> bool {
        true
    }
    fn add_identity(&self, x: &mut ComplexMatrix) {
        add_one(&mut x.re);
    }
    fn add_algebra(&self, a: f64, b: &ComplexMatrix, x: &mut ComplexMatrix) {
        x.add(a, b);
    }
    fn slope_of_q(&self, b: &ComplexMatrix, q: &ComplexMatrix, out: &mut ComplexMatrix) {
        mul_complex(out, b, q);
    }
    fn slope_of_p(&self, p: &ComplexMatrix, b: &ComplexMatrix, out: &mut ComplexMatrix) {
        mul_complex(out, p, b);
        out.parts_mut().into_iter().for_each(|part| *part *= faer::Scale(-1.0));
    }
}

fn add_one(x: &mut Mat<f64>) {
    tally(|| Ops::adds(x.nrows()));
    for i in 0..x.nrows() {
        x[(i, i)] += 1.0;
    }
}

impl ConjugationAction<MatrixGroup> for Conjugation {
    fn conjugate(
        q: &Mat<f64>,
        p: Option<&Mat<f64>>,
        m: &Mat<f64>,
        half: &mut Mat<f64>,
        out: &mut Mat<f64>,
    ) {
        mul(half, q.as_ref(), m.as_ref());
        match p {
            Some(p) => mul(out, half.as_ref(), p.as_ref()),
            None => mul(out, half.as_ref(), q.transpose()),
        }
    }
}

/// The point is Wᵀ.
impl ConjugationAction<MatrixGroup> for Coadjoint {
    fn conjugate(
        q: &Mat<f64>,
        p: Option<&Mat<f64>>,
        m: &Mat<f64>,
        half: &mut Mat<f64>,
        out: &mut Mat<f64>,
    ) {
        match p {
            Some(p) => mul(half, p.transpose(), m.as_ref()),
            None => mul(half, q.as_ref(), m.as_ref()),
        }
        mul(out, half.as_ref(), q.transpose());
    }
}

/// q m q† of a skew-Hermitian m, by one product and a half.
macro_rules! of_skew_hermitian {
    ($($action:ty),*) => {$(
        impl ConjugationAction<Unitary> for $action {
            fn conjugate(
                q: &ComplexMatrix,
                _: Option<&ComplexMatrix>,
                m: &ComplexMatrix,
                half: &mut ComplexMatrix,
                out: &mut ComplexMatrix,
            ) {
                mul_complex(half, q, m);
                mul_adjoint_skew(out, half, q);
            }
        }
    )*};
}
of_skew_hermitian!(Conjugation, Coadjoint);

impl<P, const S: usize> Method<P> for IsospectralGauss<S>
where
    P: Problem<Group: ConjugationGroup>,
    P::Action: ConjugationAction<P::Group>,
{
    type Work = IsospectralWork<P, S>;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(self.0.order).cost(None, MapCounts::default())
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let group = problem.group();
        Ok(IsospectralWork {
            q: Factor::new(group),
            p: (!group.is_skew()).then(|| Factor::new(group)),
            b: group.zero(),
            half: group.stage(),
            m: like.clone(),
            field: problem.work(),
            iterations: 0,
        })
    }
    fn iterations(&self, work: &Self::Work) -> u64 {
        work.iterations
    }
    fn step(
        &self,
        problem: &P,
        Step { t, h, .. }: Step<f64>,
        y: &mut PointOf<P>,
        IsospectralWork { q, p, b, half, m, field, iterations }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (tab, group) = (&self.0, problem.group());
        problem.f(t, y, b, field);
        if !group.is_finite(b) {
            return Err(StepError::NonFiniteRhs { stage: 1 });
        }
        q.start(group, 1.0, b, h, &tab.a);
        if let Some(p) = p {
            p.start(group, -1.0, b, h, &tab.a);
        }
        let scale = (group.rows() as f64).sqrt(); // ‖𝟙‖
        let mut progress = Progress::new(iterations);
        loop {
            let mut change = 0.0;
            for i in 0..S {
                let back = p.as_ref().map(|p| &p.stages[i]);
                P::Action::conjugate(&q.stages[i], back, y, half, m);
                problem.f(t + tab.c[i] * h, m, b, field);
                group.slope_of_q(b, &q.stages[i], half);
                change += q.replace(group, i, h, &tab.a[i], half);
                if let Some(p) = p {
                    group.slope_of_p(&p.stages[i], b, half);
                    change += p.replace(group, i, h, &tab.a[i], half);
                }
            }
            if progress.done("isospectral", change / scale)? {
                break;
            }
        }
        Factor::sum(group, &q.slopes, h, &tab.b, &mut q.stages[0]);
        if let Some(p) = p {
            Factor::sum(group, &p.slopes, h, &tab.b, &mut p.stages[0]);
        }
        let back = p.as_ref().map(|p| &p.stages[0]);
        P::Action::conjugate(&q.stages[0], back, y, half, m);
        StepError::finite(m.is_finite(), "the state")?;
        core::mem::swap(y, m);
        Ok(())
    }
}
