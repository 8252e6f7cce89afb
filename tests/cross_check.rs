//! General against specialised at n = 3: the dense layer and the closed forms on so(3) are the same
//! maps, to 8 eps·cond, at every magnitude; and every branch of the dense layer is visited.

use std::collections::BTreeSet;

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, LieGroup, MatrixGroup, Sample, So3, hat, vee};
use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Dexpinv, Exp};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::{RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude};
use lieflow::{CoordinateMap, LieAlgebra, Method, Step};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;
/// The bound of the promise, in units of eps·cond.
const BOUND: f64 = 8.0;

fn dense(x: &Matrix3<f64>) -> Mat<f64> {
    Mat::from_fn(3, 3, |i, j| x[(i, j)])
}
fn dense_algebra(u: &Vector3<f64>) -> AlgebraMatrix {
    AlgebraMatrix::new_unchecked(dense(&hat(u)))
}
fn fixed(x: &Mat<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| x[(i, j)])
}

/// A random direction at a magnitude that is log-uniform over all that have meaning, with every
/// tenth near a multiple of π/2.
fn random_vector(rng: &mut Pcg64) -> Vector3<f64> {
    let direction = match rng.random_range(0..8) {
        0 => Vector3::ith(rng.random_range(0..3), 1.0),
        _ => So3::new().sample_vector(rng).normalize(),
    };
    let size = match rng.random_range(0..10) {
        0 => {
            let k: f64 = rng.random_range(1..9).into();
            let offset: f64 = 10f64.powf(rng.random_range(-15.0..0.0));
            k * std::f64::consts::FRAC_PI_2 * (1.0 + offset)
        }
        1..5 => 10f64.powf(rng.random_range(-3.0..1.0)),
        _ => 10f64.powf(rng.random_range(-320.0..14.5)),
    };
    direction * size
}

/// The distance of α to the singular set 2π, 4π, … of dexp.
fn distance_to_singular(alpha: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    (alpha - turn * (alpha / turn).round().max(1.0)).abs()
}

