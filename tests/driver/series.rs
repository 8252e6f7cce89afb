//! Lie series with adaptive steps: their rows and events on hard starts, beside the exact motion and another method.

use lieflow::groups::Sample;
use lieflow::methods::{Embedded, LieSeries, Rkmk, Taylor, TaylorMomentum};
use lieflow::prelude::*;
use lieflow::problems::{Exact, Problem, RigidBody, RigidBodyAttitude, RigidBodyN, TaylorField};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;

type V = Vector3<f64>;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
/// A start, the end of its run, and how much the motion enlarges an error until then, with some room.
const STARTS: [([f64; 3], f64, f64); 6] = [
    ([0.1, 2.0, 0.3], 20.0, 1e4),
    // A turn about the middle axis: the separatrix, and 1e-14 beside it.
    ([0.0, 2.0, 0.0], 20.0, 10.0),
    ([1e-14, 2.0, 1e-14], 20.0, 1e7),
    // 1e-14 beside the first axis, and a fast turn.
    ([3.0, 1e-14, 1e-14], 20.0, 1e3),
    ([40.0, 30.0, -20.0], 5.0, 1e4),
    ([1000.0, 800.0, -900.0], 0.3, 1e4),
];

fn times(end: f64) -> Vec<f64> {
    (0..=60).map(|k| end * f64::from(k) / 60.0).collect()
}

/// The largest distance of the rows of a body by its momentum from the exact motion, in parts of |m|.
fn error_of_rows<M: Embedded<RigidBody>>(method: &M, start: V, end: f64, rtol: f64) -> (f64, u64) {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let exact = Exact::new(INERTIA, start.into(), Matrix3::identity()).unwrap();
    let run =
        Solve::new(&body, method, [0.0, end]).tolerances(rtol, 0.0).times(times(end)).run(start);
    let run = run.unwrap();
    let apart = |(t, m): (&f64, &V)| (m - exact.momentum_body(*t).unwrap()).norm() / start.norm();
    (run.times.iter().zip(&run.points).map(apart).fold(0.0, f64::max), run.stats.accepted)
}

#[test]
fn rows_of_the_free_body() {
    for (start, end, growth) in STARTS {
        let start = V::from(start);
        for rtol in [1e-6, 1e-9, 1e-12] {
            let errors = [
                ("8", error_of_rows(&Taylor::<8>, start, end, rtol)),
                ("11", error_of_rows(&Taylor::<11>, start, end, rtol)),
                ("16", error_of_rows(&Taylor::<16>, start, end, rtol)),
                ("8-m", error_of_rows(&TaylorMomentum::<8>, start, end, rtol)),
                ("16-m", error_of_rows(&TaylorMomentum::<16>, start, end, rtol)),
            ];
            for (order, (error, steps)) in errors {
                let allowed = growth * rtol + 1e-13 * growth;
                assert!(
                    error < allowed,
                    "{start:?} {rtol}: taylor{order} {error:e}, {steps} steps"
                );
            }
            // A high order needs fewer steps.
            for [low, high] in [[0, 2], [3, 4]].map(|pair| pair.map(|i: usize| errors[i].1.1)) {
                assert!(high < low, "{start:?} {rtol}: {low} and {high} steps");
            }
        }
        let [rough, fine] =
            [1e-6, 1e-9].map(|rtol| error_of_rows(&Taylor::<8>, start, end, rtol).0);
        assert!(fine < 0.02 * rough + 1e-13 * growth, "{start:?}: {rough:e} {fine:e}");
    }
}

/// The attitude turns, also where the momentum stays: the tolerance is that of the angle.
#[test]
fn rows_of_the_attitude() {
    for (start, end, growth) in STARTS {
        let body = RigidBodyAttitude::new(INERTIA, start).unwrap();
        let exact = Exact::new(INERTIA, start, Matrix3::identity()).unwrap();
        let run = Solve::new(&body, &Taylor::<14>, [0.0, end]).tolerances(1e-10, 0.0);
        let run = run.times(times(end)).run(Matrix3::identity()).unwrap();
        for (t, g) in run.times.iter().zip(&run.points) {
            let error = (g - exact.state(*t).unwrap().1).norm();
            assert!(error < growth * 1e-9, "{start:?}, t = {t}: {error:e}");
            assert!((g.tr_mul(g) - Matrix3::identity()).norm() < 1e-13);
        }
    }
}

