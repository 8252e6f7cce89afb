//! `lieflow compare`: speed against error for one scene, over all methods that fit it.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::CliError;
use crate::args::CompareArgs;
use crate::measure::{Candidate, Curve, Effort, WorkPoint, machine, speed_against_error};
use crate::output;
use crate::page::{Block, Page, Section};
use crate::report;
use crate::scene::Scene;

/// Step sizes are those of the scene times these, from the largest to the smallest.
const FACTORS: [f64; 8] = [8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625];

/// A curve as JSON.
#[derive(Serialize)]
struct CurveJson<'a> {
    method: &'a str,
    map: Option<&'a str>,
    tableau: Option<&'a str>,
    layer: &'static str,
    order: usize,
    measured_order: Option<f64>,
    points: &'a [WorkPoint],
}

/// Run the command.
///
/// # Errors
/// A scene that cannot be used or has no exact solution, or a report that cannot be written.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    let clock = Instant::now();
    let scene = Scene::open(&args.scene)?;
    let folder: PathBuf = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("lieflow-compare").join(&scene.name),
    };
    output::make_folder(&folder)?;
    let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let candidates = Candidate::all_that_fit(&scene, &quantities)?;
    let steps = numbers_of_steps(&scene);
    let effort = Effort {
        rounds: args.repeat.unwrap_or(if args.quick { 3 } else { 7 }),
        longest: Duration::from_millis(if args.quick { 10 } else { 100 }),
        shortest: Duration::from_micros(if args.quick { 100 } else { 500 }),
    };
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
    let bar = match ProgressStyle::with_template("{bar:40} {percent:>3}% {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    };
    let span = scene.grid.t_span();
    let curves =
        speed_against_error(&scene, &quantities, &candidates, span, &steps, effort, |done| {
            bar.set_position((1000.0 * done) as u64)
        })?;
    bar.finish_and_clear();

    let path = report::write_page(&folder, &page(&scene, &curves, &effort))?;
    let rows = curves.iter().map(|curve| (scene.name.as_str(), curve));
    output::write_file(&folder.join("speed.csv"), &report::speed_csv(rows))?;
    let json: Vec<CurveJson<'_>> = curves.iter().map(curve_json).collect();
    output::write_file(&folder.join("speed.json"), &output::to_json(&json)?)?;
    output::print(&in_words(&scene, &curves))?;
    output::print(&format!(
        "\nThe report: {}\n({:.1} s)\n",
        path.display(),
        clock.elapsed().as_secs_f64()
    ))
}

fn numbers_of_steps(scene: &Scene) -> Vec<u64> {
    let mut steps: Vec<u64> = FACTORS
        .iter()
        .map(|factor| ((scene.grid.steps() as f64 / factor).round() as u64).max(1))
        .collect();
    steps.dedup();
    steps
}

fn curve_json(curve: &Curve) -> CurveJson<'_> {
    CurveJson {
        method: &curve.candidate.method.name,
        map: curve.candidate.method.map.as_deref(),
        tableau: curve.candidate.method.tableau.as_deref(),
        layer: curve.candidate.layer.name(),
        order: curve.order,
        measured_order: curve.measured_order(),
        points: &curve.points,
    }
}

fn in_words(scene: &Scene, curves: &[Curve]) -> String {
    let rows = curves.iter().map(|curve| {
        [
            curve.candidate.label(),
            curve.order.to_string(),
            report::order(curve.measured_order()),
            report::duration(curve.seconds_per_step()),
            report::duration(curve.seconds_to(1e-3)),
            report::duration(curve.seconds_to(1e-6)),
            report::duration(curve.seconds_to(1e-9)),
        ]
    });
    let header = ["method", "order", "measured", "a step", "to 1e-3", "to 1e-6", "to 1e-9"];
    format!(
        "{}: CPU time per unit of simulated time to a global error at t = {}\n{}\n{}\n",
        scene.title,
        scene.grid.t_span()[1],
        output::table(header, rows),
        report::speed_table(curves).caption
    )
}

fn page(scene: &Scene, curves: &[Curve], effort: &Effort) -> Page {
    let [t0, t1] = scene.grid.t_span();
    let mut families: Vec<&str> = Vec::new();
    for curve in curves {
        if !families.contains(&curve.candidate.family()) {
            families.push(curve.candidate.family());
        }
    }
    let charts = families.iter().map(|family| {
        Block::Chart(report::speed_chart(
            &format!("speed-{family}"),
            &format!("Speed against error: {family}"),
            "The error is the largest relative distance of a part of the state from the exact \
             solution at the end. Solid: closed forms; dashed: general layer.",
            curves.iter().filter(|curve| curve.candidate.family() == *family),
        ))
    });
    Page {
        title: format!("{}: speed against error", scene.title),
        subtitle: format!("t = {t0} … {t1}, {} methods on this machine", curves.len()),
        sections: vec![
            Section::new(
                "In short",
                vec![
                    Block::Facts(vec![
                        ("Machine".into(), machine()),
                        (
                            "Times".into(),
                            format!(
                                "CPU time of one thread, medians of {} rounds that visit every \
                                 method in turn",
                                effort.rounds
                            ),
                        ),
                        ("Modelled".into(), scene.quantities.join(", ")),
                    ]),
                    Block::Table(report::speed_table(curves)),
                ],
            ),
            Section::new("Figures", charts.collect()),
        ],
        footer: format!("lieflow {}", env!("CARGO_PKG_VERSION")),
    }
}
