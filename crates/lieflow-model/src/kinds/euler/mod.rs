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

mod dual;
mod energy;
mod group;
mod matrices;
mod vectors;

use lieflow::names::plain;

use self::dual::Given;
use self::group::WithGroup;
use self::vectors::Vectors;
use super::algebra::{Algebra, REAL_ALGEBRAS};
use super::prelude::*;
use crate::formula::Text;
use crate::reader::values::Numbers;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "euler",
    equation: "ṁ = P(ξᵀm − mξᵀ), ξ = P(∂H/∂m) or P(W ∘ m), P the orthogonal projection on the algebra; on so3 \
               ṁ = m × ∂H/∂m, on se3 ṁ = m × ∂H/∂m + p × ∂H/∂p, ṗ = p × ∂H/∂m",
    summary: "Euler's equations of any energy on the dual of so(n), sl(n), gl(n), sp(2m), so(p,q), so3 or se3",
    ..Kind::of::<Keys, WithGroup>(|section| read_with(section, read))
};

keys! { Keys [formula_keys] {
    algebra: String =
        "\"so\", \"sl\", \"gl\", \"sp\" or \"so(p,q)\" of matrices; \"so3\" or \"se3\" of vectors",
    hamiltonian: Option<Text> =
        "the energy as a formula in the momentum: m11, m12, ..., mnn, n at most 9; m1, m2, m3 on so3; m1, m2, m3, \
         p1, p2, p3 on se3; or inverse_inertia",
    inverse_inertia: Option<Table> =
        "a quadratic energy, for matrices: n×n weights, of which so takes the symmetric part; the gradient of the energy \
         is the part in the algebra of the momentum times them, entry by entry",
    momentum: Numbers = "initial momentum, n×n in the algebra, of so also the n(n-1)/2 entries above the diagonal, row by \
         row; 3 numbers on so3, 6 on se3",
} }

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let names = keys.formula_keys();
    let Keys { algebra, hamiltonian, inverse_inertia, momentum, .. } = keys;
    let (algebra, given) = (algebra?, Given { names, hamiltonian, inverse_inertia, momentum });
    match (plain(&algebra).as_str(), Algebra::real_named(&algebra)) {
        ("so3", _) => Ok(Forms::of(Vectors::<3>::read(&algebra, given)?)),
        ("se3", _) => Ok(Forms::of(Vectors::<6>::read(&algebra, given)?)),
        (_, Some(named)) => Ok(matrices::on(named, given)?),
        (_, None) => {
            let names = [REAL_ALGEBRAS, &["so3", "se3"]].concat();
            Err(Refusal::unknown("algebra", &algebra, &names).into())
        }
    }
}
