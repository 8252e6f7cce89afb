//! Values that a program states: numbers, texts, lists and tables, without a file.

use core::fmt;
use core::ops::Range;
use std::collections::BTreeMap;

use super::read::{Mistake, ReadError};
use super::refusal::{KeyPath, Refusal};
use super::suggest::help_for;
use super::value::{Entry, Is, Value, Written};

/// A value of a key.
///
/// ```
/// use lieflow_model::reader::Tree;
///
/// let keys = Tree::table([("inertia", Tree::from([1.0, 2.0, 3.0])), ("shape", Tree::from("box"))]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Tree {
    /// True or false.
    Bool(bool),
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// A text: a name or a formula.
    Text(String),
    /// A list. A matrix is a list of its rows.
    List(Vec<Tree>),
    /// Keys with their values.
    Table(BTreeMap<String, Tree>),
}

impl Tree {
    /// A table with these keys.
    pub fn table<K: Into<String>, V: Into<Tree>>(
        entries: impl IntoIterator<Item = (K, V)>,
    ) -> Tree {
        let entries = entries.into_iter().map(|(key, value)| (key.into(), value.into()));
        Tree::Table(entries.collect())
    }

    /// The tree of a value of a file. A date is its text.
    pub(crate) fn of(value: &Value) -> Tree {
        match &value.is {
            Is::Bool(x) => Tree::Bool(*x),
            Is::Text(text) | Is::Date(text) => Tree::Text(text.clone()),
            Is::List(list) => list.iter().map(Tree::of).collect(),
            Is::Table(keys) => {
                Tree::table(keys.iter().map(|(key, entry)| (key, Tree::of(&entry.value))))
            }
            Is::Whole(Written { text, value }) => match value.map(i64::try_from) {
                Some(Ok(n)) => Tree::Whole(n),
                _ => Tree::Text(text.clone()),
            },
            Is::Number(Written { text, value }) => {
                value.map_or_else(|| Tree::Text(text.clone()), Tree::Number)
            }
        }
    }

    /// The value for readers. Each key and each value has a place of its own, counted by `places`.
    fn value(&self, places: &mut usize) -> Value {
        let place = new_place(places);
        let is = match self {
            Tree::Bool(x) => Is::Bool(*x),
            Tree::Whole(n) => Is::from(*n),
            Tree::Number(x) => Is::from(*x),
            Tree::Text(text) => Is::Text(text.clone()),
            Tree::List(list) => Is::List(list.iter().map(|entry| entry.value(places)).collect()),
            Tree::Table(entries) => {
                let mut entry = |(key, entry): (&String, &Tree)| {
                    let (place, value) = (new_place(places), entry.value(places));
                    (key.clone(), Entry { key: place, value })
                };
                Is::Table(entries.iter().map(&mut entry).collect())
            }
        };
        Value { place, is }
    }

    /// Reads a table of keys.
    ///
    /// # Errors
    /// All mistakes, by the paths of keys.
    pub(crate) fn read<T>(
        &self,
        read: impl Fn(&Value) -> Result<T, ReadError>,
    ) -> Result<T, Mistakes> {
        let keys = self.value(&mut 0);
        read(&keys).map_err(|error| {
            let mistakes = error.mistakes.into_iter().map(|one| refusal(&keys, one));
            let mistakes: Vec<_> = mistakes.collect();
            match mistakes.is_empty() {
                true => Mistakes(vec![Refusal::section("a value that cannot be used")]),
                false => Mistakes(mistakes),
            }
        })
    }
}

/// A place that no other value has.
fn new_place(places: &mut usize) -> Range<usize> {
    *places += 1;
    *places - 1..*places
}

/// A mistake in a table of keys by the path of its key.
fn refusal(keys: &Value, mistake: Mistake) -> Refusal {
    let within = |place: &Range<usize>| path_at(keys, place, String::new());
    match mistake {
        Mistake::Refused(refusal) => refusal,
        Mistake::Wrong(place, message, help) => Refusal { key: within(&place), message, help },
        Mistake::UnknownKey(place, given, names) => Refusal {
            key: within(&place),
            message: format!("unknown key `{given}`"),
            help: Some(help_for(&given, names)),
        },
        Mistake::MissingKey(place, name) => Refusal {
            key: within(&place).map(|table| join(&table, name)),
            message: format!("missing key `{name}`"),
            help: None,
        },
    }
}

/// The path of an entry of a table.
fn join(table: &str, name: &str) -> String {
    if table.is_empty() { name.into() } else { table.entry(name) }
}

/// The path of the key or the value at a place, or around it, such as `parts[2].start`. It is empty for the whole.
fn path_at(value: &Value, wanted: &Range<usize>, path: String) -> Option<String> {
    if value.place == *wanted {
        return Some(path);
    }
    match &value.is {
        Is::List(list) => {
            let mut entries = list.iter().enumerate();
            entries.find_map(|(i, entry)| path_at(entry, wanted, path.index(i)))
        }
        Is::Table(keys) => keys.iter().find_map(|(name, Entry { key, value })| {
            let path = join(&path, name);
            if key == wanted { Some(path) } else { path_at(value, wanted, path) }
        }),
        _ => None,
    }
}

/// Keys that no problem can be made of, each by its path, with what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistakes(pub Vec<Refusal>);

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, Refusal { key, message, help }) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            match key.as_deref().filter(|key| !message.starts_with(key)) {
                Some(key) => write!(f, "{key}: {message}")?,
                None => f.write_str(message)?,
            }
            if let Some(help) = help {
                write!(f, " ({help})")?;
            }
        }
        Ok(())
    }
}

impl core::error::Error for Mistakes {}

/// Mistakes whose keys are in their refusals.
impl From<ReadError> for Mistakes {
    fn from(error: ReadError) -> Self {
        let refusal = |mistake| match mistake {
            Mistake::Refused(refusal) => refusal,
            other => {
                let (message, help) = other.in_words("");
                Refusal { key: None, message, help }
            }
        };
        Mistakes(error.mistakes.into_iter().map(refusal).collect())
    }
}

impl From<bool> for Tree {
    fn from(x: bool) -> Self {
        Tree::Bool(x)
    }
}
impl From<f64> for Tree {
    fn from(x: f64) -> Self {
        Tree::Number(x)
    }
}
impl From<i32> for Tree {
    fn from(n: i32) -> Self {
        Tree::Whole(n.into())
    }
}
impl From<i64> for Tree {
    fn from(n: i64) -> Self {
        Tree::Whole(n)
    }
}
impl From<&str> for Tree {
    fn from(text: &str) -> Self {
        Tree::Text(text.into())
    }
}
impl From<String> for Tree {
    fn from(text: String) -> Self {
        Tree::Text(text)
    }
}
impl<T: Into<Tree>> From<Vec<T>> for Tree {
    fn from(list: Vec<T>) -> Self {
        list.into_iter().collect()
    }
}
impl<T: Into<Tree>, const N: usize> From<[T; N]> for Tree {
    fn from(list: [T; N]) -> Self {
        list.into_iter().collect()
    }
}
impl<T: Clone + Into<Tree>> From<&[T]> for Tree {
    fn from(list: &[T]) -> Self {
        list.iter().cloned().collect()
    }
}
impl<T: Into<Tree>> FromIterator<T> for Tree {
    fn from_iter<I: IntoIterator<Item = T>>(list: I) -> Self {
        Tree::List(list.into_iter().map(Into::into).collect())
    }
}
