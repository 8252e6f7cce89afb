//! What the equations on the duals of all algebras share: what is given and their quantities.

use lieflow::groups::GroupMatrix;

use crate::formula::Text;
use crate::kinds::entries::rows;
use crate::kinds::prelude::*;
use crate::problem::{FormulaKeys, PointOf};
use crate::reader::values::Numbers;

/// The keys of an equation, besides its algebra.
#[derive(Debug)]
pub(super) struct Given {
    pub(super) names: FormulaKeys,
    pub(super) hamiltonian: Key<Option<Text>>,
    pub(super) inverse_inertia: Key<Option<Table>>,
    pub(super) momentum: Key<Numbers>,
}

/// An energy on the dual of an algebra.
pub(super) trait Dual {
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
pub(super) trait OnDual: System {
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
pub(super) const fn quantities<S: OnDual>() -> [Quantity<S>; 5] {
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
