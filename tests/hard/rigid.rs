//! Hard cases of the rigid body by number, the rows R. References of 36 digits:
//! `references/rigid_body.json`, to which `problems/exact.rs` holds the exact solution.
//!
//! | rows | where |
//! |---|---|
//! | R1 – R9, R12 | here: the methods that step |
//! | R10 | `long/drift.rs`; R11 `long/lie_poisson.rs`, `problems/library/rigid.rs` |

use lieflow::maps::{Cay, Exp};
use lieflow::methods::{
    DMV2, DMV10, EnergyCasimir, Rkmk, SimoWong,
    tableau::{DOPRI5, RK4},
};
use lieflow::problems::{Exact, RigidBody, RigidBodyAttitude, RigidBodyQuaternion};
use lieflow::{Error, Method, Problem, RunError, SaveAt, Step, StepError, TimeGrid, integrate};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::support::references::motions;

type V = Vector3<f64>;
const EPS: f64 = f64::EPSILON;

/// The state after so many steps of size h.
fn run<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    y: &lieflow::problems::PointOf<P>,
    h: f64,
    steps: u64,
) -> lieflow::problems::PointOf<P>
where
    P::Group: lieflow::LieAlgebra<Scalar = f64>,
{
    let mut work = method.work(problem, y).expect("a workspace");
    let mut y = y.clone();
    for n in 0..steps {
        let t = n as f64 * h;
        method.step(problem, Step { n, t, h }, &mut y, &mut work).expect("a step");
    }
    y
}

/// One expression with every method that steps the momentum alone.
macro_rules! each_momentum_method {
    ($method:ident => $body:expr) => {{
        let $method = Rkmk::new(RK4, Exp);
        $body;
        let $method = Rkmk::new(RK4, Cay);
        $body;
        let $method = EnergyCasimir::new(Cay);
        $body;
        let $method = SimoWong::ONE;
        $body;
    }};
}

#[test]
fn r1_no_momentum() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    each_momentum_method!(method => assert_eq!(run(&body, &method, &V::zeros(), 0.1, 50), V::zeros()));
    assert_eq!(body.energy(&V::zeros()), 0.0);
    let still = RigidBodyAttitude::<f64>::new([1.0, 2.0, 3.0], [0.0; 3]).expect("a body");
    let one = Matrix3::identity();
    assert_eq!(run(&still, &Rkmk::new(RK4, Exp), &one, 0.1, 50), one);
    let still = RigidBodyQuaternion::new([1.0, 2.0, 3.0], [0.0; 3]).expect("a body");
    let one = UnitQuaternion::identity();
    assert_eq!(run(&still, &Rkmk::new(RK4, Cay), &one, 0.1, 50), one);
    let (m, g) = Exact::new([1.0, 2.0, 3.0], [0.0; 3], Matrix3::identity())
        .and_then(|e| e.state(7.0))
        .expect("a state");
    assert_eq!((m, g), (V::zeros(), Matrix3::identity()));
}

#[test]
fn r2_axes_are_fixed_bit_for_bit() {
    for inertia in [[1.0, 2.0, 3.0], [2.0, 1.0, 3.0], [0.3, 0.4, 0.5]] {
        let body = RigidBody::<f64>::new(inertia).expect("a body");
        for axis in 0..3 {
            let mut m = V::zeros();
            m[axis] = -1.3;
            each_momentum_method!(method => assert_eq!(run(&body, &method, &m, 0.1, 100), m));
            // And the attitude turns about it at a constant rate.
            let turning = RigidBodyAttitude::<f64>::new(inertia, m.into()).expect("a body");
            let g = run(&turning, &Rkmk::new(RK4, Exp), &Matrix3::identity(), 0.1, 100);
            let exact = lieflow::so3::exp(&(10.0 * body.omega(&m))).expect("a rotation");
            assert!((g - exact).norm() < 100.0 * 4.0 * EPS, "{inertia:?} {axis}");
        }
    }
}

#[test]
fn r3_near_the_separatrix_errors_grow_no_faster_than_the_motion_parts() {
    let mut meant = 0;
    for case in motions("separatrix") {
        let inertia = case.inertia;
        let m0 = V::from(case.momentum);
        let exact = case.m;
        let mut inverse = inertia.map(|j| 1.0 / j);
        inverse.sort_by(f64::total_cmp);
        let [low, middle, high] = inverse;
        let growth = ((high - middle) * (middle - low)).sqrt() * m0.norm();
        let t = case.t;
        let steps = (100.0 * t.abs()).ceil() as u64;
        let h = t / steps as f64;
        let body = RigidBody::<f64>::new(inertia).expect("a body");
        let m = run(&body, &Rkmk::new(DOPRI5, Exp), &m0, h, steps);
        let apart = (growth * t.abs()).exp();
        let bound = (h.abs().powi(5) + 50.0 * EPS) * m0.norm() * apart + 3.0 * case.ulp[0];
        let error = (m - exact).norm();
        assert!(error <= bound, "{}: {error:.1e} > {bound:.1e}", case.id);
        assert!((m.norm() - m0.norm()).abs() < 1e-13 * m0.norm(), "{}", case.id);
        meant += usize::from(bound < 1e-3);
    }
    assert!(meant >= 6, "bounds that say something: {meant}");
}

