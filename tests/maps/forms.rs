//! The groups of a general M: one that is symmetric or skew only to rounding, one that is neither, and badly scaled ones.
//! What the maps return is compared with functions of \[u v; 0 u\], which know of no form.

use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Solve};
use lieflow::dense::{Exponential, Structure};
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, Sample};
use lieflow::maps::{Exp, Pade22, cay_inv, dexp};
use lieflow::{CoordinateMap, LieAlgebra};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

fn gaussian(rng: &mut Pcg64, n: usize) -> Mat<f64> {
    Mat::from_fn(n, n, |_, _| rng.sample::<f64, _>(StandardNormal))
}

fn one(n: usize) -> Mat<f64> {
    Mat::identity(n, n)
}

fn scaled(a: f64, x: &Mat<f64>) -> Mat<f64> {
    x * faer::Scale(a)
}

fn j(n: usize) -> Mat<f64> {
    let m = n / 2;
    Mat::from_fn(n, n, |r, c| f64::from(u8::from(c == r + m)) - f64::from(u8::from(r == c + m)))
}

fn diagonal(d: &[f64]) -> Mat<f64> {
    Mat::from_fn(d.len(), d.len(), |r, c| if r == c { d[r] } else { 0.0 })
}

fn cond(m: &Mat<f64>) -> f64 {
    m.norm_l2() * m.partial_piv_lu().inverse().norm_l2()
}

/// ‖u + M⁻¹uᵀM‖/‖u‖.
fn outside(u: &Mat<f64>, m: &Mat<f64>) -> f64 {
    (u + m.partial_piv_lu().solve(u.transpose() * m)).norm_l2() / u.norm_l2()
}

/// A random element of this size: x − M⁻¹xᵀM, where M is symmetric or skew to rounding.
fn element(rng: &mut Pcg64, m: &Mat<f64>, size: f64) -> Mat<f64> {
    let x = gaussian(rng, m.nrows());
    let u = &x - m.partial_piv_lu().solve(x.transpose() * m);
    scaled(size / u.norm_l2(), &u)
}

/// f(u) and dΨ_u(v), from f(\[u v; 0 u\]) = \[f(u) dΨ_u(v)f(u); 0 f(u)\].
fn by_blocks(f: impl Fn(&Mat<f64>) -> Mat<f64>, u: &Mat<f64>, v: &Mat<f64>) -> Mat<f64> {
    let n = u.nrows();
    let block = Mat::from_fn(2 * n, 2 * n, |r, c| match (r < n, c < n) {
        (true, false) => v[(r, c - n)],
        (false, true) => 0.0,
        _ => u[(r % n, c % n)],
    });
    let f = f(&block);
    let corner = f.submatrix(0, n, n, n).to_owned();
    corner * f.submatrix(0, 0, n, n).to_owned().partial_piv_lu().inverse()
}

fn exp(u: &Mat<f64>) -> Mat<f64> {
    let mut g = Mat::zeros(u.nrows(), u.nrows());
    Exponential::new(u.nrows()).exp(u, Structure::General, &mut g).expect("exp");
    g
}

fn pade22(u: &Mat<f64>) -> Mat<f64> {
    let even = one(u.nrows()) + scaled(1.0 / 12.0, &(u * u));
    (&even - scaled(0.5, u)).partial_piv_lu().solve(&even + scaled(0.5, u))
}

/// dexp, dexp⁻¹ and dΨ⁻¹ of the Padé map at u, beside the blocks.
fn maps_are_right(name: &str, group: &MatrixGroup, [u, v]: [&Mat<f64>; 2]) {
    let m = group.m().expect("a form");
    let [u, v] = [u, v].map(|u| group.algebra(u.clone()).unwrap_or_else(|e| panic!("{name}: {e}")));
    // In each function a product with M and one with M⁻¹; exp grows as e^‖u‖ at most.
    let bound = 100.0 * EPS * cond(&m) * exp(&u).norm_l2().powi(2);
    let near = |what: &str, x: &Mat<f64>, y: &Mat<f64>| {
        let gap = (x - y).norm_l2() / y.norm_l2();
        assert!(gap <= bound, "{name}: {what} is off by {gap:e}, bound {bound:e}");
    };
    let w = dexp(group, &u, &v).unwrap_or_else(|e| panic!("{name}: dexp: {e}"));
    near("dexp", &w, &by_blocks(exp, &u, &v));
    let w = Exp.eval_dpsi_inv(group, &u, &v).unwrap_or_else(|e| panic!("{name}: dexp⁻¹: {e}"));
    near("dexp of dexp⁻¹", &by_blocks(exp, &u, &w), &v);
    let w = Pade22.eval_dpsi_inv(group, &u, &v).unwrap_or_else(|e| panic!("{name}: pade22: {e}"));
    near("dΨ of dΨ⁻¹, pade22", &by_blocks(pade22, &u, &w), &v);
}

