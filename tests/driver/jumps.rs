//! Jumps of f: stops around t = 0, the value of f at a stop, jumps without a stop, and long steps where nothing happens.

use crate::support::boxed::boxed_flow;
use lieflow::actions::{Conjugation, LeftTranslation, Linear};
use lieflow::faer::{Mat, c64};
use lieflow::groups::{
    AlgebraMatrix, ComplexMatrix, LieAlgebra, LieGroup, MatrixGroup, So3, Unitary,
};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::methods::commutator_free::{CF4, CF43};
use lieflow::methods::low_storage::LS32;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, HEUN, RK4};
use lieflow::methods::{CommutatorFree, Doubling, GAUSS4, LowStorage, Rk, Rkmk, RkmkGauss};
use lieflow::problems::{Flow, Problem};
use lieflow::samples::{Interpolation, Samples};
use lieflow::so3;
use lieflow::solve::Stops;
use lieflow::tolerance::Rule;
use lieflow::{Event, Solve, StepControl};
use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;
type Rate = fn(f64) -> f64;

/// A turn about e₃ with this rate: what it ends at is the angle.
fn spin<'a>(rate: impl Fn(f64) -> f64 + 'a) -> impl Problem<Group = So3, Action = Linear> + 'a {
    boxed_flow(So3::new(), Linear, move |t, _: &V, v: &mut V| *v = V::new(0.0, 0.0, rate(t)))
}

fn angle(y: &V) -> f64 {
    y[1].atan2(y[0])
}

/// A step from a stop to the next one, where 0 is between them, ended never: it is longer than both times.
#[test]
fn stops_on_both_sides_of_zero() {
    let pulse = spin(|t| if (-0.6..0.6).contains(&t) { 1.0 } else { 0.5 });
    for [t0, t1] in [[-6.0, 2.0], [2.0, -6.0], [-0.7, 0.61], [-0.6, 0.6], [-1e3, 1e3]] {
        let exact = {
            let within = |t: f64| t.clamp(-0.6, 0.6);
            0.5 * (t1 - t0) + 0.5 * (within(t1) - within(t0))
        };
        let method = Rkmk::new(DOPRI5, Exp);
        let solve = || Solve::new(&pulse, &method, [t0, t1]).stops([-0.6, 0.6]);
        for run in [
            solve().tolerances(1e-6, 0.0),
            solve().tolerances(1e-3, 1e-3),
            solve().steps(5),
            solve().steps(1),
        ] {
            let end = angle(&run.run(V::x()).expect("a run").y);
            assert!((end - exact).sin().abs() < 1e-12, "{t0} to {t1}: {end}, expected {exact}");
        }
    }
}

/// A grid that begins far from 0 has times with the rounding of its start, which is much near 0.
#[test]
fn stops_near_zero_in_a_grid_from_afar() {
    let mut steps = 0;
    for k in 0..2000 {
        let x = f64::from(k);
        let (t0, t1, jump) = (-1.38 - 1e-4 * x, 0.05, 1e-3 * (0.7 * x).sin());
        let problem = spin(move |t| if t < jump { 1.0 } else { 50.0 });
        let method = Rkmk::new(RK4, Exp);
        let run = Solve::new(&problem, &method, [t0, t1]).dt(0.013).stops([jump]).run(V::x());
        let run = run.expect("a run");
        let exact = jump - t0 + 50.0 * (t1 - jump);
        // A stage behind the jump makes up to 0.1.
        let off = (angle(&run.y) - exact).sin().abs();
        assert!(off < 1e-12, "{t0}, {jump}: {off}");
        steps += run.stats.accepted;
    }
    assert!(steps > 200_000);
    // A time of the grid that is 0 but for rounding is the stop.
    let still = spin(|_| 1.0);
    for h in [0.1, 0.07, 0.01, 0.13, 0.3, 0.02, 0.25, 0.007] {
        for n in 2..60 {
            let t0: f64 = format!("{:.6}", -f64::from(n) * h).parse().expect("a number");
            let method = Rkmk::new(RK4, Exp);
            let run = Solve::new(&still, &method, [t0, 5.0 * h]).dt(h).stops([0.0]).run(V::x());
            let stats = run.expect("a run").stats;
            assert_eq!(stats.accepted, n as u64 + 5, "{t0} by {h}");
            assert!(stats.smallest_step > 0.999 * h, "{t0} by {h}: {}", stats.smallest_step);
        }
    }
}

