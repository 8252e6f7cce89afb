//! The driver: where it observes, where it lands, and what output between steps costs.

use std::cell::RefCell;

use lieflow::actions::Linear;
use lieflow::groups::So3;
use lieflow::maps::{CCSK, Cay, Exp};
use lieflow::methods::{Method, Rk, Rkmk, tableau::RK4};
use lieflow::problems::{Exact, Flow, RigidBody};
use lieflow::solve::Next;
use lieflow::{RunError, SaveAt, Solve, Stats, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

use super::says;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.5];
const START: [f64; 3] = [1.0, 0.8, -1.2];

fn body() -> RigidBody {
    RigidBody::new(INERTIA).unwrap()
}

type Run = (Stats, Vec<(f64, Vector3<f64>)>, Vector3<f64>);

fn run<M: Method<RigidBody>>(method: &M, grid: TimeGrid, save: SaveAt, start: Vector3<f64>) -> Run {
    let (mut y, mut seen) = (start, Vec::new());
    let stats = integrate(&body(), method, &grid, &save, &mut y, |t, m| seen.push((t, *m)));
    (stats.unwrap(), seen, y)
}

fn times_of(run: &Run) -> Vec<f64> {
    run.1.iter().map(|(t, _)| *t).collect()
}

#[test]
fn the_ends_are_observed_once_each() {
    let method = Rkmk::new(RK4, Exp);
    let seen = |save, span| {
        times_of(&run(&method, TimeGrid::with_steps(span, 4).unwrap(), save, START.into()))
    };
    let (forward, backward) = ([0.0, 1.0], [1.0, 0.0]);
    assert_eq!(seen(SaveAt::Ends, forward), [0.0, 1.0]);
    assert_eq!(seen(SaveAt::Every(1), forward), [0.0, 0.25, 0.5, 0.75, 1.0]);
    assert_eq!(seen(SaveAt::Every(3), forward), [0.0, 0.75, 1.0]);
    assert_eq!(seen(SaveAt::Every(9), forward), [0.0, 1.0]);
    assert_eq!(seen(SaveAt::End, forward), [1.0]);
    assert_eq!(seen(SaveAt::Times(vec![]), forward), [0.0; 0], "given times and no others");
    assert_eq!(seen(SaveAt::Times(vec![0.0, 0.3, 0.5, 1.0]), forward), [0.0, 0.3, 0.5, 1.0]);
    assert_eq!(seen(SaveAt::Times(vec![0.26, 0.27, 0.9]), forward), [0.26, 0.27, 0.9]);
    assert_eq!(seen(SaveAt::Times(vec![1.0, 0.9, 0.5, 0.1]), backward), [1.0, 0.9, 0.5, 0.1]);
    assert_eq!(seen(SaveAt::Every(2), backward), [1.0, 0.5, 0.0]);
    assert_eq!(seen(SaveAt::TimesAndEnds(vec![]), forward), [0.0, 1.0]);
    assert_eq!(seen(SaveAt::TimesAndEnds(vec![0.3]), forward), [0.0, 0.3, 1.0]);
    assert_eq!(seen(SaveAt::TimesAndEnds(vec![0.0, 0.5, 1.0]), forward), [0.0, 0.5, 1.0]);
    assert_eq!(seen(SaveAt::TimesAndEnds(vec![0.9, 0.2]), backward), [1.0, 0.9, 0.2, 0.0]);
}

#[test]
fn an_empty_span_returns_the_start() {
    let grid = TimeGrid::new([3.0, 3.0], 0.1).unwrap();
    for save in [SaveAt::End, SaveAt::Ends, SaveAt::Every(1), SaveAt::Times(vec![3.0])] {
        let done = run(&Rkmk::new(RK4, Exp), grid, save, START.into());
        assert_eq!((done.0.accepted, done.0.evaluations, done.2), (0, Some(0), START.into()));
        assert_eq!(times_of(&done), [3.0], "the start is the end");
    }
}

#[test]
fn the_last_step_lands_exactly() {
    for span in [[0.0, 0.7], [0.1, 1e3 + 0.1], [0.3, -0.4]] {
        let grid = TimeGrid::with_steps(span, 777).unwrap();
        let done = run(&Rkmk::new(RK4, Exp), grid, SaveAt::Every(100), START.into());
        assert_eq!(done.1.last().map(|(t, _)| *t), Some(span[1]));
        assert_eq!(done.1.last().map(|(_, m)| *m), Some(done.2));
        assert_eq!((done.0.accepted, done.0.points_within), (777, 0));
    }
}

/// A step of the right size to the end, also where it is nearly a whole one: a turn at the rate 1 is exact.
#[test]
fn a_shorter_last_step_goes_to_the_end() {
    let turn =
        Flow::of_time(So3::<f64>::new(), Linear, |_, v: &mut Vector3<f64>| *v = Vector3::z());
    for parts in [9.999_999_5, 10.000_000_5, 3.2, 0.4, 1.0 + 1e-7] {
        for span in [[0.0, 2.0], [2.0, 0.0]] {
            let grid = TimeGrid::new(span, 2.0 / parts).unwrap();
            let mut x = Vector3::x();
            integrate(&turn, &Rkmk::new(RK4, Exp), &grid, &SaveAt::End, &mut x, |_, _| {}).unwrap();
            let angle = span[1] - span[0];
            let gap = (x - Vector3::new(angle.cos(), angle.sin(), 0.0)).norm();
            assert!(gap < 1e-14, "{parts} steps over {span:?}: {gap:e}");
        }
    }
}

