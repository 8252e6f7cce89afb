//! Whatever an adaptive run is asked, it ends: with a state that is right, or with an error of a known
//! type, after no more attempts than it was given. Fields that are stiff, blow up, jump, are not finite
//! or not there; spans from 5e-324 to 1e308, near 0 and far from it; tolerances of 0 and of 1e-300.

use core::cell::Cell;

use lieflow::SaveAt;
use lieflow::actions::{LeftTranslation, Linear};
use lieflow::groups::{So3, Translations};
use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, RK4};
use lieflow::methods::{CommutatorFree, Doubling, Embedded, LowStorage, Rkmk, low_storage::LS32};
use lieflow::problems::{Flow, Problem};
use lieflow::{RunError, StepControl, integrate_adaptive};
use nalgebra::Vector3;

/// Attempts that each run is given.
const ATTEMPTS: u64 = 300;
const AXIS: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);

/// A rate of turning about [`AXIS`] as a function of time.
type Rate = fn(f64) -> f64;

const RATES: [(&str, Rate); 12] = [
    ("nothing", |_| 0.0),
    ("one", |_| 1.0),
    ("the least number", |_| 5e-324),
    ("tiny", |_| 1e-300),
    ("fast", |_| 1e9),
    ("huge", |_| 1e300),
    ("a square wave", |t| if (50.0 * t).sin() > 0.0 { 1.0 } else { -1.0 }),
    ("a pole", |t| 1.0 / (0.5 - t)),
    ("a pole of time", |t| 1.0 / t),
    ("holes", |t| if t.to_bits() % 3 == 0 { f64::NAN } else { 1.0 }),
    ("noise", |t| (t.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / 1e6),
    ("not a number", |_| f64::NAN),
];

const SPANS: [[f64; 2]; 14] = [
    [0.0, 1.0],
    [1.0, -1.0],
    [0.0, 5e-324],
    [0.0, 1e-300],
    [0.0, 1e300],
    [0.0, 1.7e308],
    [-1.7e308, 1.7e308],
    [1e300, 1.0001e300],
    [1e16, 1e16 + 4.0],
    [1e9 + 1.0, 1e9],
    [-1e-12, 1e-12],
    [1.0, 1.0 + f64::EPSILON],
    [3.0, 3.0],
    [-0.0, 0.0],
];

const TOLERANCES: [[f64; 2]; 6] =
    [[1e-6, 1e-6], [1e-6, 0.0], [0.0, 1e-6], [1e-300, 0.0], [0.0, 5e-324], [1e300, 1e300]];

/// One run of a vector that turns; its end is a unit vector at the end of the span, or it is an error of
/// a run.
fn ends<M: Embedded<P>, P>(
    what: &str,
    problem: &P,
    method: &M,
    span: [f64; 2],
    control: &StepControl,
    evaluations: &Cell<u64>,
) -> Option<Vector3<f64>>
where
    P: Problem<Group = So3, Action = Linear>,
{
    let (mut y, mut last) = (Vector3::new(0.0, 1.0, 0.0), f64::NAN);
    evaluations.set(0);
    let run =
        integrate_adaptive(problem, method, span, control, &SaveAt::Every(1), &mut y, |t, y| {
            assert!(y.norm().is_finite(), "{what}: {y}");
            last = t;
        });
    // 36 stages at most an attempt, and the choice of the first step.
    assert!(evaluations.get() <= 37 * (ATTEMPTS + 2), "{what}: {} f", evaluations.get());
    assert!((y.norm() - 1.0).abs() < 1e-11, "{what}: {y}");
    match run {
        Ok(stats) => {
            assert_eq!(last, span[1], "{what}");
            assert!(stats.accepted + stats.rejected <= ATTEMPTS, "{what}: {stats:?}");
            Some(y)
        }
        Err(RunError::Setup(_)) => {
            assert!(last.is_nan(), "{what}: begun, and then refused");
            None
        }
        Err(RunError::StepSizeUnderflow { t, h, .. } | RunError::TooManySteps { t, h, .. }) => {
            assert!(t == last && h.is_finite(), "{what}: {t} {h}");
            let towards_the_end = (span[1] - span[0]) * h >= 0.0 || h == 0.0;
            assert!(t != span[1] && towards_the_end, "{what}: {t} {h}");
            None
        }
        Err(other) => panic!("{what}: {other}"),
    }
}

#[test]
fn every_run_ends() {
    let (evaluations, mut reached) = (Cell::new(0u64), 0);
    for (name, rate) in RATES {
        let problem = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
            evaluations.set(evaluations.get() + 1);
            *v = AXIS * rate(t);
        });
        for span in SPANS {
            for [rtol, atol] in TOLERANCES {
                let control = StepControl::new(rtol, atol).and_then(|c| c.max_steps(ATTEMPTS));
                let control = control.expect("tolerances");
                macro_rules! check {
                    ($($method:expr),*) => {$({
                        let what =
                            format!("{} {name} {span:?} {rtol:e} {atol:e}", stringify!($method));
                        let end = ends(&what, &problem, &$method, span, &control, &evaluations);
                        reached += u32::from(end.is_some());
                        // A turn about a fixed axis has no error but that of its angle.
                        let angle = span[1] - span[0];
                        let plain = ["one", "nothing"].contains(&name) && [rtol, atol].contains(&1e-6);
                        let within = (1e-12..=2.0).contains(&angle.abs());
                        assert!(end.is_some() || !(plain && within), "{what}: not reached");
                        if let Some(y) = end && name == "one" && angle.abs() <= 2.0 && rtol < 1.0 {
                            let exact = Vector3::new(
                                -0.8 * angle.sin(), angle.cos(), 0.6 * angle.sin(),
                            );
                            assert!((y - exact).norm() < 1e-4, "{what}: {y} {exact}");
                        }
                    })*};
                }
                check!(
                    Rkmk::new(DOPRI5, Exp),
                    Rkmk::new(DOP853, Cay),
                    CommutatorFree(CF43),
                    LowStorage(LS32),
                    Doubling(Rkmk::new(RK4, CCSK))
                );
            }
        }
    }
    assert!(reached > 1000, "{reached} runs reached their end");
}

