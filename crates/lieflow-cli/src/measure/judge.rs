//! What a run is judged by: the exact end, or one that two methods agree on; and the invariants.

use lieflow::catalog::MethodSpec;
use lieflow::problems::{Origin, explained_by_rounding};
use lieflow::solve::{Status, Stops};
use lieflow::tolerance::Rule;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use lieflow::{RunError, SaveAt, StepControl, TimeGrid};

use super::reference::{Reference, Rounding, TIGHT, reference_methods};
use super::{Candidate, Size, WorkPoint};
use crate::error::CliError;
use lieflow_counting::operations;
use lieflow_model::problem::{
    Model, Plan, Rows as Watched, SHORT_STEPS, Sink, Steps, is_elsewhere, time_to_search,
};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Component, Observable, Row, Schema, length};
use lieflow_timing::cpu_seconds;

/// Numbers of steps in which the exact motion is always taken, to see how much it rounds.
const PARTS: [u64; 5] = [2, 3, 5, 7, 11];

/// Where runs of few steps are judged besides their end, in parts of the span. The errors of a few steps may cancel at the
/// end of a whole number of turns.
const WITHIN: [f64; 2] = [0.382, 0.809];
/// Runs of fewer steps are judged there.
const FEW: u64 = 200;
/// An error there that is larger by this factor than that at the end is the error of the run.
const CANCELLED: f64 = 30.0;
/// A part that is this much smaller where it is judged than elsewhere returns to 0 there, as once in a period: its size
/// there is rounding.
pub(crate) const RETURNS: f64 = 1e-6;

/// A span, and how the steps of a scene are bounded in it.
#[derive(Clone, Debug)]
pub struct Course {
    /// The span.
    pub t_span: [f64; 2],
    /// The times at which a step of one size ends.
    stops: Stops,
    /// The same of steps that are chosen by their error.
    stops_by_error: Stops,
    /// The limit of steps that are chosen by their error.
    largest: Option<f64>,
    /// The limit of attempts.
    max_steps: Option<u64>,
}

impl Course {
    /// The span without bounds.
    pub fn free(t_span: [f64; 2]) -> Self {
        let none = Stops::default;
        Course { t_span, stops: none(), stops_by_error: none(), largest: None, max_steps: None }
    }

    /// The span with the bounds of a scene.
    fn of(scene: &Scene, t_span: [f64; 2]) -> Self {
        Course {
            t_span,
            stops: scene.stops_of(false, t_span),
            stops_by_error: scene.stops_of(true, t_span),
            largest: scene.largest_step(),
            max_steps: scene.max_steps,
        }
    }

    /// Tolerances relative to the length of the step, and the limits. The error of a run then follows rtol, whatever the
    /// order of the method.
    fn control(&self, rtol: f64, atol: f64) -> Result<StepControl, lieflow::Error> {
        let control = StepControl::new(rtol, atol)?.rule(Rule::PerLength);
        self.largest.map_or(Ok(control.clone()), |h| control.max_step(h))
    }
}

/// The exact end of a run, with the quantities that a run is judged by.
#[derive(Debug)]
pub struct Judge<'a> {
    state: &'static [&'static str],
    /// The span.
    pub course: Course,
    /// The state and the invariants.
    schema: Schema,
    end: Vec<f64>,
    /// Times of [`WITHIN`], where the motion is known, with the state there.
    within: Vec<(f64, Vec<f64>)>,
    /// Where the end comes from.
    pub reference: Reference,
    /// The flag that ends each run.
    stop: &'a AtomicBool,
}

/// A run at the tolerance of a reference.
struct TightRun {
    /// The last row.
    end: Vec<f64>,
    /// The rows at times of [`WITHIN`].
    within: Vec<(f64, Vec<f64>)>,
    steps: u64,
    seconds: f64,
}

