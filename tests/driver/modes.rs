//! One run in every mode of the driver: each way to call it, each kind of output, events, stops, by hand.

use crate::support::boxed::{boxed_flow, boxed_of_time};
use lieflow::actions::Linear;
use lieflow::groups::So3;
use lieflow::maps::CCSK;
use lieflow::methods::tableau::RK4;
use lieflow::methods::{AnyMethod, Embedded, Method, Rkmk};
use lieflow::problems::{Invariant, Problem};
use lieflow::solve::{Interrupted, Next, Status};
use lieflow::{
    Action, Event, LieAlgebra, RunError, SaveAt, Solution, Solve, Step, StepControl, TimeGrid,
    integrate, integrate_adaptive,
};
use nalgebra::Vector3;

pub(crate) type V = Vector3<f64>;

/// How the steps are chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pace {
    /// rtol, atol.
    ByError(f64, f64),
    /// dt.
    Equal(f64),
}

/// What a mode made of a run: its name, the end or why there is none, and the last point that was known.
pub(crate) struct Ran {
    pub(crate) mode: &'static str,
    pub(crate) end: Result<(f64, V), RunError>,
    pub(crate) last: Option<(f64, V)>,
}

/// Attempts that each run is given.
pub(crate) const ATTEMPTS: u64 = 2000;

fn finite(mode: &str, t: f64, y: &V) {
    assert!(t.is_finite() && y.iter().all(|x| x.is_finite()), "{mode}: {y} at {t}");
}

/// Run in every mode. Every number that comes out is finite, and so are the points of an error.
#[allow(clippy::too_many_lines)]
pub(crate) fn every_mode<P, M>(
    problem: &P,
    method: &M,
    span: [f64; 2],
    pace: Pace,
    start: V,
) -> Vec<Ran>
where
    P: Problem<Action: Action<P::Group, Point = V>, Group: LieAlgebra<Scalar = f64>>,
    M: Embedded<P>,
{
    let solve = || {
        let solve = Solve::new(problem, method, span).max_steps(ATTEMPTS);
        match pace {
            Pace::ByError(rtol, atol) => solve.tolerances(rtol, atol),
            Pace::Equal(dt) => solve.dt(dt),
        }
    };
    let within = |part: f64| span[0] + part * (span[1] - span[0]);
    let times: Vec<f64> = match span[0] == span[1] {
        true => vec![span[0]],
        false => {
            let mut times: Vec<f64> =
                (0..10).map(|i| within(f64::from(i) / 10.0)).chain([span[1]]).collect();
            times.dedup();
            times.retain(|t| t.is_finite());
            times
        }
    };
    let saves = [
        ("End", SaveAt::End),
        ("Ends", SaveAt::Ends),
        ("Every(1)", SaveAt::Every(1)),
        ("Every(3)", SaveAt::Every(3)),
        ("Times", SaveAt::Times(times.clone())),
    ];
    let mut all = Vec::new();
    for (mode, save) in &saves {
        // In place.
        let (mut y, mut last) = (start, None);
        let see = |t: f64, y: &V| {
            finite(mode, t, y);
            last = Some((t, *y));
        };
        let done = match pace {
            Pace::ByError(rtol, atol) => StepControl::new(rtol, atol)
                .and_then(|control| control.max_steps(ATTEMPTS))
                .map_err(RunError::from)
                .and_then(|control| {
                    integrate_adaptive(problem, method, span, &control, save, &mut y, see)
                }),
            Pace::Equal(dt) => TimeGrid::new(span, dt)
                .map_err(RunError::from)
                .and_then(|grid| integrate(problem, method, &grid, save, &mut y, see)),
        };
        finite(mode, 0.0, &y);
        all.push(Ran { mode, end: done.map(|_| (span[1], y)), last: last.or(Some((span[0], y))) });
        // A solution.
        all.push(stored(mode, solve().save(save.clone()).run(start)));
    }
    all.push(stored("by steps", solve().times(&*times).times_by_steps().run(start)));
    for (mode, next) in [("nothing new", Next::Continue), ("the same again", Next::Changed)] {
        all.push(stored(
            mode,
            solve().times(&*times).run_with(start, |t, y| {
                finite(mode, t, y);
                next
            }),
        ));
    }
    for (mode, end) in [("a stop", within(0.5)), ("a stop at the end", within(1.0))] {
        let run = solve().every(2).run_with(start, |t, y| {
            finite(mode, t, y);
            if (t - end) * (span[1] - span[0]) >= 0.0 { Next::Stop } else { Next::Continue }
        });
        let run = run.map(|mut run| {
            // What comes out is the last point; that it ended is what counts.
            if run.status == Status::Observer {
                run.t = span[1];
            }
            run
        });
        all.push(stored(mode, run));
    }
    let events = |change: bool| {
        let every = Event::new("every", |_, y: &V| y.x);
        let every = if change { every.change(|_, _| {}) } else { every };
        let never = Event::new("never", |_, _: &V| 1.0);
        solve().event(every).event(never).event(Event::new("time", move |t, _: &V| t - within(0.3)))
    };
    all.push(stored("events", events(false).times(&*times).run(start)));
    all.push(stored("events that change", events(true).every(1).run(start)));
    all.push(stored("stops", solve().stops([0.2, 0.5, 0.5, 0.9, -1.0].map(within)).run(start)));
    all.push(match events(false).run_continuous(start) {
        Ok(mut run) => {
            for &t in times.iter().chain(times.iter().rev()) {
                let y = *run.at(t).expect("a point of the span");
                finite("continuous", t, &y);
            }
            stored("continuous", Ok(run.solution))
        }
        Err(error) => stored("continuous", Err(error)),
    });
    for (mode, to) in [("by hand", 1.0), ("by hand, to times", 0.1)] {
        let mut by_hand = match solve().integrator(start) {
            Ok(run) => run,
            Err(error) => {
                all.push(Ran { mode, end: Err(error), last: None });
                continue;
            }
        };
        let (mut done, mut steps, mut at) = (Ok(()), 0, V::zeros());
        while done.is_ok() && !by_hand.is_done() && steps < 2 * ATTEMPTS {
            steps += 1;
            done = match to < 1.0 {
                true => {
                    let next =
                        times.iter().find(|t| (*t - by_hand.t()) * (span[1] - span[0]) > 0.0);
                    let next = next.copied().unwrap_or(span[1]);
                    by_hand.advance_to(next).map(drop)
                }
                false => by_hand.step().map(drop),
            };
            let last = by_hand.last_step();
            if done.is_ok() && by_hand.interpolate(last.t + 0.4 * last.h, &mut at).is_ok() {
                finite(mode, last.t, &at);
            }
        }
        finite(mode, by_hand.t(), by_hand.y());
        assert!(by_hand.stats().smallest_step.is_finite());
        let here = (by_hand.t(), *by_hand.y());
        if done.is_ok() && !by_hand.is_done() {
            continue; // steps of one size without a limit
        }
        all.push(Ran { mode, end: done.map(|()| here), last: Some(here) });
    }
    all
}

