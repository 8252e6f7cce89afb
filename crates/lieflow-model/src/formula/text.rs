//! Formulas as a scene has them: texts, or numbers.

use super::expression::{Formula, read_value};
use super::names::Names;
use super::tape::Tape;
use crate::reader::values::Real;
use crate::reader::{Is, KeyPath, Read, ReadError, Refusal, Shape, Value, Written, amount};

/// A formula: a text, or a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text(pub String);

/// Formulas: a list of them; or a single one, whose value is a number, a vector or a matrix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Texts {
    /// One text.
    One(Text),
    /// One text for each component.
    List(Vec<Text>),
}

impl Texts {
    /// All texts.
    pub(super) fn texts(&self) -> impl Iterator<Item = &str> {
        let texts = match self {
            Texts::One(text) => core::slice::from_ref(text),
            Texts::List(list) => list,
        };
        texts.iter().map(|text| text.0.as_str())
    }

    /// The place and the text of an entry of the value, from 0; `key` is that of all.
    pub(super) fn entry(&self, key: &str, i: usize) -> (String, &str) {
        match self {
            Texts::One(text) => (key.into(), &text.0),
            Texts::List(list) => (key.index(i), list.get(i).map_or("", |text| &text.0)),
        }
    }

    /// The formulas of this number of components.
    ///
    /// # Errors
    /// As [`Formula::read`], of all formulas, and a refusal of `key` for another number of them.
    pub fn read(&self, key: &str, count: usize, names: &Names) -> Result<Vec<Formula>, ReadError> {
        let (rows, tapes) = self.read_any(key, names)?;
        let found = tapes.len();
        if found == count && (rows == count || count == 1) {
            let entries = tapes.into_iter().enumerate();
            let formula = |(i, tape)| {
                let (key, text) = self.entry(key, i);
                Formula::of(tape, &key, text, names)
            };
            return Ok(entries.map(formula).collect());
        }
        if matches!(self, Texts::List(_)) {
            return Err(other_count(key, found, count));
        }
        let found = if found == 1 { "a number".into() } else { format!("{found} numbers") };
        let message =
            format!("{key}: the value of this formula is {found}, expected a vector of {count}");
        Err(Refusal::at(key, message).into())
    }

    /// The formulas of this number of components, where both the number and the names are known.
    ///
    /// # Errors
    /// As [`read`](Self::read). Of those, where something is not known: mistakes whatever names mean, and another number of
    /// formulas in a list.
    pub fn read_by(
        &self,
        key: &str,
        count: Option<usize>,
        names: Result<&Names, ReadError>,
    ) -> Result<Vec<Formula>, ReadError> {
        if let (Some(count), Ok(names)) = (count, &names) {
            return self.read(key, count, names);
        }
        self.check_form(key)?;
        match (self, count) {
            (Texts::List(list), Some(count)) if list.len() != count => {
                Err(other_count(key, list.len(), count))
            }
            _ => Err(ReadError::known()),
        }
    }

    /// Checks the form of all formulas, where their names are not known.
    ///
    /// # Errors
    /// As [`Formula::check_form`], of all formulas.
    pub(super) fn check_form(&self, key: &str) -> Result<(), ReadError> {
        match self {
            Texts::List(list) if list.is_empty() => Err(no_formulas(key)),
            _ => check_forms(self.texts(), |i| self.entry(key, i).0),
        }
    }

    /// The entries of the value, row by row, and the number of its rows.
    pub(super) fn read_any(
        &self,
        key: &str,
        names: &Names,
    ) -> Result<(usize, Vec<Tape>), ReadError> {
        match self {
            Texts::One(text) => read_value(key, &text.0, names),
            Texts::List(list) if list.is_empty() => Err(no_formulas(key)),
            Texts::List(list) => {
                let mut mistakes = ReadError::default();
                let tapes = list.iter().enumerate().map(|(i, text)| {
                    let formula = mistakes.keep(Formula::read(&key.index(i), &text.0, names));
                    formula.map(|formula| formula.tape)
                });
                // Each is read, also after one that is wrong.
                let tapes: Vec<_> = tapes.collect();
                let tapes = mistakes.or(tapes.into_iter().collect::<Option<Vec<_>>>())?;
                Ok((tapes.len(), tapes))
            }
        }
    }
}

/// Checks the form of each text; `place` is that of the text with a number.
fn check_forms<'t>(
    texts: impl Iterator<Item = &'t str>,
    place: impl Fn(usize) -> String,
) -> Result<(), ReadError> {
    let mut mistakes = ReadError::default();
    for (i, text) in texts.enumerate() {
        mistakes.keep(Formula::check_form(&place(i), text));
    }
    mistakes.or(Some(()))
}

fn no_formulas(key: &str) -> ReadError {
    Refusal::at(key, format!("{key}: no formulas, expected at least one")).into()
}

