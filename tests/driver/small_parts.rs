//! Parts that are small beside others: an implicit step solves each to its own rounding, and the check of a start looks at
//! each.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::support::boxed::boxed_flow;
use lieflow::actions::{LeftTranslation, Linear, Pair};
use lieflow::catalog::MethodsByName;
use lieflow::faer::Mat;
use lieflow::groups::{ComplexMatrix, Power, Product, Se3, So3, Translations, Unitary};
use lieflow::maps::{Exp, cay, dcayinv, dexp, dexpinv, exp};
use lieflow::methods::tableau::{DOPRI5, RK4};
use lieflow::methods::{Doubling, GAUSS4, GAUSS6, Gauss, Method, Rkmk, RkmkGauss};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::problems::Problem;
use lieflow::{Error, SaveAt, Solve};

type Shifts = Translations<Vector3<f64>>;

/// A vector of size 1e6 that turns slowly, and one of size 1e-8 that turns at the rate 3. Both are translated.
fn large_and_small(
    slow: f64,
) -> impl Problem<Group = Product<Shifts, Shifts>, Action = LeftTranslation, Work = ()> {
    let shifts = || Translations::new(Vector3::zeros(), 3);
    type Y = (Vector3<f64>, Vector3<f64>);
    boxed_flow(Product(shifts(), shifts()), LeftTranslation, move |_, y: &Y, v: &mut Y| {
        v.0 = slow * Vector3::new(-y.0.y, y.0.x, 0.0);
        v.1 = 3.0 * Vector3::new(-y.1.y, y.1.x, 0.0);
    })
}

/// The relative error of the small part after steps of one size.
fn error_of_the_small_part<P, M>(problem: &P, method: &M, steps: u64) -> f64
where
    P: Problem<Group = Product<Shifts, Shifts>, Action = LeftTranslation>,
    M: Method<P>,
{
    let start = (Vector3::new(1e6, 0.0, 0.0), Vector3::new(1e-8, 0.0, 0.0));
    let run = Solve::new(problem, method, [0.0, 3.0]).steps(steps).run(start).expect("a run");
    let (sin, cos) = 9f64.sin_cos();
    (run.y.1 - 1e-8 * Vector3::new(cos, sin, 0.0)).norm() / 1e-8
}

#[test]
fn an_implicit_step_solves_each_part() {
    for slow in [0.0, 1e-7, 1e-3] {
        let problem = large_and_small(slow);
        macro_rules! order {
            ($method:expr, $order:expr) => {
                let errors = [60, 120].map(|n| error_of_the_small_part(&problem, &$method, n));
                let order = (errors[0] / errors[1]).log2();
                assert!((order - $order).abs() < 0.2, "{slow}: {errors:?}, order {order}");
            };
        }
        order!(Gauss(GAUSS4), 4.0);
        order!(Gauss(GAUSS6), 6.0);
        order!(RkmkGauss::new(GAUSS4, Exp), 4.0);
        order!(RkmkGauss::new(GAUSS6, Exp), 6.0);
    }
}

/// A rotation that is none is refused, however large the rest of the point is; a pose far away is taken.
#[test]
fn a_rotation_is_checked_beside_a_large_vector() {
    type Y = (Matrix3<f64>, Vector3<f64>);
    let flow = boxed_flow(
        Se3::new(),
        LeftTranslation,
        |_, _: &Y, v: &mut (Vector3<f64>, Vector3<f64>)| {
            *v = (Vector3::z(), Vector3::zeros());
        },
    );
    let method = Rkmk::new(DOPRI5, Exp);
    let solve = || Solve::new(&flow, &method, [0.0, 1.0]).steps(10);
    for far in [1.0, 3e3, 7e6, 1e12] {
        let x = Vector3::new(far, 0.0, 0.0);
        solve().run((Matrix3::identity(), x)).expect("a pose");
        for wrong in [2.0 * Matrix3::identity(), Matrix3::zeros(), 1.001 * Matrix3::identity()] {
            let refused = solve().run((wrong, x)).expect_err("no pose").to_string();
            assert!(refused.contains("y: "), "{far}: {refused}");
        }
    }
}

