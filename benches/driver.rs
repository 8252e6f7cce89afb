//! The cost of the driver in addition to its steps: `cargo bench --bench driver`.
//!
//! Each run takes turns with the run that it is compared with. The number printed is the median of the ratios of the
//! rounds.

use std::hint::black_box;
use std::time::Instant;

use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::{DOPRI5, RK4};
use lieflow::methods::{Method, Rkmk};
use lieflow::problems::{PointOf, RigidBody, RigidBodyN};
use lieflow::solve::Next;
use lieflow::{Event, LieAlgebra, Problem, SaveAt, Solve, Step, TimeGrid, integrate};
use nalgebra::Vector3;

type V = Vector3<f64>;

const ROUNDS: usize = 41;
const START: V = V::new(0.2, 0.5, 3.0);

/// The median over the rounds of the time of `run` to that of `beside`.
fn ratio(name: &str, goal: &str, mut beside: impl FnMut(), mut run: impl FnMut()) {
    let time = |f: &mut dyn FnMut()| {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    };
    let mut ratios = Vec::new();
    let mut least = [f64::INFINITY; 2];
    for round in 0..ROUNDS {
        // The first one changes with each round.
        let [a, b] = match round % 2 {
            0 => [time(&mut beside), time(&mut run)],
            _ => {
                let b = time(&mut run);
                [time(&mut beside), b]
            }
        };
        ratios.push(b / a);
        least = [least[0].min(a), least[1].min(b)];
    }
    ratios.sort_by(f64::total_cmp);
    let (median, fastest) = (ratios[ROUNDS / 2], least[1] / least[0]);
    println!("{name:58} {median:6.3} (of the fastest rounds {fastest:6.3}), goal {goal}");
}

/// The steps of a grid and nothing else. The compiler does not know the numbers of the problem and the method, as in a
/// program that reads them.
fn loop_of_steps<P: Problem<Group: LieAlgebra<Scalar = f64>>, M: Method<P>>(
    problem: &P,
    method: &M,
    grid: &TimeGrid,
    mut y: PointOf<P>,
) {
    let (problem, method) = (black_box(problem), black_box(method));
    let mut work = method.work(problem, &y).expect("the method fits");
    for n in 0..grid.steps() {
        let step = Step { n, t: n as f64 * grid.h(), h: grid.h() };
        method.step(problem, step, &mut y, &mut work).expect("a step");
    }
    black_box(&y);
}

fn main() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).expect("a body");
    let rkmk4 = Rkmk::new(RK4, Cay);
    let dopri5 = Rkmk::new(DOPRI5, Exp);

    // A bare loop of steps.
    let steps = 200_000u64;
    let grid = TimeGrid::with_steps([0.0, 2000.0], steps).expect("a grid");
    let bare = || loop_of_steps(&body, &rkmk4, &grid, START);
    ratio("integrate without output, RKMK4 with cay, m alone", "1.03", bare, || {
        let mut y = START;
        integrate(&body, &rkmk4, &grid, &SaveAt::End, &mut y, |_, _| {}).expect("a run");
        black_box(y);
    });
    ratio("the same with an output after each step", "-", bare, || {
        let mut y = START;
        integrate(&body, &rkmk4, &grid, &SaveAt::Every(1), &mut y, |_, y| {
            black_box(y);
        })
        .expect("a run");
    });

    // A step of microseconds.
    let large = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).expect("a body");
    let mut start = large.group().zero().into_mat();
    for i in 0..6 {
        for j in 0..i {
            start[(i, j)] = 0.1 * (i + 2 * j) as f64;
            start[(j, i)] = -start[(i, j)];
        }
    }
    let steps = 5000u64;
    let grid = TimeGrid::with_steps([0.0, 50.0], steps).expect("a grid");
    ratio(
        "integrate without output, RKMK4 with cay, n = 6",
        "1.03",
        || loop_of_steps(&large, &rkmk4, &grid, start.clone()),
        || {
            let mut y = start.clone();
            integrate(&large, &rkmk4, &grid, &SaveAt::End, &mut y, |_, _| {}).expect("a run");
            black_box(&y);
        },
    );

    // Adaptive step size.
    let solve = || Solve::new(&body, &dopri5, [0.0, 2000.0]).tolerances(1e-9, 1e-12);
    let plain = || {
        black_box(solve().run(START).expect("a run").y);
    };
    println!("{} adaptive steps", solve().run(START).expect("a run").stats.accepted);
    let times: Vec<f64> = (1..=1000).map(|i| 2.0 * f64::from(i)).collect();
    ratio("a thousand output times in an adaptive run", "1.10", plain, || {
        let run = solve().times(&*times).run_with(START, |_, y| {
            black_box(y);
            Next::Continue
        });
        black_box(run.expect("a run").y);
    });
    ratio("an event that never fires", "1.05", plain, || {
        let event = Event::new("never", |_, m: &V| m.y + 100.0);
        black_box(solve().event(event).run(START).expect("a run").y);
    });
}
