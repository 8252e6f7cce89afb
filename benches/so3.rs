//! The closed forms on so(3) compared with nalgebra's `Rotation3` and `UnitQuaternion`.
//!
//! Prints nanoseconds a call over 1024 random vectors, the minimum over rounds that take turns. exp returns a `Result`,
//! and its check is part of the time; nalgebra returns none.
//!
//! `cargo bench --bench so3`

use std::hint::black_box;
use std::time::Instant;

use lieflow::so3;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const COUNT: usize = 1024;
const ROUNDS: usize = 40;
const REPEAT: usize = 20;

type Run<'a> = (&'a str, Box<dyn FnMut() + 'a>);

/// Evaluates f at every input and drops the results.
fn over<'a, I, O>(inputs: &'a [I], f: impl Fn(&I) -> O + 'a) -> Box<dyn FnMut() + 'a> {
    Box::new(move || {
        for x in black_box(inputs) {
            black_box(f(x));
        }
    })
}

/// The components of many vectors.
fn columns(x: impl Iterator<Item = Vector3<f64>> + Clone) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|k| x.clone().map(|x| x[k]).collect())
}

fn compare(title: &str, mut runs: Vec<Run<'_>>) {
    let mut best = vec![f64::INFINITY; runs.len()];
    for _ in 0..ROUNDS {
        for (run, best) in runs.iter_mut().zip(&mut best) {
            let start = Instant::now();
            for _ in 0..REPEAT {
                (run.1)();
            }
            let ns = start.elapsed().as_nanos() as f64 / (REPEAT * COUNT) as f64;
            *best = best.min(ns);
        }
    }
    println!("{title}");
    for ((name, _), ns) in runs.iter().zip(best) {
        println!("  {name:32} {ns:7.2} ns");
    }
}

fn main() {
    for (range, low, high) in [("0.01..0.9", 0.01, 0.9), ("1.0..3.1", 1.0, 3.1)] {
        let mut rng = Pcg64::seed_from_u64(1);
        let mut draw = || Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let directions: Vec<(Vector3<f64>, Vector3<f64>)> =
            (0..COUNT).map(|_| (draw(), draw())).collect();
        let mut rng = Pcg64::seed_from_u64(2);
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = directions
            .iter()
            .map(|(d, v)| (d / d.norm() * rng.random_range(low..high), *v))
            .collect();
        let u: Vec<Vector3<f64>> = pairs.iter().map(|(u, _)| *u).collect();
        let r: Vec<Matrix3<f64>> = u.iter().filter_map(|u| so3::exp(u).ok()).collect();
        let rotations: Vec<Rotation3<f64>> =
            r.iter().map(|r| Rotation3::from_matrix_unchecked(*r)).collect();
        let q: Vec<UnitQuaternion<f64>> =
            u.iter().map(|u| UnitQuaternion::from_scaled_axis(*u)).collect();

        let (us, vs) =
            (columns(pairs.iter().map(|(u, _)| *u)), columns(pairs.iter().map(|(_, v)| *v)));
        let views = |x: &'static [Vec<f64>; 3]| x.each_ref().map(|x| &x[..]);
        let (us, vs) = (views(Box::leak(Box::new(us))), views(Box::leak(Box::new(vs))));
        let mut out: [Vec<f64>; 9] = [(); 9].map(|()| vec![0.0; COUNT]);
        let mut three: [Vec<f64>; 3] = [(); 3].map(|()| vec![0.0; COUNT]);
        let (mut cay, mut dexp) = (out.clone(), three.clone());
        compare(
            &format!("arrays of {COUNT}, |u| in {range}, and a loop of single calls"),
            vec![
                (
                    "batch::exp",
                    Box::new(|| {
                        let r = out.each_mut().map(|x| &mut x[..]);
                        let _ = black_box(so3::batch::exp(black_box(us), r));
                    }),
                ),
                ("so3::exp", over(&u, |u| so3::exp(u).unwrap_or_default())),
                ("nalgebra Rotation3", over(&u, |u| Rotation3::from_scaled_axis(*u))),
                (
                    "batch::dexpinv",
                    Box::new(|| {
                        let w = three.each_mut().map(|x| &mut x[..]);
                        let _ = black_box(so3::batch::dexpinv(black_box(us), vs, w));
                    }),
                ),
                ("so3::dexpinv", over(&pairs, |(u, v)| so3::dexpinv(u, v))),
                (
                    "batch::dexp",
                    Box::new(|| {
                        let w = dexp.each_mut().map(|x| &mut x[..]);
                        let _ = black_box(so3::batch::dexp(black_box(us), vs, w));
                    }),
                ),
                (
                    "batch::cay",
                    Box::new(|| {
                        let r = cay.each_mut().map(|x| &mut x[..]);
                        let _ = black_box(so3::batch::cay(black_box(us), r));
                    }),
                ),
            ],
        );
        compare(
            &format!("exp, |u| in {range}"),
            vec![
                ("so3::exp", over(&u, |u| so3::exp(u).unwrap_or_default())),
                ("nalgebra Rotation3", over(&u, |u| Rotation3::from_scaled_axis(*u))),
                ("so3::exp_quaternion", over(&u, |u| so3::exp_quaternion(u).unwrap_or_default())),
                ("nalgebra UnitQuaternion", over(&u, |u| UnitQuaternion::from_scaled_axis(*u))),
            ],
        );
        compare(
            &format!("log, |u| in {range}"),
            vec![
                ("so3::log", over(&r, so3::log)),
                ("nalgebra Rotation3", over(&rotations, |r| r.scaled_axis())),
                (
                    "nalgebra via UnitQuaternion",
                    over(&rotations, |r| UnitQuaternion::from_rotation_matrix(r).scaled_axis()),
                ),
                ("so3::log_quaternion", over(&q, so3::log_quaternion)),
                ("nalgebra UnitQuaternion", over(&q, |q| q.scaled_axis())),
            ],
        );
        compare(
            &format!("differentials, |u| in {range} (no peer in nalgebra)"),
            vec![
                ("so3::dexpinv", over(&pairs, |(u, v)| so3::dexpinv(u, v))),
                ("so3::dexpinv_matrix", over(&u, so3::dexpinv_matrix)),
                ("so3::dexp", over(&pairs, |(u, v)| so3::dexp(u, v))),
                ("so3::dexp_matrix", over(&u, so3::dexp_matrix)),
                ("so3::cay", over(&u, so3::cay)),
                ("so3::dcayinv", over(&pairs, |(u, v)| so3::dcayinv(u, v))),
            ],
        );
        compare(
            &format!("Euler angles, |u| in {range}"),
            vec![
                ("so3::ccsk 321", over(&u, so3::ccsk::<f64, 2, 1, 0>)),
                (
                    "nalgebra from_euler_angles",
                    over(&u, |u| Rotation3::from_euler_angles(u[0], u[1], u[2])),
                ),
                ("so3::ccsk_inv 321", over(&r, so3::ccsk_inv::<2, 1, 0>)),
                ("nalgebra euler_angles", over(&rotations, |r| r.euler_angles())),
            ],
        );
    }
}
