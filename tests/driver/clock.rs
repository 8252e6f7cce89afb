//! Times of a clock: t is large beside the steps.

use core::cell::Cell;
use core::f64::consts::TAU;

use crate::support::boxed::boxed_of_time;
use lieflow::actions::{LeftTranslation, Linear};
use lieflow::groups::{So3, Translations};
use lieflow::maps::Exp;
use lieflow::methods::commutator_free::{CF4, CF43};
use lieflow::methods::magnus::Magnus4;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, RK4};
use lieflow::methods::{CommutatorFree, Doubling, Rk, Rkmk};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::problems::{Flow, LinearFlow, Problem};
use lieflow::{Solve, Stats};

/// Turns about z at this rate.
fn turn(
    rate: impl Fn(f64) -> f64 + Copy,
) -> LinearFlow<So3<f64>, LeftTranslation, impl Fn(f64, &mut Vector3<f64>) + Copy> {
    Flow::of_time(So3::new(), LeftTranslation, move |t, v: &mut Vector3<f64>| v.z = rate(t))
}

/// Turns about z at a rate that records its times.
fn turn_by<'a>(
    rate: impl Fn(f64) -> f64 + 'a,
) -> impl Problem<Group = So3, Action = LeftTranslation> + 'a {
    boxed_of_time(So3::new(), LeftTranslation, move |t, v: &mut Vector3<f64>| v.z = rate(t))
}

fn angle(y: &Matrix3<f64>) -> f64 {
    y[(1, 0)].atan2(y[(0, 0)])
}

/// f jumps every second: it is 1 in even seconds and 2 in odd ones. A step ends at each jump.
///
/// A step that begins anywhere else has its whole size. One from a jump to the next has no stage at either: it is shorter by a
/// rounding of t at each.
#[test]
fn steps_to_jumps_have_their_whole_size() {
    let (from, n) = (1e6_f64, 100);
    let to = from + f64::from(n);
    let jumps: Vec<f64> = (0..=n).map(|k| from + f64::from(k)).collect();
    let exact = 1.5 * f64::from(n);
    for span in [[from, to], [to, from]] {
        let forward = span[1] > span[0];
        // Backward, f(t) is the value at earlier times.
        let second = move |t: f64| if forward { t.floor() } else { t.ceil() - 1.0 };
        let flow = turn(move |t| 1.0 + second(t).rem_euclid(2.0));
        let check = |y: Matrix3<f64>, most: f64, case: &str| {
            let gap = angle(&y) - exact.copysign(span[1] - span[0]);
            let error = (gap - TAU * (gap / TAU).round()).abs();
            assert!(error < most, "{span:?} {case}: {error:e}");
        };
        macro_rules! check {
            ($($method:expr),*) => {$(
                let method = $method;
                let solve = || Solve::new(&flow, &method, span).stops(jumps.clone());
                // A rounding of t is 1.2e-10. There are 100 steps at rates of 1 and 2.
                for (dt, most) in [(0.25, 1e-11), (0.3, 1e-11), (1.0, 2.0 * 1.8e-8)] {
                    let run = solve().dt(dt).run(Matrix3::identity()).expect("a run");
                    check(run.y, most, &format!("{dt}"));
                }
                let run = solve().tolerances(1e-13, 1e-13).run(Matrix3::identity());
                check(run.expect("a run").y, 2.0 * 1.8e-8, "by error");
            )*};
        }
        check![Rkmk::new(DOPRI5, Exp), Rkmk::new(DOP853, Exp)];
    }
}

/// No stage is before the start of a run, nor after its end, nor after a time that the caller asks for: f may have no value
/// there.
#[test]
fn no_stage_is_after_the_end() {
    let (least, most) = (Cell::new(f64::INFINITY), Cell::new(f64::NEG_INFINITY));
    let flow = turn_by(|t| {
        least.set(least.get().min(t));
        most.set(most.get().max(t));
        1e-3 * (1.0 + t.sin())
    });
    macro_rules! check {
        ($($method:expr),*) => {$(
            let method = $method;
            for (a, b) in [(0.1, 1.0), (0.0, 0.3), (-0.7, 1.1), (5.3, 1e4), (-2.0 / 3.0, 1e-9)] {
                for span in [[a, b], [b, a]] {
                    let within = |what: &str| {
                        let [from, to] = [least.take(), most.take()];
                        least.set(f64::INFINITY);
                        most.set(f64::NEG_INFINITY);
                        assert!(from >= a && to <= b, "{span:?} {what}: f at {from} to {to}");
                    };
                    for steps in [1, 3, 7, 10, 49] {
                        let run = Solve::new(&flow, &method, span).steps(steps);
                        run.run(Matrix3::identity()).expect("a run");
                        within(&format!("{steps} steps"));
                    }
                    let run = Solve::new(&flow, &method, span).tolerances(1e-6, 1e-6);
                    run.run(Matrix3::identity()).expect("a run");
                    within("by error");
                }
            }
            let mut run = Solve::new(&flow, &method, [0.0, 1.0]).dt(0.03).integrator(Matrix3::identity()).expect("a run");
            for t in [0.3, 0.6, 0.7] {
                run.advance_to(t).expect("a run");
                assert!(run.t() == t && most.get() <= t, "{} after {t}", most.get());
            }
            least.set(f64::INFINITY);
            most.set(f64::NEG_INFINITY);
        )*};
    }
    check![
        Rkmk::new(DOPRI5, Exp),
        Rkmk::new(DOP853, Exp),
        Rk(DOPRI5),
        CommutatorFree(CF43),
        Doubling(Rkmk::new(RK4, Exp))
    ];
}

