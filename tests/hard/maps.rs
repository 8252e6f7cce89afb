//! Hard cases of the maps by number: D, the differentials of exp; C, cay; K, ccsk; L, log; and the
//! rows of E that concern the closed form on so(3). References: `references/hard.json`.
//!
//! | rows | where |
//! |---|---|
//! | D1, D6 – D8 | here; D3, D4, D6 and D8 of the map in `maps/references.rs` |
//! | D2, D5, D9 – D12 | `maps/dexp.rs`, `core/so3_closed.rs` |
//! | C1, C4 | here; C2, C3 in `maps/references.rs`; C3, C5 also in `maps/cayley.rs` |
//! | K1 – K3 | `maps/references.rs`, `core/so3_closed.rs`, `maps/ccsk.rs`; K4 here |
//! | L1, L2, L5 | `core/so3_closed.rs`; L3, L4 here and in `maps/log.rs` |
//! | E6, E16 on so(3) | here |
//! | X1 – X3 | `maps/input.rs`; constructors in `core/api/` |

mod input;

use faer::{Mat, mat};
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, Sample, So3};
use lieflow::maps::{
    CCSK123, CCSK321, Cay, CoordinateMap, Exp, Pade22, dexp, dexpinv_truncated,
    dexpinv_with_remainder,
};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::{RigidBodyN, RigidBodyNAttitude};
use lieflow::{
    Error, LieAlgebra, LieGroup, NoLogarithm, RunError, SaveAt, StepError, TimeGrid, integrate, so3,
};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::support::references::{cases, rows, square, vee};

const EPS: f64 = f64::EPSILON;

/// D7: the cut series equals the rational partial sums to 30 eps·Σ|B_k/k!|‖ad_u^k v‖, on matrices
/// and on so(3) ≅ ℝ³, and the remainder bounds what is missing, within two orders of magnitude at
/// moderate ‖u‖. q = 0 is v itself.
#[test]
fn d7_partial_sums() {
    let mut worst = 0.0f64;
    for case in cases("hard").iter().filter(|case| case.id.starts_with("series_")) {
        let (n, group) = (case.n, case.matrix_group());
        let u = group.algebra(case.matrix("u")).expect("u");
        let v = group.algebra(case.matrix("v")).expect("v");
        assert_eq!(dexpinv_truncated(&group, &u, &v, 0).expect("q = 0"), v);
        assert_eq!(case.output.len(), 13, "q = 1 … 12 and 20");
        for (function, sum) in &case.output {
            let q = function.trim_start_matches("dexpinv_").parse().expect("q");
            let place = format!("{} q = {q}", case.id);
            let (exact, scale) =
                (square(n, &sum.numbers()), sum.measure("scale").expect("a scale"));
            let cut = dexpinv_with_remainder(&group, &u, &v, q).expect("a finite sum");
            let units = (cut.value.as_ref() - &exact).norm_l2() / (EPS * scale);
            worst = worst.max(units);
            assert!(units <= 30.0, "{place}: {units}");
            let map = Exp.truncated(q).eval_dpsi_inv(&group, &u, &v).expect("dΨ⁻¹");
            assert_eq!(map, cut.value, "{place}: one series");
            if n == 3 && case.group == "so" {
                let w = Exp
                    .truncated(q)
                    .eval_dpsi_inv(&So3::<f64>::new(), &case.vector("u"), &case.vector("v"))
                    .expect("dΨ⁻¹");
                // The Frobenius norm counts every component twice.
                let units = 2f64.sqrt() * (w - Vector3::from_vec(vee(&rows(&exact)))).norm()
                    / (EPS * scale);
                assert!(units <= 30.0, "{place} in closed form: {units}");
            }
            match sum.measure("rest") {
                Some(rest) => {
                    assert!(rest <= cut.remainder, "{place}: {rest:e} > {:e}", cut.remainder);
                    if u.norm_l2() < 2.0 && cut.remainder.is_finite() {
                        let loose = 10f64.powf(2.0 + 0.5 * q as f64);
                        assert!(cut.remainder <= loose * rest, "{place}: {:e}", cut.remainder);
                    }
                }
                None => assert!(cut.remainder.is_infinite(), "{place}: {:e}", cut.remainder),
            }
        }
    }
    println!("worst {worst:.2} eps·scale");
}

