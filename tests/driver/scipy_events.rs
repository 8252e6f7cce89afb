//! What SciPy tests of events and of jumps; the table is in `scipy.rs`.

use core::cell::RefCell;
use std::f64::consts::PI;

use lieflow::actions::LeftTranslation;
use lieflow::groups::Translations;
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5};
use lieflow::methods::{CommutatorFree, Rk, Rkmk};
use lieflow::solve::Status;
use lieflow::{Event, Solve};

use crate::modes::V;
use crate::scipy::{
    SPANS, everywhere, free, rational, rational_at, times, turning, with_every_method,
};
use crate::support::boxed::{boxed_flow, boxed_of_time};

#[test]
fn many_short_steps_to_an_event() {
    // Thrown up, with steps of 1/40 of the time of flight: 0.01 t − 4.9 t² = 0.
    let problem = boxed_flow(free(), LeftTranslation, |_: f64, p: &V, v: &mut V| {
        *v = V::new(p.y, -9.80665, 0.0)
    });
    let method = Rk(DOPRI5);
    let flight = 0.02 / 9.80665;
    let run = Solve::new(&problem, &method, [0.0, f64::INFINITY])
        .tolerances(1e-3, 1e-6)
        .max_step(flight / 40.0)
        .event(Event::new("ground", |_, p: &V| p.x).falling().stop_after(1))
        .run_continuous(V::new(0.0, 0.01, 0.0))
        .expect("a run");
    assert_eq!(run.solution.status, Status::Event("ground".into()));
    assert_eq!(run.solution.events.len(), 1, "the zero at the start rises");
    let hit = &run.solution.events[0];
    assert!((hit.t / flight - 1.0).abs() < 1e-12 && !hit.rising, "{hit:?}");
    assert!((hit.y - V::new(0.0, -0.01, 0.0)).norm() < 1e-15);
    assert_eq!((run.solution.t, run.solution.y), (hit.t, hit.y));
    assert_eq!(run.t_span(), [0.0, hit.t]);
}

