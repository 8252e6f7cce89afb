//! Steps by error are taken in streaks where their size is kept. A run has the same steps, to the last bit, wherever its
//! streaks end: at output times, at events, at the end of a call, or after each step.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

use lieflow::actions::Linear;
use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::groups::So3;
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5};
use lieflow::methods::{CommutatorFree, Embedded, Rk, Rkmk, Taylor};
use lieflow::nalgebra::Vector3;
use lieflow::problems::{RigidBody, RigidBodyAttitude};
use lieflow::solve::Status;
use lieflow::tolerance::Rule;
use lieflow::{Event, Problem, Solution, Solve};

use crate::support::boxed::boxed_flow;

type V = Vector3<f64>;

/// Beside the saddle: step sizes change and are kept in turns.
const START: V = V::new(0.01, 2.0, 0.01);
const TOLERANCE: f64 = 1e-8;

/// The numbers that say which steps a run had.
fn steps<Y: Copy>(run: &Solution<Y>) -> (Y, [u64; 2], [f64; 2]) {
    let stats = &run.stats;
    (run.y, [stats.accepted, stats.rejected], [stats.smallest_step, stats.largest_step])
}

fn same_steps<P, M, Y>(name: &str, problem: &P, method: &M, start: Y)
where
    P: Problem<Action: lieflow::actions::Action<P::Group, Point = Y>>,
    M: Embedded<P>,
    Y: Copy + PartialEq + core::fmt::Debug,
    <P::Group as lieflow::LieAlgebra>::Scalar: Into<f64>,
{
    for span in [[0.0, 60.0], [3.0, -50.0]] {
        let [t0, t1] = span;
        let solve = || Solve::new(problem, method, span).tolerances(TOLERANCE, TOLERANCE);
        let free = solve().run(start).expect("a run");
        assert!(free.stats.accepted > 20, "{name}: {:?}", free.stats);

        let mut single = solve().integrator(start).expect("a start");
        while !single.is_done() {
            single.step().expect("a step");
        }
        let stats = single.stats();
        assert_eq!(*single.y(), free.y, "{name}, one step a call");
        // Between two calls f may become another one: a stage that a step had from the one before is computed again.
        let again = if ["rk dopri5", "rk bs3"].contains(&name) { stats.accepted - 1 } else { 0 };
        assert_eq!(
            (stats.accepted, stats.rejected, stats.evaluations),
            (free.stats.accepted, free.stats.rejected, free.stats.evaluations.map(|n| n + again)),
            "{name}, one step a call"
        );

        let every = solve().every(1).run(start).expect("a run");
        assert_eq!(steps(&every).0, free.y, "{name}, with each step as a row");
        assert_eq!(steps(&every).1, steps(&free).1, "{name}, with each step as a row");
        assert_eq!(every.times.len() as u64, free.stats.accepted + 1, "{name}");

        let times: Vec<f64> = (1..=400).map(|i| t0 + (t1 - t0) * f64::from(i) / 400.0).collect();
        let rows = solve().times(&*times).run(start).expect("a run");
        assert_eq!(steps(&rows).0, free.y, "{name}, with 400 rows");
        assert_eq!(steps(&rows).1, steps(&free).1, "{name}, with 400 rows");

        let (looks, cancel) = (Cell::new(0), AtomicBool::new(false));
        let clock = Event::new("clock", |t: f64, _: &Y| {
            looks.set(looks.get() + 1);
            t - 1e3
        });
        let watched = solve().event(clock).cancel(&cancel).progress(|_| {}).run(start);
        let watched = watched.expect("a run");
        assert_eq!(steps(&watched).0, free.y, "{name}, with an event");
        assert_eq!(steps(&watched).1, steps(&free).1, "{name}, with an event");
        assert!(looks.get() > free.stats.accepted, "{name}: g at each end, {} looks", looks.get());
    }
}

#[test]
fn a_run_has_the_same_steps_however_it_is_watched() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    same_steps("rk dopri5", &body, &Rk(DOPRI5), START);
    same_steps("rk bs3", &body, &Rk(BS3), START);
    same_steps("rk dop853", &body, &Rk(DOP853), START);
    same_steps("rkmk dopri5 exp", &body, &Rkmk::new(DOPRI5, Exp), START);
    same_steps("rkmk dop853 cay", &body, &Rkmk::new(DOP853, Cay), START);
    same_steps("taylor16", &body, &Taylor::<16>, START);
    for name in ["rkmk dop853 exp", "rk dopri5", "taylor12", "mr4", "cf4"] {
        let spec: MethodSpec = name.parse().expect("a name");
        same_steps(name, &body, &body.method(&spec).expect("a method"), START);
    }
    let attitude = RigidBodyAttitude::<f64>::new([1.0, 2.0, 3.0], START.into()).expect("a body");
    let one = lieflow::nalgebra::Matrix3::identity();
    same_steps("attitude", &attitude, &Rkmk::new(DOPRI5, Exp), one);
}

