//! `lieflow compare`: speed against error for one scene, over all methods that fit it, ending in
//! advice.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::CliError;
use crate::args::CompareArgs;
use crate::measure::{
    Candidate, Curve, Effort, Journal, Plan, Reached, Reference, WorkPoint, machine,
    speed_against_error,
};
use crate::output::{self, Progress};
use crate::report::{self, CHOICE_HEADER, Choice, Cost, KEPT, choices};
use lieflow_figures::{Block, Page, Section};
use lieflow_model::model::Layer;
use lieflow_model::operations::COUNTED_STEPS;
use lieflow_model::scene::Scene;

/// Step sizes are that of the scene times powers of two, from the whole span to this power below it.
const HALVINGS: i32 = 5;

/// Tolerances of the methods that choose their steps.
const TOLERANCES: [f64; 7] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13];

/// Everything as JSON.
#[derive(Serialize)]
struct Json<'a> {
    scene: &'a str,
    t_span: [f64; 2],
    reference: String,
    machine: String,
    reference_error: Option<f64>,
    advice: Vec<AdviceJson>,
    advice_energy_kept: Vec<AdviceJson>,
    /// Without the exact motion, which goes in no steps.
    advice_steps: Vec<AdviceJson>,
    advice_steps_energy_kept: Vec<AdviceJson>,
    curves: Vec<CurveJson<'a>>,
}

/// A curve as JSON.
#[derive(Serialize)]
struct CurveJson<'a> {
    method: &'a str,
    map: Option<&'a str>,
    tableau: Option<&'a str>,
    layer: &'static str,
    adaptive: bool,
    order: Option<usize>,
    measured_order: Option<f64>,
    /// Places of the points that no other run beats.
    pareto: Vec<usize>,
    points: &'a [WorkPoint],
}

/// The fastest method to an error.
#[derive(Serialize)]
struct AdviceJson {
    error: f64,
    method: Option<String>,
    h: Option<f64>,
    rtol: Option<f64>,
    seconds_per_unit: Option<f64>,
}

/// What was measured.
struct Comparison<'a> {
    scene: &'a Scene,
    curves: Vec<Curve>,
    reference: Reference,
    effort: Effort,
}

/// Run the command.
///
/// # Errors
/// A scene that cannot be used, or a report that cannot be written.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    let clock = Instant::now();
    let scene = Scene::open(&args.scene)?;
    let folder: PathBuf = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("lieflow-compare").join(&scene.name),
    };
    let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let mut layers = match args.layers.is_empty() {
        true => vec![scene.layer],
        false => args.layers.clone(),
    };
    layers.sort_unstable();
    layers.dedup();
    let mut candidates = Vec::new();
    for layer in layers {
        candidates.extend(Candidate::all_that_fit(&scene, &quantities, layer)?);
    }
    if !args.methods.is_empty() {
        candidates = Candidate::chosen(&candidates, &args.methods)?;
    }
    if !scene.grid.t_span()[1].is_finite() {
        let message = "a comparison needs a span with an end: t_span of the scene has none";
        return Err(CliError::Message(message.into()));
    }
    output::make_folder(&folder)?;
    let steps = numbers_of_steps(&scene);
    let mut tolerances = match args.tolerances.is_empty() {
        true => TOLERANCES.to_vec(),
        false => args.tolerances.clone(),
    };
    tolerances.sort_by(|a, b| b.total_cmp(a));
    tolerances.dedup();
    let effort = Effort {
        rounds: args.repeat.unwrap_or(if args.quick { 3 } else { 5 }),
        longest: Duration::from_millis(if args.quick { 5 } else { 30 }),
        shortest: Duration::from_micros(if args.quick { 50 } else { 300 }),
        seed: args.seed,
        wanted: &report::ADVICE,
        patience: Duration::from_millis(if args.quick { 100 } else { 1000 }),
    };
    let plan = Plan {
        quantities: &quantities,
        candidates: &candidates,
        t_span: scene.grid.t_span(),
        steps: &steps,
        tolerances: &tolerances,
    };
    let mut journal = Journal::open(&folder, &identity(&scene, &plan, &effort))?;
    if journal.known() > 0 {
        output::print(&format!("going on with {} runs from before\n", journal.known()))?;
    }
    let bar = Progress::new();
    let (curves, reference) =
        speed_against_error(&scene, &plan, effort, Some(&mut journal), |done| bar.at(done))?;
    drop(bar);

    let comparison = Comparison { scene: &scene, curves, reference, effort };
    let path = comparison.write(&folder)?;
    journal.finish()?;
    output::print(&comparison.in_words())?;
    output::print(&format!(
        "\nThe report: {}\n({:.1} s)\n",
        path.display(),
        clock.elapsed().as_secs_f64()
    ))
}

