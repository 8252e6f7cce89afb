//! The logarithm of matrix groups: exp and log as inverses, and refusals. References: `references.rs`.

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, Sample, So3};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::{Error, LieAlgebra, LieGroup, NoLogarithm, so3};
use nalgebra::Matrix3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

const EPS: f64 = f64::EPSILON;

fn exp(group: &MatrixGroup, u: &AlgebraMatrix) -> GroupMatrix {
    Exp.eval(group, u).expect("exp")
}

/// exp(log g) = g to 10 n ε·size², and log(exp u) = u inside the principal domain.
#[test]
fn inverse_of_exp() {
    let mut rng = Pcg64::seed_from_u64(4);
    let m = Mat::from_fn(3, 3, |i, j| [[2.0, 0.5, 0.0], [0.0, 1.0, -1.0], [0.3, 0.0, 1.5]][i][j]);
    let groups = (2..=9).map(MatrixGroup::so).chain([
        MatrixGroup::so(20),
        MatrixGroup::sp(2),
        MatrixGroup::sp(4),
        MatrixGroup::sp(8),
        MatrixGroup::gl(1),
        MatrixGroup::gl(3),
        MatrixGroup::gl(7),
        MatrixGroup::indefinite(3, 1),
        MatrixGroup::gm(m),
    ]);
    for group in groups {
        let group = group.expect("a group");
        let n = group.n() as f64;
        for case in 0..30 {
            let direction = group.sample_algebra(&mut rng, 1.0);
            let mut u = group.zero();
            // The spectral radius is below the Frobenius norm: no eigenvalue reaches iπ.
            let size = 10f64.powf(rng.random_range(-6.0..0.49));
            group.axpy(size / group.norm(&direction).max(1e-300), &direction, &mut u);
            let g = exp(&group, &u);
            let back = group.log(&g).unwrap_or_else(|error| panic!("{}: {error}", group.name()));
            let gap = (&*back - &*u).norm_l2();
            let both = g.norm_l2() * exp(&group, &negative(&group, &u)).norm_l2();
            let bound = 10.0 * n * EPS * both / (PI - size).clamp(0.05, 1.0);
            assert!(gap <= bound, "{} case {case}: {gap:e} > {bound:e}", group.name());
            let again = group.distance(&exp(&group, &back), &g);
            assert!(again <= 10.0 * n * EPS * both, "{}: {again:e}", group.name());
        }
    }
}

/// Far from 𝟙 the small eigenvalues are the rounding of the large ones: refused on each group that is not compact.
#[test]
fn elements_without_digits_are_refused() {
    let sp = MatrixGroup::sp(2).unwrap();
    let shear = |a: f64| {
        // a·(e₁ stretched, e₂ shrunk), sheared.
        let u = Mat::from_fn(2, 2, |i, j| a * [[1.0, -1.4], [0.0, -1.0]][i][j]);
        exp(&sp, &sp.algebra(u).unwrap())
    };
    assert!(sp.log(&shear(10.0)).is_ok());
    for a in [18.0, 30.0] {
        match sp.log(&shear(a)) {
            Err(Error::Singular { arg: "g", rcond, .. }) => assert!(rcond < 1e-14, "{rcond:e}"),
            other => panic!("{a}: {other:?}"),
        }
    }
}

fn negative(group: &MatrixGroup, u: &AlgebraMatrix) -> AlgebraMatrix {
    let mut out = group.zero();
    group.axpy(-1.0, u, &mut out);
    out
}

