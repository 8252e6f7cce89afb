//! Time grids and output times.

use lieflow::{SaveAt, TimeGrid};

use super::says;

#[test]
fn times_and_steps_are_checked() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        says(TimeGrid::new([bad, 1.0], 0.1).unwrap_err(), &["t_span[0] =", "finite"]);
        assert!(TimeGrid::with_steps([0.0, bad], 3).is_err());
        assert!(TimeGrid::new([0.0, 1.0], bad).is_err());
    }
    says(TimeGrid::new([0.0, f64::NAN], 0.1).unwrap_err(), &["t_span[1] =", "a number"]);
    assert_eq!(TimeGrid::new([0.0, f64::INFINITY], 0.1).unwrap().time(30), 3.0);
    for bad in [0.0, -0.0, -0.1, f64::NAN, f64::INFINITY] {
        says(TimeGrid::new([0.0, 1.0], bad).unwrap_err(), &["dt = ", "> 0"]);
        says(TimeGrid::new([1.0, 1.0], bad).unwrap_err(), &["dt = ", "> 0"]);
    }
    says(TimeGrid::new([-1e308, 1e308], 1.0).unwrap_err(), &["t_span", "finite length"]);
    says(TimeGrid::new([0.0, 1.0], 1e-300).unwrap_err(), &["dt", "1e15 steps"]);
    says(TimeGrid::new([0.0, 1.0], f64::MIN_POSITIVE / 4.0).unwrap_err(), &["dt"]);
    says(TimeGrid::with_steps([0.0, 1.0], 0).unwrap_err(), &["steps = 0", "at least 1"]);
}

#[test]
fn where_a_step_does_not_divide_the_span_the_last_one_is_shorter() {
    for (span, dt, steps) in
        [([0.0, 1.0], 0.3, 4), ([1.0, 0.0], 0.3, 4), ([0.0, 1.0], 5.0, 1), ([0.0, 1.0], 1e300, 1)]
    {
        let grid = TimeGrid::new(span, dt).unwrap();
        assert_eq!((grid.steps(), grid.time(steps)), (steps, span[1]));
        let third = span[0] + 3.0 * grid.h();
        assert!(steps == 1 || grid.time(3) == third, "{} {third}", grid.time(3));
    }
    assert_eq!(TimeGrid::new([0.0, 1.0], 1.0 / 3.0).unwrap().steps(), 3);
    // Decimal steps are not exact in binary, and divide all the same.
    for (dt, steps) in [(0.1, 10), (0.01, 100), (1e-7, 10_000_000), (1e-9, 1_000_000_000)] {
        assert_eq!(TimeGrid::new([0.0, 1.0], dt).unwrap().steps(), steps);
        assert_eq!(TimeGrid::new([1.0, 0.0], dt).unwrap().steps(), steps, "backward");
    }
}

#[test]
fn steps_lost_in_rounding_are_refused() {
    for (span, steps) in [([1e9, 1e9 + 1.0], 1 << 40), ([1e16, 1e16 + 4.0], 64)] {
        says(TimeGrid::with_steps(span, steps).unwrap_err(), &["steps", "differs from t"]);
        assert!(TimeGrid::with_steps([span[1], span[0]], steps).is_err(), "backward");
    }
}

#[test]
fn an_empty_span_has_no_steps() {
    let grid = TimeGrid::new([2.0, 2.0], 0.1).unwrap();
    assert_eq!((grid.steps(), grid.h(), grid.time(0)), (0, 0.0, 2.0));
    assert_eq!(TimeGrid::with_steps([2.0, 2.0], 7).unwrap().steps(), 0);
}

#[test]
fn no_error_accumulates_in_the_time() {
    for [t0, t1] in [[0.0, 1e7], [0.1, 1e7 + 0.1], [1e7, -3.3], [-5.0, 0.7]] {
        let steps = 100_000_000u64;
        let grid = TimeGrid::with_steps([t0, t1], steps).unwrap();
        assert_eq!((grid.time(0), grid.time(steps)), (t0, t1), "lands on both ends");
        let largest = t0.abs().max(t1.abs());
        for k in 0..1000 {
            let n = k * 99_991;
            let part = n as f64 / steps as f64;
            let expected = t0 * (1.0 - part) + t1 * part;
            let error = (grid.time(n) - expected).abs();
            assert!(error <= 4.0 * f64::EPSILON * largest, "t_{n}: {error:e}");
            let forward = (grid.time(n + 1) - grid.time(n)) * (t1 - t0).signum();
            assert!(forward > 0.0, "time stands still at step {n}");
        }
    }
}

#[test]
fn output_times_are_checked() {
    let check = |span, times: &[f64]| SaveAt::Times(times.to_vec()).check(span);
    let forward = [0.0, 1.0];
    assert_eq!(check(forward, &[]), Ok(()));
    assert_eq!(check(forward, &[0.0, 0.3, 1.0]), Ok(()));
    assert_eq!(check([1.0, 0.0], &[1.0, 0.3, 0.0]), Ok(()));
    says(check(forward, &[0.5, 1.5]).unwrap_err(), &["times[1] = 1.5", "[0, 1]"]);
    says(check(forward, &[-0.1]).unwrap_err(), &["times[0] = -0.1", "[0, 1]"]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        says(check(forward, &[0.2, bad]).unwrap_err(), &["times[1] ="]);
    }
    says(check(forward, &[0.5, 0.2]).unwrap_err(), &["times[1] = 0.2", "order"]);
    says(check(forward, &[0.5, 0.5]).unwrap_err(), &["times[1] = 0.5", "each once"]);
    says(check(forward, &[-0.0, 0.0]).unwrap_err(), &["times[1]", "each once"]);
    says(check([1.0, 0.0], &[0.2, 0.5]).unwrap_err(), &["times[1] = 0.5", "order"]);
    says(SaveAt::Every(0).check(forward).unwrap_err(), &["every = 0", "at least 1"]);
    let every = |length: f64, span| SaveAt::Interval(length).check(span);
    assert_eq!(every(1e-3, forward), Ok(()));
    assert_eq!(every(5.0, [1.0, 0.0]), Ok(()));
    assert_eq!(every(0.5, [0.0, f64::INFINITY]), Ok(()));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        says(every(bad, forward).unwrap_err(), &["interval", "a finite number > 0"]);
    }
    // Times that are one number, and times without an end.
    for (length, span) in
        [(1e-300, forward), (1e-16, forward), (1e-8, [0.0, 1e9]), (1e-8, [1e9, 1e9 + 1.0])]
    {
        says(every(length, span).unwrap_err(), &["interval", "times that differ"]);
    }
}

/// One ulp is a span of one step; anything finer than the numbers around it is refused.
#[test]
fn the_finest_steps() {
    for t in [1.0, 1.0f64.next_down(), 1e9, -3.7, 0.1] {
        let grid = TimeGrid::with_steps([t, t.next_up()], 1).unwrap();
        assert_eq!((grid.time(0), grid.time(1)), (t, t.next_up()));
        assert!(TimeGrid::with_steps([t, t.next_up()], 2).is_err());
    }
    assert!(TimeGrid::with_steps([1e9, 1e9 + 1.0], 100_000_000).is_err());
}
