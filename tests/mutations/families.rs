//! The same five slips in every family of methods: two coefficients exchanged, a bracket dropped, time
//! frozen, the wrong trivialisation, a transposed action. Each is put in on purpose, and the order
//! harness refuses what comes out; the sound method passes on the same problem. Explicit RKMK and
//! commutator-free methods have more of them in `faults.rs`.
//!
//! | | exchanged | bracket | time | trivialisation | action |
//! |---|---|---|---|---|---|
//! | RKMK | `faults.rs` | dΨ⁻¹ = id | c = 0 | dΨ⁻¹ at −u | gᵀy |
//! | commutator-free, Crouch–Grossman | weights | factors merged | c = 0 | factors reversed | gᵀy |
//! | Magnus | A₁, A₂: the same as | \[A₁, A₂\] | A(t) alone | −\[A₁, A₂\] | gᵀy |
//! | implicit RKMK | a_ij | dΨ⁻¹ = id | c = 0 | dΨ⁻¹ at −u | gᵀy |
//! | Lie series | f₁, f₂ | f₂ dropped | f₀ alone | Ψ_j f_i | gᵀy |
//!
//! Lie series have two more: the last coefficient wrong, and steps that the last term alone limits.

use crate::actions::Translation;
use crate::maps::Faulty;
use crate::support::orders::{
    Field, Flow, Reference, clock, flow, measure, measure_as, reference, start, wave,
};
use crate::support::points::Points;
use crate::support::represent::Represent;
use faer::{Mat, Scale};
use lieflow::actions::LeftTranslation;
use lieflow::chart::ChartStore;
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup};
use lieflow::maps::{Cay, Exp, exp};
use lieflow::methods::commutator_free::{CF4, ProductTableau};
use lieflow::methods::crouch_grossman::CG3;
use lieflow::methods::tableau::RK4;
use lieflow::methods::{
    CommutatorFree, Embedded, Facts, GAUSS4, ImplicitTableau, LieSeries, Method, Rkmk, RkmkGauss,
    RkmkGaussSymmetric, Step, Tableau, magnus,
};
use lieflow::problems::{AlgOf, LinearField, PointOf, Problem, TaylorField};
use lieflow::tolerance::Tolerance;
use lieflow::{
    Action, Error, LieAlgebra, LieGroup, SaveAt, StepControl, StepError, integrate_adaptive,
};

fn so5() -> MatrixGroup {
    MatrixGroup::so(5).unwrap()
}

/// The translation problem on SO(5) with an action that may be a faulty one.
fn on_so5<A: Points<MatrixGroup> + Clone + 'static>(
    action: A,
    field: Field,
) -> Flow<MatrixGroup, A> {
    flow(so5(), action, field)
}

/// The motion is that of the sound action.
fn exact<P>(field: Field, problem: &P) -> Reference<P>
where
    P: Problem<Group = MatrixGroup>,
    P::Action: Action<MatrixGroup, Point = GroupMatrix>,
{
    let sound = on_so5(LeftTranslation, field);
    reference(&sound, start(&sound, 7)).of_the_same_points(problem)
}

/// The harness finds the order that is claimed, or the test fails.
fn sound<P, M: Method<P>>(name: &str, problem: &P, method: &M, reference: &Reference<P>)
where
    P: Problem<Group = MatrixGroup>,
    P::Action: Points<MatrixGroup>,
{
    let found = measure(problem, method, reference).and_then(|e| e.check());
    found.unwrap_or_else(|reason| panic!("{name}: {reason}"));
}

/// It refuses the claim; where an order is left it is this one, on the grid for it.
fn refused<P, M: Method<P>>(
    name: &str,
    left: Option<usize>,
    problem: &P,
    method: &M,
    reference: &Reference<P>,
) where
    P: Problem<Group = MatrixGroup>,
    P::Action: Points<MatrixGroup>,
{
    let claim = measure(problem, method, reference).and_then(|e| e.check());
    assert!(claim.is_err(), "{name}: the fault was not seen");
    match left {
        Some(order) => {
            let found = measure_as(order, problem, method, reference);
            let slope = found.unwrap_or_else(|reason| panic!("{name}: {reason}")).order();
            assert!((slope - order as f64).abs() < 0.15, "{name}: {slope}, expected {order}");
        }
        None => assert!(claim.unwrap_err().contains("too few errors"), "{name}"),
    }
}