/// Every rotation has a logarithm: Haar's measure, half turns in pairs, permutations.
#[test]
fn all_of_so_n() {
    let mut rng = Pcg64::seed_from_u64(5);
    let worst = std::cell::Cell::new(0.0f64);
    let check = |group: &MatrixGroup, g: &GroupMatrix, what: &str| {
        let u = group.log(g).unwrap_or_else(|error| panic!("{what} on {}: {error}", group.name()));
        let n = group.n() as f64;
        let gap = group.distance(&exp(group, &u), g);
        worst.set(worst.get().max(gap / (n * EPS)));
        if gap > 10.0 * n * EPS {
            println!("{what} on {}: {gap:e}", group.name());
        }
        assert!((&*u + u.transpose()).norm_l2() == 0.0, "skew");
        // No angle exceeds π: ‖u‖² = 2 Σ θ².
        assert!(group.norm(&u) <= (2.0 * (n / 2.0).floor()).sqrt() * PI * (1.0 + 8.0 * EPS));
    };
    for n in 2..=12 {
        let group = MatrixGroup::so(n).expect("a group");
        for _ in 0..20 {
            check(&group, &group.sample_element(&mut rng), "Haar");
        }
        // diag(−1, −1, …) with pairs of −1, and the same in another basis.
        for pairs in 1..=n / 2 {
            let d = Mat::from_fn(n, n, |i, j| match i == j {
                true if i < 2 * pairs => -1.0,
                true => 1.0,
                false => 0.0,
            });
            let q = group.sample_element(&mut rng).into_mat();
            let turned = &q * &d * q.transpose();
            check(&group, &group.element(d).expect("a rotation"), "half turns");
            check(&group, &group.element(turned).expect("a rotation"), "turned half turns");
        }
        // A cyclic permutation (with one sign where it is odd), where plain QR steps stall.
        let cycle = Mat::from_fn(n, n, |i, j| match i == (j + 1) % n {
            true if n % 2 == 0 && j == n - 1 => -1.0,
            true => 1.0,
            false => 0.0,
        });
        check(&group, &group.element(cycle).expect("a rotation"), "cycle");
        check(&group, &group.identity(), "identity");
    }
    println!("worst ‖exp(log g) − g‖ {:.2} nε", worst.get());
    assert!(worst.get() <= 10.0);
}

/// The general layer at n = 3 is the closed form.
#[test]
fn layers_agree() {
    let (closed, general) = (So3::<f64>::new(), MatrixGroup::so(3).expect("a group"));
    let mut rng = Pcg64::seed_from_u64(6);
    for _ in 0..500 {
        let g: Matrix3<f64> = closed.sample_element(&mut rng);
        let u = so3::log(&g).expect("log");
        if u.norm() > 3.1 {
            continue; // the axis is badly conditioned next to π
        }
        let element = general.element(Mat::from_fn(3, 3, |i, j| g[(i, j)])).expect("a rotation");
        let w = general.log(&element).expect("log");
        let vee = nalgebra::Vector3::new(w[(2, 1)], w[(0, 2)], w[(1, 0)]);
        assert!((vee - u).norm() <= 40.0 * EPS / (PI - u.norm()).min(1.0), "{u:?}");
    }
}

