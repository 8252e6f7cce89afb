//! Speed against error: runs that are timed fairly and judged by the exact solution.
//!
//! Times are CPU time of this thread, medians over rounds; a round visits every method and step
//! once, so that a slow moment of the machine meets all of them.

mod clock;
mod curve;

pub use clock::{cpu_seconds, machine};
pub use curve::{Curve, WorkPoint};

use std::time::{Duration, Instant};

use lieflow::catalog::{MAPS, METHODS, MethodSpec, TABLEAUS};
use lieflow::{RunError, SaveAt, TimeGrid};

use crate::cmd::CliError;
use crate::model::{Layer, Model};
use crate::scene::Scene;

/// A method on a layer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Candidate {
    /// The method.
    pub method: MethodSpec,
    /// The layer.
    pub layer: Layer,
}

impl Candidate {
    /// RKMK4 with a map on a layer.
    pub fn rkmk4(map: &str, layer: Layer) -> Self {
        Candidate { method: MethodSpec::new("rkmk4", Some(map)), layer }
    }

    /// Classical RK4 on the entries.
    pub fn rk4(layer: Layer) -> Self {
        Candidate { method: MethodSpec::new("rk4", None), layer }
    }

    /// Its name in tables and legends.
    pub fn label(&self) -> String {
        match self.layer {
            Layer::Closed => self.method.label(),
            Layer::General => format!("{}, general", self.method.label()),
        }
    }

    /// The figure that it belongs to: its tableau, or the family of a method that has none.
    pub fn family(&self) -> &str {
        match self.method.name.as_str() {
            "rkmk4" | "rk4" => "rk4",
            name if name.starts_with("cf") => "commutator-free",
            name if name.starts_with("cg") => "crouch-grossman",
            _ => self.method.tableau.as_deref().unwrap_or("few-brackets"),
        }
    }

    /// Everything in the catalog that runs on the problem of `scene`, each with the tableaus and
    /// maps that it takes. A tableau that has a method of its own is listed under that.
    ///
    /// # Errors
    /// The problem cannot be set up.
    pub fn all_that_fit(scene: &Scene, quantities: &[&str]) -> Result<Vec<Self>, CliError> {
        let mut fitting = Vec::new();
        for layer in Layer::ALL {
            let model = scene.model_with(layer, quantities)?;
            for info in METHODS {
                let none = [None];
                let maps: Vec<Option<&str>> = match info.takes_map {
                    true => MAPS.iter().map(|map| Some(map.name)).collect(),
                    false => none.into(),
                };
                let tableaus: Vec<Option<&str>> = match info.takes_tableau {
                    true => TABLEAUS.iter().filter(|t| **t != "rk4").map(|t| Some(*t)).collect(),
                    false => none.into(),
                };
                for tableau in &tableaus {
                    for map in &maps {
                        let mut method = MethodSpec::new(info.name, *map);
                        method.tableau = tableau.map(Into::into);
                        if model.fits(&method).is_ok() {
                            fitting.push(Candidate { method, layer });
                        }
                    }
                }
            }
        }
        Ok(fitting)
    }
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Rounds of timing.
    pub rounds: u32,
    /// A step size whose single run takes longer is left out, with all smaller ones.
    pub longest: Duration,
    /// A shorter run is repeated within a round until it has taken this long.
    pub shortest: Duration,
}

/// Measure every candidate on `scene` over `t_span` in each number of steps, against the exact
/// solution at its end. `tick` is called after every run with the share of the work that is done.
///
/// # Errors
/// The problem cannot be set up, or has no exact solution.
pub fn speed_against_error(
    scene: &Scene,
    quantities: &[&str],
    candidates: &[Candidate],
    t_span: [f64; 2],
    steps: &[u64],
    effort: Effort,
    mut tick: impl FnMut(f64),
) -> Result<Vec<Curve>, CliError> {
    let judge = Judge::new(scene, quantities, t_span)?;
    let mut curves = Vec::new();
    let mut jobs = Vec::new();
    for (i, candidate) in candidates.iter().enumerate() {
        let model = scene.model_with(candidate.layer, &judge.quantities())?;
        let mut curve = Curve::new(candidate.clone(), model.order(&candidate.method)?);
        for &steps in steps {
            let grid = TimeGrid::with_steps(t_span, steps)?;
            let start = Instant::now();
            let point = judge.point(&*model, &candidate.method, &grid);
            let took = start.elapsed();
            if point.failure.is_none() {
                let repeats = effort.shortest.as_secs_f64() / took.as_secs_f64().max(1e-9);
                jobs.push(Job {
                    curve: i,
                    point: curve.points.len(),
                    grid,
                    repeats: repeats.ceil().max(1.0) as u32,
                    times: Vec::new(),
                });
            }
            curve.points.push(point);
            if took > effort.longest {
                break;
            }
        }
        curves.push((curve, model));
        tick(0.2 * (i + 1) as f64 / candidates.len() as f64);
    }
    let all = f64::from(effort.rounds) * jobs.len() as f64;
    let mut done = 0.0;
    for _ in 0..effort.rounds {
        for job in &mut jobs {
            let (curve, model) = &curves[job.curve];
            job.time(&**model, &curve.candidate.method)?;
            done += 1.0;
            tick(0.2 + 0.8 * done / all);
        }
    }
    let length = (t_span[1] - t_span[0]).abs();
    for mut job in jobs {
        let point = &mut curves[job.curve].0.points[job.point];
        point.seconds_per_unit = median(&mut job.times) / length;
    }
    Ok(curves.into_iter().map(|(curve, _)| curve).collect())
}

