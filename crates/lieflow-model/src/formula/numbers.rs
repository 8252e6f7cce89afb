//! Numbers of a scene that are formulas: `omega_body = ["5*deg", "20*deg", "deg"]`.
//!
//! What takes a number takes a text, too: a formula of the names of `[problem.parameters]`, evaluated once, before the
//! values are read. What a value may be is known by its [`Shape`].

use core::ops::Range;
use std::collections::BTreeSet;
use std::sync::Arc;

use super::names::Names;
use super::parameters::{Parameters, words};
use super::parse::{self, parse};
use crate::reader::{Is, Keys, Mistake, Read, ReadError, Shape, Value, given_key};

/// What the formulas of numbers may name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Constants {
    parameters: Parameters,
    names: Names,
    instead: Instead,
}

/// Keys of numbers, each with what to use for numbers that change with time.
pub(crate) type Instead = &'static [(&'static str, &'static str)];

impl Constants {
    /// The constants of a section. Its named formulas and the `varying` names may change with time. The mistakes in its
    /// parameters are left to who reads them.
    pub(crate) fn of(section: Option<&Value>, varying: impl IntoIterator<Item = String>) -> Self {
        let within = |key: &str| section.and_then(|section| section.get(key));
        let lets = within("let").and_then(|lets| lets.as_table());
        let lets = lets.into_iter().flat_map(|lets| lets.keys());
        let mut varying: BTreeSet<String> = varying.into_iter().collect();
        varying.insert("t".into());
        varying.extend(lets.cloned());
        let parameters = within("parameters").and_then(|value| {
            // A parameter with a mistake is there, without a value.
            Parameters::read_usable(value, &mut ReadError::default())
        });
        let parameters = parameters.unwrap_or_default();
        let mut names = Names::of_numbers(Arc::new(varying));
        for name in parameters.all() {
            if names.check("parameters", name).is_ok() {
                names.add_constant(name, parameters.value(name).unwrap_or(f64::NAN));
            }
        }
        Constants { parameters, names, instead: &[] }
    }

    /// These, of a kind with such keys.
    pub(crate) fn with_instead(self, instead: Instead) -> Self {
        Constants { instead, ..self }
    }

    /// Reads a table with these keys, in which texts that stand for numbers are numbers.
    pub(crate) fn read<T>(
        &self,
        value: &Value,
        keys: &[(&str, Shape)],
        mistakes: &mut ReadError,
        read: impl FnOnce(&Value, &mut ReadError) -> Option<T>,
    ) -> Option<T> {
        let mut found = Vec::new();
        if let Some(table) = value.as_table() {
            self.find_in(table, keys, &[], None, &mut found);
        }
        if found.is_empty() {
            return read(value, mistakes);
        }
        let mut with_numbers = value.clone();
        found.iter().for_each(|number| number.put(&mut with_numbers));
        let mut of_values = ReadError::default();
        let read = read(&with_numbers, &mut of_values);
        // The message about a formula that is not a number follows from that.
        let unusable = |place: &Range<usize>| {
            found.iter().any(|number| number.read.is_err() && number.place == *place)
        };
        of_values
            .mistakes
            .retain(|mistake| !matches!(mistake, Mistake::Wrong(place, ..) if unusable(place)));
        found.into_iter().for_each(|number| drop(mistakes.keep(number.read)));
        mistakes.add(of_values);
        read
    }

    /// The value of a text that stands for a number, where it has one.
    pub(crate) fn value(&self, value: &Value) -> Option<f64> {
        let text = value.as_text()?;
        evaluated(value, text, &self.names, &self.parameters, None).ok()
    }

    /// Finds the texts that stand for numbers in a value that is one of these shapes.
    fn find(
        &self,
        value: &Value,
        shapes: &[Shape],
        instead: Option<&'static str>,
        found: &mut Vec<Number>,
    ) {
        let mut flat = Vec::new();
        shapes.iter().for_each(|shape| flatten(*shape, &mut flat));
        match &value.is {
            Is::Text(text) => found.extend(self.number(value, text, &flat, instead)),
            Is::List(list) => {
                let of_entries: Vec<Shape> = flat.iter().filter_map(|s| of_entry(*s)).collect();
                list.iter().for_each(|entry| self.find(entry, &of_entries, instead, found));
            }
            Is::Table(table) => {
                let all = flat.iter().filter_map(|shape| match shape {
                    Shape::TableOf(entry) => Some(**entry),
                    _ => None,
                });
                let of_all: Vec<Shape> = all.collect();
                let keys: Vec<_> = flat.iter().flat_map(|shape| of_keys(*shape)).copied().collect();
                self.find_in(table, &keys, &of_all, instead, found);
            }
            _ => {}
        }
    }