/// At a stop f may have a third value, as sign(0) = 0, or that of the other side, as t ≥ 3 in a run backward.
#[test]
fn the_value_of_f_at_a_stop_counts_for_nothing() {
    let rates: [(&str, Rate); 3] = [
        ("sign", |t| if t == 3.0 { 5.0 } else { f64::from(u8::from(t > 3.0)) }),
        ("from", |t| f64::from(u8::from(t >= 3.0))),
        ("after", |t| f64::from(u8::from(t > 3.0))),
    ];
    for (name, rate) in rates {
        let problem = spin(rate);
        for span in [[2.0, 4.0], [4.0, 2.0]] {
            macro_rules! check {
                ($($method:expr),*) => {$({
                    let method = $method;
                    let solve = || Solve::new(&problem, &method, span).stops([3.0]);
                    for run in [solve().dt(0.25), solve().dt(0.3), solve().tolerances(1e-8, 1e-8)] {
                        let run = run.run(V::x()).expect("a run");
                        let off = (angle(&run.y).abs() - 1.0).abs();
                        assert!(off < 1e-13, "{name}, {}, {span:?}: {off}", stringify!($method));
                        assert_eq!(run.stats.rejected, 0, "{name}, {}, {span:?}", stringify!($method));
                    }
                })*};
            }
            check![Rkmk::new(DOP853, Exp), Rkmk::new(DOPRI5, Exp), CommutatorFree(CF43)];
        }
    }
}

/// A rate that is held from one time to the next, over spans that begin and end at such times, or elsewhere, and in both
/// directions. At times of a clock, steps by error lose no time.
#[test]
fn a_held_value_has_no_error() {
    let values: Vec<f64> = (0..=40).map(|k| f64::from((7 * k) % 11) - 4.5).collect();
    for t0 in [0.0, -1.0, 1.7e9] {
        let times: Vec<f64> = (0..=40).map(|k| t0 + 0.05 * f64::from(k)).collect();
        let held = Samples::new(&times, &[&values], Interpolation::Previous).expect("samples");
        let problem = spin(|t| held.column(0, t).unwrap_or(f64::NAN));
        let [first, last] = held.span();
        for [from, to] in [[first, last], [times[3], times[8]], [first + 0.12, last - 0.03]] {
            let within = |t: f64| t.clamp(from, to);
            let parts = times.windows(2).zip(&values);
            let exact: f64 = parts.map(|(w, x)| x * (within(w[1]) - within(w[0]))).sum();
            for (span, exact) in [([from, to], exact), ([to, from], -exact)] {
                macro_rules! check {
                    ($($method:expr),*) => {$({
                        let method = $method;
                        let stops = Stops::at_knots(&held, span);
                        let solve = || Solve::new(&problem, &method, span).stops(stops.clone());
                        let by_error = solve().tolerances(1e-8, 0.0).run(V::x()).expect("a run");
                        // The state has a rounding in each step.
                        let off = (angle(&by_error.y) - exact).sin().abs();
                        assert!(off < 1e-13, "{}, {span:?}: {off}", stringify!($method));
                        let by_steps = solve().dt(0.03).run(V::x()).expect("a run");
                        let off = (angle(&by_steps.y) - exact).sin().abs();
                        // Beside a jump a step of one size has no room for 4 ε|t|.
                        let bound = 1e-13 + 1e3 * f64::EPSILON * t0.abs();
                        assert!(off < bound, "{}, {span:?}: {off}", stringify!($method));
                    })*};
                }
                check![
                    Rkmk::new(DOPRI5, Exp),
                    Rkmk::new(DOP853, Exp),
                    CommutatorFree(CF43),
                    Doubling(Rkmk::new(RK4, Exp))
                ];
            }
        }
    }
}

