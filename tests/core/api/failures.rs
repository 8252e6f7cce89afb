//! Runs that cannot go on say where and why, and keep what they have.

use faer::Mat;
use lieflow::actions::{Coadjoint, Conjugation, LeftTranslation, Linear};
use lieflow::groups::{AlgebraMatrix, MatrixGroup, So3};
use lieflow::maps::{CCSK, Cay, CoordinateMap, Exp};
use lieflow::methods::tableau::{DOP853, DOPRI5, RK4};
use lieflow::methods::{Method, Rk, Rkmk, Step};
use lieflow::problems::{Ambient, Flow, PointOf, Problem, RigidBody};
use lieflow::scalar::DoubleDouble;
use lieflow::tolerance::{Tolerance, least_rtol};
use lieflow::{
    Action, Error, Event, Failure, LieAlgebra, LieGroup, RunError, SaveAt, Solve, StepError,
    TimeGrid, integrate,
};
use nalgebra::Vector3;

use super::says;

/// A vector that turns about (1, 1, 1), by a field that gives out after a time.
fn gives_out(after: f64, value: f64) -> impl Ambient<Group = So3, Action = Linear> {
    Flow::of_time(So3::<f64>::new(), Linear, move |t, v| {
        *v = Vector3::new(1.0, 1.0, if t > after { value } else { 1.0 });
    })
}

/// The same on n×n matrices.
fn gives_out_n(
    group: MatrixGroup,
    after: f64,
    value: f64,
) -> impl Ambient<Group = MatrixGroup, Action = Linear> {
    let n = group.n();
    Flow::of_time(group, Linear, move |t, v: &mut AlgebraMatrix| {
        let a = if t > after { value } else { 1.0 };
        *v = AlgebraMatrix::new_unchecked(Mat::from_fn(n, n, |i, j| {
            a * ((i > j) as i32 - (i < j) as i32) as f64
        }));
    })
}

/// The output of a run.
type Seen<P> = Vec<(f64, PointOf<P>)>;

/// Ten steps of 0.1 with output after each.
fn attempt<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    y: &mut PointOf<P>,
) -> (Result<(), RunError>, Seen<P>)
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    let grid = TimeGrid::new([0.0, 1.0], 0.1).unwrap();
    let mut seen = Vec::new();
    let done = integrate(problem, method, &grid, &SaveAt::Every(1), y, |t, y| {
        seen.push((t, y.clone()));
    });
    (done.map(|_| ()), seen)
}

/// With f finite until `after` and then not, the run fails in step `step` at stage `stage`, with
/// y at the last accepted state.
fn fails_at<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    start: PointOf<P>,
    (step, stage): (u64, usize),
) where
    P::Group: LieAlgebra<Scalar = f64>,
    PointOf<P>: PartialEq + std::fmt::Debug,
{
    let mut y = start;
    let (done, seen) = attempt(problem, method, &mut y);
    let Err(RunError::Step(failure)) = done else { panic!("{done:?}") };
    assert_eq!(failure.source, StepError::NonFiniteRhs { stage });
    assert_eq!(failure.step, step);
    assert!((failure.t - 0.1 * step as f64).abs() < 1e-15 && (failure.h - 0.1).abs() < 1e-15);
    assert_eq!(seen.len() as u64, step + 1, "what was observed stands");
    assert_eq!(seen.last().map(|(_, y)| y), Some(&y), "y is the last accepted state");
    says(RunError::Step(failure), &[&format!("step {step}"), "f is not finite", "stage"]);
}

#[test]
fn a_field_that_is_not_finite_is_named_with_its_stage() {
    // Stage 1 at t, stages 2 and 3 at t + h/2, stage 4 at t + h.
    for (after, place) in [(-1.0, (0, 1)), (0.04, (0, 2)), (0.52, (5, 2)), (0.58, (5, 4))] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let so3 = gives_out(after, value);
            let x = Vector3::new(0.3, -0.4, 0.5);
            fails_at(&so3, &Rkmk::new(RK4, Exp), x, place);
            fails_at(&so3, &Rkmk::new(RK4, Cay), x, place);
            fails_at(&so3, &Rkmk::new(RK4, CCSK), x, place);
            fails_at(&so3, &Rk(RK4), x, place);
            for n in [3, 9] {
                let x = Mat::from_fn(n, 1, |i, _| 0.1 + i as f64);
                let so_n = gives_out_n(MatrixGroup::so(n).unwrap(), after, value);
                fails_at(&so_n, &Rkmk::new(RK4, Exp), x.clone(), place);
                fails_at(&so_n, &Rkmk::new(RK4, Exp.truncated(2)), x.clone(), place);
                fails_at(&so_n, &Rkmk::new(RK4, Cay), x.clone(), place);
                fails_at(&so_n, &Rkmk::new(RK4, CCSK), x.clone(), place);
                let gl_n = gives_out_n(MatrixGroup::gl(n).unwrap(), after, value);
                fails_at(&gl_n, &Rkmk::new(RK4, Exp), x.clone(), place);
                fails_at(&gl_n, &Rkmk::new(RK4, Cay), x, place);
            }
        }
    }
}

