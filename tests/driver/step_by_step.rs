//! A run that is taken step by step is that of `run`: with stops, in parts by the clock, and after an error of f.

use std::cell::Cell;
use std::time::Duration;

use crate::support::boxed::boxed_flow;
use lieflow::actions::{LeftTranslation, Linear};
use lieflow::catalog::MethodsByName;
use lieflow::faer::Mat;
use lieflow::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup, Power, So3, Translations};
use lieflow::maps::Exp;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, HEUN, RK4};
use lieflow::methods::{
    AnyMethod, Composition, Doubling, Facts, GAUSS4, Method, Rk, Rkmk, RkmkGauss, STRANG, Step,
    Symmetric,
};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::problems::Problem;
use lieflow::so3::exp;
use lieflow::solve::Next;
use lieflow::{Error, Event, RunError, SaveAt, Solve, StepError, TimeGrid};

/// ω about one axis with a pulse of 1000 for a thousandth of the time: its integral up to t.
const PULSE: [f64; 2] = [2.0, 2.001];

/// A step ends four roundings of t before a jump: so much of the pulse is missing.
const ROUNDING: f64 = 1e-11;

fn rate(t: f64) -> f64 {
    if (PULSE[0]..PULSE[1]).contains(&t) { 1000.0 } else { 0.1 }
}

fn angle(t: f64) -> f64 {
    let inside = (t.min(PULSE[1]) - PULSE[0]).max(0.0);
    0.1 * t + 999.9 * inside
}

fn distance(g: &Matrix3<f64>, t: f64) -> f64 {
    (g - exp(&Vector3::new(0.0, 0.0, angle(t))).expect("an angle")).norm()
}

#[test]
fn stops_are_not_stepped_over() {
    let f = |t: f64, _: &Matrix3<f64>, v: &mut Vector3<f64>| *v = Vector3::new(0.0, 0.0, rate(t));
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let (pair, equal) = (Rkmk::new(DOP853, Exp), Rkmk::new(RK4, Exp));
    let by_error = || Solve::new(&flow, &pair, [0.0, 10.0]).tolerances(1e-9, 1e-12).stops(PULSE);
    let by_size = || Solve::new(&flow, &equal, [0.0, 10.0]).dt(0.3).stops(PULSE);
    let whole = by_error().run(Matrix3::identity()).expect("a run");
    assert!(distance(&whole.y, 10.0) < ROUNDING);
    for (name, mut run) in
        [("step", 0), ("advance_to", 1), ("advance_for", 2)].map(|(name, way)| {
            (name, (way, by_error().integrator(Matrix3::identity()).expect("a start")))
        })
    {
        let (way, run) = (run.0, &mut run.1);
        match way {
            0 => {
                while !run.is_done() {
                    run.step().expect("a step");
                }
            }
            1 => drop(run.advance_to(10.0).expect("steps")),
            _ => while !run.advance_for(10.0, Duration::from_nanos(1)).expect("steps") {},
        }
        assert_eq!(*run.y(), whole.y, "{name}");
        assert_eq!(run.stats().accepted, whole.stats.accepted, "{name}");
    }
    // Times between, and exactly at the jumps; the value after a jump counts for the next step alone.
    let mut run = by_error().integrator(Matrix3::identity()).expect("a start");
    for t in [1.0, 2.0, 2.0005, 2.001, 7.0, 10.0] {
        run.advance_to(t).expect("steps");
        assert!(distance(run.y(), t) < ROUNDING, "t = {t}: {:e}", distance(run.y(), t));
    }
    let whole = by_size().run(Matrix3::identity()).expect("a run");
    let mut run = by_size().integrator(Matrix3::identity()).expect("a start");
    run.advance_to(10.0).expect("steps");
    assert_eq!(*run.y(), whole.y);
    assert!(distance(run.y(), 10.0) < ROUNDING);
}

