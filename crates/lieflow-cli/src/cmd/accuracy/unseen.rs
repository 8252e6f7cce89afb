//! What two runs of one kind do not see: rounding that both have, and what both pass over.

use std::sync::atomic::Ordering;
use std::time::Instant;

use lieflow::problems::explained_by_rounding;
use lieflow_model::problem::{
    GRADED_MOST, LAST_DIGITS, SHORT_STEPS, finer, is_elsewhere, search_step, stays, time_to_search,
};
use lieflow_timing::cpu_seconds;

use super::{Check, NO_DIGIT, OWN, Size, Taken, Way};
use crate::cmd::apart::Apart;
use crate::output::{Accuracy, FoundBy, number, rough};

/// The search for a short pulse is given up after this many times the time that it may take.
const MISJUDGED: f64 = 3.0;
/// Another run in half of these short steps differs by less than this part of it where it was something short.
const RESOLVED: f64 = 1e-3;
/// A search that takes so many times more attempts than is expected has met something, such as a jump that takes many steps.
const HARD: u64 = 10;
/// The CPU time of a run below this many seconds says little of that of another. Then a run in short steps is begun in any
/// case, and ends at its deadline.
const BRIEF: f64 = 0.015;
/// A motion that makes this of the last digits of its start is worth a warning.
const AMPLIFIED: f64 = 1e-8;
/// Rounding in a run is like this part of it.
const OF_CHANGE: f64 = 1.0 / 16.0;
/// A motion that makes this of it is worth a warning, where the error of the method is smaller.
const GROWN: f64 = 1e-6;

/// The share of a distance that is the error. Where rounding decides it, a run at a larger tolerance is no worse, and the whole
/// distance is the error: where the last digits of the start move the end by more than the distance.
pub(super) fn with_rounding(
    (found_by, share): (FoundBy, f64),
    apart: &Apart,
    moved: Option<f64>,
) -> f64 {
    let distance = apart.parts.iter().map(|part| part.last.relative).fold(0.0, f64::max);
    match (found_by, moved) {
        (FoundBy::TenfoldTolerance, Some(moved)) if distance > 0.0 => {
            (0.5 * moved / distance).min(1.0).max(share)
        }
        _ => share,
    }
}

/// What a search finds beside a run.
pub(super) enum Found {
    /// Its rows are those of the run.
    Nothing,
    /// They come near those of the run as its steps get shorter: f jumps near the ends of steps. The distances from the finest.
    Jumps(Accuracy),
    /// They are elsewhere: steps of the run have passed over something, such as a short pulse, or a jump between the last node
    /// of a step and its end. Neither of two runs in such steps evaluates f there, so their distance shows nothing.
    Elsewhere {
        /// The distances.
        distance: Accuracy,
        /// Is the last row elsewhere?
        is_at_end: bool,
        /// The last row of the search.
        last: Vec<f64>,
    },
}

/// The error of a run that passes over something, or seems to.
pub(super) struct PassedOver {
    pub(super) accuracy: Accuracy,
    pub(super) warning: Option<String>,
    pub(super) note: Option<String>,
}

