//! Steps of their own size: tolerances are met, times are hit exactly, and whatever goes wrong ends
//! with an error that says where.

use crate::support::gap;
use crate::support::orders::{reference_after, wave};
use crate::support::points::Points;
use lieflow::actions::{LeftTranslation, Linear};
use lieflow::groups::{MatrixGroup, So3};
use lieflow::maps::{CCSK, CCSK123, Cay, Exp};
use lieflow::methods::commutator_free::{CF4, CF43};
use lieflow::methods::low_storage::LS32;
use lieflow::methods::magnus::{Magnus4, Magnus6};
use lieflow::methods::one_bracket::MAGNUS43;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, RK4, RKF45, VERNER6};
use lieflow::methods::{
    AnyMethod, CommutatorFree, Doubling, Embedded, LowStorage, Metric, OneBracket, Rk, Rkmk,
};
use lieflow::problems::{Exact, Flow, LinearFlow, PointOf, Problem, RigidBody, RigidBodyAttitude};
use lieflow::{Error, LieAlgebra, LieGroup, SaveAt, StepError};
use lieflow::{RunError, Stats, StepControl, integrate_adaptive};
use nalgebra::{Matrix3, Vector3};

fn control(rtol: f64, atol: f64) -> StepControl {
    StepControl::new(rtol, atol).expect("tolerances")
}

/// The state at the end and the statistics, or why there are none. The driver is compiled once for each problem.
fn go<P: Problem, M: Embedded<P> + Clone + Send + Sync>(
    problem: &P,
    method: &M,
    span: [f64; 2],
    control: &StepControl,
    start: &PointOf<P>,
) -> Result<(PointOf<P>, Stats), RunError>
where
    P::Group: LieAlgebra<Scalar = f64>,
    PointOf<P>: Metric<Scalar = f64>,
{
    let mut y = start.clone();
    let method = AnyMethod::embedded(method.clone());
    let stats =
        integrate_adaptive(problem, &method, span, control, &SaveAt::Ends, &mut y, |_, _| {})?;
    Ok((y, stats))
}

#[test]
fn every_pair_meets_its_tolerance_on_every_group() {
    crate::on_every_group!(wave, 1, flows => {
        let Some((flow, start)) = flows.into_iter().next() else { panic!("a problem") };
        let exact = reference_after(2.0, &flow, start);
        macro_rules! check {
            ($($method:expr),* $(,)?) => {$(
                let mut errors = Vec::new();
                for tol in [1e-4, 1e-6, 1e-8] {
                    let (y, stats) =
                        go(&flow, &$method, [0.3, 2.3], &control(tol, tol), exact.start())
                            .expect("a run");
                    let found = flow.action().numbers(flow.group(), &y);
                    let error = gap(&found, exact.end()) / exact.end().norm_l2();
                    println!(
                        "{:8} {:28} {tol:e}: {error:.1e}, {} + {} steps, {:?} f",
                        flow.group().name(), stringify!($method), stats.accepted, stats.rejected,
                        stats.evaluations
                    );
                    // Errors add up over the steps and grow with the flow.
                    assert!(error < 100.0 * tol, "{} at {tol}: {error}", stringify!($method));
                    assert!(stats.rejected <= 6 + stats.accepted / 4, "{stats:?}");
                    errors.push(error);
                }
                assert!(errors.is_sorted_by(|a, b| a > b), "a smaller tolerance must pay: {errors:?}");
                assert!(errors[2] < 0.01 * errors[0], "a smaller tolerance must pay: {errors:?}");
            )*};
        }
        check!(
            Rkmk::new(BS3, Exp), Rkmk::new(RKF45, Exp), Rkmk::new(DOPRI5, Exp),
            Rkmk::new(DOPRI5, Cay), Rkmk::new(VERNER6, Exp), Rkmk::new(DOP853, Exp),
            Rk(DOPRI5), CommutatorFree(CF43), LowStorage(LS32), OneBracket(MAGNUS43),
            Doubling(CommutatorFree(CF4)),
        );
    });
}

#[test]
fn the_attitude_of_a_rigid_body() {
    let (inertia, momentum) = ([1.0, 2.0, 3.0], [0.2, 0.5, 3.0]);
    let body = RigidBodyAttitude::new(inertia, momentum).expect("a body");
    let exact = Exact::new(inertia, momentum, Matrix3::identity()).expect("a motion");
    let (_, end) = exact.state(20.0).expect("a state");
    for tol in [1e-6, 1e-9, 1e-12] {
        let method = Rkmk::new(DOP853, Exp);
        let (g, stats) = go(&body, &method, [0.0, 20.0], &control(tol, tol), &Matrix3::identity())
            .expect("a run");
        // The way is about |ω|·20 = 20 long.
        assert!((g - end).norm() < 100.0 * tol, "{tol}: {} {stats:?}", (g - end).norm());
        assert!(So3::new().defect(&g) < 1e-13);
    }
}