    /// Finds those in a table with these keys, and entries under other names of these shapes.
    fn find_in(
        &self,
        table: &Keys,
        keys: &[(&str, Shape)],
        of_all: &[Shape],
        instead: Option<&'static str>,
        found: &mut Vec<Number>,
    ) {
        let names: Vec<&str> = keys.iter().map(|(name, _)| *name).collect();
        for (given, entry) in table {
            let own = keys
                .iter()
                .filter(|(name, _)| given_key(table, name, &names) == Some(given.as_str()));
            let shapes: Vec<Shape> =
                own.map(|(_, shape)| *shape).chain(of_all.iter().copied()).collect();
            let of_key = || self.instead.iter().find(|(key, _)| *key == given);
            let instead = instead.or_else(|| of_key().map(|(_, instead)| *instead));
            self.find(&entry.value, &shapes, instead, found);
        }
    }

    /// The number that a text stands for, where it stands for one.
    fn number(
        &self,
        value: &Value,
        text: &str,
        shapes: &[Shape],
        instead: Option<&'static str>,
    ) -> Option<Number> {
        let takes_text = |shape: &Shape| {
            matches!(shape, Shape::Text | Shape::Formula | Shape::Formulas | Shape::Samples)
        };
        let takes_number = shapes.contains(&Shape::Number);
        if shapes.iter().any(takes_text) || !takes_number && !shapes.contains(&Shape::Whole) {
            return None;
        }
        let whole = |x: f64| match x.fract() == 0.0 && x.abs() <= WHOLE_MAX {
            true => Ok(Is::from(x as i64)),
            false => Err(not_a(value, text, x, "a whole number")),
        };
        let x = evaluated(value, text, &self.names, &self.parameters, instead);
        let read = match takes_number {
            true => x.map(Is::from),
            false => x.and_then(whole),
        };
        Some(Number { place: value.place.clone(), read })
    }
}

/// Larger numbers may have no place for their last digit.
const WHOLE_MAX: f64 = 9_007_199_254_740_992.0;

/// A text that stands for a number.
struct Number {
    place: Range<usize>,
    read: Result<Is, ReadError>,
}

impl Number {
    /// Puts the number in the place of its text. Where it has none it is NaN, which no key takes.
    fn put(&self, value: &mut Value) {
        match &mut value.is {
            Is::Text(_) if value.place == self.place => {
                value.is = self.read.clone().unwrap_or(Is::from(f64::NAN));
            }
            Is::List(list) => list.iter_mut().for_each(|entry| self.put(entry)),
            Is::Table(table) => table.values_mut().for_each(|entry| self.put(&mut entry.value)),
            _ => {}
        }
    }
}

/// The shapes of which a shape is one.
fn flatten(shape: Shape, into: &mut Vec<Shape>) {
    match shape {
        Shape::Or(a, b) => [a, b].into_iter().for_each(|shape| flatten(*shape, into)),
        other => into.push(other),
    }
}

/// The shape of the entries of a list.
fn of_entry(shape: Shape) -> Option<Shape> {
    match shape {
        Shape::Numbers(_) | Shape::List => Some(Shape::Number),
        Shape::Rows | Shape::Square(_) => Some(Shape::List),
        Shape::Formulas => Some(Shape::Formula),
        Shape::ListOf(entry) => Some(*entry),
        _ => None,
    }
}

/// The keys of a table, with their shapes.
pub(crate) fn of_keys(shape: Shape) -> &'static [(&'static str, Shape)] {
    match shape {
        Shape::Keys(keys) => keys,
        _ => &[],
    }
}

fn not_a(value: &Value, text: &str, found: impl core::fmt::Display, expected: &str) -> ReadError {
    ReadError::of(value, format!("the value of {text:?} is {found}, expected {expected}"))
}

/// The value of the formula that a text is. Its mistake is known where it names a parameter that has one. `instead` is what
/// to use for a formula that changes with time.
pub(super) fn evaluated(
    value: &Value,
    text: &str,
    names: &Names,
    parameters: &Parameters,
    instead: Option<&str>,
) -> Result<f64, ReadError> {
    let parsed =
        parse(text, names).map_err(|parse::Mistake { message, at, help, varies, .. }| {
            let help = instead.filter(|_| varies).map(str::to_owned).or(help);
            ReadError::in_text(value, at, format!("{text:?} is not a number: {message}"), help)
        })?;
    if words(text).any(|word| parameters.is_unusable(word)) {
        return Err(ReadError::known());
    }
    match &parsed.entries[..] {
        [tape] => match tape.value::<f64>(&[], None) {
            x if x.is_finite() => Ok(x),
            x => Err(not_a(value, text, x, "a finite number")),
        },
        entries => {
            let what = if parsed.rows == entries.len() { "a vector" } else { "a matrix" };
            Err(not_a(value, text, format!("{what} of {} numbers", entries.len()), "a number"))
        }
    }
}
