//! What SciPy tests of `solve_ivp` (`scipy/integrate/_ivp/tests/test_ivp.py`), asked of this driver, on vectors
//! that move freely and on the sphere.
//!
//! | SciPy's test | here |
//! |---|---|
//! | `test_duplicate_timestamps` | [`many_short_steps_to_an_event`] |
//! | `test_integration` | [`integration`] |
//! | `test_integration_complex`, `_complex_sparse` | none: points are real; U(n) has tests of its own |
//! | `test_integration_sparse_difference` | none: no method takes a Jacobian |
//! | `test_integration_const_jac` | [`integration`], without a Jacobian |
//! | `test_integration_stiff` | none: every adaptive method is explicit |
//! | `test_events` | [`events_in_both_directions`] |
//! | `test_event_terminal_integer`, `_terminal_iv` | [`the_third_zero_stops`]; a count is a `u64`, and 0 is refused |
//! | `test_max_step`, `test_inital_maxstep` | [`the_largest_step`] |
//! | `test_first_step` | [`the_first_step`]; one beyond the end is shortened, not refused |
//! | `test_t_eval` | [`output_times`] |
//! | `test_t_eval_dense_output` | [`output_times_beside_a_continuous_solution`] |
//! | `test_t_eval_early_event` | [`an_event_before_the_first_output`] |
//! | `test_event_dense_output_LSODA` | [`an_event_and_a_continuous_solution_of_a_steep_problem`] |
//! | `test_no_integration`, `_class`, `test_zero_interval` | [`an_empty_span`] |
//! | `test_empty` | [`a_point_without_numbers`] |
//! | `test_ConstantDenseOutput` | [`an_empty_span`], [`nothing_moves`] |
//! | `test_classes` | [`step_by_step`] |
//! | `test_OdeSolution` | [`a_jump_belongs_to_what_follows`]; a time outside is refused |
//! | `test_num_jac`, `test_num_jac_sparse` | none: no method takes a Jacobian |
//! | `test_args`, `test_args_single_value` | [`arguments_of_a_closure`]: a closure has them |
//! | `test_array_rtol` | `tolerances::each_component_has_its_own`: an atol for each component, an rtol for each part |
//! | `test_integration_zero_rhs` | [`nothing_moves`] |
//! | `test_initial_state_finiteness` | [`a_start_that_is_not_finite`] |
//! | `test_tbound_respected_…`, three | [`no_evaluation_outside_the_span`] |
//! | `test_callable` | [`an_observer_sees_every_step`] |
//! | `test_callable_dense_output` | [`step_by_step`]: `Integrator::interpolate` |
//! | `test_callable_stop_iteration` | [`an_observer_stops_the_run`] |
//! | `test_callable_events` | [`an_observer_and_events_are_told_in_order`] |

use core::cell::Cell;

use crate::support::boxed::{boxed_flow, boxed_of_time};
use faer::Mat;
use lieflow::actions::{LeftTranslation, Linear};
use lieflow::groups::{So3, Translations};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5};
use lieflow::methods::{CommutatorFree, Embedded, Rk, Rkmk};
use lieflow::problems::Problem;
use lieflow::solve::{Continuous, Next, Status};
use lieflow::{Event, RunError, Solve};
use nalgebra::Vector3;

type V = Vector3<f64>;

/// T(3), on itself.
pub(crate) fn free() -> Translations<V> {
    Translations::new(V::zeros(), 3)
}

/// ẋ = −2tx², ẏ = xy, ż = −z² on T(3): x = 1/(1 + t²), y = exp(atan t), z = 1/t.
pub(crate) fn rational() -> impl Problem<Group = Translations<V>, Action = LeftTranslation> {
    boxed_flow(free(), LeftTranslation, |t: f64, p: &V, v: &mut V| {
        *v = V::new(-2.0 * t * p.x * p.x, p.x * p.y, -p.z * p.z);
    })
}

