//! `lieflow run`: one scene, one trajectory.

use core::ops::Range;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use lieflow::RunError;
use lieflow::adaptive::AdaptiveError;

use super::CliError;
use crate::args::RunArgs;
use crate::output::{
    self, Chosen, Drift, Gathered, MethodSummary, Progress, SUMMARY, Shown, Summary, Trajectory,
    Watched,
};
use lieflow_model::kinds::{Figure, Law, SIZE, Scale};
use lieflow_model::model::{Model, Sink, Steps};
use lieflow_model::scene::Scene;

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

/// Everything that a run is watched for: what is written, what says how good it is, what is drawn.
struct Watch<'a> {
    scene: &'a Scene,
    model: Box<dyn Model>,
    state: Vec<Shown>,
    laws: Vec<(Law, Shown)>,
    drawn: Shown,
    asked: Vec<Shown>,
    /// Where quantities are in a row of `model`.
    places: BTreeMap<String, Range<usize>>,
    /// The columns that were asked for: the first ones.
    width: usize,
}

impl<'a> Watch<'a> {
    fn new(scene: &'a Scene) -> Result<Self, CliError> {
        let problem = &scene.problem;
        let asked: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
        let (state, laws) = (problem.state(&asked), problem.invariants(&asked));
        let mut all: Vec<String> = scene.quantities.clone();
        let further = state.iter().copied().chain(laws.iter().map(|law| law.quantity));
        for name in further.chain([problem.figure().quantity()]) {
            if !all.iter().any(|known| known == name) {
                all.push(name.into());
            }
        }
        let in_terms = laws.iter().filter(|law| law.scale == Scale::Terms);
        all.extend(in_terms.map(|law| format!("{}{SIZE}", law.quantity)));

        let (mut shown, mut end) = (Vec::new(), 0);
        for name in &all {
            let columns = problem.columns(name)?;
            let place = end..end + columns.len();
            end = place.end;
            shown.push(Shown { name: name.clone(), place, columns });
        }
        let find = |name: &str| shown.iter().find(|s| s.name == name).cloned();
        let names: Vec<&str> = all.iter().map(String::as_str).collect();
        Ok(Watch {
            scene,
            model: scene.model_with(scene.layer, &names)?,
            state: state.iter().filter_map(|name| find(name)).collect(),
            laws: laws.iter().filter_map(|law| Some((*law, find(law.quantity)?))).collect(),
            drawn: find(problem.figure().quantity()).unwrap_or_else(|| shown[0].clone()),
            width: shown[asked.len() - 1].place.end,
            places: shown.iter().map(|s| (s.name.clone(), s.place.clone())).collect(),
            asked: shown.drain(..asked.len()).collect(),
        })
    }

    /// The size that the rounding of the column `i` of a law is relative to.
    fn size(&self, law: &Law, i: usize, row: &[f64]) -> f64 {
        match law.scale {
            Scale::One => 1.0,
            Scale::Value => row[i].abs(),
            Scale::Terms => {
                let place = self.places.get(&format!("{}{SIZE}", law.quantity));
                place.map_or(f64::NAN, |place| row[place.start])
            }
        }
    }

    /// The invariants of the next row, each in its turn.
    fn see(&self, t: f64, row: &[f64], watched: &mut Vec<Watched>) {
        let first = watched.is_empty();
        let mut next = 0;
        for (law, shown) in &self.laws {
            for i in shown.place.clone() {
                let size = self.size(law, i, row);
                match first {
                    true => watched.push(Watched::new(t, row[i], size)),
                    false => watched[next].see(t, row[i], size),
                }
                next += 1;
            }
        }
    }

    /// The drift of each invariant, by column.
    fn drift(&self, watched: &[Watched], steps: u64) -> Result<BTreeMap<String, Drift>, CliError> {
        let method = self.scene.method.info()?;
        let columns = self.laws.iter().flat_map(|(law, shown)| {
            shown.columns.iter().map(|column| (column.clone(), law.promised_by(method)))
        });
        let drifts = columns.zip(watched);
        Ok(drifts.map(|((name, promised), w)| (name, w.drift(promised, steps))).collect())
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

    /// The field at the end, where the figure is one.
    fn field(&self, rows: &Gathered) -> Vec<Vec<f64>> {
        match (self.scene.problem.figure(), rows.ends()) {
            (Figure::Map(..), Some([_, (_, row)])) => {
                self.scene.problem.field(&row[self.drawn.place.clone()])
            }
            _ => Vec::new(),
        }
    }

    /// The distance from the exact solution at the end of the span.
    fn errors(&self, last: &[f64]) -> Option<BTreeMap<String, f64>> {
        let exact = self.model.exact(self.scene.grid.t_span())?.ok()?;
        let distance = |range: &Range<usize>| {
            let pairs = last.get(range.clone()).into_iter().flatten();
            let pairs = pairs.zip(exact.get(range.clone()).into_iter().flatten());
            pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        Some(self.state.iter().map(|s| (s.name.clone(), distance(&s.place))).collect())
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

/// Run a scene and write its trajectory and summary into a folder. A step that fails is no error
/// here: the summary says so, and the rows up to there are kept.
///
/// # Errors
/// The scene does not run at all, or a file cannot be written.
pub fn run_scene(scene: &Scene, folder: &Path) -> Result<Summary, CliError> {
    let watch = Watch::new(scene)?;
    let columns: Vec<String> = watch.model.columns().drain(..watch.width).collect();
    output::make_folder(folder)?;
    let summary_path: PathBuf = folder.join(SUMMARY);
    output::remove_old(&summary_path)?;
    let mut trajectory = Trajectory::create(folder, &columns)?;

    let [t0, t1] = scene.grid.t_span();
    let bar = Progress::new();
    let mut rows = Gathered::default();
    let mut watched = Vec::new();
    let mut not_finite = vec![0u64; columns.len()];
    let clock = Instant::now();
    let outcome = watch.run(&mut |t, row| {
        trajectory.row(t, &row[..watch.width]);
        for (count, x) in not_finite.iter_mut().zip(row) {
            *count += u64::from(!x.is_finite());
        }
        watch.see(t, row, &mut watched);
        rows.see(t, row);
        bar.at((t - t0) / (t1 - t0));
    });
    drop(bar);
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
        |(t, row): &(f64, Vec<f64>)| [&[*t], row.get(..watch.width).unwrap_or_default()].concat();
    let (initial, last) = rows.ends().map_or_else(Default::default, |[a, b]| (shown(a), shown(b)));
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
            order: watch.model.order(method)?,
        },
        layer: scene.layer.name(),
        modelled: watch.model.modelled(method),
        facts: scene.problem.facts().iter().map(|fact| (fact.name, fact.value)).collect(),
        warnings,
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
    let laws: Vec<Shown> = watch.laws.iter().map(|(_, shown)| shown.clone()).collect();
    let figure = (scene.problem.figure(), watch.field(&rows));
    let page = output::run_page(&summary, &rows, figure, &watch.drawn, &watch.asked, &laws);
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
