//! Lie series on se(3)*: heavy tops without and with their pose, a body in a fluid, the spherical pendulum.

use lieflow::actions::Coadjoint;
use lieflow::catalog::{MethodSpec, MethodsByName, Needs};
use lieflow::groups::{Adjoint, LieGroup, Se3};
use lieflow::methods::{Embedded, LieSeries, Metric};
use lieflow::prelude::*;
use lieflow::problems::{
    DynFlow, Euler, HeavyTop, Invariants, Kinetic, LiePoisson, PointOf, SphericalPendulum,
    TaylorField, WithHamiltonian, WithSeries,
};
use nalgebra::{Matrix3, Vector3};

use crate::support::systems::assert_order;

type V = Vector3<f64>;
type Pair = (V, V);
/// An element of SE(3), and (μ, γ).
type Pose = ((Matrix3<f64>, V), Pair);

const START: Pair = (V::new(0.4, -0.3, 1.5), V::new(0.48, 0.6, 0.64));

fn top() -> HeavyTop {
    HeavyTop::new([1.0, 2.0, 2.5], [0.3, -0.2, 1.0]).unwrap()
}

fn series(order: usize) -> LieSeries {
    LieSeries::new(order).unwrap()
}

fn apart(a: &Pair, b: &Pair) -> f64 {
    (a.0 - b.0).norm() + (a.1 - b.1).norm()
}

/// The points at these times by steps of one size.
fn rows<P>(
    problem: &P,
    order: usize,
    start: &PointOf<P>,
    steps: u64,
    times: &[f64],
) -> Vec<PointOf<P>>
where
    P: TaylorField<Group = Se3>,
    PointOf<P>: Metric<Scalar = f64>,
{
    let end = times[times.len() - 1];
    let method = series(order);
    let solve = Solve::new(problem, &method, [0.0, end]).dt(end / steps as f64);
    solve.times(times).run(start.clone()).unwrap().points
}

/// Orders, and numbers of steps that are fixed in advance.
type Grids = [(usize, [u64; 4])];

/// The orders at the end of steps and within them.
fn has_orders<P>(
    (name, problem): (&str, &P),
    start: &PointOf<P>,
    grids: &Grids,
    far: impl Fn(&PointOf<P>, &PointOf<P>) -> f64,
) where
    P: TaylorField<Group = Se3>,
    PointOf<P>: Metric<Scalar = f64>,
{
    let times = [1.234, 2.345, 3.1, 4.0];
    let reference = rows(problem, 16, start, 300, &times);
    let fine = Rkmk::new(DOP853, Exp);
    let other = Solve::new(problem, &fine, [0.0, 4.0]).tolerances(1e-14, 1e-14);
    let other = other.times(times).times_by_steps().run(start.clone()).unwrap().points;
    for (a, b) in reference.iter().zip(&other) {
        assert!(far(a, b) < 1e-12, "{name}: the reference is {:e} off", far(a, b));
    }
    for &(order, steps) in grids {
        for row in [1, 3] {
            let errors =
                steps.map(|n| far(&rows(problem, order, start, n, &times)[row], &reference[row]));
            assert_order(&format!("{name} taylor{order} row {row}"), order as f64, &steps, &errors);
        }
    }
}

#[test]
fn orders_of_every_problem() {
    const FOUR: (usize, [u64; 4]) = (4, [54, 81, 121, 180]);
    const FIVE: (usize, [u64; 4]) = (5, [36, 54, 81, 121]);
    const SIX: (usize, [u64; 4]) = (6, [45, 67, 100, 150]);
    has_orders(("top", &top().problem()), &START, &[FOUR, FIVE, SIX], apart);
    let pendulum = SphericalPendulum::new(1.3).unwrap();
    let start = pendulum.state([0.48, 0.6, -0.64], [0.8, -0.64, 0.0]).unwrap();
    let grids = [FOUR, FIVE, (6, [67, 100, 150, 220])];
    has_orders(("pendulum", &pendulum), &start, &grids, apart);
    let fluid = Kinetic(|m: &Pair, u: &mut Pair| {
        u.0 = m.0.component_div(&V::new(1.0, 2.0, 3.0));
        u.1 = m.1.component_div(&V::new(1.5, 1.2, 1.0));
    });
    let grids = [FOUR, FIVE, (6, [30, 45, 67, 100]), (8, [16, 22, 30, 41])];
    has_orders(("body in a fluid", &Euler::new(Se3::new(), fluid)), &START, &grids, apart);
    let far = |(g, m): &Pose, (h, n): &Pose| Se3::new().distance(g, h) + apart(m, n);
    let start = (Se3::new().identity(), START);
    let grids = [FOUR, FIVE, SIX, (8, [22, 30, 41, 56])];
    has_orders(("top with its pose", &top().problem().with_group()), &start, &grids, far);
}