/// Backward, and from a saved state.
#[test]
fn stops_are_those_ahead() {
    let f = |t: f64, _: &Matrix3<f64>, v: &mut Vector3<f64>| *v = Vector3::new(0.0, 0.0, rate(t));
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let pair = Rkmk::new(DOP853, Exp);
    let new = |span| Solve::new(&flow, &pair, span).tolerances(1e-9, 1e-12).stops(PULSE);
    let mut there = new([0.0, 5.0]).integrator(Matrix3::identity()).expect("a start");
    there.advance_to(1.0).expect("steps");
    let saved = there.save();
    there.advance_to(5.0).expect("steps");
    let mut back = new([5.0, 0.0]).integrator(*there.y()).expect("a start");
    back.advance_to(0.0).expect("steps");
    assert_eq!(*back.y(), new([5.0, 0.0]).run(*there.y()).expect("a run").y);
    let mut again = new([0.0, 5.0]).integrator(Matrix3::identity()).expect("a start");
    again.advance_to(4.0).expect("steps");
    again.restore(&saved).expect("a state");
    again.advance_to(5.0).expect("steps");
    assert_eq!(again.y(), there.y());
}

/// A stop one rounding after the time to which the run goes is not reached, and neither is a time after the end.
#[test]
fn times_one_rounding_apart_are_two() {
    let f = |t: f64, _: &Matrix3<f64>, v: &mut Vector3<f64>| *v = Vector3::new(0.0, 0.0, rate(t));
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let (pair, equal) = (Rkmk::new(DOP853, Exp), Rkmk::new(RK4, Exp));
    for sign in [1.0, -1.0] {
        let after = |t: f64| if sign > 0.0 { t.next_up() } else { t.next_down() };
        // The distances from the start are the same after rounding.
        let span = [-1000.0 * sign, 5.0 * sign];
        let by_error = Solve::new(&flow, &pair, span).tolerances(1e-9, 1e-12);
        let by_size = Solve::new(&flow, &equal, span).dt(0.3);
        let stop = after(2.0 * sign);
        let mut runs = (
            by_error.stops([stop]).integrator(Matrix3::identity()).expect("a start"),
            by_size.stops([stop]).integrator(Matrix3::identity()).expect("a start"),
        );
        assert!(runs.0.advance_to(after(5.0 * sign)).is_err());
        for t in [2.0 * sign, stop, 5.0 * sign] {
            runs.0.advance_to(t).expect("steps");
            runs.1.advance_to(t).expect("steps");
            assert_eq!((runs.0.t(), runs.1.t()), (t, t));
        }
        assert!(runs.0.advance_to(after(5.0 * sign)).is_err());
        assert!(runs.1.advance_to(after(5.0 * sign)).is_err());
    }
}

/// f fails for a while. Where it is whole again, the run goes on as if nothing had happened.
#[test]
fn a_run_goes_on_after_an_error_of_f() {
    let broken = Cell::new(false);
    let f = |t: f64, g: &Matrix3<f64>, v: &mut Vector3<f64>| {
        *v = Vector3::new(g[(0, 1)], if broken.get() { f64::NAN } else { t.sin() }, 1.0);
    };
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let method = Rkmk::new(DOPRI5, Exp);
    let new = || {
        let solve = Solve::new(&flow, &method, [0.0, 5.0]).tolerances(1e-8, 1e-10);
        solve.integrator(Matrix3::identity()).expect("a start")
    };
    let (mut whole, mut run) = (new(), new());
    for k in 1..=5 {
        let t = f64::from(k);
        whole.advance_to(t).expect("steps");
        broken.set(true);
        let before = run.t();
        assert!(matches!(run.step(), Err(RunError::StepSizeUnderflow { .. })));
        assert!(run.advance_to(t).is_err());
        assert_eq!(run.t(), before);
        broken.set(false);
        run.advance_to(t).expect("steps");
        assert_eq!(run.y(), whole.y(), "t = {t}");
        assert_eq!(run.stats().accepted, whole.stats().accepted);
    }
}

