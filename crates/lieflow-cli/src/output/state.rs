//! The state of a run on disk, from which it goes on to the same bits after an interruption, even a kill.
//!
//! `run.state` is one state, replaced as a whole. Its words have 8 bytes each, little endian:
//!
//! | words | |
//! |---|---|
//! | 1 | the name of the format and its version |
//! | 2 | what the run is of: the version of the program, and the scene |
//! | 3 | of `run.rows` at that time: the words of a record, the records, their check sum |
//! | 1 | the number of what was seen where no row is |
//! | 1 | a check sum of the other words, the driver's too |
//! | as many | what was seen where no row is, as at the ends of steps; none at the start of a run |
//! | the rest | the state of the driver; nothing at the start of a run |
//!
//! `run.rows` is what the run showed, in records of one length: what it is ([`Kind`]), t, the numbers of the row.
//! What follows the records of the state is of no use, and is dropped. Both go away when the run is complete.

use core::hash::Hasher;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use fnv::FnvHasher;

use super::files::{BYTES, remove_old, write_file};
use crate::error::CliError;

const STATE: &str = "run.state";
/// What a run showed, until it is complete.
pub const ROWS: &str = "run.rows";

/// The name of the format, and its version.
const FORMAT: u64 = u64::from_le_bytes(*b"lf-run\x00\x05");

/// The words before the check sum.
const HEAD: usize = 7;

/// The numbers that a run saw where it has no row.
pub type Seen = Vec<f64>;

/// What a record is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A row of the trajectory.
    Row,
    /// A zero of the event of this number.
    Event(usize),
}

/// The check sum of words, one after the other.
fn sum(sum: u64, word: u64) -> u64 {
    let mut hasher = FnvHasher::with_key(sum);
    hasher.write(&word.to_le_bytes());
    hasher.finish()
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u64> {
    bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    })
}

/// What was shown of a run up to some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Shown {
    /// The words of a record; 0 before the first.
    length: u64,
    records: u64,
    sum: u64,
}

/// The rows and zeros that a run has shown, on disk.
#[derive(Debug)]
pub struct ShownRows {
    path: PathBuf,
    shown: Shown,
}

impl ShownRows {
    /// A reader, from the first record on.
    ///
    /// # Errors
    /// The file cannot be opened.
    pub fn open(&self) -> io::Result<Records<File>> {
        Ok(Records::new(File::open(&self.path)?, self.shown))
    }

    /// The number of the rows and zeros.
    pub fn count(&self) -> u64 {
        self.shown.records
    }
}

/// A reader of records, one after the other.
#[derive(Debug)]
pub struct Records<F> {
    reader: BufReader<F>,
    record: Vec<u8>,
    numbers: Vec<f64>,
    left: u64,
}

impl<F: Read> Records<F> {
    fn new(file: F, Shown { length, records, .. }: Shown) -> Self {
        let reader = BufReader::with_capacity(BYTES, file);
        Records { reader, record: vec![0; 8 * length as usize], numbers: Vec::new(), left: records }
    }

    /// Reads the next record. False: there is none.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(&mut self) -> io::Result<bool> {
        if self.left == 0 {
            return Ok(false);
        }
        self.left -= 1;
        self.reader.read_exact(&mut self.record)?;
        self.numbers.clear();
        self.numbers.extend(words(&self.record).skip(1).map(f64::from_bits));
        Ok(true)
    }

    /// The record that was read: its kind, its t and its numbers.
    pub fn shown(&self) -> (Kind, f64, &[f64]) {
        let kind = match words(&self.record).next() {
            None | Some(0) => Kind::Row,
            Some(event) => Kind::Event(event as usize - 1),
        };
        match self.numbers.split_first() {
            Some((t, numbers)) => (kind, *t, numbers),
            None => (kind, f64::NAN, &[]),
        }
    }
}

/// The state of a run on disk.
#[derive(Debug)]
pub struct RunState {
    folder: PathBuf,
    owner: [u64; 2],
    shown: Shown,
    file: Option<File>,
    /// Records that are not written yet.
    buffer: Vec<u8>,
}

