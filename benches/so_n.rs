//! Steps of order 4 on so(n) compared with the same step by hand over nalgebra: `cargo bench --bench so_n`.
//!
//! The n-dimensional body ṁ = [m, Ω] with J_ij = λ_i + λ_j, λ_i = 1 + i/n, |m|₂ = 1, h = 1/2. The
//! step by hand is RKMK4 with nalgebra's `exp`, full products, [u, v] = uv − vu, and dexp⁻¹ to the second bracket.
//! Times are the minimum over rounds in which all take turns. Errors are those at t = 4. `equal` compares the times of
//! steps with equal error: t·(e/e₀)^(1/4) is the time of a step that has the error of the step by hand.

use std::hint::black_box;
use std::time::Instant;

use faer::Mat;
use lieflow::groups::Sample;
use lieflow::maps::{Cay, Exp, Pade22};
use lieflow::methods::{
    CommutatorFree, LieSeries, Method, OneBracket, Rkmk, commutator_free::CF4,
    one_bracket::RKMK4_2C, tableau::RK4,
};
use lieflow::problems::{Problem, RigidBodyN};
use lieflow::{SaveAt, Step, TimeGrid, integrate};
use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_pcg::Pcg64;

const H: f64 = 0.5;

struct ByHand {
    inverse_inertia: DMatrix<f64>,
}

impl ByHand {
    fn new(lambda: &[f64]) -> Self {
        let n = lambda.len();
        ByHand { inverse_inertia: DMatrix::from_fn(n, n, |i, j| 1.0 / (lambda[i] + lambda[j])) }
    }

    fn step(&self, h: f64, m: &DMatrix<f64>) -> DMatrix<f64> {
        let field = |m: &DMatrix<f64>| -m.component_mul(&self.inverse_inertia);
        let bracket = |a: &DMatrix<f64>, b: &DMatrix<f64>| a * b - b * a;
        let act = |u: &DMatrix<f64>| {
            let g = u.exp();
            &g * m * g.transpose()
        };
        let stage = |u: DMatrix<f64>| {
            let v = field(&act(&u));
            let uv = bracket(&u, &v);
            v - &uv * 0.5 + bracket(&u, &uv) / 12.0
        };
        let k1 = field(m);
        let k2 = stage(&k1 * (0.5 * h));
        let k3 = stage(&k2 * (0.5 * h));
        let k4 = stage(&k3 * h);
        act(&((k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)))
    }
}

/// One step, and the state after eight.
type Case<'a> = (&'static str, Box<dyn FnMut() + 'a>, Mat<f64>);

fn library<'a, M: Method<RigidBodyN> + 'a>(
    name: &'static str,
    body: &'a RigidBodyN,
    start: &Mat<f64>,
    method: M,
) -> Case<'a> {
    let mut end = start.clone();
    let grid = TimeGrid::with_steps([0.0, 8.0 * H], 8).expect("a grid");
    integrate(body, &method, &grid, &SaveAt::Ends, &mut end, |_, _| {}).expect("a run");
    let mut m = start.clone();
    let mut work = method.work(body, &m).expect("it fits");
    let run = move || {
        let step = Step { n: 0, t: 0.0, h: black_box(H) };
        method.step(body, step, &mut m, &mut work).expect("a step");
    };
    (name, Box::new(run), end)
}

fn compare(n: usize) {
    let lambda: Vec<f64> = (0..n).map(|i| 1.0 + i as f64 / n as f64).collect();
    let body = RigidBodyN::manakov(&lambda).expect("a body");
    let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(n as u64), 1.0).into_mat();
    let size = m.singular_values().expect("singular values")[0];
    let start = m * faer::Scale(1.0 / size);
    let mut exact = start.clone();
    let grid = TimeGrid::with_steps([0.0, 8.0 * H], 32).expect("a grid");
    let method = LieSeries::new(12).expect("an order");
    integrate(&body, &method, &grid, &SaveAt::Ends, &mut exact, |_, _| {}).expect("a run");

    let hand = ByHand::new(&lambda);
    let mut state = DMatrix::from_fn(n, n, |i, j| start[(i, j)]);
    let end = (0..8).fold(state.clone(), |m, _| hand.step(H, &m));
    let end = Mat::from_fn(n, n, |i, j| end[(i, j)]);
    let mut cases: Vec<Case<'_>> = vec![
        ("by hand", Box::new(|| state = hand.step(black_box(H), &state)), end),
        library("rkmk4 exp q=2", &body, &start, Rkmk::new(RK4, Exp.truncated(2))),
        library("rkmk4 exp", &body, &start, Rkmk::new(RK4, Exp)),
        library("rkmk4 cay", &body, &start, Rkmk::new(RK4, Cay)),
        library("rkmk4 pade22", &body, &start, Rkmk::new(RK4, Pade22)),
        library("rkmk4-2c", &body, &start, OneBracket(RKMK4_2C)),
        library("cf4", &body, &start, CommutatorFree(CF4)),
        library("taylor8", &body, &start, LieSeries::new(8).expect("an order")),
    ];
    let mut best = vec![f64::INFINITY; cases.len()];
    let repeat = (200_000 / (n * n * n)).clamp(1, 200);
    for _ in 0..if n < 100 { 40 } else { 6 } {
        for ((_, run, _), best) in cases.iter_mut().zip(&mut best) {
            let start = Instant::now();
            (0..repeat).for_each(|_| run());
            *best = best.min(start.elapsed().as_nanos() as f64 / repeat as f64);
        }
    }
    println!("n = {n}: microseconds a step, error, by hand/this: a step, equal error");
    let error = |m: &Mat<f64>| (m - &exact).norm_l2() / exact.norm_l2();
    let first = error(&cases[0].2);
    for ((name, _, end), ns) in cases.iter().zip(&best) {
        let error = error(end);
        let ratio = best[0] / ns;
        let equal = match *name {
            "taylor8" => ratio * (first / error).powf(0.125),
            _ => ratio * (first / error).powf(0.25),
        };
        println!("  {name:14} {:10.2}  {error:8.1e}  {ratio:6.2}  {equal:6.2}", ns / 1e3);
    }
}

fn main() {
    for n in [3, 4, 6, 8, 16, 32, 64, 128, 256] {
        compare(n);
    }
}
