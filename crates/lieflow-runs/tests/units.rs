//! The unit tests of the rows, compiled without the methods.
#![allow(dead_code, unused_imports, unreachable_pub, missing_docs)] // modules are here for their tests

#[path = "../src/schema/mod.rs"]
mod schema;