/// Finite values that no step can carry: an error, or a finite state.
#[test]
fn a_field_that_overflows_is_an_error() {
    fn check<P: Problem, M: Method<P>>(
        problem: &P,
        method: &M,
        start: PointOf<P>,
        finite: Finite<P>,
    ) where
        P::Group: LieAlgebra<Scalar = f64>,
    {
        let mut y = start;
        let (done, seen) = attempt(problem, method, &mut y);
        assert!(finite(&y) && seen.iter().all(|(_, y)| finite(y)), "not a number in the output");
        if let Err(error) = done {
            assert!(matches!(error, RunError::Step(Failure { step: 5.., .. })), "{error}");
        }
    }
    type Finite<P> = fn(&PointOf<P>) -> bool;
    for value in [1e10, 1e100, 1e160, 1e300, f64::MAX] {
        let so3 = gives_out(0.52, value);
        let x = Vector3::new(0.3, -0.4, 0.5);
        let finite = |x: &Vector3<f64>| x.iter().all(|x| x.is_finite());
        check(&so3, &Rkmk::new(RK4, Exp), x, finite);
        check(&so3, &Rkmk::new(RK4, Cay), x, finite);
        check(&so3, &Rkmk::new(RK4, CCSK), x, finite);
        check(&so3, &Rk(RK4), x, finite);
        for group in [MatrixGroup::so(4).unwrap(), MatrixGroup::gl(4).unwrap()] {
            let so_n = gives_out_n(group, 0.52, value);
            let x = Mat::from_fn(4, 1, |i, _| 0.1 + i as f64);
            let finite = |x: &Mat<f64>| x.col(0).iter().all(|x| x.is_finite());
            check(&so_n, &Rkmk::new(RK4, Exp), x.clone(), finite);
            check(&so_n, &Rkmk::new(RK4, Cay), x, finite);
        }
    }
}

/// A workspace that a step failed in is as good as new.
#[test]
fn a_failed_step_leaves_nothing_behind() {
    fn check<Psi: CoordinateMap<So3>>(psi: Psi) {
        let (body, method) = (RigidBody::new([1.0, 2.0, 3.5]).unwrap(), Rkmk::new(RK4, psi));
        let start = Vector3::new(1.0, 0.8, -1.2);
        let mut work = method.work(&body, &start).unwrap();
        let good = Step { n: 0, t: 0.0, h: 0.1 };
        let mut expected = start;
        method.step(&body, good, &mut expected, &mut work).unwrap();
        for h in [f64::NAN, f64::INFINITY, 1e200] {
            let mut y = start;
            assert!(method.step(&body, Step { h, ..good }, &mut y, &mut work).is_err(), "h = {h}");
            assert_eq!(y, start, "untouched");
            method.step(&body, good, &mut y, &mut work).unwrap();
            assert_eq!(y, expected);
        }
    }
    check(Exp);
    check(Cay);
}

/// ẋ = x², whose solution ends at t = 1: an error there or later, never a number that is none.
#[test]
fn a_solution_that_blows_up_ends_in_an_error() {
    let gl1 = MatrixGroup::gl(1).unwrap();
    let problem = Flow::new(gl1, Linear, |_, x, v| v[(0, 0)] = x[(0, 0)]);
    let grid = TimeGrid::new([0.0, 5.0], 0.01).unwrap();
    let mut x = Mat::from_fn(1, 1, |_, _| 1.0);
    let done = integrate(&problem, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut x, |_, _| {});
    let Err(RunError::Step(failure)) = done else { panic!("{done:?}") };
    assert!(x[(0, 0)].is_finite() && (0.99..1.2).contains(&failure.t), "{failure}, {x:?}");
}

#[test]
fn parts_that_do_not_fit_are_refused_before_the_run() {
    let problem = gives_out_n(MatrixGroup::indefinite(2, 1).unwrap(), 9.0, 0.0);
    let mut x = Mat::from_fn(3, 1, |_, _| 1.0);
    let (done, seen) = attempt(&problem, &Rkmk::new(RK4, CCSK), &mut x);
    assert!(matches!(done, Err(RunError::Setup(Error::Unsupported { .. }))), "{done:?}");
    says(done.unwrap_err(), &["ccsk", "SO(2,1)", "SO(n)"]);
    assert!(seen.is_empty());
}

