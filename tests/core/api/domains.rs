//! The domains of the maps: what lies outside is a typed error, and no Ok holds a number that is none.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use faer::{Mat, mat};
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, Sample, So3, hat};
use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Ccsk, CoordinateMap, Exp};
use lieflow::{Error, LieGroup, StepError};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::says;
use crate::draw::Draw;

fn so(n: usize) -> MatrixGroup {
    MatrixGroup::so(n).unwrap()
}

fn dense(u: &Vector3<f64>) -> AlgebraMatrix {
    let h = hat(u);
    AlgebraMatrix::new_unchecked(Mat::from_fn(3, 3, |i, j| h[(i, j)]))
}

#[track_caller]
fn outside<T: std::fmt::Debug>(found: Result<T, Error>, map: &str) {
    let Err(Error::Map(
        error @ (StepError::OutsideChart { .. } | StepError::NearlySingular { .. }),
    )) = found
    else {
        panic!("{found:?}")
    };
    says(error, &[map, "smaller step"]);
}

#[test]
fn cayley_is_refused_where_it_has_a_pole() {
    let sp2 = MatrixGroup::sp(2).unwrap();
    let pole = sp2.algebra(mat![[2.0, 0.0], [0.0, -2.0]]).unwrap();
    outside(Cay.eval(&sp2, &pole), "cay");
    outside(Cay.eval_dpsi_inv(&sp2, &pole, &pole), "cay");
    let gl9 = MatrixGroup::gl(9).unwrap(); // beyond the const-size kernels
    let pole = gl9.algebra(Mat::<f64>::identity(9, 9) * faer::Scale(2.0)).unwrap();
    outside(Cay.eval(&gl9, &pole), "cay");
    // psi_on solves by itself and is refused as well.
    let (mut at, mut g) = (Cay.at(&gl9).unwrap(), gl9.identity());
    let (x, mut y) = (Mat::from_fn(9, 1, |_, _| 1.0), Mat::zeros(9, 1));
    assert!(Cay.psi_on(&gl9, &pole, &mut at, &mut g, &x, &mut y).is_err());
}

/// Ψ(u) is a rotation to rounding at every size of u that is taken, and sizes that mean something
/// are taken. (𝟙 − u/2 has no pole on so(n), but for odd n it has the eigenvalue 1 beside large ones.)
#[test]
fn large_arguments_stay_on_the_group() {
    fn check<Psi: CoordinateMap<MatrixGroup>>(psi: Psi, taken: f64) {
        let mut rng = Pcg64::seed_from_u64(1);
        for n in [2, 3, 4, 5, 8, 9, 15] {
            let bound = 8.0 * (n as f64).sqrt() * f64::EPSILON;
            for decade in 0..18 {
                for _ in 0..5 {
                    let size = 10f64.powi(decade);
                    let u = so(n).sample_algebra(&mut rng, size / n as f64);
                    let g = psi.eval(&so(n), &u);
                    assert!(g.is_ok() || size > taken, "{} refused at {size:e}", psi.name());
                    let defect = g.map_or(0.0, |g| so(n).defect(&g));
                    let name = psi.name();
                    assert!(defect <= bound, "{name}, n = {n}, ‖u‖ ~ {size:e}: {defect:e}");
                }
            }
        }
    }
    check(Exp, 1e14);
    check(Cay, 1e14);
    check(CCSK321, 1e17);
    check(CCSK123, 1e17);
}

/// And so does the short way: Ψ(u)·x has the length of x, and an Ok is finite.
#[test]
fn large_arguments_keep_lengths_of_vectors() {
    fn check<Psi: CoordinateMap<MatrixGroup>>(psi: Psi) {
        let mut rng = Pcg64::seed_from_u64(2);
        for n in [2, 3, 4, 5, 9] {
            let (group, bound) = (so(n), 8.0 * (n as f64).sqrt() * f64::EPSILON);
            let (mut at, mut g) = (psi.at(&group).unwrap(), group.identity());
            for decade in (0..18).chain([50, 150, 300]) {
                let u = group.sample_algebra(&mut rng, 10f64.powi(decade) / n as f64);
                let x = group.sample_vector(&mut rng);
                let mut y = x.clone();
                if psi.psi_on(&group, &u, &mut at, &mut g, &x, &mut y).is_ok() {
                    let stretch = (y.norm_l2() / x.norm_l2() - 1.0).abs();
                    let name = psi.name();
                    assert!(stretch <= bound, "{name}, n = {n}, ‖u‖ ~ 1e{decade}: {stretch:e}");
                }
            }
        }
    }
    check(Exp);
    check(Cay);
    check(CCSK321);
}

