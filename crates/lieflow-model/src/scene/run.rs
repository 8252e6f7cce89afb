//! A scene: what a run is asked for, read from a file and checked.

use std::hash::{Hash, Hasher};
use std::path::Path;

use super::columns::{Columns, FORMULAS, FormulaColumn, each_once, with_formulas};
use super::defaults::{self, Defaults, INTERVALS};
use super::document::{Document, Finder, with_file};
use super::error::SceneError;
use super::events::{self, EventKeys, SceneEvent};
use super::files::read_samples;
use super::keys::{Limits, MethodKeys, OutputKeys, ROWS, Rows, TimeKeys, Times, with_defaults};
use super::plot::{PlotFigure, check_plot};
use super::units::UnitKeys;
use crate::kinds;
use crate::problem::{FormulaKeys, KNOTS_MAX, Kind, Layer, Model, Plan, Problem, SAMPLES, Steps};
use crate::reader::{Is, KeyPath, Mistake, ReadError, Refusal, Tree, Value, seen};
use fnv::FnvHasher;
use lieflow::StepControl;
use lieflow::catalog::{MethodSpec, all_methods};
use lieflow::samples::{Outside, Samples};
use lieflow::solve::Stops;
use lieflow::{Error, SaveAt, TimeGrid};
use lieflow_runs::schema::{Schema, Units};

/// A run, stated in full and checked.
#[derive(Debug)]
pub struct Scene {
    /// Its title.
    pub title: String,
    /// Its name: that of the file, without `.toml`.
    pub name: String,
    /// What messages call it.
    source: String,
    /// The problem.
    pub problem: Problem,
    /// The keys of the problem, without `kind`. A file of samples is its name and its text.
    pub keys: Tree,
    /// The method, with the parts that it takes by default spelt out.
    pub method: MethodSpec,
    /// The layer.
    pub layer: Layer,
    /// The steps of one size; where `adaptive` chooses, those that `compare` starts from.
    pub grid: TimeGrid,
    /// The tolerances and limits of its steps.
    limits: Limits,
    /// Tolerances and limits of steps that are chosen by their error, where the scene has them.
    pub adaptive: Option<StepControl>,
    /// The limit of the attempts, where the scene has one.
    pub max_steps: Option<u64>,
    /// Does a step end at each knot of the problem? None: where steps are chosen by their error, or samples are held.
    at_knots: Option<bool>,
    /// Where the problem jumps, as the scene says: a step ends at each.
    jumps: Vec<f64>,
    /// Where rows are written.
    pub save: SaveAt,
    /// Are output times reached by shorter steps, and not by the continuous extension?
    pub times_by_steps: bool,
    /// The events.
    pub events: Vec<SceneEvent>,
    /// What is written, in this order; `formulas` is that of `[output.formulas]`.
    pub quantities: Vec<String>,
    /// Does a run say how large its error is, where that costs a second run?
    pub error_check: bool,
    /// The choices that the scene left to the program.
    pub by_default: Defaults,
    /// The text of the scene.
    pub text: String,
    /// The text of its file, without settings.
    file: String,
    /// The columns of `[output.formulas]`.
    formulas: Vec<FormulaColumn>,
    /// The figures to draw. Empty if the kind chooses.
    pub plot: Vec<PlotFigure>,
    /// A number of what the scene states, with its samples: another one for another scene. Comments and spaces do not
    /// count.
    pub fingerprint: u64,
    /// The names of units.
    pub units: Units,
}

impl Scene {
    /// Read a scene. `source` is what messages call it, and its file stem is the scene's name. Files that the scene
    /// names stand beside it.
    ///
    /// # Errors
    /// [`SceneError`] with all mistakes that are found. A scene that is returned can be run.
    pub fn parse(source: &str, text: &str) -> Result<Scene, SceneError> {
        Self::read(source, [text; 2], Path::new(source).parent())
    }

