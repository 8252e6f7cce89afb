//! `plot`: the figures that a scene asks for.

use std::collections::BTreeSet;

use super::columns::{FormulaColumn, each_once};
use crate::problem::{Kind, Problem};
use crate::reader::{Is, KeyPath, Read, ReadError, Refusal, Shape, Value, read_by_keys};

read_by_keys! {
    /// A figure that a scene asks for: a table, or the name of a column or a quantity alone.
    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    pub struct PlotFigure {
        /// The columns and quantities that are drawn.
        pub columns: Vec<String>,
        /// The column that they are drawn against; none for t.
        pub against: Option<String>,
        /// The title.
        pub title: Option<String>,
        /// The title of the horizontal axis.
        pub x_label: Option<String>,
        /// The title of the vertical axis.
        pub y_label: Option<String>,
    }
}

/// An entry of the list.
#[derive(Clone, Debug)]
pub(super) struct Entry(pub(super) PlotFigure);

impl Read for Entry {
    const SHAPE: Shape = Shape::Or(&Shape::Text, &PlotFigure::SHAPE);

    fn read(value: &Value) -> Result<Self, ReadError> {
        match &value.is {
            Is::Text(name) => {
                let columns = vec![name.clone()];
                Ok(Entry(PlotFigure { columns, ..PlotFigure::default() }))
            }
            Is::Table(_) => PlotFigure::read(value).map(Entry),
            _ => {
                let expected = "the name of a column or of a quantity, or a table such as { columns = [\"x\"] }";
                Err(ReadError::expected(value, expected))
            }
        }
    }
}

impl PlotFigure {
    /// The names of columns and quantities.
    fn names(&mut self) -> impl Iterator<Item = &mut String> {
        self.columns.iter_mut().chain(&mut self.against)
    }

    /// Spells the quantities as the kind does.
    pub(super) fn spell(&mut self, kind: &Kind) {
        for name in self.names() {
            if let Ok(known) = kind.quantity(name) {
                *name = known.name.into();
            }
        }
    }

    /// Is it the name of a column or a quantity alone?
    pub fn is_name(&self) -> bool {
        let PlotFigure { columns, against, title, x_label, y_label } = self;
        columns.len() == 1 && [against, title, x_label, y_label].iter().all(|key| key.is_none())
    }
}

/// Checks that the scene writes the columns and quantities of its figures.
///
/// # Errors
/// Refusals of `plot` for other names, figures of nothing, and those against a quantity of several columns.
pub(super) fn check_plot(
    plot: &[PlotFigure],
    problem: &Problem,
    quantities: &[String],
    formulas: &[FormulaColumn],
) -> Result<(), ReadError> {
    let columns = quantities.iter().flat_map(|name| problem.columns(name).unwrap_or_default());
    let derived = formulas.iter().map(|column| column.name.clone());
    let columns: Vec<String> = columns.chain(derived).collect();
    let names = || quantities.iter().chain(&columns).map(String::as_str);
    // There may be hundreds of thousands.
    let is_column: BTreeSet<&str> = columns.iter().map(String::as_str).collect();
    let is_written: BTreeSet<&str> = names().collect();
    let unknown = |i: usize, name: &str, names: Vec<&str>| {
        let unknown = Refusal::unknown("column", name, &names).about("plot".index(i));
        let message = format!("{}: it is not among what the scene writes", unknown.message);
        Refusal { message, ..unknown }
    };
    let mut refusals = Vec::new();
    for (i, figure) in plot.iter().enumerate() {
        if figure.columns.is_empty() {
            let message = "a figure of no columns, expected at least one";
            refusals.push(Refusal::at("plot".index(i), message));
        }
        let of_columns = figure.columns.iter().filter(|name| !is_written.contains(name.as_str()));
        refusals.extend(of_columns.map(|name| unknown(i, name, each_once(names()))));
        let against = figure.against.iter().filter(|name| !is_column.contains(name.as_str()));
        refusals.extend(
            against.map(|name| unknown(i, name, each_once(columns.iter().map(String::as_str)))),
        );
    }
    ReadError::from(refusals).or(Some(()))
}
