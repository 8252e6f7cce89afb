//! What is wrong with a scene, and where: for each mistake a message with the line that it is about.

use core::fmt;
use core::ops::Range;

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
    /// From 1; none of a line that is not in the file.
    line: Option<usize>,
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
    /// The place in a text, with the number of its line in the file, which settings may have changed.
    fn of(text: &str, file: &str, span: &Range<usize>) -> Place {
        let start = char_boundary(text, span.start);
        let end = char_boundary(text, span.end).max(start);
        // What lies after the last line break is no line of its own.
        let anchor = match text[..start].strip_suffix('\n') {
            Some(before) if start == text.len() => before.len(),
            _ => start,
        };
        let from = text[..anchor].rfind('\n').map_or(0, |i| i + 1);
        let (whole, number) =
            (text[from..].lines().next().unwrap_or_default(), text[..from].matches('\n').count());
        let line: Vec<char> = whole.chars().collect();
        let before = text[from..anchor].chars().count().min(line.len());
        let marked = text[anchor..end.max(anchor)].lines().next().unwrap_or_default();
        let marked = marked.chars().count().clamp(1, (line.len() - before).max(1));
        let skipped = if before + marked > SHOWN { before.saturating_sub(SHOWN / 4) } else { 0 };
        let visible = |c: &char| if c.is_control() && *c != '\t' { '\u{fffd}' } else { *c };
        let shown: String = line.iter().skip(skipped).take(SHOWN).map(visible).collect();
        let caret_end = (before + marked - skipped).min(SHOWN);
        Place {
            line: number_in(file, whole, number),
            column: before + 1,
            shown,
            caret: before - skipped..caret_end,
        }
    }
}

/// The number of a line in a file, from 1: of the one that is nearest to a number from 0.
fn number_in(file: &str, line: &str, number: usize) -> Option<usize> {
    let same = file.lines().enumerate().filter(|(_, other)| *other == line);
    // What lies after the last line break is no line.
    let end = || line.is_empty().then_some(number);
    same.map(|(i, _)| i).min_by_key(|i| i.abs_diff(number)).or_else(end).map(|i| i + 1)
}

impl SceneError {
    pub(super) fn new(source: &str, message: String) -> Self {
        let mistake = Mistake { source: source.into(), place: None, message, help: None };
        SceneError { mistakes: vec![mistake] }
    }

    /// With a place in a text, which is that of a file, or that with settings.
    pub(super) fn at(mut self, text: &str, file: &str, span: Option<Range<usize>>) -> Self {
        self.mistakes[0].place = span.map(|span| Place::of(text, file, &span));
        self
    }

    pub(super) fn with_help(mut self, help: Option<String>) -> Self {
        self.mistakes[0].help = help;
        self
    }

    /// The line of the first mistake, from 1, where it is about one.
    pub fn line(&self) -> Option<usize> {
        self.mistakes[0].place.as_ref().and_then(|place| place.line)
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
        let number = line.map_or(String::new(), |line| line.to_string());
        let margin = " ".repeat(number.len());
        let place = match line {
            Some(line) => format!("{source}:{line}:{column}"),
            None => format!("{source}, changed by --set"),
        };
        let indent: String =
            shown.chars().take(caret.start).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        let marks = "^".repeat(caret.len().max(1));
        write!(f, "{place}: {message}\n{margin} |\n{number} | {shown}")?;
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
    /// Adds mistakes.
    pub(super) fn add(&mut self, error: SceneError) {
        self.0.extend(error.mistakes);
    }

    /// Returns the value if there is no mistake. Otherwise returns all mistakes in the order of the file, and those without
    /// a place last.
    pub(super) fn or<T>(mut self, value: Option<T>) -> Result<T, SceneError> {
        match value {
            Some(value) if self.0.is_empty() => Ok(value),
            _ => {
                let place = |mistake: &Mistake| {
                    let place = mistake.place.as_ref();
                    let line = |place: &Place| (place.line.unwrap_or(usize::MAX - 1), place.column);
                    place.map_or((usize::MAX, 0), line)
                };
                self.0.sort_by_key(place);
                Err(SceneError { mistakes: self.0 })
            }
        }
    }
}

impl core::error::Error for SceneError {}
