//! Scenes and the problems that they name: what the program `lieflow` runs, without its command line.
//!
//! A scene file becomes a [`Scene`](scene::Scene). Its problem, one of [`kinds::KINDS`], becomes a
//! [`Model`](problem::Model), which any method of the catalog runs on.
//!
//! | room | what is in it |
//! |---|---|
//! | `reader` | values with their places, and what is wrong with them |
//! | `formula` | texts that become functions |
//! | `problem` | what is the same for every kind of problem |
//! | `kinds` | the kinds of problems, one file each |
//! | `scene` | a problem, a method, times and output, as a TOML file |
//! | `check` | checks that hold for every scene |
//!
//! A room uses those above it in this table only. Below them all is `lieflow-runs`: [`schema`], the rows of a run, and runs of
//! each type of problem.
#![forbid(unsafe_code)]

pub mod check;
pub mod formula;
pub mod kinds;
pub mod problem;
pub mod reader;
pub mod scene;

pub use lieflow_runs::schema;