pub(crate) fn rational_at(t: f64) -> V {
    V::new(1.0 / (1.0 + t * t), t.atan().exp(), 1.0 / t)
}

/// The error in units of the tolerances 1e-3 and 1e-6: of the point, and not, as SciPy has it, of each number.
fn error(y: &V, exact: &V) -> f64 {
    (y - exact).norm() / (1e-6 + 1e-3 * exact.norm())
}

pub(crate) const SPANS: [[f64; 2]; 2] = [[5.0, 9.0], [5.0, 3.0]];

/// So many times from a to b.
pub(crate) fn times([a, b]: [f64; 2], count: u32) -> Vec<f64> {
    let inside = (0..count - 1).map(|i| a + (b - a) * f64::from(i) / f64::from(count - 1));
    inside.chain([b]).collect()
}

/// Ask for 50 times of a solution, in the order of the run and against it.
pub(crate) fn everywhere<P, M>(run: &mut Continuous<'_, P, M>, exact: impl Fn(f64) -> V, bound: f64)
where
    P: Problem<Group = Translations<V>, Action = LeftTranslation>,
    M: Embedded<P>,
{
    let mut times = times(run.t_span(), 50);
    for _ in 0..2 {
        for &t in &times {
            let y = *run.at(t).expect("a point");
            assert!(error(&y, &exact(t)) < bound, "{t}: {y} {}", exact(t));
        }
        times.reverse();
    }
}

/// Runs on T(3) with every kind of method.
macro_rules! with_every_method {
    ($method:ident => $body:block) => {{
        {
            let $method = Rk(BS3);
            $body
        }
        {
            let $method = Rk(DOPRI5);
            $body
        }
        {
            let $method = Rkmk::new(DOP853, Exp);
            $body
        }
        {
            let $method = CommutatorFree(CF43);
            $body
        }
    }};
}
pub(crate) use with_every_method;

#[test]
fn integration() {
    let problem = rational();
    for span in SPANS {
        with_every_method!(method => {
            let start = rational_at(span[0]);
            let mut run = Solve::new(&problem, &method, span)
                .tolerances(1e-3, 1e-6).every(1).run_continuous(start).expect("a run");
            let found = run.solution.clone();
            assert_eq!(found.status, Status::Finished);
            assert_eq!((found.t, found.times[0], *found.times.last().expect("times")), (span[1], span[0], span[1]));
            assert_eq!(found.points.len() as u64, found.stats.accepted + 1);
            assert!(found.events.is_empty() && found.drift.is_empty());
            assert!(found.stats.evaluations.expect("known") < 130, "{:?}", found.stats);
            for (t, y) in found.times.iter().zip(&found.points) {
                assert!(error(y, &rational_at(*t)) < 5.0, "{t}");
                assert_eq!(run.at(*t).expect("a point"), y);
            }
            everywhere(&mut run, rational_at, 5.0);
            assert!(run.at(span[1] + (span[1] - span[0])).is_err() && run.at(f64::NAN).is_err());
        });
    }
}

/// x turns at rate 1 about e₃: x₁ = cos t.
pub(crate) fn turning() -> impl Problem<Group = So3, Action = Linear> {
    boxed_of_time(So3::new(), Linear, |_: f64, v: &mut V| *v = V::z())
}

#[test]
fn the_largest_step() {
    let problem = rational();
    for span in SPANS {
        with_every_method!(method => {
            let solve = || Solve::new(&problem, &method, span).tolerances(1e-3, 1e-6);
            let mut run = solve().max_step(0.5).every(1).run_continuous(rational_at(span[0])).expect("a run");
            let sizes = run.solution.times.windows(2).map(|t| (t[1] - t[0]).abs());
            assert!(sizes.fold(0.0, f64::max) <= 0.5 + 1e-15);
            assert!(run.solution.stats.largest_step <= 0.5 + 1e-15 && run.solution.stats.accepted as f64 >= (span[1] - span[0]).abs() / 0.5);
            everywhere(&mut run, rational_at, 5.0);
            for bad in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
                let error = solve().max_step(bad).run(rational_at(5.0)).expect_err("a limit").to_string();
                assert!(error.starts_with("max_step"), "{error}");
            }
            // Lost next to t: an error, not a run without end.
            let error = solve().max_step(1e-20).run(rational_at(5.0)).expect_err("no step");
            assert!(matches!(error.error, RunError::StepSizeUnderflow { .. }), "{error}");
            // The first step, too, which is chosen before it is limited.
            let free = solve().every(1).run(rational_at(span[0])).expect("a run");
            let first = (free.times[1] - free.times[0]).abs();
            let half = solve().max_step(0.5 * first).every(1).run(rational_at(span[0])).expect("a run");
            assert!(((half.times[1] - half.times[0]).abs() / (0.5 * first) - 1.0).abs() < 1e-12);
        });
    }
}

