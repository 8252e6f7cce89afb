//! Runs of the problems of `lieflow` by any method of its catalog, compiled once for each type of problem.
//!
//! A caller has the rows of a run as closures and asks for a method by name. The methods and the driver are generic in the
//! problem: they are compiled here, for each type in `spaces`, and not again in the crates that state problems of these
//! types.
//!
//! | room | what is in it |
//! |---|---|
//! | `schema` | the rows of a run: quantities, their columns, their laws |
//! | `spaces` | the few types that all problems of `lieflow-model` have |
//! | `run` | what a run is asked for, what sees it, and what it returns; steps by hand |
//!
//! A room uses those above it in this table only.
#![forbid(unsafe_code)]

pub mod run;
pub mod schema;
pub mod spaces;
