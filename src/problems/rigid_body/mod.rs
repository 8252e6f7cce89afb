//! The free rigid body (paper 2): by its momentum on so(3)*, by its attitude on SO(3), in n dimensions, and exactly.

mod closed;
mod exact;
mod free;
#[cfg(feature = "dense")]
mod general;
#[cfg(feature = "dense")]
mod invariants;
#[cfg(feature = "dense")]
mod series;
mod state;
mod theta;

pub(super) use closed::apply_transpose;
pub use closed::{RigidBody, RigidBodyAttitude};
pub use exact::Exact;
pub(crate) use exact::Place;
pub use free::{Frame, FreeBody};
#[cfg(feature = "dense")]
pub use general::{RigidBodyN, RigidBodyNAttitude};
#[cfg(feature = "dense")]
pub use invariants::manakov_integrals;
pub use state::{BodyFrame, BodyState, RigidBodyState};

use crate::error::Error;

/// Checks that principal moments of inertia are finite and positive, with finite reciprocals.
pub(crate) fn check_inertia(inertia: &[f64]) -> Result<(), Error> {
    for (i, &j) in inertia.iter().enumerate() {
        if !(j.is_finite() && j > 0.0 && (1.0 / j).is_finite()) {
            return Err(Error::out_of_range(format!("inertia[{i}]"), j, "a finite number > 0"));
        }
    }
    Ok(())
}
