//! Isospectral symplectic Runge–Kutta methods: Lie–Poisson systems on any matrix algebra, and every
//! other flow by conjugation.
//!
//! Ẇ = \[B, W\] with B = f(t, W) ∈ 𝔤, by the action of conjugation Λ(g, W) = g W g⁻¹, or by the
//! coadjoint action Λ(g, m) = g⁻ᵀ m gᵀ for W = mᵀ. With a Gauss tableau (a, b, c)
//!
//! Q_i = 𝟙 + h Σ_j a_ij B_j Q_j, P_i = 𝟙 − h Σ_j a_ij P_j B_j, B_j = f(t + c_j h, Q_j W P_j);
//! Q⁺ = 𝟙 + h Σ_i b_i B_i Q_i, P⁺ = 𝟙 − h Σ_i b_i P_i B_i, W⁺ = Q⁺ W P⁺.
//!
//! The Gauss methods keep quadratic invariants: P⁺Q⁺ = 𝟙, so that the spectrum of m (every Casimir
//! of GL(n)) is kept to rounding, and Q⁺ ∈ G_M where G keeps a form. P_i is M⁻¹Q_iᵀM there; where
//! every u ∈ 𝔤 is skew, as on SO(n), it is Q_iᵀ and is not computed.
//!
//! Order 2S. Preserves: Casimirs and group to rounding, time symmetry, the Lie–Poisson structure, so
//! that the energy error stays bounded. The stages are found by fixed-point iteration, which converges while h‖B‖ and h times the Lipschitz constant of
//! m ↦ f(m) stay below about 1; else [`StepError::FixedPointDidNotConverge`]. Cost of an iteration:
//! S f and 3S products (4S where P is computed), 8 to 25 iterations. S = 1 is the isospectral
//! midpoint rule.
//! Source: K. Modin & M. Viviani, Lie–Poisson methods for isospectral flows, Found. Comput. Math. 20
//! (2020).

use faer::Mat;

use super::gauss::ImplicitTableau;
use super::newton::Progress;
use super::{Method, Step, Symmetric};
use crate::actions::{Action, Coadjoint, Conjugation};
use crate::dense::{axpy, is_finite, mul, norm_frobenius};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup};
use crate::problems::Problem;
use crate::scalar::{Ops, tally};

/// An isospectral method on a Gauss tableau.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsospectralGauss<const S: usize>(pub ImplicitTableau<S>);

impl<const S: usize> Symmetric for IsospectralGauss<S> {}

/// Stages and scratch.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct IsospectralWork<P: Problem, const S: usize> {
    q: Factor<S>,
    /// `None` where it is Qᵀ.
    p: Option<Factor<S>>,
    b: AlgebraMatrix,
    half: Mat<f64>,
    m: Mat<f64>,
    field: P::Work,
}

/// The stages Q_i (or P_i) and their slopes B_i Q_i (or −P_i B_i).
struct Factor<const S: usize> {
    stages: [Mat<f64>; S],
    slopes: [Mat<f64>; S],
}

impl<const S: usize> Factor<S> {
    fn new(n: usize) -> Self {
        let zeros = || core::array::from_fn(|_| Mat::zeros(n, n));
        Factor { stages: zeros(), slopes: zeros() }
    }

    /// out ← 𝟙 + h Σ c_j slope_j.
    fn sum(slopes: &[Mat<f64>; S], h: f64, c: &[f64; S], out: &mut Mat<f64>) {
        out.fill(0.0);
        for (c, x) in c.iter().zip(slopes) {
            axpy(h * c, x, out);
        }
        tally(|| Ops::adds(out.nrows()));
        for i in 0..out.nrows() {
            out[(i, i)] += 1.0;
        }
    }

    /// Every slope is ±b.
    fn start(&mut self, sign: f64, b: &Mat<f64>, h: f64, a: &[[f64; S]; S]) {
        for slope in &mut self.slopes {
            slope.fill(0.0);
            axpy(sign, b, slope);
        }
        for (row, stage) in a.iter().zip(&mut self.stages) {
            Self::sum(&self.slopes, h, row, stage);
        }
    }

