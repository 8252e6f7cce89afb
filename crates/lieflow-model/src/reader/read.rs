//! Reads values of a scene. Each type says what it is read from, and each mistake has its place.

use core::fmt::Display;
use core::ops::Range;
use std::collections::BTreeMap;

use lieflow::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::refusal::Refusal;
use super::suggest::help_for;

/// A value of a scene, with its place in the text.
pub type Value<'a> = Spanned<DeValue<'a>>;

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
    /// A table with these keys.
    Keys(&'static [&'static str]),
    /// One of two.
    Or(&'static Shape, &'static Shape),
    /// The name of a file of samples.
    Samples,
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
    /// [`ReadError`] for a value of another type, and for one that cannot be used.
    fn read(value: &Value<'_>) -> Result<Self, ReadError>;

    /// What a missing key means. `None` if the key must be there.
    fn missing() -> Option<Self> {
        None
    }
}

/// Why a value cannot be read.
#[derive(Clone, Debug)]
pub enum ReadError {
    /// A key that does not exist, and the keys that do.
    UnknownKey(Range<usize>, String, &'static [&'static str]),
    /// A key that must be in the table at this place.
    MissingKey(Range<usize>, &'static str),
    /// A value that is not what is expected: its place and the message.
    Wrong(Range<usize>, String),
    /// A value that cannot be used. The place is found by its key.
    Refused(Refusal),
}

impl From<Refusal> for ReadError {
    fn from(refusal: Refusal) -> Self {
        ReadError::Refused(refusal)
    }
}
impl From<Error> for ReadError {
    fn from(error: Error) -> Self {
        ReadError::Refused(error.into())
    }
}

impl ReadError {
    /// A mistake in a value.
    pub fn of(value: &Value<'_>, message: impl Into<String>) -> Self {
        ReadError::Wrong(value.span(), message.into())
    }

    /// A value where something else is expected.
    pub fn expected(value: &Value<'_>, expected: impl Display) -> Self {
        let found = match value.get_ref() {
            DeValue::String(text) => format!("the text {text:?}"),
            DeValue::Integer(n) => n.to_string(),
            DeValue::Float(x) => x.to_string(),
            DeValue::Boolean(x) => x.to_string(),
            DeValue::Datetime(_) => "a date".into(),
            DeValue::Array(_) => "a list".into(),
            DeValue::Table(_) => "a table".into(),
        };
        Self::of(value, format!("found {found}, expected {expected}"))
    }

    /// The message of an error in a section, and a suggestion.
    pub(crate) fn in_words(self, section: &str) -> (String, Option<String>) {
        match self {
            ReadError::UnknownKey(_, given, names) => {
                (format!("unknown key `{given}` in [{section}]"), Some(help_for(&given, names)))
            }
            ReadError::MissingKey(_, name) => {
                (format!("missing key `{name}` in [{section}]"), None)
            }
            ReadError::Wrong(_, message) => (message, None),
            ReadError::Refused(Refusal { message, help, .. }) => (message, help),
        }
    }
}

impl Read for String {
    const SHAPE: Shape = Shape::Text;

    fn read(value: &Value<'_>) -> Result<Self, ReadError> {
        let text = value.get_ref().as_str();
        text.map(str::to_owned).ok_or_else(|| ReadError::expected(value, "a text"))
    }
}

impl Read for bool {
    const SHAPE: Shape = Shape::Bool;

    fn read(value: &Value<'_>) -> Result<Self, ReadError> {
        let known = value.get_ref().as_bool();
        known.ok_or_else(|| ReadError::expected(value, "true or false"))
    }
}

impl<T: Read> Read for Option<T> {
    const SHAPE: Shape = T::SHAPE;
    const OPTIONAL: bool = true;

    fn read(value: &Value<'_>) -> Result<Self, ReadError> {
        T::read(value).map(Some)
    }
    fn missing() -> Option<Self> {
        Some(None)
    }
}

