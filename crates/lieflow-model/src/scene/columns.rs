//! Formulas of the columns of a run: the functions of events, and the columns of `[output.formulas]`.

use std::sync::{Arc, Mutex, PoisonError};

use lieflow::Error;
use lieflow_runs::schema::{Component, Measure, Row, Schema};

use crate::formula::{Formula, Lets, Names, Parameters};
use crate::problem::{FormulaKeys, Model, Problem};
use crate::reader::{KeyPath, Mistakes, Read, ReadError, Refusal, Tree, read_by_keys, seen};

/// The name of the quantity that `[output.formulas]` is.
pub(super) const FORMULAS: &str = "formulas";

/// The column of events.csv that has the name of the event.
const EVENT: &str = "name";

/// A column of a quantity.
#[derive(Clone, Debug)]
struct Column {
    name: String,
    quantity: &'static str,
    /// The number of the column in its quantity.
    index: usize,
}

/// A formula of t and columns.
#[derive(Clone, Debug)]
pub struct RowFormula {
    formula: Formula,
    /// The columns that it uses, each with its variable.
    columns: Vec<(usize, Column)>,
    /// The number of variables; the first is t.
    variables: usize,
}

/// A formula of the rows of a schema.
#[derive(Debug)]
pub struct OnRows {
    formula: Formula,
    /// The variable and the place in a row of each column.
    places: Vec<(usize, usize)>,
    variables: Mutex<Vec<f64>>,
}

impl RowFormula {
    /// The quantities that it is made of.
    pub fn quantities(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(_, column)| -> &str { column.quantity })
    }

    /// The formula.
    pub(super) fn formula(&self) -> &Formula {
        &self.formula
    }

    /// Is it the same at all times?
    pub(super) fn is_constant(&self) -> bool {
        !(0..self.variables).any(|variable| self.formula.uses(variable))
    }

    /// The formula on rows of this schema.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a schema without a quantity of the formula.
    pub fn on(&self, schema: &Schema) -> Result<OnRows, Error> {
        let place = |(variable, column): &(usize, Column)| {
            let observable = schema.get(column.quantity)?;
            Ok((*variable, observable.place(column.index)))
        };
        let places = self.columns.iter().map(place).collect::<Result<_, Error>>()?;
        let variables = Mutex::new(vec![0.0; self.variables]);
        Ok(OnRows { formula: self.formula.clone(), places, variables })
    }
}

impl OnRows {
    /// The places in a row of its columns.
    pub fn places(&self) -> impl Iterator<Item = usize> {
        self.places.iter().map(|(_, place)| *place)
    }

    /// The value at t in a row.
    pub fn value(&self, t: f64, row: Row<'_>) -> f64 {
        let mut variables = self.variables.lock().unwrap_or_else(PoisonError::into_inner);
        variables[0] = t;
        for &(variable, place) in &self.places {
            variables[variable] = row.numbers()[place];
        }
        self.formula.value(&variables)
    }
}

/// A column of `[output.formulas]`.
#[derive(Clone, Debug)]
pub(super) struct FormulaColumn {
    /// The name of the formula: v of v1.
    of: String,
    /// The name of the column.
    pub(super) name: String,
    /// Its value in a row.
    pub(super) formula: RowFormula,
}

/// Of a quantity with more columns than these, the first are listed.
const LISTED: usize = 20;

/// The columns of a problem, and the names that formulas of them may use: t, the columns, the constants and the
/// named formulas of the problem.
#[derive(Debug)]
pub struct Columns {
    columns: Vec<Column>,
    names: Names,
    /// The column of each variable; none of t.
    variables: Vec<Option<usize>>,
}

read_by_keys! {
    /// The keys of a problem that give names to formulas of its columns.
    struct Named {
        parameters: Parameters,
        r#let: Lets,
    }
}

