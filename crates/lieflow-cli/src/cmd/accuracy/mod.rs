//! How right the rows of a run are, and what would do where they are wrong.

mod advice;
mod sizes;
mod unseen;

use std::cell::Cell;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use lieflow::catalog::MethodSpec;
use lieflow::problems::explained_by_rounding;
use lieflow::solve::{Next, RunError, Stats, Status};
use lieflow::tolerance::Tolerance;
use lieflow::{SaveAt, StepControl, TimeGrid};
use lieflow_model::problem::{
    Outcome, Plan, Steps, Watcher, near_ends, other_tolerance, stop_after_hardest,
};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Component, Observable, Row};

use self::sizes::size;
use self::unseen::with_rounding;
use super::apart::{
    Apart, Beside, ColumnApart, Gap, Largest, Limits, Size, ZerosApart, derived_of, parts_of,
};
use super::shown::{Choice, Shown};
use super::watch::Watch;
use crate::output::{Accuracy, Distance, FoundBy, PartError, RowSample, ShownRows, number, rough};

/// A run that took longer is not made a second time, but where that is asked for.
pub(super) const LONG: Duration = Duration::from_secs(10);
/// Rows at which an advice is tried, about.
const SAMPLE: usize = 100;
/// A column whose error is more than this share of its size has no right digit.
const NO_DIGIT: f64 = 0.1;
/// That is told where the relative error of its part is below this.
const KNOWN: f64 = 0.01;
/// And where the column is this many times larger than the rounding of its part.
const AMPLE: f64 = 100.0;
/// A part that has this many times the relative error at the size of most rows is worth a note, where that is above
/// [`FEW_DIGITS`].
const SMALLER: f64 = 100.0;
const FEW_DIGITS: f64 = 1e-6;

/// Rows, and zeros, for which the exact motion is evaluated, at most. A zero takes some twenty evaluations.
const EXACT: [u64; 2] = [1_000_000, 50_000];
/// At most this many rows for each step of the run are reached by a step of their own in a second run.
const OF_A_STEP: u64 = 2;
/// This many rows are reached in any case.
const FEW: u64 = 20_000;
/// Of long rows at most this many, divided by the square of the numbers of a row. The time of a step grows so.
const OF_LONG_ROWS: u64 = 100_000_000;
/// Their times are kept in memory, so there are never more.
const IN_MEMORY: u64 = 4_000_000;

/// The check of a run.
pub(super) struct Check<'a> {
    watch: &'a Watch<'a>,
    run: Shown<'a>,
    /// The run itself.
    own: Taken,
    /// True if an event ended the run.
    ended_by_event: bool,
    /// Is the exact motion known?
    is_exact: bool,
    /// The times of some rows, and of the last.
    sample: Vec<f64>,
    /// The numbers of these rows.
    rows: Vec<Vec<f64>>,
    /// The CPU time at which a run ends.
    deadline: Cell<Option<f64>>,
    /// What a change of the last digits of the start moves the end by, relative to its size: no run has more digits.
    moved: Cell<f64>,
}

/// What is known of the errors of a run.
pub(super) struct Checked {
    /// The errors of its rows.
    pub(super) accuracy: Accuracy,
    /// The largest error of the times of each event, where it is known.
    pub(super) time_errors: Vec<Option<f64>>,
    /// Of each event: has the other motion other zeros?
    pub(super) wrong_zeros: Vec<bool>,
    /// The warning about each event that has another number of zeros there.
    pub(super) other_zeros: Vec<Option<String>>,
    /// How far each column of the invariants is from its value in the other motion.
    pub(super) laws: Vec<f64>,
    /// The columns that have no right digit, though their part has.
    pub(super) notes: Vec<String>,
    /// What a reader should know.
    pub(super) warnings: Vec<String>,
}

/// A way to run the scene: with its own method or the one of scenes that name none, and steps or tolerances times a
/// factor.
#[derive(Clone, Copy)]
struct Way {
    default: bool,
    factor: f64,
    /// The limit of steps that are chosen by their error.
    largest: Option<f64>,
    /// The largest number of attempts within that limit.
    attempts: u64,
    /// Are steps of one size split?
    split: bool,
    /// Do steps of one size have short parts at both ends?
    graded: bool,
    /// rtol and atol before the factor, where they are others than those of the scene.
    tolerances: Option<[f64; 2]>,
    /// Where a step ends.
    ends: Ends,
}