/// The times of split steps contain those of the steps, and each part is between a third and two thirds of a step.
#[test]
fn split_steps_are_parts_of_steps() {
    let spans =
        [([0.0, 3.0], 0.1), ([0.3, -2.0], 0.07), ([1e9, 1e9 + 1.0], 0.3), ([0.0, 0.1], 1.0)];
    for (span, dt) in spans {
        let whole = TimeGrid::new(span, dt).expect("a grid");
        let parts = whole.split();
        assert_eq!(
            (parts.steps(), parts.t_span(), parts.h()),
            (2 * whole.steps(), span, whole.h())
        );
        for n in 0..=whole.steps() {
            assert_eq!(parts.time(2 * n), whole.time(n), "{span:?}");
        }
        for n in 0..whole.steps() {
            let [start, middle, end] = [0, 1, 2].map(|part| parts.time(2 * n + part));
            let share = (middle - start) / (end - start);
            assert!((0.33..0.67).contains(&share) && share != 0.5, "{span:?}: {share}");
        }
    }
    let endless = TimeGrid::new([0.0, f64::INFINITY], 0.5).expect("a grid").split();
    assert_eq!((endless.time(12), endless.steps()), (3.0, u64::MAX));
}

/// The error over split steps is the share of that over whole steps that their doc states, also where a stop takes the run
/// off its grid.
#[test]
fn split_steps_have_the_error_that_is_stated() {
    let f = |t: f64, g: &Matrix3<f64>, v: &mut Vector3<f64>| {
        *v = Vector3::new((2.0 * t).sin(), g.m11, 0.5);
    };
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let (fine, heun, rk4) = (Rkmk::new(DOP853, Exp), Rkmk::new(HEUN, Exp), Rkmk::new(RK4, Exp));
    let right = Solve::new(&flow, &fine, [0.0, 3.0]).dt(1e-3).run(Matrix3::identity());
    let right = right.expect("a run").y;
    for (p, steps) in [(2, 3000), (4, 120)] {
        for stops in [&[][..], &[1.0012]] {
            let error = |split: bool| {
                let grid = TimeGrid::with_steps([0.0, 3.0], steps).expect("a grid");
                let grid = if split { grid.split() } else { grid };
                let (g, span, stops) = (Matrix3::identity(), [0.0, 3.0], stops.to_vec());
                let run = match p {
                    2 => Solve::new(&flow, &heun, span).grid(grid).stops(stops).run(g),
                    _ => Solve::new(&flow, &rk4, span).grid(grid).stops(stops).run(g),
                };
                let run = run.expect("a run");
                assert_eq!(run.stats.accepted >= 2 * steps, split);
                (run.y - right).norm()
            };
            let share = error(true) / error(false) / TimeGrid::split_error(p);
            assert!((share - 1.0).abs() < 0.05, "order {p}, {stops:?}: {share}");
        }
    }
}

