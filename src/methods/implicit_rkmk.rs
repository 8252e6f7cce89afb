//! Implicit Runge–Kutta–Munthe-Kaas on Gauss tableaus, and its time-symmetric version.
//!
//! | | stages | step |
//! |---|---|---|
//! | [`RkmkGauss`] | u_i = h Σ a_ij K_j, K_i = dΨ⁻¹_{u_i} f(t + c_i h, λ_p(u_i)) | λ_p(h Σ b_i K_i) |
//! | [`RkmkGaussSymmetric`] | q = λ_p(−θ), θ = −½h Σ b_j K_j, u_i = θ + h Σ a_ij K_j, K_i = dΨ⁻¹_{u_i} f(t + c_i h, λ_q(u_i)) | λ_q(−θ) |
//!
//! The first has its chart at the start of the step. With two stages or more it is not symmetric, because a step back
//! has its chart at the other end. The second has its chart in the middle. It is symmetric for maps with Ψ(−u) = Ψ(u)⁻¹.
//!
//! Order 2S. Preserves: the group, and the invariants of the action, but not the energy or the symplectic structure.
//! Fixed-point iteration finds the stages. It converges while h times the Lipschitz constant of f is below about 1.
//! Beyond that the step fails with [`StepError::FixedPointDidNotConverge`]. Cost: 5 to 20 iterations, each with S times
//! f, Ψ and dΨ⁻¹; the second method has one Ψ more. Dense output of order 2, 3 and 5 takes 2, 2 and 5 times f more.
//! Source: A. Zanna, K. Engø & H. Munthe-Kaas, Adjoint and selfadjoint Lie-group methods, BIT 41
//! (2001).

use super::embedded::relative_error_of_parts;
use super::extension::{Extension, OneIncrement, of_increment};
use super::gauss::ImplicitTableau;
use super::newton::Progress;
use super::stages::copies;
use super::{Facts, Method, Step, Symmetric, Within};
use crate::chart::ChartStore;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::{Cay, CoordinateMap, Exp, ExpOrCay};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::Metric;

/// Implicit RKMK with its chart at the start of the step.
#[derive(Clone, Copy, Debug)]
pub struct RkmkGauss<Psi, const S: usize> {
    tableau: ImplicitTableau<S>,
    psi: Psi,
}

impl<Psi, const S: usize> RkmkGauss<Psi, S> {
    /// Makes the method.
    pub const fn new(tableau: ImplicitTableau<S>, psi: Psi) -> Self {
        RkmkGauss { tableau, psi }
    }
}

/// A map with Ψ(−u) = Ψ(u)⁻¹.
pub trait OddMap {}
impl OddMap for Exp {}
impl OddMap for Cay {}
impl OddMap for ExpOrCay {}

/// Implicit RKMK with its chart in the middle of the step.
///
/// Coordinates of the second kind do not compile, because there Ψ(−u) is not Ψ(u)⁻¹:
///
/// ```compile_fail
/// use lieflow::methods::{GAUSS4, RkmkGaussSymmetric};
/// use lieflow::maps::CCSK123;
/// let _ = RkmkGaussSymmetric::new(GAUSS4, CCSK123);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RkmkGaussSymmetric<Psi, const S: usize> {
    tableau: ImplicitTableau<S>,
    psi: Psi,
}

impl<Psi: OddMap, const S: usize> RkmkGaussSymmetric<Psi, S> {
    /// Makes the method.
    pub const fn new(tableau: ImplicitTableau<S>, psi: Psi) -> Self {
        RkmkGaussSymmetric { tableau, psi }
    }
}

impl<Psi: OddMap, const S: usize> Symmetric for RkmkGaussSymmetric<Psi, S> {}

/// Stages and the chart.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct RkmkGaussWork<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> {
    k: [AlgOf<P>; S],
    u: AlgOf<P>,
    old: AlgOf<P>,
    middle: AlgOf<P>,
    q: PointOf<P>,
    y: PointOf<P>,
    chart: ChartStore<P, Psi>,
    dense: OneIncrement<P>,
    iterations: u64,
}

impl<P: Problem, Psi: CoordinateMap<P::Group>, const S: usize> RkmkGaussWork<P, Psi, S> {
    fn new(problem: &P, psi: &Psi, like: &PointOf<P>) -> Result<Self, Error> {
        let alg = problem.group();
        Ok(RkmkGaussWork {
            k: copies(alg.zero()),
            u: alg.zero(),
            old: alg.zero(),
            middle: alg.zero(),
            q: like.clone(),
            y: like.clone(),
            chart: ChartStore::new(problem, psi, like)?,
            dense: OneIncrement::new(alg),
            iterations: 0,
        })
    }

