//! The special methods compared with loops by hand and with general methods: `cargo bench --bench special`.
//!
//! 1. A step on so(3), compared with the same step written out on arrays.
//! 2. The attitude of the free body at T = 100 (J = 1, 4, 18, m = (0, 2.75, 2.75)): the time to reach
//!    an error, the best over tolerances or steps, compared with DOP853 on the group and on
//!    the nine entries.
//! 3. The exact motion at one time.
//!
//! Times are the minimum over rounds in which all take turns.

use std::hint::black_box;
use std::time::Instant;

use lieflow::maps::Exp;
use lieflow::methods::{DMV2, MR2, MR4, Method, Rk, Rkmk, Taylor, tableau::DOP853, tableau::RK4};
use lieflow::problems::{Exact, RigidBody, RigidBodyAttitude, RigidBodyState};
use lieflow::{SaveAt, Step};
use lieflow::{StepControl, integrate_adaptive};
use nalgebra::{Matrix3, Vector3};

type Run<'a> = (String, Box<dyn FnMut() + 'a>);

/// The least nanoseconds of one call of each, over rounds that take turns.
fn compare(runs: &mut [Run<'_>], rounds: usize, repeat: usize) -> Vec<f64> {
    let mut best = vec![f64::INFINITY; runs.len()];
    for _ in 0..rounds {
        for (run, best) in runs.iter_mut().zip(&mut best) {
            let start = Instant::now();
            (0..repeat).for_each(|_| (run.1)());
            *best = best.min(start.elapsed().as_nanos() as f64 / repeat as f64);
        }
    }
    best
}

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const MOMENTUM: [f64; 3] = [0.2, 0.5, 3.0];
const H: f64 = 0.01;
/// Steps in one call.
const STEPS: usize = 1000;

/// Steps of a method whose coefficients the compiler knows, as in the loop by hand.
macro_rules! library {
    ($name:literal, $method:expr) => {{
        let body = RigidBody::new(INERTIA).expect("a body");
        let mut m = Vector3::from(MOMENTUM);
        let mut work = Method::work(&$method, &body, &m).expect("it fits");
        let run = move || {
            for _ in 0..STEPS {
                let step = Step { n: 0, t: 0.0, h: black_box(H) };
                Method::step(&$method, &body, step, &mut m, &mut work).expect("a step");
            }
        };
        (concat!($name, ", library").to_string(), Box::new(run) as Box<dyn FnMut()>)
    }};
}

fn hand<'a>(name: &str, step: impl Fn(f64, [f64; 3]) -> [f64; 3] + 'a) -> Run<'a> {
    let mut m = MOMENTUM;
    let run = move || {
        for _ in 0..STEPS {
            m = step(black_box(H), m);
        }
    };
    (format!("{name}, by hand"), Box::new(run))
}

mod by_hand {
    use super::INERTIA;

    type V = [f64; 3];

