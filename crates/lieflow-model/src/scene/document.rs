//! A scene as text: its sections, and where each key and entry of it stands.

use core::iter;
use core::ops::Range;

use toml::de::DeTable;

use super::brackets::unclosed;
use super::error::{Mistakes, SceneError};
use super::keys::sections;
use crate::formula::{Constants, DECIMAL_POINT, of_keys};
use crate::kinds;
use crate::problem::KeyInfo;
use crate::reader::{
    Entry, Is, Keys, Mistake, Read, ReadError, Refusal, Value, entry_of, given_key, is_known,
    keys_of, suggest,
};

/// The keys at the top.
pub(super) const TOP: &[&str] =
    &["title", "units", "problem", "method", "time", "events", "output"];

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

/// What to do about a text that is not TOML, by the place of the mistake.
fn help_for_text(text: &str, place: Range<usize>) -> Option<String> {
    if has_decimal_comma(text.as_bytes(), place.start) {
        return Some(DECIMAL_POINT.into());
    }
    let wrong = text.get(place)?;
    if let Some(quote) = wrong.chars().find(|c| "“”„‟‘’‚‛«»".contains(*c)) {
        return Some(format!("`{quote}` is no plain quotation mark: write \""));
    }
    // Two values of a list with a space between them.
    let mut values = wrong.split_whitespace();
    let is_value = |value: &str| value.parse::<f64>().is_ok() || value.starts_with(['[', '"']);
    let pair = values.next().zip(values.next());
    let (first, second) = pair.filter(|(first, second)| is_value(first) && is_value(second))?;
    Some(format!("a comma is missing: {first}, {second}"))
}

/// What formulas of numbers may name.
fn constants_of(root: &Keys) -> Constants {
    let Some(problem) = entry_of(root, "problem", TOP) else {
        return Constants::of(None, []);
    };
    let kind = problem.get("kind").and_then(Value::as_text);
    let kind = kind.and_then(|kind| kinds::named(kind).ok());
    kind.map_or_else(|| Constants::of(Some(problem), []), |kind| kind.constants(problem))
}

/// A parsed scene file.
pub(super) struct Document<'a> {
    source: &'a str,
    text: &'a str,
    /// The text without settings.
    file: &'a str,
    root: Keys,
    /// What formulas of numbers may name.
    constants: Constants,
}

impl<'a> Document<'a> {
    /// Parses a text, which is that of a file, or that with settings.
    pub(super) fn parse(source: &'a str, text: &'a str, file: &'a str) -> Result<Self, SceneError> {
        let (root, mistakes) = DeTable::parse_recoverable(text);
        // Those within values come after all others. Only the first in the text does not follow from another one.
        let start = |error: &toml::de::Error| error.span().unwrap_or_default().start;
        let line = |error: &toml::de::Error| text[..start(error)].matches('\n').count();
        let Some(error) = mistakes.into_iter().min_by_key(line) else {
            let root = keys_of(root.into_inner());
            let constants = constants_of(&root);
            return Ok(Document { source, text, file, root, constants });
        };
        if let Some((place, message)) = unclosed(text, start(&error)) {
            return Err(SceneError::new(source, message).at(text, file, Some(place)));
        }
        let message = error.message().lines().collect::<Vec<_>>().join("; ");
        let refused = SceneError::new(source, format!("not TOML: {message}"));
        let help = help_for_text(text, error.span().unwrap_or_default());
        Err(refused.at(text, file, error.span()).with_help(help))
    }

    /// What the scene says, without comments, spaces and the order of keys.
    pub(super) fn says(&self) -> String {
        without_places(&self.root)
    }

    /// The keys at the top that no scene has.
    fn unknown(&self) -> impl Iterator<Item = (&String, &Entry)> {
        self.root.iter().filter(|(key, _)| !TOP.contains(&key.as_str()))
    }

    /// Refuses the keys at the top that no scene has.
    pub(super) fn check_top(&self) -> Result<(), ReadError> {
        let mistake = |(key, entry): (&String, &Entry)| {
            Mistake::UnknownKey(entry.key.clone(), key.clone(), TOP)
        };
        ReadError { mistakes: self.unknown().map(mistake).collect() }.or(Some(()))
    }

    /// The value of a key at the top; of one that is misspelt, too.
    pub(super) fn get(&self, key: &str) -> Option<&Value> {
        entry_of(&self.root, key, TOP)
    }

