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
pub use state::{Kind, RunState};
pub use summary::{Chosen, Drift, EventSummary, MethodSummary, SUMMARY, Summary, Watched};

use std::io::{self, Write};

use comfy_table::{Table, presets};
use serde::Serialize;

use crate::cmd::CliError;

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

/// A table without lines.
pub fn table<const N: usize>(
    header: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header).add_rows(rows);
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
