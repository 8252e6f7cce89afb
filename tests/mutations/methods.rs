//! Methods with one fault each.

use lieflow::actions::LeftTranslation;
use lieflow::chart::ChartStore;
use lieflow::groups::{GroupMatrix, MatrixGroup};
use lieflow::maps::Exp;
use lieflow::methods::{Facts, Method, Step, Tableau, tableau::RK4};
use lieflow::problems::{AlgOf, PointOf, Problem};
use lieflow::{CoordinateMap, Error, LieAlgebra, LieGroup, StepError};

use crate::support::represent::Represent;

/// What is wrong with RKMK.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// Nothing: the control.
    None,
    /// Every stage sees the time at the start of the step.
    FrozenTime,
    /// Row i of a_ij is applied to the stages in reverse.
    ReversedRows,
    /// The update is taken from the last stage's point, not from the start.
    WrongBase,
}

/// Table 1 of the paper with a fault.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faulty(pub(crate) Tableau<4>, pub(crate) Fault);

impl<P: Problem> Method<P> for Faulty
where
    P::Group: LieAlgebra<Scalar = f64>,
    Exp: CoordinateMap<P::Group>,
{
    type Work = ChartStore<P, Exp>;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(self.0.order)
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        ChartStore::new(problem, &Exp, like)
    }
    fn step(
        &self,
        problem: &P,
        Step { n, t, h }: Step<f64>,
        y: &mut PointOf<P>,
        store: &mut Self::Work,
    ) -> Result<(), StepError> {
        let Faulty(tableau, fault) = self;
        let alg = problem.group();
        let p = y.clone();
        let mut chart = store.around(problem, &Exp, n, &p);
        let mut k: Vec<AlgOf<P>> = vec![alg.zero(); 4];
        let mut u = alg.zero();
        chart.field(t, &mut k[0]);
        for i in 1..4 {
            let mut row = tableau.a[i][..i].to_vec();
            if *fault == Fault::ReversedRows {
                row.reverse();
            }
            alg.combine(h, &row, &k[..i], &mut u);
            let c = if *fault == Fault::FrozenTime { 0.0 } else { tableau.c[i] };
            chart.pullback(t + h * c, &u, &mut k[i])?;
        }
        let mut v = alg.zero();
        alg.combine(h, &tableau.b, &k, &mut v);
        if *fault == Fault::WrongBase {
            let mut base = p.clone();
            chart.lambda(&u, &mut base)?;
            return store.around(problem, &Exp, n, &base).lambda(&v, y);
        }
        chart.lambda(&v, y)
    }
}

/// The RKMK method of order 4 with two commutators (Munthe-Kaas & Owren 1999) on Y' = A(t, Y)Y:
/// stage 3 is exp(k₂/2 − [k₁, k₂]/8). With `wrong` it is exp(k₁/2 − [k₁, k₂]/8), as it has been
/// seen in print.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TwoCommutators {
    pub(crate) wrong: bool,
}

impl<P: Problem<Group = MatrixGroup, Action = LeftTranslation>> Method<P> for TwoCommutators {
    type Work = P::Work;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(RK4.order)
    }
    fn work(&self, problem: &P, _: &GroupMatrix) -> Result<P::Work, Error> {
        Ok(problem.work())
    }
    fn step(
        &self,
        problem: &P,
        Step { t, h, .. }: Step<f64>,
        y: &mut GroupMatrix,
        work: &mut P::Work,
    ) -> Result<(), StepError> {
        let group = problem.group();
        let start = y.clone();
        let moved = |u| match Exp.eval(group, &u) {
            Ok(g) => group.product(&g, &start),
            Err(_) => group.identity(),
        };
        let mut field = |t, y: &GroupMatrix| {
            let mut k = group.zero();
            problem.f(t, y, &mut k, work);
            group.scaled(h, &k)
        };
        let k1 = field(t, &start);
        let k2 = field(t + 0.5 * h, &moved(group.scaled(0.5, &k1)));
        let bracket = group.commutator(&k1, &k2);
        let first = group.scaled(0.5, if self.wrong { &k1 } else { &k2 });
        let k3 = field(t + 0.5 * h, &moved(group.moved(&first, -0.125, &bracket)));
        let k4 = field(t + h, &moved(k3.clone()));
        let mut v = group.commutator(&k1, &k4);
        v = group.scaled(-1.0 / 12.0, &v);
        for (k, weight) in [(&k1, 1.0), (&k2, 2.0), (&k3, 2.0), (&k4, 1.0)] {
            group.axpy(weight / 6.0, k, &mut v);
        }
        *y = moved(v);
        Ok(())
    }
}