    /// The value of a key of a section, where it is there and reads as T.
    pub(super) fn within<T: Read>(&self, section: &str, key: &str) -> Option<T> {
        T::read(self.get(section)?.get(key)?).ok()
    }

    /// The entries of a list at the top. Empty if it is missing.
    pub(super) fn entries(&self, key: &str) -> Result<&[Value], ReadError> {
        let Some(value) = self.get(key) else { return Ok(&[]) };
        value.as_list().ok_or_else(|| ReadError::expected(value, format!("a list: [[{key}]]")))
    }

    /// A section, which is a table.
    pub(super) fn section(&self, name: &str) -> Result<&Value, ReadError> {
        match self.get(name) {
            // An unknown key may be meant to be this one.
            None if self.unknown().any(|(key, _)| suggest(key, &[name]).is_some()) => {
                Err(ReadError::known())
            }
            None => {
                let example = EXAMPLES.iter().find(|(section, _)| *section == name);
                let help =
                    example.map(|(_, lines)| format!("write such lines:\n[{name}]\n{lines}"));
                let missing = Refusal::section(format!("missing section [{name}]"));
                Err(Refusal { help, ..missing }.into())
            }
            Some(section) if section.as_table().is_some() => Ok(section),
            Some(other) => Err(ReadError::expected(other, format!("a section [{name}]"))),
        }
    }

    /// A refusal with its place.
    pub(super) fn refusal(&self, section: &str, refusal: Refusal) -> SceneError {
        self.mistake(section, Mistake::Refused(refusal))
    }

    /// A mistake in a section with its place.
    pub(super) fn mistake(&self, section: &str, mistake: Mistake) -> SceneError {
        let (place, formula) = match &mistake {
            Mistake::UnknownKey(place, ..)
            | Mistake::MissingKey(place, _)
            | Mistake::Wrong(place, ..) => (Some(place.clone()), None),
            Mistake::Refused(Refusal { key, .. }) => {
                let value = key.as_ref().and_then(|key| self.locate(section, key));
                let place = value.or_else(|| self.get(section)).map(|value| value.place.clone());
                (place, value.and_then(|value| self.value_of(value)))
            }
        };
        let other = match &mistake {
            Mistake::UnknownKey(_, given, names) => self.other_section(section, given, names),
            _ => None,
        };
        let (message, help) = mistake.in_words(section);
        let help = other.or(help);
        let help = formula.into_iter().chain(help).reduce(|formula, help| formula + "; " + &help);
        SceneError::new(self.source, message).at(self.text, self.file, place).with_help(help)
    }

    /// What to do about an unknown key that another section has. A section that is misspelt is no key.
    fn other_section(&self, section: &str, given: &str, names: &[&str]) -> Option<String> {
        let is_section = self.get(given).is_some_and(|value| value.as_table().is_some());
        if is_section && names == TOP {
            return None;
        }
        let kind = self.within::<String>("problem", "kind");
        let mut sections = sections(kind.as_deref()).into_iter();
        let (other, _) = sections.find(|(name, keys)| *name != section && keys.contains(&given))?;
        (!is_known(given, names)).then(|| format!("`{given}` is a key of [{other}]"))
    }

    /// Where `key`, `key[i]`, `key[i,j]` or `key[i].name[j]` ([`KeyPath`](super::KeyPath)) stands, first in this
    /// section, then in the others, then at the top.
    fn locate(&self, section: &str, key: &str) -> Option<&Value> {
        let mut path =
            key.split(['[', ']', ',', '.']).map(str::trim).filter(|step| !step.is_empty());
        let name = path.next()?;
        let sections = iter::once(&section).chain(TOP).filter_map(|section| self.get(section));
        let within = sections.filter_map(|section| section.as_table());
        // A key with this name, and else one that is misspelt.
        let exact = within.clone().find_map(|table| Some(&table.get(name)?.value));
        let close = || within.clone().find_map(|table| entry_of(table, name, &[name]));
        let mut place = exact.or_else(|| self.get(name)).or_else(close)?;
        for step in path {
            let next = match (step.parse::<usize>(), &place.is) {
                (Ok(i), Is::List(list)) => list.get(i.wrapping_sub(1)),
                (_, Is::Table(table)) => entry_of(table, step, &[step]),
                _ => None,
            };
            match next {
                Some(next) => place = next,
                None => break,
            }
        }
        Some(place)
    }

