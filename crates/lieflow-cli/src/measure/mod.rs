//! Speed against error: runs that are timed fairly and judged by the exact solution, or by one that
//! two independent methods agree on.
//!
//! Times are CPU time of this thread, medians over rounds; a round visits every method and step once,
//! in an order of its own, so that a slow moment of the machine meets all of them.

mod candidate;
pub mod checks;
mod curve;
mod journal;
mod judge;
mod kept;
mod reference;

pub use candidate::Candidate;
pub use checks::checks;
use curve::OFF;
pub use curve::{Curve, Reached, WorkPoint, pareto};
pub use journal::{JOURNAL, Journal};
pub(crate) use judge::RETURNS;
pub use judge::{Course, Judge, MOST_ROWS, Rows};
pub use kept::Kept;
pub use reference::{Reference, Rounding};

use std::collections::VecDeque;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::error::CliError;
use lieflow::catalog::MethodSpec;
use lieflow_model::problem::{Layer, Model};
use lieflow_model::scene::Scene;
use lieflow_model::schema::Row;
use lieflow_timing::{cpu_seconds, median, seconds_of};

/// How large the steps of a run are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Size {
    /// This number of steps of one size.
    Steps(u64),
    /// Steps chosen by their error: rtol, with atol = 0.
    Tolerance(f64),
}

/// The flag of a measurement that nothing stops.
pub static NEVER: AtomicBool = AtomicBool::new(false);

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort<'a> {
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
    pub wanted: &'a [f64],
    /// For these a single run may take so long.
    pub patience: Duration,
    /// The error that is asked for, where nothing else is: no method goes on beyond it, nor one that is many times
    /// slower than the best.
    pub goal: Option<f64>,
    /// The flag that ends a run before its end; then the measurement must end too, by its `tick`.
    pub stop: &'a AtomicBool,
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
    /// The rows that are part of what is timed.
    pub rows: &'a Rows,
}

