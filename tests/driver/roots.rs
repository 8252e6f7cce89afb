//! Zeros within long steps: all of them, with their number, beside known zeros, the exact motion and a dense search.

use std::cell::Cell;

use crate::support::boxed::boxed_of_time;
use lieflow::Stats;
use lieflow::groups::{Sample, So3};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::{CommutatorFree, Embedded, LieSeries, Metric, Taylor};
use lieflow::prelude::*;
use lieflow::problems::{Exact, HeavyTop, PointOf, Problem, RigidBody, RigidBodyN};
use lieflow::solve::StepControl;
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};

type V = Vector3<f64>;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
/// Beside the saddle of the middle axis.
const FLIPS: V = V::new(0.1, 2.0, 0.3);

/// The zeros of g(t) on \[0, 8\] with their directions, by steps of size 1 of order 16, and in a run backward.
fn of_time(g: impl Fn(f64) -> f64 + Copy) -> [Vec<(f64, bool)>; 2] {
    [[0.0, 8.0], [8.0, 0.0]].map(|span| {
        let body = RigidBody::<f64>::new(INERTIA).unwrap();
        let solve = Solve::new(&body, &Taylor::<16>, span).dt(1.0);
        let run = solve.event(Event::new("g", move |t, _: &V| g(t))).run(V::new(0.3, 0.0, 0.0));
        run.unwrap().events.iter().map(|zero| (zero.t, zero.rising)).collect()
    })
}

/// Demands these zeros, the first with this direction, within `apart`.
fn demand(g: impl Fn(f64) -> f64 + Copy, zeros: &[f64], rises: bool, apart: f64, what: &str) {
    let [forward, mut backward] = of_time(g);
    backward.reverse();
    backward.iter_mut().for_each(|zero| zero.1 = !zero.1);
    for found in [forward, backward] {
        assert_eq!(found.len(), zeros.len(), "{what}: {found:?}, expected {zeros:?}");
        for (k, ((t, rising), zero)) in found.iter().zip(zeros).enumerate() {
            assert!((t - zero).abs() <= apart, "{what}: {t}, expected {zero}");
            assert_eq!(*rising, rises == (k % 2 == 0), "{what}: zero {k}");
        }
    }
}

/// Slow and fast oscillations: up to eighty zeros in a step.
#[test]
fn many_zeros_within_a_step() {
    for rate in [0.4, 3.0, 7.0, 20.0, 41.0, 97.0, 250.0] {
        let zeros: Vec<f64> = (0..)
            .map(|k| (f64::from(k) + 0.5) * std::f64::consts::PI / rate)
            .take_while(|zero| *zero < 8.0)
            .collect();
        demand(|t| (rate * t).cos(), &zeros, false, 1e-13, &format!("cos {rate}t"));
    }
}

#[test]
fn two_zeros_next_to_each_other_and_touching_ones() {
    for middle in [3.4, 3.5, 3.0 + 1e-3, 3.0 + 2e-6, 4.0 - 2e-6, 0.03] {
        for apart in [1e-1, 1e-3, 1e-5, 1e-6] {
            let zeros = [middle - 0.5 * apart, middle + 0.5 * apart];
            let g = |t: f64| (t - zeros[0]) * (t - zeros[1]) * (2.0 + (1.7 * t).sin());
            if zeros[0] > 0.0 {
                demand(g, &zeros, false, 1e-15 * 8.0, &format!("{apart} apart at {middle}"));
            }
        }
    }
    for middle in [3.4, 0.1, 7.9] {
        let bend = |t: f64| 2.0 + (1.7 * t).sin();
        // What touches 0 has no zero there; what passes it flatly has one.
        demand(|t| (t - middle).powi(2) * bend(t), &[], true, 0.0, "a double zero");
        demand(|t| (t - middle).powi(2) * bend(t) + 1e-12, &[], true, 0.0, "next to a double zero");
        demand(|t| (t - middle).powi(4) * bend(t), &[], true, 0.0, "a fourfold zero");
        demand(|t| (t - middle).powi(3) * bend(t), &[middle], true, 1e-15, "a triple zero");
        let other = middle + 0.05;
        let g = |t: f64| (t - middle).powi(2) * (t - other) * bend(t);
        demand(g, &[other], true, 1e-13, "a zero beside a double one");
    }
}

