//! Checks of a method on a problem, in the build at hand: its steps, the points within them, events, tolerances.
//!
//! The results are compared with those of another method, which takes another path through the code.
//!
//! | check | what is compared with the reference | holds if |
//! |---|---|---|
//! | order of steps | the ends of runs with more and more steps of one size | the error falls with the order of the method |
//! | order within steps | the points of these runs at equal intervals, most of them within a step | the error falls with the order of dense output |
//! | ends of steps | points next to both ends of a step, with the ends themselves | they differ by as much as the motion |
//! | points on M | the distance of all points from M | it is rounding |
//! | tolerance | the points of a run with adaptive steps | the error is at most three tolerances a step |
//! | points by steps | the same points by shorter steps, with those by dense output | as for the tolerance |
//! | events | the time at which a component of the state has its reference value | as for the tolerance |
//! | saved state | the rest of a run that continues from a saved state | it has the same bits |

use std::time::Duration;

use super::Finding;
use crate::actions::Action;
use crate::groups::LieAlgebra;
use crate::methods::Embedded;
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::solve::{Event, Solve};
use crate::space::Numbers;

/// The steps of a [`Trial`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrialSteps {
    /// So many steps of one size.
    Equal(u64),
    /// Adaptive steps with this rtol and atol.
    Tolerance(f64),
}

/// A run that a check asks for.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The start and the end.
    pub t_span: [f64; 2],
    /// The steps.
    pub steps: TrialSteps,
    /// The times of the rows, in order.
    pub times: Vec<f64>,
    /// True if rows within a step come from a shorter step, not from dense output.
    pub times_by_steps: bool,
    /// An event: where the number with this place in a row has this value.
    pub event: Option<(usize, f64)>,
    /// True if the state is saved after each step.
    pub save: bool,
    /// The state to continue from.
    pub resume: Option<Vec<u8>>,
}

impl Trial {
    /// A run with rows at these times.
    pub fn new(t_span: [f64; 2], steps: TrialSteps, times: Vec<f64>) -> Self {
        let (times_by_steps, event, save, resume) = (false, None, false, None);
        Trial { t_span, steps, times, times_by_steps, event, save, resume }
    }
}

/// The result of a [`Trial`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// The numbers of the state at the times of the rows.
    pub rows: Vec<Vec<f64>>,
    /// The largest distance of a row from M, if it is known and the method stays on M.
    pub off: Option<f64>,
    /// The times of the event.
    pub events: Vec<f64>,
    /// The states that were saved, in their order.
    pub states: Vec<Vec<u8>>,
    /// The number of accepted steps.
    pub steps: u64,
}

/// A method on a problem from a start, as [`runs_agree`] sees it: in numbers.
pub trait Subject {
    /// The order of the method; `None` if its steps are exact.
    fn order(&self) -> Option<usize>;
    /// The order of the points within a step.
    fn dense_order(&self) -> usize;
    /// Takes a run.
    ///
    /// # Errors
    /// Why the run did not reach its end.
    fn run(&self, trial: Trial) -> Result<Record, String>;
    /// The distance of two rows, relative to the size of the state. The default is that of all numbers together.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>();
        let gap = norm(&mut a.iter().zip(b).map(|(a, b)| a - b));
        let size = norm(&mut b.iter().copied());
        (gap / size.max(f64::MIN_POSITIVE)).sqrt()
    }
}

/// A typed method on a problem, from a start.
#[derive(Clone, Copy)]
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct MethodOn<'a, P: Problem, M> {
    /// The problem.
    pub problem: &'a P,
    /// The method.
    pub method: &'a M,
    /// The start.
    pub start: &'a PointOf<P>,
}

