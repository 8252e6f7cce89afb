//! The order harness: test problems, a reference that owes nothing to the methods, and an estimator
//! that is told the grid before it sees an error.

mod estimate;
mod flow;
mod tree;

pub(crate) use estimate::{Estimate, estimate, grid};
pub(crate) use flow::{Flow, Reference, inertia, measure, measure_as, reference, wave};
pub(crate) use tree::order_conditions;

use lieflow::catalog::{MAPS, METHODS, MethodSpec, TABLEAUS};

/// Where the tests cut the Baker series.
const CUTS: [usize; 3] = [0, 1, 2];

/// Every method of the catalog with every tableau, map and cut that it takes.
pub(crate) fn catalog() -> Vec<MethodSpec> {
    let mut specs = Vec::new();
    for method in METHODS {
        let tableaus = match method.takes_tableau {
            true => TABLEAUS.iter().map(|&t| Some(t)).collect(),
            false => vec![None],
        };
        let maps: Vec<_> = match method.takes_map {
            true => (MAPS.iter().map(|m| (Some(m.name), None)))
                .chain(CUTS.map(|q| (Some("exp"), Some(q))))
                .collect(),
            false => vec![(None, None)],
        };
        for tableau in tableaus {
            for &(map, q) in &maps {
                let tableau = tableau.map(Into::into);
                specs.push(MethodSpec { tableau, q, ..MethodSpec::new(method.name, map) });
            }
        }
    }
    specs
}
