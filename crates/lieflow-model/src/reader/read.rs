//! Reads values of a scene. Each type says what it is read from, and each mistake has its place.

use core::fmt::{self, Display};
use core::ops::Range;
use std::collections::BTreeMap;

use lieflow::Error;
use lieflow::names::near;

use super::refusal::Refusal;
use super::suggest::{help_for, suggest};
use super::value::{Is, Keys, Value};

/// What the value of a key is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// True or false.
    Bool,
    /// A whole number.
    Whole,
    /// A number.
    Number,
    /// So many numbers.
    Numbers(usize),
    /// Any number of numbers.
    List,
    /// Rows of numbers.
    Rows,
    /// As many rows of as many numbers.
    Square(usize),
    /// A text.
    Text,
    /// A formula: a text or a number.
    Formula,
    /// A formula, or a list of formulas.
    Formulas,
    /// A list of such values.
    ListOf(&'static Shape),
    /// A table of names with such values.
    TableOf(&'static Shape),
    /// A table with these keys, and what is under each.
    Keys(&'static [(&'static str, Shape)]),
    /// One of two.
    Or(&'static Shape, &'static Shape),
    /// The name of a file of samples.
    Samples,
}

/// What the value is, in words.
impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Shape::Bool => f.write_str("true or false"),
            Shape::Whole => f.write_str("a whole number"),
            Shape::Number => f.write_str("a number"),
            Shape::Numbers(n) => write!(f, "a list of {n} numbers"),
            Shape::List => f.write_str("a list of numbers"),
            Shape::Rows => f.write_str("rows of numbers"),
            Shape::Square(n) => write!(f, "{n} rows of {n} numbers"),
            Shape::Text => f.write_str("a text"),
            Shape::Formula => f.write_str("a formula"),
            Shape::Formulas => f.write_str("a formula, or a list of formulas"),
            Shape::ListOf(entry) => write!(f, "a list, of each {entry}"),
            Shape::TableOf(entry) => write!(f, "a table of names, each {entry}"),
            Shape::Keys(keys) => {
                let names: Vec<&str> = keys.iter().map(|(name, _)| *name).collect();
                write!(f, "a table with the keys {}", names.join(", "))
            }
            Shape::Or(a, b) => write!(f, "{a}, or {b}"),
            Shape::Samples => f.write_str("the name of a CSV file"),
        }
    }
}

/// A type that is read from a value of a scene.
pub trait Read: Sized {
    /// What the value is.
    const SHAPE: Shape;
    /// True if the key may be left out.
    const OPTIONAL: bool = false;

    /// Reads a value.
    ///
    /// # Errors
    /// [`ReadError`] with all mistakes: values of another type, and those that cannot be used.
    fn read(value: &Value) -> Result<Self, ReadError>;

    /// Reads what can be used of a value, and adds its mistakes to those known. `None` if nothing can be used.
    fn read_usable(value: &Value, mistakes: &mut ReadError) -> Option<Self> {
        mistakes.keep(Self::read(value))
    }

    /// What a missing key means. `None` if the key must be there.
    fn missing() -> Option<Self> {
        None
    }

    /// What stands for a value whose mistakes are known.
    fn unusable() -> Option<Self> {
        None
    }
}

/// Reads a value of a type that can be used in parts, without a mistake.
///
/// # Errors
/// All mistakes.
pub(crate) fn read_whole<T: Read>(value: &Value) -> Result<T, ReadError> {
    let mut mistakes = ReadError::default();
    let read = T::read_usable(value, &mut mistakes);
    mistakes.or(read)
}

/// Reads the keys of a table as K, and makes something of those that can be used.
///
/// # Errors
/// The mistakes in single keys, and those that are found in what is made of them.
pub(crate) fn read_with<K: Read, T>(
    value: &Value,
    make: impl FnOnce(K) -> Result<T, ReadError>,
) -> Result<T, ReadError> {
    let mut mistakes = ReadError::default();
    let keys = K::read_usable(value, &mut mistakes);
    let made = keys.and_then(|keys| mistakes.keep(make(keys)));
    mistakes.or(made)
}

/// The value of a key. The mistakes of one that cannot be used are known to its reader, and not in the error.
pub type Key<T> = Result<T, ReadError>;

impl<T: Read> Read for Key<T> {
    const SHAPE: Shape = T::SHAPE;
    const OPTIONAL: bool = T::OPTIONAL;

