//! Values of a problem and of a scene: how they are read, and what is said of those that cannot be used.

mod read;
mod refusal;
mod suggest;
mod tree;
mod value;
pub mod values;

pub use read::{Key, Mistake, Read, ReadError, Shape};
pub(crate) use read::{
    KeyReader, all, entry_of, given, given_key, key_name, read_as_held, read_by_keys, read_whole,
    read_with, seen, take,
};
pub(crate) use refusal::amount;
pub use refusal::{Either, KeyPath, Refusal, at_most_one, exactly_one, one_of};
pub use suggest::{help_for, is_known, suggest};
pub use tree::{Mistakes, Tree};
pub use value::{Entry, Is, Keys, Value, Written};
pub(crate) use value::{is_in_range, keys_of};
