//! Runs on numbers other than f64: what is rounding depends on the type of the numbers.

use std::cell::Cell;

use lieflow::groups::Se3;
use lieflow::methods::low_storage::LS5;
use lieflow::methods::{Embedded, LowStorage, Rk};
use lieflow::prelude::*;
use lieflow::problems::{Flow, RigidBody};
use lieflow::scalar::{DoubleDouble, Real, Trig};
use lieflow::space::Numbers;
use lieflow::tolerance::{PartTolerance, Tolerance};
use nalgebra::{Matrix3, Vector3};

fn vector<S: Real>(x: [f64; 3]) -> Vector3<S> {
    Vector3::from(x).map(S::lit)
}

/// The zeros of m₂ of a free body, and how often m₂ was evaluated.
fn flips<S: Trig + Numbers + Into<f64>, M: Embedded<RigidBody<S>>>(method: &M) -> (usize, u64) {
    let (body, looks) = (RigidBody::<S>::new([1.0, 2.0, 3.0]).unwrap(), Cell::new(0));
    let flip = |_: f64, m: &Vector3<S>| {
        looks.set(looks.get() + 1);
        m[1].into()
    };
    let solve = Solve::new(&body, method, [0.0, 60.0]).tolerances(1e-5, 1e-5);
    let run = solve.event(Event::new("flip", flip)).run(vector([0.01, 3.0, 0.01])).unwrap();
    (run.events.len(), looks.get())
}

/// g in f32 is a polynomial but for its rounding, which does not halve steps.
#[test]
fn events_in_f32_take_as_many_looks() {
    let (zeros, looks) = flips::<f64, _>(&Rkmk::new(DOP853, Exp));
    let (zeros_in_f32, looks_in_f32) = flips::<f32, _>(&Rkmk::new(DOP853, Exp));
    assert_eq!(zeros, zeros_in_f32);
    assert!(looks_in_f32 < 2 * looks, "{looks_in_f32} and {looks}");
}

/// A run in f32 is off the group by rounding of f32 at its end. It goes on from there, also after an event that changes
/// nothing.
#[test]
fn runs_in_f32_go_on_from_their_end() {
    let rate = |t: f32, g: &Matrix3<f32>, u: &mut Vector3<f32>| {
        *u = Vector3::new(t.sin() + 1.0, g[(0, 1)], 2.0);
    };
    let flow = Flow::new(So3::<f32>::new(), LeftTranslation, rate);
    let method = LowStorage(LS5);
    for k in 1..20 {
        let end = 0.1 + 0.02 * f64::from(k);
        let run = Solve::new(&flow, &method, [0.0, end]).steps(7).run(Matrix3::identity());
        let start = run.unwrap().y;
        let nothing = Event::new("g", |_, g: &Matrix3<f32>| (g[(0, 0)] - 0.9).into());
        let solve = Solve::new(&flow, &method, [0.0, end]).steps(7);
        let run = solve.event(nothing.change(|_, _| {})).run(start);
        assert!(run.is_ok(), "{k}: {}", run.unwrap_err());
    }
}

/// A method that leaves the group by its error goes on after an event, whose state is as far from the group.
#[test]
fn events_change_states_that_a_method_has_moved_off_the_group() {
    let rate = |t: f64, g: &Matrix3<f64>, u: &mut Vector3<f64>| {
        *u = Vector3::new(t.sin() + 1.0, g[(0, 1)], 2.0);
    };
    let flow = Flow::new(So3::<f64>::new(), LeftTranslation, rate);
    let mut ends = Vec::new();
    for rtol in [1e-2, 1e-3, 1e-6] {
        let event = Event::new("g", |_, g: &Matrix3<f64>| g[(0, 0)]).change(|_, _| {});
        let solve = Solve::new(&flow, &Rk(DOPRI5), [0.0, 3.0]).tolerances(rtol, rtol);
        let run = solve.event(event).run(Matrix3::identity()).unwrap();
        assert!(!run.events.is_empty());
        ends.push(run.y);
        // But an event may not move the state off the group.
        let event = Event::new("off", |_, g: &Matrix3<f64>| g[(0, 0)]);
        let event = event.change(|_, g: &mut Matrix3<f64>| g[(0, 0)] += 0.05);
        let solve = Solve::new(&flow, &Rk(DOPRI5), [0.0, 3.0]).tolerances(rtol, rtol);
        let error = solve.event(event).run(Matrix3::identity()).unwrap_err().to_string();
        assert!(error.contains("not in SO(3)"), "{error}");
    }
    assert!((ends[1] - ends[2]).norm() < 0.02);
}

fn with_wrong_tolerance<S: Trig + Numbers + Into<f64>>() -> bool {
    let twist = |t: S, _: &(Matrix3<S>, Vector3<S>), u: &mut (Vector3<S>, Vector3<S>)| {
        let (s, c) = t.sin_cos();
        *u = (Vector3::new(s, c, s * c), vector([1.0, 0.5, 0.0]));
    };
    let flow = Flow::new(Se3::<S>::new(), LeftTranslation, twist);
    // A rotation has no components.
    let parts = [
        PartTolerance::per_component(1e-8, [1e-8; 3]).unwrap(),
        PartTolerance::new(1e-2, 1e-2).unwrap(),
    ];
    let method = Rkmk::new(DOPRI5, Exp);
    let solve =
        Solve::new(&flow, &method, [0.0, 1.0]).tolerance(Tolerance::of_parts(parts).unwrap());
    solve.run((Matrix3::identity().map(S::lit), vector([0.0; 3]))).is_ok()
}

/// Infinite ratios are signals of the driver.
#[test]
fn tolerances_that_do_not_fit_are_refused_for_all_numbers() {
    assert!(!with_wrong_tolerance::<f64>());
    assert!(!with_wrong_tolerance::<f32>());
    assert!(!with_wrong_tolerance::<DoubleDouble>());
}

/// The rate jumps at a time that no step knows.
fn over_a_jump<S: Trig + Numbers + Into<f64>>(rtol: f64) -> [f64; 3] {
    let rate = |t: S, _: &Vector3<S>, u: &mut Vector3<S>| {
        *u = vector(if t.all_below(1.2345678) { [1.0, 0.0, 0.5] } else { [0.0, 3.0, 1.0] });
    };
    let flow = Flow::new(So3::<S>::new(), Linear, rate);
    let solve = Solve::new(&flow, &Rk(DOPRI5), [0.0, 2.0]).tolerances(rtol, 0.0);
    let y = solve.run(vector([1.0, 0.0, 0.0])).unwrap().y;
    [y[0].into(), y[1].into(), y[2].into()]
}

#[test]
fn jumps_are_passed_in_double_doubles() {
    for rtol in [1e-6, 1e-10] {
        let (expected, found) = (over_a_jump::<f64>(rtol), over_a_jump::<DoubleDouble>(rtol));
        let far = expected.iter().zip(found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 100.0 * rtol, "{rtol}: {expected:?} {found:?}");
    }
}
