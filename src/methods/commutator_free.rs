//! Commutator-free methods: stages and update are products of exponentials of sums of stages.
//!
//! k_i = f(t + c_i h, Y_i); Y_i = exp(h Σ_j α_ij^J k_j) ⋯ exp(h Σ_j α_ij^1 k_j) Y_from, and the same
//! for the update. No bracket and no dΨ⁻¹.
//!
//! | table | order | stages | exponentials | source |
//! |---|---|---|---|---|
//! | [`CF3`] | 3 | 3 | 3 | Celledoni, Marthinsen, Owren 2003 |
//! | [`CF4`] | 4 | 4 | 5 | the same |
//! | [`CF43`] | 4(3) | 4, and 1 for the error | 5, and 3 | Curry, Owren 2019 |
//!
//! Crouch–Grossman methods are such tables with one stage in each exponential
//! ([`crouch_grossman`](super::crouch_grossman)). The map is exp. The order conditions need its one-parameter
//! subgroups; with another Ψ the order is lower. Cost: one f for each stage and one exp, applied to a point, for each
//! factor. Preserves: the group, and the invariants of the action. Source: E. Celledoni, A. Marthinsen, B. Owren,
//! Commutator-free Lie group methods, FGCS 19 (2003); C. Curry, B. Owren, Variable step size commutator free Lie group
//! integrators, Numer. Algorithms 82 (2019).

use super::embedded::ratio_between;
use super::stages::{Stages, copies};
use super::tableau::pad;
use super::{Embedded, Facts, MapCounts, Method, Metric, Step, StepCost};
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::{CoordinateMap, Exp};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::tolerance::Tolerance;

/// A product of exponentials that acts on a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExponentialProduct<const S: usize> {
    /// The stage whose point it starts from; 0 is the start of the step.
    pub from: usize,
    /// The weights of the stages in each factor; the first is applied first.
    pub factors: &'static [[f64; S]],
}

/// The coefficients of a commutator-free method with S stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProductTableau<const S: usize> {
    /// The name of the method.
    pub name: &'static str,
    /// The order of the method.
    pub order: usize,
    /// Nodes c_i.
    pub c: [f64; S],
    /// Stages; the first is the start of the step, a product without factors.
    pub stages: [ExponentialProduct<S>; S],
    /// The update.
    pub update: ExponentialProduct<S>,
    /// The number of stages of the update.
    pub update_stages: usize,
    /// A second result and its order, from the same stages.
    pub embedded: Option<(usize, ExponentialProduct<S>)>,
}

impl<const S: usize> ProductTableau<S> {
    /// The number of stages of the update and the second result.
    const fn all_stages(&self) -> usize {
        if self.embedded.is_some() { S } else { self.update_stages }
    }

    /// The number of exponentials of the update, or of the update and the second result.
    fn exponentials(&self, with_error: bool) -> usize {
        let second = self.embedded.as_ref().filter(|_| with_error).map(|(_, product)| product);
        let count = if with_error { self.all_stages() } else { self.update_stages };
        let products = self.stages[..count].iter().chain([&self.update]).chain(second);
        products.map(|product| product.factors.len()).sum()
    }
}

/// The start of the step: the first stage of every table.
pub(super) const fn start<const S: usize>() -> ExponentialProduct<S> {
    ExponentialProduct { from: 0, factors: &[] }
}

/// The stages of a table: the start of the step, these, and room for more that are never evaluated.
pub(super) const fn stages<const S: usize, const N: usize>(
    later: [ExponentialProduct<S>; N],
) -> [ExponentialProduct<S>; S] {
    let mut stages = [start(); S];
    let mut i = 0;
    while i < N {
        stages[i + 1] = later[i];
        i += 1;
    }
    stages
}

/// Order 3 with 3 stages; the update starts from the second.
pub const CF3: ProductTableau<3> = cf3();

/// [`CF3`] with room for S stages, so that methods chosen by name share one type.
pub(crate) const fn cf3<const S: usize>() -> ProductTableau<S> {
    ProductTableau {
        name: "cf3",
        order: 3,
        c: pad(&[0.0, 1.0 / 3.0, 2.0 / 3.0]),
        stages: stages([
            ExponentialProduct { from: 0, factors: const { &[pad(&[1.0 / 3.0])] } },
            ExponentialProduct { from: 0, factors: const { &[pad(&[0.0, 2.0 / 3.0])] } },
        ]),
        update: ExponentialProduct {
            from: 1,
            factors: const { &[pad(&[-1.0 / 12.0, 0.0, 0.75])] },
        },
        update_stages: 3,
        embedded: None,
    }
}

const T: f64 = 1.0 / 12.0;

/// Order 4 with 4 stages; the fourth starts from the second.
pub const CF4: ProductTableau<4> = cf4();

/// [`CF4`] with room for S stages.
pub(crate) const fn cf4<const S: usize>() -> ProductTableau<S> {
    ProductTableau {
        name: "cf4",
        order: 4,
        c: pad(&[0.0, 0.5, 0.5, 1.0]),
        stages: stages([
            ExponentialProduct { from: 0, factors: const { &[pad(&[0.5])] } },
            ExponentialProduct { from: 0, factors: const { &[pad(&[0.0, 0.5])] } },
            ExponentialProduct { from: 1, factors: const { &[pad(&[-0.5, 0.0, 1.0])] } },
        ]),
        update: ExponentialProduct {
            from: 0,
            factors: const {
                &[pad(&[3.0 * T, 2.0 * T, 2.0 * T, -T]), pad(&[-T, 2.0 * T, 2.0 * T, 3.0 * T])]
            },
        },
        update_stages: 4,
        embedded: None,
    }
}