/// Steps of a high order are searched for all zeros, whatever they turn. So how fast the state turns is not computed before
/// each step of more than a radian.
#[test]
fn long_steps_cost_the_evaluations_of_their_series() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let solve = Solve::new(&body, &Taylor::<16>, [0.0, 200.0]).tolerances(1e-6, 0.0);
    let solve = solve.event(Event::new("flip", |_, m: &V| m.y));
    let stats = solve.run(V::new(0.1, 2.0, 0.3)).unwrap().stats;
    assert!(stats.largest_step > 1.0);
    let attempts = stats.accepted + stats.rejected + 1;
    let more = stats.evaluations.unwrap() - 16 * attempts;
    assert!(more < attempts / 10 + 5, "{more} more, {attempts} attempts");
}

/// Steps of about a radian have zeros of several events, and one of them twice: all are at their exact times.
#[test]
fn events_within_long_steps() {
    let start = V::new(0.1, 2.0, 0.3);
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let exact = Exact::new(INERTIA, start.into(), Matrix3::identity()).unwrap();
    let m = |t: f64| exact.momentum_body(t).unwrap();
    let level = |m: &V| m.x - 1.05;
    let solve = Solve::new(&body, &Taylor::<16>, [0.0, 100.0]).tolerances(1e-10, 0.0);
    let solve = solve.event(Event::new("flip", |_, m: &V| m.y));
    let run = solve.event(Event::new("level", move |_, m: &V| level(m))).run(start).unwrap();
    assert!(run.stats.largest_step > 0.7, "{}", run.stats.largest_step);
    // The zeros of the exact motion, by a fine search.
    let zeros = |g: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let brackets = (0..100_000).map(|k| [k, k + 1].map(|k| 1e-3 * f64::from(k)));
        let with_zero = brackets.filter(|[a, b]| g(*a) * g(*b) < 0.0);
        with_zero
            .map(|[a, b]| {
                let (mut a, mut b) = (a, b);
                for _ in 0..50 {
                    let middle = 0.5 * (a + b);
                    *(if g(a) * g(middle) <= 0.0 { &mut b } else { &mut a }) = middle;
                }
                0.5 * (a + b)
            })
            .collect()
    };
    for (event, expected) in [zeros(&|t| m(t).y), zeros(&|t| level(&m(t)))].iter().enumerate() {
        let found: Vec<f64> = run.times_of(event).collect();
        assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
        for (t, expected) in found.iter().zip(expected) {
            assert!((t - expected).abs() < 1e-6, "{event}: {t}, expected {expected}");
        }
    }
}

/// On so(5) beside RKMK of order 8.
#[test]
fn rows_on_so5() {
    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0, 5.5]).unwrap();
    let mut rng = rand_pcg::Pcg64::seed_from_u64(9);
    let start = body.group().sample_algebra(&mut rng, 3.0).into_mat();
    let times: Vec<f64> = (0..=40).map(|k| 0.2 * f64::from(k)).collect();
    let fine = Rkmk::new(DOP853, Exp);
    let reference = Solve::new(&body, &fine, [0.0, 8.0]).tolerances(1e-14, 0.0);
    let reference = reference.times(times.clone()).times_by_steps().run(start.clone()).unwrap();
    let mut steps = Vec::new();
    for (order, rtol) in [(6, 1e-8), (10, 1e-10), (16, 1e-12)] {
        let method = LieSeries::new(order).unwrap();
        let run = Solve::new(&body, &method, [0.0, 8.0]).tolerances(rtol, 0.0);
        let run = run.times(times.clone()).run(start.clone()).unwrap();
        for (a, b) in run.points.iter().zip(&reference.points) {
            let error = (a - b).norm_l2();
            assert!(error < 1e3 * rtol, "order {order}: {error:e}");
        }
        steps.push(run.stats.accepted);
    }
    assert!(steps[2] < steps[0], "{steps:?}");
}

/// ġ = (t a + t³ b) g on SO(3): from t = 0 each second term of g vanishes.
struct Odd(So3, LeftTranslation);

