//! Hard cases of events (T13), of stops, of states that are changed within a run, and of what is left of one that failed (T14).

use core::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{GroupMatrix, MatrixGroup, So3};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::{DOP853, DOPRI5, EULER, RK4};
use lieflow::methods::{ExactMotion, Rk, Rkmk};
use lieflow::problems::{IsospectralFlow, RigidBodyAttitude, toda_lattice};
use lieflow::solve::{Next, Status};
use lieflow::{Error, Event, RunError, SaveAt, Solve};
use nalgebra::Matrix3;

use crate::hard_cases::{START, body, spin};
use crate::modes::V;
use crate::scipy::{free, rational, rational_at};
use crate::support::boxed::boxed_of_time;

#[test]
fn an_event_that_stops_before_its_first_zero_is_refused() {
    let event = Event::new("never", |_, m: &V| m.y).stop_after(0);
    let failed = Solve::new(&body(), &Rkmk::new(DOPRI5, Exp), [0.0, 1.0])
        .tolerances(1e-6, 1e-6)
        .event(event)
        .run(START)
        .expect_err("a count");
    assert!(matches!(failed.error, RunError::Setup(_)), "{failed}");
    assert!(failed.to_string().contains("`never` = 0, expected at least 1"), "{failed}");
}

/// T13: what is found where.
#[test]
fn t13_events_in_odd_places() {
    // x = t on T(3), with steps of one size: a zero at any place of a step.
    let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x());
    let method = Rk(DOPRI5);
    let find = |g: Box<dyn Fn(f64) -> f64>, points: Option<u32>, change: bool| {
        let event = Event::new("g", move |t, _: &V| g(t));
        let event = if change { event.change(|_, _| {}) } else { event };
        let event = if let Some(points) = points { event.points(points) } else { event };
        let run = Solve::new(&problem, &method, [0.0, 4.0]).dt(0.5).event(event).run(V::zeros());
        run.expect("a run").events.iter().map(|found| (found.t, found.rising)).collect::<Vec<_>>()
    };
    let near = |found: &[(f64, bool)], expected: &[(f64, bool)]| {
        let same = found.len() == expected.len()
            && found.iter().zip(expected).all(|(a, b)| (a.0 - b.0).abs() < 1e-12 && a.1 == b.1);
        assert!(same, "{found:?}, expected {expected:?}");
    };
    for change in [false, true] {
        // At the start, at the ends of steps, at the end, in the middle.
        near(&find(Box::new(|x| x), None, change), &[(0.0, true)]);
        near(&find(Box::new(|x| -x), None, change), &[(0.0, false)]);
        near(&find(Box::new(|x| x), Some(0), change), &[(0.0, true)]);
        near(&find(Box::new(|x| -x), Some(0), change), &[(0.0, false)]);
        near(&find(Box::new(|x| x - 1.5), None, change), &[(1.5, true)]);
        near(&find(Box::new(|x| 4.0 - x), None, change), &[(4.0, false)]);
        near(&find(Box::new(|x| x - 1.7), None, change), &[(1.7, true)]);
        // Two and three in one step.
        near(
            &find(Box::new(|x| (x - 1.6) * (x - 1.8)), None, change),
            &[(1.6, false), (1.8, true)],
        );
        near(
            &find(Box::new(|x| (x - 1.6) * (x - 1.7) * (x - 1.85)), None, change),
            &[(1.6, true), (1.7, false), (1.85, true)],
        );
        // In the first step, where nothing is known of the one before.
        near(
            &find(Box::new(|x| (x - 0.1) * (x - 0.4)), None, change),
            &[(0.1, false), (0.4, true)],
        );
        // At the start and soon after.
        near(&find(Box::new(|x| x * (x - 0.05)), None, change), &[(0.0, false), (0.05, true)]);
        // A jump of g is found like a zero.
        near(&find(Box::new(|x| if x < 1.7 { -1.0 } else { 1.0 }), None, change), &[(1.7, true)]);
        // From where on g is 0, whatever lies between.
        near(&find(Box::new(|x| (1.7 - x).max(0.0)), None, change), &[(1.7, false)]);
        near(&find(Box::new(|x| if x < 1.7 { -1.0 } else { 0.0 }), None, change), &[(1.7, true)]);
        // Two that are close are found by polynomials, or with enough points.
        let close = || Box::new(|x: f64| (x - 1.6).powi(2) - 1e-6);
        near(&find(close(), None, change), &[(1.599, false), (1.601, true)]);
        near(&find(close(), Some(0), change), &[]);
        near(&find(close(), Some(1000), change), &[(1.599, false), (1.601, true)]);
        // A zero that turns back is none, and one that is hit exactly is one.
        near(&find(Box::new(|x| (x - 1.6).powi(2)), None, change), &[]);
        near(&find(Box::new(|x| (x - 1.5).powi(2)), None, change), &[(1.5, false)]);
        // Always 0: never.
        near(&find(Box::new(|_| 0.0), None, change), &[]);
    }
}

