//! The command line of `lieflow`, as a library: commands, measurements, reports and the paper's tables.
#![forbid(unsafe_code)]

pub mod args;
pub mod cmd;
pub mod measure;
pub mod output;
pub mod paper;
pub mod report;
