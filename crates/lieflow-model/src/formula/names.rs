//! The names that a formula may use: the variables of its kind, the constants and the named formulas of the scene.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use lieflow::samples::{Interpolation, Samples};

use super::functions::{CALLED, CONSTANTS};
use super::lost::Losses;
use super::samples::{SamplesFile, Table};
use super::tape::Tape;
use crate::reader::{ReadError, Refusal, help_for, suggest};

/// The names that a formula may use.
#[derive(Clone, Debug, Default)]
pub struct Names {
    variables: Arc<Variables>,
    constants: Vec<(String, f64)>,
    /// The names of what may change with time, of formulas that may not.
    varying: Option<Arc<BTreeSet<String>>>,
    table: Option<Arc<Table>>,
    /// The named formulas, after those that they need; of vectors and matrices each entry by its name.
    pub(super) formulas: Arc<Vec<Entry>>,
    /// Named formulas that have no meaning here, and why. Without a reason its mistakes are known.
    pub(super) unusable: Vec<(String, Option<String>)>,
    /// The mistakes in named formulas.
    pub(super) mistakes: ReadError,
    losses: Arc<Losses>,
    /// True where the names are not known yet: then each is one of a number.
    is_open: bool,
}

/// The variables, in the order of their values.
#[derive(Clone, Debug, Default)]
struct Variables {
    names: Vec<String>,
    places: BTreeMap<String, usize>,
    /// Names of several variables, which no formula can use, and these variables in words.
    groups: BTreeMap<String, String>,
}

/// A named formula that is a number, or an entry of one that is a vector or a matrix.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) name: String,
    /// The place in the scene of the vector or the matrix that it is in. None of a number.
    pub(super) within: Option<String>,
    /// The place of its text in the scene.
    pub(super) key: String,
    pub(super) text: String,
    pub(super) tape: Tape,
}

impl Entry {
    /// Does a word of a formula mean this one, or the vector or the matrix that it is in?
    pub(super) fn belongs_to(&self, word: &str) -> bool {
        word == self.name || !word.is_empty() && without_places(word) == without_places(&self.name)
    }
}

/// The name of the entry of a matrix: xij, i and j from 1; xi_j where a dimension is above 10, so that no two have one name.
pub(crate) fn entry_name(matrix: &str, [rows, columns]: [usize; 2], [i, j]: [usize; 2]) -> String {
    let between = if rows.max(columns) > 10 { "_" } else { "" };
    format!("{matrix}{i}{between}{j}")
}

/// The name of a vector or a matrix by that of an entry.
pub(super) fn without_places(name: &str) -> &str {
    let without_digits = |name: &'_ str| name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let vector = &name[..without_digits(name)];
    match vector.strip_suffix('_') {
        Some(row) if without_digits(row) < row.len() => &row[..without_digits(row)],
        _ => vector,
    }
}

/// The meaning of a name.
#[derive(Clone, Copy, Debug)]
pub(super) enum Meaning<'a> {
    Variable(usize),
    Sample(usize),
    Number(f64),
    Formula(&'a Entry),
}

/// What a name is stated by. The numbers of a vector are stated together.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin<'a> {
    Variables,
    Samples,
    Constants,
    /// Formulas of one number each, or the formula of a vector or a matrix at this place in the scene.
    Formulas(Option<&'a str>),
}

impl<'a> Meaning<'a> {
    fn origin(&self) -> Origin<'a> {
        match *self {
            Meaning::Variable(_) => Origin::Variables,
            Meaning::Sample(_) => Origin::Samples,
            Meaning::Number(_) => Origin::Constants,
            Meaning::Formula(entry) => Origin::Formulas(entry.within.as_deref()),
        }
    }
}

impl Names {
    /// The variables, in the order of their values.
    pub fn variables(&self) -> &[String] {
        &self.variables.names
    }

    /// These variables, in the order of their values.
    ///
    /// # Errors
    /// A refusal of `key` for a variable that is not a valid name (letters, digits and underscores, no digit first), or has that of
    /// another, or of a function.
    pub(super) fn of<N: Into<String>>(
        key: &str,
        variables: impl IntoIterator<Item = N>,
    ) -> Result<Names, ReadError> {
        let mut names = Names::default();
        for variable in variables {
            let variable = variable.into();
            names.check(key, &variable)?;
            names.push(variable);
        }
        Ok(names)
    }

    /// The names for formulas that must not change with time. A name in `varying` changes with time and is refused.
    pub(super) fn of_numbers(varying: Arc<BTreeSet<String>>) -> Names {
        Names { varying: Some(varying), ..Names::default() }
    }

    /// Names that are not known yet. Only the form of a formula can be checked with them.
    pub(super) fn open() -> Names {
        Names { is_open: true, ..Names::default() }
    }

    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// May what has this name change with time, where a formula may not?
    pub(super) fn varies(&self, name: &str) -> bool {
        self.varying.as_ref().is_some_and(|varying| varying.contains(name))
    }

