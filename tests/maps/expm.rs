//! The dense exponential: hard cases against 34-digit references, laws, every branch, every error.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use faer::{Mat, c64};
use lieflow::StepError;
use lieflow::dense::{
    ApplyChoice, Approximant, ComplexExponential, ExpmChoice, Exponential, ExponentialBatch,
    ExponentialF32, Structure,
};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};

use crate::support::references::{Case, cases, square};

const EPS: f64 = f64::EPSILON;

/// The Frobenius norm, scaled by the largest entry.
fn norm(a: &Mat<f64>) -> f64 {
    a.norm_l2()
}

fn exp(u: &Mat<f64>, structure: Structure) -> Result<(Mat<f64>, ExpmChoice), StepError> {
    let mut out = Mat::from_fn(u.nrows(), u.ncols(), |_, _| f64::NAN);
    let choice = Exponential::new(u.nrows()).exp(u, structure, &mut out)?;
    Ok((out, choice))
}

fn pade(u: &Mat<f64>, structure: Structure) -> Result<(Mat<f64>, ExpmChoice), StepError> {
    let mut out = Mat::from_fn(u.nrows(), u.ncols(), |_, _| f64::NAN);
    let choice = Exponential::new(u.nrows()).insist_on_pade().exp(u, structure, &mut out)?;
    assert!(choice.kind == Approximant::Pade || choice.degree == 1, "{choice:?}");
    Ok((out, choice))
}

fn uniform(rng: &mut Pcg64) -> f64 {
    rng.next_u64() as f64 / 2f64.powi(63) - 1.0
}

/// A random element with Frobenius norm `size`.
fn element(rng: &mut Pcg64, n: usize, structure: Structure, size: f64) -> Mat<f64> {
    let mut u = Mat::from_fn(n, n, |_, _| uniform(rng));
    if structure == Structure::Skew {
        u = &u - u.transpose();
    }
    let scale = size / norm(&u);
    u * faer::Scale(scale)
}

/// ‖gᵀg − 𝟙‖_F.
fn defect(g: &Mat<f64>) -> f64 {
    Exponential::residual(g)
}

pub(super) fn structure(case: &Case) -> Structure {
    if case.group == "so" { Structure::Skew } else { Structure::General }
}

pub(super) fn reference(case: &Case) -> Mat<f64> {
    square(case.n, &case.output["exp"].numbers())
}