/// Every method of a list on the action from the wrong side.
macro_rules! on_a_transposed_action {
    ($field:expr; $($method:expr),*) => {
        for fault in [crate::actions::Fault::Transposed, crate::actions::Fault::Swapped] {
            let problem = on_so5(Translation(fault), $field);
            let reference = exact($field, &problem);
            $(refused(stringify!($method), None, &problem, &$method, &reference);)*
        }
    };
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "a debug build refuses a wrong tableau before its first step"
)]
fn rkmk() {
    let field = || wave(5, 0.5, 12);
    let problem = on_so5(LeftTranslation, field());
    let reference = exact(field(), &problem);
    let bad = |name, left, method: &dyn Fn() -> Tableau<4>| {
        refused(name, left, &problem, &Rkmk::new(method(), Exp), &reference);
    };
    sound("rkmk4", &problem, &Rkmk::new(RK4, Exp), &reference);
    // The sum of each row is the same.
    bad("exchanged", Some(2), &|| Tableau {
        a: [RK4.a[0], RK4.a[1], [0.5, 0.0, 0.0, 0.0], RK4.a[3]],
        ..RK4
    });
    let no_bracket = Rkmk::new(RK4, Faulty(Exp, crate::maps::Fault::NoDifferential));
    refused("no bracket", Some(2), &problem, &no_bracket, &reference);
    let left = Rkmk::new(RK4, Faulty(Exp, crate::maps::Fault::LeftTrivialised));
    refused("left trivialised", Some(2), &problem, &left, &reference);
    on_a_transposed_action!(field(); Rkmk::new(RK4, Exp), Rkmk::new(RK4, Cay));
}

#[test]
fn crouch_grossman() {
    let field = || wave(5, 0.5, 12);
    let problem = on_so5(LeftTranslation, field());
    let reference = exact(field(), &problem);
    let bad = |name, left, change: &dyn Fn(&mut ProductTableau<3>)| {
        let mut tableau = CG3;
        change(&mut tableau);
        refused(name, left, &problem, &CommutatorFree(tableau), &reference);
    };
    sound("cg3", &problem, &CommutatorFree(CG3), &reference);
    // 13/51, −2/3, 24/17 of k₁, k₂, k₃.
    bad("exchanged", Some(1), &|t| {
        t.update.factors =
            &[[13.0 / 51.0, 0.0, 0.0], [0.0, 24.0 / 17.0, 0.0], [0.0, 0.0, -2.0 / 3.0]];
    });
    bad("merged", Some(2), &|t| t.update.factors = &[[13.0 / 51.0, -2.0 / 3.0, 24.0 / 17.0]]);
    bad("reversed", Some(2), &|t| {
        t.update.factors =
            &[[0.0, 0.0, 24.0 / 17.0], [0.0, -2.0 / 3.0, 0.0], [13.0 / 51.0, 0.0, 0.0]];
    });
    bad("frozen", Some(1), &|t| t.c = [0.0; 3]);
    on_a_transposed_action!(field(); CommutatorFree(CG3), CommutatorFree(CF4));
}

#[test]
fn implicit_rkmk() {
    let field = || wave(5, 0.5, 12);
    let problem = on_so5(LeftTranslation, field());
    let reference = exact(field(), &problem);
    // In one row: its sum is the same.
    let mut exchanged = GAUSS4;
    exchanged.a[0].swap(0, 1);
    let frozen = ImplicitTableau { c: [0.0; 2], ..GAUSS4 };
    macro_rules! both {
        ($method:ident) => {
            let name = stringify!($method);
            sound(name, &problem, &$method::new(GAUSS4, Exp), &reference);
            refused(name, Some(2), &problem, &$method::new(exchanged, Exp), &reference);
            refused(name, Some(1), &problem, &$method::new(frozen, Exp), &reference);
            for fault in [crate::maps::Fault::NoDifferential, crate::maps::Fault::LeftTrivialised] {
                let method = $method::new(GAUSS4, Faulty(Exp, fault));
                refused(name, Some(2), &problem, &method, &reference);
            }
        };
    }
    both!(RkmkGauss);
    both!(RkmkGaussSymmetric);
    on_a_transposed_action!(
        field(); RkmkGauss::new(GAUSS4, Exp), RkmkGaussSymmetric::new(GAUSS4, Cay)
    );
}

/// What is wrong with Magnus of order 4.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slip {
    Nothing,
    NoBracket,
    Frozen,
    LeftTrivialised,
}