#[test]
fn the_first_step() {
    let problem = rational();
    for span in SPANS {
        with_every_method!(method => {
            let solve = || Solve::new(&problem, &method, span).tolerances(1e-3, 1e-6).max_step(0.5).every(1);
            let start = rational_at(span[0]);
            let mut run = solve().first_step(0.1).run_continuous(start).expect("a run");
            assert!(((run.solution.times[1] - span[0]).abs() - 0.1).abs() < 1e-15);
            assert_eq!(run.solution.times.last(), Some(&span[1]));
            everywhere(&mut run, rational_at, 5.0);
            for bad in [-1.0, 0.0, f64::NAN] {
                let error = solve().first_step(bad).run(start).expect_err("a size").to_string();
                assert!(error.starts_with("first_step"), "{error}");
            }
            assert_eq!(solve().first_step(100.0).run(start).expect("shortened").t, span[1]);
        });
    }
}

#[test]
fn output_times() {
    let (problem, method) = (rational(), Rk(DOPRI5));
    let lists: [([f64; 2], Vec<f64>); 6] = [
        (SPANS[0], times(SPANS[0], 10)),
        (SPANS[1], times(SPANS[1], 10)),
        (SPANS[0], vec![5.0, 5.01, 7.0, 8.0, 8.01, 9.0]),
        (SPANS[1], vec![5.0, 4.99, 4.0, 3.5, 3.1, 3.01, 3.0]),
        (SPANS[0], vec![5.01, 7.0, 8.0, 8.01]),
        (SPANS[1], vec![4.99, 4.0, 3.5, 3.1, 3.01]),
    ];
    for (span, times) in lists {
        let solve = || Solve::new(&problem, &method, span).tolerances(1e-3, 1e-6);
        let plain = solve().run(rational_at(span[0])).expect("a run");
        for solve in [solve().times(&*times), solve().times(&*times).times_by_steps()] {
            let run = solve.run(rational_at(span[0])).expect("a run");
            assert_eq!(run.times, times);
            assert_eq!(
                (run.t, run.y, &run.status),
                (span[1], plain.y, &Status::Finished),
                "the run is the same"
            );
            assert_eq!(run.stats.accepted, plain.stats.accepted);
            for (t, y) in times.iter().zip(&run.points) {
                assert!(error(y, &rational_at(*t)) < 5.0, "{t}");
            }
        }
    }
    for bad in [vec![4.0, 6.0], vec![6.0, 9.1], vec![6.0, 5.5], vec![6.0, 6.0], vec![f64::NAN]] {
        let run = Solve::new(&problem, &method, SPANS[0]).tolerances(1e-3, 1e-6).times(bad);
        let error = run.run(rational_at(5.0)).expect_err("times");
        assert!(error.to_string().starts_with("times["), "{error}");
        assert!(error.solution.is_none());
    }
}

