//! Methods with explicit brackets instead of dexp⁻¹: at most one in each stage and in the update.
//!
//! k_i = f(t + c_i h, exp(u_i) y), u_i = h Σ_j w_ij k_j + h² \[k_1, Σ_j x_ij k_j\], and the same for v;
//! y⁺ = exp(v) y.
//!
//! | table | order | f | exp | brackets | source |
//! |---|---|---|---|---|---|
//! | [`RKMK4_2C`] | 4 | 4 | 4 | 2 | Munthe-Kaas, Owren 1999 |
//! | [`MAGNUS43`] | 4(3) | 6 | 6 | 3 | Casas, Iserles 2006, with another estimate |
//!
//! The second is the Magnus method for nonlinear equations. The map is exp, because the brackets are those of exp. Cost:
//! see the table; one f more for dense output, of order 3. Preserves: the group, and the invariants of the action.
//!
//! Its error estimate is not that of its source. There the last stage is the result of order 3. Where f depends on t alone
//! and commutes, both results are Simpson's rule, and where f is linear in t, both have the same bracket: their difference is
//! 0 whatever the error. So the result of order 3 here has one stage more, at c = ¼, and is a product of two exponentials:
//! exp(h(−k₁/2 + 8k₇/9 + 5k₆/18)) exp(h k₁/3). Its rule has the nodes 0, ¼ and 1, and its factors do not commute where f does
//! not. Cost of a step with an estimate: 7 f, 9 exp, 3 brackets. Source: H. Munthe-Kaas, B. Owren, Computations in a free Lie algebra,
//! Phil. Trans. R. Soc. A 357 (1999); F. Casas, A. Iserles, Explicit Magnus expansions for nonlinear
//! equations, J. Phys. A 39 (2006).

use super::embedded::ratio_between;
use super::extension::{Extension, OneIncrement, of_increment};
use super::stages::Stages;
use super::tableau::pad;
use super::{Embedded, Facts, MapCounts, Method, Metric, Step, StepCost, Within};
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::{CoordinateMap, Exp};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::tolerance::Tolerance;

/// An increment h Σ w_j k_j + h² \[k_1, Σ x_j k_j\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment<const S: usize> {
    /// w_j.
    pub w: [f64; S],
    /// x_j; all 0 when there is no bracket.
    pub x: [f64; S],
}

impl<const S: usize> Increment<S> {
    /// The increment without a bracket.
    const fn plain(w: [f64; S]) -> Self {
        Increment { w, x: [0.0; S] }
    }
}

/// The coefficients of a method with S stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneBracketTableau<const S: usize> {
    /// The name of the method.
    pub name: &'static str,
    /// The order of the method.
    pub order: usize,
    /// Nodes c_i.
    pub c: [f64; S],
    /// u_i.
    pub stages: [Increment<S>; S],
    /// The increment v of the step.
    pub update: Increment<S>,
    /// The order of another result at t + h, for the error estimate, and the weights of the stages in its two
    /// exponentials; the first is applied first. It may have more stages than the update.
    pub embedded: Option<(usize, [[f64; S]; 2])>,
}

impl<const S: usize> Increment<S> {
    const fn padded<const N: usize>(&self) -> Increment<N> {
        Increment { w: pad(&self.w), x: pad(&self.x) }
    }
    fn has_bracket(&self) -> bool {
        self.x.iter().any(|x| *x != 0.0)
    }
}

impl<const S: usize> OneBracketTableau<S> {
    /// The number of stages of the update: S, or fewer for a [`padded`](Self::padded) method.
    pub const fn stages(&self) -> usize {
        let mut s = S;
        while s > 1 && self.update.w[s - 1] == 0.0 && self.update.x[s - 1] == 0.0 {
            s -= 1;
        }
        s
    }

    /// The number of stages of the update and of the other result.
    fn all_stages(&self) -> usize {
        let has = |s: &usize| {
            self.embedded.is_some_and(|(_, both)| both.iter().any(|w| w[*s - 1] != 0.0))
        };
        (1..=S).rev().find(has).unwrap_or(0).max(self.stages())
    }

    /// This method with room for N ≥ S stages. The added stages are never evaluated.
    pub const fn padded<const N: usize>(&self) -> OneBracketTableau<N> {
        let mut stages = [Increment::plain([0.0; N]); N];
        let mut i = 0;
        while i < S {
            stages[i] = self.stages[i].padded();
            i += 1;
        }
        let OneBracketTableau { name, order, .. } = *self;
        let (c, update) = (pad(&self.c), self.update.padded());
        let embedded = match &self.embedded {
            Some((order, [first, last])) => Some((*order, [pad(first), pad(last)])),
            None => None,
        };
        OneBracketTableau { name, order, c, stages, update, embedded }
    }
}