    fn read(value: &Value) -> Result<Self, ReadError> {
        read_whole(value)
    }
    fn read_usable(value: &Value, mistakes: &mut ReadError) -> Option<Self> {
        Some(T::read_usable(value, mistakes).ok_or_else(ReadError::known))
    }
    fn missing() -> Option<Self> {
        T::missing().map(Ok)
    }
    fn unusable() -> Option<Self> {
        Some(Err(ReadError::known()))
    }
}

/// A mistake in a value.
#[derive(Clone, Debug)]
pub enum Mistake {
    /// A key that does not exist, and the keys that do.
    UnknownKey(Range<usize>, String, &'static [&'static str]),
    /// A key that must be in the table at this place.
    MissingKey(Range<usize>, &'static str),
    /// A value that is not what is expected: its place, the message, and what to do.
    Wrong(Range<usize>, String, Option<String>),
    /// A value that cannot be used. The place is found by its key.
    Refused(Refusal),
}

impl Mistake {
    /// The message in a section, or at the top, and a suggestion.
    pub(crate) fn in_words(self, section: &str) -> (String, Option<String>) {
        let within = if section.is_empty() { String::new() } else { format!(" in [{section}]") };
        match self {
            Mistake::UnknownKey(_, given, names) => {
                (format!("unknown key `{given}`{within}"), Some(help_for(&given, names)))
            }
            Mistake::MissingKey(_, name) => (format!("missing key `{name}`{within}"), None),
            Mistake::Wrong(_, message, help) => (message, help),
            Mistake::Refused(Refusal { message, help, .. }) => (message, help),
        }
    }
}

/// All mistakes of a value that cannot be read. Empty if the cause is reported already.
#[derive(Clone, Debug, Default)]
pub struct ReadError {
    /// The mistakes, in the order in which they were found.
    pub mistakes: Vec<Mistake>,
}

impl From<Mistake> for ReadError {
    fn from(mistake: Mistake) -> Self {
        ReadError { mistakes: vec![mistake] }
    }
}
impl From<Refusal> for ReadError {
    fn from(refusal: Refusal) -> Self {
        Mistake::Refused(refusal).into()
    }
}
impl From<Vec<Refusal>> for ReadError {
    fn from(refusals: Vec<Refusal>) -> Self {
        ReadError { mistakes: refusals.into_iter().map(Mistake::Refused).collect() }
    }
}
impl From<Error> for ReadError {
    fn from(error: Error) -> Self {
        Refusal::from(error).into()
    }
}

impl ReadError {
    /// An error that reports nothing: its cause is reported already.
    pub(crate) fn known() -> Self {
        ReadError::default()
    }

    /// A mistake in a value.
    pub fn of(value: &Value, message: impl Into<String>) -> Self {
        Mistake::Wrong(value.place.clone(), message.into(), None).into()
    }

    /// A mistake at a character, from 0, of the text that a value is. It is at the whole value where the file writes some
    /// of the text in another way.
    pub(crate) fn in_text(
        value: &Value,
        character: usize,
        message: String,
        help: Option<String>,
    ) -> Self {
        let text = value.as_text().unwrap_or_default();
        let (span, before) = (value.place.clone(), text.char_indices().nth(character));
        let bytes = before.map_or(text.len(), |(byte, _)| byte);
        let place = match span.len() == text.len() + 2 {
            true if bytes < text.len() => span.start + 1 + bytes..span.start + 2 + bytes,
            _ => span,
        };
        Mistake::Wrong(place, message, help).into()
    }

    /// A value where something else is expected.
    pub fn expected(value: &Value, expected: impl Display) -> Self {
        let found = match &value.is {
            Is::Text(text) => format!("the text {text:?}"),
            Is::Whole(n) => n.text.clone(),
            Is::Number(x) => x.text.clone(),
            Is::Bool(x) => x.to_string(),
            Is::Date(_) => "a date".into(),
            Is::List(_) => "a list".into(),
            Is::Table(_) => "a table".into(),
        };
        Self::of(value, format!("found {found}, expected {expected}"))
    }

    /// The message of the first mistake in the value of a key.
    pub(crate) fn message(&self) -> Option<&str> {
        self.mistakes.iter().find_map(|mistake| match mistake {
            Mistake::Wrong(_, message, _) | Mistake::Refused(Refusal { message, .. }) => {
                Some(message.as_str())
            }
            _ => None,
        })
    }

    /// Adds a mistake.
    pub(crate) fn add(&mut self, mistake: impl Into<ReadError>) {
        self.mistakes.extend(mistake.into().mistakes);
    }

    /// Returns the value, or adds its mistakes.
    pub(crate) fn keep<T, E: Into<ReadError>>(&mut self, read: Result<T, E>) -> Option<T> {
        read.map_err(|error| self.add(error)).ok()
    }

