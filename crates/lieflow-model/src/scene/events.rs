//! `[[events]]`: where a column of the run, or a formula of the columns, passes zero.
//!
//! | key | |
//! |---|---|
//! | `name` | the name in `events.csv` |
//! | `when` | a column of any quantity of the problem, or a formula of t, the columns, the parameters and named formulas |
//! | `direction` | `"rising"`, `"falling"` or `"both"`; optional: both |
//! | `stop_after` | the zero that ends the run, from 1; optional |

use lieflow::{Direction, Error};

use super::columns::{Columns, RowFormula};
use crate::formula::{Formula, Text};
use crate::problem::EventPlan;
use crate::reader::read_by_keys;
use crate::reader::values::Whole;
use crate::reader::{KeyPath, Refusal};
use crate::schema::{Row, Schema};

read_by_keys! {
    /// An entry of `[[events]]`.
    pub(super) struct EventKeys {
        name: String,
        when: Text,
        direction: Option<String>,
        stop_after: Option<Whole<1>>,
    }
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
    when: RowFormula,
}

/// The directions by name.
const DIRECTIONS: [(&str, Direction); 3] =
    [("rising", Direction::Rising), ("falling", Direction::Falling), ("both", Direction::Both)];

impl SceneEvent {
    /// The quantities that the function of the event is made of.
    pub fn quantities(&self) -> impl Iterator<Item = &str> {
        self.when.quantities()
    }

    /// Its function.
    pub(super) fn formula(&self) -> &Formula {
        self.when.formula()
    }

    /// The event on rows of this schema.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a schema without a quantity of the event.
    pub fn plan(&self, schema: &Schema) -> Result<EventPlan<'static>, Error> {
        let when = self.when.on(schema)?;
        let places = when.places().collect();
        let value = move |t: f64, row: Row<'_>| when.value(t, row);
        let plan = EventPlan::new(&self.name, places, value);
        Ok(EventPlan { direction: self.direction, stop_after: self.stop_after, ..plan })
    }
}

/// The event `i` of a scene, from 0, of these columns, after events of these names.
///
/// # Errors
/// A refusal of the first key that cannot be used.
pub(super) fn resolve(
    keys: EventKeys,
    i: usize,
    names_before: &[&str],
    columns: &Columns,
) -> Result<SceneEvent, Refusal> {
    let EventKeys { name, when: Text(when), direction, stop_after } = keys;
    let key = |key: &str| "events".index(i).entry(key);
    if name.trim().is_empty() {
        return Err(Refusal::at(key("name"), "an event without a name"));
    }
    if names_before.contains(&&*name) {
        return Err(Refusal::at(key("name"), format!("event `{name}` is there twice")));
    }
    let formula = columns.read(&key("when"), when.trim())?;
    if formula.is_constant() {
        let message = format!("`{when}` is the same at all times, expected a column or t in it");
        return Err(Refusal::at(key("when"), message));
    }
    let direction = match direction {
        None => Direction::Both,
        Some(given) => {
            let found = DIRECTIONS.iter().find(|(name, _)| *name == given);
            let names = DIRECTIONS.map(|(name, _)| name);
            let unknown = || Refusal::unknown("direction", &given, &names);
            found.ok_or_else(|| unknown().about(key("direction")))?.1
        }
    };
    let stop_after = stop_after.map(|count| count.0);
    Ok(SceneEvent { name, direction, stop_after, when: formula })
}