/// What a comparison is about: another scene, other options or another program is another one.
fn identity(scene: &Scene, plan: &Plan<'_>, effort: &Effort) -> String {
    let mut hasher = DefaultHasher::new();
    format!("{scene:?} {plan:?} {effort:?} {}", machine()).hash(&mut hasher);
    format!("{} {} {:016x}", env!("CARGO_PKG_VERSION"), scene.name, hasher.finish())
}

fn numbers_of_steps(scene: &Scene) -> Vec<u64> {
    let own = scene.grid.steps().max(1);
    // A single step first: some methods need no more.
    let doublings = own.ilog2() as i32;
    let scaled = (-doublings..=HALVINGS).map(|power| own as f64 * f64::from(power).exp2());
    let mut steps: Vec<u64> = scaled.map(|steps| (steps.round() as u64).max(1)).collect();
    steps.insert(0, 1);
    steps.dedup();
    steps
}

impl From<&Choice<'_>> for AdviceJson {
    fn from(choice: &Choice<'_>) -> Self {
        let (curve, reached) = choice.best.unzip();
        AdviceJson {
            error: choice.error,
            method: curve.map(|curve| curve.candidate.label()),
            h: reached.map(|reached| reached.h),
            rtol: reached.and_then(|reached| reached.tolerance),
            seconds_per_unit: reached.map(|reached| reached.seconds),
        }
    }
}

