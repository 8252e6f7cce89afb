//! Orders and costs: every method of the catalog, measured on problems that depend on t and y and do
//! not commute.

#[path = "../support/mod.rs"]
mod support;

mod adaptive;
#[allow(unreachable_pub)] // CONTRIBUTING.md prints it as a file of the library
mod cf2;
mod costs;
mod dense;
mod fields;
mod implicit;
mod lie_series;
mod lie_series_of_time;
mod not_computed;
mod products;
mod rigid_body;
mod rigid_methods;
mod second_results;
mod wide;
