//! What is read off a line of time against error.

use lieflow_cli::measure::{Candidate, Curve, Reached, Size, WorkPoint, pareto};
use lieflow_model::problem::Layer;

use crate::support::Folder;

/// error = h⁴, time per unit = 1/h.
fn ideal(hs: &[f64]) -> Curve {
    let candidate = Candidate::rk4(Layer::Closed);
    let label = candidate.name();
    let (order, stays, points) = (Some(4), false, Vec::new());
    let mut curve = Curve { candidate, label, order, stays, floor: 1e-17, points };
    curve.points = hs
        .iter()
        .map(|&h| WorkPoint {
            h,
            error: h.powi(4),
            seconds_per_unit: 1.0 / h,
            ..WorkPoint::new([0.0, 1.0], Size::Steps((1.0 / h).round() as u64))
        })
        .collect();
    curve
}

#[test]
fn the_order_of_an_ideal_method() {
    let order = ideal(&[0.2, 0.13, 0.07, 0.05]).measured_order();
    assert!((order.expect("enough points") - 4.0).abs() < 1e-12);
    assert_eq!(ideal(&[0.2, 0.1]).measured_order(), None);
}

/// Rounding has no order: runs near the floor do not count, and two runs above it are too few.
#[test]
fn no_order_is_fitted_into_the_floor() {
    let mut curve = ideal(&[0.1, 0.05, 0.025, 0.0125, 0.006]);
    for (point, error) in curve.points.iter_mut().zip([1.6e-4, 1e-5, 6.25e-7, 2e-7, 3e-7]) {
        point.error = error;
    }
    // Three runs are clean, and the others round, whether the floor is known or not.
    let order = |curve: &Curve| curve.measured_order().map(|p| (p * 1e9).round() / 1e9);
    assert_eq!(order(&curve), Some(4.0));
    curve.floor = 5e-8;
    assert_eq!(order(&curve), Some(4.0));
    curve.floor = 1e-7;
    assert_eq!(order(&curve), None);
}

/// Rounding of many small steps, large first steps, and slopes that never agree.
#[test]
fn the_order_is_that_of_runs_whose_slopes_agree() {
    let order = |errors: &[f64]| {
        let hs: Vec<f64> = (0..errors.len()).map(|i| 0.5_f64.powi(i as i32)).collect();
        let mut curve = ideal(&hs);
        curve.points.iter_mut().zip(errors).for_each(|(point, error)| point.error = *error);
        curve.measured_order()
    };
    // Rounding far above the floor, with a slope of its own by chance.
    let rounds = [9e-3, 5.6e-4, 3.5e-5, 2.2e-6, 1.4e-7, 9e-9, 1e-9, 6e-10, 3.5e-10, 2.1e-10];
    assert!((order(&rounds).expect("an order") - 4.0).abs() < 0.05);
    // The first steps are too large, and the first slope with them.
    let large = [1.7e-3, 1.1e-5, 9.6e-7, 7.2e-8, 4.9e-9, 3.2e-10, 2.0e-11, 1.3e-12];
    assert!((order(&large).expect("an order") - 3.97).abs() < 0.05);
    // A jump of f within steps, and then none.
    assert_eq!(order(&[1.3e-3, 8e-3, 1.3e-4, 5.9e-5, 4.9e-14, 7.2e-14, 9.7e-14]), None);
    assert_eq!(order(&[4.7e-15, 4.3e-15, 2.8e-14, 1.4e-13]), None);
    assert_eq!(order(&[]), None);
}

/// `lieflow order` on bundled scenes, whose smallest steps are all rounding.
#[test]
fn orders_of_bundled_scenes() {
    let folder = Folder::new();
    let scenes = ["rotating-field", "crossed-fields", "sorting", "oja", "mathieu", "manakov-body"];
    for scene in scenes {
        let told = folder.lieflow(&["order", scene, "--json"]).ok();
        let json: serde_json::Value = serde_json::from_str(&told).unwrap();
        for method in json["methods"].as_array().unwrap() {
            let [order, found] = ["order", "measured_order"].map(|key| method[key].as_f64());
            let apart = (order.expect("an order") - found.expect(scene)).abs();
            assert!(apart < 0.25, "{scene}: {method}");
        }
    }
    let told = folder.lieflow(&["order", "nutating-top"]).ok();
    assert!(told.contains(": the slopes of these runs have not settled at the order"), "{told}");
    let told = folder.lieflow(&["order", "riccati-pole"]).ok();
    assert!(told.contains("order 4; it cannot be measured here"), "{told}");
    assert!(told.contains("rounding") && !told.contains("measured -"), "{told}");
}