/// f may be another one after `advance_to`, and after an event changed something that f depends on: its value at the end of
/// the step before is not used.
#[test]
fn f_may_change_where_a_step_ends() {
    let rate = Cell::new(1.0);
    let flow = boxed_flow(Translations::new(0.0, 1), LeftTranslation, |_, _: &f64, v: &mut f64| {
        *v = rate.get()
    });
    macro_rules! check {
        ($($method:expr),*) => {$({
            let method = $method;
            let solve = || Solve::new(&flow, &method, [0.0, 2.0]).tolerances(1e-3, 1e-3);
            rate.set(1.0);
            let mut run = solve().integrator(0.0).expect("a start");
            run.advance_to(1.0).expect("steps");
            rate.set(2.0);
            let y = *run.advance_to(2.0).expect("steps");
            assert!((y - 3.0).abs() < 1e-12, "{y}");
            // Between any two steps, too: y is the sum of the rates times the steps.
            let limited = solve().max_step(0.05);
            let (mut run, mut sum, mut sign) = (limited.integrator(0.0).expect("a start"), 0.0, 1.0);
            while !run.is_done() {
                rate.set(sign);
                let before = run.t();
                run.step().expect("a step");
                sum += sign * (run.t() - before);
                sign = -sign;
            }
            assert!((run.y() - sum).abs() < 1e-12, "{} for {sum}", run.y());
            assert!(run.stats().accepted < 100, "{:?}", run.stats());
            // The change leaves y as it is.
            rate.set(1.0);
            let switch = Event::new("switch", |t, _| t - 1.0).change(|_, _| rate.set(2.0));
            let y = solve().event(switch).run(0.0).expect("a run").y;
            assert!((y - 3.0).abs() < 1e-12, "{y}");
        })*};
    }
    check![Rk(BS3), Rk(DOPRI5), Rkmk::new(DOPRI5, Exp), AnyMethod::embedded(Rk(DOPRI5))];
}

/// A state of another number of columns, a point of another size: each is refused, and the run goes on.
#[test]
fn points_of_other_sizes_are_refused() {
    let group = MatrixGroup::so(5).expect("SO(5)");
    let zero = group.zero();
    let field = |_: f64, _: &Mat<f64>, v: &mut AlgebraMatrix| v.clone_from(&zero);
    let flow = boxed_flow(group, Linear, field);
    let start = Mat::from_fn(5, 1, |i, _| i as f64);
    let wide = || Mat::<f64>::zeros(5, 3);
    for name in ["rk4", "rk dopri5", "rkmk4", "cf4", "gauss4"] {
        let method = flow.method(&name.parse().expect("a name")).expect("a method");
        let solve = || Solve::new(&flow, &method, [0.0, 1.0]).dt(0.25);
        let mut run = solve().integrator(start.clone()).expect("a start");
        run.step().expect("a step");
        for _ in 0..2 {
            let told = run.set_state(&wide()).expect_err("another size").to_string();
            assert!(told.contains("5×3, expected 5×1"), "{told}");
            run.step().expect("a step");
        }
        for t in [0.6, run.t()] {
            for other in [wide(), Mat::zeros(0, 0), Mat::zeros(4, 1)] {
                let told = run.interpolate(t, &mut other.clone()).expect_err("another size");
                assert!(told.to_string().starts_with("at: "), "{told}");
            }
        }
        let event = Event::new("at", |t, _| t - 0.3).change(move |_, y: &mut Mat<f64>| *y = wide());
        let told = solve().event(event).run(start.clone()).expect_err("another size").to_string();
        assert!(told.contains("5×3, expected 5×1"), "{told}");
        let observed = |next: Next| {
            solve().save(SaveAt::Every(1)).run_with(start.clone(), move |_, y| {
                *y = wide();
                next
            })
        };
        observed(Next::Changed).expect_err("another size");
        assert_eq!(observed(Next::Continue).expect("a run").y, start);
    }
    type Vectors = Box<[Vector3<f64>]>;
    let copies = Power::new(So3::<f64>::new(), 3).expect("copies");
    let still = boxed_flow(copies, Linear, |_, _: &Vectors, _: &mut Vectors| {});
    let method = Rkmk::new(RK4, Exp);
    let start: Vectors = vec![Vector3::x(); 3].into();
    let solve = Solve::new(&still, &method, [0.0, 1.0]).dt(0.5);
    let mut run = solve.integrator(start).expect("a start");
    run.step().expect("a step");
    for n in [0, 2, 5] {
        let mut other: Vectors = vec![Vector3::zeros(); n].into();
        for t in [0.2, 0.5] {
            run.interpolate(t, &mut other).expect_err("another size");
        }
    }
}

