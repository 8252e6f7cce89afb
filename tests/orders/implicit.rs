//! Implicit methods: Gauss on the linear space, implicit RKMK and its symmetric version. Order in m and g,
//! symmetry, invariants, typed errors; on so(3) in closed form and on so(n) over matrices.

use crate::support::systems::{assert_order, grid, run};
use lieflow::actions::LeftTranslation;
use lieflow::error::StepError;
use lieflow::groups::{LieGroup, MatrixGroup, Sample, So3};
use lieflow::maps::{CCSK123, Cay, Exp};
use lieflow::methods::{
    Composition, GAUSS2, GAUSS4, GAUSS6, Gauss, KAHAN_LI6, RkmkGauss, RkmkGaussSymmetric,
};
use lieflow::problems::{
    Ambient, BodyState, Exact, Flow, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude,
    RigidBodyState,
};
use lieflow::{CoordinateMap, LieAlgebra, Method, Problem, SaveAt, Step, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const MOMENTUM: [f64; 3] = [0.9, 1.0, 2.1];

/// f = cos 1.3t A + tanh g₁₂ B + t g₀₀/2 [A, B], ‖A‖ = ‖B‖ = 0.8.
fn driven(
    group: MatrixGroup,
    seed: u64,
) -> impl Ambient<Group = MatrixGroup, Action = LeftTranslation> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut sample = || {
        let (x, mut u) = (group.sample_algebra(&mut rng, 1.0), group.zero());
        group.axpy(0.8 / group.norm(&x), &x, &mut u);
        u
    };
    let (a, b) = (sample(), sample());
    let mut c = group.zero();
    group.bracket(&a, &b, &mut c);
    Flow::new(group.clone(), LeftTranslation, move |t: f64, g, v| {
        group.set_zero(v);
        group.axpy((1.3 * t).cos(), &a, v);
        group.axpy(g[(1, 2)].tanh(), &b, v);
        group.axpy(0.5 * t * g[(0, 0)], &c, v);
    })
}

/// Orders in m and in g apart; every method on every group is in `fields.rs`.
#[test]
fn order_on_the_rigid_body() {
    let body = RigidBodyState::new(INERTIA).expect("a body");
    let start = body.state(MOMENTUM, Matrix3::identity()).expect("a state");
    let (m, g) = Exact::new(INERTIA, MOMENTUM, Matrix3::identity())
        .and_then(|e| e.state(2.0))
        .expect("the exact motion");
    macro_rules! check {
        ($($method:expr, $p:expr, $first:expr;)*) => {$({
            let grid = grid($first);
            let ends = grid.map(|n| run(&body, &$method, &start, 2.0, n));
            let name = stringify!($method);
            assert_order(&format!("{name} m"), $p, &grid, &ends.map(|y| (y.m - m).norm()));
            assert_order(&format!("{name} g"), $p, &grid, &ends.map(|y| (y.g - g).norm()));
        })*};
    }
    check! {
        Gauss(GAUSS2), 2.0, 32;
        Gauss(GAUSS4), 4.0, 24;
        Gauss(GAUSS6), 6.0, 12;
        Composition::new(Gauss(GAUSS2), KAHAN_LI6), 6.0, 12;
        RkmkGauss::new(GAUSS4, Exp), 4.0, 24;
        RkmkGauss::new(GAUSS4, CCSK123), 4.0, 32;
        RkmkGauss::new(GAUSS6, Cay), 6.0, 12;
        RkmkGaussSymmetric::new(GAUSS4, Exp), 4.0, 24;
        RkmkGaussSymmetric::new(GAUSS6, Cay), 6.0, 12;
    }
}

/// ‖Φ₋ₕ(Φₕ(y)) − y‖ on SO(3).
fn defect<M: Method<RigidBodyState>>(method: &M) -> f64 {
    let body = RigidBodyState::new(INERTIA).expect("a body");
    let g0 = Exp.eval(&So3::new(), &Vector3::new(0.3, -0.5, 0.8)).expect("a rotation");
    let start = BodyState { m: MOMENTUM.into(), g: g0 };
    let (mut y, mut work) = (start, method.work(&body, &start).expect("it fits"));
    for h in [0.3, -0.3] {
        method.step(&body, Step { n: 0, t: 0.0, h }, &mut y, &mut work).expect("a step");
    }
    (y.m - start.m).norm() + (y.g - start.g).norm()
}

#[test]
fn symmetry_at_rounding_for_the_symmetric_ones_only() {
    /// Rounding of two steps of |m| ≈ 2.5.
    const ROUNDING: f64 = 5e-15;
    assert!(defect(&Gauss(GAUSS2)) < ROUNDING && defect(&Gauss(GAUSS6)) < ROUNDING);
    assert!(defect(&RkmkGaussSymmetric::new(GAUSS2, Exp)) < ROUNDING);
    assert!(defect(&RkmkGaussSymmetric::new(GAUSS4, Exp)) < ROUNDING);
    assert!(defect(&RkmkGaussSymmetric::new(GAUSS4, Cay)) < ROUNDING);
    assert!(defect(&RkmkGaussSymmetric::new(GAUSS6, Exp)) < ROUNDING);
    let one_sided = defect(&RkmkGauss::new(GAUSS4, Exp));
    println!("chart at the start: symmetry defect {one_sided:.1e}");
    assert!(one_sided > 1e-9);
    // With time in the field and on a group where nothing commutes.
    let problem = driven(MatrixGroup::sp(4).expect("Sp(4)"), 3);
    let method = RkmkGaussSymmetric::new(GAUSS4, Exp);
    let start = problem.group().identity();
    let (mut y, mut work) = (start.clone(), method.work(&problem, &start).expect("it fits"));
    for (t, h) in [(0.2, 0.15), (0.35, -0.15)] {
        method.step(&problem, Step { n: 0, t, h }, &mut y, &mut work).expect("a step");
    }
    assert!(problem.group().distance(&y, &start) < ROUNDING);
}

