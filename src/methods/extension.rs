//! Continuous extensions: the points within a step, from its stages and a few more.
//!
//! u(θ) = h Σ_j w_j(θ) k_j + h Σ_e x_e(θ) d_e, y(t + θh) ≈ λ_p(u(θ)), with u(0) = 0 and u(1) = v exactly. So the
//! point lies on M, and θ = 1 gives the end of the step. The weights are those of [`Dense`]. The extra stages d_e are
//! values of f̃ at such combinations. On the linear space around M the point is y + u(θ).
//!
//! The general extension interpolates v, the slopes h k₁ and h f̃(v) at both ends, and slopes within the step:
//!
//! | order | slopes within | taken on |
//! |---|---|---|
//! | 3 | | |
//! | 4 | at 1/4 | the cubic |
//! | 5 | at 1/2 and 1/5 | the one of order 4 |
//!
//! A slope from a point with an error O(h⁴) has the error O(h⁵). The next order needs this.
//!
//! Cost: [`Extension::evaluations`] of f̃ for each step, one λ_p for each point.
//! Source: L. F. Shampine, Interpolation for Runge–Kutta methods, SIAM J. Numer. Anal. 22 (1985); W. H. Enright,
//! K. R. Jackson, S. P. Nørsett, P. G. Thomsen, Interpolants for Runge–Kutta formulas, ACM Trans. Math. Softw. 12
//! (1986); Hairer, Nørsett, Wanner I, II.6.

use super::stages::copies;
use super::tableau::{Dense, Row};
use super::{Step, Tableau};
use crate::chart::Chart;
use crate::error::StepError;
use crate::groups::LieAlgebra;
use crate::maps::CoordinateMap;
use crate::problems::{AlgOf, Ambient, FieldStore, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::{LinearSpace, Metric};

/// The largest number of extra stages.
pub(super) const EXTRA: usize = 4;

/// For each extra stage of the general extension: the degree of its interpolant, and its θ.
const SAMPLES: [(usize, f64); EXTRA] = [(3, 1.0), (3, 0.25), (4, 0.5), (4, 0.2)];

/// The weights of S stages and of the extra ones.
#[derive(Clone, Copy)]
pub(super) struct Weights<const S: usize> {
    stages: [f64; S],
    extra: [f64; EXTRA],
}

impl<const S: usize> Weights<S> {
    const ZERO: Self = Weights { stages: [0.0; S], extra: [0.0; EXTRA] };

    /// These weights and a times those of the row.
    fn plus(mut self, a: f64, row: &Row) -> Self {
        self.stages.iter_mut().zip(row.stages).for_each(|(w, r)| *w += a * r);
        self.extra.iter_mut().zip(row.extra).for_each(|(w, r)| *w += a * r);
        self
    }

    /// u ← h Σ w_j k_j + h Σ x_e d_e in 𝔤.
    fn in_algebra<G: LieAlgebra>(
        &self,
        alg: &G,
        h: G::Scalar,
        k: &[G::Alg; S],
        d: &[G::Alg],
        u: &mut G::Alg,
    ) {
        alg.combine(h, &self.stages, k, u);
        for (&x, d) in self.extra.iter().zip(d) {
            if x != 0.0 {
                alg.axpy(h * G::Scalar::lit(x), d, u);
            }
        }
    }

    /// z ← y + h Σ w_j k_j + h Σ x_e d_e.
    fn in_space<Y: LinearSpace>(&self, y: &Y, h: Y::Scalar, k: &[Y; S], d: &[Y], z: &mut Y) {
        z.set_sum(y, h, &self.stages, k);
        for (&x, d) in self.extra.iter().zip(d) {
            if x != 0.0 {
                z.add(h * Y::Scalar::lit(x), d);
            }
        }
    }
}

/// The weights of v, h k₁ and h e in the cubic of Hermite.
fn cubic(theta: f64) -> [f64; 3] {
    let rest = 1.0 - theta;
    [theta * theta * (1.0 + 2.0 * rest), theta * rest * rest, -theta * theta * rest]
}

/// Their derivatives.
fn slope_of_cubic(theta: f64) -> [f64; 3] {
    [6.0 * theta * (1.0 - theta), (1.0 - theta) * (1.0 - 3.0 * theta), theta * (3.0 * theta - 2.0)]
}

/// θ²(1 − θ)².
fn bump(theta: f64) -> f64 {
    (theta * (1.0 - theta)).powi(2)
}

/// The continuous extension of a step with S stages.
#[derive(Clone, Copy)]
pub(super) struct Extension<'a, const S: usize> {
    /// v = h Σ b_j k_j.
    b: &'a [f64; S],
    /// The index of k₁.
    first: usize,
    /// u(0) = start·v.
    start: f64,
    /// The order of the step.
    order: usize,
    dense: Dense,
}

