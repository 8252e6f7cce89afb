//! Events whose times are known in closed form, and published runs.

use std::f64::consts::PI;

use lieflow::actions::LeftTranslation;
use lieflow::groups::{Product, So3, Translations};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::{DOP853, DOPRI5};
use lieflow::methods::{ExactMotion, Method, Rk, Rkmk};
use lieflow::problems::{
    BodyMotion, BodyState, Exact, RigidBody, RigidBodyAttitude, RigidBodyQuaternion,
    RigidBodyState, SpaceTorque, SphericalPendulum, TorqueBody,
};
use lieflow::{Error, Event, RunError, Solve};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::modes::V;
use crate::scipy::free;
use crate::support::boxed::boxed_flow;

/// K(k) by the arithmetic-geometric mean, from k' = √(1 − k²).
fn quarter_period(complement: f64) -> f64 {
    let (mut a, mut b) = (1.0f64, complement);
    for _ in 0..10 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (2.0 * a)
}

/// The time from one zero of m₂ to the next, J₁ < J₂ < J₃: m₂ is proportional to sn(rate·t), with the axis of the
/// larger momentum exchanged where |m|² < 2EJ₂ (Landau and Lifshitz, Mechanics, § 37).
fn time_of_a_flip(inertia: [f64; 3], m: &V) -> f64 {
    let [mut j1, j2, mut j3] = inertia;
    let (square, twice) = (m.norm_squared(), m.x * m.x / j1 + m.y * m.y / j2 + m.z * m.z / j3);
    if square < twice * j2 {
        (j1, j3) = (j3, j1);
    }
    let rate2 = (j3 - j2) * (square - twice * j1) / (j1 * j2 * j3);
    let k2 = (j2 - j1) * (twice * j3 - square) / ((j3 - j2) * (square - twice * j1));
    2.0 * quarter_period((1.0 - k2).sqrt()) / rate2.sqrt()
}

#[test]
fn flips_of_a_free_body() {
    let inertia = [1.0, 2.0, 3.0];
    let body = RigidBody::new(inertia).expect("a body");
    // Near the middle axis, on both sides of the separatrix, and far from it.
    for start in [
        V::new(1.0, 0.0, 2.0),
        V::new(2.0, 0.0, 1.0),
        V::new(0.02, 0.0, 3.0),
        V::new(3.0, 0.0, 0.02),
    ] {
        let flip = time_of_a_flip(inertia, &start);
        let check = |found: &[f64], bound: f64| {
            assert_eq!(found.len(), 9);
            for (k, t) in found.iter().enumerate() {
                assert!(
                    (t - k as f64 * flip).abs() <= bound * flip * (1.0 + k as f64),
                    "{k}: {:e}",
                    t / flip - k as f64
                );
            }
        };
        // Steps are exact: the times are, to rounding. The first is the start.
        let flips = || Event::new("flip", |_, m: &V| m.y).stop_after(9);
        for steps in [0.5, 1.0, 0.1] {
            let run =
                Solve::new(&body, &ExactMotion, [0.0, f64::INFINITY]).dt(steps).event(flips());
            check(
                &run.run(start)
                    .expect("a run")
                    .events
                    .iter()
                    .map(|found| found.t)
                    .collect::<Vec<_>>(),
                1e-12,
            );
        }
        let method = Rkmk::new(DOP853, Exp);
        let run =
            Solve::new(&body, &method, [0.0, f64::INFINITY]).tolerances(1e-14, 0.0).event(flips());
        let run = run.run(start).expect("a run");
        check(&run.events.iter().map(|found| found.t).collect::<Vec<_>>(), 1e-12);
        for found in &run.events {
            assert!(found.y.y.abs() < 1e-14 && (found.y.norm() - start.norm()).abs() < 1e-13);
        }
        // The two zeros at each turning point of m₂, within one step: g = m₂ − 0.9999 of its largest.
        let (square, twice) = (start.norm_squared(), start.x * start.x + start.z * start.z / 3.0);
        let largest =
            [2.0 * (twice * 3.0 - square) / 1.0, 2.0 * (square - twice) / 1.0].map(f64::abs);
        let largest = largest[0].min(largest[1]).sqrt();
        let run = Solve::new(&body, &ExactMotion, [0.0, 4.0 * flip])
            .dt(0.2)
            .event(Event::new("turns", |_, m: &V| m.y - 0.9999 * largest))
            .run(start)
            .expect("a run");
        assert_eq!(
            run.events.iter().map(|found| found.rising).collect::<Vec<_>>(),
            [true, false, true, false]
        );
        let middle = |i: usize| 0.5 * (run.events[i].t + run.events[i + 1].t);
        assert!((middle(2) - middle(0) - 2.0 * flip).abs() < 1e-12 * flip * 4.0 + 1e-13);
    }
}