/// f jumps at each time of a grid whose times are rounded. No step of this grid has a stage behind the jump at its end.
#[test]
fn jumps_at_rounded_times_of_a_grid_are_not_passed() {
    for (t0, dt) in [(1e6, 0.1), (1e4, 0.01), (100.0, 0.1)] {
        let n = 200;
        let times: Vec<f64> = (0..=n).map(|k| t0 + f64::from(k) * dt).collect();
        let jumps = times.clone();
        // 1 in even parts, and 2 in odd ones.
        let flow = boxed_of_time(So3::new(), LeftTranslation, |t, v: &mut Vector3<f64>| {
            let part = times.partition_point(|time| *time <= t).max(1) - 1;
            v.z = 1.0 + (part % 2) as f64;
        });
        let method = Rkmk::new(DOPRI5, Exp);
        let span = [t0, times[n as usize]];
        let solve = Solve::new(&flow, &method, span).dt(dt).stops(jumps);
        let run = solve.run(Matrix3::identity()).expect("a run");
        let gap = angle(&run.y) - 1.5 * f64::from(n) * dt;
        let error = (gap - TAU * (gap / TAU).round()).abs();
        // Each step misses a rounding of t at both ends at most, at a rate of 1.5.
        let most = 3.0 * f64::from(n) * f64::EPSILON * t0 + 1e-13;
        assert!(error < most, "{t0} {dt}: {error:e} of {most:e}");
    }
}

/// The rounding of t in f is no reason for small steps: a rate of cos t at times of a clock, with tolerances far below that
/// rounding. There are no more of them than near t = 0, but for a search after 256 steps. The error after 20 s is below that
/// of an f that is ε·t late.
#[test]
fn the_rounding_of_time_makes_no_steps_small() {
    for t0 in [1e6_f64, 1.7e9] {
        let span = [t0, t0 + 20.0];
        let exact = span[1].sin() - span[0].sin();
        let flow = turn(f64::cos);
        macro_rules! check {
            ($($method:expr),*) => {$(
                for tolerance in [1e-14, 1e-11, 1e-8, 1e-5] {
                    let method = $method;
 let solve = Solve::new(&flow, &method, span).tolerances(tolerance, tolerance);
                    let run = solve.run(Matrix3::identity()).expect("a run");
                    let error = (angle(&run.y) - exact).abs();
                    let Stats { accepted, rejected, .. } = run.stats;
                    let case = format!("{t0:e} {tolerance:e}: {accepted} {rejected} {error:e}");
                    let allowed = 100.0 * tolerance + 20.0 * f64::EPSILON * t0;
                    let near_0 = Solve::new(&flow, &method, [0.0, 20.0]).tolerances(tolerance, tolerance);
                    let near_0 = near_0.run(Matrix3::identity()).expect("a run").stats.accepted;
                    let most = near_0 + near_0 / 5 + 300;
                    assert!(error < allowed && accepted + rejected < most, "{case} {near_0}");
                }
            )*};
        }
        check![Rkmk::new(DOPRI5, Exp), Rkmk::new(DOP853, Exp), Rk(DOPRI5), Doubling(Magnus4)];
    }
}

