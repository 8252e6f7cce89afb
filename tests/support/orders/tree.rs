//! Order conditions of a Runge–Kutta tableau over all rooted trees (Butcher; Hairer, Nørsett,
//! Wanner I, II.2): Σ_i b_i Φ_i(τ) = 1/γ(τ) for every τ with at most p nodes.

use lieflow::methods::Tableau;

use super::super::{EPS, Verdict};

/// A rooted tree: the trees at its root by their numbers in the list, its nodes and its density γ.
struct Tree {
    under: Vec<usize>,
    nodes: usize,
    density: f64,
}

/// All rooted trees of 1 to `max` nodes, the smaller ones first.
fn trees(max: usize) -> Vec<Tree> {
    /// All ways to choose trees from number `from` on, with `left` nodes in all.
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
            if tree.nodes <= left {
                under.push(i);
                forests(all, i, left - tree.nodes, under, out);
                under.pop();
            }
        }
    }
    let mut all: Vec<Tree> = Vec::new();
    for nodes in 1..=max {
        let mut found = Vec::new();
        forests(&all, 0, nodes - 1, &mut Vec::new(), &mut found);
        for under in found {
            let density = nodes as f64 * under.iter().map(|&i| all[i].density).product::<f64>();
            all.push(Tree { under, nodes, density });
        }
    }
    all
}

/// The worst |Σ b_i Φ_i(τ) − 1/γ(τ)| over the trees of each number of nodes from 1 on, relative to the
/// largest |b_i Φ_i(τ)|, at least 1.
pub(crate) fn defects<const S: usize>(max: usize, a: &[[f64; S]; S], b: &[f64; S]) -> Vec<f64> {
    let mut weights: Vec<[f64; S]> = Vec::new();
    let mut worst = vec![0.0f64; max];
    for tree in trees(max) {
        let mut phi = [1.0; S];
        for &child in &tree.under {
            for i in 0..S {
                phi[i] *= (0..S).map(|j| a[i][j] * weights[child][j]).sum::<f64>();
            }
        }
        let (mut sum, mut size) = (0.0, 1.0f64);
        for i in 0..S {
            sum += b[i] * phi[i];
            size = size.max((b[i] * phi[i]).abs());
        }
        weights.push(phi);
        let worst = &mut worst[tree.nodes - 1];
        *worst = worst.max((sum - 1.0 / tree.density).abs() / size);
    }
    worst
}

/// The row b with the stages a has exactly this order: the conditions hold up to it, and one of the
/// next order fails.
pub(crate) fn row_conditions<const S: usize>(
    name: &str,
    a: &[[f64; S]; S],
    b: &[f64; S],
    order: usize,
) -> Verdict {
    let found = defects(order + 1, a, b);
    // Rounding of the coefficients: S² products of a size that the defect is relative to.
    let tolerance = 8.0 * EPS * (S * S) as f64;
    match found.iter().take_while(|d| **d <= tolerance).count() {
        held if held < order => Err(format!("{name}: a condition of order {} fails", held + 1)),
        held if held > order => Err(format!("{name}: it has a higher order than {order}")),
        _ => Ok(()),
    }
}

/// A tableau is explicit, its c_i are the row sums, and its b has exactly the order that it states.
pub(crate) fn order_conditions<const S: usize>(t: &Tableau<S>) -> Verdict {
    for i in 0..S {
        if t.a[i][i..].iter().any(|a| *a != 0.0) {
            return Err(format!("{}: row {} is not explicit", t.name, i + 1));
        }
        let sum: f64 = t.a[i].iter().sum();
        let size: f64 = t.a[i].iter().map(|a| a.abs()).sum();
        if (sum - t.c[i]).abs() > 4.0 * EPS * size.max(1.0) {
            return Err(format!("{}: c_{} is not Σ a_ij", t.name, i + 1));
        }
    }
    row_conditions(t.name, &t.a, &t.b, t.order)
}

/// How many rooted trees there are with 1, 2, … nodes.
pub(crate) fn tree_counts(nodes: usize) -> Vec<usize> {
    let all = trees(nodes);
    (1..=nodes).map(|n| all.iter().filter(|t| t.nodes == n).count()).collect()
}
