//! Lie series (Taylor) methods on any group: order, group, invariants, the step from the last terms,
//! typed errors; on quadratic Lie–Poisson systems, attitudes and a field that depends on time.

use crate::support::systems::{assert_order, casimirs, quadratic, run, systems};
use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{LieGroup, MatrixGroup, Sample, So3};
use lieflow::maps::Exp;
use lieflow::methods::{GAUSS6, LieSeries, RkmkGaussSymmetric, SeriesGroup, Taylor};
use lieflow::problems::{
    Euler, Kinetic, Problem, RigidBodyN, RigidBodyNAttitude, RigidBodyState, TaylorField,
};
use lieflow::{Error, LieAlgebra, Method, SaveAt, Step, StepError};
use lieflow::{StepControl, integrate_adaptive};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

fn series(order: usize) -> LieSeries {
    LieSeries::new(order).expect("an order")
}

/// Numbers of steps fixed in advance over a time of 8: high orders pass from the first digits to
/// rounding within a factor of 2.
const ORDERS: [(usize, [u64; 4]); 4] = [
    (4, [48, 72, 108, 156]),
    (5, [40, 60, 90, 130]),
    (6, [32, 48, 72, 108]),
    (8, [36, 40, 46, 52]),
];
/// The same over a time of 2, where the group is not compact and the motion runs away.
const ORDERS_NOT_COMPACT: [(usize, [u64; 4]); 2] =
    [(4, [72, 108, 162, 234]), (6, [36, 54, 81, 117])];

/// The motion of g besides that of m, on SO(5), Sp(4), GL(3) and SO(3,1). Orders of m alone are in
/// `rigid_body.rs`.
#[test]
fn order_of_the_attitude_on_every_group() {
    for (group, momentum) in systems() {
        let name = group.name();
        let compact = name == "SO(5)";
        let time = if compact { 8.0 } else { 2.0 };
        let system = quadratic(group).with_group();
        let start = (system.group().identity(), momentum);
        let reference = run(&system, &series(16), &start, time, 400);
        // The reference is not its own judge.
        let other = run(&system, &RkmkGaussSymmetric::new(GAUSS6, Exp), &start, time, 2000);
        let distance = |y: &(_, Mat<f64>)| {
            let (g, size) = (system.group().distance(&y.0, &reference.0), reference.1.norm_l2());
            g + (&y.1 - &reference.1).norm_l2() / size
        };
        assert!(distance(&other) < 1e-11, "{name}: {:e}", distance(&other));
        let orders = if compact { &ORDERS[..] } else { &ORDERS_NOT_COMPACT };
        for &(p, grid) in orders {
            let errors = grid.map(|n| distance(&run(&system, &series(p), &start, time, n)));
            assert_order(&format!("{name} taylor{p}"), p as f64, &grid, &errors);
        }
    }
}

fn attitude(n: usize) -> RigidBodyNAttitude {
    let lambda: Vec<f64> = (0..n).map(|i| 0.5 + 0.4 * i as f64).collect();
    let body = RigidBodyN::manakov(&lambda).expect("a body");
    let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(3), 0.6).into_mat();
    RigidBodyNAttitude::new(body, m).expect("a body")
}

#[test]
fn order_of_the_attitude() {
    let body = attitude(4);
    let start = body.group().sample_element(&mut Pcg64::seed_from_u64(4));
    // Slower than the systems above by 2. Of odd orders the leading term is small here.
    let time = 16.0;
    let reference = run(&body, &RkmkGaussSymmetric::new(GAUSS6, Exp), &start, time, 4000);
    for (p, grid) in ORDERS.into_iter().filter(|(p, _)| p % 2 == 0) {
        let errors = grid
            .map(|n| body.group().distance(&run(&body, &series(p), &start, time, n), &reference));
        assert_order(&format!("attitude taylor{p}"), p as f64, &grid, &errors);
    }
}

