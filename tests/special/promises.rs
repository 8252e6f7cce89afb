//! What the catalog says that a method preserves, measured for every one: energy, Casimirs and the
//! group over a thousand steps, time symmetry by a step that is undone by a step back. The words are
//! read from the catalog, so that a promise that is not kept fails here.

use crate::support;

use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::catalog::{
    LINEAR_METHODS, MAPS, MethodInfo, MethodSpec, Needs, OnMethod, TABLEAUS, all_methods,
    with_attitude_method, with_lie_poisson_method, with_linear_method, with_state_method,
};
use lieflow::groups::{MatrixGroup, Sample};
use lieflow::maps::Exp;
use lieflow::methods::low_storage::{EES25, EES27};
use lieflow::methods::{LowStorage, Metric, Rkmk, tableau::RK4};
use lieflow::problems::{BodyState, PointOf, Problem, RigidBodyN, RigidBodyState};
use lieflow::{LieAlgebra, LieGroup, Method, SaveAt, Step, TimeGrid, integrate};
use nalgebra::Matrix3;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use support::orders::{Flow, clock, slopes, wave};

/// Relative deviations that are rounding: of a thousand steps with one update each, and of two.
const KEPT: f64 = 2e-13;
/// The group at every step of a run: docs/promises.md, 5.
const ON_THE_GROUP: f64 = 2e-14;
const UNDONE: f64 = 3e-14;

/// What is measured of a state, by the catalog's word for it.
type Quantity<P> = (&'static str, fn(&P, &PointOf<P>) -> f64);

/// The largest relative deviation of each quantity, and the gap after a step there and back.
struct Measure<'a, P: Problem> {
    problem: &'a P,
    start: &'a PointOf<P>,
    quantities: &'a [Quantity<P>],
}

impl<P: Problem> OnMethod<P> for Measure<'_, P>
where
    P::Group: LieAlgebra<Scalar = f64>,
    PointOf<P>: Metric<Scalar = f64>,
{
    type Out = Vec<(&'static str, f64)>;
    fn call<M: Method<P>>(self, method: M) -> Self::Out {
        let Measure { problem, start, quantities } = self;
        let values = |y: &PointOf<P>| quantities.iter().map(|(_, q)| q(problem, y)).collect();
        let first: Vec<f64> = values(start);
        let mut worst = vec![0.0f64; first.len()];
        let grid = TimeGrid::with_steps([0.0, 50.0], 1000).expect("a grid");
        let mut y = start.clone();
        integrate(problem, &method, &grid, &SaveAt::Every(10), &mut y, |_, y| {
            let now: Vec<f64> = values(y);
            for (worst, (now, first)) in worst.iter_mut().zip(now.iter().zip(&first)) {
                *worst = worst.max((now - first).abs() / first.abs().max(1.0));
            }
        })
        .expect("a run");
        let mut found: Vec<_> = quantities.iter().map(|(word, _)| *word).zip(worst).collect();
        found.push(("time symmetry", there_and_back(problem, &method, start, 0.2)));
        found
    }
}

/// ‖Φ₋ₕ(Φₕ(y)) − y‖.
fn there_and_back<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    h: f64,
) -> f64
where
    P::Group: LieAlgebra<Scalar = f64>,
    PointOf<P>: Metric<Scalar = f64>,
{
    let mut y = start.clone();
    let mut work = method.work(problem, &y).expect("it fits");
    method.step(problem, Step { n: 0, t: 0.3, h }, &mut y, &mut work).expect("there");
    method.step(problem, Step { n: 1, t: 0.3 + h, h: -h }, &mut y, &mut work).expect("back");
    y.distance(start)
}

/// Updates of the state a step, each with its own rounding: compositions have the steps of Suzuki and of
/// Kahan and Li.
fn updates(name: &str) -> f64 {
    match name {
        "energy-casimir4" | "isospectral-suzuki4" => 5.0,
        "energy-casimir6" | "isospectral-kahan-li6" => 9.0,
        _ => 1.0,
    }
}