/// Zeros at one time: all are told, in their order, and one that stops does not hide another that changes.
#[test]
fn t13_events_at_one_time() {
    let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x());
    let method = Rk(DOPRI5);
    let calls = Cell::new(0);
    let run = Solve::new(&problem, &method, [0.0, 4.0])
        .tolerances(1e-6, 1e-6)
        .event(Event::new("first", |_, y: &V| y.x - 1.0).stop_after(1))
        .event(Event::new("second", |_, y: &V| 2.0 - 2.0 * y.x).change(|_, y: &mut V| {
            calls.set(calls.get() + 1);
            y.y = 7.0;
        }))
        .event(Event::new("third", |t, _: &V| t - 1.0))
        .every(1)
        .run(V::zeros())
        .expect("a run");
    let found: Vec<usize> = run.events.iter().map(|found| found.event).collect();
    assert_eq!((found, calls.get()), (vec![0, 1, 2], 1));
    assert_eq!(run.status, Status::Event("first".into()));
    assert!(
        (run.t - 1.0).abs() < 1e-14
            && run.y.y == 7.0
            && run.events.iter().all(|found| found.y.y == 0.0)
    );
    assert_eq!(run.points.last(), Some(&run.y));
    // One that changes the state hides no zero a little later.
    for later in [1e-3, 1e-6, 1e-9, 1e-12] {
        let run = Solve::new(&problem, &method, [0.0, 4.0])
            .dt(0.5)
            .event(Event::new("first", |_, y: &V| y.x - 1.25).change(|_, _| {}))
            .event(Event::new("second", move |_, y: &V| y.x - 1.25 - later).stop_after(1))
            .run(V::zeros())
            .expect("a run");
        let found: Vec<usize> = run.events.iter().map(|found| found.event).collect();
        assert_eq!(found, [0, 1], "{later}");
        assert!((run.t - 1.25 - later).abs() < 1e-15);
    }
    // The other direction of a zero that was passed is not found at the same time.
    let run = Solve::new(&problem, &method, [0.0, 4.0])
        .dt(0.5)
        .event(
            Event::new("falls", |_, y: &V| 1.3 - y.x).falling().change(|_, y: &mut V| y.z += 1.0),
        )
        .event(Event::new("rises", |_, y: &V| 1.3 - y.x).rising())
        .run(V::zeros())
        .expect("a run");
    assert_eq!(run.events.len(), 1, "{:?}", run.events);
}

#[test]
fn t13_an_event_that_is_not_a_number_is_named() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    for bad in [f64::NAN, f64::INFINITY] {
        for from in [0.0, 1.7] {
            let run = Solve::new(&body, &method, [0.0, 4.0])
                .dt(0.5)
                .every(1)
                .event(Event::new("fine", |_, m: &V| m.x))
                .event(Event::new(
                    "log of what is not there",
                    move |t, _: &V| if t < from { 1.0 } else { bad },
                ))
                .run(START)
                .expect_err("no number");
            match &run.error {
                RunError::Event { name, t, value } => {
                    assert_eq!(name, "log of what is not there");
                    assert!((from..from + 0.5).contains(t) && !value.is_finite());
                }
                other => panic!("{other}"),
            }
            let known = run.solution.expect("what was known");
            assert_eq!(known.times.is_empty(), from == 0.0);
            assert!(known.t <= 2.0);
        }
    }
}