    /// Returns the value if there is no mistake.
    pub(crate) fn or<T>(self, value: Option<T>) -> Result<T, ReadError> {
        value.filter(|_| self.mistakes.is_empty()).ok_or(self)
    }
}

/// What a value is for others that need it: its mistakes are not theirs.
pub(crate) fn seen<T, E>(value: &Result<T, E>) -> Result<&T, ReadError> {
    value.as_ref().map_err(|_| ReadError::known())
}

/// Does a key have a value, be it wrong?
pub(crate) fn given<T>(key: &Key<Option<T>>) -> bool {
    !matches!(key, Ok(None))
}

/// Takes the value of a key out.
pub(crate) fn take<T>(key: &mut Key<T>) -> Key<T> {
    core::mem::replace(key, Err(ReadError::known()))
}

/// The values of results, or the mistakes of all of them.
macro_rules! all {
    ($($result:ident),+ $(,)?) => {{
        let mut mistakes = $crate::reader::ReadError::default();
        $(let $result = mistakes.keep($result);)+
        #[allow(clippy::question_mark)]
        let values = match ($($result,)+) {
            ($(Some($result),)+) => Some(($($result),+)),
            _ => None,
        };
        mistakes.or(values)
    }};
}
pub(crate) use all;

impl Read for String {
    const SHAPE: Shape = Shape::Text;

    fn read(value: &Value) -> Result<Self, ReadError> {
        let text = value.as_text();
        text.map(str::to_owned).ok_or_else(|| ReadError::expected(value, "a text"))
    }
}

impl Read for bool {
    const SHAPE: Shape = Shape::Bool;

    fn read(value: &Value) -> Result<Self, ReadError> {
        match value.is {
            Is::Bool(x) => Ok(x),
            _ => Err(ReadError::expected(value, "true or false")),
        }
    }
}

impl<T: Read> Read for Option<T> {
    const SHAPE: Shape = T::SHAPE;
    const OPTIONAL: bool = true;

    fn read(value: &Value) -> Result<Self, ReadError> {
        T::read(value).map(Some)
    }
    fn read_usable(value: &Value, mistakes: &mut ReadError) -> Option<Self> {
        T::read_usable(value, mistakes).map(Some)
    }
    fn missing() -> Option<Self> {
        Some(None)
    }
}

/// Reads an entry of a list or a table.
fn read_entry<T: Read>(entry: &Value, mistakes: &mut ReadError) -> Option<T> {
    T::read_usable(entry, mistakes).or_else(T::unusable)
}

impl<T: Read> Read for Vec<T> {
    const SHAPE: Shape = Shape::ListOf(&T::SHAPE);

    fn read(value: &Value) -> Result<Self, ReadError> {
        read_whole(value)
    }
    fn read_usable(value: &Value, mistakes: &mut ReadError) -> Option<Self> {
        let list = value.as_list();
        let list = list.ok_or_else(|| ReadError::expected(value, "a list"));
        let entries = mistakes.keep(list)?.iter().map(|entry| read_entry(entry, mistakes));
        // Each is read, also after one that is wrong.
        let entries: Vec<_> = entries.collect();
        entries.into_iter().collect()
    }
}

/// A table of any keys. A missing one is empty.
impl<T: Read> Read for BTreeMap<String, T> {
    const SHAPE: Shape = Shape::TableOf(&T::SHAPE);
    const OPTIONAL: bool = true;

    fn read(value: &Value) -> Result<Self, ReadError> {
        read_whole(value)
    }
    fn read_usable(value: &Value, mistakes: &mut ReadError) -> Option<Self> {
        let table = value.as_table();
        let table = table.ok_or_else(|| ReadError::expected(value, "a table"));
        let entries = mistakes.keep(table)?.iter().map(|(key, entry)| {
            read_entry(&entry.value, mistakes).map(|entry| (key.clone(), entry))
        });
        let entries: Vec<_> = entries.collect();
        entries.into_iter().collect()
    }
    fn missing() -> Option<Self> {
        Some(BTreeMap::new())
    }
}

/// Reads the values of the keys of a table.
pub(crate) struct KeyReader<'v, 'm> {
    table: &'v Keys,
    place: Range<usize>,
    names: &'static [&'static str],
    /// The keys in the table that are none of the names, and close to none that is not there.
    unknown: Vec<&'v str>,
    mistakes: &'m mut ReadError,
}

