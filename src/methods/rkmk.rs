//! Runge–Kutta–Munthe-Kaas: any explicit tableau × any coordinate map × any action (Table 1).
//!
//! k₁ = f(t, p); u_i = h Σ_j a_ij k_j; k_i = dΨ_{u_i}⁻¹ f(t + c_i h, λ_p(u_i)); v = h Σ_j b_j k_j;
//! y = λ_p(v).
//!
//! Order: that of the tableau, if dΨ⁻¹ is accurate enough. Preserves: the group, and the invariants of the action
//! (Casimirs on a coadjoint orbit), but not the energy, the symplectic structure or time symmetry. Cost of a step with
//! S stages: S times f, S times Ψ (applied without forming it, if the action allows), S − 1 times dΨ⁻¹. A stage that
//! only the error estimate needs is left out without an estimate.
//! Points within a step: [`Dense`](super::tableau::Dense) in the chart of the step.
//! Source: H. Munthe-Kaas, High order Runge–Kutta methods on manifolds, Appl. Numer. Math. 29 (1999).

use super::embedded::{LARGEST_RATIO, ratio_in_algebra};
use super::extension::{EXTRA, Extension};
use super::stages::{Stages, copies};
use super::{Embedded, Facts, MapCounts, Method, Step, StepCost, Tableau, Within};
use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::CoordinateMap;
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::{Real, larger, smaller};
use crate::tolerance::{Scales, Tolerance};

/// RKMK with S stages and the map Ψ.
///
/// Table 1 of the paper is `Rkmk::new(RK4, Exp)`.
#[derive(Clone, Copy, Debug)]
pub struct Rkmk<Psi, const S: usize> {
    tableau: Tableau<S>,
    /// The number of stages of the update.
    stages: usize,
    /// The stage at the end of the step, of a pair that has one.
    end: Option<usize>,
    psi: Psi,
}

impl<Psi, const S: usize> Rkmk<Psi, S> {
    /// Makes the method.
    pub const fn new(tableau: Tableau<S>, psi: Psi) -> Self {
        let end = match tableau.ends_with_first_stage() {
            true => Some(tableau.all_stages() - 1),
            false => None,
        };
        Rkmk { tableau, stages: tableau.update_stages(), end, psi }
    }
}

/// Stages, the chart, and the extra stages of dense output.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct RkmkWork<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> {
    stages: Stages<P, Psi, S>,
    y: PointOf<P>,
    extra: [AlgOf<P>; EXTRA],
    /// The stage at the end of the last step, if that step took it.
    end: Option<usize>,
    /// How often that stage served dense output.
    reused: u64,
}

impl<Psi, const S: usize> Rkmk<Psi, S> {
    /// `to` ← the step from p, with the first `count` stages; then u is v.
    #[inline(always)]
    fn advance<P: Problem>(
        &self,
        count: usize,
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        p: &PointOf<P>,
        Stages { k, u, chart }: &mut Stages<P, Psi, S>,
        to: &mut PointOf<P>,
    ) -> Result<(), StepError>
    where
        Psi: CoordinateMap<P::Group>,
    {
        let (tab, alg) = (&self.tableau, problem.group());
        let mut chart = chart.around(problem, &self.psi, n, p);
        chart.field(t, &mut k[0]);
        for i in 1..S {
            if i >= count {
                break;
            }
            alg.combine(h, &tab.a[i][..i], &k[..i], u); // u_i = h Σ_j a_ij k_j
            chart.pullback(t + h * ScalarOf::<P>::lit(tab.c[i]), u, &mut k[i])?;
        }
        alg.combine(h, &tab.b, k, u); // v = h Σ_j b_j k_j
        if !alg.is_finite(u) {
            return Err(StepError::NotFinite { what: "the increment v" });
        }
        chart.lambda(u, to)
    }
}

impl<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> Method<P> for Rkmk<Psi, S> {
    type Work = RkmkWork<P, Psi, S>;

