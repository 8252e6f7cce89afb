//! The solution at all times as numbers, and runs that share their problem.

use core::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use lieflow::actions::LeftTranslation;
use lieflow::catalog::MethodsByName;
use lieflow::groups::{Sample, So3};
use lieflow::methods::{AnyMethod, LieSeries};
use lieflow::problems::{DynFlow, Flow, Problem, RigidBody, RigidBodyN, TimeAlone};
use lieflow::solve::{Continuous, Integrator, Interpolant, RunError};
use lieflow::{Error, Event, Solve};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

type Rotations = DynFlow<So3, LeftTranslation, TimeAlone>;

/// The attitude of a free body, and the number of calls of f.
fn attitudes() -> (Rotations, Arc<AtomicU64>) {
    let calls = Arc::new(AtomicU64::new(0));
    let count = calls.clone();
    let field = move |_: f64, g: &Matrix3<f64>, v: &mut Vector3<f64>| {
        count.fetch_add(1, Ordering::Relaxed);
        let omega = (g.transpose() * Vector3::new(0.3, 2.75, 2.75))
            .component_div(&Vector3::new(1.0, 4.0, 18.0));
        *v = g * omega;
    };
    (DynFlow::new(Flow::new(So3::new(), LeftTranslation, field), LeftTranslation), calls)
}

/// An event that changes the state goes on from a point on M, also where the points within a step have left it.
#[test]
fn a_change_within_a_step_begins_on_the_manifold() {
    use lieflow::groups::LieGroup;
    use lieflow::maps::Exp;
    use lieflow::methods::{GAUSS4, Gauss, Rkmk, tableau::RK4};
    let (body, _) = attitudes();
    let start = Matrix3::identity();
    // At a zero of one number of the attitude, it turns by half a turn in the body.
    let half = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0));
    macro_rules! run {
        ($method:expr, $h:expr) => {{
            let method = $method;
            let turned = Event::new("turn", |_, g: &Matrix3<f64>| g[(0, 0)] - 0.4);
            let turned = turned.stop_after(2).change(move |_, g: &mut Matrix3<f64>| *g *= half);
            let solve = Solve::new(&body, &method, [0.0, 20.0]).dt($h).event(turned);
            solve.run(start).expect("a run")
        }};
    }
    let exact = run!(Rkmk::new(RK4, Exp), 1e-3);
    let mut before: Option<f64> = None;
    for h in [0.2, 0.1, 0.05] {
        let run = run!(Gauss(GAUSS4), h);
        assert!(So3::<f64>::new().defect(&run.y) < 1e-12, "{h}: {:e}", So3::new().defect(&run.y));
        let off = (run.y - exact.y).norm();
        // Not the points within a step: 1e-3 of them in M would not be seen as 1e-6.
        assert!(before.is_none_or(|before| off < 0.2 * before) && off < 0.2, "{h}: {off:e}");
        before = Some(off);
    }
}

fn assert_moves<T: Send + 'static>(_: &T) {}
fn assert_shared<T: Send + Sync + 'static>(_: &T) {}

/// The last stage of DOPRI5 and BS3 is f at the end of the step. Dense output takes it from there.
#[test]
fn dense_output_evaluates_only_what_the_step_has_not() {
    for (name, each) in [
        ("rkmk dopri5 exp", 0),
        ("rkmk bs3 cay", 0),
        ("rk dopri5", 0),
        ("rk bs3", 0),
        ("rkmk verner6 exp", 4),
        ("rkmk dop853 exp", 4),
        ("rk dop853", 4),
    ] {
        let (problem, calls) = attitudes();
        let method = problem.method(&name.parse().expect(name)).expect(name);
        let run = |times: Option<&[f64]>| {
            let solve = Solve::new(&problem, &method, [1.0, 4.0]).tolerances(1e-6, 1e-6);
            let solve = match times {
                Some(times) => solve.times(times),
                None => solve.every(1),
            };
            let before = calls.load(Ordering::Relaxed);
            let run = solve.run(Matrix3::identity()).expect(name);
            (calls.load(Ordering::Relaxed) - before, run)
        };
        let (called, steps) = run(None);
        let within: Vec<f64> = steps.times.windows(2).map(|t| 0.7 * t[0] + 0.3 * t[1]).collect();
        let (called_more, rows) = run(Some(&within));
        assert_eq!((rows.y, rows.stats.points_within), (steps.y, steps.stats.accepted), "{name}");
        let more = each * steps.stats.accepted;
        assert_eq!(called_more - called, more, "{name}");
        let counted = [&rows, &steps].map(|run| run.stats.evaluations.expect("known"));
        assert_eq!(counted[0] - counted[1], more, "{name}");
    }
}

