//! What is wrong with a scene, and where: for each mistake a message with the line that it is about.

use core::fmt;
use core::ops::Range;

use lieflow::Error;

use super::suggest::help_for;

/// Why a scene cannot be used: its mistakes, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// At least one.
    mistakes: Vec<Mistake>,
}

/// A mistake: the file, the line with a caret, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Mistake {
    source: String,
    place: Option<Place>,
    message: String,
    help: Option<String>,
}

/// More mistakes than this are counted and not shown.
const MISTAKES: usize = 10;

#[derive(Clone, Debug, PartialEq, Eq)]
struct Place {
    line: usize,
    column: usize,
    /// The line, or the part of it around the caret, without control characters.
    shown: String,
    /// Characters of `shown` before the caret, and below it.
    caret: Range<usize>,
}

/// The most characters of a line that are shown.
const SHOWN: usize = 100;

/// The last boundary of characters up to `i`.
fn char_boundary(text: &str, i: usize) -> usize {
    let mut i = i.min(text.len());
    while !text.is_char_boundary(i) {
        i -= 1;
    }
    i
}

impl Place {
    fn of(text: &str, span: &Range<usize>) -> Place {
        let start = char_boundary(text, span.start);
        let end = char_boundary(text, span.end).max(start);
        // What lies after the last line break is no line of its own.
        let anchor = match text[..start].strip_suffix('\n') {
            Some(before) if start == text.len() => before.len(),
            _ => start,
        };
        let from = text[..anchor].rfind('\n').map_or(0, |i| i + 1);
        let line: Vec<char> = text[from..].lines().next().unwrap_or_default().chars().collect();
        let before = text[from..anchor].chars().count().min(line.len());
        let marked = text[anchor..end.max(anchor)].lines().next().unwrap_or_default();
        let marked = marked.chars().count().clamp(1, (line.len() - before).max(1));
        let skipped = if before + marked > SHOWN { before.saturating_sub(SHOWN / 4) } else { 0 };
        let visible = |c: &char| if c.is_control() && *c != '\t' { '\u{fffd}' } else { *c };
        let shown: String = line.iter().skip(skipped).take(SHOWN).map(visible).collect();
        let caret_end = (before + marked - skipped).min(SHOWN);
        Place {
            line: text[..from].matches('\n').count() + 1,
            column: before + 1,
            shown,
            caret: before - skipped..caret_end,
        }
    }
}

impl SceneError {
    pub(super) fn new(source: &str, message: String) -> Self {
        let mistake = Mistake { source: source.into(), place: None, message, help: None };
        SceneError { mistakes: vec![mistake] }
    }

    pub(super) fn at(mut self, text: &str, span: Option<Range<usize>>) -> Self {
        self.mistakes[0].place = span.map(|span| Place::of(text, &span));
        self
    }

    pub(super) fn with_help(mut self, help: Option<String>) -> Self {
        self.mistakes[0].help = help;
        self
    }

    /// The line of the first mistake, from 1, where it is about one.
    pub fn line(&self) -> Option<usize> {
        self.mistakes[0].place.as_ref().map(|place| place.line)
    }

    /// The message of the first mistake, without its place.
    pub fn message(&self) -> &str {
        &self.mistakes[0].message
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, others @ ..] = &self.mistakes[..] else { return Ok(()) };
        if others.is_empty() {
            return first.fmt(f);
        }
        write!(f, "{}: {} mistakes", first.source, self.mistakes.len())?;
        self.mistakes.iter().take(MISTAKES).try_for_each(|mistake| write!(f, "\n\n{mistake}"))?;
        match self.mistakes.len().saturating_sub(MISTAKES) {
            0 => Ok(()),
            more => write!(f, "\n\nand {more} more"),
        }
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Mistake { source, place, message, help } = self;
        let Some(Place { line, column, shown, caret }) = place else {
            write!(f, "{source}: {message}")?;
            return write_help(f, "", help.as_deref());
        };
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        let indent: String =
            shown.chars().take(caret.start).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        let marks = "^".repeat(caret.len().max(1));
        write!(f, "{source}:{line}:{column}: {message}\n{margin} |\n{number} | {shown}")?;
        write!(f, "\n{margin} | {indent}{marks}")?;
        write_help(f, &margin, help.as_deref())
    }
}

/// Writes the suggestion. Lines after the first are lines for the scene, and are indented.
fn write_help(f: &mut fmt::Formatter<'_>, margin: &str, help: Option<&str>) -> fmt::Result {
    let mut lines = help.unwrap_or_default().lines();
    lines.next().map_or(Ok(()), |first| write!(f, "\n{margin} = {first}"))?;
    lines.try_for_each(|line| write!(f, "\n{margin}       {line}"))
}

/// The mistakes that have been found so far.
#[derive(Debug, Default)]
pub(super) struct Mistakes(Vec<Mistake>);

impl Mistakes {
    /// Returns the value, or keeps its mistakes.
    pub(super) fn keep<T>(&mut self, read: Result<T, SceneError>) -> Option<T> {
        read.map_err(|error| self.0.extend(error.mistakes)).ok()
    }

    /// True if no mistake was found so far.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the value if there is no mistake. Otherwise returns all mistakes in the order of the file, and those without
    /// a place last.
    pub(super) fn or<T>(mut self, value: Option<T>) -> Result<T, SceneError> {
        match value {
            Some(value) if self.is_empty() => Ok(value),
            _ => {
                let place = |mistake: &Mistake| {
                    let place = mistake.place.as_ref();
                    place.map_or((usize::MAX, 0), |place| (place.line, place.column))
                };
                self.0.sort_by_key(place);
                Err(SceneError { mistakes: self.0 })
            }
        }
    }
}

impl core::error::Error for SceneError {}

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

/// An argument of the library, whose lists count from 0, as a path.
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
                Error::OutOfRange { arg: path_of(&arg), value, expected }
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
            Error::OutOfRange { arg, .. } => Some(arg),
            Error::NotFiniteEntry { arg, row, col, .. } => Some(format!("{arg}[{row},{col}]")),
            Error::NotSquare { arg, .. }
            | Error::Shape { arg, .. }
            | Error::NotInAlgebra { arg, .. }
            | Error::NotOnGroup { arg, .. }
            | Error::Reflection { arg }
            | Error::Singular { arg, .. } => Some(arg.into()),
            Error::Unsupported { what, .. } => Some(what.into()),
            _ => None,
        };
        Refusal { key, ..Refusal::section(message) }
    }
}

/// One of two keys.
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
    let mut given = keys.into_iter().filter(|(_, given)| *given).map(|(key, _)| key);
    match (given.next(), given.next()) {
        (Some(a), Some(b)) => {
            Err(Refusal::at(b, format!("both `{a}` and `{b}`, expected exactly one of them")))
        }
        (first, _) => Ok(first),
    }
}

/// The one of two keys that is there.
///
/// # Errors
/// Both are there, or none.
pub fn exactly_one<A, B>(
    (a, first): (&str, Option<A>),
    (b, second): (&str, Option<B>),
) -> Result<Either<A, B>, Refusal> {
    at_most_one([(a, first.is_some()), (b, second.is_some())])?;
    match (first, second) {
        (Some(value), _) => Ok(Either::First(value)),
        (None, Some(value)) => Ok(Either::Second(value)),
        (None, None) => Err(Refusal::section(format!("expected `{a}` or `{b}`, found neither"))),
    }
}