/// Stops: whatever cuts a step before one, it is still there, and one that is given twice changes nothing.
#[test]
fn stops_are_kept() {
    let ends = Cell::new(Vec::new());
    let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x());
    let method = Rk(DOPRI5);
    for (span, forward) in [([0.0, 4.0], true), ([4.0, 0.0], false)] {
        for adaptive in [false, true] {
            let solve = Solve::new(&problem, &method, span)
                .every(1)
                .stops([3.3, 1.2, 1.2, 9.0, -1.0, 0.0, 4.0, 2.6]);
            let solve = if adaptive { solve.tolerances(1e-6, 1e-6) } else { solve.dt(0.7) };
            let run = solve
                .event(Event::new("cut", |t, _: &V| t - 2.3).change(|_, _| {}))
                .event(Event::new("count", |t, _: &V| t - 1.2))
                .event(Event::new("count", |t, _: &V| t - 1.1))
                .run(V::zeros())
                .expect("a run");
            assert!([1.2, 2.6, 3.3].iter().all(|stop| run.times.contains(stop)), "{:?}", run.times);
            assert!(run.times.windows(2).all(|t| if forward { t[0] < t[1] } else { t[0] > t[1] }));
            assert_eq!(run.events.len(), 3, "{:?}", run.events);
            assert!((run.y.x - (span[1] - span[0])).abs() < 1e-14);
            ends.set(run.times);
        }
    }
    // A jump of f at a stop is met by no step: one step on each side is exact.
    let jump = |t: f64| if t < 1.3 { 1.0 } else { -5.0 };
    let problem =
        boxed_of_time(free(), LeftTranslation, move |t: f64, v: &mut V| *v = V::x() * jump(t));
    let run = |stops: Vec<f64>| {
        let solve = Solve::new(&problem, &method, [0.0, 2.0]).tolerances(1e-10, 1e-10).stops(stops);
        solve.run(V::zeros()).expect("a run")
    };
    let (with, without) = (run(vec![1.3]), run(vec![]));
    assert!((with.y.x - (1.3 - 3.5)).abs() < 1e-9, "{}", with.y.x);
    assert!(
        2 * with.stats.rejected < without.stats.rejected,
        "{:?} {:?}",
        with.stats,
        without.stats
    );
}

#[test]
fn a_run_is_cancelled() {
    let (body, method) = (body(), Rk(DOPRI5));
    for (adaptive, every) in [(true, 1), (false, 1), (true, u64::MAX), (false, u64::MAX)] {
        let (flag, calls_after) = (AtomicBool::new(false), AtomicU64::new(0));
        // The flag is set from within f, at t > 3: nothing is observed, and nothing is taken back to M.
        let problem = boxed_of_time(free(), LeftTranslation, |t: f64, v: &mut V| {
            if t > 3.0 {
                flag.store(true, Ordering::Relaxed);
            }
            calls_after.fetch_add(u64::from(flag.load(Ordering::Relaxed)), Ordering::Relaxed);
            *v = V::x() * (9.0 * t).cos();
        });
        // An end that is not reached, or none.
        let end = if every == 1 { f64::INFINITY } else { 1e3 };
        let solve = Solve::new(&problem, &method, [0.0, end]).cancel(&flag).every(every);
        let solve = if adaptive { solve.tolerances(1e-9, 1e-9) } else { solve.dt(0.001) };
        let run = solve.run(START).expect("a run");
        assert_eq!(run.status, Status::Cancelled);
        // Within a thousand steps of at most seven stages.
        let calls_after = calls_after.load(Ordering::Relaxed);
        assert!(calls_after <= 1001 * 7, "{calls_after} calls of f");
        assert!(run.t >= 3.0 - 1.0 && (adaptive || run.t < 4.1), "{}", run.t);
        if every == 1 {
            assert_eq!(run.times.last(), Some(&run.t));
        }
    }
    let flag = AtomicBool::new(true);
    let run =
        Solve::new(&body, &method, [0.0, 1.0]).dt(0.1).cancel(&flag).run(START).expect("a run");
    assert_eq!((run.status, run.stats.accepted, run.y), (Status::Cancelled, 0, START));
}