/// The limit of attempts is that of a call: a loop by hand may take any number of steps, and each call ends.
#[test]
fn each_call_has_the_limit_of_attempts() {
    let f = |_: f64, _: &Matrix3<f64>, v: &mut Vector3<f64>| *v = Vector3::new(0.0, 0.0, 0.1);
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let method = Rkmk::new(DOPRI5, Exp);
    let solve = |by_error: bool| {
        let solve = Solve::new(&flow, &method, [0.0, f64::INFINITY]).max_steps(100);
        if by_error { solve.tolerances(1e-6, 1e-6).max_step(0.01) } else { solve.dt(0.01) }
    };
    for by_error in [true, false] {
        let start = || solve(by_error).integrator(Matrix3::identity()).expect("a start");
        let mut run = start();
        for k in 1..=20 {
            run.advance_to(0.9 * f64::from(k)).expect("steps within the limit");
        }
        for _ in 0..500 {
            run.step().expect("a step");
        }
        assert!(run.stats().accepted > 2000);
        let state = run.save();
        // More than a call may take; the message has the time that was asked for.
        let far = run.t() + 2.0;
        for call in 0..2 {
            let failed = match call {
                0 => run.advance_to(far).map(drop),
                _ => (0..200).try_for_each(|_| run.advance_for(far, Duration::ZERO).map(drop)),
            };
            match failed {
                Err(RunError::TooManySteps { left, max_steps: 100, .. }) => {
                    assert!(left < 2.0, "{left}")
                }
                other => panic!("{other:?}"),
            }
            run.restore(&state).expect("its own state");
        }
        run.advance_to(run.t() + 0.5).expect("a call after an error");
        let mut other = start();
        other.restore(&state).expect("a state");
        other.advance_to(other.t() + 0.5).expect("steps after a state of many");
        assert_eq!(other.y(), run.y());
    }
}

/// A start with the digits of f32 is put on the group at once, and not in the middle of the run.
#[test]
fn a_start_with_few_digits_is_corrected_at_once() {
    let f = |_: f64, _: &Matrix3<f64>, v: &mut Vector3<f64>| *v = Vector3::new(0.1, 0.2, 0.3);
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let rough =
        exp(&Vector3::new(1.0, 2.0, 3.0)).expect("an angle").map(|x: f64| f64::from(x as f32));
    let method = Rkmk::new(DOP853, Exp);
    let run = Solve::new(&flow, &method, [0.0, 5.0]).tolerances(1e-12, 1e-12).count(20);
    let run = run.run(rough).expect("a run");
    for y in &run.points {
        assert!((y.transpose() * y - Matrix3::identity()).norm() < 1e-14, "{y}");
    }
    assert!((run.points[0] - rough).norm() < 1e-7);
    // One that has all digits stays as it is, to the bit.
    let fine = exp(&Vector3::new(1.0, 2.0, 3.0)).expect("an angle");
    let run = Solve::new(&flow, &method, [0.0, 5.0]).tolerances(1e-12, 1e-12).count(1);
    assert_eq!(run.run(fine).expect("a run").points[0], fine);
}

/// A run by hand goes on from bytes, too, and refuses those of another run.
#[test]
fn a_run_by_hand_goes_on_from_bytes() {
    let f = |_: f64, _: &Matrix3<f64>, v: &mut Vector3<f64>| *v = Vector3::new(0.0, 0.0, 0.1);
    let flow = boxed_flow(So3::new(), LeftTranslation, f);
    let method = Rkmk::new(RK4, Exp);
    let solve = || Solve::new(&flow, &method, [0.0, 10.0]).dt(0.1);
    let mut first = solve().integrator(Matrix3::identity()).expect("a start");
    first.advance_to(3.0).expect("steps");
    let mut second = solve().resume(first.save()).integrator(Matrix3::identity()).expect("a state");
    assert_eq!((second.t(), second.y()), (3.0, first.y()));
    first.advance_to(7.0).expect("steps");
    second.advance_to(7.0).expect("steps");
    assert_eq!(second.y(), first.y());
    assert!(solve().resume(vec![1, 2, 3]).integrator(Matrix3::identity()).is_err());
}