#[test]
fn output_times_beside_a_continuous_solution() {
    let (problem, method) = (rational(), Rk(DOPRI5));
    let solve = || {
        Solve::new(&problem, &method, SPANS[0]).tolerances(1e-3, 1e-6).times(times(SPANS[0], 10))
    };
    let alone = solve().run(rational_at(5.0)).expect("a run");
    let mut beside = solve().run_continuous(rational_at(5.0)).expect("a run");
    assert_eq!(beside.solution.times, alone.times);
    assert_eq!(beside.solution.points, alone.points);
    for (t, y) in alone.times.iter().zip(&alone.points) {
        assert_eq!(beside.at(*t).expect("a point"), y);
    }
}

#[test]
fn an_empty_span() {
    let problem = turning();
    let method = Rkmk::new(DOPRI5, Exp);
    let solve = || {
        Solve::new(&problem, &method, [4.0, 4.0])
            .event(Event::new("x", |_, x: &V| x.x).stop_after(1))
    };
    for solve in
        [solve().tolerances(1e-6, 1e-9), solve().dt(0.1), solve().steps(7), solve().steps(0)]
    {
        let mut run = solve.run_continuous(V::y()).expect("a run");
        assert_eq!(
            (run.t_span(), run.solution.stats.accepted, run.solution.stats.evaluations),
            ([4.0, 4.0], 0, Some(0))
        );
        assert_eq!((run.solution.t, run.solution.y, run.solution.times.len()), (4.0, V::y(), 1));
        assert_eq!(run.at(4.0).expect("the start"), &V::y());
        assert!(run.at(5.0).is_err());
        assert_eq!(
            (run.solution.status, run.solution.events.len()),
            (Status::Finished, 0),
            "nothing follows"
        );
    }
    let mut by_hand = solve().tolerances(1e-6, 1e-9).integrator(V::y()).expect("a run");
    assert!(by_hand.is_done());
    assert_eq!(by_hand.step().expect("nothing to do"), 4.0);
    assert_eq!(
        (by_hand.y(), by_hand.stats().accepted, by_hand.stats().smallest_step),
        (&V::y(), 0, 0.0)
    );
}

#[test]
fn a_point_without_numbers() {
    let group = Translations::new(Mat::<f64>::zeros(0, 0), 0);
    let problem = boxed_flow(group, LeftTranslation, |_: f64, _: &Mat<f64>, _: &mut Mat<f64>| {});
    let method = Rk(DOPRI5);
    let mut run = Solve::new(&problem, &method, [0.0, 10.0])
        .tolerances(1e-6, 1e-9)
        .run_continuous(Mat::zeros(0, 0))
        .expect("a run");
    assert_eq!(run.at(3.0).expect("a point").nrows(), 0);
    let run = Solve::new(&problem, &method, [0.0, f64::INFINITY])
        .tolerances(1e-6, 1e-9)
        .event(Event::new("time", |t, _: &Mat<f64>| t - 10.0).stop_after(1))
        .run(Mat::zeros(0, 0))
        .expect("a run");
    assert_eq!(run.t, 10.0);
}

#[test]
fn nothing_moves() {
    let still = boxed_of_time(So3::new(), Linear, |_: f64, v: &mut V| *v = V::zeros());
    macro_rules! check {
        ($($method:expr),*) => {$(
            let method = $method;
            let mut run = Solve::new(&still, &method, [0.0, 10.0])
                .tolerances(1e-6, 1e-9).run_continuous(V::x()).expect("a run");
            assert_eq!((run.solution.y, *run.at(7.0).expect("a point")), (V::x(), V::x()));
            // Without an end, until an event of time.
            let run = Solve::new(&still, &method, [0.0, f64::INFINITY]).tolerances(1e-6, 1e-9)
                .event(Event::new("time", |t, _: &V| t - 1e6).stop_after(1)).run(V::x()).expect("a run");
            assert!((run.t - 1e6).abs() < 1e-9 && run.y == V::x());
        )*};
    }
    check!(Rk(BS3), Rkmk::new(DOPRI5, Exp), Rkmk::new(DOP853, Cay), CommutatorFree(CF43));
}