/// The general extension of a step of this order with one increment v, in one chart or in the linear space. Its "stages"
/// are v/h and k₁; u(0) = start·v.
pub(super) const fn of_increment(order: usize, start: f64) -> Extension<'static, 2> {
    Extension { b: &[1.0, 0.0], first: 1, start, order, dense: Dense::General }
}

impl<'a, const S: usize> Extension<'a, S> {
    /// The extension of a tableau, whose first stage is k₁.
    pub(super) fn of(tableau: &'a Tableau<S>) -> Self {
        let Tableau { b, order, dense, .. } = tableau;
        Extension { b, first: 0, start: 0.0, order: *order, dense: *dense }
    }

    /// The order at a fixed θ.
    pub(super) fn order(&self) -> usize {
        match self.dense {
            Dense::Cubic { order, .. } | Dense::Raised { order, .. } => order,
            Dense::General => self.degree().min(self.order),
        }
    }

    /// The degree of the general extension.
    fn degree(&self) -> usize {
        self.order.saturating_sub(1).clamp(3, 5)
    }

    /// The number of extra stages.
    pub(super) fn evaluations(&self) -> usize {
        match self.dense {
            Dense::Cubic { .. } => 0,
            Dense::Raised { stages, .. } => 1 + stages.len(),
            Dense::General => match self.degree() {
                3 => 1,
                4 => 2,
                _ => 4,
            },
        }
    }

    /// The weights of a·v + b·h k₁ + c·h e.
    fn ends(&self, [v, k1, e]: [f64; 3]) -> Weights<S> {
        let mut weights = Weights { stages: self.b.map(|b| v * b), ..Weights::ZERO };
        weights.stages[self.first] += k1;
        match self.dense {
            Dense::Cubic { end, .. } => weights.plus(e, &Row { stages: end, extra: &[] }),
            _ => weights.plus(e, &Row { stages: &[], extra: &[1.0] }),
        }
    }

    /// The weights of the general extension of this degree.
    ///
    /// θ²(1 − θ)² and, for degree 5, its product with θ correct the cubic to the slopes within.
    fn general(&self, degree: usize, theta: f64) -> Weights<S> {
        let (mut ends, mut extra) = (cubic(theta), [0.0; EXTRA]);
        ends[0] += self.start;
        // B' = 3/16 at 1/4, 0 at 1/2, 0.192 at 1/5 for B = θ²(1 − θ)²; (θB)' = 1/16 at 1/2, 0.064 at 1/5.
        let slopes: &[(usize, f64)] = match degree {
            3 => &[],
            4 => &[(1, bump(theta) * 16.0 / 3.0)],
            _ => &[(2, bump(theta) * 16.0 * (theta - 1.0 / 3.0)), (3, bump(theta) / 0.192)],
        };
        for &(stage, weight) in slopes {
            extra[stage] = weight;
            let known = slope_of_cubic(SAMPLES[stage].1);
            ends.iter_mut().zip(known).for_each(|(w, s)| *w -= weight * s);
        }
        let mut weights = self.ends(ends);
        weights.extra.iter_mut().zip(extra).for_each(|(w, x)| *w += x);
        weights
    }