impl RunState {
    /// Is there a run to go on with?
    pub fn is_in(folder: &Path) -> bool {
        folder.join(STATE).is_file()
    }

    fn new(folder: &Path, scene: u64) -> Self {
        let version = env!("CARGO_PKG_VERSION").bytes().fold(0, |a, b| sum(a, u64::from(b)));
        let (shown, owner) = (Shown::default(), [version, scene]);
        RunState { folder: folder.into(), owner, shown, file: None, buffer: Vec::new() }
    }

    /// Begin a run of the scene with this fingerprint.
    ///
    /// # Errors
    /// A file cannot be written, or an old one cannot be removed.
    pub fn begin(folder: &Path, scene: u64) -> Result<Self, CliError> {
        let mut state = Self::new(folder, scene);
        state.save(&[], &[])?;
        remove_old(&folder.join(ROWS))?;
        Ok(state)
    }

    /// The state of a run of the scene with this fingerprint, what it saw where it has no row, and the state of its driver;
    /// none at its start.
    ///
    /// # Errors
    /// There is no saved run. The saved run is damaged. It belongs to another scene or to another version of the
    /// program.
    pub fn open(folder: &Path, scene: u64) -> Result<(Self, Seen, Option<Vec<u8>>), CliError> {
        let path = folder.join(STATE);
        let bytes = fs::read(&path).map_err(CliError::io("read", &path))?;
        let mut state = Self::new(folder, scene);
        let (head, rest) = bytes.split_at(bytes.len().min(8 * (HEAD + 1)));
        let head: Vec<u64> = words(head).collect();
        let &[FORMAT, version, of, length, records, rows, seen, check] = &head[..] else {
            return Err(state.damaged());
        };
        if check != sum_of(&head[..HEAD], rest) {
            return Err(state.damaged());
        }
        let of_seen = usize::try_from(seen).ok().and_then(|seen| seen.checked_mul(8));
        let Some((seen, driver)) = of_seen.and_then(|bytes| rest.split_at_checked(bytes)) else {
            return Err(state.damaged());
        };
        let seen = words(seen).map(f64::from_bits).collect();
        if version != state.owner[0] {
            let message = "the run was begun by another version of the program: start it again \
                           without --resume";
            return Err(CliError::Message(message.into()));
        }
        if of != scene {
            let message = "the scene has changed since the run was begun: start it again without \
                           --resume, or go on with the scene as it was";
            return Err(CliError::Message(message.into()));
        }
        state.shown = Shown { length, records, sum: rows };
        state.check_rows()?;
        Ok((state, seen, (!driver.is_empty()).then(|| driver.to_vec())))
    }

    fn damaged(&self) -> CliError {
        let folder = self.folder.display();
        CliError::Message(format!(
            "the saved run in `{folder}` is damaged: start it again without --resume"
        ))
    }

    /// Checks the records of the run, before a file of it is touched.
    fn check_rows(&self) -> Result<(), CliError> {
        let path = self.folder.join(ROWS);
        let Shown { length, records, sum: expected } = self.shown;
        if records == 0 {
            return Ok(());
        }
        let file = match File::open(&path) {
            Err(source) if source.kind() == io::ErrorKind::NotFound => return Err(self.damaged()),
            opened => opened.map_err(CliError::io("read", &path))?,
        };
        let bytes = length.checked_mul(8).and_then(|bytes| bytes.checked_mul(records));
        let there = file.metadata().map_err(CliError::io("read", &path))?.len();
        if length < 2 || bytes.is_none_or(|bytes| bytes > there) {
            return Err(self.damaged());
        }
        let (mut reader, mut found) = (Records::new(&file, self.shown), 0);
        while reader.read().map_err(CliError::io("read", &path))? {
            found = words(&reader.record).fold(found, sum);
        }
        if found == expected { Ok(()) } else { Err(self.damaged()) }
    }

