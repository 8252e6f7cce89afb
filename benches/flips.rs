//! A job that users have, by every adaptive method: a free body beside its saddle, t = 0 … 1000, 1000 output times, an
//! event. `cargo bench --bench flips`; `benches/flips.py` compares it with other programs.
//!
//! A line for each run: the method, rtol, the steps, the zeros, the largest error of a row, and the least time of the
//! rounds in ms. With a file name as its argument it writes the exact rows there.

use std::fs;
use std::time::Instant;

use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::maps::Exp;
use lieflow::methods::tableau::{DOP853, DOPRI5};
use lieflow::methods::{Embedded, Rk, Rkmk, Taylor, TaylorMomentum};
use lieflow::problems::{Exact, RigidBody};
use lieflow::{Event, Solve};
use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const START: V = V::new(0.1, 2.0, 0.3);
const ROUNDS: usize = 15;

fn job<M: Embedded<RigidBody>>(name: &str, method: &M, exact: &[V]) {
    let body = RigidBody::new(INERTIA).expect("a body");
    let times: Vec<f64> = (0..=1000).map(f64::from).collect();
    for digits in 6..15 {
        let rtol = 0.1f64.powi(digits);
        let run = || {
            let solve = Solve::new(&body, method, [0.0, 1000.0]).tolerances(rtol, rtol);
            let solve = solve.times(&*times).event(Event::new("flip", |_, m: &V| m.y));
            solve.run(START).expect("a run")
        };
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS {
            let start = Instant::now();
            run();
            least = least.min(start.elapsed().as_secs_f64());
        }
        let run = run();
        let errors = run.points.iter().zip(exact).map(|(m, exact)| (m - exact).norm());
        let (error, steps, zeros) =
            (errors.fold(0.0, f64::max), run.stats.accepted, run.events.len());
        println!("{name:20} 1e-{digits} {steps} {zeros} {error:.2e} {:.3}", 1e3 * least);
    }
}

fn main() {
    let motion = Exact::new(INERTIA, START.into(), Matrix3::identity()).expect("a body");
    let exact: Vec<V> =
        (0..=1000).map(|t| motion.momentum_body(f64::from(t)).expect("a time")).collect();
    if let Some(file) = std::env::args().skip(1).find(|arg| !arg.starts_with('-')) {
        let rows = exact.iter().map(|m| format!("{:e} {:e} {:e}\n", m.x, m.y, m.z));
        fs::write(file, rows.collect::<String>()).expect("a file");
    }
    job("taylor16", &Taylor::<16>, &exact);
    job("taylor12", &Taylor::<12>, &exact);
    job("taylor16-m", &TaylorMomentum::<16>, &exact);
    job("taylor12-m", &TaylorMomentum::<12>, &exact);
    job("rk dop853", &Rk(DOP853), &exact);
    job("rkmk dop853 exp", &Rkmk::new(DOP853, Exp), &exact);
    job("rk dopri5", &Rk(DOPRI5), &exact);
    job("rkmk dopri5 exp", &Rkmk::new(DOPRI5, Exp), &exact);
    let body = RigidBody::new(INERTIA).expect("a body");
    let spec = MethodSpec::new("taylor16", None);
    job("taylor16 by name", &body.method(&spec).expect("a method"), &exact);
    let spec = MethodSpec { tableau: Some("dopri5".into()), ..MethodSpec::new("rk", None) };
    job("rk dopri5 by name", &body.method(&spec).expect("a method"), &exact);
}