impl<P, M> Subject for MethodOn<'_, P, M>
where
    P: Problem<Group: LieAlgebra<Scalar = f64>>,
    M: Embedded<P>,
    PointOf<P>: Numbers,
    ScalarOf<P>: Into<f64>,
{
    fn order(&self) -> Option<usize> {
        Some(self.method.facts(self.problem).order).filter(|&order| order != usize::MAX)
    }
    fn dense_order(&self) -> usize {
        self.method.facts(self.problem).dense_order
    }
    fn run(&self, trial: Trial) -> Result<Record, String> {
        let MethodOn { problem, method, start } = *self;
        let (group, action) = (problem.group(), problem.action());
        let Trial { t_span, steps, times, times_by_steps, event, save, resume } = trial;
        let (mut rows, mut states, mut off) = (Vec::new(), Vec::new(), None::<f64>);
        let mut solve = Solve::new(problem, method, t_span).times(times);
        solve = match steps {
            TrialSteps::Equal(steps) => solve.steps(steps),
            TrialSteps::Tolerance(tolerance) => solve.tolerances(tolerance, tolerance),
        };
        if times_by_steps {
            solve = solve.times_by_steps();
        }
        if let Some((place, value)) = event {
            let g = move |_, y: &PointOf<P>| numbers_of(y)[place] - value;
            solve = solve.event(Event::new("the reference value", g));
        }
        if save {
            solve = solve.checkpoints(Duration::ZERO, |bytes| states.push(bytes.to_vec()));
        }
        if let Some(bytes) = resume {
            solve = solve.resume(bytes);
        }
        let mut work = action.work(group);
        let stays_on_manifold = method.facts(problem).stays_on_manifold;
        let done = solve.run_with(start.clone(), |_, y| {
            rows.push(numbers_of(y));
            if stays_on_manifold {
                let found = action.restore_to(group, start, &mut y.clone(), &mut work);
                off = found.map(|found| off.map_or(found, |off| off.max(found))).or(off);
            }
        });
        let done = done.map_err(|interrupted| interrupted.error.to_string())?;
        let events = done.events.iter().map(|zero| zero.t).collect();
        Ok(Record { rows, off, events, states, steps: done.stats.accepted })
    }
}

fn numbers_of<Y: Numbers + Clone>(y: &Y) -> Vec<f64> {
    let mut numbers = Vec::new();
    y.clone().each_number(&mut |x| numbers.push(*x));
    numbers
}

/// The number of rows of the reference, at equal intervals. Methods of a low order take the first of them.
const ROWS: usize = 32;
/// The steps of the reference from row to row.
const STEPS_PER_ROW: u64 = 8;
/// The numbers of steps that are tried, until the errors are rounding.
const COUNTS: [u64; 24] = [
    1, 2, 3, 4, 5, 6, 8, 11, 15, 21, 29, 41, 57, 81, 113, 159, 223, 315, 441, 619, 867, 1231, 1747,
    2473,
];
/// A run ends at one of these rows before the last one. The error of a single end may vanish by accident.
const ENDS: [usize; 3] = [0, 2, 3];
/// An error above this one is not asymptotic.
const COARSE: f64 = 1e-2;
/// The distance of two references is multiplied by this: errors below may be those of the references.
const MARGIN: f64 = 30.0;
/// If the errors fall to rounding from one below this, they are too few for an order.
const FINE: f64 = 1e-7;
/// Errors below may be rounding.
const ROUNDING: f64 = 3e-12;
/// So many errors are enough to show an order up to 6.
const ENOUGH: usize = 8;
/// The largest number of errors through which a measured order is a straight line.
const FITTED: usize = 4;
/// The error of a run with adaptive steps is at most this many times the tolerance, for each of its steps.
const PER_STEP: f64 = 3.0;
/// The same for the distance of points by steps from points by dense output.
const APART_PER_STEP: f64 = 0.3;
/// The distance of points from M. Coarse steps have large u, at which maps amplify rounding.
const ON_M: f64 = 1e-12;

/// The rows of the reference, the floor of the errors, and the span.
#[derive(Clone, Debug)]
pub struct Reference {
    t_span: [f64; 2],
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
    floor: f64,
}