impl<'a> Judge<'a> {
    /// For runs of the problem of `scene` over a span, in up to these numbers of steps. A single run for the
    /// rounding of the exact solution takes about so long at most. `stop` ends a run.
    ///
    /// # Errors
    /// The problem cannot be set up, or no reference can be computed.
    pub fn new(
        scene: &Scene,
        quantities: &[&str],
        t_span: [f64; 2],
        steps: &[u64],
        longest: Duration,
        stop: &'a AtomicBool,
    ) -> Result<Self, CliError> {
        let state = scene.problem.state(quantities);
        let judged = [state, &scene.problem.invariants(quantities)].concat();
        // The first layer of the problem.
        let layer = scene.problem.layers().first().copied().unwrap_or(scene.layer);
        let model = scene.model_with(layer, &judged)?;
        let (schema, reference) = (model.schema().clone(), Reference::Exact { rounding: None });
        let (end, within, course) = (Vec::new(), Vec::new(), Course::of(scene, t_span));
        let mut judge = Judge { state, course, schema, end, within, reference, stop };
        match model.exact(t_span) {
            Some(Ok(exact)) => {
                judge.end = exact;
                let at = |t: f64| Some((t, model.exact([t_span[0], t])?.ok()?));
                judge.within = times_within(t_span).into_iter().filter_map(at).collect();
                let rounding = judge.rounding(&model, steps, longest);
                judge.reference = Reference::Exact { rounding };
            }
            _ => judge.find_end(&model)?,
        }
        Ok(judge)
    }

    /// Takes the end of two runs. If a run in short steps ends elsewhere, both passed over something short, such as a pulse.
    /// Then the end is that of two runs in short steps.
    fn find_end(&mut self, model: &Model) -> Result<(), CliError> {
        let (method, steps, seconds) = self.take_two_runs(model, None)?;
        let [t0, t1] = self.course.t_span;
        let short = (t1 - t0).abs() / SHORT_STEPS as f64;
        if time_to_search(steps, seconds).is_none() {
            return Ok(());
        }
        let Some(found) = self.tight_run(model, &method, Some(short))? else { return Ok(()) };
        let rounding = explained_by_rounding(found.steps, 1.0);
        if is_elsewhere(self.error(&found.end), self.reference.floor().max(rounding)) {
            self.take_two_runs(model, Some(short))?;
        }
        Ok(())
    }

    /// Takes the end of two runs of different methods, in steps of at most `largest`. Returns the first method, and its
    /// number of steps and seconds.
    fn take_two_runs(
        &mut self,
        model: &Model,
        largest: Option<f64>,
    ) -> Result<(MethodSpec, u64, f64), CliError> {
        let mut first: Option<(MethodSpec, TightRun)> = None;
        for method in reference_methods() {
            let Some(run) = self.tight_run(model, &method, largest)? else { continue };
            let Some((by, taken)) = &first else {
                first = Some((method, run));
                continue;
            };
            (self.end, self.within) = (taken.end.clone(), taken.within.clone());
            let apart = self.error(&run.end);
            let (name, beside) = (by.label(), method.label());
            self.reference = Reference::Own { by: name, beside, apart, largest };
            return Ok((by.clone(), taken.steps, taken.seconds));
        }
        Err(CliError::Message("no two methods for a reference solution fit this problem".into()))
    }

