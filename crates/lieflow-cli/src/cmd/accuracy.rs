//! How right a run is at its end, and what would do where it is wrong.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use lieflow::Error;
use lieflow::catalog::MethodSpec;
use lieflow::solve::{Next, Status};
use lieflow_model::kinds::explained_by_rounding;
use lieflow_model::model::{Plan, Watcher};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Part, Row};

use super::watch::Watch;
use crate::output::{Accuracy, FoundBy, PartError, RowSample, number, short};

/// A run that took longer is not made a second time, but where that is asked for.
pub(super) const LONG: Duration = Duration::from_secs(10);
/// A larger relative error is worth a warning.
const POOR: f64 = 1e-2;
/// A larger one makes a run useless.
const USELESS: f64 = 0.1;
/// The relative error that an advice should lead to.
const GOOD: f64 = 1e-4;
/// How long an advice is looked for, in seconds, and in times that the run took where that is longer.
const PATIENCE: [f64; 2] = [3.0, 5.0];
/// A tolerance this small is compared with a larger one: a smaller one is rounding.
const SMALLEST: f64 = 1e-13;

/// The check of the end of a run.
pub(super) struct Check<'a> {
    watch: &'a Watch<'a>,
    /// The time of the end.
    t: f64,
    /// The run itself.
    own: Taken,
    /// The size of each part of the state.
    sizes: Vec<f64>,
    /// The numbers of the exact row, where it is known.
    exact: Option<Vec<f64>>,
    /// The flag that ends the check.
    stop: &'a AtomicBool,
    deadline: Cell<Option<Instant>>,
}

/// A way to run the scene: with its own method or the one of scenes that name none, and steps or tolerances times a
/// factor.
#[derive(Clone, Copy)]
struct Way {
    default: bool,
    factor: f64,
    /// The limit of steps that are chosen by their error.
    largest: Option<f64>,
}

const OWN: Way = Way { default: false, factor: 1.0, largest: None };

/// The steps that a run took.
#[derive(Clone, Copy)]
pub(super) struct Taken {
    /// The number of steps.
    pub(super) steps: u64,
    /// The largest of them.
    pub(super) largest: f64,
}

/// The share of the expected steps that tells that the tolerance chose them, and no limit did.
const CHOSEN: f64 = 0.9;

impl<'a> Check<'a> {
    /// The check of a run that ended at t after so many steps, and showed these rows.
    pub(super) fn new(
        watch: &'a Watch<'a>,
        rows: &RowSample<'_>,
        (t, own): (f64, Taken),
        stop: &'a AtomicBool,
    ) -> Self {
        let sizes = parts_of(watch).map(|part| size(part, rows)).collect();
        let (exact, deadline) = (watch.exact(t), Cell::new(None));
        Check { watch, t, own, sizes, exact, stop, deadline }
    }

    /// Is the exact end known?
    pub(super) fn is_exact(&self) -> bool {
        self.exact.is_some()
    }

    /// The error of the run, whose last row has these numbers. Where a second run is needed and fails, the reason.
    pub(super) fn error(&self, end: &[f64]) -> Result<Accuracy, String> {
        self.error_of(OWN, end, self.own)
    }

