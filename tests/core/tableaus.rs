//! The order conditions of every tableau of the catalog, tree by tree, and of every embedded row.

use crate::support::orders::{order_conditions, row_conditions};
use lieflow::catalog::TABLEAUS;
use lieflow::maps::Exp;
use lieflow::methods::tableau::{Tableau, order_defects};
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
    for (wrong, says) in [
        (
            Tableau { b: [0.5, 0.5, 0.25, 0.25], ..rk4 },
            "Σ b[j] of the tableau `rk4` = 1.5, expected 1",
        ),
        (Tableau { b: [0.5, 0.0, 0.0, 0.5], ..rk4 }, "order of the tableau `rk4` = 4"),
        (c, "c[3] of the tableau `rk4` = 0.4, expected"),
        (implicit, "a[2,2] of the tableau `rk4` = 0.1, expected 0"),
        (nan, "Σ b[j] of the tableau `rk4` = NaN, expected 1"),
    ] {
        let error = wrong.check().unwrap_err();
        assert!(matches!(error, Error::OutOfRange { .. }));
        assert!(error.to_string().contains(says), "{error}");
        let body = lieflow::problems::RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
        let refused = Rk(wrong).work(&body, &nalgebra::Vector3::x()).err();
        let is_seen = cfg!(debug_assertions) || !says.starts_with("order");
        assert_eq!(refused.map(|e| e.to_string()), is_seen.then(|| error.to_string()), "{says}");
        let on_group = Solve::new(&body, &Rkmk::new(wrong, Exp), [0.0, 1.0])
            .dt(0.5)
            .run(nalgebra::Vector3::x());
        let refused = matches!(on_group, Err(e) if e.error.to_string() == error.to_string());
        assert_eq!(refused, is_seen, "{says}");
    }
}
