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

/// The least number with a finite reciprocal.
const LEAST_MOMENT: f64 = (1.0 / f64::MAX).next_up();

/// Checks that principal moments of inertia are finite and positive, with finite reciprocals.
pub(crate) fn check_inertia(inertia: &[f64]) -> Result<(), Error> {
    let mut moments = inertia.iter().enumerate();
    moments.try_for_each(|(i, &j)| check_moment(j, || format!("inertia[{i}]")))
}

/// Checks one moment of inertia, which `arg` names.
pub(crate) fn check_moment(j: f64, arg: impl FnOnce() -> String) -> Result<(), Error> {
    if j.is_finite() && j >= LEAST_MOMENT {
        return Ok(());
    }
    let mut expected = String::from("a finite number > 0");
    if j > 0.0 && j < LEAST_MOMENT {
        expected += &format!(" with a finite reciprocal, at least {LEAST_MOMENT:e}");
    }
    Err(Error::out_of_range(arg(), j, expected))
}
