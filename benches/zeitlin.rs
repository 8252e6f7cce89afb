//! Fluids on the sphere: `cargo bench --bench zeitlin [N …]`, by default N = 32 to 512.
//!
//! A random field of l < 10 with the root mean square 1, h = ħ/4. Times are CPU times of the thread, the
//! minimum over rounds in which both midpoint rules take turns. The columns `it.` and `cubic` are the iterations of a
//! step, and those in which the cubic term was computed.
//!
//! With `--exchange DIR N STEPS TOLERANCE` one run of each rule starts from DIR/start, which is made if it does not
//! exist. The results are in DIR/isospectral and DIR/energy, and ms a step are printed. `benches/zeitlin.py` uses this
//! to compare with quflow. The files are N×N complex numbers, row by row.

use std::fs;
use std::io::Read;
use std::path::Path;

use faer::c64;
use lieflow::groups::ComplexMatrix;
use lieflow::methods::FluidMidpoint;
use lieflow::problems::{Sphere, Zeitlin};
use lieflow::{Method, Step};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// The CPU time of this thread in seconds.
fn thread_seconds() -> f64 {
    let mut text = String::new();
    let read =
        fs::File::open("/proc/thread-self/schedstat").and_then(|mut f| f.read_to_string(&mut text));
    read.expect("the scheduler's statistics");
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).expect("nanoseconds") * 1e-9
}

struct Run<'a> {
    fluid: &'a Zeitlin<Sphere>,
    method: FluidMidpoint,
    work: <FluidMidpoint as Method<Zeitlin<Sphere>>>::Work,
    w: ComplexMatrix,
    n: u64,
}

impl<'a> Run<'a> {
    fn new(fluid: &'a Zeitlin<Sphere>, method: FluidMidpoint, w: &ComplexMatrix) -> Self {
        let work = method.work(fluid, w).expect("a workspace");
        Run { fluid, method, work, w: w.clone(), n: 0 }
    }
    /// Seconds a step.
    fn steps(&mut self, count: u64) -> f64 {
        let h = 0.25 * self.fluid.hbar();
        let start = thread_seconds();
        for _ in 0..count {
            let step = Step { n: self.n, t: 0.0, h };
            self.method.step(self.fluid, step, &mut self.w, &mut self.work).expect("a step");
            self.n += 1;
        }
        (thread_seconds() - start) / count as f64
    }
}

fn spectrum_gap(fluid: &Zeitlin<Sphere>, a: &ComplexMatrix, b: &ComplexMatrix) -> f64 {
    let [a, b] = [a, b].map(|w| fluid.spectrum(w).expect("eigenvalues"));
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn table(sizes: &[usize]) {
    println!(
        "    N | isospectral ms  it. cubic  spectrum | energy ms  it. cubic  spectrum     dH/H | ratio"
    );
    for &n in sizes {
        let fluid = Zeitlin::sphere(n).expect("a sphere");
        let start = fluid.random(&mut Pcg64::seed_from_u64(1), 10).expect("a field");
        let methods = [FluidMidpoint::isospectral(), FluidMidpoint::energy()];
        let mut runs = methods.map(|m| Run::new(&fluid, m, &start));
        let count = (4_000_000 / (n * n)).clamp(10, 400) as u64;
        let mut best = [f64::INFINITY; 2];
        for _ in 0..7 {
            for (run, best) in runs.iter_mut().zip(&mut best) {
                *best = best.min(1e3 * run.steps(count));
            }
        }
        let [it, it_energy] =
            runs.each_ref().map(|r| r.work.iterations().map(|i| i as f64 / r.n as f64));
        let [gap, gap_energy] = runs.each_ref().map(|r| spectrum_gap(&fluid, &start, &r.w));
        let energy = fluid.energy(&start);
        println!(
            "{n:5} | {:14.3} {:4.1} {:5.1}  {gap:8.1e} | {:9.3} {:4.1} {:5.1}  {gap_energy:8.1e} {:8.1e} | {:.2}",
            best[0],
            it[0],
            it[1],
            best[1],
            it_energy[0],
            it_energy[1],
            (fluid.energy(&runs[1].w) - energy).abs() / energy,
            best[1] / best[0],
        );
    }
}

fn load(path: &Path, n: usize) -> Option<ComplexMatrix> {
    let bytes = fs::read(path).ok()?;
    let x: Vec<f64> =
        bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("8 bytes"))).collect();
    Some(ComplexMatrix::from_fn(n, n, |i, j| c64::new(x[2 * (i * n + j)], x[2 * (i * n + j) + 1])))
}

fn store(path: &Path, w: &ComplexMatrix) {
    let n = w.nrows();
    let entry = |k: usize| w.get(k / n, k % n);
    let bytes = (0..n * n).flat_map(|k| [entry(k).re, entry(k).im]).flat_map(f64::to_le_bytes);
    fs::write(path, bytes.collect::<Vec<u8>>()).expect("a file");
}

fn exchange(dir: &Path, n: usize, count: u64, tolerance: f64) {
    let fluid = Zeitlin::sphere(n).expect("a sphere");
    let start = load(&dir.join("start"), n).unwrap_or_else(|| {
        let w = fluid.random(&mut Pcg64::seed_from_u64(1), 10).expect("a field");
        store(&dir.join("start"), &w);
        w
    });
    for (name, method) in
        [("isospectral", FluidMidpoint::isospectral()), ("energy", FluidMidpoint::energy())]
    {
        let method = match tolerance > 0.0 {
            true => method.with_tolerance(tolerance).expect("a tolerance"),
            false => method,
        };
        let mut run = Run::new(&fluid, method, &start);
        let ms = 1e3 * run.steps(count);
        let [iterations, cubic] = run.work.iterations().map(|i| i as f64 / count as f64);
        println!("{name} {ms} {iterations} {cubic} {}", spectrum_gap(&fluid, &start, &run.w));
        store(&dir.join(name), &run.w);
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match args.split_first() {
        Some((flag, rest)) if flag == "--exchange" => {
            let [dir, n, count, tolerance] = rest else {
                panic!("--exchange DIR N STEPS TOLERANCE")
            };
            let number = |x: &String| x.parse::<f64>().expect("a number");
            exchange(Path::new(dir), number(n) as usize, number(count) as u64, number(tolerance));
        }
        _ => {
            let sizes: Vec<usize> = args.iter().filter_map(|a| a.parse().ok()).collect();
            table(if sizes.is_empty() { &[32, 64, 128, 256, 512] } else { &sizes });
        }
    }
}