/// A step of any length may have many rows, and a field may be slow: the flag is read between rows, and by time.
#[test]
fn a_run_is_cancelled_between_rows_and_between_slow_steps() {
    let body = body();
    let (flag, mut rows) = (AtomicBool::new(false), 0);
    let run = Solve::new(&body, &ExactMotion, [0.0, 1e4])
        .tolerances(1e-9, 1e-9)
        .count(1_000_000)
        .cancel(&flag)
        .run_with(START, |_, _| {
            rows += 1;
            flag.store(rows == 100, Ordering::Relaxed);
        })
        .expect("a run");
    assert_eq!((run.status, rows, run.stats.accepted), (Status::Cancelled, 100, 1));

    let flag = AtomicBool::new(false);
    let slow = boxed_of_time(free(), LeftTranslation, |t: f64, v: &mut V| {
        std::thread::sleep(Duration::from_millis(2));
        flag.store(t > 2.0, Ordering::Relaxed);
        *v = V::x();
    });
    let run = Solve::new(&slow, &Rk(EULER), [0.0, 1e6]).dt(0.1).cancel(&flag).run(START);
    let run = run.expect("a run");
    assert!(run.status == Status::Cancelled && run.t < 6.0, "{:?} at {}", run.status, run.t);
}

/// Adaptive steps of a method without an error: one step, or steps that turn by a radian where events are looked for.
#[test]
fn exact_steps() {
    let body = body();
    let start = V::new(0.3, 2.0, 0.3);
    let solve = |t1: f64| Solve::new(&body, &ExactMotion, [0.0, t1]).tolerances(1e-10, 0.0);
    let flip = || Event::new("flip", |_, m: &V| m.y);
    let run = solve(200.0).count(400).run(start).expect("a run");
    assert_eq!((run.stats.accepted, run.stats.rejected, run.times.len()), (1, 0, 401));
    let many = Solve::new(&body, &ExactMotion, [0.0, 200.0]).steps(400).every(1);
    let many = many.run(start).expect("a run");
    for (a, b) in run.points.iter().zip(&many.points) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
    let with_events = solve(200.0).event(flip()).run(start).expect("a run");
    let dopri = Rkmk::new(DOP853, Exp);
    let expected = Solve::new(&body, &dopri, [0.0, 200.0]).tolerances(1e-13, 1e-13);
    let expected = expected.event(flip()).run(start).expect("a run");
    assert_eq!(with_events.events.len(), expected.events.len());
    for (a, b) in with_events.events.iter().zip(&expected.events) {
        assert!((a.t - b.t).abs() < 1e-8, "{} {}", a.t, b.t);
    }
    let third = solve(f64::INFINITY).event(flip().stop_after(3)).run(start).expect("a run");
    assert!((third.t - expected.events[2].t).abs() < 1e-8);
}

#[test]
fn a_start_that_is_not_on_the_manifold_is_refused() {
    let body = RigidBodyAttitude::new([1.0, 2.0, 3.0], [0.3, 0.4, 2.0]).expect("a body");
    let method = Rkmk::new(DOPRI5, Exp);
    let one = Matrix3::<f64>::identity();
    let reflection = Matrix3::from_diagonal(&V::new(1.0, 1.0, -1.0));
    for start in [2.0 * one, reflection, one + Matrix3::repeat(1e-4), Matrix3::zeros()] {
        for adaptive in [true, false] {
            let solve = Solve::new(&body, &method, [0.0, 1.0]);
            let solve = if adaptive { solve.tolerances(1e-6, 1e-6) } else { solve.dt(0.1) };
            match solve.run(start).expect_err("not a rotation").error {
                RunError::Setup(Error::NotOnGroup { arg: "y", residual, tolerance, .. }) => {
                    assert!(residual > 1e-5 && tolerance == 1e-6, "{residual}");
                }
                other => panic!("{other}"),
            }
        }
    }
    // Seven digits are enough.
    let near = one + Matrix3::repeat(1e-8);
    Solve::new(&body, &method, [0.0, 1.0]).dt(0.1).run(near).expect("a run");
    let group = MatrixGroup::so(4).expect("SO(4)");
    let still = boxed_of_time(group, LeftTranslation, |_: f64, _: &mut _| {});
    let off =
        GroupMatrix::new_unchecked(Mat::from_fn(4, 4, |i, j| f64::from(2 * u8::from(i == j))));
    let refused = Solve::new(&still, &method, [0.0, 1.0]).dt(0.1).run(off).expect_err("2·𝟙");
    let text = refused.error.to_string();
    assert!(text.starts_with("y: not in SO(4): relative residual "), "{text}");
}

