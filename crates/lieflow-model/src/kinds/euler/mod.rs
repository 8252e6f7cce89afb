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

use lieflow::groups::GroupMatrix;
use lieflow::names::plain;

use self::group::WithGroup;
use self::vectors::Vectors;
use super::algebra::{ALGEBRAS, Algebra};
use super::entries::rows;
use super::prelude::*;
use crate::formula::Text;
use crate::problem::PointOf;
use crate::reader::values::Numbers;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "euler",
    equation: "ṁ = P(ξᵀm − mξᵀ), ξ = P(∂H/∂m) or P(W ∘ m), P the orthogonal projection on the algebra; on so3 \
               ṁ = m × ∂H/∂m, on se3 ṁ = m × ∂H/∂m + p × ∂H/∂p, ṗ = p × ∂H/∂m",
    summary: "Euler's equations of any energy on the dual of so(n), sl(n), gl(n), sp(2m), so(p,q), so3 or se3",
    ..Kind::of::<Keys, WithGroup>(|section| read(Read::read(section)?))
};

keys! { Keys [formula_keys] {
    algebra: String =
        "\"so\", \"sl\", \"gl\", \"sp\" or \"so(p,q)\" of matrices; \"so3\" or \"se3\" of vectors",
    hamiltonian: Option<Text> =
        "the energy as a formula in the momentum: m11, m12, ..., mnn, n at most 9; m1, m2, m3 on so3; m1, m2, m3, \
         p1, p2, p3 on se3; or inverse_inertia",
    inverse_inertia: Option<Table> =
        "a quadratic energy, for matrices: n×n weights, symmetric for so; the gradient of the energy is the part in \
         the algebra of the momentum times them, entry by entry",
    momentum: Numbers = "initial momentum, n×n in the algebra, of so also the n(n-1)/2 entries above the diagonal, row by \
         row; 3 numbers on so3, 6 on se3",
} }

fn read(keys: Keys) -> Result<Box<dyn ProblemSpec>, ReadError> {
    match (plain(&keys.algebra).as_str(), Algebra::named(&keys.algebra)) {
        ("so3", _) => Ok(Box::new(Stated(Vectors::<3>::read(keys)?))),
        ("se3", _) => Ok(Box::new(Stated(Vectors::<6>::read(keys)?))),
        (_, Some(named)) => Ok(matrices::on(named, keys)?),
        (_, None) => {
            let names = [&ALGEBRAS[..], &["so3", "se3"]].concat();
            Err(Refusal::unknown("algebra", &keys.algebra, &names).into())
        }
    }
}

/// An energy on the dual of an algebra.
trait Dual {
    /// m.
    type Momentum;

    /// The columns of m, and of the Casimirs.
    fn columns(&self) -> [Vec<String>; 2];
    /// The degrees of the energy and of the Casimirs as polynomials; 0 where they are none, or of many degrees.
    fn degrees(&self) -> [u32; 2];
    /// The entries of m go to the end of the row.
    fn entries(m: &Self::Momentum, row: &mut Vec<f64>);
    /// H(m).
    fn energy(&self, m: &Self::Momentum) -> f64;
    /// The size of the terms that H(m) is the sum of.
    fn energy_terms(&self, m: &Self::Momentum) -> f64;
    /// The Casimirs go to the end of the row.
    fn casimirs(m: &Self::Momentum, row: &mut Vec<f64>);
    /// The size of the terms that they are the sums of.
    fn casimir_terms(m: &Self::Momentum) -> f64;
}

/// A system that moves the momentum, and g where it is asked for.
trait OnDual: System {
    /// The energy.
    type Dual: Dual;
    /// Why there is no g.
    const WITHOUT_G: Option<&'static str> = Some("the motion of g is integrated for matrices only");

    fn dual(&self) -> &Self::Dual;
    /// m.
    fn momentum(y: &PointOf<Self>) -> &<Self::Dual as Dual>::Momentum;
    /// The columns of g and of the momentum in space.
    fn group_columns(&self) -> [Vec<String>; 2] {
        Default::default()
    }
    /// g.
    fn group(_: &PointOf<Self>) -> Option<&GroupMatrix> {
        None
    }
    /// Ad*_{g⁻¹} m.
    fn in_space(&self, _: &PointOf<Self>) -> Option<Mat<f64>> {
        None
    }
    /// The size of the terms that it is the sum of.
    fn in_space_terms(_: &PointOf<Self>) -> f64 {
        f64::NAN
    }
}

/// The quantities of each Euler equation.
const fn quantities<S: OnDual>() -> [Quantity<S>; 5] {
    [
        Quantity::numbers(
            "momentum",
            &["m11", "…", "mnn"],
            "momentum, row by row; m1, m2, m3 on so3, and p1, p2, p3 on se3",
            |_, _, y, row| S::Dual::entries(S::momentum(y), row),
        )
        .with_columns(|system: &S| system.dual().columns()[0].clone()),
        Quantity::number("energy", "the energy", |system: &S, _, y| {
            system.dual().energy(S::momentum(y))
        })
        .kept_where(|system| Some(Law::by_the_flow(system.dual().degrees()[0])))
        .in_terms(|system, y| system.dual().energy_terms(S::momentum(y))),
        Quantity::numbers(
            "casimirs",
            &["trm1", "…", "trmn"],
            "traces of the powers of the momentum; m·m on so3, p·p and m·p on se3",
            |_, _, y, row| S::Dual::casimirs(S::momentum(y), row),
        )
        .with_columns(|system: &S| system.dual().columns()[1].clone())
        .kept_where(|system| Some(Law::by_the_action(system.dual().degrees()[1])))
        .in_terms(|_, y| S::Dual::casimir_terms(S::momentum(y))),
        Quantity::numbers(
            "group",
            &["g11", "…", "gnn"],
            "g with the velocity g grad H, from the identity, row by row; integrated only when asked for, for \
             matrices",
            |_, _, y, row| row.extend(S::group(y).into_iter().flat_map(|g| rows(g))),
        )
        .with_columns(|system: &S| system.group_columns()[0].clone())
        .missing_where(|_| S::WITHOUT_G),
        Quantity::numbers(
            "momentum_space",
            &["s11", "…", "snn"],
            "the momentum in space, Ad* of the inverse of g, row by row; needs g, which is then integrated",
            |system: &S, _, y, row| row.extend(system.in_space(y).iter().flat_map(rows)),
        )
        .with_columns(|system| system.group_columns()[1].clone())
        .kept(Law::by_the_action(0))
        .in_terms(|_, y| S::in_space_terms(y))
        .missing_where(|_| S::WITHOUT_G),
    ]
}