/// Many exact steps have the error of their rounding alone: energy and |m| do not drift.
#[test]
fn exact_steps_do_not_drift() {
    let steps = 50_000;
    for (inertia, m) in [
        ([1.0, 4.0, 4.5], V::new(1.0, 0.2, 0.5)),
        ([1.0, 2.0, 3.0], V::new(0.1, 2.0, 0.3)),
        ([1.0, 2.0, 3.0], V::new(1e-6, 1e-3, 2.0)),
        ([1.0, 1.0, 2.0], V::new(0.3, 0.4, 0.5)),
        ([1.0, 1.0, 1.0 + 1e-9], V::new(0.3, 0.4, 0.5)),
        ([2.0, 2.0, 2.0], V::new(0.3, 0.4, 0.5)),
        ([1e-150, 2e-150, 3e-150], V::new(0.3e-150, 0.4e-150, 0.5e-150)),
        ([1e150, 2e150, 3e150], V::new(0.3e150, 0.4e150, 0.5e150)),
    ] {
        let body = RigidBody::new(inertia).expect("a body");
        let end =
            Solve::new(&body, &ExactMotion, [0.0, 400.0]).steps(steps).run(m).expect("a run").y;
        let once = Exact::new(inertia, m.into(), Matrix3::identity()).expect("a body");
        let apart = (end - once.momentum_body(400.0).expect("a time")).norm() / m.norm();
        // The energy beside that about one axis, which a rotation about it keeps.
        let energy = |m: &V| body.energy(m) / m.norm_squared();
        let drift = (energy(&end) / energy(&m) - 1.0).abs();
        println!("{inertia:?} {m:?}: {apart:.1e}, energy {drift:.1e}");
        assert!(drift < 2e-14, "{inertia:?} {m:?}: energy {drift:e}");
        assert!(apart < 1e-11, "{inertia:?} {m:?}: {apart:e}");
    }
}

/// The phase and the attitude, too. In steps of one size a rounding that is the same in each of them would add up: 1e-11.
#[test]
fn exact_steps_keep_their_phase() {
    for (inertia, m) in [
        ([1.0, 2.0, 3.0], V::new(0.2, 0.0, 3.0)),
        ([1.0, 2.0, 3.0], V::new(0.1, 2.0, 0.6)),
        ([1.0, 4.0, 18.0], V::new(0.3, 2.0, 12.6)),
        ([1.0, 1.0, 2.0], V::new(0.3, 0.1, 2.0)),
        ([2.0, 2.0, 2.0], V::new(0.3, 0.4, 0.5)),
        ([1.0, 2.0, 3.0], V::new(0.0, 0.0, 2.0)),
        ([1.0, 2.0, 3.0], V::new(0.0, 2.0, 3e-6)),
        ([1e-150, 2e-150, 3e-150], V::new(0.3e-150, 0.4e-150, 0.5e-150)),
        ([1e150, 2e150, 3e150], V::new(0.3e150, 0.4e150, 0.5e150)),
    ] {
        let body = RigidBodyState::new(inertia).expect("a body");
        let once = Exact::new(inertia, m.into(), Matrix3::identity()).expect("a body");
        let (m_end, g_end) = once.state(10.0).expect("a time");
        for steps in [20_000, 33_333, 67_584] {
            let start = BodyState { m, g: Matrix3::identity() };
            let solve = Solve::new(&body, &ExactMotion, [0.0, 10.0]).steps(steps);
            let BodyState { m: m_run, g: g_run } = solve.run(start).expect("a run").y;
            let apart = ((m_run - m_end).norm() / m.norm()).max((g_run - g_end).norm());
            println!("{inertia:?} {m:?} {steps}: {apart:.1e}");
            assert!(apart < 3e-13, "{inertia:?} {m:?} {steps}: {apart:e}");
        }
    }
}

