//! What the file of a kind is written with.

pub(super) use faer::Mat;
pub(super) use lieflow::Error;

pub(super) use super::quantity::Quantity;
pub(super) use super::system::{Number, Start, Stated, System, lacks_any};
pub(super) use super::{
    Fact, Figure, KeyInfo, Kind, Law, PrincipalInertia, ProblemSpec, Scale, body_keys,
    formula_keys, keys, sample_keys,
};
pub(super) use crate::model::Layer;
pub(super) use crate::scene::read::{Read, ReadError, read_by_keys};
pub(super) use crate::scene::values::{List, Real, Reals, Table, Whole};
pub(super) use crate::scene::{Either, KeyPath, Refusal, at_most_one, exactly_one, help_for};