    /// Read a scene whose files stand in `folder`, or else come with the program. The texts are that with settings, and
    /// that of the file.
    pub(super) fn read(
        source: &str,
        [text, file]: [&str; 2],
        folder: Option<&Path>,
    ) -> Result<Scene, SceneError> {
        let document = Document::parse(source, text, file)?;
        let mut finder = Finder::new(&document);
        finder.keep("", document.check_top());
        let title = document.get("title").and_then(|title| finder.read::<String>("", title));

        let units = finder.read_if_any::<UnitKeys>("units");
        let units = units.and_then(|units| finder.keep("units", units.resolve()));

        let kind = finder.keep("problem", read_kind(&document));
        let problem =
            kind.and_then(|kind| finder.keep("problem", read_problem(&document, kind, folder)));
        let (problem, keys) = problem.unzip();
        let spec = problem.as_ref();

        let method = finder.read_if_any::<MethodKeys>("method");
        let method_left = method.as_ref().is_some_and(MethodKeys::is_left);
        let method = method.and_then(|method| finder.keep("method", method.resolve(spec)));

        let times = finder.keep("time", document.section("time"));
        let times = times.and_then(|section| finder.read::<TimeKeys>("time", section));
        let t_span = times.as_ref().and_then(TimeKeys::t_span);
        let times = times.and_then(|times| finder.keep("time", times.resolve()));
        let steps_left = times.as_ref().is_some_and(|times| times.limits.is_left);
        let at_knots = times.as_ref().zip(spec).and_then(|(times, problem)| {
            finder.keep("time", times.at_knots(problem.knots([0.0, 0.0]).is_some()))
        });
        if let (Some(t_span), Some(problem)) = (t_span, spec) {
            // Beyond its samples a formula has no value.
            let covered = finder.keep("time", covered(problem, t_span));
            let without_value = covered.map(|()| problem.check_start(t_span[0]));
            finder.refuse("problem", without_value.unwrap_or_default());
        }

        let mut output = finder.read_if_any::<OutputKeys>("output");
        if let (Some(output), Some(kind)) = (&mut output, kind) {
            output.spell(kind);
            finder.refuse("output", output.wrong_quantities(kind, spec));
        }
        let asked = output.as_ref().and_then(|output| output.quantities.clone().ok()?);
        let by_default = Defaults {
            method: method_left,
            steps: steps_left,
            quantities: asked.is_none(),
            rows: output.as_ref().is_some_and(OutputKeys::leaves_rows),
        };
        let asked = asked.or_else(|| spec.map(defaults::quantities)).unwrap_or_default();
        let rows = output
            .as_ref()
            .and_then(|output| finder.keep("output", output.rows(t_span, steps_left)));

        let mut columns = spec.and_then(|problem| {
            let named = FormulaKeys {
                parameters: Ok(document.within("problem", "parameters").unwrap_or_default()),
                r#let: Ok(document.within("problem", "let").unwrap_or_default()),
            };
            finder.keep("problem", Columns::of(problem, &asked, &named))
        });
        let formulas = output.as_ref().and_then(|output| {
            let formulas = seen(&output.formulas).and_then(|lets| match columns.as_mut() {
                Some(columns) => columns.define(lets),
                None => lets.check_form(FORMULAS).and_then(|()| Err(ReadError::known())),
            });
            finder.keep("output", formulas)
        });
        let plot = output.and_then(OutputKeys::figures);
        if let (Some(plot), Some(problem), Some(formulas)) = (&plot, spec, &formulas) {
            finder.keep("output", check_plot(plot, problem, &asked, formulas));
        }

        let events = finder.keep("events", document.entries("events"));
        let events = events.and_then(|entries| read_events(&mut finder, entries, columns.as_ref()));
        if let (Some(t_span), Some(events)) = (t_span, &events)
            && !t_span[1].is_finite()
            && events.iter().all(|event| event.stop_after.is_none())
        {
            let message =
                "t_span has no end, expected an event with `stop_after` that ends the run";
            finder.refuse("time", vec![Refusal::at("t_span".index(1), message)]);
        }

        let all = || {
            let problem = problem.zip(keys);
            Some((problem?, method?, at_knots?, times?, rows?, plot?, formulas?, events?, units?))
        };
        let (whole, (method, layer), at_knots, times, rows, plot, formulas, events, units) =
            finder.or(all())?;
        let (problem, keys) = whole;
        let Times { grid, control: adaptive, limits, stops: jumps, .. } = times;
        let Rows { save, times_by_steps, error_check } = rows;
        let mut quantities = asked;
        if !formulas.is_empty() {
            quantities.push(FORMULAS.into());
        }
        let stem = Path::new(source).file_stem().unwrap_or_default().to_string_lossy();
        // A folder may have this name.
        let is_name = !stem.trim_matches('.').is_empty();
        let name = if is_name { stem.into_owned() } else { "scene".into() };
        let fingerprint = fingerprint(&document.says(), &problem);
        let mut scene = Scene {
            title: title.map_or(name.clone(), |title| title.replace(char::is_control, " ")),
            name,
            source: source.into(),
            problem,
            keys,
            method,
            layer,
            grid,
            limits,
            adaptive,
            max_steps: limits.max_steps,
            at_knots,
            jumps,
            save,
            times_by_steps,
            events,
            quantities,
            error_check,
            by_default,
            text: text.into(),
            file: file.into(),
            formulas,
            plot,
            fingerprint,
            units,
        };
        if scene.stops(scene.grid.t_span()).len() > KNOTS_MAX {
            let has_end = scene.grid.t_span()[1].is_finite();
            let span = if has_end { "a shorter span" } else { "a span with an end" };
            let message = format!(
                "a step has to end at more than {KNOTS_MAX} times in t_span, expected {span}, or `at_knots = false`, with \
                 which steps pass over them"
            );
            return Err(document.refusal("time", Refusal::at("t_span", message)));
        }
        let model = scene.model_with(scene.layer, &scene.computed());
        let model = model.map_err(|error| document.refusal("problem", error.into()))?;
        model.fits(&scene.method).map_err(|error| {
            let mut refusal = Refusal::from(error);
            if refusal.help.is_none() && scene.fits_in_no_way(&model) {
                refusal.key = Some("name".into());
                refusal.help = Some(format!("methods that fit: {}", fitting(&model).join(", ")));
            }
            document.refusal("method", refusal)
        })?;
        if scene.by_default.steps {
            let order = model.order(&scene.method).unwrap_or(None);
            let start = model.start(&scene.method).unwrap_or_default();
            scene.limits.take(defaults::tolerances(order, &start));
            scene.adaptive = scene.limits.control(1.0).ok();
        }
        if let Some(control) = &scene.adaptive {
            let checked = model.check_tolerance(&scene.method, control.tolerance());
            checked.map_err(|error| document.refusal("time", error.into()))?;
        }
        Ok(scene)
    }

