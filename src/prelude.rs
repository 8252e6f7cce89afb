//! The names that most programs need: `use lieflow::prelude::*;`.

pub use crate::actions::{Coadjoint, LeftTranslation, Linear, RightTranslation};
#[cfg(feature = "dense")]
pub use crate::catalog::MethodsByName;
#[cfg(feature = "dense")]
pub use crate::groups::MatrixGroup;
pub use crate::groups::{LieAlgebra, LieGroup, Se3, So3};
pub use crate::maps::{Cay, Exp};
pub use crate::methods::{
    AnyMethod, Rk, Rkmk,
    tableau::{DOP853, DOPRI5, RK4},
};
pub use crate::problems::{Flow, Problem, RigidBody, RigidBodyAttitude};
pub use crate::solve::{Event, SaveAt, Solve, TimeGrid, integrate};