/// Where a step of another run ends: so it sees a short pulse that a run has seen.
#[derive(Clone, Copy)]
enum Ends {
    /// Where the motion was the hardest for the run that is checked.
    AtHardest,
    /// There, or nowhere.
    At(Option<f64>),
}

const OWN: Way = Way {
    default: false,
    factor: 1.0,
    largest: None,
    attempts: StepControl::MAX_STEPS,
    split: false,
    graded: false,
    tolerances: None,
    ends: Ends::AtHardest,
};

/// The steps that a run took.
#[derive(Clone, Copy, Default)]
pub(super) struct Taken {
    /// The number of steps.
    pub(super) steps: u64,
    /// The largest of them.
    pub(super) largest: f64,
    /// Where a second run ends a step ([`stop_after_hardest`]).
    pub(super) hardest: Option<f64>,
}

impl Taken {
    /// The steps of these statistics of a run over this span.
    pub(super) fn of(stats: &Stats, t_span: [f64; 2]) -> Self {
        Taken {
            steps: stats.accepted,
            largest: stats.largest_step,
            hardest: stop_after_hardest(stats, t_span),
        }
    }
}

/// The share of the expected steps that tells that the tolerance chose them, and no limit did.
const CHOSEN: f64 = 0.9;

impl<'a> Check<'a> {
    /// The check of a complete run. `rows` keeps some of its rows.
    pub(super) fn new(
        watch: &'a Watch<'a>,
        rows: &RowSample<'_>,
        (records, shown): (ShownRows, u64),
        (t, own, ended_by_event): (f64, Taken, bool),
        stop: &'a AtomicBool,
    ) -> Self {
        let [t0, last] = watch.scene.grid.t_span();
        let sizes = parts_of(watch).map(|part| size(part, rows)).collect();
        let is_exact = watch.exact(t).is_some();
        let width = watch.model.schema().columns().count().max(1) as u64;
        let most = match is_exact {
            true => EXACT[0],
            false => {
                let few = FEW.min(OF_LONG_ROWS / width.pow(2));
                OF_A_STEP.saturating_mul(own.steps).max(few).min(IN_MEMORY)
            }
        };
        let run = Shown {
            zeros: Choice::new(records.count().saturating_sub(shown), EXACT[1]),
            records,
            rows: Choice::new(shown, most),
            sizes,
            t_span: [t0, t],
            direction: (last - t0).signum(),
            step: own.largest,
            stop,
        };
        let every = rows.rows().count().div_ceil(SAMPLE).max(1);
        let some = rows.rows().step_by(every).chain(rows.ends().map(|[_, last]| last));
        let (mut sample, mut kept) = (Vec::new(), Vec::<Vec<f64>>::new());
        for (t, row) in some {
            if sample.last() != Some(&t) {
                sample.push(t);
                kept.push(row.numbers().into());
            }
        }
        let (deadline, moved) = (Cell::new(None), Cell::new(0.0));
        let mut check = Check {
            watch,
            run,
            own,
            ended_by_event,
            is_exact,
            sample,
            rows: kept,
            deadline,
            moved,
        };
        check.see_sizes_between();
        check
    }

