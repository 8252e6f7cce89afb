//! What a run is watched for: what is written, what says how good it is, what is drawn.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use lieflow::catalog::{MethodSpec, Needs};
use lieflow::problems::Invariant;
use lieflow::solve::{Next, Status};
use lieflow::{Error, RunError};

use super::accuracy::Taken;
use super::between::Between;
use super::room::Room;
use super::singular::Singular;
use crate::error::CliError;
use crate::output::{
    self, Chosen, Drift, EventSummary, Kind, Progress, RowFile, RowSample, RunState, Seen, Watched,
};
use lieflow_model::problem::Figure;
use lieflow_model::problem::{Model, Outcome, Plan, Watcher};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Branch, Measure, Observable, Row, Schema};

/// The quantities of a run: those that the scene names first, then those of its events, the state, the invariants
/// and those that are drawn.
pub(super) fn quantities(scene: &Scene) -> Vec<&str> {
    let problem = &scene.problem;
    let mut all = scene.computed();
    let drawn_as = all.iter().filter_map(|name| problem.kind().quantity(name).ok());
    let drawn: Vec<&str> =
        drawn_as.map(|info| info.drawn_as).filter(|name| !name.is_empty()).collect();
    let figure = problem.figure(&all).quantity();
    let further = [problem.state(&all), &problem.invariants(&all), &[figure], &drawn];
    for name in further.concat() {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

/// Everything that a run is watched for.
pub(super) struct Watch<'a> {
    pub(super) scene: &'a Scene,
    pub(super) model: &'a Model,
    pub(super) written: Vec<&'a Observable>,
    /// What is written, or what events and formulas are made of.
    computed: Vec<&'a Observable>,
    /// The columns of what is written, each with its place in a row.
    pub(super) columns: Vec<(&'a str, usize)>,
    pub(super) state: Vec<&'a Observable>,
    pub(super) laws: Vec<&'a Observable>,
    pub(super) drawn: &'a Observable,
}

impl<'a> Watch<'a> {
    /// `model` has the [`quantities`] of the scene.
    pub(super) fn new(scene: &'a Scene, model: &'a Model) -> Result<Self, CliError> {
        let (problem, schema) = (&scene.problem, model.schema());
        let computed = scene.computed();
        let find = |names: &[&str]| -> Result<Vec<_>, _> {
            names.iter().map(|name| schema.get(name)).collect()
        };
        let written = find(&computed[..scene.quantities.len()])?;
        Ok(Watch {
            computed: find(&computed)?,
            scene,
            model,
            columns: Schema::each_column_once(written.iter().copied()),
            state: find(problem.state(&computed))?,
            laws: find(&problem.invariants(&computed))?,
            drawn: schema.get(problem.figure(&computed).quantity())?,
            written,
        })
    }

    /// The values that are written of a row go to the end of `line`.
    pub(super) fn line(&self, row: Row<'_>, line: &mut Vec<f64>) {
        line.extend(self.columns.iter().map(|(_, place)| row.numbers()[*place]));
    }

    /// The names of the columns of the invariants.
    pub(super) fn law_columns(&self) -> impl Iterator<Item = &'a String> {
        self.laws.iter().flat_map(|law| &law.columns)
    }

    /// The invariants of the next row, each in its turn.
    fn see(&self, t: f64, row: Row<'_>, watched: &mut Vec<Watched>) {
        let of = |&law: &&'a Observable| row[law].iter().map(move |x| (law, *x, row.terms(law)));
        let values = self.laws.iter().flat_map(of);
        if watched.is_empty() {
            let starts =
                self.law_columns().zip(values).filter_map(|(name, (quantity, x, terms))| {
                    Some(Watched::new(t, Invariant::new(name, quantity.law?), x, terms))
                });
            watched.extend(starts);
        } else {
            let rows = watched.iter_mut().zip(values);
            rows.for_each(|(watched, (_, x, terms))| watched.see(t, x, terms));
        }
    }

    /// The invariants at the end of a step that had rows within it.
    fn see_end_of_step(&self, row: Row<'_>, watched: &mut [Watched]) {
        let values = self.laws.iter().flat_map(|law| &row[*law]);
        watched.iter_mut().zip(values).for_each(|(watched, x)| watched.see_end_of_step(*x));
    }

    /// What ends the run here: a state of the row that is not finite.
    fn overflow(&self, t: f64, row: Row<'_>) -> Option<String> {
        let states = self.written.iter().filter(|part| part.is_state);
        let mut numbers = states.flat_map(|part| part.columns.iter().zip(&row[*part]));
        let (column, x) = numbers.find(|(_, x)| !x.is_finite())?;
        Some(format!("the state is out of the range of numbers at t = {t}: {column} is {x}"))
    }

    /// The drift of each invariant, by column.
    pub(super) fn drift(
        &self,
        watched: &[Watched],
        steps: u64,
    ) -> Result<BTreeMap<String, Drift>, CliError> {
        let method = self.scene.method.info()?;
        let columns = self.laws.iter().flat_map(|law| {
            law.columns.iter().map(|column| (column.clone(), law.promised_by(method)))
        });
        let drifts = columns.zip(watched);
        Ok(drifts.map(|((name, promised), w)| (name, w.drift(promised, steps))).collect())
    }

    /// The largest number of the state and of the laws in a row.
    pub(super) fn largest(&self, row: Row<'_>) -> f64 {
        let numbers = self.state.iter().chain(&self.laws).flat_map(|part| &row[*part]);
        numbers.fold(0.0, |most, x| most.max(x.abs()))
    }

    /// Run the scene by this plan. A step that fails is an end, not an error.
    pub(super) fn run(&self, plan: Plan<'_>, watcher: &mut dyn Watcher) -> Result<Done, CliError> {
        let scene = self.scene;
        scene.forget_losses();
        match self.model.drive(&scene.method, plan, watcher) {
            Ok(Outcome { t, status, stats, .. }) => Ok(Done {
                unsure: stats.unsure_in_words("h_max", status.event()),
                taken: Taken::of(&stats, scene.grid.t_span()),
                points_within: Some(stats.points_within),
                chosen: scene.adaptive.is_some().then_some(Chosen {
                    accepted: stats.accepted,
                    rejected: stats.rejected,
                    evaluations: stats.evaluations,
                    smallest_step: stats.smallest_step,
                    largest_step: stats.largest_step,
                }),
                failure: (status == Status::Cancelled).then(|| format!("interrupted at t = {t}")),
                attempts_used_up: false,
                interrupted: status == Status::Cancelled,
                ended_by: status.event().map(String::from),
                t: Some(t),
            }),
            Err(RunError::Setup(error)) => Err(error.into()),
            Err(error) => Ok(Done {
                failure: scene.lost_in_words(&error).or_else(|| {
                    let pole = scene.pole(&error).map(|why| format!(": {why}"));
                    let told = pole.or_else(|| self.larger_steps(&error)).unwrap_or_default();
                    Some(format!("{error}{told}"))
                }),
                taken: Taken { steps: error.accepted().unwrap_or(0), ..Taken::default() },
                attempts_used_up: matches!(error, RunError::TooManySteps { .. }),
                ..Done::default()
            }),
        }
    }

    /// What takes larger steps, where the attempts of a run were used up and f depends on time alone: the methods that
    /// are for such an f.
    fn larger_steps(&self, error: &RunError) -> Option<String> {
        let RunError::TooManySteps { .. } = error else { return None };
        if self.scene.method.info().ok()?.needs == Needs::LinearType {
            return None;
        }
        let names = Needs::LinearType.methods().iter().map(|method| method.name);
        let fits = |name: &&str| self.model.fits(&MethodSpec::new(name, None)).is_ok();
        let names: Vec<String> = names.filter(fits).map(|name| format!("`{name}`")).collect();
        (!names.is_empty()).then(|| {
            format!(
                "; or take one of {}, whose steps are larger where f depends on t alone, as here",
                names.join(", ")
            )
        })
    }

    /// Is the figure a map?
    pub(super) fn draws_a_map(&self) -> bool {
        matches!(self.scene.problem.figure(&self.scene.computed()), Figure::Map(..))
    }

    /// The field at the end, where the figure is one.
    pub(super) fn field(&self, rows: &RowSample<'_>) -> Vec<Vec<f64>> {
        match rows.ends().filter(|_| self.draws_a_map()) {
            Some([_, (_, row)]) => self.scene.problem.field(&row[self.drawn]),
            None => Vec::new(),
        }
    }

    /// The row at t by the exact solution, where it is known.
    pub(super) fn exact(&self, t: f64) -> Option<Vec<f64>> {
        self.model.exact([self.scene.grid.t_span()[0], t])?.ok()
    }

    /// The distance of the row at t from the exact solution.
    pub(super) fn errors(&self, t: f64, row: Row<'_>) -> Option<BTreeMap<String, f64>> {
        let exact = self.exact(t)?;
        let exact = self.model.schema().row(&exact);
        let distance = |part: &Observable| Measure::Length.distance(&row[part], &exact[part]);
        Some(self.state.iter().map(|part| (part.name.into(), distance(part))).collect())
    }
}

/// What a run did.
#[derive(Default)]
pub(super) struct Done {
    pub(super) failure: Option<String>,
    pub(super) attempts_used_up: bool,
    pub(super) interrupted: bool,
    pub(super) taken: Taken,
    pub(super) points_within: Option<u64>,
    /// The warning about zeros of events that may be missed.
    pub(super) unsure: Option<String>,
    pub(super) chosen: Option<Chosen>,
    /// The event that ended the run.
    pub(super) ended_by: Option<String>,
    /// The time at the end, where no step failed.
    pub(super) t: Option<f64>,
}

/// Zeros of an event that are drawn.
const MARKS: usize = 200;

/// What is kept of a run as it goes, in memory and on disk.
pub(super) struct Recorder<'a> {
    watch: &'a Watch<'a>,
    folder: PathBuf,
    pub(super) trajectory: RowFile,
    pub(super) events: Option<RowFile>,
    /// None while an earlier part of the run is shown again.
    pub(super) state: Option<RunState>,
    room: Room,
    pub(super) rows: RowSample<'a>,
    pub(super) watched: Vec<Watched>,
    /// The number of the rows where a column is not finite, and the time of the first.
    pub(super) not_finite: Vec<(u64, f64)>,
    pub(super) seen: Vec<EventSummary>,
    /// What the rows say of each event.
    pub(super) between: Vec<Between>,
    singular: Vec<Singular<'a>>,
    /// When turns of values that are followed may have been lost first; NaN: never.
    lost_at: f64,
    line: Vec<f64>,
    pub(super) overflow: Option<String>,
    /// What could not be written: it ends the run.
    pub(super) failure: Option<CliError>,
    /// What a signal raises.
    stop: &'a AtomicBool,
    /// What ends this run, and no other.
    cancel: &'a AtomicBool,
    pub(super) bar: Progress,
}

