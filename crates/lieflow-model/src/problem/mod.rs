//! Problems, whatever their kind: what a kind states, and a model of it that any method runs on.

mod keys;
mod mapped;
mod model;
mod operations;
mod quantity;
mod spec;
mod system;

pub(crate) use keys::*;
pub(crate) use mapped::*;
pub use model::*;
pub use operations::*;
pub(crate) use quantity::*;
pub use spec::*;
pub(crate) use system::*;
