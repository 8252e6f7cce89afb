//! A scene as text: its sections, and where each key and entry of it stands.

use core::ops::Range;

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue, ValueDeserializer};

use super::error::{ReadError, Refusal, SceneError};
use super::suggest::help_for;

/// The keys at the top.
pub(super) const TOP: &[&str] = &["title", "problem", "method", "time", "events", "output"];

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
                Err(SceneError::new(source, format!("not TOML: {message}")).at(text, error.span()))
            }
        }
    }

    /// Refuse keys at the top that no scene has.
    pub(super) fn check_top(&self) -> Result<(), SceneError> {
        match self.root.keys().find(|key| !TOP.contains(&key.get_ref().as_ref())) {
            None => Ok(()),
            Some(key) => Err(self
                .error(format!("unknown key `{}`", key.get_ref()), Some(key.span()))
                .with_help(Some(help_for(key.get_ref(), TOP)))),
        }
    }

    /// The value of a key at the top that may be missing, as T.
    pub(super) fn optional<T: for<'de> Deserialize<'de>>(
        &self,
        key: &str,
    ) -> Result<Option<T>, SceneError> {
        let Some(value) = self.root.get(key) else { return Ok(None) };
        T::deserialize(ValueDeserializer::from(value.clone()))
            .map(Some)
            .map_err(|error| self.read_error(key, error.into()))
    }

    /// The value of a key of a section, where it is there and reads as T.
    pub(super) fn within<T: for<'de> Deserialize<'de>>(
        &self,
        section: &str,
        key: &str,
    ) -> Option<T> {
        let DeValue::Table(table) = self.root.get(section)?.get_ref() else { return None };
        T::deserialize(ValueDeserializer::from(table.get(key)?.clone())).ok()
    }

    /// A section, as a table.
    pub(super) fn section(&self, name: &str) -> Result<Spanned<DeTable<'a>>, SceneError> {
        match self.root.get(name) {
            None => Err(self.error(format!("missing section [{name}]"), None)),
            Some(value) => match value.get_ref() {
                DeValue::Table(table) => Ok(Spanned::new(value.span(), table.clone())),
                other => {
                    let found = other.type_str();
                    let message = format!("{name}: found {found}, expected a section [{name}]");
                    Err(self.error(message, Some(value.span())))
                }
            },
        }
    }

    /// The keys of a section, as T.
    pub(super) fn keys<T: for<'de> Deserialize<'de>>(&self, name: &str) -> Result<T, SceneError> {
        T::deserialize(deserializer(self.section(name)?))
            .map_err(|error| self.read_error(name, error.into()))
    }

    /// The keys of a section, as T; the default where there is no such section.
    pub(super) fn keys_if_any<T>(&self, name: &str) -> Result<T, SceneError>
    where
        T: Default + for<'de> Deserialize<'de>,
    {
        if self.root.contains_key(name) { self.keys(name) } else { Ok(T::default()) }
    }

    fn error(&self, message: String, span: Option<Range<usize>>) -> SceneError {
        SceneError::new(self.source, message).at(self.text, span)
    }

    /// Find the place that an error in a section is about.
    pub(super) fn read_error(&self, section: &str, error: ReadError) -> SceneError {
        match error {
            ReadError::Toml(error) => {
                let (message, help) = in_words(error.message(), section);
                self.error(message, error.span()).with_help(help)
            }
            ReadError::Refused(refusal) => self.refusal(section, refusal),
        }
    }

    /// Find the place that a refusal is about: its key, wherever it stands, or else the section.
    pub(super) fn refusal(&self, section: &str, refusal: Refusal) -> SceneError {
        let Refusal { key, message, help } = refusal;
        let place = key.and_then(|key| self.locate(section, &key));
        let place = place.or_else(|| self.root.get(section).map(Spanned::span));
        self.error(message, place).with_help(help)
    }

    /// Where `key`, `key[i]`, `key[i,j]` or `key[i].name[j]` stands, first in this section, then in the
    /// others, then at the top.
    fn locate(&self, section: &str, key: &str) -> Option<Range<usize>> {
        let mut path =
            key.split(['[', ']', ',', '.']).map(str::trim).filter(|step| !step.is_empty());
        let name = path.next()?;
        let within = [section].iter().chain(TOP).find_map(|section| {
            match self.root.get(*section)?.get_ref() {
                DeValue::Table(table) => table.get(name),
                _ => None,
            }
        });
        let mut place = within.or_else(|| self.root.get(name))?;
        for step in path {
            let next = match (step.parse::<usize>(), place.get_ref()) {
                (Ok(i), DeValue::Array(list)) => list.get(i),
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

/// Put a file's text behind its name, where a key names a file: \[name, text\] in the place of the name.
pub(super) fn read_beside(
    section: &mut Spanned<DeTable<'_>>,
    key: &str,
    read: impl Fn(&str) -> Result<String, String>,
) -> Result<(), Refusal> {
    let Some(value) = section.get_mut().get_mut(key) else { return Ok(()) };
    let DeValue::String(name) = value.get_ref() else {
        let found = value.get_ref().type_str();
        return Err(Refusal::at(key, format!("found {found}, expected the name of a file")));
    };
    let text = read(name).map_err(|why| Refusal::at(key, why))?;
    let mut file = DeArray::new();
    for part in [name.clone(), text.into()] {
        file.push(Spanned::new(value.span(), DeValue::String(part)));
    }
    *value.get_mut() = DeValue::Array(file);
    Ok(())
}

/// Ready to be read into keys.
pub(super) fn deserializer(section: Spanned<DeTable<'_>>) -> ValueDeserializer<'_> {
    let span = section.span();
    Spanned::new(span, DeValue::Table(section.into_inner())).into()
}

/// A message of the deserializer in the words of this program, with what may have been meant.
fn in_words(message: &str, section: &str) -> (String, Option<String>) {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if let ["unknown", "field", ..] = message.split(' ').collect::<Vec<_>>()[..]
        && let [given, names @ ..] = &quoted[..]
    {
        return (format!("unknown key `{given}` in [{section}]"), Some(help_for(given, names)));
    }
    if message.starts_with("missing field")
        && let [name] = quoted[..]
    {
        return (format!("missing key `{name}` in [{section}]"), None);
    }
    if message.ends_with("number overflowed") {
        return ("the number is out of range".into(), None);
    }
    let plain = ["invalid type: ", "invalid value: "]
        .iter()
        .find_map(|jargon| message.strip_prefix(jargon))
        .map_or_else(|| message.to_owned(), |rest| format!("found {rest}"));
    let words = [("floating point", "number"), ("sequence", "list"), ("map,", "table,")];
    (words.iter().fold(plain, |text, (from, to)| text.replace(from, to)), None)
}
