//! What stays constant along a solution, by name: a run reports the drift of each.

use super::{PointOf, Problem, ScalarOf};

/// Why a quantity is constant, which says what keeps it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// It is constant on the orbits of the action: a Casimir, an eigenvalue, a length. Every method
    /// that acts by the group keeps it to rounding.
    ByTheAction,
    /// It is a first integral of this flow: the energy. A method keeps it to its own accuracy, or to
    /// rounding where it is built to.
    ByTheFlow,
}

/// A quantity that the exact solution keeps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Invariant {
    /// Its name, as in reports.
    pub name: String,
    /// What keeps it.
    pub kept: Kept,
}

impl Invariant {
    /// One that every method that acts by the group keeps.
    pub fn of_the_action(name: impl Into<String>) -> Self {
        Invariant { name: name.into(), kept: Kept::ByTheAction }
    }
    /// One of this flow.
    pub fn of_the_flow(name: impl Into<String>) -> Self {
        Invariant { name: name.into(), kept: Kept::ByTheFlow }
    }
}

/// A capability: a problem that names its invariants.
pub trait Invariants: Problem {
    /// The invariants, in the order of [`values`](Self::values).
    fn invariants(&self) -> Vec<Invariant>;
    /// Their values at y. Between steps, not within one: it may allocate.
    fn values(&self, y: &PointOf<Self>) -> Vec<ScalarOf<Self>>;
}