/// D1: with u = 0, v = 0 or [u, v] = 0 the result is v, bit by bit, at every size of u; on Sp(2m),
/// where the bracket of one product sums in another order than its mirror, to 2 eps.
#[test]
fn d1_commuting_arguments() {
    let mut rng = Pcg64::seed_from_u64(51);
    for group in [
        MatrixGroup::so(3),
        MatrixGroup::so(6),
        MatrixGroup::sp(4),
        MatrixGroup::gl(3),
        MatrixGroup::indefinite(2, 2),
    ] {
        let group = group.expect("a group");
        let (zero, v) = (group.zero(), group.sample_algebra(&mut rng, 1.0));
        for scale in [0.0, 0.125, 1.0, 2.0, 64.0, 4096.0] {
            let mut u = group.zero();
            group.axpy(scale, &v, &mut u); // a power of two: u and v commute exactly
            let inverse = |v: &AlgebraMatrix| Exp.eval_dpsi_inv(&group, &u, v);
            // exp(4096 v) overflows where v has real eigenvalues.
            if group.name().starts_with("Sp") {
                if scale <= 0.125 {
                    let w = inverse(&v).expect("[u, v] = 0");
                    assert!((&*w - &*v).norm_l2() <= 2.0 * EPS * v.norm_l2());
                }
                continue;
            }
            if Exp.eval(&group, &u).is_ok() {
                assert_eq!(inverse(&v).expect("[u, v] = 0"), v, "{} × {scale}", group.name());
                assert_eq!(inverse(&zero).expect("v = 0"), zero, "{} × {scale}", group.name());
            }
            assert_eq!(dexp(&group, &u, &v).expect("[u, v] = 0"), v, "{} × {scale}", group.name());
            assert_eq!(dexp(&group, &u, &zero).expect("v = 0"), zero, "{}", group.name());
        }
    }
    for size in [0.0, 0.5, 2.0, 8.0, 1e3] {
        let v = Vector3::new(0.3, -0.5, 0.25);
        let u = v * size;
        let zero = Vector3::zeros();
        // v + c·u×(u×v) with u×v = 0 exactly, since products are commutative.
        assert_eq!(so3::dexpinv(&u, &zero), Ok(zero));
        if size == 0.0 || size == 0.5 || size == 2.0 || size == 8.0 {
            assert_eq!(so3::dexpinv(&u, &v), Ok(v), "{size}");
            assert_eq!(so3::dexp(&u, &v), Ok(v), "{size}");
        }
    }
}

/// D6: the cut series beyond its radius is never silent. D8: a finite sum has no remainder. The map itself,
/// with D3 and D4, is held to the references by `maps/references.rs`.
#[test]
fn d6_d8_cut_series() {
    let hard = cases("hard");
    let cases = hard.iter().filter(|case| case.output.contains_key("dexpinv"));
    for case in cases {
        let group = case.matrix_group();
        let [u, v] = ["u", "v"].map(|name| group.algebra(case.matrix(name)).expect("𝔤"));
        let output = &case.output["dexpinv"];
        let (exact, cond) = (square(case.n, &output.numbers()), output.cond());
        let cut = dexpinv_with_remainder(&group, &u, &v, 20).expect("a sum");
        let truth = (cut.value.as_ref() - &exact).norm_l2();
        if case.id.contains("nilpotent") {
            assert_eq!(cut.remainder, 0.0);
            assert!(truth <= 30.0 * EPS * cond * exact.norm_l2());
        } else {
            assert!(truth <= cut.remainder + 30.0 * EPS * cond, "{}: {truth:e}", case.id);
        }
    }
}

