//! Saves the state of a run as bytes, and restores it to the same bits.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `lieflow` and the version of the format |
//! | 8 | a hash of what the run is: the words of `owner` |
//! | 8 each | the numbers of the state, little endian |
//! | 8 | a check sum of all bytes before |

use core::hash::Hasher;

use fnv::FnvHasher;

use super::control::StepControl;
use super::drive::Drive;
use super::integrator::Integrator;
use super::points::{AnyPoints, Saved};
use super::roots::FINEST;
use super::stats::Stats;
use super::timeline::{Looked, Pacer, Timeline, Turns};
use crate::error::Error;
use crate::methods::{MapCounts, Method};
use crate::problems::{PointOf, Problem};
use crate::space::Numbers;

/// The name of the format, and its version.
const HEADER: [u8; 8] = *b"lieflow\x06";

/// The largest number of values of a list.
const LIST_MAX: u64 = 1 << 24;

/// A hash that is the same on every machine.
fn hash(bytes: &[u8]) -> u64 {
    let mut hasher = FnvHasher::default();
    hasher.write(bytes);
    hasher.finish()
}

/// The function that reads or writes each word of a state.
type Each<'a> = dyn FnMut(&mut u64) + 'a;

fn number(each: &mut Each<'_>, x: &mut f64) {
    let mut word = x.to_bits();
    each(&mut word);
    *x = f64::from_bits(word);
}

fn flag(each: &mut Each<'_>, x: &mut bool) {
    let mut word = u64::from(*x);
    each(&mut word);
    *x = word != 0;
}

