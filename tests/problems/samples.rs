//! Sampled data: what defines each interpolation, where it is found and where it ends, and the coning motion of
//! a strapdown sensor.

use std::f64::consts::PI;

use lieflow::actions::LeftTranslation;
use lieflow::groups::{LieGroup, So3};
use lieflow::methods::magnus::Magnus4;
use lieflow::problems::Flow;
use lieflow::samples::Interpolation::{Cubic, Linear, MeanRate, Previous};
use lieflow::samples::{Interpolation, Outside, Samples};
use lieflow::{Error, SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

/// Seven uneven times: steps from 0.25 to 1.5.
const UNEVEN: [f64; 7] = [-1.0, -0.5, 1.0, 1.25, 2.0, 2.75, 4.0];
/// Without a rule.
const VALUES: [f64; 7] = [1.0, -2.0, 0.5, 3.0, -1.0, 0.25, 2.0];

/// The rounding of a spline here: some twenty operations on numbers up to 1e2, slopes divided by 0.25.
const ROUNDING: f64 = 1e4 * f64::EPSILON;

fn of(times: &[f64], values: &[f64], interpolation: Interpolation) -> Samples {
    Samples::new(times, &[values], interpolation).unwrap()
}
#[track_caller]
fn near(a: f64, b: f64) {
    assert!((a - b).abs() < ROUNDING, "{a} and {b} are {:e} apart", a - b);
}
/// x³ − 2x² + x/2 + 3 and its derivatives.
fn cubic(order: usize, x: f64) -> f64 {
    match order {
        0 => ((x - 2.0) * x + 0.5) * x + 3.0,
        1 => (3.0 * x - 4.0) * x + 0.5,
        2 => 6.0 * x - 4.0,
        3 => 6.0,
        _ => 0.0,
    }
}
/// Fifty times over the span of the samples, both ends among them.
fn over(samples: &Samples) -> impl Iterator<Item = f64> {
    let [first, last] = samples.span();
    (0..=49).map(move |i| first + (last - first) * f64::from(i) / 49.0)
}

/// Each is exact where it claims to be; of two and of three rows too.
#[test]
fn polynomials_are_met() {
    for n in 2..=7 {
        let times = &UNEVEN[..n];
        // The derivative of the cubic that vanishes from the order n on: a polynomial of degree min(n − 1, 3).
        let lost = 4usize.saturating_sub(n);
        let exact = |order: usize, x: f64| cubic(lost + order, x);
        let values: Vec<f64> = times.iter().map(|&t| exact(0, t)).collect();
        let spline = of(times, &values, Cubic);
        let increments: Vec<f64> =
            (0..n).map(|k| if k == 0 { 7.0 } else { values[k] - values[k - 1] }).collect();
        let rate = of(times, &increments, MeanRate);
        let line: Vec<f64> = times.iter().map(|t| 3.0 - 2.0 * t).collect();
        let line = of(times, &line, Linear);
        for t in over(&spline) {
            for order in 0..=4 {
                near(spline.derivative(0, order, t).unwrap(), exact(order, t));
            }
            near(rate.column(0, t).unwrap(), exact(1, t));
            near(line.column(0, t).unwrap(), 3.0 - 2.0 * t);
        }
    }
}

/// The definition of the not-a-knot spline: it meets the values, two derivatives are continuous, and the third
/// jumps at no knot but those that are listed.
#[test]
fn the_spline_is_not_a_knot() {
    let spline = of(&UNEVEN, &VALUES, Cubic);
    for (t, x) in UNEVEN.iter().zip(VALUES) {
        near(spline.column(0, *t).unwrap(), x);
    }
    let jump = |samples: &Samples, order, t: f64| {
        let side = |t| samples.derivative(0, order, t).unwrap();
        side(t) - side(t.next_down())
    };
    let knots: Vec<f64> = spline.knots([-9.0, 9.0]).collect();
    assert_eq!(knots, UNEVEN[2..5]);
    for t in &UNEVEN[1..6] {
        (0..3).for_each(|order| near(jump(&spline, order, *t), 0.0));
        let third = jump(&spline, 3, *t).abs();
        assert!(if knots.contains(t) { third > 1.0 } else { third < ROUNDING }, "{t}: {third}");
    }
    // The rate of increments is C¹, with the same knots; lines have all of them.
    let rate = of(&UNEVEN, &VALUES, MeanRate);
    assert!(rate.knots([-9.0, 9.0]).eq(knots));
    for t in &UNEVEN[1..6] {
        (0..2).for_each(|order| near(jump(&rate, order, *t), 0.0));
    }
    let line = of(&UNEVEN, &VALUES, Linear);
    assert!(line.knots([4.0, -1.0]).eq(UNEVEN[1..6].iter().copied()));
    assert!(line.knots([1.0, 2.5]).rev().eq([2.0, 1.25]));
    assert_eq!(of(&UNEVEN[..3], &VALUES[..3], Cubic).knots([-9.0, 9.0]).count(), 0);
}

/// The integral over each interval is the increment: Simpson's rule is exact for its parabola.
/// A value that is held is that of the last time which has passed. It jumps at each time but the first.
#[test]
fn a_value_is_held_until_the_next_time() {
    for times in [&UNEVEN[..], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]] {
        let held = of(times, &VALUES, Previous);
        for (k, (t, x)) in times.iter().zip(VALUES).enumerate() {
            assert_eq!(held.column(0, *t), Ok(x));
            assert_eq!(held.derivative(0, 1, *t), Ok(0.0));
            if k > 0 {
                assert_eq!(held.column(0, t.next_down()), Ok(VALUES[k - 1]));
            }
        }
        let span = held.span();
        assert!(held.knots(span).eq(times[1..].iter().copied()));
        assert!(held.knots([span[1], times[2]]).rev().eq(times[2..].iter().rev().copied()));
        assert!(held.column(0, span[1] + 1.0).is_err());
    }
    let two = of(&[0.0, 1.0], &[3.0, 4.0], Previous);
    assert_eq!((two.column(0, 0.5), two.column(0, 1.0)), (Ok(3.0), Ok(4.0)));
    assert_ne!(two, of(&[0.0, 1.0], &[3.0, 5.0], Previous));
}

