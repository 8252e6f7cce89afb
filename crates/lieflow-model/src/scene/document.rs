//! A scene as text: its sections, and where each key and entry of it stands.

use core::iter;
use core::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{Mistakes, SceneError};
use crate::formula::DECIMAL_POINT;
use crate::reader::Refusal;
use crate::reader::help_for;
use crate::reader::{Found, every_mistake, rename};
use crate::reader::{Read, ReadError, Value};

/// The keys at the top.
pub(super) const TOP: &[&str] = &["title", "problem", "method", "time", "events", "output"];

/// The sections that a scene must have, with lines that may stand there.
const EXAMPLES: [(&str, &str); 2] = [
    ("problem", "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 0, 1]"),
    ("time", "t_span = [0, 10]"),
];

/// True if a comma between two digits is at this place, or just before it.
fn has_decimal_comma(text: &[u8], at: usize) -> bool {
    let digit = |i: usize| text.get(i).is_some_and(u8::is_ascii_digit);
    let comma = |i: usize| text.get(i) == Some(&b',') && digit(i.wrapping_sub(1)) && digit(i + 1);
    comma(at) || comma(at.wrapping_sub(1))
}

/// A parsed scene file.
pub(super) struct Document<'a> {
    source: &'a str,
    text: &'a str,
    root: DeTable<'a>,
}

impl<'a> Document<'a> {
    pub(super) fn parse(source: &'a str, text: &'a str) -> Result<Self, SceneError> {
        match DeTable::parse(text) {
            Ok(root) => Ok(Document { source, text, root: root.into_inner() }),
            Err(error) => {
                let message = error.message().lines().collect::<Vec<_>>().join("; ");
                let refused = SceneError::new(source, format!("not TOML: {message}"));
                let at = error.span().map_or(0, |span| span.start);
                let help = has_decimal_comma(text.as_bytes(), at).then(|| DECIMAL_POINT.into());
                Err(refused.at(text, error.span()).with_help(help))
            }
        }
    }

    /// What the scene says, without comments, spaces and the order of keys.
    pub(super) fn says(&self) -> String {
        without_places(&self.root)
    }

    /// Refuse keys at the top that no scene has. What is close to a key of a scene is read as that key.
    pub(super) fn check_top(&mut self) -> Result<(), SceneError> {
        let mut mistakes = Mistakes::default();
        let unknown = |key: &&Spanned<_>| !TOP.contains(&AsRef::<str>::as_ref(key.get_ref()));
        let unknown: Vec<_> = self.root.keys().filter(unknown).cloned().collect();
        for key in unknown {
            let error = self.error(format!("unknown key `{}`", key.get_ref()), Some(key.span()));
            mistakes.keep::<()>(Err(error.with_help(Some(help_for(key.get_ref(), TOP)))));
            rename(&mut self.root, key.get_ref(), TOP);
        }
        mistakes.or(Some(()))
    }

    /// The value of a key at the top that may be missing, as T.
    pub(super) fn optional<T: Read>(&self, key: &str) -> Result<Option<T>, SceneError> {
        let Some(value) = self.root.get(key) else { return Ok(None) };
        self.read(key, value.clone(), Read::read)
    }

    /// The value of a key of a section, where it is there and reads as T.
    pub(super) fn within<T: Read>(&self, section: &str, key: &str) -> Option<T> {
        T::read(self.root.get(section)?.get_ref().get(key)?).ok()
    }