    /// A run at the tolerance of a reference, in steps of at most `largest`. None if the method does not fit the problem.
    fn tight_run(
        &self,
        model: &Model,
        method: &MethodSpec,
        largest: Option<f64>,
    ) -> Result<Option<TightRun>, CliError> {
        let t_span = self.course.t_span;
        let course = Course {
            largest: match (self.course.largest, largest) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            },
            ..self.course.clone()
        };
        let control = course.control(TIGHT, TIGHT)?.max_steps(10_000_000)?;
        let [t0, t1] = t_span;
        let times = [&[t0], &times_within(t_span)[..], &[t1]].concat();
        let (mut rows, start) = (Vec::new(), cpu_seconds());
        let steps = Steps::ByError { t_span, control };
        let (cancel, stops) = (Some(self.stop), course.stops_by_error);
        let plan =
            Plan { cancel, stops, times_by_steps: true, ..Plan::new(steps, SaveAt::Times(times)) };
        let mut see = |t: f64, row: Row<'_>| rows.push((t, row.values().to_vec()));
        match model.drive(method, plan, &mut Watched(&mut see)) {
            Ok(outcome) if outcome.status == Status::Cancelled => {
                Err(CliError::Message("no reference solution: it was stopped".into()))
            }
            Ok(outcome) => {
                let (_, end) = rows.pop().unwrap_or_default();
                let within = rows.split_off(1.min(rows.len()));
                let (steps, seconds) = (outcome.stats.accepted, cpu_seconds() - start);
                Ok(Some(TightRun { end, within, steps, seconds }))
            }
            Err(RunError::Setup(_)) => Ok(None),
            Err(error) => Err(CliError::Message(format!(
                "no reference solution: {} stopped: {error}",
                method.label()
            ))),
        }
    }

    /// How far from its end the exact motion comes in several steps, and in as many as other methods take. One
    /// number of steps may meet calm moments only.
    fn rounding(&self, model: &Model, steps: &[u64], longest: Duration) -> Option<Rounding> {
        let mut numbers = [&PARTS, steps].concat();
        numbers.retain(|steps| *steps > 1);
        numbers.sort_unstable();
        let mut worst = None;
        for steps in numbers {
            let (start, mut last) = (cpu_seconds(), Vec::new());
            let mut see = |_: f64, row: Row<'_>| last = row.values().to_vec();
            let exact = MethodSpec::new("exact", None);
            let size = Size::Steps(steps);
            let rows = &Rows::ENDS;
            let whole = (&self.course, self.course.t_span[1]);
            size.run(model, &exact, whole, rows, Some(self.stop), &mut see).ok()?;
            let before = worst.map_or(0.0, |worst: Rounding| worst.apart);
            let apart = Some(self.error(&last)).filter(|apart| apart.is_finite())?;
            worst = Some(Rounding { apart: before.max(apart), steps });
            if cpu_seconds() - start > longest.as_secs_f64() {
                break;
            }
        }
        worst
    }

    /// What a model must compute for [`point`](Self::point).
    pub fn quantities(&self) -> Vec<&'static str> {
        self.schema.iter().map(|observable| observable.name).collect()
    }

    /// True if the method keeps all that the action keeps here, and so M. Gauss methods keep quadratic invariants, though
    /// they add vectors.
    pub fn promises_manifold(&self, method: &MethodSpec) -> bool {
        let is_of_action =
            |law: &&Observable| law.law.is_some_and(|law| law.origin == Origin::Action);
        let mut laws = self.schema.laws().filter(is_of_action).peekable();
        let Ok(info) = method.info() else { return false };
        laws.peek().is_some() && laws.all(|law| law.promised_by(info))
    }

    /// Run once, and judge.
    pub fn point(&self, model: &Model, candidate: &Candidate, size: Size) -> WorkPoint {
        let t_span = self.course.t_span;
        let (mut first, mut last) = (Vec::new(), Vec::new());
        let mut see = |_: f64, row: Row<'_>| {
            if first.is_empty() {
                first = row.numbers().to_vec();
            }
            last = row.numbers().to_vec();
        };
        let mut point = WorkPoint::new(t_span, size);
        let method = &candidate.method;
        let whole = (&self.course, t_span[1]);
        let outcome = size.run(model, method, whole, &Rows::ENDS, Some(self.stop), &mut see);
        match outcome {
            Ok(done) => {
                let length = (t_span[1] - t_span[0]).abs();
                (point.steps, point.rejected) = (done.steps, done.rejected);
                point.h = length / done.steps.max(1) as f64;
                point.evaluations = done
                    .evaluations
                    .or_else(|| candidate.evaluations_per_step().map(|n| n * done.steps));
                point.error = self.error(&last);
                let [first, last] = [&first, &last].map(|values| self.schema.row(values));
                for law in self.schema.laws() {
                    for (&start, &end) in first[law].iter().zip(&last[law]) {
                        let moved = relative(end - start, size_of_value(start, first.terms(law)));
                        if law.law.is_some_and(|law| law.origin == Origin::Action) {
                            let off = if law.is_distance { end } else { moved };
                            point.off_manifold = off.max(point.off_manifold);
                        }
                        match law.name {
                            "energy" => point.energy_error = moved.max(point.energy_error),
                            _ if law.is_distance => {
                                point.group_residual = end.max(point.group_residual);
                            }
                            _ => point.casimir_error = moved.max(point.casimir_error),
                        }
                    }
                }
            }
            Err(failure) => point.failure = Some(failure),
        }
        point
    }

    /// Takes the largest error within the span as that of a run of few steps, where the errors of its steps cancel at the
    /// end: by runs to two times within.
    pub fn look_within(&self, model: &Model, method: &MethodSpec, point: &mut WorkPoint) {
        if point.failure.is_some() || point.steps >= FEW {
            return;
        }
        let at = |(t, state): &(f64, Vec<f64>)| {
            let mut last = Vec::new();
            let mut see = |_: f64, row: Row<'_>| last = row.values().to_vec();
            let (to, ends) = ((&self.course, *t), &Rows::ENDS);
            match point.size.run(model, method, to, ends, Some(self.stop), &mut see) {
                Ok(_) => self.error_from(state, &last),
                Err(_) => 0.0,
            }
        };
        let within = self.within.iter().map(at).fold(0.0, f64::max);
        if within > CANCELLED * point.error {
            point.error = within;
        }
    }

    /// The largest relative distance of a part of the state from the reference at the end.
    fn error(&self, values: &[f64]) -> f64 {
        self.error_from(&self.end, values)
    }

    /// The largest relative distance of a part of the state from `right`, as a run states it: that of a rotation is an
    /// angle. A part that passes zero has the size of the end, and one that returns to zero there that within the span.
    fn error_from(&self, right: &[f64], values: &[f64]) -> f64 {
        let [row, right, end] = [values, right, &self.end].map(|values| self.schema.row(values));
        let error = |(observable, part): (&Observable, &Component)| {
            let [x, right, end] =
                [&row, &right, &end].map(|row| &row[observable][part.columns.clone()]);
            let distance = part.measure.distance(x, right);
            let size = if part.measure.is_angle() { 1.0 } else { length(right).max(length(end)) };
            let size_within = |(_, state): &(f64, Vec<f64>)| {
                length(&self.schema.row(state)[observable][part.columns.clone()])
            };
            let within = self.within.iter().map(size_within).fold(0.0, f64::max);
            relative(distance, if size < RETURNS * within { within } else { size })
        };
        // A part that is no number has left the solution: `f64::max` would forget it.
        let worst = |a: f64, b: f64| if a >= b || a.is_nan() { a } else { b };
        let state = self.schema.iter().filter(|part| self.state.contains(&part.name));
        let parts = state
            .flat_map(|observable| observable.parts.iter().map(move |part| (observable, part)));
        parts.map(error).fold(0.0, worst)
    }
}