#[test]
fn step_by_step() {
    let problem = rational();
    with_every_method!(method => {
        let start = rational_at(5.0);
        let solve = Solve::new(&problem, &method, [5.0, f64::INFINITY]).tolerances(1e-3, 1e-6);
        let mut run = solve.integrator(start).expect("a run");
        assert_eq!((run.t(), *run.y(), run.t_end(), run.is_done()), (5.0, start, f64::INFINITY, false));
        assert_eq!((run.last_step().h, run.stats().accepted), (0.0, 0));
        let mut at = V::zeros();
        assert!(run.interpolate(5.1, &mut at).is_err(), "no step, nothing to look into");
        run.interpolate(5.0, &mut at).expect("the start");
        assert_eq!(at, start);
        let t = run.step().expect("a step");
        assert!(t > 5.0 && t == run.t() && *run.y() != start && run.stats().accepted == 1);
        assert!(run.stats().evaluations.expect("known") > 0 && run.last_step().h == t - 5.0);
        run.interpolate(5.0, &mut at).expect("the start");
        assert_eq!(at, start);
        run.interpolate(5.0 + 0.3 * (t - 5.0), &mut at).expect("a point");
        assert!(error(&at, &rational_at(5.0 + 0.3 * (t - 5.0))) < 5.0);
        for outside in [4.9, t + 1e-9, f64::NAN] {
            let error = run.interpolate(outside, &mut at).expect_err("outside").to_string();
            assert!(error.starts_with("t = ") || error.starts_with("t:"), "{error}");
        }
        assert!(run.advance_to(4.0).is_err() && run.advance_to(f64::INFINITY).is_err());
        assert!(error(run.advance_to(9.0).expect("a state"), &rational_at(9.0)) < 5.0);
        assert_eq!(run.t(), 9.0);
    });
}

#[test]
fn a_start_that_is_not_finite() {
    let (sphere, free) = (turning(), rational());
    let method = Rkmk::new(DOPRI5, Exp);
    for bad in [f64::NAN, f64::INFINITY] {
        let start = V::new(0.0, bad, 0.0);
        let solve = Solve::new(&free, &method, [5.0, 9.0]).tolerances(1e-6, 1e-6);
        assert!(solve.run(start).expect_err("a start").to_string().starts_with('y'));
        for solve in [
            Solve::new(&sphere, &method, [0.0, 1.0]).tolerances(1e-6, 1e-6),
            Solve::new(&sphere, &method, [0.0, 0.0]).dt(0.1),
        ] {
            let error = solve.run(start).expect_err("a start");
            assert!(
                matches!(error.error, RunError::Setup(_)) && error.solution.is_none(),
                "{error}"
            );
        }
    }
}