/// E6, E16 on so(3): exp from the least subnormal to the largest double; `maps/references.rs` has the
/// bound of its error. Tiny u are not lost: the entries off the diagonal have their own relative accuracy. Always on the
/// group to 4√3 eps.
#[test]
fn e6_e16_exp_on_so3_at_every_size() {
    let hard = cases("hard");
    let cases: Vec<_> = hard.iter().filter(|case| case.id.starts_with("exp_")).collect();
    assert_eq!(cases.len(), 84);
    for case in cases {
        let u = case.vector("u");
        let exact = Matrix3::from_row_slice(&case.output["exp"].numbers());
        let g = match so3::exp(&u) {
            Ok(g) => g,
            Err(error) => {
                assert!(u.lp_norm(1).is_infinite(), "{u:?}: {error}");
                assert_eq!(error, StepError::NormTooLarge { map: "exp" });
                continue;
            }
        };
        let defect = (g.transpose() * g - Matrix3::identity()).norm();
        assert!(defect <= 4.0 * 3f64.sqrt() * EPS, "{u:?}: {:.1} eps", defect / EPS);
        if u.amax() < 1e-7 {
            for (x, r) in g.iter().zip(exact.iter()) {
                let ulp = (EPS * r.abs()).max(5e-324);
                assert!((x - r).abs() <= ulp, "{u:?}: {x:e} for {r:e}");
            }
        }
    }
}

/// C1: an eigenvalue 2 of u is an error that names 𝟙 − u/2 and its rcond, on every group that has
/// such u, and with Ψ(u)·x as well.
#[test]
fn c1_cay_at_its_pole() {
    for (group, u) in [
        (MatrixGroup::sp(2), mat![[2.0, 0.0], [0.0, -2.0]]),
        (MatrixGroup::gl(2), mat![[2.0, 0.0], [0.0, -2.0]]),
        (MatrixGroup::gl(2), mat![[2.0, 1e8], [0.0, 2.0]]),
        (MatrixGroup::indefinite(1, 1), mat![[0.0, 2.0], [2.0, 0.0]]),
        (MatrixGroup::gm(mat![[0.0, 3.0], [3.0, 0.0]]), mat![[2.0, 0.0], [0.0, -2.0]]),
    ] {
        let group = group.expect("a group");
        let u = group.algebra(u).expect("u");
        let refused = Cay.eval(&group, &u).expect_err("a pole");
        assert!(
            matches!(refused, Error::Map(StepError::NearlySingular { map: "cay", rcond, .. })
                if rcond < 1e-14),
            "{}: {refused}",
            group.name()
        );
        let (mut at, mut g) = (Cay.at(&group).expect("cay"), group.identity());
        let (x, mut y) = (Mat::from_fn(2, 1, |_, _| 1.0), Mat::zeros(2, 1));
        assert!(Cay.psi_on(&group, &u, &mut at, &mut g, &x, &mut y).is_err());
    }
}

/// C4: cay for n = 1 and odd and even n is defined, and orthogonal.
#[test]
fn c4_cay_at_every_n() {
    let mut rng = Pcg64::seed_from_u64(52);
    for n in [1, 2, 3, 4, 7, 8, 9, 12] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        let u = group.sample_algebra(&mut rng, 1e3);
        let g = Cay.eval(&group, &u).expect("cay(u)");
        assert!(group.defect(&g) <= 4.0 * n as f64 * EPS, "n = {n}: {:e}", group.defect(&g));
    }
}

/// K4: where a coordinate of the second kind is singular on SO(n), dccsk⁻¹ is an error and ccsk
/// itself is not; the raw bound is the user's.
#[test]
fn k4_gimbal_lock_on_so_n() {
    let mut rng = Pcg64::seed_from_u64(53);
    for n in 3..=7 {
        let group = MatrixGroup::so(n).expect("SO(n)");
        let v = group.sample_algebra(&mut rng, 1.0);
        for middle in [FRAC_PI_2, -FRAC_PI_2, 3.0 * FRAC_PI_2] {
            let mut u = group.sample_algebra(&mut rng, 0.3);
            (u[(n - 1, 0)], u[(0, n - 1)]) = (middle, -middle); // the last plane of column 1
            assert!(CCSK321.eval(&group, &u).is_ok(), "n = {n}");
            let refused = CCSK321.eval_dpsi_inv(&group, &u, &v).expect_err("gimbal lock");
            assert!(matches!(refused, Error::Map(StepError::OutsideChart { map: "ccsk", .. })));
            let refused = CCSK123.eval_dpsi_inv(&group, &u, &v).expect_err("gimbal lock");
            assert!(refused.to_string().contains("ccsk"), "{refused}");
        }
    }
}

