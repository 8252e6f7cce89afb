//! Order conditions of a Runge–Kutta tableau over all rooted trees (Butcher; Hairer, Nørsett,
//! Wanner I, II.2): Σ_i b_i Φ_i(τ) = 1/γ(τ) for every τ with at most p nodes.

use lieflow::methods::Tableau;

use super::super::{EPS, Verdict, within};

/// A rooted tree as the subtrees at its root.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Tree(Vec<Tree>);

impl Tree {
    fn nodes(&self) -> usize {
        1 + self.0.iter().map(Tree::nodes).sum::<usize>()
    }

    /// γ(τ): the product of the numbers of nodes of all its subtrees.
    fn density(&self) -> f64 {
        self.nodes() as f64 * self.0.iter().map(Tree::density).product::<f64>()
    }

    /// Φ_i(τ) = ∏ over the subtrees of Σ_j a_ij Φ_j.
    fn weight<const S: usize>(&self, tableau: &Tableau<S>, i: usize) -> f64 {
        let below = |t: &Tree| (0..i).map(|j| tableau.a[i][j] * t.weight(tableau, j)).sum::<f64>();
        self.0.iter().map(below).product()
    }
}

/// All rooted trees with so many nodes.
pub(crate) fn trees(nodes: usize) -> Vec<Tree> {
    let mut all: Vec<Tree> = forests(nodes - 1).into_iter().map(Tree).collect();
    all.sort();
    all.dedup();
    all
}

/// All multisets of rooted trees with so many nodes in total.
fn forests(nodes: usize) -> Vec<Vec<Tree>> {
    if nodes == 0 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for first in 1..=nodes {
        for tree in trees(first) {
            for mut rest in forests(nodes - first) {
                rest.push(tree.clone());
                rest.sort();
                all.push(rest);
            }
        }
    }
    all
}

/// The tableau satisfies every condition up to the order that it states and not all of the next
/// one; c_i are the row sums.
pub(crate) fn order_conditions<const S: usize>(tableau: &Tableau<S>) -> Verdict {
    let name = tableau.name;
    for i in 0..S {
        let sum: f64 = tableau.a[i][..i].iter().sum();
        within(&format!("{name}: c_{} = Σ a_ij", i + 1), (sum - tableau.c[i]).abs(), 2.0 * EPS)?;
    }
    let residual = |tree: &Tree| {
        let sum: f64 = (0..S).map(|i| tableau.b[i] * tree.weight(tableau, i)).sum();
        (sum - 1.0 / tree.density()).abs()
    };
    for tree in (1..=tableau.order).flat_map(trees) {
        within(&format!("{name}: condition of {tree:?}"), residual(&tree), 4.0 * EPS)?;
    }
    match trees(tableau.order + 1).iter().any(|t| residual(t) > 1e-3) {
        true => Ok(()),
        false => Err(format!("{name}: it has a higher order than {}", tableau.order)),
    }
}

#[test]
fn rooted_trees_are_counted_right() {
    assert_eq!([1, 2, 3, 4, 5, 6].map(|n| trees(n).len()), [1, 1, 2, 4, 9, 20]); // OEIS A000081
}
