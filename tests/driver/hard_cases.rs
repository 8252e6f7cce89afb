//! Hard cases of time stepping, T1 to T14 and X4, over every mode of the driver: no run hangs or panics, and no
//! number of a result is not finite.

use std::panic::{AssertUnwindSafe, catch_unwind};

use faer::Mat;
use lieflow::actions::{LeftTranslation, Linear};
use lieflow::groups::{AlgebraMatrix, MatrixGroup, So3};
use lieflow::maps::{CCSK123, Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, RK4};
use lieflow::methods::{CommutatorFree, Doubling, Rkmk};
use lieflow::problems::{Fallible, LinearFlow, RigidBody, TryProblem};
use lieflow::{LieGroup, RunError, Solve, StepControl, StepError, Stops, TimeGrid};
use nalgebra::Vector3;

use crate::modes::{Pace, Ran, V, every_mode};
use crate::scipy::free;
use crate::support::boxed::{boxed_flow, boxed_of_time};

const PACES: [Pace; 2] = [Pace::ByError(1e-6, 1e-9), Pace::Equal(0.05)];

pub(crate) fn body() -> RigidBody {
    RigidBody::new([1.0, 2.0, 3.0]).expect("a body")
}
pub(crate) const START: V = Vector3::new(0.2, 0.5, 3.0);

/// x turns about an axis at a rate of time.
pub(crate) fn spin<'a>(
    rate: impl Fn(f64) -> f64 + 'a,
) -> LinearFlow<So3, Linear, impl Fn(f64, &mut V) + 'a> {
    boxed_of_time(So3::new(), Linear, move |t, v: &mut V| *v = V::new(0.6, 0.0, 0.8) * rate(t))
}

/// Every run in every mode.
macro_rules! in_every_mode {
    ($problem:expr, $span:expr, $pace:expr, $start:expr, $check:expr) => {{
        in_every_mode!(@ $problem, $span, $pace, $start, $check;
            Rkmk::new(DOPRI5, Exp), Rkmk::new(BS3, Cay), CommutatorFree(CF43),
            Doubling(Rkmk::new(RK4, CCSK123)));
    }};
    (@ $problem:expr, $span:expr, $pace:expr, $start:expr, $check:expr; $($method:expr),*) => {$(
        for ran in every_mode($problem, &$method, $span, $pace, $start) {
            let check: &dyn Fn(&Ran) = &$check;
            println!("{} {:?} {:?}", stringify!($method), $pace, ran.mode);
            check(&ran);
        }
    )*};
}

#[test]
fn t1_an_empty_span() {
    for pace in PACES {
        in_every_mode!(&body(), [2.0, 2.0], pace, START, |ran| {
            assert_eq!(*ran.end.as_ref().expect("a run"), (2.0, START), "{}", ran.mode);
        });
    }
}

#[test]
fn t2_backward() {
    let method = Rkmk::new(DOPRI5, Exp);
    let body = body();
    for pace in [Pace::ByError(1e-10, 1e-10), Pace::Equal(0.01)] {
        let there = every_mode(&body, &method, [1.0, 6.0], pace, START);
        let end = there[0].end.as_ref().expect("a run").1;
        for ran in every_mode(&body, &method, [6.0, 1.0], pace, end) {
            let (t, y) = *ran.end.as_ref().expect("a run");
            assert!(
                ran.mode == "a stop" || t == 1.0 && (y - START).norm() < 1e-7,
                "{}: {y}",
                ran.mode
            );
        }
    }
}

/// Whatever is looked at, the run is the same: to the last bit where nothing ends its steps, within the tolerance else.
#[test]
fn a_run_is_the_same_in_every_mode() {
    for (pace, bound) in [(Pace::ByError(1e-9, 1e-9), 1e-7), (Pace::Equal(0.01), 1e-8)] {
        for span in [[0.3, 5.0], [5.0, 0.3]] {
            let method = Rkmk::new(DOPRI5, Exp);
            let all = every_mode(&body(), &method, span, pace, START);
            assert_eq!(all.len(), 21);
            let (_, plain) = *all[0].end.as_ref().expect("a run");
            for ran in &all {
                let (t, y) = *ran.end.as_ref().expect("a run");
                assert_eq!(t, span[1]);
                let cut = [
                    "the same again",
                    "a stop",
                    "events that change",
                    "stops",
                    "by hand, to times",
                ];
                match cut.contains(&ran.mode) {
                    false => assert_eq!(y, plain, "{}", ran.mode),
                    true if ran.mode == "a stop" => {}
                    true => assert!(
                        (y - plain).norm() < bound,
                        "{}: {:e}",
                        ran.mode,
                        (y - plain).norm()
                    ),
                }
            }
        }
    }
}

