//! The order conditions of every tableau of the catalog, tree by tree, and of every embedded row.

use crate::support::orders::{order_conditions, row_conditions};
use lieflow::catalog::TABLEAUS;
use lieflow::maps::Exp;
use lieflow::methods::low_storage::TwoN;
use lieflow::methods::tableau::{Dense, ErrorEstimate, Tableau, order_defects};
use lieflow::methods::{Rk, Rkmk, tableau};
use lieflow::{Error, Method, Solve};

fn check<const S: usize>(t: &Tableau<S>) {
    order_conditions(t).unwrap();
    assert!(t.update_stages() <= S && t.b[t.update_stages() - 1] != 0.0);
    assert!(t.b[t.update_stages()..].iter().all(|b| *b == 0.0));
    if let Some(error) = t.error {
        let hat = |e: [f64; S]| core::array::from_fn::<f64, S, _>(|j| t.b[j] - e[j]);
        let order = if error.damp.is_some() { 5 } else { error.order };
        row_conditions(&format!("{}, embedded", t.name), &t.a, &hat(error.e), order).unwrap();
        assert!(error.order < t.order);
        if let Some(damp) = error.damp {
            row_conditions(&format!("{}, damping", t.name), &t.a, &hat(damp), 3).unwrap();
        }
    }
}

#[test]
fn every_tableau_has_its_order_and_no_more() {
    let mut names = Vec::new();
    macro_rules! check_all {
        ($($tableau:ident)*) => {$(
            check(&tableau::$tableau);
            names.push(tableau::$tableau.name);
        )*};
    }
    check_all!(EULER MIDPOINT HEUN RK4 THREE_EIGHTHS BS3 RKF45 DOPRI5 VERNER6 DOP853);
    let listed: Vec<_> = TABLEAUS.iter().map(|t| t.name).collect();
    assert_eq!(names, listed, "a tableau of the catalog is not checked here");
}

/// The order conditions of a method with low storage, to the rounding of its coefficients.
fn check_low_storage<const S: usize>(table: &TwoN<S>) {
    // u ← u + b_i d_i with d_i = a_i d_{i−1} + h f_i, as a tableau: the rows are u before each stage.
    let (mut a, mut b, mut d) = ([[0.0; S]; S], [0.0; S], [0.0; S]);
    for i in 0..S {
        a[i] = b;
        d = d.map(|x| table.a[i] * x);
        d[i] += 1.0;
        b = core::array::from_fn(|j| b[j] + table.b[i] * d[j]);
    }
    let largest = table.a.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
    let defects = order_defects(table.order, &a, &b);
    let worst = defects.iter().fold(0.0, |most: f64, defect| most.max(defect.abs()));
    assert!(worst < 1e-15 * largest, "{}: {worst:e}", table.name);
    let times = a.iter().zip(table.c).map(|(row, c)| (row.iter().sum::<f64>() - c).abs());
    assert!(times.fold(0.0, f64::max) < 1e-15 * largest, "{}: {:?}", table.name, table.c);
}

#[test]
fn low_storage_methods_have_their_order_to_rounding() {
    use lieflow::methods::low_storage::{EES25, EES27, LS3, LS3_BP, LS4, LS5, LS32};
    macro_rules! check_all {
        ($($table:ident)*) => { $(check_low_storage(&$table);)* };
    }
    check_all!(EES25 EES27 LS3 LS3_BP LS32 LS4 LS5);
}

#[test]
fn a_wrong_coefficient_is_seen() {
    let mut broken = tableau::DOPRI5;
    broken.a[3][1] += 1e-12;
    let found = order_defects(5, &broken.a, &broken.b);
    assert!(found.iter().any(|d| *d > 1e-13), "{found:?}");
    assert!(row_conditions("broken", &broken.a, &broken.b, 5).is_err());
}

/// A user's tableau that is wrong is an error: by a call, and before a run. A release build does not look at the order.
#[test]
fn a_wrong_tableau_is_refused() {
    let rk4 = tableau::RK4;
    let (mut c, mut implicit, mut nan) = (rk4, rk4, rk4);
    (c.c[2], implicit.a[1][1], nan.b[0]) = (0.4, 0.1, f64::NAN);
    let end = |end| Tableau { dense: Dense::Cubic { order: 2, end }, ..rk4 };
    let error = |order, e| Tableau { error: Some(ErrorEstimate { order, e, damp: None }), ..rk4 };
    for (wrong, says) in [
        (
            Tableau { b: [0.5, 0.5, 0.25, 0.25], ..rk4 },
            "Σ b[j] of the tableau `rk4` = 1.5, expected 1",
        ),
        (Tableau { b: [0.5, 0.0, 0.0, 0.5], ..rk4 }, "order of the tableau `rk4` = 4"),
        (c, "c[3] of the tableau `rk4` = 0.4, expected"),
        (implicit, "a[2,2] of the tableau `rk4` = 0.1, expected 0"),
        (nan, "Σ b[j] of the tableau `rk4` = NaN, expected 1"),
        (end(&[0.0, 0.0, 0.0, 0.5]), "Σ dense.end[j] of the tableau `rk4` = 0.5, expected 1"),
        (
            end(&[0.0, 0.0, 0.0, 0.0, 1.0]),
            "dense.end of the tableau `rk4` = 5, expected at most 4 weights",
        ),
        (error(3, [0.5, 0.0, 0.0, 0.0]), "Σ error.e[j] of the tableau `rk4` = 0.5, expected 0"),
        (
            error(3, [0.0; 4]),
            "error.e of the tableau `rk4` = 0, expected weights that are not all 0",
        ),
        (
            error(2, [0.5, -0.5, 0.0, 0.0]),
            "error.order of the tableau `rk4` = 2, expected at most 1",
        ),
    ] {
        let error = wrong.check().unwrap_err();
        assert!(matches!(error, Error::OutOfRange { .. }));
        assert!(error.to_string().contains(says), "{error}");
        let body = lieflow::problems::RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
        let refused = Rk(wrong).work(&body, &nalgebra::Vector3::x()).err();
        let of_order = says.starts_with("order") || says.starts_with("error.order");
        let is_seen = cfg!(debug_assertions) || !of_order;
        assert_eq!(refused.map(|e| e.to_string()), is_seen.then(|| error.to_string()), "{says}");
        let on_group = Solve::new(&body, &Rkmk::new(wrong, Exp), [0.0, 1.0])
            .dt(0.5)
            .run(nalgebra::Vector3::x());
        let refused = matches!(on_group, Err(e) if e.error.to_string() == error.to_string());
        assert_eq!(refused, is_seen, "{says}");
    }
}