    /// Another constant.
    pub(super) fn add_constant(&mut self, name: &str, value: f64) {
        self.constants.push((name.into(), value));
    }

    /// These names, the first of them `t`, and the columns of a file of samples, functions of t.
    ///
    /// # Errors
    /// A refusal of `samples` for a file that is no table, and a column with the name of something else; of
    /// `interpolation` where it is unknown, or there are no samples.
    pub fn with_samples(
        mut self,
        file: Option<SamplesFile>,
        interpolation: Option<Interpolation>,
    ) -> Result<Names, Refusal> {
        let Some(file) = file else {
            let alone =
                || Refusal::at("interpolation", "`interpolation` is of `samples`: add them");
            return interpolation.map_or(Ok(self), |_| Err(alone()));
        };
        let table = Table::read(file, interpolation.unwrap_or(Interpolation::Linear))?;
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

    /// These names, the first of them `t`, and the columns of this table. A variable hides a column of the same name.
    pub(super) fn with_table(self, table: Option<Arc<Table>>) -> Names {
        Names { table: table.or(self.table), ..self }
    }

    /// Is it the name of a named formula, or of an entry of one?
    pub fn is_formula(&self, name: &str) -> bool {
        matches!(self.meaning(name), Some(Meaning::Formula(_))) || self.is_unusable(name)
    }

    /// Is it the name of a named formula that has no meaning here?
    pub(super) fn is_unusable(&self, name: &str) -> bool {
        self.unusable.iter().any(|(formula, _)| formula == name)
    }

    /// Why this named formula, or an entry of it, cannot be used. `None` inside if the mistake is reported already.
    pub(super) fn unusable(&self, word: &str) -> Option<Option<&str>> {
        let of = |wanted: &str| self.unusable.iter().find(|(name, _)| name == wanted);
        of(word).or_else(|| of(without_places(word))).map(|(_, why)| why.as_deref())
    }

    /// These names, where no named formula has a mistake.
    ///
    /// # Errors
    /// The mistakes in the named formulas.
    pub fn checked(mut self) -> Result<Names, ReadError> {
        self.take_mistakes().map(|()| self)
    }

    /// Takes the mistakes in the named formulas out.
    ///
    /// # Errors
    /// The mistakes, if there are some.
    pub fn take_mistakes(&mut self) -> Result<(), ReadError> {
        core::mem::take(&mut self.mistakes).or(Some(()))
    }

    /// Where a scene gives a name its meaning.
    pub(super) fn where_to_state(&self, name: &str) -> String {
        match &self.varying {
            None => format!(
                "a constant is a line `{name} = 0.5` in [problem.parameters], a formula one in [problem.let]"
            ),
            Some(_) if self.varies(name) => {
                "a number is computed before the run, from names of [problem.parameters]".into()
            }
            Some(_) => format!("a constant is a line `{name} = 0.5` in [problem.parameters]"),
        }
    }

    /// The samples.
    pub(super) fn table(&self) -> Option<&Arc<Table>> {
        self.table.as_ref()
    }
    pub(super) fn samples(&self) -> Option<&Samples> {
        self.table.as_ref().map(|table| &table.samples)
    }
    /// The named formulas.
    pub(super) fn formulas(&self) -> &[Entry] {
        &self.formulas
    }
    /// The same names for formulas whose losses are kept apart.
    pub fn apart(&self) -> Names {
        Names { losses: Arc::default(), ..self.clone() }
    }
    /// What formulas of these names lost.
    pub(super) fn losses(&self) -> &Losses {
        &self.losses
    }
    fn columns(&self) -> &[String] {
        self.table.as_ref().map_or(&[], |table| &table.columns)
    }

    /// Another variable, where its name is free and a formula can use it; else nothing, and false.
    pub fn add(&mut self, variable: &str) -> bool {
        let usable = self.check("", variable).is_ok();
        if usable {
            self.push(variable.into());
        }
        usable
    }

    /// A name of several variables, and these variables in words. A formula that has this name is told them.
    pub fn add_group(&mut self, name: &str, variables: String) {
        Arc::make_mut(&mut self.variables).groups.insert(name.into(), variables);
    }

    /// What to do about a name that no formula can use: the variables of a group, or what was probably meant.
    pub(super) fn help_for(&self, name: &str) -> String {
        let group = |name| self.variables.groups.get_key_value(name);
        match group(name).or_else(|| group(without_places(name))) {
            Some((group, variables)) => format!("the numbers of {group} are {variables}"),
            None if suggest(name, &self.all()).is_some() => help_for(name, &self.all()),
            None => format!("expected one of {}", in_groups(&self.all())),
        }
    }

    fn push(&mut self, variable: String) {
        let Variables { names, places, .. } = Arc::make_mut(&mut self.variables);
        places.insert(variable.clone(), names.len());
        names.push(variable);
    }

    pub(super) fn check(&self, key: &str, name: &str) -> Result<(), Refusal> {
        let first = name.chars().next();
        if name.is_empty() {
            return Err(Refusal::at(
                key,
                "the name is empty, expected letters, digits and underscores",
            ));
        }
        let why = if !first.is_some_and(starts_name) || !name.chars().all(continues_name) {
            "is not a valid name: expected letters, digits and underscores, and no digit first"
        } else if CALLED.iter().any(|(called, _)| *called == name) {
            "is the name of a function"
        } else if CONSTANTS.iter().any(|(constant, _)| *constant == name) {
            "is a constant already; choose another name"
        } else if self.meaning(name).is_some() {
            "is the name of a variable already"
        } else {
            return Ok(());
        };
        Err(Refusal::at(key, format!("`{name}` {why}")))
    }

    /// Checks a name as [`check`](Self::check) does. It must not be the name of a vector or a matrix either.
    pub(super) fn check_new(&self, key: &str, name: &str) -> Result<(), Refusal> {
        self.check(key, name)?;
        let has_entries = |ends: [&str; 2]| {
            ends.iter().all(|end| self.meaning(&format!("{name}{end}")).is_some())
        };
        if has_entries(["1", "2"]) || has_entries(["11", "12"]) || has_entries(["1_1", "1_2"]) {
            let message = format!("`{name}` is the name of a vector or a matrix already");
            return Err(Refusal::at(key, message));
        }
        Ok(())
    }

    pub(super) fn meaning(&self, name: &str) -> Option<Meaning<'_>> {
        if self.is_unusable(name) {
            return None;
        }
        if let Some(entry) = self.formulas.iter().find(|entry| entry.name == name) {
            return Some(Meaning::Formula(entry));
        }
        let variable = self.variables.places.get(name).copied();
        let own = self.constants.iter().map(|(name, x)| (name.as_str(), *x));
        let number =
            || own.chain(CONSTANTS.iter().copied()).find(|(constant, _)| *constant == name);
        let column = self.columns().iter().position(|column| column == name);
        let varies = variable.map(Meaning::Variable).or(column.map(Meaning::Sample));
        varies.or_else(|| number().map(|(_, x)| Meaning::Number(x)))
    }

