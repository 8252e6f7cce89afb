//! A file of samples as variables of formulas: CSV with a line of names, `t` first, and rows of numbers.

use std::hash::{Hash, Hasher};

use fnv::FnvHasher;
use lieflow::Error;
use lieflow::samples::{Interpolation, Samples};

use crate::reader::values::counted;
use crate::reader::{Read, ReadError, Refusal, Shape, Value, amount};

/// The key of the file.
const KEY: &str = "samples";

/// The name of a file and its text, which stands in the place of the name once the scene has read it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SamplesFile(pub(super) String, pub(super) String);

impl Read for SamplesFile {
    const SHAPE: Shape = Shape::Samples;

    fn read(value: &Value) -> Result<Self, ReadError> {
        // A file whose mistake is known.
        if value.as_list().is_some_and(<[_]>::is_empty) {
            return Err(ReadError::known());
        }
        let [name, text] = counted(value, 2, "texts")?;
        Ok(SamplesFile(name, text))
    }
}

/// The samples of a file with the names of their columns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Table {
    pub(super) file: String,
    /// A hash of the text: two files with other numbers are not shown as the same.
    text: u64,
    pub(super) columns: Vec<String>,
    pub(super) samples: Samples,
}

impl Table {
    /// # Errors
    /// A refusal of `samples` that says at which line of the file.
    pub(super) fn read(
        SamplesFile(file, text): SamplesFile,
        interpolation: Interpolation,
    ) -> Result<Table, Refusal> {
        let refused = |line: usize, message: String| {
            Refusal::at(KEY, format!("{file}, line {line}: {message}"))
        };
        let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).zip(1..);
        let mut lines = lines.filter(|(line, _)| !line.is_empty() && !line.starts_with('#'));
        let (header, first) = lines.next().unwrap_or(("", 1));
        let columns: Vec<String> = header.split(',').map(|name| name.trim().into()).collect();
        if columns[0] != "t" || columns.len() < 2 {
            let message = format!("found `{header}`, expected the names of columns, `t` first");
            return Err(refused(first, message));
        }
        let mut values = vec![Vec::new(); columns.len()];
        for (line, place) in lines {
            let found = line.split(',').count();
            if found != columns.len() {
                let message =
                    format!("found {}, expected {}", amount(found, "columns"), columns.len());
                return Err(refused(place, message));
            }
            let fields = line.split(',').zip(&columns).zip(&mut values);
            for (place_in_row, ((field, name), values)) in fields.enumerate() {
                let x = field.trim().parse().ok().filter(|x: &f64| x.is_finite());
                let expected = |what: String| {
                    let found = format!("column {name}: found `{}`", field.trim());
                    refused(place, format!("{found}, expected {what}"))
                };
                let x = x.ok_or_else(|| expected("a finite number".into()))?;
                if let (Some(&last), 0) = (values.last(), place_in_row)
                    && x <= last
                {
                    return Err(expected(format!("more than {last} of the row before")));
                }
                values.push(x);
            }
        }
        let samples = Samples::new(&values[0], &values[1..], interpolation).map_err(|error| {
            let message = match error {
                // All columns have as many values as there are rows.
                Error::Length { found, expected, .. } => {
                    format!("found {}, expected {expected}", amount(found, "rows"))
                }
                other => Refusal::from(other).message,
            };
            Refusal::at(KEY, format!("{file}: {message}"))
        })?;
        let mut hasher = FnvHasher::default();
        text.hash(&mut hasher);
        Ok(Table { file, text: hasher.finish(), columns: columns[1..].into(), samples })
    }
}