/// T2: forward and back.
#[test]
fn backward_time_returns() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let start = Vector3::new(0.2, 0.5, 3.0);
    let (method, control) = (Rkmk::new(DOPRI5, Exp), control(1e-10, 1e-10));
    let (end, there) = go(&body, &method, [0.0, 10.0], &control, &start).expect("there");
    let (back, again) = go(&body, &method, [10.0, 0.0], &control, &end).expect("back");
    assert!((end - start).norm() > 0.01);
    assert!((back - start).norm() < 1e-7, "{}", (back - start).norm());
    assert!(there.accepted > 20 && again.accepted > 20);
}

/// T1, T3, T4, T11: spans and arguments.
#[test]
fn spans_and_arguments() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let start = Vector3::new(0.2, 0.5, 3.0);
    let method = Rkmk::new(DOPRI5, Exp);
    let tols = control(1e-6, 1e-6);
    let (y, stats) = go(&body, &method, [1.0, 1.0], &tols, &start).expect("an empty span");
    assert_eq!((y, stats.accepted, stats.evaluations), (start, 0, Some(0)));
    let next = 1.0f64.next_up();
    match go(&body, &method, [1.0, next], &tols, &start) {
        Ok((_, stats)) => assert_eq!(stats.accepted, 1),
        Err(error) => {
            assert!(matches!(error, RunError::Setup(Error::OutOfRange { .. })), "{error}");
        }
    }
    let bad_starts = [f64::NAN, f64::INFINITY, -f64::INFINITY].map(|bad| [bad, 1.0]);
    for span in bad_starts.into_iter().chain([[0.0, f64::NAN]]) {
        let error = go(&body, &method, span, &tols, &start).expect_err("a bad time");
        assert!(error.to_string().starts_with("t_span["), "{error}");
    }
    // A span without end is gone through until the attempts are used up.
    let few = tols.clone().max_steps(20).expect("a limit");
    let error = go(&body, &method, [0.0, f64::INFINITY], &few, &start).expect_err("no end");
    assert!(matches!(error, RunError::TooManySteps { accepted: 20, .. }), "{error}");
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(StepControl::new(bad, 1.0).expect_err("rtol").to_string().starts_with("rtol"));
        assert!(StepControl::new(1.0, bad).expect_err("atol").to_string().starts_with("atol"));
        assert!(tols.clone().min_step(bad).expect_err("h").to_string().starts_with("min_step"));
        assert!(tols.clone().max_step(bad).expect_err("h").to_string().starts_with("max_step"));
        assert!(tols.clone().first_step(bad).expect_err("h").to_string().starts_with("first_step"));
    }
    assert!(StepControl::new(0.0, 0.0).is_err() && tols.clone().max_steps(0).is_err());
    assert!(tols.clone().first_step(0.0).is_err());
    assert!(tols.clone().max_step(0.1).and_then(|c| c.min_step(0.2)).is_err());
    // No pair, no adaptive run; step doubling is the way.
    let (method, save, mut y) = (Rkmk::new(RK4, Exp), SaveAt::Ends, start);
    let run = integrate_adaptive(&body, &method, [0.0, 1.0], &tols, &save, &mut y, |_, _| {});
    let error = run.expect_err("no pair");
    assert!(error.to_string().contains("`rk4`"), "{error}");
    assert!(go(&body, &Doubling(Rkmk::new(RK4, Exp)), [0.0, 1.0], &tols, &start).is_ok());
}

