//! Imports for the file of a kind.

pub(super) use faer::Mat;
pub(super) use lieflow::Error;
pub(super) use lieflow_runs::schema::{Dimension, Law, Numbers, Scale, length};

pub(super) use crate::problem::{
    Counting, Figure, Forms, Kind, Layer, PrincipalInertia, Property, Quantity, Start, System,
    counting, formula_keys, keys, sample_keys,
};
pub(super) use crate::reader::values::{List, Real, Reals, Table, Whole};
pub(super) use crate::reader::{
    Either, Key, KeyPath, ReadError, Refusal, all, amount, at_most_one, exactly_one, given,
    help_for, one_of, read_by_keys, read_with, seen,
};
