//! Lie–Poisson methods: energy and Casimirs, composition, spectrum, and the energy's behaviour
//! over long times. On so(3), on Manakov's body on so(5), and on quadratic systems of other algebras.

use crate::support::systems::{self, quadratic, systems};
use faer::Mat;
use lieflow::groups::Sample;
use lieflow::maps::{Cay, Exp};
use lieflow::methods::{
    Composition, EnergyCasimir, GAUSS2, GAUSS4, GAUSS6, IsospectralGauss, KAHAN_LI6, SUZUKI4,
    SimoWong,
};
use lieflow::problems::{Exact, LiePoisson, RigidBody, RigidBodyN};
use lieflow::{LieAlgebra, Method, Problem, SaveAt, Step, StepError, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Manakov's body on so(5), its mass moments nothing special.
fn body() -> (RigidBodyN, Mat<f64>) {
    let body = RigidBodyN::manakov(&[0.4, 0.9, 1.3, 2.0, 2.8]).expect("a body");
    let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(5), 0.7).into_mat();
    (body, m)
}

/// The Casimirs of so(5): the moduli of the eigenvalues, in order.
fn spectrum(m: &Mat<f64>) -> Vec<f64> {
    let mut found: Vec<f64> = m.singular_values().expect("singular values");
    found.sort_by(f64::total_cmp);
    found
}

fn distance(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    (a - b).norm_l2()
}

/// On SO(5), Sp(4), GL(3) and SO(3,1): what is kept over 300 steps. Orders are in `orders/fields.rs`.
#[test]
fn on_every_algebra() {
    /// Rounding of 300 steps, for momenta of about 1.
    const KEPT: f64 = 3e-14;
    for (group, start) in systems() {
        let name = group.name();
        let system = quadratic(group);
        let grid = TimeGrid::with_steps([0.0, 2.0], 300).expect("a grid");
        macro_rules! check {
            ($($method:expr, $energy:literal;)*) => {$({
                let mut m = start.clone();
                integrate(&system, &$method, &grid, &SaveAt::Ends, &mut m, |_, _| {}).expect("a run");
                // The motion runs away where the group is not compact.
                let growth = (m.norm_l2() / start.norm_l2()).max(1.0).powi(2);
                for (a, b) in systems::casimirs(&m).iter().zip(systems::casimirs(&start)) {
                    assert!((a - b).abs() < KEPT * growth, "{name} {}: {a} {b}", stringify!($method));
                }
                let drift = (system.energy(&m) - system.energy(&start)).abs();
                let kept = drift < KEPT * growth;
                assert!(kept || !$energy, "{name} {}: {drift:e}", stringify!($method));
            })*};
        }
        check! {
            EnergyCasimir::new(Exp), true;
            EnergyCasimir::new(Cay), true;
            Composition::new(EnergyCasimir::new(Cay), SUZUKI4), true;
            IsospectralGauss(GAUSS2), false;
            IsospectralGauss(GAUSS4), false;
            IsospectralGauss(GAUSS6), false;
        }
    }
}