#[test]
fn ccsk_is_refused_at_gimbal_lock() {
    let v = Vector3::new(0.3, -0.2, 0.5);
    for middle in [FRAC_PI_2, -FRAC_PI_2, 3.0 * FRAC_PI_2, FRAC_PI_2 - 1e-5] {
        let u = Vector3::new(0.4, middle, -0.7);
        assert!(CCSK123.eval(&So3::new(), &u).is_ok(), "Ψ itself is regular");
        outside(CCSK123.eval_dpsi_inv(&So3::new(), &u, &v), "ccsk");
        outside(CCSK321.eval_dpsi_inv(&So3::new(), &u, &v), "ccsk");
        outside(CCSK321.eval_dpsi_inv(&so(3), &dense(&u), &dense(&v)), "ccsk");
        outside(CCSK123.eval_dpsi_inv(&so(3), &dense(&u), &dense(&v)), "ccsk");
        let w = Ccsk::<0, 1, 2>::with_min_cos(0.0).eval_dpsi_inv(&So3::new(), &u, &v).unwrap();
        assert!(w.iter().all(|x| x.is_finite()), "the raw formula up to its singularity");
    }
    let u = Vector3::new(0.4, FRAC_PI_2 - 1e-3, -0.7);
    assert!(CCSK123.eval_dpsi_inv(&So3::new(), &u, &v).is_ok(), "close by it is taken");
}

#[test]
fn dexpinv_is_refused_near_its_singular_set() {
    let axis = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    let v = Vector3::new(0.3, -0.2, 0.5);
    for k in 1..4 {
        let u = axis * (TAU * k as f64);
        assert!(Exp.eval(&So3::new(), &u).is_ok(), "exp itself is regular");
        outside(Exp.eval_dpsi_inv(&So3::new(), &u, &v), "exp");
        outside(Exp.eval_dpsi_inv(&so(3), &dense(&u), &dense(&v)), "exp");
        let near = axis * (TAU * k as f64 + 1e-6);
        for w in [
            Exp.eval_dpsi_inv(&So3::new(), &near, &v).unwrap().norm(),
            Exp.eval_dpsi_inv(&so(3), &dense(&near), &dense(&v)).unwrap().norm_l2(),
        ] {
            assert!((1e5..1e8).contains(&w), "large but finite: {w:e}");
        }
        // Half way there is nothing singular on so(n), although there is on gl(n).
        let half = axis * (PI * (2 * k - 1) as f64);
        let w = Exp.eval_dpsi_inv(&so(3), &dense(&half), &dense(&v)).unwrap();
        let closed = Exp.eval_dpsi_inv(&So3::new(), &half, &v).unwrap();
        assert!((&*w - &*dense(&closed)).norm_l2() < 1e-13 * k as f64);
    }
    // Real eigenvalues of ad_u beyond the series' radius.
    let sp2 = MatrixGroup::sp(2).unwrap();
    let (u, v) = (mat![[10.0, 0.0], [0.0, -10.0]], mat![[0.0, 1.0], [1.0, 0.0]]);
    let found = Exp.eval_dpsi_inv(&sp2, &sp2.algebra(u).unwrap(), &sp2.algebra(v).unwrap());
    match found {
        Err(_) => outside(found, "exp"),
        // coth: (x/2)coth(x/2) ∓ x/2 at x = ±20, if the exact map is taken there.
        Ok(w) => assert!((w[(0, 1)] - 20.0 / (20f64.exp() - 1.0)).abs() < 1e-12, "{w:?}"),
    }
}

/// An entry as it comes from broken input.
fn entry(rng: &mut Pcg64) -> f64 {
    Draw(&rng.random::<[u8; 10]>()).wild()
}

/// Every result is finite or an error, and no input that is not finite has a result.
fn total<G: LieGroup, Psi: CoordinateMap<G>>(
    group: &G,
    psi: &Psi,
    u: &G::Alg,
    v: &G::Alg,
    finite: impl Fn(&G::Elem) -> bool,
    show: impl Fn() -> String,
) {
    let inverse = psi.eval_dpsi_inv(group, u, v);
    let g = psi.eval(group, u);
    if let Ok(g) = &g {
        assert!(finite(g), "{} on {}: Ok holds no number, {}", psi.name(), group.name(), show());
        assert!(group.is_finite(u), "{}: Ok at an u that is no number, {}", psi.name(), show());
    }
    if let Ok(w) = &inverse {
        assert!(group.is_finite(w), "d{}⁻¹ on {}: {}", psi.name(), group.name(), show());
    }
}