/// The energy of a body by its quaternion, which has the momentum by rounding alone.
#[test]
fn exact_steps_of_a_quaternion_keep_the_energy() {
    for (inertia, h) in [([1.0, 1.0, 3.0], 0.7), ([1.0, 2.0, 3.0], 1.3)] {
        let body = RigidBodyQuaternion::new(inertia, [0.4, 1.0, 2.0]).expect("a body");
        let solve = Solve::new(&body, &ExactMotion, [0.0, h * 4e5]).steps(400_000);
        let end = solve.run(UnitQuaternion::identity()).expect("a run").y;
        let energy = |q| {
            let m: V = body.momentum_body(q);
            m.dot(&m.component_div(&V::from(inertia))) / m.norm_squared()
        };
        let drift = (energy(&end) / energy(&UnitQuaternion::identity()) - 1.0).abs();
        println!("{inertia:?}: {drift:.1e}");
        assert!(drift < 1e-12, "{inertia:?}: {drift:e}");
    }
}

/// A step over any time stays on SO(3) and on the sphere, also where no digit of the phase is left.
#[test]
fn exact_steps_over_many_turns_stay_on_m() {
    let body = RigidBodyState::new([1.0, 2.0, 3.0]).expect("a body");
    let m = V::new(0.4, 1.0, 2.0);
    for h in [1e10, 1e12, 1e13, 1e14, 1e15, 1e17, 1e20, 1e30] {
        let start = BodyState { m, g: Matrix3::identity() };
        let end = Solve::new(&body, &ExactMotion, [0.0, h]).steps(1).run(start).expect("a run").y;
        let length = (end.m.norm() / m.norm() - 1.0).abs();
        let defect = (end.g.tr_mul(&end.g) - Matrix3::identity()).norm();
        assert!(length < 1e-14 && defect < 1e-14, "{h:e}: {length:e}, {defect:e}");
        assert!((end.g * end.m - m).norm() < 1e-13, "{h:e}");
    }
}

#[test]
fn the_period_of_a_pendulum() {
    let omega0: f64 = 1.7;
    let pendulum = SphericalPendulum::new(omega0 * omega0).expect("a pendulum");
    for angle in [0.1f64, 1.0, 3.0] {
        // Let go at an angle from the lowest point.
        let start = pendulum.state([0.0, angle.sin(), -angle.cos()], [0.0; 3]).expect("a state");
        let period = 4.0 * quarter_period((0.5 * angle).cos()) / omega0;
        let run = |event: Event<'static, (V, V)>| {
            let method = Rkmk::new(DOP853, Cay);
            let run = Solve::new(&pendulum, &method, [0.0, 3.3 * period])
                .tolerances(1e-13, 1e-13)
                .event(event);
            run.run(start).expect("a run").events
        };
        let lowest = run(Event::new("lowest", |_, y: &(V, V)| y.1.y).falling());
        assert_eq!(lowest.len(), 4);
        for (k, found) in lowest.iter().enumerate() {
            assert!(
                (found.t - (0.25 + k as f64) * period).abs() < 1e-10,
                "{angle} {k}: {}",
                found.t
            );
        }
        // At rest at the start, which counts, and after each half of a period.
        let rest = run(Event::new("at rest", |_, y: &(V, V)| y.0.x));
        assert_eq!(rest.len(), 7);
        for (k, found) in rest.iter().enumerate() {
            assert!((found.t - 0.5 * k as f64 * period).abs() < 1e-10, "{angle} {k}: {}", found.t);
        }
    }
}