    /// Show what the run showed before the state was saved, and go on from there.
    ///
    /// # Errors
    /// The records cannot be read, or `show` fails.
    pub fn replay(
        &mut self,
        mut show: impl FnMut(Kind, f64, &[f64]) -> Result<(), CliError>,
    ) -> Result<(), CliError> {
        let path = self.folder.join(ROWS);
        if self.shown.records == 0 {
            return remove_old(&path);
        }
        let file = OpenOptions::new().read(true).append(true).open(&path);
        let file = file.map_err(CliError::io("read", &path))?;
        let mut reader = Records::new(&file, self.shown);
        while reader.read().map_err(CliError::io("read", &path))? {
            let (kind, t, numbers) = reader.shown();
            show(kind, t, numbers)?;
        }
        file.set_len(self.bytes()).map_err(CliError::io("write", &path))?;
        self.file = Some(file);
        Ok(())
    }

    /// Keep what the run shows.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn record(&mut self, kind: Kind, t: f64, numbers: &[f64]) -> Result<(), CliError> {
        let kind = match kind {
            Kind::Row => 0,
            Kind::Event(event) => event as u64 + 1,
        };
        let numbers = core::iter::once(&t).chain(numbers).map(|x| x.to_bits());
        for word in core::iter::once(kind).chain(numbers) {
            self.shown.sum = sum(self.shown.sum, word);
            self.buffer.extend(word.to_le_bytes());
        }
        if self.shown.records == 0 {
            self.shown.length = self.buffer.len() as u64 / 8;
        }
        self.shown.records += 1;
        if self.buffer.len() >= BYTES { self.flush() } else { Ok(()) }
    }

    /// What the run has shown so far, to be read again while the run is kept.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn shown(&mut self) -> Result<ShownRows, CliError> {
        self.flush()?;
        Ok(ShownRows { path: self.folder.join(ROWS), shown: self.shown })
    }

    fn flush(&mut self) -> Result<(), CliError> {
        if self.buffer.is_empty() {
            return Ok(());
        }
        let path = self.folder.join(ROWS);
        let file = match &mut self.file {
            Some(file) => file,
            none => {
                let new = OpenOptions::new().create(true).append(true).open(&path);
                none.insert(new.map_err(CliError::io("write", &path))?)
            }
        };
        file.write_all(&self.buffer).map_err(CliError::io("write", &path))?;
        self.buffer.clear();
        Ok(())
    }

    /// The run is in this state of its driver, after what it showed so far. `seen` is what it saw where it has no row.
    ///
    /// # Errors
    /// A file cannot be written: then the state before is there.
    pub fn save(&mut self, seen: &[f64], driver: &[u8]) -> Result<(), CliError> {
        self.flush()?;
        // The records that a state counts are on the disk before it.
        let kept = self.file.as_ref().map_or(Ok(()), File::sync_data);
        kept.map_err(CliError::io("write", &self.folder.join(ROWS)))?;
        let Shown { length, records, sum } = self.shown;
        let [version, scene] = self.owner;
        let head: [u64; HEAD] = [FORMAT, version, scene, length, records, sum, seen.len() as u64];
        let seen = seen.iter().flat_map(|x| x.to_le_bytes());
        let rest: Vec<u8> = seen.chain(driver.iter().copied()).collect();
        let head = head.into_iter().chain([sum_of(&head, &rest)]);
        let mut bytes: Vec<u8> = head.flat_map(u64::to_le_bytes).collect();
        bytes.extend(rest);
        write_file(&self.folder.join(STATE), &bytes)
    }

    /// The bytes of the records so far.
    pub fn bytes(&self) -> u64 {
        8 * self.shown.length * self.shown.records
    }

    /// The run is complete.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn finish(self) -> Result<(), CliError> {
        drop(self.file);
        [STATE, ROWS].iter().try_for_each(|name| remove_old(&self.folder.join(name)))
    }
}

/// The check sum of a state.
fn sum_of(head: &[u64], rest: &[u8]) -> u64 {
    words(rest).fold(head.iter().copied().fold(0, sum), sum)
}