/// Zeros of a function of the state, in pairs next to each other: m₂² passes a small level twice at each zero of m₂. The
/// rounding of m₂² is that of m, however small it is.
#[test]
fn pairs_of_zeros_of_the_state() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    for (rtol, level) in [(1e-12, 2.5e-11), (1e-12, 1e-9), (1e-9, 1e-9), (1e-9, 1e-7), (1e-6, 1e-7)]
    {
        for span in [[0.0, 100.0], [0.0, -100.0]] {
            let solve = || Solve::new(&body, &Taylor::<16>, span).tolerances(rtol, rtol);
            let flips = solve().event(Event::new("flip", |_, m: &V| m.y)).run(FLIPS).unwrap();
            let pairs = solve().event(Event::new("pair", |_, m: &V| m.y * m.y - level));
            let pairs = pairs.run(FLIPS).unwrap();
            let what = format!("{level:e} by rtol {rtol:e}");
            assert_eq!(flips.events.len(), 9, "{what}");
            assert_eq!(pairs.events.len(), 2 * flips.events.len(), "{what}");
            assert_eq!(pairs.stats.unsure_steps, 0, "{what}");
            for (flip, pair) in flips.events.iter().zip(pairs.events.as_chunks::<2>().0) {
                let middle = 0.5 * (pair[0].t + pair[1].t);
                assert!((middle - flip.t).abs() < 1e-8, "{what}: {middle} and {}", flip.t);
            }
        }
    }
}

/// At the start and at the ends of steps, and so near that only rounding is between.
#[test]
fn zeros_at_the_ends_of_a_step() {
    for end in [2.0, 5.0] {
        for beside in [0.0, 1e-15, 1e-13, 1e-9, 1e-6, 1e-3] {
            for sign in [1.0, -1.0] {
                let zero = end + sign * beside;
                let g = |t: f64| (t - zero) * (1.5 + (2.0 * t).cos());
                demand(g, &[zero], true, 1e-15, &format!("{zero}"));
                let second = end - sign * 2.0 * beside.max(1e-6);
                let mut zeros = [zero, second];
                zeros.sort_by(f64::total_cmp);
                let g = |t: f64| (t - zero) * (t - second) * (1.5 + (2.0 * t).cos());
                demand(g, &zeros, false, 1e-14, &format!("{zero} and {second}"));
            }
        }
    }
    // One at the start of the run counts, in the direction that follows.
    let [forward, _] = of_time(|t| (25.0 * t).sin());
    assert_eq!(forward[0], (0.0, true));
    assert_eq!(forward.len(), 1 + (8.0 * 25.0 / std::f64::consts::PI) as usize);
    // A jump is found like a zero, and a corner is no obstacle.
    demand(|t| if t < 1.7 { -1.0 } else { 1.0 }, &[1.7], true, 1e-15, "a jump");
    demand(|t| (t - 1.7).abs() - 0.1, &[1.6, 1.8], false, 1e-14, "a corner");
}

/// Random zeros, up to six in a step, and factors that are no polynomials.
#[test]
fn random_zeros() {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(11);
    for case in 0..400 {
        let count = rng.random_range(0..=6);
        let mut zeros: Vec<f64> = (0..count).map(|_| rng.random_range(3.0..4.0)).collect();
        if count > 0 && case % 2 == 0 {
            zeros.push(zeros[0] + 1e-4);
        }
        zeros.sort_by(f64::total_cmp);
        if zeros.windows(2).any(|pair| pair[1] - pair[0] < 9e-5) {
            continue;
        }
        let (rate, shift) = (rng.random_range(0.0..4.0), rng.random_range(1.1..3.0));
        let all = &zeros;
        let g = |t: f64| {
            all.iter().fold(1.0, |product, zero| product * (t - zero)) * (shift + (rate * t).sin())
        };
        demand(g, &zeros, zeros.len() % 2 == 1, 1e-14, &format!("case {case}"));
    }
}