    /// The entries of a list at the top; none where it is missing.
    pub(super) fn entries(&self, key: &str) -> Result<Vec<Value<'a>>, SceneError> {
        let Some(value) = self.root.get(key) else { return Ok(Vec::new()) };
        match value.get_ref().as_array() {
            Some(list) => Ok(list.iter().cloned().collect()),
            None => Err(self.expected(value, &format!("a list: [[{key}]]"))),
        }
    }

    /// A section, which is a table.
    pub(super) fn section(&self, name: &str) -> Result<Value<'a>, SceneError> {
        match self.root.get(name) {
            None => {
                let example = EXAMPLES.iter().find(|(section, _)| *section == name);
                let help =
                    example.map(|(_, lines)| format!("write such lines:\n[{name}]\n{lines}"));
                Err(self.error(format!("missing section [{name}]"), None).with_help(help))
            }
            Some(section) if section.get_ref().is_table() => Ok(section.clone()),
            Some(other) => Err(self.expected(other, &format!("a section [{name}]"))),
        }
    }

    /// Reads a value at the top, and finds all its mistakes.
    pub(super) fn read<T>(
        &self,
        name: &str,
        value: Value<'a>,
        read: impl Fn(&Value<'_>) -> Result<T, ReadError>,
    ) -> Result<T, SceneError> {
        let place = |value: &Value<'a>, error: &ReadError| self.place(name, value, error);
        every_mistake(self.text, value, &place, read).or_else(|found| {
            let mut mistakes = Mistakes::default();
            for found in found {
                mistakes.keep::<()>(Err(self.read_error(name, found)));
            }
            mistakes.or(None)
        })
    }

    /// The keys of a section, as T; the default where there is no such section.
    pub(super) fn keys_if_any<T: Default + Read>(&self, name: &str) -> Result<T, SceneError> {
        if !self.root.contains_key(name) {
            return Ok(T::default());
        }
        self.read(name, self.section(name)?, T::read)
    }

    /// The error for a value where something else is expected.
    fn expected(&self, value: &Value<'_>, expected: &str) -> SceneError {
        self.read_error("", (Some(value.span()), ReadError::expected(value, expected)))
    }

    fn error(&self, message: String, span: Option<Range<usize>>) -> SceneError {
        SceneError::new(self.source, message).at(self.text, span)
    }

    /// Gives a refusal of a section the place that it is about.
    pub(super) fn check<T>(
        &self,
        section: &str,
        checked: Result<T, Refusal>,
    ) -> Result<T, SceneError> {
        checked.map_err(|refusal| self.refusal(section, refusal))
    }

    /// Gives all refusals of a section their places. No refusal is no error.
    pub(super) fn check_all(
        &self,
        section: &str,
        refusals: Vec<Refusal>,
    ) -> Result<(), SceneError> {
        let mut mistakes = Mistakes::default();
        for refusal in refusals {
            mistakes.keep::<()>(Err(self.refusal(section, refusal)));
        }
        mistakes.or(Some(()))
    }

    /// The place that an error in a value at the top is about.
    fn place(&self, section: &str, value: &Value<'a>, error: &ReadError) -> Option<Range<usize>> {
        match error {
            ReadError::UnknownKey(place, ..)
            | ReadError::MissingKey(place, _)
            | ReadError::Wrong(place, _) => Some(place.clone()),
            ReadError::Refused(refusal) => self.place_of(section, Some(value), refusal),
        }
    }

    /// An error in a value at the top, with its place.
    fn read_error(&self, section: &str, (place, error): Found) -> SceneError {
        let (message, help) = error.in_words(section);
        self.error(message, place).with_help(help)
    }

    /// A refusal with its place.
    pub(super) fn refusal(&self, section: &str, refusal: Refusal) -> SceneError {
        let place = self.place_of(section, None, &refusal);
        self.error(refusal.message, place).with_help(refusal.help)
    }

    /// The place that a refusal is about: its key, wherever it stands, or else the section.
    fn place_of(
        &self,
        section: &str,
        value: Option<&Value<'a>>,
        refusal: &Refusal,
    ) -> Option<Range<usize>> {
        let place = refusal.key.as_ref().and_then(|key| self.locate(section, value, key));
        place.or_else(|| self.root.get(section).map(Spanned::span))
    }

    /// Where `key`, `key[i]`, `key[i,j]` or `key[i].name[j]` ([`KeyPath`](super::KeyPath)) stands, first in this
    /// value, then in this section, then in the others, then at the top.
    fn locate(&self, section: &str, value: Option<&Value<'a>>, key: &str) -> Option<Range<usize>> {
        let mut path =
            key.split(['[', ']', ',', '.']).map(str::trim).filter(|step| !step.is_empty());
        let name = path.next()?;
        let others = iter::once(&section).chain(TOP).filter_map(|section| self.root.get(*section));
        let within = value.into_iter().chain(others).find_map(|value| match value.get_ref() {
            DeValue::Table(table) => table.get(name),
            _ => None,
        });
        let mut place = within.or_else(|| self.root.get(name))?;
        if let Some(entry) = value.filter(|_| name == section) {
            // The value is one of the list, with the number that is next.
            place = entry;
            path.next();
        }
        for step in path {
            let next = match (step.parse::<usize>(), place.get_ref()) {
                (Ok(i), DeValue::Array(list)) => list.get(i.wrapping_sub(1)),
                (_, DeValue::Table(table)) => table.get(step),
                _ => None,
            };
            match next {
                Some(next) => place = next,
                None => break,
            }
        }
        Some(place.span())
    }
}

/// A section in which the text of a file stands behind its name, where a key names a file: \[name, text\].
pub(super) fn with_file<'a>(
    section: &Value<'a>,
    key: &str,
    read: impl Fn(&str) -> Result<String, String>,
) -> Result<Value<'a>, ReadError> {
    let mut section = section.clone();
    let DeValue::Table(table) = section.get_mut() else { return Ok(section) };
    let Some(value) = table.get_mut(key) else { return Ok(section) };
    let DeValue::String(name) = value.get_ref() else {
        return Err(ReadError::expected(value, "the name of a file"));
    };
    let text = read(name).map_err(|why| Refusal::at(key, why))?;
    let parts = [name.clone(), text.into()].map(DeValue::String);
    let file = parts.map(|part| Spanned::new(value.span(), part)).into_iter().collect();
    *value.get_mut() = DeValue::Array(file);
    Ok(section)
}

/// A table without the places of its values.
fn without_places(table: &DeTable<'_>) -> String {
    let entry = |(key, value): (&Spanned<_>, &Value<'_>)| {
        format!("{:?}: {}", key.get_ref(), without_place(value.get_ref()))
    };
    format!("{{{}}}", table.iter().map(entry).collect::<Vec<_>>().join(", "))
}

/// A value without its place. Numbers are compared as numbers: 1e-3 is 0.001.
fn without_place(value: &DeValue<'_>) -> String {
    match value {
        DeValue::Integer(n) => format!("Integer({n})"),
        DeValue::Float(x) => format!("Float({:?})", x.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Array(list) => {
            let list: Vec<_> = list.iter().map(|entry| without_place(entry.get_ref())).collect();
            format!("Array([{}])", list.join(", "))
        }
        DeValue::Table(table) => format!("Table({})", without_places(table)),
        other => format!("{other:?}"),
    }
}