/// A problem on the sphere and one on vectors, both by hand: what a controller does.
#[test]
fn a_state_that_is_set() {
    let problem = rational();
    let method = Rk(DOPRI5);
    for adaptive in [true, false] {
        let solve = Solve::new(&problem, &method, [5.0, 9.0]);
        let solve = if adaptive { solve.tolerances(1e-10, 1e-10) } else { solve.dt(0.013) };
        let mut run = solve.integrator(V::zeros()).expect("a run");
        run.advance_to(5.5).expect("a state");
        run.set_state(&rational_at(5.5)).expect("a state");
        let mut at = V::zeros();
        assert!(run.interpolate(5.4999, &mut at).is_err(), "what was before is forgotten");
        run.interpolate(5.5, &mut at).expect("the state");
        assert_eq!(at, rational_at(5.5));
        for t in [6.0, 6.01, 7.7, 9.0] {
            let y = run.advance_to(t).expect("a state");
            assert!((y - rational_at(t)).norm() < 1e-8, "{t}");
        }
        assert!(run.is_done());
        let bad = V::repeat(f64::NAN);
        match run.set_state(&bad) {
            Err(RunError::Changed { by, t, source: Error::OutOfRange { .. } }) => {
                assert_eq!((by.as_str(), t), ("the caller", 9.0));
            }
            other => panic!("{other:?}"),
        }
        assert!((run.y() - rational_at(9.0)).norm() < 1e-8, "it is as it was");
    }
}

/// An event that ends the run is a point of the output, unless the times are given and no others.
#[test]
fn the_end_at_an_event_is_shown() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    let times = |save: SaveAt| {
        let solve = Solve::new(&body, &method, [0.0, 50.0]).tolerances(1e-9, 1e-9).save(save);
        let run = solve.event(Event::new("m2", |_, m: &V| m.y).stop_after(1)).run(START);
        let run = run.expect("a run");
        assert_eq!(run.status, Status::Event("m2".into()));
        (run.times, run.t)
    };
    let (given, end) = times(SaveAt::Times(vec![0.1, 40.0]));
    assert_eq!(given, [0.1]);
    assert_eq!(times(SaveAt::TimesAndEnds(vec![0.1, 40.0])), (vec![0.0, 0.1, end], end));
    assert_eq!(times(SaveAt::TimesAndEnds(vec![0.1, end])), (vec![0.0, 0.1, end], end));
}

/// What an observer changes is gone on from, and it is asked whether it is on M.
#[test]
fn an_observer_changes_the_state() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    for save in [SaveAt::Every(1), SaveAt::Times(vec![0.0, 0.77, 1.5])] {
        let run = Solve::new(&body, &method, [0.0, 2.0])
            .tolerances(1e-9, 1e-9)
            .save(save)
            .run_with(START, |t, m| {
                *m *= if t == 0.0 { 2.0 } else { 1.0 };
                if t == 0.0 { Next::Changed } else { Next::Continue }
            });
        let run = run.expect("a run");
        let twice = Solve::new(&body, &method, [0.0, 2.0])
            .tolerances(1e-9, 1e-9)
            .run(2.0 * START)
            .expect("a run");
        assert!((run.y - twice.y).norm() < 1e-7);
    }
    // A bad state is not that of the run.
    for t in [0.0, 0.77, 1.0] {
        let shown = Cell::new(V::zeros());
        let run = Solve::new(&body, &method, [0.0, 2.0]).dt(0.1).times([t]);
        let run = run.run_with(START, |_, m| {
            shown.set(*m);
            m.x = f64::NAN;
            Next::Changed
        });
        let failed = run.expect_err("not on M");
        assert!(failed.to_string().contains("the observer"), "{failed}");
        let known = failed.solution.expect("what was known");
        assert_eq!((known.t, known.y), (t, shown.get()));
    }
}

