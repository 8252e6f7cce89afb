//! A scene as text: its sections, and where each key and entry of it stands.

use core::iter;
use core::ops::Range;

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue, ValueDeserializer};

use super::error::{Mistakes, ReadError, Refusal, SceneError};
use super::suggest::{help_for, suggest};
use lieflow::names::near;

/// The keys at the top.
pub(super) const TOP: &[&str] = &["title", "problem", "method", "time", "events", "output"];

/// The sections that a scene must have, with lines that may stand there.
const EXAMPLES: [(&str, &str); 2] = [
    ("problem", "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 0, 1]"),
    ("time", "t_span = [0, 10]"),
];

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
    pub(super) fn optional<T: for<'de> Deserialize<'de>>(
        &self,
        key: &str,
    ) -> Result<Option<T>, SceneError> {
        let Some(value) = self.root.get(key) else { return Ok(None) };
        self.read(key, value.clone(), |value| Ok(Some(T::deserialize(value)?)))
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
            None => {
                let example = EXAMPLES.iter().find(|(section, _)| *section == name);
                let help =
                    example.map(|(_, lines)| format!("write such lines:\n[{name}]\n{lines}"));
                Err(self.error(format!("missing section [{name}]"), None).with_help(help))
            }
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
        self.read(name, table(self.section(name)?), |value| Ok(T::deserialize(value)?))
    }

    /// Read a value at the top, and find all its mistakes. A mistake is mended in a copy, and the copy is read for
    /// the next one: until none is left, or until it may come from the mending.
    pub(super) fn read<T>(
        &self,
        name: &str,
        mut value: Spanned<DeValue<'a>>,
        read: impl Fn(ValueDeserializer<'_>) -> Result<T, ReadError>,
    ) -> Result<T, SceneError> {
        let mut mistakes = Mistakes::default();
        let (mut left_out, mut replaced) = (Vec::<String>::new(), Vec::new());
        loop {
            let error = match read(value.clone().into()) {
                Ok(read) => return mistakes.or(Some(read)),
                Err(error) => error,
            };
            let place = self.place(name, &value, &error);
            let mended = match &error {
                ReadError::Toml(_) if !replaced.is_empty() => break,
                ReadError::Refused(_) if !left_out.is_empty() => break,
                ReadError::Toml(error) => {
                    let wrong = Wrong::of(error.message());
                    if let Wrong::MissingKey(key) = wrong
                        && left_out.iter().any(|given| suggest(given, &[key]).is_some())
                    {
                        break;
                    }
                    place.is_some_and(|place| {
                        at_entry(value.get_mut(), &place, &mut |table, key| match &wrong {
                            Wrong::UnknownKey(_, names) if rename(table, &key, names) => {}
                            _ => {
                                table.remove(key.as_str());
                                left_out.push(key);
                            }
                        })
                    })
                }
                ReadError::Refused(_) => {
                    let mended = place.is_some_and(|place| {
                        let is_new = !replaced.contains(&place);
                        is_new && write_over(value.get_mut(), &place) && {
                            replaced.push(place);
                            true
                        }
                    });
                    if !mended && !replaced.is_empty() {
                        break;
                    }
                    mended
                }
            };
            mistakes.keep::<()>(Err(self.read_error(name, &value, error)));
            if !mended {
                break;
            }
        }
        mistakes.or(None)
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
    fn place(
        &self,
        section: &str,
        value: &Spanned<DeValue<'a>>,
        error: &ReadError,
    ) -> Option<Range<usize>> {
        match error {
            ReadError::Toml(error) => error.span(),
            ReadError::Refused(refusal) => self.place_of(section, Some(value), refusal),
        }
    }

    /// An error in a value at the top, with its place.
    fn read_error(
        &self,
        section: &str,
        value: &Spanned<DeValue<'a>>,
        error: ReadError,
    ) -> SceneError {
        let place = self.place(section, value, &error);
        let (message, help) = match error {
            ReadError::Toml(error) => Wrong::of(error.message()).in_words(section),
            ReadError::Refused(Refusal { message, help, .. }) => (message, help),
        };
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
        value: Option<&Spanned<DeValue<'a>>>,
        refusal: &Refusal,
    ) -> Option<Range<usize>> {
        let place = refusal.key.as_ref().and_then(|key| self.locate(section, value, key));
        place.or_else(|| self.root.get(section).map(Spanned::span))
    }

    /// Where `key`, `key[i]`, `key[i,j]` or `key[i].name[j]` ([`KeyPath`](super::KeyPath)) stands, first in this
    /// value, then in this section, then in the others, then at the top.
    fn locate(
        &self,
        section: &str,
        value: Option<&Spanned<DeValue<'a>>>,
        key: &str,
    ) -> Option<Range<usize>> {
        let mut path =
            key.split(['[', ']', ',', '.']).map(str::trim).filter(|step| !step.is_empty());
        let name = path.next()?;
        let others = iter::once(&section).chain(TOP).filter_map(|section| self.root.get(*section));
        let within = value.into_iter().chain(others).find_map(|value| match value.get_ref() {
            DeValue::Table(table) => table.get(name),
            _ => None,
        });
        let mut place = within.or_else(|| self.root.get(name))?;
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

/// A section as a value.
pub(super) fn table(section: Spanned<DeTable<'_>>) -> Spanned<DeValue<'_>> {
    Spanned::new(section.span(), DeValue::Table(section.into_inner()))
}

/// Calls `act` on the innermost table entry that contains a place. Returns false if no entry contains it.
fn at_entry<'a>(
    value: &mut DeValue<'a>,
    place: &Range<usize>,
    act: &mut dyn FnMut(&mut DeTable<'a>, String),
) -> bool {
    let found = match value {
        DeValue::Table(table) => {
            table.iter_mut().any(|(_, value)| at_entry(value.get_mut(), place, act))
        }
        DeValue::Array(list) => list.iter_mut().any(|entry| at_entry(entry.get_mut(), place, act)),
        _ => false,
    };
    let DeValue::Table(table) = value else { return found };
    let holds = |span: Range<usize>| span.start <= place.start && place.end <= span.end;
    let mut entries = table.iter();
    let entry = entries.find(|(key, value)| holds(key.span()) || holds(value.span()));
    match entry.map(|(key, _)| key.get_ref().to_string()) {
        Some(key) if !found => {
            act(table, key);
            true
        }
        _ => found,
    }
}

/// Give an entry the name that is spelt like its own, where that is free.
fn rename(table: &mut DeTable<'_>, given: &str, names: &[&str]) -> bool {
    let Some(meant) = near(given, names).filter(|meant| !table.contains_key(*meant)) else {
        return false;
    };
    table.remove_entry(given).is_some_and(|(key, value)| {
        table.insert(Spanned::new(key.span(), meant.to_owned().into()), value);
        true
    })
}

/// Write a formula over the text at a place; false where there is no text.
fn write_over(value: &mut DeValue<'_>, place: &Range<usize>) -> bool {
    let within = |value: &mut Spanned<DeValue<'_>>| match value.get_ref() {
        DeValue::String(_) if value.span() == *place => {
            *value.get_mut() = DeValue::String("0".into());
            true
        }
        _ => write_over(value.get_mut(), place),
    };
    match value {
        DeValue::Table(table) => table.iter_mut().any(|(_, value)| within(value)),
        DeValue::Array(list) => list.iter_mut().any(within),
        _ => false,
    }
}

/// A mistake that the deserializer found.
enum Wrong<'m> {
    /// A key, and those that there are.
    UnknownKey(&'m str, Vec<&'m str>),
    MissingKey(&'m str),
    Value(&'m str),
}

impl<'m> Wrong<'m> {
    /// Reads the kind of mistake from the message of the deserializer, which gives nothing else.
    fn of(message: &'m str) -> Self {
        let mut quoted = message.split('`').skip(1).step_by(2);
        match quoted.next() {
            Some(given) if message.starts_with("unknown field") => {
                Wrong::UnknownKey(given, quoted.collect())
            }
            Some(name) if message.starts_with("missing field") => Wrong::MissingKey(name),
            _ => Wrong::Value(message),
        }
    }

    /// The message in the words of this program, and a suggestion.
    fn in_words(&self, section: &str) -> (String, Option<String>) {
        let message = match self {
            Wrong::UnknownKey(given, names) => {
                let message = format!("unknown key `{given}` in [{section}]");
                return (message, Some(help_for(given, names)));
            }
            Wrong::MissingKey(name) => {
                return (format!("missing key `{name}` in [{section}]"), None);
            }
            Wrong::Value(message) => message,
        };
        if message.ends_with("number overflowed") {
            return ("the number is out of range".into(), None);
        }
        let plain = ["invalid type: ", "invalid value: "]
            .iter()
            .find_map(|jargon| message.strip_prefix(jargon))
            .map_or_else(|| message.to_string(), |rest| format!("found {rest}"));
        let words = [("floating point", "number"), ("sequence", "list"), ("map,", "table,")];
        (words.iter().fold(plain, |text, (from, to)| text.replace(from, to)), None)
    }
}