/// What has no real logarithm is refused, with the eigenvalue; and so is what is not on the group.
#[test]
fn refusals() {
    let diagonal =
        |d: &[f64]| Mat::from_fn(d.len(), d.len(), |i, j| if i == j { d[i] } else { 0.0 });
    let gl = MatrixGroup::gl(2).expect("a group");
    for d in [[-1.0, 2.0], [3.0, -1e-8], [-5.0, -7.0]] {
        let g = gl.element(diagonal(&d)).expect("invertible");
        match gl.log(&g) {
            Err(error @ Error::NoLogarithm { re, why: NoLogarithm::Odd, .. }) => {
                assert!(re < 0.0);
                assert!(error.to_string().contains("GL(2)"), "{error}");
            }
            other => panic!("{d:?}: {other:?}"),
        }
    }
    let sp = MatrixGroup::sp(2).expect("a group");
    let g = sp.element(diagonal(&[-2.0, -0.5])).expect("symplectic");
    assert!(matches!(sp.log(&g), Err(Error::NoLogarithm { why: NoLogarithm::Odd, .. })));
    let lorentz = MatrixGroup::indefinite(3, 1).expect("a group");
    let reversal = lorentz.element(diagonal(&[1.0, 1.0, 1.0, -1.0])).expect("on the group");
    let refused = lorentz.log(&reversal);
    assert!(matches!(refused, Err(Error::NoLogarithm { why: NoLogarithm::Odd, .. })));
    // −1 on one direction of space and on time: turns by π exist, but they mix the two.
    let both = lorentz.element(diagonal(&[1.0, 1.0, -1.0, -1.0])).expect("on the group");
    let refused = lorentz.log(&both);
    assert!(matches!(refused, Err(Error::NoLogarithm { why: NoLogarithm::Outside, .. })));
    // One Jordan block of −1 has no real logarithm, two of them have; neither is told from the other.
    let jordan = gl.element(faer::mat![[-1.0, 1.0], [0.0, -1.0]]).expect("invertible");
    let refused = gl.log(&jordan);
    assert!(matches!(refused, Err(Error::NoLogarithm { why: NoLogarithm::Undecided, .. })));

    for n in [3, 5] {
        let so = MatrixGroup::so(n).expect("a group");
        let minus = GroupMatrix::new_unchecked(diagonal(&vec![-1.0; n]));
        assert!(matches!(so.log(&minus), Err(Error::Reflection { arg: "g" })));
        let mut nan = Mat::identity(n, n);
        nan[(n - 1, 0)] = f64::NAN;
        let nan = GroupMatrix::new_unchecked(nan);
        assert!(matches!(so.log(&nan), Err(Error::NotFiniteEntry { .. })));
        let mut far = Mat::identity(n, n);
        far[(0, 1)] = 0.1;
        assert!(matches!(
            so.log(&GroupMatrix::new_unchecked(far)),
            Err(Error::NotOnGroup { arg: "g", .. })
        ));
    }
    let singular = GroupMatrix::new_unchecked(Mat::zeros(2, 2));
    assert!(matches!(gl.log(&singular), Err(Error::Singular { .. })));
    let wrong = GroupMatrix::new_unchecked(Mat::identity(3, 3));
    assert!(matches!(gl.log(&wrong), Err(Error::Shape { .. })));
}

/// Negative eigenvalues in pairs: exp(log g) = g, and log g ∈ 𝔤 with a turn by π in each pair, as g
/// stands and in other bases.
#[test]
fn pairs_of_half_turns() {
    let mut rng = Pcg64::seed_from_u64(7);
    let skewed = {
        let signs = [3.0, -2.0, 2.0, -3.0];
        MatrixGroup::gm(Mat::from_fn(4, 4, |i, j| if i == j { signs[i] } else { 0.3 }))
    };
    for (group, d) in [
        (MatrixGroup::gl(2), vec![-1.0; 2]),
        (MatrixGroup::gl(3), vec![-5.0, 3.0, -5.0]),
        (MatrixGroup::gl(5), vec![-5.0, -0.1, 3.0, -5.0, -0.1]),
        (MatrixGroup::gl(8), vec![-1.0; 8]),
        (MatrixGroup::sp(2), vec![-1.0; 2]),
        (MatrixGroup::sp(4), vec![-1.0; 4]),
        (MatrixGroup::sp(4), vec![-1.0, 2.0, -1.0, 0.5]),
        (MatrixGroup::sp(8), vec![-2.0, -2.0, -1.0, 3.0, -0.5, -0.5, -1.0, 1.0 / 3.0]),
        (MatrixGroup::indefinite(3, 1), vec![-1.0, 1.0, -1.0, 1.0]),
        (MatrixGroup::indefinite(2, 2), vec![-1.0; 4]),
        (MatrixGroup::indefinite(2, 2), vec![1.0, 1.0, -1.0, -1.0]),
        (
            MatrixGroup::gm(Mat::from_fn(4, 4, |i, j| f64::from(u8::from(i + j == 3)))),
            vec![-1.0; 4],
        ),
        (skewed, vec![-1.0; 4]),
    ] {
        let group = group.expect("a group");
        let n = group.n();
        let d = Mat::from_fn(n, n, |i, j| if i == j { d[i] } else { 0.0 });
        for case in 0..10 {
            // h d h⁻¹, with h = 𝟙 at first.
            let mut v = group.sample_algebra(&mut rng, 0.3);
            if case == 0 {
                group.set_zero(&mut v);
            }
            let (h, inverse) = (exp(&group, &v), exp(&group, &negative(&group, &v)));
            let g = GroupMatrix::new_unchecked(&*h * &d * &*inverse);
            let u = group.log(&g).unwrap_or_else(|error| panic!("{}: {error}", group.name()));
            assert!(group.algebra((*u).clone()).is_ok(), "{}: in the algebra", group.name());
            let cond = (h.norm_l2() * inverse.norm_l2()).powi(2) * group.norm(&u).max(1.0);
            let gap = group.distance(&exp(&group, &u), &g) / g.norm_l2();
            assert!(gap <= 4.0 * EPS * cond, "{} case {case}: {gap:e}", group.name());
            // tr log g = ln det g, and every pair turns by π.
            let eigenvalues = u.eigenvalues().expect("eigenvalues");
            let turns = eigenvalues.iter().filter(|z| (z.im.abs() - PI).abs() < 1e-6).count();
            let pairs = (0..n).filter(|&i| d[(i, i)] < 0.0).count();
            assert_eq!(turns, pairs, "{}: {eigenvalues:?}", group.name());
        }
    }
}