    /// The slope in `half` becomes that of stage i, and the stage follows. Returns its change.
    fn replace(&mut self, i: usize, h: f64, a: &[f64; S], half: &mut Mat<f64>) -> f64 {
        core::mem::swap(half, &mut self.slopes[i]);
        Self::sum(&self.slopes, h, a, half);
        core::mem::swap(half, &mut self.stages[i]);
        axpy(-1.0, &self.stages[i], half);
        norm_frobenius(half)
    }
}

/// An action that conjugates matrices, or their transposes.
pub trait Conjugates: Action<MatrixGroup, Point = Mat<f64>> {
    /// Is the point mᵀ conjugated, and not m?
    const TRANSPOSED: bool;
}

impl Conjugates for Conjugation {
    const TRANSPOSED: bool = false;
}

impl Conjugates for Coadjoint {
    const TRANSPOSED: bool = true;
}

/// out ← q m p, or pᵀ m qᵀ, with p = qᵀ where there is none.
fn conjugate<A: Conjugates>(
    q: &Mat<f64>,
    p: Option<&Mat<f64>>,
    m: &Mat<f64>,
    half: &mut Mat<f64>,
    out: &mut Mat<f64>,
) {
    match (p, A::TRANSPOSED) {
        (Some(p), true) => mul(half, p.transpose(), m.as_ref()),
        _ => mul(half, q.as_ref(), m.as_ref()),
    }
    match (p, A::TRANSPOSED) {
        (Some(p), false) => mul(out, half.as_ref(), p.as_ref()),
        _ => mul(out, half.as_ref(), q.transpose()),
    }
}

impl<P, const S: usize> Method<P> for IsospectralGauss<S>
where
    P: Problem<Group = MatrixGroup>,
    P::Action: Action<MatrixGroup, Point = Mat<f64>> + Conjugates,
{
    type Work = IsospectralWork<P, S>;

    fn order(&self, _: &P) -> usize {
        self.0.order
    }
    fn work(&self, problem: &P, _: &Mat<f64>) -> Result<Self::Work, Error> {
        let group = problem.group();
        let zero = || Mat::zeros(group.n(), group.n());
        Ok(IsospectralWork {
            q: Factor::new(group.n()),
            p: (!group.is_skew()).then(|| Factor::new(group.n())),
            b: group.zero(),
            half: zero(),
            m: zero(),
            field: problem.work(),
        })
    }
    fn step(
        &self,
        problem: &P,
        Step { t, h, .. }: Step<f64>,
        y: &mut Mat<f64>,
        IsospectralWork { q, p, b, half, m, field }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let tab = &self.0;
        problem.f(t, y, b, field);
        if !is_finite(b) {
            return Err(StepError::NonFiniteRhs { stage: 1 });
        }
        q.start(1.0, b, h, &tab.a);
        if let Some(p) = p {
            p.start(-1.0, b, h, &tab.a);
        }
        let scale = (y.nrows() as f64).sqrt(); // ‖𝟙‖
        let mut progress = Progress::new();
        loop {
            let mut change = 0.0;
            for i in 0..S {
                let back = p.as_ref().map(|p| &p.stages[i]);
                conjugate::<P::Action>(&q.stages[i], back, y, half, m);
                problem.f(t + tab.c[i] * h, m, b, field);
                mul(half, b.as_ref(), q.stages[i].as_ref());
                change += q.replace(i, h, &tab.a[i], half);
                if let Some(p) = p {
                    mul(half, p.stages[i].as_ref(), b.as_ref());
                    *half *= faer::Scale(-1.0);
                    change += p.replace(i, h, &tab.a[i], half);
                }
            }
            if progress.done("isospectral", change / scale)? {
                break;
            }
        }
        Factor::sum(&q.slopes, h, &tab.b, &mut q.stages[0]);
        if let Some(p) = p {
            Factor::sum(&p.slopes, h, &tab.b, &mut p.stages[0]);
        }
        let back = p.as_ref().map(|p| &p.stages[0]);
        conjugate::<P::Action>(&q.stages[0], back, y, half, m);
        if !is_finite(m) {
            return Err(StepError::NotFinite { what: "the state" });
        }
        core::mem::swap(y, m);
        Ok(())
    }
}
