//! The main job: the paper's three experiments on both layers, against the exact solution, with
//! the report of speed against error.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lieflow::SaveAt;
use lieflow::check::Finding;

use super::{CliError, check};
use crate::args::DemoArgs;
use crate::measure::{Candidate, Curve, Effort, Plan, machine, speed_against_error};
use crate::output;
use crate::report::{self, EnergyRun, scientific};
use crate::survey::{self, Study};
use lieflow_figures::page::{Block, Column, Page, Row, Section, Table};
use lieflow_model::kinds::RigidBodySpec;
use lieflow_model::model::Layer;
use lieflow_model::scene::Scene;

/// An experiment of the paper (section 5.2).
struct Experiment {
    /// The bundled scene.
    scene: &'static str,
    /// The span over which speed is set against error; the energy takes the scene's own span.
    window: [f64; 2],
    /// Numbers of steps over the window.
    steps: &'static [u64],
    /// What Table 3 of the paper prints: (map, energy error at the end, mean).
    printed: &'static [(&'static str, f64, f64)],
}

/// The number of steps grows by turns of √2: slopes are seen, and no step is a power of two of
/// another only.
const EXPERIMENTS: [Experiment; 3] = [
    Experiment {
        scene: "asymmetric-top",
        window: [0.0, 20.0],
        steps: &[50, 100, 200, 400, 800, 1600, 3200, 6400, 12800],
        printed: &[],
    },
    Experiment {
        scene: "symmetric-top",
        window: [0.0, 20.0],
        steps: &[50, 100, 200, 400, 800, 1600, 3200, 6400, 12800],
        printed: &[],
    },
    Experiment {
        scene: "high-energy",
        window: [0.0, 4.0],
        steps: &[250, 500, 1000, 2000, 4000, 8000, 16000, 32000],
        printed: &[
            ("exp", 0.0300, 0.0150),
            ("cay", 0.3339, 0.1671),
            ("ccsk123", 0.4204, 0.2094),
            ("ccsk321", 0.0089, 0.0046),
            ("ccsk", 0.2064, 0.1026),
            ("rk4", 0.5863, 0.2958),
        ],
    },
];

const MAPS: [&str; 5] = ["exp", "cay", "ccsk123", "ccsk321", "ccsk"];
/// The attitude is what the paper integrates; the momentum and the energy follow from it.
const QUANTITIES: [&str; 4] = ["momentum_body", "attitude", "energy", "attitude_defect"];

/// The seed of all that is random: the same inputs on every machine.
const SEED: u64 = 2003;

/// What one experiment gave.
struct Outcome {
    scene: Scene,
    window: [f64; 2],
    curves: Vec<Curve>,
    runs: Vec<EnergyRun>,
    /// Largest difference of the final momentum between the layers, relative, by map.
    layers_differ: Vec<(&'static str, f64)>,
    printed: &'static [(&'static str, f64, f64)],
}

/// Run the command.
///
/// # Errors
/// A report that cannot be written.
pub fn run(args: &DemoArgs) -> Result<(), CliError> {
    let clock = Instant::now();
    // A folder that cannot be written is better known before the work than after it.
    output::make_folder(&args.out)?;
    output::print(&format!(
        "lieflow {}: the rigid body of Celledoni & Owren on {}\n",
        env!("CARGO_PKG_VERSION"),
        machine()
    ))?;
    let bar = progress();
    let findings = check::findings(if args.quick { 2_000 } else { 50_000 })?;
    bar.set_position(10);
    let mut outcomes = Vec::new();
    for (i, experiment) in EXPERIMENTS.iter().enumerate() {
        bar.set_message(experiment.scene);
        let share = |done: f64| bar.set_position(10 + (26.0 * (i as f64 + done)) as u64);
        outcomes.push(experiment.run(args.quick, share)?);
    }
    bar.set_message("maps");
    let effort = survey::Effort {
        directions: if args.quick { 6 } else { 20 },
        largest: if args.quick { 12 } else { 32 },
        rounds: if args.quick { 3 } else { 7 },
    };
    let studies =
        survey::survey(&effort, SEED, |done| bar.set_position(90 + (10.0 * done) as u64))?;
    bar.finish_and_clear();

    let maps = report::write_maps(&args.out, &studies)?;
    let page = page(&outcomes, &findings, args.quick, clock.elapsed());
    let path = report::write_page(&args.out, &page)?;
    let rows = outcomes.iter().flat_map(|outcome| {
        let fronts = report::fronts(&outcome.curves);
        let curves = outcome.curves.iter().zip(fronts);
        curves.map(|(curve, front)| (outcome.scene.name.as_str(), curve, front))
    });
    output::write_file(&args.out.join("speed.csv"), &report::speed_csv(rows))?;

    for outcome in &outcomes {
        output::print(&outcome.in_words())?;
    }
    let worst = findings.iter().map(|f| f.worst).fold(0.0, f64::max);
    let broken = findings.iter().filter(|f| !f.holds()).count();
    output::print(&format!(
        "\nGeneral against closed, and the laws of the groups: {} checks, worst {worst:.1} eps·cond\n\
         {}\n\
         The report with its figures: {}\n\
         Accuracy and time of every map: {}\n({:.1} s)\n",
        findings.len(),
        maps_in_words(&studies),
        path.display(),
        maps.display(),
        clock.elapsed().as_secs_f64()
    ))?;
    match broken {
        0 => Ok(()),
        _ => {
            Err(CliError::Failed(format!("{broken} checks are out of bounds; see `lieflow check`")))
        }
    }
}

