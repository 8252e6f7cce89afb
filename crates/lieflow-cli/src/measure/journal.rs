//! Points on disk as they are measured, so that a comparison which is interrupted goes on.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::WorkPoint;
use crate::cmd::CliError;

/// The file, while there is something to go on with.
pub const JOURNAL: &str = "points.jsonl";

/// A line of the file.
#[derive(Serialize, Deserialize)]
enum Entry {
    /// What is measured; first.
    Of(String),
    /// A run that was judged.
    Point(String, WorkPoint),
    /// A timing of it.
    Time(String, f64),
}

/// What is known already, and where more of it goes.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    points: HashMap<String, WorkPoint>,
    times: HashMap<String, Vec<f64>>,
}

impl Journal {
    /// Go on with the file in `folder` if it is about the same thing, or begin a new one.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(folder: &Path, of: &str) -> Result<Self, CliError> {
        let path = folder.join(JOURNAL);
        let old = fs::read_to_string(&path).unwrap_or_default();
        // A line that was cut off by the interruption is no entry.
        let entry = |line| Some((line, serde_json::from_str::<Entry>(line).ok()?));
        let mut entries = old.lines().map_while(entry);
        let same = matches!(entries.next(), Some((_, Entry::Of(what))) if what == of);
        let (mut points, mut times) = (HashMap::new(), HashMap::<String, Vec<f64>>::new());
        let mut text = line_of(&Entry::Of(of.into()))?;
        for (line, entry) in entries.take_while(|_| same) {
            match entry {
                Entry::Of(_) => {}
                Entry::Point(key, point) => {
                    points.insert(key, point);
                }
                Entry::Time(key, seconds) => times.entry(key).or_default().push(seconds),
            }
            text += line;
            text.push('\n');
        }
        crate::output::write_file(&path, &text)?;
        let file = OpenOptions::new().append(true).open(&path);
        let file = file.map_err(CliError::io("write", &path))?;
        Ok(Journal { path, file, points, times })
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

    /// Everything is measured: the next comparison begins anew.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn finish(self) -> Result<(), CliError> {
        drop(self.file);
        crate::output::remove_old(&self.path)
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
