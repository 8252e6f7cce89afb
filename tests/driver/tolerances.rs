//! What the error of a step is compared with, and that a run keeps to it.

use lieflow::actions::{LeftTranslation, Linear};
use lieflow::catalog::MethodsByName;
use lieflow::groups::{Product, Se3, So3, Translations};
use lieflow::maps::Exp;
use lieflow::methods::tableau::{BS3, DOPRI5};
use lieflow::methods::{Embedded, Rk, Rkmk};
use lieflow::problems::{PointOf, Problem, RigidBody};
use lieflow::tolerance::{PartTolerance, Rule, Tolerance};
use lieflow::{LieAlgebra, RunError, Solve, Step, StepControl};
use nalgebra::{Matrix3, Vector3};

use crate::modes::V;
use crate::scipy::free;
use crate::support::boxed::{boxed_flow, boxed_of_time};

/// The ratio of one step with a tolerance.
fn ratio<P: Problem<Group: LieAlgebra<Scalar = f64>>, M: Embedded<P>>(
    problem: &P,
    method: &M,
    tolerance: Tolerance,
    y: &PointOf<P>,
) -> f64 {
    let mut work = method.work(problem, y).expect("the method fits");
    let step = Step { n: 0, t: 0.2, h: 0.3 };
    let mut to = y.clone();
    method.step_with_error(problem, step, &tolerance, y, &mut work, &mut to).expect("a step")
}

fn both(rtol: f64, atol: f64) -> Tolerance {
    Tolerance::new(rtol, atol).expect("tolerances")
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-9, "{found:e}, expected {expected:e}");
}

/// A vector: ‖e‖ against atol + rtol·‖y‖, or |eᵢ| against atolᵢ + rtol·|yᵢ|.
#[test]
fn of_a_vector() {
    let field = |t: f64| V::new((9.0 * t).cos(), (8.0 * t).sin(), 1e-3 * (7.0 * t).cos());
    let problem = boxed_of_time(free(), LeftTranslation, move |t: f64, v: &mut V| *v = field(t));
    let (method, y) = (Rk(BS3), V::new(300.0, -40.0, 0.0));
    // The error itself, from the rows of the pair: 5/72, −1/12, −1/9, 1/8.
    let e = 0.3
        * (5.0 / 72.0 * field(0.2) - field(0.35) / 12.0 - field(0.425) / 9.0 + field(0.5) / 8.0);
    let of = |tolerance| ratio(&problem, &method, tolerance, &y);
    near(of(both(0.0, 1.0)), e.norm());
    // In M the error is that of the end of the step, to rounding of the difference of two points.
    let way = 0.3 * (2.0 / 9.0 * field(0.2) + field(0.35) / 3.0 + 4.0 / 9.0 * field(0.425));
    let close = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 1e-7, "{found:e}, expected {expected:e}")
    };
    let exact = Rkmk::new(BS3, Exp);
    let of_algebra = |tolerance| ratio(&problem, &exact, tolerance, &y);
    near(of_algebra(both(0.0, 1e-5)), e.norm() / 1e-5);
    near(of_algebra(both(1e-3, 0.0)), e.norm() / (1e-3 * y.norm()));
    near(of_algebra(both(1e-3, 0.5)), e.norm() / (0.5 + 1e-3 * y.norm()));
    let each = |rtol, atol: [f64; 3]| -> Tolerance {
        PartTolerance::per_component(rtol, atol).expect("tolerances").into()
    };
    let scaled = |rtol: f64, atol: [f64; 3], at: V| {
        (0..3).map(|i| e[i].abs() / (atol[i] + rtol * at[i].abs())).fold(0.0, f64::max)
    };
    for atol in [[1.0, 1.0, 1.0], [1.0, 1.0, 1e-6], [1e-6, 1.0, 1.0], [1.0, 1e-6, 1.0]] {
        for rtol in [0.0, 1e-4] {
            near(of_algebra(each(rtol, atol)), scaled(rtol, atol, y));
            close(of(each(rtol, atol)), scaled(rtol, atol, y + way));
        }
    }
    // By the length of the step: ‖e‖ against atol + rtol·(the way that it goes).
    near(of_algebra(both(1e-3, 0.0).by(Rule::PerLength)), e.norm() / (1e-3 * way.norm()));
    near(of_algebra(both(1e-3, 0.5).by(Rule::PerLength)), e.norm() / (0.5 + 1e-3 * way.norm()));
}