#[test]
fn directions_stops_and_changes() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let g = |t: f64, _: &V| (40.0 * t).cos();
    let run = |event: Event<'_, V>| {
        let solve = Solve::new(&body, &Taylor::<16>, [0.0, 8.0]).dt(1.0).event(event);
        let run = solve.run(V::new(0.3, 0.0, 0.0)).unwrap();
        run.events.iter().map(|zero| zero.t).collect::<Vec<_>>()
    };
    let all: Vec<f64> = (0..)
        .map(|k| (f64::from(k) + 0.5) * std::f64::consts::PI / 40.0)
        .take_while(|zero| *zero < 8.0)
        .collect();
    let near = |found: Vec<f64>, expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-13));
    };
    near(run(Event::new("g", g)), &all);
    let every_second = |from: usize| all.iter().copied().skip(from).step_by(2).collect::<Vec<_>>();
    near(run(Event::new("g", g).falling()), &every_second(0));
    near(run(Event::new("g", g).rising()), &every_second(1));
    near(run(Event::new("g", g).stop_after(17)), &all[..17]);
    near(run(Event::new("g", g).change(|_, _| {})), &all);
}

/// A function of a point with its name.
type Named<Y> = (&'static str, fn(&Y) -> f64);

/// The functions of m that are searched.
const FUNCTIONS: [Named<V>; 7] = [
    ("m₂", |m| m.y),
    ("m₁ − 0.95", |m| m.x - 0.95),
    ("m₁m₃", |m| m.x * m.z),
    ("cos 5m₂", |m| (5.0 * m.y).cos()),
    ("cos 40m₂", |m| (40.0 * m.y).cos()),
    ("sin 30m₁ + m₃", |m| (30.0 * m.x).sin() + m.z),
    ("cos 150m₂ − 0.3", |m| (150.0 * m.y).cos() - 0.3),
];

/// The zeros of the exact motion, by many points and then halves.
fn exact_zeros(exact: &Exact, end: f64, g: fn(&V) -> f64) -> Vec<f64> {
    let g = |t: f64| g(&exact.momentum_body(t).unwrap());
    let count = (2000.0 * end) as u32;
    let at = |k: u32| end * f64::from(k) / f64::from(count);
    let values: Vec<f64> = (0..=count).map(|k| g(at(k))).collect();
    let with_zero = (0..count).filter(|&k| values[k as usize] * values[k as usize + 1] < 0.0);
    let halved = with_zero.map(|k| {
        let (mut a, mut b, first) = (at(k), at(k + 1), values[k as usize]);
        for _ in 0..50 {
            let middle = 0.5 * (a + b);
            *(if first * g(middle) <= 0.0 { &mut b } else { &mut a }) = middle;
        }
        0.5 * (a + b)
    });
    halved.collect()
}

/// All zeros of fast functions of a free body beside its saddle, for steps of any length.
#[test]
fn zeros_of_the_exact_motion() {
    let exact = Exact::new(INERTIA, FLIPS.into(), Matrix3::identity()).unwrap();
    let end = 60.0;
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let expected = FUNCTIONS.map(|(_, g)| exact_zeros(&exact, end, g));
    for rtol in [1e-6, 1e-8, 1e-10, 1e-13] {
        let mut solve = Solve::new(&body, &Taylor::<16>, [0.0, end]).tolerances(rtol, rtol);
        for (name, g) in FUNCTIONS {
            solve = solve.event(Event::new(name, move |_, m: &V| g(m)));
        }
        let run = solve.run(FLIPS).unwrap();
        for (event, ((name, _), expected)) in FUNCTIONS.iter().zip(&expected).enumerate() {
            let found: Vec<f64> = run.times_of(event).collect();
            assert!(!expected.is_empty(), "{name}");
            assert_eq!(found.len(), expected.len(), "{name}, rtol = {rtol}");
            let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // The saddle enlarges the error of a step by 1e3 until the end.
            assert!(apart < 1e4 * rtol + 1e-10, "{name}, rtol = {rtol}: {apart:e}");
        }
    }
}

/// Demands of each event the zeros that a search at 600 points of each step finds.
fn as_by_many_points<P, M>(
    problem: &P,
    method: &M,
    (start, span, rtol): (&PointOf<P>, [f64; 2], f64),
    functions: &[Named<PointOf<P>>],
) where
    P: Problem<Group: LieAlgebra<Scalar = f64>>,
    PointOf<P>: Clone + Metric,
    M: Embedded<P>,
{
    let runs = [None, Some(600)].map(|points| {
        let mut solve = Solve::new(problem, method, span).tolerances(rtol, rtol);
        for (name, g) in functions.iter().copied() {
            let event = Event::new(name, move |_, y: &PointOf<P>| g(y));
            solve = solve.event(match points {
                Some(points) => event.points(points),
                None => event,
            });
        }
        solve.run(start.clone()).unwrap()
    });
    for (event, (name, _)) in functions.iter().enumerate() {
        let [found, expected] = [0, 1].map(|k| runs[k].times_of(event).collect::<Vec<f64>>());
        assert!(!expected.is_empty(), "{name}");
        assert_eq!(found.len(), expected.len(), "{name}, rtol = {rtol}");
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-11, "{name}, rtol = {rtol}: {a}, expected {b}");
        }
    }
}

