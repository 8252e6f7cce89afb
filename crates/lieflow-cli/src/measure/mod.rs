//! Speed against error: runs that are timed fairly and judged by the exact solution, or by one that
//! two independent methods agree on.
//!
//! Times are CPU time of this thread, medians over rounds; a round visits every method and step once,
//! in an order of its own, so that a slow moment of the machine meets all of them.

mod candidate;
mod checks;
mod clock;
mod curve;
mod fit;
mod journal;
mod judge;

pub use candidate::Candidate;
pub use checks::checks;
pub use clock::{cpu_seconds, machine, seconds_of};
pub use curve::{Curve, Reached, WorkPoint, pareto};
pub use fit::Fit;
pub use journal::{JOURNAL, Journal};
pub use judge::{Judge, Reference};

use std::collections::VecDeque;
use std::time::Duration;

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::cmd::CliError;
use lieflow_model::model::Model;
use lieflow_model::scene::Scene;
use lieflow_model::schema::Row;

/// How large the steps of a run are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Size {
    /// So many steps of one size.
    Steps(u64),
    /// Steps chosen by their error: rtol, with atol = 0.
    Tolerance(f64),
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
    /// Of the order within the rounds.
    pub seed: u64,
    /// Errors that some method in steps should reach: where none does, those that promise most go on to
    /// smaller steps.
    pub wanted: &'static [f64],
    /// For these a single run may take so long.
    pub patience: Duration,
}

/// What is measured.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// What the runs model.
    pub quantities: &'a [&'a str],
    /// The methods.
    pub candidates: &'a [Candidate],
    /// From when to when.
    pub t_span: [f64; 2],
    /// Numbers of steps for the methods with steps of one size, from few to many.
    pub steps: &'a [u64],
    /// Tolerances for those that choose their steps, from loose to tight.
    pub tolerances: &'a [f64],
}

/// Measure every candidate on `scene` in each size of steps. `tick` is called after every run with the
/// share of the work that is done. What `journal` knows is not measured again.
///
/// # Errors
/// The problem cannot be set up or has no reference; the journal cannot be written.
pub fn speed_against_error(
    scene: &Scene,
    plan: &Plan<'_>,
    effort: Effort,
    journal: Option<&mut Journal>,
    mut tick: impl FnMut(f64),
) -> Result<(Vec<Curve>, Reference), CliError> {
    let Plan { candidates, t_span, .. } = *plan;
    let judge = Judge::new(scene, plan.quantities, t_span)?;
    let mut bench = Bench { judge: &judge, effort, t_span, journal, jobs: Vec::new() };
    let mut lines = Vec::new();
    for (i, candidate) in candidates.iter().enumerate() {
        let model = scene.model_with(candidate.layer, &judge.quantities())?;
        let curve = Curve::new(candidate.clone(), model.order(&candidate.method)?);
        let left = match candidate.adaptive {
            false => plan.steps.iter().map(|n| Size::Steps(*n)).collect(),
            true => plan.tolerances.iter().map(|tol| Size::Tolerance(*tol)).collect(),
        };
        let mut line = Line { curve, model, left };
        while let Some(took) = bench.next(i, &mut line)? {
            if took > effort.longest.as_secs_f64() {
                break;
            }
        }
        lines.push(line);
        tick(0.2 * (i + 1) as f64 / candidates.len() as f64);
    }
    bench.go_on(&mut lines)?;
    let Bench { mut journal, mut jobs, .. } = bench;
    let mut rng = Pcg64::seed_from_u64(effort.seed);
    for round in 0..effort.rounds {
        jobs.shuffle(&mut rng);
        let share = |done: usize| {
            let rounds = f64::from(round) + done as f64 / jobs.len() as f64;
            0.2 + 0.8 * rounds / f64::from(effort.rounds)
        };
        let shares: Vec<f64> = (1..=jobs.len()).map(share).collect();
        for (job, share) in jobs.iter_mut().zip(shares) {
            if job.times.len() <= round as usize {
                let Line { curve, model, .. } = &lines[job.curve];
                let seconds = job.time(&**model, &curve.candidate, t_span)?;
                if let Some(journal) = &mut journal {
                    journal.saw_time(&job.key, seconds)?;
                }
            }
            tick(share);
        }
    }
    let length = (t_span[1] - t_span[0]).abs();
    for mut job in jobs {
        let point = &mut lines[job.curve].curve.points[job.point];
        point.seconds_per_unit = median(&mut job.times) / length;
    }
    Ok((lines.into_iter().map(|line| line.curve).collect(), judge.reference))
}