fn stored(mode: &'static str, run: Result<Solution<V>, Interrupted<V>>) -> Ran {
    let check = |found: &Solution<V>| {
        finite(mode, found.t, &found.y);
        assert!(found.stats.smallest_step.is_finite() && found.stats.largest_step.is_finite());
        assert_eq!(found.times.len(), found.points.len());
        for (t, y) in found.times.iter().zip(&found.points) {
            finite(mode, *t, y);
        }
        for found in &found.events {
            finite(mode, found.t, &found.y);
        }
    };
    match run {
        Ok(found) => {
            check(&found);
            let end = (found.t, found.y);
            Ran { mode, end: Ok(end), last: Some(end) }
        }
        Err(failed) => {
            let last = failed.solution.as_deref().map(|found| {
                check(found);
                (found.t, found.y)
            });
            Ran { mode, end: Err(failed.error), last }
        }
    }
}

#[test]
fn a_method_behind_a_pointer_takes_the_typed_step() {
    // The map alternates with the number of the step, and f depends on t.
    let flow = boxed_flow(So3::new(), Linear, |t: f64, x: &V, v: &mut V| {
        *v = V::new(t, x[0], 1.0 + t * x[1]);
    });
    let typed = Rkmk::new(RK4, CCSK);
    let any = AnyMethod::new(typed);
    let (mut a, mut b) = (V::new(0.3, 0.4, 1.2), V::new(0.3, 0.4, 1.2));
    let mut typed_work = typed.work(&flow, &a).expect("the method fits");
    let mut any_work = any.work(&flow, &b).expect("the method fits");
    for n in [0u64, 1, 2, 5, 5, 8] {
        let step = Step { n, t: 0.1 * n as f64, h: 0.1 };
        let start = a;
        typed.step(&flow, step, &mut a, &mut typed_work).expect("a step");
        any.step(&flow, step, &mut b, &mut any_work).expect("a step");
        assert_eq!(a, b, "step {n}");
        assert_ne!(a, start, "step {n}");
    }
}

#[test]
fn a_changed_state_stays_on_its_own_orbit() {
    // Each step is on a sphere, and the driver corrects the length to that of the last change.
    let flow = boxed_of_time(So3::new(), Linear, |t: f64, v: &mut V| *v = V::new(1.0, t, 0.5));
    let method = Rkmk::new(RK4, CCSK);
    let mut run =
        Solve::new(&flow, &method, [0.0, 10.0]).dt(0.01).integrator(V::x()).expect("a run");
    run.advance_to(2.0).expect("steps");
    run.set_state(&(run.y() * 3.0)).expect("a point of M");
    let y = run.advance_to(10.0).expect("steps");
    assert!((y.norm() - 3.0).abs() < 1e-13, "{}", y.norm());
    assert!(run.stats().restored > 5);
}

#[test]
fn the_largest_drift_is_that_of_the_output() {
    // The invariant that is claimed is x of a turning vector: it is 1 at both ends, and −1 half way.
    let flow = boxed_of_time(So3::new(), Linear, |_: f64, v: &mut V| *v = V::z())
        .invariant(Invariant::of_the_flow("x", 1), |x: &V| x[0]);
    let span = [0.0, core::f64::consts::TAU];
    let method = Rkmk::new(RK4, CCSK);
    let solve = || Solve::new(&flow, &method, span).steps(100).watch_invariants();
    let largest = |solve: Solve<'_, _, _>| solve.run(V::x()).expect("a run").drift[0].clone();
    let (ends, shown) = (largest(solve()), largest(solve().every(1)));
    assert!(ends.largest < 1e-6 && ends.at_end.abs() < 1e-6, "{ends:?}");
    assert!((shown.largest - 2.0).abs() < 1e-6 && shown.at_end.abs() < 1e-6, "{shown:?}");
}