/// Measure every candidate on `scene` in each size of steps. `tick` is called after every run with the
/// share of the work that is done; an error of it ends the measurement. What `journal` knows is not measured
/// again.
///
/// # Errors
/// The problem cannot be set up or has no reference; the journal cannot be written; those of `tick`.
pub fn speed_against_error(
    scene: &Scene,
    plan: &Plan<'_>,
    effort: Effort<'_>,
    journal: Option<&mut Journal>,
    mut tick: impl FnMut(f64) -> Result<(), CliError>,
) -> Result<(Vec<Curve>, Reference), CliError> {
    let Plan { candidates, t_span, quantities, .. } = *plan;
    let judge = Judge::new(scene, quantities, t_span, plan.steps, effort.longest, effort.stop)?;
    let floor = judge.reference.floor();
    let mut layers: Vec<Layer> = candidates.iter().map(|candidate| candidate.layer).collect();
    layers.sort_unstable();
    layers.dedup();
    let models = layers.iter().map(|&layer| {
        let judged = scene.model_with(layer, &judge.quantities())?;
        Ok(Models { layer, judged, timed: scene.model_with(layer, quantities)? })
    });
    let models: Vec<Models> = models.collect::<Result<_, CliError>>()?;
    let mut bench = Bench {
        judge: &judge,
        effort,
        rows: plan.rows,
        journal,
        jobs: Vec::new(),
        share: 0.0,
        tick: &mut tick,
    };
    let mut lines = Vec::new();
    let mut best = f64::INFINITY;
    // Those of high order reach the goal soon, and the others need not go far then.
    let rank = |candidate: &Candidate| {
        let models = models.iter().find(|models| models.layer == candidate.layer);
        let order = models.and_then(|models| models.judged.order(&candidate.method).ok().flatten());
        core::cmp::Reverse(order.filter(|_| effort.goal.is_some()))
    };
    let mut in_order: Vec<(usize, &Candidate)> = candidates.iter().enumerate().collect();
    in_order.sort_by_key(|(_, candidate)| rank(candidate));
    for (done, (i, candidate)) in in_order.into_iter().enumerate() {
        let Some(models) = models.iter().find(|models| models.layer == candidate.layer) else {
            continue;
        };
        let orders = models.judged.orders(&candidate.method)?;
        let curve = Curve {
            candidate: candidate.clone(),
            label: if layers.len() > 1 { candidate.label() } else { candidate.name() },
            order: orders.step,
            stays: orders.stays_on_manifold || judge.promises_manifold(&candidate.method),
            floor,
            points: Vec::new(),
        };
        let left = match candidate.adaptive {
            false => plan.steps.iter().map(|n| Size::Steps(*n)).collect(),
            true => plan.tolerances.iter().map(|tol| Size::Tolerance(*tol)).collect(),
        };
        let mut line = Line { curve, models, left };
        while let Some(took) = bench.next(i, &mut line)? {
            if took > effort.longest.as_secs_f64() {
                break;
            }
            if let Some(goal) = effort.goal {
                let is_there = line.curve.points.last().is_some_and(|point| point.error <= goal);
                // Methods that leave M, and the exact motion, say nothing of the others.
                if is_there && line.curve.stays && line.curve.order.is_some() {
                    best = best.min(took);
                }
                if is_there || took > SLOW * best {
                    break;
                }
            }
        }
        lines.push((i, line));
        bench.share = 0.2 * (done + 1) as f64 / candidates.len() as f64;
    }
    lines.sort_by_key(|(i, _)| *i);
    // The place of a line is the number of its candidate, but where its layer has no model.
    let mut places = vec![usize::MAX; candidates.len()];
    lines.iter().enumerate().for_each(|(place, (i, _))| places[*i] = place);
    bench.jobs.iter_mut().for_each(|job| job.curve = places[job.curve]);
    let mut lines: Vec<Line<'_>> = lines.into_iter().map(|(_, line)| line).collect();
    bench.go_on(&mut lines)?;
    bench.come_near(&mut lines)?;
    let Bench { mut journal, mut jobs, tick, .. } = bench;
    let length = (t_span[1] - t_span[0]).abs();
    // Methods that leave M, and the exact motion, say nothing of the others.
    let ahead = lines.iter().map(|line| &line.curve).filter(|c| c.stays && c.order.is_some());
    let ahead = Ahead::of(ahead.flat_map(|c| &c.points).map(|p| (p.error, p.first_seconds)));
    // What is far from the goal, or slow, is not timed again.
    jobs.retain(|job| {
        let Some(point) = lines[job.curve].point_of(job.size) else { return false };
        match effort.goal {
            Some(goal) => point.error <= NEAR * goal && point.first_seconds <= SLOW * best,
            None => point.first_seconds <= SLOW * ahead.seconds(point.error),
        }
    });
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
                let Line { curve, models, .. } = &lines[job.curve];
                let (method, shortest) = (&curve.candidate.method, effort.shortest.as_secs_f64());
                let seconds =
                    job.size.seconds(&models.timed, method, &judge.course, &Rows::ENDS, shortest);
                let seconds = match seconds {
                    Ok(seconds) => seconds,
                    // With what is written a run may fail that reached its end without it.
                    Err(failure) => {
                        if let Some(point) = lines[job.curve].point_of(job.size) {
                            point.failure = Some(failure);
                        }
                        job.times = vec![f64::NAN; effort.rounds as usize];
                        tick(share)?;
                        continue;
                    }
                };
                job.times.push(seconds);
                if let Some(journal) = &mut journal {
                    journal.saw_time(&job.key, seconds)?;
                }
                tick(share)?;
            }
        }
    }
    for mut job in jobs {
        if let Some(point) = lines[job.curve].point_of(job.size) {
            point.seconds_per_unit = (median(&mut job.times) + point.output_seconds) / length;
        }
    }
    Ok((lines.into_iter().map(|line| line.curve).collect(), judge.reference))
}