/// Wide scales and defective matrices.
#[test]
fn hard_matrices() {
    let gl = |rows: &[&[f64]]| {
        let n = rows.len();
        let group = MatrixGroup::gl(n).expect("a group");
        let g = group.element(Mat::from_fn(n, n, |i, j| rows[i][j])).expect("invertible");
        (group, g)
    };
    // One Jordan block: log = N − N²/2 + …
    let (group, g) = gl(&[&[1.0, 1.0, 0.0], &[0.0, 1.0, 1.0], &[0.0, 0.0, 1.0]]);
    let u = group.log(&g).expect("log");
    let expected = [[0.0, 1.0, -0.5], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];
    for i in 0..3 {
        for j in 0..3 {
            assert!((u[(i, j)] - expected[i][j]).abs() < 1e-14, "{u:?}");
        }
    }
    // diag(1e6, 1e-6) is as good as two scalars.
    let (group, g) = gl(&[&[1e6, 0.0], &[0.0, 1e-6]]);
    let u = group.log(&g).expect("log");
    assert!((u[(0, 0)] - 1e6f64.ln()).abs() < 1e-14 * 13.9, "{u:?}");
    assert!((u[(1, 1)] - 1e-6f64.ln()).abs() < 1e-14 * 13.9, "{u:?}");
    // Tiny: relative accuracy is kept.
    let so = MatrixGroup::so(4).expect("a group");
    let mut g = Mat::identity(4, 4);
    (g[(0, 1)], g[(1, 0)], g[(2, 3)], g[(3, 2)]) = (-1e-200, 1e-200, 3e-310, -3e-310);
    let u = so.log(&so.element(g).expect("a rotation")).expect("log");
    assert!((u[(1, 0)] / 1e-200 - 1.0).abs() < 1e-15 && (u[(2, 3)] / 3e-310 - 1.0).abs() < 1e-12);
}

