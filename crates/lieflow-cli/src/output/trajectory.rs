//! trajectory.csv: rows as they come, every value with 17 significant digits.

use core::fmt::Write;
use std::fs::File;
use std::path::{Path, PathBuf};

use super::files::{NewFile, remove_old};
use crate::cmd::CliError;

/// A complete trajectory.
pub const COMPLETE: &str = "trajectory.csv";
/// A trajectory up to a step that failed.
pub const PARTIAL: &str = "trajectory.partial.csv";

/// A trajectory that is being written. Only [`finish`](Trajectory::finish) gives it its name.
#[derive(Debug)]
pub struct Trajectory {
    folder: PathBuf,
    new: NewFile,
    csv: csv::Writer<File>,
    field: String,
    rows: u64,
    failure: Option<csv::Error>,
}

impl Trajectory {
    /// Start a trajectory in a folder, in place of what earlier runs left there.
    ///
    /// # Errors
    /// The file cannot be made, or old ones cannot be removed.
    pub fn create(folder: &Path, columns: &[String]) -> Result<Self, CliError> {
        for old in [COMPLETE, PARTIAL] {
            remove_old(&folder.join(old))?;
        }
        let place = folder.join(COMPLETE);
        let (new, file) = NewFile::create(&place)?;
        let mut csv = csv::Writer::from_writer(file);
        let header = core::iter::once("t").chain(columns.iter().map(String::as_str));
        let failure = csv.write_record(header).err();
        Ok(Trajectory { folder: folder.into(), new, csv, field: String::new(), rows: 0, failure })
    }

    /// Write a row. What goes wrong is kept for the end.
    pub fn row(&mut self, t: f64, values: &[f64]) {
        if self.failure.is_some() {
            return;
        }
        match self.write(t, values) {
            Ok(()) => self.rows += 1,
            Err(error) => self.failure = Some(error),
        }
    }

    fn write(&mut self, t: f64, values: &[f64]) -> csv::Result<()> {
        for x in core::iter::once(&t).chain(values) {
            self.field.clear();
            // Writing to a string cannot fail.
            let _ = write!(self.field, "{x:.16e}");
            self.csv.write_field(&self.field)?;
        }
        self.csv.write_record(None::<&[u8]>)
    }

    /// The rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Leave nothing.
    pub fn discard(self) {
        drop(self.csv);
        self.new.discard();
    }

    /// Name the file: [`COMPLETE`], or [`PARTIAL`] when the run stopped early.
    ///
    /// # Errors
    /// A row or the file could not be written; nothing is left then.
    pub fn finish(self, complete: bool) -> Result<PathBuf, CliError> {
        let Trajectory { folder, new, mut csv, failure, .. } = self;
        let path = folder.join(if complete { COMPLETE } else { PARTIAL });
        let written = match failure {
            Some(error) => Err(error.into()),
            None => csv.flush(),
        };
        drop(csv);
        new.finish(written, &path)?;
        Ok(path)
    }
}