    fn cross(a: V, b: V) -> V {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }
    fn dot(a: V, b: V) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }
    fn axpy(a: f64, x: V, y: V) -> V {
        [y[0] + a * x[0], y[1] + a * x[1], y[2] + a * x[2]]
    }
    const J: V = [1.0 / INERTIA[0], 1.0 / INERTIA[1], 1.0 / INERTIA[2]];

    pub(super) fn rk4(h: f64, m: V) -> V {
        let f = |m: V| cross(m, [J[0] * m[0], J[1] * m[1], J[2] * m[2]]);
        let k1 = f(m);
        let k2 = f(axpy(0.5 * h, k1, m));
        let k3 = f(axpy(0.5 * h, k2, m));
        let k4 = f(axpy(h, k3, m));
        std::array::from_fn(|i| m[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }

    pub(super) fn rkmk4_exp(h: f64, m: V) -> V {
        let field = |m: V| [-J[0] * m[0], -J[1] * m[1], -J[2] * m[2]];
        let act = |u: V, a: f64, b: f64, m: V| {
            let um = cross(u, m);
            axpy(b, cross(u, um), axpy(a, um, m))
        };
        let stage = |u: V| {
            let z = dot(u, u);
            let alpha = z.sqrt();
            let (s, c) = (0.5 * alpha).sin_cos();
            let (a, b, d) = if alpha < 1e-3 {
                (1.0 - z / 6.0, 0.5 - z / 24.0, 1.0 / 12.0 + z / 720.0)
            } else {
                (2.0 * s * c / alpha, 2.0 * s * s / z, (1.0 - 0.5 * alpha * c / s) / z)
            };
            let v = field(act(u, a, b, m));
            let uv = cross(u, v);
            axpy(d, cross(u, uv), axpy(-0.5, uv, v))
        };
        let scaled = |a: f64, k: V| [a * k[0], a * k[1], a * k[2]];
        let k1 = field(m);
        let k2 = stage(scaled(0.5 * h, k1));
        let k3 = stage(scaled(0.5 * h, k2));
        let k4 = stage(scaled(h, k3));
        let v: V = std::array::from_fn(|i| h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        let z = dot(v, v);
        let alpha = z.sqrt();
        let (s, c) = (0.5 * alpha).sin_cos();
        let (a, b) = if alpha < 1e-3 {
            (1.0 - z / 6.0, 0.5 - z / 24.0)
        } else {
            (2.0 * s * c / alpha, 2.0 * s * s / z)
        };
        act(v, a, b, m)
    }

    fn turn(m: &mut V, k: usize, t: f64) {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let (s, c) = (t * J[k] * m[k]).sin_cos();
        (m[i], m[j]) = (c * m[i] + s * m[j], c * m[j] - s * m[i]);
    }

    pub(super) fn mr2(h: f64, mut m: V) -> V {
        turn(&mut m, 0, 0.5 * h);
        turn(&mut m, 1, 0.5 * h);
        turn(&mut m, 2, h);
        turn(&mut m, 1, 0.5 * h);
        turn(&mut m, 0, 0.5 * h);
        m
    }

    pub(super) fn mr4(h: f64, mut m: V) -> V {
        let w = 1.0 / (2.0 - 2f64.cbrt());
        let mut before = 0.0;
        for w in [w, 1.0 - 2.0 * w, w] {
            turn(&mut m, 0, h * (before + 0.5 * w));
            turn(&mut m, 1, 0.5 * h * w);
            turn(&mut m, 2, h * w);
            turn(&mut m, 1, 0.5 * h * w);
            before = 0.5 * w;
        }
        turn(&mut m, 0, h * before);
        m
    }

    /// Newton's iteration on c = (1 + |c|²)a + d c c, and the rotation cay(2c) of m.
    pub(super) fn dmv2(h: f64, m: V) -> V {
        let i = INERTIA;
        let a: V = std::array::from_fn(|k| 0.5 * h * J[k] * m[k]);
        let d = [(i[1] - i[2]) * J[0], (i[2] - i[0]) * J[1], (i[0] - i[1]) * J[2]];
        let scale = dot(a, a).sqrt();
        let mut c = a;
        for _ in 0..20 {
            let grown = 1.0 + dot(c, c);
            let r = [
                c[0] - grown * a[0] - d[0] * c[1] * c[2],
                c[1] - grown * a[1] - d[1] * c[2] * c[0],
                c[2] - grown * a[2] - d[2] * c[0] * c[1],
            ];
            let x = [
                1.0 - 2.0 * a[0] * c[0],
                -2.0 * a[1] * c[0] - d[1] * c[2],
                -2.0 * a[2] * c[0] - d[2] * c[1],
            ];
            let y = [
                -2.0 * a[0] * c[1] - d[0] * c[2],
                1.0 - 2.0 * a[1] * c[1],
                -2.0 * a[2] * c[1] - d[2] * c[0],
            ];
            let z = [
                -2.0 * a[0] * c[2] - d[0] * c[1],
                -2.0 * a[1] * c[2] - d[1] * c[0],
                1.0 - 2.0 * a[2] * c[2],
            ];
            let yz = cross(y, z);
            let s = 1.0 / dot(x, yz);
            let e = [s * dot(r, yz), s * dot(r, cross(z, x)), s * dot(r, cross(x, y))];
            c = [c[0] - e[0], c[1] - e[1], c[2] - e[2]];
            if dot(e, e).sqrt() < 2e-10 * scale {
                break;
            }
        }
        // cay(−2c) m = m + s(−c × m + c × (c × m)), s = 2/(1 + |c|²).
        let s = 2.0 / (1.0 + dot(c, c));
        let cm = cross(c, m);
        axpy(s, cross(c, cm), axpy(-s, cm, m))
    }
}

fn steps_by_hand() {
    println!("a step on so(3)*: nanoseconds, library/by hand");
    let mut runs = vec![
        library!("rkmk4 exp", Rkmk::new(RK4, Exp)),
        hand("rkmk4 exp", by_hand::rkmk4_exp),
        library!("rk4", Rk(RK4)),
        hand("rk4", by_hand::rk4),
        library!("mr2", MR2),
        hand("mr2", by_hand::mr2),
        library!("mr4", MR4),
        hand("mr4", by_hand::mr4),
        library!("dmv2", DMV2),
        hand("dmv2", by_hand::dmv2),
    ];
    let best = compare(&mut runs, 300, 1);
    for (pair, names) in best.chunks(2).zip(runs.chunks(2)) {
        let [library, hand] = [pair[0], pair[1]].map(|ns| ns / STEPS as f64);
        println!("  {:24} {library:8.1} {hand:8.1} {:8.2}", names[1].0, library / hand);
    }
}

const TOP: [f64; 3] = [1.0, 4.0, 18.0];
const SPIN: [f64; 3] = [0.0, 2.75, 2.75];
const T: f64 = 100.0;
const GOALS: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// One integration: its error.
type Integration<'a> = Box<dyn Fn() -> f64 + 'a>;

fn taylor_fixed<'a, const N: usize>(exact: &'a Matrix3<f64>, steps: usize) -> Integration<'a> {
    let body = RigidBodyState::new(TOP).expect("a body");
    Box::new(move || {
        let mut y = body.state(SPIN, Matrix3::identity()).expect("a state");
        let mut work = Taylor::<N>.work(&body, &y).expect("a workspace");
        let h = T / steps as f64;
        for n in 0..steps {
            let step = Step { n: n as u64, t: 0.0, h: black_box(h) };
            Taylor::<N>.step(&body, step, &mut y, &mut work).expect("a step");
        }
        (y.g - exact).norm() / exact.norm()
    })
}

