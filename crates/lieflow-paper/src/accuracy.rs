//! The error at t = 1 over the number of steps: Table 4 and Figure 5.

use lieflow::scalar::Ops;
use lieflow::{RunError, SaveAt, TimeGrid};
use nalgebra::Matrix3;

use crate::experiments::{EXAMPLE2, EXAMPLE3};
use crate::methods::{Body, PaperMethod};
use crate::printed::{Table4, table4};
use lieflow_timing::{Fit, median};

/// One of the two accuracy tests of section 5.3.
#[derive(Clone, Copy, Debug)]
pub struct Test {
    /// Its name in files.
    pub key: &'static str,
    /// Its name for people.
    pub name: &'static str,
    /// The body.
    pub body: Body,
    /// The paper's numbers of steps are 2 to these powers.
    pub powers: [u32; 6],
}

/// The two tests, with the data and steps that the paper's numbers belong to.
pub const TESTS: [Test; 2] = [
    Test {
        key: "symmetric",
        name: "J = diag(1, 1, 2)",
        body: EXAMPLE2.body,
        powers: [1, 2, 3, 4, 5, 6],
    },
    Test {
        key: "asymmetric",
        name: "J⁻¹ = diag(1, 4, 18)",
        body: EXAMPLE3.body,
        powers: [5, 6, 7, 8, 9, 10],
    },
];

/// Errors below this are near those of rounding, which say nothing of the order of a method.
const ROUNDING: f64 = 1e-12;

/// The errors that costs are read off at.
pub const EPSILONS: [f64; 2] = [1e-3, 1e-6];

/// A run.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyPoint {
    /// Its steps.
    pub steps: u64,
    /// ‖g(1) − exact‖, the spectral norm; not a number when a step failed.
    pub error: f64,
    /// CPU time of its steps, without that of the set-up of a run.
    pub seconds: f64,
}

/// A method in a test.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// The test, by its place in [`TESTS`].
    pub test: usize,
    /// The method.
    pub method: PaperMethod,
    /// The paper's six runs, and finer ones.
    pub points: Vec<AccuracyPoint>,
    /// The operations of a step, where they can be counted.
    pub ops: Option<Ops>,
}

/// What Table 4 has of a method at an error: log₁₀ of operations, and the time.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Operations as printed.
    pub printed: Option<f64>,
    /// Operations of our runs with the paper's operations of a step.
    pub ours: Option<f64>,
    /// Operations of our runs, as they are counted.
    pub counted: Option<f64>,
    /// CPU time in seconds.
    pub seconds: Option<f64>,
}

impl Accuracy {
    /// What the paper prints for the method.
    fn print(&self) -> Option<&'static Table4> {
        table4(self.method)
    }

    /// The operations of a step that the paper's numbers imply.
    pub fn printed_step(&self) -> Option<f64> {
        self.print().and_then(|printed| printed.per_step[self.test])
    }

    /// The operations of a step as they are counted.
    pub fn counted_step(&self) -> Option<u64> {
        self.ops.map(|ops| ops.total())
    }

    /// What it costs to reach the error of this place in [`EPSILONS`].
    pub fn cost(&self, e: usize) -> Cost {
        let epsilon = EPSILONS[e];
        // The paper takes all runs.
        let n = self.log_steps(epsilon, |_| true).unwrap_or(f64::NAN);
        // Those near rounding, and those that failed, say nothing of the order.
        let clear = self.log_steps(epsilon, |run| run.error >= ROUNDING);
        Cost {
            printed: self.print().map(|printed| printed.printed[self.test][e]),
            ours: self.printed_step().map(|ops| n + ops.log10()),
            // No run is shorter than a step.
            counted: clear
                .zip(self.counted_step())
                .map(|(n, ops)| n.max(0.0) + (ops as f64).log10()),
            seconds: self.seconds_to(epsilon),
        }
    }

    /// The paper's points.
    pub fn printed(&self) -> &[AccuracyPoint] {
        &self.points[..6.min(self.points.len())]
    }

    /// log₁₀ of the number of steps that reach ε, as the paper reads it: on the line of least squares
    /// through log cost against log error of those of its six runs that count. None where fewer than three do.
    fn log_steps(&self, epsilon: f64, counts: impl Fn(&AccuracyPoint) -> bool) -> Option<f64> {
        let runs: Vec<_> = self.printed().iter().filter(|run| counts(run)).collect();
        let logs = runs.iter().map(|run| (run.error.log10(), (run.steps as f64).log10()));
        logs.collect::<Fit>().at(epsilon.log10()).filter(|_| runs.len() >= 3)
    }

    /// The CPU time that reaches ε, between two runs by the line through them in the logarithms; none
    /// where no run reaches it.
    pub fn seconds_to(&self, epsilon: f64) -> Option<f64> {
        let runs: Vec<_> = self.points.iter().filter(|p| !p.error.is_nan()).collect();
        let reached = runs.iter().position(|p| p.error <= epsilon)?;
        let b = runs[reached];
        let Some(a) = reached.checked_sub(1).map(|i| runs[i]) else { return Some(b.seconds) };
        let share = (a.error / epsilon).ln() / (a.error / b.error).ln();
        Some((a.seconds.ln() + share * (b.seconds / a.seconds).ln()).exp())
    }
}

