//! Files: each is written under another name and gets its own when it is complete.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use lieflow_figures::Page;

use crate::error::CliError;

/// A file that is being written beside its place.
#[derive(Debug)]
pub(super) struct NewFile(PathBuf);

impl NewFile {
    /// Start a file that may get the name `place`.
    pub(super) fn create(place: &Path) -> Result<(Self, File), CliError> {
        let mut path = place.as_os_str().to_owned();
        path.push(".partial");
        let path = PathBuf::from(path);
        match File::create(&path) {
            Ok(file) => Ok((NewFile(path), file)),
            Err(source) => Err(CliError::Io { doing: "write", path, source }),
        }
    }

    /// Name the file; remove it if it was not `written`, or cannot be named.
    pub(super) fn finish(self, written: io::Result<()>, place: &Path) -> Result<(), CliError> {
        written.and_then(|()| fs::rename(&self.0, place)).map_err(|source| {
            self.discard();
            CliError::Io { doing: "write", path: place.into(), source }
        })
    }

    /// Leave nothing.
    pub(super) fn discard(&self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Write a file at once: no half of it ever has this name.
///
/// # Errors
/// The file cannot be written.
pub fn write_file(path: &Path, content: impl AsRef<[u8]>) -> Result<(), CliError> {
    let (new, mut file) = NewFile::create(path)?;
    let written = file.write_all(content.as_ref());
    drop(file);
    new.finish(written, path)
}

/// Write a table as CSV.
///
/// # Errors
/// The file cannot be written.
pub fn write_csv<N: AsRef<str>>(
    path: &Path,
    header: impl IntoIterator<Item = N>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> Result<(), CliError> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    let header: Vec<String> = header.into_iter().map(|name| name.as_ref().into()).collect();
    let written = core::iter::once(header).chain(rows).try_for_each(|row| csv.write_record(row));
    let text = written.map_err(io::Error::from);
    let text = text.and_then(|()| csv.into_inner().map_err(csv::IntoInnerError::into_error));
    write_file(path, text.map_err(CliError::io("write", path))?)
}

/// The digits of a number, for a file. A number that is not finite gives an empty field.
pub fn in_full(x: f64) -> String {
    if x.is_finite() { format!("{x:e}") } else { String::new() }
}

/// The text of a value, for a file. A value that is missing gives an empty field.
pub fn optional<T: ToString>(x: Option<T>) -> String {
    x.map_or_else(String::new, |x| x.to_string())
}

/// Values as the fields of a row.
macro_rules! fields {
    ($($value:expr),* $(,)?) => { vec![$($value.to_string()),*] };
}
pub(crate) use fields;

/// Write a page with its figures as SVG files beside it; the path of the page.
///
/// # Errors
/// A file cannot be written.
pub fn write_page(folder: &Path, name: &str, page: &Page) -> Result<PathBuf, CliError> {
    make_folder(folder)?;
    for (name, svg) in page.figures() {
        write_file(&folder.join(name), svg)?;
    }
    let path = folder.join(name);
    write_file(&path, page.html())?;
    Ok(path)
}

/// Make a folder for results, with those above it.
///
/// # Errors
/// It cannot be made.
pub fn make_folder(path: &Path) -> Result<(), CliError> {
    fs::create_dir_all(path).map_err(CliError::io("make the folder", path))
}

/// Remove a file of an earlier run, if there is one.
///
/// # Errors
/// It is there and stays.
pub fn remove_old(path: &Path) -> Result<(), CliError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(CliError::Io { doing: "replace", path: path.into(), source })
        }
        _ => Ok(()),
    }
}
