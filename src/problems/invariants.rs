//! What stays constant along a solution, by name: a run reports the drift of each.

use super::{PointOf, Problem, ScalarOf};

/// What makes a quantity constant, and so which methods keep it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The quantity is constant on the orbits of the action: a Casimir, an eigenvalue, a length. Every method
    /// that acts by the group keeps it to rounding.
    Action,
    /// The quantity is a first integral of this flow: the energy. A method keeps it to its own accuracy, or to
    /// rounding where it is built to.
    Flow,
}

/// A quantity that the exact solution keeps.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Invariant {
    /// The name, as in reports.
    pub name: String,
    /// What keeps it.
    pub origin: Origin,
}

impl Invariant {
    /// An invariant of the action: every method that acts by the group keeps it.
    pub fn of_the_action(name: impl Into<String>) -> Self {
        Invariant { name: name.into(), origin: Origin::Action }
    }
    /// An invariant of this flow.
    pub fn of_the_flow(name: impl Into<String>) -> Self {
        Invariant { name: name.into(), origin: Origin::Flow }
    }
}

/// A capability: a problem that names its invariants.
pub trait Invariants: Problem {
    /// The invariants, in the order of [`values`](Self::values).
    fn invariants(&self) -> Vec<Invariant>;
    /// The values of the invariants at y. Between steps, not within one: it may allocate.
    fn values(&self, y: &PointOf<Self>) -> Vec<ScalarOf<Self>>;
}