/// An optional value: a flag and the value.
fn option<T: Default>(
    each: &mut Each<'_>,
    x: &mut Option<T>,
    value: impl FnOnce(&mut Each<'_>, &mut T),
) {
    let mut there = x.is_some();
    flag(each, &mut there);
    let mut inner = x.take().unwrap_or_default();
    value(each, &mut inner);
    *x = there.then_some(inner);
}

/// Lists the words of the statistics.
fn each_of_stats(each: &mut Each<'_>, stats: &mut Stats) {
    for count in [
        &mut stats.accepted,
        &mut stats.rejected,
        &mut stats.points_within,
        &mut stats.unsure_steps,
        &mut stats.restored,
        &mut stats.not_restored,
        &mut stats.iterations,
    ] {
        each(count);
    }
    for x in [&mut stats.smallest_step, &mut stats.largest_step, &mut stats.residual] {
        number(each, x);
    }
    option(each, &mut stats.after_rejection, |each, x| x.iter_mut().for_each(|x| number(each, x)));
    option(each, &mut stats.evaluations, |each, n| each(n));
    option(each, &mut stats.maps, |each, MapCounts { psi, dpsi_inv, brackets }| {
        [psi, dpsi_inv, brackets].into_iter().for_each(each);
    });
}

/// The bytes of a state that belongs to `owner`; `words` calls its argument with every word.
fn write(owner: &str, words: &mut dyn FnMut(&mut Each<'_>)) -> Vec<u8> {
    let mut bytes = HEADER.to_vec();
    bytes.extend(hash(owner.as_bytes()).to_le_bytes());
    words(&mut |word| bytes.extend(word.to_le_bytes()));
    let sum = hash(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// Reads a state from bytes; `words` lists its words.
fn read(owner: &str, bytes: &[u8], words: &mut dyn FnMut(&mut Each<'_>)) -> Result<(), Error> {
    let refuse = |why: &str| {
        let expected = format!("the saved state of this run, but {why}");
        Err(Error::out_of_range("bytes", bytes.len() as f64, expected))
    };
    let mut saved = bytes.chunks_exact(8).map(|word| word.try_into().unwrap_or_default());
    if !bytes.len().is_multiple_of(8) || bytes.len() < 24 {
        return refuse("these bytes are no state: a state has another number of bytes");
    }
    if saved.next() != Some(HEADER) {
        return refuse("these bytes do not begin with `lieflow` and this version of the format");
    }
    let (body, sum) = bytes.split_at(bytes.len() - 8);
    if hash(body).to_le_bytes() != sum {
        return refuse("these bytes are damaged: their check sum differs");
    }
    if saved.next() != Some(hash(owner.as_bytes()).to_le_bytes()) {
        return refuse(
            "these bytes are of another group, method, choice of steps or end of the span",
        );
    }
    // Lists have a length of their own, so the words are counted as they are read.
    let there = bytes.len() / 8 - 3;
    let (mut before, mut asked) = (Vec::new(), 0);
    words(&mut |word| before.push(*word));
    words(&mut |word| {
        *word = saved.next().filter(|_| asked < there).map_or(0, u64::from_le_bytes);
        asked += 1;
    });
    if asked == there {
        return Ok(());
    }
    let mut before = before.into_iter();
    words(&mut |word| *word = before.next().unwrap_or(0));
    refuse("these bytes have another number of values")
}

/// The length of a list, and its values. New values are the default.
fn list<T: Default + Clone>(
    each: &mut Each<'_>,
    all: &mut Vec<T>,
    mut value: impl FnMut(&mut Each<'_>, &mut T),
) {
    let mut length = all.len() as u64;
    each(&mut length);
    // The zeros of a step are few: a larger number is of another state.
    all.resize(length.min(LIST_MAX) as usize, T::default());
    all.iter_mut().for_each(|x| value(each, x));
}

impl Timeline {
    fn each_word(&mut self, points: &mut dyn AnyPoints, each: &mut Each<'_>) {
        number(each, &mut self.t);
        number(each, &mut self.t1);
        number(each, &mut self.jumped_at);
        flag(each, &mut self.jumped_by_stop);
        points.each_number(Saved::State, &mut |x| number(each, x));
        points.each_number(Saved::Start, &mut |x| number(each, x));
        each(&mut self.last.n);
        number(each, &mut self.last.t);
        number(each, &mut self.last.h);
        let before = match self.looked_at {
            Looked::Nothing => 0,
            Looked::Fresh | Looked::Stale => 1,
            Looked::Prepared | Looked::Restored => 2,
        };
        let mut known = before;
        each(&mut known);
        if known != before {
            self.looked_at = match known {
                0 => Looked::Nothing,
                1 => Looked::Stale,
                _ => Looked::Restored,
            };
        }
        points.each_number(Saved::Orbit, &mut |x| number(each, x));
        each(&mut self.cadence.every);
        each(&mut self.cadence.next);
        // The workspace counts from its own start.
        let (counted, reused) = (points.iterations(), points.reused());
        self.stats.iterations = self.stats.iterations.wrapping_add(counted);
        self.stats.evaluations = self.stats.evaluations.map(|n| n.wrapping_sub(reused));
        each_of_stats(each, &mut self.stats);
        self.stats.iterations = self.stats.iterations.wrapping_sub(counted);
        self.stats.evaluations = self.stats.evaluations.map(|n| n.wrapping_add(reused));
        match &mut self.pacer {
            Pacer::Equal { grid, done, .. } => {
                grid.each_part(&mut |x| number(each, x));
                each(done);
            }
            Pacer::ByError(chooser) => {
                flag(each, &mut chooser.controller.hold);
                option(each, &mut chooser.h, number);
                option(each, &mut chooser.wall, number);
                number(each, &mut chooser.noise.per_size);
                each(&mut chooser.noise.next);
            }
        }
        if let Some(Turns { radian, next }) = &mut self.turns {
            number(each, radian);
            each(next);
        }
        points.each_number(Saved::Memory, &mut |x| number(each, x));
    }

    /// What a state belongs to.
    fn owner(&self, points: &dyn AnyPoints) -> String {
        let pace = match &self.pacer {
            // The size is that of the whole run, also after it was taken off its grid.
            Pacer::Equal { grid, size, .. } => {
                format!("{} {size:?}", if grid.is_split() { "split" } else { "equal" })
            }
            // A run that used up its attempts goes on with more of them.
            Pacer::ByError(chooser) => {
                format!("{:?}", StepControl { max_steps: 0, ..chooser.control.clone() })
            }
        };
        let costs = (self.facts.step.evaluations, self.facts.step.maps);
        let (group, order, end) = (points.group_name(), self.facts.order, self.t1);
        format!("{group} {order} {costs:?} {pace} to {end:?}")
    }

    fn save(&mut self, points: &mut dyn AnyPoints) -> Vec<u8> {
        let owner = self.owner(points);
        write(&owner, &mut |each| self.each_word(points, each))
    }

    pub(super) fn restore(
        &mut self,
        points: &mut dyn AnyPoints,
        bytes: &[u8],
    ) -> Result<(), Error> {
        let owner = self.owner(points);
        read(&owner, bytes, &mut |each| self.each_word(points, each))?;
        self.forget_workspace();
        Ok(())
    }
}

impl<P: Problem, M: Method<P>> Integrator<'_, P, M>
where
    PointOf<P>: Numbers,
{
    /// The state as bytes. [`restore`](Self::restore) continues from them with the same results, to the bit. They do not
    /// contain the problem or the method: [`restore`](Self::restore) does not see whether the numbers of the problem, the map and
    /// the stops are the same.
    pub fn save(&mut self) -> Vec<u8> {
        self.points.list = Some(Numbers::each_number);
        self.times.save(&mut self.points)
    }

    /// Continues from a state of [`save`](Self::save), of a run with the same problem, method, choice of steps and end of
    /// the span.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for bytes that are damaged, of another version of the format or of another run. Then the
    /// state is unchanged.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.points.list = Some(Numbers::each_number);
        self.times.restore(&mut self.points, bytes)?;
        self.times.ask_for(self.times.t1);
        Ok(())
    }
}

impl Drive<'_> {
    fn each_word(&mut self, points: &mut dyn AnyPoints, each: &mut Each<'_>) {
        self.times.each_word(points, each);
        let mut done = self.times_done as u64;
        each(&mut done);
        self.times_done = done as usize;
        option(each, &mut self.shown_at, number);
        flag(each, &mut self.is_within);
        let mut zeros = self.zeros_done as u64;
        each(&mut zeros);
        self.zeros_done = zeros as usize;
        list(each, &mut self.events.found, |each, zero| {
            number(each, &mut zero.t);
            let mut event = zero.event as u64;
            each(&mut event);
            zero.event = event as usize;
            flag(each, &mut zero.rising);
        });
        for event in &mut self.events.all {
            each(&mut event.count);
            number(each, &mut event.seen.value);
            flag(each, &mut event.seen.anew);
            let mut level = event.seen.level as u64;
            each(&mut level);
            event.seen.level = FINEST.min(level as usize);
            option(each, &mut event.seen.before, |each, before: &mut [f64; 2]| {
                before.iter_mut().for_each(|x| number(each, x));
            });
        }
        for drift in &mut self.drift {
            number(each, &mut drift.start);
            number(each, &mut drift.largest);
            number(each, &mut drift.size);
        }
    }

    fn owner(&self, points: &dyn AnyPoints) -> String {
        let events: Vec<&str> = self.events.all.iter().map(|event| event.name.as_str()).collect();
        format!("{} from {:?} {events:?} {:?}", self.times.owner(points), self.t0, self.save)
    }

    /// The state of the whole run as bytes.
    pub(super) fn write(&mut self, points: &mut dyn AnyPoints) -> Vec<u8> {
        let owner = self.owner(points);
        write(&owner, &mut |each| self.each_word(points, each))
    }

    /// Continues from such bytes.
    pub(super) fn read(&mut self, points: &mut dyn AnyPoints, bytes: &[u8]) -> Result<(), Error> {
        let owner = self.owner(points);
        read(&owner, bytes, &mut |each| self.each_word(points, each))?;
        self.times.forget_workspace();
        Ok(())
    }
}
