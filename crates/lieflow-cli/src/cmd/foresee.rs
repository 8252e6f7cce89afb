//! Runs that would take too long, seen before they begin.

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use lieflow::solve::Status;
use lieflow::{RunError, SaveAt, StepControl, TimeGrid};
use lieflow_model::problem::{Model, Plan, Rows, Steps};
use lieflow_model::reader::Refusal;
use lieflow_model::scene::Scene;

use crate::error::CliError;
use crate::output::{duration, number};
use lieflow_figures::number::typed;

/// A run of more steps of one size is timed before it begins.
const MANY: u64 = 10_000_000;
/// Steps are timed for this long.
const TRIAL: Duration = Duration::from_millis(20);
/// A longer run is refused without `--yes`, in seconds.
const LONGEST: f64 = 86400.0;
/// A longer run is announced, in seconds.
const LONG: f64 = 60.0;
/// The number of attempts in a trial run with adaptive steps.
const ATTEMPTS: u64 = 1000;
/// Methods of this order and higher ones need no trial run.
const HIGH_ORDER: usize = 4;

/// The warning about a run that will take long. `stop` ends the trial of it.
///
/// # Errors
/// A run that would take more than a day, unless `any_length` is meant.
pub(super) fn foresee(
    scene: &Scene,
    model: &Model,
    any_length: bool,
    stop: &AtomicBool,
) -> Result<Option<String>, CliError> {
    let may_end_early = scene.events.iter().any(|event| event.stop_after.is_some());
    if may_end_early || !scene.grid.t_span()[1].is_finite() {
        return Ok(None);
    }
    match scene.adaptive {
        None => steps_of_one_size(scene, model, any_length, stop),
        Some(_) => Ok(chosen_steps(scene, model, stop)),
    }
}

fn steps_of_one_size(
    scene: &Scene,
    model: &Model,
    any_length: bool,
    stop: &AtomicBool,
) -> Result<Option<String>, CliError> {
    let (steps, h, [t0, _]) = (scene.grid.steps(), scene.grid.h(), scene.grid.t_span());
    if steps < MANY {
        return Ok(None);
    }
    let mut trial = 1;
    let seconds = loop {
        let Ok(grid) = TimeGrid::new([t0, t0 + trial as f64 * h], h.abs()) else { return Ok(None) };
        let plan = Plan { cancel: Some(stop), ..Plan::new(Steps::Equal(grid), SaveAt::End) };
        let clock = Instant::now();
        match model.drive(&scene.method, plan, &mut Rows(&mut |_, _| {})) {
            Ok(outcome) if outcome.status == Status::Finished => {}
            _ => return Ok(None),
        }
        let took = clock.elapsed();
        if took > TRIAL || trial >= MANY / 8 {
            break took.as_secs_f64() / trial as f64 * steps as f64;
        }
        trial *= 8;
    };
    let would = format!("{} steps would take about {}", number(steps as f64), duration(seconds));
    if seconds > LONGEST && !any_length {
        let message = format!("dt = {}: {would}. More than a day needs --yes", number(h.abs()));
        let help =
            Some("take a larger step, or leave it out: lieflow then chooses the steps".into());
        let refusal = Refusal { help, ..Refusal::at("dt", message) };
        return Err(scene.refuse("time", refusal).into());
    }
    Ok((seconds > LONG).then_some(would))
}

fn chosen_steps(scene: &Scene, model: &Model, stop: &AtomicBool) -> Option<String> {
    let [t0, t1] = scene.grid.t_span();
    let order = model.order(&scene.method).ok()??;
    if order >= HIGH_ORDER {
        return None;
    }
    let plan = scene.plan_to(t1, 1.0, None).ok()?;
    let plan = Plan { max_steps: Some(ATTEMPTS), cancel: Some(stop), ..plan };
    let tried = model.drive(&scene.method, plan, &mut Rows(&mut |_, _| {}));
    let Err(RunError::TooManySteps { t, .. }) = tried else { return None };
    let limit = scene.max_steps.unwrap_or(StepControl::MAX_STEPS);
    let needed = ATTEMPTS as f64 * (t1 - t0) / (t - t0);
    (needed > limit as f64).then(|| {
        format!(
            "about {} steps are needed, and the run ends after {} (max_steps): {} has order {order}. \
             Take a method of a higher order or a larger tolerance, or leave [method] out",
            typed(needed, 1),
            number(limit as f64),
            scene.method.label()
        )
    })
}
