//! What the catalog says that a step costs is what it costs: evaluations of f, Ψ, dΨ⁻¹, commutators and
//! triple products of each method for fields are counted on a group and a field that count. What a method and a
//! run say of themselves is compared with the same.

use std::cell::Cell;

use lieflow::actions::LeftTranslation;
use lieflow::catalog::{
    Count, MethodInfo, MethodSpec, Needs, Operation, OtherCase, TABLEAUS, WorkItem,
};
use lieflow::groups::{Sample, So3};
use lieflow::maps::{Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp};
use lieflow::methods::tableau::RK4;
use lieflow::methods::{
    Composition, Doubling, Embedded, GAUSS4, Gauss, MapCounts, Metric, Rkmk, SUZUKI4, SimoWong,
    Step, StepCost, magnus::TripleProduct,
};
use lieflow::problems::{
    Flow, PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyState, ScalarOf,
};
use lieflow::tolerance::Tolerance;
use lieflow::{Error, LieAlgebra, LieGroup, RunError, SaveAt, Solve, Stats, StepControl};
use lieflow::{StepError, TimeGrid, integrate, integrate_adaptive};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::support::named::{self, Named};

type V = Vector3<f64>;
type M = Matrix3<f64>;

/// How often each was asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Asked {
    field: u64,
    psi: u64,
    dpsi_inv: u64,
    brackets: u64,
    triples: u64,
}

impl Asked {
    fn times(self, n: u64) -> Self {
        let Asked { field, psi, dpsi_inv, brackets, triples } = self;
        Asked {
            field: n * field,
            psi: n * psi,
            dpsi_inv: n * dpsi_inv,
            brackets: n * brackets,
            triples: n * triples,
        }
    }
    fn maps(self) -> MapCounts {
        MapCounts { psi: self.psi, dpsi_inv: self.dpsi_inv, brackets: self.brackets }
    }
}

thread_local! {
    static ASKED: Cell<Asked> = Cell::default();
}

fn count(which: impl FnOnce(&mut Asked)) {
    let mut asked = ASKED.get();
    which(&mut asked);
    ASKED.set(asked);
}

/// SO(3), counting.
struct Counting(So3);

impl LieAlgebra for Counting {
    type Scalar = f64;
    type Alg = V;
    fn name(&self) -> String {
        self.0.name()
    }
    fn dim(&self) -> usize {
        3
    }
    fn zero(&self) -> V {
        self.0.zero()
    }
    fn set_zero(&self, u: &mut V) {
        self.0.set_zero(u);
    }
    fn axpy(&self, a: f64, x: &V, y: &mut V) {
        self.0.axpy(a, x, y);
    }
    fn bracket(&self, u: &V, v: &V, out: &mut V) {
        count(|asked| asked.brackets += 1);
        self.0.bracket(u, v, out);
    }
    fn norm(&self, u: &V) -> f64 {
        self.0.norm(u)
    }
    fn is_finite(&self, u: &V) -> bool {
        self.0.is_finite(u)
    }
}

impl LieGroup for Counting {
    type Elem = M;
    type Vector = V;
    fn identity(&self) -> M {
        self.0.identity()
    }
    fn compose(&self, a: &M, b: &M, out: &mut M) {
        self.0.compose(a, b, out);
    }
    fn apply(&self, g: &M, x: &V, y: &mut V) {
        self.0.apply(g, x, y);
    }
    fn tangent(&self, v: &V, g: &M, out: &mut M) {
        self.0.tangent(v, g, out);
    }
    fn apply_algebra(&self, v: &V, x: &V, y: &mut V) {
        self.0.apply_algebra(v, x, y);
    }
    fn distance(&self, a: &M, b: &M) -> f64 {
        self.0.distance(a, b)
    }
    fn defect(&self, g: &M) -> f64 {
        self.0.defect(g)
    }
}

impl TripleProduct for Counting {
    fn triple(&self, u: &V, v: &V, w: &V, work: &mut V, out: &mut V) {
        count(|asked| asked.triples += 1);
        self.0.triple(u, v, w, work, out);
    }
}

