//! The main job: the paper's three experiments on both layers, against the exact solution, with the report of
//! speed against error.

mod page;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lieflow::check::Finding;
use lieflow::groups::{LieGroup, So3};
use lieflow::{SaveAt, TimeGrid};
use lieflow_figures::Body;
use lieflow_figures::number::{or_dash, scientific, seconds, sig};
use lieflow_model::problem::Layer;
use lieflow_model::scene::Scene;
use lieflow_paper::energy::EnergyRun;
use lieflow_paper::experiments::{EXPERIMENTS, Experiment, SEED};
use lieflow_paper::maps::{self, MAPS_FILE, MAPS_PAGE, Study};
use lieflow_paper::methods::PaperMethod;

use crate::error::CliError;
use crate::measure::{Candidate, Curve, Effort, NEVER, Plan, Rows, checks, speed_against_error};
use crate::output;
use crate::report;

/// RKMK4 with each map. Classical Runge–Kutta, on the closed layer alone, comes after them.
const MAPS: [PaperMethod; 5] = [
    PaperMethod::Exp,
    PaperMethod::Cay,
    PaperMethod::Ccsk123,
    PaperMethod::Ccsk321,
    PaperMethod::Ccsk,
];

/// The attitude is what the paper integrates; the momentum and the energy follow from it.
const QUANTITIES: [&str; 4] = ["momentum_body", "attitude", "energy", "attitude_defect"];

/// A row on a layer, as the catalog names it.
fn candidate(row: PaperMethod, layer: Layer) -> Candidate {
    match row {
        PaperMethod::Rk4 => Candidate::rk4(layer),
        _ => Candidate::rkmk4(row.key(), layer),
    }
}

/// What the main job shows.
#[derive(Debug)]
pub struct Speed {
    outcomes: Vec<Outcome>,
    findings: Vec<Finding>,
    studies: Vec<Study>,
    /// A body that turns over and over.
    body: Option<Body>,
    quick: bool,
    took: Duration,
}

/// What one experiment gave.
#[derive(Debug)]
struct Outcome {
    experiment: Experiment,
    title: String,
    curves: Vec<Curve>,
    /// On the closed layer, by row.
    runs: Vec<LongRun>,
}

/// A row on the closed layer over the whole span of the energy runs.
#[derive(Debug)]
struct LongRun {
    label: String,
    energy: EnergyRun,
    /// Difference of the final momentum between the layers, relative; not a number for RK4.
    layers_differ: f64,
}

impl Speed {
    /// Compute everything. `tick` gets the share of the work that is done and what is under way.
    pub fn compute(quick: bool, mut tick: impl FnMut(f64, &str)) -> Result<Self, CliError> {
        let clock = Instant::now();
        tick(0.0, "");
        let groups = checks(if quick { 2_000 } else { 50_000 })?;
        let findings = groups.into_iter().flat_map(|(_, findings)| findings).collect();
        let mut outcomes = Vec::new();
        for (i, experiment) in EXPERIMENTS.into_iter().enumerate() {
            let share = |done: f64| tick(0.1 + 0.26 * (i as f64 + done), experiment.scene);
            outcomes.push(Outcome::of(experiment, quick, share)?);
        }
        let effort = maps::StudyExtent {
            directions: if quick { 6 } else { 20 },
            largest: if quick { 12 } else { 32 },
            rounds: if quick { 3 } else { 7 },
        };
        let studies = maps::survey(&effort, SEED, |done| tick(0.9 + 0.1 * done, "maps"))?;
        let body = output::moving_body(&Scene::bundled("wing-nut")?)?;
        Ok(Speed { outcomes, findings, studies, body, quick, took: clock.elapsed() })
    }

