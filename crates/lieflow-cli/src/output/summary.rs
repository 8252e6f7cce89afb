//! summary.json: what was run, and how well it went.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::{Serialize, Serializer};

use lieflow::problems::Invariant;
use lieflow::solve;
use lieflow_model::problem::Property;
use lieflow_model::scene::{Defaults, Scene};
use lieflow_model::schema::{Observable, Units};
use lieflow_timing::Fit;

use super::files::remove_old;
use super::{duration, rough, time};
use crate::error::CliError;

/// Number of parts whose errors are printed. The file has all.
const PARTS: usize = 4;

/// The name of the first column, the time.
pub const TIME: &str = "t";

/// The name of the file.
pub const SUMMARY: &str = "summary.json";

/// Remove the summary of an earlier run, and the figures that it names: they show other rows.
///
/// # Errors
/// A file is there and stays.
pub fn remove_summary(folder: &Path) -> Result<(), CliError> {
    let path = folder.join(SUMMARY);
    let text = fs::read_to_string(&path).unwrap_or_default();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let names = summary["figures"].as_array().into_iter().flatten();
    // A file of the folder itself.
    let is_figure = |name: &&str| name.ends_with(".svg") && !name.contains(['/', '\\']);
    for name in names.filter_map(serde_json::Value::as_str).filter(is_figure) {
        remove_old(&folder.join(name))?;
    }
    remove_old(&path)
}

/// What was run, and how well it went.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The version of the program.
    pub lieflow: &'static str,
    /// The title of the scene.
    pub title: String,
    /// The name of the scene.
    pub scene: String,
    /// The kind of problem.
    pub problem: &'static str,
    /// A number of what the scene states.
    pub fingerprint: String,
    /// Did the run reach its end, or the event that ends it?
    pub completed: bool,
    /// Was it stopped from outside?
    #[serde(skip)]
    pub interrupted: bool,
    /// Why not.
    pub failure: Option<String>,
    /// The method.
    pub method: MethodSummary,
    /// The layer.
    pub layer: &'static str,
    /// What was integrated.
    pub modelled: Vec<String>,
    /// What is known of the problem before any run.
    #[serde(serialize_with = "by_name")]
    pub facts: Vec<Property>,
    /// What a reader should know: a body that cannot be, an invariant that moved.
    pub warnings: Vec<String>,
    /// Changes that were made to numbers of the scene.
    pub notes: Vec<String>,
    /// What was written.
    pub quantities: Vec<String>,
    /// The columns of the trajectory.
    pub columns: Vec<String>,
    /// The units of t and of the columns, where they are known.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub units: BTreeMap<String, String>,
    /// The names of units.
    #[serde(skip)]
    pub unit_names: Units,
    /// The file of the trajectory, next to this one.
    pub trajectory: &'static str,
    /// The files of the figures, next to this one: the next run in the folder removes them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub figures: Vec<String>,
    /// From when to when; null where there is no end.
    pub t_span: [f64; 2],
    /// The time that was reached; none when a step failed.
    pub t_end: Option<f64>,
    /// The event that ended the run.
    pub ended_by: Option<String>,
    /// The zeros of each event; none in a scene without events.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<EventSummary>,
    /// The step size. `None` if each step has its own.
    pub dt: Option<f64>,
    /// The steps that were taken.
    pub steps: u64,
    /// How steps were chosen, where they were.
    pub adaptive: Option<Chosen>,
    /// Points within steps, for output times and events; not known when a step failed.
    pub side_steps: Option<u64>,
    /// The rows that were written.
    pub rows: u64,
    /// Seconds, with writing.
    pub wall_time_s: f64,
    /// The first row: t and each column by its name.
    pub initial: BTreeMap<String, f64>,
    /// The last row: t and each column by its name.
    #[serde(rename = "final")]
    pub last: BTreeMap<String, f64>,
    /// Where the drifts were looked at.
    pub drift_computed_at: &'static str,
    /// The drift of each invariant that follows from what was modelled, by column.
    pub drift: BTreeMap<String, Drift>,
    /// The distance from the exact solution at the end, by quantity. `None` if no exact solution is known.
    pub error_at_end: Option<BTreeMap<String, f64>>,
    /// How accurate the rows are, if that is known.
    pub accuracy: Option<Accuracy>,
    /// Why the accuracy is not known.
    pub accuracy_unknown: Option<String>,
    /// The choices that the scene left to the program.
    pub chosen_by_default: Defaults,
    /// These choices in words.
    #[serde(skip)]
    pub defaults_in_words: Option<String>,
    /// The tolerances, where steps were chosen by their error.
    pub rtol: Option<f64>,
    /// As `rtol`.
    pub atol: Option<f64>,
}