/// The heavy top of Exudyn's documentation: ω_y in space at two times.
#[test]
fn the_heavy_top_of_exudyn() {
    let (mass, gravity, arm) = (15.0, 9.81, V::y());
    let inertia = [15.234375, 0.46875, 15.234375];
    let weight =
        move |at: &BodyMotion| (at.attitude * arm).cross(&V::new(0.0, 0.0, -mass * gravity));
    let top = TorqueBody::new(inertia, SpaceTorque(weight)).expect("a top");
    let start = (Matrix3::identity(), V::new(0.0, 150.0 * inertia[1], -4.61538 * inertia[2]));
    let omega =
        |(g, m): &(Matrix3<f64>, V)| g * (g.transpose() * m).component_div(&Vector3::from(inertia));
    let method = Rkmk::new(DOP853, Exp);
    let run = Solve::new(&top, &method, [0.0, 2.0])
        .tolerances(1e-13, 1e-12)
        .times([0.01, 2.0])
        .run(start);
    let run = run.expect("a run");
    let found = [omega(&run.points[0]).y, omega(&run.points[1]).y];
    assert!((found[0] - 149.8473939540758).abs() < 1e-9, "{found:?}");
    assert!((found[1] + 106.163804142).abs() < 1e-6, "{found:?}");
    // Its energy is the same when the centre of mass is lowest.
    let energy = |y: &(Matrix3<f64>, V)| 0.5 * omega(y).dot(&y.1) + mass * gravity * (y.0 * arm).z;
    let height = |y: &(Matrix3<f64>, V)| omega(y).cross(&(y.0 * arm)).z;
    let lowest = Event::new("lowest", move |_, y: &(Matrix3<f64>, V)| height(y)).rising();
    let run = Solve::new(&top, &method, [0.0, 2.0])
        .tolerances(1e-13, 1e-12)
        .event(lowest)
        .run(start)
        .expect("a run");
    assert!(!run.events.is_empty());
    for found in &run.events {
        assert!((energy(&found.y) / energy(&start) - 1.0).abs() < 1e-11);
    }
}

/// A ball that keeps the part e of its speed: it bounces at t₁ = √(2h/g), and then after 2eⁿt₁.
#[test]
fn a_ball_that_bounces() {
    let (gravity, height, keeps): (f64, f64, f64) = (9.81, 2.0, 0.8);
    let ball = boxed_flow(free(), LeftTranslation, move |_: f64, y: &V, v: &mut V| {
        *v = V::new(y.y, -gravity, 0.0)
    });
    let method = Rk(DOPRI5);
    let fall = (2.0 * height / gravity).sqrt();
    for adaptive in [true, false] {
        let bounce = Event::new("bounce", |_, y: &V| y.x).falling().stop_after(25);
        let bounce = bounce.change(move |_, y: &mut V| *y = V::new(0.0, -keeps * y.y, 0.0));
        let solve = Solve::new(&ball, &method, [0.0, 100.0]).event(bounce).times([0.5 * fall]);
        let solve = if adaptive { solve.tolerances(1e-10, 1e-12) } else { solve.dt(0.01) };
        let run = solve.run_continuous(V::new(height, 0.0, 0.0));
        let mut run = run.expect("a run");
        assert_eq!(run.solution.events.len(), 25);
        let mut expected = fall;
        for (n, found) in run.solution.events.clone().iter().enumerate() {
            assert!((found.t - expected).abs() < 1e-11, "{adaptive} {n}: {} {expected}", found.t);
            let speed = keeps.powi(n as i32) * gravity * fall;
            assert!((found.y.y + speed).abs() < 1e-10, "the speed before it");
            if found.t < run.solution.t {
                assert!(
                    (run.at(found.t).expect("a point").y - keeps * speed).abs() < 1e-10,
                    "and after"
                );
                // At the top of the next flight.
                let top = run.at(found.t + keeps * speed / gravity).expect("a point");
                assert!(
                    (top.x - (keeps * speed).powi(2) / (2.0 * gravity)).abs() < 1e-10
                        && top.y.abs() < 1e-9
                );
            }
            expected += 2.0 * keeps.powi(n as i32 + 1) * fall;
        }
        assert!((run.solution.y.y - keeps.powi(25) * gravity * fall).abs() < 1e-10);
    }
}