#[test]
fn as_by_many_points_on_so3() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    for rtol in [1e-5, 1e-9] {
        as_by_many_points(&body, &Taylor::<12>, (&FLIPS, [0.0, 40.0], rtol), &FUNCTIONS);
        as_by_many_points(&body, &Taylor::<16>, (&FLIPS, [40.0, 0.0], rtol), &FUNCTIONS);
    }
    // A method of order 8 looks at eight points of a step; its steps are short.
    let slow = &FUNCTIONS[..4];
    as_by_many_points(&body, &Rkmk::new(DOP853, Exp), (&FLIPS, [0.0, 40.0], 1e-9), slow);
}

#[test]
fn as_by_many_points_on_so5() {
    type M = lieflow::faer::Mat<f64>;
    let functions: [Named<M>; 4] = [
        ("m₁₃", |m| m[(0, 2)]),
        ("m₁₃m₁₅", |m| m[(0, 2)] * m[(0, 4)]),
        ("cos 20m₁₃", |m| (20.0 * m[(0, 2)]).cos()),
        ("sin 60m₄₅ + m₁₂/2", |m| (60.0 * m[(3, 4)]).sin() + 0.5 * m[(0, 1)]),
    ];
    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0, 5.5]).unwrap();
    let mut rng = rand_pcg::Pcg64::seed_from_u64(9);
    let start = body.group().sample_algebra(&mut rng, 3.0).into_mat();
    for (order, rtol) in [(12, 1e-7), (16, 1e-6), (16, 1e-11)] {
        let method = LieSeries::new(order).unwrap();
        as_by_many_points(&body, &method, (&start, [0.0, 4.0], rtol), &functions);
    }
}

#[test]
fn as_by_many_points_on_se3() {
    type Pair = (V, V);
    let functions: [Named<Pair>; 4] = [
        ("γ₃", |y| y.1.z),
        ("μ₁γ₂ − 0.1", |y| y.0.x * y.1.y - 0.1),
        ("cos 20μ₁", |y| (20.0 * y.0.x).cos()),
        ("sin 60γ₁ + γ₃/2", |y| (60.0 * y.1.x).sin() + 0.5 * y.1.z),
    ];
    let top = HeavyTop::new([1.0, 2.0, 2.5], [0.3, -0.2, 1.0]).unwrap().problem();
    let start = (V::new(0.4, -0.3, 1.5), V::new(0.48, 0.6, 0.64));
    for (order, rtol) in [(10, 1e-6), (16, 1e-6), (16, 1e-11)] {
        as_by_many_points(
            &top,
            &LieSeries::new(order).unwrap(),
            (&start, [20.0, 0.0], rtol),
            &functions,
        );
    }
}

/// A step without a zero costs one point within it; one with a zero the points that find it. The number of a single tolerance
/// depends on where its steps end, so that of seven tolerances counts.
#[test]
fn what_an_event_costs() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    for (rtol, level, most) in [(1e-6, 100.0, 2.2), (1e-6, 0.0, 3.3), (1e-9, 0.0, 2.7)] {
        for span in [[0.0, 1000.0], [1000.0, 0.0]] {
            let each = [0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0].map(|factor| {
                let calls = Cell::new(0);
                let event = Event::new("m₂", |_, m: &V| {
                    calls.set(calls.get() + 1);
                    m.y - level
                });
                let tolerance = factor * rtol;
                let solve = Solve::new(&body, &Taylor::<16>, span).tolerances(tolerance, tolerance);
                let run = solve.event(event).run(FLIPS).unwrap();
                f64::from(calls.get()) / run.stats.accepted as f64
            });
            let mean = each.iter().sum::<f64>() / each.len() as f64;
            assert!(mean < most, "rtol = {rtol}, m₂ = {level}: {each:?} evaluations of g a step");
        }
    }
}