impl Summary {
    /// The unit of times; empty where it is not known.
    pub fn time_unit(&self) -> String {
        self.units.get(TIME).cloned().unwrap_or_default()
    }
}

/// The units of t and of the columns of these quantities of a scene, where they are known.
pub fn units_of(scene: &Scene, written: &[&Observable]) -> BTreeMap<String, String> {
    let time = (TIME.to_string(), scene.units.of(scene.problem.kind().time).unwrap_or_default());
    let kind = scene.problem.kind();
    let columns = written.iter().flat_map(|quantity| {
        let info = kind.quantity(quantity.name);
        let unit = info.map_or(String::new(), |info| info.unit(&scene.units));
        quantity.columns.iter().map(move |column| (column.clone(), unit.clone()))
    });
    core::iter::once(time).chain(columns).filter(|(_, unit)| !unit.is_empty()).collect()
}

/// The facts as a table of names and values.
fn by_name<S: Serializer>(facts: &[Property], to: S) -> Result<S::Ok, S::Error> {
    let table: BTreeMap<&str, f64> = facts.iter().map(|fact| (fact.name, fact.value)).collect();
    table.serialize(to)
}

/// How right the rows of a run are.
#[derive(Clone, Debug, Serialize)]
pub struct Accuracy {
    /// How that was found.
    pub found_by: FoundBy,
    /// Seconds that it took.
    pub seconds: f64,
    /// The number of rows that were compared.
    pub rows: u64,
    /// The decimal digits that are right in every row that was compared, of the part that is worst.
    pub digits: u32,
    /// The parts of the state.
    pub parts: Vec<PartError>,
    /// The time of the last row.
    #[serde(skip)]
    pub t_end: f64,
}

/// The result that a run is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FoundBy {
    /// The exact motion.
    Exact,
    /// A second run with each step in two parts.
    SplitSteps,
    /// A second run in steps of half the size.
    HalfStep,
    /// A second run at a tenth of the tolerance.
    TenthTolerance,
    /// A second run at ten times the tolerance.
    TenfoldTolerance,
    /// A run in short steps, which ends elsewhere.
    ShortSteps,
}

/// The error of a part of the state: the largest of all rows that were compared, and that of the last row.
#[derive(Clone, Debug, Serialize)]
pub struct PartError {
    /// The quantity, or the part of a composed system.
    pub name: String,
    /// The largest error.
    #[serde(flatten)]
    pub largest: Distance,
    /// The time of the row with the largest error.
    pub t: f64,
    /// The error of the last row.
    pub at_end: Distance,
}

/// The distance of a part of the state from what it should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distance {
    /// The distance; an angle in radians where the part is a rotation.
    pub absolute: f64,
    /// The distance in sizes of the part; an angle in radians where it is a rotation. NaN where no finite size is left.
    pub relative: f64,
    /// The angle, where the part is a rotation.
    pub degrees: Option<f64>,
}

impl Accuracy {
    /// Sets the digits by the errors of the parts. An error below `unseen` is taken as `unseen`, because it is rounding.
    pub fn with_digits(mut self, unseen: f64) -> Self {
        let worst = self.relative();
        // A NaN has no digits.
        let digits = if worst.is_nan() { 0.0 } else { -worst.max(unseen).log10() };
        self.digits = digits.floor().max(0.0) as u32;
        self
    }

    /// The part with the largest relative error.
    pub fn worst(&self) -> Option<&PartError> {
        self.parts.iter().max_by(|a, b| a.largest.rank().total_cmp(&b.largest.rank()))
    }

    /// The part with the largest relative error, of those whose error is known.
    pub fn worst_known(&self) -> Option<&PartError> {
        let known = self.parts.iter().filter(|part| part.largest.is_known());
        known.max_by(|a, b| a.largest.relative.total_cmp(&b.largest.relative))
    }

