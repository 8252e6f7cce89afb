//! Matrices as no random number makes them: triangles in disguise, blocks and rows of all magnitudes,
//! permutations, small integers, numbers near the ends of the range. On every group exp, dexp, its inverse
//! and log return, agree with each other to rounding, and fail only where they have to.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, c64};
use lieflow::dense::{ComplexExponential, Exponential, ExponentialBatch, Structure};
use lieflow::groups::{AlgebraMatrix, Form, MatrixGroup, Sample};
use lieflow::maps::{Cay, Exp, cay_inv, dexp, distance_to_singular};
use lieflow::{CoordinateMap, LieAlgebra};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

/// An element of 𝔤 near a matrix of one of these shapes.
fn structured(group: &MatrixGroup, shape: u32, rng: &mut Pcg64) -> AlgebraMatrix {
    let n = group.n();
    let any_size = |rng: &mut Pcg64| match rng.random_range(0..3) {
        0 => 1.0,
        1 => 10f64.powf(rng.random_range(-3.0..2.5)),
        _ => 10f64.powf(rng.random_range(-310.0..2.5)),
    };
    let sizes: Vec<f64> = (0..n).map(|_| any_size(rng)).collect();
    let cut = rng.random_range(1..=n);
    let mut place: Vec<usize> = (0..n).collect();
    place.shuffle(rng);
    let x = Mat::from_fn(n, n, |i, j| {
        let x: f64 = rng.random_range(-1.0..1.0);
        let block = |i: usize| usize::from(place[i] < cut);
        match shape {
            0 => x,
            1 => x * sizes[i],
            2 => x * sizes[i] * sizes[j],
            3 if block(i) == block(j) => x * sizes[block(i)],
            4 if place[i] < place[j] => x,
            5 if rng.random_range(0..4) == 0 => 2.0 * x.round(),
            6 if place[i] < place[j] => x * sizes[i],
            6 if i == j => 1.0,
            7 if i == place[j] => 1.0,
            8 => x * any_size(rng),
            _ => 0.0,
        }
    });
    let size = if rng.random_range(0..3) == 0 { any_size(rng) } else { 1.0 };
    group.project_algebra((x * faer::Scale(size)).as_ref())
}

fn groups() -> Vec<MatrixGroup> {
    let mut groups = vec![MatrixGroup::so(20), MatrixGroup::gl(24), MatrixGroup::sp(18)];
    for n in 2..=10 {
        groups.extend([MatrixGroup::so(n), MatrixGroup::gl(n)]);
        groups.extend((n % 2 == 0).then(|| MatrixGroup::sp(n)));
        groups
            .extend([MatrixGroup::indefinite(n - 1, 1), MatrixGroup::indefinite(n / 2, n - n / 2)]);
    }
    groups.into_iter().map(|group| group.expect("a group")).collect()
}

/// The reciprocal of ‖x‖‖x⁻¹‖, Frobenius.
fn rcond(x: &Mat<f64>) -> f64 {
    let inverse = x.partial_piv_lu().inverse();
    let product = x.norm_l2() * inverse.norm_l2();
    if product.is_finite() { 1.0 / product } else { 0.0 }
}

#[test]
fn maps_and_their_inverses() {
    let mut rng = Pcg64::seed_from_u64(21);
    for group in groups() {
        let (name, n) = (group.name(), group.n());
        let one = Mat::<f64>::identity(n, n);
        for round in 0..if n > 10 { 200 } else { 100 } {
            let shape = rng.random_range(0..9);
            let u = structured(&group, shape, &mut rng);
            let size = u.norm_l2();
            if size > 200.0 {
                continue;
            }
            let at = || format!("{name}, round {round}: u = {:?}", &*u);
            let minus = AlgebraMatrix::new_unchecked(&*u * faer::Scale(-1.0));
            let exp = |u| Exp.eval(&group, u).unwrap_or_else(|e| panic!("{e}: {}", at()));
            let (g, inverse) = (exp(&u), exp(&minus));
            // exp(u)exp(−u) = 𝟙: to ε for each of the factors, and as far as u moves them.
            let spread = g.norm_l2() * inverse.norm_l2();
            let rounding = EPS * n as f64 * spread * size.max(1.0);
            let gap = (&*g * &*inverse - &one).norm_l2();
            assert!(gap <= 8.0 * rounding * size.max(1.0), "exp: {gap:e}, {}", at());

            let far = distance_to_singular(&group, &u).unwrap_or_else(|e| panic!("{e}: {}", at()));
            let v = group.sample_algebra(&mut rng, 1.0);
            let w = dexp(&group, &u, &v).unwrap_or_else(|e| panic!("{e}: {}", at()));
            match Exp.eval_dpsi_inv(&group, &u, &w) {
                Ok(back) => {
                    let gap = (&*back - &*v).norm_l2() / v.norm_l2();
                    let cond = (1.0 + size / far.min(1.0)).powi(2);
                    assert!(gap <= 30.0 * rounding * spread * cond, "dexp⁻¹: {gap:e}, {}", at());
                }
                Err(e) => assert!(far < 1e-9 * size.max(1.0), "dexp⁻¹: {e}, {far:e}: {}", at()),
            }
            if size < 3.0 {
                let back = group.log(&g).unwrap_or_else(|e| panic!("{e}: {}", at()));
                let gap = (&*back - &*u).norm_l2();
                assert!(gap <= 99.0 * rounding, "log: {gap:e}, {}", at());
            }
            match Cay.eval(&group, &u) {
                Ok(c) => {
                    let margin = rcond(&(&*c + &one));
                    let back = cay_inv(&group, &c);
                    assert!(
                        back.is_ok() || margin < 1e-13,
                        "cay⁻¹: {back:?}, {margin:e}: {}",
                        at()
                    );
                }
                Err(e) => {
                    let margin = rcond(&(&one - &*u * faer::Scale(0.5)));
                    assert!(margin < 1e-13, "cay: {e}, {margin:e}: {}", at());
                }
            }
        }
    }
}