/// y ← exp(½h(A₁ + A₂) − (√3/12) h²\[A₁, A₂\]) y with a slip.
struct Magnus4(Slip);

impl<P: LinearField + Problem<Group = MatrixGroup>> Method<P> for Magnus4 {
    type Work = ChartStore<P, Exp>;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(4)
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        ChartStore::new(problem, &Exp, like)
    }
    fn step(
        &self,
        problem: &P,
        Step { n, t, h }: Step<f64>,
        y: &mut PointOf<P>,
        chart: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (group, root) = (problem.group(), 3f64.sqrt());
        let [first, second] = [0.5 - root / 6.0, 0.5 + root / 6.0].map(|c| {
            let (c, mut a) = (if self.0 == Slip::Frozen { 0.0 } else { c }, group.zero());
            problem.f(t + c * h, y, &mut a, &mut problem.work());
            a
        });
        let weight = match self.0 {
            Slip::NoBracket => 0.0,
            Slip::LeftTrivialised => 1.0,
            _ => -1.0,
        };
        let mut u: AlgOf<P> = group.zero();
        group.bracket(&first, &second, &mut u);
        let mut omega = group.zero();
        group.axpy(weight * h * h * root / 12.0, &u, &mut omega);
        group.axpy(0.5 * h, &first, &mut omega);
        group.axpy(0.5 * h, &second, &mut omega);
        let p = y.clone();
        chart.around(problem, &Exp, n, &p).lambda(&omega, y)
    }
}

#[test]
fn magnus() {
    let field = || clock(5, 1.0, 21);
    let problem = on_so5(LeftTranslation, field());
    let reference = exact(field(), &problem);
    sound("magnus4", &problem, &Magnus4(Slip::Nothing), &reference);
    for (slip, left) in [(Slip::NoBracket, 2), (Slip::Frozen, 1), (Slip::LeftTrivialised, 2)] {
        refused(&format!("{slip:?}"), Some(left), &problem, &Magnus4(slip), &reference);
    }
    on_a_transposed_action!(field(); Magnus4(Slip::Nothing), magnus::Magnus4, magnus::CayleyMagnus4);
}

/// What is wrong with the Taylor coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coefficients {
    Sound,
    Exchanged,
    Dropped,
    Frozen,
    /// Three times the last one.
    WrongLast,
}

/// ẏ = λ_*(Σ c_n tⁿ)(y) with the coefficients of its field about any t; where it is MOVING they are taken
/// for those of the frame that moves.
struct Polynomial<A, const MOVING: bool> {
    group: MatrixGroup,
    action: A,
    c: [AlgebraMatrix; 4],
    coefficients: Coefficients,
}

/// The coefficients as matrices: those of [`clock`] at four times.
fn matrices() -> [Mat<f64>; 4] {
    let field = clock(5, 0.8, 31);
    [0.0, 1.0, 2.0, 3.0].map(|t| field(t, &Mat::zeros(0, 0)))
}

impl<A: Points<MatrixGroup>, const MOVING: bool> Polynomial<A, MOVING> {
    fn new(action: A, coefficients: Coefficients) -> Self {
        let group = so5();
        let c = matrices().map(|c| group.nearest(&c));
        Polynomial { group, action, c, coefficients }
    }

    fn exact(&self) -> Reference<Self>
    where
        A: Action<MatrixGroup, Point = GroupMatrix>,
    {
        let c = matrices();
        let field = move |t: f64, _: &Mat<f64>| {
            c.iter().rev().fold(Mat::zeros(5, 5), |s, c| s * Scale(t) + c)
        };
        exact(Box::new(field), self)
    }
}

impl<A: Points<MatrixGroup>, const MOVING: bool> Problem for Polynomial<A, MOVING> {
    type Group = MatrixGroup;
    type Action = A;
    type Work = ();
    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &A {
        &self.action
    }
    fn work(&self) {}
    fn f(&self, t: f64, _: &A::Point, v: &mut AlgebraMatrix, _: &mut ()) {
        self.group.set_zero(v);
        self.c.iter().zip(0..).for_each(|(c, n)| self.group.axpy(t.powi(n), c, v));
    }
}

