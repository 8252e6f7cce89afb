//! A file of samples as variables of formulas: CSV with a line of names, `t` first, and rows of numbers.

use std::hash::{Hash, Hasher};

use fnv::FnvHasher;
use lieflow::Error;
use lieflow::samples::{Interpolation, Samples};

use crate::reader::values::counted;
use crate::reader::{Read, ReadError, Refusal, Shape, Value, amount, is_in_range};

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

/// So many wrong lines of a file are told.
const LINES_MOST: usize = 5;

/// The numbers of a line, after a row with the time `last`.
///
/// # Errors
/// What is wrong with the line, in words.
fn row(line: &str, columns: &[String], last: Option<f64>) -> Result<Vec<f64>, String> {
    let found = line.split(',').count();
    if found != columns.len() {
        return Err(format!("found {}, expected {}", amount(found, "columns"), columns.len()));
    }
    let wrong = |field: &str, name: &str, expected: String| {
        format!("column {name}: found `{}`, expected {expected}", field.trim())
    };
    let number = |(field, name): (&str, &String)| {
        let field = field.trim();
        let x = field.parse().ok().filter(|&x| is_in_range(x, field));
        x.ok_or_else(|| wrong(field, name, "a finite number".into()))
    };
    let row: Vec<f64> = line.split(',').zip(columns).map(number).collect::<Result<_, _>>()?;
    match last {
        Some(last) if row[0] <= last => {
            let time = line.split(',').next().unwrap_or_default();
            Err(wrong(time, &columns[0], format!("more than {last} of the row before")))
        }
        _ => Ok(row),
    }
}

impl Table {
    /// # Errors
    /// A refusal of `samples` that says at which line of the file.
    pub(super) fn read(
        SamplesFile(file, text): SamplesFile,
        interpolation: Interpolation,
    ) -> Result<Table, Refusal> {
        let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).zip(1..);
        let mut lines = lines.filter(|(line, _)| !line.is_empty() && !line.starts_with('#'));
        let (header, first) = lines.next().unwrap_or(("", 1));
        let columns: Vec<String> = header.split(',').map(|name| name.trim().into()).collect();
        if columns[0] != "t" || columns.len() < 2 {
            let message = format!("found `{header}`, expected the names of columns, `t` first");
            return Err(Refusal::at(KEY, format!("{file}, line {first}: {message}")));
        }
        let mut wrong = Vec::new();
        let mut values = vec![Vec::new(); columns.len()];
        for (line, place) in lines {
            match row(line, &columns, values[0].last().copied()) {
                Ok(row) => values.iter_mut().zip(row).for_each(|(values, x)| values.push(x)),
                Err(message) => wrong.push(format!("line {place}: {message}")),
            }
        }
        if !wrong.is_empty() {
            let more = match wrong.len().saturating_sub(LINES_MOST) {
                0 => String::new(),
                more => format!("; and {} more", amount(more, "lines")),
            };
            wrong.truncate(LINES_MOST);
            return Err(Refusal::at(KEY, format!("{file}, {}{more}", wrong.join("; "))));
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
