//! dexp, dexp⁻¹ and the Padé map at hard arguments; the cut series with its remainder; the singular
//! set. References are in `references.rs`, those on U(m) by complex matrices here.

use core::f64::consts::{PI, TAU};

use faer::{Mat, c64};
use lieflow::groups::{AlgebraMatrix, ComplexMatrix, MatrixGroup, Sample, Unitary};
use lieflow::maps::{
    Dexpinv, Exp, dexp, dexpinv_truncated, dexpinv_with_remainder, distance_to_singular,
};
use lieflow::{CoordinateMap, Error, LieAlgebra, LieGroup};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::support::references::{self, square};

const EPS: f64 = f64::EPSILON;

/// U(m) = G_M with M = 𝟙 + J.
fn unitary(m: usize) -> Result<MatrixGroup, Error> {
    MatrixGroup::gm(Mat::from_fn(2 * m, 2 * m, |i, j| match (i, j) {
        _ if i == j => 1.0,
        _ if j == i + m => 1.0,
        _ if i == j + m => -1.0,
        _ => 0.0,
    }))
}

fn gap(x: &Mat<f64>, r: &Mat<f64>) -> f64 {
    (x - r).norm_l2() / r.norm_l2()
}

/// The references on U(m) by complex matrices, in both forms of dexp⁻¹: at most 10 eps·cond.
#[test]
fn references_on_u_n() {
    let mut choices = Vec::new();
    for case in references::cases("dexp").iter().filter(|case| case.group == "gm") {
        let (n, [dexp, dexpinv, distance]) =
            (case.n, ["dexp", "dexpinv", "distance"].map(|function| &case.output[function]));
        let group = Unitary::new(n / 2).expect("U(n)");
        let complex = |x: Mat<f64>| {
            ComplexMatrix::from_fn(n / 2, n / 2, |i, j| c64::new(x[(i, j)], x[(i + n / 2, j)]))
        };
        let [u, v] = ["u", "v"].map(|name| complex(case.matrix(name)));
        let [w, inverse] = [dexp, dexpinv].map(|x| complex(square(n, &x.numbers())));
        let mut at = Exp.at(&group).expect("exp");
        let units = |x: &ComplexMatrix, reference: &ComplexMatrix| {
            group.distance(x, reference) / group.norm(reference) / EPS
        };
        let (cond, size) = (dexpinv.cond(), group.norm(&u).max(1.0));
        let mut x = v.clone();
        Exp.dpsi_inv(&group, &u, &mut at, &mut x).expect("dexp⁻¹");
        assert!(units(&x, &inverse) <= 10.0 * cond, "{}: {}", case.id, units(&x, &inverse));
        choices.push(at.dexpinv_choice());
        let mut x = v.clone();
        at.dexp(&group, &u, &mut x).expect("dexp");
        assert!(units(&x, &w) <= 10.0 * cond.max(size), "{}: {}", case.id, units(&x, &w));
        let far = at.distance_to_singular(&u).expect("a spectrum") - distance.numbers()[0];
        assert!(far.abs() <= 20.0 * EPS * size, "{}: {far:e}", case.id);
    }
    assert!(choices.len() == 3 && choices.contains(&Dexpinv::Eigen), "{choices:?}");
    assert!(choices.iter().any(|choice| matches!(choice, Dexpinv::Series(_))), "{choices:?}");
}

/// On U(n) as real matrices ad_u has the eigenvalues of u(n), not those of so(2n): u = i(π + ½, π/2 − e) is not singular.
#[test]
fn unitary_matrices_as_real_ones() {
    let mut rng = Pcg64::seed_from_u64(3);
    for n in 1..=4 {
        let (real, complex) = (MatrixGroup::u(n).expect("U(n)"), Unitary::new(n).expect("U(n)"));
        let parts = |x: &AlgebraMatrix| {
            ComplexMatrix::from_fn(n, n, |i, j| c64::new(x[(i, j)], x[(i + n, j)]))
        };
        for size in [0.3, 3.0, 30.0, PI] {
            for near in [1e-3, 1e-9, 0.0] {
                let mut u = real.sample_algebra(&mut rng, size);
                if size == PI {
                    // Twice π − near: the sum is beside 2π, the difference is 0.
                    u = real.zero();
                    let v = real.sample_algebra(&mut rng, 1.0);
                    let angles = |j: usize| PI - near + if j == 0 { 0.5 } else { -0.5 };
                    let diagonal = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
                        (false, true) if i == j + n => angles(j),
                        (true, false) if j == i + n => -angles(i),
                        _ => 0.0,
                    });
                    let q = Exp.eval(&real, &v).expect("exp");
                    let turned = &*q * diagonal * q.transpose();
                    real.axpy(1.0, &real.project_algebra(turned.as_ref()), &mut u);
                }
                let v = real.sample_algebra(&mut rng, 1.0);
                let (mut at, mut w) = (Exp.at(&real).expect("exp"), v.clone());
                let by_real = Exp.dpsi_inv(&real, &u, &mut at, &mut w);
                let (mut at, mut exact) = (Exp.at(&complex).expect("exp"), parts(&v));
                let by_complex = Exp.dpsi_inv(&complex, &parts(&u), &mut at, &mut exact);
                let far = at.distance_to_singular(&parts(&u)).expect("a spectrum");
                let same = distance_to_singular(&real, &u).expect("a spectrum");
                assert!((far - same).abs() < 1e-12 * (1.0 + size), "{n} {size}: {far} {same}");
                assert_eq!(by_real.is_ok(), by_complex.is_ok(), "{n}, {size}, {near}");
                if by_real.is_ok() {
                    let off = complex.distance(&parts(&w), &exact) / complex.norm(&exact);
                    assert!(off < 1e-13 * (1.0 + 1.0 / far), "{n}, {size}, {near}: {off:e}");
                    assert!(real.algebra(w.clone().into_mat()).is_ok(), "{n}, {size}, {near}");
                }
                if size == PI {
                    assert!(by_real.is_ok(), "{n}, {near}");
                }
            }
        }
    }
}