/// Zeros at the time of a change are told, whoever changes the state: the observer, or another event.
#[test]
fn a_change_hides_no_zero_at_the_same_time() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    for (span, at) in [([0.0, 2.0], 1.0), ([-1.0, 1.0], 0.0), ([3.0, -2.0], 0.1)] {
        for stops in [false, true] {
            let event = Event::new("clock", move |t: f64, _: &V| (t - at).sin());
            let event = if stops { event.stop_after(1) } else { event };
            let run = Solve::new(&body, &method, span).tolerances(1e-9, 1e-9).times([at]);
            let run = run.event(event).run_with(START, |_, m| {
                *m *= 2.0;
                Next::Changed
            });
            let run = run.expect("a run");
            assert_eq!(run.events.len(), 1, "{span:?}");
            assert_eq!((run.t == span[1], run.events[0].y == run.y), (!stops, stops));
            assert!(
                (run.events[0].t - at).abs() < 1e-15
                    && (run.y.norm() / START.norm() - 2.0).abs() < 1e-9
            );
        }
        let count = |name, g: fn(f64) -> f64| Event::new(name, move |t: f64, _: &V| g(t - at));
        let run = Solve::new(&body, &method, span)
            .tolerances(1e-9, 1e-9)
            .event(count("sine", f64::sin).change(|_, m: &mut V| *m *= 2.0))
            .event(count("exponential", f64::exp_m1))
            .event(count("tangent", |t| 3.0 * (t / 3.0).tan()));
        let run = run.run(START).expect("a run");
        let told = [0, 1, 2].map(|event| run.times_of(event).count());
        assert_eq!(told, [1, 1, 1], "{span:?}");
    }
}

#[test]
fn an_observer_that_changes_the_shape_of_a_matrix_is_refused() {
    let lattice = IsospectralFlow::toda(3).expect("a flow");
    let start = toda_lattice(&[0.0, 0.1, 0.3], &[0.3, 0.1, -0.2]).expect("a lattice");
    let method = Rkmk::new(RK4, Cay);
    let run = Solve::new(&lattice, &method, [0.0, 1.0]).dt(0.1).times([0.25]);
    let run = run.run_with(start, |_, l: &mut Mat<f64>| {
        *l = Mat::zeros(2, 2);
        Next::Changed
    });
    let failed = run.expect_err("another shape");
    assert!(failed.to_string().contains("the observer"), "{failed}");
    let known = failed.solution.expect("what was known");
    assert_eq!((known.t, known.y.nrows()), (0.25, 3));
}

/// What an observer writes has no effect where it does not say that it changed the state.
#[test]
fn an_observer_that_goes_on_changes_nothing() {
    let lattice = IsospectralFlow::toda(3).expect("a flow");
    let start = toda_lattice(&[0.0, 0.1, 0.3], &[0.3, 0.1, -0.2]).expect("a lattice");
    let method = Rkmk::new(RK4, Cay);
    let end = |write: &dyn Fn(&mut Mat<f64>)| {
        let run = Solve::new(&lattice, &method, [0.0, 1.0]).dt(0.1).times([0.25, 0.3, 0.47, 1.0]);
        let run = run.run_with(start.clone(), |_, l: &mut Mat<f64>| {
            write(l);
            Next::Continue
        });
        run.expect("a run").y
    };
    let right = end(&|_| {});
    assert!(end(&|l| *l = Mat::zeros(2, 2)) == right && end(&|l| l.fill(f64::NAN)) == right);
}