/// Each map of the catalog, counting. `psi_on` is Ψ by default, and is not used on matrices.
macro_rules! counting {
    ($($map:ty),*) => {$(
        impl CoordinateMap<Counting> for $map {
            type At = <$map as CoordinateMap<So3>>::At;
            fn name(&self) -> &'static str {
                CoordinateMap::<So3>::name(self)
            }
            fn order(&self, group: &Counting) -> usize {
                CoordinateMap::<So3>::order(self, &group.0)
            }
            fn at(&self, group: &Counting) -> Result<Self::At, Error> {
                CoordinateMap::<So3>::at(self, &group.0)
            }
            fn psi(&self, group: &Counting, u: &V, at: &mut Self::At, g: &mut M) -> Result<(), StepError> {
                count(|asked| asked.psi += 1);
                CoordinateMap::<So3>::psi(self, &group.0, u, at, g)
            }
            fn dpsi_inv(&self, group: &Counting, u: &V, at: &mut Self::At, v: &mut V) -> Result<(), StepError> {
                count(|asked| asked.dpsi_inv += 1);
                CoordinateMap::<So3>::dpsi_inv(self, &group.0, u, at, v)
            }
        }
    )*};
}
counting!(Exp, TruncatedExp, Cay, Pade22, Ccsk<0, 1, 2>, Ccsk<2, 1, 0>);

/// What a step asked for, and what its method says of it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Taken {
    asked: Asked,
    stated: StepCost,
    iterations: u64,
}

impl Taken {
    /// A step of an explicit method that knows what it asks for.
    fn known(asked: Asked) -> Self {
        let stated = StepCost { evaluations: Some(asked.field), maps: Some(asked.maps()) };
        Taken { asked, stated, iterations: 0 }
    }
}

/// Take a step, and one with an estimate of its error.
fn take<P>(problem: &P, method: &impl Embedded<P>) -> [Taken; 2]
where
    P: Problem<Group = Counting, Action = LeftTranslation>,
{
    let (start, mut y) = (M::identity(), M::identity());
    let mut work = method.work(problem, &y).expect("it fits");
    let (facts, step) = (method.facts(problem), Step { n: 0, t: 0.2, h: 0.1 });
    ASKED.set(Asked::default());
    method.step(problem, step, &mut y, &mut work).expect("a step");
    let plain =
        Taken { asked: ASKED.take(), stated: facts.step, iterations: method.iterations(&work) };
    // A point within the step costs what the method says.
    method.prepare(problem, step, &start, &y, &mut work).expect("the stages of the extension");
    let prepared = ASKED.take().field;
    let mut at = start;
    method.interpolate(problem, step, 0.4, &start, &mut work, &mut at).expect("a point");
    let stated = facts.dense_evaluations;
    assert_eq!(stated[0], Some(prepared));
    assert!(stated[1].is_none_or(|n| n == ASKED.get().field), "{stated:?} {:?}", ASKED.get());
    ASKED.set(Asked::default());
    let before = method.iterations(&work);
    let tolerance = Tolerance::new(1e-6, 1e-6).expect("a tolerance");
    method.step_with_error(problem, step, &tolerance, &start, &mut work, &mut y).expect("a step");
    let with_error = Taken {
        asked: ASKED.take(),
        stated: facts.step_with_error,
        iterations: method.iterations(&work) - before,
    };
    [plain, with_error]
}

/// What the work of a step asks for.
fn stated(work: &[WorkItem]) -> Asked {
    let count = |operations: &[Operation]| {
        let work = work.iter().find(|work| operations.contains(&work.operation));
        work.map_or(0, |work| match work.count {
            Count::Exactly(n) => u64::from(n),
            other => panic!("{other} is no number"),
        })
    };
    Asked {
        field: count(&[Operation::Field, Operation::AmbientField, Operation::LinearField]),
        psi: count(&[Operation::Exp, Operation::Cay, Operation::Psi]),
        dpsi_inv: count(&[Operation::DpsiInv]),
        brackets: count(&[Operation::Bracket]),
        triples: count(&[Operation::TripleProduct]),
    }
}

/// What a step costs, and one with an estimate of its error.
fn explicit(info: &MethodInfo, spec: &MethodSpec) -> [Taken; 2] {
    let plain = stated(info.cost.work);
    let with_error = match info.cost.other_case {
        OtherCase::WithError(work) => stated(work),
        _ if spec.has_pair().expect("a method") => plain,
        _ => plain.times(3),
    };
    [plain, with_error].map(Taken::known)
}

fn counting_field() -> impl Problem<Group = Counting, Action = LeftTranslation> {
    Flow::new(Counting(So3::new()), LeftTranslation, |t: f64, g: &M, v: &mut V| {
        count(|asked| asked.field += 1);
        *v = V::new(t.cos(), g[(0, 1)], 0.5);
    })
}

fn one_step(spec: &MethodSpec) -> [Taken; 2] {
    let problem = counting_field();
    named::field(spec, |method| take(&problem, method)).expect("a method")
}

#[test]
fn methods_for_fields() {
    for info in Needs::Field.methods().iter().filter(|info| !info.takes_tableau) {
        let map = info.takes_map().then_some("exp");
        let spec = MethodSpec::new(info.name, map);
        assert_eq!(one_step(&spec), explicit(info, &spec), "{}: {}", info.name, info.cost);
    }
}