/// A rotation: the angle of the error against atol + rtol. A vector that turns: the angle times its size.
#[test]
fn of_a_rotation() {
    let field = |t: f64, v: &mut V| *v = V::new((9.0 * t).cos(), (8.0 * t).sin(), 0.3);
    let (method, so3) = (Rkmk::new(BS3, Exp), So3::<f64>::new());
    let attitude = boxed_of_time(so3, LeftTranslation, field);
    let of = |tolerance| ratio(&attitude, &method, tolerance, &Matrix3::identity());
    let angle = of(both(0.0, 1.0));
    assert!(angle > 1e-4);
    near(of(both(1e-6, 0.0)), angle / 1e-6);
    near(of(both(1e-6, 3e-6)), angle / 4e-6);
    let vector = boxed_of_time(so3, Linear, field);
    let y = V::new(0.0, 30.0, 40.0);
    near(ratio(&vector, &method, both(0.0, 1e-6), &y), 50.0 * angle / 1e-6);
    near(ratio(&vector, &method, both(1e-6, 0.0), &y), angle / 1e-6);
    near(ratio(&vector, &method, both(1e-6, 1e-5), &y), 50.0 * angle / (1e-5 + 50e-6));
}

type Both = (Matrix3<f64>, V);

/// An attitude that turns, and a vector that moves on its own.
fn beside() -> impl Problem<Group = Product<So3, Translations<V>>, Action = LeftTranslation> {
    let group = Product(So3::new(), free());
    boxed_flow(group, LeftTranslation, |t: f64, y: &Both, v: &mut (V, V)| {
        *v = (
            V::new((2.0 * t).cos(), 0.4, t.sin()),
            V::new(-2.0 * t * y.1.x * y.1.x, y.1.x * y.1.y, -0.5 * y.1.z),
        );
    })
}

const START: Both =
    (Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), Vector3::new(1.0, 1.0, 1.0));

fn parts<const N: usize>(atol: [f64; N]) -> Tolerance {
    let parts = atol.map(|atol| PartTolerance::new(0.0, atol).expect("a tolerance"));
    Tolerance::of_parts(parts).expect("parts")
}

/// The largest of the ratios of the parts, each with its own tolerance.
#[test]
fn of_a_product() {
    let (problem, method) = (beside(), Rkmk::new(BS3, Exp));
    let of = |a, b| ratio(&problem, &method, parts([a, b]), &START);
    let (turned, moved) = (of(1e-9, 1e9) * 1e-9, of(1e9, 1e-9) * 1e-9);
    assert!(turned > 1e-6 && moved > 1e-6);
    near(of(1e-5, 1e-7), f64::max(turned / 1e-5, moved / 1e-7));
    near(of(1e-7, 1e-5), f64::max(turned / 1e-7, moved / 1e-5));
    near(ratio(&problem, &method, both(0.0, 1e-6), &START), turned.max(moved) / 1e-6);
}

/// The part with the loose tolerance gets fewer digits than with a tight one, and the run fewer steps.
#[test]
fn each_part_has_its_own() {
    let (problem, method) = (beside(), Rkmk::new(DOPRI5, Exp));
    let run = |tolerance: Tolerance| {
        let run = Solve::new(&problem, &method, [0.0, 6.0])
            .tolerance(tolerance)
            .run(START)
            .expect("a run");
        (run.y, run.stats.accepted)
    };
    let exact = run(parts([1e-13, 1e-13])).0;
    let error = |y: &Both| ((y.0 - exact.0).norm(), (y.1 - exact.1).norm());
    let (tight, steps) = run(parts([1e-9, 1e-9]));
    let (loose_vector, fewer) = run(parts([1e-9, 1e-3]));
    let (loose_rotation, _) = run(parts([1e-3, 1e-9]));
    let (loose, fewest) = run(parts([1e-3, 1e-3]));
    assert!(error(&tight).0 < 1e-7 && error(&tight).1 < 1e-7);
    assert!(error(&loose_vector).0 < 1e-7 && error(&loose_rotation).1 < 1e-7);
    assert!(error(&loose).0 > 1e-5 && error(&loose).1 > 1e-5, "{:?}", error(&loose));
    assert!(fewest < fewer && fewer <= steps);
}