/// Far from t = 0 the rounding of t is more than that of g. It does not count as a function that is too fast.
#[test]
fn events_far_from_zero_cost_no_more() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let functions: [fn(f64, &V) -> f64; 3] =
        [|_, m| m.y, |t, m| m.y - 0.5 * (0.3 * t).sin(), |_, m| m.x * m.z - 0.1];
    for (number, g) in functions.into_iter().enumerate() {
        for points in [None, Some(3), Some(200)] {
            let [near, far, farther] = [0.0, 1e6, 1e10].map(|start| {
                let calls = Cell::new(0);
                let event = Event::new("g", |t, m: &V| {
                    calls.set(calls.get() + 1);
                    g(t - start, m)
                });
                let event = match points {
                    Some(points) => event.points(points),
                    None => event,
                };
                let solve = Solve::new(&body, &Taylor::<16>, [start, start + 100.0]);
                let run = solve.tolerances(1e-9, 1e-9).event(event).run(FLIPS).unwrap();
                assert_eq!(run.stats.unsure_steps, 0);
                (run.events.len(), f64::from(calls.get()))
            });
            for (zeros, calls) in [far, farther] {
                assert_eq!(zeros, near.0, "function {number}, {points:?}");
                let ratio = calls / near.1;
                assert!(ratio < 1.1, "function {number}, {points:?}: {ratio} times the calls");
            }
        }
    }
}

/// A function that turns too fast for its steps is told, and one that does not is not.
#[test]
fn steps_that_may_have_more_zeros_are_counted() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    for (rate, is_sure) in [(1.0, true), (40.0, true), (1e4, false), (1e6, false)] {
        let solve = Solve::new(&body, &Taylor::<16>, [0.0, 20.0]).tolerances(1e-9, 1e-9);
        let run =
            solve.event(Event::new("g", |t: f64, _: &V| (rate * t).sin())).run(FLIPS).unwrap();
        let Stats { unsure_steps, accepted, .. } = run.stats;
        assert_eq!(unsure_steps == 0, is_sure, "sin {rate}t: {unsure_steps} of {accepted}");
        assert!(unsure_steps <= accepted);
        // In shorter steps all are found.
        if rate == 1e4 {
            let solve = Solve::new(&body, &Taylor::<16>, [0.0, 20.0]).tolerances(1e-9, 1e-9);
            let event = Event::new("g", |t: f64, _: &V| (rate * t).sin());
            let run = solve.max_step(1e-3).event(event).run(FLIPS).unwrap();
            let expected = (20.0 * rate / std::f64::consts::PI) as usize + 1;
            assert_eq!((run.events.len(), run.stats.unsure_steps), (expected, 0));
        }
    }
}

/// A kink, a jump and a zero of high multiplicity do not count as functions that are too fast.
#[test]
fn functions_that_are_not_smooth_are_sure() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let zeros = |g: fn(f64, &V) -> f64| {
        let solve = Solve::new(&body, &Taylor::<16>, [0.0, 40.0]).tolerances(1e-9, 1e-9);
        let run = solve.event(Event::new("g", g)).run(V::new(0.2, 1.0, 3.0)).unwrap();
        assert_eq!(
            run.stats.unsure_steps, 0,
            "{} of {}",
            run.stats.unsure_steps, run.stats.accepted
        );
        run.times_of(0).collect::<Vec<_>>()
    };
    let plain = zeros(|_, m| m.y);
    assert!(plain.len() > 5);
    let same: [fn(f64, &V) -> f64; 3] =
        [|_, m| m.y.powi(3), |_, m| m.y.signum(), |_, m| (100.0 * m.y).tanh()];
    for same in same {
        let found = zeros(same);
        assert_eq!(found.len(), plain.len());
        assert!(found.iter().zip(&plain).all(|(a, b)| (a - b).abs() < 1e-4), "{found:?} {plain:?}");
    }
    let [level, both] = [zeros(|_, m| m.y - 0.5), zeros(|_, m| m.y.abs() - 0.5)];
    assert_eq!(both.len(), level.len() + zeros(|_, m| m.y + 0.5).len());
    assert_eq!(zeros(|t, _| (t - 5.0).powi(3)).len(), 1);
}

