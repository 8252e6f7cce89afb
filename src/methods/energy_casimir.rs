//! A method that conserves energy and Casimirs of Lie–Poisson systems on any Lie algebra.
//!
//! m⁺ = Λ(Ψ(−hξ), m) = Ad*_{Ψ(hξ)} m in the paper's notation, with ξ = ∇̄H(m, m⁺) a discrete
//! gradient of H (for quadratic H, ∇H((m + m⁺)/2)). For so(3) and Ψ = cay it is Simo and Wong's
//! method with k = 1.
//!
//! Order 2, symmetric; a [`Composition`](super::Composition) raises the order. Preserves: every Casimir, because it
//! acts by the group, and the energy, because Ψ(hξ) leaves ξ fixed: H(m⁺) − H(m) = ⟨m⁺ − m, ξ⟩ = ⟨m, Ad_Ψ ξ − ξ⟩ = 0.
//! Both hold to rounding: the iteration goes on until its changes no longer shrink. It is not symplectic in general.
//! The fixed-point iteration for ξ converges while h‖J⁻¹‖|m| is below about 1. Beyond that the step fails with [`StepError::FixedPointDidNotConverge`].
//!
//! It takes every problem that is [`LiePoisson`]: the body in ℝ³ and ℝⁿ, and Euler's equations
//! ([`Euler`](crate::problems::Euler)) on any algebra. H is quadratic, or any function with a
//! [`MeanGradient`](crate::problems::MeanGradient). Cost: 5 to 20 iterations of one Ψ, one action and one discrete
//! gradient. Dense output of order 2 takes two f more; it conserves the Casimirs, but not the energy.
//! Source: after J. C. Simo & K. K. Wong (1991) and D. Lewis & J. C. Simo, J. Nonlinear Sci. 4
//! (1994); discrete gradients by R. McLachlan, G. Quispel & N. Robidoux (1999).

use super::embedded::relative_error_of_parts;
use super::extension::{Extension, OneIncrement, of_increment};
use super::implicit_rkmk::OddMap;
use super::newton::Progress;
use super::{Facts, Method, Step, Symmetric, Within};
use crate::chart::ChartStore;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::CoordinateMap;
use crate::problems::{AlgOf, LiePoisson, PointOf, ScalarOf};
use crate::scalar::Real;
use crate::space::LinearSpace;

/// The energy–Casimir method with the map Ψ: exp, cay, or another map with Ψ(−u) = Ψ(u)⁻¹.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnergyCasimir<Psi> {
    psi: Psi,
}

impl<Psi: OddMap> EnergyCasimir<Psi> {
    /// Makes the method.
    pub const fn new(psi: Psi) -> Self {
        EnergyCasimir { psi }
    }
}

impl<Psi: OddMap> Symmetric for EnergyCasimir<Psi> {}

/// ξ, points and the chart.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct EnergyCasimirWork<P: LiePoisson, Psi: CoordinateMap<P::Group>> {
    xi: AlgOf<P>,
    old: AlgOf<P>,
    u: AlgOf<P>,
    y: PointOf<P>,
    scratch: (PointOf<P>, AlgOf<P>),
    chart: ChartStore<P, Psi>,
    field: P::Work,
    dense: OneIncrement<P>,
    iterations: u64,
}

/// In the chart at the start.
const EXTENSION: Extension<'static, 2> = of_increment(2, 0.0);

impl<P: LiePoisson, Psi: CoordinateMap<P::Group> + OddMap> Method<P> for EnergyCasimir<Psi> {
    type Work = EnergyCasimirWork<P, Psi>;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(2).dense(2, 1 + EXTENSION.evaluations())
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let alg = problem.group();
        Ok(EnergyCasimirWork {
            xi: alg.zero(),
            old: alg.zero(),
            u: alg.zero(),
            y: like.clone(),
            scratch: (like.clone(), alg.zero()),
            chart: ChartStore::new(problem, &self.psi, like)?,
            field: problem.work(),
            dense: OneIncrement::new(alg),
            iterations: 0,
        })
    }
    fn iterations(&self, work: &Self::Work) -> u64 {
        work.iterations
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { n, h, .. }: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        w: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (alg, lit) = (problem.group(), ScalarOf::<P>::lit);
        let EnergyCasimirWork { xi, old, u, y, scratch: (m, v), chart, field, iterations, .. } = w;
        problem.discrete_gradient(p, p, xi, (m, v), field);
        if !alg.is_finite(xi) {
            return Err(StepError::NonFiniteRhs { stage: 1 });
        }
        let mut progress = Progress::to_the_last_digit(iterations);
        loop {
            alg.set_zero(u);
            alg.axpy(-h, xi, u);
            chart.around(problem, &self.psi, n, p).lambda(u, y)?;
            // hξ and not ξ, whose squares may leave the range.
            alg.set_zero(old);
            alg.axpy(lit(1.0), u, old);
            problem.discrete_gradient(p, y, xi, (m, v), field);
            alg.axpy(h, xi, old);
            let size = lit(1.0) + alg.norm(u);
            let change = alg.norm(old) / size;
            if progress.done("energy-casimir", change)? {
                let of_parts = relative_error_of_parts(problem, old, [p, y]);
                if progress.parts_are_done(change, of_parts / size) {
                    break;
                }
            }
        }
        StepError::finite(y.is_finite(), "the state")?;
        core::mem::swap(p, y);
        Ok(())
    }
    fn prepare(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        _: &PointOf<P>,
        EnergyCasimirWork { u, chart, dense, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let alg = problem.group();
        let mut chart = chart.around(problem, &self.psi, step.n, from);
        let rate = ScalarOf::<P>::lit(1.0) / step.h;
        alg.combine(rate, &[1.0], core::slice::from_ref(u), &mut dense.k[0]);
        dense.first(&EXTENSION, alg, &mut chart, step)?;
        dense.prepare(&EXTENSION, alg, &mut chart, step)
    }
    fn within(&self, _: &Self::Work) -> Within {
        Within::Chart
    }
    fn coordinates(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        theta: f64,
        _: &mut PointOf<P>,
        work: &mut Self::Work,
        u: &mut AlgOf<P>,
    ) {
        work.dense.coordinates(&EXTENSION, problem.group(), (theta, h), u);
    }
    fn on_chart(
        &self,
        problem: &P,
        n: u64,
        base: &PointOf<P>,
        u: &AlgOf<P>,
        work: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        work.chart.around(problem, &self.psi, n, base).lambda(u, at)
    }
    fn interpolate(
        &self,
        problem: &P,
        Step { n, h, .. }: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        EnergyCasimirWork { chart, dense, .. }: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let mut chart = chart.around(problem, &self.psi, n, from);
        dense.point(&EXTENSION, problem.group(), &mut chart, (theta, h), at)
    }
}
