//! The room that a run takes on the disk: an estimate before it begins, and limits while it writes.

use std::path::{Path, PathBuf};

use lieflow_model::problem::Plan;
use lieflow_model::reader::Refusal;
use lieflow_model::scene::Scene;
use lieflow_model::schema::Schema;

use crate::error::CliError;
use crate::output::{EVENTS, ROWS, TRAJECTORY, number, size};

/// The largest number of bytes that a run writes without `--yes`.
pub(super) const MOST: u64 = 10_000_000_000;
/// A run that writes more bytes says so before it begins.
const MUCH: u64 = 100_000_000;
/// The bytes of a value in a file of rows, with its comma: 21 to 25, as a rule 22.
const VALUE: u64 = 22;
/// The free bytes that a run leaves for its state, its summary and its page.
const RESERVE: u64 = 20_000_000;
/// The number of bytes after which the free bytes are counted again.
const COUNTED_EVERY: u64 = 1_000_000;

/// An estimate of what a run writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Estimate {
    rows: u64,
    columns: u64,
    /// The bytes of trajectory.csv.
    trajectory: u64,
    /// The bytes of run.rows, which goes away when the run is complete.
    records: u64,
}

impl Estimate {
    /// The estimate of this number of rows with these columns besides t.
    fn new(rows: u64, columns: usize, schema: &Schema) -> Self {
        let columns = columns as u64 + 1;
        let row = [VALUE * columns, 8 * (schema.numbers() as u64 + 2)];
        let [trajectory, records] = row.map(|bytes| rows.saturating_mul(bytes));
        Estimate { rows, columns, trajectory, records }
    }

    /// All bytes at the end of the run.
    fn bytes(self) -> u64 {
        self.trajectory.saturating_add(self.records)
    }

    /// What is written into a folder, in words.
    fn in_words(self, folder: &Path) -> String {
        let Estimate { rows, columns, trajectory, records } = self;
        format!(
            "write about {} ({} rows of {columns} columns) to {}, and {} more until it is complete",
            size(trajectory),
            number(rows as f64),
            folder.display(),
            size(records)
        )
    }

    /// Checks the estimate against a limit and the room on the disk.
    fn check(self, folder: &Path, most: u64, room: Option<u64>) -> Result<(), String> {
        let would = || format!("the run would {}", self.in_words(folder));
        match room {
            Some(room) if self.bytes().saturating_add(RESERVE) > room => {
                let (room, left) = (size(room), size(RESERVE));
                Err(format!("{}. The disk has room for {room}, of which {left} stay free", would()))
            }
            _ if self.bytes() > most => {
                Err(format!("{}. More than {} needs --yes", would(), size(most)))
            }
            _ => Ok(()),
        }
    }
}

/// The note about a run that writes much. A run may write `most` bytes.
///
/// # Errors
/// The run would write more than that, or more than the disk has room for.
pub(super) fn foresee_room(
    scene: &Scene,
    plan: &Plan<'_>,
    (columns, schema): (usize, &Schema),
    folder: &Path,
    most: u64,
) -> Result<Option<String>, CliError> {
    // Without a number of rows there must be room for the rest.
    let rows = plan.rows().unwrap_or(0);
    let estimate = Estimate::new(rows, columns, schema);
    let room = free(folder).map(|free| free.saturating_add(replaced(folder)));
    estimate.check(folder, most, room).map_err(|message| {
        let help = "write fewer rows (a larger `every` or `interval`, or a smaller `count`, in \
                    [output]) or fewer `quantities`";
        let refusal = Refusal { help: Some(help.into()), ..Refusal::at(scene.rows_key(), message) };
        scene.refuse("output", refusal)
    })?;
    let is_much = estimate.bytes() > MUCH;
    Ok(is_much.then(|| format!("will {}", estimate.in_words(folder))))
}