#[test]
fn each_component_has_its_own() {
    // x and y are independent of one another: cos and sin at 3, and a slow z.
    let problem = boxed_flow(free(), LeftTranslation, |_: f64, y: &V, v: &mut V| {
        *v = V::new(-3.0 * y.y, 3.0 * y.x, -y.z)
    });
    let method = Rk(DOPRI5);
    let run = |atol: [f64; 3]| {
        let tolerance = PartTolerance::per_component(0.0, atol).expect("tolerances");
        let run = Solve::new(&problem, &method, [0.0, 4.0])
            .tolerance(tolerance.into())
            .run(V::new(1.0, 0.0, 1.0));
        let run = run.expect("a run");
        let exact = V::new(12.0f64.cos(), 12.0f64.sin(), (-4.0f64).exp());
        ((run.y - exact).abs(), run.stats.accepted)
    };
    let (tight, steps) = run([1e-10, 1e-10, 1e-10]);
    let (loose, fewer) = run([1e-3, 1e-3, 1e-10]);
    let (also_loose, fewest) = run([1e-3, 1e-3, 1e-3]);
    assert!(tight.x < 1e-7 && tight.z < 1e-8 && loose.z < 1e-8, "{tight} {loose}");
    assert!(
        fewest < fewer
            && fewer < steps
            && loose.x > 10.0 * tight.x
            && also_loose.z > 10.0 * loose.z
    );
}

#[test]
fn a_wrong_number_of_them_is_told() {
    let method = Rkmk::new(DOPRI5, Exp);
    let problem = beside();
    for (given, tolerance) in [(3, parts([1e-6; 3])), (5, parts([1e-6; 5]))] {
        let failed = Solve::new(&problem, &method, [0.0, 1.0])
            .tolerance(tolerance)
            .run(START)
            .expect_err("parts");
        assert!(matches!(failed.error, RunError::Setup(_)), "{failed}");
        let said = failed.to_string();
        assert!(
            said.contains("tolerances") && said.contains(&given.to_string()) && said.contains('2'),
            "{said}"
        );
    }
    assert!(Tolerance::of_parts([]).is_err());
    for fits in [1, 2] {
        let tolerance = if fits == 1 { parts([1e-6; 1]) } else { parts([1e-6; 2]) };
        Solve::new(&problem, &method, [0.0, 1.0]).tolerance(tolerance).run(START).expect("a run");
    }
    // SE(3) has two parts.
    let se3 = boxed_of_time(Se3::<f64>::new(), LeftTranslation, |t: f64, v: &mut (V, V)| {
        *v = (V::z() * t, V::x())
    });
    let at = (Matrix3::identity(), V::zeros());
    for (count, fits) in [(1, true), (2, true), (3, false)] {
        let tolerance =
            Tolerance::of_parts(vec![PartTolerance::new(0.0, 1e-6).expect("one"); count])
                .expect("parts");
        let run = Solve::new(&se3, &method, [0.0, 1.0]).tolerance(tolerance).run(at);
        assert_eq!(run.is_ok(), fits, "{count}");
    }
    // As many as components.
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    for (count, fits) in [(2, false), (3, true), (4, false)] {
        let tolerance = PartTolerance::per_component(1e-6, vec![1e-6; count]).expect("tolerances");
        let run = Solve::new(&body, &method, [0.0, 1.0]).tolerance(tolerance.into()).run(V::x());
        assert_eq!(run.is_ok(), fits, "{count}");
        if let Err(failed) = run {
            let said = failed.to_string();
            assert!(said.contains("atol") && said.contains(&count.to_string()), "{said}");
        }
    }
    let array = boxed_of_time(
        Translations::new([0.0; 2], 2),
        LeftTranslation,
        |t: f64, v: &mut [f64; 2]| *v = [t, 1.0],
    );
    // A rotation has no components, and the rule by the length has one tolerance.
    let turn =
        boxed_of_time(So3::<f64>::new(), LeftTranslation, |t: f64, v: &mut V| *v = V::z() * t);
    let two = || PartTolerance::per_component(1e-6, [1e-6, 1e-3]).expect("tolerances");
    Solve::new(&array, &method, [0.0, 1.0]).tolerance(two().into()).run([0.0; 2]).expect("a run");
    let failed =
        Solve::new(&turn, &method, [0.0, 1.0]).tolerance(two().into()).run(Matrix3::identity());
    assert!(failed.expect_err("components").to_string().contains("atol"));
    for tolerance in [Tolerance::from(two()), parts([1e-6; 2])] {
        let tolerance = tolerance.by(Rule::PerLength);
        let failed = Solve::new(&problem, &method, [0.0, 1.0]).tolerance(tolerance).run(START);
        assert!(matches!(failed.expect_err("parts").error, RunError::Setup(_)));
    }
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(
            PartTolerance::per_component(1e-6, [1e-6, bad]).is_err()
                && PartTolerance::new(bad, 1.0).is_err()
        );
    }
    assert!(
        PartTolerance::per_component(0.0, [1e-6, 0.0]).is_err(),
        "nothing to compare the second with"
    );
}