/// Random u on every group, both ways round: dexp then dexp⁻¹, at all sizes, every branch visited.
#[test]
fn inverse_of_each_other() {
    let mut rng = Pcg64::seed_from_u64(12);
    let (mut series, mut halved, mut eigen) = (0, 0, 0);
    for group in [
        MatrixGroup::so(5),
        MatrixGroup::sp(6),
        MatrixGroup::gl(4),
        MatrixGroup::indefinite(2, 3),
        unitary(2),
        MatrixGroup::gl(1),
        MatrixGroup::sp(2),
        MatrixGroup::u(3),
        MatrixGroup::su(2),
        // Neither symmetric nor skew, and its symmetric part is singular.
        MatrixGroup::gm(faer::mat![[1.0, 2.0], [-2.0, 0.0]]),
    ] {
        let group = group.expect("a group");
        let mut at = Exp.at(&group).expect("exp");
        for k in 0..60 {
            let v = group.sample_algebra(&mut rng, 1.0);
            let mut u = group.sample_algebra(&mut rng, 1.0);
            if group.norm(&u) == 0.0 {
                continue; // dim 𝔤 = 0
            }
            let size = 10f64.powf(-3.0 + f64::from(k) / 15.0) / group.norm(&u);
            let direction = u.clone();
            group.set_zero(&mut u);
            group.axpy(size, &direction, &mut u);
            let distance = distance_to_singular(&group, &u).expect("a spectrum");
            let norm = group.norm(&u);
            let mut w = v.clone();
            let done = Exp.dpsi_inv(&group, &u, &mut at, &mut w);
            assert!(done.is_ok() || distance < 1e-10, "{} {norm} {distance}", group.name());
            match (at.dexpinv_choice(), at.halvings()) {
                (Dexpinv::Eigen, _) => eigen += 1,
                (Dexpinv::Series(_), 0) => series += 1,
                _ => halved += 1,
            }
            let back = dexp(&group, &u, &w).expect("dexp");
            // Small directions of dexp⁻¹ (φ(z) = z e^{−z}) are lost next to large ones: compare in
            // units of what dexp makes of ε‖w‖.
            let lost = growth(&u) * group.norm(&w);
            let units = (back.as_ref() - v.as_ref()).norm_l2() / (EPS * lost);
            let bound = 40.0 * (1.0 + norm) * (1.0 + norm / distance);
            assert!(units <= bound, "{} at {norm}: {units} of {bound}", group.name());
        }
    }
    assert!(series > 50 && halved > 40 && eigen > 10, "{series} {halved} {eigen}");
}

/// A bound of dexp_u: e^{2‖sym u‖₂}.
fn growth(u: &AlgebraMatrix) -> f64 {
    let symmetric = (u.as_ref() + u.transpose()) * faer::Scale(0.5);
    (2.0 * symmetric.norm_l2()).exp()
}

