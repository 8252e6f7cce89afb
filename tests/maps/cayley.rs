//! cay at its edges: far out, near 𝟙 − u/2 singular, its inverse and its differential; the Padé map
//! of order 4.

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, Sample, So3, hat};
use lieflow::maps::{Cay, Exp, Pade22, cay_inv, dcay};
use lieflow::{CoordinateMap, Error, LieAlgebra, LieGroup, StepError};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

fn dense(x: &Matrix3<f64>) -> Mat<f64> {
    Mat::from_fn(3, 3, |i, j| x[(i, j)])
}

/// C3: never singular on so(n), and on the group however large u: to 1e15 in n dimensions, to the
/// end of the range on so(3).
#[test]
fn far_out() {
    let mut rng = Pcg64::seed_from_u64(21);
    let so3 = So3::<f64>::new();
    for k in 0..307 {
        let size = 10f64.powi(k);
        let axis = so3.sample_vector(&mut rng).normalize();
        let u = axis * size;
        let g = Cay.eval(&so3, &u).expect("cay(u)");
        assert!(so3.defect(&g) <= 8.0 * EPS, "1e{k}: {:e}", so3.defect(&g));
        // The angle is π − 4/|u| + …
        if k > 9 {
            let half_turn = axis * axis.transpose() * 2.0 - Matrix3::identity();
            assert!((g - half_turn).norm() <= 8.0 / size + 8.0 * EPS, "1e{k}");
        }
        let mut y = Vector3::zeros();
        let x = so3.sample_vector(&mut rng);
        let mut scratch = g;
        Cay.psi_on(&so3, &u, &mut (), &mut scratch, &x, &mut y).expect("cay(u)x");
        assert!((y - g * x).norm() <= 8.0 * EPS * x.norm(), "1e{k}");
        match Cay.eval_dpsi_inv(&so3, &u, &x) {
            Ok(w) => assert!(so3.is_finite(&w), "1e{k}"),
            Err(error) => assert!(k >= 150, "1e{k}: {error}"),
        }
    }
    for n in [1, 2, 3, 4, 5, 8, 9] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        for k in 0..16 {
            let (direction, mut u) = (group.sample_algebra(&mut rng, 1.0), group.zero());
            let size = if n == 1 { 1.0 } else { group.norm(&direction) };
            group.axpy(10f64.powi(k) / size, &direction, &mut u);
            match Cay.eval(&group, &u) {
                Ok(g) => {
                    let bound = 6.0 * n as f64 * EPS;
                    assert!(group.defect(&g) <= bound, "n = {n}, 1e{k}: {:e}", group.defect(&g));
                }
                Err(error) => assert!(k == 15, "n = {n}, 1e{k}: {error}"),
            }
        }
    }
}

/// C1, C2: the condition number decides, and is told.
#[test]
fn near_singular() {
    let sp2 = MatrixGroup::sp(2).expect("Sp(2)");
    for k in 1..=16 {
        let gap = 10f64.powi(-k);
        let x = 2.0 - gap;
        let u = sp2.algebra(faer::mat![[x, 0.0], [0.0, -x]]).expect("sp(2)");
        match Cay.eval(&sp2, &u) {
            Ok(g) => {
                let exact = (1.0 + 0.5 * x) / (1.0 - 0.5 * x);
                assert!(k <= 13 && (g[(0, 0)] / exact - 1.0).abs() <= 4.0 * EPS, "1e-{k}");
            }
            Err(Error::Map(StepError::NearlySingular { rcond, .. })) => {
                assert!(k >= 14 && (0.0..1e-14).contains(&rcond), "1e-{k}: rcond = {rcond:e}");
            }
            Err(error) => panic!("1e-{k}: {error}"),
        }
    }
    // Ill conditioned without a small pivot: a triangle of −1 (Kahan).
    let gl = MatrixGroup::gl(60).expect("GL(60)");
    let u = Mat::from_fn(60, 60, |i, j| if j > i { 2.0 } else { 0.0 });
    let u = gl.algebra(u).expect("gl(60)");
    assert!(matches!(Cay.eval(&gl, &u), Ok(_) | Err(Error::Map(StepError::NearlySingular { .. }))));
}