/// By the step the size of the point counts, by the length it does not: the error of a run is rtol of its way.
#[test]
fn by_the_step_and_by_the_length() {
    let problem =
        boxed_of_time(free(), LeftTranslation, |t: f64, v: &mut V| *v = V::new(t.cos(), 0.0, 0.0));
    let method = Rkmk::new(DOPRI5, Exp);
    let run = |rule: Rule, offset: f64, rtol: f64| {
        let start = V::new(0.0, offset, 0.0);
        let run = Solve::new(&problem, &method, [0.0, 40.0])
            .tolerances(rtol, 0.0)
            .rule(rule)
            .every(1)
            .run(start)
            .expect("a run");
        // The largest error of all steps: that of the end alone may cancel.
        let errors = run.times.iter().zip(&run.points).map(|(t, y)| (y.x - t.sin()).abs());
        (errors.fold(0.0, f64::max), run.stats.accepted)
    };
    let (near_0, far) = (run(Rule::PerStep, 1.0, 1e-8), run(Rule::PerStep, 1e6, 1e-8));
    assert!(far.1 * 3 < near_0.1, "{far:?} {near_0:?}");
    let (near_0, far) = (run(Rule::PerLength, 1.0, 1e-8), run(Rule::PerLength, 1e6, 1e-8));
    assert_eq!(near_0.1, far.1);
    // The way is 4/π·20 long: |cos| over 40.
    for rtol in [1e-5, 1e-7, 1e-9] {
        let (error, _) = run(Rule::PerLength, 1.0, rtol);
        assert!(error < rtol * 26.0, "{rtol}: {error}");
    }
    // A smaller tolerance pays, by about its own factor.
    let errors = [1e-5, 1e-9].map(|rtol| run(Rule::PerStep, 1.0, rtol).0);
    assert!(errors[1] < 1e-3 * errors[0], "{errors:?}");
}

/// The rule that was set stays where the tolerances are set after it.
#[test]
fn tolerances_keep_the_rule() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let (method, start) = (Rkmk::new(DOPRI5, Exp), V::new(0.2, 0.0, 3.0));
    let steps = |run: Solve<'_, RigidBody, _>| run.run(start).expect("a run").stats.accepted;
    let solve = || Solve::new(&body, &method, [0.0, 50.0]);
    let before = steps(solve().rule(Rule::PerLength).tolerances(1e-6, 0.0));
    assert_eq!(before, steps(solve().tolerances(1e-6, 0.0).rule(Rule::PerLength)));
    assert_ne!(before, steps(solve().tolerances(1e-6, 0.0)));
}

/// rtol alone, from parts that are 0 at the start: the size of the end of the step counts there.
#[test]
fn rtol_alone_from_zero() {
    let group = Product(So3::<f64>::new(), free());
    let action = lieflow::actions::Pair(LeftTranslation, LeftTranslation);
    let flow = boxed_flow(group, action, |t: f64, y: &(Matrix3<f64>, V), v: &mut (_, V)| {
        v.0 = Vector3::new(0.3, t.cos(), 0.1) + y.1;
        v.1 = V::new(t, (3.0 * t).sin(), 1.0);
    });
    let y0 = (Matrix3::identity(), V::zeros());
    let end = |rtol: f64| {
        let method = Rkmk::new(DOPRI5, Exp);
        let solve = Solve::new(&flow, &method, [0.0, 2.0]).tolerances(rtol, 0.0);
        solve.run(y0).expect("a run")
    };
    let (rough, fine) = (end(1e-5), end(1e-9));
    let exact = V::new(2.0, (1.0 - 6f64.cos()) / 3.0, 2.0);
    assert!((rough.y.1 - exact).norm() < 1e-4 && (fine.y.1 - exact).norm() < 1e-8);
    assert!((rough.y.0 - fine.y.0).norm() < 1e-4);
    // Steps are few: none is a search for a part that is 0.
    assert!(rough.stats.accepted + rough.stats.rejected < 60, "{:?}", rough.stats);
}