    /// The choices that the scene left to the program, in words; none if the scene says everything.
    pub fn chosen_by_default(&self) -> Option<String> {
        let (Defaults { method, steps, quantities, rows }, mut chosen) =
            (self.by_default, Vec::new());
        if method {
            chosen.push(format!("method {}", self.method.label()));
        }
        if steps {
            let [rtol, atol] = self.limits.tolerances();
            let equal =
                if rtol == atol { " = atol".into() } else { format!(" = {rtol:.0e}, atol") };
            chosen.push(format!("adaptive steps with rtol{equal} = {atol:.0e}"));
        }
        if quantities {
            chosen.push(format!("quantities {}", self.quantities.join(", ")));
        }
        if rows && steps && self.grid.t_span()[1].is_finite() {
            chosen.push(format!("rows at {INTERVALS} equal intervals"));
        }
        (!chosen.is_empty()).then(|| chosen.join("; "))
    }

    /// The steps of the run.
    pub fn steps(&self) -> Steps {
        match &self.adaptive {
            None => Steps::Equal(self.grid),
            Some(control) => {
                Steps::ByError { t_span: self.grid.t_span(), control: control.clone() }
            }
        }
    }

    /// rtol and atol, where steps are chosen by their error.
    pub fn tolerances(&self) -> Option<[f64; 2]> {
        self.adaptive.as_ref().map(|_| self.limits.tolerances())
    }

