//! Table 2: operations of the maps on so(3), by running the library's formulas on a number that
//! counts.

use lieflow::groups::{LieGroup, So3};
use lieflow::maps::{CCSK123, Cay, CoordinateMap, Exp};
use lieflow::scalar::{Counted, Ops, Real};
use lieflow::{Error, StepError, so3};
use nalgebra::Vector3;

/// The operations of one column of Table 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count {
    /// The map.
    pub map: &'static str,
    /// Ψ, dΨ⁻¹ or both.
    pub part: &'static str,
    /// Of Ψ(u) as a matrix, of dΨ_u⁻¹v on its own, of the second after the first.
    pub ops: Ops,
}

impl Count {
    /// The operations of the product of the matrix dΨ⁻¹ with a vector, which the paper leaves out of
    /// its table: 15, and 10 for the sparse matrix of ccsk.
    pub fn product(&self) -> u64 {
        match (self.part, self.map) {
            ("Ψ", _) => 0,
            (_, "ccsk") => 10,
            _ => 15,
        }
    }
}

fn vector(x: [f64; 3]) -> Vector3<Counted> {
    Vector3::from(x.map(Counted::lit))
}

/// |u| > π: the formulas of the paper, with their root, sine and cosine, and no polynomials.
const U: [f64; 3] = [1.2, -1.0, 3.0];
const V: [f64; 3] = [1.0, 2.0, 3.0];

type Differential = fn(&Vector3<Counted>, &Vector3<Counted>) -> Result<Vector3<Counted>, StepError>;

fn columns<Psi: CoordinateMap<So3<Counted>>>(
    map: &'static str,
    psi: Psi,
    inverse: Differential,
) -> Result<[Count; 3], Error> {
    let group = So3::<Counted>::new();
    let u = vector(U);
    let (mut at, mut g, mut v) = (psi.at(&group)?, group.identity(), vector(V));
    let (done, formed) = Counted::count(|| psi.psi(&group, &u, &mut at, &mut g));
    done?;
    let (done, after) = Counted::count(|| psi.dpsi_inv(&group, &u, &mut at, &mut v));
    done?;
    let (done, alone) = Counted::count(|| inverse(&u, &vector(V)));
    done?;
    Ok([
        Count { map, part: "Ψ", ops: formed },
        Count { map, part: "dΨ⁻¹", ops: alone },
        Count { map, part: "both", ops: formed + after },
    ])
}

/// Every column, map by map.
pub fn table2() -> Result<Vec<Count>, Error> {
    let maps = [
        columns("exp", Exp, so3::dexpinv)?,
        columns("ccsk", CCSK123, so3::dccskinv::<_, 0, 1, 2>)?,
        columns("cay", Cay, so3::dcayinv)?,
    ];
    Ok(maps.into_iter().flatten().collect())
}
