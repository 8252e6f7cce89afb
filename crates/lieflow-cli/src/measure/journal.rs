//! Points on disk as they are measured. An interrupted comparison continues from them, and one with other
//! options adds to them.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::WorkPoint;
use crate::error::CliError;

/// The file.
pub const JOURNAL: &str = "points.jsonl";

/// A line of the file.
#[derive(Serialize, Deserialize)]
enum Entry {
    /// The comparison that the next entries belong to.
    Of(String),
    /// A run that was judged.
    Point(String, WorkPoint),
    /// A timing of it.
    Time(String, f64),
}

/// The measurements that are known, and the file for more of them.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    points: HashMap<String, WorkPoint>,
    times: HashMap<String, Vec<f64>>,
}

impl Journal {
    /// Go on with the file in `folder`: what it has of this is known, and what it has of anything else stays.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(folder: &Path, of: &str) -> Result<Self, CliError> {
        let path = folder.join(JOURNAL);
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            read => read.map_err(CliError::io("read", &path))?,
        };
        // An interruption may have cut a line within a character.
        let mut text = String::from_utf8_lossy(&bytes).into_owned();
        let (mut points, mut times) = (HashMap::new(), HashMap::<String, Vec<f64>>::new());
        let mut ours = false;
        for line in text.lines() {
            // A line that was cut off by an interruption is no entry.
            match serde_json::from_str(line) {
                Ok(Entry::Of(what)) => ours = what == of,
                Ok(Entry::Point(key, point)) if ours => {
                    points.insert(key, point);
                }
                Ok(Entry::Time(key, seconds)) if ours => {
                    times.entry(key).or_default().push(seconds);
                }
                _ => {}
            }
        }
        if !text.is_empty() && !text.ends_with('\n') {
            text.push('\n');
        }
        text += &line_of(&Entry::Of(of.into()))?;
        crate::output::write_file(&path, &text)?;
        let file = OpenOptions::new().append(true).open(&path);
        let file = file.map_err(CliError::io("write", &path))?;
        Ok(Journal { path, file, points, times })
    }

    /// Forget everything that was measured.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(folder: &Path) -> Result<(), CliError> {
        crate::output::remove_old(&folder.join(JOURNAL))
    }

    /// How many points it knows.
    pub fn known(&self) -> usize {
        self.points.len()
    }

    pub(super) fn point(&self, key: &str) -> Option<&WorkPoint> {
        self.points.get(key)
    }

    pub(super) fn times(&self, key: &str) -> &[f64] {
        self.times.get(key).map_or(&[], Vec::as_slice)
    }

    pub(super) fn saw_point(&mut self, key: &str, point: &WorkPoint) -> Result<(), CliError> {
        self.append(&Entry::Point(key.into(), point.clone()))
    }

    pub(super) fn saw_time(&mut self, key: &str, seconds: f64) -> Result<(), CliError> {
        self.append(&Entry::Time(key.into(), seconds))
    }

    fn append(&mut self, entry: &Entry) -> Result<(), CliError> {
        let line = line_of(entry)?;
        self.file.write_all(line.as_bytes()).map_err(CliError::io("write", &self.path))
    }
}

fn line_of(entry: &Entry) -> Result<String, CliError> {
    let line = serde_json::to_string(entry);
    line.map(|line| line + "\n").map_err(|error| CliError::Message(format!("JSON: {error}")))
}

/// A number that may be none in JSON, where it is null.
pub(super) mod number {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(in super::super) fn serialize<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
        if x.is_finite() { to.serialize_some(x) } else { to.serialize_none() }
    }
    pub(in super::super) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
    }
}
