//! A value of a scene or of a program, with its place.

use core::ops::Range;
use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value, with its place.
#[derive(Clone, Debug)]
pub struct Value {
    /// The bytes of the text where the value stands. Without a text it is a place that no other value has.
    pub place: Range<usize>,
    /// What the value is.
    pub is: Is,
}

/// What a value is.
#[derive(Clone, Debug)]
pub enum Is {
    /// True or false.
    Bool(bool),
    /// A whole number.
    Whole(Written<i128>),
    /// A number.
    Number(Written<f64>),
    /// A text: a name or a formula.
    Text(String),
    /// A date.
    Date(String),
    /// A list. A matrix is a list of its rows.
    List(Vec<Value>),
    /// Keys with their values.
    Table(Keys),
}

/// A number as it is written.
#[derive(Clone, Debug)]
pub struct Written<T> {
    /// The text.
    pub text: String,
    /// The number. `None` if it is out of range.
    pub value: Option<T>,
}

/// Keys with their values.
pub type Keys = BTreeMap<String, Entry>;

/// The value of a key, with the place of the key.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The place of the key.
    pub key: Range<usize>,
    /// The value.
    pub value: Value,
}

impl From<f64> for Is {
    fn from(x: f64) -> Self {
        Is::Number(Written { text: format!("{x:?}").to_lowercase(), value: Some(x) })
    }
}
impl From<i64> for Is {
    fn from(n: i64) -> Self {
        Is::Whole(Written { text: n.to_string(), value: Some(n.into()) })
    }
}

impl Value {
    /// The text, where it is one.
    pub fn as_text(&self) -> Option<&str> {
        match &self.is {
            Is::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The entries, where it is a list.
    pub fn as_list(&self) -> Option<&[Value]> {
        match &self.is {
            Is::List(list) => Some(list),
            _ => None,
        }
    }

    /// The keys, where it is a table.
    pub fn as_table(&self) -> Option<&Keys> {
        match &self.is {
            Is::Table(keys) => Some(keys),
            _ => None,
        }
    }

    /// The value of a key, where it is a table with that key.
    pub fn get(&self, key: &str) -> Option<&Value> {
        Some(&self.as_table()?.get(key)?.value)
    }
}

/// Is the number x, which is written by these digits, neither infinite nor 0 by underflow?
pub(crate) fn is_in_range(x: f64, digits: &str) -> bool {
    let mut significant = digits.chars().take_while(|c| !matches!(c, 'e' | 'E'));
    x.is_finite() && (x != 0.0 || !significant.any(|c| matches!(c, '1'..='9')))
}

/// The value that is written in TOML.
impl From<Spanned<DeValue<'_>>> for Value {
    fn from(value: Spanned<DeValue<'_>>) -> Self {
        let place = value.span();
        let is = match value.into_inner() {
            DeValue::Boolean(x) => Is::Bool(x),
            DeValue::Integer(n) => Is::Whole(Written {
                text: n.to_string(),
                value: i128::from_str_radix(n.as_str(), n.radix()).ok(),
            }),
            DeValue::Float(x) => {
                let is_word = x.as_str().ends_with(|c: char| c.is_alphabetic());
                let parsed = x.as_str().parse().ok();
                let value = parsed.filter(|&value| is_word || is_in_range(value, x.as_str()));
                Is::Number(Written { text: x.to_string(), value })
            }
            DeValue::String(text) => Is::Text(text.into_owned()),
            DeValue::Datetime(date) => Is::Date(date.to_string()),
            DeValue::Array(list) => Is::List(list.into_iter().map(Value::from).collect()),
            DeValue::Table(table) => Is::Table(keys_of(table)),
        };
        Value { place, is }
    }
}

/// The keys of a table that is written in TOML.
pub(crate) fn keys_of(table: DeTable<'_>) -> Keys {
    let entry = |(key, value): (Spanned<_>, _)| {
        let place = key.span();
        (String::from(key.into_inner()), Entry { key: place, value: Value::from(value) })
    };
    table.into_iter().map(entry).collect()
}
