//! What a run is judged by: the exact end, or one that two methods agree on; and the invariants.

use lieflow::catalog::MethodSpec;
use lieflow::tolerance::Rule;
use lieflow::{RunError, StepControl};
use lieflow::{SaveAt, TimeGrid};

use super::{Candidate, Size, WorkPoint};
use crate::cmd::CliError;
use lieflow_model::model::{Model, Sink, Steps};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Observable, Row, Schema};

/// Where the end comes from that errors are measured against.
#[derive(Clone, Debug, PartialEq)]
pub enum Reference {
    /// The exact solution.
    Exact {
        /// How far it ends from itself in seven steps, relative: an estimate of its rounding; none
        /// where it is no method too.
        apart: Option<f64>,
    },
    /// A run at the finest tolerance.
    Own {
        /// Its method.
        by: String,
        /// The independent one that it is compared with.
        beside: String,
        /// The relative distance of the two: an estimate of the error of the reference.
        apart: f64,
    },
}

impl Reference {
    /// An estimate of the relative error of the reference.
    pub fn error(&self) -> Option<f64> {
        match self {
            Reference::Exact { apart } => *apart,
            Reference::Own { apart, .. } => Some(*apart),
        }
    }

    /// A sentence that says what the reference is.
    pub fn in_words(&self) -> String {
        match self {
            Reference::Exact { apart: None } => "the exact solution".into(),
            Reference::Exact { apart: Some(apart) } => format!(
                "the exact solution, which ends {apart:.0e} away, relative, when it goes in seven \
                 steps: errors below that are rounding"
            ),
            Reference::Own { by, beside, apart } => {
                let verdict = if *apart <= AGREE { "they agree" } else { "they do NOT agree" };
                format!(
                    "{by} at a tolerance of {TIGHT:e}; {beside} ends {apart:.1e} away, relative \
                     ({verdict}): errors below some {apart:.0e} say nothing"
                )
            }
        }
    }
}

/// The tolerance of a reference run.
const TIGHT: f64 = 1e-13;
/// The steps of the exact motion that say how much it rounds.
const PARTS: u64 = 7;
/// Two reference runs that are closer than this agree.
const AGREE: f64 = 1e-9;

/// The methods of a reference, of different kinds: the first two that fit are taken.
fn reference_methods() -> Vec<MethodSpec> {
    let with = |name: &str, tableau: &str| MethodSpec {
        tableau: Some(tableau.into()),
        ..MethodSpec::new(name, None)
    };
    vec![
        with("rkmk", "dop853"),
        MethodSpec::new("taylor16", None),
        MethodSpec::new("magnus8", None),
        MethodSpec::new("gauss6", None),
        MethodSpec::new("cf-ls5", None),
        with("rk", "dop853"),
    ]
}