    /// The parts whose error is not known, each in a sentence.
    pub fn unknown_in_words(&self) -> impl Iterator<Item = String> {
        let unknown = self.parts.iter().filter(|part| !part.largest.is_known());
        unknown.map(|part| {
            format!(
                "the error of `{}` cannot be stated: its size, or its distance from what it should be, is not a finite \
                 number",
                part.name
            )
        })
    }

    /// The relative error of the part that is worst. NaN if that of a part is.
    pub fn relative(&self) -> f64 {
        self.worst().map_or(f64::NAN, |worst| worst.largest.relative)
    }

    /// The largest relative error of a part in the last row.
    pub fn at_end(&self) -> f64 {
        self.parts.iter().fold(0.0, |most, part| most.max(part.at_end.relative))
    }

    /// When a row was, as "at t = 6.9" or "at the end".
    pub fn when(&self, t: f64) -> String {
        match t == self.t_end {
            true => "at the end".into(),
            false => format!("at t = {}", time(t, [t, self.t_end])),
        }
    }

    /// As "about 8 digits".
    pub fn digits_in_words(&self) -> String {
        match self.digits {
            0 => "no right digit".into(),
            1 => "about 1 digit".into(),
            digits => format!("about {digits} digits"),
        }
    }

    /// As "about 8 digits are right".
    pub fn rightness_in_words(&self) -> String {
        match self.digits {
            _ if self.relative().is_nan() => "the number of right digits is not known".into(),
            0 => "no digit is right".into(),
            1 => self.digits_in_words() + " is right",
            _ => self.digits_in_words() + " are right",
        }
    }

    /// The errors of the parts, as in "attitude 0.002 degrees at t = 6.9, at the end 0.001; momentum_body 1.2e-9 of its
    /// size at the end": the largest ones first, where there are many.
    pub fn errors_in_words(&self) -> String {
        let mut parts: Vec<_> = self.parts.iter().collect();
        let further = parts.len().saturating_sub(PARTS);
        if further > 0 {
            parts.sort_by(|a, b| b.largest.rank().total_cmp(&a.largest.rank()));
        }
        let in_words = |part: &PartError| {
            let PartError { name, largest, t, at_end } = part;
            let (error, unit) = largest.in_words();
            let told = format!("{name} {error}{unit} {}", self.when(*t));
            let (end, of_end) = at_end.in_words();
            if *t == self.t_end {
                told
            } else {
                format!("{told}, at the end {end}{}", if unit.is_empty() { of_end } else { "" })
            }
        };
        let mut told: Vec<_> = parts.into_iter().take(PARTS).map(in_words).collect();
        if further > 0 {
            told.push(format!("{further} further parts less"));
        }
        told.join("; ")
    }

    /// How it was found, in words. `rows` is the number of rows of the run.
    pub fn found_in_words(&self, rows: u64) -> String {
        let by =
            |what: &str| format!("estimated by a second run {what}, {}", duration(self.seconds));
        let found = match self.found_by {
            FoundBy::Exact => "against the exact motion".into(),
            FoundBy::SplitSteps => by("with each step in two parts"),
            FoundBy::HalfStep => by("with half the step"),
            FoundBy::TenthTolerance => by("at a tenth of the tolerance"),
            FoundBy::TenfoldTolerance => by("at ten times the tolerance"),
            FoundBy::ShortSteps => by("in short steps"),
        };
        match self.rows < rows {
            true => format!("{found}, in {} of {rows} rows", self.rows),
            false => found,
        }
    }
}

impl Distance {
    /// Is it a number?
    fn is_known(&self) -> bool {
        !self.relative.is_nan()
    }

    /// The relative distance; infinite if it is NaN.
    fn rank(&self) -> f64 {
        if self.is_known() { self.relative } else { f64::INFINITY }
    }

    /// The number and its unit, as "0.002" and " degrees", or "1.2e-9" and " of its size".
    fn in_words(&self) -> (String, &'static str) {
        match self.degrees {
            _ if !self.is_known() => ("not known".into(), ""),
            Some(degrees) => (rough(degrees), " degrees"),
            None if self.relative.is_infinite() => (rough(self.absolute), ", of a size of 0,"),
            None => (rough(self.relative), " of its size"),
        }
    }
}