#[test]
fn methods_for_fields_of_linear_type() {
    for info in Needs::LinearType.methods() {
        let problem = Flow::of_time(Counting(So3::new()), LeftTranslation, |t, v| {
            count(|asked| asked.field += 1);
            *v = V::new(t.cos(), t, 0.5);
        });
        let spec = MethodSpec::new(info.name, None);
        let taken = named::linear(&spec, |method| take(&problem, method)).expect("a method");
        assert_eq!(taken, explicit(info, &spec), "{}: {}", info.name, info.cost);
    }
}

/// s f, s Ψ and s − 1 dΨ⁻¹ with every tableau and map; s F on the entries. A stage that only the error looks at
/// comes with the error.
#[test]
fn tableaus() {
    for tableau in TABLEAUS {
        let s = tableau.stages as u64;
        let with_error = match (tableau.name, tableau.pair) {
            ("bs3" | "dopri5", _) => (1, s + 1),
            (_, true) => (1, s),
            (_, false) => (3, s),
        };
        let expected = |on_group: u64| {
            [(1, s), with_error].map(|(steps, s)| {
                let (psi, dpsi_inv) = (on_group * s, on_group * (s - 1));
                Taken::known(Asked { field: s, psi, dpsi_inv, ..Asked::default() }.times(steps))
            })
        };
        for map in ["exp", "cay", "pade22", "ccsk123", "ccsk321", "ccsk"] {
            let spec = MethodSpec::new("rkmk", Some(map));
            let spec = MethodSpec { tableau: Some(tableau.name.into()), ..spec };
            assert_eq!(one_step(&spec), expected(1), "{}", spec.label());
        }
        let spec = MethodSpec::new("rk", None);
        let spec = MethodSpec { tableau: Some(tableau.name.into()), ..spec };
        assert_eq!(one_step(&spec), expected(0), "{}", spec.label());
    }
}

/// 5 to 20 iterations, each with what stands in the brackets; the values of f that an iteration begins
/// with, and the Ψ of the update, come once.
#[test]
fn implicit_methods() {
    for info in Needs::Norm.methods() {
        let map = info.takes_map().then_some("cay");
        let [plain, with_error] = one_step(&MethodSpec::new(info.name, map));
        assert_eq!(info.cost.iterations, Some((5, 20)));
        let each = stated(info.cost.work);
        let iterations = plain.asked.field / each.field - 1;
        assert!((5..=20).contains(&iterations), "{}: {iterations}", info.name);
        // The symmetric ones go to the middle and on.
        let once = each.psi.min(1) + u64::from(info.name.ends_with("symmetric"));
        let asked = Asked {
            field: each.field * (iterations + 1),
            psi: each.psi * iterations + once,
            dpsi_inv: each.dpsi_inv * iterations,
            ..Asked::default()
        };
        let maps = (each.psi == 0).then(MapCounts::default);
        let expected = Taken { asked, stated: StepCost { evaluations: None, maps }, iterations };
        assert_eq!(plain, expected, "{}: {}", info.name, info.cost);
        // Three steps, each of iterations of its own.
        let iterations = with_error.asked.field / each.field - 3;
        assert_eq!(
            (with_error.stated.maps, with_error.iterations),
            (maps, iterations),
            "{}",
            info.name
        );
    }
}

#[test]
fn doubled_steps() {
    let problem = counting_field();
    let [plain, with_error] = take(&problem, &Doubling(Rkmk::new(RK4, Exp)));
    let once = Asked { field: 4, psi: 4, dpsi_inv: 3, ..Asked::default() };
    assert_eq!([plain, with_error], [2, 3].map(|n| Taken::known(once.times(n))));
    let [plain, with_error] = take(&problem, &Doubling(Gauss(GAUSS4)));
    let iterations = |taken: Taken, steps| taken.asked.field / 2 - steps;
    assert_eq!(plain.iterations, iterations(plain, 2));
    assert_eq!(with_error.iterations, iterations(with_error, 3));
}

/// Attempts that are rejected, and the one that the first step is chosen by, ask as often as others.
#[test]
fn runs() {
    let (problem, save) = (counting_field(), SaveAt::Ends);
    let grid = TimeGrid::new([0.0, 1.05], 0.1).expect("a grid");
    let control = StepControl::new(1e-8, 1e-8).expect("tolerances");
    let too_large = control.clone().first_step(1.0).expect("a step");
    for name in ["rkmk4 cay", "rkmk dopri5 exp", "cf43", "cf-ls32", "rkmk4-2c", "rk4"] {
        let run = |control: Option<&StepControl>| {
            let mut y = M::identity();
            let spec = name.parse().expect("a method");
            ASKED.take();
            let stats = named::explicit(&spec, |method| match control {
                None => integrate(&problem, method, &grid, &save, &mut y, |_, _| {}),
                Some(control) => {
                    let span = grid.t_span();
                    integrate_adaptive(&problem, method, span, control, &save, &mut y, |_, _| {})
                }
            });
            let stats = stats.expect("a method").expect("a run");
            assert_eq!(stats.maps, Some(ASKED.take().maps()), "{name}: {stats:?}");
            assert_eq!(stats.iterations, 0, "{name}");
            stats.rejected
        };
        assert_eq!(run(None), 0);
        run(Some(&control));
        assert!(run(Some(&too_large)) > 0, "{name}");
    }
}