/// The exact end of a run, with the quantities that a run is judged by.
#[derive(Debug)]
pub struct Judge {
    state: &'static [&'static str],
    /// The state and the invariants.
    schema: Schema,
    end: Vec<f64>,
    /// Where the end comes from.
    pub reference: Reference,
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Judge {
    /// For runs of the problem of `scene` over a span.
    ///
    /// # Errors
    /// The problem cannot be set up, or no reference can be computed.
    pub fn new(scene: &Scene, quantities: &[&str], t_span: [f64; 2]) -> Result<Self, CliError> {
        let (mut judge, model) = Self::without_end(scene, quantities)?;
        match model.exact(t_span) {
            Some(Ok(exact)) => {
                judge.end = exact;
                judge.reference = Reference::Exact { apart: judge.rounding(&*model, t_span) };
            }
            _ => judge.find_end(&*model, t_span)?,
        }
        Ok(judge)
    }

    /// A judge with a reference of two runs, whether an exact solution is known or not.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn by_two_runs(
        scene: &Scene,
        quantities: &[&str],
        t_span: [f64; 2],
    ) -> Result<Self, CliError> {
        let (mut judge, model) = Self::without_end(scene, quantities)?;
        judge.find_end(&*model, t_span)?;
        Ok(judge)
    }

    /// A judge that knows no end yet, and the model that a reference is computed with.
    fn without_end(scene: &Scene, quantities: &[&str]) -> Result<(Self, Box<dyn Model>), CliError> {
        let state = scene.problem.state(quantities);
        let judged = [state, &scene.problem.invariants(quantities)].concat();
        // The first layer of the problem.
        let layer = scene.problem.layers().first().copied().unwrap_or(scene.layer);
        let model = scene.model_with(layer, &judged)?;
        let (schema, reference) = (model.schema().clone(), Reference::Exact { apart: None });
        Ok((Judge { state, schema, end: Vec::new(), reference }, model))
    }

    fn find_end(&mut self, model: &dyn Model, t_span: [f64; 2]) -> Result<(), CliError> {
        let control = per_length(TIGHT, TIGHT)?.max_steps(10_000_000)?;
        let mut ends: Vec<(String, Vec<f64>)> = Vec::new();
        for method in reference_methods() {
            let mut last = Vec::new();
            let outcome = model.adapt(&method, t_span, &control, &mut |_, row| {
                last = row.values().to_vec();
            });
            match outcome {
                Ok(_) => ends.push((method.label(), last)),
                Err(RunError::Setup(_)) => continue,
                Err(error) => {
                    return Err(CliError::Message(format!(
                        "no reference solution: {} stopped: {error}",
                        method.label()
                    )));
                }
            }
            if let [(by, a), (beside, b)] = &ends[..] {
                self.end = a.clone();
                let apart = self.error(b);
                let (by, beside) = (by.clone(), beside.clone());
                self.reference = Reference::Own { by, beside, apart };
                return Ok(());
            }
        }
        Err(CliError::Message("no two methods for a reference solution fit this problem".into()))
    }

    /// How far from its end the exact motion comes in [`PARTS`] steps.
    fn rounding(&self, model: &dyn Model, t_span: [f64; 2]) -> Option<f64> {
        let mut last = Vec::new();
        let mut see = |_: f64, row: Row<'_>| last = row.values().to_vec();
        Size::Steps(PARTS).run(model, &MethodSpec::new("exact", None), t_span, &mut see).ok()?;
        Some(self.error(&last)).filter(|apart| apart.is_finite())
    }

    /// What a model must compute for [`point`](Self::point).
    pub fn quantities(&self) -> Vec<&'static str> {
        self.schema.iter().map(|observable| observable.name).collect()
    }

    /// Run once, and judge.
    pub fn point(
        &self,
        model: &dyn Model,
        candidate: &Candidate,
        t_span: [f64; 2],
        size: Size,
    ) -> WorkPoint {
        let (mut first, mut last) = (Vec::new(), Vec::new());
        let mut see = |_: f64, row: Row<'_>| {
            if first.is_empty() {
                first = row.values().to_vec();
            }
            last = row.values().to_vec();
        };
        let mut point = WorkPoint::new(t_span, size);
        let outcome = size.run(model, &candidate.method, t_span, &mut see);
        match outcome {
            Ok(done) => {
                let length = (t_span[1] - t_span[0]).abs();
                (point.steps, point.rejected) = (done.steps, done.rejected);
                point.h = length / done.steps.max(1) as f64;
                point.evaluations = done
                    .evaluations
                    .or_else(|| candidate.evaluations_per_step().map(|n| n * done.steps));
                point.error = self.error(&last);
                let [first, last] = [&first, &last].map(|values| self.schema.row(values));
                for law in self.schema.laws() {
                    for (&start, &end) in first[law].iter().zip(&last[law]) {
                        let moved = relative(end - start, start);
                        match law.name {
                            "energy" => point.energy_error = moved,
                            // A defect is a distance from the group already.
                            name if name.ends_with("defect") => point.group_residual = end,
                            _ => point.casimir_error = moved.max(point.casimir_error),
                        }
                    }
                }
            }
            Err(failure) => point.failure = Some(failure),
        }
        point
    }

    /// The largest relative distance of a part of the state from the reference.
    fn error(&self, values: &[f64]) -> f64 {
        let [row, end] = [values, &self.end].map(|values| self.schema.row(values));
        let part = |part: &Observable| {
            let (x, end) = (&row[part], &end[part]);
            let gap: Vec<f64> = x.iter().zip(end).map(|(x, e)| x - e).collect();
            relative(norm(&gap), norm(end))
        };
        // A part that is no number has left the solution: `f64::max` would forget it.
        let worst = |a: f64, b: f64| if a >= b || a.is_nan() { a } else { b };
        let state = self.schema.iter().filter(|part| self.state.contains(&part.name));
        state.map(part).fold(0.0, worst)
    }
}

/// Tolerances relative to the length of the step. The error of a run then follows rtol, whatever the order of the
/// method.
fn per_length(rtol: f64, atol: f64) -> Result<StepControl, lieflow::Error> {
    Ok(StepControl::new(rtol, atol)?.rule(Rule::PerLength))
}

fn relative(gap: f64, size: f64) -> f64 {
    if size == 0.0 { gap.abs() } else { (gap / size).abs() }
}

/// What a run did.
#[derive(Clone, Copy, Debug)]
pub struct Done {
    steps: u64,
    rejected: u64,
    evaluations: Option<u64>,
}

impl Size {
    /// The operations of a run that took so many steps, rejected ones among them; none where the
    /// problem or the method does not run on numbers that count.
    pub fn operations(
        self,
        model: &dyn Model,
        method: &MethodSpec,
        t_span: [f64; 2],
        steps: u64,
    ) -> Option<u64> {
        let a_step = match self {
            Size::Steps(steps) => {
                let grid = TimeGrid::with_steps(t_span, steps).ok()?;
                model.operations(method, &Steps::Equal(grid))?
            }
            Size::Tolerance(rtol) => {
                let control = per_length(rtol, 0.0).ok()?;
                model.operations(method, &Steps::ByError { t_span, control })?
            }
        };
        Some((a_step * steps as f64).round() as u64)
    }

    /// Run a method over a span in steps of this size; why not, in words.
    ///
    /// # Errors
    /// The run did not reach its end.
    pub fn run(
        self,
        model: &dyn Model,
        method: &MethodSpec,
        t_span: [f64; 2],
        sink: &mut Sink<'_>,
    ) -> Result<Done, String> {
        match self {
            Size::Steps(steps) => {
                let grid = TimeGrid::with_steps(t_span, steps).map_err(|e| e.to_string())?;
                let stats = model.run(method, &grid, &SaveAt::Ends, sink);
                let stats = stats.map_err(|error| error.to_string())?;
                Ok(Done { steps: stats.accepted, rejected: 0, evaluations: None })
            }
            Size::Tolerance(rtol) => {
                let control = per_length(rtol, 0.0).map_err(|error| error.to_string())?;
                let stats = model.adapt(method, t_span, &control, sink);
                let stats = stats.map_err(|error| error.to_string())?;
                Ok(Done {
                    steps: stats.accepted,
                    rejected: stats.rejected,
                    evaluations: stats.evaluations,
                })
            }
        }
    }
}