impl<T: Read> Read for Vec<T> {
    const SHAPE: Shape = Shape::ListOf(&T::SHAPE);

    fn read(value: &Value<'_>) -> Result<Self, ReadError> {
        let list = value.get_ref().as_array();
        let list = list.ok_or_else(|| ReadError::expected(value, "a list"))?;
        list.iter().map(T::read).collect()
    }
}

/// A table of any keys. A missing one is empty.
impl<T: Read> Read for BTreeMap<String, T> {
    const SHAPE: Shape = Shape::TableOf(&T::SHAPE);
    const OPTIONAL: bool = true;

    fn read(value: &Value<'_>) -> Result<Self, ReadError> {
        let table = value.get_ref().as_table();
        let table = table.ok_or_else(|| ReadError::expected(value, "a table"))?;
        table.iter().map(|(key, value)| Ok((key.get_ref().to_string(), T::read(value)?))).collect()
    }
    fn missing() -> Option<Self> {
        Some(BTreeMap::new())
    }
}

/// Reads the values of the keys of a table. All values are read before a missing key is told.
pub(crate) struct KeyReader<'v, 'a> {
    table: &'v DeTable<'a>,
    place: Range<usize>,
    /// The mistakes, each with its key.
    mistakes: Vec<(&'v str, ReadError)>,
}

impl<'v, 'a> KeyReader<'v, 'a> {
    /// Begins to read a table that has no other keys than these.
    pub(crate) fn of(
        value: &'v Value<'a>,
        names: &'static [&'static str],
    ) -> Result<Self, ReadError> {
        let DeValue::Table(table) = value.get_ref() else {
            let keys = format!("a table with the keys {}", names.join(", "));
            return Err(ReadError::expected(value, keys));
        };
        let unknown = table.keys().find(|key| !names.contains(&key.get_ref().as_ref()));
        let mistake = unknown.map(|key| {
            let given: &str = key.get_ref();
            (given, ReadError::UnknownKey(key.span(), given.into(), names))
        });
        Ok(KeyReader { table, place: value.span(), mistakes: mistake.into_iter().collect() })
    }

    /// Reads the value of a key. Returns `None` if the key is missing or its value has a mistake.
    pub(crate) fn read<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&Value<'_>) -> Result<T, ReadError>,
    ) -> Option<T> {
        let found = read(self.table.get(name)?);
        found.map_err(|error| self.mistakes.push((name, error))).ok()
    }

    /// Returns the mistake with the first key in the alphabet.
    pub(crate) fn check(&mut self) -> Result<(), ReadError> {
        let first = self.mistakes.drain(..).min_by_key(|(name, _)| *name);
        first.map_or(Ok(()), |(_, error)| Err(error))
    }

    /// The value of a key, or what its type takes if the key is missing.
    pub(crate) fn or_missing<T: Read>(
        &self,
        name: &'static str,
        value: Option<T>,
    ) -> Result<T, ReadError> {
        let missing = || ReadError::MissingKey(self.place.clone(), name);
        value.or_else(T::missing).ok_or_else(missing)
    }
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

            fn read(value: &Value<'_>) -> Result<Self, ReadError> {
                Read::read(value).map($name)
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
                &[$($crate::reader::key_name(stringify!($key)),)*]
            );

            fn read(
                value: &$crate::reader::Value<'_>,
            ) -> Result<Self, $crate::reader::ReadError> {
                use $crate::reader::{KeyReader, Read, key_name};
                let mut keys = KeyReader::of(value, const { &[$(key_name(stringify!($key)),)*] })?;
                $(let $key = keys.read(const { key_name(stringify!($key)) }, Read::read);)*
                keys.check()?;
                Ok($name {
                    $($key: keys.or_missing(const { key_name(stringify!($key)) }, $key)?,)*
                })
            }
        }
    };
}
pub(crate) use read_by_keys;
