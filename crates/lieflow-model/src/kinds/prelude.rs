//! What the file of a kind is written with.

pub(super) use faer::Mat;
pub(super) use lieflow::Error;
pub(super) use lieflow::samples::Samples;
pub(super) use serde::Deserialize;
pub(super) use toml::de::ValueDeserializer;

pub(super) use super::quantity::Quantity;
pub(super) use super::system::{Number, Start, Stated, System};
pub(super) use super::{
    Fact, Figure, INTERPOLATION, Kind, Law, PARAMETERS, PrincipalInertia, ProblemSpec, SAMPLES,
    Scale, keys,
};
pub(super) use crate::model::Layer;
pub(super) use crate::scene::values::{List, Real, Reals, Table, Whole};
pub(super) use crate::scene::{Either, ReadError, Refusal, exactly_one, help_for};