/// The step after a stop has its stages a rounding later, and its size is that between its ends.
#[test]
fn stops_have_the_same_steps_however_a_run_is_watched() {
    for t0 in [0.0, 1e3, 1e6] {
        let jump = t0 + 1.242_540_74;
        let turn = boxed_flow(So3::new(), Linear, move |t: f64, x: &V, v: &mut V| {
            *v = V::new(1.0, (t - t0).sin() * x[0], if t > jump { 1.5 } else { 0.5 });
        });
        let (pair, cf43) = (Rkmk::new(DOPRI5, Exp), CommutatorFree(CF43));
        stopped(&turn, &pair, [t0, jump]);
        stopped(&turn, &Rkmk::new(DOP853, Cay), [t0, jump]);
        stopped(&turn, &cf43, [t0, jump]);
    }
}

fn stopped<P, M>(problem: &P, method: &M, [t0, jump]: [f64; 2])
where
    P: Problem<Group = So3, Action = Linear>,
    M: Embedded<P>,
{
    let t1 = t0 + 3.0;
    for rtol in [1e-5, 1e-6, 1e-7, 1e-8, 1e-9] {
        let solve = || Solve::new(problem, method, [t0, t1]).tolerances(rtol, 0.0).stops([jump]);
        let free = solve().run(V::x()).expect("a run");
        let mut single = solve().integrator(V::x()).expect("a start");
        while !single.is_done() {
            single.step().expect("a step");
        }
        let every = solve().every(1).run(V::x()).expect("a run");
        let end = solve().times(&[t1][..]).run(V::x()).expect("a run");
        let found = [single.stats().accepted, every.stats.accepted, end.stats.accepted];
        assert_eq!(found, [free.stats.accepted; 3], "{t0}, {rtol:e}");
        assert_eq!([*single.y(), every.y, end.y], [free.y; 3], "{t0}, {rtol:e}");
    }
}

#[test]
fn zeros_within_streaks_are_found() {
    // An event that passes zero many times in steps whose size is kept: a clock.
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let run = Solve::new(&body, &Rk(DOPRI5), [0.0, 40.0])
        .tolerances(TOLERANCE, TOLERANCE)
        .event(Event::new("ring", |t: f64, _: &V| (0.5 * core::f64::consts::PI * t).cos()))
        .run(V::new(0.3, 0.2, 3.0))
        .expect("a run");
    let rings: Vec<f64> = run.events.iter().map(|zero| zero.t).collect();
    assert_eq!(rings.len(), 20);
    for (i, t) in rings.iter().enumerate() {
        assert!((t - (2.0 * i as f64 + 1.0)).abs() < 1e-13, "{t}");
    }
}

/// Who is told of the progress may cancel the run: no further step is taken.
#[test]
fn no_step_is_taken_after_the_one_that_is_cancelled() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let (flag, told) = (AtomicBool::new(false), Cell::new(0.0));
    let progress = |t: f64| {
        told.set(t);
        flag.store(t > 0.35, Ordering::Relaxed);
    };
    let solve = Solve::new(&body, &Rk(DOPRI5), [0.0, 1e6]).dt(0.1).every(1);
    let run = solve.cancel(&flag).progress(progress).run(START).expect("a run");
    assert_eq!((run.status, run.t), (Status::Cancelled, told.get()));
}

/// By the length of steps, where they become ever shorter: of the short ones some grow, wherever streaks end.
#[test]
fn short_steps_by_length_do_not_depend_on_the_output() {
    let grows = |t: f64, y: &V, v: &mut V| {
        let rate = (1.0 - t).recip();
        *v = V::new(0.3 * rate * y.z, 0.2 * rate * y.x, rate);
    };
    let problem = boxed_flow(So3::new(), Linear, grows);
    let end = 1.0 - 1e-8;
    // The largest size is that of a step, and has the rounding of its time.
    let taken = |run: &Solution<V>| (run.y, run.stats.accepted, run.stats.rejected);
    macro_rules! same {
        ($($method:expr),*) => {$({
            let method = $method;
            let solve = || {
                let solve = Solve::new(&problem, &method, [0.0, end]).tolerances(1e-10, 0.0);
                solve.rule(Rule::PerLength)
            };
            let free = solve().run(V::x()).expect("a run");
            assert!(free.stats.smallest_step < 1e-6 * free.stats.largest_step, "{:?}", free.stats);
            let every = solve().every(1).run(V::x()).expect("a run");
            assert_eq!(taken(&every), taken(&free), "{}, every step", stringify!($method));
            let times = solve().count(401).run(V::x()).expect("a run");
            assert_eq!(taken(&times), taken(&free), "{}, times", stringify!($method));
            let saves = std::cell::RefCell::new(Vec::new());
            let keep = |bytes: &[u8]| saves.borrow_mut().push(bytes.to_vec());
            let saved = solve().checkpoints(std::time::Duration::ZERO, keep).run(V::x());
            assert_eq!(taken(&saved.expect("a run")), taken(&free), "{}, saved", stringify!($method));
            for bytes in saves.into_inner().into_iter().step_by(97) {
                let run = solve().resume(bytes).run(V::x()).expect("a run");
                assert_eq!(taken(&run), taken(&free), "{}, resumed", stringify!($method));
            }
        })*};
    }
    same![Rkmk::new(DOPRI5, Exp), Rk(DOPRI5), CommutatorFree(CF43)];
}