/// The closed form on so(3) near 2π: refused below the threshold, right above it; the distance is
/// what is left.
#[test]
fn real_singularities() {
    let so3 = MatrixGroup::so(3).expect("SO(3)");
    let sp2 = MatrixGroup::sp(2).expect("Sp(2)");
    let gl2 = MatrixGroup::gl(2).expect("GL(2)");
    let mut rng = Pcg64::seed_from_u64(13);
    for k in 1..=16 {
        let delta = 10f64.powi(-k);
        // ad_u has the eigenvalues ±iα on so(3), ±2ia on sp(2) and gl(2).
        for (group, angle) in
            [(&so3, TAU - delta), (&sp2, PI - 0.5 * delta), (&gl2, PI - 0.5 * delta)]
        {
            let mut u = group.zero();
            (u[(0, 1)], u[(1, 0)]) = (-angle, angle);
            let distance = distance_to_singular(group, &u).expect("a spectrum");
            assert!((distance - delta).abs() <= 40.0 * EPS, "{}: {distance:e}", group.name());
            let v = group.sample_algebra(&mut rng, 1.0);
            match Exp.eval_dpsi_inv(group, &u, &v) {
                Ok(w) => {
                    assert!(k <= 12 && w.norm_l2().is_finite(), "{} at 1e-{k}", group.name());
                    let back = dexp(group, &u, &w).expect("dexp");
                    let gap = (back.as_ref() - v.as_ref()).norm_l2();
                    assert!(gap <= 100.0 * EPS / delta * v.norm_l2(), "{} at 1e-{k}", group.name());
                }
                Err(error) => {
                    assert!(k >= 11, "{} at 1e-{k}: {error}", group.name());
                    assert!(error.to_string().contains("multiple of 2πi"), "{error}");
                }
            }
        }
    }
}

/// D1, D6, D8, D11, D12.
#[test]
fn edges() {
    let mut rng = Pcg64::seed_from_u64(14);
    for group in [MatrixGroup::so(4), MatrixGroup::sp(4), MatrixGroup::gl(4)] {
        let group = group.expect("a group");
        let (zero, v) = (group.zero(), group.sample_algebra(&mut rng, 1.0));
        assert_eq!(Exp.eval_dpsi_inv(&group, &zero, &v).expect("u = 0"), v);
        assert_eq!(dexp(&group, &zero, &v).expect("u = 0"), v);
        for q in [0, 1, 2, 9] {
            assert_eq!(dexpinv_truncated(&group, &zero, &v, q).expect("u = 0"), v);
        }
        // v ∥ u and v = 0: exactly so where only the series is at work.
        let mut u = group.zero();
        group.axpy(0.1, &v, &mut u);
        assert!(gap(&Exp.eval_dpsi_inv(&group, &u, &v).expect("[u, v] = 0"), &v) < 2.0 * EPS);
        assert_eq!(Exp.eval_dpsi_inv(&group, &v, &zero).expect("v = 0"), zero);
        let mut broken = v.clone();
        broken[(3, 2)] = f64::NAN;
        let message = dexp(&group, &broken, &v).expect_err("NaN").to_string();
        assert!(message.starts_with("u[3,2] = NaN"), "{message}");
        let small = AlgebraMatrix::new_unchecked(Mat::zeros(3, 3));
        let message = dexpinv_truncated(&group, &v, &small, 2).expect_err("a shape").to_string();
        assert!(message.starts_with("v: 3×3, expected 4×4"), "{message}");
        for size in [1e8, 1e150, 1e200, f64::MAX] {
            let mut u = group.zero();
            group.axpy(size / group.norm(&v), &v, &mut u);
            if let Ok(w) = Exp.eval_dpsi_inv(&group, &u, &zero) {
                assert!(group.is_finite(&w), "{size:e}");
            }
            if let Ok(w) = Exp.eval_dpsi_inv(&group, &u, &v) {
                assert!(group.is_finite(&w), "{size:e}");
            }
            if let Ok(w) = dexp(&group, &u, &v) {
                assert!(group.is_finite(&w), "{size:e}");
            }
        }
    }
    // Nilpotent u of size 10: the exact sums are finite.
    let gl3 = MatrixGroup::gl(3).expect("GL(3)");
    let u = gl3.algebra(faer::mat![[0.0, 10.0, -3.0], [0.0, 0.0, 5.0], [0.0, 0.0, 0.0]]);
    let u = u.expect("gl(3)");
    let v = gl3.sample_algebra(&mut rng, 1.0);
    let exact = dexpinv_truncated(&gl3, &u, &v, 6).expect("a finite sum");
    let w = Exp.eval_dpsi_inv(&gl3, &u, &v).expect("dexp⁻¹");
    assert!(gap(&w, &exact) < 1e3 * EPS, "{:e}", gap(&w, &exact));
    assert_eq!(dexpinv_with_remainder(&gl3, &u, &v, 5).expect("a sum").remainder, 0.0);
    // n = 100 at a norm beyond the series.
    let sp = MatrixGroup::sp(100).expect("Sp(100)");
    let u = sp.sample_algebra(&mut rng, 0.05);
    let v = sp.sample_algebra(&mut rng, 1.0);
    let w = Exp.eval_dpsi_inv(&sp, &u, &v).expect("dexp⁻¹");
    assert!(gap(&dexp(&sp, &u, &w).expect("dexp"), &v) < 1e-10);
}

