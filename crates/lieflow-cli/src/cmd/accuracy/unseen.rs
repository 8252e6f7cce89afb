//! What two runs of one kind do not see: rounding that both have, and what both pass over.

use std::time::Instant;

use lieflow::problems::explained_by_rounding;
use lieflow_model::problem::{LAST_DIGITS, SHORT_STEPS, time_to_search};
use lieflow_timing::cpu_seconds;

use super::{Check, NO_DIGIT, OWN, Way};
use crate::cmd::apart::Apart;
use crate::measure::PASSED_OVER;
use crate::output::{Accuracy, FoundBy, number, rough};

/// The search for a short pulse is given up after this many times the time that it may take.
const MISJUDGED: f64 = 3.0;
/// Another run in half of these short steps differs by less than this part of it where it was something short.
const RESOLVED: f64 = 1e-3;
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

impl Check<'_> {
    /// The size of short steps.
    pub(super) fn short_step(&self) -> f64 {
        let [t0, end] = self.run.t_span;
        (end - t0).abs() / SHORT_STEPS as f64
    }

    /// A run in short steps, and their size, where those of the run are larger.
    pub(super) fn short_steps(&self) -> Option<(f64, Way)> {
        let short = self.short_step();
        let way = match self.scene().tolerances() {
            Some(_) => Way { largest: Some(short), ..OWN },
            None => Way { factor: short / self.scene().grid.h().abs(), ..OWN },
        };
        (2.0 * short < self.own.largest).then_some((short, way))
    }

    /// The setting that limits the steps to this size.
    pub(super) fn limit_of_steps(&self, size: f64) -> String {
        let name = if self.scene().tolerances().is_some() { "h_max" } else { "dt" };
        format!("{name} = {}", number(size))
    }

    /// The distance of the last row from that of a run in short steps, with a warning, where the steps of two runs that are
    /// chosen by their error have passed over something, such as a short pulse or a jump near the end of a step. Neither run
    /// evaluates f there, so the error of a step shows nothing. Only the last row is compared: a pulse whose effect dies out
    /// before it is not seen.
    pub(super) fn passed_over(&self, known: &Accuracy, seconds: f64) -> Option<(Accuracy, String)> {
        let (clock, end) = (Instant::now(), self.end());
        if self.is_exact || self.ended_by_event {
            return None;
        }
        let (short, way) = self.short_steps()?;
        let most = self.time_to_search(seconds)?;
        // The estimate of its time may be wrong: within a pulse f may be dear, or steps small.
        self.deadline.set(Some(cpu_seconds() + most * MISJUDGED));
        let found = self.rows_at(way, &[end]);
        self.deadline.set(None);
        let (rows, taken) = found.ok()?;
        let pair = rows.first().map(|row| (end, [&self.last[..], &row[..]]));
        let apart = Apart::of_rows(self.watch, &self.run.sizes, pair.into_iter());
        let found = self.judge((FoundBy::ShortSteps, 1.0), &apart, self.moved.get(), clock);
        let growth = (self.moved.get() / (OF_CHANGE * LAST_DIGITS)).max(1.0);
        let rounding = explained_by_rounding(taken.steps, growth);
        let is_far = found.relative() > PASSED_OVER * known.at_end().max(rounding);
        is_far.then(|| {
            let name = found.worst().map_or("", |worst| &worst.name);
            let limit = self.limit_of_steps(short);
            let elsewhere =
                format!("in steps of at most {} `{name}` ends elsewhere", number(short));
            // Where their error chooses the steps, shorter ones do not move an end that short ones have found.
            let half = way.largest.map(|h| Way { largest: Some(0.5 * h), ..way });
            let moved = half.and_then(|half| self.rows_at(half, &[end]).ok()?.0.pop());
            let moved = moved.map_or(0.0, |other| {
                self.ends_apart([[&rows[0], &other]].into_iter()).relative()
            });
            let warning = match moved < RESOLVED * found.relative() {
                true => format!(
                    "{elsewhere}: the steps of this run, of up to {}, pass over something short, such as a pulse or a jump. \
                     Give {limit} in [time], or less",
                    number(self.own.largest)
                ),
                false => format!("{elsewhere}, and elsewhere again in half of these: small errors grow fast here"),
            };
            (found, warning)
        })
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
            return Some(self.ends_apart(ends.iter().flatten().map(|end| [&self.last, end])));
        }
        let changed = self.changed_end(OWN, LAST_DIGITS, brief);
        let moved = self.ends_apart(changed.iter().map(|end| [&self.last, end]));
        if moved.relative() <= GROWN {
            return Some(moved);
        }
        // One of the two may have passed over a short pulse. Runs in short steps do not.
        let in_short_steps = || {
            let (_, short) = self.short_steps()?;
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
        let found = self.rows_from(Some(start), way, &[self.end()]);
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
