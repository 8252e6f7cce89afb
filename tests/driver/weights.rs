//! An error in 𝔤 is weighed by what it does to the parts of a point: a run meets its tolerance also where it moves a part by
//! the size of another one.

use crate::support::boxed::{boxed_flow, boxed_of_time};
use lieflow::actions::{Coadjoint, Lagrangian, Linear, Pair};
use lieflow::faer::{c64, mat};
use lieflow::groups::{
    AlgebraMatrix, ComplexMatrix, LieAlgebra, MatrixGroup, Product, Se3, So3, Unitary,
};
use lieflow::maps::Exp;
use lieflow::methods::tableau::{DOP853, DOPRI5, RK4};
use lieflow::methods::{Embedded, LieSeries, Rk, Rkmk};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::problems::{Flow, HeavyTop, SphericalPendulum};
use lieflow::tolerance::{PartTolerance, Tolerance};
use lieflow::{Error, RunError, Solve};

/// Small swings of a pendulum, ω = a sin t: an error of the direction moves ω by the size of the direction, which is 1.
#[test]
fn a_small_swing_has_the_digits_of_its_tolerance() {
    let pendulum = SphericalPendulum::<f64>::new(1.0).expect("a pendulum");
    for a in [1e-6f64, 1e-4] {
        let start = pendulum.state([a.sin(), 0.0, -a.cos()], [0.0; 3]).expect("a state");
        let far = |error: f64| assert!(error < 1e-5, "a = {a}: {error:e}");
        fn go<M: Embedded<SphericalPendulum<f64>>>(
            pendulum: &SphericalPendulum<f64>,
            method: &M,
            start: (Vector3<f64>, Vector3<f64>),
        ) -> f64 {
            let run = Solve::new(pendulum, method, [0.0, 10.0]).tolerances(1e-6, 1e-15).run(start);
            run.expect("a run").y.0[1]
        }
        // The period of a swing of 1e-4 is longer by 1.6e-10 of it.
        let exact = a * 10f64.sin();
        far(go(&pendulum, &Rkmk::new(DOPRI5, Exp), start) / exact - 1.0);
        far((go(&pendulum, &Rkmk::new(DOP853, Exp), start) / exact - 1.0).abs());
        far((go(&pendulum, &Rk(DOPRI5), start) / exact - 1.0).abs());
        for order in [6, 12, 16] {
            let series = LieSeries::new(order).expect("an order");
            far((go(&pendulum, &series, start) / exact - 1.0).abs());
        }
    }
}

/// A part of its own may have a smaller tolerance.
#[test]
fn parts_of_a_momentum_have_their_tolerances() {
    let pendulum = SphericalPendulum::<f64>::new(1.0).expect("a pendulum");
    let start = pendulum.state([1e-6f64.sin(), 0.0, -1e-6f64.cos()], [0.0; 3]).expect("a state");
    let part = |atol: f64| PartTolerance::new(0.0, atol).expect("a tolerance");
    let tolerance = Tolerance::of_parts([part(1e-12), part(1e-6)]).expect("tolerances");
    let method = Rkmk::new(DOPRI5, Exp);
    let run = Solve::new(&pendulum, &method, [0.0, 10.0]).tolerance(tolerance).run(start);
    let error = run.expect("a run").y.0[1] - 1e-6 * 10f64.sin();
    assert!(error.abs() < 1e-11, "{error:e}");
}

/// A top that is let go: its momentum is small beside its direction.
#[test]
fn a_top_from_rest() {
    let top = HeavyTop::<f64>::new([1.0, 1.5, 0.7], [0.0, 0.0, 1.0]).expect("a top").problem();
    let start = (Vector3::zeros(), Vector3::new(1e-6, 0.0, -1.0).normalize());
    let end = |rtol: f64| {
        let method = Rkmk::new(DOPRI5, Exp);
        let run = Solve::new(&top, &method, [0.0, 3.0]).tolerances(rtol, 1e-14).run(start);
        run.expect("a run").y
    };
    let (rough, fine) = (end(1e-6), end(1e-12));
    assert!((rough.0 - fine.0).norm() < 1e-5 * fine.0.norm(), "{} {}", rough.0, fine.0);
    // The same with its motion in SE(3).
    let (body, method) = (top.with_group(), Rkmk::new(DOPRI5, Exp));
    let start = ((Matrix3::identity(), Vector3::zeros()), start);
    let run = Solve::new(&body, &method, [0.0, 3.0]).tolerances(1e-6, 1e-14).run(start);
    let momentum = run.expect("a run").y.1.0;
    assert!((momentum - fine.0).norm() < 1e-5 * fine.0.norm(), "{momentum} {}", fine.0);
}