/// [`CF4`] with a fifth stage for an embedded result of order 3.
pub const CF43: ProductTableau<5> = {
    let ProductTableau { mut c, mut stages, update, .. } = cf4::<5>();
    (c[4], stages[4]) =
        (0.75, ExponentialProduct { from: 0, factors: &[[0.0, 0.75, 0.0, 0.0, 0.0]] });
    let embedded = ExponentialProduct {
        from: 0,
        factors: &[[1.0 / 3.0, 0.0, 0.0, 0.0, 0.0], [-1.0 / 9.0, 1.0 / 3.0, 0.0, 0.0, 4.0 / 9.0]],
    };
    let embedded = Some((3, embedded));
    ProductTableau { name: "cf43", order: 4, c, stages, update, update_stages: 4, embedded }
};

/// A commutator-free method with S stages.
#[derive(Clone, Copy, Debug)]
pub struct CommutatorFree<const S: usize>(pub ProductTableau<S>);

/// Stages, their points, and the chart.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
#[doc(hidden)]
pub struct CommutatorFreeWork<P: Problem, const S: usize>
where
    Exp: CoordinateMap<P::Group>,
{
    inner: Inner<P, S>,
    y: PointOf<P>,
}

struct Inner<P: Problem, const S: usize>
where
    Exp: CoordinateMap<P::Group>,
{
    stages: Stages<P, Exp, S>,
    points: [PointOf<P>; S],
    aside: PointOf<P>,
}

impl<P: Problem, const S: usize> Inner<P, S>
where
    Exp: CoordinateMap<P::Group>,
{
    /// `to` ← the product, acting on its starting point. It must have at least one factor.
    #[inline(always)]
    fn product(
        &mut self,
        problem: &P,
        Step { n, h, .. }: Step<ScalarOf<P>>,
        p: &PointOf<P>,
        product: &ExponentialProduct<S>,
        to: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let Inner { stages: Stages { k, u, chart }, points, aside } = self;
        for (i, weights) in product.factors.iter().enumerate() {
            problem.group().combine(h, weights, k, u);
            let copy;
            let from = match (i, product.from) {
                (0, 0) => p,
                (0, from) => &points[from],
                // A swap of small points goes through memory.
                _ if PointOf::<P>::IS_SMALL => {
                    copy = to.clone();
                    &copy
                }
                _ => {
                    core::mem::swap(aside, to);
                    &*aside
                }
            };
            chart.around(problem, &Exp, n, from).lambda(u, to)?;
        }
        Ok(())
    }

    /// The first `count` stages, and `to` ← the update.
    #[inline(always)]
    fn advance(
        &mut self,
        table: &ProductTableau<S>,
        count: usize,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &PointOf<P>,
        to: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let Stages { k, chart, .. } = &mut self.stages;
        chart.around(problem, &Exp, step.n, p).field(step.t, &mut k[0]);
        for i in 1..count {
            self.product(problem, step, p, &table.stages[i], to)?;
            match PointOf::<P>::IS_SMALL {
                true => self.points[i].assign(to),
                false => core::mem::swap(&mut self.points[i], to),
            }
            let t = step.t + step.h * ScalarOf::<P>::lit(table.c[i]);
            let Stages { k, chart, .. } = &mut self.stages;
            chart.around(problem, &Exp, step.n, &self.points[i]).field(t, &mut k[i]);
        }
        if !self.stages.k[..count].iter().all(|k| problem.group().is_finite(k)) {
            return Err(StepError::NotFinite { what: "a stage" });
        }
        self.product(problem, step, p, &table.update, to)
    }
}

impl<P: Problem, const S: usize> Method<P> for CommutatorFree<S>
where
    Exp: CoordinateMap<P::Group>,
{
    type Work = CommutatorFreeWork<P, S>;

    fn facts(&self, _: &P) -> Facts {
        let maps = |with_error| {
            let psi = self.0.exponentials(with_error) as u64;
            MapCounts { psi, ..MapCounts::default() }
        };
        let facts =
            Facts::of_order(self.0.order).cost(Some(self.0.update_stages as u64), maps(false));
        let evaluations = Some(self.0.all_stages() as u64);
        let step_with_error = StepCost { evaluations, maps: Some(maps(true)) };
        let error_order = self.0.embedded.map(|(order, _)| order);
        Facts { step_with_error, ..facts.estimate(self.0.name, error_order) }
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let inner = Inner {
            stages: Stages::new(problem, &Exp, like)?,
            points: copies(like.clone()),
            aside: like.clone(),
        };
        Ok(CommutatorFreeWork { inner, y: like.clone() })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        CommutatorFreeWork { inner, y }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let done = inner.advance(&self.0, self.0.update_stages, problem, step, p, y);
        inner.stages.conclude(problem, done, p, y)
    }
}

impl<P: Problem, const S: usize> Embedded<P> for CommutatorFree<S>
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
        CommutatorFreeWork { inner, y }: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        let done = inner.advance(&self.0, self.0.all_stages(), problem, step, from, to);
        done.map_err(|error| inner.stages.blame(problem, error))?;
        let error = match &self.0.embedded {
            Some((_, product)) => {
                inner.product(problem, step, from, product, y)?;
                ratio_between(tolerance, y, 1.0, from, to)
            }
            None => ScalarOf::<P>::lit(f64::INFINITY),
        };
        Ok(error)
    }
}