/// L3: turns by π, and by almost π in planes that are almost one another's: a skew logarithm of
/// length ≤ π in each plane with exp(log g) = g to 10 n eps, whatever plane was chosen.
#[test]
fn l3_half_turns_and_clusters() {
    let mut rng = Pcg64::seed_from_u64(54);
    let mut worst = 0.0f64;
    for n in [2, 3, 4, 5, 6, 8, 12] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        for k in 0..=16 {
            let q = group.sample_element(&mut rng);
            let mut u = group.zero();
            for plane in 0..n / 2 {
                let (i, j) = (2 * plane, 2 * plane + 1);
                let gap = if k == 16 { 0.0 } else { 10f64.powi(-k) * rng.random_range(0.0..1.0) };
                // k = 16: exactly −𝟙 on all planes, or on all but one.
                let angle = if n == 4 && plane == 1 && k % 2 == 0 { 0.0 } else { PI - gap };
                (u[(j, i)], u[(i, j)]) = (angle, -angle);
            }
            let turned = AlgebraMatrix::new_unchecked(q.as_ref() * u.as_ref() * q.transpose());
            let g = Exp.eval(&group, &turned).expect("exp");
            let log = group.log(&g).unwrap_or_else(|e| panic!("n = {n}, π − 1e-{k}: {e}"));
            assert_eq!((&*log + log.transpose()).norm_l2(), 0.0, "skew");
            let longest = (2.0 * (n / 2) as f64).sqrt() * PI;
            assert!(group.norm(&log) <= longest * (1.0 + 8.0 * EPS));
            let back = Exp.eval(&group, &log).expect("exp");
            let units = group.distance(&back, &g) / (n as f64 * EPS);
            worst = worst.max(units);
            assert!(units <= 10.0, "n = {n}, π − 1e-{k}: {units} n·eps");
        }
    }
    println!("worst ‖exp(log g) − g‖ {worst:.2} n·eps");
    let minus =
        |n: usize| GroupMatrix::new_unchecked(Mat::<f64>::identity(n, n) * faer::Scale(-1.0));
    for n in [1, 3, 5, 9] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        let refused = group.log(&minus(n)).expect_err("no rotation");
        assert_eq!(refused, Error::Reflection { arg: "g" }, "−𝟙 in odd dimension");
    }
}

/// L4: negative eigenvalues on Sp, GL and SO(p,q): refused with the eigenvalue and the reason, and where
/// they come in pairs a logarithm with a turn by π in the algebra.
#[test]
fn l4_negative_eigenvalues() {
    let diagonal =
        |d: &[f64]| Mat::from_fn(d.len(), d.len(), |i, j| if i == j { d[i] } else { 0.0 });
    for (group, d) in [
        (MatrixGroup::sp(2), vec![-2.0, -0.5]),
        (MatrixGroup::sp(4), vec![-2.0, 3.0, -0.5, 1.0 / 3.0]),
        (MatrixGroup::gl(1), vec![-1.0]),
        (MatrixGroup::gl(3), vec![-1e-200, 1.0, 1e200]),
    ] {
        let group = group.expect("a group");
        let g = GroupMatrix::new_unchecked(diagonal(&d));
        match group.log(&g) {
            Err(error @ Error::NoLogarithm { re, why: NoLogarithm::Odd, .. }) => {
                assert!(re < 0.0 && error.to_string().contains("no real matrix"), "{error}");
            }
            Err(Error::Singular { .. }) if d.contains(&1e200) => {}
            other => panic!("{} {d:?}: {other:?}", group.name()),
        }
    }
    for (group, d) in [
        (MatrixGroup::sp(4), vec![-2.0, -2.0, -0.5, -0.5]),
        (MatrixGroup::gl(3), vec![-1.0, -1.0, 2.0]),
        (MatrixGroup::indefinite(2, 1), vec![-1.0, -1.0, 1.0]),
    ] {
        let group = group.expect("a group");
        let g = group.element(diagonal(&d)).expect("on the group");
        let back = Exp.eval(&group, &group.log(&g).expect("log")).expect("exp");
        assert!(group.distance(&back, &g) <= 30.0 * EPS * g.norm_l2(), "{d:?}");
    }
}
