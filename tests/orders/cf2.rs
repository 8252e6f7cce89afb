//! A commutator-free method of order 2: two exponentials in place of dΨ⁻¹.
//!
//! k₁ = f(t, p), q = λ_p(½hk₁); k₂ = f(t + h, λ_p(hk₁)); y = λ_q(½hk₂).
//!
//! Order: 2 for Ψ = exp and cay; 1 for ccsk.
//! Preserves: the group, Casimirs. Cost: 2 f, 3 Ψ.
//! Source: E. Celledoni, A. Marthinsen, B. Owren, Commutator-free Lie group methods (2003).

use lieflow::chart::ChartStore;
use lieflow::error::{Error, StepError};
use lieflow::groups::LieAlgebra;
use lieflow::maps::CoordinateMap;
use lieflow::methods::{Facts, MapCounts, Method, Step};
use lieflow::problems::{AlgOf, PointOf, Problem, ScalarOf};
use lieflow::scalar::Real;

/// The commutator-free method of order 2 in the coordinates Ψ.
#[derive(Clone, Copy, Debug)]
pub struct Cf2<Psi>(pub Psi);

/// A stage, two points and the chart.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct Cf2Work<P: Problem, Psi: CoordinateMap<P::Group>> {
    k: AlgOf<P>,
    u: AlgOf<P>,
    q: PointOf<P>,
    y: PointOf<P>,
    chart: ChartStore<P, Psi>,
}

impl<P: Problem, Psi: CoordinateMap<P::Group>> Method<P> for Cf2<Psi> {
    type Work = Cf2Work<P, Psi>;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(2).cost(Some(2), MapCounts { psi: 3, ..MapCounts::default() })
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let zero = || problem.group().zero();
        let chart = ChartStore::new(problem, &self.0, like)?;
        Ok(Cf2Work { k: zero(), u: zero(), q: like.clone(), y: like.clone(), chart })
    }
    fn step(
        &self,
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        Cf2Work { k, u, q, y, chart }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let alg = problem.group();
        let mut around_p = chart.around(problem, &self.0, n, p);
        around_p.field(t, k);
        alg.combine(h, &[0.5], core::slice::from_ref(k), u);
        around_p.lambda(u, q)?;
        alg.combine(h, &[1.0], core::slice::from_ref(k), u);
        around_p.lambda(u, y)?;
        chart.around(problem, &self.0, n, y).field(t + h * ScalarOf::<P>::lit(1.0), k);
        alg.combine(h, &[0.5], core::slice::from_ref(k), u);
        if !alg.is_finite(u) {
            return Err(StepError::NotFinite { what: "the increment" });
        }
        chart.around(problem, &self.0, n, q).lambda(u, y)?;
        core::mem::swap(p, y);
        Ok(())
    }
}

/// The orders and the cost of the method.
mod measured {
    use core::cell::Cell;

    use super::*;
    use crate::support::orders::{flow, measure, measure_as, reference, start, wave};
    use lieflow::actions::LeftTranslation;
    use lieflow::groups::So3;
    use lieflow::maps::{CCSK123, Cay, Exp};
    use lieflow::problems::Flow;
    use nalgebra::{Matrix3, Vector3};

    /// On a problem that does not commute and depends on time and on the state.
    #[test]
    fn it_has_order_2_with_exp_and_cay_and_1_with_ccsk() {
        let problem = flow(So3::new(), LeftTranslation, wave(3, 0.5, 11));
        let reference = reference(&problem, start(&problem, 7));
        measure(&problem, &Cf2(Exp), &reference).unwrap().check().unwrap();
        measure(&problem, &Cf2(Cay), &reference).unwrap().check().unwrap();
        measure_as(1, &problem, &Cf2(CCSK123), &reference).unwrap().check().unwrap();
    }

    #[test]
    fn it_evaluates_f_as_often_as_it_states() {
        let calls = Cell::new(0);
        let field = |t: f64, y: &Matrix3<f64>, v: &mut Vector3<f64>| {
            calls.set(calls.get() + 1);
            *v = Vector3::new(t, y[(0, 1)], 1.0);
        };
        let problem = Flow::new(So3::new(), LeftTranslation, field);
        let (method, mut y) = (Cf2(Exp), Matrix3::identity());
        let mut work = method.work(&problem, &y).unwrap();
        method.step(&problem, Step { n: 0, t: 0.0, h: 0.1 }, &mut y, &mut work).unwrap();
        assert_eq!(method.facts(&problem).step.evaluations, Some(calls.get()));
    }
}