#[test]
fn r4_r5_nearly_symmetric_slender_and_stiff_bodies() {
    let mut seen = 0;
    for case in
        ["nearly_symmetric", "nearly_axis", "nearly_middle", "axis"].into_iter().flat_map(motions)
    {
        let inertia = case.inertia;
        let momentum = case.momentum;
        let (t, exact_m) = (case.t, case.m);
        let body = RigidBody::<f64>::new(inertia).expect("a body");
        let steps = (50.0 * t.abs()).ceil() as u64;
        let h = t / steps as f64;
        let m = run(&body, &Rkmk::new(DOPRI5, Exp), &momentum.into(), h, steps);
        let scale = V::from(momentum).norm();
        // The attitude turns by ωt, and an error of its rate is an error of m.
        let turns = 1.0 + body.omega(&momentum.into()).norm() * t.abs();
        let bound = 20.0 * (h.abs() * turns / t.abs()).powi(5) * turns * scale
            + 64.0 * EPS * (steps as f64).sqrt() * turns * scale
            + 3.0 * case.ulp[0];
        assert!(
            (m - exact_m).norm() <= bound,
            "{}: {:.1e} > {bound:.1e}",
            case.id,
            (m - exact_m).norm()
        );
        seen += 1;

        if case.attitude0.is_none() {
            let start = RigidBodyQuaternion::new(inertia, momentum).expect("a body");
            let q = run(&start, &Rkmk::new(DOPRI5, Exp), &UnitQuaternion::identity(), h, steps);
            let g = case.g;
            let error = (q.to_rotation_matrix().matrix() - g).norm();
            let bound = 4.0 * bound / scale + 3.0 * case.ulp[1];
            assert!(error <= bound, "{}: the quaternion {error:.1e} > {bound:.1e}", case.id);
        }
    }
    assert!(seen >= 8, "{seen}");
    // A sphere: its momentum rests, exactly.
    let ball = RigidBody::<f64>::new([0.7; 3]).expect("a body");
    let m = V::new(0.3, -1.1, 0.4);
    assert!((run(&ball, &Rkmk::new(RK4, Exp), &m, 0.3, 100) - m).norm() < 4.0 * EPS);
    // Extreme ratios: the axis that is nearly free does not disturb the others.
    for inertia in [[1.0, 1.0, 1e-3], [1.0, 1.0, 1e-6], [1.0, 1e4, 1.0001e4]] {
        let m0 = V::new(1e-3, 0.8, 1e-4);
        let exact = Exact::new(inertia, m0.into(), Matrix3::identity()).expect("a body");
        let body = RigidBody::<f64>::new(inertia).expect("a body");
        let (t, steps) = (1.0, 10_000);
        let h = t / steps as f64;
        let m = run(&body, &Rkmk::new(DOPRI5, Exp), &m0, h, steps);
        let far = (m - exact.momentum_body(t).expect("a momentum")).norm();
        let rate = 1.0 + body.omega(&m0).norm();
        let bound = (20.0 * (h * rate).powi(5) + 4.0 * EPS * (steps as f64).sqrt()) * rate * t;
        assert!(far < bound, "{inertia:?}: {far:.1e} > {bound:.1e}");
    }
}

#[test]
fn r6_inertias_that_are_none() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 5e-324] {
        for i in 0..3 {
            let mut inertia = [1.0, 2.0, 3.0];
            inertia[i] = bad;
            let name = format!("inertia[{i}]");
            let named = |e: Option<Error>| {
                assert!(
                    matches!(e, Some(Error::OutOfRange { ref arg, .. }) if *arg == name),
                    "{e:?}"
                );
            };
            named(RigidBody::<f64>::new(inertia).err());
            named(RigidBodyAttitude::<f64>::new(inertia, [1.0; 3]).err());
            named(RigidBodyQuaternion::new(inertia, [1.0; 3]).err());
            named(Exact::new(inertia, [1.0; 3], Matrix3::identity()).err());
        }
    }
    for bad in [f64::NAN, f64::NEG_INFINITY] {
        assert!(RigidBodyQuaternion::new([1.0, 2.0, 3.0], [0.0, bad, 0.0]).is_err());
    }
}

