//! Scenes and the problems that they name: what the program `lieflow` runs, without its command line.
//!
//! A scene file becomes a [`Scene`](scene::Scene). Its problem, one of [`kinds::KINDS`], becomes a
//! [`Model`](model::Model), which any method of the catalog runs on.
#![forbid(unsafe_code)]

pub mod branch;
pub mod check;
pub mod kinds;
mod mapped;
pub mod model;
pub mod operations;
pub mod scene;
pub mod schema;
