//! What a contributor runs in a loop: laws of groups, maps and actions, closed formulas, tableaus, and
//! the interface at its edges.

#[path = "../support/mod.rs"]
mod support;

mod adjoint;
mod api;
#[path = "../../fuzz/src/draw.rs"]
mod draw;
mod laws;
mod products;
mod rooms;
mod scalars;
mod so3_closed;
mod tableaus;
mod tally;
