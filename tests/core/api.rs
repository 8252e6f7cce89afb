//! What the interface promises at its edges: arguments are checked, errors say what was wrong, and
//! nothing that is not a number is ever returned as a result.

mod catalog;
mod constructors;
mod domains;
mod failures;
mod grids;
mod runs;

/// The message names all of these: the argument, its value, what was expected.
#[track_caller]
fn says(error: impl std::fmt::Display, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{message}` does not name `{word}`");
    }
}
