//! `lieflow run`: one scene, one trajectory.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::CliError;
use super::watch::{Recorder, Watch, quantities};
use crate::args::RunArgs;
use crate::output::{self, Drawn, Drift, MethodSummary, RunState, SUMMARY, Summary};
use lieflow_model::model::Plan;
use lieflow_model::scene::Scene;

/// The exit code of a run that was interrupted.
const INTERRUPTED: u8 = 130;
/// How often the state of a run is saved.
const SAVED_EVERY: Duration = Duration::from_secs(1);

/// Run the command.
///
/// # Errors
/// The scene cannot be used, a file cannot be written, a step failed, or the run was interrupted.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    let scene = Scene::open(&args.scene)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("lieflow-out").join(&scene.name),
    };
    if args.resume && !RunState::is_in(&folder) {
        return nothing_to_do(&scene, &folder);
    }
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // The second signal ends the program at once: it finds that the first was there.
        flag::register_conditional_shutdown(signal, INTERRUPTED.into(), Arc::clone(&stop))
            .and_then(|_| flag::register(signal, Arc::clone(&stop)))
            .map_err(CliError::Signals)?;
    }
    let how = || {
        let out = args.out.as_ref().map(|out| format!(" --out {}", out.display()));
        let (scene, out) = (args.scene.display(), out.unwrap_or_default());
        format!("`lieflow run {scene}{out} --resume` goes on from there")
    };
    let summary = match run_scene(&scene, &folder, args.resume, &stop) {
        Err(error @ CliError::Io { .. }) if RunState::is_in(&folder) => {
            let message = format!("{error}\nWhat was written is kept; {}", how());
            return Err(CliError::Stopped { message, code: error.exit_code() });
        }
        done => done?,
    };
    let Some(failure) = &summary.failure else {
        return output::print(&in_words(&summary, &folder));
    };
    let place = folder.join(summary.trajectory);
    let kept = format!("The rows up to there ({}) are in {}", summary.rows, place.display());
    Err(match summary.interrupted {
        true => {
            let message = format!("{failure}\n{kept}; {}", how());
            CliError::Stopped { message, code: INTERRUPTED }
        }
        false => CliError::Message(format!("{failure}\n{kept}")),
    })
}

/// There is no run to go on with: is it complete?
fn nothing_to_do(scene: &Scene, folder: &Path) -> Result<(), CliError> {
    let text = fs::read_to_string(folder.join(SUMMARY)).unwrap_or_default();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let (name, place) = (&scene.name, folder.display());
    if summary["completed"] == true && summary["fingerprint"] == fingerprint(scene) {
        return output::print(&format!("the run of {name} in `{place}` is complete\n"));
    }
    Err(CliError::Message(format!(
        "there is no interrupted run of {name} in `{place}` to go on with: start it without --resume"
    )))
}

fn fingerprint(scene: &Scene) -> String {
    format!("{:016x}", scene.fingerprint)
}

/// Run a scene and write its trajectory, its events and its summary into a folder; or `resume` a run there that
/// was interrupted, to the same bits. A step that fails is no error here, nor is a run that `stop` ended: the
/// summary says so, and the rows up to there are kept.
///
/// # Errors
/// The scene does not run at all, there is no run of it to go on with, or a file cannot be written.
pub fn run_scene(
    scene: &Scene,
    folder: &Path,
    resume: bool,
    stop: &AtomicBool,
) -> Result<Summary, CliError> {
    let model = scene.model_with(scene.layer, &quantities(scene))?;
    let watch = Watch::new(scene, &*model)?;
    let columns: Vec<String> = watch.written.iter().flat_map(|o| o.columns.clone()).collect();
    output::make_folder(folder)?;
    let (mut state, driver) = match resume {
        true => RunState::open(folder, scene.fingerprint)?,
        false => (RunState::begin(folder, scene.fingerprint)?, None),
    };
    let summary_path: PathBuf = folder.join(SUMMARY);
    output::remove_old(&summary_path)?;
    let clock = Instant::now();
    let mut kept = Recorder::new(&watch, folder, &columns, stop)?;
    if resume {
        let schema = model.schema();
        state.replay(|kind, t, numbers| kept.see(kind, t, schema.row(numbers)))?;
    }
    kept.state = Some(state);
    let plan = Plan {
        cancel: Some(stop),
        checkpoints: Some(SAVED_EVERY),
        resume: driver,
        ..scene.plan(model.schema())?
    };
    let outcome = watch.run(plan, &mut kept);
    let written = kept.trajectory.rows();
    let mut done = match outcome {
        Ok(done) => done,
        Err(error) => {
            // A saved run stays where it was.
            if !resume {
                kept.discard();
            }
            return Err(error);
        }
    };
    if let Some(error) = kept.failure.take() {
        // What can be written of the lines so far.
        let _ = kept.finish(false);
        return Err(error);
    }
    done.failure = kept.overflow.take().or(done.failure);
    let completed = done.failure.is_none();
    let wall_time_s = clock.elapsed().as_secs_f64();

    let rows = &kept.rows;
    let with_time = |(t, row)| {
        let mut line = vec![t];
        watch.line(row, &mut line);
        line
    };
    let [initial, last] = rows.ends().map_or_else(Default::default, |ends| ends.map(with_time));
    let end = rows.ends().filter(|_| completed);
    let drift = watch.drift(&kept.watched, done.steps)?;
    let mut warnings = scene.problem.warnings();
    warnings.extend(drift.iter().filter(|(_, drift)| drift.breaks_a_promise()).map(broken_promise));
    let out_of_range = columns.iter().zip(&kept.not_finite).filter(|(_, count)| **count > 0);
    warnings.extend(out_of_range.map(|(column, count)| {
        format!("{column} is not a finite number in {count} of {written} rows")
    }));
    let method = &scene.method;
    let summary = Summary {
        lieflow: env!("CARGO_PKG_VERSION"),
        title: scene.title.clone(),
        scene: scene.name.clone(),
        problem: scene.problem.kind().name,
        fingerprint: fingerprint(scene),
        completed,
        interrupted: done.interrupted,
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
        trajectory: output::TRAJECTORY[usize::from(!completed)],
        t_span: scene.grid.t_span(),
        t_end: done.t,
        ended_by: done.ended_by,
        events: core::mem::take(&mut kept.seen),
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
        error_at_end: end.and_then(|[_, (t, row)]| watch.errors(t, row)),
    };
    let field = watch.field(rows);
    let drawn = Drawn {
        scene,
        rows,
        figure: watch.drawn,
        field: &field,
        asked: &watch.written,
        watched: &watch.laws,
    };
    let page = output::run_page(&summary, &drawn);
    let state = kept.finish(completed)?;
    output::write_file(&summary_path, &output::to_json(&summary)?)?;
    output::write_page(folder, "index.html", &page)?;
    if !summary.interrupted {
        state.map_or(Ok(()), RunState::finish)?;
    }
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
    let t1 = summary.t_end.unwrap_or(*t1);
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
    if let Some(name) = &summary.ended_by {
        text += &format!("  ended by event {name}\n");
    }
    for event in &summary.events {
        text += &format!("  event {}: {} times", event.name, event.count);
        if let (Some(first), Some(last)) = (event.first, event.last) {
            text += &format!(", first at t = {first}, last at t = {last}");
        }
        text += "\n";
    }
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
    if !summary.events.is_empty() {
        text += &format!("  {}\n", folder.join(output::EVENTS[0]).display());
    }
    text += &format!("  {}\n", folder.join(SUMMARY).display());
    text += &format!("  {}\n", folder.join("index.html").display());
    text
}