    /// Write the pages, their figures as SVG and the data as CSV; the paths of the two pages.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<[PathBuf; 2], CliError> {
        output::write_file(&folder.join(MAPS_FILE), maps::points(&self.studies))?;
        let maps = output::write_page(folder, MAPS_PAGE, &maps::page(&self.studies))?;
        let page = output::write_page(folder, "index.html", &self.page())?;
        let curves = self.outcomes.iter().map(|o| (o.experiment.scene, &o.curves[..]));
        report::write_speed_csv(&folder.join("speed.csv"), curves)?;
        Ok([page, maps])
    }

    /// The number of checks that do not hold.
    pub fn broken(&self) -> usize {
        self.findings.iter().filter(|f| !f.holds()).count()
    }

    /// The largest difference that a check found.
    fn worst(&self) -> f64 {
        self.findings.iter().map(|f| f.worst).fold(0.0, f64::max)
    }

    /// The first result, in a paragraph.
    fn result(&self) -> String {
        let Some(outcome) = self.outcomes.first() else { return String::new() };
        let steps = (Experiment::END / outcome.experiment.dt).round();
        let defect = |of_group: bool| sig(outcome.defect(of_group), 2);
        format!(
            "After {steps} steps, what classical Runge–Kutta (rk4) computes is no rotation any more: it is {} away \
             from one. The Lie group methods are {} away, which is rounding, and stay there.",
            defect(false),
            defect(true)
        )
    }

    /// The text for a terminal.
    pub fn in_words(&self) -> String {
        let mut text = format!("\n{}", output::wrap(&self.result(), ""));
        text += "\nThe tables have the CPU time that one unit of simulated time takes, to a relative error of \
                 1e-3,\n1e-6 and 1e-9, and how far the energy is from its start after a long run.\n";
        text.extend(self.outcomes.iter().map(Outcome::in_words));
        // The largest error over all maps and angles.
        let maps = |name: &str| {
            let lines = self.studies.iter().flat_map(|study| &study.lines);
            let lines = lines.filter(|line| line.name == name);
            lines.filter_map(|line| Some(line.worst()?.error)).fold(0.0, f64::max)
        };
        text += &format!(
            "\nThe fast formulas for rotations and the general code agree: {} checks, the worst {:.1} units.\n\
             Against numbers of 30 digits they are right to {:.1} and {:.1} units.\n\
             One unit is the error that rounding the input alone causes.\n",
            self.findings.len(),
            self.worst(),
            maps("closed form"),
            maps("general layer")
        );
        text
    }
}

impl Outcome {
    fn of(
        experiment: Experiment,
        quick: bool,
        mut share: impl FnMut(f64),
    ) -> Result<Self, CliError> {
        let scene = Scene::bundled(experiment.scene)?;
        share(0.0);
        let run = |energy: EnergyRun| {
            let layers_differ = match energy.method {
                PaperMethod::Rk4 => f64::NAN,
                row => layers_differ(&scene, &experiment.grid()?, row)?,
            };
            Ok(LongRun {
                label: candidate(energy.method, Layer::Closed).label(),
                energy,
                layers_differ,
            })
        };
        let runs =
            experiment.energy(MAPS.into_iter().chain([PaperMethod::Rk4]))?.into_iter().map(run);
        let runs = runs.collect::<Result<Vec<_>, CliError>>()?;
        share(0.2);
        let mut candidates = Layer::ALL.map(|layer| MAPS.map(|row| candidate(row, layer))).concat();
        candidates.push(candidate(PaperMethod::Rk4, Layer::Closed));
        let effort = Effort {
            rounds: rounds(quick),
            longest: Duration::from_millis(if quick { 20 } else { 200 }),
            shortest: Duration::from_micros(if quick { 200 } else { 1000 }),
            wanted: &[],
            patience: Duration::ZERO,
            goal: None,
            seed: SEED,
            stop: &NEVER,
        };
        let plan = Plan {
            quantities: &QUANTITIES,
            candidates: &candidates,
            t_span: experiment.window,
            steps: if quick { &experiment.steps[..6] } else { experiment.steps },
            tolerances: &[],
            rows: &Rows::ENDS,
        };
        let done = |done| {
            share(0.2 + 0.8 * done);
            Ok(())
        };
        let (curves, _) = speed_against_error(&scene, &plan, effort, None, done)?;
        Ok(Outcome { experiment, title: scene.title, curves, runs })
    }

