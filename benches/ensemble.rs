//! Many free rigid bodies in SIMD lanes, compared with a loop over the same bodies by the same methods.
//!
//! Prints nanoseconds for a body and a step, the minimum over rounds that take turns.
//!
//! `cargo bench --bench ensemble`

use std::hint::black_box;
use std::time::Instant;

use lieflow::ensemble::{Ensemble, EnsembleMethod};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::RK4;
use lieflow::methods::{Method, Rk, Rkmk, Step};
use lieflow::problems::{BodyState, Problem, RigidBody, RigidBodyState};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const ROUNDS: usize = 15;
/// The number of body-steps in a round of each contestant.
const WORK: usize = 1 << 18;
const H: f64 = 0.02;

type Run<'a> = (&'a str, Box<dyn FnMut() + 'a>);

fn fastest(runs: &mut [Run<'_>], bodies: usize, steps: usize) {
    let mut best = vec![f64::INFINITY; runs.len()];
    for _ in 0..ROUNDS {
        for (run, best) in runs.iter_mut().zip(&mut best) {
            let start = Instant::now();
            (run.1)();
            *best = best.min(start.elapsed().as_nanos() as f64 / (bodies * steps) as f64);
        }
    }
    println!("{bodies} bodies, {steps} steps");
    for ((name, _), ns) in runs.iter().zip(best) {
        println!("  {name:28} {ns:7.2} ns, {:6.1} million body-steps a second", 1e3 / ns);
    }
}

/// A loop over bodies, all steps of each.
fn one_by_one<P: Problem, M: Method<P>>(
    problems: &[P],
    states: &mut [lieflow::problems::PointOf<P>],
    method: &M,
    steps: usize,
) where
    P::Group: lieflow::LieAlgebra<Scalar = f64>,
{
    let mut work = method.work(&problems[0], &states[0]).expect("the method fits");
    for (problem, y) in problems.iter().zip(states) {
        for n in 0..steps as u64 {
            let step = Step { n, t: 0.0, h: H };
            method.step(problem, black_box(step), y, &mut work).expect("a step");
        }
    }
}

fn main() {
    for bodies in [64usize, 1024, 65536] {
        let steps = WORK / bodies;
        let mut rng = Pcg64::seed_from_u64(1);
        let mut triple = |low: f64, high: f64| [(); 3].map(|()| rng.random_range(low..high));
        let inertia: Vec<_> = (0..bodies).map(|_| triple(1.0, 3.0)).collect();
        let momentum: Vec<_> = (0..bodies).map(|_| triple(-1.0, 1.0)).collect();
        let identity = vec![Matrix3::identity(); bodies];

        let problems: Vec<_> =
            inertia.iter().map(|j| RigidBody::new(*j).expect("a body")).collect();
        let with_g: Vec<_> =
            inertia.iter().map(|j| RigidBodyState::new(*j).expect("a body")).collect();
        let m: Vec<_> = momentum.iter().map(|m| Vector3::from(*m)).collect();
        let both: Vec<_> = m.iter().map(|m| BodyState { m: *m, g: Matrix3::identity() }).collect();
        let ensemble = Ensemble::new(&inertia, &momentum).expect("bodies");
        let attitudes = ensemble.clone().with_attitudes(&identity).expect("attitudes");

        let mut runs: Vec<Run<'_>> = Vec::new();
        macro_rules! pair {
            ($name:literal, $alone:literal, $how:expr, $from:expr, $problems:expr, $y:expr, $method:expr) => {
                let mut many = $from.clone();
                runs.push((
                    $name,
                    Box::new(move || {
                        many.advance($how, H, steps as u64, 1).expect("a run");
                    }),
                ));
                let mut y = $y.clone();
                let problems = &$problems;
                runs.push((
                    $alone,
                    Box::new(move || one_by_one(problems, &mut y, &$method, steps)),
                ));
            };
        }
        pair!("rk4 m", "  alone", EnsembleMethod::Rk4, ensemble, problems, m, Rk(RK4));
        let exp = EnsembleMethod::Rkmk4Exp;
        pair!("rkmk4 exp m", "  alone", exp, ensemble, problems, m, Rkmk::new(RK4, Exp));
        let cay = EnsembleMethod::Rkmk4Cay;
        pair!("rkmk4 cay m", "  alone", cay, ensemble, problems, m, Rkmk::new(RK4, Cay));
        pair!("rkmk4 exp m, g", "  alone", exp, attitudes, with_g, both, Rkmk::new(RK4, Exp));
        pair!("rkmk4 cay m, g", "  alone", cay, attitudes, with_g, both, Rkmk::new(RK4, Cay));
        let mut two = attitudes.clone();
        runs.push((
            "rkmk4 cay m, g, two threads",
            Box::new(move || {
                two.advance(cay, H, steps as u64, 2).expect("a run");
            }),
        ));
        fastest(&mut runs, bodies, steps);
    }
}