impl Columns {
    /// The columns of the problem of these keys. A column that several quantities have is taken first from those of
    /// `asked`.
    ///
    /// # Errors
    /// [`Mistakes`] of `parameters`.
    pub fn of_keys(problem: &Problem, keys: &Tree, asked: &[String]) -> Result<Self, Mistakes> {
        let Tree::Table(keys) = keys else {
            return Err(Mistakes(vec![Refusal::section("expected a table of keys")]));
        };
        let named = ["parameters", "let"].into_iter();
        let named = named.filter_map(|name| Some((name, keys.get(name)?.clone())));
        Tree::table(named).read(|values| {
            let Named { parameters, r#let } = Named::read(values)?;
            let named = FormulaKeys { parameters: Ok(parameters), r#let: Ok(r#let) };
            Columns::of(problem, asked, &named)
        })
    }

    /// `asked` are the quantities that the scene writes: a column that several quantities have is taken from them
    /// first.
    ///
    /// # Errors
    /// As [`Parameters::names`].
    pub(super) fn of(
        problem: &Problem,
        asked: &[String],
        FormulaKeys { parameters, r#let: lets }: &FormulaKeys,
    ) -> Result<Self, ReadError> {
        let mut quantities: Vec<&'static str> =
            (problem.kind().quantities)().iter().map(|quantity| quantity.name).collect();
        quantities.sort_by_key(|name| !asked.iter().any(|asked| asked == name));
        // What this problem does not have has no columns.
        let columns = quantities.iter().flat_map(|&quantity| {
            let names = problem.columns(quantity).unwrap_or_default();
            let numbered = names.into_iter().enumerate();
            numbered.map(move |(index, name)| Column { name, quantity, index })
        });
        let columns: Vec<Column> = columns.collect();
        let mut names = seen(parameters)?.names("t", ["t"])?;
        let mut variables = vec![None];
        for (place, Column { name, .. }) in columns.iter().enumerate() {
            if names.add(name) {
                variables.push(Some(place));
            }
        }
        for of_quantity in columns.chunk_by(|column, next| column.quantity == next.quantity) {
            let listed: Vec<&str> =
                of_quantity.iter().map(|c| c.name.as_str()).take(LISTED).collect();
            names.add_group(of_quantity[0].quantity, listed.join(", "));
        }
        // A name means in all formulas of a scene what it means in its problem.
        let names = match problem.formula() {
            Some(formula) => formula.add_samples(names),
            None => names,
        };
        let names = names.with_usable_lets("let", seen(lets)?);
        Ok(Columns { columns, names, variables })
    }

    /// The columns of `[output.formulas]`; their names may be used after that.
    ///
    /// # Errors
    /// The mistakes in the formulas.
    pub(super) fn define(&mut self, lets: &Lets) -> Result<Vec<FormulaColumn>, ReadError> {
        self.names = core::mem::take(&mut self.names).with_lets(FORMULAS, lets);
        self.names.take_mistakes()?;
        if self.names.entries_of(lets).any(|(_, name, _)| name == EVENT) {
            let message =
                format!("`{EVENT}` is the column of the names of events: give it another name");
            return Err(Refusal::at(FORMULAS.entry(EVENT), message).into());
        }
        let entries = self.names.entries_of(lets);
        let column = |(of, name, formula): (&str, String, _)| FormulaColumn {
            of: of.into(),
            name,
            formula: self.of_rows(formula),
        };
        Ok(entries.map(column).collect())
    }

    /// A formula, or the name of a column alone.
    ///
    /// # Errors
    /// As [`Formula::read`], and a refusal of `key` for the name of a quantity of several columns.
    pub fn read(&self, key: &str, text: &str) -> Result<RowFormula, ReadError> {
        let formula = || Ok(self.of_rows(Formula::read(key, text, &self.names.apart())?));
        if self.names.is_formula(text) {
            return formula();
        }
        // The name of a column may be one that no formula can use.
        if let Some(column) = self.columns.iter().find(|column| column.name == text) {
            let names = Parameters::default().names(key, ["t", "x"])?;
            let formula = Formula::read(key, "x", &names)?;
            return Ok(RowFormula { formula, columns: vec![(1, column.clone())], variables: 2 });
        }
        let of_quantity = || self.columns.iter().filter(|column| column.quantity == text);
        if of_quantity().next().is_some() {
            let names: Vec<&str> = of_quantity().map(|c| c.name.as_str()).take(LISTED).collect();
            let message = format!("`{text}` has more than one column");
            let help = Some(format!("choose from {}", names.join(", ")));
            return Err(Refusal { help, ..Refusal::at(key, message) }.into());
        }
        formula()
    }

    fn of_rows(&self, formula: Formula) -> RowFormula {
        let used =
            self.variables.iter().enumerate().filter(|(variable, _)| formula.uses(*variable));
        let columns = used
            .filter_map(|(variable, column)| Some((variable, self.columns[(*column)?].clone())));
        RowFormula { columns: columns.collect(), variables: self.variables.len(), formula }
    }
}

/// The first quantities of a model, and formulas of its columns as one more, `formulas`.
///
/// # Errors
/// As [`RowFormula::on`].
pub(super) fn with_formulas(
    base: Model,
    count: usize,
    formulas: &[FormulaColumn],
) -> Result<Model, Error> {
    let mut schema = base.schema().first(count);
    let width = schema.columns().count();
    schema.push(FORMULAS, formulas.iter().map(|column| column.name.clone()).collect(), None, false);
    let mut first = 0;
    let parts = formulas.chunk_by(|a, b| a.of == b.of).map(|columns| {
        let place = first..first + columns.len();
        first = place.end;
        Component {
            name: columns[0].of.clone(),
            what: "",
            columns: place,
            measure: Measure::Length,
        }
    });
    schema.set_parts(parts.collect());
    let formulas = formulas.iter().map(|column| column.formula.on(base.schema()));
    let formulas = formulas.collect::<Result<Vec<_>, _>>()?;
    let number = move |place: usize, t: f64, row: Row<'_>| match place.checked_sub(width) {
        None => row.values()[place],
        Some(i) => match formulas.get(i) {
            Some(formula) => formula.value(t, row),
            // The sizes of terms are those of the base.
            None => row.numbers()[row.values().len() + i - formulas.len()],
        },
    };
    Ok(base.mapped(schema, Arc::new(number)))
}

/// The names without those that were there before.
pub(super) fn each_once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all = Vec::new();
    for name in names {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}