/// Ṗ = −b P² with a small b and a large P, and Ṗ = c − P² with a small c from 0.
#[test]
fn riccati_equations_of_any_size() {
    let sp = || MatrixGroup::sp(2).expect("a group");
    let large =
        boxed_of_time(sp(), Lagrangian, |t: f64, v| v[(0, 1)] = 1e-6 * (1.0 + (20.0 * t).cos()));
    let small = boxed_of_time(sp(), Lagrangian, |t: f64, v| {
        (v[(0, 1)], v[(1, 0)]) = (1.0, 1e-6 * (2.0 * t).cos());
    });
    let method = Rkmk::new(DOPRI5, Exp);
    for (rtol, bound) in [(1e-6, 1e-6), (1e-9, 1e-9)] {
        let solve = Solve::new(&large, &method, [0.0, 2.0]).tolerances(rtol, 1e-9);
        let p = solve.run(mat![[1e6]]).expect("a run").y[(0, 0)];
        let exact = 1e6 / (3.0 + 40f64.sin() / 20.0);
        assert!((p / exact - 1.0).abs() < bound, "{p:e} {exact:e}");
        let solve = Solve::new(&small, &method, [0.0, 2.0]).tolerances(rtol, 1e-15);
        let p = solve.run(mat![[0.0]]).expect("a run").y[(0, 0)];
        // P = ½c sin 2t − ∫P², which is 5e-13 at the most.
        assert!((p / (0.5e-6 * 4f64.sin()) - 1.0).abs() < 3e-6, "{p:e}");
    }
    // A step to a pole, and one from it, are steps.
    let pole = boxed_of_time(sp(), Lagrangian, |_, v| (v[(1, 0)], v[(0, 1)]) = (1.0, -1.0));
    let method = Rkmk::new(DOP853, Exp);
    let pi_2 = core::f64::consts::FRAC_PI_2;
    for stop in [pi_2, pi_2 - 1e-7, 1.5] {
        let solve = Solve::new(&pole, &method, [0.0, 3.0]).tolerances(1e-13, 1e-13).stops([stop]);
        let p = solve.run(mat![[0.0]]).expect("a run over a pole").y[(0, 0)];
        assert!((p - 3f64.tan()).abs() < 1e-9, "{stop}: {p}");
    }
}

/// Each component has its atol, also where it is small beside the others, which a rotation mixes with it.
#[test]
fn components_that_are_small_have_their_tolerances() {
    let f = |t: f64, _: &Vector3<f64>, v: &mut Vector3<f64>| {
        *v = Vector3::new(5.0, 1e-5 * (2.0 * t).cos(), 1e-5 * (2.0 * t).sin());
    };
    let flow = boxed_flow(So3::<f64>::new(), Linear, f);
    let (method, fine) = (Rkmk::new(DOPRI5, Exp), Rkmk::new(DOP853, Exp));
    let tolerance = PartTolerance::per_component(1e-13, [1e-3, 1e-9, 1e-9]).expect("a tolerance");
    let run = Solve::new(&flow, &method, [0.0, 10.0]).tolerance(tolerance.into()).run(Vector3::x());
    let reference =
        Solve::new(&flow, &fine, [0.0, 10.0]).tolerances(1e-14, 1e-16).run(Vector3::x());
    let gap = run.expect("a run").y - reference.expect("a run").y;
    assert!(gap.y.abs() < 2e-8 && gap.z.abs() < 2e-8, "{gap}");
}