impl<'a> Recorder<'a> {
    /// Files in `folder`, in place of those of earlier runs, and what they may take. `stop` ends all runs, and
    /// `cancel` this one.
    pub(super) fn new(
        watch: &'a Watch<'a>,
        (folder, room): (&Path, Room),
        columns: &[String],
        [stop, cancel]: [&'a AtomicBool; 2],
    ) -> Result<Self, CliError> {
        let events = &watch.scene.events;
        let columns = || core::iter::once("t").chain(columns.iter().map(String::as_str));
        output::remove_old(&folder.join(output::EVENTS[1]))?;
        let schema = watch.model.schema();
        let between = events.iter().map(|event| Ok(Between::new(event, event.plan(schema)?.value)));
        let with_events = (!events.is_empty()).then(|| {
            RowFile::create(folder, output::EVENTS, core::iter::once("name").chain(columns()))
        });
        Ok(Recorder {
            folder: folder.into(),
            between: between.collect::<Result<_, Error>>()?,
            trajectory: RowFile::create(folder, output::TRAJECTORY, columns())?,
            events: with_events.transpose()?,
            state: None,
            room,
            rows: RowSample::new(watch.model.schema()),
            watched: Vec::new(),
            not_finite: vec![(0, 0.0); columns().count() - 1],
            seen: events.iter().map(|event| EventSummary::new(&event.name)).collect(),
            lost_at: f64::NAN,
            singular: watch.computed.iter().filter_map(|angles| Singular::of(angles)).collect(),
            line: Vec::new(),
            overflow: None,
            failure: None,
            bar: Progress::after_a_second(),
            watch,
            stop,
            cancel,
        })
    }

    /// What is shown now, or was shown by an earlier part of the run.
    pub(super) fn see(&mut self, kind: Kind, t: f64, row: Row<'_>) -> Result<(), CliError> {
        self.line.clear();
        self.watch.line(row, &mut self.line);
        match kind {
            Kind::Row => {
                let without_value = |(_, x): &(_, &f64)| !x.is_finite();
                let columns = self.not_finite.iter_mut().zip(&self.line);
                for ((count, first), _) in columns.filter(without_value) {
                    *first = if *count == 0 { t } else { *first };
                    *count += 1;
                }
                for (between, seen) in self.between.iter_mut().zip(&self.seen) {
                    between.see(t, row, seen.count);
                }
                self.watch.see(t, row, &mut self.watched);
                self.rows.see(t, row);
                self.trajectory.row(None, t, &self.line)?;
            }
            Kind::Event(event) => {
                if let (Some(seen), Some(file)) = (self.seen.get_mut(event), &mut self.events) {
                    seen.see(t, MARKS);
                    self.between[event].see_zero(t, seen.count);
                    file.row(Some(&seen.name), t, &self.line)?;
                }
            }
        }
        if let Some(state) = &mut self.state {
            state.record(kind, t, row.numbers())?;
        }
        self.room.check(self.bytes())
    }

    /// Calls `each` with the numbers that the rows alone do not bring back, because they were seen between rows.
    fn each_unshown(&mut self, each: &mut dyn FnMut(&mut f64)) {
        each(&mut self.lost_at);
        self.singular.iter_mut().for_each(|singular| singular.each_unshown(each));
        self.between.iter_mut().for_each(|between| between.each_unshown(each));
        self.watched.iter_mut().for_each(|law| law.each_unshown(each));
    }

    /// Goes on from what an earlier part of the run has seen, once its rows are shown again. At the start that is nothing.
    pub(super) fn go_on_from(&mut self, seen: Seen) {
        let mut seen = seen.into_iter();
        self.each_unshown(&mut |x| *x = seen.next().unwrap_or(*x));
    }

    /// The bytes of all files that grow with the run.
    fn bytes(&self) -> u64 {
        let events = self.events.as_ref().map_or(0, RowFile::bytes);
        let state = self.state.as_ref().map_or(0, RunState::bytes);
        self.trajectory.bytes() + events + state
    }

    /// What is to be known of Euler angles that came to where they are singular, or near.
    pub(super) fn singular_in_words(&self) -> impl Iterator<Item = String> {
        self.singular.iter().flat_map(Singular::in_words)
    }

    /// The warning about turns that may be lost, in quantities that are continuous from row to row.
    pub(super) fn lost_in_words(&self) -> Option<String> {
        let followed = self.watch.computed.iter().filter(|one| one.branch != Branch::Single);
        let names: Vec<&str> = followed.map(|one| one.name).collect();
        (!self.lost_at.is_nan()).then(|| {
            format!(
                "{} may have lost turns since t = {}: the body turns by more than half a turn between two points, and there \
                 are no points between them, or more than 100 000 in a step. Take shorter steps, or times nearer to t = 0",
                names.join(", "),
                output::number(self.lost_at)
            )
        })
    }

    /// Writes the lines so far.
    pub(super) fn flush(&mut self) -> Result<(), CliError> {
        self.trajectory.flush()?;
        self.events.as_mut().map_or(Ok(()), RowFile::flush)
    }

    fn has_ended(&self) -> bool {
        self.overflow.is_some() || self.failure.is_some()
    }

    fn keep(&mut self, done: Result<(), CliError>) {
        if let Err(error) = done {
            self.failure.get_or_insert(error);
            self.cancel.store(true, Ordering::Relaxed);
        }
    }

    /// Name the files; what is left is the state of the run.
    pub(super) fn finish(self, complete: bool) -> Result<Option<RunState>, CliError> {
        self.trajectory.finish(complete)?;
        match self.events {
            Some(events) => events.finish(complete)?,
            // Those of an earlier run are of other rows.
            None if complete => output::remove_old(&self.folder.join(output::EVENTS[0]))?,
            None => {}
        }
        Ok(self.state)
    }

    /// Leave nothing of a run that cannot begin.
    pub(super) fn discard(self) {
        self.trajectory.discard();
        self.events.map(RowFile::discard).unwrap_or_default();
        let _ = self.state.map(RunState::finish);
    }
}

impl Watcher for Recorder<'_> {
    fn row(&mut self, t: f64, row: Row<'_>) -> Next {
        self.overflow = self.overflow.take().or_else(|| self.watch.overflow(t, row));
        if !self.has_ended() {
            let done = self.see(Kind::Row, t, row);
            self.keep(done);
        }
        if self.has_ended() { Next::Stop } else { Next::Continue }
    }

