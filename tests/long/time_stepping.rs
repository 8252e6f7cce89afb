//! Hard cases of time stepping that concern the field and the record of a run: values outside the
//! algebra, errors of the user's own, interrupted runs, very many steps. Spans, grids and output times
//! are in `core/api/grids.rs`, adaptive runs in `orders/adaptive.rs`.

use std::cell::Cell;

use faer::Mat;
use lieflow::actions::{LeftTranslation, Linear};
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, So3, Translations};
use lieflow::maps::Exp;
use lieflow::methods::tableau::{DOPRI5, EULER, MIDPOINT, RK4};
use lieflow::methods::{Doubling, Rk, Rkmk};
use lieflow::problems::{
    Ambient, Fallible, Flow, InAlgebra, RigidBody, RigidBodyAttitude, TryProblem,
};
use lieflow::{Error, LieGroup, RunError, SaveAt, StepError, TimeGrid, integrate};
use lieflow::{StepControl, integrate_adaptive};
use nalgebra::{Matrix3, Vector3};

fn control() -> StepControl {
    StepControl::new(1e-8, 1e-8).expect("tolerances")
}

fn grid(end: f64, steps: u64) -> TimeGrid {
    TimeGrid::with_steps([0.0, end], steps).expect("a grid")
}

/// A field on SO(3) whose value is one matrix until a time, and another one afterwards.
fn jump(
    group: &MatrixGroup,
    before: Mat<f64>,
    from: f64,
    after: Mat<f64>,
) -> impl Ambient<Group = MatrixGroup, Action = LeftTranslation> + Clone {
    Flow::of_time(group.clone(), LeftTranslation, move |t, v: &mut AlgebraMatrix| {
        *v = AlgebraMatrix::new_unchecked(if t < from { &before } else { &after }.clone());
    })
}

fn skew() -> Mat<f64> {
    Mat::from_fn(3, 3, |i, j| j as f64 - i as f64)
}

/// T6, at the first value: no run begins.
#[test]
fn a_field_outside_the_algebra() {
    let group = MatrixGroup::so(3).expect("SO(3)");
    let symmetric = Mat::from_fn(3, 3, |i, j| (i + j) as f64);
    for (wrong, expected) in [
        (symmetric, "f: not in the Lie algebra of SO(3): relative residual"),
        (skew() + Mat::<f64>::identity(3, 3) * faer::Scale(1e-9), "f: not in the Lie algebra"),
        (Mat::zeros(4, 4), "f: 4×4, expected 3×3"),
        (Mat::zeros(3, 4), "f: 3×4, expected 3×3"),
    ] {
        let problem = jump(&group, wrong, 9.0, skew());
        let mut y = group.identity();
        let observe = |_: f64, _: &GroupMatrix| panic!("observed");
        let method = Rkmk::new(DOPRI5, Exp);
        let run = integrate(&problem, &method, &grid(1.0, 9), &SaveAt::Ends, &mut y, observe);
        let Err(RunError::Setup(error)) = run else { panic!("{run:?}") };
        assert!(error.to_string().starts_with(expected), "{error}");
        let save = SaveAt::Ends;
        let run =
            integrate_adaptive(&problem, &method, [0.0, 1.0], &control(), &save, &mut y, |_, _| {});
        let Err(RunError::Setup(error)) = run else { panic!("{run:?}") };
        assert!(error.to_string().starts_with(expected), "{error}");
        assert_eq!(y, group.identity());
    }
    // An element to rounding is one, of whatever size, and so is 0.
    for size in [0.0, 1e-310, 1e-9, 1e3] {
        let near = skew() * faer::Scale(size) + Mat::from_fn(3, 3, |_, _| 1e-14 * size);
        let problem = jump(&group, near, 9.0, skew());
        let mut y = group.identity();
        let run = integrate(
            &problem,
            &Rkmk::new(RK4, Exp),
            &grid(0.1, 9),
            &SaveAt::Ends,
            &mut y,
            |_, _| {},
        );
        assert!(run.is_ok(), "{size}: {run:?}");
    }
}

