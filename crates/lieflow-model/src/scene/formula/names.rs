//! The names that a formula may use: the variables of its kind, and the constants of the scene.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::super::Refusal;
use super::super::values::Real;
use super::functions::{CALLED, CONSTANTS};

/// `[problem.parameters]`: constants that the formulas of a scene share, `k = 3.0`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Parameters(BTreeMap<String, Real>);

impl FromIterator<(String, Real)> for Parameters {
    fn from_iter<I: IntoIterator<Item = (String, Real)>>(parameters: I) -> Self {
        Parameters(parameters.into_iter().collect())
    }
}

impl Parameters {
    /// The names and their values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0.iter().map(|(name, x)| (name.as_str(), x.0))
    }

    /// These variables, in the order of their values, and the parameters.
    ///
    /// # Errors
    /// A refusal of `key` for a variable, and of `parameters` for a parameter, that is no name (letters,
    /// digits and underscores, no digit first), or has that of another, or of a function.
    pub fn names<N: Into<String>>(
        &self,
        key: &str,
        variables: impl IntoIterator<Item = N>,
    ) -> Result<Names, Refusal> {
        let mut names = Names { variables: Vec::new(), constants: Vec::new() };
        for variable in variables {
            let variable = variable.into();
            names.check(key, &variable)?;
            names.variables.push(variable);
        }
        for (name, value) in &self.0 {
            names.check("parameters", name)?;
            names.constants.push((name.clone(), value.0));
        }
        Ok(names)
    }
}

/// The names that a formula may use.
#[derive(Clone, Debug, PartialEq)]
pub struct Names {
    variables: Vec<String>,
    constants: Vec<(String, f64)>,
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    Variable(usize),
    Number(f64),
}

impl Names {
    /// The variables, in the order of their values.
    pub fn variables(&self) -> &[String] {
        &self.variables
    }

    fn check(&self, key: &str, name: &str) -> Result<(), Refusal> {
        let first = name.chars().next();
        let why = if !first.is_some_and(starts_name) || !name.chars().all(continues_name) {
            "is no name: expected letters, digits and underscores, and no digit first"
        } else if CALLED.iter().any(|(called, _)| *called == name) {
            "is the name of a function"
        } else if CONSTANTS.iter().any(|(constant, _)| *constant == name) {
            "is the name of a number"
        } else if self.meaning(name).is_some() {
            "is the name of a variable already"
        } else {
            return Ok(());
        };
        Err(Refusal::at(key, format!("`{name}` {why}")))
    }

    pub(super) fn meaning(&self, name: &str) -> Option<Meaning> {
        let variable = self.variables.iter().position(|variable| variable == name);
        let own = self.constants.iter().map(|(name, x)| (name.as_str(), *x));
        let number =
            || own.chain(CONSTANTS.iter().copied()).find(|(constant, _)| *constant == name);
        variable.map(Meaning::Variable).or_else(|| number().map(|(_, x)| Meaning::Number(x)))
    }

    /// Every name that stands for a number.
    pub(super) fn all(&self) -> Vec<&str> {
        let variables = self.variables.iter().map(String::as_str);
        let own = self.constants.iter().map(|(name, _)| name.as_str());
        variables.chain(own).chain(CONSTANTS.iter().map(|(name, _)| *name)).collect()
    }
}

pub(super) fn starts_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}
pub(super) fn continues_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}
