//! The texts of files: scenes, and the samples that they name.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::bundled;

/// Larger files are neither scenes nor samples.
const SIZE_MAX: u64 = 64 << 20;

/// All the text that a reader has; `what` it should be.
pub(super) fn text_of(reader: impl Read, what: &str) -> Result<String, String> {
    let mut bytes = Vec::new();
    let read = reader.take(SIZE_MAX + 1).read_to_end(&mut bytes);
    read.map_err(|error| format!("cannot read the {what}: {error}"))?;
    if bytes.len() as u64 > SIZE_MAX {
        return Err(format!("larger than {} MiB, expected a {what} file", SIZE_MAX >> 20));
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err("the text is UTF-16: save it as UTF-8".into());
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..valid].iter().filter(|byte| **byte == b'\n').count() + 1;
        format!("line {line} is not UTF-8 text")
    })
}

/// The text of a file of samples: in the folder, or else of those that come with the program.
pub(super) fn read_samples(folder: Option<&Path>, name: &str) -> Result<String, String> {
    let path = folder.map(|folder| folder.join(name)).filter(|path| path.is_file());
    match (path, bundled::file(name)) {
        (Some(path), _) => {
            let file =
                File::open(&path).map_err(|error| format!("cannot read the samples: {error}"));
            file.and_then(|file| text_of(file, "samples")).map_err(|why| format!("{name}: {why}"))
        }
        (None, Some(text)) => Ok(text.into()),
        (None, None) => Err(format!("there is no file `{name}` beside the scene")),
    }
}