    fn facts(&self, problem: &P) -> Facts {
        let (tableau, extension) = (&self.tableau, Extension::of(&self.tableau));
        let most = self.psi.order(problem.group());
        let maps = |stages| MapCounts { psi: stages, dpsi_inv: stages - 1, brackets: 0 };
        let (stages, all) = (self.stages as u64, tableau.all_stages() as u64);
        let facts = Facts::of_order(tableau.order.min(most))
            .cost(Some(stages), maps(stages))
            // A dΨ⁻¹ that is cut early makes an error of its own, which the pair does not see.
            .estimate(tableau.name, tableau.error.map(|e| e.order.min(most)))
            .dense(extension.order().min(most), extension.evaluations());
        let step_with_error = StepCost { evaluations: Some(all), maps: Some(maps(all)) };
        Facts { step_with_error, ..facts }
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        self.tableau.check_before_run()?;
        Ok(RkmkWork {
            stages: Stages::new(problem, &self.psi, like)?,
            y: like.clone(),
            extra: copies(problem.group().zero()),
            end: None,
            reused: 0,
        })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        RkmkWork { stages, y, end, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        *end = None;
        let done = self.advance(self.stages, problem, step, p, stages, y);
        stages.conclude(problem, done, p, y)
    }
    fn prepare(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        _: &PointOf<P>,
        RkmkWork { stages: Stages { k, u, chart }, extra, end, reused, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let mut chart = chart.around(problem, &self.psi, step.n, from);
        let extension = Extension::of(&self.tableau);
        let end = end.filter(|_| extension.evaluations() > 0);
        *reused += u64::from(end.is_some());
        extension.prepare_in_chart(problem.group(), &mut chart, step, (k, end), extra, u)
    }
    fn reused(&self, work: &Self::Work) -> u64 {
        work.reused
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
        RkmkWork { stages, extra, .. }: &mut Self::Work,
        u: &mut AlgOf<P>,
    ) {
        Extension::of(&self.tableau).coordinates(problem.group(), (theta, h), &stages.k, extra, u);
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
        work.stages.chart.around(problem, &self.psi, n, base).lambda(u, at)
    }
    fn interpolate(
        &self,
        problem: &P,
        Step { n, h, .. }: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        RkmkWork { stages: Stages { k, u, chart }, extra, .. }: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let mut chart = chart.around(problem, &self.psi, n, from);
        let extension = Extension::of(&self.tableau);
        extension.point_in_chart(problem.group(), &mut chart, (theta, h), k, extra, u, at)
    }
}

/// Steps by error turn the state by so many radians at most, also those of methods with [`Facts::short_turns`]. Where f is
/// almost constant, a step could be longer. But at large u
/// dΨ⁻¹ multiplies the rounding of the stages, again and again in the further stages of dense output, and the error of a step
/// does not see these.
pub(crate) const FARTHEST: f64 = 8.0;

impl<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> Embedded<P> for Rkmk<Psi, S> {
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        RkmkWork { stages, end, .. }: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        let (alg, all) = (problem.group(), self.tableau.all_stages());
        *end = self.end;
        let done = self.advance(all, problem, step, from, stages, to);
        done.map_err(|error| stages.blame(problem, error))?;
        let Stages { k, u, .. } = stages;
        let length = alg.norm(u);
        let size = |weights: &[f64; S]| {
            alg.combine(step.h, weights, k, u);
            ratio_in_algebra(problem, tolerance, u, [from, &*to], length)
        };
        let error = match &self.tableau.error {
            Some(estimate) => estimate.error(size),
            None => ScalarOf::<P>::lit(f64::INFINITY),
        };
        let Some(estimate) = &self.tableau.error else { return Ok(error) };
        if !error.is_finite() {
            let error = StepError::NotFinite { what: "the error estimate" };
            return Err(stages.blame(problem, error));
        }
        // A step that turns as far as it may has an error of 1, which grows in the order of the estimate. One that turns farther
        // is accepted only where steps have a least size: it may be the least.
        let of_turn = |turn: ScalarOf<P>| {
            let part = turn / ScalarOf::<P>::lit(FARTHEST);
            (0..=estimate.order).fold(ScalarOf::<P>::lit(1.0), |power, _| power * part)
        };
        if !(error - of_turn(length)).any_below(0.0) {
            return Ok(error);
        }
        alg.combine(step.h, &self.tableau.b, k, u);
        let relative = problem.action().error_ratio(alg, u, from, &mut Scales::relative());
        let error_of_turn = of_turn(smaller(length, relative));
        let most = if tolerance.has_least_step() { 1.0 } else { LARGEST_RATIO };
        Ok(larger(error, smaller(ScalarOf::<P>::lit(most), error_of_turn)))
    }
}