/// Output times are hit exactly, each once, and do not change the run.
#[test]
fn output_times() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let start = Vector3::new(0.2, 0.5, 3.0);
    let (method, tols) = (Rkmk::new(DOPRI5, Exp), control(1e-9, 1e-9));
    for span in [[0.0, 5.0], [5.0, 0.0]] {
        let mut times: Vec<f64> = (0..=50).map(|i| f64::from(i) * 0.1).collect();
        if span[0] > span[1] {
            times.reverse();
        }
        let (plain, without) = go(&body, &method, span, &tols, &start).expect("a run");
        let (mut y, mut seen) = (start, Vec::new());
        let save = SaveAt::Times(times.clone());
        let stats = integrate_adaptive(&body, &method, span, &tols, &save, &mut y, |t, y| {
            seen.push((t, *y))
        })
        .expect("a run");
        assert_eq!(y, plain);
        assert_eq!((stats.accepted, stats.rejected), (without.accepted, without.rejected));
        assert_eq!(seen.iter().map(|s| s.0).collect::<Vec<_>>(), times);
        for (t, y) in &seen {
            let (end, _) = go(&body, &method, [span[0], *t], &tols, &start).expect("a run");
            assert!((end - y).norm() < 1e-7);
        }
        let (mut y, mut count) = (start, 0);
        integrate_adaptive(&body, &method, span, &tols, &SaveAt::Every(3), &mut y, |_, _| {
            count += 1
        })
        .expect("a run");
        let every = 1 + without.accepted / 3 + u64::from(without.accepted % 3 > 0);
        assert_eq!(count, every);
        for bad in [vec![2.0, 1.0, 3.0], vec![1.0, 1.0], vec![9.0], vec![f64::NAN]] {
            let save = SaveAt::Times(bad);
            let mut y = start;
            let run = integrate_adaptive(&body, &method, span, &tols, &save, &mut y, |_, _| {});
            assert!(matches!(run, Err(RunError::Setup(_))));
        }
    }
}

#[test]
fn limits_on_the_step() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let start = Vector3::new(0.2, 0.5, 3.0);
    let method = Rkmk::new(DOPRI5, Exp);
    let tols = control(1e-3, 1e-3).max_step(0.05).expect("limits");
    let (_, stats) = go(&body, &method, [0.0, 5.0], &tols, &start).expect("a run");
    assert!(stats.largest_step <= 0.05 + 1e-15 && stats.accepted >= 100, "{stats:?}");
    let tols = control(1e-12, 1e-12).min_step(0.5).expect("limits");
    let error = go(&body, &method, [0.0, 5.0], &tols, &start).expect_err("too small a tolerance");
    assert!(matches!(error, RunError::StepSizeUnderflow { source: None, .. }), "{error}");
    let tols = control(1e-9, 1e-9).max_steps(10).expect("limits");
    match go(&body, &method, [0.0, 50.0], &tols, &start).expect_err("10 steps do not do") {
        RunError::TooManySteps { t, h, accepted, rejected, max_steps: 10, .. } => {
            assert!(t > 0.0 && h > 0.0 && accepted + rejected == 10);
        }
        other => panic!("{other}"),
    }
}

fn spin(rate: impl Fn(f64) -> f64) -> LinearFlow<So3, Linear, impl Fn(f64, &mut Vector3<f64>)> {
    Flow::of_time(So3::new(), Linear, move |t, v: &mut Vector3<f64>| {
        *v = Vector3::new(0.1, 0.2, 1.0) * rate(t);
    })
}

/// T5: a right-hand side that is not finite, from the start or from some time on.
#[test]
fn not_a_number() {
    let start = Vector3::new(1.0, 0.0, 0.0);
    macro_rules! check {
        ($($method:expr),*) => {$(
            for bad in [f64::NAN, f64::INFINITY] {
                for from in [0.0, 0.5] {
                    let problem = spin(move |t| if t < from { 1.0 } else { bad });
                    let tols = control(1e-8, 1e-8);
                    let mut y = start;
                    let run = integrate_adaptive(
                        &problem, &$method, [0.0, 1.0], &tols, &SaveAt::Ends, &mut y, |_, y| {
                            assert!(y.norm().is_finite());
                        },
                    );
                    match run {
                        Err(RunError::StepSizeUnderflow { t, h, rejected, source, accepted }) => {
                            assert!((t - from).abs() < 1e-9, "{t}");
                            assert!((0.0..1e-9).contains(&h), "{h}");
                            assert!(rejected <= 60, "{}: {rejected} after {accepted}, from {from}, t = {t:e}, h = {h:e}", stringify!($method));
                            assert!(matches!(source, Some(StepError::NonFiniteRhs { .. })));
                        }
                        other => panic!("{other:?}"),
                    }
                    // The last accepted state.
                    assert!((y.norm() - 1.0).abs() < 1e-12);
                }
            }
        )*};
    }
    check!(
        Rkmk::new(DOPRI5, Exp),
        CommutatorFree(CF43),
        LowStorage(LS32),
        OneBracket(MAGNUS43),
        Doubling(Magnus6)
    );
    // A hole in time is stepped over when no stage falls into it, or ends the run: never a NaN.
    let problem = spin(|t| if t == 0.5 { f64::NAN } else { 1.0 });
    if let Ok((y, _)) =
        go(&problem, &Rkmk::new(DOPRI5, Exp), [0.0, 1.0], &control(1e-8, 1e-8), &start)
    {
        assert!((y.norm() - 1.0).abs() < 1e-12);
    }
}