/// The median; not a number where there are none.
pub fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

/// One run to be timed, round after round.
struct Job {
    curve: usize,
    point: usize,
    grid: TimeGrid,
    repeats: u32,
    times: Vec<f64>,
}

impl Job {
    fn time(&mut self, model: &dyn Model, method: &MethodSpec) -> Result<(), RunError> {
        let start = cpu_seconds();
        for _ in 0..self.repeats {
            model.run(method, &self.grid, &SaveAt::Ends, &mut |_, row| {
                core::hint::black_box(row);
            })?;
        }
        self.times.push((cpu_seconds() - start) / f64::from(self.repeats));
        Ok(())
    }
}

/// The exact end of a run, and where in a row the state and the energy are.
struct Judge {
    state: Vec<(&'static str, core::ops::Range<usize>)>,
    energy: Option<usize>,
    exact: Vec<f64>,
}

impl Judge {
    fn new(scene: &Scene, quantities: &[&str], t_span: [f64; 2]) -> Result<Self, CliError> {
        let kind = scene.problem.kind();
        let mut width = 0;
        let mut state = Vec::new();
        for name in scene.problem.state(quantities) {
            let columns = kind.quantity(name)?.columns.len();
            state.push((*name, width..width + columns));
            width += columns;
        }
        let energy = kind.quantity("energy").is_ok().then_some(width);
        let mut judge = Judge { state, energy, exact: Vec::new() };
        let model = scene.model_with(Layer::Closed, &judge.quantities())?;
        judge.exact = match model.exact(t_span[1] - t_span[0]) {
            Some(exact) => exact?,
            None => {
                return Err(CliError::Message(format!(
                    "no exact solution is known of `{}`",
                    kind.name
                )));
            }
        };
        Ok(judge)
    }

    /// What a model must compute for [`point`](Self::point).
    fn quantities(&self) -> Vec<&'static str> {
        let names = self.state.iter().map(|(name, _)| *name);
        names.chain(self.energy.map(|_| "energy")).collect()
    }

    fn point(&self, model: &dyn Model, method: &MethodSpec, grid: &TimeGrid) -> WorkPoint {
        let (mut first, mut last) = (Vec::new(), Vec::new());
        let outcome = model.run(method, grid, &SaveAt::Ends, &mut |_, row| {
            if first.is_empty() {
                first = row.to_vec();
            }
            last = row.to_vec();
        });
        let mut point = WorkPoint {
            steps: grid.steps(),
            h: grid.h().abs(),
            error: f64::NAN,
            energy_error: f64::NAN,
            seconds_per_unit: f64::NAN,
            failure: None,
        };
        match outcome {
            Ok(_) => {
                point.error = self.error(&last);
                if let Some(column) = self.energy {
                    point.energy_error = last[column] - first[column];
                }
            }
            Err(error) => point.failure = Some(error.to_string()),
        }
        point
    }

    /// The largest relative distance of a part of the state from the exact one.
    fn error(&self, row: &[f64]) -> f64 {
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let relative = |(_, range): &(_, core::ops::Range<usize>)| {
            let (x, exact) = (&row[range.clone()], &self.exact[range.clone()]);
            let gap: Vec<f64> = x.iter().zip(exact).map(|(x, e)| x - e).collect();
            let size = norm(exact);
            if size > 0.0 { norm(&gap) / size } else { norm(&gap) }
        };
        self.state.iter().map(relative).fold(0.0, f64::max)
    }
}
