//! Formulas with names, which other formulas use.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::expression::Formula;
use super::names::{Entry, Names, continues_name, entry_name, without_places};
use super::text::NamedTexts;
use crate::reader::{Key, KeyPath, Read, ReadError, Refusal, Shape, Value, read_as_held, seen};

read_as_held!(Lets: BTreeMap<String, Key<NamedTexts>> = Shape::TableOf(&NamedTexts::SHAPE));

/// `[problem.let]`: formulas with names, which other formulas may use, `b = "3*t"`.
#[derive(Clone, Debug, Default)]
pub struct Lets(BTreeMap<String, Key<NamedTexts>>);

/// More named formulas than this are refused.
const LETS_MAX: usize = 256;

impl Lets {
    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The names, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// Checks the form of all formulas, where their names are not known yet. `key` is their table in the scene.
    ///
    /// # Errors
    /// As [`Formula::check_form`], of all formulas.
    pub fn check_form(&self, key: &str) -> Result<(), ReadError> {
        let mut mistakes = ReadError::default();
        for (name, texts) in &self.0 {
            if let Ok(texts) = texts {
                mistakes.keep(texts.check_form(&key.entry(name)));
            }
        }
        mistakes.or(Some(()))
    }

    /// The formula that a name in a text belongs to: that of the name, or of the vector or matrix x by x1 or x12.
    fn of<'a>(&'a self, word: &str) -> Option<&'a str> {
        let whole = || self.0.get_key_value(without_places(word));
        let found = self.0.get_key_value(word).or_else(whole)?;
        Some(found.0)
    }
}

impl Names {
    /// These names and named formulas, which may use each other in any order. `key` is their table in the scene.
    ///
    /// A formula that cannot be read, has a name that is taken, or needs itself is a mistake that
    /// [`checked`](Self::checked) returns. Other formulas that need it cannot be read, without a mistake of their own.
    pub fn with_lets(mut self, key: &str, lets: &Lets) -> Names {
        if lets.0.len() > LETS_MAX {
            let message = format!("found {} formulas, expected at most {LETS_MAX}", lets.0.len());
            self.mistakes.add(Refusal::at(key, message));
        }
        let mut reader = LetReader::new(key, lets, true);
        for name in lets.names().take(LETS_MAX) {
            reader.path.clear();
            let read = reader.define(name, &mut self);
            let mut mistakes = core::mem::take(&mut self.mistakes);
            mistakes.keep(read);
            self.mistakes = mistakes;
        }
        self
    }

    /// Adds the formulas of [`with_lets`](Self::with_lets) that can be used with these names. A formula hides a variable of
    /// the same name, also where it cannot be used.
    pub fn with_usable_lets(mut self, key: &str, lets: &Lets) -> Names {
        let mut reader = LetReader::new(key, lets, false);
        for name in lets.names().take(LETS_MAX) {
            reader.path.clear();
            // Why it cannot be used is kept in the names.
            let _ = reader.define(name, &mut self);
        }
        self
    }

    /// The named formulas of a table, by the name of each entry.
    pub fn entries_of<'a>(
        &'a self,
        lets: &'a Lets,
    ) -> impl Iterator<Item = (&'a str, String, Formula)> + 'a {
        lets.names().flat_map(move |name| {
            let of_this = move |entry: &&Entry| lets.of(&entry.name) == Some(name);
            let entries = self.formulas.iter().filter(of_this);
            entries.map(|Entry { name, key, text, tape, .. }| {
                (
                    lets.of(name).unwrap_or(name),
                    name.clone(),
                    Formula::of(tape.clone(), key, text, self),
                )
            })
        })
    }
}

/// Reads named formulas.
struct LetReader<'a> {
    key: &'a str,
    lets: &'a Lets,
    /// Is a name refused that has a meaning already?
    refuses_taken: bool,
    /// Those that need the one that is read.
    path: Vec<&'a str>,
    done: BTreeSet<&'a str>,
}

impl<'a> LetReader<'a> {
    fn new(key: &'a str, lets: &'a Lets, refuses_taken: bool) -> Self {
        LetReader { key, lets, refuses_taken, path: Vec::new(), done: BTreeSet::new() }
    }

    /// Read a named formula, and before it those that it needs.
    fn define(&mut self, name: &'a str, names: &mut Names) -> Result<(), ReadError> {
        let place = self.key.entry(name);
        if let Some(start) = self.path.iter().position(|above| *above == name) {
            let circle = [&self.path[start..], &[name]].concat().join(" needs ");
            let message = format!("{place}: a formula cannot need itself: {circle}");
            return Err(Refusal::at(place, message).into());
        }
        let lets = self.lets;
        let texts = lets.0.get(name).filter(|_| self.done.insert(name));
        let Some(texts) = texts else { return Ok(()) };
        self.path.push(name);
        let read = seen(texts).and_then(|texts| self.read(name, texts, names));
        self.path.pop();
        if let Err(error) = &read {
            let why = error.message().filter(|_| !self.refuses_taken);
            names.unusable.push((name.into(), why.map(str::to_owned)));
        }
        read
    }

    fn read(&mut self, name: &str, texts: &NamedTexts, names: &mut Names) -> Result<(), ReadError> {
        let (place, lets) = (self.key.entry(name), self.lets);
        for word in texts.texts().flat_map(|text| text.split(|c| !continues_name(c))) {
            if let Some(needed) = lets.of(word) {
                if needed == name && word != name && names.meaning(word).is_some() {
                    let message = format!(
                        "{place}: `{word}` is a part of `{name}`, and the name of something else: rename one of them"
                    );
                    return Err(Refusal::at(place, message).into());
                }
                self.define(needed, names)?;
            }
        }
        if self.refuses_taken {
            names.check_new(&place, name)?;
        }
        let (rows, tapes) = texts.read_any(&place, names)?;
        let columns = tapes.len() / rows;
        for (i, tape) in tapes.into_iter().enumerate() {
            let (key, text) = texts.entry(&place, i);
            let name = match (rows, columns) {
                (1, 1) => name.to_owned(),
                (_, 1) => format!("{name}{}", i + 1),
                _ => entry_name(name, [rows, columns], [i / columns + 1, i % columns + 1]),
            };
            if self.refuses_taken {
                names.check(&place, &name)?;
            }
            let within = (rows * columns > 1).then(|| place.clone());
            let entry = Entry { name, within, key, text: text.into(), tape };
            Arc::make_mut(&mut names.formulas).push(entry);
        }
        Ok(())
    }
}
