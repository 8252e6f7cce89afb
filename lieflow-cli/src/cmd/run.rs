//! `lieflow run`: one scene, one trajectory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lieflow::RunError;
use lieflow::adaptive::AdaptiveError;

use super::CliError;
use crate::args::RunArgs;
use crate::model::{Model, Sink, Steps};
use crate::output::{self, Chosen, Drift, MethodSummary, SUMMARY, Summary, Trajectory};
use crate::scene::Scene;

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

/// Everything that a run is watched for: what is written, what says how good it is.
struct Watch<'a> {
    scene: &'a Scene,
    model: Box<dyn Model>,
    /// Quantities with the place of their columns in a row of `model`.
    state: Vec<(&'static str, core::ops::Range<usize>)>,
    invariants: Vec<(&'static str, usize)>,
    /// Columns that were asked for: the first ones.
    asked: usize,
}

impl<'a> Watch<'a> {
    fn new(scene: &'a Scene) -> Result<Self, CliError> {
        let asked: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
        let (state, invariants) = (scene.problem.state(&asked), scene.problem.invariants(&asked));
        let mut all = asked.clone();
        for &name in state.iter().chain(invariants) {
            if !all.contains(&name) {
                all.push(name);
            }
        }
        let mut places = BTreeMap::new();
        let mut width = 0;
        let mut asked_width = 0;
        for (i, &name) in all.iter().enumerate() {
            let columns = scene.problem.kind().quantity(name)?.columns.len();
            places.insert(name, width..width + columns);
            width += columns;
            if i < asked.len() {
                asked_width = width;
            }
        }
        let place = |name: &'static str| places.get(name).map(|range| (name, range.clone()));
        Ok(Watch {
            scene,
            model: scene.model_with(scene.layer, &all)?,
            state: state.iter().filter_map(|&name| place(name)).collect(),
            invariants: invariants
                .iter()
                .filter_map(|&name| place(name).map(|(name, range)| (name, range.start)))
                .collect(),
            asked: asked_width,
        })
    }

    /// Run the scene. A step that fails is an end, not an error.
    fn run(&self, sink: &mut Sink<'_>) -> Result<Done, CliError> {
        let Scene { method, grid, save, .. } = self.scene;
        match self.scene.adaptive {
            None => match self.model.run(method, grid, save, sink) {
                Ok(stats) => Ok(Done {
                    steps: stats.steps,
                    side_steps: Some(stats.side_steps),
                    ..Done::default()
                }),
                Err(RunError::Step(failure)) => Ok(Done::stopped(&failure, failure.step)),
                Err(error) => Err(error.into()),
            },
            Some(control) => {
                let steps = Steps { t_span: grid.t_span(), control };
                match self.model.adapt(method, &steps, save, sink) {
                    Ok(stats) => Ok(Done {
                        steps: stats.accepted,
                        side_steps: Some(stats.side_steps),
                        chosen: Some(Chosen {
                            accepted: stats.accepted,
                            rejected: stats.rejected,
                            evaluations: stats.evaluations,
                            smallest_step: stats.smallest_step,
                            largest_step: stats.largest_step,
                        }),
                        failure: None,
                    }),
                    Err(AdaptiveError::Setup(error)) => Err(error.into()),
                    Err(error) => {
                        let steps = match &error {
                            AdaptiveError::StepSizeUnderflow { accepted, .. }
                            | AdaptiveError::TooManySteps { accepted, .. } => *accepted,
                            _ => 0,
                        };
                        Ok(Done::stopped(&error, steps))
                    }
                }
            }
        }
    }

    /// The distance from the exact solution at the end of the span.
    fn errors(&self, last: &[f64]) -> Option<BTreeMap<&'static str, f64>> {
        let [t0, t1] = self.scene.grid.t_span();
        let exact = self.model.exact(t1 - t0)?.ok()?;
        let distance = |range: &core::ops::Range<usize>| {
            let pairs = last.get(range.clone()).into_iter().flatten();
            let pairs = pairs.zip(exact.get(range.clone()).into_iter().flatten());
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        Some(self.state.iter().map(|(name, range)| (*name, distance(range))).collect())
    }
}

/// What a run did.
#[derive(Default)]
struct Done {
    failure: Option<String>,
    steps: u64,
    side_steps: Option<u64>,
    chosen: Option<Chosen>,
}

impl Done {
    fn stopped(failure: &impl ToString, steps: u64) -> Self {
        Done { failure: Some(failure.to_string()), steps, ..Done::default() }
    }
}

fn progress(steps: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template("{bar:40} {percent}% {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Run a scene and write its trajectory and summary into a folder. A step that fails is no error
/// here: the summary says so, and the rows up to there are kept.
///
/// # Errors
/// The scene does not run at all, or a file cannot be written.
pub fn run_scene(scene: &Scene, folder: &Path) -> Result<Summary, CliError> {
    let watch = Watch::new(scene)?;
    let columns: Vec<String> = watch.model.columns().drain(..watch.asked).collect();
    output::make_folder(folder)?;
    let summary_path: PathBuf = folder.join(SUMMARY);
    output::remove_old(&summary_path)?;
    let mut trajectory = Trajectory::create(folder, &columns)?;

    let [t0, t1] = scene.grid.t_span();
    let bar = progress(scene.grid.steps());
    let mut rows: Option<[(f64, Vec<f64>); 2]> = None;
    let mut drift: BTreeMap<&'static str, Drift> = BTreeMap::new();
    let clock = Instant::now();
    let outcome = watch.run(&mut |t, row| {
        trajectory.row(t, &row[..watch.asked]);
        for &(name, column) in &watch.invariants {
            drift.entry(name).or_insert_with(|| Drift::from(row[column])).see(row[column]);
        }
        match &mut rows {
            None => rows = Some([(t, row.into()), (t, row.into())]),
            Some([_, (time, last)]) => {
                *time = t;
                last.copy_from_slice(row);
            }
        }
        bar.set_position(((t - t0) / (t1 - t0) * scene.grid.steps() as f64) as u64);
    });
    bar.finish_and_clear();
    let written = trajectory.rows();
    let done = match outcome {
        Ok(done) => done,
        Err(error) => {
            trajectory.discard();
            return Err(error);
        }
    };
    let completed = done.failure.is_none();
    trajectory.finish(completed)?;
    let wall_time_s = clock.elapsed().as_secs_f64();

    let shown =
        |(t, row): &(f64, Vec<f64>)| [&[*t], row.get(..watch.asked).unwrap_or_default()].concat();
    let (initial, last) =
        rows.as_ref().map_or_else(Default::default, |[a, b]| (shown(a), shown(b)));
    let end = rows.as_ref().filter(|_| completed);
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
            order: watch.model.order(method)?,
        },
        layer: scene.layer.name(),
        modelled: watch.model.modelled(method),
        quantities: scene.quantities.clone(),
        columns: core::iter::once("t".into()).chain(columns).collect(),
        trajectory: if completed { output::COMPLETE } else { output::PARTIAL },
        t_span: [t0, t1],
        dt: scene.adaptive.is_none().then(|| scene.grid.h().abs()),
        steps: done.steps,
        adaptive: done.chosen,
        side_steps: done.side_steps,
        rows: written,
        wall_time_s,
        initial,
        last,
        drift_computed_at: "written rows",
        drift,
        error_at_end: end.and_then(|[_, (_, row)]| watch.errors(row)),
    };
    output::write_file(&summary_path, &output::to_json(&summary)?)?;
    Ok(summary)
}

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
    for (name, drift) in &summary.drift {
        text += &format!("  drift of {name}: {:.2e} at most, on the written rows\n", drift.max);
    }
    for (name, error) in summary.error_at_end.iter().flatten() {
        text += &format!("  error of {name} at the end: {error:.2e}\n");
    }
    text += &format!("  {}\n", folder.join(summary.trajectory).display());
    text += &format!("  {}\n", folder.join(SUMMARY).display());
    text
}
