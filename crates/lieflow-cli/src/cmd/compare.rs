//! `lieflow compare`: which method is the fastest to an error on a scene, and why; speed against error of all
//! methods that fit it.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::stop::{INTERRUPTED, listen};
use crate::args::CompareArgs;
use crate::error::CliError;
use crate::measure::{
    Candidate, Curve, Effort, Journal, Kept, MOST_ROWS, Plan, Reached, Reference, Rows, SLOW,
    speed_against_error,
};
use crate::output::{self, Progress};
use crate::report::{self, ADVICE, Answer, Best, Choice, Cost, KEPT, choices, json};
use lieflow::solve::COUNTED_STEPS;
use lieflow_figures::{Block, Chart, Page, Section};
use lieflow_model::problem::Layer;
use lieflow_model::scene::Scene;
use lieflow_timing::machine;

/// The errors that are answered for where none is asked.
const ASKED: [f64; 2] = [1e-6, 1e-9];

/// Step sizes are that of the scene times powers of two, from the whole span to this power below it.
const HALVINGS: i32 = 10;

/// Tolerances of the methods that choose their steps.
const TOLERANCES: [f64; 7] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13];

/// How often a line tells where a comparison is, where no bar can.
const TOLD_EVERY: Duration = Duration::from_secs(10);

/// What was measured.
struct Comparison<'a> {
    scene: &'a Scene,
    curves: Vec<Curve>,
    reference: Reference,
    effort: Effort<'a>,
    /// The errors that are answered for, from the largest to the smallest.
    asked: &'a [f64],
    /// Are all methods shown?
    all: bool,
}

/// Run the command.
///
/// # Errors
/// A scene that cannot be used, a report that cannot be written, or an interruption.
pub fn run(args: &CompareArgs) -> Result<(), CliError> {
    let clock = Instant::now();
    let scene = args.settings.open(&args.scene)?;
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
        candidates = Candidate::chosen(&scene, &quantities, &candidates, &args.methods)?;
    }
    if let Some(name) = &args.keep {
        let kept = Kept::of(&scene, name)?;
        candidates.retain(|candidate| kept.by(&candidate.method));
        if candidates.is_empty() {
            return Err(CliError::Message(format!(
                "--keep: no method that is asked for keeps {name}"
            )));
        }
    }
    if !scene.grid.t_span()[1].is_finite() {
        let message = "a comparison needs a span with an end: t_span of the scene has none";
        return Err(CliError::Message(message.into()));
    }
    output::make_folder(&folder)?;
    let _lock = output::Lock::of(&folder)?;
    let steps = numbers_of_steps(&scene);
    let (asked, tolerances) =
        (falling(&args.errors, &ASKED), falling(&args.tolerances, &TOLERANCES));
    let wanted = match args.errors.is_empty() {
        true => ADVICE.to_vec(),
        false => asked.clone(),
    };
    let stop = listen()?;
    let effort = Effort {
        rounds: args.repeat.unwrap_or(if args.quick { 3 } else { 5 }),
        longest: Duration::from_millis(if args.quick { 5 } else { 30 }),
        shortest: Duration::from_micros(if args.quick { 50 } else { 300 }),
        seed: args.seed,
        wanted: &wanted,
        patience: Duration::from_millis(if args.quick { 100 } else { 1000 }),
        goal: asked.last().copied().filter(|_| !args.errors.is_empty() && !args.all),
        stop: &stop,
    };
    let plan = Plan {
        quantities: &quantities,
        candidates: &candidates,
        t_span: scene.grid.t_span(),
        steps: &steps,
        tolerances: &tolerances,
        rows: &Rows::of(&scene),
    };
    if args.again {
        Journal::remove(&folder)?;
    }
    let mut journal = Journal::open(&folder, &identity(&scene))?;
    if journal.known() > 0 {
        output::print(&format!(
            "{} runs are known from before; --again measures them again.\n",
            journal.known()
        ))?;
    }
    let mut told = Told::new(effort.goal.is_none());
    let measured = speed_against_error(&scene, &plan, effort, Some(&mut journal), |share| {
        told.at(share)?;
        stopped(&stop, &folder)
    });
    drop(told);
    let (curves, reference) =
        measured.map_err(|error| stopped(&stop, &folder).err().unwrap_or(error))?;

    let comparison =
        Comparison { scene: &scene, curves, reference, effort, asked: &asked, all: args.all };
    let path = comparison.write(&folder)?;
    output::print(&comparison.in_words())?;
    output::print(&format!(
        "\nThe report: {}\n({:.1} s)\n",
        path.display(),
        clock.elapsed().as_secs_f64()
    ))
}