    /// Is the exact motion known?
    pub(super) fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// The errors of the run, or the reason why a second run failed. `seconds` is the time of the run.
    pub(super) fn errors(&self, seconds: f64) -> Result<Checked, String> {
        let clock = Instant::now();
        let (found_by, share, apart) = match self.is_exact {
            true => (FoundBy::Exact, 1.0, Apart::from_exact(self.watch, &self.run)?),
            false => {
                let times = self.run.times()?;
                self.by_another(OWN, self.own, |way| self.beside(way, &times))?
            }
        };
        let moved = self.moved_by_last_digits(seconds);
        let share =
            with_rounding((found_by, share), &apart, moved.as_ref().map(Accuracy::relative));
        let zeros = self.scene().events.iter().zip(&apart.events);
        let other_zeros = zeros.map(|(event, zeros)| {
            if zeros.agree() {
                if zeros.are_others(self.run.length()) {
                    return Some(format!(
                        "event `{}`: its zeros are up to {} apart in two runs, so that zeros are missed or have no meaning: take \
                         smaller steps or a smaller tolerance",
                        event.name,
                        rough(zeros.distance)
                    ));
                }
                let is_none = self.is_exact && zeros.distance.is_nan();
                return is_none.then(|| {
                    format!(
                        "event `{}` has zeros in this run where the exact motion has none: its function is smaller than the \
                         error of the run. Its zeros have no meaning",
                        event.name
                    )
                });
            }
            let others = match self.is_exact {
                true => format!("at least {} in the exact motion", zeros.other.sure),
                false => format!("{} in the second run", zeros.other.possible),
            };
            Some(format!(
                "event `{}` has {} {} in this run, and {others}: take smaller steps or a smaller tolerance",
                event.name,
                zeros.own.possible,
                if zeros.own.possible == 1 { "zero" } else { "zeros" }
            ))
        });
        let other_zeros = other_zeros.collect();
        let are_wrong = |zeros: &ZerosApart| {
            let are_others = !zeros.distance.is_finite() || zeros.are_others(self.run.length());
            !zeros.agree() || are_others
        };
        let wrong_zeros = apart.events.iter().map(are_wrong).collect();
        let time_error = |zeros: &ZerosApart| {
            // A time is no better than its last digit.
            let rounding = f64::EPSILON * self.run.t_span[0].abs().max(self.run.t_span[1].abs());
            (!are_wrong(zeros)).then(|| (zeros.distance * share).max(rounding))
        };
        self.moved.set(moved.as_ref().map_or(0.0, |moved| self.by_rounding(moved.relative())));
        let (mut accuracy, mut warnings) =
            (self.judge((found_by, share), &apart, self.moved.get(), clock), Vec::new());
        let mut time_errors: Vec<_> = apart.events.iter().map(time_error).collect();
        warnings.extend(moved.and_then(|moved| self.growth_warning(&moved, accuracy.relative())));
        let mut notes = self.small_rows(&apart, share);
        if let Some(passed) = self.passed_over(&accuracy, seconds)? {
            (accuracy, time_errors) = (passed.accuracy, vec![None; time_errors.len()]);
            warnings.extend(passed.warning);
            notes.extend(passed.note);
        }
        notes.extend(self.small_columns(&apart, share));
        notes.extend(self.derived_without_digits(&apart, share));
        let laws = apart.laws.iter().map(|gap| gap * share).collect();
        Ok(Checked { accuracy, time_errors, wrong_zeros, other_zeros, laws, notes, warnings })
    }

    /// The parts that are much smaller in most rows than at an end, and have few digits there, in words.
    fn small_rows(&self, apart: &Apart, share: f64) -> Vec<String> {
        let told = |(place, (observable, part)): (usize, (&Observable, &Component))| {
            let (largest, Size { largest: size, middle }) =
                (&apart.parts[place], self.run.sizes[place]);
            let [known, there] = [largest.gap.relative, largest.of_middle].map(|x| x * share);
            let rounding = AMPLE * explained_by_rounding(self.own.steps, size);
            let is_told =
                known < KNOWN && there > FEW_DIGITS.max(SMALLER * known) && middle > rounding;
            let whole = if part.name.is_empty() { observable.name } else { &part.name };
            is_told.then(|| {
                format!(
                    "`{whole}` has fewer right digits in most rows: its size is {} in the middle one of them, and the \
                     largest error beside that is {}. The error above is relative to {}",
                    rough(middle),
                    rough(there),
                    rough(size)
                )
            })
        };
        parts_of(self.watch).enumerate().filter_map(told).collect()
    }