/// A motion in the body does not depend on where it begins in space.
#[test]
fn steps_in_the_body_do_not_depend_on_the_place() {
    type U = (Vector3<f64>, Vector3<f64>);
    let f = |t: f64, _: &(Matrix3<f64>, Vector3<f64>), v: &mut U| {
        *v = (Vector3::new(t.sin(), 0.3, 1.0 + t.cos()), Vector3::new(1.0, t.cos(), 0.1));
    };
    let flow = Flow::in_body(Se3::new(), f);
    let method = Rkmk::new(DOPRI5, Exp);
    let steps = [0.0, 1e3, 1e6].map(|x| {
        let start = (Matrix3::identity(), Vector3::new(x, 0.0, 0.0));
        let run = Solve::new(&flow, &method, [0.0, 10.0]).tolerances(0.0, 1e-9).run(start);
        run.expect("a run").stats.accepted
    });
    assert!(steps[0] == steps[1] && steps[0] == steps[2], "{steps:?}");
    // A turn to and fro about a far axis, which moves the body little.
    let (far, a) = (1e4, 1e-3);
    let wiggle = move |t: f64, _: &(Matrix3<f64>, Vector3<f64>), v: &mut U| {
        let rate = 50.0 * a * (50.0 * t).cos();
        *v = (Vector3::z() * rate, Vector3::y() * (-far * rate));
    };
    let flow = Flow::in_body(Se3::new(), wiggle);
    let part = |atol: f64| PartTolerance::new(0.0, atol).expect("a tolerance");
    let angle = a * 50f64.sin();
    let moved = Vector3::new(far * (1.0 - angle.cos()), -far * angle.sin(), 0.0);
    for x in [0.0, far] {
        let tolerance = Tolerance::of_parts([part(1e-3), part(1e-6)]).expect("tolerances");
        let start = (Matrix3::identity(), Vector3::new(x, 0.0, 0.0));
        let run = Solve::new(&flow, &method, [0.0, 1.0]).tolerance(tolerance).run(start);
        let error = (run.expect("a run").y.1 - start.1 - moved).norm();
        assert!(error < 1e-5, "{x}: {error:e}");
    }
}

/// Numbers that are not finite are refused in states of U(n), also as a part of a pair and in a span without a step.
#[test]
fn states_of_unitary_groups_are_finite() {
    let u2 = Unitary::new(2).expect("a group");
    let mut rho =
        ComplexMatrix::from_fn(2, 2, |i, j| c64::new(0.0, if i == j { 1.0 } else { 0.0 }));
    rho.im[(0, 0)] = f64::NAN;
    let psi =
        ComplexMatrix::from_fn(2, 1, |i, _| c64::new(if i == 0 { f64::NAN } else { 1.0 }, 0.0));
    let refused = |end: Result<(), RunError>| {
        let is_entry = matches!(&end, Err(RunError::Setup(Error::NotFiniteEntry { .. })));
        assert!(is_entry, "{end:?}");
    };
    let method = Rkmk::new(DOPRI5, Exp);
    let group = Product(u2, So3::new());
    let pair = boxed_flow(
        group,
        Pair(Coadjoint, Linear),
        |t: f64, _: &_, v: &mut (ComplexMatrix, Vector3<f64>)| {
            v.0.im[(0, 0)] = t.cos();
        },
    );
    assert!(group.zero().1 == Vector3::zeros());
    let solve = Solve::new(&pair, &method, [0.0, 1.0]).tolerances(1e-6, 1e-9);
    refused(solve.run((rho, Vector3::x())).map(drop).map_err(|failed| failed.error));
    let one = boxed_of_time(u2, Linear, |t: f64, v: &mut ComplexMatrix| v.im[(0, 0)] = t.cos());
    let solve = Solve::new(&one, &method, [0.0, 1.0]).tolerances(1e-6, 1e-9);
    refused(solve.run(psi.clone()).map(drop).map_err(|failed| failed.error));
    let plain = Rkmk::new(RK4, Exp);
    let empty = Solve::new(&one, &plain, [0.0, 0.0]).steps(1);
    refused(empty.run(psi).map(drop).map_err(|failed| failed.error));
}

/// A Riccati equation beside a vector passes its poles as alone, and has its own error beside a large P.
#[test]
fn a_riccati_equation_in_a_pair() {
    let group = Product(MatrixGroup::sp(2).expect("a group"), So3::<f64>::new());
    let f = |_: f64, _: &_, v: &mut (AlgebraMatrix, Vector3<f64>)| {
        (v.0[(1, 0)], v.0[(0, 1)]) = (1.0, -1.0);
        v.1 = Vector3::z();
    };
    let flow = boxed_flow(group, Pair(Lagrangian, Linear), f);
    let method = Rkmk::new(DOP853, Exp);
    let pi_2 = core::f64::consts::FRAC_PI_2;
    for stop in [pi_2, pi_2 - 1e-7] {
        let solve = Solve::new(&flow, &method, [0.0, 3.0]).tolerances(1e-13, 1e-13).stops([stop]);
        let end = solve.run((mat![[0.0]], Vector3::x())).expect("a run over a pole").y;
        assert!((end.0[(0, 0)] - 3f64.tan()).abs() < 1e-9, "{stop}: {:?}", end.0);
        assert!((end.1 - Vector3::new(3f64.cos(), 3f64.sin(), 0.0)).norm() < 1e-10, "{}", end.1);
    }
}
