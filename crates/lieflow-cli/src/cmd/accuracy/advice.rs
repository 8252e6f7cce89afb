//! What is said of an inaccurate run, and the change that would help.

use std::time::Instant;

use lieflow::SaveAt;
use lieflow_model::problem::LAST_DIGITS;
use lieflow_model::schema::length;
use lieflow_timing::cpu_seconds;

use super::unseen::{Found, with_rounding};
use super::{Check, Ends, LONG, OWN, Way};
use crate::cmd::apart::{Size, parts_of};
use crate::output::{Accuracy, Distance, FoundBy, number, rough};

/// A larger relative error is worth a warning.
const POOR: f64 = 1e-2;
/// A larger one makes a run useless.
const USELESS: f64 = 0.1;
/// The relative error that an advice should lead to.
const GOOD: f64 = 1e-4;
/// How long an advice is looked for, in seconds, and in times that the run took where that is longer.
const PATIENCE: [f64; 2] = [3.0, 5.0];
/// What helps where no step does.
const SMALL_ERRORS_GROW: &str =
    "small errors grow fast here. Take a shorter t_span, or trust averages only";
/// What helps steps of one size that pass over knots.
const AT_KNOTS: &str = " Steps pass over knots of samples, ends of magnets or a short pulse, and are less accurate there: \
                        `at_knots = true` in [time] ends a step at each.";

