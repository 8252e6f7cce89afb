//! What the interface promises at its edges: arguments are checked, errors say what was wrong, and
//! nothing that is not a number is ever returned as a result.

#[path = "api/catalog.rs"]
mod catalog;
#[path = "api/constructors.rs"]
mod constructors;
#[path = "api/domains.rs"]
mod domains;
#[path = "../fuzz/src/draw.rs"]
mod draw;
#[path = "api/failures.rs"]
mod failures;
#[path = "api/grids.rs"]
mod grids;
#[path = "api/runs.rs"]
mod runs;

/// The message names all of these: the argument, its value, what was expected.
#[track_caller]
fn says(error: impl std::fmt::Display, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{message}` does not name `{word}`");
    }
}