/// Where times are large, the noise of a step is measured: beside a stop, too, and not by the value of f there.
#[test]
fn noise_beside_a_stop_is_not_its_jump() {
    // The time of the stops after t₀, and the factor of f after each.
    let stops = [0.21, 0.29];
    let calls = core::cell::Cell::new(0);
    let from = |t0: f64| {
        let calls = &calls;
        boxed_flow(So3::new(), Linear, move |t: f64, _: &V, v: &mut V| {
            calls.set(calls.get() + u32::from(stops.iter().any(|stop| t == t0 + stop)));
            let x = t - t0;
            let factor = [1.0, -1.5, 2.0][stops.iter().filter(|stop| t > t0 + *stop).count()];
            *v = V::new((1.7 * x).cos(), 0.8 * (2.0 * x).sin() + 0.4, 1.1 + 0.6 * x) * factor;
        })
    };
    let start = V::new(0.6, 0.0, 0.8);
    macro_rules! end {
        ($t0:expr, $rtol:expr, $method:expr) => {{
            let (t0, method): (f64, _) = ($t0, $method);
            let problem = from(t0);
            let control = StepControl::new($rtol, 0.0).expect("tolerances");
            let run = Solve::new(&problem, &method, [t0, t0 + 1.5]).control(control);
            run.stops(stops.map(|stop| t0 + stop)).run(start).expect("a run").y
        }};
    }
    let exact = end!(0.0, 1e-14, Rkmk::new(DOP853, Exp));
    for t0 in [1e5, 2.39e6] {
        macro_rules! check {
            ($($method:expr),*) => {$({
                calls.set(0);
                let off = (end!(t0, 1e-10, $method) - exact).norm();
                // The times of stages have a rounding of ε/2·t.
                let bound = 3e-9 + 10.0 * f64::EPSILON * t0;
                assert!(off < bound, "{}, {t0}: {off:e}", stringify!($method));
                assert_eq!(calls.get(), 0, "{}, {t0}", stringify!($method));
            })*};
        }
        check![
            Doubling(CommutatorFree(CF4)),
            Doubling(Rkmk::new(RK4, Exp)),
            Rkmk::new(DOP853, Exp),
            Rk(DOPRI5)
        ];
    }
}

/// Where errors are relative to the length of a step, both fall with the step size beside a jump of f.
#[test]
fn jumps_without_a_stop_are_passed() {
    for (at, after) in [(5000.1, 2.0), (100.3, -30.0), (1.1, 1000.0)] {
        let problem = spin(move |t| if t < at { 1.0 } else { after });
        let exact = 1.0 + after;
        macro_rules! pass {
            ($($method:expr),*) => {$(for rtol in [1e-3, 1e-6, 1e-8] {
                let control = StepControl::new(rtol, 0.0).expect("tolerances");
                let method = $method;
                let run = Solve::new(&problem, &method, [at - 1.0, at + 1.0]).control(control);
                let run = run.run(V::x()).expect(stringify!($method));
                let off = (angle(&run.y) - exact).sin().abs();
                assert!(off < 100.0 * rtol, "{} at {at}, rtol = {rtol}: {off}", stringify!($method));
            })*};
        }
        pass![
            CommutatorFree(CF43),
            LowStorage(LS32),
            Rkmk::new(DOPRI5, Exp),
            Rkmk::new(DOP853, Exp),
            Rkmk::new(DOP853, Exp),
            Rk(DOPRI5),
            Rk(DOP853)
        ];
    }
}