/// The limits of a run while it writes.
#[derive(Debug)]
pub(super) struct Room {
    folder: PathBuf,
    most: u64,
    /// The bytes that were written when the free ones were counted.
    counted: u64,
}

impl Room {
    /// The limits of a run that may write `most` bytes into a folder.
    pub(super) fn new(folder: &Path, most: u64) -> Self {
        Room { folder: folder.into(), most, counted: 0 }
    }

    /// Checks the bytes that are written so far.
    ///
    /// # Errors
    /// They are more than the limit, or the disk has no room for more.
    pub(super) fn check(&mut self, written: u64) -> Result<(), CliError> {
        if written > self.most {
            let most = size(self.most);
            return Err(CliError::TooMuch(format!("the run wrote {most}: more needs --yes")));
        }
        if written.saturating_sub(self.counted) < COUNTED_EVERY {
            return Ok(());
        }
        self.counted = written;
        match free(&self.folder) {
            Some(free) if free < RESERVE => Err(CliError::Full(format!(
                "the disk of `{}` is full: {} are left",
                self.folder.display(),
                size(free)
            ))),
            _ => Ok(()),
        }
    }
}

/// The free bytes on the disk of a folder, which may not exist yet. None if they are not known, as of what is no disk.
#[cfg(unix)]
fn free(folder: &Path) -> Option<u64> {
    let there = folder.ancestors().find(|folder| folder.is_dir()).unwrap_or(Path::new("."));
    let disk = rustix::fs::statvfs(there).ok()?;
    (disk.f_blocks > 0).then_some(disk.f_bavail)?.checked_mul(disk.f_frsize)
}

#[cfg(not(unix))]
fn free(_folder: &Path) -> Option<u64> {
    None
}

/// The bytes of the files in a folder that a run replaces.
fn replaced(folder: &Path) -> u64 {
    let names = [TRAJECTORY[1], EVENTS[1], ROWS];
    let bytes = |name| folder.join(name).metadata().map_or(0, |file| file.len());
    names.into_iter().map(bytes).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: &str = "out";

    fn estimate(trajectory: u64) -> Estimate {
        Estimate { rows: 1000, columns: 4, trajectory, records: trajectory / 2 }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let check = |trajectory, most, room| {
            estimate(trajectory).check(Path::new(HERE), most, room).err().unwrap_or_default()
        };
        assert_eq!(check(6_000_000_000, MOST, None), "");
        let message = check(7_000_000_000, MOST, None);
        let expected = "the run would write about 7 GB (1000 rows of 4 columns) to out, and 3.5 GB \
                        more until it is complete. More than 10 GB needs --yes";
        assert_eq!(message, expected);
        assert_eq!(check(7_000_000_000, u64::MAX, Some(11_000_000_000)), "");
        // The reserve has room, too; --yes is no help.
        for most in [MOST, u64::MAX] {
            assert_eq!(check(2_000_000, most, Some(RESERVE + 3_000_000)), "");
            let message = check(2_000_000, most, Some(RESERVE + 2_999_999));
            assert!(message.ends_with("for 23 MB, of which 20 MB stay free"), "{message}");
        }
        assert_eq!(check(u64::MAX, u64::MAX, None), "");
    }

    #[test]
    fn a_run_stops_at_its_limit() {
        let mut room = Room::new(Path::new(HERE), 3_000_000);
        for written in [0, 1_500_000, 3_000_000] {
            room.check(written).unwrap();
        }
        let error = room.check(3_000_001).unwrap_err();
        assert!(matches!(error, CliError::TooMuch(_)));
        assert_eq!(error.to_string(), "the run wrote 3 MB: more needs --yes");
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_is_not_there_has_the_room_of_the_one_above() {
        let [here, below] = [".", "no/such/folder"].map(|folder| free(Path::new(folder)).unwrap());
        // Others write meanwhile.
        assert!(here > 0 && here.abs_diff(below) < here / 2, "{here} {below}");
    }
}