/// AᵀJA, skew to rounding, and a symmetric matrix with rounding errors.
fn up_to_rounding(rng: &mut Pcg64, n: usize) -> [(&'static str, Mat<f64>); 4] {
    let a = gaussian(rng, n);
    let mut skew = a.transpose() * j(n) * &a;
    let d =
        Mat::from_fn(n, n, |r, c| if r == c { 1.0 - 2.0 * f64::from(r as u8 % 2) } else { 0.0 });
    let mut symmetric = a.transpose() * d * &a;
    // Rounding differs between machines. These two entries are never equal.
    skew[(0, 1)] = -skew[(1, 0)] * (1.0 + 2.0 * EPS);
    symmetric[(0, 1)] = symmetric[(1, 0)] * (1.0 + 2.0 * EPS);
    [
        ("skew to rounding", skew),
        ("symmetric to rounding", symmetric),
        ("J + 1e-14", j(n) + scaled(1e-14, &one(n))),
        ("1 + 1e-14 J", one(n) + scaled(1e-14, &j(n))),
    ]
}

#[test]
fn a_form_up_to_rounding_is_a_form() {
    let mut rng = Pcg64::seed_from_u64(60);
    for n in [4, 4, 6, 10] {
        for (name, m) in up_to_rounding(&mut rng, n) {
            let group = MatrixGroup::gm(m.clone()).expect("a group");
            let is_skew = name.contains('J') == name.starts_with('J') && !name.starts_with("sym");
            let dim = if is_skew { n * (n + 1) / 2 } else { n * (n - 1) / 2 };
            assert_eq!(group.dim(), dim, "{name}");
            let [u, v] = [2.5, 1.0].map(|size| element(&mut rng, &m, size));
            maps_are_right(name, &group, [&u, &v]);
        }
    }
}

/// 𝔤 is the intersection of the algebras of both parts, and the larger part is the form of the maps.
#[test]
fn a_form_with_both_parts() {
    let mut rng = Pcg64::seed_from_u64(62);
    for n in [4, 6] {
        // AᵀMA has the algebra A⁻¹𝔤A. Here it is that of U(m).
        let a = one(n) + scaled(0.2, &gaussian(&mut rng, n));
        for c in [1.0, 0.5, 1e-2, 1e-4, 3.0, 1e3] {
            let m = a.transpose() * (scaled(c, &one(n)) + j(n)) * &a;
            let name = format!("n = {n}, {c}·𝟙 + J");
            let group = MatrixGroup::gm(m.clone()).expect("a group");
            assert_eq!(group.dim(), n * n / 4, "{name}");
            let [u, v] = [2.5, 1.0].map(|size| {
                let u = group.project_algebra(gaussian(&mut rng, n).as_ref());
                scaled(size / u.norm_l2(), &u)
            });
            maps_are_right(&name, &group, [&u, &v]);
        }
    }
    // u is skew only to 1e-7, and accepted: its symmetric part is small, and so is that of M.
    let (n, m) = (4, j(4) + scaled(1e-6, &one(4)));
    let group = MatrixGroup::gm(m).expect("a group");
    let [u, v] = [2.5, 1.0].map(|size| {
        let u = group.project_algebra(gaussian(&mut rng, n).as_ref());
        scaled(size / u.norm_l2(), &u) + element(&mut rng, &j(n), 1e-7)
    });
    maps_are_right("J + 1e-6", &group, [&u, &v]);
}

/// Forms without a symmetry, and with one, from well to badly scaled.
fn forms(rng: &mut Pcg64) -> Vec<(String, Mat<f64>)> {
    let mut forms = Vec::new();
    for n in [2, 3, 4, 6] {
        let x = gaussian(rng, n);
        forms.push((format!("symmetric, n = {n}"), &x + x.transpose()));
        if n % 2 == 0 {
            forms.push((format!("skew, n = {n}"), &x - x.transpose()));
            forms.push((format!("𝟙 + J, n = {n}"), x.transpose() * (one(n) + j(n)) * &x));
        }
        let q = x.qr().compute_thin_Q();
        for power in [-4.0, -8.0, -11.0] {
            let d: Vec<f64> =
                (0..n).map(|i| 10f64.powf(power * i as f64 / (n - 1) as f64)).collect();
            forms.push((format!("diagonal to 1e{power}, n = {n}"), diagonal(&d)));
            let m = &q * diagonal(&d) * q.transpose();
            let m = Mat::from_fn(n, n, |r, c| 0.5 * (m[(r, c)] + m[(c, r)]));
            forms.push((format!("turned diagonal to 1e{power}, n = {n}"), m));
        }
        if n == 4 {
            let small = |r: usize| if r.is_multiple_of(2) { 1.0 } else { 1e-4 };
            let m = one(4) + j(4);
            let m = Mat::from_fn(4, 4, |r, c| small(r) * small(c) * m[(r, c)]);
            forms.push(("𝟙 + J of two scales".into(), m));
        }
    }
    forms.push(("diag(1, 1, 1e-11)".into(), diagonal(&[1.0, 1.0, 1e-11])));
    forms
}

/// P is the orthogonal projection onto 𝔤: Px ∈ 𝔤, Pu = u, x − Px ⊥ 𝔤; random elements are in 𝔤.
#[test]
fn projections_are_nearest_elements() {
    let mut rng = Pcg64::seed_from_u64(63);
    for (name, m) in forms(&mut rng) {
        let (n, group) = (m.nrows(), MatrixGroup::gm(m.clone()).expect("a group"));
        // A diagonal M has no rounding, however badly it is scaled.
        let exact = name.starts_with("diag");
        let unit = 100.0 * n as f64 * EPS * if exact { 1.0 } else { cond(&m) };
        for _ in 0..10 {
            let x = gaussian(&mut rng, n);
            let u = group.project_algebra(x.as_ref());
            let w = group.sample_algebra(&mut rng, 1.0);
            for u in [&u, &w].into_iter().filter(|u| u.norm_l2() > 0.0) {
                let gap = outside(u, &m);
                assert!(gap <= unit, "{name}: {gap:e} outside of 𝔤, bound {unit:e}");
                assert!(group.algebra((**u).clone()).is_ok(), "{name}: refused");
                let again = group.project_algebra(u.as_ref());
                let moved = (&*again - &**u).norm_l2() / u.norm_l2();
                assert!(moved <= unit.min(100.0 * EPS * n as f64), "{name}: moved by {moved:e}");
            }
            let rest = &x - &*u;
            let dot = (0..n).map(|k| rest.col(k).transpose() * w.col(k)).sum::<f64>();
            assert!(dot.abs() <= 100.0 * EPS * (n * n) as f64, "{name}: x − Px on 𝔤: {dot:e}");
        }
        let g = group.sample_element(&mut rng);
        assert!(group.element(g.into_mat()).is_ok(), "{name}: a random element is refused");
    }
}

/// u₃₃ ≠ 0 has no place in the algebra of diag(1, 1, 10⁻¹¹), and g₃₃ ≠ ±1 none in the group.
#[test]
fn small_directions_are_checked() {
    let group = MatrixGroup::gm(diagonal(&[1.0, 1.0, 1e-11])).expect("a group");
    let u = faer::mat![[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.7]];
    let refused = group.algebra(u.clone()).expect_err("u₃₃").to_string();
    assert!(refused.contains("not in the Lie algebra"), "{refused}");
    assert!(group.algebra_within(u.clone(), 1e-6).is_err());
    assert!(group.check("u", &AlgebraMatrix::new_unchecked(u.clone())).is_err());
    let refused = group.element(exp(&u)).expect_err("g₃₃").to_string();
    assert!(refused.contains("not in G_M"), "{refused}");
    let inside = faer::mat![[0.0, -1.0, 1e-11], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
    let inside = group.algebra(inside).expect("in 𝔤");
    assert!(group.element(exp(&inside)).is_ok());
}

/// log and cay⁻¹ invert the maps. With a projection of O(n⁶) this test would not end: its map has n⁴ entries, 800 MB.
#[test]
fn inverse_maps_of_large_matrices() {
    let (n, mut rng) = (100, Pcg64::seed_from_u64(64));
    let x = gaussian(&mut rng, n);
    for m in [scaled(9.0, &one(n)) + &x + x.transpose(), &x - x.transpose()] {
        let group = MatrixGroup::gm(m.clone()).expect("a group");
        let u = AlgebraMatrix::new_unchecked(element(&mut rng, &m, 2.0));
        let g = GroupMatrix::new_unchecked(exp(&u));
        let bound = 100.0 * EPS * cond(&m) * g.norm_l2().powi(2);
        let back = group.log(&g).expect("a logarithm");
        assert!((&*back - &*u).norm_l2() <= bound, "log: {:e}", (&*back - &*u).norm_l2());
        let half = scaled(0.5, &u);
        let c = (one(n) - &half).partial_piv_lu().solve(one(n) + &half);
        let back = cay_inv(&group, &GroupMatrix::new_unchecked(c)).expect("cay⁻¹");
        assert!((&*back - &*u).norm_l2() <= bound, "cay⁻¹: {:e}", (&*back - &*u).norm_l2());
        let w = group.sample_algebra(&mut rng, 1.0);
        assert!(outside(&w, &m) <= 100.0 * EPS * cond(&m));
    }
}