const ODD: [V; 2] = [V::new(0.9, 0.2, -0.4), V::new(-0.1, 0.2, 0.15)];

impl Problem for Odd {
    type Group = So3;
    type Action = LeftTranslation;
    type Work = ();
    fn group(&self) -> &So3 {
        &self.0
    }
    fn action(&self) -> &LeftTranslation {
        &self.1
    }
    fn work(&self) {}
    fn f(&self, t: f64, _: &Matrix3<f64>, v: &mut V, (): &mut ()) {
        *v = t * ODD[0] + t.powi(3) * ODD[1];
    }
}

impl TaylorField for Odd {
    type Series = ();
    fn series(&self, _: usize) {}
    fn coefficient(&self, [t, h]: [f64; 2], _: &Matrix3<f64>, k: usize, f: &mut [V], (): &mut ()) {
        let [a, b] = ODD;
        f[k] = match k {
            0 => t * a + t.powi(3) * b,
            1 => h * (a + 3.0 * t * t * b),
            2 => 3.0 * t * h * h * b,
            3 => h.powi(3) * b,
            _ => V::zeros(),
        };
    }
}

/// Both of the last terms limit a step, because one of them may vanish.
#[test]
fn a_term_that_vanishes_lengthens_no_step() {
    let problem = Odd(So3::new(), LeftTranslation);
    let fine = Rkmk::new(DOP853, Exp);
    let reference = Solve::new(&problem, &fine, [0.0, 3.0]).tolerances(1e-14, 1e-14);
    let reference = reference.run(Matrix3::identity()).unwrap().y;
    for order in 9..=16 {
        for first in [0.2, 0.5, 0.9, 1.3, 1.7] {
            let method = LieSeries::new(order).unwrap();
            let solve = Solve::new(&problem, &method, [0.0, 3.0]).tolerances(1e-9, 0.0);
            let run = solve.first_step(first).run(Matrix3::identity()).unwrap();
            let error = (run.y - reference).norm();
            assert!(error < 3e-8, "order {order}, first step {first}: {error:e}");
        }
    }
}

/// On so(5) from hard starts: a relative equilibrium, 1e-14 beside one that is not stable, and a fast turn.
#[test]
fn hard_starts_on_so5() {
    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0, 5.5]).unwrap();
    let mut rng = rand_pcg::Pcg64::seed_from_u64(10);
    let random = body.group().sample_algebra(&mut rng, 1.0).into_mat();
    let plane = |i: usize, j: usize| {
        lieflow::faer::Mat::from_fn(5, 5, |a, b| match (a, b) {
            _ if (a, b) == (i, j) => 3.0,
            _ if (a, b) == (j, i) => -3.0,
            _ => 0.0,
        })
    };
    for (name, start, end, growth) in [
        ("equilibrium", plane(0, 1), 10.0, 1e3),
        ("beside one", plane(0, 4) + 1e-14 * &random, 10.0, 1e8),
        ("fast", 1000.0 * &random, 0.02, 1e4),
    ] {
        let times: Vec<f64> = (0..=20).map(|k| end * f64::from(k) / 20.0).collect();
        let fine = Rkmk::new(DOP853, Exp);
        let reference = Solve::new(&body, &fine, [0.0, end]).tolerances(1e-14, 0.0);
        let reference = reference.times(times.clone()).times_by_steps().run(start.clone()).unwrap();
        for (order, rtol) in [(8, 1e-7), (16, 1e-7), (16, 1e-11)] {
            let method = LieSeries::new(order).unwrap();
            let run = Solve::new(&body, &method, [0.0, end]).tolerances(rtol, 0.0);
            let run = run.times(times.clone()).run(start.clone()).unwrap();
            for (a, b) in run.points.iter().zip(&reference.points) {
                let error = (a - b).norm_l2() / start.norm_l2();
                assert!(
                    error < growth * (rtol + 1e-13),
                    "{name}, order {order}, {rtol}: {error:e}"
                );
                assert!((a.norm_l2() / start.norm_l2() - 1.0).abs() < 1e-13, "{name}");
            }
        }
    }
}