/// The times of [`WITHIN`].
fn times_within([t0, t1]: [f64; 2]) -> [f64; 2] {
    WITHIN.map(|part| t0 + part * (t1 - t0))
}

/// The size of an invariant: its value, or that of its terms where it is a small difference of large terms.
fn size_of_value(value: f64, terms: f64) -> f64 {
    if value.abs() > 1e-3 * terms || terms.is_nan() { value.abs() } else { terms }
}

/// The gap in sizes; NaN where the size is out of the range of numbers.
fn relative(gap: f64, size: f64) -> f64 {
    match size {
        0.0 => gap.abs(),
        size if size.is_infinite() => f64::NAN,
        size => (gap / size).abs(),
    }
}

/// The rows that a run gives while it is timed.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// When.
    pub save: SaveAt,
    /// Are these times reached by shorter steps?
    pub by_steps: bool,
}

/// More rows than this are thinned out.
pub const MOST_ROWS: u64 = 10_000;

impl Rows {
    /// The start and the end.
    pub const ENDS: Rows = Rows { save: SaveAt::Ends, by_steps: false };

    /// Those of a scene, at the same times whatever the step.
    pub fn of(scene: &Scene) -> Self {
        let save = match (&scene.save, &scene.adaptive) {
            (SaveAt::Every(every), None) => {
                let thin = (scene.grid.steps() / every).div_ceil(MOST_ROWS).max(1);
                let steps = (0..scene.grid.steps()).step_by((every * thin) as usize);
                let times = steps.map(|n| scene.grid.time(n)).chain([scene.grid.t_span()[1]]);
                SaveAt::Times(times.collect())
            }
            (SaveAt::TimesAndEnds(times), _) => {
                let thin = times.len().div_ceil(MOST_ROWS as usize).max(1);
                SaveAt::TimesAndEnds(times.iter().step_by(thin).copied().collect())
            }
            (save, _) => save.clone(),
        };
        Rows { save, by_steps: scene.times_by_steps }
    }
}