/// A reflection has orthonormal columns, and is no rotation.
#[test]
fn a_change_to_a_reflection_is_refused() {
    let at = nalgebra::Matrix3::from_diagonal(&V::new(1.0, 1.0, -1.0));
    let problem = boxed_of_time(So3::<f64>::new(), LeftTranslation, |_, v: &mut V| *v = V::x());
    let method = Rkmk::new(DOPRI5, Exp);
    let solve = Solve::new(&problem, &method, [0.0, 1.0]).tolerances(1e-8, 1e-8);
    let mut run = solve.integrator(nalgebra::Matrix3::identity()).expect("a run");
    assert!(matches!(run.set_state(&at), Err(RunError::Changed { .. })));
    assert_eq!(*run.y(), nalgebra::Matrix3::identity());
}

#[test]
fn t14_what_a_failed_run_leaves() {
    let problem = spin(|t| if t < 0.5 { 1.0 } else { f64::NAN });
    let method = Rkmk::new(DOPRI5, Exp);
    let exact = |t: f64| *nalgebra::Rotation3::new(V::new(0.6, 0.0, 0.8) * t).matrix() * V::y();
    for adaptive in [false, true] {
        for continuous in [false, true] {
            let solve = Solve::new(&problem, &method, [0.0, 1.0])
                .every(1)
                .event(Event::new("y", |_, x: &V| x.y - 0.9));
            let solve = if adaptive { solve.tolerances(1e-8, 1e-8) } else { solve.dt(0.06) };
            let failed = match continuous {
                false => solve.run(V::y()).map(drop),
                true => solve.run_continuous(V::y()).map(drop),
            };
            let failed = failed.expect_err("no field");
            let known = failed.solution.expect("what was known");
            let accepted = failed.error.accepted().expect("the number of steps");
            assert_eq!((known.stats.accepted, known.times.len() as u64), (accepted, accepted + 1));
            assert_eq!((known.times.last(), known.points.last()), (Some(&known.t), Some(&known.y)));
            assert_eq!(known.events.len(), 1);
            assert!(known.t < 0.5 && known.t > 0.4 && (known.y - exact(known.t)).norm() < 1e-6);
            let said = match &failed.error {
                RunError::Step(failure) => (failure.t, failure.h),
                RunError::StepSizeUnderflow { t, h, .. } => (*t, *h),
                other => panic!("{other}"),
            };
            assert!(said.0 == known.t && said.1 > 0.0);
        }
    }
    // In one call of the method, too.
    let failed =
        Solve::new(&problem, &method, [0.0, 1.0]).dt(0.001).run(V::y()).expect_err("no field");
    let known = failed.solution.expect("what was known");
    assert_eq!(known.stats.smallest_step, 0.001);
    assert_eq!(known.stats.accepted, 499);
    assert!((known.t - 0.499).abs() < 1e-12 && (known.y - exact(known.t)).norm() < 1e-10);
}

/// The end of a step that an event cuts is seen, because the point at the event is one within the step.
#[test]
fn the_end_of_a_step_that_is_cut_is_seen() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    let ends = |level: f64| {
        let ends = RefCell::new(Vec::new());
        let see = |t: f64, m: &V| ends.borrow_mut().push((t, *m));
        let event = Event::new("level", move |t: f64, _: &V| t - level).stop_after(1);
        let solve = Solve::new(&body, &method, [0.0, 2.0]).dt(0.5).event(event).ends_of_steps(see);
        let run = solve.run(START).unwrap();
        assert!((run.t - level).abs() < 1e-15);
        ends.into_inner()
    };
    let whole = Solve::new(&body, &method, [0.0, 1.0]).dt(0.5).run(START).unwrap();
    assert_eq!(ends(0.8), [(1.0, whole.y)]);
    assert_eq!(ends(1.0), []);
}

/// A pole that is a number is found, though g is infinite there.
#[test]
fn a_pole_at_a_number_is_found() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    for pole in [2.0, 2.1, 0.75, 3.0] {
        for span in [[0.0, 6.03], [6.03, 0.0]] {
            let run = Solve::new(&body, &method, span).tolerances(1e-9, 1e-9);
            let run = run.event(Event::new("pole", move |t: f64, _: &V| 1.0 / (t - pole)));
            let run = run.run(START).expect("a run");
            assert_eq!(run.times_of(0).count(), 1, "{pole}");
            assert!((run.events[0].t - pole).abs() < 1e-14, "{}", run.events[0].t);
        }
    }
}