    /// The names of the numbers of a vector or a matrix, row by row, and the number of its rows: of x1, x2, … by the name x,
    /// of x11, x12, … or x1_1, x1_2, … by the name x. All are stated together.
    pub fn numbers_of(&self, name: &str) -> Option<(usize, Vec<String>)> {
        let origin = |name: &str| self.meaning(name).map(|meaning| meaning.origin());
        let line = |stem: &str| -> Vec<String> {
            let first = origin(&format!("{stem}1"));
            let names = (1..).map(|i| format!("{stem}{i}"));
            let names = names.take_while(|name| first.is_some() && origin(name) == first);
            names.collect()
        };
        let rows = |between: &str| -> Vec<Vec<String>> {
            let rows = (1..).map(|i| line(&format!("{name}{i}{between}")));
            let mut rows: Vec<_> = rows.take_while(|row| row.len() > 1).collect();
            let first = rows.first().and_then(|row| origin(&row[0]));
            rows.retain(|row| origin(&row[0]) == first);
            rows
        };
        let vector = ["", "_"].map(|between| line(&format!("{name}{between}")));
        if let Some(vector) = vector.into_iter().find(|vector| vector.len() > 1) {
            return Some((vector.len(), vector));
        }
        let matrices = ["", "_"].map(rows);
        let is_matrix = |rows: &Vec<Vec<String>>| {
            rows.len() > 1 && rows.iter().all(|row| row.len() == rows[0].len())
        };
        let rows = matrices.into_iter().find(is_matrix)?;
        Some((rows.len(), rows.concat()))
    }

    /// Every name that stands for a number.
    fn all(&self) -> Vec<&str> {
        let variables = self.variables.names.iter().chain(self.columns()).map(String::as_str);
        let formulas = self.formulas.iter().map(|entry| entry.name.as_str());
        let own = self.constants.iter().map(|(name, _)| name.as_str());
        let own = variables.chain(formulas).chain(own);
        own.chain(CONSTANTS.iter().map(|(name, _)| *name)).collect()
    }
}

/// Is `next` this name with a last digit that is larger by one?
fn follows(name: &str, next: &str) -> bool {
    let (name, next) = (name.as_bytes().split_last(), next.as_bytes().split_last());
    name.zip(next).is_some_and(|((digit, stem), (following, stem_of_next))| {
        matches!(digit, b'0'..=b'8') && digit + 1 == *following && stem == stem_of_next
    })
}

/// Names for a message. Three and more with digits that follow each other are one entry: `m1 to m3`.
fn in_groups(names: &[&str]) -> String {
    let groups = names.chunk_by(|name, next| follows(name, next));
    let entries = groups.map(|group| match group {
        [first, _, .., last] => format!("{first} to {last}"),
        group => group.join(", "),
    });
    entries.collect::<Vec<_>>().join(", ")
}

pub(super) fn starts_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}
pub(super) fn continues_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}
