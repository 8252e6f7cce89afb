//! The exponentials allocate nothing once their storage is made, whatever approximant they choose.

use faer::{Mat, c64};
use lieflow::LieAlgebra;
use lieflow::dense::{
    ComplexExponential, Exponential, ExponentialBatch, ExponentialF32, Structure,
};
use lieflow::groups::{MatrixGroup, Sample, Unitary};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// The allocations of the second call: the product library makes its packing buffer at the first.
fn allocations(mut f: impl FnMut() -> bool) -> usize {
    assert!(f());
    let before = crate::counting::total();
    assert!(f());
    crate::counting::total() - before
}

/// Skew, with a Frobenius norm of about `size`.
fn skew(n: usize, size: f64) -> Mat<f64> {
    let entry = |i: usize, j: usize| ((3 * i * j + 5 * i + 7 * j) % 11) as f64 - 5.0;
    let u = Mat::from_fn(n, n, |i, j| entry(i, j) - entry(j, i));
    let norm = u.norm_l2().max(1.0);
    u * faer::Scale(size / norm)
}

#[test]
fn no_exponential_allocates() {
    assert!(allocations(|| Mat::<f64>::zeros(2, 2).nrows() == 2) > 0, "the counter does not count");
    for n in [1, 2, 3, 6, 8, 16, 17, 40, 170] {
        for size in [1e-9, 1e-2, 0.2, 1.0, 3.0, 50.0] {
            let (u, mut g) = (skew(n, size), Mat::zeros(n, n));
            for structure in [Structure::Skew, Structure::General] {
                let (mut exp, mut pade) =
                    (Exponential::new(n), Exponential::new(n).insist_on_pade());
                assert_eq!(allocations(|| exp.exp(&u, structure, &mut g).is_ok()), 0, "{n} {size}");
                assert_eq!(
                    allocations(|| pade.exp(&u, structure, &mut g).is_ok()),
                    0,
                    "{n} {size}"
                );
                let z = Mat::from_fn(n, n, |i, j| c64::new(u[(i, j)], 0.0));
                let (mut exp, mut w) = (ComplexExponential::new(n), z.clone());
                assert_eq!(allocations(|| exp.exp(&z, structure, &mut w).is_ok()), 0, "{n} {size}");
                let x = Mat::from_fn(n, n, |i, j| u[(i, j)] as f32);
                let (mut exp, mut y) = (ExponentialF32::new(n), x.clone());
                assert_eq!(allocations(|| exp.exp(&x, structure, &mut y).is_ok()), 0, "{n} {size}");
                let many: Vec<f64> = (0..n * n).flat_map(|k| [u[(k % n, k / n)]; 5]).collect();
                let (mut exp, mut out) = (ExponentialBatch::new(n), many.clone());
                assert_eq!(allocations(|| exp.exp(&many, structure, &mut out).is_ok()), 0, "{n}");
            }
        }
    }
}

/// Row E21 of the hard cases: the storage is that of nine matrices, one of them for the solve alone,
/// with a tenth of one for each to pad its columns.
#[test]
fn storage_of_nine_matrices() {
    for n in [64usize, 256, 1000] {
        let before = crate::counting::bytes();
        let exponential = Exponential::new(n);
        let words = (crate::counting::bytes() - before) / size_of::<f64>();
        assert!(words <= 9 * n * n * 11 / 10, "{n}: {:.2} n²", words as f64 / (n * n) as f64);
        drop(exponential);
    }
}

/// A field that is a constant is written as `v.clone_from(&u)`.
#[test]
fn copies_of_matrices_allocate_nothing() {
    let mut rng = Pcg64::seed_from_u64(3);
    let so5 = MatrixGroup::so(5).expect("SO(5)");
    let (u, mut v) = (so5.sample_algebra(&mut rng, 1.0), so5.zero());
    assert_eq!(allocations(|| clone_into(&mut v, &u)), 0);
    let u3 = Unitary::new(3).expect("U(3)");
    let (u, mut v) = (u3.sample_algebra(&mut rng, 1.0), u3.zero());
    assert_eq!(allocations(|| clone_into(&mut v, &u)), 0);
}

fn clone_into<T: Clone + PartialEq>(v: &mut T, u: &T) -> bool {
    v.clone_from(u);
    v == u
}