#[test]
fn t3_one_rounding_unit() {
    for start in [1.0, 1e9, -3.0] {
        let end = f64::next_up(start);
        for pace in PACES {
            in_every_mode!(&body(), [start, end], pace, START, |ran| match &ran.end {
                Ok((t, y)) => assert!(*t == end && (y - START).norm() < 1e-5, "{}", ran.mode),
                Err(error) => panic!("{}: {error}", ran.mode),
            });
        }
    }
}

#[test]
fn t4_arguments_are_named() {
    let (body, method) = (body(), Rkmk::new(DOPRI5, Exp));
    let said = |solve: Solve<'_, RigidBody, Rkmk<Exp, 7>>| match solve.run(START) {
        Err(error) => {
            assert!(matches!(error.error, RunError::Setup(_)) && error.solution.is_none());
            error.to_string()
        }
        Ok(_) => "it ran".into(),
    };
    let over = |span| Solve::new(&body, &method, span);
    let starts = |said: String, with: &str| assert!(said.starts_with(with), "{said}, not {with}");
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        starts(said(over([bad, 1.0]).tolerances(1e-6, 1e-6)), "t_span[0]");
        starts(said(over([bad, 1.0]).dt(0.1)), "t_span[0]");
        starts(said(over([0.0, 1.0]).dt(bad)), "dt");
        starts(said(over([0.0, 1.0]).tolerances(bad, 1e-6)), "rtol");
        starts(said(over([0.0, 1.0]).tolerances(1e-6, bad)), "atol");
        starts(said(over([0.0, 1.0]).first_step(bad)), "first_step");
        starts(said(over([0.0, 1.0]).min_step(bad)), "min_step");
        starts(said(over([0.0, 1.0]).max_step(bad)), "max_step");
        starts(said(over([0.0, 1.0]).dt(0.1).times([0.5, bad])), "times[1]");
    }
    starts(said(over([0.0, f64::NAN]).dt(0.1)), "t_span[1]");
    starts(said(over([-1e308, 1e308]).dt(0.1)), "t_span");
    starts(said(over([0.0, 1.0]).dt(0.0)), "dt");
    for span in [[0.0, 1.0], [1.0, 0.0]] {
        starts(said(over(span).dt(-0.1)), "dt");
    }
    starts(said(over([0.0, 1e9]).dt(1e-300)), "dt");
    starts(said(over([1e9, 1e9 + 1.0]).dt(1e-9)), "dt");
    starts(said(over([0.0, 1.0]).steps(0)), "steps");
    starts(said(over([0.0, f64::INFINITY]).steps(3)), "t_span[1]");
    let none = said(over([0.0, 1.0]));
    starts(none.clone(), "steps: not given, expected a step size by `dt`, a number of steps by ");
    assert!(none.contains("`tolerances`") && !none.contains("NaN"), "{none}");
    starts(said(over([0.0, 1.0]).tolerances(-1e-6, 1e-6)), "rtol");
    starts(said(over([0.0, 1.0]).tolerances(1e-6, -1e-6)), "atol");
    starts(said(over([0.0, 1.0]).tolerances(0.0, 0.0)), "rtol");
    starts(said(over([0.0, 1.0]).max_step(0.1).min_step(0.2)), "min_step");
    starts(said(over([0.0, 1.0]).min_step(0.2).max_step(0.1)), "max_step");
    starts(said(over([0.0, 1.0]).tolerances(1e-6, 1e-6).max_steps(0)), "max_steps");
    starts(said(over([0.0, 1.0]).dt(0.1).every(0)), "every");
    starts(said(over([0.0, 1.0]).dt(0.1).stops([0.5, f64::NAN])), "stops[1]");
    // Two ways to choose the steps.
    let twice = "dt = 0.1, expected only one of dt, steps and tolerances in a run";
    starts(said(over([0.0, 1.0]).dt(0.1).steps(10)), twice);
    starts(said(over([0.0, 1.0]).dt(0.1).tolerances(1e-6, 1e-6)), twice);
    starts(said(over([0.0, 1.0]).tolerances(1e-6, 1e-6).dt(0.1)), "dt");
    // The first wrong value is the one that is told.
    starts(said(over([0.0, 1.0]).tolerances(-1.0, 1e-6).max_step(-1.0)), "rtol");
    assert!(TimeGrid::new([0.0, 1.0], -0.1).is_err() && StepControl::new(1e-6, f64::NAN).is_err());
    // A method without an estimate cannot choose.
    let plain = Rkmk::new(RK4, Exp);
    let error = Solve::new(&body, &plain, [0.0, 1.0]).tolerances(1e-6, 1e-6).run(START);
    assert!(error.expect_err("no pair").to_string().contains("`rk4`"));
}

