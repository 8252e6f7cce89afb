//! The options of the command line.

use std::path::{Path, PathBuf};

use clap::error::{ContextKind, ContextValue};
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use lieflow::names::near;

use lieflow_model::problem::Layer;
use lieflow_model::scene::{BUNDLED, Scene, SceneError};

/// Integrate ordinary differential equations on Lie groups.
///
/// Without a command: run the demonstration and write its report.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "lieflow",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Examples:
  lieflow                               the demonstration: lieflow-report/index.html
  lieflow --quick                       the same in a few seconds
  lieflow scenes                        the scenes that come with the program
  lieflow run asymmetric-top            run one of them
  lieflow scenes asymmetric-top > my.toml
                                        a scene of one's own to start from
  lieflow run my.toml --out results     run it
  lieflow paper --out paper             the paper's tables and figures, computed again"
)]
pub struct Cli {
    /// The command; the demonstration when there is none.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Options of the demonstration.
    #[command(flatten)]
    pub demo: DemoArgs,
}

impl Cli {
    /// The options that the program was started with. The program ends here where they cannot be read.
    pub fn started_with() -> Self {
        Cli::try_parse().unwrap_or_else(|error| match meant(&error) {
            Some(meant) => {
                eprintln!("error: {meant}");
                std::process::exit(error.exit_code())
            }
            None => error.exit(),
        })
    }
}

/// What was meant by a word that is no command: a scene to run, or a command with another spelling.
fn meant(error: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(given)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    let is_scene = Path::new(given).is_file()
        || given.ends_with(".toml")
        || BUNDLED.iter().any(|scene| scene.name == given);
    let command = Cli::command();
    let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    if names.contains(&given.as_str()) {
        return Some(format!("options come after the command: `lieflow {given} … --option`"));
    }
    let meant = match near(given, &names).filter(|_| !is_scene) {
        Some(name) => format!("did you mean `lieflow {name}`?"),
        None if is_scene => format!("did you mean `lieflow run {}`?", quoted(given)),
        None => format!("expected one of {}", names.join(", ")),
    };
    Some(format!("there is no command `{given}`\n{meant}"))
}

/// A command.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Run a scene: trajectory.csv, summary.json, and a page with figures.
    Run(RunArgs),
    /// Draw columns of runs that were made before, those of several runs in one figure.
    Plot(PlotArgs),
    /// Find the fastest method to an error on a scene: run all that fit, and write a report.
    Compare(CompareArgs),
    /// Show what Lie group methods are good for, on three bodies that turn: a page with figures. The same as no command.
    Demo(DemoArgs),
    /// Compute the paper's tables and figures again: paper.html, CSV and SVG files.
    Paper(PaperArgs),
    /// Check every method on every type of problem, and the maps, in the program at hand.
    Check(CheckArgs),
    /// List the scenes that come with the program, or print one to start from.
    Scenes(ScenesArgs),
    /// Tell which method to take; list the methods, coordinate maps and tableaus.
    Methods(MethodsArgs),
    /// Measure the order of methods on a scene: errors with steps that are halved.
    Order(OrderArgs),
    /// Print completions for a shell.
    Completions(CompletionsArgs),
}

/// Options of the demonstration.
#[derive(Args, Clone, Debug)]
pub struct DemoArgs {
    /// Shorter runs: a few seconds, the same figures with less in them.
    #[arg(long)]
    pub quick: bool,
    /// Folder for the report.
    #[arg(long, value_name = "DIR", default_value = "lieflow-report")]
    pub out: PathBuf,
}

/// Options of `run`.
#[derive(Args, Clone, Debug)]
#[command(after_help = SCENE_HELP)]
pub struct RunArgs {
    /// Scene files, or names of bundled scenes; - reads a scene from standard input.
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Folder for what is written; with several scenes, a folder in it for each [default: lieflow-out/SCENE].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// What is changed in the scenes.
    #[command(flatten)]
    pub settings: Settings,
    /// Write no page and no figures.
    #[arg(long)]
    pub no_page: bool,
    /// When a second run may be made to estimate the error: if it takes a few seconds, always, or never.
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = ErrorCheck::Auto)]
    pub error_check: ErrorCheck,
    /// Go on with a run that was interrupted or killed, to the same bits.
    #[arg(long)]
    pub resume: bool,
    /// Write more than 10 GB, or run for more than a day, where that is meant.
    #[arg(long)]
    pub yes: bool,
}