/// g₁ rises through 0 at 5.5, g₂ falls at 7.5, in the direction of time.
#[test]
fn events_in_both_directions() {
    let problem = rational();
    // z = 1/t, and a function of x and t that vanishes at 7.5.
    let rises = |_: f64, p: &V| 1.0 / 5.5 - p.z;
    let falls = |t: f64, p: &V| (p.x - 1.0 / (1.0 + 7.5 * 7.5)) * (1.0 + t);
    let span = [5.0, 8.0];
    with_every_method!(method => {
        for back in [false, true] {
            let span = if back { [span[1], span[0]] } else { span };
            let start = rational_at(span[0]);
            let go = |first: fn(Event<'static, V>) -> Event<'static, V>, stop: bool| {
                let mut solve = Solve::new(&problem, &method, span)
                    .tolerances(1e-6, 1e-9)
                    .event(first(Event::new("rises", rises)))
                    .event(first(Event::new("falls", falls)));
                if stop {
                    solve = solve.event(Event::new("time", |t, _: &V| t - 7.4).stop_after(1));
                }
                solve.run_continuous(start).expect("a run")
            };
            let near = |t: f64, at: f64| (t - at).abs() < 1e-4;
            let mut both = go(|event| event, false);
            assert_eq!(both.solution.status, Status::Finished);
            let [one, two]: [Vec<f64>; 2] = [0, 1].map(|i| both.solution.times_of(i).collect());
            assert!(one.len() == 1 && near(one[0], 5.5) && two.len() == 1 && near(two[0], 7.5), "{one:?} {two:?}");
            for found in &both.solution.events.clone() {
                let g = if found.event == 0 { rises(found.t, &found.y) } else { falls(found.t, &found.y) };
                assert!(g.abs() < 1e-14, "{g}");
                assert_eq!(found.rising, (found.event == 0) != back);
                assert_eq!(*both.at(found.t).expect("a point"), found.y);
            }
            let in_order: Vec<f64> = both.solution.events.iter().map(|found| found.t).collect();
            assert!(if back { in_order[0] > in_order[1] } else { in_order[0] < in_order[1] });
            // Of one direction only, in the direction of the run.
            for (index, rising) in [(0, !back), (1, back)] {
                let found = match rising {
                    true => go(Event::rising, false).solution.events,
                    false => go(Event::falling, false).solution.events,
                };
                assert!(found.len() == 1 && found[0].event == index && found[0].rising == rising, "{found:?}");
            }
            // A third one stops the run: of the others the one before it is found.
            let mut stopped = go(|event| event, true);
            assert_eq!(stopped.solution.status, Status::Event("time".into()));
            let found: Vec<usize> = stopped.solution.events.iter().map(|found| found.event).collect();
            assert_eq!(found, if back { [1, 2] } else { [0, 2] });
            assert!((stopped.solution.t - 7.4).abs() < 1e-14);
            everywhere(&mut stopped, rational_at, 5.0);
            assert!(stopped.at(7.4 + 0.1 * (span[1] - span[0]).signum()).is_err());
        }
    });
}

#[test]
fn the_third_zero_stops() {
    let (problem, method) = (turning(), Rkmk::new(DOPRI5, Cay));
    let span = [0.0, 100.0];
    for count in [3u64, 4] {
        let run = Solve::new(&problem, &method, span)
            .tolerances(1e-9, 1e-9)
            .event(Event::new("x", |_, x: &V| x.x).stop_after(count))
            .run(V::x())
            .expect("a run");
        assert_eq!(run.events.len() as u64, count);
        for (k, found) in run.events.iter().enumerate() {
            assert!(
                (found.t - (k as f64 + 0.5) * PI).abs() < 1e-7 && found.y.x.abs() < 1e-14,
                "{found:?}"
            );
            assert_eq!(found.rising, k % 2 == 1);
        }
        assert_eq!(run.t, run.events[count as usize - 1].t);
    }
    let all = Solve::new(&problem, &method, span)
        .tolerances(1e-9, 1e-9)
        .event(Event::new("x", |_, x: &V| x.x))
        .run(V::x())
        .expect("a run");
    assert_eq!((all.events.len(), all.t), (32, 100.0));
    let never = Event::new("x", |_, x: &V| x.x).stop_after(0);
    let refused =
        Solve::new(&problem, &method, span).tolerances(1e-9, 1e-9).event(never).run(V::x());
    assert!(refused.is_err_and(|e| e.to_string().contains("expected at least 1")), "a count of 0");
}

#[test]
fn an_event_before_the_first_output() {
    let problem = rational();
    with_every_method!(method => {
        let run = Solve::new(&problem, &method, SPANS[0])
            .tolerances(1e-3, 1e-6)
            .times(times([7.5, 9.0], 16))
            .event(Event::new("early", |t, _: &V| t - 7.0).stop_after(1))
            .run(rational_at(5.0))
            .expect("a run");
        assert_eq!(run.status, Status::Event("early".into()));
        assert!(run.times.is_empty() && run.points.is_empty());
        assert_eq!((run.events.len(), run.events[0].t, run.t), (1, 7.0, 7.0));
    });
}

#[test]
fn an_event_and_a_continuous_solution_of_a_steep_problem() {
    // ẋ = x(t − 2): x = 0.05·exp(t²/2 − 2t − 6) from t = −2.
    let problem = boxed_flow(free(), LeftTranslation, |t: f64, p: &V, v: &mut V| {
        *v = V::new(p.x * (t - 2.0), 0.0, 0.0)
    });
    let exact = |t: f64| V::new(0.05 * (0.5 * t * t - 2.0 * t - 6.0).exp(), 0.0, 0.0);
    with_every_method!(method => {
        let mut run = Solve::new(&problem, &method, [-2.0, 2.0])
            .tolerances(1e-3, 1e-6).first_step(1e-3).max_step(1.0).every(1)
            .event(Event::new("x", |_, p: &V| p.x - 2.02e-5))
            .run_continuous(exact(-2.0))
            .expect("a run");
        assert!((run.solution.times[1] + 2.0 - 1e-3).abs() < 1e-15);
        assert_eq!(run.solution.times.last(), Some(&2.0));
        everywhere(&mut run, exact, 10.0);
    });
}

#[test]
fn arguments_of_a_closure() {
    // x and y turn at 2, z is the logistic curve that reaches 0.99 at t = 5.
    let (omega, k, z_end): (f64, f64, f64) = (2.0, 4.0, 0.99);
    let z0 = (-5.0 * k).exp() / ((1.0 - z_end) / z_end + (-5.0 * k).exp());
    let problem = boxed_flow(free(), LeftTranslation, move |_: f64, p: &V, v: &mut V| {
        *v = V::new(-omega * p.y, omega * p.x, k * p.z * (1.0 - p.z));
    });
    let method = Rk(DOP853);
    let mut run = Solve::new(&problem, &method, [0.0, 10.0])
        .tolerances(1e-11, 1e-14)
        .event(Event::new("x falls", |_, p: &V| p.x).falling())
        .event(Event::new("y rises", |_, p: &V| p.y).rising())
        .event(Event::new("z", move |_, p: &V| p.z - z_end).stop_after(1))
        .run_continuous(V::new(0.0, -1.0, z0))
        .expect("a run");
    let expected: [&[f64]; 3] = [&[0.5 * PI, 1.5 * PI], &[0.25 * PI, 1.25 * PI], &[5.0]];
    for (index, expected) in expected.iter().enumerate() {
        let found: Vec<f64> = run.solution.times_of(index).collect();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(*expected).all(|(a, b)| (a - b).abs() < 1e-7 * b), "{found:?}");
    }
    for t in times([0.0, run.solution.t], 100) {
        let y = run.at(t).expect("a point");
        let z = 1.0 / ((1.0 - z0) / z0 * (-k * t).exp() + 1.0);
        let gap = (y - V::new((omega * t).sin(), -(omega * t).cos(), z)).norm();
        assert!(gap < 1e-8, "{t}: {gap:e}");
    }
}