/// Errors that are distances of points count relative to the length of a short step. There the part that is rounding of t
/// does not fall with the step size. A vector in a field that turns.
#[test]
fn errors_of_points_at_times_of_a_clock() {
    let t0 = 1.7e9;
    let field = |t0: f64, w: f64| {
        let f = move |t: f64, v: &mut Vector3<f64>| {
            let (sin, cos) = (w * (t - t0)).sin_cos();
            *v = Vector3::new(cos, sin, 0.5);
        };
        boxed_of_time(So3::<f64>::new(), Linear, f)
    };
    for (w, rtol) in [(1.0, 1e-9), (10.0, 1e-9), (100.0, 1e-9), (100.0, 1e-6)] {
        let (near_0, fine) = (field(0.0, w), Rkmk::new(DOP853, Exp));
        let reference = Solve::new(&near_0, &fine, [0.0, 10.0]);
        let exact = reference.tolerances(1e-13, 1e-13).run(Vector3::x()).expect("a run").y;
        let flow = field(t0, w);
        macro_rules! check {
            ($($method:expr),*) => {$(
                let method = $method;
                let solve = Solve::new(&flow, &method, [t0, t0 + 10.0]).tolerances(rtol, 0.0);
                let run = solve.max_steps(100_000).run(Vector3::x());
                let run = run.unwrap_or_else(|e| panic!("{} {w} {rtol:e}: {e}", stringify!($method)));
                let error = (run.y - exact).norm();
                // f changes by wεt₀ in a rounding of t.
                let allowed = 300.0 * rtol + 10.0 * w * f64::EPSILON * t0;
                assert!(error < allowed, "{} {w} {rtol:e}: {error:e}", stringify!($method));
            )*};
        }
        check![Rk(DOPRI5), Rk(DOP853), CommutatorFree(CF43), Doubling(CommutatorFree(CF4))];
    }
}

/// A field that does not know the time is integrated to the tolerance, whatever the time.
#[test]
fn an_autonomous_field_keeps_its_tolerance() {
    use lieflow::problems::RigidBody;
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("moments");
    let start = Vector3::new(0.2, 1.0, 0.4);
    let run = |t0: f64, tolerance: f64| {
        let method = Rkmk::new(DOP853, Exp);
        let solve = Solve::new(&body, &method, [t0, t0 + 16.0]).tolerances(tolerance, tolerance);
        solve.run(start).expect("a run")
    };
    for tolerance in [1e-9, 1e-13] {
        let (here, there) = (run(0.0, tolerance), run(1e9, tolerance));
        assert!((here.y - there.y).norm() < 10.0 * tolerance, "{tolerance:e}");
        assert!(here.stats.accepted.abs_diff(there.stats.accepted) <= 2);
    }
}

/// A run that is saved and restored between two measurements of the noise takes the same steps.
#[test]
fn a_restored_run_has_the_same_noise() {
    let t0 = 1.7e9;
    let flow = turn(f64::cos);
    let method = Rkmk::new(DOPRI5, Exp);
    let new = || {
        let solve = Solve::new(&flow, &method, [t0, t0 + 20.0]).tolerances(1e-11, 1e-11);
        solve.integrator(Matrix3::identity()).expect("a start")
    };
    let (mut run, mut saved) = (new(), Vec::new());
    while !run.is_done() {
        saved.push(run.save());
        run.step().expect("a step");
    }
    for bytes in saved.iter().step_by(7) {
        let mut other = new();
        other.restore(bytes).expect("a state");
        other.advance_to(t0 + 20.0).expect("steps");
        assert_eq!((other.y(), other.stats()), (run.y(), run.stats()));
    }
}

/// f jumps, and atol is 0: steps shrink there to the rounding of t, and go on.
#[test]
fn a_jump_is_passed_with_rtol_alone() {
    type Numbers = Box<[f64]>;
    let zero: Numbers = vec![0.0; 3].into();
    let group = Translations::new(zero, 3);
    let flow = boxed_of_time(group, LeftTranslation, |t: f64, v: &mut Numbers| {
        (v[0], v[1]) = (0.02 * (0.3 * t).sin().signum(), 0.01);
    });
    let start: Numbers = vec![0.1, 0.2, 0.3].into();
    // 38 jumps, of which each second takes back what the one before did.
    let exact = 0.1 + 0.02 * (400.0 - 38.0 * core::f64::consts::PI / 0.3);
    let check = |rtol: f64, run: Result<lieflow::Solution<Numbers>, String>| {
        let run = run.unwrap_or_else(|error| panic!("{rtol:e}: {error}"));
        let error = (run.y[0] - exact).abs();
        assert!(error < 100.0 * rtol && run.stats.accepted < 20_000, "{error:e}: {:?}", run.stats);
    };
    for rtol in [1e-3, 1e-6, 1e-9] {
        let cf = CommutatorFree(CF43);
        let solve = Solve::new(&flow, &cf, [0.0, 400.0]).tolerances(rtol, 0.0).max_steps(50_000);
        check(rtol, solve.run(start.clone()).map_err(|failed| failed.error.to_string()));
        let solve =
            Solve::new(&flow, &Rk(BS3), [0.0, 400.0]).tolerances(rtol, 0.0).max_steps(50_000);
        check(rtol, solve.run(start.clone()).map_err(|failed| failed.error.to_string()));
    }
}
