//! `[[events]]`: where a column of the run, or a formula of the columns, passes zero.
//!
//! | key | |
//! |---|---|
//! | `name` | the name in `events.csv` |
//! | `when` | a column of any quantity of the problem, or a formula of t, the columns and the parameters |
//! | `direction` | `"rising"`, `"falling"` or `"both"`; optional: both |
//! | `stop_after` | the zero that ends the run, from 1; optional |

use core::cell::RefCell;

use lieflow::{Direction, Error};
use serde::Deserialize;

use super::error::Refusal;
use super::formula::{Formula, Parameters};
use super::values::Whole;
use crate::kinds::ProblemSpec;
use crate::model::EventPlan;
use crate::schema::{Row, Schema};

/// An entry of `[[events]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EventKeys {
    name: String,
    when: String,
    direction: Option<String>,
    stop_after: Option<Whole<1>>,
}

/// An event of a scene.
#[derive(Clone, Debug)]
pub struct SceneEvent {
    /// Its name.
    pub name: String,
    /// Which zeros count.
    pub direction: Direction,
    /// The zero that ends the run, from 1.
    pub stop_after: Option<u64>,
    when: Formula,
    /// The number of variables of the formula; the first is t.
    variables: usize,
    columns: Vec<Column>,
}

/// A column that a formula uses.
#[derive(Clone, Debug)]
struct Column {
    /// The variable of the formula.
    variable: usize,
    quantity: &'static str,
    /// The number of the column in its quantity.
    index: usize,
}

/// The directions by name.
const DIRECTIONS: [(&str, Direction); 3] =
    [("rising", Direction::Rising), ("falling", Direction::Falling), ("both", Direction::Both)];

impl SceneEvent {
    /// The quantities that the function of the event is made of.
    pub fn quantities(&self) -> impl Iterator<Item = &'static str> {
        self.columns.iter().map(|column| column.quantity)
    }

    /// The event on rows of this schema.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a schema without a quantity of the event.
    pub fn plan(&self, schema: &Schema) -> Result<EventPlan<'_>, Error> {
        let place = |column: &Column| {
            let observable = schema.get(column.quantity)?;
            Ok((column.variable, observable.place(column.index)))
        };
        let places: Vec<(usize, usize)> =
            self.columns.iter().map(place).collect::<Result<_, Error>>()?;
        let variables = RefCell::new(vec![0.0; self.variables]);
        let value = move |t: f64, row: Row<'_>| {
            let mut variables = variables.borrow_mut();
            variables[0] = t;
            for &(variable, place) in &places {
                variables[variable] = row.numbers()[place];
            }
            self.when.value(&variables)
        };
        Ok(EventPlan {
            name: self.name.clone(),
            value: Box::new(value),
            direction: self.direction,
            stop_after: self.stop_after,
        })
    }
}

/// The events of a scene. `asked` are the quantities that the scene writes: a column that several quantities
/// have is taken from them first.
pub(super) fn resolve(
    keys: Vec<EventKeys>,
    problem: &dyn ProblemSpec,
    asked: &[String],
    parameters: &Parameters,
) -> Result<Vec<SceneEvent>, Refusal> {
    let mut quantities: Vec<&'static str> =
        (problem.kind().quantities)().iter().map(|quantity| quantity.name).collect();
    quantities.sort_by_key(|name| !asked.iter().any(|asked| asked == name));
    // What this problem does not have has no columns.
    let columns = quantities.iter().flat_map(|&quantity| {
        let names = problem.columns(quantity).unwrap_or_default();
        names.into_iter().enumerate().map(move |(index, name)| (name, quantity, index))
    });
    let columns: Vec<(String, &'static str, usize)> = columns.collect();
    let mut events: Vec<SceneEvent> = Vec::new();
    for (i, EventKeys { name, when, direction, stop_after }) in keys.into_iter().enumerate() {
        let key = |key: &str| format!("events[{i}].{key}");
        if name.trim().is_empty() {
            return Err(Refusal::at(key("name"), "an event without a name"));
        }
        if events.iter().any(|event| event.name == name) {
            return Err(Refusal::at(key("name"), format!("event `{name}` is there twice")));
        }
        let direction = match direction {
            None => Direction::Both,
            Some(given) => {
                let found = DIRECTIONS.iter().find(|(name, _)| *name == given);
                let names = DIRECTIONS.map(|(name, _)| name);
                let unknown = || Refusal::unknown("direction", &given, &names);
                found.ok_or_else(|| Refusal { key: Some(key("direction")), ..unknown() })?.1
            }
        };
        let (formula, variables) = read(&key("when"), when.trim(), &columns, parameters)?;
        if !(0..variables.len()).any(|variable| formula.uses(variable)) {
            let message =
                format!("`{when}` is the same at all times, expected a column or t in it");
            return Err(Refusal::at(key("when"), message));
        }
        let used = variables.iter().enumerate().filter(|(variable, _)| formula.uses(*variable));
        let columns = used.filter_map(|(variable, column)| {
            let (_, quantity, index) = columns[(*column)?];
            Some(Column { variable, quantity, index })
        });
        events.push(SceneEvent {
            columns: columns.collect(),
            name,
            direction,
            stop_after: stop_after.map(|count| count.0),
            when: formula,
            variables: variables.len(),
        });
    }
    Ok(events)
}

/// The formula, and what each of its variables is: t, or the number of a column.
fn read(
    key: &str,
    when: &str,
    columns: &[(String, &'static str, usize)],
    parameters: &Parameters,
) -> Result<(Formula, Vec<Option<usize>>), Refusal> {
    // The name of a column alone may be one that no formula can use.
    if let Some(column) = columns.iter().position(|(name, ..)| name == when) {
        let names = Parameters::default().names(key, ["t", "x"])?;
        return Ok((Formula::read(key, "x", &names)?, vec![None, Some(column)]));
    }
    let of_quantity = || columns.iter().filter(|(_, quantity, _)| *quantity == when);
    if of_quantity().next().is_some() {
        let names: Vec<&str> = of_quantity().map(|(name, ..)| name.as_str()).take(20).collect();
        let message = format!("`{when}` has more than one column");
        let help = Some(format!("choose from {}", names.join(", ")));
        return Err(Refusal { help, ..Refusal::at(key, message) });
    }
    let mut names = parameters.names(key, ["t"])?;
    let mut variables = vec![None];
    for (column, (name, ..)) in columns.iter().enumerate() {
        if names.add(name) {
            variables.push(Some(column));
        }
    }
    Ok((Formula::read(key, when, &names)?, variables))
}
