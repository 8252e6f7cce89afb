//! `lieflow run`: one scene, one trajectory.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::accuracy::{Check, Checked, LONG};
use super::foresee::foresee;
use super::room::{MOST, Room, foresee_room};
use super::stop::{INTERRUPTED, listen};
use super::told::in_words;
use super::watch::{Recorder, Watch, quantities};
use crate::args::{ErrorCheck, RunArgs, quoted};
use crate::error::CliError;
use crate::output::{self, Drawn, Drift, MethodSummary, RunState, SUMMARY, Summary};
use lieflow_model::problem::Plan;
use lieflow_model::scene::{Scene, SceneEvent};
use lieflow_timing::cpu_seconds;

/// How often the state of a run is saved.
const SAVED_EVERY: Duration = Duration::from_secs(1);

/// The page of a run.
const PAGE: &str = "index.html";

/// How a scene is run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Go on with a run that was interrupted.
    pub resume: bool,
    /// Write no page.
    pub no_page: bool,
    /// When a second run is made to estimate the error.
    pub error_check: ErrorCheck,
    /// The most bytes that a run may write.
    pub most: u64,
    /// Take more than a day.
    pub any_length: bool,
}

impl Default for Options {
    fn default() -> Self {
        let error_check = ErrorCheck::default();
        Options { resume: false, no_page: false, error_check, most: MOST, any_length: false }
    }
}

/// Run the command.
///
/// # Errors
/// A scene cannot be used, a file cannot be written, a step failed, or the run was interrupted.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    let stop = listen()?;
    let opened: Vec<_> = args.scenes.iter().map(|path| args.settings.open(path)).collect();
    refuse_one_folder_for_two(args, &opened)?;
    let (mut failed, mut codes) = (0, Vec::new());
    for (number, (path, scene)) in args.scenes.iter().zip(opened).enumerate() {
        if stop.load(Ordering::Relaxed) {
            let message = format!("interrupted before {}", path.display());
            return Err(CliError::Stopped { message, code: INTERRUPTED });
        }
        match scene
            .map_err(Into::into)
            .and_then(|scene| run_one(args, &args.scenes[number..], &scene, &stop))
        {
            Err(error) if args.scenes.len() == 1 || error.exit_code() == INTERRUPTED => {
                return Err(error);
            }
            // The other scenes run all the same.
            Err(error) => {
                failed += 1;
                codes.push(error.exit_code());
                eprintln!("error: {error}");
            }
            Ok(()) => {}
        }
    }
    codes.dedup();
    let message = format!("{failed} of {} scenes failed", args.scenes.len());
    match codes[..] {
        [] => Ok(()),
        [code] => Err(CliError::Stopped { message, code }),
        _ => Err(CliError::Message(message)),
    }
}

/// The folder of a scene.
fn folder_of(args: &RunArgs, scene: &Scene) -> PathBuf {
    match &args.out {
        Some(folder) if args.scenes.len() == 1 => folder.clone(),
        folder => folder.as_deref().unwrap_or(Path::new("lieflow-out")).join(&scene.name),
    }
}

/// Two scenes cannot be written into one folder.
fn refuse_one_folder_for_two<E>(
    args: &RunArgs,
    opened: &[Result<Scene, E>],
) -> Result<(), CliError> {
    let mut taken = BTreeMap::new();
    for (path, scene) in args.scenes.iter().zip(opened) {
        let Ok(scene) = scene else { continue };
        let folder = folder_of(args, scene);
        if let Some(other) = taken.insert(folder.clone(), path) {
            let (a, b, folder) = (other.display(), path.display(), folder.display());
            let message = format!(
                "{a} and {b} have one folder, `{folder}`: run them in two calls with --out"
            );
            return Err(CliError::Message(message));
        }
    }
    Ok(())
}