/// With these methods the points of the interpolant are those of dense output, and f is not called for them.
#[test]
fn the_interpolant_is_dense_output_without_f() {
    for (name, adaptive) in [
        ("rkmk dop853 exp", true),
        ("rkmk verner6 exp", true),
        ("rkmk dopri5 cay", true),
        ("rkmk bs3 exp", true),
        ("rkmk dopri5 ccsk123", true),
        ("rkmk rk4 exp", false),
        ("rkmk-gauss4", false),
        ("rkmk-gauss4-symmetric", false),
        ("rk dop853", true),
        ("gauss4", false),
    ] {
        let (problem, calls) = attitudes();
        let spec = name.parse().expect(name);
        let method: AnyMethod<'static, _> = problem.method(&spec).expect(name);
        let (problem, method) = (Arc::new(problem), Arc::new(method));
        let solve = || {
            let solve = Solve::shared(problem.clone(), method.clone(), [1.0, 4.0]);
            if adaptive { solve.tolerances(1e-5, 1e-5) } else { solve.steps(40) }
        };
        let mut dense: Continuous<'static, _, _> =
            solve().run_continuous(Matrix3::identity()).expect(name);
        let (run, curve): (_, Interpolant<'static, _, _>) =
            solve().run_interpolant(Matrix3::identity()).expect(name);
        assert_moves(&dense);
        assert_shared(&curve);
        assert_eq!(run.y, dense.solution.y, "{name}");
        assert_eq!(curve.steps() as u64, run.stats.accepted, "{name}");
        let before = calls.load(Ordering::Relaxed);
        let again = Interpolant::from_numbers(problem.clone(), method, &run.y, &curve.numbers())
            .expect(name);
        let (mut reader, mut copy) =
            (curve.reader().expect("a reader"), again.reader().expect("a reader"));
        let times = (0..=300).map(|i| 1.0 + 3.0 * f64::from(i * 37 % 301) / 300.0);
        let points: Vec<_> =
            times.map(|t| (t, *reader.at(t).expect(name), *copy.at(t).expect(name))).collect();
        assert_eq!(calls.load(Ordering::Relaxed), before, "{name}: f is not called");
        for (t, point, copy) in points {
            let beside = dense.at(t).expect(name);
            let gap = (point - beside).norm();
            assert!(gap < 2e-14, "{name} at {t}: {gap:e}");
            assert_eq!(point, copy, "{name} at {t}");
        }
    }
}

/// The terms of a Lie series are its dense output.
#[test]
fn a_lie_series_is_dense_output_without_f() {
    let body = Arc::new(RigidBodyN::manakov(&[1.0, 2.5, 3.0, 4.5, 6.0]).expect("a body"));
    let start = {
        let mut rng = Pcg64::seed_from_u64(5);
        body.group().sample_algebra(&mut rng, 1.0).into_mat()
    };
    for order in [6, 12, 16] {
        let method = Arc::new(LieSeries::new(order).expect("a method"));
        for end in [4.0, -4.0] {
            let solve =
                || Solve::shared(body.clone(), method.clone(), [0.0, end]).tolerances(1e-7, 1e-7);
            let mut dense = solve().run_continuous(start.clone()).expect("a run");
            let (run, curve) = solve().run_interpolant(start.clone()).expect("a run");
            assert!(run.stats.accepted > 1);
            let numbers = curve.numbers();
            let again = Interpolant::from_numbers(body.clone(), method.clone(), &run.y, &numbers)
                .expect("it");
            let (mut reader, mut copy) =
                (curve.reader().expect("a reader"), again.reader().expect("a reader"));
            for t in (0..=200).map(|i| end * f64::from(i * 37 % 201) / 200.0) {
                let point = reader.at(t).expect("a point").clone();
                assert_eq!(&point, copy.at(t).expect("a point"), "order {order} at {t}");
                let gap = (&point - dense.at(t).expect("a point")).norm_l2();
                assert!(gap < 2e-14 * point.norm_l2(), "order {order} at {t}: {gap:e}");
            }
            let short = &numbers[..numbers.len() - 1];
            assert!(
                Interpolant::from_numbers(body.clone(), method.clone(), &run.y, short).is_err()
            );
        }
    }
}

/// Events that cut a step cut its polynomial, too, and a run backward has the same points.
#[test]
fn the_interpolant_ends_at_events_and_runs_backward() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let start = Vector3::new(0.2, 0.1, 3.0);
    for (name, end) in ["rkmk dop853 exp", "taylor16"].iter().flat_map(|n| [(n, 30.0), (n, -30.0)])
    {
        let method = body.method(&name.parse().expect("a method")).expect("it fits");
        let kick = Event::new("kick", |_, m: &Vector3<f64>| m[1])
            .change(|_, m: &mut Vector3<f64>| m[2] = -m[2]);
        let (run, curve) = Solve::new(&body, &method, [0.0, end])
            .tolerances(1e-9, 1e-12)
            .event(kick)
            .every(1)
            .run_interpolant(start)
            .expect("a run");
        assert!(run.events.len() > 3);
        let mut reader = curve.reader().expect("a reader");
        for (t, m) in run.times.iter().zip(&run.points) {
            let gap = (reader.at(*t).expect("a point") - m).norm();
            assert!(gap < 1e-12, "t = {t}: {gap:e}");
        }
        for event in &run.events {
            let early = event.t - 1e-9 * end;
            let gap = (reader.at(early).expect("a point") - event.y).norm();
            assert!(gap < 1e-6, "before the kick: {gap:e}");
        }
        assert!(matches!(
            reader.at(1.01 * end).map(|_| ()),
            Err(RunError::Setup(Error::OutOfRange { .. }))
        ));
    }
}

