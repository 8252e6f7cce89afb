//! `lieflow order`: the errors of methods on a scene with steps that are halved, and the orders that they show.

use std::time::Duration;

use serde::Serialize;

use super::stop::listen;
use crate::args::OrderArgs;
use crate::error::CliError;
use crate::measure::{Candidate, Curve, Judge, Reference, Size};
use crate::output::{self, number, print, print_json, table};
use lieflow_figures::number::scientific;
use lieflow_model::scene::Scene;

/// The number of times that the step is halved.
const HALVINGS: u32 = 11;
/// A method whose runs have taken so long takes no smaller steps.
const LONGEST: Duration = Duration::from_secs(2);

/// A measured order that is farther from the order of the method is explained.
const SETTLED: f64 = 0.5;

/// The orders as JSON.
#[derive(Serialize)]
struct Json<'a> {
    scene: &'a str,
    t_span: [f64; 2],
    reference: String,
    reference_error: f64,
    methods: Vec<MethodJson>,
}

/// A method as JSON.
#[derive(Serialize)]
struct MethodJson {
    method: String,
    order: Option<usize>,
    measured_order: Option<f64>,
    runs: Vec<RunJson>,
}

/// A run as JSON.
#[derive(Serialize)]
struct RunJson {
    steps: u64,
    h: f64,
    error: Option<f64>,
    slope: Option<f64>,
    failure: Option<String>,
}

/// Run the command.
///
/// # Errors
/// A scene or a method that cannot be used, or an interruption.
pub fn run(args: &OrderArgs) -> Result<(), CliError> {
    let scene = args.settings.open(&args.scene)?;
    let t_span = scene.grid.t_span();
    if !t_span[1].is_finite() {
        let message = "an order needs a span with an end: t_span of the scene has none";
        return Err(CliError::Message(message.into()));
    }
    let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let all = Candidate::all_that_fit(&scene, &quantities, scene.layer)?;
    let names = match args.methods.is_empty() {
        true => vec![scene.method.label()],
        false => args.methods.clone(),
    };
    let mut candidates = Candidate::chosen(&scene, &quantities, &all, &names)?;
    candidates.retain(|candidate| !candidate.adaptive);

    let stop = listen()?;
    let steps = numbers_of_steps(&scene, args.steps);
    let judge = Judge::new(&scene, &quantities, t_span, &steps, LONGEST, &stop)?;
    let model = scene.model_with(scene.layer, &judge.quantities())?;
    let mut curves = Vec::new();
    for candidate in candidates {
        let order = model.order(&candidate.method)?;
        let label = candidate.method.label();
        let floor = judge.reference.floor();
        let stays = model.orders(&candidate.method)?.stays_on_manifold;
        let mut curve = Curve { candidate, label, order, stays, floor, points: Vec::new() };
        let clock = std::time::Instant::now();
        for &steps in &steps {
            let point = judge.point(&model, &curve.candidate, Size::Steps(steps));
            super::stop::ended(&stop)?;
            curve.points.push(point);
            if clock.elapsed() > LONGEST {
                break;
            }
        }
        curves.push(curve);
    }
    match args.json {
        true => print_json(&json(&scene, &curves, &judge.reference)),
        false => print(&in_words(&scene, &curves, &judge.reference)),
    }
}

/// The first number, and its doubles. The first is that which was asked for, or that of the scene over 16.
fn numbers_of_steps(scene: &Scene, first: Option<u64>) -> Vec<u64> {
    let first = first.unwrap_or_else(|| (scene.grid.steps() / 16).max(1));
    (0..=HALVINGS).filter_map(|k| first.checked_shl(k)).collect()
}

/// The number of the first run that is rounding. The runs after it, of smaller steps, are too.
fn first_of_rounding(curve: &Curve) -> usize {
    let rounding = 2.0 * curve.rounding();
    let first = curve.points.iter().position(|run| run.error <= rounding);
    first.unwrap_or(curve.points.len())
}

/// The slopes of the runs that are not rounding.
fn slopes(curve: &Curve) -> impl Iterator<Item = Option<f64>> {
    let end = first_of_rounding(curve);
    curve.slopes().into_iter().enumerate().map(move |(i, slope)| slope.filter(|_| i < end))
}

fn json<'a>(scene: &'a Scene, curves: &[Curve], reference: &Reference) -> Json<'a> {
    let methods = curves.iter().map(|curve| {
        let runs = curve.points.iter().zip(slopes(curve)).map(|(point, slope)| RunJson {
            steps: point.steps,
            h: point.h,
            error: Some(point.error).filter(|error| error.is_finite()),
            slope,
            failure: point.failure.clone(),
        });
        MethodJson {
            method: curve.label.clone(),
            order: curve.order,
            measured_order: curve.measured_order(),
            runs: runs.collect(),
        }
    });
    Json {
        scene: &scene.name,
        t_span: scene.grid.t_span(),
        reference: reference.in_words(),
        reference_error: reference.floor(),
        methods: methods.collect(),
    }
}

fn in_words(scene: &Scene, curves: &[Curve], reference: &Reference) -> String {
    let [t0, t1] = scene.grid.t_span();
    let mut text = format!("Errors at t = {t1} on the scene {}, from t = {t0}\n", scene.name);
    text += &output::wrap(
        &format!("The reference: {}.", reference.in_words().trim_end_matches('.')),
        "",
    );
    for curve in curves {
        let order = match (curve.order, curve.measured_order()) {
            (Some(order), Some(found)) if (found - order as f64).abs() > SETTLED => format!(
                "order {order}, measured {found:.2}: the slopes of these runs have not settled at the order"
            ),
            (Some(order), Some(found)) => format!("order {order}, measured {found:.2}"),
            (Some(order), None) => format!(
                "order {order}; it cannot be measured here: no three runs that are clear of rounding have one slope"
            ),
            (None, _) => "exact: it has no order".into(),
        };
        text += &format!("\n{}: {order}\n", curve.label);
        let rounding = first_of_rounding(curve);
        let rows = curve.points.iter().zip(slopes(curve)).enumerate().map(|(i, (point, slope))| {
            let error = match &point.failure {
                Some(_) => "failed".into(),
                None if i >= rounding => scientific(point.error) + ", rounding",
                None => scientific(point.error),
            };
            let slope = slope.map_or(String::new(), |slope| format!("{slope:.2}"));
            [point.steps.to_string(), number(point.h), error, slope]
        });
        text += &table(["steps", "h", "error", "slope"], rows);
        for point in &curve.points {
            if let Some(failure) = &point.failure {
                text += &output::wrap(&format!("{} steps: {failure}.", point.steps), "");
            }
        }
    }
    text
}