/// On so(3) it is the method of the free body on another layer: at steps with a plain error that method's
/// error is no larger, and falls from step to step with it; at small ones the two agree.
#[test]
fn on_so3_it_is_the_method_of_the_free_body() {
    let (inertia, m) = ([1.0, 2.0, 3.0], Vector3::new(0.9, 1.0, 2.1));
    let free = RigidBodyState::new(inertia).expect("a body");
    let start = free.state(m.into(), Matrix3::identity()).expect("a state");
    let exact = lieflow::problems::Exact::new(inertia, m.into(), Matrix3::identity())
        .and_then(|exact| exact.state(3.0))
        .expect("the exact motion");
    let hat = lieflow::groups::hat(&m);
    let body = RigidBodyN::from_principal(inertia).expect("a body");
    let m = Mat::from_fn(3, 3, |i, j| hat[(i, j)]);
    let body = RigidBodyNAttitude::new(body, m).expect("a body");
    let matrix = |g: &Matrix3<f64>| Mat::from_fn(3, 3, |i, j| g[(i, j)]);
    let exact = matrix(&exact.1);
    macro_rules! check {
        ($($order:literal, $steps:expr;)*) => {$(
            for steps in $steps {
                let closed = matrix(&run(&free, &Taylor::<$order>, &start, 3.0, steps).g);
                let g = run(&body, &series($order), &body.group().identity(), 3.0, steps);
                let [closed, error] = [&closed, &*g].map(|g| (g - &exact).norm_l2());
                println!("order {}, {steps} steps: {closed:.1e}, {error:.1e}", $order);
                assert!(error > 1e-12 && closed < error, "order {}: {closed:e}", $order);
            }
        )*};
    }
    check!(8, [16, 20]; 10, [11, 14]; 12, [8, 10]; 14, [7, 8]; 16, [6, 7];);
    let closed = run(&free, &Taylor::<16>, &start, 3.0, 30).g;
    let g = run(&body, &series(16), &body.group().identity(), 3.0, 30);
    let gap = (0..9).map(|k| (g[(k / 3, k % 3)] - closed[(k / 3, k % 3)]).abs());
    let gap = gap.fold(0.0, f64::max);
    assert!(gap < 1e-13, "{gap:e}");
}

/// Euler's equations on so(3)* are those of a free body: its momentum and attitude, and the step by error.
#[test]
fn eulers_equations_on_so3() {
    let (inertia, m) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.9, 1.0, 2.1));
    let exact = lieflow::problems::Exact::new(inertia.into(), m.into(), Matrix3::identity())
        .and_then(|exact| exact.state(4.0))
        .expect("the exact motion");
    let kinetic = Kinetic(move |m: &Vector3<f64>, u: &mut Vector3<f64>| {
        *u = m.component_div(&inertia);
    });
    let body = Euler::new(So3::new(), kinetic).with_group();
    let start = (Matrix3::identity(), m);
    let distance =
        |y: &(Matrix3<f64>, Vector3<f64>)| (y.0 - exact.1).norm() + (y.1 - exact.0).norm();
    for (p, grid) in ORDERS.into_iter().filter(|(p, _)| [4, 6].contains(p)) {
        let errors = grid.map(|n| distance(&run(&body, &series(p), &start, 4.0, n)));
        assert_order(&format!("so(3)* taylor{p}"), p as f64, &grid, &errors);
    }
    let mut y = start;
    let control = StepControl::new(0.0, 1e-10).expect("a tolerance");
    integrate_adaptive(&body, &series(12), [0.0, 4.0], &control, &SaveAt::Ends, &mut y, |_, _| {})
        .expect("a run");
    assert!(distance(&y) < 1e-9, "{:e}", distance(&y));
}

/// ġ = f(t) g on SO(3), f a polynomial: its coefficients about any t.
struct Polynomial(So3, [Vector3<f64>; 4]);