impl Check<'_> {
    /// The size of short steps.
    pub(super) fn short_step(&self) -> f64 {
        let [t0, end] = self.run.t_span;
        (end - t0).abs() / SHORT_STEPS as f64
    }

    /// Does a run choose its steps by their error?
    fn is_by_error(&self, way: Way) -> bool {
        way.default || self.scene().tolerances().is_some()
    }

    /// A run in short steps, and their size, where the largest that this run took is larger.
    pub(super) fn short_steps(&self, way: Way, taken: Taken) -> Option<(f64, Way)> {
        let short = self.short_step();
        let attempts = HARD * (SHORT_STEPS + taken.steps);
        let way = match self.is_by_error(way) {
            true => Way { largest: Some(short), attempts, ..way },
            false => Way { factor: short / self.scene().grid.h().abs(), ..way },
        };
        (2.0 * short < taken.largest).then_some((short, way))
    }

    /// A run in short steps that shows what the steps that this run took have passed over; and their size.
    pub(super) fn search(&self, way: Way, taken: Taken) -> Option<(f64, Way)> {
        if self.is_by_error(way) {
            return self.short_steps(way, taken);
        }
        let [t0, end] = self.run.t_span;
        let size = search_step((end - t0).abs(), taken.largest);
        Some((size, Way { factor: size / self.scene().grid.h().abs(), ..way }))
    }

    /// The setting that limits the steps to this size.
    pub(super) fn limit_of_steps(&self, size: f64) -> String {
        match self.scene().tolerances() {
            Some(_) => format!("h_max = {}", number(size)),
            None => self.step_size(size),
        }
    }

    /// The setting of steps of one size.
    pub(super) fn step_size(&self, size: f64) -> String {
        let instead = if self.scene().counts_steps() { " instead of `steps`" } else { "" };
        format!("dt = {}{instead}", number(size))
    }

    /// What a search finds beside rows of a run, of these two ways. The error of the run is known, and `moved` is what rounding
    /// moves its end by. Where steps are chosen by their error, only the last row is compared.
    ///
    /// # Errors
    /// Why the search has no rows.
    pub(super) fn found_by(
        &self,
        (own, way): (Way, Way),
        (times, rows, sizes): (&[f64], &[Vec<f64>], &[Size]),
        (known, moved): (&Accuracy, f64),
    ) -> Result<Found, String> {
        let clock = Instant::now();
        let from = if self.is_by_error(way) { times.len().saturating_sub(1) } else { 0 };
        let (times, rows) = (&times[from..], &rows[from..]);
        let distances = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            let apart = self.rows_apart(times, [a, b], sizes);
            self.judge((FoundBy::ShortSteps, 1.0), &apart, moved, clock)
        };
        let begun = cpu_seconds();
        let (others, taken) = self.rows_at(way, times)?;
        let spent = cpu_seconds() - begun;
        let found = distances(rows, &others);
        let growth = (moved / (OF_CHANGE * LAST_DIGITS)).max(1.0);
        let rounding = explained_by_rounding(taken.steps, growth);
        let is_far = |found: f64, known: f64| is_elsewhere(found, known.max(rounding));
        let is_at_end = is_far(found.at_end(), known.at_end());
        if !is_at_end && !is_far(found.relative(), known.relative()) {
            return Ok(Found::Nothing);
        }
        let last = others.last().cloned().unwrap_or_default();
        if self.is_by_error(way) {
            return Ok(Found::Elsewhere { distance: found, is_at_end, last });
        }
        // Small errors may grow within the span, and not at its end.
        let changed = self.changed_start(way, LAST_DIGITS);
        let changed = changed.and_then(|start| self.rows_from(Some(start), way, times, true).ok());
        if let Some((changed, _)) = changed
            && !is_elsewhere(found.relative(), distances(&others, &changed).relative())
        {
            return Ok(Found::Nothing);
        }
        let left = self.deadline.get().map_or(f64::INFINITY, |until| until - cpu_seconds());
        let finer = finer(spent, left).and_then(|times_shorter| {
            let way = Way { factor: way.factor / times_shorter, ..way };
            self.rows_at(way, times).ok()
        });
        let nearer = match finer.map(|(finer, _)| distances(rows, &finer)) {
            Some(distance) if stays(distance.relative(), found.relative()) => {
                return Ok(Found::Elsewhere { distance, is_at_end, last });
            }
            nearer => nearer.unwrap_or(found),
        };
        // Where steps end at the jumps, so do their parts.
        let [t0, end] = self.run.t_span;
        let steps = (end - t0).abs() / (own.factor * self.scene().grid.h().abs());
        let parts = match steps <= GRADED_MOST as f64 {
            true => self.rows_at(Way { graded: true, ..own }, times).ok(),
            false => None,
        };
        let is_right = parts.is_some_and(|(parts, _)| {
            !is_far(distances(rows, &parts).relative(), known.relative())
        });
        Ok(if is_right { Found::Nothing } else { Found::Jumps(nearer) })
    }

    /// What a search finds beside the run itself: the distances of the rows from those of the search, with a sentence. A pulse
    /// whose effect dies out between the rows is not seen.
    ///
    /// # Errors
    /// The search ended early, at something that the run has not met.
    pub(super) fn passed_over(
        &self,
        known: &Accuracy,
        seconds: f64,
    ) -> Result<Option<PassedOver>, String> {
        if self.is_exact || self.ended_by_event {
            return Ok(None);
        }
        let search = self.search(OWN, self.own).zip(self.time_to_search(seconds));
        let Some(((size, way), most)) = search else { return Ok(None) };
        // The estimate of its time may be wrong: within a pulse f may be dear, or steps small.
        let until = cpu_seconds() + most * MISJUDGED;
        self.deadline.set(Some(until));
        let rows = (&self.sample[..], &self.rows[..], &self.run.sizes[..]);
        let found = self.found_by((OWN, way), rows, (known, self.moved.get()));
        self.deadline.set(None);
        let (found, is_at_end, last) = match found {
            Ok(Found::Nothing) => return Ok(None),
            Ok(Found::Jumps(nearer)) => {
                let note = "f seems to jump near the ends of steps, where no stage is. The error is the distance from a run in short \
                            steps. Name the times of the jumps: `stops` in [time]";
                return Ok(Some(PassedOver {
                    accuracy: nearer,
                    warning: None,
                    note: Some(note.into()),
                }));
            }
            Ok(Found::Elsewhere { distance, is_at_end, last }) => (distance, is_at_end, last),
            Err(_) if cpu_seconds() > until || self.is_stopped() => return Ok(None),
            Err(why) => {
                return Err(format!("in steps of at most {} the run fails: {why}", number(size)));
            }
        };
        let (name, when) = found.worst().map_or(("", String::new()), |worst| {
            let is = if is_at_end {
                "ends elsewhere".into()
            } else {
                format!("is elsewhere {}", found.when(worst.t))
            };
            (&worst.name, is)
        });
        let elsewhere = format!("in steps of at most {} `{name}` {when}", number(size));
        // Where their error chooses the steps, shorter ones do not move an end that short ones have found.
        let half = way.largest.map(|h| Way { largest: Some(0.5 * h), ..way });
        let half = half.and_then(|half| self.rows_at(half, &[self.end()]).ok()?.0.pop());
        let moved =
            half.map_or(0.0, |half| self.ends_apart([[&last, &half]].into_iter()).relative());
        let warning = match moved < RESOLVED * found.relative() {
            true => {
                let smaller = match self.short_steps(OWN, self.own) {
                    Some((short, _)) => {
                        format!("Give {} in [time], or less", self.limit_of_steps(short))
                    }
                    None => "Take smaller steps".into(),
                };
                format!(
                    "{elsewhere}: the steps of this run, of up to {}, pass over something short, such as a pulse or a jump. \
                     {smaller}; or name the times of jumps: `stops` in [time]",
                    number(self.own.largest)
                )
            }
            false => format!(
                "{elsewhere}, and elsewhere again in half of these: small errors grow fast here, or f jumps at times that are no `stops`"
            ),
        };
        Ok(Some(PassedOver { accuracy: found, warning: Some(warning), note: None }))
    }

    fn is_stopped(&self) -> bool {
        self.run.stop.load(Ordering::Relaxed)
    }

    /// How far the last digits of the start move the end of a run. Rounding in the run does the same, and a second run
    /// does not see it where both round alike. The exact motion has this error, too.
    pub(super) fn moved_by_last_digits(&self, seconds: f64) -> Option<Accuracy> {
        let has_order = self.watch.model.order(&self.method(OWN)).ok()?.is_some();
        if self.ended_by_event || (self.is_exact && has_order) {
            return None;
        }
        let brief = MISJUDGED * seconds.max(BRIEF);
        if !has_order {
            // Steps of one size of an exact method are one step.
            let way = Way { factor: self.own.steps.max(1) as f64, ..OWN };
            let ends = [1.0, -1.0].map(|sign| self.changed_end(way, sign * f64::EPSILON, brief));
            let ends = ends.iter().flatten();
            return Some(self.ends_apart(ends.filter_map(|end| Some([self.rows.last()?, end]))));
        }
        let changed = self.changed_end(OWN, LAST_DIGITS, brief);
        let last = |end| Some([self.rows.last()?, end]);
        let moved = self.ends_apart(changed.iter().filter_map(last));
        if moved.relative() <= GROWN {
            return Some(moved);
        }
        // One of the two may have passed over a short pulse. Runs in short steps do not.
        let in_short_steps = || {
            let (_, short) = self.short_steps(OWN, self.own)?;
            let most = MISJUDGED * self.time_to_search(seconds)?;
            let ends = [0.0, LAST_DIGITS].map(|change| self.changed_end(short, change, most));
            let [Some(one), Some(other)] = ends else { return None };
            Some(self.ends_apart([[&one, &other]].into_iter()))
        };
        Some(in_short_steps().filter(|other| other.relative() <= GROWN).unwrap_or(moved))
    }

    /// How long a run in short steps may take.
    fn time_to_search(&self, seconds: f64) -> Option<f64> {
        time_to_search(self.own.steps, if seconds < BRIEF { 0.0 } else { seconds })
    }

    /// The last row of a run from a start whose numbers are changed by this part of them, neighbours in opposite
    /// directions. None if it takes longer than so many seconds.
    fn changed_end(&self, way: Way, change: f64, most: f64) -> Option<Vec<f64>> {
        let start = self.changed_start(way, change)?;
        self.deadline.set(Some(cpu_seconds() + most));
        let found = self.rows_from(Some(start), way, &[self.end()], true);
        self.deadline.set(None);
        found.ok()?.0.pop()
    }

    /// The numbers of the start, changed by this part of them, neighbours in opposite directions.
    pub(super) fn changed_start(&self, way: Way, change: f64) -> Option<Vec<f64>> {
        let start = self.watch.model.start(&self.method(way)).ok()?;
        let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        Some(start.iter().enumerate().map(|(i, x)| x + sign(i) * change * x).collect())
    }

    /// The distances of last rows.
    pub(super) fn ends_apart<'r>(
        &self,
        pairs: impl Iterator<Item = [&'r Vec<f64>; 2]>,
    ) -> Accuracy {
        let clock = Instant::now();
        let pairs = pairs.map(|pair| (self.end(), pair.map(|row| &row[..])));
        let apart = Apart::of_rows(self.watch, &self.run.sizes, pairs);
        self.judge((FoundBy::Exact, 1.0), &apart, 0.0, clock)
    }

    /// What rounding does to the end, where the change of the start moves it by this. A motion that is another one then is
    /// not linear in that.
    pub(super) fn by_rounding(&self, moved: f64) -> f64 {
        if self.is_exact || moved > NO_DIGIT { moved } else { OF_CHANGE * moved }
    }

    /// The warning that the end moves by so much with the last digits of the start, where the error that is known is smaller.
    pub(super) fn growth_warning(&self, moved: &Accuracy, known: f64) -> Option<String> {
        let (change, from, so) = match self.is_exact {
            true => (
                "the last digits of the start move".into(),
                AMPLIFIED,
                "no method has more digits there",
            ),
            false => {
                let change = format!("a change of {} of the start moves", rough(LAST_DIGITS));
                (change, GROWN.max(known / OF_CHANGE), "so does rounding")
            }
        };
        let worst = moved.worst().filter(|worst| worst.largest.relative > from)?;
        let by = match worst.largest.degrees {
            Some(degrees) => format!("{} degrees", rough(degrees)),
            None => format!("{} of its size", rough(worst.largest.relative)),
        };
        Some(format!("{change} `{}` by {by} at the end: {so}", worst.name))
    }
}