    /// The weights of u(θ)/h.
    pub(super) fn weights(&self, theta: f64) -> Weights<S> {
        match self.dense {
            Dense::Cubic { .. } => self.ends(cubic(theta)),
            Dense::General => self.general(self.degree(), theta),
            Dense::Raised { rows, .. } => {
                let powers = [1.0, theta, theta * (1.0 - theta), theta * theta * (1.0 - theta)];
                let terms = rows.iter().zip(powers.map(|power| power * bump(theta)));
                terms.fold(self.ends(cubic(theta)), |sum, (row, a)| sum.plus(a, row))
            }
        }
    }

    /// The node c of an extra stage, and the weights of its u.
    fn sample(&self, e: usize) -> (f64, Weights<S>) {
        match self.dense {
            Dense::Raised { stages, .. } if e > 0 => {
                let (c, row) = &stages[e - 1];
                (*c, Weights::ZERO.plus(1.0, row))
            }
            _ => (SAMPLES[e].1, self.general(SAMPLES[e].0, SAMPLES[e].1)),
        }
    }

    /// Calls `field` for each extra stage after the known ones, one after the other, with its number e, its node c and the
    /// weights of its u.
    ///
    /// `field` reads the stages before e and writes stage e of one array. It does not get them as two references:
    /// docs/compiler-fault.md says why.
    fn stages(
        &self,
        known: usize,
        mut field: impl FnMut(usize, f64, &Weights<S>) -> Result<(), StepError>,
    ) -> Result<(), StepError> {
        for e in known..self.evaluations() {
            let (c, weights) = self.sample(e);
            field(e, c, &weights)?;
        }
        Ok(())
    }

    /// d ← the extra stages in a chart. The first one, at the end of the step, is the stage `end` if that is known.
    pub(super) fn prepare_in_chart<P: Problem, Psi: CoordinateMap<P::Group>>(
        &self,
        alg: &P::Group,
        chart: &mut Chart<'_, P, Psi>,
        Step { t, h, .. }: Step<ScalarOf<P>>,
        (k, end): (&[AlgOf<P>; S], Option<usize>),
        d: &mut [AlgOf<P>; EXTRA],
        u: &mut AlgOf<P>,
    ) -> Result<(), StepError> {
        if let Some(end) = end {
            alg.combine(ScalarOf::<P>::lit(1.0), &[1.0], &k[end..=end], &mut d[0]);
        }
        self.stages(usize::from(end.is_some()), |e, c, weights| {
            weights.in_algebra(alg, h, k, &d[..e], u);
            chart.pullback(t + h * ScalarOf::<P>::lit(c), u, &mut d[e])?;
            finite(alg.is_finite(&d[e]))
        })
    }

    /// `at` ← λ_p(u(θ)), after [`prepare_in_chart`](Self::prepare_in_chart).
    pub(super) fn point_in_chart<P: Problem, Psi: CoordinateMap<P::Group>>(
        &self,
        alg: &P::Group,
        chart: &mut Chart<'_, P, Psi>,
        (theta, h): (f64, ScalarOf<P>),
        k: &[AlgOf<P>; S],
        d: &[AlgOf<P>; EXTRA],
        u: &mut AlgOf<P>,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.coordinates(alg, (theta, h), k, d, u);
        finite(alg.is_finite(u))?;
        chart.lambda(u, at)
    }

    /// u ← u(θ), after [`prepare_in_chart`](Self::prepare_in_chart).
    pub(super) fn coordinates<G: LieAlgebra>(
        &self,
        alg: &G,
        (theta, h): (f64, G::Scalar),
        k: &[G::Alg; S],
        d: &[G::Alg; EXTRA],
        u: &mut G::Alg,
    ) {
        self.weights(theta).in_algebra(alg, h, k, d, u);
    }