/// The rows of steps that are doubled are steps of their own: f is called for them, and they are counted.
#[test]
fn evaluations_of_rows_are_counted() {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let flow =
        boxed_flow(So3::<f64>::new(), Linear, |t: f64, x: &Vector3<f64>, v: &mut Vector3<f64>| {
            CALLS.fetch_add(1, Ordering::Relaxed);
            *v = Vector3::new(t.cos(), x.x, 1.0);
        });
    for name in
        ["rk4", "rkmk4", "rkmk rk4 exp", "rk dopri5", "rkmk dopri5 exp", "cf4", "rkmk bs3 cay"]
    {
        let method = flow.method(&name.parse().expect("a name")).expect("a method");
        for rows in [2, 1001] {
            let times: Vec<f64> = (0..rows).map(|i| 10.0 * i as f64 / (rows - 1) as f64).collect();
            CALLS.store(0, Ordering::Relaxed);
            let solve = Solve::new(&flow, &method, [0.0, 10.0]).tolerances(1e-6, 1e-6);
            let run = solve.save(SaveAt::Times(times)).run(Vector3::x()).expect("a run");
            let (calls, stated) = (CALLS.load(Ordering::Relaxed), run.stats.evaluations);
            let stated = stated.expect("a count");
            // The check of f at the start may not be in it.
            assert!(
                stated.abs_diff(calls) <= 2,
                "{name}, {rows} rows: {stated} stated, {calls} calls"
            );
        }
        // The point in the middle of a step that is doubled is known.
        let mut run = Solve::new(&flow, &method, [0.0, 10.0])
            .tolerances(1e-6, 1e-6)
            .integrator(Vector3::x())
            .expect("a start");
        run.step().expect("a step");
        let middle = 0.5 * run.t();
        CALLS.store(0, Ordering::Relaxed);
        let (before, mut at) = (run.stats().evaluations.expect("a count"), Vector3::zeros());
        for _ in 0..20 {
            run.interpolate(middle, &mut at).expect("a point");
        }
        let stated = run.stats().evaluations.expect("a count") - before;
        assert_eq!(stated, CALLS.load(Ordering::Relaxed), "{name}");
    }
}

/// The point in the middle of a step of [`Doubling`] costs no call of f, in steps of one size, too.
#[test]
fn points_within_halves_are_counted() {
    let called = Arc::new(AtomicU64::new(0));
    let counter = called.clone();
    let flow = boxed_flow(
        So3::<f64>::new(),
        Linear,
        move |t: f64, x: &Vector3<f64>, v: &mut Vector3<f64>| {
            counter.fetch_add(1, Ordering::Relaxed);
            *v = Vector3::new(t.cos(), x.x, 1.0);
        },
    );
    let calls = || called.load(Ordering::Relaxed);
    let method = Doubling(Rkmk::new(RK4, Exp));
    let solve = || Solve::new(&flow, &method, [0.0, 10.0]);
    macro_rules! check {
        ($solve:expr) => {
            let mut run = $solve.integrator(Vector3::x()).expect("a start");
            run.step().expect("a step");
            let (h, mut at) = (run.t(), Vector3::zeros());
            for (theta, each) in [(0.25, 4), (0.5, 0), (0.75, 4)] {
                let before = (run.stats().evaluations.expect("a count"), calls());
                run.interpolate(theta * h, &mut at).expect("a point");
                let stated = run.stats().evaluations.expect("a count") - before.0;
                assert_eq!([stated, calls() - before.1], [each; 2], "at {theta}");
            }
        };
    }
    check!(solve().tolerances(1e-6, 1e-6));
    check!(solve().steps(16));
}