/// What is changed in a scene.
#[derive(Args, Clone, Debug, Default)]
pub struct Settings {
    /// Change a key of the scene: `time.dt=0.01`, `problem.inertia=[1,2,3]`, `problem.inertia[2]=2.5`. Places in lists count
    /// from 1. Nothing after the = takes the key away. May be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl Settings {
    /// A scene file or a bundled scene, with the changes; `-` is standard input.
    ///
    /// # Errors
    /// As [`Scene::open_with`].
    pub fn open(&self, scene: &Path) -> Result<Scene, SceneError> {
        Scene::open_with(scene, &self.set)
    }

    /// The options again, as they are typed in a shell.
    pub fn typed(&self) -> String {
        self.set.iter().map(|setting| format!(" --set {}", quoted(setting))).collect()
    }
}

/// A word as it is typed in a shell, in quotes if it needs them.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

impl RunArgs {
    /// The options again, as they are typed in a shell, of a run of one scene into this folder.
    pub fn options_typed(&self, folder: &Path) -> String {
        let mut typed = self.settings.typed();
        if self.out.is_some() {
            typed += &format!(" --out {}", quoted(&folder.display().to_string()));
        }
        if self.no_page {
            typed += " --no-page";
        }
        if let Some(when) =
            self.error_check.to_possible_value().filter(|_| self.error_check != ErrorCheck::Auto)
        {
            typed += &format!(" --error-check {}", when.get_name());
        }
        if self.yes {
            typed += " --yes";
        }
        typed
    }
}

/// When the error of a run is estimated by a second run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ErrorCheck {
    /// Only if it takes a few seconds.
    #[default]
    Auto,
    /// Always.
    Always,
    /// Never, except against a known exact solution.
    Never,
}