    /// A run to time t that shows its ends and sees no events, with the step size or the tolerances times a factor.
    /// Steps that are chosen by their error are at most `largest` long.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a factor that makes a step or a tolerance too small.
    pub fn plan_to(
        &self,
        t: f64,
        factor: f64,
        largest: Option<f64>,
    ) -> Result<Plan<'static>, Error> {
        let t_span = [self.grid.t_span()[0], t];
        let steps = match self.adaptive {
            None => Steps::Equal(TimeGrid::new(t_span, factor * self.grid.h().abs())?),
            Some(_) => {
                let control = limited(self.limits.control(factor)?, largest)?;
                Steps::ByError { t_span, control }
            }
        };
        Ok(Plan { stops: self.stops(t_span), ..Plan::new(steps, SaveAt::Ends) })
    }

    /// The method of a scene of this problem that names none.
    pub fn default_method(&self) -> MethodSpec {
        with_defaults(self.problem.default_method())
    }

    /// The same run as [`plan_to`](Self::plan_to) with the steps of a scene that names none, for a method of this
    /// order.
    ///
    /// # Errors
    /// Those of [`plan_to`](Self::plan_to).
    pub fn default_plan_to(
        &self,
        t: f64,
        factor: f64,
        largest: Option<f64>,
        order: Option<usize>,
    ) -> Result<Plan<'static>, Error> {
        let t_span = [self.grid.t_span()[0], t];
        let start = self.model()?.start(&self.default_method())?;
        let [rtol, atol] = defaults::tolerances(order, &start).map(|tolerance| factor * tolerance);
        let control = limited(StepControl::new(rtol, atol)?, largest)?;
        let stops = self.stops_of(true, t_span);
        Ok(Plan { stops, ..Plan::new(Steps::ByError { t_span, control }, SaveAt::Ends) })
    }

    /// A refusal of a value of the scene, with its place.
    pub fn refuse(&self, section: &str, refusal: Refusal) -> SceneError {
        match Document::parse(&self.source, &self.text, &self.file) {
            Ok(document) => document.refusal(section, refusal),
            Err(error) => error,
        }
    }

    /// The key that says where rows are written.
    pub fn rows_key(&self) -> &'static str {
        let document = Document::parse(&self.source, &self.text, &self.file);
        let output = document.as_ref().ok().and_then(|document| document.section("output").ok());
        let mut given =
            ROWS.into_iter().filter(|key| output.is_some_and(|output| output.get(key).is_some()));
        given.next().unwrap_or("interval")
    }

    /// What a run is asked for, on rows of this schema.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a schema without a quantity of an event.
    pub fn plan(&self, schema: &Schema) -> Result<Plan<'_>, Error> {
        Ok(Plan {
            times_by_steps: self.times_by_steps,
            events: self.events.iter().map(|event| event.plan(schema)).collect::<Result<_, _>>()?,
            max_steps: self.max_steps,
            stops: self.stops(self.grid.t_span()),
            ..Plan::new(self.steps(), self.save.clone())
        })
    }

    /// The times at which a step of the run ends.
    fn stops(&self, t_span: [f64; 2]) -> Stops {
        self.stops_of(self.adaptive.is_some(), t_span)
    }

    /// The times at which a step ends, where steps are chosen by their error, or else of one size: those of the scene, and
    /// the knots of the problem, where they are asked for.
    pub fn stops_of(&self, by_error: bool, t_span: [f64; 2]) -> Stops {
        let knots = || self.problem.knots(t_span);
        let mut stops = self.ends_at_knots(by_error).then(knots).flatten().unwrap_or_default();
        stops.jumps.extend(&self.jumps);
        stops
    }

    /// Does a step end at each knot of the problem? Steps of one size do so by default where samples are held.
    fn ends_at_knots(&self, by_error: bool) -> bool {
        let is_held = |samples: &Samples| samples.interpolation().jumps();
        self.at_knots.unwrap_or_else(|| by_error || self.problem.samples().is_some_and(is_held))
    }

    /// Does the scene state the number of steps, and not their size?
    pub fn counts_steps(&self) -> bool {
        self.limits.counts_steps
    }

    /// The limit of the step size, where steps are chosen by their error.
    pub fn largest_step(&self) -> Option<f64> {
        self.limits.h_max
    }

    /// True if steps may pass over knots of the problem.
    pub fn passes_knots(&self) -> bool {
        let knots = self.problem.knots(self.grid.t_span());
        !self.ends_at_knots(self.adaptive.is_some()) && knots.is_some_and(|knots| !knots.is_empty())
    }

    /// The quantities that a run computes: those that are written, then those of formulas and events.
    pub fn computed(&self) -> Vec<&str> {
        let of_events = self.events.iter().flat_map(SceneEvent::quantities);
        let written = self.quantities.iter().map(String::as_str);
        each_once(written.chain(self.of_formulas()).chain(of_events))
    }

    /// The quantities that `[output.formulas]` is made of.
    fn of_formulas(&self) -> impl Iterator<Item = &str> {
        self.formulas.iter().flat_map(|column| column.formula.quantities())
    }

    /// The problem on the layer of the scene, with the quantities of the scene.
    ///
    /// # Errors
    /// [`lieflow::Error`] for a problem that cannot be set up; not after [`parse`](Self::parse).
    pub fn model(&self) -> Result<Model, Error> {
        let quantities: Vec<&str> = self.quantities.iter().map(String::as_str).collect();
        self.model_with(self.layer, &quantities)
    }

    /// Does the method of the scene not run on the model, whatever its parts?
    fn fits_in_no_way(&self, model: &Model) -> bool {
        model.fits(&MethodSpec::new(&self.method.name, None)).is_err()
    }

    /// The problem on any layer with any quantities.
    ///
    /// # Errors
    /// [`Error::UnknownName`] for a quantity that the problem does not have.
    pub fn model_with(&self, layer: Layer, quantities: &[&str]) -> Result<Model, Error> {
        if !quantities.contains(&FORMULAS) {
            return self.problem.model(layer, quantities);
        }
        let asked = each_once(quantities.iter().copied().filter(|name| *name != FORMULAS));
        let of_problem = each_once(asked.iter().copied().chain(self.of_formulas()));
        with_formulas(self.problem.model(layer, &of_problem)?, asked.len(), &self.formulas)
    }
}