impl Reference {
    /// The rows of `subject` over the span, in small steps. `other` is another method, which tells how right they
    /// are.
    ///
    /// # Errors
    /// A run that failed, or two methods that do not agree to 1e-8.
    pub fn new(
        subject: &dyn Subject,
        other: &dyn Subject,
        t_span: [f64; 2],
    ) -> Result<Self, String> {
        let [t0, t1] = t_span;
        let times: Vec<f64> = (1..=ROWS).map(|i| t0 + (t1 - t0) * i as f64 / ROWS as f64).collect();
        let run = |subject: &dyn Subject, steps| {
            subject.run(Trial::new(t_span, TrialSteps::Equal(steps), times.clone()))
        };
        // Rows are at ends of steps: no dense output is needed for a reference.
        let steps = STEPS_PER_ROW * ROWS as u64;
        let (rows, others) = (run(subject, steps)?.rows, run(other, steps)?.rows);
        let gap = largest(rows.iter().zip(&others).map(|(a, b)| subject.distance(a, b)));
        if gap.is_nan() || gap > 1e-8 || rows.len() != ROWS {
            return Err(format!("the two references differ by {gap:e}"));
        }
        Ok(Reference { t_span, times, rows, floor: (MARGIN * gap).max(ROUNDING) })
    }

    /// The span.
    pub fn t_span(&self) -> [f64; 2] {
        self.t_span
    }

    /// The rows with their times.
    pub fn rows(&self) -> impl Iterator<Item = (f64, &[f64])> {
        self.times.iter().copied().zip(self.rows.iter().map(Vec::as_slice))
    }

    /// The largest error that may be that of the reference.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// The first `rows` rows.
    fn first(&self, rows: usize) -> Self {
        let (times, rows) = (self.times[..rows].to_vec(), self.rows[..rows].to_vec());
        let t_span = [self.t_span[0], times[times.len() - 1]];
        Reference { t_span, times, rows, floor: self.floor }
    }

    /// The distances of the rows from those of the reference.
    fn errors(&self, subject: &dyn Subject, rows: &[Vec<f64>]) -> Vec<f64> {
        match rows.len() == self.rows.len() {
            true => rows.iter().zip(&self.rows).map(|(a, b)| subject.distance(a, b)).collect(),
            false => vec![f64::INFINITY],
        }
    }
}

/// The largest of these numbers, NaN if one is NaN.
fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
}

/// The square root of the mean of the squares.
fn mean(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len() as f64).sqrt()
}

/// The order that errors show: the slope of the straight line through the logarithms of all of them, or of the last ones.
/// None for fewer than two.
fn order_of(errors: &[(f64, f64)]) -> Option<f64> {
    let last = slope(&errors[errors.len().saturating_sub(FITTED)..])?;
    Some(last.max(slope(errors)?))
}

/// The slope of the straight line through the logarithms; none for fewer than two errors.
fn slope(errors: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<_> = errors.iter().map(|(n, error)| (n.ln(), error.ln())).collect();
    let n = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (top, bottom) = logs.iter().fold((0.0, 0.0), |(top, bottom), (u, v)| {
        (top + (u - x) * (v - y), bottom + (u - x) * (u - x))
    });
    (logs.len() > 1).then(|| -top / bottom)
}

/// A measured order may be so much below the order that is claimed. Errors of a high order are rounding before they are
/// asymptotic.
fn order_bound(order: usize) -> f64 {
    if order <= 8 { (0.15 * order as f64).clamp(0.5, 0.9) } else { 0.3 * order as f64 }
}

/// The errors of runs with more and more steps, in the window where they show an order.
#[derive(Default)]
struct Errors {
    window: Vec<(f64, f64)>,
    /// True if an error is below the floor.
    ended: bool,
}

impl Errors {
    /// True if no error was small enough so far.
    fn is_coarse(&self) -> bool {
        self.window.is_empty() && !self.ended
    }

    fn add(&mut self, steps: u64, error: f64, floor: f64) {
        self.ended |= error <= floor;
        if !self.ended && error <= COARSE {
            self.window.push((steps as f64, error));
        }
    }