/// Options of `plot`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow plot lieflow-out/a lieflow-out/b
                                        each column with a line for each run
  lieflow plot lieflow-out/* --columns energy,m1 --out both
  lieflow plot lieflow-out/a --columns m --from 10 --to 20
                                        m1, m2 and m3 of one run, a part of its time

Written: index.html, and each figure as an SVG file.")]
pub struct PlotArgs {
    /// Folders of runs, as `lieflow run` writes them.
    #[arg(required = true, value_name = "DIR")]
    pub runs: Vec<PathBuf>,
    /// The columns to draw; m stands for m1, m2 and m3 [default: all that every run has].
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
    /// From this time on.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub from: Option<f64>,
    /// Up to this time.
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub to: Option<f64>,
    /// Folder for the page.
    #[arg(long, value_name = "DIR", default_value = "lieflow-plot")]
    pub out: PathBuf,
}

/// Options of `compare`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow compare asymmetric-top --error 1e-8
                                        which method is the fastest to this error, and why
  lieflow compare asymmetric-top --error 1e-6 --keep energy
                                        the same among methods for long times
  lieflow compare my.toml --out results --repeat 15
  lieflow compare my.toml --methods rkmk4,mr4,taylor12,exact
  lieflow compare my.toml --methods \"rkmk dopri5\" --tolerances 1e-4,1e-8,1e-12
  lieflow compare my.toml --layers closed,general --methods rkmk4,rk4

Written: index.html, speed.csv and speed.json with every run, the figures as SVG files, and points.jsonl
with everything that was measured. A comparison that is stopped goes on from there when the command is given
again. One with other options adds to it, as --repeat 9 after --repeat 5. A run that takes many times as long as the
best one to its error is timed once. With --error and without --all, methods that are many times slower than the best
are left out soon. Events of the scene are left out.")]
pub struct CompareArgs {
    /// A scene file, the name of a bundled scene, or - for standard input.
    pub scene: PathBuf,
    /// What is changed in the scene.
    #[command(flatten)]
    pub settings: Settings,
    /// The error at the end that you want, or a list of them [default: 1e-6,1e-9].
    #[arg(long = "error", value_name = "LIST", value_delimiter = ',', value_parser = wanted_error)]
    #[arg(allow_negative_numbers = true)]
    pub errors: Vec<f64>,
    /// Only methods that keep this invariant of the scene for long times, as energy: to rounding, or within bounds.
    #[arg(long, value_name = "NAME")]
    pub keep: Option<String>,
    /// Show all methods, and not the ten best.
    #[arg(long)]
    pub all: bool,
    /// Folder for the report [default: lieflow-compare/SCENE].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Shorter runs.
    #[arg(long)]
    pub quick: bool,
    /// Only these: names of methods, with parts where wanted, as in "rkmk dopri5 cay".
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub methods: Vec<String>,
    /// The layers to run on: closed, general, or closed,general [default: the scene's].
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = layer)]
    pub layers: Vec<Layer>,
    /// Tolerances for the methods that choose their steps.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = tolerance)]
    #[arg(allow_negative_numbers = true)]
    pub tolerances: Vec<f64>,
    /// Number of times that each run is timed, in turns with the others; the median is taken.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    #[arg(allow_negative_numbers = true)]
    pub repeat: Option<u32>,
    /// Measure everything again, and forget what was measured before.
    #[arg(long)]
    pub again: bool,
    /// The seed of the order in which runs take their turns.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

fn layer(text: &str) -> Result<Layer, String> {
    Layer::named(text.trim()).map_err(|error| error.to_string())
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x < 1.0 => Ok(x),
        _ => Err("expected a number between 0 and 1, as 1e-6".into()),
    }
}

fn wanted_error(text: &str) -> Result<f64, String> {
    match tolerance(text)? {
        x if x < 1e-15 => Err("expected at least 1e-15, because numbers have 16 digits".into()),
        x => Ok(x),
    }
}

/// Options of `paper`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow paper --out paper
  lieflow paper --quick

Written: paper.html, self-contained; table1.csv to table4.csv, figure3.csv to figure5.csv,
frames.csv, drift.csv, separatrix.csv; every figure as an SVG file.")]
pub struct PaperArgs {
    /// Folder for the page and the data.
    #[arg(long, value_name = "DIR", default_value = "lieflow-paper")]
    pub out: PathBuf,
    /// Fewer space frames and fewer rounds of timing; the tables are the same.
    #[arg(long)]
    pub quick: bool,
}

/// Options of `check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow check
  lieflow check --quick --json

The exit code is 0 when every check holds, and 1 when one does not.")]
pub struct CheckArgs {
    /// Fewer and shorter runs.
    #[arg(long)]
    pub quick: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Options of `scenes`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow scenes                        a line for each kind of problem and for each scene
  lieflow scenes rigid-body             the keys and the quantities of a kind, and an example
  lieflow scenes tumbling-attitude > my.toml
                                        a scene to start from
  lieflow scenes --all                  everything in full")]
pub struct ScenesArgs {
    /// Print this scene, or what a scene of this kind can say.
    pub name: Option<String>,
    /// The name is that of a kind, where a scene has the same name.
    #[arg(long, requires = "name")]
    pub kind: bool,
    /// Print everything: the description of each scene, the keys and quantities of each kind.
    #[arg(long, conflicts_with = "name")]
    pub all: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Options of `methods`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow methods                       which one to take, and all there are
  lieflow methods --for my.toml         the same for a scene
  lieflow methods --for my.toml --keep energy
                                        those for long times
  lieflow methods taylor13              what it is
  lieflow methods --json")]
pub struct MethodsArgs {
    /// Tell everything about this method.
    #[arg(conflicts_with = "scene")]
    pub name: Option<String>,
    /// Only what fits this scene: a scene file, or the name of a bundled scene.
    #[arg(long = "for", value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Of these only what keeps this invariant of the scene for long times, as energy.
    #[arg(long, value_name = "NAME", requires = "scene", conflicts_with = "name")]
    pub keep: Option<String>,
    /// What is changed in the scene.
    #[command(flatten)]
    pub settings: Settings,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Options of `order`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow order asymmetric-top          the method of the scene
  lieflow order my.toml --method \"rkmk dopri5 exp\" --method cf4
  lieflow order my.toml --method rkmk4 --steps 10 --json")]
pub struct OrderArgs {
    /// A scene file, the name of a bundled scene, or - for standard input.
    pub scene: PathBuf,
    /// What is changed in the scene.
    #[command(flatten)]
    pub settings: Settings,
    /// A method, with parts where wanted; may be given several times [default: that of the scene].
    #[arg(long = "method", value_name = "NAME")]
    pub methods: Vec<String>,
    /// The smallest number of steps; it is doubled eleven times [default: those of the scene over 16].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    #[arg(allow_negative_numbers = true)]
    pub steps: Option<u64>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Options of `completions`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Examples:
  lieflow completions bash > ~/.local/share/bash-completion/completions/lieflow
  lieflow completions zsh > ~/.zfunc/_lieflow
  lieflow completions fish > ~/.config/fish/completions/lieflow.fish")]
pub struct CompletionsArgs {
    /// The shell.
    pub shell: Shell,
}

const SCENE_HELP: &str = "Examples:
  lieflow run asymmetric-top
  lieflow run my.toml --out results
  lieflow run my.toml --out results --resume
                                        go on after Ctrl-C, a kill or a full disk
  lieflow run my.toml --set time.dt=0.01 --set 'problem.inertia=[1,2,3]'
  lieflow run a.toml b.toml --no-page   several scenes, without pages
  lieflow scenes flips | lieflow run -  a scene from standard input

The shortest scene file: lieflow chooses the method, the steps and what is written.
  [problem]
  kind = \"rigid-body\"
  inertia = [1.0, 2.0, 3.0]
  omega_body = [0.2, 0.0, 1.0]
  [time]
  t_span = [0.0, 400.0]

A scene file with everything that it can say about a rigid body:
  title = \"Asymmetric top\"           # optional
  [problem]
  kind = \"rigid-body\"
  inertia = [1.0, 2.0, 3.0]         # or the tensor as three rows, inverse_inertia, or
                                    # shape = { kind = \"box\", mass = 1, sides = [1, 2, 3] }
  omega_body = [0.2, 0.0, 1.0]      # or momentum_body
  attitude = [[1,0,0],[0,1,0],[0,0,1]]
                                    # body to space; optional
  [method]                          # optional: adaptive, of order 8
  name = \"rkmk\"                     # lieflow methods lists the names
  map = \"exp\"                       # optional: exp
  tableau = \"heun\"                  # optional: rk4; for rkmk and rk only
  q = 2                             # optional: cut of the Baker series; for exp only
  layer = \"closed\"                  # optional: closed, or general
  [time]
  t_span = [0.0, 400.0]             # may run backward; may end at inf where an event stops it
  dt = 0.05                         # or steps = 8000; optional: steps chosen by their error
  # rtol = 1e-9                     # instead of dt; the error of a step is at most
  # atol = 1e-12                    # atol + rtol times the size; optional: 0; one is needed
  # tolerance = \"per-step\"          # optional; \"per-length\": rtol is relative to the length of the step
  # h_init = 0.01                   # optional, as are h_min, h_max, max_steps
  [[events]]                        # optional; any number of them
  name = \"flip\"
  when = \"m2\"                       # a column, or a formula of columns, t and parameters
  direction = \"rising\"              # optional: both; or falling
  stop_after = 3                    # optional: the zero that ends the run
  [output]                          # optional
  quantities = [\"momentum_body\"]    # optional; lieflow scenes lists what there is
  every = 10                        # or count = 100, interval = 4.0, times = [1.5, 20]
  # times_by = \"dense\"              # optional, with times; or steps
  error_check = true                # optional: false makes no second run to estimate the error

Written: trajectory.csv, a column t and the columns of each quantity, 17 significant digits, the
start first and the end last; events.csv, a line for each event; summary.json, what was modelled and run,
the errors of the rows and of the times of events, the drift of each invariant, and a warning where
a run is wrong or a method did not keep what it promises; index.html with figures, and each as an SVG
file. When a step fails, the rows up to it are in trajectory.partial.csv, a trajectory.csv of a run
before stays, and the exit code is 2.
It is 130 after Ctrl-C, and 1 where a file cannot be written, the disk is full or a run wrote 10 GB;
--resume goes on from there.";