/// cay_inv(cay(u)) = u to eps·cond, and C5: −1 is not in the image.
#[test]
fn inverse_map() {
    let mut rng = Pcg64::seed_from_u64(22);
    let so3 = So3::<f64>::new();
    for k in -20..16 {
        let u = so3.sample_vector(&mut rng).normalize() * 10f64.powf(0.5 * f64::from(k));
        let back = cay_inv(&so3, &Cay.eval(&so3, &u).expect("cay(u)")).expect("a chart");
        // w = 1/√(1 + |u|²/4) is known to eps.
        let cond = 1.0 + 0.25 * u.norm_squared();
        assert!((back - u).norm() <= 8.0 * EPS * cond.sqrt() * u.norm().max(1.0), "{u}");
    }
    for turn in [[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]] {
        let g = Matrix3::from_diagonal(&Vector3::from(turn));
        assert!(matches!(cay_inv(&so3, &g), Err(Error::Singular { .. })), "{turn:?}");
        let group = MatrixGroup::so(3).expect("SO(3)");
        let g = group.element(dense(&g)).expect("a rotation");
        assert!(matches!(cay_inv(&group, &g), Err(Error::Singular { .. })), "{turn:?}");
    }
    assert!(cay_inv(&so3, &Matrix3::from_element(f64::NAN)).is_err());
    for group in [MatrixGroup::so(5), MatrixGroup::sp(4), MatrixGroup::gl(3)] {
        let group = group.expect("a group");
        for _ in 0..20 {
            let u = group.sample_algebra(&mut rng, 0.4);
            let Ok(g) = Cay.eval(&group, &u) else { continue };
            let back = cay_inv(&group, &g).expect("a chart");
            let plus = g.as_ref() + Mat::<f64>::identity(group.n(), group.n());
            let svd = plus.svd().expect("singular values");
            let s = svd.S().column_vector();
            let cond = (s[0] / s[group.n() - 1]).powi(2);
            let gap = (back.as_ref() - u.as_ref()).norm_l2();
            assert!(gap <= 16.0 * EPS * cond * (1.0 + u.norm_l2()), "{}: {gap:e}", group.name());
        }
    }
    let small = GroupMatrix::new_unchecked(Mat::identity(2, 2));
    assert!(cay_inv(&MatrixGroup::gl(3).expect("GL(3)"), &small).is_err());
    // Near 𝟙 the trace of cay⁻¹(g) on SL(n) is rounding.
    for n in [2, 3] {
        let sl = MatrixGroup::sl(n).expect("SL(n)");
        for k in 6..=12 {
            let u = sl.sample_algebra(&mut rng, 10f64.powi(-k));
            let g = Exp.eval(&sl, &u).expect("exp(u)");
            let back = cay_inv(&sl, &g).expect("a g near 𝟙");
            let gap = (&*back - &*u).norm_l2();
            assert!(gap <= 40.0 * EPS, "SL({n}), 1e-{k}: {gap:e}");
        }
    }
    // On SL(3) most g are no cay(u) of a u without trace.
    let sl = MatrixGroup::sl(3).expect("SL(3)");
    let diagonal = |x: [f64; 3]| {
        let g = Mat::from_fn(3, 3, |i, j| if i == j { x[i] } else { 0.0 });
        cay_inv(&sl, &sl.element(g).expect("an element"))
    };
    assert!(matches!(diagonal([2.0, 2.0, 0.25]), Err(Error::Trace { .. })));
    assert!(diagonal([2.0, 1.0, 0.5]).is_ok() && diagonal([1.0; 3]).is_ok());
}

/// dcay is the inverse of dcay⁻¹, and the derivative of cay by a central difference.
#[test]
fn differential() {
    let mut rng = Pcg64::seed_from_u64(23);
    let so3 = So3::<f64>::new();
    for k in -10..150 {
        let u = so3.sample_vector(&mut rng).normalize() * 10f64.powi(k);
        let v = so3.sample_vector(&mut rng);
        let w = dcay(&so3, &u, &v).expect("dcay");
        assert!(so3.is_finite(&w));
        if k <= 6 {
            let back = Cay.eval_dpsi_inv(&so3, &u, &w).expect("dcay⁻¹");
            assert!((back - v).norm() <= 8.0 * EPS * (1.0 + u.norm_squared()) * v.norm(), "1e{k}");
        }
    }
    for group in [MatrixGroup::so(5), MatrixGroup::sp(4), MatrixGroup::gl(3)] {
        let group = group.expect("a group");
        for _ in 0..20 {
            let (u, v) = (group.sample_algebra(&mut rng, 0.3), group.sample_algebra(&mut rng, 1.0));
            let w = dcay(&group, &u, &v).expect("dcay");
            let back = Cay.eval_dpsi_inv(&group, &u, &w).expect("dcay⁻¹");
            let size = w.norm_l2() * (1.0 + u.norm_l2()).powi(2);
            assert!(
                (back.as_ref() - v.as_ref()).norm_l2() <= 16.0 * EPS * size,
                "{}",
                group.name()
            );
            let h = 1e-5;
            let at = |h: f64| {
                let mut moved = u.clone();
                group.axpy(h, &v, &mut moved);
                Cay.eval(&group, &moved).expect("cay")
            };
            let slope = (at(h).as_ref() - at(-h).as_ref()) * faer::Scale(0.5 / h);
            let mut expected = group.identity();
            let g = at(0.0);
            group.compose(&GroupMatrix::new_unchecked(w.clone().into_mat()), &g, &mut expected);
            let gap = (slope - expected.as_ref()).norm_l2();
            let bound = 10.0 * h * h * (1.0 + w.norm_l2()).powi(3) * (1.0 + g.norm_l2());
            assert!(gap <= bound, "{}: {gap:e} of {bound:e}", group.name());
        }
    }
}