    /// The finding about the order that is claimed; `None` is for exact steps.
    fn finding(&self, name: &str, claimed: Option<usize>) -> Finding {
        let mut finding = Finding::new(name, claimed.map_or(0.0, order_bound));
        finding.cases = 1;
        let window: Vec<String> =
            self.window.iter().map(|(n, e)| format!("{e:.1e} at {n}")).collect();
        let errors = window.join(", ");
        match (claimed, order_of(&self.window)) {
            (None, _) if self.ended && self.window.is_empty() => {}
            (None, _) => {
                (finding.worst, finding.at) = (f64::INFINITY, format!("exact steps, but {errors}"));
            }
            // From coarse errors to rounding, or almost, by one more step.
            (Some(_), _) if self.ended && self.window.first().is_none_or(|(_, e)| *e < FINE) => {}
            (Some(order), Some(found)) => {
                finding.worst = (order as f64 - found).max(0.0);
                finding.at = format!("order {found:.1}, expected {order}: errors {errors}");
            }
            // One error between coarse ones and rounding.
            (Some(_), None) if self.ended => {}
            (Some(_), None) => {
                (finding.worst, finding.at) = (f64::INFINITY, format!("no small error: {errors}"));
            }
        }
        finding
    }
}

/// Checks a method against a reference, as the table of this module says.
///
/// ```
/// use lieflow::check::{MethodOn, Reference, runs_agree};
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use lieflow::nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let start = &Vector3::new(0.1, 2.0, 0.3);
/// let method = MethodOn { problem: &body, method: &Rkmk::new(DOP853, Exp), start };
/// let classical = MethodOn { problem: &body, method: &Rk(DOP853), start };
/// let reference = Reference::new(&classical, &method, [0.0, 4.0])?;
/// for finding in runs_agree(&method, &reference) {
///     assert!(finding.holds(), "{}: {}", finding.name, finding.at);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn runs_agree(subject: &dyn Subject, reference: &Reference) -> Vec<Finding> {
    let order = subject.order();
    let reference = &reference.first(match order {
        Some(..=2) => ROWS / 4,
        Some(..=6) => ROWS / 2,
        _ => ROWS,
    });
    let mut off = Off::default();
    let mut findings = Vec::new();

    // Steps of one size.
    let [mut ends, mut within] = [(); 2].map(|()| Errors::default());
    let mut finest = None;
    for steps in COUNTS {
        let records = match equal(subject, reference, steps) {
            Ok(records) => records,
            // A step may be too large for a chart or an iteration.
            Err(_) if ends.is_coarse() && steps < COUNTS[COUNTS.len() - 1] => continue,
            Err(why) => {
                findings.push(failed("order of steps", format!("{steps} steps: {why}")));
                return findings;
            }
        };
        let errors: Vec<_> = records
            .iter()
            .zip(ENDS)
            .map(|(record, before)| {
                let reference = reference.first(reference.rows.len() - before);
                reference.errors(subject, &record.rows)
            })
            .collect();
        let at_ends: Vec<_> = errors.iter().filter_map(|errors| errors.last().copied()).collect();
        ends.add(steps, mean(&at_ends), reference.floor);
        within.add(steps, mean(&errors.concat()), reference.floor);
        finest = Some(steps);
        if !ends.is_coarse() {
            records.iter().for_each(|record| off.see(record));
        }
        let is_high = order.is_none_or(|order| order > 6);
        let done = |errors: &Errors| errors.ended || !is_high && errors.window.len() >= ENOUGH;
        if done(&ends) && done(&within) {
            break;
        }
    }
    let dense = order.map(|order| order.min(subject.dense_order() + 1));
    findings.push(ends.finding("order of steps", order));
    findings.push(within.finding("order within steps", dense));
    if let Some(steps) = finest {
        findings.push(next_to_ends(subject, reference, steps, &mut off));
    }

    // Adaptive steps.
    let p = order.map_or(9, |order| order.min(8)) as i32;
    let tolerance = 10f64.powi(-p - 1);
    match adaptive(subject, reference, tolerance, &mut off) {
        Ok(found) => findings.extend(found),
        Err(why) => findings.push(failed("tolerance", format!("tolerance {tolerance:e}: {why}"))),
    }
    findings.extend(off.finding());
    findings
}

