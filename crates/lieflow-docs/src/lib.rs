//! The Rust programs of the README and of the pages in `docs/`, as tests.
//!
//! They are compiled as in the crate of a user, whose only dependency is `lieflow`: `cargo test --doc -p lieflow-docs`.

/// The programs of README.md.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
pub struct Readme;

/// The programs of docs/driver.md.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/driver.md")]
pub struct DriverPage;

/// The program of docs/tutorial.md.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/tutorial.md")]
pub struct Tutorial;