    /// self.y ← the step from p.
    fn advance(
        &mut self,
        name: &'static str,
        (tab, psi, centred): (&ImplicitTableau<S>, &Psi, bool),
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        p: &PointOf<P>,
    ) -> Result<(), StepError> {
        let (alg, lit) = (problem.group(), ScalarOf::<P>::lit);
        let RkmkGaussWork { k, u, old, middle, q, y, chart, iterations, .. } = self;
        let stages = tab.stages();
        for i in (0..S).take(stages) {
            chart.around(problem, psi, n, p).field(t + h * lit(tab.c[i]), &mut k[i]);
            if !alg.is_finite(&k[i]) {
                return Err(StepError::NonFiniteRhs { stage: i + 1 });
            }
        }
        let mut progress = Progress::new(iterations);
        loop {
            if centred {
                alg.combine(h * lit(0.5), &tab.b, k, middle); // −θ
                chart.around(problem, psi, n, p).lambda(middle, q)?;
            }
            let mut around = chart.around(problem, psi, n, if centred { &*q } else { p });
            let (mut change, mut size) = (lit(0.0), lit(1.0));
            for i in (0..S).take(stages) {
                alg.combine(h, &tab.a[i], k, u);
                if centred {
                    alg.axpy(lit(-1.0), middle, u);
                }
                alg.set_zero(old);
                alg.axpy(lit(1.0), &k[i], old);
                around.pullback(t + h * lit(tab.c[i]), u, &mut k[i])?;
                alg.axpy(lit(-1.0), &k[i], old);
                change += h.abs() * alg.norm(old);
                size += h.abs() * alg.norm(&k[i]);
            }
            let change = change / size;
            if progress.done(name, change)? {
                // The change of the last stage.
                alg.set_zero(u);
                alg.axpy(h, old, u);
                let of_parts = relative_error_of_parts(problem, u, [p, around.last_point()]);
                if progress.parts_are_done(change, of_parts / size) {
                    break;
                }
            }
        }
        if centred {
            alg.combine(h * lit(0.5), &tab.b, k, middle);
            chart.around(problem, psi, n, p).lambda(middle, q)?;
            chart.around(problem, psi, n, q).lambda(middle, y)
        } else {
            alg.combine(h, &tab.b, k, u);
            chart.around(problem, psi, n, p).lambda(u, y)
        }
    }
}

macro_rules! method {
    ($name:ident, $label:literal, $centred:literal, $($bound:tt)*) => {
        impl<Psi, const S: usize> $name<Psi, S> {
            /// In the chart of the step. The step with the chart in the middle begins at −v/2.
            fn extension(&self) -> Extension<'static, 2> {
                of_increment(self.tableau.order, if $centred { -0.5 } else { 0.0 })
            }
        }

        impl<P: Problem, Psi: CoordinateMap<P::Group> $($bound)*, const S: usize> Method<P>
            for $name<Psi, S>
        {
            type Work = RkmkGaussWork<P, Psi, S>;

            fn facts(&self, problem: &P) -> Facts {
                let (extension, most) = (self.extension(), self.psi.order(problem.group()));
                Facts::of_order(self.tableau.order.min(most))
                    .dense(extension.order().min(most), 1 + extension.evaluations())
                    .short_turns()
            }
            fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
                RkmkGaussWork::new(problem, &self.psi, like)
            }
            fn iterations(&self, work: &Self::Work) -> u64 {
                work.iterations
            }
            #[inline]
            fn step(
                &self,
                problem: &P,
                step: Step<ScalarOf<P>>,
                p: &mut PointOf<P>,
                w: &mut Self::Work,
            ) -> Result<(), StepError> {
                w.advance($label, (&self.tableau, &self.psi, $centred), problem, step, p)?;
                core::mem::swap(p, &mut w.y);
                Ok(())
            }
            fn prepare(
                &self,
                problem: &P,
                step: Step<ScalarOf<P>>,
                from: &PointOf<P>,
                _: &PointOf<P>,
                RkmkGaussWork { k, q, chart, dense, .. }: &mut Self::Work,
            ) -> Result<(), StepError> {
                let (alg, around) = (problem.group(), if $centred { &*q } else { from });
                let mut chart = chart.around(problem, &self.psi, step.n, around);
                alg.combine(ScalarOf::<P>::lit(1.0), &self.tableau.b, k, &mut dense.k[0]);
                dense.first(&self.extension(), alg, &mut chart, step)?;
                dense.prepare(&self.extension(), alg, &mut chart, step)
            }
            fn within(&self, _: &Self::Work) -> Within {
                Within::Chart
            }
            fn coordinates(
                &self,
                problem: &P,
                Step { h, .. }: Step<ScalarOf<P>>,
                theta: f64,
                base: &mut PointOf<P>,
                work: &mut Self::Work,
                u: &mut AlgOf<P>,
            ) {
                if $centred {
                    base.assign(&work.q);
                }
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
                work.chart.around(problem, &self.psi, n, base).lambda(u, at)
            }
            fn interpolate(
                &self,
                problem: &P,
                Step { n, h, .. }: Step<ScalarOf<P>>,
                theta: f64,
                from: &PointOf<P>,
                RkmkGaussWork { q, chart, dense, .. }: &mut Self::Work,
                at: &mut PointOf<P>,
            ) -> Result<(), StepError> {
                let mut chart =
                    chart.around(problem, &self.psi, n, if $centred { &*q } else { from });
                dense.point(&self.extension(), problem.group(), &mut chart, (theta, h), at)
            }
        }
    };
}
method!(RkmkGauss, "rkmk-gauss", false,);
method!(RkmkGaussSymmetric, "rkmk-gauss-symmetric", true, + OddMap);