/// Gauss methods keep what is quadratic in y to rounding, over 2000 steps.
#[test]
fn quadratic_invariants_on_the_linear_space() {
    const KEPT: f64 = 1e-13;
    let body = RigidBodyState::new(INERTIA).expect("a body");
    let start = body.state(MOMENTUM, Matrix3::identity()).expect("a state");
    macro_rules! check {
        ($($method:expr),*) => {$({
            let mut y = start;
            let grid = TimeGrid::with_steps([0.0, 200.0], 2000).expect("a grid");
            let mut worst = [0.0f64; 4];
            integrate(&body, &$method, &grid, &SaveAt::Every(1), &mut y, |_, y| {
                let found = [
                    (body.energy(y) / body.energy(&start) - 1.0).abs(),
                    (y.m.norm() / start.m.norm() - 1.0).abs(),
                    (body.momentum_space(y) - start.m).norm(),
                    body.group().defect(&y.g),
                ];
                worst.iter_mut().zip(found).for_each(|(w, f)| *w = w.max(f));
            })
            .expect("a run");
            println!("{:20} E, |m|, gm, g: {worst:?}", stringify!($method));
            assert!(worst.iter().all(|&w| w < KEPT), "{worst:?}");
        })*};
    }
    check!(Gauss(GAUSS2), Gauss(GAUSS4), Gauss(GAUSS6));
}

/// Both layers, so(3) in closed form and over matrices, take the same step; and on bodies in ℝⁿ.
#[test]
fn the_layers_agree() {
    let (a, b) = (
        RigidBody::<f64>::new(INERTIA).expect("a body"),
        RigidBodyN::from_principal(INERTIA).expect("a body"),
    );
    let m = Vector3::from(MOMENTUM);
    let hat = lieflow::groups::hat(&m);
    let big = faer::Mat::from_fn(3, 3, |i, j| hat[(i, j)]);
    macro_rules! check {
        ($($method:expr),*) => {$({
            let x = run(&a, &$method, &m, 1.0, 5);
            let y = run(&b, &$method, &big, 1.0, 5);
            let gap = (y[(2, 1)] - x[0]).abs() + (y[(0, 2)] - x[1]).abs() + (y[(1, 0)] - x[2]).abs();
            assert!(gap < 2e-14, "{}: {gap:e}", stringify!($method));
        })*};
    }
    check!(
        Gauss(GAUSS4),
        RkmkGauss::new(GAUSS4, Exp),
        RkmkGaussSymmetric::new(GAUSS4, Cay),
        RkmkGaussSymmetric::new(GAUSS6, Exp)
    );
    let n_body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0]).expect("a body");
    let m = n_body.group().sample_algebra(&mut Pcg64::seed_from_u64(1), 1.0).into_mat();
    let attitude = RigidBodyNAttitude::new(n_body, m).expect("a body");
    let g = run(&attitude, &Gauss(GAUSS4), &attitude.group().identity(), 1.0, 10);
    assert!(attitude.group().defect(&g) < 1e-13);
}

/// A step beyond the contraction fails with its name, and leaves y as it was.
#[test]
fn a_step_too_large_has_a_typed_error() {
    let body =
        RigidBodyAttitude::<f64>::new([1.0, 0.25, 1.0 / 18.0], [0.0, 2.75, 2.75]).expect("a body");
    macro_rules! check {
        ($($method:expr),*) => {$({
            let (mut g, method) = (Matrix3::identity(), $method);
            let mut work = method.work(&body, &g).expect("it fits");
            for h in [0.002, 5.0] {
                let before = g;
                let result = method.step(&body, Step { n: 0, t: 0.0, h }, &mut g, &mut work);
                match result {
                    Ok(()) => assert!(h < 1.0, "{}", stringify!($method)),
                    Err(StepError::FixedPointDidNotConverge { iterations, .. }) => {
                        assert!(h > 1.0 && iterations > 0 && g == before);
                    }
                    Err(StepError::NormTooLarge { .. } | StepError::OutsideChart { .. }) => {
                        assert!(h > 1.0 && g == before);
                    }
                    Err(other) => panic!("{}: {other}", stringify!($method)),
                }
            }
            // What went wrong stays behind: the next small step is as good as the first.
            method.step(&body, Step { n: 0, t: 0.0, h: 0.002 }, &mut g, &mut work).expect("a step");
            assert!(body.group().defect(&g) < 1e-14);
        })*};
    }
    check!(
        Gauss(GAUSS2),
        Gauss(GAUSS6),
        RkmkGauss::new(GAUSS4, Exp),
        RkmkGaussSymmetric::new(GAUSS4, Exp),
        RkmkGaussSymmetric::new(GAUSS4, Cay)
    );
}