/// Largest relative energy deviation in the first and in the second half of T = 300, and the
/// deviation of the spectrum at the end.
fn long_run<M: Method<RigidBodyN>>(name: &str, method: &M) -> ([f64; 2], f64) {
    let (body, mut m) = body();
    let (energy, casimirs) = (body.hamiltonian(&m), spectrum(&m));
    let grid = TimeGrid::new([0.0, 300.0], 0.1).expect("a grid");
    let mut worst = [0.0f64; 2];
    integrate(&body, method, &grid, &SaveAt::Every(1), &mut m, |t, m| {
        let half = &mut worst[usize::from(t > 150.0)];
        *half = half.max((body.hamiltonian(m) / energy - 1.0).abs());
    })
    .expect("a run");
    let gap = spectrum(&m).iter().zip(&casimirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let gap = gap / casimirs[casimirs.len() - 1];
    println!("{name:28} energy {worst:?} spectrum {gap:.1e}");
    (worst, gap)
}

#[test]
fn energy_and_spectrum_over_3000_steps() {
    /// Spectrum and, where it is kept, energy: rounding of 3000 steps that has no preferred sign.
    const KEPT: f64 = 1e-13;
    macro_rules! check {
        ($($method:expr, $energy:expr;)*) => {$({
            let ([first, second], gap) = long_run(stringify!($method), &$method);
            assert!(gap < KEPT, "spectrum: {gap:e}");
            // Kept, or bounded: the second half is no worse than the first.
            assert!(second < $energy && second < KEPT.max(1.5 * first), "{first:e} {second:e}");
            assert_eq!(first < KEPT, $energy == KEPT, "{}", stringify!($method));
        })*};
    }
    check! {
        EnergyCasimir::new(Exp), KEPT;
        EnergyCasimir::new(Cay), KEPT;
        Composition::new(EnergyCasimir::new(Cay), KAHAN_LI6), KEPT;
        IsospectralGauss(GAUSS2), 1e-2;
        IsospectralGauss(GAUSS4), 1e-5;
        IsospectralGauss(GAUSS6), 1e-8;
    }
}

/// On so(3) the energy–Casimir method with cay is Simo and Wong's with k = 1, step by step.
#[test]
fn on_so3_it_is_simo_and_wong() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let start = Vector3::new(0.9, 1.0, 2.1);
    let grid = TimeGrid::new([0.0, 5.0], 0.1).expect("a grid");
    let (mut a, mut b, mut c) = (start, start, start);
    let mut other = Vec::new();
    integrate(&body, &SimoWong::ONE, &grid, &SaveAt::Every(1), &mut a, |_, m| other.push(*m))
        .expect("a run");
    let mut found = other.iter();
    integrate(&body, &EnergyCasimir::new(Cay), &grid, &SaveAt::Every(1), &mut b, |_, m| {
        let gap = found.next().map_or(f64::NAN, |x| (x - m).norm());
        assert!(gap < 1e-13, "{gap:e}");
    })
    .expect("a run");
    let tan = integrate(&body, &SimoWong::TAN, &grid, &SaveAt::Ends, &mut c, |_, _| {});
    tan.expect("a run");
    // exp(hξ) is Simo and Wong's with their own k.
    let mut d = start;
    integrate(&body, &EnergyCasimir::new(Exp), &grid, &SaveAt::Ends, &mut d, |_, _| {})
        .expect("a run");
    assert!((c - d).norm() < 1e-13 && (a - c).norm() > 1e-6);
}

/// Also on the layer over matrices, against the exact motion; a step beyond the contraction fails.
#[test]
fn matrices_at_n_3_and_steps_too_large() {
    let inertia = [1.0, 2.0, 3.0];
    let body = RigidBodyN::from_principal(inertia).expect("a body");
    let m = Vector3::new(0.9, 1.0, 2.1);
    let hat = |m: &Vector3<f64>| {
        let h = lieflow::groups::hat(m);
        Mat::from_fn(3, 3, |i, j| h[(i, j)])
    };
    let exact = Exact::new(inertia, m.into(), Matrix3::identity()).expect("a body");
    let mut w = hat(&m);
    let grid = TimeGrid::with_steps([0.0, 5.0], 100).expect("a grid");
    integrate(&body, &IsospectralGauss(GAUSS6), &grid, &SaveAt::Ends, &mut w, |_, _| {})
        .expect("a run");
    let gap = distance(&w, &hat(&exact.momentum_body(5.0).expect("a time")));
    assert!(gap < 1e-10, "{gap:e}");
    macro_rules! fails {
        ($($method:expr),*) => {$({
            let (mut y, method) = (w.clone(), $method);
            let mut work = method.work(&body, &y).expect("it fits");
            let step = Step { n: 0, t: 0.0, h: 50.0 };
            let error = method.step(&body, step, &mut y, &mut work).expect_err("too large");
            assert!(matches!(error, StepError::FixedPointDidNotConverge { .. }), "{error}");
            assert_eq!(y, w, "y is as it was");
        })*};
    }
    fails!(EnergyCasimir::new(Exp), IsospectralGauss(GAUSS2), IsospectralGauss(GAUSS6));
}