/// Runs from 0 to `end` by these methods end within so many tolerances of the exact point.
macro_rules! meet {
    (($problem:expr, $end:expr, $start:expr, $exact:expr, $most:expr); $($method:expr),* $(,)?) => {$(
        for tol in [1e-4, 1e-6, 1e-8] {
            let tols = control(tol, tol);
            let (y, stats) = go($problem, &$method, [0.0, $end], &tols, &$start).expect("a run");
            let error = (y - $exact).norm();
            println!("{:28} {tol:e}: {error:.1e}, {} steps", stringify!($method), stats.accepted);
            assert!(error < $most * tol, "{} at {tol}: {error:e}, {stats:?}", stringify!($method));
        }
    )*};
}

/// f of t alone that commutes with itself: a step is a rule for an integral. Two results that are one rule there would tell
/// nothing of their error.
#[test]
fn an_integral_meets_its_tolerance() {
    let turning = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
        *v = Vector3::z() * (2.0 * (3.0 * t).cos() + (0.3 * t * t).exp());
    });
    // ∫ exp(0.3 t²) over [0, 2], by Simpson's rule on many intervals.
    let part = |i: i32| (0.3 * (f64::from(i) * 1e-3).powi(2)).exp();
    let sum: f64 = (0..1000).map(|i| part(2 * i) + 4.0 * part(2 * i + 1) + part(2 * i + 2)).sum();
    let angle = 2.0 / 3.0 * 6.0f64.sin() + sum * 1e-3 / 3.0;
    let exact = turn(&(Vector3::z() * angle)) * Vector3::x();
    meet!(
        (&turning, 2.0, Vector3::x(), exact, 10.0);
        Rkmk::new(BS3, Exp),
        Rkmk::new(RKF45, Exp),
        Rkmk::new(DOPRI5, Exp),
        Rkmk::new(DOPRI5, Cay),
        Rkmk::new(VERNER6, Exp),
        Rkmk::new(DOP853, Exp),
        Rk(BS3),
        Rk(RKF45),
        Rk(DOPRI5),
        Rk(VERNER6),
        Rk(DOP853),
        CommutatorFree(CF43),
        LowStorage(LS32),
        OneBracket(MAGNUS43),
        Doubling(CommutatorFree(CF4)),
        Doubling(Magnus6),
    );
}

/// f that is linear in t and does not commute with itself: here a rule for the integral of f is exact, and so is one bracket.
#[test]
fn a_linear_field_meets_its_tolerance() {
    let turning = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
        *v = Vector3::new(2.0, 0.0, 2.0 * t);
    });
    let start = Vector3::new(0.6, 0.0, 0.8);
    let fine = control(1e-13, 1e-13);
    let (exact, _) = go(&turning, &Rk(DOP853), [0.0, 5.0], &fine, &start).expect("a run");
    meet!(
        (&turning, 5.0, start, exact, 20.0);
        Rkmk::new(BS3, Exp),
        Rkmk::new(DOPRI5, Exp),
        Rkmk::new(DOPRI5, Cay),
        Rkmk::new(DOP853, Exp),
        Rk(DOPRI5),
        CommutatorFree(CF43),
        LowStorage(LS32),
        OneBracket(MAGNUS43),
        Doubling(CommutatorFree(CF4)),
        Doubling(Magnus4),
        Doubling(Magnus6),
    );
}