#[test]
fn t5_a_field_that_is_not_finite() {
    for bad in [f64::NAN, f64::INFINITY] {
        for from in [0.0, 0.5] {
            let problem = spin(move |t| if t < from { 1.0 } else { bad });
            for pace in PACES {
                in_every_mode!(&problem, [0.0, 1.0], pace, V::y(), |ran| {
                    if ran.mode == "a stop" && from > 0.0 {
                        return; // before it
                    }
                    let error = ran.end.as_ref().expect_err(ran.mode);
                    match (pace, error) {
                        (
                            Pace::ByError(..),
                            RunError::StepSizeUnderflow { t, h, rejected, source, .. },
                        ) => {
                            assert!(
                                (t - from).abs() < 1e-9 && h.abs() < 1e-3,
                                "{}: {error}",
                                ran.mode
                            );
                            assert!(*rejected <= 130, "{}: {error}", ran.mode);
                            assert!(
                                matches!(source, Some(StepError::NonFiniteRhs { .. })),
                                "{error}"
                            );
                        }
                        (Pace::Equal(_), RunError::Step(failure)) => {
                            assert!(
                                (failure.t - from).abs() <= 0.05 + 1e-12,
                                "{}: {error}",
                                ran.mode
                            );
                            assert!(
                                matches!(failure.source, StepError::NonFiniteRhs { .. }),
                                "{error}"
                            );
                        }
                        _ => panic!("{}: {error}", ran.mode),
                    }
                });
            }
        }
    }
}

#[test]
fn t6_a_field_outside_the_algebra() {
    let group = MatrixGroup::so(3).expect("SO(3)");
    let start = group.identity();
    let outside: [(&str, Mat<f64>); 2] =
        [("symmetric", Mat::identity(3, 3)), ("of another size", Mat::zeros(2, 2))];
    for (what, value) in outside {
        let problem = boxed_of_time(group.clone(), LeftTranslation, |_: f64, v| {
            *v = AlgebraMatrix::new_unchecked(value.clone())
        });
        let method = Rkmk::new(DOPRI5, Exp);
        for solve in [
            Solve::new(&problem, &method, [0.0, 1.0]).tolerances(1e-6, 1e-6),
            Solve::new(&problem, &method, [0.0, 1.0]).dt(0.1),
        ] {
            let error = solve.run(start.clone()).expect_err(what);
            assert!(matches!(error.error, RunError::Setup(_)), "{error}");
            assert!(error.to_string().contains('f'), "{error}");
        }
    }
}

#[test]
fn t7_a_field_with_errors_of_its_own() {
    struct Measured;
    impl TryProblem for Measured {
        type Group = So3;
        type Action = Linear;
        type Work = ();
        type Error = &'static str;
        fn group(&self) -> &So3 {
            const { &So3::new() }
        }
        fn action(&self) -> &Linear {
            &Linear
        }
        fn work(&self) {}
        fn try_f(&self, t: f64, _: &V, v: &mut V, (): &mut ()) -> Result<(), &'static str> {
            *v = V::z();
            if t > 0.4 { Err("nothing was measured") } else { Ok(()) }
        }
    }
    for pace in PACES {
        let problem = Fallible::new(Measured);
        let method = Rkmk::new(DOPRI5, Exp);
        for ran in every_mode(&problem, &method, [0.0, 1.0], pace, V::x()) {
            assert!(ran.end.is_err(), "{}", ran.mode);
        }
        assert_eq!(problem.into_error(), Some("nothing was measured"));
    }
    // A panic goes through as it is.
    let problem = spin(|t| if t > 0.4 { panic!("the user's own") } else { 1.0 });
    let method = Rkmk::new(DOPRI5, Exp);
    let run = AssertUnwindSafe(|| {
        Solve::new(&problem, &method, [0.0, 1.0]).dt(0.1).run(V::x()).map(drop)
    });
    let panic = catch_unwind(run).expect_err("a panic");
    assert_eq!(panic.downcast_ref(), Some(&"the user's own"));
}