/// Ψ − exp = O(u⁵), both layers the same map at every size, in the group.
#[test]
fn pade_is_of_order_4_and_the_same_on_both_layers() {
    let mut rng = Pcg64::seed_from_u64(24);
    let (so3, general) = (So3::<f64>::new(), MatrixGroup::so(3).expect("SO(3)"));
    let axis = so3.sample_vector(&mut rng).normalize();
    let error = |size: f64| {
        let u = axis * size;
        (Pade22.eval(&so3, &u).expect("Ψ") - Exp.eval(&so3, &u).expect("exp")).norm()
    };
    for size in [0.4, 0.2, 0.1] {
        let order = (error(size) / error(0.5 * size)).log2();
        assert!((order - 5.0).abs() < 0.05, "local order {order}");
    }
    for k in 0..4000 {
        let size = 10f64.powf(-8.0 + 0.004 * f64::from(k) * 2.5 / 4.0 * 1.2);
        let u = so3.sample_vector(&mut rng).normalize() * size;
        let v = so3.sample_vector(&mut rng);
        let dense_u = AlgebraMatrix::new_unchecked(dense(&hat(&u)));
        let dense_v = AlgebraMatrix::new_unchecked(dense(&hat(&v)));
        let closed = Pade22.eval(&so3, &u).expect("Ψ");
        assert!(so3.defect(&closed) <= 8.0 * EPS, "{size:e}");
        let g = Pade22.eval(&general, &dense_u).expect("Ψ");
        let cond = 1.0 + size * size;
        let gap = (dense(&closed) - g.as_ref()).norm_l2();
        assert!(gap <= 8.0 * EPS * cond, "Ψ at {size:e}: {gap:e}");
        let closed = Pade22.eval_dpsi_inv(&so3, &u, &v).expect("dΨ⁻¹");
        let w = Pade22.eval_dpsi_inv(&general, &dense_u, &dense_v).expect("dΨ⁻¹");
        let gap = (dense(&hat(&closed)) - w.as_ref()).norm_l2();
        assert!(gap <= 8.0 * EPS * cond * cond * v.norm(), "dΨ⁻¹ at {size:e}: {gap:e}");
    }
    // Two planes with a b = 12 are singular on so(4), and one with a² = 12 is not.
    let so4 = MatrixGroup::so(4).expect("SO(4)");
    let planes = |a: f64, b: f64| {
        let mut u = so4.zero();
        (u[(1, 0)], u[(0, 1)], u[(3, 2)], u[(2, 3)]) = (a, -a, b, -b);
        u
    };
    let v = so4.sample_algebra(&mut rng, 1.0);
    assert!(Pade22.eval_dpsi_inv(&so4, &planes(3.0, 4.0), &v).is_err());
    let w = Pade22.eval_dpsi_inv(&so4, &planes(12f64.sqrt(), 1.0), &v).expect("dΨ⁻¹");
    assert!(w.norm_l2() < 20.0 * v.norm_l2());
}

/// A solve loses the group to rounding where u is large. On SO(n) the quotients are put back, up to norms where no digit is
/// left.
#[test]
fn large_turns_stay_on_the_group() {
    let mut rng = Pcg64::seed_from_u64(21);
    for n in [3, 4, 5, 17] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        for size in [3.9, 4.1, 30.0, 220.0, 2.3e4, 1.4e6, 3.2e7] {
            let v = group.sample_algebra(&mut rng, 1.0);
            let mut u = group.zero();
            group.axpy(size / v.norm_l2(), &v, &mut u);
            let x = group.sample_vector(&mut rng);
            macro_rules! check {
                ($($map:expr),*) => {$({
                    let (map, mut y) = ($map, x.clone());
                    let g = map.eval(&group, &u).expect("a map");
                    let defect = (g.transpose() * &*g - Mat::<f64>::identity(n, n)).norm_l2();
                    let bound = 8.0 * (n as f64).sqrt() * f64::EPSILON;
                    assert!(defect <= bound, "{} at {size:e}, n = {n}: {defect:e}", stringify!($map));
                    let mut at = CoordinateMap::<MatrixGroup>::at(&map, &group).expect("storage");
                    map.psi_on(&group, &u, &mut at, &mut group.identity(), &x, &mut y).expect("g·x");
                    let off = (&y - &*g * &x).norm_l2();
                    assert!(off <= 1e-13 * x.norm_l2(), "{} at {size:e}: {off:e}", stringify!($map));
                    // What is stored is of the same u.
                    let mut w = v.clone();
                    let found = map.dpsi_inv(&group, &u, &mut at, &mut w).map(|()| w);
                    let again = map.eval_dpsi_inv(&group, &u, &v);
                    assert_eq!(found.map_err(Error::from), again, "{} at {size:e}", stringify!($map));
                })*};
            }
            check![Cay, Pade22];
        }
        let mut u = group.sample_algebra(&mut rng, 1.0);
        let scale = 1e9 / u.norm_l2();
        u.col_iter_mut().for_each(|column| column.iter_mut().for_each(|x| *x *= scale));
        let message = Pade22.eval(&group, &u).expect_err("too large").to_string();
        assert!(message.contains("the norm of the argument is too large"), "{message}");
    }
}