#[test]
fn an_observer_and_events_are_told_in_order() {
    let (problem, method) = (rational(), Rk(DOPRI5));
    let told = RefCell::new(Vec::new());
    let tell = |at: f64| {
        Event::new("time", move |t, _: &V| t - at).change(|t, _: &mut V| told.borrow_mut().push(t))
    };
    let run = Solve::new(&problem, &method, [5.0, 7.0])
        .tolerances(1e-3, 1e-6)
        .times(times([5.0, 7.0], 21))
        .event(tell(6.0))
        .event(tell(6.55))
        .run_with(rational_at(5.0), |t, _| told.borrow_mut().push(t))
        .expect("a run");
    assert_eq!(run.events.len(), 2);
    let told = told.borrow();
    assert!(told.len() == 23 && told.is_sorted(), "{told:?}");
    assert!(told.contains(&6.55) || told.iter().any(|t| (t - 6.55).abs() < 1e-14));
}

#[test]
fn a_jump_belongs_to_what_follows() {
    // x moves at rate 1; at t = 1 and 3 it is put back to 0.
    for (span, forward) in [([0.0, 4.0], 1.0), ([4.0, 0.0], -1.0)] {
        let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x());
        let method = Rk(DOPRI5);
        let put_back = |at: f64| {
            Event::new("back", move |t, _: &V| t - at).change(|_, p: &mut V| *p = V::zeros())
        };
        let mut run = Solve::new(&problem, &method, span)
            .tolerances(1e-6, 1e-9)
            .event(put_back(1.0))
            .event(put_back(3.0))
            .run_continuous(V::zeros())
            .expect("a run");
        let first = if forward > 0.0 { 1.0 } else { 3.0 };
        assert_eq!(
            run.solution.events.iter().map(|found| found.t).collect::<Vec<_>>(),
            [first, 4.0 - first]
        );
        let mut x = |t: f64| run.at(t).expect("a point").x;
        let start = span[0];
        for (after, expected) in [
            (0.0, 0.0),
            (0.5, 0.5),
            (1.0 - 1e-9, 1.0),
            (1.0, 0.0),
            (2.0, 1.0),
            (3.0 - 1e-9, 2.0),
            (3.0, 0.0),
            (3.5, 0.5),
            (4.0, 1.0),
        ] {
            let found = forward * x(start + forward * after);
            assert!((found - expected).abs() < 2e-9, "{after}: {found}, expected {expected}");
        }
    }
}

/// One fall in metres and in feet: both balls bounce, though the zeros are some roundings apart and each bounce changes the
/// state.
#[test]
fn bounces_at_one_moment_are_two() {
    let (g, feet) = (9.81, 1.0 / 0.3048);
    let fall = boxed_flow(
        Translations::new([0.0; 4], 4),
        LeftTranslation,
        move |_: f64, y: &[f64; 4], v: &mut [f64; 4]| *v = [y[1], -g, y[3], -g * feet],
    );
    let bounce = |name: &'static str, at: usize| {
        let event = Event::new(name, move |_, y: &[f64; 4]| y[at]).falling();
        event.change(move |_, y| (y[at], y[at + 1]) = (0.0, -0.8 * y[at + 1]))
    };
    for case in 0..130 {
        let (height, v0) =
            (0.5 + 0.1 * f64::from(case % 26), [0.0, 1.0, -1.0, 0.5, 1.5][case as usize / 26]);
        let end = 1.5 * (v0 + f64::sqrt(v0 * v0 + 2.0 * g * height)) / g;
        let start = [height, v0, feet * height, feet * v0];
        for rtol in [1e-6, 1e-10, 1e-12] {
            let method = Rkmk::new(DOP853, Exp);
            let solve = Solve::new(&fall, &method, [0.0, end]).tolerances(rtol, 0.0);
            let run = solve.event(bounce("a", 0)).event(bounce("b", 2)).run(start).expect("a run");
            let [a, b] = [0, 1].map(|event| run.times_of(event).count());
            assert!(a > 0 && a == b, "{height} m, {v0} m/s, {rtol:e}: {a} and {b} bounces");
            assert!((run.y[0] - run.y[2] / feet).abs() < 1e-9, "{height} m, {v0} m/s: {:?}", run.y);
        }
    }
}
