//! Values of a problem and of a scene: how they are read, and what is said of those that cannot be used.

mod mend;
mod read;
mod refusal;
mod suggest;
mod tree;
pub mod values;

pub(crate) use mend::{Found, every_mistake, rename};
pub(crate) use read::{KeyReader, key_name, read_as_held, read_by_keys};
pub use read::{Read, ReadError, Shape, Value};
pub use refusal::{Either, KeyPath, Refusal, at_most_one, exactly_one};
pub use suggest::{help_for, suggest};
pub use tree::{Mistakes, Tree};