/// A tolerance that no step can meet is refused before the first step; a part that starts at 0 has any.
#[test]
fn a_tolerance_out_of_reach_is_refused() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let method = Rkmk::new(DOPRI5, Exp);
    let run = |y: V, tolerance: Tolerance| {
        let control = StepControl::from(tolerance);
        Solve::new(&body, &method, [0.0, 1e-3]).control(control).run(y)
    };
    let start = V::new(0.3, 2.0, -1.0);
    let refused = run(start, both(0.0, 1e-30)).expect_err("a tolerance below rounding");
    assert_eq!(
        refused.to_string(),
        "atol = 1e-30, expected a larger one, or rtol = 9e-16 or more beside it: no step from this start has so small an \
         error"
    );
    for each in [[1e-9, 1e-30, 1e-9], [1e-30; 3]] {
        let of_each = PartTolerance::per_component(0.0, each).expect("tolerances");
        assert!(run(start, of_each.into()).is_err(), "{each:?}");
    }
    run(start, both(1e-15, 1e-30)).expect("rtol is enough");
    run(start, both(0.0, 1e-18)).expect("a short step has such an error");
    run(1e-14 * start, both(0.0, 1e-30)).expect("it is relative to the start");
    run(V::zeros(), both(0.0, 1e-30)).expect("it stays at 0");
}

/// The statistics have the smallest step that followed a rejected attempt: a pulse of f is there.
#[test]
fn the_hardest_place_of_a_run_is_known() {
    let (start, end) = (V::new(0.0, 0.0, 1.0), 10.0);
    let run = |strength: f64| {
        let rate = move |t: f64| 0.1 + strength * (-((t - 6.3) / 0.02f64).powi(2)).exp();
        let turning = move |t: f64, v: &mut V| *v = V::new(rate(t), 0.0, 0.0);
        let problem = boxed_of_time(So3::<f64>::new(), Linear, turning);
        let method = Rkmk::new(BS3, Exp);
        let solve = Solve::new(&problem, &method, [0.0, end]).max_step(0.1);
        solve.tolerances(1e-8, 1e-8).run(start).expect("a run").stats
    };
    let [at, size] = run(20.0).after_rejection.expect("a rejected attempt");
    assert!((at - 6.3).abs() < 0.06 && size < 0.02, "{at}, {size}");
    assert_eq!(run(0.0).after_rejection, None);
}

/// The unit of a vector does not change the steps, also far from t = 0 where the numbers are large.
#[test]
fn the_unit_of_a_vector_does_not_count() {
    let turning = |t: f64, y: &V, v: &mut V| *v = V::new(-y.y, y.x, 0.3 * t.cos() * y.z);
    let (problem, method) = (boxed_flow(free(), LeftTranslation, turning), Rkmk::new(DOPRI5, Exp));
    let run = |unit: f64| {
        let solve = Solve::new(&problem, &method, [1e3, 1.01e3]).tolerances(1e-6, 0.0);
        solve.run(V::new(unit, 0.0, unit)).expect("a run")
    };
    let one = run(1.0);
    for unit in [2f64.powi(37), 2f64.powi(200)] {
        let other = run(unit);
        assert_eq!(other.stats.accepted, one.stats.accepted, "{unit}");
        assert!((other.y / unit - one.y).norm() < 1e-13, "{unit}");
    }
    let turned = V::new(10f64.cos(), 10f64.sin(), 0.0);
    assert!((one.y - turned).xy().norm() < 1e-4);
}

/// A part with a large number does not hide the errors of the others, whatever method estimates them: an attitude beside a
/// position of an astronomical unit in metres, which does not move.
#[test]
fn a_large_part_hides_no_error() {
    let group = Product(So3::<f64>::new(), free());
    let problem = boxed_flow(group, LeftTranslation, |t: f64, _: &Both, v: &mut (V, V)| {
        *v = (V::new(t.cos(), (2.0 * t).sin(), 1.0), V::zeros());
    });
    for method in ["cf43", "rkmk4", "cf4", "cg3", "rkmk dopri5"] {
        let method = problem.method(&method.parse().expect("a method")).expect("it fits");
        let end = |position: f64, tolerance: f64| {
            let start = (Matrix3::identity(), V::x() * position);
            let solve = Solve::new(&problem, &method, [0.0, 10.0]).tolerances(tolerance, tolerance);
            solve.run(start).expect("a run").y.0
        };
        let exact = end(1.0, 1e-12);
        let (near, far) = ((end(1.0, 1e-9) - exact).norm(), (end(1.5e11, 1e-9) - exact).norm());
        assert!(far < 1e-6 && near < 1e-6, "{near:e} {far:e}");
    }
}
