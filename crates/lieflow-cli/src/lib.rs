//! The command line of `lieflow`, as a library: commands, measurements, reports and the paper's tables.
//!
//! | room | what is in it |
//! |---|---|
//! | `error` | why a command failed |
//! | `fit` | straight lines through points |
//! | `args` | the command line |
//! | `output` | what a run writes: rows, state, summary, figures |
//! | `measure` | errors and costs of methods |
//! | `report` | the page and the numbers of a comparison |
//! | `paper` | the tables and figures of the paper |
//! | `cmd` | the commands, one file each |
//!
//! A room uses those above it in this table only.
#![forbid(unsafe_code)]

pub mod args;
pub mod cmd;
pub mod error;
pub mod fit;
pub mod measure;
pub mod output;
pub mod paper;
pub mod report;