impl<A: Points<MatrixGroup>, const MOVING: bool> TaylorField for Polynomial<A, MOVING> {
    const MOVING: bool = MOVING;
    type Series = ();
    fn series(&self, _: usize) {}
    fn coefficient(
        &self,
        [t, h]: [f64; 2],
        _: &A::Point,
        k: usize,
        f: &mut [AlgebraMatrix],
        (): &mut (),
    ) {
        self.group.set_zero(&mut f[k]);
        let power = match (self.coefficients, k) {
            (Coefficients::Exchanged, 1 | 2) => 3 - k,
            (Coefficients::Dropped, 2) | (Coefficients::Frozen, 1..) => return,
            _ => k,
        };
        let binomial = |n: usize| (0..power).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64);
        for n in power..self.c.len() {
            let wrong = self.coefficients == Coefficients::WrongLast && k + 1 == self.c.len();
            let weight = binomial(n) * t.powi((n - power) as i32) * h.powi(k as i32);
            let weight = if wrong { 3.0 * weight } else { weight };
            self.group.axpy(weight, &self.c[n], &mut f[k]);
        }
    }
}

#[test]
fn lie_series() {
    use Coefficients::{Dropped, Exchanged, Frozen, Sound, WrongLast};
    let taylor = LieSeries::new(4).unwrap();
    let on = |coefficients| Polynomial::<_, false>::new(LeftTranslation, coefficients);
    let problem = on(Sound);
    sound("taylor4", &problem, &taylor, &problem.exact());
    for (slip, left) in [(Exchanged, 1), (Dropped, 2), (Frozen, 1), (WrongLast, 3)] {
        let problem = on(slip);
        refused(&format!("{slip:?}"), Some(left), &problem, &taylor, &problem.exact());
    }
    let moving = Polynomial::<_, true>::new(LeftTranslation, Sound);
    refused("left trivialised", Some(2), &moving, &taylor, &moving.exact());
    for fault in [crate::actions::Fault::Transposed, crate::actions::Fault::Swapped] {
        let problem = Polynomial::<_, false>::new(Translation(fault), Sound);
        refused("transposed", None, &problem, &taylor, &problem.exact());
    }
}

/// A Lie series whose error is its last term alone, for the relative tolerance [`RTOL`].
struct LimitedByLast(LieSeries);

const RTOL: f64 = 1e-8;

impl<P: TaylorField<Group = MatrixGroup>> Method<P> for LimitedByLast {
    type Work = <LieSeries as Method<P>>::Work;

    fn facts(&self, problem: &P) -> Facts {
        self.0.facts(problem)
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        self.0.work(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<f64>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        self.0.step(problem, step, y, work)
    }
}

impl<P: TaylorField<Group = MatrixGroup>> Embedded<P> for LimitedByLast {
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<f64>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<f64, StepError> {
        self.0.step_with_error(problem, step, tolerance, from, work, to)?;
        let mut numbers = Vec::new();
        Method::<P>::each_term(&self.0, work, &mut |x| numbers.push(*x));
        let last = &numbers[numbers.len() - problem.group().n().pow(2)..];
        Ok(last.iter().map(|x| x * x).sum::<f64>().sqrt() / RTOL)
    }
}

/// The solution of ẏ = t M y is even about 0, so the last term of an odd order vanishes in the first step.
#[test]
fn lie_series_are_limited_by_both_of_their_last_terms() {
    let group = so5();
    let m = group.nearest(&matrices()[0]);
    let zero = || group.zero();
    let c = [zero(), m.clone(), zero(), zero()];
    let problem = Polynomial::<_, false> {
        group: group.clone(),
        action: LeftTranslation,
        c,
        coefficients: Coefficients::Sound,
    };
    let exact = exp(&group, &group.nearest(&(&*m * Scale(0.5)))).unwrap();
    let control = StepControl::new(0.0, RTOL).and_then(|c| c.first_step(1.0)).unwrap();
    let run = |method: &dyn Fn(&mut GroupMatrix)| {
        let mut y = group.identity();
        method(&mut y);
        group.distance(&y, &exact)
    };
    let (series, span) = (LieSeries::new(7).unwrap(), [0.0, 1.0]);
    let sound = run(&|y| {
        integrate_adaptive(&problem, &series, span, &control, &SaveAt::Ends, y, |_, _| {}).unwrap();
    });
    let faulty = LimitedByLast(series);
    let broken = run(&|y| {
        integrate_adaptive(&problem, &faulty, span, &control, &SaveAt::Ends, y, |_, _| {}).unwrap();
    });
    assert!(sound < 100.0 * RTOL && broken > 1e4 * RTOL, "{sound:e}, {broken:e}");
}
