//! What a motion keeps, and what rounding may do to that.

use lieflow::problems::Origin;

/// How the exact motion keeps the columns of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// What keeps it: a method that acts by the group keeps what the action keeps.
    pub origin: Origin,
    /// Its degree as a polynomial of the state; 0 where it is none, or the motion keeps it on M alone.
    pub degree: u32,
    /// The size that its rounding is relative to.
    pub scale: Scale,
}

/// The size that the rounding of an invariant is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Its value.
    Value,
    /// The sizes of the terms that it is the sum of, and that may cancel.
    Terms,
    /// 1: it is a distance from a group.
    One,
}

/// A step rounds an invariant by a few tens of ε: some twenty operations of the action and of the
/// update, each rounded once. The errors of steps are independent in all that was measured, and add up
/// as the root of their number.
const ROUNDINGS: f64 = 64.0;

impl Law {
    /// A law of the action.
    pub(crate) const fn by_the_action(degree: u32) -> Law {
        Law { origin: Origin::Action, degree, scale: Scale::Value }
    }
    /// A law of this flow.
    pub(crate) const fn by_the_flow(degree: u32) -> Law {
        Law { origin: Origin::Flow, ..Law::by_the_action(degree) }
    }
    /// The law with another size that its rounding is relative to.
    pub(crate) const fn on_scale(self, scale: Scale) -> Law {
        Law { scale, ..self }
    }
}

/// What rounding explains of a drift after so many steps, for an invariant of this size.
pub fn explained_by_rounding(steps: u64, size: f64) -> f64 {
    ROUNDINGS * f64::EPSILON * (1.0 + steps as f64).sqrt() * size
}
