//! The error at t = 1 over the number of steps: Table 4 and Figure 5.

use lieflow::problems::{Exact, PointOf};
use lieflow::scalar::Ops;
use lieflow::{Method, RunError, SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

use super::rows::{Body, EXAMPLE2, EXAMPLE3, Row, Seen, Visit, Watch};
use crate::cmd::CliError;
use crate::measure::{cpu_seconds, median};

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
        body: EXAMPLE2,
        powers: [1, 2, 3, 4, 5, 6],
    },
    Test {
        key: "asymmetric",
        name: "J⁻¹ = diag(1, 4, 18)",
        body: EXAMPLE3,
        powers: [5, 6, 7, 8, 9, 10],
    },
];

/// The errors that costs are read off at.
pub const EPSILONS: [f64; 2] = [1e-3, 1e-6];

/// A run.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Its steps.
    pub steps: u64,
    /// ‖g(1) − exact‖, the spectral norm; not a number when a step failed.
    pub error: f64,
    /// CPU time.
    pub seconds: f64,
}

/// A method in a test.
#[derive(Clone, Debug)]
pub struct Accuracy {
    /// The method.
    pub row: Row,
    /// The paper's six runs, and finer ones.
    pub points: Vec<Point>,
    /// The operations of a step, where they can be counted.
    pub ops: Option<Ops>,
}

/// The line of least squares through (x, y).
fn line(points: &[(f64, f64)]) -> impl Fn(f64) -> f64 {
    let n = points.len() as f64;
    let (x, y) =
        (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let sxy: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    move |at| y + sxy / sxx * (at - x)
}

impl Accuracy {
    /// The paper's points.
    pub fn printed(&self) -> &[Point] {
        &self.points[..6.min(self.points.len())]
    }

    /// log₁₀ of the number of steps that reach ε, as the paper reads it: on the line of least squares
    /// through log cost against log error of its six runs.
    pub fn log_steps(&self, epsilon: f64) -> f64 {
        let logs: Vec<_> =
            self.printed().iter().map(|p| (p.error.log10(), (p.steps as f64).log10())).collect();
        line(&logs)(epsilon.log10())
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

/// Measure every row with an attitude, in rounds that take turns.
///
/// # Errors
/// None with the paper's bodies.
pub fn accuracy(test: &Test, finer: u32, rounds: u32) -> Result<Vec<Accuracy>, CliError> {
    let body = test.body;
    let exact = Exact::new(body.inertia, body.momentum_body().into(), body.attitude)?;
    let (_, exact) = exact.state(1.0)?;
    let powers = test.powers[0]..=test.powers[5] + finer;
    let mut all = Vec::new();
    for row in Row::all().filter(|row| *row != Row::EnergyCasimir) {
        let mut points = Vec::new();
        for power in powers.clone() {
            let grid = TimeGrid::with_steps([0.0, 1.0], 1 << power)?;
            let mut end = None;
            let see = |_: f64, _: Vector3<f64>, g: Option<Matrix3<f64>>| end = g;
            let outcome = row.visit(&body, Watch { grid: &grid, save: SaveAt::Ends, see })?;
            let gap = |g: Matrix3<f64>| (g - exact).singular_values().max();
            let error = match (outcome, end) {
                (Ok(()), Some(g)) => gap(g),
                _ => f64::NAN,
            };
            points.push(Point { steps: 1 << power, error, seconds: f64::NAN });
        }
        let ops = row.counted(&body, 1.0 / f64::from(1u32 << test.powers[3]))?;
        all.push(Accuracy { row, points, ops });
    }
    time(&mut all, &body, rounds)?;
    Ok(all)
}

/// A timing shorter than this is repeated within its round.
const SHORTEST: f64 = 2e-4;

fn time(all: &mut [Accuracy], body: &Body, rounds: u32) -> Result<(), CliError> {
    let mut times: Vec<Vec<Vec<f64>>> =
        all.iter().map(|a| vec![Vec::new(); a.points.len()]).collect();
    for _ in 0..rounds {
        for (accuracy, times) in all.iter().zip(&mut times) {
            for (point, times) in accuracy.points.iter().zip(times) {
                if !point.error.is_nan() {
                    let grid = TimeGrid::with_steps([0.0, 1.0], point.steps)?;
                    times.push(accuracy.row.visit(body, Clock { grid })??);
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

/// The CPU time of a run.
struct Clock {
    grid: TimeGrid,
}

impl Visit for Clock {
    type Out = Result<f64, RunError>;
    fn call<P: Seen, M: Method<P>>(self, problem: &P, method: &M, start: PointOf<P>) -> Self::Out {
        let clock = cpu_seconds();
        let mut runs = 0.0;
        loop {
            let mut y = start.clone();
            integrate(problem, method, &self.grid, &SaveAt::Ends, &mut y, |_, y| {
                core::hint::black_box(y);
            })?;
            runs += 1.0;
            let took = cpu_seconds() - clock;
            if took >= SHORTEST {
                return Ok(took / runs);
            }
        }
    }
}