    /// The columns that are so small beside their part that they have no right digit, in words. The error of a part is
    /// relative to its length.
    fn small_columns(&self, apart: &Apart, share: f64) -> Vec<String> {
        let told = |(place, (observable, part)): (usize, (&Observable, &Component))| {
            let (largest, columns) = (&apart.parts[place], &apart.columns[place]);
            let rounding =
                AMPLE * explained_by_rounding(self.own.steps, self.run.sizes[place].largest);
            let is_poor = |column: &ColumnApart| column.gap * share > column.size * NO_DIGIT;
            let names = observable.columns[part.columns.clone()].iter().zip(columns);
            let mut poor = names.filter(|(_, column)| is_poor(column) && column.size > rounding);
            let knows_the_part = !part.measure.is_angle() && largest.gap.relative * share < KNOWN;
            let (name, ColumnApart { gap, size }) = poor.next().filter(|_| knows_the_part)?;
            let further = match poor.count() {
                0 => String::new(),
                1 => ", and one further column".into(),
                n => format!(", and {n} further columns"),
            };
            let whole = if part.name.is_empty() { observable.name } else { &part.name };
            Some(format!(
                "`{name}` has no right digit{further}: it is at most {}, and wrong by {}. The error of `{whole}` is relative to \
                 its length",
                rough(*size),
                rough(gap * share)
            ))
        };
        parts_of(self.watch).enumerate().filter_map(told).collect()
    }

    /// The quantities that are computed from the state and have no right digit, though the state has, in words: numbers
    /// of it that are large cancel in them.
    fn derived_without_digits(&self, apart: &Apart, share: f64) -> Vec<String> {
        let knows_the_state =
            apart.parts.iter().all(|largest| largest.gap.relative * share < KNOWN);
        let size = self.run.sizes.iter().map(|size| size.largest).fold(0.0, f64::max);
        let rounding = AMPLE * explained_by_rounding(self.own.steps, size.max(size * size));
        let told = |(observable, ColumnApart { gap, size }): (&Observable, &ColumnApart)| {
            let is_poor = gap * share > size * NO_DIGIT && *size > rounding;
            (is_poor && knows_the_state).then(|| {
                format!(
                    "`{}` has no right digit: it is at most {}, and wrong by {}. It is computed from the state, whose digits \
                     cancel in it",
                    observable.name,
                    rough(*size),
                    rough(gap * share)
                )
            })
        };
        derived_of(self.watch).zip(&apart.derived).filter_map(told).collect()
    }