/// T6, later: [`InAlgebra`] looks at every value.
#[test]
fn a_field_that_leaves_the_algebra() {
    let group = MatrixGroup::so(3).expect("SO(3)");
    for after in [Mat::identity(3, 3), Mat::zeros(2, 2)] {
        let jump = jump(&group, skew(), 0.5, after);
        let problem = Fallible::new(InAlgebra(jump));
        let mut y = group.identity();
        let method = Rkmk::new(RK4, Exp);
        let run = integrate(&problem, &method, &grid(1.0, 10), &SaveAt::Ends, &mut y, |_, _| {});
        let Err(RunError::Step(failure)) = run else { panic!("{run:?}") };
        // The step to t = 0.5 has its last stage there.
        assert_eq!((failure.step, failure.source), (4, StepError::NonFiniteRhs { stage: 4 }));
        assert!(group.defect(&y) < 1e-14);
        let error = problem.into_error().expect("an error");
        assert!(matches!(error, Error::NotInAlgebra { .. } | Error::Shape { .. }), "{error}");
        assert!(error.to_string().starts_with("f: "), "{error}");
    }
}

/// Fails at t ≥ 0.5 with an error of its own.
struct Broken(So3);

thread_local!(
    /// How often it failed.
    static ASKED: std::cell::Cell<u32> = const { std::cell::Cell::new(0) }
);

#[derive(Debug, PartialEq)]
struct OutOfData {
    at: f64,
}

impl TryProblem for Broken {
    type Group = So3;
    type Action = Linear;
    type Work = ();
    type Error = OutOfData;
    fn group(&self) -> &So3 {
        &self.0
    }
    fn action(&self) -> &Linear {
        &Linear
    }
    fn work(&self) {}
    fn try_f(
        &self,
        t: f64,
        _: &Vector3<f64>,
        v: &mut Vector3<f64>,
        _: &mut (),
    ) -> Result<(), OutOfData> {
        if t >= 0.5 {
            ASKED.set(ASKED.get() + 1);
            return Err(OutOfData { at: t });
        }
        *v = Vector3::new(0.0, 0.3, 1.0);
        Ok(())
    }
}

/// T7: the user's error comes back unchanged, after one call.
#[test]
fn an_error_of_the_users_own() {
    macro_rules! check {
        ($at:expr, $problem:ident => $run:expr) => {{
            let $problem = Fallible::new(Broken(So3::new()));
            assert!($problem.error().is_none());
            assert!($run.is_err());
            let at: std::ops::RangeInclusive<f64> = $at;
            assert!($problem.error().is_some_and(|e| at.contains(&e.at)), "{:?}", $problem.error());
            assert!($problem.into_error().is_some());
        }};
    }
    let (mut y, save) = (Vector3::x(), SaveAt::Ends);
    check!(0.5..=0.5, p => integrate(&p, &Rkmk::new(RK4, Exp), &grid(1.0, 10), &save, &mut y, |_, _| {}));
    check!(0.5..=1.0, p => integrate_adaptive(
        &p, &Rkmk::new(DOPRI5, Exp), [0.0, 1.0], &control(), &save, &mut y, |_, _| {}
    ));
    check!(0.5..=1.0, p => integrate_adaptive(
        &p, &Doubling(Rkmk::new(RK4, Exp)), [0.0, 1.0], &control(), &save, &mut y, |_, _| {}
    ));
    assert!((y.norm() - 1.0).abs() < 1e-14);
    // It is not asked again, however often the step is shortened.
    let broken = Fallible::new(Broken(So3::new()));
    let dopri5 = Rkmk::new(DOPRI5, Exp);
    let run =
        integrate_adaptive(&broken, &dopri5, [0.0, 1.0], &control(), &save, &mut y, |_, _| {});
    assert!(matches!(run, Err(RunError::StepSizeUnderflow { rejected, .. }) if rejected <= 60));
    assert_eq!(ASKED.get(), 4, "once in each of four runs");
}