    /// The value of a text that is a formula of a number, in words.
    fn value_of(&self, value: &Value) -> Option<String> {
        let text = value.as_text().filter(|text| text.parse::<f64>().is_err())?;
        let x = self.constants.value(value)?;
        Some(format!("the value of {text:?} is {x}"))
    }
}

/// The mistakes in a document that have been found so far.
pub(super) struct Finder<'d, 'a> {
    document: &'d Document<'a>,
    mistakes: Mistakes,
}

impl<'d, 'a> Finder<'d, 'a> {
    pub(super) fn new(document: &'d Document<'a>) -> Self {
        Finder { document, mistakes: Mistakes::default() }
    }

    /// Returns the value, or keeps its mistakes, which are in this section.
    pub(super) fn keep<T, E: Into<ReadError>>(
        &mut self,
        section: &str,
        read: Result<T, E>,
    ) -> Option<T> {
        read.map_err(|error| self.add(section, error.into())).ok()
    }

    /// Reads what can be used of a value in a section, and keeps its mistakes.
    pub(super) fn read<T: Read>(&mut self, section: &str, value: &Value) -> Option<T> {
        let (mut mistakes, keys) = (ReadError::default(), of_keys(T::SHAPE));
        let read = self.document.constants.read(value, keys, &mut mistakes, T::read_usable);
        self.add(section, mistakes);
        read
    }

    /// Reads the keys of a section, all of which may be missing, as the section may be.
    pub(super) fn read_if_any<T: Read>(&mut self, section: &str) -> Option<T> {
        let none = Value { place: 0..0, is: Is::Table(Keys::new()) };
        let value = match self.document.get(section) {
            Some(_) => self.keep(section, self.document.section(section))?,
            None => &none,
        };
        self.read(section, value)
    }

    /// Adds refusals of keys of a section.
    pub(super) fn refuse(&mut self, section: &str, refusals: Vec<Refusal>) {
        self.add(section, refusals.into());
    }

    fn add(&mut self, section: &str, error: ReadError) {
        for mistake in error.mistakes {
            self.mistakes.add(self.document.mistake(section, mistake));
        }
    }

    /// Returns the value if there is no mistake.
    pub(super) fn or<T>(self, value: Option<T>) -> Result<T, SceneError> {
        self.mistakes.or(value)
    }
}

/// Puts the text of a file behind its name, where a key of a section names a file: \[name, text\]. An empty list stands
/// for a file whose mistake is known.
pub(super) fn with_file(
    section: &mut Value,
    key: &str,
    keys: &[KeyInfo],
    read: impl Fn(&str) -> Result<String, String>,
) -> Result<(), ReadError> {
    let Is::Table(table) = &mut section.is else { return Ok(()) };
    let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
    let Some(given) = given_key(table, key, &names).map(str::to_owned) else { return Ok(()) };
    let Some(Entry { value, .. }) = table.get_mut(&given) else { return Ok(()) };
    let text = match &value.is {
        Is::Text(name) => read(name).map_err(|why| Refusal::at(key, why).into()),
        _ => Err(ReadError::expected(value, "the name of a file")),
    };
    let name = value.as_text().unwrap_or_default().to_owned();
    let parts = text.as_ref().map_or(Vec::new(), |text| vec![name, text.clone()]);
    let part = |text| Value { place: value.place.clone(), is: Is::Text(text) };
    value.is = Is::List(parts.into_iter().map(part).collect());
    text.map(|_| ())
}

/// A table without the places of its values.
fn without_places(table: &Keys) -> String {
    let entry =
        |(key, entry): (&String, &Entry)| format!("{key:?}: {}", without_place(&entry.value));
    format!("{{{}}}", table.iter().map(entry).collect::<Vec<_>>().join(", "))
}

/// A value without its place. Numbers are compared as numbers: 1e-3 is 0.001.
fn without_place(value: &Value) -> String {
    match &value.is {
        Is::Bool(x) => format!("Boolean({x})"),
        Is::Whole(n) => format!("Integer({})", n.text),
        Is::Number(x) => format!("Float({:?})", x.text.parse().unwrap_or(f64::NAN)),
        Is::Text(text) => format!("String({text:?})"),
        Is::Date(date) => format!("Datetime({date})"),
        Is::List(list) => {
            let list: Vec<_> = list.iter().map(without_place).collect();
            format!("Array([{}])", list.join(", "))
        }
        Is::Table(table) => format!("Table({})", without_places(table)),
    }
}