/// Steps that were chosen by their error.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Chosen {
    /// Steps that were accepted.
    pub accepted: u64,
    /// Attempts that were rejected, for their error or because the step failed.
    pub rejected: u64,
    /// Evaluations of f, where the method knows them.
    pub evaluations: Option<u64>,
    /// The smallest accepted step.
    pub smallest_step: f64,
    /// The largest accepted step.
    pub largest_step: f64,
}

/// A method with its parts.
#[derive(Clone, Debug, Serialize)]
pub struct MethodSummary {
    /// Its name.
    pub name: String,
    /// Its name with its parts.
    pub label: String,
    /// Its map.
    pub map: Option<String>,
    /// Its tableau.
    pub tableau: Option<String>,
    /// The cut of the Baker series.
    pub q: Option<usize>,
    /// Its order. `None` if it is exact.
    pub order: Option<usize>,
}

/// The zeros of an event.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventSummary {
    /// Its name.
    pub name: String,
    /// How many there were.
    pub count: u64,
    /// When the first was.
    pub first: Option<f64>,
    /// When the last was.
    pub last: Option<f64>,
    /// The largest error of the times, if that is known.
    pub time_error: Option<f64>,
    /// Those that are drawn.
    #[serde(skip)]
    pub marks: Vec<f64>,
}

/// How often something came: never, once, or a number of times.
pub fn count_in_words(count: u64) -> String {
    match count {
        0 => "never".into(),
        1 => "once".into(),
        count => format!("{count} times"),
    }
}

impl EventSummary {
    /// None yet.
    pub fn new(name: &str) -> Self {
        let (name, marks) = (name.into(), Vec::new());
        EventSummary { name, count: 0, first: None, last: None, time_error: None, marks }
    }

    /// How often and when it came, as "once, at t = 3" or "21 times, first at t = 1.5, last at t = 60", with this way to
    /// write a time.
    pub fn in_words(&self, time: impl Fn(f64) -> String) -> String {
        let told = count_in_words(self.count);
        match (self.count, self.first, self.last) {
            (1, Some(at), _) => format!("{told}, at t = {}", time(at)),
            (_, Some(first), Some(last)) => {
                format!("{told}, first at t = {}, last at t = {}", time(first), time(last))
            }
            _ => told,
        }
    }

    /// The error of the times, as "times right to about 2e-12", if it is known.
    pub fn time_error_in_words(&self) -> Option<String> {
        self.time_error.map(|error| format!("times right to about {}", rough(error)))
    }

    /// The next zero. At most `marks` zeros are drawn.
    pub fn see(&mut self, t: f64, marks: usize) {
        self.count += 1;
        self.first = self.first.or(Some(t));
        self.last = Some(t);
        if self.marks.len() < marks {
            self.marks.push(t);
        }
    }
}

/// How far an invariant moved from its value at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Drift {
    /// Its value at the start.
    pub initial: f64,
    /// |value − initial| at the end.
    pub at_end: f64,
    /// The largest |value − initial|.
    pub max: f64,
    /// The largest |value − initial| at the ends of the steps that have rows within them; none without such rows.
    pub max_at_ends_of_steps: Option<f64>,
    /// What it moves by in a unit of time: the slope of the line with the least squares.
    pub slope: f64,
    /// Does the method promise to keep it to rounding?
    pub promised: bool,
    /// What rounding explains of `max`.
    pub rounding: f64,
    /// The largest size that rounding is relative to.
    #[serde(skip)]
    pub size: f64,
}

impl Drift {
    /// Are the drift and the size of the quantity numbers? Otherwise nothing can be said of it.
    pub fn is_known(&self) -> bool {
        self.max.is_finite() && self.rounding.is_finite()
    }

    /// Does rounding explain it?
    pub fn is_rounding(&self) -> bool {
        self.is_known() && self.max <= self.rounding
    }

    /// Did it move by far more at rows within steps than at the ends of the steps? Of what the method keeps there to rounding,
    /// any more.
    pub fn is_of_rows(&self) -> bool {
        self.max_at_ends_of_steps.filter(|at_ends| at_ends.is_finite()).is_some_and(|at_ends| {
            let times = if self.promised && at_ends <= self.rounding { 1.0 } else { OF_ROWS };
            self.is_known() && self.max > times * at_ends.max(self.rounding)
        })
    }