/// A state that outgrows the range in its very last step is found by the next run, wherever it lives.
#[test]
fn a_state_that_outgrew_the_range_is_no_start() {
    fn twice<A: Action<MatrixGroup>>(group: &MatrixGroup, action: A, mut y: A::Point) {
        let u = group.algebra(faer::mat![[400.0, 0.0], [0.0, -400.0]]).expect("in 𝔤");
        let field = |_: f64, v: &mut AlgebraMatrix| v.copy_from(&*u);
        let problem = Flow::of_time(group.clone(), action, field);
        let grid = TimeGrid::with_steps([0.0, 2.0], 2).expect("a grid");
        let mut run =
            || integrate(&problem, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut y, |_, _| {});
        // e⁸⁰⁰ is beyond the range, and nothing comes after it that could stumble over it.
        match (run(), run()) {
            (Ok(_), second) => says(second.expect_err("not finite"), &["y[", "finite"]),
            (first, second) => assert!(second.is_err(), "{first:?}, then {second:?}"),
        }
    }
    for group in [MatrixGroup::gl(2), MatrixGroup::sp(2)] {
        let group = group.expect("a group");
        twice(&group, LeftTranslation, group.identity());
        twice(&group, Conjugation, Mat::from_fn(2, 2, |_, _| 1.0));
        twice(&group, Coadjoint, Mat::from_fn(2, 2, |_, _| 1.0));
        twice(&group, Linear, Mat::from_fn(2, 1, |_, _| 1.0));
    }
}

/// Times at the ends of the range of numbers are told in few digits.
#[test]
fn a_time_is_told_in_few_digits() {
    let body = lieflow::problems::RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
    let method = lieflow::methods::Rk(lieflow::methods::tableau::RK4);
    let solve = lieflow::Solve::new(&body, &method, [1e300, 1.5e300]).steps(1);
    let error = solve.run(nalgebra::Vector3::new(1.0, 2.0, 3.0)).unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("step 0 from t = 1e300 with h = 5e299 failed"), "{message}");
    let error = lieflow::TimeGrid::new([1e300, 1e300 - 1e285], 1e283).unwrap_err();
    assert!(error.to_string().ends_with("a step that changes t = 1e300"), "{error}");
}

#[test]
fn a_run_without_an_end_says_what_ends_it() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
    let never = |_: f64, m: &Vector3<f64>| m.x - 100.0;
    let said = |end: f64| {
        let method = Rkmk::new(DOPRI5, Exp);
        let solve = Solve::new(&body, &method, [0.0, end]).tolerances(1e-6, 1e-6).max_steps(100);
        let start = Vector3::new(0.1, 1.0, 0.2);
        let run = solve.event(Event::new("late", never).stop_after(1)).run(start);
        run.expect_err("it has no end").to_string()
    };
    let advice = "; the span has no end, and no event ended the run: give t_span an end";
    let (endless, long) = (said(f64::INFINITY), said(1e6));
    assert!(endless.contains(advice) && !endless.contains("raise max_steps"), "{endless}");
    assert!(
        !long.contains(advice) && long.contains("; raise max_steps or the tolerances"),
        "{long}"
    );
}

/// Without atol, an rtol below the rounding of the numbers is refused; the least one is met by methods of every order.
#[test]
fn an_rtol_below_rounding_is_refused() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
    let run = |rtol: f64, atol: f64| {
        let method = Rkmk::new(DOP853, Exp);
        let solve = Solve::new(&body, &method, [0.0, 1.0]).tolerances(rtol, atol);
        solve.run(Vector3::new(0.1, 1.0, 0.2)).map(|run| run.stats)
    };
    for rtol in [1e-30, 1e-16, 0.99 * least_rtol::<f64>()] {
        let error = run(rtol, 0.0).expect_err("it is below rounding");
        assert!(matches!(error.error, RunError::Setup(Error::OutOfRange { .. })), "{error}");
        let (found, least) = (format!("rtol = {rtol:?}, expected at least"), least_rtol::<f64>());
        let told = error.to_string();
        assert!(told.starts_with(&found) && told.contains(&format!("{least:.0e}")), "{told}");
        assert!(run(rtol, 1e-12).is_ok());
    }
    let stats = run(least_rtol::<f64>(), 0.0).unwrap();
    assert!(stats.rejected < stats.accepted && stats.accepted < 1000, "{stats:?}");
    assert!(Tolerance::new(1e-25, 0.0).unwrap().check_rounding::<DoubleDouble>().is_ok());
}