/// Runs with `steps` steps to the last row, and to some rows before.
fn equal(subject: &dyn Subject, reference: &Reference, steps: u64) -> Result<Vec<Record>, String> {
    let to = |before: usize| {
        let Reference { t_span, times, .. } = reference.first(reference.rows.len() - before);
        subject.run(Trial::new(t_span, TrialSteps::Equal(steps), times))
    };
    ENDS.into_iter().map(to).collect()
}

/// A check that could not be made.
fn failed(name: &str, why: String) -> Finding {
    Finding { cases: 1, worst: f64::INFINITY, at: why, ..Finding::new(name, 1.0) }
}

/// The largest distance of points from M.
#[derive(Default)]
struct Off(Option<f64>);

impl Off {
    fn see(&mut self, record: &Record) {
        self.0 = record.off.map(|off| largest([off, self.0.unwrap_or(0.0)].into_iter())).or(self.0);
    }

    fn finding(&self) -> Option<Finding> {
        let off = self.0?;
        let at = format!("{off:e} off M");
        Some(Finding { cases: 1, worst: off, at, ..Finding::new("points on M", ON_M) })
    }
}

/// The points next to the ends of a step in the middle of a run.
fn next_to_ends(
    subject: &dyn Subject,
    reference: &Reference,
    steps: u64,
    off: &mut Off,
) -> Finding {
    let [t0, t1] = reference.t_span;
    let h = (t1 - t0) / steps as f64;
    // A step in the middle. In a run of one step its start is no row.
    let near = 1e-7 * h;
    let (start, end) = (t0 + h * (steps / 2) as f64, t0 + h * (steps / 2 + 1).min(steps) as f64);
    let times = vec![start + near, start + 0.5 * h, end - near, end];
    let record = subject.run(Trial::new([t0, t1], TrialSteps::Equal(steps), times.clone()));
    let name = "ends of steps";
    let record = match record {
        Ok(record) if record.rows.len() == times.len() => record,
        Ok(record) => return failed(name, format!("{} rows of {}", record.rows.len(), 4)),
        Err(why) => return failed(name, why),
    };
    off.see(&record);
    let rows = &record.rows;
    // What the state moves by in a step, and what rounding of t and of a few products moves.
    let moved = subject.distance(&rows[0], &rows[1]) + subject.distance(&rows[1], &rows[3]);
    let allowed = 20.0 * 1e-7 * moved + 1e-13;
    let mut gap = subject.distance(&rows[2], &rows[3]);
    let mut at = format!("{gap:.1e} from the end of a step, at 1e-7 of it");
    if steps > 1 && t0 < start {
        let times = vec![start, start + near];
        let record = subject.run(Trial::new([t0, t1], TrialSteps::Equal(steps), times));
        match record {
            Ok(record) if record.rows.len() == 2 => {
                let other = subject.distance(&record.rows[0], &record.rows[1]);
                if other > gap || other.is_nan() {
                    (gap, at) = (other, format!("{other:.1e} from the start of a step, at 1e-7"));
                }
            }
            Ok(record) => return failed(name, format!("{} rows of 2", record.rows.len())),
            Err(why) => return failed(name, why),
        }
    }
    Finding { cases: 1, worst: gap / allowed, at, ..Finding::new(name, 1.0) }
}

