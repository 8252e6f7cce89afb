//! What is wrong with a value, as data: its key, a message and what to do.

use lieflow::Error;
use lieflow::error::Plain;

use super::suggest::help_for;

/// A value that a scene cannot have; the place is found by its key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The key, with the index of the entry where it has one, by [`KeyPath`]: `inertia[2]`, `attitude[1,3]`.
    pub key: Option<String>,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

impl Refusal {
    /// Replaces the names of the library by those of scene files.
    pub fn renamed(mut self, names: &[(&str, &str)]) -> Self {
        for (from, to) in names {
            if self.key.as_deref() == Some(from) {
                self.key = Some((*to).into());
            }
            self.message = self.message.replace(from, to);
        }
        self
    }

    /// A value that cannot be used.
    pub fn at(key: impl Into<String>, message: impl Into<String>) -> Self {
        Refusal { key: Some(key.into()), ..Refusal::section(message) }
    }

    /// A name that is none of those that are expected.
    pub fn unknown(key: &str, name: &str, expected: &[&str]) -> Self {
        Refusal {
            help: Some(help_for(name, expected)),
            ..Refusal::at(key, format!("unknown {key} `{name}`"))
        }
    }

    /// Makes the refusal about another key.
    pub fn about(self, key: impl Into<String>) -> Self {
        Refusal { key: Some(key.into()), ..self }
    }

    /// A number that lies outside its range.
    pub(crate) fn out_of_range(key: &str, value: f64, expected: &str) -> Self {
        Refusal::at(key, format!("{key} = {}, expected {expected}", Plain(&value)))
    }

    /// The refusal of an argument of the library that is a key of this table.
    pub fn in_table(table: &str, error: Error) -> Self {
        match error {
            Error::OutOfRange { arg, value, expected } => {
                Refusal::out_of_range(&table.entry(&path_of(&arg)), value, &path_of(&expected))
            }
            other => Refusal::from(other).about(table),
        }
    }

    /// Something about a section as a whole.
    pub fn section(message: impl Into<String>) -> Self {
        Refusal { key: None, message: message.into(), help: None }
    }
}

/// Places in a scene by the path of their keys. Scenes count from 1: all paths and messages are made here.
pub trait KeyPath {
    /// The entry `i`, from 0, of a list: `inertia[2]` for 1.
    fn index(&self, i: usize) -> String;
    /// The entry in row `i` and column `j`, from 0: `field[3,1]` for 2 and 0.
    fn cell(&self, i: usize, j: usize) -> String;
    /// The entry of a table: `let.b`.
    fn entry(&self, name: &str) -> String;
}

impl KeyPath for str {
    fn index(&self, i: usize) -> String {
        format!("{self}[{}]", i + 1)
    }
    fn cell(&self, i: usize, j: usize) -> String {
        format!("{self}[{},{}]", i + 1, j + 1)
    }
    fn entry(&self, name: &str) -> String {
        format!("{self}.{name}")
    }
}

/// A number of things in a message: `1 row`, `2 rows`.
pub(crate) fn amount(n: usize, things: &str) -> String {
    format!("{n} {}", if n == 1 { things.trim_end_matches('s') } else { things })
}

/// A text of the library, whose lists count from 0, with paths of scenes.
fn path_of(arg: &str) -> String {
    let mut parts = arg.split('[');
    let key = parts.next().unwrap_or_default().to_owned();
    parts.fold(key, |path, part| {
        let (index, rest) = part.split_once(']').unwrap_or((part, ""));
        match index.parse() {
            Ok(i) => path.index(i) + rest,
            Err(_) => format!("{path}[{part}"),
        }
    })
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        let error = match error {
            Error::OutOfRange { arg, value, expected } => {
                Error::OutOfRange { arg: path_of(&arg), value, expected: path_of(&expected) }
            }
            Error::Length { arg, found, expected } => {
                Error::Length { arg: path_of(&arg), found, expected }
            }
            Error::NotFiniteEntry { arg, row, col, value } => {
                Error::NotFiniteEntry { arg, row: row + 1, col: col + 1, value }
            }
            other => other,
        };
        let message = error.to_string();
        let key = match error {
            Error::UnknownName { kind, name, expected } => {
                let key = if kind == "method" { "name" } else { kind };
                return Refusal::unknown(kind, &name, &expected).about(key);
            }
            Error::OutOfRange { arg, .. } | Error::Length { arg, .. } => Some(arg),
            Error::NotFiniteEntry { arg, row, col, .. } => Some(format!("{arg}[{row},{col}]")),
            Error::NotSquare { arg, .. }
            | Error::Shape { arg, .. }
            | Error::NotInAlgebra { arg, .. }
            | Error::NotOnGroup { arg, .. }
            | Error::Determinant { arg, .. }
            | Error::Trace { arg, .. }
            | Error::NotGiven { arg, .. }
            | Error::NotSymmetric { arg, .. }
            | Error::Reflection { arg }
            | Error::Singular { arg, .. } => Some(arg.into()),
            Error::Unsupported { what, .. } => Some(what.into()),
            _ => None,
        };
        Refusal { key, ..Refusal::section(message) }
    }
}

/// One of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Either<A, B> {
    /// The first.
    First(A),
    /// The second.
    Second(B),
}

/// The one of these keys that is there, where one is.
///
/// # Errors
/// A refusal of the second one that is there.
pub fn at_most_one<'a>(
    keys: impl IntoIterator<Item = (&'a str, bool)>,
) -> Result<Option<&'a str>, Refusal> {
    one_of(keys, "at most one")
}

/// The one of these keys that is there, where one is. `expected` says how many of them a user should give.
///
/// # Errors
/// A refusal of the second one that is there, which names all.
pub fn one_of<'a>(
    keys: impl IntoIterator<Item = (&'a str, bool)>,
    expected: &str,
) -> Result<Option<&'a str>, Refusal> {
    let given = keys.into_iter().filter(|(_, given)| *given).map(|(key, _)| key);
    let given: Vec<_> = given.collect();
    let all = match &given[..] {
        [] | [_] => return Ok(given.first().copied()),
        [a, b] => format!("both `{a}` and `{b}`"),
        [before @ .., last] => format!("`{}` and `{last}`", before.join("`, `")),
    };
    Err(Refusal::at(given[1], format!("{all}, expected {expected} of them")))
}

/// The one of two keys that is there.
///
/// # Errors
/// Both are there, or none.
pub fn exactly_one<A, B>(
    (a, first): (&str, Option<A>),
    (b, second): (&str, Option<B>),
) -> Result<Either<A, B>, Refusal> {
    one_of([(a, first.is_some()), (b, second.is_some())], "exactly one")?;
    match (first, second) {
        (Some(value), _) => Ok(Either::First(value)),
        (None, Some(value)) => Ok(Either::Second(value)),
        (None, None) => Err(Refusal::section(format!("expected `{a}` or `{b}`, found neither"))),
    }
}
