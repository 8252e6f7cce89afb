//! The order conditions of every explicit tableau, tree by tree, and of every embedded row.

use lieflow::methods::Tableau;
use lieflow::methods::tableau::{
    BS3, DOP853, DOPRI5, EULER, HEUN, MIDPOINT, RK4, RKF45, THREE_EIGHTHS, VERNER6,
};

/// A rooted tree: the trees under its root by their number, and its order and density.
struct Tree {
    under: Vec<usize>,
    order: usize,
    gamma: f64,
}

/// All rooted trees of orders 1 to `max`: 1, 1, 2, 4, 9, 20, 48, 115, 286 of them.
fn trees(max: usize) -> Vec<Tree> {
    /// All ways to choose trees numbered `from` on, with `left` nodes in all.
    fn forests(
        all: &[Tree],
        from: usize,
        left: usize,
        under: &mut Vec<usize>,
        out: &mut Vec<Vec<usize>>,
    ) {
        if left == 0 {
            out.push(under.clone());
        }
        for (i, tree) in all.iter().enumerate().skip(from) {
            if tree.order <= left {
                under.push(i);
                forests(all, i, left - tree.order, under, out);
                under.pop();
            }
        }
    }
    let mut all: Vec<Tree> = Vec::new();
    for order in 1..=max {
        let mut found = Vec::new();
        forests(&all, 0, order - 1, &mut Vec::new(), &mut found);
        for under in found {
            let gamma = order as f64 * under.iter().map(|&i| all[i].gamma).product::<f64>();
            all.push(Tree { under, order, gamma });
        }
    }
    all
}

/// The worst |Σ b_i Φ_i(t) − 1/γ(t)| over the trees of each order, relative to Σ |b_i Φ_i(t)|.
fn defects<const S: usize>(trees: &[Tree], a: &[[f64; S]; S], b: &[f64; S]) -> Vec<f64> {
    let mut phi: Vec<[f64; S]> = Vec::new();
    let mut worst = vec![0.0f64; trees.last().map_or(0, |t| t.order) + 1];
    for tree in trees {
        let mut p = [1.0; S];
        for &child in &tree.under {
            for i in 0..S {
                p[i] *= (0..S).map(|j| a[i][j] * phi[child][j]).sum::<f64>();
            }
        }
        let (mut sum, mut size) = (0.0, 1.0f64);
        for i in 0..S {
            sum += b[i] * p[i];
            size = size.max((b[i] * p[i]).abs());
        }
        phi.push(p);
        worst[tree.order] = worst[tree.order].max((sum - 1.0 / tree.gamma).abs() / size);
    }
    worst
}

/// A row has exactly this order: the conditions hold up to it, and one of the next order fails.
fn assert_order<const S: usize>(what: &str, a: &[[f64; S]; S], b: &[f64; S], order: usize) {
    let found = defects(&trees(order + 1), a, b);
    // Rounding of the coefficients: S² products of a size that the defect is relative to.
    let tolerance = 8.0 * f64::EPSILON * (S * S) as f64;
    let held = found.iter().skip(1).take_while(|d| **d <= tolerance).count();
    assert_eq!(held, order, "{what}: {found:?}");
}

fn check<const S: usize>(t: &Tableau<S>) {
    assert_order(t.name, &t.a, &t.b, t.order);
    for i in 0..S {
        assert!(t.a[i][i..].iter().all(|a| *a == 0.0), "{}: not explicit", t.name);
        let sum: f64 = t.a[i].iter().sum();
        let size: f64 = t.a[i].iter().map(|a| a.abs()).sum();
        assert!((sum - t.c[i]).abs() <= 4.0 * f64::EPSILON * size.max(1.0), "{}: c[{i}]", t.name);
    }
    assert!(t.update_stages() <= S && t.b[t.update_stages() - 1] != 0.0);
    assert!(t.b[t.update_stages()..].iter().all(|b| *b == 0.0));
    if let Some(error) = t.error {
        let hat = |e: [f64; S]| core::array::from_fn::<f64, S, _>(|j| t.b[j] - e[j]);
        let order = if error.damp.is_some() { 5 } else { error.order };
        assert_order(&format!("{}, embedded", t.name), &t.a, &hat(error.e), order);
        assert!(error.order < t.order);
        if let Some(damp) = error.damp {
            assert_order(&format!("{}, damping", t.name), &t.a, &hat(damp), 3);
        }
    }
}

#[test]
fn every_tableau_has_its_order_and_no_more() {
    check(&EULER);
    check(&MIDPOINT);
    check(&HEUN);
    check(&RK4);
    check(&THREE_EIGHTHS);
    check(&BS3);
    check(&RKF45);
    check(&DOPRI5);
    check(&VERNER6);
    check(&DOP853);
}

#[test]
fn the_trees_are_all_there() {
    let all = trees(9);
    let count = |order| all.iter().filter(|t| t.order == order).count();
    assert_eq!((1..=9).map(count).collect::<Vec<_>>(), [1, 1, 2, 4, 9, 20, 48, 115, 286]);
}

#[test]
fn a_wrong_coefficient_is_seen() {
    let mut broken = DOPRI5;
    broken.a[3][1] += 1e-12;
    let found = defects(&trees(5), &broken.a, &broken.b);
    assert!(found.iter().any(|d| *d > 1e-13), "{found:?}");
}