/// Steps by error of an integrator turn the state by as little as those of a run: the points within them are right.
#[test]
fn steps_by_error_turn_little() {
    let rate = Vector3::new(0.6, 0.0, 0.8);
    let problem = boxed_flow(
        So3::new(),
        LeftTranslation,
        move |_, _: &Matrix3<f64>, v: &mut Vector3<f64>| *v = rate,
    );
    macro_rules! little {
        ($($method:expr),*) => {$({
            let method = $method;
            let solve = || Solve::new(&problem, &method, [0.0, 1000.0]).tolerances(1e-7, 0.0);
            let run = solve().run(Matrix3::identity()).expect("a run");
            let mut single = solve().integrator(Matrix3::identity()).expect("a start");
            let mut at = Matrix3::zeros();
            while !single.is_done() {
                let from = single.t();
                let end = single.step().expect("a step");
                for k in 1..20 {
                    let t = from + (end - from) * f64::from(k) / 20.0;
                    single.interpolate(t, &mut at).expect("a point");
                    let off = (at - exp(&(rate * t)).expect("a turn")).norm();
                    assert!(off < 1e-9, "{} at {t}: {off}", stringify!($method));
                }
            }
            assert_eq!(*single.y(), run.y, "{}", stringify!($method));
            assert_eq!(single.stats().largest_step, run.stats.largest_step);
        })*};
    }
    little![
        Doubling(Rkmk::new(RK4, Exp)),
        Doubling(RkmkGauss::new(GAUSS4, Exp)),
        Rkmk::new(DOPRI5, Exp)
    ];
}

type V = Vector3<f64>;

/// Euler's method that keeps f at the end of a step for the next one.
struct Keeping;

impl Symmetric for Keeping {}

impl<P: Problem<Group = Translations<V>, Action = LeftTranslation>> Method<P> for Keeping {
    type Work = (Option<V>, P::Work);

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(1)
    }
    fn work(&self, problem: &P, _: &V) -> Result<Self::Work, Error> {
        Ok((None, problem.work()))
    }
    fn forget(&self, work: &mut Self::Work) {
        work.0 = None;
    }
    fn step(
        &self,
        problem: &P,
        step: Step<f64>,
        y: &mut V,
        (kept, work): &mut Self::Work,
    ) -> Result<(), StepError> {
        let mut k = V::zeros();
        let mut f = |t: f64, y: &V| {
            problem.f(t, y, &mut k, work);
            k
        };
        let first = kept.unwrap_or_else(|| f(step.t, y));
        *y += step.h * first;
        *kept = Some(f(step.t + step.h, y));
        Ok(())
    }
}

/// An observer that changes f is told to a method that keeps f, in each way to take steps.
#[test]
fn wrappers_and_steps_of_one_size_forget() {
    let rate = Cell::new(1.0);
    let group = Translations::new(V::zeros(), 3);
    let flow = boxed_flow(group, LeftTranslation, |_, _: &V, v: &mut V| *v = V::x() * rate.get());
    macro_rules! check {
        ($($method:expr),*) => {$(
            let method = $method;
            for rows in [1, 10] {
                rate.set(1.0);
                let solve = Solve::new(&flow, &method, [0.0, 2.0]).steps(20).every(rows);
                let run = solve.run_with(V::zeros(), |t, _| {
                    if t == 1.0 {
                        rate.set(3.0);
                        return Next::Changed;
                    }
                    Next::Continue
                });
                let found = run.expect("a run").y.x;
                assert!((found - 4.0).abs() < 1e-13, "{}, {rows}: {found}", stringify!($method));
            }
        )*};
    }
    check!(Keeping, Doubling(Keeping), Composition::new(Keeping, STRANG));
}
