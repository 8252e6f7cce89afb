//! trajectory.csv and events.csv: rows as they come, every value with 17 significant digits.

use core::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use lieflow_figures::csv::field;

use super::files::{BYTES, name_file, remove_old};
use crate::error::CliError;

/// The names of a file of rows: when its run is complete, and until then.
pub(crate) type Names = [&'static str; 2];
/// The rows of a run.
pub const TRAJECTORY: Names = ["trajectory.csv", "trajectory.partial.csv"];
/// The zeros of its events.
pub const EVENTS: Names = ["events.csv", "events.partial.csv"];

/// A file of rows that is being written, in whole lines, which reach it when they have `BYTES`, and when the state of
/// the run is saved. Only [`finish`](RowFile::finish) gives it its name.
#[derive(Debug)]
pub struct RowFile {
    folder: PathBuf,
    names: Names,
    file: File,
    /// Lines that are not written yet.
    lines: String,
    /// The bytes that are.
    written: u64,
    rows: u64,
}

impl RowFile {
    /// Start a file of these columns in a folder, in place of what a run that did not end left there. The file of a
    /// complete run stays until this one is complete.
    ///
    /// # Errors
    /// The file cannot be made, or the old one cannot be removed.
    pub fn create<'c>(
        folder: &Path,
        names: Names,
        columns: impl IntoIterator<Item = &'c str>,
    ) -> Result<Self, CliError> {
        let [place, path] = names.map(|name| folder.join(name));
        if place.is_dir() {
            let source = io::ErrorKind::IsADirectory.into();
            return Err(CliError::Io { doing: "replace", path: place, source });
        }
        remove_old(&path)?;
        let file = OpenOptions::new().create(true).append(true).open(&path);
        let file = file.map_err(CliError::io("write", &path))?;
        let header: Vec<_> = columns.into_iter().map(field).collect();
        let lines = header.join(",") + "\n";
        Ok(RowFile { folder: folder.into(), names, file, lines, written: 0, rows: 0 })
    }

    /// Write a row, after a name where it has one.
    ///
    /// # Errors
    /// Lines cannot be written; the file has those before them.
    pub fn row(&mut self, name: Option<&str>, t: f64, values: &[f64]) -> Result<(), CliError> {
        if let Some(name) = name {
            self.lines += &field(name);
            self.lines.push(',');
        }
        // Writing to a string cannot fail.
        let _ = write!(self.lines, "{t:.16e}");
        for x in values {
            let _ = write!(self.lines, ",{x:.16e}");
        }
        self.lines.push('\n');
        self.rows += 1;
        if self.lines.len() >= BYTES { self.flush() } else { Ok(()) }
    }

    /// Write what is not written yet.
    ///
    /// # Errors
    /// As [`row`](Self::row).
    pub fn flush(&mut self) -> Result<(), CliError> {
        let written = self.file.write_all(self.lines.as_bytes());
        match written {
            Ok(()) => self.written += self.lines.len() as u64,
            // No part of a line stays.
            Err(_) => self.file.set_len(self.written).unwrap_or_default(),
        }
        self.lines.clear();
        written.map_err(CliError::io("write", &self.folder.join(self.names[1])))
    }

    /// The rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The bytes so far, with the lines that are not written yet.
    pub fn bytes(&self) -> u64 {
        self.written + self.lines.len() as u64
    }

    /// Leave nothing.
    pub fn discard(self) {
        let _ = fs::remove_file(self.folder.join(self.names[1]));
    }

    /// Name the file: by the first name, or by the second when the run stopped early.
    ///
    /// # Errors
    /// Lines cannot be written, or the file cannot be named; what was written stays.
    pub fn finish(mut self, complete: bool) -> Result<(), CliError> {
        self.flush()?;
        let [place, from] = self.names.map(|name| self.folder.join(name));
        match complete {
            true => name_file(&self.file, &from, &place).map_err(CliError::io("write", &place)),
            false => Ok(()),
        }
    }
}