/// Steps so large that the error is plain stay on the orbit to rounding.
#[test]
fn rough_steps_stay_on_the_orbit() {
    let problem = top().problem();
    for (order, steps) in [(4, 12), (6, 10), (9, 9), (16, 8)] {
        let end = rows(&problem, order, &START, steps, &[4.0])[0];
        let fine = rows(&problem, 16, &START, 300, &[4.0])[0];
        assert!(
            order == 16 || apart(&end, &fine) > 1e-6,
            "order {order}: {:e}",
            apart(&end, &fine)
        );
        assert!((end.1.norm() - 1.0).abs() < 1e-14, "order {order}: {:e}", end.1.norm() - 1.0);
        assert!((end.0.dot(&end.1) - START.0.dot(&START.1)).abs() < 1e-13, "order {order}");
    }
}

/// The units of mass and length change no step and no digit.
#[test]
fn steps_do_not_depend_on_units() {
    let run = |unit: f64| {
        let scaled = |x: [f64; 3]| x.map(|x| unit * x);
        let top = HeavyTop::new(scaled([1.0, 2.0, 2.5]), scaled([0.3, -0.2, 1.0])).unwrap();
        let (problem, method, start) = (top.problem(), series(12), (unit * START.0, START.1));
        let run = Solve::new(&problem, &method, [0.0, 10.0])
            .tolerances(1e-9, 0.0)
            .first_step(0.1)
            .run(start);
        let run = run.unwrap();
        (run.y.0 / unit, run.y.1, run.stats.accepted)
    };
    let plain = run(1.0);
    for unit in [2f64.powi(20), 2f64.powi(-20)] {
        assert_eq!(run(unit), plain, "{unit}");
    }
}

/// Invariants of the action to rounding, the energy to the tolerance; the error follows the tolerance.
#[test]
fn errors_and_invariants_by_tolerance() {
    let problem = top().problem();
    let by = |rtol: f64| {
        let method = series(16);
        let solve = Solve::new(&problem, &method, [0.0, 20.0]).tolerances(rtol, 0.0);
        let run = solve.run(START).unwrap();
        (run.y, run.stats.accepted)
    };
    let (reference, _) = by(1e-15);
    let fine = Rkmk::new(DOP853, Exp);
    let other = Solve::new(&problem, &fine, [0.0, 20.0]).tolerances(1e-14, 0.0);
    let other = other.run(START).unwrap();
    assert!(apart(&reference, &other.y) < 1e-11, "{:e}", apart(&reference, &other.y));
    let mut last = f64::INFINITY;
    for rtol in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let (y, steps) = by(rtol);
        let error = apart(&y, &reference);
        println!("{rtol:e}: {error:.1e} in {steps} steps");
        assert!(error < 30.0 * rtol && error < last, "{rtol:e}: {error:e}");
        let [before, after] = [&START, &y].map(|y| problem.values(y));
        assert!((after[0] - before[0]).abs() < 30.0 * rtol, "energy");
        for k in [1, 2] {
            assert!((after[k] - before[k]).abs() < 1e-14, "{rtol:e}: invariant {k}");
        }
        last = error;
    }
    // With the pose: it stays on SE(3), and the momentum in space stays.
    let with_pose = problem.with_group();
    let method = series(12);
    let solve = Solve::new(&with_pose, &method, [0.0, 20.0]).tolerances(1e-9, 0.0);
    let run = solve.run((Se3::new().identity(), START)).unwrap();
    let (g, m) = run.y;
    let group = Se3::new();
    let (mut inverse, mut in_space) = (group.identity(), START);
    group.invert(&g, &mut (), &mut inverse).unwrap();
    group.coad_group(&inverse, &m, &mut in_space).unwrap();
    assert!(group.defect(&g) < 1e-14);
    assert!(apart(&in_space, &START) < 1e-12, "{:e}", apart(&in_space, &START));
    assert!(apart(&m, &reference) < 1e-7);
}

/// The points at these times by steps by error.
fn all<M: Embedded<Euler<Se3, HeavyTop>>>(
    problem: &Euler<Se3, HeavyTop>,
    method: &M,
    (start, times, tolerance): (Pair, &[f64], f64),
) -> Vec<Pair> {
    let end = times[times.len() - 1];
    let solve = Solve::new(problem, method, [0.0, end]).tolerances(tolerance, tolerance);
    solve.times(times).run(start).unwrap().points
}