#[test]
fn a_mean_rate_has_the_increments() {
    let rate = of(&UNEVEN, &VALUES, MeanRate);
    for k in 1..7 {
        let [a, b] = [UNEVEN[k - 1], UNEVEN[k]];
        let [start, middle, end] = [a, (a + b) / 2.0, b].map(|t| rate.column(0, t).unwrap());
        near((b - a) * (start + 4.0 * middle + end) / 6.0, VALUES[k]);
    }
}

/// Every time is found in its interval, in even times and in uneven ones.
#[test]
fn each_time_is_found() {
    let even: Vec<f64> = (0..1000).map(|k| 0.3 + 0.1 * f64::from(k)).collect();
    let jittered: Vec<f64> = even.iter().map(|t| t + 0.04 * (37.0 * t).sin()).collect();
    let clustered: Vec<f64> = even.iter().map(|t| t * t).collect();
    for times in [even, jittered, clustered] {
        // The slope of the piece k is k.
        let mut values = vec![0.0];
        for k in 1..times.len() {
            values.push(values[k - 1] + (k - 1) as f64 * (times[k] - times[k - 1]));
        }
        let samples = of(&times, &values, Linear);
        for k in 0..times.len() - 1 {
            for t in [times[k], (times[k] + times[k + 1]) / 2.0, times[k + 1].next_down()] {
                let slope = samples.derivative(0, 1, t).unwrap();
                assert_eq!(slope.round(), k as f64, "{t} in {} to {}", times[k], times[k + 1]);
            }
        }
        assert_eq!(samples.column(0, samples.span()[0]), Ok(0.0));
    }
}

#[test]
fn beyond_the_ends_is_an_error() {
    let samples = Samples::new(&[0.0, 1.0, 3.0], &[[1.0, 2.0, 3.0], [5.0; 3]], Linear).unwrap();
    assert_eq!((samples.columns(), samples.interpolation()), (2, Linear));
    let mut out = [0.0; 2];
    for t in [0.0, 3.0, -1e-16, 3.0_f64.next_up()] {
        samples.value(t, &mut out).unwrap();
        assert!(out[1] == 5.0 && (out[0] - 1.0) * (out[0] - 3.0) == 0.0, "{out:?}");
    }
    for t in [-1e-14, 3.0 + 1e-14, f64::INFINITY, f64::NAN] {
        let error = samples.value(t, &mut out).unwrap_err();
        assert!(out.iter().all(|x| x.is_nan()));
        assert_eq!(error.span, [0.0, 3.0]);
        assert!(samples.column(0, t).is_err());
    }
    assert_eq!(samples.covers([3.0, 0.5]), Ok(()));
    assert_eq!(samples.covers([0.0, 4.0]), Err(Outside { t: 4.0, span: [0.0, 3.0] }));
    let error = Error::from(samples.covers([-1.0, 2.0]).unwrap_err()).to_string();
    assert_eq!(error, "t = -1, expected a time in the span of the samples, 0 to 3");
}