/// Run one of the scenes: the first of these, which are left.
fn run_one(
    args: &RunArgs,
    left: &[PathBuf],
    scene: &Scene,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let folder = folder_of(args, scene);
    let resume = args.resume && RunState::is_in(&folder);
    if args.resume && !resume {
        match nothing_to_do(scene, &folder) {
            // Others were interrupted before this one began.
            Err(_) if args.scenes.len() > 1 => {
                eprintln!("note: {} begins: it has no interrupted run", scene.name)
            }
            told => return told,
        }
    }
    let options = Options {
        resume,
        no_page: args.no_page,
        error_check: args.error_check,
        most: if args.yes { u64::MAX } else { MOST },
        any_length: args.yes,
    };
    let typed = |yes: bool| {
        let again = RunArgs { yes, ..args.clone() };
        let folder = match &args.out {
            Some(out) if left.len() > 1 => out,
            _ => &folder,
        };
        let paths: Vec<_> = left.iter().map(|path| quoted(&path.display().to_string())).collect();
        let (paths, options) = (paths.join(" "), again.options_typed(folder));
        format!("`lieflow run {paths}{options} --resume`")
    };
    let how = |yes: bool| format!("{} goes on from there", typed(yes));
    let summary = match run_scene(scene, &folder, options, stop) {
        Err(
            error @ (CliError::Io { .. }
            | CliError::Full(_)
            | CliError::TooMuch(_)
            | CliError::Stopped { .. }),
        ) if RunState::is_in(&folder) => {
            let yes = args.yes || matches!(error, CliError::TooMuch(_));
            let message = format!("{error}\nWhat was written is kept; {}", how(yes));
            return Err(CliError::Stopped { message, code: error.exit_code() });
        }
        done => done?,
    };
    let Some(failure) = &summary.failure else {
        let page = (!args.no_page).then_some(PAGE);
        output::print(&in_words(&summary, &folder, page))?;
        return match summary.interrupted {
            true => {
                let how = typed(args.yes);
                let message = format!(
                    "interrupted in the second run, by which the error is estimated\nAll rows are there; {how} makes the \
                     second run"
                );
                Err(CliError::Stopped { message, code: INTERRUPTED })
            }
            false => Ok(()),
        };
    };
    let place = folder.join(summary.trajectory);
    let mut kept = format!("The rows up to there ({}) are in {}", summary.rows, place.display());
    let before = folder.join(output::TRAJECTORY[0]);
    if before.is_file() {
        kept += &format!("; {} is that of a run before", before.display());
    }
    Err(match summary.interrupted {
        true => {
            let message = format!("{failure}\n{kept}; {}", how(args.yes));
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
/// The scene does not run at all, there is no run of it to go on with, a file cannot be written, or what is written is
/// more than it may be.
pub fn run_scene(
    scene: &Scene,
    folder: &Path,
    Options { resume, no_page, error_check, most, any_length }: Options,
    stop: &AtomicBool,
) -> Result<Summary, CliError> {
    let all = quantities(scene);
    let mut model = scene.model_with(scene.layer, &all)?;
    let asked = scene.computed();
    let others: Vec<&str> = all.into_iter().filter(|name| !asked.contains(name)).collect();
    model.follow_from_row_to_row(&others);
    if let Some(known) = foresee(scene, &model, any_length, stop)? {
        eprintln!("note: {}: {known}", scene.name);
    }
    let watch = Watch::new(scene, &model)?;
    let columns: Vec<String> = watch.columns.iter().map(|(name, _)| (*name).into()).collect();
    let plan = scene.plan(model.schema())?;
    if let Some(much) = foresee_room(scene, &plan, (columns.len(), model.schema()), folder, most)? {
        eprintln!("note: {}: {much}", scene.name);
    }
    output::make_folder(folder)?;
    let _lock = output::Lock::of(folder)?;
    let (mut state, seen, driver) = match resume {
        true => RunState::open(folder, scene.fingerprint)?,
        false => (RunState::begin(folder, scene.fingerprint)?, Vec::new(), None),
    };
    let summary_path: PathBuf = folder.join(SUMMARY);
    output::remove_summary(folder)?;
    let (clock, cpu_clock) = (Instant::now(), cpu_seconds());
    let cancel = AtomicBool::new(false);
    let mut kept =
        Recorder::new(&watch, (folder, Room::new(folder, most)), &columns, [stop, &cancel])?;
    if resume {
        let schema = model.schema();
        state.replay(|kind, t, numbers| match stop.load(Ordering::Relaxed) {
            true => {
                let message = "interrupted before the run went on".into();
                Err(CliError::Stopped { message, code: INTERRUPTED })
            }
            false => kept.see(kind, t, schema.row(numbers)),
        })?;
        kept.go_on_from(seen);
    }
    let begun_at = kept.rows.ends().map_or(scene.grid.t_span()[0], |[_, (t, _)]| t);
    kept.state = Some(state);
    let plan =
        Plan { cancel: Some(&cancel), checkpoints: Some(SAVED_EVERY), resume: driver, ..plan };
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
    if let (true, Some(failure), Some([_, (_, row)])) =
        (done.attempts_used_up, &mut done.failure, kept.rows.ends())
    {
        *failure += &larger_atol(scene, watch.largest(row)).unwrap_or_default();
    }
    done.failure = kept.overflow.take().or(done.failure);
    let completed = done.failure.is_none();
    // Whatever happens to the second run, the rows of this one are there.
    kept.flush()?;
    let (wall_time_s, cpu_time) = (clock.elapsed().as_secs_f64(), cpu_seconds() - cpu_clock);

    let rows = &kept.rows;
    let mut checked = Ok(None);
    let end = rows.ends().filter(|_| completed).map(|[_, end]| end);
    if let (Some((t, _)), Some(state)) = (end, &mut kept.state) {
        // Only a part of a resumed run was timed.
        let share = ((t - begun_at) / (t - scene.grid.t_span()[0])).max(1e-3);
        let shown = (state.shown()?, written);
        let check = Check::new(&watch, rows, shown, (t, done.taken, done.ended_by.is_some()), stop);
        kept.bar.now(1.0, "a second run, to estimate the error");
        checked = check_errors(&check, scene, error_check, cpu_time / share);
        done.interrupted = !matches!(checked, Ok(None)) && stop.load(Ordering::Relaxed);
    }
    let with_time = |(t, row)| {
        let mut line = vec![t];
        watch.line(row, &mut line);
        line
    };
    let names: Vec<String> = core::iter::once("t".into()).chain(columns.clone()).collect();
    let by_name = |end| names.iter().cloned().zip(with_time(end)).collect();
    let [initial, last] = rows.ends().map_or_else(Default::default, |ends| ends.map(by_name));
    let drift = watch.drift(&kept.watched, done.taken.steps)?;
    let mut warnings = scene.problem.warnings().to_vec();
    warnings.extend(one_long_step(scene));
    warnings.extend(kept.lost_in_words());
    let by_events = kept.between.iter().zip(&scene.events).zip(&kept.seen);
    warnings
        .extend(by_events.clone().filter_map(|((between, _), seen)| between.warning(seen.count)));
    let are_rounding: Vec<bool> =
        by_events.clone().map(|((between, _), seen)| between.is_rounding(seen.count)).collect();
    let is_end = |event: &SceneEvent| done.ended_by.as_ref() == Some(&event.name);
    let mut ends_wrong =
        by_events.clone().any(|((between, event), _)| is_end(event) && between.has_missed());
    let is_any_more = are_rounding.iter().any(|is_rounding| !is_rounding);
    warnings.extend(done.unsure.filter(|_| is_any_more));
    let mut notes = scene.notes();
    let ended = done.ended_by.is_some();
    notes.extend(by_events.filter_map(|((between, event), seen)| {
        between.note(seen, event.stop_after.filter(|_| completed && !ended))
    }));
    notes.extend(kept.singular_in_words());
    let (known, unknown): (Vec<_>, Vec<_>) = drift.iter().partition(|(_, drift)| drift.is_known());
    let known = known.into_iter();
    warnings.extend(unknown.into_iter().map(unknown_drift));
    warnings
        .extend(known.clone().filter(|(_, drift)| drift.breaks_a_promise()).map(broken_promise));
    warnings.extend(known.filter(|(_, drift)| drift.is_of_rows()).map(drift_of_rows));
    let out_of_range = columns.iter().zip(&kept.not_finite).filter(|(_, (count, _))| *count > 0);
    warnings.extend(out_of_range.map(|(column, (count, first))| {
        format!(
            "{column} is not a finite number in {count} of {written} rows, first at t = {first}"
        )
    }));
    let mut events = core::mem::take(&mut kept.seen);
    let (accuracy, accuracy_unknown) = match checked {
        Ok(Some(checked)) => {
            let error = checked.accuracy.relative();
            let numbers = rows.ends().map_or(0.0, |[(_, row), _]| watch.largest(row));
            let gaps: BTreeMap<&String, f64> = watch.law_columns().zip(checked.laws).collect();
            let is_moving = |(name, drift): &(&String, &Drift)| {
                let gap = gaps.get(name).copied().unwrap_or(0.0);
                drift.is_of_the_motion(error, numbers, gap)
            };
            warnings.extend(drift.iter().filter(is_moving).map(no_constant));
            notes.extend(checked.notes);
            let other_zeros = checked.other_zeros.into_iter().zip(&are_rounding);
            warnings.extend(
                other_zeros.filter(|(_, is_rounding)| !**is_rounding).filter_map(|(told, _)| told),
            );
            warnings.extend(checked.warnings);
            let mut zeros = scene.events.iter().zip(checked.wrong_zeros);
            ends_wrong |= zeros.any(|(event, are_wrong)| is_end(event) && are_wrong);
            let times = checked.time_errors.into_iter().zip(&are_rounding);
            for (event, (error, is_rounding)) in events.iter_mut().zip(times) {
                event.time_error = error.filter(|_| event.count > 0 && !is_rounding);
            }
            (Some(checked.accuracy), None)
        }
        Ok(None) => (None, None),
        Err(why) => (None, Some(why)),
    };
    if let (Some(name), true) = (&done.ended_by, ends_wrong) {
        warnings.insert(
            0,
            format!("event {name} ended the run at a wrong zero: this run is not usable"),
        );
    }
    let method = &scene.method;
    let [rtol, atol] = match scene.tolerances() {
        Some(both) => both.map(Some),
        None => [None; 2],
    };
    let mut summary = Summary {
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
        facts: scene.problem.facts().to_vec(),
        warnings,
        notes,
        quantities: scene.quantities.clone(),
        columns: names.clone(),
        units: output::units_of(scene, &watch.written),
        unit_names: scene.units.clone(),
        trajectory: output::TRAJECTORY[usize::from(!completed)],
        figures: Vec::new(),
        t_span: scene.grid.t_span(),
        t_end: done.t,
        ended_by: done.ended_by,
        events,
        dt: scene.adaptive.is_none().then(|| scene.grid.h().abs().min(length(scene))),
        steps: done.taken.steps,
        adaptive: done.chosen,
        side_steps: done.points_within,
        rows: written,
        wall_time_s,
        initial,
        last,
        drift_computed_at: "written rows",
        drift,
        error_at_end: end.and_then(|(t, row)| watch.errors(t, row)),
        accuracy,
        accuracy_unknown,
        chosen_by_default: scene.by_default,
        defaults_in_words: scene.chosen_by_default(),
        rtol,
        atol,
    };
    // The map of a large fluid takes a second, which a run that is interrupted does not have.
    let is_late = summary.interrupted && watch.draws_a_map();
    let page = (!no_page && !is_late).then(|| {
        let drawn = Drawn {
            scene,
            rows,
            figure: watch.drawn,
            field: &watch.field(rows),
            asked: &watch.written,
            watched: &watch.laws,
        };
        output::run_page(&summary, &drawn)
    });
    let state = kept.finish(completed)?;
    if let Some(page) = &page {
        summary.figures = output::write_figures(folder, page)?;
    }
    output::write_file(&summary_path, &output::to_json(&summary)?)?;
    match page {
        Some(page) => output::write_file(&folder.join(PAGE), page.html())?,
        // That of an earlier run shows other rows.
        None => output::remove_old(&folder.join(PAGE))?,
    }
    if !summary.interrupted {
        state.map_or(Ok(()), RunState::finish)?;
    }
    Ok(summary)
}

/// The errors of a run, with a warning if they are large.
///
/// Nothing is returned if no error is asked for, and a sentence if it is not known.
fn check_errors(
    check: &Check<'_>,
    scene: &Scene,
    when: ErrorCheck,
    seconds: f64,
) -> Result<Option<Checked>, String> {
    if !check.is_exact() {
        let never = when == ErrorCheck::Never || !scene.error_check;
        if never && when != ErrorCheck::Always {
            return Ok(None);
        }
        if when != ErrorCheck::Always && seconds > LONG.as_secs_f64() {
            return Err(format!(
                "not known. No exact solution is known, and a second run would take {} or more; \
                 --error-check always makes it",
                output::duration(seconds)
            ));
        }
    }
    let mut checked = check.errors(seconds).map_err(|why| match check.is_exact() {
        true => format!("not known. The comparison with the exact motion did not end: {why}"),
        false => {
            format!("not known. The second run, by which it is estimated, did not end: {why}")
        }
    })?;
    let advise = when != ErrorCheck::Never && scene.error_check;
    let poor = check.warning(&checked.accuracy, advise.then_some(seconds));
    checked.warnings.splice(0..0, checked.accuracy.unknown_in_words().chain(poor));
    Ok(Some(checked))
}

/// The length of the span of a scene.
fn length(scene: &Scene) -> f64 {
    let [t0, t1] = scene.grid.t_span();
    (t1 - t0).abs()
}

/// The warning about a step that is longer than the span.
fn one_long_step(scene: &Scene) -> Option<String> {
    let (dt, length) = (scene.grid.h().abs(), length(scene));
    (scene.adaptive.is_none() && dt > length).then(|| {
        format!(
            "dt = {} is longer than t_span, which is {} long: the run is a single step",
            output::number(dt),
            output::number(length)
        )
    })
}

/// What to set where atol was chosen by a start that is small beside what the numbers became: their rounding is more.
fn larger_atol(scene: &Scene, largest: f64) -> Option<String> {
    let [rtol, atol] = scene.tolerances().filter(|_| scene.by_default.steps)?;
    let rounding = largest * f64::EPSILON;
    (atol < 1e-3 * rtol * largest).then(|| {
        format!(
            "; rtol = {rtol:.0e} and atol = {atol:.0e} were chosen by the start, whose numbers are smaller: take atol = \
             {rounding:.0e}, the rounding of the largest number that was reached"
        )
    })
}

fn drift_of_rows((name, drift): (&String, &Drift)) -> String {
    format!(
        "`{name}` drifted by {} at rows within steps, but by {} at the ends of the steps: the rows are less accurate \
         than the steps. Take shorter steps, or times_by = \"steps\"",
        output::rough(drift.max),
        output::rough(drift.max_at_ends_of_steps.unwrap_or(0.0))
    )
}

fn no_constant((name, drift): (&String, &Drift)) -> String {
    format!(
        "`{name}` moves by {}, {} of its size, and the error of the run does not explain that: it is no constant of this \
         motion. Look at its formula, or at what acts on the motion",
        output::rough(drift.max),
        output::rough(drift.max / drift.size)
    )
}

fn unknown_drift((name, _): (&String, &Drift)) -> String {
    format!(
        "the drift of `{name}` cannot be stated: a value of it, or its size, is not a finite number"
    )
}

fn broken_promise((name, drift): (&String, &Drift)) -> String {
    format!(
        "`{name}` drifted by {}, though the method promises to keep it: rounding explains {}",
        output::rough(drift.max),
        output::rough(drift.rounding)
    )
}