#[test]
fn r7_r12_scales_change_no_bit() {
    // m → sm with h → h/s, and J → sJ with h → sh, leave hω as it is: with s = 2^k bit for bit.
    let (inertia, m, h) = ([1.0, 2.0, 2.5], V::new(0.3, -1.1, 0.4), 0.1);
    let body = RigidBody::<f64>::new(inertia).expect("a body");
    for k in [-498, 498, 664, 332, -332] {
        let s = 2f64.powi(k);
        if k.abs() < 400 {
            let heavy = RigidBody::<f64>::new(inertia.map(|j| s * j)).expect("a body");
            each_momentum_method!(method => {
                let (plain, other) = (run(&body, &method, &m, h, 40), run(&heavy, &method, &m, s * h, 40));
                assert_eq!(other, plain, "J times 2^{k}");
            });
        }
        let (rkmk, implicit) = (Rkmk::new(RK4, Exp), EnergyCasimir::new(Cay));
        assert_eq!(run(&body, &rkmk, &(s * m), h / s, 40) / s, run(&body, &rkmk, &m, h, 40));
        let rkmk = Rkmk::new(RK4, Cay);
        assert_eq!(run(&body, &rkmk, &(s * m), h / s, 40) / s, run(&body, &rkmk, &m, h, 40));
        let (plain, scaled) =
            (run(&body, &implicit, &m, h, 40), run(&body, &implicit, &(s * m), h / s, 40) / s);
        assert_eq!(scaled, plain, "m times 2^{k}");
        for implicit in [SimoWong::ONE, SimoWong::TAN, SimoWong::LEWIS_SIMO] {
            let (plain, scaled) =
                (run(&body, &implicit, &m, h, 40), run(&body, &implicit, &(s * m), h / s, 40) / s);
            assert_eq!(scaled, plain, "m times 2^{k}, {implicit:?}");
        }
        for implicit in [DMV2, DMV10] {
            let (plain, scaled) =
                (run(&body, &implicit, &m, h, 40), run(&body, &implicit, &(s * m), h / s, 40) / s);
            assert!((scaled - plain).norm() <= 1e-14 * plain.norm(), "m times 2^{k}, {implicit:?}");
        }
    }
}

#[test]
fn r8_steps_of_any_size_stay_on_the_orbit() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let m = V::new(0.2, 0.9, 3.0);
    for h in [1.0, 5.0, 1e-300, 0.0] {
        let end = run(&body, &Rkmk::new(RK4, Exp), &m, h, 1);
        assert!((end.norm() - m.norm()).abs() <= 10.0 * EPS * m.norm(), "h = {h}");
        assert!(h > 1e-200 || end == m, "h = {h}");
    }
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        assert!(
            matches!(TimeGrid::new([0.0, 1.0], bad), Err(Error::OutOfRange { ref arg, .. }) if arg == "dt")
        );
    }
    let mut work = Method::<RigidBody>::work(&Rkmk::new(RK4, Exp), &body, &m).expect("a workspace");
    let (mut y, step) = (m, Step { n: 0, t: 0.0, h: f64::NAN });
    assert!(Rkmk::new(RK4, Exp).step(&body, step, &mut y, &mut work).is_err());
    assert_eq!(y, m, "y is as it was");
}

#[test]
fn r9_implicit_steps_beyond_their_reach() {
    // They end in a typed error with y as it was, or on the orbit; never in anything else.
    let body = RigidBody::<f64>::new([0.1, 2.0, 3.0]).expect("a body");
    let m = V::new(2.0, -3.0, 5.0);
    let mut refused = 0;
    for h in [1.0, 3.0, 10.0, 40.0, 1e3, 1e6] {
        for method in [SimoWong::ONE, SimoWong::TAN, SimoWong::LEWIS_SIMO] {
            let (mut y, grid) = (m, TimeGrid::new([0.0, h], h).expect("a grid"));
            match integrate(&body, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {}) {
                Ok(_) => assert!((y.norm() - m.norm()).abs() < 1e-12 * m.norm(), "h = {h}"),
                Err(RunError::Step(failure)) => {
                    let typed = matches!(
                        failure.source,
                        StepError::NewtonDidNotConverge { .. }
                            | StepError::FixedPointDidNotConverge { .. }
                            | StepError::OutsideChart { .. }
                    );
                    assert!(typed && (failure.step, failure.h) == (0, h), "{failure}");
                    assert_eq!(y, m);
                    refused += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
    assert!(refused > 0, "some step is beyond their reach");
}
