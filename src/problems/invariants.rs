//! Invariants: quantities that are constant along a solution. A run reports the drift of each.

use super::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;

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

/// The size that the rounding of an invariant is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Its value.
    Value,
    /// The sizes of the terms of a sum, which may cancel.
    Terms,
    /// 1, for a distance from a group.
    One,
}

impl Scale {
    /// The size, from the value and the size of its terms.
    pub fn size(self, value: f64, terms: f64) -> f64 {
        match self {
            Scale::Value => value.abs(),
            Scale::Terms => terms,
            Scale::One => 1.0,
        }
    }
}

/// Why and how a quantity is constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// The reason. A method that acts by the group conserves what the action conserves.
    pub origin: Origin,
    /// The degree of the quantity as a polynomial of the state. 0 if it is no polynomial, or is constant only on M.
    pub degree: u32,
    /// The size that its rounding is relative to.
    pub scale: Scale,
}

impl Law {
    /// A quantity that the action conserves, relative to its value.
    pub const fn by_the_action(degree: u32) -> Law {
        Law { origin: Origin::Action, degree, scale: Scale::Value }
    }
    /// A first integral of this flow, relative to its value.
    pub const fn by_the_flow(degree: u32) -> Law {
        Law { origin: Origin::Flow, ..Law::by_the_action(degree) }
    }
    /// The same law on another scale.
    pub const fn on_scale(self, scale: Scale) -> Law {
        Law { scale, ..self }
    }
}

/// A step rounds an invariant by a few tens of ε: about twenty operations of the action and of the update, each rounded
/// once. In all that was measured the errors of steps are independent, and grow with the root of their number.
const ROUNDINGS: f64 = 64.0;

/// The drift that rounding explains after `steps` steps, for an invariant of this size.
pub fn explained_by_rounding(steps: u64, size: f64) -> f64 {
    ROUNDINGS * f64::EPSILON * (1.0 + steps as f64).sqrt() * size
}

/// A quantity that the exact solution conserves.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Invariant {
    /// The name in reports.
    pub name: String,
    /// Why and how it is constant.
    pub law: Law,
}

impl Invariant {
    /// An invariant with its law.
    pub fn new(name: impl Into<String>, law: Law) -> Self {
        Invariant { name: name.into(), law }
    }
    /// An invariant of the action of this degree. Every method that acts by the group conserves it.
    pub fn of_the_action(name: impl Into<String>, degree: u32) -> Self {
        Invariant::new(name, Law::by_the_action(degree))
    }
    /// An invariant of this flow of this degree.
    pub fn of_the_flow(name: impl Into<String>, degree: u32) -> Self {
        Invariant::new(name, Law::by_the_flow(degree))
    }
    /// The same invariant, whose rounding is relative to its terms ([`Invariants::sizes`]).
    pub fn in_terms(self) -> Self {
        Invariant { law: self.law.on_scale(Scale::Terms), ..self }
    }
}

/// A problem with named invariants.
pub trait Invariants: Problem {
    /// The invariants, in the order of [`values`](Self::values).
    fn invariants(&self) -> Vec<Invariant>;
    /// The values of the invariants at y. It may allocate, so it is not called within a step.
    fn values(&self, y: &PointOf<Self>) -> Vec<ScalarOf<Self>>;
    /// The sizes of the terms of the invariants at y, for those on [`Scale::Terms`]. The default is the size of each value.
    fn sizes(&self, y: &PointOf<Self>) -> Vec<ScalarOf<Self>> {
        self.values(y).into_iter().map(Real::abs).collect()
    }
}