fn other_count(key: &str, found: usize, count: usize) -> ReadError {
    let found = amount(found, "formulas");
    Refusal::at(key, format!("{key}: found {found}, expected {count}")).into()
}

/// A formula with a name: [`Texts`], or rows of the entries of a matrix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NamedTexts {
    /// One text, whose value may be a vector or a matrix, or a text for each entry of a vector.
    Texts(Texts),
    /// Rows of one text for each entry; all have as many.
    Rows(Vec<Vec<Text>>),
}

impl NamedTexts {
    /// Checks the form of all formulas, where their names are not known.
    ///
    /// # Errors
    /// As [`Formula::check_form`], of all formulas.
    pub(super) fn check_form(&self, key: &str) -> Result<(), ReadError> {
        match self {
            NamedTexts::Texts(texts) => texts.check_form(key),
            NamedTexts::Rows(_) => check_forms(self.texts(), |i| self.entry(key, i).0),
        }
    }

    /// All texts.
    pub(super) fn texts(&self) -> impl Iterator<Item = &str> {
        let (texts, rows) = match self {
            NamedTexts::Texts(texts) => (Some(texts.texts()), &[][..]),
            NamedTexts::Rows(rows) => (None, &rows[..]),
        };
        texts.into_iter().flatten().chain(rows.iter().flatten().map(|text| text.0.as_str()))
    }

    /// The place and the text of an entry of the value, from 0; `key` is that of all.
    pub(super) fn entry(&self, key: &str, i: usize) -> (String, &str) {
        match self {
            NamedTexts::Texts(texts) => texts.entry(key, i),
            NamedTexts::Rows(rows) => {
                let columns = rows.first().map_or(1, Vec::len).max(1);
                let (row, column) = (i / columns, i % columns);
                let text = rows.get(row).and_then(|row| row.get(column));
                (key.cell(row, column), text.map_or("", |text| &text.0))
            }
        }
    }

    /// The entries of the value, row by row, and the number of its rows.
    pub(super) fn read_any(
        &self,
        key: &str,
        names: &Names,
    ) -> Result<(usize, Vec<Tape>), ReadError> {
        let rows = match self {
            NamedTexts::Texts(texts) => return texts.read_any(key, names),
            NamedTexts::Rows(rows) => rows,
        };
        let columns = rows.first().map_or(0, Vec::len);
        if let Some(i) = rows.iter().position(|row| row.len() != columns || row.is_empty()) {
            let expected = if columns == 0 { "at least 1".into() } else { columns.to_string() };
            let message = format!(
                "{key}: row {} has {}, expected {expected}",
                i + 1,
                amount(rows[i].len(), "formulas")
            );
            return Err(Refusal::at(key.index(i), message).into());
        }
        let mut mistakes = ReadError::default();
        let texts = rows.iter().flatten().enumerate();
        let tapes = texts.map(|(i, text)| {
            let (key, _) = self.entry(key, i);
            mistakes.keep(Formula::read(&key, &text.0, names)).map(|formula| formula.tape)
        });
        // Each is read, also after one that is wrong.
        let tapes: Vec<_> = tapes.collect();
        let tapes = mistakes.or(tapes.into_iter().collect::<Option<Vec<_>>>())?;
        Ok((rows.len(), tapes))
    }
}

impl Read for NamedTexts {
    const SHAPE: Shape =
        Shape::Or(&Shape::Formulas, &Shape::ListOf(&Shape::ListOf(&Shape::Formula)));

    fn read(value: &Value) -> Result<Self, ReadError> {
        let entries = value.as_list().into_iter().flatten();
        let mut is_row = entries.map(|entry| entry.as_list().is_some());
        match (is_row.clone().any(|row| row), is_row.all(|row| row)) {
            (false, _) => <Texts as Read>::read(value).map(NamedTexts::Texts),
            (true, true) => Vec::read(value).map(NamedTexts::Rows),
            (true, false) => {
                let message =
                    "found formulas beside rows, expected either formulas or rows of formulas";
                Err(ReadError::of(value, message))
            }
        }
    }
}

impl Read for Text {
    const SHAPE: Shape = Shape::Formula;

    fn read(value: &Value) -> Result<Self, ReadError> {
        match &value.is {
            Is::Text(text) => Ok(Text(text.clone())),
            Is::Whole(Written { value: Some(n), .. }) => Ok(Text(n.to_string())),
            Is::Whole(_) | Is::Number(_) => Real::read(value).map(|x| Text(format!("{:?}", x.0))),
            _ => Err(ReadError::expected(value, "a formula: a text or a number")),
        }
    }
}

impl Read for Texts {
    const SHAPE: Shape = Shape::Formulas;

    fn read(value: &Value) -> Result<Self, ReadError> {
        match value.is {
            Is::List(_) => Vec::read(value).map(Texts::List),
            Is::Text(_) | Is::Whole(_) | Is::Number(_) => Text::read(value).map(Texts::One),
            _ => Err(ReadError::expected(value, "a formula, or a list of formulas")),
        }
    }
}
