//! The order harness: test problems, a reference that owes nothing to the methods, and an estimator
//! that is told the grid before it sees an error.

mod ensemble;
mod estimate;
mod flow;
mod tree;

pub(crate) use ensemble::{LONG, MEMBERS, measure_over};
pub(crate) use estimate::{Estimate, estimate, grid, slopes};
pub(crate) use flow::{
    Field, Flow, Reference, clock, family, inertia, measure, measure_as, reference,
    reference_after, wave,
};
pub(crate) use tree::{defects, order_conditions, row_conditions};

use lieflow::catalog::{MAPS, METHODS, MethodSpec, TABLEAUS};

/// Where the tests cut the Baker series: q = p − 2 keeps the order, a smaller q leaves q + 2.
fn cuts(tableau: &str) -> &'static [usize] {
    match tableau {
        "rkf45" | "dopri5" => &[3],
        "verner6" => &[4],
        "dop853" => &[6],
        _ => &[0, 1, 2],
    }
}

/// Every method of the catalog with every tableau, map and cut that it takes.
pub(crate) fn catalog() -> Vec<MethodSpec> {
    let mut specs = Vec::new();
    for method in METHODS {
        let tableaus = match method.takes_tableau {
            true => TABLEAUS.iter().copied().map(Some).collect(),
            false => vec![None],
        };
        for tableau in tableaus {
            let maps: Vec<_> = match method.takes_map {
                true => (MAPS.iter().map(|m| (Some(m.name), None)))
                    .chain(cuts(tableau.unwrap_or("rk4")).iter().map(|&q| (Some("exp"), Some(q))))
                    .collect(),
                false => vec![(None, None)],
            };
            for &(map, q) in &maps {
                let tableau = tableau.map(Into::into);
                specs.push(MethodSpec { tableau, q, ..MethodSpec::new(method.name, map) });
            }
        }
    }
    specs
}