/// RKMK of order 4 with two commutators.
pub const RKMK4_2C: OneBracketTableau<4> = OneBracketTableau {
    name: "rkmk4-2c",
    order: 4,
    c: [0.0, 0.5, 0.5, 1.0],
    stages: [
        Increment::plain([0.0; 4]),
        Increment::plain([0.5, 0.0, 0.0, 0.0]),
        Increment { w: [0.0, 0.5, 0.0, 0.0], x: [0.0, -1.0 / 8.0, 0.0, 0.0] },
        Increment::plain([0.0, 0.0, 1.0, 0.0]),
    ],
    update: Increment {
        w: [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
        x: [0.0, 0.0, 0.0, -1.0 / 12.0],
    },
    embedded: None,
};

/// The nonlinear Magnus pair 4(3).
pub const MAGNUS43: OneBracketTableau<7> = OneBracketTableau {
    name: "magnus43",
    order: 4,
    c: [0.0, 0.5, 0.5, 1.0, 0.5, 1.0, 0.25],
    stages: [
        Increment::plain([0.0; 7]),
        Increment::plain([0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Increment::plain([0.25, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Increment::plain([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Increment {
            w: [5.0 / 24.0, 0.0, 1.0 / 3.0, -1.0 / 24.0, 0.0, 0.0, 0.0],
            x: [0.0, -1.0 / 48.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        },
        Increment {
            w: [1.0 / 6.0, 0.0, 2.0 / 3.0, 1.0 / 6.0, 0.0, 0.0, 0.0],
            x: [0.0, -1.0 / 6.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        },
        // The integral to ¼ of the parabola through k₁, k₅ and k₆.
        Increment::plain([1.0 / 6.0, 0.0, 0.0, 0.0, 5.0 / 48.0, -1.0 / 48.0, 0.0]),
    ],
    update: Increment {
        w: [1.0 / 6.0, 0.0, 0.0, 0.0, 2.0 / 3.0, 1.0 / 6.0, 0.0],
        x: [0.0, 0.0, 1.0 / 6.0, 0.0, -1.0 / 6.0, -1.0 / 12.0, 0.0],
    },
    embedded: Some((
        3,
        [
            [1.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [-0.5, 0.0, 0.0, 0.0, 0.0, 5.0 / 18.0, 8.0 / 9.0],
        ],
    )),
};

/// A method with at most one bracket in each stage.
#[derive(Clone, Copy, Debug)]
pub struct OneBracket<const S: usize>(pub OneBracketTableau<S>);

impl<const S: usize> OneBracket<S> {
    fn extension(&self) -> Extension<'static, 2> {
        of_increment(self.0.order, 0.0)
    }
}

/// Stages, increments and the chart.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
#[doc(hidden)]
pub struct OneBracketWork<P: Problem, const S: usize>
where
    Exp: CoordinateMap<P::Group>,
{
    inner: Inner<P, S>,
    y: PointOf<P>,
    dense: OneIncrement<P>,
}

struct Inner<P: Problem, const S: usize>
where
    Exp: CoordinateMap<P::Group>,
{
    stages: Stages<P, Exp, S>,
    v: AlgOf<P>,
    x: AlgOf<P>,
    bracket: AlgOf<P>,
    at: PointOf<P>,
}

impl<P: Problem, const S: usize> Inner<P, S>
where
    Exp: CoordinateMap<P::Group>,
{
    /// u ← the increment.
    #[inline(always)]
    fn increment(&mut self, alg: &P::Group, h: ScalarOf<P>, increment: &Increment<S>) {
        let Inner { stages: Stages { k, u, .. }, x, bracket, .. } = self;
        alg.combine(h, &increment.w, k, u);
        if increment.has_bracket() {
            alg.combine(h, &increment.x, k, x);
            alg.bracket(&k[0], x, bracket);
            alg.axpy(h, bracket, u);
        }
    }

    /// k ← the value of stage i of the step from p.
    #[inline(always)]
    fn stage(
        &mut self,
        table: &OneBracketTableau<S>,
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        p: &PointOf<P>,
        i: usize,
    ) -> Result<(), StepError> {
        self.increment(problem.group(), h, &table.stages[i]);
        let Stages { k, u, chart } = &mut self.stages;
        chart.around(problem, &Exp, n, p).lambda(u, &mut self.at)?;
        let t = t + h * ScalarOf::<P>::lit(table.c[i]);
        chart.around(problem, &Exp, n, &self.at).field(t, &mut k[i]);
        Ok(())
    }

    /// `to` ← the step from p. Then u is v.
    #[inline(always)]
    fn advance(
        &mut self,
        table: &OneBracketTableau<S>,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &PointOf<P>,
        to: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let (alg, Step { n, t, h }) = (problem.group(), step);
        let Stages { k, chart, .. } = &mut self.stages;
        chart.around(problem, &Exp, n, p).field(t, &mut k[0]);
        for i in 1..table.stages() {
            self.stage(table, problem, step, p, i)?;
        }
        self.increment(alg, h, &table.update);
        let Stages { u, chart, .. } = &mut self.stages;
        StepError::finite(alg.is_finite(u), "the increment v")?;
        chart.around(problem, &Exp, n, p).lambda(u, to)
    }
}

impl<P: Problem, const S: usize> Method<P> for OneBracket<S>
where
    Exp: CoordinateMap<P::Group>,
{
    type Work = OneBracketWork<P, S>;

    fn facts(&self, _: &P) -> Facts {
        let OneBracketTableau { stages, update, .. } = &self.0;
        let brackets = stages.iter().chain([update]).filter(|u| u.has_bracket()).count() as u64;
        let (stages, extension) = (self.0.stages() as u64, self.extension());
        let cost = |stages, more| StepCost {
            evaluations: Some(stages),
            maps: Some(MapCounts { psi: stages + more, dpsi_inv: 0, brackets }),
        };
        let step = cost(stages, 0);
        let step_with_error = self.0.embedded.map_or(step, |_| cost(self.0.all_stages() as u64, 2));
        let facts = Facts::of_order(self.0.order)
            .estimate(self.0.name, self.0.embedded.map(|(order, _)| order))
            .dense(extension.order(), extension.evaluations());
        // The polynomial of the pair within a step has order 3, and no error estimate sees it.
        Facts { step, step_with_error, short_turns: self.0.embedded.is_some(), ..facts }
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let alg = problem.group();
        let inner = Inner {
            stages: Stages::new(problem, &Exp, like)?,
            v: alg.zero(),
            x: alg.zero(),
            bracket: alg.zero(),
            at: like.clone(),
        };
        Ok(OneBracketWork { inner, y: like.clone(), dense: OneIncrement::new(alg) })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        OneBracketWork { inner, y, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let done = inner.advance(&self.0, problem, step, p, y);
        inner.stages.conclude(problem, done, p, y)
    }
    fn prepare(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        _: &PointOf<P>,
        OneBracketWork { inner, dense, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (alg, Stages { k, u, chart }) = (problem.group(), &mut inner.stages);
        alg.combine(
            ScalarOf::<P>::lit(1.0) / step.h,
            &[1.0],
            core::slice::from_ref(u),
            &mut dense.k[0],
        );
        alg.combine(ScalarOf::<P>::lit(1.0), &[1.0], &k[..1], &mut dense.k[1]);
        dense.prepare(&self.extension(), alg, &mut chart.around(problem, &Exp, step.n, from), step)
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
        work.dense.coordinates(&self.extension(), problem.group(), (theta, h), u);
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
        work.inner.stages.chart.around(problem, &Exp, n, base).lambda(u, at)
    }
    fn interpolate(
        &self,
        problem: &P,
        Step { n, h, .. }: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        OneBracketWork { inner, dense, .. }: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let mut chart = inner.stages.chart.around(problem, &Exp, n, from);
        dense.point(&self.extension(), problem.group(), &mut chart, (theta, h), at)
    }
}

impl<P: Problem, const S: usize> Embedded<P> for OneBracket<S>
where
    Exp: CoordinateMap<P::Group>,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        OneBracketWork { inner, y, .. }: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        let (table, alg) = (&self.0, problem.group());
        let mut done = inner.advance(table, problem, step, from, to);
        let Some((_, [first, last])) = &table.embedded else {
            done.map_err(|error| inner.stages.blame(problem, error))?;
            return Ok(ScalarOf::<P>::lit(f64::INFINITY));
        };
        // u is v again at the end, for dense output.
        core::mem::swap(&mut inner.stages.u, &mut inner.v);
        for i in table.stages()..table.all_stages() {
            done = done.and_then(|()| inner.stage(table, problem, step, from, i));
        }
        let Inner { stages: Stages { k, u, chart }, v, at, .. } = inner;
        let done = done.and_then(|()| {
            alg.combine(step.h, first, k, u);
            chart.around(problem, &Exp, step.n, from).lambda(u, at)?;
            alg.combine(step.h, last, k, u);
            chart.around(problem, &Exp, step.n, at).lambda(u, y)
        });
        core::mem::swap(u, v);
        done.map_err(|error| inner.stages.blame(problem, error))?;
        Ok(ratio_between(tolerance, y, 1.0, from, &*to))
    }
}
