//! exp of many matrices side by side: the hard cases, and each matrix as if it were alone.

use faer::Mat;
use lieflow::StepError;
use lieflow::dense::{Exponential, ExponentialBatch, Structure};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::expm::{reference, structure};
use crate::support::references::cases;

const EPS: f64 = f64::EPSILON;

fn uniform(rng: &mut Pcg64) -> f64 {
    rng.next_u64() as f64 / 2f64.powi(63) - 1.0
}

fn element(rng: &mut Pcg64, n: usize, structure: Structure, size: f64) -> Mat<f64> {
    let mut u = Mat::from_fn(n, n, |_, _| uniform(rng));
    if structure == Structure::Skew {
        u = &u - u.transpose();
    }
    let norm = u.norm_l2();
    if norm > 0.0 { u * faer::Scale(size / norm) } else { u }
}

/// Entry (i, j) of matrix m at (j·n + i)·count + m, and back.
fn pack(all: &[Mat<f64>]) -> Vec<f64> {
    let (n, count) = (all[0].nrows(), all.len());
    let mut packed = vec![f64::NAN; n * n * count];
    for (m, a) in all.iter().enumerate() {
        for j in 0..n {
            for i in 0..n {
                packed[(j * n + i) * count + m] = a[(i, j)];
            }
        }
    }
    packed
}

fn batch(all: &[Mat<f64>], structure: Structure) -> Result<Vec<Mat<f64>>, StepError> {
    let (n, count) = (all[0].nrows(), all.len());
    let u = pack(all);
    let mut out = vec![f64::NAN; u.len()];
    ExponentialBatch::new(n).exp(&u, structure, &mut out)?;
    let matrix = |m| Mat::from_fn(n, n, |i, j| out[(j * n + i) * count + m]);
    Ok((0..count).map(matrix).collect())
}

fn alone(u: &Mat<f64>, structure: Structure) -> Result<Mat<f64>, StepError> {
    let mut g = u.clone();
    Exponential::new(u.nrows()).exp(u, structure, &mut g).map(|_| g)
}

/// The promise of the single exponential: 2ε·max(1, cond). Every case stands among strangers, so that its
/// neighbours decide on the degree.
#[test]
fn hard_cases_in_company() {
    let mut rng = Pcg64::seed_from_u64(1);
    let mut tried = 0;
    for case in cases("expm").iter().filter(|c| c.n <= 8 && !c.id.starts_with("beyond_")) {
        let (u, reference, structure) = (case.matrix("u"), reference(case), structure(case));
        for size in [0.01, 0.2, 0.9, 3.0] {
            let mut all: Vec<_> =
                (0..11).map(|_| element(&mut rng, case.n, structure, size)).collect();
            all[4] = u.clone();
            let g = &batch(&all, structure).unwrap_or_else(|e| panic!("{}: {e}", case.id))[4];
            let scale = reference.norm_l2().max(1e-300);
            let least = u.norm_l2() / (case.n as f64).sqrt();
            let cond = case.output["exp"].measure("cond").unwrap_or(least);
            let error = (g - &reference).norm_l2() / scale / (EPS * cond.max(1.0));
            assert!(error <= 2.0, "{} beside matrices of size {size}: {error:.2}", case.id);
            tried += 1;
        }
    }
    assert!(tried > 300, "{tried}");
}

#[test]
fn every_matrix_is_treated_as_if_it_were_alone() {
    let mut rng = Pcg64::seed_from_u64(2);
    for n in 1..=9 {
        for count in [1, 2, 3, 7, 8, 9, 33] {
            for structure in [Structure::Skew, Structure::General] {
                let all: Vec<_> = (0..count)
                    .map(|m| element(&mut rng, n, structure, 10f64.powf(-3.0 + (m % 5) as f64)))
                    .collect();
                for (m, g) in batch(&all, structure).expect("exp").iter().enumerate() {
                    let expected = alone(&all[m], structure).expect("exp");
                    let size = all[m].norm_l2();
                    let gap = (g - &expected).norm_l2() / expected.norm_l2();
                    assert!(gap <= 4.0 * EPS * size.max(1.0), "{n} {m}/{count} {size:e}: {gap:e}");
                    if structure == Structure::Skew {
                        let defect = Exponential::residual(g);
                        assert!(defect <= 4.0 * (n as f64).sqrt() * EPS, "{n} {size}: {defect:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn one_matrix_that_needs_care_does_not_spoil_the_others() {
    let mut rng = Pcg64::seed_from_u64(3);
    let mut all: Vec<_> = (0..20).map(|_| element(&mut rng, 3, Structure::General, 0.5)).collect();
    all[3] = Mat::from_fn(3, 3, |i, j| if i <= j { 4.0 } else { 0.0 });
    all[10] = element(&mut rng, 3, Structure::General, 90.0);
    for (u, g) in all.iter().zip(batch(&all, Structure::General).expect("exp")) {
        let expected = alone(u, Structure::General).expect("exp");
        let gap = (&g - &expected).norm_l2() / expected.norm_l2();
        assert!(gap <= 4.0 * EPS * u.norm_l2().max(1.0), "{u:?}: {gap:e}");
    }
}

#[test]
fn what_is_not_finite_is_an_error_in_every_lane() {
    let mut rng = Pcg64::seed_from_u64(4);
    for n in [1, 2, 3, 5, 6, 8] {
        for structure in [Structure::Skew, Structure::General] {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                for m in 0..11 {
                    let mut all: Vec<_> =
                        (0..11).map(|_| element(&mut rng, n, structure, 0.5)).collect();
                    all[m][(n - 1, 0)] = bad;
                    let error = batch(&all, structure).expect_err("not finite");
                    assert!(matches!(error, StepError::NotFinite { .. }), "{n} {m} {bad}: {error}");
                }
            }
        }
    }
    let mut large = element(&mut rng, 3, Structure::Skew, 1.0);
    (large[(0, 1)], large[(1, 0)]) = (1e16, -1e16);
    assert_eq!(batch(&[large], Structure::Skew), Err(StepError::NormTooLarge { map: "exp" }));
    assert!(ExponentialBatch::new(3).exp(&[], Structure::General, &mut []).is_ok());
    assert!(ExponentialBatch::new(0).exp(&[], Structure::General, &mut []).is_ok());
    assert!(ExponentialBatch::new(0).exp(&[1.0], Structure::General, &mut [0.0]).is_err());
}
