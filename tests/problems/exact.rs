//! The exact solution of the rigid body against references of 36 digits.

use lieflow::methods::Taylor;
use lieflow::problems::{Exact, RigidBodyState};
use nalgebra::{Matrix3, Vector3};

use crate::support::references::motions;

/// Orbits from the separatrix to the axes, which take one form near the former and another elsewhere,
/// against a Lie series. Each starts again from its state at half the time.
#[test]
fn every_orbit_moves_as_the_lie_series_says() {
    let mut worst = 0.0f64;
    for inertia in [[1.0, 2.0, 3.0], [18.0, 4.0, 1.0], [1.0, 1.0, 2.0], [1.0, 1.001, 1.5]] {
        for k in 0..=60 {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(k) / 60.0;
            let m = Vector3::new(angle.cos(), 0.3, -angle.sin()).normalize();
            let start = Exact::new(inertia, m.into(), Matrix3::identity()).expect("a body");
            let (half_m, half_g) = start.state(2.0).expect("a time");
            let (end_m, end_g) = start.state(4.0).expect("a time");
            let again = Exact::new(inertia, half_m.into(), half_g).expect("a body");
            let (again_m, again_g) = again.state(2.0).expect("a time");
            let body = RigidBodyState::new(inertia).expect("a body");
            let mut y = body.state(m.into(), Matrix3::identity()).expect("a state");
            Taylor::<16>.advance(&body, 4.0, 1e-16, &mut 0.1, &mut y).expect("a run");
            for (m, g) in [(again_m, again_g), (y.m, y.g)] {
                let gap = (m - end_m).norm() + (g - end_g).norm();
                assert!(gap < 3e-13, "{inertia:?}, {m:?}: {gap:e}");
                worst = worst.max(gap);
            }
        }
    }
    println!("worst {worst:.1e}");
}

/// Within 3 times what one ulp of the input changes, plus 3e-14 (of |m|, and of g).
#[test]
fn momentum_and_attitude_at_every_reference() {
    let motions = motions("");
    assert!(motions.len() >= 100);
    let mut failures = Vec::new();
    for case in &motions {
        let g0 = case.attitude0.unwrap_or_else(Matrix3::identity);
        let body = Exact::new(case.inertia, case.momentum, g0).expect("a valid body");
        let (m, g) = body.state(case.t).expect("a state");
        let (m_ref, g_ref) = (case.m, case.g);
        let scale = m_ref.amax().max(f64::MIN_POSITIVE);
        let error_m = ((m - m_ref) / scale).norm();
        let error_g = (g - g_ref).norm();
        let bound_m = 3.0 * case.ulp[0] / scale + 3e-14;
        let bound_g = 3.0 * case.ulp[1] + 3e-14;
        eprintln!(
            "{:40} m {error_m:.1e} ({:.2})  g {error_g:.1e} ({:.2})",
            case.id,
            error_m / bound_m,
            error_g / bound_g
        );
        if !(error_m <= bound_m && error_g <= bound_g) {
            failures.push(&case.id);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// The phase of a late time has no digit, and the attitude is a rotation all the same.
#[test]
fn a_late_time_is_a_rotation() {
    for inertia in [[1.0, 2.0, 2.5], [1.0, 1.0, 2.0], [3.0, 2.0, 1.0]] {
        let motion = Exact::new(inertia, [0.2, 0.3, 1.0], Matrix3::identity()).expect("a body");
        for t in [1e9, 1e12, 1e14, 1e15, 1e16, 1e18, 1e20, -1e17] {
            let (m, g) = motion.state(t).expect("a state");
            let defect = (g.tr_mul(&g) - Matrix3::identity()).norm();
            assert!(defect < 1e-13, "{inertia:?} at {t:e}: {defect:e}");
            assert!((m.norm() - 1.13f64.sqrt()).abs() < 1e-13, "{inertia:?} at {t:e}: {m:?}");
        }
    }
}

/// Two moments that nearly agree, near the separatrix: a flat body that tumbles about an axis close to the middle one. Lie series
/// in short steps have the motion, and what one ulp of the input changes.
#[test]
fn moments_that_nearly_agree() {
    let by_series = |inertia: [f64; 3], m: Vector3<f64>| {
        let body = RigidBodyState::new(inertia).expect("a body");
        let mut y = body.state(m.into(), Matrix3::identity()).expect("a state");
        Taylor::<16>.advance(&body, 3.0, 1e-16, &mut 0.05, &mut y).expect("a run");
        (y.m, y.g)
    };
    for exponent in 1..=16 {
        let gap = 10f64.powi(-exponent);
        let bodies = [
            [1.0, 1.0 + gap, 1.5],
            [1.5, 1.0 + gap, 1.0],
            [1.0, 1.5, 1.0 + gap],
            [1.0, 1.5, 1.5 - gap],
            [1.0, 2.0, 2.0 * (1.0 - gap)],
        ];
        let rates = [
            [1e-9, 1.0, 0.0],
            [-0.0019, -1.0, 0.0],
            [-0.99995, 0.01, 0.0],
            [0.3, 0.7, 1e-6],
            [1e-5, 1e-7, 1.0],
        ];
        for (inertia, omega) in bodies.iter().flat_map(|j| rates.iter().map(move |w| (*j, w))) {
            let m = Vector3::from_fn(|i, _| inertia[i] * omega[i]);
            let motion = Exact::new(inertia, m.into(), Matrix3::identity()).expect("a body");
            let right = by_series(inertia, m);
            let far = |(end, g): (Vector3<f64>, Matrix3<f64>)| {
                (end - right.0).norm() / m.norm() + (g - right.1).norm()
            };
            let mut of_an_ulp = 0.0f64;
            for i in 0..3 {
                let (mut inertia, mut m) = (inertia, m);
                inertia[i] = inertia[i].next_up();
                of_an_ulp = of_an_ulp.max(far(by_series(inertia, m)));
                m[i] = m[i].next_up();
                of_an_ulp = of_an_ulp.max(far(by_series(inertia, m)));
            }
            let error = far(motion.state(3.0).expect("a time"));
            assert!(error < 6e-14 + 3.0 * of_an_ulp, "{inertia:?}, {omega:?}: {error:e}");
        }
    }
}

/// Numbers that leave the range of f64 are an error and no NaN.
#[test]
fn motions_out_of_range_are_refused() {
    for (inertia, m, t) in [
        ([1e-200, 1e200, 1e200], [1.0, 1.0, 1.0], 1.0),
        ([1.0, 2.0, 3.0], [1e308, 1.7e308, 1.7e308], 1e-300),
        ([1e-160, 1.0, 1.0], [1e160, 1.0, 1.0], 1.0),
    ] {
        let Ok(motion) = Exact::new(inertia, m, Matrix3::identity()) else { continue };
        let is_finite = |m: &Vector3<f64>| m.iter().all(|x| x.is_finite());
        assert!(motion.momentum_body(t).as_ref().map_or(true, is_finite), "{inertia:?}");
        let state = motion.state(t);
        let numbers =
            |(m, g): &(Vector3<f64>, Matrix3<f64>)| is_finite(m) && g.iter().all(|x| x.is_finite());
        assert!(state.as_ref().map_or(true, numbers), "{inertia:?}: {state:?}");
    }
}