/// What a run did.
#[derive(Clone, Copy, Debug)]
pub struct Done {
    steps: u64,
    rejected: u64,
    evaluations: Option<u64>,
}

impl Size {
    /// The operations of a run, of all its steps with the rejected ones. `None` if the problem or the method does not
    /// run on numbers that count.
    pub fn operations(
        self,
        model: &Model,
        method: &MethodSpec,
        course: &Course,
        steps: u64,
    ) -> Option<u64> {
        let t_span = course.t_span;
        let a_step = match self {
            Size::Steps(steps) => {
                let grid = TimeGrid::with_steps(t_span, steps).ok()?;
                model.operations(method, &Steps::Equal(grid), operations)?
            }
            Size::Tolerance(rtol) => {
                let control = course.control(rtol, 0.0).ok()?;
                model.operations(method, &Steps::ByError { t_span, control }, operations)?
            }
        };
        Some((a_step * steps as f64).round() as u64)
    }

    /// Run a method over a span in steps of this size, or to a time in it, with these rows; why not, in words. A flag
    /// cancels the run.
    ///
    /// # Errors
    /// The run did not reach its end.
    pub fn run(
        self,
        model: &Model,
        method: &MethodSpec,
        (course, to): (&Course, f64),
        rows: &Rows,
        cancel: Option<&AtomicBool>,
        sink: &mut Sink<'_>,
    ) -> Result<Done, String> {
        let in_words = |error: lieflow::Error| error.to_string();
        let t_span = course.t_span;
        let (steps, stops) = match self {
            Size::Steps(steps) => {
                let grid = TimeGrid::with_steps(t_span, steps).map_err(in_words)?;
                let is_whole = to == t_span[1];
                let part = || TimeGrid::new([t_span[0], to], grid.h().abs()).map_err(in_words);
                (Steps::Equal(if is_whole { grid } else { part()? }), &course.stops)
            }
            Size::Tolerance(rtol) => {
                let control = course.control(rtol, 0.0).map_err(in_words)?;
                (Steps::ByError { t_span: [t_span[0], to], control }, &course.stops_by_error)
            }
        };
        let plan = Plan {
            times_by_steps: rows.by_steps,
            cancel,
            stops: stops.clone(),
            max_steps: course.max_steps,
            ..Plan::new(steps, rows.save.clone())
        };
        let done = model.drive(method, plan, &mut Watched(sink));
        let done = done.map_err(|error| error.to_string())?;
        if done.status == Status::Cancelled {
            return Err("it was stopped".into());
        }
        let stats = done.stats;
        Ok(match self {
            Size::Steps(_) => Done { steps: stats.accepted, rejected: 0, evaluations: None },
            Size::Tolerance(_) => Done {
                steps: stats.accepted,
                rejected: stats.rejected,
                evaluations: stats.evaluations,
            },
        })
    }
}
