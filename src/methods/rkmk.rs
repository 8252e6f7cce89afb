//! Runge–Kutta–Munthe-Kaas: any explicit tableau × any coordinate map × any action (Table 1).
//!
//! k₁ = f(t, p); u_i = h Σ_j a_ij k_j; k_i = dΨ_{u_i}⁻¹ f(t + c_i h, λ_p(u_i)); v = h Σ_j b_j k_j;
//! y = λ_p(v).
//!
//! Order: the tableau's, as long as the map's dΨ⁻¹ keeps it. Preserves: the group, and what the
//! action leaves invariant (Casimirs on a coadjoint orbit). Cost of a step with S stages: S times f,
//! S times Ψ (applied, not formed, where the action allows), S − 1 times dΨ⁻¹.
//! Source: H. Munthe-Kaas, High order Runge–Kutta methods on manifolds, Appl. Numer. Math. 29 (1999).

use super::{Method, Step, Tableau};
use crate::chart::ChartStore;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::CoordinateMap;
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;

/// RKMK with S stages in the coordinates Ψ.
///
/// Table 1 of the paper is `Rkmk::new(RK4, Exp)`.
#[derive(Clone, Copy, Debug)]
pub struct Rkmk<Psi, const S: usize> {
    tableau: Tableau<S>,
    psi: Psi,
}

impl<Psi, const S: usize> Rkmk<Psi, S> {
    /// The method.
    pub const fn new(tableau: Tableau<S>, psi: Psi) -> Self {
        Rkmk { tableau, psi }
    }
}

/// Stages and the chart.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct RkmkWork<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> {
    k: [AlgOf<P>; S],
    u: AlgOf<P>,
    y: PointOf<P>,
    chart: ChartStore<P, Psi>,
}

impl<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> RkmkWork<P, Psi, S> {
    /// self.y ← the step from p.
    #[inline(always)]
    fn advance(
        &mut self,
        method: &Rkmk<Psi, S>,
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        p: &PointOf<P>,
    ) -> Result<(), StepError> {
        let (tab, alg) = (&method.tableau, problem.group());
        let RkmkWork { k, u, y, chart } = self;
        let mut chart = chart.around(problem, &method.psi, n, p);
        chart.field(t, &mut k[0]);
        for i in 1..S {
            alg.combine(h, &tab.a[i][..i], &k[..i], u); // u_i = h Σ_j a_ij k_j
            chart.pullback(t + h * ScalarOf::<P>::lit(tab.c[i]), u, &mut k[i])?;
        }
        alg.combine(h, &tab.b, k, u); // v = h Σ_j b_j k_j
        if !alg.is_finite(u) {
            return Err(StepError::NotFinite { what: "the increment v" });
        }
        chart.lambda(u, y)
    }

    /// The same error, or the stage whose f was not finite: that is where it came from.
    #[cold]
    fn explain(&mut self, alg: &P::Group, error: StepError) -> StepError {
        let stage = self.k.iter().position(|k| !alg.is_finite(k));
        // The next attempt must not see the numbers of this one.
        self.k.iter_mut().for_each(|k| alg.set_zero(k));
        stage.map_or(error, |stage| StepError::NonFiniteRhs { stage: stage + 1 })
    }
}

impl<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> Method<P> for Rkmk<Psi, S> {
    type Work = RkmkWork<P, Psi, S>;

    fn order(&self, problem: &P) -> usize {
        self.tableau.order.min(self.psi.order(problem.group()))
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let alg = problem.group();
        Ok(RkmkWork {
            k: core::array::from_fn(|_| alg.zero()),
            u: alg.zero(),
            y: like.clone(),
            chart: ChartStore::new(problem, &self.psi, like)?,
        })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        w: &mut Self::Work,
    ) -> Result<(), StepError> {
        match w.advance(self, problem, step, p) {
            Ok(()) => {
                core::mem::swap(p, &mut w.y);
                Ok(())
            }
            Err(error) => Err(w.explain(problem.group(), error)),
        }
    }
}