    /// d ← the extra stages in the linear space around M. The first one, at the end of the step, is the stage `end` if
    /// that is known.
    pub(super) fn prepare_in_space<P: Ambient>(
        &self,
        problem: &P,
        Step { t, h, .. }: Step<ScalarOf<P>>,
        y: &PointOf<P>,
        (k, end): (&[PointOf<P>; S], Option<usize>),
        d: &mut [PointOf<P>; EXTRA],
        z: &mut PointOf<P>,
        store: &mut FieldStore<P>,
    ) -> Result<(), StepError> {
        if let Some(end) = end {
            d[0].assign(&k[end]);
        }
        self.stages(usize::from(end.is_some()), |e, c, weights| {
            weights.in_space(y, h, k, &d[..e], z);
            problem.field(t + h * ScalarOf::<P>::lit(c), z, &mut d[e], store);
            finite(d[e].is_finite())
        })
    }

    /// `at` ← y + u(θ), after [`prepare_in_space`](Self::prepare_in_space).
    pub(super) fn point_in_space<Y: LinearSpace>(
        &self,
        (theta, h): (f64, Y::Scalar),
        y: &Y,
        k: &[Y; S],
        d: &[Y; EXTRA],
        at: &mut Y,
    ) -> Result<(), StepError> {
        self.weights(theta).in_space(y, h, k, d, at);
        finite(at.is_finite())
    }
}

/// The error of numbers that are not finite.
fn finite(is: bool) -> Result<(), StepError> {
    StepError::finite(is, "the continuous extension")
}

/// The general extension of a step with one increment in one chart: its v/h and k₁, and the extra stages.
pub(super) struct OneIncrement<P: Problem> {
    /// v/h and k₁.
    pub(super) k: [AlgOf<P>; 2],
    d: [AlgOf<P>; EXTRA],
    u: AlgOf<P>,
}

impl<P: Problem> OneIncrement<P> {
    pub(super) fn new(alg: &P::Group) -> Self {
        OneIncrement { k: copies(alg.zero()), d: copies(alg.zero()), u: alg.zero() }
    }

    /// k₁ ← f̃ at the start, for a method without this stage.
    pub(super) fn first<Psi: CoordinateMap<P::Group>>(
        &mut self,
        extension: &Extension<2>,
        alg: &P::Group,
        chart: &mut Chart<'_, P, Psi>,
        Step { t, h, .. }: Step<ScalarOf<P>>,
    ) -> Result<(), StepError> {
        let OneIncrement { k: [v, k1], u, .. } = self;
        alg.set_zero(u);
        alg.axpy(ScalarOf::<P>::lit(extension.start) * h, v, u);
        chart.pullback(t, u, k1)?;
        finite(alg.is_finite(k1))
    }

    /// The extra stages.
    pub(super) fn prepare<Psi: CoordinateMap<P::Group>>(
        &mut self,
        extension: &Extension<2>,
        alg: &P::Group,
        chart: &mut Chart<'_, P, Psi>,
        step: Step<ScalarOf<P>>,
    ) -> Result<(), StepError> {
        let OneIncrement { k, d, u } = self;
        extension.prepare_in_chart(alg, chart, step, (k, None), d, u)
    }

    /// u ← u(θ).
    pub(super) fn coordinates(
        &self,
        extension: &Extension<2>,
        alg: &P::Group,
        at_part: (f64, ScalarOf<P>),
        u: &mut AlgOf<P>,
    ) {
        extension.coordinates(alg, at_part, &self.k, &self.d, u);
    }

    /// `at` ← λ_p(u(θ)).
    pub(super) fn point<Psi: CoordinateMap<P::Group>>(
        &mut self,
        extension: &Extension<2>,
        alg: &P::Group,
        chart: &mut Chart<'_, P, Psi>,
        at_part: (f64, ScalarOf<P>),
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let OneIncrement { k, d, u } = self;
        extension.point_in_chart(alg, chart, at_part, k, d, u, at)
    }
}