#[derive(Default)]
struct Worst(std::collections::BTreeMap<&'static str, (f64, Vector3<f64>)>);

impl Worst {
    /// `gap` relative to `size`, in units of eps·cond.
    fn see(&mut self, name: &'static str, u: Vector3<f64>, gap: f64, size: f64, cond: f64) {
        let units = if gap == 0.0 { 0.0 } else { gap / (EPS * size * cond) };
        assert!(units <= BOUND, "{name} at u = {u:?}: {units} eps·cond");
        let worst = self.0.entry(name).or_default();
        if units > worst.0 {
            *worst = (units, u);
        }
    }
}

#[test]
fn maps_and_inverse_differentials_on_100_000_vectors() {
    let (so3, general) = (So3::<f64>::new(), MatrixGroup::so(3).expect("SO(3)"));
    let mut rng = Pcg64::seed_from_u64(3);
    let mut worst = Worst::default();
    let mut ats = (
        Exp.at(&general).expect("exp"),
        Cay.at(&general).expect("cay"),
        CCSK123.at(&general).expect("ccsk"),
        CCSK321.at(&general).expect("ccsk"),
    );
    let mut compared = [0usize; 2];
    for _ in 0..100_000 {
        let u = random_vector(&mut rng);
        let v = so3.sample_vector(&mut rng);
        let alpha = u.norm();
        let dense_u = dense_algebra(&u);
        macro_rules! compare {
            ($map:expr, $at:expr, $psi:literal, $inverse:literal, $cond:expr, $size:expr, $cond_inverse:expr) => {{
                let closed = $map.eval(&so3, &u);
                let mut g = general.identity();
                let mine = $map.psi(&general, &dense_u, $at, &mut g);
                if let (Ok(closed), Ok(())) = (&closed, &mine) {
                    worst.see($psi, u, (closed - fixed(&g)).norm(), 3f64.sqrt(), $cond);
                    compared[0] += 1;
                    let mut w = dense_algebra(&v);
                    let mine = $map.dpsi_inv(&general, &dense_u, $at, &mut w);
                    match ($map.eval_dpsi_inv(&so3, &u, &v), mine) {
                        (Ok(closed), Ok(())) => {
                            let gap = (closed - vee(&fixed(&w))).norm();
                            worst.see($inverse, u, gap, $size * v.norm(), $cond_inverse);
                            compared[1] += 1;
                        }
                        // Both draw the line of the singular set, each by its own measure.
                        (Err(_), _) | (_, Err(_)) => {
                            assert!($cond_inverse * $size > 1e3, "{} refused at {u:?}", $inverse)
                        }
                    }
                } else {
                    panic!("{} refused at {u:?}: {closed:?}, {mine:?}", $psi);
                }
            }};
        }
        let phi = (0.5 * alpha / (0.5 * alpha).sin()).abs().max(1.0);
        let near = 1.0 + alpha / distance_to_singular(alpha);
        let (size, half) = (alpha.max(1.0), (1.0 + 0.25 * alpha * alpha).sqrt());
        let secant = 1.0 / u[1].cos().abs();
        compare!(Exp, &mut ats.0, "exp", "dexpinv", size, phi, near);
        compare!(Cay, &mut ats.1, "cay", "dcayinv", half, half * half, 1.0);
        compare!(CCSK123, &mut ats.2, "ccsk123", "dccsk123inv", 1.0, secant, secant);
        compare!(CCSK321, &mut ats.3, "ccsk321", "dccsk321inv", 1.0, secant, secant);
    }
    for (name, (units, u)) in &worst.0 {
        println!("{name:12} worst {units:.2} eps·cond at |u| = {:.3e}", u.norm());
    }
    println!("compared {compared:?}");
    assert!(compared[0] == 400_000 && compared[1] > 390_000);
}

/// One RKMK4 step of the rigid body, momentum alone and with attitude, on 2000 random bodies.
#[test]
fn one_step_of_rkmk4() {
    let mut rng = Pcg64::seed_from_u64(4);
    let so3 = So3::<f64>::new();
    for _ in 0..2000 {
        let inertia = [(); 3].map(|()| 10f64.powf(rng.random_range(-1.0..1.0)));
        let m = so3.sample_vector(&mut rng);
        let g = so3.sample_element(&mut rng);
        let m_space = g * m;
        let closed = RigidBody::new(inertia).expect("a body");
        let speed = closed.omega(&m).norm();
        let h = 10f64.powf(rng.random_range(-3.0..0.0)) / speed;
        // The step's condition: f(m) = −J⁻¹m has the Lipschitz constant |m|/J_min on the orbit.
        let smallest = inertia.into_iter().fold(f64::INFINITY, f64::min);
        let cond = 1.0 + h * m.norm() / smallest;
        let step = Step { n: rng.random_range(0..2), t: 0.0, h };

        let general = RigidBodyN::from_principal(inertia).expect("a body");
        let attitude = RigidBodyAttitude::new(inertia, m_space.into()).expect("a body");
        let m_space = dense(&hat(&m_space));
        let general_attitude = RigidBodyNAttitude::new(general.clone(), m_space).expect("a body");
        macro_rules! compare {
            ($psi:expr) => {{
                let method = Rkmk::new(RK4, $psi);
                let (mut a, mut b) = (m, dense(&hat(&m)));
                let mut work = method.work(&closed, &a).expect("fits");
                method.step(&closed, step, &mut a, &mut work).expect("a step");
                let mut work = method.work(&general, &b).expect("fits");
                method.step(&general, step, &mut b, &mut work).expect("a step");
                let units = (a - vee(&fixed(&b))).norm() / (EPS * cond * m.norm());
                assert!(units <= BOUND, "{}: m differs by {units} eps·cond", stringify!($psi));

                let (mut a, mut b) = (g, general_attitude.group().identity());
                b.copy_from(dense(&g));
                let mut work = method.work(&attitude, &a).expect("fits");
                method.step(&attitude, step, &mut a, &mut work).expect("a step");
                let mut work = method.work(&general_attitude, &b).expect("fits");
                method.step(&general_attitude, step, &mut b, &mut work).expect("a step");
                let units = (a - fixed(&b)).norm() / (EPS * cond * 3f64.sqrt());
                assert!(units <= BOUND, "{}: g differs by {units} eps·cond", stringify!($psi));
            }};
        }
        use lieflow::Problem;
        compare!(Exp);
        compare!(Cay);
        compare!(CCSK123);
        compare!(CCSK321);
        compare!(CCSK);
    }
}

/// The choice made is part of the result: every Padé degree, squarings and corrections, the series
/// and the eigen form are taken somewhere on a ladder of norms, and each is right there.
#[test]
fn every_branch_of_the_dense_exponential() {
    let mut rng = Pcg64::seed_from_u64(5);
    let (mut degrees, mut squarings, mut corrected) = (BTreeSet::new(), BTreeSet::new(), false);
    let (mut series, mut eigen) = (BTreeSet::new(), false);
    for n in [3usize, 5, 10] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        let mut at = Exp.at(&group).expect("exp");
        for k in 0..300 {
            let size = 10f64.powf(-11.0 + 0.05 * f64::from(k));
            let mut u = group.zero();
            let direction = group.sample_algebra(&mut rng, 1.0);
            group.axpy(size / group.norm(&direction), &direction, &mut u);
            let mut g = group.identity();
            Exp.psi(&group, &u, &mut at, &mut g).expect("exp(u)");
            let choice = at.expm_choice();
            degrees.insert(choice.degree);
            squarings.insert(choice.squarings);
            corrected |= choice.corrections > 0;
            // exp(u)·exp(−u) = 𝟙 and the group, at rounding level.
            let mut minus = group.zero();
            group.axpy(-1.0, &u, &mut minus);
            let (back, mut product) =
                (Exp.eval(&group, &minus).expect("exp(−u)"), group.identity());
            group.compose(&g, &back, &mut product);
            let n = n as f64;
            let gap = group.distance(&product, &group.identity());
            assert!(gap <= 8.0 * n * EPS * size.max(1.0), "exp(u)exp(−u) at {size:e}: {gap:e}");
            let defect = group.defect(&g);
            assert!(defect <= 4.0 * n * EPS, "{choice:?} at {size:e}: defect {defect:e}");

            let mut v = group.sample_algebra(&mut rng, 1.0);
            if Exp.dpsi_inv(&group, &u, &mut at, &mut v).is_ok() {
                match at.dexpinv_choice() {
                    Dexpinv::Series(q) => drop(series.insert(q)),
                    Dexpinv::Eigen => eigen = true,
                    Dexpinv::None => panic!("no choice was recorded"),
                }
            }
        }
    }
    assert_eq!(degrees, BTreeSet::from([3, 5, 7, 9, 13]));
    assert!(squarings.len() >= 10 && corrected && eigen, "{squarings:?} {corrected} {eigen}");
    assert!(series.contains(&2) && series.len() >= 5, "{series:?}");
}