/// The remainder is a bound, not far from the truth, and infinite where it knows nothing.
#[test]
fn remainder_of_the_cut_series() {
    let mut rng = Pcg64::seed_from_u64(15);
    for group in [MatrixGroup::so(5), MatrixGroup::sp(4), MatrixGroup::gl(3)] {
        let group = group.expect("a group");
        for size in [0.1, 1.0, 2.5] {
            let direction = group.sample_algebra(&mut rng, 1.0);
            let (mut u, v) = (group.zero(), group.sample_algebra(&mut rng, 1.0));
            group.axpy(size / group.norm(&direction), &direction, &mut u);
            let exact = Exp.eval_dpsi_inv(&group, &u, &v).expect("dexp⁻¹");
            for q in [0, 1, 2, 3, 4, 6, 12, 20] {
                let cut = dexpinv_with_remainder(&group, &u, &v, q).expect("a sum");
                let truth = (cut.value.as_ref() - exact.as_ref()).norm_l2();
                let rounding = 60.0 * EPS * v.norm_l2();
                assert!(truth <= cut.remainder + rounding, "{} {size} q = {q}", group.name());
                if q == 2 && size == 0.1 {
                    assert!(cut.remainder < 1e3 * truth, "{} {size}", group.name());
                }
            }
        }
        let mut u = group.zero();
        group.axpy(30.0, &group.sample_algebra(&mut rng, 1.0), &mut u);
        let v = group.sample_algebra(&mut rng, 1.0);
        assert!(dexpinv_with_remainder(&group, &u, &v, 4).expect("a sum").remainder.is_infinite());
    }
    let gl3 = MatrixGroup::gl(3).expect("a group");
    let all = |x: f64| gl3.algebra(Mat::full(3, 3, x)).expect("an element");
    for q in [0, 1, 30] {
        let cut = dexpinv_with_remainder(&gl3, &all(5e-324), &all(1e308), q).expect("a sum");
        assert!(cut.remainder >= 0.0, "q = {q}: {}", cut.remainder);
    }
}

/// Eigenvalues that are close to each other have no accurate eigenvectors. On so(n) twice such an eigenvalue is none of ad_u,
/// also where it is 2πi, and only sums of two of them count.
#[test]
fn clusters_at_half_a_turn() {
    let mut rng = Pcg64::seed_from_u64(15);
    let angles: [&[f64]; 8] = [
        &[PI, PI + 1e-7],
        &[PI, PI + 1e-4],
        &[1000.0, PI, PI + 9e-4],
        &[1e5, PI, PI + 0.05],
        &[1e7, PI],
        &[3.0 * PI + 0.2, PI, PI + 1e-6, 0.1, 0.1],
        &[0.3, 0.3 + 1e-9, PI + 0.1, PI + 0.1 + 1e-9, 2e-9],
        &[2.0, 2.0, 2.0],
    ];
    for angles in angles {
        for n in [2 * angles.len(), 2 * angles.len() + 1] {
            let group = MatrixGroup::so(n).expect("SO(n)");
            let mut block = Mat::zeros(n, n);
            for (k, &angle) in angles.iter().enumerate() {
                (block[(2 * k + 1, 2 * k)], block[(2 * k, 2 * k + 1)]) = (angle, -angle);
            }
            let turn = group.sample_element(&mut rng);
            let u = group.project_algebra((&*turn * &block * turn.transpose()).as_ref());
            // The eigenvalues ±i(α ± β) of ad_u, and ±iα for odd n.
            let sums = (0..angles.len())
                .flat_map(|j| (0..j).flat_map(move |k| [(j, k, 1.0), (j, k, -1.0)]));
            let mut thetas: Vec<f64> = sums.map(|(j, k, s)| angles[j] + s * angles[k]).collect();
            thetas.extend(angles.iter().filter(|_| n % 2 == 1));
            let away =
                |theta: &f64| (theta.abs() - TAU * (theta.abs() / TAU).round().max(1.0)).abs();
            let distance = thetas.iter().map(away).fold(TAU, f64::min);
            let size = group.norm(&u);
            let v = group.sample_algebra(&mut rng, 1.0);
            let w = Exp
                .eval_dpsi_inv(&group, &u, &v)
                .unwrap_or_else(|e| panic!("{angles:?}, {n}: {e}"));
            let back = dexp(&group, &u, &w).expect("dexp");
            let gap = (back.as_ref() - v.as_ref()).norm_l2() / v.norm_l2();
            let bound = 100.0 * EPS * (1.0 + size * (1.0 + 1.0 / distance));
            assert!(gap <= bound, "{angles:?}, {n}: {gap:e}, expected {bound:e}");
        }
    }
}