#[test]
fn a_change_that_leaves_the_manifold_is_refused() {
    let body = RigidBodyAttitude::new([1.0, 2.0, 3.0], [0.3, 0.4, 2.0]).expect("a body");
    let method = Rkmk::new(DOPRI5, Exp);
    let run = |change: fn(&mut Matrix3<f64>)| {
        Solve::new(&body, &method, [0.0, 4.0])
            .tolerances(1e-9, 1e-9)
            .every(1)
            .event(Event::new("kick", |t, _: &Matrix3<f64>| t - 1.25).change(move |_, g| change(g)))
            .run(Matrix3::identity())
    };
    let changes: [fn(&mut Matrix3<f64>); 3] =
        [|g| *g *= 1.1, |g| g[(0, 0)] = f64::NAN, |g| g.fill(0.0)];
    for change in changes {
        let failed = run(change).expect_err("not a rotation");
        match &failed.error {
            RunError::Changed {
                by,
                t,
                source: Error::NotOnGroup { arg: "y", .. } | Error::OutOfRange { .. },
            } => {
                assert!(by == "event `kick`" && (t - 1.25).abs() < 1e-15, "{by} {t}");
            }
            other => panic!("{other}"),
        }
        let known = failed.solution.expect("what was known");
        assert!((known.t - 1.25).abs() < 1e-15 && known.events.len() == 1 && known.times.len() > 2);
        assert!(
            (known.y * known.y.transpose() - Matrix3::identity()).norm() < 1e-13,
            "the state before it"
        );
    }
    // Off by rounding is taken back to M, and a rotation is gone on from.
    let turned = run(|g| {
        *g = *g * Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0) * (1.0 + 1e-9)
    });
    let turned = turned.expect("a run");
    assert!((turned.y * turned.y.transpose() - Matrix3::identity()).norm() < 1e-13);
    assert_eq!(turned.t, 4.0);
}

/// Attitude with a vector beside it: events of a product see both, and a change may touch one part.
#[test]
fn an_impulse_on_a_part() {
    let group = Product(So3::<f64>::new(), Translations::new(V::zeros(), 3));
    let problem = boxed_flow(
        group,
        LeftTranslation,
        |_: f64, (_, rate): &(Matrix3<f64>, V), v: &mut (V, V)| {
            *v = (*rate, V::zeros());
        },
    );
    let method = Rkmk::new(DOPRI5, Exp);
    assert_eq!(method.facts(&problem).order, 5);
    // Turned by 1 at rate 1, then by 2 at rate −4.
    let run = Solve::new(&problem, &method, [0.0, 1.5])
        .tolerances(1e-10, 1e-10)
        .event(
            Event::new("a radian", |_, y: &(Matrix3<f64>, V)| y.0[(1, 0)].atan2(y.0[(0, 0)]) - 1.0)
                .change(|_, y| y.1 *= -4.0),
        )
        .run((Matrix3::identity(), V::z()))
        .expect("a run");
    assert_eq!(run.events.len(), 1);
    assert!((run.events[0].t - 1.0).abs() < 1e-12);
    assert!((run.y.0[(1, 0)].atan2(run.y.0[(0, 0)]) + 1.0).abs() < 1e-12, "{:?}", run.y);
}