#[test]
fn every_result_in_closed_form_is_finite() {
    let (so3, mut rng) = (So3::new(), Pcg64::seed_from_u64(5));
    let finite = |g: &Matrix3<f64>| g.iter().all(|x| x.is_finite());
    for _ in 0..100_000 {
        let u = Vector3::from_fn(|_, _| entry(&mut rng));
        let v = so3.sample_algebra(&mut rng, 1.0);
        let show = || format!("u = {:e}, {:e}, {:e}", u[0], u[1], u[2]);
        total(&so3, &Exp, &u, &v, finite, show);
        total(&so3, &Exp.truncated(2), &u, &v, finite, show);
        total(&so3, &Cay, &u, &v, finite, show);
        total(&so3, &CCSK123, &u, &v, finite, show);
        total(&so3, &CCSK321, &u, &v, finite, show);
        total(&so3, &CCSK, &u, &v, finite, show);
    }
}

#[test]
fn every_result_on_matrices_is_finite() {
    let groups = [
        (so(2), true),
        (so(3), true),
        (so(5), true),
        (so(9), true),
        (MatrixGroup::gl(1).unwrap(), false),
        (MatrixGroup::gl(3).unwrap(), false),
        (MatrixGroup::sp(4).unwrap(), false),
        (MatrixGroup::indefinite(3, 1).unwrap(), false),
    ];
    let mut rng = Pcg64::seed_from_u64(6);
    let finite = |g: &GroupMatrix| g.col_iter().all(|c| c.iter().all(|x| x.is_finite()));
    for (group, rotations) in groups {
        let n = group.n();
        for case in 0..3000 {
            // All entries of one wild size, or one wild entry among tame ones.
            let (wild, place) = (entry(&mut rng), rng.random_range(0..n * n));
            let tame = case % 2 == 0;
            let x = Mat::from_fn(n, n, |i, j| {
                let x: f64 = rng.random_range(-1.0..1.0);
                if !tame {
                    x * wild
                } else if i + j * n == place {
                    wild
                } else {
                    x
                }
            });
            let u = group.project_algebra(x.as_ref());
            let v = group.sample_algebra(&mut rng, 1.0);
            let show = || format!("entries of size {wild:e}, u = {:?}", *u);
            total(&group, &Exp, &u, &v, finite, show);
            total(&group, &Exp.truncated(2), &u, &v, finite, show);
            total(&group, &Cay, &u, &v, finite, show);
            // cay has a short way to Ψ(u)·x of its own.
            let (mut at, mut g) = (Cay.at(&group).unwrap(), group.identity());
            let (x, mut y) = (group.sample_vector(&mut rng), Mat::zeros(n, 1));
            if Cay.psi_on(&group, &u, &mut at, &mut g, &x, &mut y).is_ok() {
                assert!(y.col(0).iter().all(|y| y.is_finite()), "cay(u)·x: {}", show());
            }
            if rotations {
                total(&group, &CCSK123, &u, &v, finite, show);
                total(&group, &CCSK321, &u, &v, finite, show);
                total(&group, &CCSK, &u, &v, finite, show);
            }
        }
    }
}

/// Only the rounding of a determinant grows with the entries. What is not special has no logarithm, and is no start.
#[test]
fn determinants_are_one() {
    let sl2 = MatrixGroup::sl(2).unwrap();
    for (det, is_right) in [(1.0, true), (1.0 + 1e-12, true), (1.3, false), (1.001, false)] {
        let g = mat![[1.0, 1e6], [0.0, det]];
        assert_eq!(sl2.element(g.clone()).is_ok(), is_right, "{det}");
        let start = sl2.check_member(&GroupMatrix::new_unchecked(g));
        assert_eq!(start.is_ok(), is_right, "{det}");
    }
    let sl = MatrixGroup::sl(30).unwrap();
    let large = Mat::<f64>::identity(30, 30) * faer::Scale(1.2);
    assert!(sl.check_member(&GroupMatrix::new_unchecked(large)).is_err());
    let mut rng = Pcg64::seed_from_u64(8);
    for _ in 0..20 {
        let u = sl.sample_algebra(&mut rng, 0.3);
        sl.check_member(&Exp.eval(&sl, &u).unwrap()).expect("an element");
    }
}

/// Orthogonal columns of other lengths are no singular matrix.
#[test]
fn the_ends_of_runs_are_starts() {
    for (group, singular) in [(MatrixGroup::gl(2), true), (MatrixGroup::sl(2), true)] {
        let group = group.unwrap();
        for t in [1.0, 40.0, 80.0, 300.0] {
            let (c, s) = (0.6, 0.8);
            let d = [f64::exp(-t), f64::exp(t)];
            for g in [
                mat![[d[0], 0.0], [0.0, d[1]]],
                mat![[c * d[0], -s * d[0]], [s * d[1], c * d[1]]],
                mat![[c * d[0], -s * d[1]], [s * d[0], c * d[1]]],
            ] {
                group.check_member(&GroupMatrix::new_unchecked(g)).expect("a start");
            }
        }
        let flat = GroupMatrix::new_unchecked(mat![[1.0, 2.0], [2.0, 4.0]]);
        assert_eq!(group.check_member(&flat).is_err(), singular);
    }
}