/// A translation whose terms do not fall with those of the rotation is in the error by the length of steps, too.
#[test]
fn the_translation_of_a_motion_is_in_the_error() {
    use core::f64::consts::FRAC_PI_2;
    use lieflow::groups::Se3;
    use lieflow::problems::Flow;
    use lieflow::tolerance::Rule;
    for turn in [0.0, 1e-3, 0.1] {
        let derivative = move |t: f64, k: usize, v: &mut (V, V)| {
            let w = if k == 0 { V::z() * turn } else { V::zeros() };
            let cosine = 20f64.powi(k as i32) * (20.0 * t + k as f64 * FRAC_PI_2).cos();
            *v = (w, V::x() * cosine);
        };
        let flow = Flow::of_derivatives(Se3::<f64>::new(), LeftTranslation, derivative);
        let start = (Matrix3::identity(), V::x() * 0.5);
        let reference = Rkmk::new(DOP853, Exp);
        let right = Solve::new(&flow, &reference, [0.0, 3.0]).steps(4000).run(start);
        let right = right.expect("a reference").y;
        for tolerance in [1e-6, 1e-10] {
            for rule in [Rule::PerStep, Rule::PerLength] {
                let method = LieSeries::new(16).expect("an order");
                let run = Solve::new(&flow, &method, [0.0, 3.0])
                    .tolerances(tolerance, tolerance)
                    .rule(rule);
                let run = run.run(start).expect("a run");
                let away = (run.y.1 - right.1).norm();
                let allowed = 100.0 * tolerance * run.stats.accepted as f64;
                assert!(
                    away < allowed,
                    "{turn}, {rule:?}, {tolerance}: {away:e} in {} steps",
                    run.stats.accepted
                );
            }
        }
    }
}

/// The points within a step are those of its polynomial: rows cost no evaluation.
#[test]
fn rows_of_a_series_cost_no_evaluation() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let start = V::new(0.1, 2.0, 0.3);
    for adaptive in [true, false] {
        let evaluations = |times: Vec<f64>| {
            let solve = Solve::new(&body, &Taylor::<16>, [0.0, 20.0]).times(times);
            let solve = if adaptive { solve.tolerances(1e-9, 0.0) } else { solve.steps(40) };
            solve.run(start).unwrap().stats.evaluations
        };
        assert_eq!(evaluations(times(20.0)), evaluations(vec![20.0]));
    }
}

/// The momentum in units of s, with the inertia in the same units, moves alike for any s: also where |m|² is beyond the range of
/// numbers. Each row is on the sphere of the start.
#[test]
fn the_series_of_the_momentum_serves_any_unit() {
    let rows = |s: f64| {
        let body = RigidBody::<f64>::new(INERTIA.map(|j| s * j)).unwrap();
        let solve = Solve::new(&body, &TaylorMomentum::<16>, [0.0, 20.0]).dt(0.5);
        let run = solve.times(times(20.0)).run(s * V::new(0.1, 2.0, 0.3)).unwrap();
        run.points.iter().map(|m| m / s).collect::<Vec<_>>()
    };
    let expected = rows(1.0);
    let exact = Exact::new(INERTIA, [0.1, 2.0, 0.3], Matrix3::identity()).unwrap();
    for s in [1.0, 1e-290, 1e-200, 1e-155, 1e-140, 1e140, 1e152, 1e200, 1e290] {
        for ((m, expected), t) in rows(s).iter().zip(&expected).zip(times(20.0)) {
            assert!((m - expected).norm() < 1e-13, "{s:e}: {m:?}, expected {expected:?}");
            assert!((m.norm() - expected.norm()).abs() < 1e-14, "{s:e}: {m:?}");
            assert!((m - exact.momentum_body(t).unwrap()).norm() < 1e-9, "{s:e}: {m:?}, t = {t}");
        }
    }
}

/// A body at rest stays at rest, and one that turns about an axis stays there.
#[test]
fn the_series_of_the_momentum_keeps_what_stays() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    for start in [V::zeros(), V::new(0.0, 2.0, 0.0), V::new(-3.0, 0.0, 0.0)] {
        let solve = Solve::new(&body, &TaylorMomentum::<12>, [0.0, 100.0]).tolerances(1e-9, 1e-9);
        let run = solve.times(times(100.0)).run(start).unwrap();
        assert!(run.points.iter().all(|m| (m - start).norm() < 1e-14 * start.norm().max(1.0)));
    }
}
