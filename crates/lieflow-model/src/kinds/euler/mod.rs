//! `kind = "euler"`: Euler's equations ṁ = ad*_ξ m, ξ = ∇H(m), on the dual of an algebra; see
//! [`Euler`](lieflow::problems::Euler).
//!
//! | algebra | m | ⟨m, v⟩ | Casimirs |
//! |---|---|---|---|
//! | so, sl, gl, sp, so(p,q) | a matrix in the algebra | tr(mᵀv) | tr mᵏ |
//! | so3 | (m₁, m₂, m₃) | m·v | \|m\|² |
//! | se3 | (m, p), six numbers | m·ω + p·v | \|p\|², m·p |
//!
//! H is ½⟨m, π(W ∘ m)⟩ with weights W and the projection π on the algebra, or a formula in the entries of
//! m; that is H(π(m)), so that it is the same for all matrices that are the same functional, and
//! ∇H = π(∂H(π(m))). Invariants: H and the Casimirs.

mod energy;
mod group;
mod matrices;
mod vectors;

use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::algebra::{ALGEBRAS, Algebra};
use super::{KeyInfo, Kind, PARAMETERS, ProblemSpec, QuantityInfo};
use crate::scene::ReadError;
use crate::scene::formula::Parameters;
use crate::scene::values::{Numbers, Table};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "euler",
    equation: "ṁ = P(ξᵀm − mξᵀ), ξ = P(∂H/∂m) or P(W ∘ m), P the orthogonal projection on the algebra; on so3 \
               ṁ = m × ∂H/∂m, on se3 ṁ = m × ∂H/∂m + p × ∂H/∂p, ṗ = p × ∂H/∂m",
    summary: "Euler's equations of any energy on the dual of so(n), sl(n), gl(n), sp(2m), so(p,q), so3 or se3",
    keys: &[
        KeyInfo {
            name: "algebra",
            meaning: "\"so\", \"sl\", \"gl\", \"sp\" or \"so(p,q)\" of matrices; \"so3\" or \"se3\" of vectors",
        },
        KeyInfo {
            name: "hamiltonian",
            meaning: "the energy as a formula in the momentum: m11, m12, ..., mnn, n at most 9; m1, m2, m3 on \
                      so3; m1, m2, m3, p1, p2, p3 on se3; or inverse_inertia",
        },
        KeyInfo {
            name: "inverse_inertia",
            meaning: "a quadratic energy, for matrices: n×n weights, symmetric for so; the gradient of the \
                      energy is the part in the algebra of the momentum times them, entry by entry",
        },
        KeyInfo {
            name: "momentum",
            meaning: "initial momentum, n×n in the algebra; 3 numbers on so3, 6 on se3",
        },
        PARAMETERS,
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "momentum",
                columns: &["m11", "…", "mnn"],
                meaning: "momentum, row by row; m1, m2, m3 on so3, and p1, p2, p3 on se3",
            },
            QuantityInfo { name: "energy", columns: &["energy"], meaning: "the energy" },
            QuantityInfo {
                name: "casimirs",
                columns: &["trm1", "…", "trmn"],
                meaning: "traces of the powers of the momentum; m·m on so3, p·p and m·p on se3",
            },
            QuantityInfo {
                name: "group",
                columns: &["g11", "…", "gnn"],
                meaning: "g with the velocity g grad H, from the identity, row by row; integrated only when \
                      asked for, for matrices",
            },
            QuantityInfo {
                name: "momentum_space",
                columns: &["s11", "…", "snn"],
                meaning: "the momentum in space, Ad* of the inverse of g, row by row; needs g, which is then \
                      integrated",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    algebra: String,
    hamiltonian: Option<String>,
    inverse_inertia: Option<Table>,
    momentum: Numbers,
    #[serde(default)]
    parameters: Parameters,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    match (keys.algebra.as_str(), Algebra::named(&keys.algebra)) {
        ("so3", _) => Ok(vectors::on_so3(keys)?),
        ("se3", _) => Ok(vectors::on_se3(keys)?),
        (_, Some(algebra)) => Ok(matrices::on(algebra, keys)?),
        (name, None) => {
            let names = [&ALGEBRAS[..], &["so3", "se3"]].concat();
            Err(Algebra::unknown("algebra", name, &names).into())
        }
    }
}