/// The run with adaptive steps, the same by shorter steps, and from a saved state.
fn adaptive(
    subject: &dyn Subject,
    reference: &Reference,
    tolerance: f64,
    off: &mut Off,
) -> Result<Vec<Finding>, String> {
    let Reference { t_span, times, rows, floor } = reference;
    // A number of the state passes its value at a row, fast, on a curve, and not beside a turning point.
    let passes = (1..rows.len() - 1).flat_map(|i| {
        let numbers = rows[i - 1].iter().zip(&rows[i]).zip(&rows[i + 1]).enumerate();
        numbers.map(move |(place, ((a, b), c))| {
            let (before, after) = (b - a, c - b);
            let least = if before * after > 0.0 { before.abs().min(after.abs()) } else { 0.0 };
            (i, place, (c - a).abs(), least * (after - before).abs())
        })
    });
    let passes = passes.filter(|(.., rank)| *rank > 0.0);
    let passed = passes.max_by(|a, b| a.3.total_cmp(&b.3));
    let event = passed.map(|(i, place, ..)| (place, rows[i][place]));
    let trial = Trial {
        event,
        save: true,
        ..Trial::new(*t_span, TrialSteps::Tolerance(tolerance), times.clone())
    };
    let record = subject.run(trial.clone())?;
    off.see(&record);
    let steps = record.steps.max(1) as f64;
    // Points within a step of a lower order are less accurate than its end.
    let (p, q) = match subject.order() {
        None => (1.0, 1.0),
        Some(order) => (order as f64 + 1.0, order.min(subject.dense_order()) as f64 + 1.0),
    };
    let per_step = tolerance.powf((q / p).min(1.0));
    let allowed = PER_STEP * steps * per_step + floor;
    let apart = APART_PER_STEP * steps * per_step + floor;
    let error = largest(reference.errors(subject, &record.rows).into_iter());
    let told = |error: f64| format!("{error:.1e} at tolerance {tolerance:.0e}, {steps} steps");
    let mut findings = vec![Finding {
        cases: 1,
        worst: error / allowed,
        at: told(error),
        ..Finding::new("tolerance", 1.0)
    }];

    let landed = subject.run(Trial { times_by_steps: true, save: false, ..trial.clone() })?;
    let pairs = landed.rows.iter().zip(&record.rows);
    let gap = largest(pairs.map(|(a, b)| subject.distance(a, b)));
    let gap = if landed.rows.len() == record.rows.len() { gap } else { f64::INFINITY };
    findings.push(Finding {
        cases: 1,
        worst: gap / apart,
        at: told(gap),
        ..Finding::new("points by steps", 1.0)
    });

    if let Some((i, place, change, _)) = passed {
        let speed = change / (times[i + 1] - times[i - 1]).abs();
        let gaps = record.events.iter().map(|t| (t - times[i]).abs());
        // A run that never passes the value has an error of at least the way from there to the nearer end of the values.
        let ends = rows.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], row| {
            [low.min(row[place]), high.max(row[place])]
        });
        let beyond = (rows[i][place] - ends[0]).min(ends[1] - rows[i][place]);
        let gap = gaps.reduce(f64::min).map_or(beyond, |gap| gap * speed);
        let size = rows.iter().map(|row| row.iter().map(|x| x * x).sum::<f64>().sqrt());
        let size = size.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        findings.push(Finding {
            cases: 1,
            worst: gap / size / allowed,
            at: format!(
                "number {place} of the state passes its value {} away in t, tolerance {tolerance:.0e}",
                gap / speed
            ),
            ..Finding::new("events", 1.0)
        });
    }

    // The state after the first half of the steps.
    if let Some(state) = record.states.get(record.states.len() / 2) {
        let resume = Some(state.clone());
        let rest = subject.run(Trial { resume, save: false, ..trial })?;
        let tail = record.rows.len().saturating_sub(rest.rows.len());
        let bits =
            |rows: &[Vec<f64>]| rows.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
        let same = !rest.rows.is_empty() && bits(&rest.rows) == bits(&record.rows[tail..]);
        findings.push(Finding {
            cases: 1,
            worst: if same { 0.0 } else { f64::INFINITY },
            at: format!("the last {} rows are others", rest.rows.len()),
            ..Finding::new("saved state", 1.0)
        });
    }
    Ok(findings)
}