/// The numbers that were given, or else the default, from the largest to the smallest.
fn falling(given: &[f64], default: &[f64]) -> Vec<f64> {
    let mut numbers = if given.is_empty() { default.to_vec() } else { given.to_vec() };
    numbers.sort_by(|a, b| b.total_cmp(a));
    numbers.dedup();
    numbers
}

/// Everything that a measurement depends on besides method and step: the scene, the program and the machine.
fn identity(scene: &Scene) -> String {
    let (version, machine) = (env!("CARGO_PKG_VERSION"), machine());
    format!("{} {:016x}, lieflow {version}, {machine}", scene.name, scene.fingerprint)
}

/// The end of a comparison that was interrupted.
fn stopped(stop: &AtomicBool, folder: &Path) -> Result<(), CliError> {
    if !stop.load(Ordering::Relaxed) {
        return Ok(());
    }
    let message = format!(
        "the comparison was interrupted\nWhat was measured is kept in {}; the same command goes on from there",
        folder.join(crate::measure::JOURNAL).display()
    );
    Err(CliError::Stopped { message, code: INTERRUPTED })
}

/// The progress of a comparison: a bar on a terminal, and otherwise a line now and then.
struct Told {
    bar: Progress,
    start: Instant,
    last: Instant,
    lines: bool,
    /// What makes a long comparison shorter, until it is told in a line.
    hint: Option<&'static str>,
}

/// What makes a comparison of all methods at all errors shorter.
const SHORTER: &str =
    "with --error 1e-6 it measures only what reaches that error, in a fraction of the time";

impl Told {
    fn new(of_all: bool) -> Self {
        let (now, hint) = (Instant::now(), of_all.then_some(SHORTER));
        let lines = !io::stderr().is_terminal();
        Told { bar: Progress::new(), start: now, last: now, lines, hint }
    }