/// Balancing takes a triangle in disguise for a steep matrix; what it saves in the norm it loses in digits.
#[test]
fn a_graded_triangle_is_not_balanced_to_pieces() {
    let mut rng = Pcg64::seed_from_u64(22);
    let group = MatrixGroup::gl(24).expect("GL(24)");
    for round in 0..400 {
        let u = structured(&group, 6, &mut rng);
        // u − 𝟙 is nilpotent: exp(u) = e·Σ (u − 𝟙)ᵏ/k! with 24 terms, whatever the places.
        let nilpotent = &*u - Mat::<f64>::identity(24, 24);
        if u[(0, 0)] != 1.0 || nilpotent.norm_l2() > 50.0 {
            continue;
        }
        let (mut sum, mut term) = (Mat::<f64>::identity(24, 24), Mat::<f64>::identity(24, 24));
        let mut size = 1.0;
        for k in 1..24 {
            term = &term * &nilpotent * faer::Scale(1.0 / f64::from(k));
            sum += &term;
            size += term.norm_l2();
        }
        let g = Exp.eval(&group, &u).unwrap_or_else(|e| panic!("{e}"));
        let gap = (&*g - &sum * faer::Scale(core::f64::consts::E)).norm_l2();
        assert!(gap <= 24.0 * EPS * size * u.norm_l2(), "{round}: {:e}", gap / size);
    }
}

/// Padé's approximant, the default choice, a batch, complex numbers and exp(u)·x are one function.
#[test]
fn one_exponential() {
    let mut rng = Pcg64::seed_from_u64(23);
    for group in groups() {
        let (name, n) = (group.name(), group.n());
        let skew = match group.form() {
            Form::Identity => Structure::Skew,
            _ => Structure::General,
        };
        let mut out = Mat::zeros(n, n);
        for round in 0..if n > 10 { 100 } else { 60 } {
            let [shape, before, after] = [(); 3].map(|()| rng.random_range(0..9));
            let u = structured(&group, shape, &mut rng).into_mat();
            if u.norm_l2() > 200.0 {
                continue;
            }
            let at = || format!("{name}, round {round}: u = {u:?}");
            let mut exp = Exponential::new(n).insist_on_pade();
            exp.exp(&u, Structure::General, &mut out).unwrap_or_else(|e| panic!("{e}: {}", at()));
            let pade = out.clone();
            let cond = Exponential::condition(&u).unwrap_or_else(|e| panic!("{e}: {}", at()));
            let rounding = EPS * n as f64 * cond.max(1.0) * pade.norm_l2();
            let close = |mine: &Mat<f64>, what: &str| {
                let gap = (mine - &pade).norm_l2();
                assert!(gap <= 8.0 * rounding, "{what}: {:.1}, {}", gap / rounding, at());
            };

            let mut exp = Exponential::new(n);
            exp.exp(&u, skew, &mut out).unwrap_or_else(|e| panic!("{e}: {}", at()));
            close(&out, "the default choice");

            // Between strangers; one of them may be beyond the range, and then there is no batch.
            let strangers = [before, after].map(|shape| structured(&group, shape, &mut rng));
            let mut packed = vec![0.0; 3 * n * n];
            for (m, x) in [&*strangers[0], &u, &*strangers[1]].into_iter().enumerate() {
                for j in 0..n {
                    for i in 0..n {
                        packed[(j * n + i) * 3 + m] = x[(i, j)];
                    }
                }
            }
            let mut images = packed.clone();
            if ExponentialBatch::new(n).exp(&packed, skew, &mut images).is_ok() {
                close(&Mat::from_fn(n, n, |i, j| images[(j * n + i) * 3 + 1]), "a batch");
            }

            let z = Mat::from_fn(n, n, |i, j| c64::new(u[(i, j)], 0.0));
            let (mut g, mut exp_z) = (z.clone(), ComplexExponential::new(n));
            exp_z.exp(&z, skew, &mut g).unwrap_or_else(|e| panic!("{e}: {}", at()));
            close(&Mat::from_fn(n, n, |i, j| g[(i, j)].re), "complex numbers");

            let mut x = Mat::from_fn(n, 1, |i, _| 1.0 + i as f64);
            let image = &pade * &x;
            let size = x.norm_l2();
            exp.apply(&u, skew, &mut x).unwrap_or_else(|e| panic!("{e}: {}", at()));
            let gap = (&x - &image).norm_l2();
            assert!(gap <= 8.0 * rounding * size, "exp(u)·x: {gap:e}, {}", at());
        }
    }
}
