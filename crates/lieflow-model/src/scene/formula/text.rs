//! Formulas as a scene has them: texts, or numbers.

use core::fmt;

use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, de};

use super::super::Refusal;
use super::tape::Tape;
use super::{Formula, KeyPath, Names, read_value};

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

    /// The formulas of so many components.
    ///
    /// # Errors
    /// As [`Formula::read`], and a refusal of `key` for another number of them.
    pub fn read(&self, key: &str, count: usize, names: &Names) -> Result<Vec<Formula>, Refusal> {
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
        let found = match self {
            Texts::List(_) => format!("found {found} formulas, expected {count}"),
            Texts::One(_) => {
                let found = if found == 1 { "a number".into() } else { format!("{found} numbers") };
                format!("the value of this formula is {found}, expected a vector of {count}")
            }
        };
        Err(Refusal::at(key, format!("{key}: {found}")))
    }

    /// The entries of the value, row by row, and the number of its rows.
    pub(super) fn read_any(&self, key: &str, names: &Names) -> Result<(usize, Vec<Tape>), Refusal> {
        match self {
            Texts::One(text) => read_value(key, &text.0, names),
            Texts::List(list) if list.is_empty() => {
                Err(Refusal::at(key, format!("{key}: no formulas, expected at least one")))
            }
            Texts::List(list) => {
                let read = |(i, text): (usize, &Text)| {
                    Formula::read(&key.index(i), &text.0, names).map(|formula| formula.tape)
                };
                let tapes = list.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
                Ok((tapes.len(), tapes))
            }
        }
    }
}

/// Reads a formula; where that is allowed, a list of them.
struct AsText;
struct AsTexts;

impl Visitor<'_> for AsText {
    type Value = Text;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a formula: a text or a number")
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Text, E> {
        Ok(Text(text.into()))
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Text, E> {
        match x.is_finite() {
            true => Ok(Text(format!("{x:?}"))),
            false => Err(E::custom(format!("found {x}, expected a finite number"))),
        }
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Text, E> {
        Ok(Text(x.to_string()))
    }
}

impl<'de> Visitor<'de> for AsTexts {
    type Value = Texts;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a formula, or a list of formulas")
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Texts, E> {
        AsText.visit_str(text).map(Texts::One)
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Texts, E> {
        AsText.visit_f64(x).map(Texts::One)
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Texts, E> {
        AsText.visit_i64(x).map(Texts::One)
    }
    fn visit_seq<A: de::SeqAccess<'de>>(self, list: A) -> Result<Texts, A::Error> {
        let list = de::value::SeqAccessDeserializer::new(list);
        Vec::deserialize(list).map(Texts::List)
    }
}

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AsText)
    }
}
impl<'de> Deserialize<'de> for Texts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AsTexts)
    }
}