impl Comparison<'_> {
    /// The fastest to each error: of all, and of those whose energy does not drift; then the same of
    /// the methods that go in steps.
    fn advice(&self) -> [Vec<Choice<'_>>; 4] {
        let of = |pass: fn(&Curve, &Reached) -> bool| choices(&self.curves, &self.reference, pass);
        [
            of(|_, _| true),
            of(report::keeps_energy),
            of(|curve, _| report::steps(curve)),
            of(|curve, reached| report::steps(curve) && report::keeps_energy(curve, reached)),
        ]
    }

    /// The advice that says something, each with its caption.
    fn advice_in_words(&self) -> Vec<(String, Vec<Choice<'_>>)> {
        let [all, kept, stepping, stepping_kept] = self.advice();
        let energy = format!(
            "The same where the energy must not drift: methods that keep it or keep it in bounds by \
             construction, and those that kept it within {KEPT:.0e} here."
        );
        let mut told = vec![(
            "The fastest method for each error; times are CPU time per unit of simulated time."
                .to_string(),
            all,
        )];
        if self.has_energy() {
            told.push((energy.clone(), kept));
        }
        let exact = self.curves.iter().filter(|curve| !report::steps(curve)).count();
        if (1..self.curves.len()).contains(&exact) {
            let apart = "The fastest without the exact motion, which is there in one step but serves \
                         no other problem.";
            told.push((apart.into(), stepping));
            if self.has_energy() {
                told.push((energy, stepping_kept));
            }
        }
        told
    }

    /// Does the problem have an energy?
    fn has_energy(&self) -> bool {
        self.curves.iter().flat_map(|curve| &curve.points).any(|p| !p.energy_error.is_nan())
    }

    fn write(&self, folder: &Path) -> Result<PathBuf, CliError> {
        let curves = [(self.scene.name.as_str(), &self.curves[..])];
        report::write_speed_csv(&folder.join("speed.csv"), curves)?;
        let [advice, advice_energy_kept, advice_steps, advice_steps_energy_kept] =
            self.advice().map(|choices| choices.iter().map(AdviceJson::from).collect());
        let json = Json {
            scene: &self.scene.name,
            t_span: self.scene.grid.t_span(),
            reference: self.reference.in_words(),
            machine: machine(),
            reference_error: self.reference.error(),
            advice,
            advice_energy_kept,
            advice_steps,
            advice_steps_energy_kept,
            curves: self.curves.iter().zip(report::fronts(&self.curves)).map(curve_json).collect(),
        };
        output::write_file(&folder.join("speed.json"), output::to_json(&json)?)?;
        output::write_page(folder, "index.html", &self.page())
    }

    fn in_words(&self) -> String {
        let mut text = format!(
            "{}: global error at t = {}, {} methods\n",
            self.scene.title,
            self.scene.grid.t_span()[1],
            self.curves.len(),
        );
        for (caption, choices) in self.advice_in_words() {
            let table = output::table(CHOICE_HEADER, choices.iter().map(report::choice_cells));
            text += &format!("\n{caption}\n{table}");
        }
        text + &format!("\nErrors are distances from {}.\n", self.reference.in_words())
    }

    /// What the figures of the front say of the exact motion.
    fn left_out(&self) -> &'static str {
        match self.curves.iter().all(report::steps) {
            true => "",
            false => {
                " The front is that of the methods with steps; the exact motion stands beside it."
            }
        }
    }

    /// The figures of what is counted.
    fn counts(&self) -> Vec<Block> {
        let evaluations = "Evaluations of f, of F or of A(t): the catalog's number for a step times the \
                           steps, and what was counted where steps were chosen, rejected attempts \
                           among them. Implicit methods and those without a field are left out.";
        let layers = |layer: Layer| self.curves.iter().any(|c| c.candidate.layer == layer);
        let mut operations =
            "Additions, multiplications, divisions, square roots, sines and cosines, \
                              each as one, counted while the steps run: "
                .to_string();
        operations += match (layers(Layer::Closed), layers(Layer::General)) {
            (_, false) => "the closed formulas on numbers that count what is done to them",
            (false, _) => {
                "every product, solve, sum and rotation of matrices says what it has done"
            }
            (true, true) => {
                "on the closed layer by numbers that count what is done to them, on the general one by \
                 every product, solve, sum and rotation of matrices, which says what it has done"
            }
        };
        operations += &format!(
            ". A run of more than {COUNTED_STEPS} steps is charged the mean of the first \
             {COUNTED_STEPS} for each, or of fewer where these take millions of operations; rejected \
             attempts are among them."
        );
        if layers(Layer::General) {
            operations += " Signs, copies and the arithmetic of single numbers beside a matrix are free; \
                           eigenvectors count as 9n³.";
        }
        if self.curves.iter().any(|curve| !report::steps(curve)) {
            operations += " The exact motion, which is made of elliptic functions, has no count.";
        }
        let chart = |id, title, caption: &str, cost| {
            report::front_chart(id, title, &self.curves, cost).with_caption(caption).into()
        };
        let counted = self.curves.iter().flat_map(|curve| &curve.points);
        let by_operations = match counted.into_iter().any(|p| p.operations.is_some()) {
            true => chart(
                "operations",
                "Runs that no other beats in both error and operations",
                &operations,
                Cost::Operations,
            ),
            false => Block::text(
                "There is no figure of operations: none of these runs has operations to count. The exact \
                 motion is made of elliptic functions.",
            ),
        };
        vec![
            by_operations,
            chart(
                "evaluations",
                "Runs that no other beats in both error and evaluations of f",
                evaluations,
                Cost::Evaluations,
            ),
        ]
    }

    fn page(&self) -> Page {
        let [t0, t1] = self.scene.grid.t_span();
        let curves = &self.curves;
        let mut families: Vec<&str> = Vec::new();
        for curve in curves {
            if !families.contains(&curve.candidate.family()) {
                families.push(curve.candidate.family());
            }
        }
        let what = "The error is the largest relative distance of a part of the state from the \
                    reference at the end; runs with an error above 1 are not drawn.";
        let mut charts: Vec<Block> = families
            .iter()
            .map(|family| {
                let of_family = curves.iter().filter(|c| c.candidate.family() == *family);
                let title = format!("Speed against error: {family}");
                let chart = report::speed_chart(&format!("speed-{family}"), &title, of_family);
                chart.with_caption(what).into()
            })
            .collect();
        charts.splice(0..0, self.counts());
        let advice = self.advice_in_words();
        let table = |(caption, choices): &(String, Vec<Choice<'_>>)| {
            report::choice_table(caption, choices).into()
        };
        let mut facts = report::conditions(self.effort.rounds).to_vec();
        facts.extend([
            (
                "Runs".into(),
                format!(
                    "steps get smaller until a run takes {:?}; up to {:?} for the methods that promise \
                     most where none has reached an error of the tables",
                    self.effort.longest, self.effort.patience
                ),
            ),
            ("Modelled".into(), self.scene.quantities.join(", ")),
            ("Errors are distances from".into(), self.reference.in_words()),
        ]);
        // One below the other: two side by side hide their last columns.
        let mut short: Vec<Block> = advice.iter().map(table).collect();
        short.extend([
            report::front_chart(
                "pareto",
                "Runs that no other beats in both error and time",
                curves,
                Cost::Time,
            )
            .with_caption(format!("{what}{}", self.left_out()))
            .into(),
            Block::Facts(facts),
        ]);
        report::page(
            format!("{}: which method?", self.scene.title),
            format!("t = {t0} … {t1}, {} methods on this machine", curves.len()),
            vec![
                Section::new("In short", short),
                Section::new("Figures", charts),
                Section::new(
                    "All methods",
                    vec![
                        Block::text(
                            "speed.csv and speed.json beside this page have every run; every figure is \
                             there as an SVG file.",
                        ),
                        report::speed_table(curves).into(),
                        report::kept_table(curves).into(),
                    ],
                ),
            ],
        )
    }
}

fn curve_json((curve, pareto): (&Curve, Vec<usize>)) -> CurveJson<'_> {
    CurveJson {
        method: &curve.candidate.method.name,
        map: curve.candidate.method.map.as_deref(),
        tableau: curve.candidate.method.tableau.as_deref(),
        layer: curve.candidate.layer.name(),
        adaptive: curve.candidate.adaptive,
        order: curve.order,
        measured_order: curve.measured_order(),
        pareto,
        points: &curve.points,
    }
}
