//! The order conditions of every tableau of the catalog, tree by tree, and of every embedded row.

use crate::support::orders::{defects, order_conditions, row_conditions, tree_counts};
use lieflow::catalog::TABLEAUS;
use lieflow::methods::{Tableau, tableau};

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
    let found = defects(5, &broken.a, &broken.b);
    assert!(found.iter().any(|d| *d > 1e-13), "{found:?}");
    assert!(row_conditions("broken", &broken.a, &broken.b, 5).is_err());
}

#[test]
fn rooted_trees_are_all_there() {
    assert_eq!(tree_counts(9), [1, 1, 2, 4, 9, 20, 48, 115, 286]); // OEIS A000081
}