#[test]
fn forward_and_back_returns() {
    for h in [0.02, 0.01] {
        let there = TimeGrid::new([0.0, 2.0], h).unwrap();
        let back = TimeGrid::new([2.0, 0.0], h).unwrap();
        for gap in [
            round_trip(&Rkmk::new(RK4, Exp), there, back),
            round_trip(&Rkmk::new(RK4, Cay), there, back),
            round_trip(&Rkmk::new(RK4, CCSK), there, back),
            round_trip(&Rk(RK4), there, back),
        ] {
            // The errors of the two ways cancel to leading order: h⁴ bounds what is left.
            assert!(gap <= h.powi(4), "h = {h}: {gap:e}");
        }
    }
}

fn round_trip<M: Method<RigidBody>>(method: &M, there: TimeGrid, back: TimeGrid) -> f64 {
    let far = run(method, there, SaveAt::Ends, START.into()).2;
    assert!((far - Vector3::from(START)).norm() > 0.1, "it went nowhere");
    (run(method, back, SaveAt::Ends, far).2 - Vector3::from(START)).norm()
}

/// Output between steps leaves the run as it is, bit for bit, and is as accurate as the steps.
#[test]
fn side_steps_do_not_change_the_run() {
    fn check<M: Method<RigidBody>>(method: &M) {
        let body = body();
        let grid = TimeGrid::new([0.0, 3.0], 0.05).unwrap();
        let off_grid: Vec<f64> = (0..47).map(|k| 0.013 + 0.0631 * k as f64).collect();
        let plain = run(method, grid, SaveAt::Every(1), START.into());
        let mut dense = (Stats::default(), Vec::new(), Vector3::zeros());
        let solve = Solve::new(&body, method, [0.0; 2]).grid(grid).times(off_grid.clone());
        let done = solve.times_by_steps().run_with(START.into(), |t, m| dense.1.push((t, *m)));
        let done = done.unwrap();
        (dense.0, dense.2) = (done.stats, done.y);
        let bits = |m: &Vector3<f64>| m.map(f64::to_bits);
        assert_eq!(bits(&plain.2), bits(&dense.2), "the run itself");
        assert_eq!((dense.0.accepted, dense.0.points_within), (60, 47));

        let exact = Exact::new(INERTIA, START, Matrix3::identity()).unwrap();
        let worst = |run: &Run| -> f64 {
            let error =
                |(t, m): &(f64, Vector3<f64>)| (m - exact.momentum_body(*t).unwrap()).norm();
            run.1.iter().map(error).fold(0.0, f64::max)
        };
        assert!(worst(&plain) < 1e-6, "steps: {:e}", worst(&plain));
        assert!(worst(&dense) <= 1.5 * worst(&plain), "{:e} {:e}", worst(&dense), worst(&plain));
        for (t, m) in &dense.1 {
            let length = Vector3::from(START).norm();
            assert!((m.norm() - length).abs() < 1e-6, "|m| at {t}");
        }

        // An output time on the grid is the step itself, with nothing computed aside.
        let on_grid: Vec<f64> = (0..=60).map(|n| grid.time(n)).collect();
        let again = run(method, grid, SaveAt::Times(on_grid), START.into());
        assert_eq!(again.1, plain.1);
        assert_eq!(again.0.points_within, 0);
    }
    check(&Rkmk::new(RK4, Exp));
    check(&Rkmk::new(RK4, Cay));
    check(&Rkmk::new(RK4, CCSK)); // it alternates by the number of the step: side steps do not count
    check(&Rk(RK4));
}

#[test]
fn output_times_off_the_span_fail_before_anything_is_observed() {
    let grid = TimeGrid::new([0.0, 1.0], 0.5).unwrap();
    let mut m = Vector3::from(START);
    let save = SaveAt::Times(vec![0.2, 7.0]);
    let observe = |_, _: &Vector3<f64>| panic!("observed");
    let refused = integrate(&body(), &Rkmk::new(RK4, Exp), &grid, &save, &mut m, observe);
    assert!(matches!(refused, Err(RunError::Setup(_))));
    says(refused.unwrap_err(), &["times[1] = 7"]);
    assert_eq!(m, Vector3::from(START));
}

/// The end of a step is shown if rows stand within the step, once, and after them; forward and backward.
#[test]
fn the_ends_of_steps_with_rows() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
    let start = Vector3::new(0.3, 1.0, -0.5);
    let method = Rkmk::new(RK4, Exp);
    for sign in [1.0, -1.0] {
        let seen = RefCell::new(Vec::new());
        let times = [0.0, 0.1, 0.2, 0.25, 0.4, 0.8, 0.95].map(|t: f64| sign * t);
        let solve = Solve::new(&body, &method, [0.0, sign]).dt(0.2).times(times);
        let solve = solve.ends_of_steps(|t, y| seen.borrow_mut().push((t, *y)));
        let run = solve.run_with(start, |_, _| Next::Continue).unwrap();
        let seen = seen.into_inner();
        let expected = [0.2, 0.4, 1.0].map(|t: f64| sign * t);
        assert_eq!(seen.iter().map(|(t, _)| *t).collect::<Vec<_>>(), expected);
        assert_eq!(seen[2].1, run.y);
    }
}
