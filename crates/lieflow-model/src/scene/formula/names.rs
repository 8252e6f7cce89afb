//! The names that a formula may use: the variables of its kind, and the constants of the scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Deserialize;

use super::super::Refusal;
use super::super::values::Real;
use super::functions::{CALLED, CONSTANTS};
use super::samples::{SamplesFile, Table};

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
        let mut names = Names { variables: Vec::new(), constants: Vec::new(), table: None };
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
    table: Option<Arc<Table>>,
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    Variable(usize),
    Sample(usize),
    Number(f64),
}

impl Names {
    /// The variables, in the order of their values.
    pub fn variables(&self) -> &[String] {
        &self.variables
    }

    /// These names, the first of them `t`, and the columns of a file of samples, functions of t.
    ///
    /// # Errors
    /// A refusal of `samples` for a file that is no table, and a column with the name of something else; of
    /// `interpolation` where it is unknown, or there are no samples.
    pub fn with_samples(
        mut self,
        file: Option<SamplesFile>,
        interpolation: Option<&str>,
    ) -> Result<Names, Refusal> {
        let Some(file) = file else {
            let alone =
                || Refusal::at("interpolation", "`interpolation` is of `samples`: add them");
            return interpolation.map_or(Ok(self), |_| Err(alone()));
        };
        let table = Table::read(file, interpolation)?;
        for (i, column) in table.columns.iter().enumerate() {
            let mut checked = self.check("samples", column);
            if table.columns[..i].contains(column) {
                let message = format!("`{column}` is the name of a column already");
                checked = Err(Refusal::at("samples", message));
            }
            checked.map_err(|refusal| Refusal {
                message: format!("{}: {}", table.file, refusal.message),
                help: Some("give the column another name in the first line of the file".into()),
                ..refusal
            })?;
        }
        self.table = Some(table.into());
        Ok(self)
    }

    /// The samples.
    pub(super) fn table(&self) -> Option<&Arc<Table>> {
        self.table.as_ref()
    }
    fn columns(&self) -> &[String] {
        self.table.as_ref().map_or(&[], |table| &table.columns)
    }

    /// Another variable, where its name is free and a formula can use it; else nothing, and false.
    pub fn add(&mut self, variable: &str) -> bool {
        let usable = self.check("", variable).is_ok();
        if usable {
            self.variables.push(variable.into());
        }
        usable
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
        let column = self.columns().iter().position(|column| column == name);
        let varies = variable.map(Meaning::Variable).or(column.map(Meaning::Sample));
        varies.or_else(|| number().map(|(_, x)| Meaning::Number(x)))
    }

    /// Every name that stands for a number.
    pub(super) fn all(&self) -> Vec<&str> {
        let variables = self.variables.iter().chain(self.columns()).map(String::as_str);
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
