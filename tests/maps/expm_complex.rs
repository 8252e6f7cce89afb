//! exp of complex matrices and in `f32`: laws, errors; references of complex matrices are in `references.rs`.

use std::collections::BTreeSet;

use faer::{Mat, c64};
use lieflow::StepError;
use lieflow::dense::{ComplexExponential, Exponential, ExponentialF32, Structure};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

const EPS: f64 = f64::EPSILON;
/// ‖g*g − 𝟙‖_F per √n·ε: twice that of real rotations, as a complex product is four real ones.
const C_GROUP: f64 = 8.0;

fn defect(g: &Mat<c64>) -> f64 {
    (g.adjoint() * g - Mat::<c64>::identity(g.ncols(), g.ncols())).norm_l2()
}

fn uniform(rng: &mut Pcg64) -> f64 {
    rng.next_u64() as f64 / 2f64.powi(63) - 1.0
}

fn element(rng: &mut Pcg64, n: usize, structure: Structure, size: f64) -> Mat<c64> {
    let mut u = Mat::from_fn(n, n, |_, _| c64::new(uniform(rng), uniform(rng)));
    if structure == Structure::Skew {
        u = &u - u.adjoint();
    }
    let norm = u.norm_l2();
    Mat::from_fn(n, n, |i, j| u[(i, j)] * (size / norm))
}

#[test]
fn every_branch_is_taken_and_keeps_the_laws() {
    let mut rng = Pcg64::seed_from_u64(1);
    let (mut degrees, mut squarings, mut corrected) = (BTreeSet::new(), BTreeSet::new(), false);
    for n in [2, 5, 12, 40] {
        let mut exp = ComplexExponential::new(n);
        for structure in [Structure::Skew, Structure::General] {
            for k in 0..24 {
                let size = 10f64.powf(-17.0 + f64::from(k) * 0.85);
                if structure == Structure::General && size > 50.0 {
                    continue;
                }
                let u = element(&mut rng, n, structure, size);
                let minus = Mat::from_fn(n, n, |i, j| -u[(i, j)]);
                let (mut g, mut back) = (u.clone(), u.clone());
                let choice = exp.exp(&u, structure, &mut g).expect("exp(u)");
                exp.exp(&minus, structure, &mut back).expect("exp(−u)");
                degrees.insert(choice.degree);
                squarings.insert(choice.squarings);
                corrected |= choice.corrections > 0;
                let gap = (&g * &back - Mat::<c64>::identity(n, n)).norm_l2();
                let unit = EPS * g.norm_l2() * back.norm_l2() * size.max(1.0);
                assert!(gap <= 4.0 * unit, "{n} {size:e} {choice:?}: {gap:e}");
                if structure == Structure::Skew {
                    let defect = defect(&g);
                    assert!(
                        defect <= C_GROUP * (n as f64).sqrt() * EPS,
                        "{n} {size:e}: {defect:e}"
                    );
                }
            }
        }
    }
    assert_eq!(degrees, BTreeSet::from([1, 8, 12, 18]));
    assert!(squarings.len() > 5 && corrected, "{squarings:?}");
}

/// A real matrix is a complex one.
#[test]
fn real_matrices_agree_with_the_real_exponential() {
    let mut rng = Pcg64::seed_from_u64(2);
    for n in [1, 3, 8, 20] {
        for size in [1e-3, 0.2, 1.0, 8.0] {
            let u = Mat::from_fn(n, n, |_, _| size * uniform(&mut rng) / n as f64);
            let z = Mat::from_fn(n, n, |i, j| c64::new(u[(i, j)], 0.0));
            let (mut g, mut w) = (u.clone(), z.clone());
            Exponential::new(n).exp(&u, Structure::General, &mut g).expect("exp");
            ComplexExponential::new(n).exp(&z, Structure::General, &mut w).expect("exp");
            let gap = Mat::from_fn(n, n, |i, j| w[(i, j)] - g[(i, j)]).norm_l2() / g.norm_l2();
            assert!(gap <= 4.0 * EPS * size.max(1.0), "{n} {size}: {gap:e}");
        }
    }
}

#[test]
fn errors() {
    for n in [1, 3, 20] {
        let mut exp = ComplexExponential::new(n);
        let mut g = Mat::zeros(n, n);
        for structure in [Structure::Skew, Structure::General] {
            for bad in [f64::NAN, f64::INFINITY] {
                for z in [c64::new(bad, 0.0), c64::new(0.0, bad)] {
                    let mut u = Mat::zeros(n, n);
                    u[(n - 1, 0)] = z;
                    assert!(exp.exp(&u, structure, &mut g).is_err());
                }
            }
        }
        let mut u = Mat::zeros(n, n);
        u[(0, 0)] = c64::new(0.0, 2e15);
        let error = exp.exp(&u, Structure::Skew, &mut g).expect_err("too large");
        assert_eq!(error, StepError::NormTooLarge { map: "exp" });
        for size in [1e4, 1e100, 1e300] {
            u[(0, 0)] = c64::new(size, 0.0);
            let error = exp.exp(&u, Structure::General, &mut g).expect_err("overflow");
            assert!(matches!(error, StepError::NotFinite { .. }));
        }
        assert!(exp.exp(&Mat::zeros(n, n + 1), Structure::General, &mut g).is_err());
    }
}

#[test]
fn f32_is_the_f64_result_rounded() {
    let mut rng = Pcg64::seed_from_u64(3);
    for n in [1, 2, 5, 16, 30] {
        for size in [1e-6, 0.1, 1.0, 20.0] {
            for structure in [Structure::Skew, Structure::General] {
                let mut u = Mat::<f32>::zeros(n, n);
                for j in 0..n {
                    for i in 0..n {
                        u[(i, j)] = (size * uniform(&mut rng)) as f32;
                    }
                }
                if structure == Structure::Skew {
                    u = &u - u.transpose();
                }
                let wide = Mat::from_fn(n, n, |i, j| f64::from(u[(i, j)]));
                let (mut g, mut h) = (u.clone(), wide.clone());
                let expected = Exponential::new(n).exp(&wide, structure, &mut h);
                let found = ExponentialF32::new(n).exp(&u, structure, &mut g);
                let fits = h.norm_max() < f64::from(f32::MAX);
                if expected.is_err() || !fits {
                    assert!(found.is_err());
                    continue;
                }
                assert_eq!(found, expected);
                for j in 0..n {
                    for i in 0..n {
                        assert_eq!(g[(i, j)], h[(i, j)] as f32);
                    }
                }
            }
        }
    }
    let mut u = Mat::<f32>::zeros(2, 2);
    u[(0, 0)] = 100.0;
    let error = ExponentialF32::new(2).exp(&u, Structure::General, &mut Mat::zeros(2, 2));
    assert!(matches!(error, Err(StepError::NotFinite { .. })));
}
