//! The command line of `lieflow`, as a library: commands, measurements and reports.
//!
//! | room | what is in it |
//! |---|---|
//! | `error` | why a command failed |
//! | `args` | the command line |
//! | `output` | what a run writes: rows, state, summary, figures |
//! | `measure` | errors and costs of methods |
//! | `report` | the page and the numbers of a comparison |
//! | `main_job` | what a bare `lieflow` does |
//! | `cmd` | the commands, one file each |
//!
//! A room uses those above it in this table only.
#![forbid(unsafe_code)]

pub mod args;
pub mod cmd;
pub mod error;
pub mod main_job;
pub mod measure;
pub mod output;
pub mod report;
