//! The kinds of problems that scene files can name.
//!
//! To add a kind: one file with its keys and its [`Model`], one line in [`KINDS`].

mod rigid_body;
mod spin;

pub use rigid_body::RigidBodySpec;
pub use spin::SpinSpec;

use core::any::Any;
use core::fmt::Debug;

use lieflow::Error;
use toml::de::ValueDeserializer;

use crate::model::{Layer, Model};
use crate::scene::ReadError;

/// Every kind.
pub const KINDS: &[Kind] = &[rigid_body::KIND, spin::KIND];

/// A kind of problem.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its name in scene files.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// The keys of `[problem]`, besides `kind`.
    pub keys: &'static [KeyInfo],
    /// What can be asked of it.
    pub quantities: &'static [QuantityInfo],
    /// Reads the keys of `[problem]`, without `kind`.
    pub read: fn(ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError>,
}

/// A key of `[problem]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyInfo {
    /// The key.
    pub name: &'static str,
    /// What it means, and what it holds.
    pub meaning: &'static str,
}

/// A quantity that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuantityInfo {
    /// Its name in scene files.
    pub name: &'static str,
    /// Its columns.
    pub columns: &'static [&'static str],
    /// What it means.
    pub meaning: &'static str,
}

impl Kind {
    /// The kind of that name.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn named(name: &str) -> Result<&'static Kind, Error> {
        KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| Error::UnknownName {
            kind: "kind of problem",
            name: name.into(),
            expected: KINDS.iter().map(|kind| kind.name).collect(),
        })
    }

    /// The quantity of that name.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn quantity(&self, name: &str) -> Result<&'static QuantityInfo, Error> {
        self.quantities.iter().find(|quantity| quantity.name == name).ok_or_else(|| {
            Error::UnknownName {
                kind: "quantity",
                name: name.into(),
                expected: self.quantities.iter().map(|quantity| quantity.name).collect(),
            }
        })
    }
}

/// A problem as its scene states it: checked, and not yet tied to a layer or to quantities.
///
/// The type behind it is found by `downcast_ref` on `&dyn Any`.
pub trait ProblemSpec: Any + Debug + Send + Sync {
    /// Its kind.
    fn kind(&self) -> &'static Kind;

    /// The problem on a layer, modelling what the quantities need and no more.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a quantity that the kind does not have.
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error>;

    /// The quantities that make up what these quantities model: those to compare with the exact
    /// solution.
    fn state(&self, quantities: &[&str]) -> &'static [&'static str];

    /// The quantities that the exact motion keeps, of those that follow from what these quantities
    /// model. Each has one column.
    fn invariants(&self, quantities: &[&str]) -> &'static [&'static str];
}