/// By the length of a step no step over a jump is short enough: it counts as a whole one, and the steps grow again.
#[test]
fn jumps_are_passed_by_the_length_of_steps() {
    for (at, after) in [(0.4046, 1.0), (0.7, -30.0), (0.25, -2.0)] {
        let problem = spin(move |t| if t < at { 0.01 } else { after });
        let exact = 0.01 * at + after * (1.0 - at);
        macro_rules! pass {
            ($($method:expr),*) => {$(for rtol in [1e-3, 1e-5, 1e-7] {
                let control = StepControl::new(rtol, 0.0).expect("tolerances").rule(Rule::PerLength);
                let control = control.max_step(2.5e-3).expect("a step");
                let method = $method;
                let run = Solve::new(&problem, &method, [0.0, 1.0]).control(control);
                let run = run.run(V::x()).expect(stringify!($method));
                let off = (angle(&run.y) - exact).sin().abs();
                assert!(off < 100.0 * rtol, "{} at {at}, rtol = {rtol}: {off}", stringify!($method));
                let attempts = run.stats.accepted + run.stats.rejected;
                assert!(attempts < 2000, "{} at {at}, rtol = {rtol}: {attempts}", stringify!($method));
            })*};
        }
        pass![
            Doubling(Rkmk::new(RK4, Exp)),
            Doubling(CommutatorFree(CF4)),
            CommutatorFree(CF43),
            LowStorage(LS32),
            Rkmk::new(DOPRI5, Exp),
            Rkmk::new(DOP853, Exp),
            Rk(DOPRI5),
            Rk(DOP853)
        ];
    }
}

/// A skew matrix.
fn skew(n: usize) -> Mat<f64> {
    let x = |i: usize, j: usize| ((3 * i + 7 * j + i * j) as f64).sin();
    Mat::from_fn(n, n, |i, j| x(i, j) - x(j, i))
}

/// f that hardly changes allows long steps. What lies within them is as right as their ends, and on the group.
#[test]
fn rows_within_long_steps() {
    let so4 = MatrixGroup::so(4).expect("a group");
    let times: Vec<f64> = (0..=200).map(|k| 0.5 * f64::from(k)).collect();
    let phase = |t: f64| t + 2.0 * (1.0 - (0.05 * t).cos());
    for rtol in [1e-3, 1e-6, 1e-9] {
        for changes in [0.0, 1.0] {
            let a = skew(4);
            let field = |t: f64, _: &_, v: &mut AlgebraMatrix| {
                let rate = 1.0 + changes * 0.1 * (0.05 * t).sin();
                (0..4).for_each(|j| (0..4).for_each(|i| v.as_mut()[(i, j)] = rate * a[(i, j)]));
            };
            let problem = boxed_flow(so4.clone(), LeftTranslation, field);
            let exact = |t: f64| {
                let turn = if changes == 0.0 { t } else { phase(t) };
                let mut u = so4.zero();
                let from = so4.algebra(a.clone()).expect("an element");
                so4.axpy(turn, &from, &mut u);
                Exp.eval(&so4, &u).expect("exp")
            };
            // The largest error of a row.
            macro_rules! off {
                ($method:expr) => {{
                    let method = $method;
                    let run = Solve::new(&problem, &method, [0.0, 100.0]).tolerances(rtol, 0.0);
                    let run = run.times(&times[..]).run(so4.identity()).expect("a run");
                    let rows = run.times.iter().zip(&run.points);
                    rows.map(|(t, y)| so4.distance(y, &exact(*t))).fold(0.0, f64::max)
                }};
            }
            let off = off!(Rkmk::new(DOP853, Exp));
            assert!(off < rtol.min(1e-7), "dop853, rtol = {rtol}: {off}");
            // Methods in two halves: a row is a shorter step. Their errors are those of the ends of steps.
            let in_halves = [
                off!(Doubling(Rkmk::new(RK4, Exp))),
                off!(Doubling(Rkmk::new(HEUN, Exp))),
                off!(Doubling(Rkmk::new(DOPRI5, Exp))),
                off!(Doubling(RkmkGauss::new(GAUSS4, Exp))),
            ];
            for (number, off) in in_halves.into_iter().enumerate() {
                assert!(
                    off < (1000.0 * rtol).max(1e-7),
                    "{number}, rtol = {rtol}, {changes}: {off}"
                );
            }
        }
    }
}