/// T14: what an interrupted run says, and what it leaves.
#[test]
fn an_interrupted_run() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let start = Vector3::new(0.9, 1.0, 2.1);
    let hole = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
        *v = Vector3::new(1.0, 2.0, if t > 0.77 { f64::NAN } else { 3.0 });
    });
    let method = Rkmk::new(RK4, Exp);
    let (mut y, mut last) = (start, (0.0, start));
    let save = SaveAt::Every(1);
    let run = integrate(&hole, &method, &grid(1.0, 10), &save, &mut y, |t, y| last = (t, *y));
    let Err(RunError::Step(failure)) = run else { panic!("{run:?}") };
    assert_eq!((failure.step, failure.t), (7, grid(1.0, 10).time(7)));
    assert!((failure.h - 0.1).abs() < 1e-15);
    assert_eq!(failure.source, StepError::NonFiniteRhs { stage: 4 });
    assert_eq!((failure.t, y), last, "the last accepted state");
    // From there the run goes on, and is the run that was not interrupted.
    let plain = Flow::of_time(So3::new(), Linear, |_: f64, v: &mut Vector3<f64>| {
        *v = Vector3::new(1.0, 2.0, 3.0);
    });
    let rest = TimeGrid::with_steps([failure.t, 1.0], 3).expect("a grid");
    integrate(&plain, &method, &rest, &SaveAt::Ends, &mut y, |_, _| {}).expect("the rest");
    let mut whole = start;
    integrate(&plain, &method, &grid(1.0, 10), &SaveAt::Ends, &mut whole, |_, _| {}).expect("all");
    assert!((y - whole).norm() < 1e-14);

    // Adaptive: attempts run out.
    let (mut y, mut last) = (start, (0.0, start));
    let few = control().max_steps(12).expect("a limit");
    let dopri5 = Rkmk::new(DOPRI5, Exp);
    let run =
        integrate_adaptive(&body, &dopri5, [0.0, 50.0], &few, &save, &mut y, |t, y| last = (t, *y));
    let Err(RunError::TooManySteps { t, h, accepted, rejected, .. }) = run else {
        panic!("{run:?}")
    };
    assert_eq!((accepted + rejected, t, y), (12, last.0, last.1));
    assert!(h > 0.0 && t > 0.0);
}

/// T12: the times of 1e8 steps are exact to rounding, and so is what 1e6 of them add up to.
#[test]
fn very_many_steps() {
    let steps = 100_000_000;
    let grid = TimeGrid::with_steps([0.1, 10_000.1], steps).expect("a grid");
    assert_eq!(grid.time(steps), 10_000.1);
    for n in (0..=steps).step_by(999_983) {
        let exact = 0.1 + 1e4 * (n as f64 / steps as f64);
        assert!((grid.time(n) - exact).abs() <= 2.0 * f64::EPSILON * exact, "{n}");
    }
    // A clock that is summed up would be off by 1e-7 here: ∫ t dt by the midpoints is exact.
    let clock = Flow::of_time(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
        *v = Vector3::new(0.0, 0.0, t);
    });
    let (mut y, end) = (Vector3::x(), 1e4);
    let fine = TimeGrid::with_steps([0.0, end], 1_000_000).expect("a grid");
    let midpoint = Rkmk::new(MIDPOINT, Exp);
    integrate(&clock, &midpoint, &fine, &SaveAt::Ends, &mut y, |_, _| {}).expect("a run");
    // The angle 5e7 has an error of ε·5e7 = 1e-8 of its own in each result, and 1e-14 a step from the
    // angles of the steps, t·h to ε.
    let angle = 0.5 * end * end;
    assert!((y - Vector3::new(angle.cos(), angle.sin(), 0.0)).norm() < 1e-8, "{y}");
}