/// G2, G3: the error in units of ε·max(1, condition), normwise and for entrywise perturbations.
fn score(f: impl Fn(&Mat<f64>, Structure) -> Result<(Mat<f64>, ExpmChoice), StepError>) -> f64 {
    let mut errors = Vec::new();
    let mut failures = Vec::new();
    for case in cases("expm") {
        let (u, reference, exp) = (case.matrix("u"), reference(&case), &case.output["exp"]);
        let (g, choice) = match f(&u, structure(&case)) {
            Ok(x) => x,
            Err(e) => {
                failures.push(format!("{}: {e}", case.id));
                continue;
            }
        };
        let size = norm(&reference);
        let gap = norm(&(&g - &reference));
        let relative = if size > 1e-300 { gap / size } else { gap / f64::MIN_POSITIVE };
        // ‖L‖ ≥ ‖exp(u)‖₂, with equality on so(n): a lower bound where none was computed.
        let least = norm(&u) / (case.n as f64).sqrt();
        let cond = exp.measure("cond").unwrap_or(least);
        let e_k = relative / (EPS * cond.max(1.0));
        // What no published algorithm does well is kept in sight, not required.
        let beyond = case.id.starts_with("beyond_");
        if beyond {
            println!("{}: e_k = {e_k:.2e}", case.id);
            continue;
        }
        errors.push(e_k);
        if e_k > 2.0 {
            failures.push(format!("{}: e_k = {e_k:.2e}, {choice:?}", case.id));
        }
        if let Some(mixed) = exp.measure("mixed") {
            let e_mixed = relative / (EPS * mixed.max(1.0));
            if e_mixed > 10.0 {
                failures.push(format!("{}: e_mixed = {e_mixed:.2e}, {choice:?}", case.id));
            }
        }
        if structure(&case) == Structure::Skew {
            let residual = defect(&g) / (EPS * (case.n as f64).sqrt());
            if residual > 4.0 {
                failures.push(format!("{}: residual {residual:.2} √n ε, {choice:?}", case.id));
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    println!("{} cases, e_k median {median:.2}, max {:.2}", errors.len(), errors[errors.len() - 1]);
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
    median
}

#[test]
fn hard_cases() {
    assert!(score(exp) <= 0.4);
}

#[test]
fn hard_cases_by_pade_alone() {
    score(pade);
}

#[test]
fn zero_gives_exactly_the_identity() {
    for n in [1, 2, 5, 16, 17, 60] {
        for structure in [Structure::General, Structure::Skew] {
            let zero = Mat::zeros(n, n);
            assert_eq!(exp(&zero, structure).expect("exp(0)").0, Mat::<f64>::identity(n, n), "{n}");
            assert_eq!(pade(&zero, structure).expect("exp(0)").0, Mat::<f64>::identity(n, n));
        }
    }
    assert_eq!(exp(&Mat::zeros(0, 0), Structure::General).expect("0×0").0.nrows(), 0);
}

#[test]
fn what_is_not_finite_is_an_error_wherever_it_stands() {
    for n in [1, 2, 3, 5, 8, 16, 17, 50] {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (i, j) in [(0, 0), (0, n - 1), (n - 1, 0), (n - 1, n - 1)] {
                for structure in [Structure::General, Structure::Skew] {
                    for size in [0.0, 1.0] {
                        let mut u = Mat::from_fn(n, n, |i, j| size * (i as f64 - j as f64));
                        u[(i, j)] = bad;
                        let error = exp(&u, structure).expect_err("not finite");
                        assert!(matches!(error, StepError::NotFinite { .. }), "{error}");
                        assert!(pade(&u, structure).is_err());
                    }
                }
            }
        }
    }
}

/// What is not n×n is told with both sizes by every entry; what is not finite is no result of any.
#[test]
fn every_entry_checks_sizes_and_numbers() {
    let told = |error: Result<(), StepError>, text: &str| {
        assert_eq!(error.expect_err("a wrong size").to_string(), text);
    };
    for structure in [Structure::General, Structure::Skew] {
        for n in [3usize, 20] {
            let (mut real, mut narrow) = (Exponential::new(n), ExponentialF32::new(n));
            let (mut complex, mut many) = (ComplexExponential::new(n), ExponentialBatch::new(n));
            for (rows, cols) in [(n - 1, n - 1), (n + 1, n + 1), (n, n + 1), (n - 1, n), (0, 0)] {
                let wrong = |arg: &str| format!("{arg}: {rows}×{cols}, expected {n}×{n}");
                let mut bad = Mat::<f64>::zeros(rows, cols);
                let mut good = Mat::<f64>::zeros(n, n);
                told(real.exp(&bad, structure, &mut good).map(drop), &wrong("u"));
                told(real.exp(&good, structure, &mut bad).map(drop), &wrong("out"));
                told(real.apply(&bad, structure, &mut good).map(drop), &wrong("u"));
                let (mut bad, mut good) = (Mat::<f32>::zeros(rows, cols), Mat::zeros(n, n));
                told(narrow.exp(&bad, structure, &mut good).map(drop), &wrong("u"));
                told(narrow.exp(&good, structure, &mut bad).map(drop), &wrong("out"));
                let (mut bad, mut good) = (Mat::<c64>::zeros(rows, cols), Mat::zeros(n, n));
                told(complex.exp(&bad, structure, &mut good).map(drop), &wrong("u"));
                told(complex.exp(&good, structure, &mut bad).map(drop), &wrong("out"));
            }
            let u = Mat::zeros(n, n);
            let columns = real.apply(&u, structure, &mut Mat::zeros(n + 1, 2));
            told(columns.map(drop), &format!("x: {}×2, expected {n}×2", n + 1));
            let (one, two) = (vec![0.0; n * n], vec![0.0; 2 * n * n]);
            let short = many.exp(&two[1..], structure, &mut two.clone());
            told(short, &format!("u: {}×1, expected {}×1", 2 * n * n - 1, 2 * n * n));
            let fewer = many.exp(&two, structure, &mut one.clone());
            told(fewer, &format!("out: {}×1, expected {}×1", n * n, 2 * n * n));

            for bad in [f64::NAN, f64::INFINITY] {
                let (mut u, mut out, one) = (u.clone(), u.clone(), Mat::<f64>::identity(n, n));
                u[(n - 1, 0)] = bad;
                let not = |error: Option<StepError>| {
                    assert!(matches!(error, Some(StepError::NotFinite { .. })), "{error:?}");
                };
                not(real.exp(&u, structure, &mut out).err());
                not(real.apply(&u, structure, &mut one.clone()).err());
                not(real.apply(&one, structure, &mut u.clone()).err());
                not(Exponential::condition(&u).err());
                let narrow_u = Mat::from_fn(n, n, |i, j| u[(i, j)] as f32);
                not(narrow.exp(&narrow_u, structure, &mut Mat::zeros(n, n)).err());
                let complex_u = Mat::from_fn(n, n, |i, j| c64::new(0.0, u[(i, j)]));
                not(complex.exp(&complex_u, structure, &mut Mat::zeros(n, n)).err());
                let mut entries = one_after_another(&u);
                not(many.exp(&entries.clone(), structure, &mut entries).err());
            }
        }
    }
    let error = Exponential::condition(&Mat::zeros(2, 3)).map(drop);
    told(error, "u: 2×3, expected 2×2");
}

/// Row E21: rotations in 2×2 blocks seen through a reflection, u = hbh with h = 𝟙 − 2vvᵀ/v², so that
/// exp(u) = h·exp(b)·h is known at any n; the general path is given the same matrix.
#[test]
fn large_matrices_with_a_known_exponential() {
    let sizes: &[usize] = if cfg!(debug_assertions) { &[64, 150] } else { &[64, 256, 1000] };
    for &n in sizes {
        let mut rng = Pcg64::seed_from_u64(n as u64);
        let angles: Vec<f64> = (0..n / 2).map(|_| 3.0 * uniform(&mut rng)).collect();
        let v: Vec<f64> = (0..n).map(|_| uniform(&mut rng)).collect();
        let square: f64 = v.iter().map(|x| x * x).sum();
        let reflected = |block: &dyn Fn(f64) -> [f64; 2]| {
            // hbh = b − v·wᵀ − z·vᵀ with w, z from bv, bᵀv, vᵀbv.
            let b = Mat::from_fn(n, n, |i, j| {
                let [c, s] = block(angles[i / 2]);
                match (i / 2 == j / 2, i.cmp(&j)) {
                    (false, _) => 0.0,
                    (_, Ordering::Equal) => c,
                    (_, Ordering::Greater) => s,
                    (_, Ordering::Less) => -s,
                }
            });
            let v = Mat::from_fn(n, 1, |i, _| v[i]);
            let (bv, vb) = (&b * &v, v.transpose() * &b);
            let vbv = (v.transpose() * &bv)[(0, 0)];
            let f = 2.0 / square;
            Mat::from_fn(n, n, |i, j| {
                b[(i, j)] - f * v[(i, 0)] * vb[(0, j)] - f * bv[(i, 0)] * v[(j, 0)]
                    + f * f * vbv * v[(i, 0)] * v[(j, 0)]
            })
        };
        let u = reflected(&|angle| [0.0, angle]);
        let expected = reflected(&|angle| [angle.cos(), angle.sin()]);
        for structure in [Structure::Skew, Structure::General] {
            let u = match structure {
                Structure::Skew => (&u - u.transpose()) * faer::Scale(0.5),
                Structure::General => u.clone(),
            };
            let start = std::time::Instant::now();
            let (g, choice) = exp(&u, structure).expect("exp");
            let (time, error) = (start.elapsed(), norm(&(&g - &expected)) / norm(&expected));
            println!("n = {n}, {structure:?}: {time:.1?}, error {error:.1e}, {choice:?}");
            // u is normal, and itself known to ε‖u‖.
            assert!(error <= 10.0 * EPS * 3.0, "{n} {structure:?}: {error:e}");
        }
    }
}

fn one_after_another(x: &Mat<f64>) -> Vec<f64> {
    (0..x.ncols()).flat_map(|j| x.col_as_slice(j).to_vec()).collect()
}

#[test]
fn overflow_and_meaningless_norms_are_errors() {
    for n in [2, 9, 30] {
        let u = Mat::from_fn(n, n, |i, j| if i == j { 1e4 * (-1f64).powi(i as i32) } else { 0.0 });
        assert_eq!(exp(&u, Structure::General), Err(StepError::NotFinite { what: "exp(u)" }));
        let full = Mat::from_fn(n, n, |_, _| 1e3);
        assert!(exp(&full, Structure::General).is_err());
        for x in [1e16, 1e20, 1e40, 1e77, 1e200, 1.7e308] {
            let mut u = Mat::zeros(n, n);
            (u[(0, 1)], u[(1, 0)]) = (x, -x);
            let error = StepError::NormTooLarge { map: "exp" };
            assert_eq!(exp(&u, Structure::Skew), Err(error));
            assert_eq!(pade(&u, Structure::Skew), Err(error));
            // Taken as any matrix it may fail, but says so and comes back.
            let _ = exp(&u, Structure::General);
        }
    }
    let wrong =
        Exponential::new(3).exp(&Mat::zeros(3, 4), Structure::General, &mut Mat::zeros(3, 3));
    assert!(wrong.is_err());
}

#[test]
fn any_bit_pattern_comes_back_finite_or_as_an_error() {
    let mut rng = Pcg64::seed_from_u64(1);
    for k in 0..4000 {
        let n = 1 + k % 18;
        let mut u = Mat::from_fn(n, n, |_, _| f64::from_bits(rng.next_u64()));
        if k % 3 == 0 {
            // All finite, magnitudes over the whole range.
            u = Mat::from_fn(n, n, |_, _| {
                let e = 300.0 * uniform(&mut rng);
                uniform(&mut rng) * 10f64.powf(e)
            });
        }
        for structure in [Structure::General, Structure::Skew] {
            if structure == Structure::Skew {
                u = Mat::from_fn(n, n, |i, j| {
                    if i < j {
                        u[(i, j)]
                    } else if i > j {
                        -u[(j, i)]
                    } else {
                        0.0
                    }
                });
            }
            for (g, choice) in [exp(&u, structure), pade(&u, structure)].into_iter().flatten() {
                assert!(norm(&g).is_finite() || g.norm_max().is_finite(), "{u:?} {choice:?}");
                if structure == Structure::Skew {
                    assert!(defect(&g) <= 4.0 * (n as f64).sqrt() * EPS, "{u:?} {choice:?}");
                }
            }
        }
    }
}

#[test]
fn every_branch_is_taken_and_keeps_the_laws() {
    let mut rng = Pcg64::seed_from_u64(2);
    let mut seen = BTreeSet::new();
    let (mut squared, mut corrected) = (BTreeSet::new(), BTreeSet::new());
    for n in [2, 3, 4, 6, 8, 9, 13, 16, 17, 33, 50, 100, 160, 233] {
        for structure in [Structure::General, Structure::Skew] {
            let steps = match n {
                50.. => 11,
                _ => 40,
            };
            for k in 0..steps {
                let size = 10f64.powf(-17.0 + 20.0 * f64::from(k) / f64::from(steps - 1));
                if structure == Structure::General && size > 100.0 {
                    continue;
                }
                let u = element(&mut rng, n, structure, size);
                let (g, choice) = exp(&u, structure).expect("exp(u)");
                let (p, by_pade) = pade(&u, structure).expect("exp(u)");
                for c in [choice, by_pade] {
                    seen.insert((c.kind, c.degree));
                    squared.extend((c.squarings > 0).then_some(c.kind));
                    corrected.extend((c.corrections > 0).then_some(c.kind));
                }
                // Two algorithms that share nothing but the products.
                let growth = EPS * (n as f64).sqrt() * size.max(1.0);
                let gap = norm(&(&g - &p)) / norm(&g);
                assert!(gap <= 8.0 * growth, "{n} {size:e} {choice:?} {by_pade:?}: {gap:e}");
                if structure == Structure::Skew {
                    for (g, c) in [(&g, choice), (&p, by_pade)] {
                        let residual = defect(g);
                        assert!(
                            residual <= 4.0 * (n as f64).sqrt() * EPS,
                            "{n} {size:e} {c:?} {residual:e}"
                        );
                    }
                }
            }
        }
    }
    use Approximant::{CosSin, Pade, Taylor};
    let all = [
        (Pade, 3),
        (Pade, 5),
        (Pade, 7),
        (Pade, 9),
        (Pade, 13),
        (Taylor, 1),
        (Taylor, 2),
        (Taylor, 4),
        (Taylor, 8),
        (Taylor, 12),
        (Taylor, 18),
        (CosSin, 5),
        (CosSin, 9),
        (CosSin, 13),
        (CosSin, 17),
    ];
    assert_eq!(seen, BTreeSet::from(all));
    assert_eq!(squared, BTreeSet::from([Pade, Taylor, CosSin]));
    assert_eq!(corrected, BTreeSet::from([Pade, Taylor, CosSin]));
}

#[test]
fn careful_branches_are_taken() {
    let choice = |rows: &[&[f64]]| {
        let n = rows.len();
        exp(&Mat::from_fn(n, n, |i, j| rows[i][j]), Structure::General).expect("exp(u)").1
    };
    // Balancing.
    assert!(choice(&[&[0.5, 1e-200], &[1e200, -0.5]]).balanced);
    // Powers see that nothing has to be squared.
    let nilpotent = choice(&[&[0.0, 1e6, 0.0], &[0.0, 0.0, 1e6], &[0.0, 0.0, 0.0]]);
    assert_eq!((nilpotent.kind, nilpotent.squarings), (Approximant::Pade, 0));
    // The trace is taken out before squaring: as many squarings as the rest needs.
    let shifted = choice(&[&[600.0, 1.0], &[-2.0, 601.0]]);
    assert!(shifted.squarings <= 2, "{shifted:?}");
    // Large matrices of no structure: products up to a norm of 1000, a solve beyond.
    let mut rng = Pcg64::seed_from_u64(3);
    let large = |size: f64, rng: &mut Pcg64| {
        exp(&element(rng, 128, Structure::General, size), Structure::General).expect("exp(u)").1
    };
    assert_eq!(large(1.0, &mut rng).kind, Approximant::Taylor);
    assert_eq!(large(60.0, &mut rng).kind, Approximant::Taylor);
    let mut stiff = element(&mut rng, 128, Structure::General, 1.0);
    (0..64).for_each(|i| stiff[(i, i)] -= 3e3);
    let stiff = exp(&stiff, Structure::General).expect("exp(u)").1;
    assert!(stiff.kind == Approximant::Pade && stiff.squarings > 5, "{stiff:?}");
}

#[test]
fn condition_estimates_lie_below_and_close() {
    for case in cases("expm").iter().filter(|c| c.n <= 8) {
        let Some(cond) = case.output["exp"].measure("cond") else { continue };
        let u = case.matrix("u");
        // Where exp(u) underflows so does its derivative.
        let vanishes = norm(&reference(case)) < 1e-290;
        if !(1e-3..1e6).contains(&norm(&u)) || cond > 1e6 || vanishes {
            continue;
        }
        let estimate = Exponential::condition(&u).unwrap_or_else(|e| panic!("{}: {e}", case.id));
        assert!(
            (0.3 * cond..=1.02 * cond).contains(&estimate),
            "{}: {estimate:e} for {cond:e}",
            case.id
        );
    }
}

#[test]
fn few_columns_agree_with_the_exponential() {
    let mut rng = Pcg64::seed_from_u64(4);
    let (mut formed, mut series) = (false, false);
    for (n, k, size) in [(40, 1, 0.5), (40, 2, 4.0), (100, 1, 10.0), (6, 6, 1.0), (30, 1, 1e3)] {
        for structure in [Structure::General, Structure::Skew] {
            if structure == Structure::General && size > 100.0 {
                continue;
            }
            let u = element(&mut rng, n, structure, size);
            let x = Mat::from_fn(n, k, |_, _| uniform(&mut rng));
            let mut y = x.clone();
            let choice = Exponential::new(n).apply(&u, structure, &mut y).expect("exp(u)x");
            match choice {
                ApplyChoice::Series { steps, products } => series |= steps > 0 && products > 3,
                _ => formed = true,
            }
            let (g, _) = exp(&u, structure).expect("exp(u)");
            let gap = norm(&(&y - &g * &x)) / (norm(&g) * norm(&x));
            assert!(gap <= 8.0 * EPS * size.max(1.0), "{n} {size} {choice:?}: {gap:e}");
        }
    }
    assert!(formed && series);
}

#[test]
fn an_action_on_no_columns_takes_no_time() {
    let u = Mat::from_fn(3, 3, |i, j| [[0.0, 1e9, 0.0], [-1e9, 0.0, 0.0], [0.0; 3]][i][j]);
    let mut x = Mat::zeros(3, 0);
    let choice = Exponential::new(3).apply(&u, Structure::General, &mut x).expect("nothing");
    assert_eq!(choice, ApplyChoice::Series { steps: 0, products: 0 });
}