fn taylor_advance<'a, const N: usize>(exact: &'a Matrix3<f64>, tol: f64) -> Integration<'a> {
    let body = RigidBodyState::new(TOP).expect("a body");
    Box::new(move || {
        let mut y = body.state(SPIN, Matrix3::identity()).expect("a state");
        Taylor::<N>.advance(&body, T, black_box(tol), &mut 0.3, &mut y).expect("a run");
        (y.g - exact).norm() / exact.norm()
    })
}

fn dop853<'a>(exact: &'a Matrix3<f64>, tol: f64, on_group: bool) -> Integration<'a> {
    let body = RigidBodyAttitude::<f64>::new(TOP, SPIN).expect("a body");
    Box::new(move || {
        let mut g = Matrix3::identity();
        let control = StepControl::new(0.0, black_box(tol)).expect("a tolerance");
        let save = SaveAt::Ends;
        let done = match on_group {
            true => integrate_adaptive(
                &body,
                &Rkmk::new(DOP853, Exp),
                [0.0, T],
                &control,
                &save,
                &mut g,
                |_, _| {},
            ),
            false => {
                integrate_adaptive(&body, &Rk(DOP853), [0.0, T], &control, &save, &mut g, |_, _| {})
            }
        };
        done.expect("a run");
        (g - exact).norm() / exact.norm()
    })
}