/// A free body does not know what time it is: steps are even beside t = 1.7e9, where ulps of t are 2e-7, and
/// a run begun there is that begun at 0, bit by bit.
#[test]
fn steps_are_even_beside_a_large_time() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let run = |t_span| {
        let (mut y, mut sum) = (Vector3::new(0.9, 1.0, 2.1), 0.0);
        let (grid, save) = (TimeGrid::new(t_span, 0.01).expect("a grid"), SaveAt::Every(1));
        let rkmk4 = Rkmk::new(RK4, Exp);
        integrate(&body, &rkmk4, &grid, &save, &mut y, |_, y| sum += y[0]).expect("a run");
        (y, sum)
    };
    let start = 1.7e9;
    assert_eq!(run([0.0, 100.0]), run([start, start + 100.0]));
    assert_eq!(run([0.0, -100.0]), run([start, start - 100.0]));
}

/// T12 as a run: the field sees each of 1e8 times within two units in the last place.
#[test]
#[ignore = "1e8 steps; .ci/long runs it: cargo test --release --test long time_stepping -- --ignored"]
fn a_hundred_million_steps() {
    let (steps, end, n, worst) = (100_000_000, 1e4, Cell::new(0u64), Cell::new(0.0f64));
    let still = |t: f64, _: &mut Vector3<f64>| {
        // The field is asked once before the run.
        let exact = end * (n.get().saturating_sub(1) as f64 / steps as f64);
        n.set(n.get() + 1);
        worst.set(worst.get().max((t - exact).abs() / exact.max(1e-300)));
    };
    let group = Translations::new(Vector3::zeros(), 3);
    let problem = Flow::of_time(group, LeftTranslation, still);
    let (mut y, mut last) = (Vector3::zeros(), 0.0);
    let euler = Rkmk::new(EULER, Exp);
    let stats =
        integrate(&problem, &euler, &grid(end, steps), &SaveAt::Ends, &mut y, |t, _| last = t)
            .expect("a run");
    assert_eq!((stats.accepted, last, n.get()), (steps, end, steps + 1));
    assert!(worst.get() <= 2.0 * f64::EPSILON, "{:e}", worst.get());
}

/// An adaptive run of many steps stays on its group as a fixed one does, and one of a method that
/// leaves the group is shown as it is.
#[test]
fn an_adaptive_run_is_kept_on_the_group() {
    let body = RigidBodyAttitude::<f64>::new([1.0, 2.0, 3.0], [0.9, 1.0, 2.1]).expect("a body");
    let fine = control().max_step(1e-2).expect("a limit");
    let mut g = Matrix3::identity();
    let stats = integrate_adaptive(
        &body,
        &Rkmk::new(DOPRI5, Exp),
        [0.0, 400.0],
        &fine,
        &SaveAt::Ends,
        &mut g,
        |_, _| {},
    )
    .expect("a run");
    assert!(stats.accepted >= 40_000 && stats.restored >= 400 && stats.not_restored == 0);
    assert!(So3::new().defect(&g) < 2e-14, "{:e}", So3::new().defect(&g));
    for doubled in [false, true] {
        let (mut g, span, save) = (Matrix3::identity(), [0.0, 20.0], SaveAt::Ends);
        let loose = StepControl::new(1e-4, 1e-4).expect("tolerances");
        let stats = match doubled {
            true => integrate_adaptive(
                &body,
                &Doubling(Rk(RK4)),
                span,
                &loose,
                &save,
                &mut g,
                |_, _| {},
            ),
            false => integrate_adaptive(&body, &Rk(DOPRI5), span, &loose, &save, &mut g, |_, _| {}),
        };
        assert_eq!(stats.expect("a run").restored, 0);
        assert!(So3::new().defect(&g) > 1e-9);
    }
}
