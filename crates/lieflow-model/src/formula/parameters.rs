//! `[problem.parameters]`: constants that the numbers and the formulas of a scene share.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::names::{Names, continues_name};
use super::numbers::evaluated;
use crate::reader::values::Real;
use crate::reader::{Entry, KeyPath, Keys, Mistake, Read, ReadError, Refusal, Shape, Value};

/// `[problem.parameters]`: constants, `k = 3.0`. Each may be a formula of others, `w = "sqrt(k/m)"`, in any order.
#[derive(Clone, Debug, Default)]
pub struct Parameters(BTreeMap<String, Constant>);

/// The value of a constant. `None` if its mistake is reported already.
type Constant = Option<f64>;

impl FromIterator<(String, Real)> for Parameters {
    fn from_iter<I: IntoIterator<Item = (String, Real)>>(parameters: I) -> Self {
        Parameters(parameters.into_iter().map(|(name, x)| (name, Some(x.0))).collect())
    }
}

impl Parameters {
    /// The names and their values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0.iter().filter_map(|(name, x)| Some((name.as_str(), (*x)?)))
    }

    /// All names.
    pub(super) fn all(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }

    /// The value of a parameter that has one.
    pub(super) fn value(&self, name: &str) -> Option<f64> {
        self.0.get(name).copied().flatten()
    }

    /// Is it the name of a parameter whose mistake is known?
    pub(super) fn is_unusable(&self, name: &str) -> bool {
        self.0.get(name).is_some_and(Option::is_none)
    }

    /// These variables, in the order of their values, and the parameters.
    ///
    /// # Errors
    /// A refusal of `key` for a variable that is not a valid name (letters, digits and underscores, no digit first), and of
    /// each parameter that has the name of a variable.
    pub fn names<N: Into<String>>(
        &self,
        key: &str,
        variables: impl IntoIterator<Item = N>,
    ) -> Result<Names, ReadError> {
        let (mut names, mut mistakes) = (Names::of(key, variables)?, ReadError::default());
        for (name, value) in &self.0 {
            match (names.check_new(&"parameters".entry(name), name), value) {
                (Ok(()), Some(value)) => names.add_constant(name, *value),
                // With a wrong number formulas can be read, and not run.
                (Ok(()), None) => names.add_constant(name, f64::NAN),
                (Err(refusal), Some(_)) => mistakes.add(refusal),
                (Err(_), None) => {}
            }
        }
        mistakes.or(Some(names))
    }
}

impl Read for Parameters {
    const SHAPE: Shape = Shape::TableOf(&Shape::Formula);
    const OPTIONAL: bool = true;

    fn read(value: &Value) -> Result<Self, ReadError> {
        crate::reader::read_whole(value)
    }
    fn read_usable(value: &Value, mistakes: &mut ReadError) -> Option<Self> {
        let Some(table) = value.as_table() else {
            mistakes.add(ReadError::expected(value, "a table"));
            return None;
        };
        let time = BTreeSet::from(["t".to_string()]);
        let names = Names::of_numbers(Arc::new(time));
        let mut reader =
            Reader { table, names, path: Vec::new(), done: Parameters::default(), mistakes };
        table.keys().for_each(|key| reader.define(key));
        Some(reader.done)
    }
    fn missing() -> Option<Self> {
        Some(Parameters::default())
    }
}

/// The most parameters of which each needs the next.
const LONGEST_CHAIN: usize = 256;

/// Evaluates parameters, each after those that it needs.
struct Reader<'v, 'm> {
    table: &'v Keys,
    /// Those that are done.
    names: Names,
    done: Parameters,
    /// Those that need the one that is evaluated.
    path: Vec<&'v str>,
    mistakes: &'m mut ReadError,
}

impl<'v> Reader<'v, '_> {
    fn define(&mut self, name: &'v str) {
        let entry = self.table.get(name).filter(|_| !self.done.0.contains_key(name));
        let Some(Entry { key, value }) = entry else { return };
        let wrong = match self.path.iter().position(|above| *above == name) {
            Some(start) => {
                let circle = [&self.path[start..], &[name]].concat().join(" needs ");
                Some(format!("parameters.{name}: a number cannot need itself: {circle}"))
            }
            None => (self.path.len() >= LONGEST_CHAIN).then(|| {
                let most = LONGEST_CHAIN;
                format!("parameters.{name}: expected at most {most} parameters that need each other in a row")
            }),
        };
        if let Some(message) = wrong {
            self.mistakes.add(ReadError::of(value, message));
            self.done.0.insert(name.into(), None);
            self.names.add_constant(name, f64::NAN);
            return;
        }
        let evaluated = match (self.names.check("parameters", name), value.as_text()) {
            (Err(Refusal { message, help, .. }), _) => {
                Err(Mistake::Wrong(key.clone(), message, help).into())
            }
            (Ok(()), Some(text)) => {
                self.path.push(name);
                for word in words(text) {
                    if let Some((needed, _)) = self.table.get_key_value(word) {
                        self.define(needed);
                    }
                }
                self.path.pop();
                evaluated(value, text, &self.names, &self.done, None)
            }
            (Ok(()), None) => Real::read(value).map(|x| x.0),
        };
        // In a circle it is known already to have no value.
        let constant = self.mistakes.keep(evaluated);
        let constant = *self.done.0.entry(name.into()).or_insert(constant);
        self.names.add_constant(name, constant.unwrap_or(f64::NAN));
    }
}

/// The names in a text.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c| !continues_name(c))
}