fn attitude() {
    let exact = Exact::new(TOP, SPIN, Matrix3::identity()).expect("a body");
    let (_, exact) = exact.state(T).expect("a time");
    let tolerances: Vec<f64> = (4..=30).map(|k| 10f64.powf(-0.5 * k as f64)).collect();
    let steps: Vec<usize> = (0..24).map(|k| (60.0 * 1.16f64.powi(k)) as usize).collect();
    let mut families: Vec<(String, Vec<Integration<'_>>)> = Vec::new();
    macro_rules! taylor {
        ($($n:literal)*) => {$(
            families.push((
                format!("taylor{}, fixed step", $n),
                steps.iter().map(|&n| taylor_fixed::<$n>(&exact, n)).collect(),
            ));
            families.push((
                format!("taylor{}, step from its terms", $n),
                tolerances.iter().map(|&tol| taylor_advance::<$n>(&exact, tol)).collect(),
            ));
        )*};
    }
    taylor!(8 9 10 12 13 15 16);
    for (name, on_group) in [("dop853, rkmk exp", true), ("dop853, nine entries", false)] {
        let runs = tolerances.iter().map(|&tol| dop853(&exact, tol, on_group)).collect();
        families.push((name.into(), runs));
    }
    // Rounds visit every run of every family.
    let mut best: Vec<Vec<f64>> = families.iter().map(|f| vec![f64::INFINITY; f.1.len()]).collect();
    for _ in 0..30 {
        for ((_, runs), best) in families.iter().zip(&mut best) {
            for (run, best) in runs.iter().zip(best) {
                let start = Instant::now();
                black_box(run());
                *best = best.min(start.elapsed().as_nanos() as f64);
            }
        }
    }
    println!("attitude at T = 100: microseconds to an error of 1e-3, 1e-6, 1e-9, 1e-12");
    for ((name, runs), best) in families.iter().zip(&best) {
        let errors: Vec<f64> = runs.iter().map(|run| run()).collect();
        let times = GOALS.map(|goal| {
            let reached = errors.iter().zip(best).filter(|(e, _)| **e <= goal).map(|(_, t)| *t);
            reached.fold(f64::INFINITY, f64::min) / 1e3
        });
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        println!("  {name:34} {times:8.1?}   least error {least:.1e}");
    }
}

fn exact_motion() {
    let body = Exact::new(TOP, SPIN, Matrix3::identity()).expect("a body");
    let mut t = T;
    let state = move || {
        for _ in 0..STEPS {
            t += 1e-3;
            black_box(body.state(black_box(t)).expect("a time"));
        }
    };
    let body = Exact::new(TOP, SPIN, Matrix3::identity()).expect("a body");
    let momentum = move || {
        for _ in 0..STEPS {
            t += 1e-3;
            black_box(body.momentum_body(black_box(t)).expect("a time"));
        }
    };
    let orbit = || {
        for _ in 0..STEPS {
            black_box(Exact::new(black_box(TOP), SPIN, Matrix3::identity()).expect("a body"));
        }
    };
    let mut runs: Vec<Run<'_>> = vec![
        ("m and attitude at t".into(), Box::new(state)),
        ("m at t".into(), Box::new(momentum)),
        ("a new orbit".into(), Box::new(orbit)),
    ];
    let best = compare(&mut runs, 100, 1);
    println!("exact motion: nanoseconds");
    for ((name, _), ns) in runs.iter().zip(best) {
        println!("  {name:24} {:8.1}", ns / STEPS as f64);
    }
}

fn main() {
    steps_by_hand();
    exact_motion();
    attitude();
}