/// The same on U(3). The trace of a matrix that is conjugated does not drift.
#[test]
fn rows_and_traces_on_unitary_groups() {
    let u3 = Unitary::new(3).expect("a group");
    let h = skew(3);
    let i_h = Mat::from_fn(3, 3, |i, j| {
        let real = ((2 * i.min(j) + 3 * i.max(j)) as f64).cos();
        c64::new(h[(i, j)], real)
    });
    let generator = ComplexMatrix::from_fn(3, 3, |i, j| i_h[(i, j)]);
    let field = |_: f64, _: &_, v: &mut ComplexMatrix| v.clone_from(&generator);
    let problem = boxed_flow(u3, LeftTranslation, field);
    for rtol in [1e-3, 1e-6] {
        let method = Rkmk::new(DOP853, Exp);
        let run = Solve::new(&problem, &method, [0.0, 100.0]).tolerances(rtol, 0.0);
        let run = run.interval(0.5).run(u3.identity()).expect("a run");
        for (t, y) in run.times.iter().zip(&run.points) {
            let mut u = u3.zero();
            u3.axpy(*t, &generator, &mut u);
            let exact = Exp.eval(&u3, &u).expect("exp");
            let off = u3.distance(y, &exact);
            assert!(off < 1e-7, "rtol = {rtol}, t = {t}: {off}");
            assert!(u3.defect(y) < 2e-14, "rtol = {rtol}, t = {t}: {}", u3.defect(y));
        }
    }
    let conjugated = boxed_flow(u3, Conjugation, field);
    let start = ComplexMatrix::from_fn(3, 3, |i, j| {
        c64::new(0.0, if i == j { 1.0 + i as f64 } else { 0.1 })
    });
    let trace = |y: &ComplexMatrix| (0..3).map(|i| y.im[(i, i)]).sum::<f64>();
    let method = CommutatorFree(CF4);
    let run = Solve::new(&conjugated, &method, [0.0, 2e4]).dt(0.1).run(start.clone());
    let drift = trace(&run.expect("a run").y) - trace(&start);
    // It was 4e-12 by the rounding of each step, in a straight line.
    assert!(drift.abs() < 1e-13, "{drift}");
}

/// A wheel whose rate jumps at two stops: every kind of run has the steps of `run`, and its first time is t₀.
#[test]
fn every_kind_of_run_ends_steps_at_stops() {
    let wheel = spin(|t| if (1.0..2.0).contains(&t) { 5.0 } else { 0.5 });
    let method = Rkmk::new(DOPRI5, Exp);
    for [t0, t1] in [[0.0, 3.0], [1.0, 3.0], [3.0, 0.0], [2.0, -1.0]] {
        for by_error in [true, false] {
            let solve = || {
                let solve = Solve::new(&wheel, &method, [t0, t1]).stops([1.0, 2.0]);
                if by_error { solve.tolerances(1e-6, 1e-6) } else { solve.dt(0.3) }
            };
            let case = format!("{t0} to {t1}, by error: {by_error}");
            let run = solve().run(V::x()).expect("a run");
            let turned = |t: f64| 0.5 * t + 4.5 * (t.clamp(1.0, 2.0) - 1.0);
            assert!((angle(&run.y) - turned(t1) + turned(t0)).sin().abs() < 1e-12, "{case}");
            let mut kept = solve().run_continuous(V::x()).expect("a run");
            assert_eq!(kept.solution.y, run.y, "{case}");
            assert_eq!(kept.solution.stats.accepted, run.stats.accepted, "{case}");
            let (with, curve) = solve().run_interpolant(V::x()).expect("a run");
            assert_eq!((with.y, with.stats.accepted), (run.y, run.stats.accepted), "{case}");
            assert_eq!([kept.t_span(), curve.t_span()], [[t0, t1]; 2], "{case}");
            let mut reader = curve.reader().expect("a reader");
            for t in [t0, 1.0, 2.0, t1] {
                let off = |y: &V| (angle(y) - turned(t) + turned(t0)).sin().abs();
                assert!(off(kept.at(t).expect("a point")) < 1e-12, "{case}, {t}");
                assert!(off(reader.at(t).expect("a point")) < 1e-12, "{case}, {t}");
            }
            let mut single = solve().integrator(V::x()).expect("a start");
            while !single.is_done() {
                let (before, y) = (single.t(), *single.y());
                single.step().expect("a step");
                let mut at = V::zeros();
                single.interpolate(before, &mut at).expect("the start of the step");
                assert!((at - y).norm() < 1e-12, "{case}, {before}");
            }
            assert_eq!(*single.y(), run.y, "{case}");
            // A zero at the start is one of the time t₀.
            let event = Event::new("start", |t, _: &V| t - t0);
            let run = solve().event(event).run(V::x()).expect("a run");
            assert_eq!(run.events.first().map(|zero| zero.t), Some(t0), "{case}");
        }
    }
}

