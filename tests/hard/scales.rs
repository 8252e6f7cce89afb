//! Units: what is computed in other units of time or of size is the same, to rounding.

use lieflow::actions::LeftTranslation;
use lieflow::groups::{Product, So3, Translations};
use lieflow::maps::Exp;
use lieflow::methods::magnus::{Magnus4, Magnus6, Magnus8};
use lieflow::methods::{GAUSS2, GAUSS4, GAUSS6, Gauss, RkmkGauss, RkmkGaussSymmetric};
use lieflow::{LieGroup, Solve};
use nalgebra::Vector3;

use crate::support::boxed::{boxed_flow, boxed_of_time};

/// A linear field in another unit of time, with steps that turn by 0.4 radian.
#[test]
fn magnus_methods_do_not_depend_on_the_unit_of_time() {
    macro_rules! check {
        ($($method:expr),*) => {$(
            let end = |s: f64| {
                let flow = boxed_of_time(So3::<f64>::new(), LeftTranslation, move |t, v: &mut Vector3<f64>| {
                    *v = s * Vector3::new((s * t).cos(), 0.5, s * t);
                });
                let run = Solve::new(&flow, &$method, [0.0, 2.0 / s]).steps(5);
                run.run(So3::<f64>::new().identity()).expect(stringify!($method)).y
            };
            for power in [-480, -250, -217, 217, 250, 480] {
                let away = (end(2f64.powi(power)) - end(1.0)).norm();
                assert!(away < 1e-14, "{}, 2^{power}: {away:e}", stringify!($method));
            }
        )*};
    }
    check!(Magnus4, Magnus6, Magnus8);
}

/// y' = s + y from rest: a start that is 0 has no size, and the solution has that of s.
#[test]
fn implicit_steps_from_rest_do_not_depend_on_the_unit() {
    macro_rules! check {
        ($($method:expr),*) => {$(
            let end = |s: f64, steps: u64| {
                let group = Translations::new(Vector3::zeros(), 3);
                let flow = boxed_flow(group, LeftTranslation, move |_, y: &Vector3<f64>, v: &mut Vector3<f64>| {
                    *v = Vector3::new(s + y.x, s + y.x - y.y, 2.0 * s - y.z);
                });
                let method = $method;
                let run = Solve::new(&flow, &method, [0.0, 0.5]).steps(steps);
                run.run(Vector3::zeros()).expect(stringify!($method)).y / s
            };
            for steps in [1, 10] {
                let right = end(1.0, steps);
                for s in [1e-4, 1e-8, 1e-12, 1e-15, 1e-18, 1e-100] {
                    let away = (end(s, steps) - right).norm();
                    assert!(away < 1e-14, "{}, {steps} steps, s = {s}: {away:e}", stringify!($method));
                }
            }
        )*};
    }
    check!(
        Gauss(GAUSS2),
        Gauss(GAUSS4),
        Gauss(GAUSS6),
        RkmkGauss::new(GAUSS2, Exp),
        RkmkGauss::new(GAUSS4, Exp),
        RkmkGauss::new(GAUSS6, Exp),
        RkmkGaussSymmetric::new(GAUSS6, Exp)
    );
}

/// A chain that fills from its end: x₁' = x₂, x₂' = x₃, x₃' = s, each a part of its own.
#[test]
fn parts_that_leave_rest_one_after_the_other_converge() {
    macro_rules! check {
        ($($method:expr),*) => {$(
            let end = |s: f64| {
                let one = || Translations::new(Vector3::zeros(), 3);
                type Y = (Vector3<f64>, (Vector3<f64>, Vector3<f64>));
                let group = Product(one(), Product(one(), one()));
                let field = move |_: f64, y: &Y, v: &mut Y| *v = (y.1.0, (y.1.1, s * Vector3::x()));
                let flow = boxed_flow(group, LeftTranslation, field);
                let start = (Vector3::zeros(), (Vector3::zeros(), Vector3::zeros()));
                let method = $method;
                let run = Solve::new(&flow, &method, [0.0, 1.0]).steps(4).run(start);
                run.expect(stringify!($method)).y.0.x / s
            };
            for s in [1e-15, 1e-18, 1e-60] {
                let away = (end(s) / end(1.0) - 1.0).abs();
                assert!(away < 1e-13, "{}, s = {s}: {away:e}", stringify!($method));
            }
        )*};
    }
    check!(
        Gauss(GAUSS4),
        RkmkGauss::new(GAUSS2, Exp),
        RkmkGauss::new(GAUSS4, Exp),
        RkmkGaussSymmetric::new(GAUSS6, Exp)
    );
}
