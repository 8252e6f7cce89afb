//! `[units]`: the names of units. They are words beside numbers, and no number is changed.

use lieflow_runs::schema::Units;

use crate::reader::{Key, Mistake, ReadError, Refusal, all, read_by_keys};

read_by_keys! {
    /// `[units]`.
    pub(super) struct UnitKeys {
        mass: Key<Option<String>>,
        length: Key<Option<String>>,
        time: Key<Option<String>>,
        angle: Key<Option<String>>,
    }
}

/// The most characters of the name of a unit.
const LONGEST: usize = 12;

impl UnitKeys {
    /// The units.
    ///
    /// # Errors
    /// Refusals of names that are empty, long or more than a word, and of another unit of angles than the radian.
    pub(super) fn resolve(self) -> Result<Units, ReadError> {
        let UnitKeys { mass, length, time, angle } = self;
        let word = |key: &str, name: Key<Option<String>>| -> Key<Option<String>> {
            let Some(name) = name? else { return Ok(None) };
            let is_word = !name.is_empty()
                && name.chars().count() <= LONGEST
                && !name.chars().any(|c| c.is_whitespace() || c.is_control());
            let message = || {
                format!(
                    "{key} = {name:?}, expected a word of at most {LONGEST} characters, such as \"s\""
                )
            };
            if is_word { Ok(Some(name)) } else { Err(Refusal::at(key, message()).into()) }
        };
        let (mass, length, time) = (word("mass", mass), word("length", length), word("time", time));
        let angle = angle.and_then(|angle| match angle.as_deref() {
            None | Some("rad") => Ok(()),
            Some(other) => {
                let message = format!("angle = {other:?}, expected \"rad\": angles are in radians");
                let help = "a number in degrees is written \"5*deg\"; a column in degrees is a line of \
                            [output.formulas], such as w1_deg = \"w1/deg\"";
                let refusal = Refusal { help: Some(help.into()), ..Refusal::at("angle", message) };
                Err(ReadError::from(Mistake::Refused(refusal)))
            }
        });
        let (mass, length, time, ()) = all!(mass, length, time, angle)?;
        Ok(Units { mass, length, time })
    }
}