/// The largest error of the closed forms and of the general layer, over all maps and angles.
fn maps_in_words(studies: &[Study]) -> String {
    let worst = |name: &str| {
        let lines = studies.iter().flat_map(|study| &study.lines).filter(|line| line.name == name);
        lines.filter_map(|line| Some(line.worst()?.error)).fold(0.0, f64::max)
    };
    format!(
        "Maps against 30 digits: closed forms within {:.1} eps·cond, general layer within {:.1}",
        worst("closed form"),
        worst("general layer")
    )
}

fn progress() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(100), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template("{bar:40} {percent:>3}% {msg}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

impl Experiment {
    fn run(&self, quick: bool, share: impl Fn(f64)) -> Result<Outcome, CliError> {
        let scene = Scene::bundled(self.scene)?;
        let mut candidates: Vec<Candidate> = Vec::new();
        for layer in Layer::ALL {
            candidates.extend(MAPS.map(|map| Candidate::rkmk4(map, layer)));
        }
        candidates.push(Candidate::rk4(Layer::Closed));

        let runs = candidates
            .iter()
            .filter(|candidate| candidate.layer == Layer::Closed)
            .map(|candidate| energy_run(&scene, candidate))
            .collect::<Result<Vec<_>, _>>()?;
        share(0.1);
        let layers_differ = MAPS
            .iter()
            .map(|map| Ok((*map, layers_differ(&scene, map)?)))
            .collect::<Result<Vec<_>, CliError>>()?;
        share(0.2);
        let effort = Effort {
            rounds: if quick { 3 } else { 9 },
            longest: Duration::from_millis(if quick { 20 } else { 200 }),
            shortest: Duration::from_micros(if quick { 200 } else { 1000 }),
            wanted: &[],
            patience: Duration::ZERO,
            seed: SEED,
        };
        let steps = if quick { &self.steps[..6] } else { self.steps };
        let plan = Plan {
            quantities: &QUANTITIES,
            candidates: &candidates,
            t_span: self.window,
            steps,
            tolerances: &[],
        };
        let (curves, _) = speed_against_error(&scene, &plan, effort, None, |done| {
            share(0.2 + 0.8 * done);
        })?;
        Ok(Outcome {
            scene,
            window: self.window,
            curves,
            runs,
            layers_differ,
            printed: self.printed,
        })
    }
}

/// The whole span of the scene with its own step.
fn energy_run(scene: &Scene, candidate: &Candidate) -> Result<EnergyRun, CliError> {
    let model = scene.model_with(candidate.layer, &QUANTITIES)?;
    let mut run = EnergyRun {
        candidate: candidate.clone(),
        energy_error: Vec::new(),
        momentum: Vec::new(),
        error: f64::NAN,
        defect: f64::NAN,
    };
    let mut start = f64::NAN;
    let mut last = Vec::new();
    // Columns: m1 m2 m3, g11 … g33, energy, defect.
    model.run(&candidate.method, &scene.grid, &SaveAt::Every(1), &mut |t, row| {
        if start.is_nan() {
            start = row[12];
        }
        run.energy_error.push((t, row[12] - start));
        if run.momentum.len() < 4000 {
            run.momentum.push([row[0], row[1], row[2]]);
        }
        last.clear();
        last.extend_from_slice(row);
    })?;
    if let (Some(exact), Some(&defect)) = (model.exact(scene.grid.t_span()), last.last()) {
        let exact = exact?;
        run.error = distance(&last[3..12], &exact[3..12]) / 3f64.sqrt();
        run.defect = defect;
    }
    Ok(run)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The relative difference of the momentum at the end of the scene's span between the layers.
fn layers_differ(scene: &Scene, map: &str) -> Result<f64, CliError> {
    let mut ends = Vec::new();
    for layer in Layer::ALL {
        let candidate = Candidate::rkmk4(map, layer);
        let model = scene.model_with(layer, &["momentum_body"])?;
        let mut last = [0.0; 3];
        model.run(&candidate.method, &scene.grid, &SaveAt::Ends, &mut |_, row| {
            last.copy_from_slice(row);
        })?;
        ends.push(last);
    }
    let size = distance(&ends[0], &[0.0; 3]);
    Ok(distance(&ends[0], &ends[1]) / if size > 0.0 { size } else { 1.0 })
}

impl Outcome {
    /// The table for a terminal.
    fn in_words(&self) -> String {
        let header = [
            "method",
            "order",
            "a step",
            "to 1e-3",
            "to 1e-6",
            "to 1e-9",
            "energy error",
            "layers differ",
        ];
        let closed = self.curves.iter().filter(|c| c.candidate.layer == Layer::Closed);
        let rows = closed.map(|curve| {
            let run = self.runs.iter().find(|run| run.candidate == curve.candidate);
            let map = curve.candidate.method.map.as_deref();
            let differ = self.layers_differ.iter().find(|(name, _)| Some(*name) == map);
            [
                curve.candidate.label(),
                report::order(curve.measured_order()),
                report::duration(curve.seconds_per_step()),
                report::duration(curve.seconds_to(1e-3)),
                report::duration(curve.seconds_to(1e-6)),
                report::duration(curve.seconds_to(1e-9)),
                scientific(run.map_or(f64::NAN, EnergyRun::energy_at_end)),
                scientific(differ.map_or(f64::NAN, |(_, gap)| *gap)),
            ]
        });
        let [t0, t1] = self.scene.grid.t_span();
        format!(
            "\n{} (times: CPU time per unit of simulated time to a global error at t = {}; \
             energy error and difference of the layers at t = {t1}, from t = {t0} with dt = {})\n{}",
            self.scene.title,
            self.window[1],
            self.scene.grid.h(),
            output::table(header, rows)
        )
    }

    fn section(&self) -> Section {
        let name = &self.scene.name;
        let [t0, t1] = self.scene.grid.t_span();
        let mut blocks = vec![Block::Chart(report::speed_chart(
            &format!("speed-{name}"),
            "Speed against error",
            &format!(
                "Attitude and momentum integrated over t = {} … {}; the error is the larger relative \
                 distance of the two from the exact solution. Solid: closed forms on so(3); dashed: \
                 the general matrix layer.",
                self.window[0], self.window[1]
            ),
            &self.curves,
        ))];
        blocks.push(Block::Table(report::speed_table(&self.curves)));
        blocks.push(Block::Chart(report::energy_chart(
            &format!("energy-{name}"),
            "Energy error over time",
            &format!("Closed layer, t = {t0} … {t1}, dt = {}.", self.scene.grid.h()),
            &self.runs,
        )));
        blocks.push(Block::Table(self.energy_table()));
        if let Some(sphere) = self.sphere() {
            blocks.push(Block::Sphere(sphere));
        }
        Section::new(self.scene.title.clone(), blocks)
    }

    fn sphere(&self) -> Option<lieflow_figures::plot::Sphere> {
        let problem: &dyn core::any::Any = &*self.scene.problem;
        let body = problem.downcast_ref::<RigidBodySpec>()?;
        let run = self.runs.first()?;
        let energy = (0..3).map(|i| body.momentum_body[i].powi(2) / (2.0 * body.inertia[i])).sum();
        Some(report::momentum_sphere(
            &format!("sphere-{}", self.scene.name),
            "The momentum on its sphere",
            body.inertia,
            energy,
            &run.momentum,
        ))
    }

    fn energy_table(&self) -> Table {
        let mut columns = vec![
            Column::text("Method"),
            Column::number("E(end) − E(0)"),
            Column::number("max |E − E(0)|"),
            Column::number("mean |E − E(0)|"),
            Column::number("attitude error"),
            Column::number("‖gᵀg − 𝟙‖"),
            Column::number("layers differ"),
        ];
        if !self.printed.is_empty() {
            columns.push(Column::number("paper: end"));
            columns.push(Column::number("paper: mean"));
        }
        let rows = self.runs.iter().map(|run| {
            let method = &run.candidate.method;
            let key = method.map.as_deref().unwrap_or(&method.name);
            let differ = self.layers_differ.iter().find(|(map, _)| *map == key);
            let mut cells = vec![
                run.candidate.label(),
                scientific(run.energy_at_end()),
                scientific(run.energy_max()),
                scientific(run.energy_mean()),
                scientific(run.error),
                scientific(run.defect),
                scientific(differ.map_or(f64::NAN, |(_, gap)| *gap)),
            ];
            if let Some((_, end, mean)) = self.printed.iter().find(|(name, ..)| *name == key) {
                cells.push(format!("{end:.4}"));
                cells.push(format!("{mean:.4}"));
            }
            Row::new(cells)
        });
        let [t0, t1] = self.scene.grid.t_span();
        Table {
            caption: format!(
                "At t = {t1} from t = {t0}, dt = {}. “Layers differ”: relative difference of the \
                 final momentum, momentum-only model, between closed forms and general layer.",
                self.scene.grid.h()
            ),
            columns,
            rows: rows.collect(),
        }
    }
}

fn page(outcomes: &[Outcome], findings: &[Finding], quick: bool, took: Duration) -> Page {
    let worst = findings.iter().map(|f| f.worst).fold(0.0, f64::max);
    let holds = findings.iter().all(Finding::holds);
    let mut facts = vec![
        ("Machine".to_string(), machine()),
        (
            "Times".to_string(),
            format!(
                "CPU time of one thread, medians of {} rounds that visit every method in turn{}",
                if quick { 3 } else { 9 },
                if quick { " (--quick: fewer rounds, less certain)" } else { "" }
            ),
        ),
        (
            "General against closed".to_string(),
            format!(
                "{} checks {}, worst {worst:.1} eps·cond",
                findings.len(),
                if holds { "hold" } else { "do NOT all hold" }
            ),
        ),
        ("Took".to_string(), format!("{:.1} s", took.as_secs_f64())),
    ];
    for outcome in outcomes {
        let speed = |layer: Layer| {
            let of = |c: &&Curve| c.candidate == Candidate::rkmk4("exp", layer);
            outcome.curves.iter().find(of).and_then(Curve::seconds_per_step)
        };
        if let (Some(closed), Some(general)) = (speed(Layer::Closed), speed(Layer::General)) {
            facts.push((
                format!("{}: a step of RKMK4 exp", outcome.scene.title),
                format!(
                    "{} closed, {} general ({})",
                    lieflow_figures::plot::format::seconds(closed),
                    lieflow_figures::plot::format::seconds(general),
                    report::times(general / closed)
                ),
            ));
        }
    }
    let mut sections = vec![Section::new(
        "In short",
        vec![
            Block::text(
                "The free rigid body of the paper, integrated by Runge–Kutta–Munthe-Kaas of order 4 \
                 with each coordinate map — through the closed formulas on so(3) and through the \
                 general matrix layer for any n — and by classical Runge–Kutta, each compared with \
                 the exact solution in Jacobi's elliptic functions.",
            ),
            Block::Facts(facts),
        ],
    )];
    sections.extend(outcomes.iter().map(Outcome::section));
    sections.push(report::agreement(findings));
    sections.push(Section::new(
        "Go on",
        vec![
            Block::Link {
                text: "The maps one by one: accuracy and time over the angle and over n".into(),
                href: report::MAPS_PAGE.into(),
            },
            Block::text(
                "Every figure lies beside this page as an SVG file; speed.csv has every run.",
            ),
            Block::Code(
                "lieflow scenes asymmetric-top > my.toml   # a scene to start from\n\
                 lieflow run my.toml --out results         # trajectory.csv and summary.json\n\
                 lieflow compare my.toml --out results     # speed against error for it\n\
                 lieflow methods                           # what there is to choose from"
                    .into(),
            ),
        ],
    ));
    Page {
        title: "Lie group integrators: speed against error".into(),
        subtitle: "The rigid body experiments of Celledoni & Owren, section 5.2".into(),
        sections,
        footer: format!("lieflow {}", env!("CARGO_PKG_VERSION")),
    }
}
