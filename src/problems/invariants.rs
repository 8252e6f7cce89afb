//! Invariants: quantities that are constant along a solution. A run reports the drift of each.

use super::{PointOf, Problem, ScalarOf};

/// The reason why a quantity is constant, which decides the methods that conserve it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The quantity is constant on the orbits of the action. Examples: a Casimir, an eigenvalue, a length. Every method
    /// that acts by the group conserves it to rounding.
    Action,
    /// The quantity is a first integral of this flow. Example: the energy. A method conserves it to its own accuracy.
    /// Some methods conserve it to rounding by construction.
    Flow,
}

/// A quantity that the exact solution conserves.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Invariant {
    /// The name in reports.
    pub name: String,
    /// The reason why it is constant.
    pub origin: Origin,
}

impl Invariant {
    /// An invariant of the action. Every method that acts by the group conserves it.
    pub fn of_the_action(name: impl Into<String>) -> Self {
        Invariant { name: name.into(), origin: Origin::Action }
    }
    /// An invariant of this flow.
    pub fn of_the_flow(name: impl Into<String>) -> Self {
        Invariant { name: name.into(), origin: Origin::Flow }
    }
}

/// A problem with named invariants.
pub trait Invariants: Problem {
    /// The invariants, in the order of [`values`](Self::values).
    fn invariants(&self) -> Vec<Invariant>;
    /// The values of the invariants at y. It may allocate, so it is not called within a step.
    fn values(&self, y: &PointOf<Self>) -> Vec<ScalarOf<Self>>;
}
