//! The program `lieflow`: its commands, its files, and every mistake in a scene.

mod advice;
mod bounds;
mod broken;
mod columns;
mod compare;
mod curves;
mod docs;
mod events;
mod every_row;
mod goals;
mod growth;
mod laws;
mod listing;
mod messages;
mod operations;
mod plot;
#[cfg(unix)]
mod resume;
mod right;
mod room;
mod run;
mod same_bits;
mod search;
mod second_run;
mod singular;
mod sizes;
mod small;
mod support;
mod units;
