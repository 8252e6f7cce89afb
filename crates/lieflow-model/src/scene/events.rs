//! `[[events]]`: where a column of the run, or a formula of the columns, passes zero.
//!
//! | key | |
//! |---|---|
//! | `name` | the name in `events.csv` |
//! | `when` | a column of any quantity of the problem, or a formula of t, the columns, the parameters and named formulas |
//! | `direction` | `"rising"`, `"falling"` or `"both"`; optional: both |
//! | `stop_after` | the zero that ends the run, from 1; optional |

use lieflow::{Direction, Error};
use lieflow_runs::schema::{Row, Schema};

use super::columns::{Columns, RowFormula};
use crate::formula::{Formula, Text};
use crate::problem::EventPlan;
use crate::reader::values::Whole;
use crate::reader::{Key, KeyPath, ReadError, Refusal, all, read_by_keys};

read_by_keys! {
    /// An entry of `[[events]]`.
    pub(super) struct EventKeys {
        name: Key<String>,
        when: Key<Text>,
        direction: Key<Option<String>>,
        stop_after: Key<Option<Whole<1>>>,
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
    /// The text of its function.
    pub text: String,
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

/// The refusal of a comparison, such as `m2 > 0`, in the place of a number.
fn comparison(key: &str, when: &str) -> Option<Refusal> {
    let is_sign = |c: char| "<>=≤≥".contains(c);
    let (left, rest) = when.split_at(when.find(is_sign)?);
    let right = rest.trim_start_matches(is_sign).trim();
    let number = match right.parse() {
        Ok(0.0) => left.trim().to_owned(),
        _ => format!("{} - ({right})", left.trim()),
    };
    let direction = match rest.chars().next() {
        Some('>' | '≥') => ", direction = \"rising\"",
        Some('<' | '≤') => ", direction = \"falling\"",
        _ => "",
    };
    let message = format!("{key}: `{when}` is a comparison, expected a number that passes zero");
    let help =
        Some(format!("an event is where a number passes zero: when = \"{number}\"{direction}"));
    Some(Refusal { help, ..Refusal::at(key, message) })
}

/// The event `i` of a scene, from 0, of these columns, after events of these names. None if there
/// are no columns: then its formula cannot be read.
///
/// # Errors
/// Refusals of the keys that cannot be used.
pub(super) fn resolve(
    keys: EventKeys,
    i: usize,
    names_before: &[&str],
    columns: Option<&Columns>,
) -> Result<SceneEvent, ReadError> {
    let EventKeys { name, when, direction, stop_after } = keys;
    let key = |key: &str| "events".index(i).entry(key);
    let name = name.and_then(|name| match name.trim() {
        "" => Err(Refusal::at(key("name"), "an event without a name").into()),
        _ if names_before.contains(&&*name) => {
            Err(Refusal::at(key("name"), format!("event `{name}` is there twice")).into())
        }
        _ => Ok(name),
    });
    let when = when.and_then(|Text(when)| {
        if let Some(refusal) = comparison(&key("when"), &when) {
            return Err(refusal.into());
        }
        let Some(columns) = columns else {
            Formula::check_form(&key("when"), when.trim())?;
            return Err(ReadError::known());
        };
        let formula = columns.read(&key("when"), when.trim())?;
        if formula.is_constant() {
            let message =
                format!("`{when}` is the same at all times, expected a column or t in it");
            return Err(Refusal::at(key("when"), message).into());
        }
        Ok((when.trim().to_owned(), formula))
    });
    let direction = direction.and_then(|direction| {
        let Some(given) = direction else { return Ok(Direction::Both) };
        let names = DIRECTIONS.map(|(name, _)| name);
        let unknown = || Refusal::unknown("direction", &given, &names).about(key("direction"));
        let found = DIRECTIONS.iter().find(|(name, _)| *name == given);
        Ok(found.ok_or_else(unknown)?.1)
    });
    let (name, (text, when), direction, stop_after) = all!(name, when, direction, stop_after)?;
    Ok(SceneEvent { name, direction, stop_after: stop_after.map(|count| count.0), text, when })
}