#[test]
fn t8_what_blows_up() {
    let problem = boxed_flow(free(), LeftTranslation, |_: f64, y: &V, v: &mut V| {
        *v = V::new(y.x * y.x, 0.0, 0.0)
    });
    in_every_mode!(&problem, [0.0, 10.0], Pace::ByError(1e-8, 0.0), V::x(), |ran| match &ran.end {
        Err(RunError::StepSizeUnderflow { t, .. } | RunError::TooManySteps { t, .. }) => {
            assert!((0.99..1.0001).contains(t), "{}: {t}", ran.mode);
            if let Some((last, y)) = ran.last
                && last > 0.0
            {
                assert!(last <= *t && y.x > 0.0 && y.x.is_finite(), "{}", ran.mode);
            }
        }
        other => panic!("{}: {other:?}", ran.mode),
    });
    // With steps of one size it is passed, or not finite: an error then.
    in_every_mode!(&problem, [0.0, 10.0], Pace::Equal(0.05), V::x(), |ran| if let Err(error) =
        &ran.end
    {
        assert!(
            matches!(error, RunError::Step(_) | RunError::Event { .. } | RunError::Within { .. }),
            "{error}"
        );
    });
}

#[test]
fn t9_jumps_and_noise() {
    let rates: [fn(f64) -> f64; 4] = [
        |t| if t < 0.5 { 1.0 } else { 1e30 },
        |t| if t < 0.5 { 1.0 } else { 20.0 },
        |t| (t.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / 1e6,
        |t| if (50.0 * t).sin() > 0.0 { 1.0 } else { -1.0 },
    ];
    for (index, rate) in rates.into_iter().enumerate() {
        for pace in PACES {
            in_every_mode!(&spin(rate), [0.0, 1.0], pace, V::y(), |ran| match &ran.end {
                Ok((t, y)) => assert!(*t == 1.0 && (y.norm() - 1.0).abs() < 1e-11, "{}", ran.mode),
                Err(RunError::StepSizeUnderflow { .. } | RunError::TooManySteps { .. }) =>
                    assert!([0, 2].contains(&index), "{index} {}", ran.mode),
                Err(RunError::Step(_)) => assert!(index == 0, "{index} {}", ran.mode),
                // A shorter step may leave the chart that the whole one stays in, and 1e30 the range of numbers.
                Err(RunError::Within { source: StepError::OutsideChart { .. }, .. }) => {}
                Err(RunError::Within { source: StepError::NotFinite { .. }, .. }) if index == 0 => {
                }
                Err(other) => panic!("{}: {other}", ran.mode),
            });
        }
    }
}

#[test]
fn t10_steps_that_are_lost() {
    in_every_mode!(&spin(|_| 1e12), [1e9, 1e9 + 1.0], Pace::ByError(1e-8, 1e-8), V::y(), |ran| {
        match &ran.end {
            Err(RunError::StepSizeUnderflow { t, .. }) => assert_eq!(*t, 1e9, "{}", ran.mode),
            Err(RunError::TooManySteps { t, .. }) => assert!(*t < 1e9 + 1e-3, "{}", ran.mode),
            other => panic!("{}: {other:?}", ran.mode),
        }
    });
}

/// T12: a million steps end at their end, in one call of the method and one by one, to the last bit the same.
#[test]
fn t12_many_steps_of_one_size() {
    let (body, method) = (body(), Rkmk::new(RK4, Cay));
    let end = 0.1 * 300_000.0 / 3.0;
    let solve = || Solve::new(&body, &method, [0.0, end]).steps(300_000);
    let quiet = solve().run(START).expect("a run");
    let mut last = 0.0;
    let shown = solve().every(1).run_with(START, |t, _| {
        assert!(t > last || t == 0.0);
        last = t;
    });
    let shown = shown.expect("a run");
    assert_eq!((quiet.t, quiet.y, quiet.stats.accepted), (end, shown.y, 300_000));
    let stats = (
        shown.stats.restored,
        shown.stats.evaluations,
        shown.stats.smallest_step,
        shown.stats.largest_step,
    );
    assert_eq!(
        (
            quiet.stats.restored,
            quiet.stats.evaluations,
            quiet.stats.smallest_step,
            quiet.stats.largest_step
        ),
        stats
    );
    assert_eq!((last, shown.t), (end, end));
    // A last step that is shorter, and a limit.
    let short = Solve::new(&body, &method, [0.0, 1.0]).dt(0.3).every(1).run(START).expect("a run");
    assert_eq!(short.times.len(), 5);
    assert!((short.stats.smallest_step - 0.1).abs() < 1e-15 && short.stats.largest_step == 0.3);
    for every in [1, 7] {
        let run =
            Solve::new(&body, &method, [0.0, f64::INFINITY]).dt(0.3).every(every).max_steps(100);
        match run.run(START).expect_err("no end").error {
            RunError::TooManySteps {
                accepted: 100, max_steps: 100, t, by_error: false, ..
            } => {
                assert!((t - 30.0).abs() < 1e-12)
            }
            other => panic!("{other}"),
        }
    }
}

/// X4: the same bits twice, on any thread.
#[test]
fn x4_the_same_bits() {
    let all = || {
        PACES.map(|pace| {
            every_mode(&body(), &Rkmk::new(DOP853, Exp), [0.0, 3.0], pace, START)
                .into_iter()
                .map(|ran| ran.end.expect("a run").1.data.0[0].map(f64::to_bits))
                .collect::<Vec<_>>()
        })
    };
    let here = all();
    let threads: Vec<_> = (0..3).map(|_| std::thread::spawn(all)).collect();
    for thread in threads {
        assert_eq!(thread.join().expect("a thread"), here);
    }
}

/// Fields that are hard, over spans that are hard, in every mode.
#[test]
fn every_mode_ends() {
    let rates: [fn(f64) -> f64; 9] = [
        |_| 0.0,
        |_| 5e-324,
        |_| 1e9,
        |_| 1e300,
        |t| 1.0 / (0.5 - t),
        |t| 1.0 / t,
        |t| if t.to_bits() % 3 == 0 { f64::NAN } else { 1.0 },
        |t| (t.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / 1e6,
        |_| f64::NAN,
    ];
    let spans = [
        [0.0, 1.0],
        [1.0, -1.0],
        [0.0, 5e-324],
        [0.0, 1e300],
        [-1.7e308, 1.7e308],
        [1e16, 1e16 + 4.0],
        [-1e-12, 1e-12],
        [0.0, f64::INFINITY],
        [0.0, f64::NEG_INFINITY],
    ];
    let tolerances = [[1e-6, 1e-6], [0.0, 1e-21], [1e300, 1e300]];
    let mut reached = 0;
    for rate in rates {
        let problem = spin(rate);
        for span in spans {
            for [rtol, atol] in tolerances {
                for ran in every_mode(
                    &problem,
                    &Rkmk::new(BS3, Cay),
                    span,
                    Pace::ByError(rtol, atol),
                    V::y(),
                ) {
                    if let Ok((t, y)) = ran.end {
                        reached += 1;
                        assert!(
                            t == span[1] && (y.norm() - 1.0).abs() < 1e-11,
                            "{}: {y} at {t}",
                            ran.mode
                        );
                    }
                }
            }
            let length =
                if (span[1] - span[0]).is_finite() { (span[1] - span[0]).abs() } else { 1e3 };
            for ran in
                every_mode(&problem, &Rkmk::new(BS3, Cay), span, Pace::Equal(length / 7.5), V::y())
            {
                if let Ok((t, y)) = ran.end {
                    reached += 1;
                    assert!(
                        t == span[1] && (y.norm() - 1.0).abs() < 1e-11,
                        "{}: {y} at {t}",
                        ran.mode
                    );
                }
            }
        }
    }
    assert!(reached > 1500, "{reached} runs reached their end");
}

/// f jumps at the end of the span: with a stop there, the last step evaluates it before the jump.
#[test]
fn a_jump_at_the_end_is_not_stepped_on() {
    use nalgebra::Matrix3;
    for [from, to] in [[0.0, 1.0], [2.0, 1.0]] {
        let turn =
            boxed_of_time(So3::new(), LeftTranslation, move |t: f64, v: &mut Vector3<f64>| {
                let is_before = if to > from { t < 1.0 } else { t > 1.0 };
                v.z = if is_before { 0.5 } else { 5.0 };
            });
        let method = Rkmk::new(DOPRI5, Exp);
        for adaptive in [false, true] {
            let solve = Solve::new(&turn, &method, [from, to]).stops([1.0]);
            let solve = if adaptive { solve.tolerances(1e-9, 1e-9) } else { solve.steps(10) };
            let run = solve.run(Matrix3::identity()).expect("a run");
            let angle = run.y[(1, 0)].atan2(run.y[(0, 0)]);
            assert!((angle - 0.5 * (to - from)).abs() < 1e-13, "{from} {adaptive}: {angle}");
            assert_eq!(run.stats.rejected, 0);
        }
    }
}

/// Methods whose stages are all within a step lose no time at stops, also where t is large: a constant field, samples of
/// 100 Hz, and times of a clock.
#[test]
fn no_time_is_lost_at_stops() {
    use lieflow::methods::magnus::{Magnus4, Magnus8};
    use nalgebra::Matrix3;
    let turn = boxed_of_time(So3::new(), LeftTranslation, |_: f64, v: &mut Vector3<f64>| v.z = 1.0);
    let t0 = 1.7e9;
    let stops: Vec<f64> = (1..100).map(|k| t0 + 0.01 * f64::from(k)).collect();
    let solve = |end: f64| Solve::new(&turn, &Magnus4, [t0, end]).dt(0.01).stops(stops.clone());
    let angle = |y: &Matrix3<f64>| y[(1, 0)].atan2(y[(0, 0)]);
    let run = solve(t0 + 1.0).run(Matrix3::identity()).expect("a run");
    assert!((angle(&run.y) - 1.0).abs() < 1e-12, "{}", angle(&run.y));
    let run = Solve::new(&turn, &Magnus8, [t0 + 1.0, t0]).dt(0.02).stops(stops);
    let run = run.run(Matrix3::identity()).expect("a run");
    assert!((angle(&run.y) + 1.0).abs() < 1e-12, "{}", angle(&run.y));
}

/// No method loses time where only derivatives of f jump, and no step is as short as rounding: a rate by straight lines
/// between knots that are no numbers of the grid. Nor do steps by error at jumps.
#[test]
fn no_time_is_lost_at_kinks() {
    use nalgebra::Matrix3;
    let (t0, n) = (1e4, 100);
    let knots: Vec<f64> = (0..=n).map(|k| t0 + 0.01 * f64::from(k)).collect();
    let times = knots.clone();
    let turn = boxed_of_time(So3::new(), LeftTranslation, move |t: f64, v: &mut Vector3<f64>| {
        let k = times.partition_point(|knot| *knot <= t).clamp(1, times.len() - 1);
        let share = (t - times[k - 1]) / (times[k] - times[k - 1]);
        v.z = if k % 2 == 1 { share } else { 1.0 - share };
    });
    let span = [t0, knots[n as usize]];
    let exact = 0.5 * (span[1] - span[0]);
    let error = |stops: Stops, [from, to]: [f64; 2], adaptive: bool| {
        let method = Rkmk::new(DOPRI5, Exp);
        let solve = Solve::new(&turn, &method, [from, to]).stops(stops);
        let solve = if adaptive { solve.tolerances(1e-9, 1e-9) } else { solve.dt(0.01) };
        let run = solve.run(Matrix3::identity()).expect("a run");
        let steps = run.stats.accepted;
        assert!(adaptive || steps == n as u64, "{steps} steps");
        let angle = run.y[(1, 0)].atan2(run.y[(0, 0)]);
        (angle.abs() - exact).abs()
    };
    for span in [span, [span[1], span[0]]] {
        for adaptive in [false, true] {
            let kinks = error(Stops::at_kinks(knots.clone()), span, adaptive);
            let jumps = error(knots.clone().into(), span, adaptive);
            let lost = if adaptive { jumps } else { 0.0 };
            // Stages that are moved have other values of f, by its slope.
            assert!(kinks < 3e-12 && lost < 1e-11, "{span:?} {adaptive}: {kinks:e} {jumps:e}");
            // Steps of one size have no room there.
            assert!(adaptive || jumps > 3e-11, "{span:?}: {jumps:e}");
        }
    }
    // Of two stops at one time the jump counts, and a time that is no number is named.
    let both = Stops { jumps: knots.clone(), kinks: knots.clone() };
    assert!(error(both, span, false) > 3e-11);
    let bad = Solve::new(&turn, &Rkmk::new(DOPRI5, Exp), span)
        .dt(0.1)
        .stops(Stops::at_kinks([f64::NAN]))
        .run(Matrix3::identity());
    assert!(bad.expect_err("NaN").to_string().contains("kinks[0]"));
}