    /// Did it move by more than rounding explains, though the method promises to keep it? The promise is about the ends
    /// of steps.
    pub fn breaks_a_promise(&self) -> bool {
        self.promised && (self.max.is_nan() || self.max > self.rounding) && !self.is_of_rows()
    }

    /// Did it move by far more than the relative error of the run explains? Then it is no constant of the motion. A formula
    /// that is 0 may have terms as large as `numbers`, those of its row. In the motion without errors its value is `gap` away.
    pub fn is_of_the_motion(&self, error: f64, numbers: f64, gap: f64) -> bool {
        let least = error.max(NO_CONSTANT / BEYOND);
        let explained = self.rounding.max(least * self.size).max(f64::EPSILON * numbers).max(gap);
        let is_explained = !self.is_known() || error.is_nan() || self.max <= BEYOND * explained;
        !self.promised && !is_explained && !self.is_of_rows()
    }
}

/// A drift above this many times the error of the run does not come from the method.
const BEYOND: f64 = 1e3;
/// A smaller relative drift is no reason to doubt a formula.
const NO_CONSTANT: f64 = 1e-6;

/// A drift at rows above this many times the drift at ends of steps comes from the rows.
const OF_ROWS: f64 = 100.0;

/// A drift that is being watched.
#[derive(Clone, Debug)]
pub struct Watched {
    drift: solve::Drift,
    t0: f64,
    /// t and the value, from the start.
    fit: Fit,
}

impl Watched {
    /// The value and the size of its terms at the start.
    pub fn new(t0: f64, invariant: Invariant, value: f64, terms: f64) -> Self {
        let fit = Fit::from_iter([(0.0, 0.0)]);
        Watched { drift: solve::Drift::new(invariant, value, terms), t0, fit }
    }

    /// The next row.
    pub fn see(&mut self, t: f64, value: f64, terms: f64) {
        self.drift.see(value, terms);
        self.fit.add((t - self.t0, self.drift.at_end));
    }

    /// The end of a step that had rows within it.
    pub fn see_end_of_step(&mut self, value: f64) {
        self.drift.see_end_of_step(value);
    }

    /// Calls `each` with the largest drift at the ends of steps so far, or with −1 before the first step has ended.
    pub fn each_unshown(&mut self, each: &mut dyn FnMut(&mut f64)) {
        let mut largest = self.drift.largest_at_ends_of_steps.unwrap_or(-1.0);
        each(&mut largest);
        self.drift.largest_at_ends_of_steps = (largest != -1.0).then_some(largest);
    }

    /// What was seen. `steps` is the number of steps of the run.
    pub fn drift(&self, promised: bool, steps: u64) -> Drift {
        Drift {
            initial: self.drift.start,
            at_end: self.drift.at_end.abs(),
            max: self.drift.largest,
            max_at_ends_of_steps: self.drift.largest_at_ends_of_steps,
            // One row alone has no slope.
            slope: self.fit.slope().unwrap_or(0.0),
            promised,
            rounding: self.drift.explained_by_rounding(steps),
            size: self.drift.size,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drift or a size that is no finite number is no rounding, and tells nothing of the motion. A promise of a value that is
    /// no number is not kept.
    #[test]
    fn nothing_is_said_of_a_drift_that_is_not_known() {
        let known =
            Drift { max: 1.0, size: 1.0, rounding: 0.5, promised: true, ..Drift::default() };
        assert!(known.breaks_a_promise() && !known.is_rounding());
        for (max, rounding) in [(f64::NAN, 1.0), (f64::INFINITY, 1.0), (1.0, f64::INFINITY)] {
            for promised in [true, false] {
                let at_ends = Some(1e-9);
                let drift =
                    Drift { max, rounding, promised, max_at_ends_of_steps: at_ends, ..known };
                assert!(!drift.is_known() && !drift.is_rounding() && !drift.is_of_rows());
                assert!(!drift.is_of_the_motion(1e-9, 1.0, 0.0));
                assert_eq!(drift.breaks_a_promise(), promised && !max.is_finite());
            }
        }
    }
}