    fn event(&mut self, event: usize, t: f64, _rising: bool, row: Row<'_>) {
        if !self.has_ended() {
            let done = self.see(Kind::Event(event), t, row);
            self.keep(done);
        }
    }

    fn end_of_step(&mut self, t: f64, row: Row<'_>) {
        self.watch.see_end_of_step(row, &mut self.watched);
        self.between.iter_mut().for_each(|between| between.see_end_of_step(t, row));
    }

    fn followed(&mut self, t: f64, row: Row<'_>, is_sure: bool) {
        if !is_sure && self.lost_at.is_nan() {
            self.lost_at = t;
        }
        self.singular.iter_mut().for_each(|singular| singular.see(t, row));
    }

    fn progress(&mut self, t: f64) {
        if self.stop.load(Ordering::Relaxed) {
            self.cancel.store(true, Ordering::Relaxed);
        }
        let [t0, t1] = self.watch.scene.grid.t_span();
        self.bar.often((t - t0) / (t1 - t0), || format!("t = {t:.6}"));
    }

    fn state(&mut self, bytes: &[u8]) {
        if !self.has_ended() {
            let done = self.flush();
            let mut seen = Seen::new();
            self.each_unshown(&mut |x| seen.push(*x));
            let done = done.and_then(|()| match &mut self.state {
                Some(state) => state.save(&seen, bytes),
                None => Ok(()),
            });
            self.keep(done);
        }
    }
}
