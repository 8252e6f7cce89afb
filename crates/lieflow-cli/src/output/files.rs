//! Files: each is written under another name and gets its own when it is complete.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use lieflow_figures::Page;

use crate::error::CliError;

/// What is written bit by bit reaches its file when it has this many bytes.
pub(super) const BYTES: usize = 1 << 16;

/// Write a file at once: no half of it ever has this name, and what has the name is on the disk.
///
/// # Errors
/// The file cannot be written.
pub fn write_file(path: &Path, content: impl AsRef<[u8]>) -> Result<(), CliError> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".partial");
    let beside = PathBuf::from(beside);
    let mut file = File::create(&beside).map_err(CliError::io("write", &beside))?;
    let written = file.write_all(content.as_ref());
    let named = written.and_then(|()| name_file(&file, &beside, path));
    named.map_err(|source| {
        let _ = fs::remove_file(&beside);
        CliError::Io { doing: "write", path: path.into(), source }
    })
}

/// Give a complete file its name. A power cut leaves the old file or the new one: the bytes are on the disk first.
pub(super) fn name_file(file: &File, from: &Path, name: &Path) -> io::Result<()> {
    file.sync_all()?;
    fs::rename(from, name)
}

/// Write a page with its figures as SVG files beside it; the path of the page.
///
/// # Errors
/// A file cannot be written.
pub fn write_page(folder: &Path, name: &str, page: &Page) -> Result<PathBuf, CliError> {
    make_folder(folder)?;
    write_figures(folder, page)?;
    let path = folder.join(name);
    write_file(&path, page.html())?;
    Ok(path)
}

/// Write the figures of a page as SVG files; their names.
///
/// # Errors
/// A file cannot be written.
pub fn write_figures(folder: &Path, page: &Page) -> Result<Vec<String>, CliError> {
    let write = |(name, svg): (String, String)| {
        write_file(&folder.join(&name), svg)?;
        Ok(name)
    };
    page.figures().into_iter().map(write).collect()
}

/// Make a folder for results, with those above it.
///
/// # Errors
/// It cannot be made.
pub fn make_folder(path: &Path) -> Result<(), CliError> {
    fs::create_dir_all(path).map_err(CliError::io("make the folder", path))
}

/// A folder that one run writes into. It is free when this value is dropped, also where the program is killed.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Lock a folder. A file system without locks locks nothing.
    ///
    /// # Errors
    /// Another run writes into the folder, or the file of the lock cannot be written.
    pub fn of(folder: &Path) -> Result<Self, CliError> {
        let path = folder.join("run.lock");
        loop {
            let file = File::create(&path).map_err(CliError::io("write", &path))?;
            if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
                return Err(CliError::Message(format!(
                    "another run writes into `{}`: wait until it ends, or name another folder with --out",
                    folder.display()
                )));
            }
            // A run that ended meanwhile may have removed this file, and the next run would make another one.
            if is_at(&file, &path) {
                return Ok(Lock { path, _file: file });
            }
        }
    }
}

/// Has the file this path?
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let number = |data: fs::Metadata| (data.dev(), data.ino());
    let [open, there] = [file.metadata(), fs::metadata(path)].map(|data| data.ok().map(number));
    open == there
}

/// A file that is open keeps its path.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
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