    /// This share of the work is done, after a run that was measured.
    fn at(&mut self, share: f64) -> Result<(), CliError> {
        let is_long = self.start.elapsed() >= TOLD_EVERY;
        self.bar.often(share, || self.hint.filter(|_| is_long).unwrap_or_default().into());
        if self.lines && self.last.elapsed() >= TOLD_EVERY {
            self.last = Instant::now();
            let seconds = self.start.elapsed().as_secs();
            // A reader that went away is no reason to stop.
            let hint = self.hint.take().map_or(String::new(), |hint| format!("; {hint}"));
            let _ = writeln!(io::stderr(), "{:.0} % after {seconds} s{hint}", 100.0 * share);
        }
        Ok(())
    }
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

impl Comparison<'_> {
    /// The answers to the errors that were asked for.
    fn answers(&self) -> Vec<Answer<'_>> {
        let answer = |&error: &f64| Answer::new(&self.curves, &self.reference, error);
        self.asked.iter().map(answer).collect()
    }

    /// The best methods.
    fn best(&self) -> Best<'_> {
        Best::new(&self.curves, self.asked, self.all)
    }

    /// The errors of the tables, from the largest to the smallest.
    fn errors(&self) -> Vec<f64> {
        falling(&[&ADVICE, self.asked].concat(), &[])
    }

    /// The fastest to each error: of all, and of those whose energy does not drift; then the same of
    /// the methods that go in steps.
    fn advice(&self) -> [Vec<Choice<'_>>; 4] {
        let errors = self.errors();
        let of = |pass: fn(&Curve, &Reached) -> bool| {
            choices(&self.curves, &self.reference, &errors, pass)
        };
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
            "The same among methods that conserve energy, or keep it within bounds, or kept it within {KEPT:e} \
             here."
        );
        let mut told = vec![(
            "The fastest method for each error. Times are CPU times for each unit of simulated time, without rows of output."
                .to_string(),
            all,
        )];
        if self.has_energy() {
            told.push((energy.clone(), kept));
        }
        let exact_is_best = |choices: &[Choice<'_>]| {
            choices.iter().any(|choice| choice.best.is_some_and(|(curve, _)| !report::steps(curve)))
        };
        let [first, second] = [&told[0].1, &told[told.len() - 1].1];
        if exact_is_best(first) || exact_is_best(second) {
            let apart = "The fastest without the exact motion, which serves no other problem.";
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
            self.advice().map(|choices| json::choices(&choices));
        let document = json!({
            "scene": self.scene.name,
            "t_span": self.scene.grid.t_span(),
            "reference": self.reference.in_words(),
            "machine": machine(),
            "reference_error": self.reference.error(),
            "answers": self.answers().iter().map(json::answer).collect::<Value>(),
            "advice": advice,
            "advice_energy_kept": advice_energy_kept,
            // Without the exact motion, which goes in no steps.
            "advice_steps": advice_steps,
            "advice_steps_energy_kept": advice_steps_energy_kept,
            "curves": json::curves(&self.curves),
        });
        output::write_file(&folder.join("speed.json"), output::to_json(&document)?)?;
        output::write_page(folder, "index.html", &self.page())
    }

    fn in_words(&self) -> String {
        let best = self.best();
        let mut text: String = self
            .answers()
            .iter()
            .map(|answer| output::wrap(&answer.in_words(), "") + "\n")
            .collect();
        text += &output::wrap(&best.caption(self.curves.len()), "");
        let columns = best.columns().into_iter().map(|column| column.title);
        let rows = best.rows().into_iter().map(|row| row.into_iter().map(|cell| cell.text));
        text += &output::table(columns, rows);
        text += &format!("\n{}", output::wrap(&self.about_times(), ""));
        if best.is_cut() {
            text += "--all shows every method that reaches it. The page has all runs.\n";
        }
        text
    }

    /// What times and errors are.
    fn about_times(&self) -> String {
        let energy = match self.has_energy() {
            true => " The energy error is relative, at the end of the same run.",
            false => "",
        };
        let reference = self.reference.in_words();
        let off = " The last column is how far a run ends from M, the set of all possible states.";
        let off = if self.curves.iter().any(Curve::leaves) { off } else { "" };
        let length = match self.curves.iter().any(|curve| curve.candidate.adaptive) {
            true => {
                " An rtol is relative to the length of each step: tolerance = \"per-length\" in a scene, atol = 0."
            }
            false => "",
        };
        format!(
            "Times are CPU times of a whole run without its rows of output. Errors are those at the \
             end.{length}{energy}{off} {reference}"
        )
    }

    /// A figure of speed against error, or of what is counted, for some of the methods.
    fn chart(
        &self,
        id: &str,
        title: &str,
        cost: Cost,
        shown: impl Fn(usize) -> bool,
    ) -> Option<Chart> {
        report::front_chart(id, title, &self.curves, cost, &self.best().looks, shown)
    }

    /// The figures of what is counted.
    fn counts(&self) -> Vec<Block> {
        let evaluations = "Evaluations of f, F or A(t). Steps of one size: the number for a step in the catalog, \
                           times the steps. Steps chosen by their error: counted, with rejected attempts. \
                           Implicit methods and those without a field are left out.";
        let layers = |layer: Layer| self.curves.iter().any(|c| c.candidate.layer == layer);
        let mut operations =
            "Additions, multiplications, divisions, square roots, sines and cosines, each \
                              as one. They are counted while the steps run: "
                .to_string();
        operations += match (layers(Layer::Closed), layers(Layer::General)) {
            (_, false) => "the closed formulas run on numbers that count",
            (false, _) => "every product, solve, sum and rotation of matrices is counted",
            (true, true) => {
                "on the closed layer by numbers that count, on the general layer by every product, solve, \
                 sum and rotation of matrices"
            }
        };
        operations += &format!(
            ". Long runs are extrapolated from their first {COUNTED_STEPS} steps. Rejected attempts count."
        );
        if layers(Layer::General) {
            operations += " Signs, copies and the arithmetic of single numbers beside a matrix are free. \
                           Eigenvectors count as 9n³.";
        }
        if self.curves.iter().any(|curve| !report::steps(curve)) {
            operations += " The exact motion has no count: it is made of elliptic functions.";
        }
        let figure = |id, title, caption: &str, cost| {
            let on_front = report::on_front(&self.curves, cost);
            match self.chart(id, title, cost, |i| on_front[i]) {
                Some(chart) => chart.with_caption(caption).into(),
                None => Block::text(format!("{title}: nothing was counted in these runs.")),
            }
        };
        vec![
            figure("operations", "Operations to an error", &operations, Cost::Operations),
            figure("evaluations", "Evaluations of f to an error", evaluations, Cost::Evaluations),
        ]
    }

    /// A figure for each kind of method.
    fn kinds(&self, best: &Best<'_>) -> Vec<Block> {
        let mut kinds: Vec<&str> = Vec::new();
        for curve in &self.curves {
            if !kinds.contains(&curve.candidate.figure()) {
                kinds.push(curve.candidate.figure());
            }
        }
        let chart = |kind: &&str| {
            let (id, title) = (format!("speed-{kind}"), format!("Time to an error: {kind}"));
            let of_kind = |curve: &Curve| curve.candidate.figure() == *kind;
            report::speed_chart(&id, &title, &self.curves, &best.looks, of_kind)
        };
        kinds.iter().filter_map(chart).map(Block::from).collect()
    }

    /// How it was measured.
    fn conditions(&self) -> Vec<(String, String)> {
        let Effort { rounds, longest, patience, .. } = self.effort;
        let mut facts = report::conditions(rounds).to_vec();
        let runs = format!(
            "steps get smaller until a run takes {longest:?}; where no method has reached an error that is asked \
             for, the most promising ones go on to {patience:?}; a run that takes {SLOW} times as long as the best one \
             to its error is timed once"
        );
        let rows = format!(
            "each timed run gives the rows of the scene, {MOST_ROWS} at most; events are left out"
        );
        facts.extend([
            ("Runs".into(), runs),
            ("Output".into(), rows),
            ("Modelled".into(), self.scene.quantities.join(", ")),
            ("Errors".into(), self.reference.in_words()),
        ]);
        facts
    }

    fn page(&self) -> Page {
        let [t0, t1] = self.scene.grid.t_span();
        let (curves, best) = (&self.curves, self.best());
        let mut answer: Vec<Block> =
            self.answers().iter().map(|answer| Block::text(answer.in_words())).collect();
        let what = "The error is the largest relative distance of a part of the state from the reference at the \
                    end. Runs with an error above 1 are not drawn. Lines end where rounding begins. The dashed \
                    line joins the best runs of all methods that take steps.";
        let title = "Time that a run takes to reach an error";
        let figure = self.chart("pareto", title, Cost::Run, |i| best.draws(i));
        answer.extend(figure.map(|chart| chart.with_caption(what).into()));
        let caption = format!("{} {}", best.caption(curves.len()), self.about_times());
        answer.push(best.table(caption).into());
        let table = |(caption, choices): &(String, Vec<Choice<'_>>)| {
            report::choice_table(caption, choices).into()
        };
        let every = vec![
            report::speed_table(curves, &self.errors()).into(),
            report::kept_table(curves).into(),
        ];
        let more = vec![
            Block::fold(format!("All {} methods", curves.len()), every),
            Block::fold(
                "The fastest for large and small errors, and where the energy must not drift",
                self.advice_in_words().iter().map(table).collect(),
            ),
            Block::fold("A figure for each kind of method", self.kinds(&best)),
            Block::fold("Operations and evaluations of f", self.counts()),
            Block::fold("How it was measured", vec![Block::Facts(self.conditions())]),
        ];
        let page = Page::new(
            format!("{}: which method?", self.scene.title),
            format!(
                "t = {} to {}, {} methods on this machine",
                output::time(t0, [t0, t1]),
                output::time(t1, [t0, t1]),
                curves.len()
            ),
            vec![Section::new("In short", answer), Section::new("More", more)],
        );
        page.with_links([("Every run (CSV)", "speed.csv"), ("Every run (JSON)", "speed.json")])
    }
}