/// The problem on a layer.
struct Models {
    layer: Layer,
    /// With what a run is judged by.
    judged: Model,
    /// With what a run is asked for.
    timed: Model,
}

/// A method on its way from large steps to small ones.
struct Line<'a> {
    curve: Curve,
    models: &'a Models,
    left: VecDeque<Size>,
}

impl Line<'_> {
    /// The run with this size of steps.
    fn point_of(&mut self, size: Size) -> Option<&mut WorkPoint> {
        self.curve.points.iter_mut().find(|point| point.size == size)
    }

    /// Expected time of a run to this error. `None` if unknown.
    fn promise(&self, error: f64) -> Option<f64> {
        let (last, order) = (self.curve.points.last()?, self.curve.order?);
        let gain = (last.error.min(1.0) / error).powf(1.0 / order as f64);
        let known = last.failure.is_none() && gain.is_finite() && !self.left.is_empty();
        known.then_some(last.first_seconds * gain.max(1.0))
    }
}

/// The least times to each error, from the smallest error to the largest.
struct Ahead(Vec<(f64, f64)>);

impl Ahead {
    /// Of runs with these errors and times. A run that failed has none.
    fn of(runs: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut known: Vec<_> = runs.filter(|(error, time)| (error + time).is_finite()).collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut least = f64::INFINITY;
        for (_, seconds) in &mut known {
            least = least.min(*seconds);
            *seconds = least;
        }
        Ahead(known)
    }

    /// The least time of a run whose error is not larger; infinite if there is none.
    fn seconds(&self, error: f64) -> f64 {
        let count = self.0.partition_point(|&(known, _)| known <= error);
        self.0[..count].last().map_or(f64::INFINITY, |&(_, seconds)| seconds)
    }
}

/// A method that is this many times slower than the best is left out, or timed once.
pub const SLOW: f64 = 8.0;
/// An error is near the goal if it is at most this many times the goal.
const NEAR: f64 = 1e4;

/// The first run of a method is longer by so many seconds at most, for caches and what is made once.
const COLD: f64 = 1e-2;

/// The number of runs that come nearer to an error.
const NEARER: usize = 4;

/// The number of methods that continue at a time to an error that none has reached.
const PROMISING: usize = 6;

/// Where runs are made and judged.
struct Bench<'a> {
    judge: &'a Judge<'a>,
    effort: Effort<'a>,
    rows: &'a Rows,
    journal: Option<&'a mut Journal>,
    jobs: Vec<Job>,
    /// The share of the work that is done.
    share: f64,
    tick: &'a mut dyn FnMut(f64) -> Result<(), CliError>,
}