impl<'v, 'm> KeyReader<'v, 'm> {
    /// Begins to read a table that has no other keys than these. `None` if the value is no table.
    pub(crate) fn of(
        value: &'v Value,
        names: &'static [&'static str],
        mistakes: &'m mut ReadError,
    ) -> Option<Self> {
        let Some(table) = value.as_table() else {
            let keys = format!("a table with the keys {}", names.join(", "));
            mistakes.add(ReadError::expected(value, keys));
            return None;
        };
        let mut unknown = Vec::new();
        for (given, entry) in table.iter().filter(|(key, _)| !names.contains(&key.as_str())) {
            if near(given, names).is_none_or(|name| table.contains_key(name)) {
                unknown.push(given.as_str());
            }
            mistakes.add(Mistake::UnknownKey(entry.key.clone(), given.clone(), names));
        }
        Some(KeyReader { table, place: value.place.clone(), names, unknown, mistakes })
    }

    /// Reads the value of a key; of one that is misspelt, too. Returns `None` if nothing of it can be used.
    pub(crate) fn read<T: Read>(&mut self, name: &'static str) -> Option<T> {
        if let Some(value) = entry_of(self.table, name, self.names) {
            return T::read_usable(value, self.mistakes).or_else(T::unusable);
        }
        // One of the unknown keys may be meant.
        let suggested = || self.unknown.iter().any(|given| suggest(given, &[name]).is_some());
        let may_be_there = T::OPTIONAL && T::unusable().is_none() && !self.unknown.is_empty();
        if may_be_there || suggested() {
            return T::unusable();
        }
        T::missing().or_else(|| {
            self.mistakes.add(Mistake::MissingKey(self.place.clone(), name));
            T::unusable()
        })
    }
}

/// The value of a key of a table with these names; of one that is none of them and close to it, where the key is not
/// there.
pub(crate) fn entry_of<'v>(table: &'v Keys, name: &str, names: &[&str]) -> Option<&'v Value> {
    Some(&table.get(given_key(table, name, names)?)?.value)
}

/// The key of that name as it is spelt in a table with these names.
pub(crate) fn given_key<'v>(table: &'v Keys, name: &'v str, names: &[&str]) -> Option<&'v str> {
    let unknown = || table.keys().map(String::as_str).filter(|key| !names.contains(key));
    let close = || unknown().find(|key| near(key, names) == Some(name));
    if table.contains_key(name) { Some(name) } else { close() }
}

/// The name of a key by that of its field, `let` by `r#let`.
pub(crate) const fn key_name(field: &'static str) -> &'static str {
    match field.as_bytes() {
        [b'r', b'#', ..] => field.split_at(2).1,
        _ => field,
    }
}

/// Reads a type as the value that it holds.
macro_rules! read_as_held {
    ($($name:ident: $held:ty = $shape:expr),*) => {$(
        impl Read for $name {
            const SHAPE: Shape = $shape;
            const OPTIONAL: bool = <$held>::OPTIONAL;

            fn read(value: &Value) -> Result<Self, ReadError> {
                $crate::reader::read_whole(value)
            }
            fn read_usable(value: &Value, mistakes: &mut ReadError) -> Option<Self> {
                Read::read_usable(value, mistakes).map($name)
            }
            fn missing() -> Option<Self> {
                Read::missing().map($name)
            }
        }
    )*};
}
pub(crate) use read_as_held;

/// Declares a struct that is read from a table with the names of its fields as keys.
macro_rules! read_by_keys {
    (
        $(#[$attribute:meta])*
        $visible:vis struct $name:ident {
            $($(#[$doc:meta])* $shown:vis $key:ident: $type:ty,)*
        }
    ) => {
        $(#[$attribute])*
        $visible struct $name {
            $($(#[$doc])* $shown $key: $type,)*
        }

        impl $crate::reader::Read for $name {
            const SHAPE: $crate::reader::Shape = $crate::reader::Shape::Keys(
                &[$((
                    $crate::reader::key_name(stringify!($key)),
                    <$type as $crate::reader::Read>::SHAPE,
                ),)*]
            );

            fn read(
                value: &$crate::reader::Value,
            ) -> Result<Self, $crate::reader::ReadError> {
                $crate::reader::read_whole(value)
            }
            fn read_usable(
                value: &$crate::reader::Value,
                mistakes: &mut $crate::reader::ReadError,
            ) -> Option<Self> {
                use $crate::reader::{KeyReader, key_name};
                let names = const { &[$(key_name(stringify!($key)),)*] };
                let mut keys = KeyReader::of(value, names, mistakes)?;
                // Each is read, also after one that is wrong.
                $(let $key = keys.read(const { key_name(stringify!($key)) });)*
                Some($name { $($key: $key?,)* })
            }
        }
    };
}
pub(crate) use read_by_keys;
