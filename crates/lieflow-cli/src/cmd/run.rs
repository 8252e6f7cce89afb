//! `lieflow run`: one scene, one trajectory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use lieflow::RunError;

use super::CliError;
use crate::args::RunArgs;
use crate::output::{
    self, Chosen, Drift, MethodSummary, Progress, RowSample, SUMMARY, Summary, Trajectory, Watched,
};
use lieflow_model::kinds::Figure;
use lieflow_model::model::{Model, Outcome, Plan, Rows, Watcher};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Observable, Row};

/// Run the command.
///
/// # Errors
/// The scene cannot be used, a file cannot be written, or a step failed.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    let scene = Scene::open(&args.scene)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("lieflow-out").join(&scene.name),
    };
    let summary = run_scene(&scene, &folder)?;
    match summary.failure {
        None => output::print(&in_words(&summary, &folder)),
        Some(failure) => Err(CliError::Message(format!(
            "{failure}\nThe rows up to there ({}) are in {}",
            summary.rows,
            folder.join(summary.trajectory).display()
        ))),
    }
}

/// The quantities of a run: those that the scene names first, then the state, the invariants and the one
/// that is drawn.
fn quantities(scene: &Scene) -> Vec<&str> {
    let problem = &scene.problem;
    let mut all: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let further = [problem.state(&all), &problem.invariants(&all), &[problem.figure().quantity()]];
    for name in further.concat() {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

/// Everything that a run is watched for: what is written, what says how good it is, what is drawn.
struct Watch<'a> {
    scene: &'a Scene,
    model: &'a dyn Model,
    written: Vec<&'a Observable>,
    state: Vec<&'a Observable>,
    laws: Vec<&'a Observable>,
    drawn: &'a Observable,
}

impl<'a> Watch<'a> {
    /// `model` has the [`quantities`] of the scene.
    fn new(scene: &'a Scene, model: &'a dyn Model) -> Result<Self, CliError> {
        let (problem, schema) = (&scene.problem, model.schema());
        let written: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
        let find = |names: &[&str]| -> Result<Vec<_>, _> {
            names.iter().map(|name| schema.get(name)).collect()
        };
        Ok(Watch {
            scene,
            model,
            state: find(problem.state(&written))?,
            laws: find(&problem.invariants(&written))?,
            drawn: schema.get(problem.figure().quantity())?,
            written: find(&written)?,
        })
    }

    /// The values that are written of a row go to the end of `line`.
    fn line(&self, row: Row<'_>, line: &mut Vec<f64>) {
        self.written.iter().for_each(|observable| line.extend_from_slice(&row[observable]));
    }

    /// The invariants of the next row, each in its turn.
    fn see(&self, t: f64, row: Row<'_>, watched: &mut Vec<Watched>) {
        let values = self
            .laws
            .iter()
            .flat_map(|law| row[law].iter().enumerate().map(move |(i, x)| (*x, row.size(law, i))));
        if watched.is_empty() {
            watched.extend(values.map(|(x, size)| Watched::new(t, x, size)));
        } else {
            watched.iter_mut().zip(values).for_each(|(watched, (x, size))| watched.see(t, x, size));
        }
    }

    /// What ends the run here: a state of the row that is not finite.
    fn overflow(&self, t: f64, row: Row<'_>) -> Option<String> {
        let states = self.written.iter().filter(|part| part.is_state);
        let mut numbers = states.flat_map(|part| part.columns.iter().zip(&row[*part]));
        let (column, x) = numbers.find(|(_, x)| !x.is_finite())?;
        Some(format!("the state is out of the range of numbers at t = {t}: {column} is {x}"))
    }

    /// The drift of each invariant, by column.
    fn drift(&self, watched: &[Watched], steps: u64) -> Result<BTreeMap<String, Drift>, CliError> {
        let method = self.scene.method.info()?;
        let columns = self.laws.iter().flat_map(|law| {
            law.columns.iter().map(|column| (column.clone(), law.promised_by(method)))
        });
        let drifts = columns.zip(watched);
        Ok(drifts.map(|((name, promised), w)| (name, w.drift(promised, steps))).collect())
    }

    /// Run the scene. A step that fails is an end, not an error.
    fn run(&self, watcher: &mut dyn Watcher) -> Result<Done, CliError> {
        let scene = self.scene;
        let plan = Plan::new(scene.steps(), scene.save.clone());
        match self.model.drive(&scene.method, plan, watcher) {
            Ok(Outcome { stats, .. }) => Ok(Done {
                steps: stats.accepted,
                points_within: Some(stats.points_within),
                chosen: scene.adaptive.is_some().then_some(Chosen {
                    accepted: stats.accepted,
                    rejected: stats.rejected,
                    evaluations: stats.evaluations,
                    smallest_step: stats.smallest_step,
                    largest_step: stats.largest_step,
                }),
                failure: None,
            }),
            Err(RunError::Setup(error)) => Err(error.into()),
            Err(error) => Ok(Done::stopped(&error, error.accepted().unwrap_or(0))),
        }
    }

    /// The field at the end, where the figure is one.
    fn field(&self, rows: &RowSample<'_>) -> Vec<Vec<f64>> {
        match (self.scene.problem.figure(), rows.ends()) {
            (Figure::Map(..), Some([_, (_, row)])) => self.scene.problem.field(&row[self.drawn]),
            _ => Vec::new(),
        }
    }

    /// The distance from the exact solution at the end of the span.
    fn errors(&self, last: Row<'_>) -> Option<BTreeMap<String, f64>> {
        let exact = self.model.exact(self.scene.grid.t_span())?.ok()?;
        let exact = self.model.schema().row(&exact);
        let distance = |part: &Observable| {
            let pairs = last[part].iter().zip(&exact[part]);
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        Some(self.state.iter().map(|part| (part.name.into(), distance(part))).collect())
    }
}

/// What a run did.
#[derive(Default)]
struct Done {
    failure: Option<String>,
    steps: u64,
    points_within: Option<u64>,
    chosen: Option<Chosen>,
}

impl Done {
    fn stopped(failure: &impl ToString, steps: u64) -> Self {
        Done { failure: Some(failure.to_string()), steps, ..Done::default() }
    }
}

/// Run a scene and write its trajectory and summary into a folder. A step that fails is no error
/// here: the summary says so, and the rows up to there are kept.
///
/// # Errors
/// The scene does not run at all, or a file cannot be written.
pub fn run_scene(scene: &Scene, folder: &Path) -> Result<Summary, CliError> {
    let model = scene.model_with(scene.layer, &quantities(scene))?;
    let watch = Watch::new(scene, &*model)?;
    let columns: Vec<String> = watch.written.iter().flat_map(|o| o.columns.clone()).collect();
    output::make_folder(folder)?;
    let summary_path: PathBuf = folder.join(SUMMARY);
    output::remove_old(&summary_path)?;
    let mut trajectory = Trajectory::create(folder, &columns)?;

    let [t0, t1] = scene.grid.t_span();
    let bar = Progress::new();
    let mut rows = RowSample::new(model.schema());
    let (mut line, mut watched) = (Vec::new(), Vec::new());
    let mut not_finite = vec![0u64; columns.len()];
    let clock = Instant::now();
    let mut overflow = None;
    let outcome = watch.run(&mut Rows(&mut |t, row| {
        overflow = overflow.take().or_else(|| watch.overflow(t, row));
        if overflow.is_some() {
            return;
        }
        line.clear();
        watch.line(row, &mut line);
        trajectory.row(t, &line);
        for (count, x) in not_finite.iter_mut().zip(&line) {
            *count += u64::from(!x.is_finite());
        }
        watch.see(t, row, &mut watched);
        rows.see(t, row);
        bar.at((t - t0) / (t1 - t0));
    }));
    drop(bar);
    let written = trajectory.rows();
    let mut done = match outcome {
        Ok(done) => done,
        Err(error) => {
            trajectory.discard();
            return Err(error);
        }
    };
    done.failure = overflow.or(done.failure);
    let completed = done.failure.is_none();
    trajectory.finish(completed)?;
    let wall_time_s = clock.elapsed().as_secs_f64();

    let with_time = |(t, row)| {
        let mut line = vec![t];
        watch.line(row, &mut line);
        line
    };
    let [initial, last] = rows.ends().map_or_else(Default::default, |ends| ends.map(with_time));
    let end = rows.ends().filter(|_| completed);
    let drift = watch.drift(&watched, done.steps)?;
    let mut warnings = scene.problem.warnings();
    warnings.extend(drift.iter().filter(|(_, drift)| drift.breaks_a_promise()).map(broken_promise));
    let out_of_range = columns.iter().zip(&not_finite).filter(|(_, count)| **count > 0);
    warnings.extend(out_of_range.map(|(column, count)| {
        format!("{column} is not a finite number in {count} of {written} rows")
    }));
    let method = &scene.method;
    let summary = Summary {
        lieflow: env!("CARGO_PKG_VERSION"),
        title: scene.title.clone(),
        scene: scene.name.clone(),
        problem: scene.problem.kind().name,
        completed,
        failure: done.failure,
        method: MethodSummary {
            name: method.name.clone(),
            label: method.label(),
            map: method.map.clone(),
            tableau: method.tableau.clone(),
            q: method.q,
            order: model.order(method)?,
        },
        layer: scene.layer.name(),
        modelled: model.modelled(method),
        facts: scene.problem.facts().iter().map(|fact| (fact.name, fact.value)).collect(),
        warnings,
        quantities: scene.quantities.clone(),
        columns: core::iter::once("t".into()).chain(columns).collect(),
        trajectory: if completed { output::COMPLETE } else { output::PARTIAL },
        t_span: [t0, t1],
        dt: scene.adaptive.is_none().then(|| scene.grid.h().abs()),
        steps: done.steps,
        adaptive: done.chosen,
        side_steps: done.points_within,
        rows: written,
        wall_time_s,
        initial,
        last,
        drift_computed_at: "written rows",
        drift,
        error_at_end: end.and_then(|[_, (_, row)]| watch.errors(row)),
    };
    output::write_file(&summary_path, &output::to_json(&summary)?)?;
    let figure = (scene.problem.figure(), watch.field(&rows));
    let page = output::run_page(&summary, &rows, figure, watch.drawn, &watch.written, &watch.laws);
    output::write_page(folder, "index.html", &page)?;
    Ok(summary)
}

fn broken_promise((name, drift): (&String, &Drift)) -> String {
    format!(
        "{name} moved by {:.2e}, though the method promises to keep it: rounding explains {:.2e}",
        drift.max, drift.rounding
    )
}

/// Drifts that are told; summary.json has all.
const DRIFTS: usize = 10;

fn in_words(summary: &Summary, folder: &Path) -> String {
    let Summary { title, steps, rows, wall_time_s, t_span: [t0, t1], .. } = summary;
    let sizes = match (summary.dt, &summary.adaptive) {
        (Some(dt), _) => format!(" of {dt}"),
        (None, Some(chosen)) => format!(
            " of {:.2e} to {:.2e} ({} rejected)",
            chosen.smallest_step, chosen.largest_step, chosen.rejected
        ),
        (None, None) => String::new(),
    };
    let mut text = format!(
        "{title}: {}, {}, {} layer\n  t = {t0} to {t1}, {steps} steps{sizes}, {rows} rows, \
         {wall_time_s:.3} s\n",
        summary.modelled.join(", "),
        summary.method.label,
        summary.layer,
    );
    let mut drifts: Vec<_> = summary.drift.iter().collect();
    if drifts.len() > DRIFTS {
        drifts.sort_by(|(_, a), (_, b)| b.max.total_cmp(&a.max));
    }
    for (name, drift) in drifts.iter().take(DRIFTS) {
        text += &format!(
            "  drift of {name}: {:.2e} at most, {:.2e} at the end, {:.2e} a unit of time, on the \
             written rows\n",
            drift.max, drift.at_end, drift.slope
        );
    }
    if drifts.len() > DRIFTS {
        text += &format!("  {} further drifts are smaller\n", drifts.len() - DRIFTS);
    }
    for (name, error) in summary.error_at_end.iter().flatten() {
        text += &format!("  error of {name} at the end: {error:.2e}\n");
    }
    for (name, value) in &summary.facts {
        text += &format!("  {}: {}\n", name.replace('_', " "), output::in_digits(*value));
    }
    for warning in &summary.warnings {
        text += &format!("  warning: {warning}\n");
    }
    text += &format!("  {}\n", folder.join(summary.trajectory).display());
    text += &format!("  {}\n", folder.join(SUMMARY).display());
    text += &format!("  {}\n", folder.join("index.html").display());
    text
}