#[test]
fn no_evaluation_outside_the_span() {
    let seen = Cell::new([f64::INFINITY, f64::NEG_INFINITY]);
    for span in [[0.0, 1e-4], [0.0, 10.0], [5.0, 0.1], [100.0, 200.0]] {
        let problem = boxed_of_time(So3::new(), Linear, |t: f64, v: &mut V| {
            let [low, high] = seen.get();
            seen.set([low.min(t), high.max(t)]);
            *v = V::new((3.0 * t).cos(), 0.3, (0.5 * t).sin());
        });
        macro_rules! check {
            ($($method:expr),*) => {$(
                let method = $method;
                let solve = || Solve::new(&problem, &method, span).times(times(span, 7))
                    .event(Event::new("never", |_, x: &V| x.x + 2.0));
                for solve in [
                    solve().tolerances(1e-5, 1e-8), solve().steps(90),
                    solve().dt(0.007 * (span[1] - span[0]).abs()),
                    solve().tolerances(1e-3, 1e-3).first_step(1e9).times_by_steps(),
                ] {
                    seen.set([f64::INFINITY, f64::NEG_INFINITY]);
                    solve.run(V::x()).expect("a run");
                    let [low, high] = seen.get();
                    // t + h may be the end only up to rounding.
                    let rounding = 2.0 * f64::EPSILON * span[0].abs().max(span[1].abs());
                    let [least, most] = [span[0].min(span[1]) - rounding, span[0].max(span[1]) + rounding];
                    assert!(low >= least && high <= most, "{span:?}: {low} {high}");
                }
                // What a controller may change is not asked for before it is reached.
                let mut run = solve().tolerances(1e-5, 1e-8).integrator(V::x()).expect("a run");
                for t in times(span, 5) {
                    seen.set([f64::INFINITY, f64::NEG_INFINITY]);
                    run.advance_to(t).expect("a state");
                    let [low, high] = seen.get();
                    let ahead = if span[1] > span[0] { high - t } else { t - low };
                    let rounding = 2.0 * f64::EPSILON * span[0].abs().max(span[1].abs());
                    assert!(low > high || ahead <= rounding, "{ahead}");
                }
            )*};
        }
        check!(Rk(BS3), Rkmk::new(DOPRI5, Exp), Rkmk::new(DOP853, Cay), CommutatorFree(CF43));
    }
}

#[test]
fn an_observer_sees_every_step() {
    let (problem, method) = (rational(), Rk(DOPRI5));
    let mut seen = Vec::new();
    let run = Solve::new(&problem, &method, SPANS[0])
        .tolerances(1e-3, 1e-6)
        .every(1)
        .run_with(rational_at(5.0), |t, y| seen.push((t, *y)))
        .expect("a run");
    assert!(run.times.is_empty() && run.points.is_empty(), "nothing is stored");
    assert_eq!(seen.len() as u64, run.stats.accepted + 1);
    assert_eq!((seen[0], seen[seen.len() - 1]), ((5.0, rational_at(5.0)), (9.0, run.y)));
    // Every third, and the end.
    for equal in [false, true] {
        let solve = || match equal {
            true => Solve::new(&problem, &method, SPANS[0]).steps(20),
            false => Solve::new(&problem, &method, SPANS[0]).tolerances(1e-6, 1e-9),
        };
        let all = solve().every(1).run(rational_at(5.0)).expect("a run").times;
        let third = solve().every(3).run(rational_at(5.0)).expect("a run").times;
        let mut expected: Vec<f64> = all.iter().copied().step_by(3).collect();
        if (all.len() - 1) % 3 != 0 {
            expected.push(9.0);
        }
        assert_eq!(third, expected);
    }
}

#[test]
fn an_observer_stops_the_run() {
    let (problem, method) = (rational(), Rk(DOPRI5));
    let solve = || Solve::new(&problem, &method, SPANS[0]).tolerances(1e-6, 1e-9);
    let mut calls = 0;
    let run = solve()
        .every(1)
        .run_with(rational_at(5.0), |t, y| {
            calls += 1;
            *y = V::repeat(f64::NAN); // what is written there is not used
            if t > 5.0 { Next::Stop } else { Next::Continue }
        })
        .expect("a run");
    assert_eq!((calls, run.stats.accepted, &run.status), (2, 1, &Status::Observer));
    assert!(error(&run.y, &rational_at(run.t)) < 1.0);
    // Within a step: the state is the one that was shown.
    for by_steps in [false, true] {
        let solve = solve().times([5.001, 6.0, 7.0]);
        let solve = if by_steps { solve.times_by_steps() } else { solve };
        let mut last = None;
        let run = solve
            .run_with(rational_at(5.0), |t, y| {
                last = Some(*y);
                if t == 6.0 { Next::Stop } else { Next::Continue }
            })
            .expect("a run");
        assert_eq!((run.t, Some(run.y)), (6.0, last));
    }
}