/// A method whose points within a step are shorter steps is refused, with methods that can be used.
#[test]
fn a_method_without_polynomials_is_refused() {
    let (problem, _) = attitudes();
    for name in ["cf4", "rkmk rk4 exp"] {
        let method = problem.method(&name.parse().expect(name)).expect(name);
        let solve = Solve::new(&problem, &method, [0.0, 1.0]).tolerances(1e-6, 1e-6);
        let error = solve.run_interpolant(Matrix3::identity()).map(drop).expect_err(name);
        assert!(error.to_string().contains("dop853"), "{error}");
    }
}

/// A shared run moves to another thread.
#[test]
fn a_shared_run_may_move() {
    let (problem, _) = attitudes();
    let method = problem.method(&"rkmk dop853 exp".parse().expect("a method")).expect("it fits");
    let solve =
        Solve::shared(Arc::new(problem), Arc::new(method), [0.0, PI]).tolerances(1e-9, 1e-12);
    let mut run: Integrator<'static, _, _> = solve.integrator(Matrix3::identity()).expect("a run");
    let moved = std::thread::spawn(move || *run.advance_to(PI).expect("a run"));
    let (problem, _) = attitudes();
    let method = problem.method(&"rkmk dop853 exp".parse().expect("a method")).expect("it fits");
    let beside = Solve::new(&problem, &method, [0.0, PI])
        .tolerances(1e-9, 1e-12)
        .run(Matrix3::identity())
        .expect("a run");
    assert_eq!(moved.join().expect("a thread"), beside.y);
}

/// One step of the exact motion goes as far as the span, also with tolerances.
#[test]
fn the_exact_motion_by_tolerance_is_one_step() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let method = body.method(&"exact".parse().expect("a method")).expect("it fits");
    let run = Solve::new(&body, &method, [0.0, 1e4])
        .tolerances(1e-10, 1e-10)
        .run(Vector3::new(0.2, 0.0, 3.0))
        .expect("a run");
    assert_eq!(run.stats.accepted, 1);
}