/// What is counted is what the field sees, but for the one evaluation that asks whether f is in 𝔤.
#[test]
fn evaluations_are_counted() {
    let seen = std::cell::Cell::new(0u64);
    let turning = |t: f64, v: &mut Vector3<f64>| {
        seen.set(seen.get() + 1);
        *v = Vector3::new(3.0 * t.cos(), 1.0, t * t);
    };
    let problem = Flow::of_time(So3::new(), Linear, turning);
    macro_rules! check {
        ($($method:expr),* $(,)?) => {$({
            seen.set(0);
            let tols = control(1e-7, 1e-7);
            let (_, stats) =
                go(&problem, &$method, [0.0, 2.0], &tols, &Vector3::x()).expect("a run");
            assert!(stats.accepted > 3, "{stats:?}");
            assert_eq!(stats.evaluations, Some(seen.get() - 1), "{}", stringify!($method));
        })*};
    }
    check!(
        Rkmk::new(DOPRI5, Exp),
        Rkmk::new(DOP853, Cay),
        CommutatorFree(CF43),
        LowStorage(LS32),
        OneBracket(MAGNUS43),
        Doubling(CommutatorFree(CF43)),
        Doubling(Rkmk::new(DOPRI5, Cay)),
        Doubling(Magnus6),
    );
    let rotations = Doubling(lieflow::methods::ExactMotion);
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let (_, stats) =
        go(&body, &rotations, [0.0, 2.0], &control(1e-7, 1e-7), &Vector3::x()).expect("a run");
    assert_eq!(stats.evaluations, None);
}

#[test]
fn blow_up_and_discontinuities() {
    // ẏ = (y y) y on GL(1): y = 1/√(1 − 2t) blows up at t = ½ (T8).
    let gl1 = MatrixGroup::gl(1).expect("GL(1)");
    let mut y = gl1.identity();
    let problem = Flow::new(gl1, LeftTranslation, |_, y, v| v[(0, 0)] = y[(0, 0)] * y[(0, 0)]);
    let method = Rkmk::new(DOPRI5, Exp);
    let tols = control(1e-8, 1e-8);
    let run =
        integrate_adaptive(&problem, &method, [0.0, 1.0], &tols, &SaveAt::Ends, &mut y, |_, _| {});
    match run {
        Err(RunError::StepSizeUnderflow { t, .. }) => {
            assert!((t - 0.5).abs() < 1e-6, "{t}");
            assert!(y[(0, 0)].is_finite() && y[(0, 0)] > 100.0);
        }
        other => panic!("{other:?}"),
    }
    // T9: a jump of the rate is found and passed; a jump to 1e30 ends, one way or the other.
    let start = Vector3::new(1.0, 0.0, 0.0);
    let problem = spin(|t| if t < 0.5 { 1.0 } else { 50.0 });
    let (y, stats) = go(&problem, &method, [0.0, 1.0], &tols, &start).expect("a jump");
    let axis = Vector3::new(0.1, 0.2, 1.0);
    let exact = turn(&(axis * (0.5 + 25.0))) * start;
    assert!((y - exact).norm() < 1e-5, "{} {stats:?}", (y - exact).norm());
    let problem = spin(|t| if t < 0.5 { 1.0 } else { 1e30 });
    let tols = tols.clone().max_steps(20_000).expect("limits");
    let error = go(&problem, &method, [0.0, 1.0], &tols, &start).expect_err("too fast");
    assert!(matches!(error, RunError::StepSizeUnderflow { .. } | RunError::TooManySteps { .. }));
    // T10: next to |t| = 1e9 a step of 1e-7 is lost.
    let problem = spin(|_| 1e12);
    let span = [1e9, 1e9 + 1.0];
    let error = go(&problem, &method, span, &tols, &start).expect_err("too fast for this clock");
    assert!(matches!(error, RunError::StepSizeUnderflow { .. }), "{error}");
}

fn turn(u: &Vector3<f64>) -> Matrix3<f64> {
    lieflow::CoordinateMap::eval(&Exp, &So3::<f64>::new(), u).expect("exp")
}

/// Near a chart's singularity steps are rejected, and the result is right all the same.
#[test]
fn singular_charts() {
    let axis = Vector3::new(0.1, 0.2, 1.0);
    let problem = spin(|t| 4.0 + 3.0 * (5.0 * t).sin());
    let start = Vector3::new(1.0, 0.0, 0.0);
    let exact = turn(&(axis * (4.0 * 20.0 + 0.6 * (1.0 - 100.0f64.cos())))) * start;
    macro_rules! check {
        ($($psi:expr),*) => {$(
            // So loose a first step that the chart's singularity lies within it.
            let tols = control(1e-7, 1e-7).first_step(20.0).expect("a step");
            let (y, stats) = go(&problem, &Rkmk::new(DOPRI5, $psi), [0.0, 20.0], &tols, &start)
                .expect("a run");
            assert!(stats.rejected > 0);
            assert!((y - exact).norm() < 1e-4, "{}: {stats:?}", (y - exact).norm());
        )*};
    }
    check!(Exp, Cay, CCSK123, CCSK);
}
