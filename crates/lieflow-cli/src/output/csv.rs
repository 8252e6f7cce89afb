//! trajectory.csv: rows as they come, every value with 17 significant digits.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::remove_old;
use crate::cmd::CliError;

/// A complete trajectory.
pub const COMPLETE: &str = "trajectory.csv";
/// A trajectory up to a step that failed.
pub const PARTIAL: &str = "trajectory.partial.csv";
/// A trajectory that is being written.
const GROWING: &str = "trajectory.csv.partial";

/// A trajectory that is being written. Only [`finish`](Trajectory::finish) gives it its name.
#[derive(Debug)]
pub struct Trajectory {
    folder: PathBuf,
    file: BufWriter<File>,
    line: String,
    rows: u64,
    failure: Option<io::Error>,
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
        let path = folder.join(GROWING);
        let file = File::create(&path).map_err(CliError::io("write", &path))?;
        let (mut file, header) = (BufWriter::new(file), columns.join(","));
        writeln!(file, "t,{header}").map_err(CliError::io("write", &path))?;
        Ok(Trajectory { folder: folder.into(), file, line: String::new(), rows: 0, failure: None })
    }

    /// Write a row. What goes wrong is kept for the end.
    pub fn row(&mut self, t: f64, values: &[f64]) {
        use core::fmt::Write as _;
        if self.failure.is_some() {
            return;
        }
        self.line.clear();
        // Writing to a string cannot fail.
        let _ = write!(self.line, "{t:.16e}");
        for value in values {
            let _ = write!(self.line, ",{value:.16e}");
        }
        self.line.push('\n');
        match self.file.write_all(self.line.as_bytes()) {
            Ok(()) => self.rows += 1,
            Err(error) => self.failure = Some(error),
        }
    }

    /// The rows so far.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Leave nothing.
    pub fn discard(self) {
        drop(self.file);
        let _ = fs::remove_file(self.folder.join(GROWING));
    }

    /// Name the file: [`COMPLETE`], or [`PARTIAL`] when the run stopped early.
    ///
    /// # Errors
    /// A row or the file could not be written; nothing is left then.
    pub fn finish(mut self, complete: bool) -> Result<PathBuf, CliError> {
        let growing = self.folder.join(GROWING);
        let path = self.folder.join(if complete { COMPLETE } else { PARTIAL });
        let written = match self.failure.take() {
            Some(error) => Err(error),
            None => self.file.flush(),
        };
        drop(self.file);
        match written.and_then(|()| fs::rename(&growing, &path)) {
            Ok(()) => Ok(path),
            Err(source) => {
                let _ = fs::remove_file(&growing);
                Err(CliError::Io { doing: "write", path, source })
            }
        }
    }
}
