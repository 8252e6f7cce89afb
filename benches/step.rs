//! One step of each method on the rigid body: `cargo bench --bench step`.
//!
//! RKMK4 on so(3) is compared with the same step written by hand on arrays, which shows the cost of the abstraction. The
//! methods take turns. A number is the least time of the rounds.

use std::hint::black_box;
use std::time::Instant;

use faer::Mat;
use lieflow::groups::{LieGroup, hat};
use lieflow::maps::{CCSK123, CCSK321, Cay, Exp};
use lieflow::methods::{Method, Rk, Rkmk, tableau::RK4};
use lieflow::problems::{PointOf, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude};
use lieflow::{LieAlgebra, Problem, Step};
use nalgebra::{Matrix3, Vector3};

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const MOMENTUM: [f64; 3] = [0.2, 0.5, 3.0];
const H: f64 = 0.01;
const ROUNDS: usize = 21;
const STEPS: u32 = 20_000;

/// A loop of so many steps.
type Loop = Box<dyn FnMut(u32)>;

/// The steps of a method on a problem.
fn steps<P, M>(problem: P, method: M, y: PointOf<P>) -> Loop
where
    P: Problem<Group: LieAlgebra<Scalar = f64>> + 'static,
    M: Method<P> + 'static,
{
    let mut y = y;
    let mut work = method.work(&problem, &y).expect("the method fits");
    Box::new(move |count| {
        for _ in 0..count {
            let step = Step { n: 0, t: 0.0, h: black_box(H) };
            method.step(&problem, step, &mut y, &mut work).expect("a step");
        }
    })
}

fn momentum_matrix() -> Mat<f64> {
    let m = hat(&Vector3::from(MOMENTUM));
    Mat::from_fn(3, 3, |i, j| m[(i, j)])
}

fn main() {
    let body = || RigidBody::new(INERTIA).expect("a body");
    let attitude = || RigidBodyAttitude::new(INERTIA, MOMENTUM).expect("a body");
    let general = || RigidBodyN::from_principal(INERTIA).expect("a body");
    let general_attitude =
        || RigidBodyNAttitude::new(general(), momentum_matrix()).expect("a body");
    let (m, g) = (Vector3::from(MOMENTUM), Matrix3::identity());
    let mut loops: Vec<(String, Loop)> = vec![
        ("rk4, m".into(), steps(body(), Rk(RK4), m)),
        ("rk4, g".into(), steps(attitude(), Rk(RK4), g)),
        ("rkmk4 cay by hand, m".into(), Box::new(by_hand::steps_cay())),
    ];
    macro_rules! rkmk {
        ($($name:literal: $psi:expr;)*) => {$(
            let method = Rkmk::new(RK4, $psi);
            let mut add = |what: &str, steps| loops.push((format!("rkmk4 {}, {what}", $name), steps));
            add("m", steps(body(), method, m));
            add("g", steps(attitude(), method, g));
            add("m as a matrix", steps(general(), method, momentum_matrix()));
            let start = general_attitude().group().identity();
            add("g as a matrix", steps(general_attitude(), method, start));
        )*};
    }
    rkmk! {
        "exp": Exp;
        "cay": Cay;
        "ccsk123": CCSK123;
        "ccsk321": CCSK321;
    }
    let mut least = vec![f64::INFINITY; loops.len()];
    for _ in 0..ROUNDS {
        for ((_, steps), least) in loops.iter_mut().zip(&mut least) {
            let start = Instant::now();
            steps(STEPS);
            *least = least.min(start.elapsed().as_secs_f64() / f64::from(STEPS));
        }
    }
    for ((name, _), least) in loops.iter().zip(least) {
        println!("{name:30} {:8.1} ns", 1e9 * least);
    }
}

mod by_hand {
    use super::*;

    fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }
    /// cay(u)·m.
    fn act(u: [f64; 3], m: [f64; 3]) -> [f64; 3] {
        let a = 1.0 / (1.0 + 0.25 * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
        let um = cross(u, m);
        let uum = cross(u, um);
        std::array::from_fn(|i| m[i] + a * um[i] + 0.5 * a * uum[i])
    }
    /// dcay_u⁻¹(−J⁻¹m).
    fn field(u: [f64; 3], m: [f64; 3]) -> [f64; 3] {
        let v: [f64; 3] = std::array::from_fn(|i| -m[i] / INERTIA[i]);
        let c = 0.25 * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
        let uv = cross(u, v);
        std::array::from_fn(|i| v[i] + c * u[i] - 0.5 * uv[i])
    }

    /// RKMK4 with cay on the momentum.
    pub(super) fn steps_cay() -> impl FnMut(u32) {
        let mut m = MOMENTUM;
        move |count| {
            for _ in 0..count {
                let h = black_box(H);
                let scaled = |a: f64, k: [f64; 3]| k.map(|k| h * a * k);
                let k1 = field([0.0; 3], m);
                let u = scaled(0.5, k1);
                let k2 = field(u, act(u, m));
                let u = scaled(0.5, k2);
                let k3 = field(u, act(u, m));
                let u = scaled(1.0, k3);
                let k4 = field(u, act(u, m));
                let sum = |i: usize| k1[i] / 6.0 + k2[i] / 3.0 + k3[i] / 3.0 + k4[i] / 6.0;
                m = act(std::array::from_fn(|i| h * sum(i)), m);
            }
            black_box(m);
        }
    }
}