impl Problem for Polynomial {
    type Group = So3;
    type Action = LeftTranslation;
    type Work = ();
    fn group(&self) -> &So3 {
        &self.0
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    fn f(&self, t: f64, _: &Matrix3<f64>, v: &mut Vector3<f64>, _: &mut ()) {
        *v = self.1.iter().rev().fold(Vector3::zeros(), |s, c| s * t + c);
    }
}

impl TaylorField for Polynomial {
    type Series = ();
    fn series(&self, _: usize) {}
    fn coefficient(
        &self,
        [t, h]: [f64; 2],
        _: &Matrix3<f64>,
        k: usize,
        f: &mut [Vector3<f64>],
        (): &mut (),
    ) {
        let binomial = |n: usize| (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64);
        f[k] = (k..self.1.len()).fold(Vector3::zeros(), |s, n| {
            s + self.1[n] * (binomial(n) * t.powi((n - k) as i32) * h.powi(k as i32))
        });
    }
}

#[test]
fn order_with_time_in_the_field() {
    let coefficients = [[1.0, 0.2, -0.5], [0.3, -1.0, 0.8], [-0.9, 0.4, 0.6], [0.2, 0.7, -0.3]];
    let problem = Polynomial(So3::new(), coefficients.map(Vector3::from));
    let start = Matrix3::identity();
    let reference = run(&problem, &RkmkGaussSymmetric::new(GAUSS6, Exp), &start, 1.0, 800);
    for (p, grid) in [(4, [12, 18, 27, 39]), (7, [16, 20, 25, 32]), (8, [14, 17, 20, 24])] {
        let errors = grid.map(|n| (run(&problem, &series(p), &start, 1.0, n) - reference).norm());
        assert_order(&format!("polynomial taylor{p}"), p as f64, &grid, &errors);
    }
}

#[test]
fn group_and_invariants_over_1000_steps() {
    let body = attitude(5);
    let g = run(&body, &series(10), &body.group().identity(), 50.0, 1000);
    assert!(body.group().defect(&g) < 1e-14, "{:e}", body.group().defect(&g));
    for (group, start) in systems() {
        let (name, compact) = (group.name(), group.name() == "SO(5)");
        let system = quadratic(group);
        let end = if compact { 50.0 } else { 2.0 };
        let m = run(&system, &series(12), &start, end, 1000);
        // |m| grows on a non-compact group, and with it what rounding does.
        let growth = (m.norm_l2() / start.norm_l2()).max(1.0).powi(2);
        for (k, (after, before)) in casimirs(&m).into_iter().zip(casimirs(&start)).enumerate() {
            let gap = (after - before).abs();
            assert!(gap < 1e-13 * growth, "{name}: tr m^{} off by {gap:e}", k + 1);
        }
    }
}

/// The driver follows the last terms: the error follows the tolerance, and next to nothing is
/// rejected.
#[test]
fn adaptive_steps() {
    let (group, start) = systems().swap_remove(0);
    let system = quadratic(group);
    let reference = run(&system, &series(16), &start, 10.0, 1000);
    let energy = system.energy(&start);
    let mut last = f64::INFINITY;
    for tolerance in [1e-4, 1e-7, 1e-10, 1e-13] {
        let control = StepControl::new(0.0, tolerance).expect("a tolerance");
        let mut m = start.clone();
        let stats = integrate_adaptive(
            &system,
            &series(10),
            [0.0, 10.0],
            &control,
            &SaveAt::Ends,
            &mut m,
            |_, _| {},
        )
        .expect("a run");
        let error = (&m - &reference).norm_l2() / start.norm_l2();
        println!("{tolerance:e}: error {error:.1e}, {stats:?}");
        assert!(error < 100.0 * tolerance && error < last, "{error:e} at {tolerance:e}");
        assert!(stats.rejected <= 2 + stats.accepted / 10, "{stats:?}");
        assert!((system.energy(&m) - energy).abs() < 100.0 * tolerance);
        last = error;
    }
    // The free body's own method runs by the same driver.
    let body = RigidBodyState::new([1.0, 4.0, 18.0]).expect("a body");
    let mut y = body.state([0.0, 2.75, 2.75], Matrix3::identity()).expect("a state");
    let exact = lieflow::problems::Exact::new([1.0, 4.0, 18.0], [0.0, 2.75, 2.75], y.g)
        .and_then(|e| e.state(20.0))
        .expect("the exact motion");
    let control = StepControl::new(0.0, 1e-11).expect("a tolerance");
    let stats = integrate_adaptive(
        &body,
        &Taylor::<12>,
        [0.0, 20.0],
        &control,
        &SaveAt::Ends,
        &mut y,
        |_, _| {},
    )
    .expect("a run");
    assert!(
        (y.g - exact.1).norm() < 1e-9 && stats.rejected <= 2 + stats.accepted / 10,
        "{stats:?}"
    );
}

#[test]
fn errors_are_typed_and_leave_the_state() {
    for order in [0, 3, 17] {
        assert!(matches!(LieSeries::new(order), Err(Error::OutOfRange { .. })));
    }
    let body = attitude(4);
    let method = series(8);
    let mut g = body.group().identity();
    let mut work = method.work(&body, &g).expect("it fits");
    for h in [50.0, 1e300, f64::NAN] {
        let before = g.clone();
        let result = method.step(&body, Step { n: 0, t: 0.0, h }, &mut g, &mut work);
        match result {
            Err(StepError::OutsideChart { .. } | StepError::NotFinite { .. }) => (),
            other => panic!("h = {h}: {other:?}"),
        }
        assert_eq!(body.group().distance(&g, &before), 0.0);
    }
    // What went wrong stays behind.
    method.step(&body, Step { n: 0, t: 0.0, h: 0.1 }, &mut g, &mut work).expect("a step");
    assert!(body.group().defect(&g) < 1e-14);
    let group = MatrixGroup::gl(2).expect("GL(2)");
    let mut x = group.identity();
    group.clear(&mut x);
    assert_eq!(group.size(&x), 0.0);
}