/// A method on its way from large steps to small ones.
struct Line {
    curve: Curve,
    model: Box<dyn Model>,
    left: VecDeque<Size>,
}

impl Line {
    /// How long a run to this error should take, by the last run and the order; none where that says
    /// nothing, or no smaller steps are planned.
    fn promise(&self, error: f64) -> Option<f64> {
        let (last, order) = (self.curve.points.last()?, self.curve.order?);
        let gain = (last.error.min(1.0) / error).powf(1.0 / order as f64);
        let known = last.failure.is_none() && gain.is_finite() && !self.left.is_empty();
        known.then_some(last.first_seconds * gain.max(1.0))
    }
}

/// So many methods go on at a time to an error that none has reached.
const PROMISING: usize = 6;

/// Where runs are made and judged.
struct Bench<'a> {
    judge: &'a Judge,
    effort: Effort,
    t_span: [f64; 2],
    journal: Option<&'a mut Journal>,
    jobs: Vec<Job>,
}

impl Bench<'_> {
    /// The next run of line i, and how long it took; none where no more are planned.
    fn next(&mut self, i: usize, line: &mut Line) -> Result<Option<f64>, CliError> {
        let Line { curve, model, left } = line;
        let Some(size) = left.pop_front() else { return Ok(None) };
        let (candidate, t_span, shortest) =
            (&curve.candidate, self.t_span, self.effort.shortest.as_secs_f64());
        let key = format!("{} {size:?}", candidate.label());
        let known = self.journal.as_ref().and_then(|journal| journal.point(&key)).cloned();
        let point = match known {
            Some(point) => point,
            None => {
                let run = || {
                    let start = cpu_seconds();
                    let point = self.judge.point(&**model, candidate, t_span, size);
                    (point, cpu_seconds() - start)
                };
                let (mut point, mut took) = run();
                // The first time finds cold caches, which a short run cannot repay.
                if took < shortest {
                    took = took.min(run().1);
                }
                point.first_seconds = took;
                if point.failure.is_none() {
                    let attempts = point.steps + point.rejected;
                    point.operations =
                        size.operations(&**model, &candidate.method, t_span, attempts);
                }
                if let Some(journal) = &mut self.journal {
                    journal.saw_point(&key, &point)?;
                }
                point
            }
        };
        let took = point.first_seconds;
        if point.failure.is_none() {
            let times = self.journal.as_ref().map_or(&[][..], |journal| journal.times(&key));
            self.jobs.push(Job {
                curve: i,
                point: curve.points.len(),
                size,
                repeats: (shortest / took.max(1e-9)).ceil().max(1.0) as u32,
                times: times.to_vec(),
                key,
            });
        }
        curve.points.push(point);
        Ok(Some(took))
    }

    /// On to the wanted errors that no method in steps has reached, as far as the reference can tell.
    fn go_on(&mut self, lines: &mut [Line]) -> Result<(), CliError> {
        let (floor, patience) =
            (self.judge.reference.error().unwrap_or(0.0), self.effort.patience.as_secs_f64());
        for &error in self.effort.wanted.iter().filter(|error| **error >= floor) {
            let reaches = |line: &Line| {
                line.curve.order.is_some() && line.curve.points.iter().any(|p| p.error <= error)
            };
            while !lines.iter().any(reaches) {
                let promise = |(i, line): (usize, &Line)| Some((line.promise(error)?, i));
                let mut promising: Vec<_> = lines.iter().enumerate().filter_map(promise).collect();
                promising.retain(|(seconds, _)| *seconds <= patience);
                promising.sort_by(|a, b| a.0.total_cmp(&b.0));
                promising.truncate(PROMISING);
                if promising.is_empty() {
                    break;
                }
                for (_, i) in promising {
                    self.next(i, &mut lines[i])?;
                }
            }
        }
        Ok(())
    }
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
    size: Size,
    repeats: u32,
    times: Vec<f64>,
    key: String,
}

impl Job {
    fn time(
        &mut self,
        model: &dyn Model,
        candidate: &Candidate,
        t_span: [f64; 2],
    ) -> Result<f64, CliError> {
        let start = cpu_seconds();
        for _ in 0..self.repeats {
            let mut see = |_: f64, row: Row<'_>| {
                core::hint::black_box(row.values());
            };
            self.size.run(model, &candidate.method, t_span, &mut see).map_err(CliError::Message)?;
        }
        let seconds = (cpu_seconds() - start) / f64::from(self.repeats);
        self.times.push(seconds);
        Ok(seconds)
    }
}