    fn scene(&self) -> &'a Scene {
        self.watch.scene
    }

    fn method(&self, way: Way) -> MethodSpec {
        match way.default {
            true => self.scene().default_method(),
            false => self.scene().method.clone(),
        }
    }

    /// The plan of a run to the end.
    fn plan(&self, way: Way) -> Result<Plan<'static>, Error> {
        let Way { default, factor, largest } = way;
        match default {
            true => {
                let order = self.watch.model.order(&self.method(way))?;
                self.scene().default_plan_to(self.t, factor, largest, order)
            }
            false => self.scene().plan_to(self.t, factor, largest),
        }
    }

    /// The last row of a run, and its steps; or why the run did not end.
    fn end(&self, way: Way) -> Result<(Vec<f64>, Taken), String> {
        let cancel = AtomicBool::new(false);
        let mut last = Last {
            numbers: Vec::new(),
            cancel: &cancel,
            stop: self.stop,
            deadline: self.deadline.get(),
        };
        let plan = self.plan(way).map_err(|error| error.to_string())?;
        let plan = Plan { cancel: Some(&cancel), ..plan };
        let outcome = self.watch.model.drive(&self.method(way), plan, &mut last);
        let outcome = outcome.map_err(|error| error.to_string())?;
        match outcome.status {
            Status::Finished => {
                let stats = &outcome.stats;
                let taken = Taken { steps: stats.accepted, largest: stats.largest_step };
                Ok((last.numbers, taken))
            }
            _ => Err("it was stopped".into()),
        }
    }

    /// The error of a run that ends with these numbers, after these steps.
    fn error_of(&self, way: Way, end: &[f64], taken: Taken) -> Result<Accuracy, String> {
        let clock = Instant::now();
        if let Some(exact) = &self.exact {
            return Ok(self.judge(FoundBy::Exact, end, exact, 1.0, clock));
        }
        let order = self.watch.model.order(&self.method(way)).ok().flatten();
        let order = order.ok_or("the method has no order")? as f64;
        // The error of steps of one size goes with the power p of the size, that of a tolerance with p/(p + 1) of it.
        // The default is beyond the smallest.
        let tolerances = if way.default { Some([0.0; 2]) } else { self.scene().tolerances() };
        let tolerance = tolerances.map(|both| way.factor * both[0].max(both[1]));
        let halved = 1.0 / (1.0 - 0.5_f64.powf(order));
        // A step that is a tenth of the tolerance long, in terms of one by the tolerance; the error goes with its power p.
        let shorter = 0.1_f64.powf(1.0 / (order + 1.0));
        let ratio = shorter.powf(order);
        let (found_by, factor, largest, share) = match tolerance {
            None => (FoundBy::HalfStep, 0.5, None, halved),
            // The limit shortens the steps also where `h_max` or knots chose them.
            Some(tolerance) if tolerance >= SMALLEST => {
                let largest = Some(shorter * taken.largest);
                (FoundBy::TenthTolerance, 0.1, largest, 1.0 / (1.0 - ratio))
            }
            Some(_) => (FoundBy::TenfoldTolerance, 10.0, None, ratio / (1.0 - ratio)),
        };
        let (other, others) = self.end(Way { factor: factor * way.factor, largest, ..way })?;
        let is_limited = others.steps as f64 > CHOSEN * taken.steps as f64;
        if found_by == FoundBy::TenfoldTolerance && is_limited {
            let (other, _) = self.end(Way { largest: Some(0.5 * taken.largest), ..way })?;
            return Ok(self.judge(FoundBy::HalfStep, end, &other, halved, clock));
        }
        Ok(self.judge(found_by, end, &other, share, clock))
    }

    /// The distance of two ends, part by part, times a share.
    fn judge(
        &self,
        found_by: FoundBy,
        a: &[f64],
        b: &[f64],
        share: f64,
        clock: Instant,
    ) -> Accuracy {
        let schema = self.watch.model.schema();
        let [a, b] = [a, b].map(|numbers| schema.row(numbers));
        let parts = parts_of(self.watch).zip(&self.sizes).map(|((observable, part), &size)| {
            let columns = part.columns.clone();
            let (a, b) = (&a[observable][columns.clone()], &b[observable][columns]);
            let distance = part.measure.distance(a, b) * share;
            let degrees = part.measure.is_angle().then(|| distance.to_degrees());
            let size = if degrees.is_some() { 1.0 } else { size };
            let relative = if distance == 0.0 { 0.0 } else { distance / size };
            let name =
                if part.name.is_empty() { observable.name.into() } else { part.name.clone() };
            PartError { name, absolute: distance, relative, degrees }
        });
        let parts: Vec<PartError> = parts.collect();
        // A second run does not see what rounding does to both.
        let unseen = match found_by {
            FoundBy::Exact => f64::EPSILON,
            _ => explained_by_rounding(self.own.steps, 1.0),
        };
        Accuracy::new(found_by, parts, unseen, clock.elapsed().as_secs_f64())
    }

    /// The warning about a poor error, with a change that would help. If the seconds of the run are given, further runs
    /// look for that change.
    pub(super) fn warning(&self, accuracy: &Accuracy, seconds: Option<f64>) -> Option<String> {
        let worst = accuracy.worst()?;
        if worst.relative <= POOR {
            return None;
        }
        let off = match worst.degrees {
            Some(degrees) => format!("{} degrees", short(degrees)),
            None => format!("{} % of its size", short(100.0 * worst.relative)),
        };
        let verdict = if worst.relative <= USELESS { "inaccurate" } else { "not usable" };
        let wrong =
            format!("`{}` is wrong by {off} at the end: this run is {verdict}.", worst.name);
        let Some(seconds) = seconds else { return Some(wrong) };
        let patience = PATIENCE[0].max(PATIENCE[1] * seconds.min(LONG.as_secs_f64()));
        let until = Instant::now() + Duration::from_secs_f64(patience);
        self.deadline.set(Some(until));
        let default = self.tried(Way { default: true, ..OWN });
        let is_tried = default.is_some();
        let default = default.filter(|accuracy| accuracy.relative() <= POOR);
        let default = default.map(|accuracy| accuracy.digits_in_words());
        // Where high order and the least tolerance do not do, no step does.
        let is_hopeless = is_tried && default.is_none();
        let smaller = if is_hopeless { None } else { self.smaller_steps(until, seconds) };
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
            (None, None) => {
                "The default method, at its least tolerance, is not enough either: small errors grow \
                 fast here. Take a shorter t_span, or trust averages only"
                    .into()
            }
        };
        Some(format!("{wrong} {advice}."))
    }

    /// The error of another run, if it can be found.
    fn tried(&self, way: Way) -> Option<Accuracy> {
        let (end, taken) = self.end(way).ok()?;
        self.error_of(way, &end, taken).ok()
    }

    /// Smaller steps of the same method that would do, and the digits that they give.
    fn smaller_steps(&self, until: Instant, seconds: f64) -> Option<String> {
        let h = self.scene().grid.h().abs();
        let tolerances = self.scene().tolerances();
        let factors: Vec<f64> = match tolerances {
            None => nice_below(h).take(10).map(|nice| nice / h).collect(),
            Some(_) => (1..12).map(|i| 0.1_f64.powi(i)).collect(),
        };
        let mut best = None;
        for factor in factors {
            let left = until.saturating_duration_since(Instant::now()).as_secs_f64();
            let longer = if tolerances.is_none() { factor.recip() } else { 1.0 };
            if longer * seconds > left {
                break;
            }
            let Some(accuracy) = self.tried(Way { factor, ..OWN }) else { break };
            let relative = accuracy.relative();
            if relative <= POOR {
                let steps = match tolerances {
                    None => format!("dt = {}", number(factor * h)),
                    Some([rtol, atol]) => {
                        let both = [("rtol", rtol), ("atol", atol)];
                        let both = both.iter().filter(|(_, tolerance)| *tolerance > 0.0);
                        let told =
                            |(name, x): &(&str, f64)| format!("{name} = {}", number(factor * x));
                        both.map(told).collect::<Vec<_>>().join(" and ")
                    }
                };
                best = Some(format!("{steps} would give {}", accuracy.digits_in_words()));
            }
            if relative <= GOOD {
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

/// The parts of the state, with their quantities.
fn parts_of<'a>(
    watch: &'a Watch<'_>,
) -> impl Iterator<Item = (&'a lieflow_model::schema::Observable, &'a Part)> {
    watch
        .state
        .iter()
        .flat_map(|observable| observable.parts.iter().map(move |part| (*observable, part)))
}

/// The size that an error is relative to: of the start, of the end and of the middle one of the rows, the largest.
fn size(
    (observable, part): (&lieflow_model::schema::Observable, &Part),
    rows: &RowSample<'_>,
) -> f64 {
    let norm = |row: Row<'_>| {
        let values = &row[observable][part.columns.clone()];
        values.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    let mut sizes: Vec<f64> = rows.rows().map(|(_, row)| norm(row)).collect();
    let ends = rows.ends().map_or([0.0; 2], |ends| ends.map(|(_, row)| norm(row)));
    sizes.sort_by(f64::total_cmp);
    let middle = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    ends[0].max(ends[1]).max(middle)
}

/// Keeps the last row of a run, and stops the run when its time is up.
struct Last<'a> {
    numbers: Vec<f64>,
    cancel: &'a AtomicBool,
    stop: &'a AtomicBool,
    deadline: Option<Instant>,
}

impl Watcher for Last<'_> {
    fn row(&mut self, _t: f64, row: Row<'_>) -> Next {
        self.numbers.clear();
        self.numbers.extend_from_slice(row.numbers());
        Next::Continue
    }

    fn progress(&mut self, _t: f64) {
        let late = self.deadline.is_some_and(|deadline| Instant::now() > deadline);
        if late || self.stop.load(Ordering::Relaxed) {
            self.cancel.store(true, Ordering::Relaxed);
        }
    }
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