impl Bench<'_> {
    /// The next run of line i, and its time. None if no more are planned.
    fn next(&mut self, i: usize, line: &mut Line<'_>) -> Result<Option<f64>, CliError> {
        let Line { curve, models: Models { judged, timed, .. }, left } = line;
        let Some(size) = left.pop_front() else { return Ok(None) };
        let (candidate, shortest) = (&curve.candidate, self.effort.shortest.as_secs_f64());
        let (course, [t0, t1]) = (&self.judge.course, self.judge.course.t_span);
        let key = format!("{} {:?} {size:?}", candidate.name(), candidate.layer);
        let known = self.journal.as_ref().and_then(|journal| journal.point(&key)).cloned();
        let mut point = match known {
            Some(point) => point,
            None => {
                let run = || {
                    let start = cpu_seconds();
                    let point = self.judge.point(judged, candidate, size);
                    (point, cpu_seconds() - start)
                };
                let (mut point, mut took) = run();
                // The first time finds cold caches, which a short run cannot repay. What seems slow is not timed again.
                let is_first = curve.points.len() < 2 && took < COLD;
                if is_first || took < shortest {
                    took = took.min(run().1);
                }
                point.first_seconds = took;
                self.judge.look_within(judged, &candidate.method, &mut point);
                // Nobody asks for the rows of a run that has lost the solution.
                if point.error <= OFF && *self.rows != Rows::ENDS {
                    match size.seconds(timed, &candidate.method, course, self.rows, shortest) {
                        Ok(seconds) => point.output_seconds = (seconds - took).max(0.0),
                        // Steps that reach the end may have no rows between them.
                        Err(failure) => point.failure = Some(failure),
                    }
                }
                if point.failure.is_none() {
                    let attempts = point.steps + point.rejected;
                    point.operations = size.operations(judged, &candidate.method, course, attempts);
                }
                // A run that was stopped is not kept.
                (self.tick)(self.share)?;
                if let Some(journal) = &mut self.journal {
                    journal.saw_point(&key, &point)?;
                }
                point
            }
        };
        let took = point.first_seconds;
        if point.failure.is_none() {
            let length = (t1 - t0).abs();
            point.seconds_per_unit = (took + point.output_seconds) / length;
            let times = self.journal.as_ref().map_or(&[][..], |journal| journal.times(&key));
            self.jobs.push(Job { curve: i, size, times: times.to_vec(), key });
        }
        curve.insert(point);
        Ok(Some(took))
    }

    /// On to the wanted errors that no method in steps has reached, as far as the reference can tell.
    fn go_on(&mut self, lines: &mut [Line<'_>]) -> Result<(), CliError> {
        let (floor, patience) = (self.judge.reference.floor(), self.effort.patience.as_secs_f64());
        for &error in self.effort.wanted.iter().filter(|error| **error >= floor) {
            let reaches = |line: &Line<'_>| {
                line.curve.order.is_some() && line.curve.points.iter().any(|p| p.error <= error)
            };
            while !lines.iter().any(reaches) {
                let promise = |(i, line): (usize, &Line<'_>)| Some((line.promise(error)?, i));
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

    /// Runs with the steps that the line between two runs promises, so that what is advised was tried. Where that came no
    /// nearer to the error from below, as where the error does not fall with the tolerance, those in the middle.
    fn come_near(&mut self, lines: &mut [Line<'_>]) -> Result<(), CliError> {
        for &error in self.effort.wanted {
            for (i, line) in lines.iter_mut().enumerate() {
                let mut before = None;
                for _ in 0..NEARER {
                    let Some(reached) = line.curve.all_that_reach(error).first().copied() else {
                        break;
                    };
                    if line.point_of(reached.size()).is_some() {
                        break;
                    }
                    let mut size = reached.size();
                    if let Some([reaches, middle]) = line.curve.middle(error) {
                        if before == Some(reaches) && line.point_of(middle).is_none() {
                            size = middle;
                        }
                        before = Some(reaches);
                    }
                    line.left.push_front(size);
                    self.next(i, line)?;
                }
            }
        }
        Ok(())
    }
}

/// One run to be timed, round after round.
struct Job {
    curve: usize,
    size: Size,
    times: Vec<f64>,
    key: String,
}

impl Size {
    /// The CPU time of a run with these rows, which is repeated until `shortest` is over; why there is none, in
    /// words.
    fn seconds(
        self,
        model: &Model,
        method: &MethodSpec,
        course: &Course,
        rows: &Rows,
        shortest: f64,
    ) -> Result<f64, String> {
        let mut see = |_: f64, row: Row<'_>| {
            core::hint::black_box(row.values());
        };
        seconds_of(shortest, || {
            let until = (course, course.t_span[1]);
            self.run(model, method, until, rows, None, &mut see).map(|_| ())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Ahead;

    #[test]
    fn the_least_time_is_that_of_a_run_whose_error_is_not_larger() {
        let runs = [(1e-3, 2.0), (f64::NAN, 0.1), (1e-9, 5.0), (1e-6, 7.0), (1e-4, f64::NAN)];
        let ahead = Ahead::of(runs.into_iter());
        let found = [1e-2, 1e-3, 1e-5, 1e-6, 1e-9, 1e-10].map(|error| ahead.seconds(error));
        assert_eq!(found, [2.0, 2.0, 5.0, 5.0, 5.0, f64::INFINITY]);
    }
}