/// Compare what was found with what is promised; the methods that keep each word.
fn judge(info: &MethodInfo, label: &str, found: &[(&'static str, f64)], wrong: &mut Vec<String>) {
    let promised = |word: &str| match info.preserves {
        "everything" => word != "time symmetry",
        words => words.split(", ").any(|w| w == word),
    };
    let numbers: Vec<String> = found.iter().map(|(word, d)| format!("{word} {d:.0e}")).collect();
    println!("{label:24} {}", numbers.join(", "));
    for (word, deviation) in found {
        let bound = match *word {
            "time symmetry" => UNDONE,
            "group" => ON_THE_GROUP,
            _ => KEPT * updates(info.name),
        };
        if promised(word) && (deviation.is_nan() || *deviation >= bound) {
            wrong.push(format!("{label}: {word} {deviation:e}"));
        }
    }
}

/// A method with the maps that it takes: the first two of the catalog, exp and cay.
fn specs(info: &MethodInfo) -> Vec<MethodSpec> {
    let maps: &[_] = if info.takes_map { &[Some("exp"), Some("cay")] } else { &[None] };
    maps.iter().map(|map| MethodSpec::new(info.name, *map)).collect()
}

#[test]
fn of_the_body_with_its_attitude() {
    let body = RigidBodyState::new([1.0, 2.0, 3.0]).expect("a body");
    let start: BodyState = body.state([0.9, 1.0, 2.1], Matrix3::identity()).expect("a state");
    let quantities: &[Quantity<RigidBodyState>] = &[
        ("energy", |body, y| body.energy(y)),
        ("Casimirs", |_, y| y.m.norm()),
        ("quadratic invariants", |_, y| y.m.norm_squared()),
        ("group", |body, y| 1.0 + body.group().defect(&y.g)),
    ];
    let mut wrong = Vec::new();
    let mut seen = 0;
    for (info, needs) in all_methods() {
        use Needs::{Attitude, Body, Field, Norm, Series, State};
        if ![Field, Norm, Series, Body, Attitude, State].contains(&needs) {
            continue;
        }
        for spec in specs(info) {
            let measure = Measure { problem: &body, start: &start, quantities };
            let found = match needs {
                State => with_state_method(&spec, measure),
                _ => with_attitude_method(&spec, measure),
            }
            .expect("a method");
            judge(info, &spec.label(), &found, &mut wrong);
            seen += 1;
            if info.name == "rk4" {
                // A method that promises none of it keeps none of it: the measurement sees.
                assert!(found.iter().all(|(_, deviation)| *deviation > 1e-10), "{found:?}");
            }
        }
    }
    assert!(seen > 40 && wrong.is_empty(), "{seen}:\n{}", wrong.join("\n"));
}

#[test]
fn of_momenta_as_matrices() {
    let body = RigidBodyN::manakov(&[0.4, 0.9, 1.3, 2.0, 2.8]).expect("a body");
    let start = body.group().sample_algebra(&mut Pcg64::seed_from_u64(5), 0.7).into_mat();
    let quantities: &[Quantity<RigidBodyN>] = &[
        ("energy", |body, m| body.energy(m)),
        ("Casimirs", |_, m| {
            let square = m * m;
            let trace = |x: &Mat<f64>| (0..x.nrows()).map(|i| x[(i, i)]).sum::<f64>();
            trace(&square) + trace(&(&square * &square))
        }),
    ];
    let mut wrong = Vec::new();
    for needs in [Needs::LiePoisson, Needs::Isospectral] {
        for info in needs.methods() {
            for spec in specs(info) {
                let measure = Measure { problem: &body, start: &start, quantities };
                let found = with_lie_poisson_method(&spec, measure).expect("a method");
                judge(info, &spec.label(), &found, &mut wrong);
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn of_equations_of_linear_type() {
    let mut wrong = Vec::new();
    for group in [MatrixGroup::so(5), MatrixGroup::sp(4), MatrixGroup::indefinite(3, 1)] {
        let group = group.expect("a group");
        let n = group.n();
        let flow = Flow::new(group, LeftTranslation, clock(n, 0.4, 3));
        let start = flow.start(1);
        for info in LINEAR_METHODS {
            let measure = Measure { problem: &flow, start: &start, quantities: &[] };
            let found = with_linear_method(info.name, measure).expect("a method");
            judge(info, info.name, &found, &mut wrong);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// CF-EES(2,m) is of order 2 and comes back to O(h^{m+1}); RKMK4 to O(h⁶).
#[test]
fn nearly_symmetric_methods_come_back_with_a_high_order() {
    for group in [MatrixGroup::so(5), MatrixGroup::gl(3), MatrixGroup::sp(4)] {
        let group = group.expect("a group");
        let n = group.n();
        let flow = Flow::new(group, LeftTranslation, wave(n, 0.25, 3));
        let start = flow.group().identity();
        macro_rules! check {
            ($method:expr, $order:expr, $steps:expr) => {{
                let steps: [f64; 4] = $steps;
                let gaps = steps.map(|h| there_and_back(&flow, &$method, &start, h));
                let found = slopes(&steps.map(|h| 1.0 / h), &gaps);
                println!("{} {found:.2?}", stringify!($method));
                assert!(found.iter().all(|s| *s > $order - 0.75), "{found:?} {gaps:?}");
            }};
        }
        check!(LowStorage(EES25), 6.0, [0.15, 0.11, 0.08, 0.06]);
        check!(LowStorage(EES27), 8.0, [0.3, 0.22, 0.16, 0.12]);
        check!(Rkmk::new(RK4, Exp), 5.5, [0.15, 0.11, 0.08, 0.06]);
    }
}

/// docs/methods.md names every method, map and tableau.
#[test]
fn the_guide_knows_them_all() {
    let guide = include_str!("../../docs/methods.md");
    let methods = all_methods().map(|(info, _)| info.name);
    for name in methods.chain(TABLEAUS.iter().copied()).chain(MAPS.iter().map(|m| m.name)) {
        let named = guide.contains(&format!("`{name}`")) || name.starts_with("ccsk");
        assert!(named, "`{name}` is not in docs/methods.md");
    }
}