/// The zeros of the sine of the angle less 0.9, in a rotation about an axis with this angle.
fn of_rotation<M>((method, [angle, rate]): (&M, [OfTime; 2]), steps: Option<f64>, what: &str)
where
    M: for<'a> Embedded<Turning<'a>>,
{
    let field: Field<'_> = &|t, _, v| *v = V::z() * rate(t);
    let turning = Flow::new(So3::new(), LeftTranslation, field);
    let solve = || {
        let solve = Solve::new(&turning, method, [0.0, 20.0]);
        match steps {
            None => solve.tolerances(1e-8, 1e-8),
            Some(h) => solve.dt(h),
        }
    };
    let turns = (0..).map(|k| f64::from(k) * std::f64::consts::TAU);
    let zeros: Vec<f64> = turns
        .flat_map(|turn| [turn + 0.9f64.asin(), turn + std::f64::consts::PI - 0.9f64.asin()])
        .take_while(|zero| *zero < angle(20.0))
        .collect();
    for points in [None, Some(2)] {
        let event = Event::new("g", |_, y: &Matrix3<f64>| y[(1, 0)] - 0.9);
        let event = match points {
            None => event,
            Some(points) => event.points(points),
        };
        let run = solve().event(event).run(Matrix3::identity()).unwrap();
        let found: Vec<f64> = run.times_of(0).map(angle).collect();
        assert_eq!(found.len(), zeros.len(), "{what}, {points:?}: {:?}", run.stats);
        for (found, zero) in found.iter().zip(&zeros) {
            assert!((found - zero).abs() < 1e-5, "{what}, {points:?}: {found}, expected {zero}");
        }
    }
}

/// Steps are not below their least size because of events, and the search tells that they are too long.
#[test]
fn steps_that_turn_far_have_their_least_size() {
    let turning =
        boxed_of_time(So3::<f64>::new(), LeftTranslation, |_, v: &mut V| *v = 100.0 * V::z());
    let control = StepControl::new(1e-8, 1e-8).unwrap().min_step(4.0).unwrap();
    let method = Rkmk::new(DOPRI5, Exp);
    let event = Event::new("g", |_, y: &Matrix3<f64>| y[(1, 0)] - 0.9);
    let solve = Solve::new(&turning, &method, [0.0, 40.0]).control(control).event(event);
    let stats = solve.run(Matrix3::identity()).unwrap().stats;
    assert!(stats.smallest_step >= 4.0 && stats.unsure_steps > 0, "{stats:?}");
}

type OfTime = fn(f64) -> f64;
type Field<'a> = &'a dyn Fn(f64, &Matrix3<f64>, &mut V);
type Turning<'a> = Flow<So3, LeftTranslation, Field<'a>>;

/// An exponential is exact where f is constant, so that steps turn by many radian.
#[test]
fn steps_that_turn_far() {
    let even: [OfTime; 2] = [|t| 100.0 * t, |_| 100.0];
    // Slow at first, so that steps grow for long, and then fast.
    let faster: [OfTime; 2] = [|t| 2.0 * ((0.25 * t).exp() - 1.0), |t| 0.5 * (0.25 * t).exp()];
    for (what, [angle, rate]) in [("even", even), ("faster", faster)] {
        let turn = std::f64::consts::TAU / rate(20.0);
        for steps in [None, Some(0.7 * turn), Some(0.97 * turn), Some(1.37 * turn)] {
            let what = |name| format!("{name}, {what}, {steps:?}");
            of_rotation((&Rkmk::new(DOPRI5, Exp), [angle, rate]), steps, &what("dopri5"));
            of_rotation((&Rkmk::new(DOP853, Exp), [angle, rate]), steps, &what("dop853"));
            of_rotation((&CommutatorFree(CF43), [angle, rate]), steps, &what("cf43"));
        }
    }
}