const STEPS: u64 = 10;

/// Ten steps of the methods that need this, each reported as the catalog says.
fn check_runs<P>(needs: &[Needs], problem: &P, start: &PointOf<P>, run: Run<'_, P>)
where
    P: Problem + 'static,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    for info in needs.iter().flat_map(|needs| needs.methods()).filter(|info| !info.takes_tableau) {
        let spec = MethodSpec::new(info.name, info.takes_map().then_some("cay"));
        let stats = run(&spec, &|method| {
            let grid = TimeGrid::with_steps([0.0, 1.0], STEPS).expect("a grid");
            integrate(problem, method, &grid, &SaveAt::Ends, &mut start.clone(), |_, _| {})
        });
        let stats = stats.expect("a method").expect("a run");
        let of = |operation| match info.cost.count(operation) {
            Count::Exactly(n) => u64::from(n),
            _ => 1,
        };
        // A composition is told by its steps.
        let (simo_wong, energy_casimir) =
            (of(Operation::SimoWongStep), of(Operation::EnergyCasimirStep));
        let composed = simo_wong + energy_casimir + of(Operation::IsospectralStep);
        let newton = of(Operation::NewtonIteration);
        let implicit = u64::from(info.cost.iterations.is_some()) + newton + composed;
        match implicit {
            0 => assert_eq!(stats.iterations, 0, "{}", info.name),
            n => assert!(stats.iterations > n * STEPS, "{}: {}", info.name, stats.iterations),
        }
        let asked = stated(info.cost.work).maps();
        let asked = MapCounts { psi: asked.psi + simo_wong, ..asked };
        let differs = energy_casimir > 0 || info.cost.iterations.is_some() && asked.psi > 0;
        let expected = (!differs).then(|| asked.times(STEPS));
        assert_eq!(stats.maps, expected, "{}: {}", info.name, info.cost);
    }
}

type Run<'a, P> = &'a dyn Fn(
    &MethodSpec,
    &dyn Fn(&Named<'_, P>) -> Result<Stats, RunError>,
) -> Result<Result<Stats, RunError>, Error>;

/// Ψ of a body is that of SO(3), which does not count: here the catalog alone says what a step asks for.
#[test]
fn runs_of_bodies() {
    use Needs::{Attitude, Body, Field, Isospectral, LiePoisson, Norm, Series, State};
    let (inertia, m) = ([1.0, 2.0, 3.0], V::new(0.2, 0.5, 1.0));
    let body = RigidBodyAttitude::<f64>::new(inertia, m.into()).expect("a body");
    let needs = [Field, Norm, Series, Body, Attitude];
    check_runs(&needs, &body, &M::identity(), &|spec, run| named::attitude(spec, run));
    let body = RigidBodyState::<f64>::new(inertia).expect("a body");
    let start = body.state(m.into(), M::identity()).expect("a state");
    check_runs(&[State], &body, &start, &|spec, run| named::state(spec, run));
    let body = RigidBodyN::manakov(&[0.4, 1.0, 1.6, 2.3]).expect("a body");
    let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(5), 0.7).into_mat();
    let needs = [Field, Norm, Series, LiePoisson, Isospectral];
    check_runs(&needs, &body, &m, &|spec, run| named::lie_poisson(spec, run));
}

/// A run that goes on from a saved state takes its last step again to look into it, and reports what the first one
/// reports.
#[test]
fn resumed_runs() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let method = Composition::new(SimoWong::ONE, SUZUKI4);
    let run = || {
        let solve = Solve::new(&body, &method, [0.0, 1.0]).steps(STEPS);
        solve.integrator(V::new(0.2, 0.5, 1.0)).expect("a run")
    };
    let (mut first, mut second) = (run(), run());
    for _ in 0..3 {
        first.step().expect("a step");
    }
    second.restore(&first.save()).expect("a state");
    let mut at = V::zeros();
    for run in [&mut first, &mut second] {
        run.interpolate(0.25, &mut at).expect("a point");
    }
    assert!(first.stats().iterations > 5 * 3);
    assert_eq!(first.stats(), second.stats());
}
