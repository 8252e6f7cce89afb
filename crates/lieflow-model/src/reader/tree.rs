//! Values that a program states: numbers, texts, lists and tables, without a file.

use core::fmt;
use core::ops::Range;
use std::collections::BTreeMap;

use toml::de::{DeTable, DeValue};

use super::read::{Mistake, ReadError, Value};
use super::refusal::{KeyPath, Refusal};
use super::suggest::help_for;

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
    pub(crate) fn of(value: &Value<'_>) -> Tree {
        match value.get_ref() {
            DeValue::Boolean(x) => Tree::Bool(*x),
            DeValue::String(text) => Tree::Text(text.to_string()),
            DeValue::Array(list) => Tree::List(list.iter().map(Tree::of).collect()),
            DeValue::Table(table) => {
                Tree::table(table.iter().map(|(key, value)| (&**key.get_ref(), Tree::of(value))))
            }
            DeValue::Integer(n) => match i64::from_str_radix(n.as_str(), n.radix()) {
                Ok(n) => Tree::Whole(n),
                Err(_) => Tree::Text(n.to_string()),
            },
            DeValue::Float(x) => x.as_str().parse().map_or(Tree::Text(x.to_string()), Tree::Number),
            DeValue::Datetime(date) => Tree::Text(date.to_string()),
        }
    }

    /// Reads a table of keys.
    ///
    /// # Errors
    /// All mistakes, by the paths of keys.
    pub(crate) fn read<T>(
        &self,
        read: impl Fn(&Value<'_>) -> Result<T, ReadError>,
    ) -> Result<T, Mistakes> {
        let text = format!("{KEYS} = {self}");
        let not_read = |message: &str| Mistakes(vec![Refusal::section(message)]);
        let mut root = DeTable::parse(&text).map_err(|error| not_read(error.message()))?;
        let keys = root.get_mut().remove(KEYS).ok_or_else(|| not_read("no keys"))?;
        read(&keys).map_err(|error| {
            let mistakes = error.mistakes.into_iter().map(|one| refusal(&keys, one));
            let mistakes: Vec<_> = mistakes.collect();
            match mistakes.is_empty() {
                true => not_read("a value that cannot be used"),
                false => Mistakes(mistakes),
            }
        })
    }
}

/// The name of the table of keys in a text.
const KEYS: &str = "keys";

/// The value as TOML.
impl fmt::Display for Tree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Tree::Bool(x) => x.fmt(f),
            Tree::Whole(n) => n.fmt(f),
            Tree::Number(x) => f.write_str(&format!("{x:?}").to_lowercase()),
            Tree::Text(text) => f.write_str(&quoted(text)),
            Tree::List(list) => {
                f.write_str("[")?;
                list.iter().try_for_each(|entry| write!(f, "{entry}, "))?;
                f.write_str("]")
            }
            Tree::Table(entries) => {
                f.write_str("{ ")?;
                for (i, (key, entry)) in entries.iter().enumerate() {
                    let comma = if i > 0 { ", " } else { "" };
                    write!(f, "{comma}{} = {entry}", quoted(key))?;
                }
                f.write_str(" }")
            }
        }
    }
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", c as u32),
        c => c.into(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}

/// A mistake in a table of keys by the path of its key.
fn refusal(keys: &Value<'_>, mistake: Mistake) -> Refusal {
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
fn path_at(value: &Value<'_>, wanted: &Range<usize>, path: String) -> Option<String> {
    let span = value.span();
    if span == *wanted {
        return Some(path);
    }
    if value.get_ref().is_str() && span.contains(&wanted.start) {
        return Some(path);
    }
    match value.get_ref() {
        DeValue::Array(list) => {
            let mut entries = list.iter().enumerate();
            entries.find_map(|(i, entry)| path_at(entry, wanted, path.index(i)))
        }
        DeValue::Table(table) => table.iter().find_map(|(key, entry)| {
            let path = join(&path, key.get_ref());
            if key.span() == *wanted { Some(path) } else { path_at(entry, wanted, path) }
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