    fn scene(&self) -> &'a Scene {
        self.watch.scene
    }

    /// The time of the last row.
    fn end(&self) -> f64 {
        self.run.t_span[1]
    }

    fn method(&self, way: Way) -> MethodSpec {
        match way.default {
            true => self.scene().default_method(),
            false => self.scene().method.clone(),
        }
    }

    /// The plan of a run to time t.
    fn plan(&self, way: Way, t: f64) -> Result<Plan<'static>, String> {
        let Way { default, factor, largest, attempts, split, graded, tolerances, ends } = way;
        let plan = match default {
            true => {
                let order = self.watch.model.order(&self.method(way));
                order.and_then(|order| self.scene().default_plan_to(t, factor, largest, order))
            }
            false => self.scene().plan_to(t, factor, largest),
        };
        let mut plan = plan.map_err(|error| error.to_string())?;
        if let (Steps::ByError { control, .. }, Some(_)) = (&mut plan.steps, largest) {
            // The limit is that of the longer steps of the run.
            let most = control.clone().max_steps(attempts);
            *control = most.map_err(|error| error.to_string())?;
        }
        plan.stops.kinks.extend(match ends {
            Ends::AtHardest => self.own.hardest,
            Ends::At(place) => place,
        });
        match (&mut plan.steps, tolerances) {
            (Steps::Equal(grid), _) if split => *grid = grid.split(),
            (Steps::Equal(grid), _) if graded => plan.stops.kinks.extend(near_ends(grid)),
            (Steps::ByError { control, .. }, Some([rtol, atol])) => {
                let rule = control.tolerance().rule();
                let other = Tolerance::new(factor * rtol, factor * atol);
                let other = other.map_err(|error| error.to_string())?;
                *control = control.clone().with_tolerance(other.by(rule));
            }
            _ => {}
        }
        Ok(plan)
    }

    fn limits<'c>(&'c self, cancel: &'c AtomicBool) -> Limits<'c> {
        Limits { cancel, stop: self.run.stop, deadline: self.deadline.get() }
    }

    /// The rows of another run at these times, each reached by a step, and its steps; or why it did not get to the end.
    fn rows_at(&self, way: Way, times: &[f64]) -> Result<(Vec<Vec<f64>>, Taken), String> {
        self.rows_from(None, way, times, true)
    }

    /// [`rows_at`](Self::rows_at) from another start, by the numbers of its point; and reached by steps or not.
    fn rows_from(
        &self,
        start: Option<Vec<f64>>,
        way: Way,
        times: &[f64],
        times_by_steps: bool,
    ) -> Result<(Vec<Vec<f64>>, Taken), String> {
        let cancel = AtomicBool::new(false);
        let mut kept = Kept { rows: Vec::new(), limits: self.limits(&cancel) };
        let save = SaveAt::Times(times.to_vec());
        let plan = self.plan(way, self.end())?;
        let plan = Plan { save, times_by_steps, cancel: Some(&cancel), start, ..plan };
        let outcome = self.watch.model.drive(&self.method(way), plan, &mut kept);
        let Outcome { status, stats, .. } = outcome.map_err(|error| match error {
            RunError::TooManySteps { t, max_steps, .. } if way.largest.is_some() => {
                format!("{max_steps} attempts get no farther than t = {}", number(t))
            }
            error => error.to_string(),
        })?;
        match status {
            Status::Finished => Ok((kept.rows, Taken::of(&stats, self.run.t_span))),
            _ => Err("it was stopped".into()),
        }
    }

    /// How far rows of two runs at these times are apart, beside these sizes.
    fn rows_apart(&self, times: &[f64], [a, b]: [&[Vec<f64>]; 2], sizes: &[Size]) -> Apart {
        let pairs = times.iter().zip(a.iter().zip(b));
        let pairs = pairs.map(|(t, (a, b))| (*t, [&a[..], &b[..]]));
        Apart::of_rows(self.watch, sizes, pairs)
    }

    /// How far the run is from another one that has rows at the same `times`, and the number of steps of that. It
    /// reaches each row by a step, so that an error of the continuous extension is seen.
    fn beside(&self, way: Way, times: &[f64]) -> Result<(Apart, u64), String> {
        let cancel = AtomicBool::new(false);
        let mut beside = Beside::new(self.watch, &self.run, self.limits(&cancel))?;
        let plan = Plan {
            save: SaveAt::Times(times.to_vec()),
            times_by_steps: true,
            events: self.run.events(self.watch)?,
            cancel: Some(&cancel),
            ..self.plan(way, self.beyond())?
        };
        let outcome = self.watch.model.drive(&self.method(way), plan, &mut beside);
        let (steps, why) = match outcome {
            Ok(outcome) => (outcome.stats.accepted, "it was stopped".into()),
            Err(error) => (error.accepted().unwrap_or(0), error.to_string()),
        };
        // What is after the last row does not count.
        Ok((beside.finish()?.ok_or(why)?, steps))
    }

    /// The end of a second run. The zero that ended the first may be later there.
    fn beyond(&self) -> f64 {
        let ([_, end], [_, last]) = (self.run.t_span, self.scene().grid.t_span());
        match (self.ended_by_event, self.run.direction > 0.0) {
            (false, _) => end,
            (true, true) => (end + self.own.largest).min(last),
            (true, false) => (end - self.own.largest).max(last),
        }
    }

    /// A comparison of a run, which took these steps, with another one: by which run that is, the share of the distance
    /// that is the error, and what `run` tells beside the number of steps.
    fn by_another<T>(
        &self,
        way: Way,
        taken: Taken,
        run: impl Fn(Way) -> Result<(T, u64), String>,
    ) -> Result<(FoundBy, f64, T), String> {
        let order = self.watch.model.order(&self.method(way)).ok().flatten();
        let order = order.ok_or("the method has no order")?;
        // The error of steps of one size goes with the power p of the size, that of a tolerance with p/(p + 1) of it.
        // The default is beyond the smallest.
        let tolerances = way.tolerances.or_else(|| self.scene().tolerances());
        let tolerances = if way.default { Some([0.0; 2]) } else { tolerances };
        let change = tolerances.map(|both| other_tolerance(both.map(|x| way.factor * x)));
        let halved = 1.0 / (1.0 - 0.5_f64.powi(order as i32));
        // A step that is a tenth of the tolerance long, in terms of one by the tolerance; the error goes with its power p.
        let shorter = 0.1_f64.powf(1.0 / (order as f64 + 1.0));
        let ratio = shorter.powi(order as i32);
        let (found_by, factor, largest, share) = match change {
            None => {
                // Where knots or the end have made the steps shorter than they were to be, it is their mean that is split.
                let [t0, t1] = self.run.t_span;
                let planned = (t1 - t0).abs() / (way.factor * self.scene().grid.h().abs());
                let factor = match taken.steps as f64 > (planned - 1e-9).ceil() || planned < 1.0 {
                    true => planned / taken.steps as f64,
                    false => 1.0,
                };
                (FoundBy::SplitSteps, factor, None, 1.0 / (1.0 - TimeGrid::split_error(order)))
            }
            // The limit shortens the steps also where `h_max` or knots chose them.
            Some(factor) if factor < 1.0 => {
                let largest = Some(shorter * taken.largest);
                (FoundBy::TenthTolerance, factor, largest, 1.0 / (1.0 - ratio))
            }
            Some(factor) => (FoundBy::TenfoldTolerance, factor, way.largest, ratio / (1.0 - ratio)),
        };
        let split = change.is_none();
        let (other, steps) = run(Way { factor: factor * way.factor, largest, split, ..way })?;
        let is_limited = steps as f64 > CHOSEN * taken.steps as f64;
        if found_by == FoundBy::TenfoldTolerance && is_limited {
            let (other, _) = run(Way { largest: Some(0.5 * taken.largest), ..way })?;
            return Ok((FoundBy::HalfStep, halved, other));
        }
        Ok((found_by, share, other))
    }

    /// The errors of a run: a share of the distances. `moved` is what rounding does to it.
    fn judge(
        &self,
        (found_by, share): (FoundBy, f64),
        apart: &Apart,
        moved: f64,
        clock: Instant,
    ) -> Accuracy {
        let all = parts_of(self.watch).zip(&apart.parts);
        let parts = all.map(|((observable, part), &Largest { gap, t, last, .. })| {
            let error = |Gap { absolute, relative }: Gap| {
                let is_angle = part.measure.is_angle();
                // No two rotations are farther apart than half a turn.
                let most = if is_angle { PI } else { f64::INFINITY };
                let [absolute, relative] =
                    [absolute, relative].map(|x| if x * share > most { most } else { x * share });
                let degrees = is_angle.then(|| absolute.to_degrees());
                Distance { absolute, relative, degrees }
            };
            let name =
                if part.name.is_empty() { observable.name.into() } else { part.name.clone() };
            PartError { name, largest: error(gap), t, at_end: error(last) }
        });
        // A second run does not see what rounding does to both.
        let unseen = match found_by {
            FoundBy::Exact => f64::EPSILON,
            _ => explained_by_rounding(self.own.steps, 1.0),
        };
        let unseen = unseen.max(moved);
        let (seconds, rows, parts) = (clock.elapsed().as_secs_f64(), apart.rows, parts.collect());
        let t_end = self.end();
        Accuracy { found_by, seconds, rows, digits: 0, parts, t_end }.with_digits(unseen)
    }
}

/// Keeps the rows of a run, and stops the run when its time is up.
struct Kept<'a> {
    rows: Vec<Vec<f64>>,
    limits: Limits<'a>,
}

impl Watcher for Kept<'_> {
    fn row(&mut self, _t: f64, row: Row<'_>) -> Next {
        self.rows.push(row.numbers().into());
        Next::Continue
    }

    fn progress(&mut self, _t: f64) {
        self.limits.look();
    }
}
