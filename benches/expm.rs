//! The dense matrix exponential compared with nalgebra's: interleaved rounds, the minimum of each.
//!
//! `cargo bench --bench expm` prints one row for each n and norm: nanoseconds, the ratio, and the
//! cost in products of the same size. Arguments select sizes n and kinds (so, sp,
//! gl).

use std::hint::black_box;
use std::time::Instant;

use faer::{Accum, Mat, Par};
use lieflow::dense::{Exponential, Structure};
use nalgebra::{DMatrix, SMatrix};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

const NORMS: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
const ROUNDS: usize = 9;

/// Nanoseconds a call: the contestants take turns, and each keeps its best round.
fn race(contestants: &mut [&mut dyn FnMut()]) -> Vec<f64> {
    let mut repetitions = vec![1u32; contestants.len()];
    for (f, n) in contestants.iter_mut().zip(&mut repetitions) {
        f();
        let start = Instant::now();
        f();
        let once = start.elapsed().as_secs_f64().max(2e-8);
        *n = (2e-3 / once).clamp(1.0, 1e5) as u32;
    }
    let mut best = vec![f64::INFINITY; contestants.len()];
    for _ in 0..ROUNDS {
        for (i, f) in contestants.iter_mut().enumerate() {
            let start = Instant::now();
            for _ in 0..repetitions[i] {
                f();
            }
            let each = start.elapsed().as_secs_f64() / f64::from(repetitions[i]);
            best[i] = best[i].min(1e9 * each);
        }
    }
    best
}

fn uniform(rng: &mut Pcg64) -> f64 {
    rng.next_u64() as f64 / 2f64.powi(63) - 1.0
}

/// An element of the algebra with ‖u‖₁ = `norm`.
fn element(kind: &str, n: usize, norm: f64) -> Mat<f64> {
    let mut rng = Pcg64::seed_from_u64(n as u64);
    let mut u = Mat::from_fn(n, n, |_, _| uniform(&mut rng));
    let m = n / 2;
    match kind {
        "so" => u = &u - u.transpose(),
        "sp" => {
            let x = u.clone();
            u = Mat::from_fn(n, n, |i, j| match (i < m, j < m) {
                (true, true) => x[(i, j)],
                (false, false) => -x[(j - m, i - m)],
                (true, false) => x[(i, j)] + x[(j - m, i + m)],
                (false, true) => x[(i, j)] + x[(j + m, i - m)],
            });
        }
        _ => {}
    }
    let norm1 = (0..n).map(|j| u.col(j).iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    u * faer::Scale(norm / norm1)
}

fn fixed<const N: usize>(u: &Mat<f64>) -> Box<dyn FnMut()>
where
    nalgebra::Const<N>: nalgebra::DimMin<nalgebra::Const<N>, Output = nalgebra::Const<N>>,
{
    let u = SMatrix::<f64, N, N>::from_fn(|i, j| u[(i, j)]);
    Box::new(move || {
        black_box(black_box(&u).exp());
    })
}

/// nalgebra's exp, on a matrix of fixed size for small n, else of dynamic size.
fn peer(u: &Mat<f64>) -> Box<dyn FnMut()> {
    match u.nrows() {
        3 => fixed::<3>(u),
        4 => fixed::<4>(u),
        6 => fixed::<6>(u),
        8 => fixed::<8>(u),
        16 => fixed::<16>(u),
        n => {
            let u = DMatrix::from_fn(n, n, |i, j| u[(i, j)]);
            Box::new(move || drop(black_box(black_box(&u).exp())))
        }
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let picked = |all: &[&'static str]| -> Vec<&'static str> {
        let some: Vec<_> = all.iter().copied().filter(|x| args.iter().any(|a| a == x)).collect();
        if some.is_empty() { all.to_vec() } else { some }
    };
    let kinds = picked(&["so", "sp", "gl"]);
    let sizes = picked(&["3", "4", "6", "8", "16", "32", "64", "128", "256", "512"]);
    println!("kind    n   norm        own ns    nalgebra ns  ratio      G  choice");
    for n in sizes.iter().filter_map(|n| n.parse::<usize>().ok()) {
        for kind in &kinds {
            if *kind == "sp" && n % 2 == 1 {
                continue;
            }
            for norm in NORMS {
                row(kind, n, norm);
            }
        }
    }
}

fn row(kind: &str, n: usize, norm: f64) {
    let u = element(kind, n, norm);
    let structure = if kind == "so" { Structure::Skew } else { Structure::General };
    let (mut own, mut out) = (Exponential::new(n), Mat::zeros(n, n));
    let (mut product, mut peer) = (Mat::<f64>::zeros(n, n), peer(&u));
    let times = race(&mut [
        &mut || {
            let _ = black_box(own.exp(black_box(&u), structure, &mut out));
        },
        &mut *peer,
        &mut || {
            let (a, b) = (black_box(u.as_ref()), u.as_ref());
            faer::linalg::matmul::matmul(&mut product, Accum::Replace, a, b, 1.0, Par::Seq);
        },
    ]);
    let choice = own.choice();
    println!(
        "{kind:4} {n:4} {norm:6} {:13.1} {:14.1} {:6.2} {:6.2}  {:?} {} s={} c={}",
        times[0],
        times[1],
        times[1] / times[0],
        times[0] / times[2],
        choice.kind,
        choice.degree,
        choice.squarings,
        choice.corrections
    );
}
