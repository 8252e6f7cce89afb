//! The command line of `lieflow`, as a library: scenes, models, commands, figures and pages.
//!
//! A scene file becomes a [`Scene`](scene::Scene); its problem, one of [`kinds::KINDS`], becomes a
//! [`Model`](model::Model) that any method of the catalog runs on.
#![forbid(unsafe_code)]

pub mod args;
pub mod cmd;
pub mod erased;
pub mod kinds;
pub mod measure;
pub mod model;
pub mod operations;
pub mod output;
pub mod page;
pub mod paper;
pub mod plot;
pub mod report;
pub mod scene;
pub mod survey;
