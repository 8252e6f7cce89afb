//! The commands, one file each.

mod accuracy;
mod apart;
mod between;
pub mod check;
pub mod compare;
pub mod completions;
pub mod demo;
mod foresee;
pub mod methods;
pub mod order;
pub mod paper;
pub mod plot;
mod room;
pub mod run;
pub mod scenes;
mod shown;
mod signs;
mod singular;
mod stop;
mod told;
mod watch;