    /// How far the attitudes at the end of the long runs are from a rotation: by the methods on the group, or by RK4.
    fn defect(&self, of_group: bool) -> f64 {
        let runs = self.runs.iter();
        let runs = runs.filter(|run| (run.energy.method != PaperMethod::Rk4) == of_group);
        let ends = runs.filter_map(|run| run.energy.end);
        ends.map(|g| So3::new().defect(&g)).fold(0.0, f64::max)
    }

    /// What the speed of the classical method costs.
    fn price(&self) -> String {
        format!(
            "A step of classical rk4 is the cheapest, because it leaves the rotations: at t = {} in steps of {} its \
             attitude is {} from one, and those of the others {}.",
            Experiment::END,
            self.experiment.dt,
            sig(self.defect(false), 2),
            sig(self.defect(true), 2)
        )
    }

    /// The table for a terminal.
    fn in_words(&self) -> String {
        let header = ["method", "order", "a step", "to 1e-3", "to 1e-6", "to 1e-9", "energy error"];
        let rows = self.runs.iter().filter_map(|run| {
            let curve = self.curves.iter().find(|curve| curve.candidate.label() == run.label)?;
            let to = |error| or_dash(curve.seconds_to(error), seconds);
            Some([
                run.label.clone(),
                or_dash(curve.measured_order(), |p| format!("{p:.2}")),
                or_dash(curve.seconds_per_step(), seconds),
                to(1e-3),
                to(1e-6),
                to(1e-9),
                scientific(run.energy.last()),
            ])
        });
        let remarks = [Some(self.price()), report::above_order(&self.curves).map(Into::into)];
        let remarks = remarks.into_iter().flatten().map(|remark| output::wrap(&remark, " "));
        format!(
            "\n{}, steps of {}\n{}{}",
            self.title,
            self.experiment.dt,
            output::table(header, rows),
            remarks.collect::<String>()
        )
    }
}

/// The rounds of timing.
fn rounds(quick: bool) -> u32 {
    if quick { 3 } else { 9 }
}

/// The relative difference of the momentum at the end of these steps between the layers.
fn layers_differ(scene: &Scene, grid: &TimeGrid, row: PaperMethod) -> Result<f64, CliError> {
    let mut ends = [[0.0; 3]; 2];
    for (layer, end) in Layer::ALL.into_iter().zip(&mut ends) {
        let model = scene.model_with(layer, &["momentum_body"])?;
        let method = candidate(row, layer).method;
        model.run(&method, grid, &SaveAt::Ends, &mut |_, row| {
            end.copy_from_slice(row.values());
        })?;
    }
    let [a, b] = ends.map(nalgebra::Vector3::from);
    let size = a.norm();
    Ok((a - b).norm() / if size > 0.0 { size } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use lieflow_model::kinds::RigidBodySpec;

    use super::*;

    #[test]
    fn scenes_and_experiments_are_the_same() {
        for experiment in EXPERIMENTS {
            let scene = Scene::bundled(experiment.scene).unwrap();
            let spec = scene.problem.spec::<RigidBodySpec>().unwrap();
            assert_eq!(spec.inertia, experiment.body.inertia);
            assert_eq!(spec.momentum_body, experiment.body.momentum_space);
            assert_eq!(scene.grid.t_span(), [0.0, Experiment::END]);
            // The scene of the high energy takes eight steps for one of the paper, which leaves no digit right.
            let steps = if experiment.scene == "high-energy" { 8.0 } else { 1.0 };
            assert!((steps * scene.grid.h() - experiment.dt).abs() < 1e-15);
        }
    }
}
