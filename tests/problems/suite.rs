//! The problems of the library: orders, invariants and known solutions of each.

#[path = "../support/mod.rs"]
mod support;

mod ensemble;
mod exact;
mod fluids;
mod fluids_catalog;
mod fluids_gauss;
mod fluids_limits;
mod frames;
mod grassmann;
mod library;
mod quaternion_body;
mod samples;
mod tops_by_series;
mod unitary;
