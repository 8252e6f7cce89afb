//! What goes to standard output and into files.

mod figures;
mod files;
mod progress;
mod rows;
mod state;
mod summary;

pub use figures::{Drawn, RowSample, in_digits, moving_body, run_page};
pub(crate) use files::fields;
pub use files::{in_full, make_folder, optional, remove_old, write_csv, write_file, write_page};
pub use progress::Progress;
pub use rows::{EVENTS, RowFile, TRAJECTORY};
pub use state::{Kind, ROWS, Records, RunState, ShownRows};
pub use summary::{
    Accuracy, Chosen, Distance, Drift, EventSummary, FoundBy, MethodSummary, PartError, SUMMARY,
    Summary, Watched,
};

use std::io::{self, Write};

use comfy_table::{Table, presets};
use lieflow_figures::number::{DASH, typed};
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

/// A number as people write it, with six digits at most: `0.05`, `77.6073`, `1.2e-6`.
pub fn number(x: f64) -> String {
    typed(x, 6)
}

/// A number of which the size matters: `144`, `2.7`, `0.0021`, `1.2e-6`.
pub fn short(x: f64) -> String {
    if (100.0..1e6).contains(&x.abs()) { format!("{x:.0}") } else { typed(x, 2) }
}

/// A duration as people say it: `20 ms`, `1.5 s`, `12 minutes`, `5 years`.
pub fn duration(seconds: f64) -> String {
    const LONG: [(f64, &str); 4] =
        [(365.25 * 86400.0, "years"), (86400.0, "days"), (3600.0, "hours"), (60.0, "minutes")];
    const SHORT: [(f64, &str); 3] = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")];
    if let Some((unit, name)) = LONG.iter().find(|(unit, _)| seconds >= 2.0 * unit) {
        return format!("{} {name}", short((seconds / unit).round()));
    }
    let (unit, name) = SHORT.iter().find(|(unit, _)| seconds >= *unit).unwrap_or(&SHORT[2]);
    format!("{} {name}", short(seconds / unit))
}

/// A number of bytes as people say it: `300 bytes`, `2.1 GB`.
pub fn size(bytes: u64) -> String {
    const UNITS: [(f64, &str); 5] =
        [(1e15, "PB"), (1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    let bytes = bytes as f64;
    let (unit, name) = UNITS.iter().find(|(unit, _)| bytes >= *unit).unwrap_or(&(1.0, "bytes"));
    format!("{} {name}", short(bytes / unit))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_people_write_them() {
        let numbers = [0.05, 600.0, 77.607_325_78, 1.0 / 33.0, 1.2e-6, 3e9, 0.0, -0.0];
        let told = numbers.map(number);
        assert_eq!(told, ["0.05", "600", "77.6073", "0.030303", "1.2e-6", "3e9", "0", "0"]);
        let told = [143.7, 2.69, 0.002_14, 9.96e-9, 0.0].map(short);
        assert_eq!(told, ["144", "2.7", "0.0021", "1e-8", "0"]);
        let told = [9.8e-4, 0.021, 90.0, 700.0, 1e5, 1.6e8].map(duration);
        assert_eq!(told, ["980 µs", "21 ms", "90 s", "12 minutes", "28 hours", "5 years"]);
        let told = [0, 320, 2_110_000_000, 1 << 50].map(size);
        assert_eq!(told, ["0 bytes", "320 bytes", "2.1 GB", "1.1 PB"]);
    }
}