/// A pair of actions checks each part.
#[test]
fn parts_of_a_pair_are_checked() {
    type Y = (Matrix3<f64>, Vector3<f64>);
    let group = Product(So3::<f64>::new(), Translations::new(Vector3::zeros(), 3));
    let flow = boxed_flow(
        group,
        Pair(LeftTranslation, LeftTranslation),
        |_, _: &Y, v: &mut (Vector3<f64>, Vector3<f64>)| {
            *v = (Vector3::z(), Vector3::zeros());
        },
    );
    let method = Rkmk::new(DOPRI5, Exp);
    let run =
        |g| Solve::new(&flow, &method, [0.0, 1.0]).steps(10).run((g, Vector3::new(7e6, 0.0, 0.0)));
    run(Matrix3::identity()).expect("a point");
    run(2.0 * Matrix3::identity()).expect_err("no rotation");
}

/// Arguments of other sizes are refused, and no part of them is taken.
#[test]
fn sizes_of_arguments_are_checked() {
    let unitary = Unitary::new(2).expect("a group");
    for n in [1, 3] {
        let u = ComplexMatrix::zeros(n, n);
        let told = |error: Option<Error>| {
            let error = error.expect("another size").to_string();
            assert!(error.contains(&format!("{n}×{n}")) && error.contains("2×2"), "{error}");
        };
        told(exp(&unitary, &u).err());
        told(cay(&unitary, &u).err());
        told(dexp(&unitary, &u, &u).err());
        told(dexpinv(&unitary, &u, &u).err());
        told(dcayinv(&unitary, &u, &u).err());
    }
    let three = Power::new(So3::<f64>::new(), 3).expect("a group");
    for n in [2, 5] {
        let u: Box<[Vector3<f64>]> = vec![Vector3::z(); n].into();
        exp(&three, &u).expect_err("another number of parts");
        dexpinv(&three, &u, &u).expect_err("another number of parts");
    }
    type Numbers = Box<[f64]>;
    let numbers = |n: usize| -> Numbers { vec![1.0; n].into() };
    let group = || Translations::new(vec![0.0; 3].into_boxed_slice(), 3);
    let method = Rkmk::new(DOPRI5, Exp);
    for (y, f) in [(3, 3), (5, 3), (2, 3), (3, 2), (3, 4)] {
        let flow = boxed_flow(group(), LeftTranslation, move |_, _: &Numbers, v: &mut Numbers| {
            *v = numbers(f)
        });
        let run = Solve::new(&flow, &method, [0.0, 1.0]).steps(4).run(numbers(y));
        assert_eq!(run.is_ok(), (y, f) == (3, 3), "{y} {f}: {run:?}");
    }
    let zero = || Mat::<f64>::zeros(2, 2);
    let flow = boxed_flow(
        Translations::new(zero(), 4),
        LeftTranslation,
        |_, _: &Mat<f64>, _: &mut Mat<f64>| {},
    );
    for n in [1, 2, 3] {
        let run = Solve::new(&flow, &method, [0.0, 1.0]).steps(4).run(Mat::zeros(n, n));
        assert_eq!(run.is_ok(), n == 2, "{n}");
    }
}

/// Numbers far below 1 on one space alone have the order of the method, too: they are not compared with 1.
#[test]
fn an_implicit_step_solves_small_numbers() {
    for size in [1.0, 1e-9, 1e-15] {
        let shifts = Translations::new(Vector3::zeros(), 3);
        let flow =
            boxed_flow(shifts, LeftTranslation, |_, y: &Vector3<f64>, v: &mut Vector3<f64>| {
                *v = 3.0 * Vector3::new(-y.y, y.x, 0.0);
            });
        let start = Vector3::new(size, 0.0, 0.0);
        let (sin, cos) = 9f64.sin_cos();
        let errors = [60, 120].map(|n| {
            let method = RkmkGauss::new(GAUSS6, Exp);
            let run = Solve::new(&flow, &method, [0.0, 3.0]).steps(n).run(start).expect("a run");
            (run.y / size - Vector3::new(cos, sin, 0.0)).norm()
        });
        let order = (errors[0] / errors[1]).log2();
        assert!((order - 6.0).abs() < 0.2, "{size:e}: {errors:?}, order {order}");
    }
}