#[test]
fn no_error_below_the_floor_is_reached() {
    let mut curve = ideal(&[0.1, 0.01, 0.001]);
    curve.floor = 1e-9;
    assert_eq!(curve.reached(1e-10), None);
    assert!(curve.reached(1e-9).is_some());
    // A run that hits the floor by luck is no better than it.
    curve.points[2].error = 1e-14;
    assert_eq!(curve.error(&curve.points[2]), 1e-9);
    curve.points[1].error = 1e-9;
    let front = pareto(&[curve], |_, p| Some(p.seconds_per_unit));
    assert_eq!(front, [(0, 0), (0, 1)]);
}

#[test]
fn the_time_to_an_error_lies_on_the_line() {
    let curve = ideal(&[0.1, 0.01]);
    let time = curve.seconds_to(1e-6).expect("reached");
    assert!((time - 10f64.powf(1.5)).abs() < 1e-9);
    assert_eq!(curve.seconds_to(1e-9), None);
    assert!((curve.seconds_to(1.0).expect("coarsest") - 10.0).abs() < 1e-12);
}

#[test]
fn a_run_that_is_far_off_is_no_end_of_a_line() {
    // A step over everything, and the next is accurate at once: nothing is known between them.
    let mut curve = ideal(&[20.0, 0.01]);
    curve.points[0].error = 0.9;
    let reached = curve.reached(1e-6).expect("the second");
    assert!((reached.h - 0.01).abs() < 1e-12);
    curve.points[0].error = 0.05;
    assert!(curve.reached(1e-6).expect("between").h > 0.02);
}

/// Where f jumps, steps that end at the jumps are exact, and those between two such sizes are not.
#[test]
fn nothing_is_read_between_runs_that_the_order_does_not_join() {
    let mut curve = ideal(&[0.11, 0.1]);
    (curve.points[0].error, curve.points[1].error) = (1e-2, 1e-14);
    assert!((curve.reached(1e-6).expect("the second").h - 0.1).abs() < 1e-15);
}

#[test]
fn the_step_to_an_error_lies_on_the_line_too() {
    let reached = ideal(&[0.1, 0.01]).reached(1e-6).expect("reached");
    assert!((reached.h - 1e-6f64.powf(0.25)).abs() < 1e-12 && reached.tolerance.is_none());
}

#[test]
fn a_more_accurate_run_may_pass_where_the_soonest_does_not() {
    let mut curve = ideal(&[0.1, 0.01, 0.001]);
    for point in &mut curve.points {
        point.energy_error = point.error;
    }
    let kept = |reached: &Reached| reached.energy_error <= 1e-11;
    let reached = curve.reached_where(1e-6, kept).expect("the last run");
    assert!((reached.h - 0.001).abs() < 1e-12);
    assert_eq!(curve.reached_where(1e-6, |reached| reached.energy_error < 0.0), None);
}

#[test]
fn the_front_is_what_nothing_beats_in_both() {
    let mut slow = ideal(&[0.1, 0.01]);
    for point in &mut slow.points {
        point.seconds_per_unit *= 2.0;
    }
    // Slower everywhere, but for one run that nobody else is as accurate as.
    slow.points[1].error = 1e-9;
    let time = |_: &Curve, p: &WorkPoint| Some(p.seconds_per_unit);
    let front = pareto(&[ideal(&[0.1, 0.01]), slow], time);
    assert_eq!(front, [(0, 0), (0, 1), (1, 1)]);
    assert_eq!(pareto(&[ideal(&[0.1])], |_, _| None), []);
}

#[test]
fn an_error_of_zero_reaches_every_error() {
    let mut curve = ideal(&[0.1, 0.01]);
    curve.points[1].error = 0.0;
    let time = curve.seconds_to(1e-12).expect("reached");
    assert!(time > 10.0 && time < 100.0);
}
