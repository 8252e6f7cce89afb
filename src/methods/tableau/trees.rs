//! Rooted trees. Each one is a condition of order.

/// A rooted tree: the numbers of the trees at its root, its number of nodes, and its density γ.
pub(super) struct Tree {
    pub(super) under: Vec<usize>,
    pub(super) nodes: usize,
    pub(super) density: f64,
}

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

/// All rooted trees of 1 to `max` nodes, the smaller ones first.
pub(super) fn trees(max: usize) -> Vec<Tree> {
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

#[cfg(test)]
mod tests {
    use super::trees;

    #[test]
    fn rooted_trees_are_all_there() {
        let all = trees(9);
        let counts = (1..=9).map(|n| all.iter().filter(|tree| tree.nodes == n).count());
        assert_eq!(counts.collect::<Vec<_>>(), [1, 1, 2, 4, 9, 20, 48, 115, 286]); // OEIS A000081
    }
}
