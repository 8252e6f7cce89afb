//! What goes to standard output and into files.

mod figures;
mod files;
mod progress;
mod rows;
mod state;
mod summary;

pub use figures::{
    Drawn, RowSample, Sample, Written, in_digits, moving_body, run_page, together, unit_of,
};
pub use files::{Lock, make_folder, remove_old, write_figures, write_file, write_page};
pub use lieflow_figures::number::{duration, number, rough, size, time};
pub use progress::Progress;
pub use rows::{EVENTS, RowFile, TRAJECTORY};
pub use state::{Kind, ROWS, Records, RunState, Seen, ShownRows};
pub use summary::{
    Accuracy, Chosen, Distance, Drift, EventSummary, FoundBy, MethodSummary, PartError, SUMMARY,
    Summary, TIME, Watched, count_in_words, remove_summary, units_of,
};

use std::io::{self, Write};

use comfy_table::{Table, presets};
use lieflow_figures::number::DASH;
use serde::Serialize;

use crate::error::CliError;

/// Print to standard output. A reader that went away, as in `| head -1`, is no error.
///
/// # Errors
/// Anything else that goes wrong there.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}

/// Print as JSON.
///
/// # Errors
/// As [`print()`].
pub fn print_json<T: Serialize>(value: &T) -> Result<(), CliError> {
    print(&to_json(value)?)
}

/// JSON to read, with a line break at the end.
///
/// # Errors
/// A map with keys that are no strings.
pub fn to_json<T: Serialize>(value: &T) -> Result<String, CliError> {
    let json = serde_json::to_string_pretty(value);
    json.map(|json| json + "\n").map_err(|error| CliError::Message(format!("JSON: {error}")))
}

/// A table without lines. Columns without a value are left out.
pub fn table<R: IntoIterator<Item = String>>(
    header: impl IntoIterator<Item: Into<String>>,
    rows: impl IntoIterator<Item = R>,
) -> String {
    let header: Vec<String> = header.into_iter().map(Into::into).collect();
    let rows: Vec<Vec<String>> = rows.into_iter().map(|row| row.into_iter().collect()).collect();
    let is_value = |cell: &String| !cell.is_empty() && cell != DASH;
    let used = |column: usize| rows.iter().filter_map(|row| row.get(column)).any(is_value);
    let used: Vec<usize> = (0..header.len()).filter(|&column| used(column)).collect();
    let cells = |row: &[String]| -> Vec<String> {
        used.iter().map(|&column| row.get(column).cloned().unwrap_or_default()).collect()
    };
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(cells(&header));
    table.add_rows(rows.iter().map(|row| cells(row)));
    let lines = table.to_string();
    lines.lines().map(|line| format!(" {}\n", line.trim_end())).collect()
}

/// Text in lines of at most 88 characters, each after `indent`.
pub fn wrap(text: &str, indent: &str) -> String {
    let mut lines = String::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        if !line.is_empty()
            && line.chars().count() + 1 + word.chars().count()
                > 88usize.saturating_sub(indent.len())
        {
            lines += &format!("{indent}{line}\n");
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    if line.is_empty() { lines } else { lines + indent + &line + "\n" }
}