/// Starts from which steps are hard to choose, beside RKMK of order 8 with small steps.
#[test]
fn hard_starts() {
    let top = |inertia, weight| HeavyTop::new(inertia, weight).unwrap();
    let general = || top([1.0, 2.0, 2.5], [0.3, -0.2, 1.0]);
    let up = V::new(0.3, -0.2, 1.0).normalize();
    let free = || top([1.0, 2.0, 3.0], [0.0; 3]);
    // The name, the top, its start, the end, and how much the motion enlarges an error.
    let starts: [(&str, HeavyTop, Pair, f64, f64); 9] = [
        ("upright, the separatrix", general(), (V::new(0.0, 1e-14, 0.0), up), 20.0, 1e8),
        ("upright at rest", general(), (V::zeros(), up), 5.0, 1e3),
        ("at rest, level", general(), (V::zeros(), V::x()), 10.0, 1e3),
        (
            "sleeping",
            top([1.0, 1.0, 0.5], [0.0, 0.0, 1.0]),
            (V::new(0.0, 1e-14, 2.1), V::z()),
            30.0,
            1e3,
        ),
        ("a fast spin", general(), (V::new(10.0, 20.0, 2500.0), V::y()), 0.3, 1e4),
        ("a fast turn", general(), (V::new(600.0, -800.0, 900.0), V::y()), 0.3, 1e4),
        ("a heavy weight", top([1.0, 2.0, 2.5], [300.0, -200.0, 1e3]), START, 0.5, 1e4),
        ("free, the separatrix", free(), (V::new(0.0, 2.0, 0.0), V::z()), 20.0, 1e8),
        ("free, beside an axis", free(), (V::new(3.0, 1e-14, 1e-14), V::z()), 20.0, 1e3),
    ];
    for (name, top, start, end, growth) in starts {
        let problem = top.problem();
        let times: Vec<f64> = (0..=40).map(|k| end * f64::from(k) / 40.0).collect();
        let reference = all(&problem, &Rkmk::new(DOP853, Exp), (start, &times, 1e-14));
        let sizes = reference.iter().map(|y| y.0.norm());
        let size = sizes.fold(1.0, f64::max);
        for (order, rtol) in [(8, 1e-6), (16, 1e-6), (16, 1e-9), (16, 1e-12)] {
            let found = all(&problem, &series(order), (start, &times, rtol));
            for ((a, b), t) in found.iter().zip(&reference).zip(&times) {
                let error = apart(a, b) / size;
                let allowed = growth * rtol + 1e-14 * growth;
                assert!(error < allowed, "{name}, order {order}, {rtol:e}, t = {t}: {error:e}");
                assert!((a.1.norm() - start.1.norm()).abs() < 1e-14, "{name}: |γ|");
                assert!(
                    (a.0.dot(&a.1) - start.0.dot(&start.1)).abs() < 3e-14 * size,
                    "{name}: μ·γ"
                );
            }
        }
    }
}

/// The methods by name are those of the types, and only problems with coefficients have them.
#[test]
fn by_name() {
    type Top = DynFlow<Se3, Coadjoint, WithSeries, WithHamiltonian>;
    let known = Top::lie_poisson_with_series(top().problem(), Coadjoint);
    let unknown = Top::lie_poisson(top().problem(), Coadjoint);
    let spec = MethodSpec::new("taylor12", None);
    assert!(known.offers().contains(&Needs::Series) && !unknown.offers().contains(&Needs::Series));
    assert!(known.offers().contains(&Needs::LiePoisson));
    assert!(unknown.method(&spec).is_err());
    let method = known.method(&spec).unwrap();
    let by_name = Solve::new(&known, &method, [0.0, 3.0]).tolerances(1e-9, 0.0).run(START).unwrap();
    let (problem, method) = (top().problem(), series(12));
    let typed = Solve::new(&problem, &method, [0.0, 3.0]).tolerances(1e-9, 0.0).run(START).unwrap();
    assert_eq!((by_name.y, by_name.stats.accepted), (typed.y, typed.stats.accepted));
    assert_eq!(known.hamiltonian(&START), problem.energy(&START));
    // Without coefficients a step fails, and says so.
    let method = series(12);
    let failed = Solve::new(&unknown, &method, [0.0, 3.0]).dt(0.1).run(START).unwrap_err();
    assert!(failed.to_string().contains("stage 1"), "{failed}");
}
