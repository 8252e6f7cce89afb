//! The job of `benches/flips.rs` by diffsol: its explicit pair `tsit45` with dense output, and the zeros by bisection.
//!
//! `flips-diffsol ROWS`, where ROWS is the file of the exact rows. A line for each tolerance, as `flips.rs` prints it.

use std::time::Instant;

use diffsol::{NalgebraContext, NalgebraMat, NalgebraVec, OdeBuilder, OdeSolverMethod, Vector};

const ROUNDS: usize = 15;

/// ṁ = m × J⁻¹m with J = (1, 2, 3).
fn field(m: &[f64], _: &[f64], _: f64, d: &mut [f64]) {
    let (a, b, c) = (1.0, 0.5, 1.0 / 3.0);
    d[0] = m[1] * m[2] * (c - b);
    d[1] = m[2] * m[0] * (a - c);
    d[2] = m[0] * m[1] * (b - a);
}

fn main() {
    let file = std::env::args().nth(1).expect("the file of the exact rows");
    let text = std::fs::read_to_string(file).expect("the file can be read");
    let exact: Vec<[f64; 3]> = text
        .lines()
        .map(|line| {
            let numbers: Vec<f64> =
                line.split_whitespace().map(|x| x.parse().expect("a number")).collect();
            [numbers[0], numbers[1], numbers[2]]
        })
        .collect();
    for digits in 6..15 {
        let tolerance = 0.1f64.powi(digits);
        let problem = OdeBuilder::<NalgebraMat<f64>>::new()
            .rtol(tolerance)
            .atol([tolerance; 3])
            .h0(0.01)
            .rhs(field)
            .init(|_, _, m| m.copy_from_slice(&[0.1, 2.0, 0.3]), 3)
            .build()
            .expect("a problem");
        let mut least = f64::INFINITY;
        let (mut steps, mut zeros, mut rows) = (0, 0, Vec::with_capacity(exact.len()));
        for _ in 0..ROUNDS {
            let start = Instant::now();
            (steps, zeros) = (0, 0);
            rows.clear();
            rows.push([0.1, 2.0, 0.3]);
            let mut solver = problem.tsit45().expect("a solver");
            let mut at = NalgebraVec::zeros(3, NalgebraContext::default());
            let (mut from, mut before) = (0.0, 2.0);
            while rows.len() < exact.len() {
                solver.step().expect("a step");
                steps += 1;
                let (to, after) = (solver.state().t, solver.state().y.batch_as_slice(0)[1]);
                if (before < 0.0) != (after < 0.0) {
                    let (mut low, mut high) = (from, to);
                    while high - low > 1e-12 {
                        let middle = 0.5 * (low + high);
                        solver.interpolate_inplace(middle, &mut at).expect("a point");
                        if (at.batch_as_slice(0)[1] < 0.0) == (before < 0.0) {
                            low = middle;
                        } else {
                            high = middle;
                        }
                    }
                    zeros += 1;
                }
                (from, before) = (to, after);
                while rows.len() < exact.len() && rows.len() as f64 <= to {
                    solver.interpolate_inplace(rows.len() as f64, &mut at).expect("a point");
                    let m = at.batch_as_slice(0);
                    rows.push([m[0], m[1], m[2]]);
                }
            }
            least = least.min(start.elapsed().as_secs_f64());
        }
        let distance = |(a, b): (&[f64; 3], &[f64; 3])| {
            a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        };
        let error = rows.iter().zip(&exact).map(distance).fold(0.0, f64::max);
        println!(
            "{:20} 1e-{digits} {steps} {zeros} {error:.2e} {:.3}",
            "diffsol tsit45",
            1e3 * least
        );
    }
}
