//! One step of each method on the rigid body: `cargo bench --bench step`.
//!
//! RKMK4 on so(3) is compared with the same step written by hand on arrays, which shows the cost of the abstraction.

use std::hint::black_box;

use divan::Bencher;
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

fn main() {
    divan::main();
}

fn bench<P: Problem, M: Method<P>>(bencher: Bencher<'_, '_>, problem: P, method: M, y: PointOf<P>)
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    let mut y = y;
    let mut work = method.work(&problem, &y).expect("the method fits");
    bencher.bench_local(|| {
        let step = Step { n: 0, t: 0.0, h: black_box(H) };
        method.step(&problem, step, &mut y, &mut work).expect("a step");
    });
}

macro_rules! steps {
    ($($module:ident: $psi:expr;)*) => {$(
        mod $module {
            use super::*;

            #[divan::bench]
            fn momentum(bencher: Bencher<'_, '_>) {
                let body = RigidBody::new(INERTIA).expect("a body");
                bench(bencher, body, Rkmk::new(RK4, $psi), Vector3::from(MOMENTUM));
            }
            #[divan::bench]
            fn attitude(bencher: Bencher<'_, '_>) {
                let body = RigidBodyAttitude::new(INERTIA, MOMENTUM).expect("a body");
                bench(bencher, body, Rkmk::new(RK4, $psi), Matrix3::identity());
            }
            #[divan::bench]
            fn momentum_general(bencher: Bencher<'_, '_>) {
                let body = RigidBodyN::from_principal(INERTIA).expect("a body");
                bench(bencher, body, Rkmk::new(RK4, $psi), momentum_matrix());
            }
            #[divan::bench]
            fn attitude_general(bencher: Bencher<'_, '_>) {
                let body = RigidBodyN::from_principal(INERTIA).expect("a body");
                let body = RigidBodyNAttitude::new(body, momentum_matrix()).expect("a body");
                let start = body.group().identity();
                bench(bencher, body, Rkmk::new(RK4, $psi), start);
            }
        }
    )*};
}
steps! {
    exp: Exp;
    cay: Cay;
    ccsk123: CCSK123;
    ccsk321: CCSK321;
}

fn momentum_matrix() -> Mat<f64> {
    let m = hat(&Vector3::from(MOMENTUM));
    Mat::from_fn(3, 3, |i, j| m[(i, j)])
}

mod classical {
    use super::*;

    #[divan::bench]
    fn momentum(bencher: Bencher<'_, '_>) {
        let body = RigidBody::new(INERTIA).expect("a body");
        bench(bencher, body, Rk(RK4), Vector3::from(MOMENTUM));
    }
    #[divan::bench]
    fn attitude(bencher: Bencher<'_, '_>) {
        let body = RigidBodyAttitude::new(INERTIA, MOMENTUM).expect("a body");
        bench(bencher, body, Rk(RK4), Matrix3::identity());
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
    #[divan::bench]
    fn momentum_cay(bencher: Bencher<'_, '_>) {
        let mut m = MOMENTUM;
        bencher.bench_local(|| {
            let h = black_box(H);
            let scaled = |a: f64, k: [f64; 3]| k.map(|k| h * a * k);
            let k1 = field([0.0; 3], m);
            let u = scaled(0.5, k1);
            let k2 = field(u, act(u, m));
            let u = scaled(0.5, k2);
            let k3 = field(u, act(u, m));
            let u = scaled(1.0, k3);
            let k4 = field(u, act(u, m));
            let v = std::array::from_fn(|i| {
                h * (1.0 / 6.0 * k1[i] + 1.0 / 3.0 * k2[i] + 1.0 / 3.0 * k3[i] + 1.0 / 6.0 * k4[i])
            });
            m = act(v, m);
        });
    }
}