/// A hash of what the scene states and of its samples: the same on every machine.
fn fingerprint(stated: &str, problem: &Problem) -> u64 {
    let mut hasher = FnvHasher::default();
    hasher.write(stated.as_bytes());
    if let Some(formula) = problem.formula() {
        formula.samples().hash(&mut hasher);
        formula.sample_names().hash(&mut hasher);
    }
    hasher.finish()
}

/// The names of the methods that run on a problem, with their default parts.
fn fitting(model: &Model) -> Vec<&'static str> {
    let fits = |name: &str| model.fits(&MethodSpec::new(name, None)).is_ok();
    all_methods().map(|info| info.name).filter(|name| fits(name)).collect()
}

/// The kind of problem that a scene names.
fn read_kind(document: &Document<'_>) -> Result<&'static Kind, ReadError> {
    let section = document.section("problem")?;
    let kind = section.get("kind");
    let kind = kind.ok_or_else(|| Mistake::MissingKey(section.place.clone(), "kind"))?;
    let name = kind.as_text();
    let name = name.ok_or_else(|| ReadError::expected(kind, "the name of a problem"))?;
    kinds::named(name).map_err(|error| Refusal::from(error).about("kind").into())
}

fn read_problem(
    document: &Document<'_>,
    kind: &'static Kind,
    folder: Option<&Path>,
) -> Result<(Problem, Tree), ReadError> {
    let mut section = document.section("problem")?.clone();
    if let Is::Table(keys) = &mut section.is {
        keys.remove("kind");
    }
    let mut mistakes = ReadError::default();
    if kind.keys.contains(&SAMPLES) {
        let file = |name: &str| read_samples(folder, name);
        mistakes.keep(with_file(&mut section, SAMPLES.name, kind.keys, file));
    }
    let problem = mistakes.keep(kind.read_problem(&section));
    mistakes.or(problem.map(|problem| (problem, Tree::of(&section))))
}

/// The events, where all of them can be used.
fn read_events(
    finder: &mut Finder<'_, '_>,
    entries: &[Value],
    columns: Option<&Columns>,
) -> Option<Vec<SceneEvent>> {
    let names = entries.iter().map(|entry| {
        let name = entry.get("name").and_then(Value::as_text);
        name.unwrap_or_default()
    });
    let names: Vec<&str> = names.collect();
    let events = entries.iter().enumerate().map(|(i, entry)| {
        let keys = finder.read::<EventKeys>("events", entry)?;
        finder.keep("events", events::resolve(keys, i, &names[..i], columns))
    });
    // Each is read, also after one that is wrong.
    let events: Vec<_> = events.collect();
    events.into_iter().collect()
}

/// A run stays in the span of the samples.
fn covered(problem: &Problem, [t0, t1]: [f64; 2]) -> Result<(), Refusal> {
    let Some(samples) = problem.samples() else { return Ok(()) };
    samples.covers([t0, t1]).map_err(|Outside { span: [first, last], .. }| {
        let spans = format!("[{t0}, {t1}], and the samples span {first} to {last}");
        Refusal::at("t_span", format!("t_span = {spans}"))
    })
}

/// The control with a limit of the steps.
fn limited(control: StepControl, largest: Option<f64>) -> Result<StepControl, Error> {
    largest.map_or(Ok(control.clone()), |h| control.max_step(h))
}