/// Measure every method with an attitude in the test of this place in [`TESTS`], in rounds that take turns.
pub fn accuracy(test: usize, finer: u32, rounds: u32) -> Result<Vec<Accuracy>, RunError> {
    let Test { body, powers: paper, .. } = TESTS[test];
    let (_, exact) = body.exact(1.0)?;
    let powers = paper[0]..=paper[5] + finer;
    let mut all = Vec::new();
    for method in PaperMethod::all().filter(|method| *method != PaperMethod::EnergyCasimir) {
        let mut points = Vec::new();
        for power in powers.clone() {
            let grid = TimeGrid::with_steps([0.0, 1.0], 1 << power)?;
            let mut end = None;
            let outcome = method.run(&body, &grid, SaveAt::Ends, &mut |_, _, g| end = g);
            let gap = |g: Matrix3<f64>| (g - exact).singular_values().max();
            let error = match (outcome, end) {
                (Ok(()), Some(g)) => gap(g),
                _ => f64::NAN,
            };
            points.push(AccuracyPoint { steps: 1 << power, error, seconds: f64::NAN });
        }
        let ops = method.counted(&body, 1.0 / f64::from(1u32 << paper[3]))?;
        all.push(Accuracy { test, method, points, ops });
    }
    time(&mut all, &body, rounds)?;
    Ok(all)
}

/// A timing shorter than this is repeated within its round.
const SHORTEST: f64 = 2e-4;

/// A run of few steps is mostly its set-up: the time of a step is that of a run of so many, or more.
const LONG: u64 = 2048;

/// The CPU time of so many steps over a unit of time.
fn seconds(method: PaperMethod, body: &Body, steps: u64) -> Result<f64, RunError> {
    let (grid, share) = long_run(steps)?;
    Ok(share * method.seconds(body, &grid, SHORTEST)?)
}

/// A long run of steps of the size that so many have over a unit of time, and their part of it.
fn long_run(steps: u64) -> Result<(TimeGrid, f64), RunError> {
    let long = steps.max(LONG);
    let share = steps as f64 / long as f64;
    Ok((TimeGrid::with_steps([0.0, 1.0 / share], long)?, share))
}

fn time(all: &mut [Accuracy], body: &Body, rounds: u32) -> Result<(), RunError> {
    let mut times: Vec<Vec<Vec<f64>>> =
        all.iter().map(|a| vec![Vec::new(); a.points.len()]).collect();
    for _ in 0..rounds {
        for (accuracy, times) in all.iter().zip(&mut times) {
            for (point, times) in accuracy.points.iter().zip(times) {
                if !point.error.is_nan() {
                    times.push(seconds(accuracy.method, body, point.steps)?);
                }
            }
        }
    }
    for (accuracy, times) in all.iter_mut().zip(&mut times) {
        for (point, times) in accuracy.points.iter_mut().zip(times) {
            point.seconds = median(times);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A method of these errors at 2, 4, 8, … steps, whose step takes 1 s and a hundred operations.
    fn with_errors(errors: &[f64]) -> Accuracy {
        let point = |(power, error): (u32, &f64)| {
            let steps = 1 << power;
            AccuracyPoint { steps, error: *error, seconds: steps as f64 }
        };
        let ops = Ops { add: 100, ..Ops::default() };
        let points = (1..).zip(errors).map(point).collect();
        Accuracy { test: 0, method: PaperMethod::Dmv10, points, ops: Some(ops) }
    }

    #[test]
    fn short_runs_are_timed_as_long_ones() {
        let (grid, share) = long_run(2).unwrap();
        assert_eq!((grid.steps(), grid.h(), share * 2048.0), (2048, 0.5, 2.0));
        let (grid, share) = long_run(4096).unwrap();
        assert_eq!((grid.steps(), grid.h(), share), (4096, 1.0 / 4096.0, 1.0));
    }

    #[test]
    fn operations_are_counted_where_errors_are_above_rounding() {
        let counted = |errors: &[f64]| with_errors(errors).cost(0).counted;
        // Order 2: 16 steps to 1e-3.
        let errors = [1, 2, 3, 4, 5].map(|power| 0.256 / 4f64.powi(power));
        let rounding = [&errors[..], &[3e-15]].concat();
        let expected = 16f64.log10() + 2.0;
        for errors in [&errors[..], &rounding] {
            assert!(counted(errors).is_some_and(|x| (x - expected).abs() < 1e-12), "{errors:?}");
        }
        // A step is enough, and two runs are no line.
        assert_eq!(counted(&[1e-8, 1e-9, 1e-10, 1e-11, 1e-14, 1e-14]), Some(2.0));
        assert_eq!(counted(&[1e-8, 1e-11, 1e-14, 1e-14, f64::NAN, 1e-14]), None);
    }
}