#[test]
fn a_table_that_is_none_is_refused() {
    let refused = |times: &[f64], columns: &[&[f64]], message: &str| {
        for interpolation in Interpolation::ALL {
            let error = Samples::new(times, columns, interpolation).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    };
    refused(&[], &[], "times: length 0, expected at least 2");
    refused(&[1.0], &[&[1.0]], "times: length 1, expected at least 2");
    refused(&[0.0, 2.0, 1.0], &[], "times[2] = 1, expected more than 2, the time before it");
    refused(&[0.0, 2.0, 2.0], &[], "times[2] = 2, expected more than 2, the time before it");
    refused(&[0.0, f64::NAN], &[], "times[1] = NaN, expected a finite number");
    refused(&[-1e308, 1e308], &[], "times = inf, expected times that span a finite length");
    refused(&[0.0, 1.0], &[&[0.0, 1.0], &[0.0]], "columns[1]: length 1, expected 2 as there are");
    refused(&[0.0, 1.0], &[&[0.0, f64::INFINITY]], "columns[0][1] = inf, expected a finite");
    for interpolation in [Linear, Cubic, MeanRate] {
        let steep = Samples::new(&[0.0, 1e-3], &[&[0.0, 1e307]], interpolation);
        let error = steep.unwrap_err().to_string();
        let message = "columns[0][1] = 1e307, expected a value whose slope";
        assert!(error.starts_with(message), "{error}");
    }
    // Of a curve that is not finite in all intervals the entry at the end of the steepest is named.
    for at in 0..9 {
        let mut values = [0.0; 10];
        values[at] = 1e308;
        values[at + 1] = -1e308;
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        let error = Samples::new(&times, &[values], Cubic).unwrap_err().to_string();
        let message = format!("columns[0][{}] = -1e308, expected a value whose slope", at + 1);
        assert!(error.starts_with(&message), "{error}");
    }
    let error = Interpolation::named("quadratic").unwrap_err().to_string();
    assert_eq!(
        error,
        "unknown interpolation `quadratic`: expected one of linear, cubic, previous, mean-rate"
    );
    assert!(Interpolation::ALL.iter().all(|x| Interpolation::named(x.name()) == Ok(*x)));
}

/// Coning: the body's axis moves on a cone of half-angle A at the rate W, g = exp(A (cos Wt, sin Wt, 0)^), and
/// ω = W (−sin A sin Wt, sin A cos Wt, cos A − 1). A sensor gives the integrals of ω over equal intervals.
///
/// The rate with these means beats their mean rates as straight lines, the mean rate of each interval at its end
/// and at its middle: by the order in the interval, and by the drift about the axis of the cone.
#[test]
fn coning_from_increments() {
    const A: f64 = 0.1;
    const W: f64 = 2.0 * PI;
    const END: f64 = 10.25;
    let exact = |t: f64| {
        let axis = Vector3::new((W * t).cos(), (W * t).sin(), 0.0);
        *nalgebra::Rotation3::new(A * axis).matrix()
    };
    // The distance from exact after END turns, with so many intervals a turn; the table has more on each side,
    // so that its ends play no part.
    let error = |per_turn: u32, interpolation: Interpolation, shift: f64| {
        let h = 1.0 / f64::from(per_turn);
        let times: Vec<f64> = (0..=12 * per_turn).map(|k| -1.0 + h * f64::from(k)).collect();
        let increments = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            times.iter().map(|t| of(*t) - of(t - h)).collect()
        };
        let columns = [
            increments(&|t| A.sin() * (W * t).cos()),
            increments(&|t| A.sin() * (W * t).sin()),
            increments(&|t| (A.cos() - 1.0) * W * t),
        ];
        let (times, columns) = match interpolation {
            MeanRate => (times, columns),
            _ => {
                let rate = |column: Vec<f64>| column.iter().map(|x| x / h).collect();
                (times.iter().map(|t| t - shift * h).collect(), columns.map(rate))
            }
        };
        let rates = Samples::new(&times, &columns, interpolation).unwrap();
        rates.covers([0.0, END]).unwrap();
        let attitude =
            Flow::of_time(So3::<f64>::new(), LeftTranslation, |t, v: &mut Vector3<f64>| {
                let _ = rates.value(t, v.as_mut_slice());
                *v = -*v;
            });
        let mut g: Matrix3<f64> = exact(0.0).transpose();
        let grid = TimeGrid::new([0.0, END], h).unwrap();
        integrate(&attitude, &Magnus4, &grid, &SaveAt::Ends, &mut g, |_, _| {}).unwrap();
        assert!(So3::<f64>::new().defect(&g) < 1e-13);
        (g.transpose() - exact(END)).norm()
    };
    for (interpolation, shift, order) in
        [(Linear, 0.0, 1.0), (Linear, 0.5, 2.0), (MeanRate, 0.0, 4.0)]
    {
        let [coarse, fine] = [16, 32].map(|n| error(n, interpolation, shift));
        let slope = (coarse / fine).log2();
        println!("{interpolation:?} {shift}: {coarse:.2e} {fine:.2e}, order {slope:.2}");
        assert!((slope - order).abs() < 0.3, "{interpolation:?}: {coarse:e} {fine:e}, {slope}");
    }
    let [ends, middles, rate] =
        [(Linear, 0.0), (Linear, 0.5), (MeanRate, 0.0)].map(|(by, shift)| error(32, by, shift));
    assert!(100.0 * rate < middles && middles < ends, "{rate:e} {middles:e} {ends:e}");
}