/// Beside the negative axis an eigenvalue and its conjugate are one up to rounding. What is returned is a logarithm of g.
#[test]
fn what_has_no_digits_is_refused() {
    let exact = |group: &MatrixGroup, g: Mat<f64>, what: &str| {
        let g = group.element(g).unwrap_or_else(|error| panic!("{what}: {error}"));
        match group.log(&g) {
            Ok(u) => {
                let gap = (&*exp(group, &u) - &*g).norm_l2() / g.norm_l2();
                assert!(gap < 1e-7, "{what}: {gap:e}");
                true
            }
            Err(Error::NoLogarithm { why, .. }) => {
                assert!(why != NoLogarithm::Odd || what.contains("alone"), "{what}: {why}");
                false
            }
            Err(error) => panic!("{what}: {error}"),
        }
    };
    let (sl, gl) = (MatrixGroup::sl(2).unwrap(), MatrixGroup::gl(6).unwrap());
    let mut found = [0, 0];
    for k in 1..=16 {
        let d = 10f64.powi(-k);
        // A turn by π − d in sheared axes.
        let (c, s) = ((PI - d).cos(), (PI - d).sin());
        let g = Mat::from_fn(2, 2, |i, j| [[c - 0.5 * s, -1.25 * s], [s, c + 0.5 * s]][i][j]);
        found[usize::from(exact(&sl, g, &format!("a turn by π − {d}")))] += 1;
        // Symmetric, with two pairs of negative eigenvalues beside each other.
        let values = [-1.0, -1.0, -1.0 - d, -1.0 - d, 5.0, 5.0];
        let mut rng = Pcg64::seed_from_u64(k as u64);
        let so = MatrixGroup::so(6).unwrap();
        let q = exp(&so, &so.sample_algebra(&mut rng, 2.0));
        let diagonal = Mat::from_fn(6, 6, |i, j| if i == j { values[i] } else { 0.0 });
        let g = &*q * diagonal * q.transpose();
        found[usize::from(exact(&gl, g, &format!("pairs {d} apart")))] += 1;
    }
    // Both happen.
    assert!(found[0] > 3 && found[1] > 15, "{found:?}");
}

/// On SU(n) the angles of the eigenvalues may have another sum than 0, and then some are taken a turn farther. On U(n) the
/// eigenvalue −1 may be repeated.
#[test]
fn logarithms_of_unitary_matrices() {
    let mut rng = Pcg64::seed_from_u64(11);
    for n in 2..=5 {
        for group in [MatrixGroup::su(n), MatrixGroup::u(n)] {
            let group = group.expect("a group");
            for case in 0..200 {
                let u = group.sample_algebra(&mut rng, 2.0);
                let mut g = exp(&group, &u);
                if case == 0 {
                    // −𝟙, with the rounding of another basis.
                    let minus = Mat::<f64>::identity(2 * n, 2 * n) * faer::Scale(-1.0);
                    let minus = &*g * minus * g.transpose();
                    match group.element(minus) {
                        Ok(minus) => g = minus,
                        Err(_) => continue, // its determinant is −1
                    }
                }
                let log = group.log(&g).expect("a logarithm");
                let gap = (&*exp(&group, &log) - &*g).norm_l2();
                assert!(gap < 100.0 * n as f64 * EPS, "{} {case}: {gap:e}", group.name());
            }
        }
    }
}

/// What the projection onto 𝔤 takes away beside half turns is told, too.
#[test]
fn a_logarithm_that_is_not_in_the_algebra_has_no_digits() {
    let half_turn = |d: f64| {
        let a = [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0];
        let (c, s) = (-d.cos(), d.sin());
        let hat = [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
        let scale = [1.0, 2.0, 3.0];
        Mat::from_fn(3, 3, |i, j| {
            let one = if i == j { c } else { 0.0 };
            (one + s * hat[i][j] + (1.0 - c) * a[i] * a[j]) * scale[j] / scale[i]
        })
    };
    let m = Mat::from_fn(3, 3, |i, j| if i == j { ((i + 1) * (i + 1)) as f64 } else { 0.0 });
    let group = MatrixGroup::gm(m).expect("a group");
    let mut found = [0, 0];
    for k in 2..=15 {
        let g = group.element(half_turn(10f64.powi(-k))).expect("an element");
        match group.log(&g) {
            Ok(u) => {
                let gap = (&*exp(&group, &u) - &*g).norm_l2() / g.norm_l2();
                assert!(gap < 1e-7, "π − 1e-{k}: {gap:e}");
                found[0] += 1;
            }
            Err(Error::NoLogarithm { .. }) => found[1] += 1,
            Err(error) => panic!("π − 1e-{k}: {error}"),
        }
    }
    assert!(found[0] > 4 && found[1] > 2, "{found:?}");
}