impl Check<'_> {
    /// The warning about a poor error, with a change that would help. If the seconds of the run are given, further runs
    /// look for that change.
    pub(in crate::cmd) fn warning(
        &self,
        accuracy: &Accuracy,
        seconds: Option<f64>,
    ) -> Option<String> {
        let worst = accuracy.worst_known()?;
        let Distance { relative, degrees, .. } = worst.largest;
        if relative <= POOR || accuracy.found_by == FoundBy::ShortSteps {
            return None;
        }
        let off = match degrees {
            Some(degrees) => format!("{} degrees", rough(degrees)),
            None => format!("{} % of its size", rough(100.0 * relative)),
        };
        let verdict = if relative <= USELESS { "inaccurate" } else { "not usable" };
        let when = accuracy.when(worst.t);
        let wrong = format!("`{}` is wrong by {off} {when}: this run is {verdict}.", worst.name);
        // No other run has an error that can be stated, either.
        let is_known = !accuracy.relative().is_nan();
        let Some(seconds) = seconds.filter(|_| is_known) else { return Some(wrong) };
        let patience = PATIENCE[0].max(PATIENCE[1] * seconds.min(LONG.as_secs_f64()));
        let until = cpu_seconds() + patience;
        self.deadline.set(Some(until));
        let mut times = self.sample.clone();
        // In the direction of the run.
        let is_before = |t: &f64| (worst.t - t) * self.run.direction > 0.0;
        let place = times.partition_point(is_before);
        if times.get(place) != Some(&worst.t) {
            times.insert(place, worst.t);
        }
        let default = self.tried(Way { default: true, ..OWN }, &times);
        // Where high order and the least tolerance do not do, no step does.
        let is_hopeless = matches!(default, Some(None));
        let default = default.flatten();
        let default = default.map(|accuracy| accuracy.digits_in_words());
        let smaller = match is_hopeless {
            true if self.is_by_atol(worst.largest.absolute) => self.without_atol(&times),
            true => self.shorter_steps(&times),
            false => self.smaller_steps(until, seconds, &times),
        };
        self.deadline.set(None);
        let advice = match (smaller, default) {
            (Some(steps), Some(digits)) => {
                format!("{steps}. Leave [method] and the steps out, and lieflow gives {digits}")
            }
            (Some(steps), None) => steps,
            (None, Some(digits)) => {
                format!("Leave [method] and the steps out, and lieflow gives {digits}")
            }
            (None, None) if !is_hopeless => {
                "Take a smaller step, or leave [method] and the steps out; lieflow did not try \
                 what takes longer than a few seconds"
                    .into()
            }
            (None, None) if self.moved.get() > POOR => {
                format!("No step is small enough: {SMALL_ERRORS_GROW}")
            }
            (None, None) => "The default method, at its least tolerance, is not enough either. Where f has a jump or a short \
                             pulse, steps must be shorter than it: h_max in [time]"
                .into(),
        };
        let knots = if self.scene().passes_knots() { AT_KNOTS } else { "" };
        Some(format!("{wrong} {advice}.{knots}"))
    }

    /// The errors of another run at these times, if they can be found; none inside if that run is poor, or passes over
    /// something short, too.
    fn tried(&self, way: Way, times: &[f64]) -> Option<Option<Accuracy>> {
        let clock = Instant::now();
        // The run itself, as a user takes it: with its rows between steps. Others beside it see what was the hardest for it.
        let scene = self.scene();
        let by_steps = scene.times_by_steps || matches!(scene.save, SaveAt::Every(_));
        let as_taken = Way { ends: Ends::At(None), ..way };
        let (rows, taken) = self.rows_from(None, as_taken, times, by_steps).ok()?;
        let way = Way { ends: Ends::At(taken.hardest), ..way };
        // The rows of a run that blew up are larger than the motion.
        let schema = self.watch.model.schema();
        let sizes: Vec<Size> = parts_of(self.watch)
            .zip(&self.run.sizes)
            .map(|((observable, part), size)| {
                let norms = rows
                    .iter()
                    .map(|row| length(&schema.row(row)[observable][part.columns.clone()]));
                let largest = norms.fold(0.0, f64::max);
                Size { largest: size.largest.min(largest), middle: size.middle.min(largest) }
            })
            .collect();
        let apart = |others: &[Vec<f64>]| self.rows_apart(times, [&rows, others], &sizes);
        let exact = || times.iter().map(|t| self.watch.exact(*t)).collect::<Option<Vec<_>>>();
        // What rounding does to it, as `moved` of the run.
        let changed = || {
            self.rows_from(Some(self.changed_start(way, LAST_DIGITS)?), way, times, by_steps).ok()
        };
        let mut end_moved = None;
        let moved = match self.is_exact {
            true => 0.0,
            false => changed().map_or(self.moved.get(), |(others, _)| {
                let moved = self.judge((FoundBy::Exact, 1.0), &apart(&others), 0.0, clock);
                end_moved = Some(moved.relative());
                self.by_rounding(moved.relative())
            }),
        };
        let (found_by, share, apart) = match self.is_exact {
            true => (FoundBy::Exact, 1.0, apart(&exact()?)),
            false => {
                let other =
                    |way| self.rows_at(way, times).map(|(rows, taken)| (apart(&rows), taken.steps));
                self.by_another(way, taken, other).ok()?
            }
        };
        let share = with_rounding((found_by, share), &apart, end_moved);
        let accuracy = self.judge((found_by, share), &apart, moved, clock);
        // Two runs may have the same rounding.
        let is_good = |accuracy: &Accuracy| moved <= POOR && accuracy.relative() <= POOR;
        let search = self.search(way, taken).filter(|_| !self.is_exact);
        let accuracy = match search.filter(|_| is_good(&accuracy)) {
            None => Some(accuracy),
            Some((_, search)) => {
                match self.found_by((way, search), (times, &rows, &sizes), (&accuracy, moved)) {
                    Ok(Found::Nothing) => Some(accuracy),
                    Ok(Found::Jumps(nearer)) => Some(nearer),
                    Ok(Found::Elsewhere { .. }) | Err(_) => None,
                }
            }
        };
        Some(accuracy.filter(is_good))
    }

    /// A limit of the step size that would do at these times, and the digits that it gives.
    fn shorter_steps(&self, times: &[f64]) -> Option<String> {
        let (short, way) = self.short_steps(OWN, self.own)?;
        let accuracy = self.tried(way, times)??;
        let limit = self.limit_of_steps(short);
        Some(format!("{limit} would give {}", accuracy.digits_in_words()))
    }

    /// Could the absolute tolerance alone make this error?
    fn is_by_atol(&self, error: f64) -> bool {
        let by_atol = |[_, atol]: [f64; 2]| atol * self.own.steps as f64 >= error;
        self.scene().tolerances().is_some_and(by_atol)
    }

    /// The relative tolerance alone, if that would do at these times, and the digits that it gives. A part that is small beside
    /// the others may be smaller than atol.
    fn without_atol(&self, times: &[f64]) -> Option<String> {
        let [rtol, atol] = self.scene().tolerances()?;
        if atol == 0.0 || rtol == 0.0 {
            return None;
        }
        let accuracy = self.tried(Way { tolerances: Some([rtol, 0.0]), ..OWN }, times)??;
        let (rtol, digits) = (number(rtol), accuracy.digits_in_words());
        Some(format!("rtol = {rtol} alone, with atol = 0, would give {digits}"))
    }

    /// Smaller steps of the same method that would do at these times, and the digits that they give.
    fn smaller_steps(&self, until: f64, seconds: f64, times: &[f64]) -> Option<String> {
        let h = self.scene().grid.h().abs();
        let tolerances = self.scene().tolerances();
        let factors: Vec<f64> = match tolerances {
            None => nice_below(h).take(10).map(|nice| nice / h).collect(),
            Some(_) => (1..12).map(|i| 0.1_f64.powi(i)).collect(),
        };
        let mut best = None;
        for factor in factors {
            let left = until - cpu_seconds();
            let longer = if tolerances.is_none() { factor.recip() } else { 1.0 };
            if longer * seconds > left {
                break;
            }
            // As they are told: where f jumps, the last digits of a tolerance decide which steps hide it.
            let typed = |x: f64| number(factor * x).parse().unwrap_or(factor * x);
            let smaller = tolerances.map(|both| both.map(typed));
            let way = match smaller {
                None => Way { factor, ..OWN },
                Some(_) => Way { tolerances: smaller, ..OWN },
            };
            let Some(accuracy) = self.tried(way, times) else { break };
            if let Some(accuracy) = &accuracy {
                let steps = match smaller {
                    None => self.step_size(factor * h),
                    Some([rtol, atol]) => {
                        let both = [("rtol", rtol), ("atol", atol)];
                        let both = both.iter().filter(|(_, tolerance)| *tolerance > 0.0);
                        let told = |(name, x): &(&str, f64)| format!("{name} = {}", number(*x));
                        both.map(told).collect::<Vec<_>>().join(" and ")
                    }
                };
                best = Some(format!("{steps} would give {}", accuracy.digits_in_words()));
            }
            if accuracy.is_some_and(|accuracy| accuracy.relative() <= GOOD) {
                break;
            }
        }
        best
    }
}

/// Numbers of the kind 1, 2, 5 below x, from large to small.
fn nice_below(x: f64) -> impl Iterator<Item = f64> {
    let decade = x.log10().floor() as i32;
    let nice = (0..).flat_map(move |i| {
        // Decimal as it is written, not a product that is rounded.
        [5, 2, 1].map(|digit| format!("{digit}e{}", decade - i).parse().unwrap_or(f64::NAN))
    });
    nice.skip_while(move |nice| *nice > 0.6 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_steps_are_such_as_people_write() {
        let first = |x: f64| nice_below(x).take(4).collect::<Vec<_>>();
        assert_eq!(first(0.1), [0.05, 0.02, 0.01, 0.005]);
        assert_eq!(first(0.3), [0.1, 0.05, 0.02, 0.01]);
        assert_eq!(first(7.0), [2.0, 1.0, 0.5, 0.2]);
    }
}