/// The times of the stages are numbers of the problem: no stage in f32 is at a stop, nor after it.
#[test]
fn stops_hold_in_single_precision() {
    for at_stop in [0.5, 5.0, 100.0] {
        for t0 in [0.0, 0.5] {
            let rate = |t: f32| match t {
                t if t < 1.0 => 0.5,
                t if t > 1.0 => 5.0,
                _ => at_stop,
            };
            let f = |t: f32, v: &mut Vector3<f32>| *v = Vector3::new(0.0, 0.0, rate(t));
            let flow = Flow::of_time(So3::<f32>::new(), Linear, f);
            let exact = 0.5 * (1.0 - t0) + 5.0;
            macro_rules! ends {
                ($($method:expr),*) => {$({
                    let method = $method;
                    for dt in [0.5, 0.25, 0.1] {
                        let run = Solve::new(&flow, &method, [t0, 2.0]).stops([1.0]).dt(dt);
                        let y = run.run(Vector3::x()).expect("a run").y;
                        let off = (f64::from(y[1].atan2(y[0])) - exact).sin().abs();
                        assert!(off < 1e-5, "{}, {at_stop}, {dt}: {off}", stringify!($method));
                    }
                })*};
            }
            ends![
                Rkmk::new(RK4, Exp),
                Rkmk::new(DOPRI5, Exp),
                Rkmk::new(HEUN, Exp),
                Rkmk::new(BS3, Exp)
            ];
        }
    }
}

/// Steps by error turn by 8 radians at most, also the first ones behind a stop where the rate grows, and a first step that is given:
/// the points within them are right.
#[test]
fn steps_behind_a_stop_turn_little() {
    let axis = V::new(0.6, 0.0, 0.8);
    for rate in [1.0, 5.0] {
        let rate_at = move |t: f64| if t < 400.0 { 0.02 } else { rate };
        let field = move |t: f64, _: &Matrix3<f64>, v: &mut V| *v = rate_at(t) * axis;
        let problem = boxed_flow(So3::new(), LeftTranslation, field);
        let turned = |t: f64| 0.02 * t.min(400.0) + rate * (t - 400.0).max(0.0);
        let off =
            |t: f64, y: &Matrix3<f64>| (y - so3::exp(&(turned(t) * axis)).expect("a turn")).norm();
        macro_rules! little {
            ($($method:expr),*) => {$(for rtol in [1e-3, 1e-6, 1e-9] {
                let method = $method;
                let solve = |span: [f64; 2]| Solve::new(&problem, &method, span).tolerances(rtol, rtol);
                let case = format!("{}, rate {rate}, rtol = {rtol}", stringify!($method));
                let run = solve([0.0, 440.0]).stops([400.0]).count(4401).run(Matrix3::identity());
                let run = run.expect("a run");
                assert!(run.stats.largest_step <= 8.0 / 0.02, "{case}: {:?}", run.stats);
                let rows = run.times.iter().zip(&run.points);
                let most = rows.map(|(t, y)| off(*t, y)).fold(0.0, f64::max);
                assert!(most < 1e-3 * rtol.max(1e-7), "{case}: {most:e}");
                // A first step that is given.
                let first = solve([500.0, 900.0]).first_step(300.0).count(4001);
                let run = first.run(so3::exp(&(turned(500.0) * axis)).expect("a turn")).expect("a run");
                assert!(run.stats.largest_step * rate <= 8.0, "{case}: {:?}", run.stats);
                let rows = run.times.iter().zip(&run.points);
                let most = rows.map(|(t, y)| off(*t, y)).fold(0.0, f64::max);
                assert!(most < 1e-3 * rtol.max(1e-7), "{case}, first step: {most:e}");
            })*};
        }
        little![Rkmk::new(DOPRI5, Exp), Rkmk::new(DOP853, Exp), Rkmk::new(BS3, Exp)];
    }
}