/// Limits on the step that contradict the span or one another in effect.
#[test]
fn limits_that_leave_no_step() {
    let evaluations = Cell::new(0);
    let problem = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
        evaluations.set(evaluations.get() + 1);
        *v = Vector3::new(t.cos(), t.sin(), 0.5);
    });
    let plain =
        || StepControl::new(1e-8, 1e-8).and_then(|c| c.max_steps(ATTEMPTS)).expect("tolerances");
    let method = Rkmk::new(BS3, Exp);
    let run = |what, control: Result<StepControl, lieflow::Error>, span| {
        ends(what, &problem, &method, span, &control.expect("limits"), &evaluations)
    };
    assert_eq!(run("steps of 1e-300", plain().max_step(1e-300), [0.0, 1.0]), None);
    assert_eq!(run("lost steps", plain().max_step(1e-9), [1e9, 1e9 + 1.0]), None);
    assert_eq!(run("no step below 10", plain().min_step(10.0), [0.0, 100.0]), None);
    // The last step may be shorter than the shortest.
    assert!(run("an end before it", plain().min_step(10.0), [0.0, 1e-3]).is_some());
    assert!(run("a first step beyond", plain().first_step(1e300), [0.0, 1.0]).is_some());
    assert!(run("a first step of nothing", plain().first_step(1e-250), [0.0, 1.0]).is_none());
}

/// Each run ends before it, close to it.
#[test]
fn what_blows_up_ends_before_it_does() {
    // ẏ = (y₁², 0, 0): blows up at t = 1/y₁(0).
    let group = Translations::new(Vector3::<f64>::zeros(), 3);
    let problem = Flow::new(group, LeftTranslation, |_, y, v| {
        *v = Vector3::new(y[0] * y[0], 0.0, 0.0);
    });
    macro_rules! check {
        ($($method:expr),*) => {$(
            for (start, at) in [(1.0, 1.0), (1e-100, 1e100), (1e100, 1e-100)] {
                let control = StepControl::new(1e-9, 0.0).expect("tolerances");
                let (mut y, span) = (Vector3::new(start, 0.0, 0.0), [0.0, 10.0 * at]);
                let run = integrate_adaptive(
                    &problem, &$method, span, &control, &SaveAt::Ends, &mut y, |_, _| {},
                );
                let name = stringify!($method);
                match run {
                    Err(RunError::StepSizeUnderflow { t, .. }) => {
                        assert!((t / at - 1.0).abs() < 1e-5, "{name}: {t}");
                        assert!(y[0].is_finite() && y[0] > 1e4 * start, "{name}: {y}");
                    }
                    other => panic!("{name}: {other:?}, y = {y:e}"),
                }
            }
        )*};
    }
    check!(Rkmk::new(DOPRI5, Exp), Rkmk::new(BS3, Exp), Doubling(Rkmk::new(RK4, Exp)));
}

/// Steps as long as the tolerance allows meet the singularity of each chart: a run that reaches its end
/// has the error that its tolerance says, in spite of it.
#[test]
fn no_chart_gives_a_wrong_result() {
    let direction = |t: f64| Vector3::new(0.3 * t.cos(), 1.0, 0.4 * (0.7 * t).sin());
    let problem = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
        *v = direction(t);
    });
    let at = |control: &StepControl, end: f64| {
        let (mut y, method) = (Vector3::new(0.0, 0.6, 0.8), Rkmk::new(DOP853, Exp));
        let save = SaveAt::Ends;
        integrate_adaptive(&problem, &method, [0.0, end], control, &save, &mut y, |_, _| {})
            .expect("a reference");
        y
    };
    let exact = at(&StepControl::new(0.0, 1e-13).expect("tolerances"), 20.0);
    macro_rules! check {
        ($($psi:expr),*) => {$(
            for atol in [1e-1, 1e-2, 1e-3, 1e-5] {
                // The first step goes to where u₂ = π/2, |u| = 2π and beyond.
                for first in [1.57, 1.6, 3.1, 6.2, 6.3, 20.0] {
                    let control = StepControl::new(0.0, atol).and_then(|c| c.first_step(first));
                    let mut y = Vector3::new(0.0, 0.6, 0.8);
                    let stats = integrate_adaptive(
                        &problem, &Rkmk::new(DOPRI5, $psi), [0.0, 20.0],
                        &control.expect("tolerances"), &SaveAt::Ends, &mut y, |_, _| {},
                    ).expect("a run");
                    let (error, steps) = ((y - exact).norm(), stats.accepted as f64);
                    assert!(
                        error <= 4.0 * steps * atol,
                        "{} {atol} {first}: {error} after {steps} steps", stringify!($psi),
                    );
                }
            }
        )*};
    }
    check!(Exp, Cay, CCSK123, CCSK321, CCSK);
}
