//! What the test suites share.
//!
//! A law or an order is a function that returns a [`Verdict`]: `core/laws.rs` and `orders/fields.rs` ask that it
//! holds, `mutations/faults.rs` asks that it fails on a method broken on purpose.
#![allow(dead_code, unused_imports, reason = "each suite uses its part")]

pub(crate) mod boxed;
pub(crate) mod laws;
pub(crate) mod named;
pub(crate) mod orders;
pub(crate) mod points;
pub(crate) mod references;
pub(crate) mod represent;
pub(crate) mod systems;
pub(crate) mod uncorrected;

use faer::Mat;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The rounding unit that tolerances are multiples of.
pub(crate) const EPS: f64 = f64::EPSILON;

/// Whether a claim held, and by how much it failed.
pub(crate) type Verdict = Result<(), String>;

/// `gap` ≤ `bound`; a gap that is not a number fails.
pub(crate) fn within(claim: &str, gap: f64, bound: f64) -> Verdict {
    match gap <= bound {
        true => Ok(()),
        false => Err(format!("{claim}: {gap:.3e}, expected at most {bound:.3e}")),
    }
}

/// Put `claim` to so many random cases, the same ones in every run. Each draws what it needs from a
/// generator of its own, whose seed a failure names.
pub(crate) fn holds(cases: u32, claim: impl Fn(&mut Pcg64) -> Verdict) -> Verdict {
    let mut seeds = Pcg64::seed_from_u64(0);
    (0..cases).try_for_each(|_| {
        let seed = seeds.random();
        claim(&mut Pcg64::seed_from_u64(seed)).map_err(|reason| format!("{reason} (seed {seed})"))
    })
}

/// A random size: log-uniform from 1e-12 in one half of the cases, of the order of `cap` in the
/// other, so that neither the series near 0 nor the far end of a domain is seen rarely.
pub(crate) fn size(rng: &mut Pcg64, cap: f64) -> f64 {
    match rng.random_bool(0.5) {
        true => 10f64.powf(rng.random_range(-12.0..cap.log10())),
        false => rng.random_range(0.1 * cap..cap),
    }
}

/// A matrix of independent standard Gaussians.
pub(crate) fn gaussian(rng: &mut Pcg64, rows: usize, cols: usize) -> Mat<f64> {
    Mat::from_fn(rows, cols, |_, _| rng.sample(rand_distr::StandardNormal))
}

/// The same numbers, bit for bit.
pub(crate) fn same_bits(a: &Mat<f64>, b: &Mat<f64>) -> bool {
    let bits = |x: &Mat<f64>| -> Vec<u64> {
        x.col_iter().flat_map(|c| c.iter().map(|x| x.to_bits()).collect::<Vec<_>>()).collect()
    };
    (a.nrows(), a.ncols()) == (b.nrows(), b.ncols()) && bits(a) == bits(b)
}

/// ‖a − b‖ (Frobenius).
pub(crate) fn gap(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    (a - b).norm_l2()
}

/// s·x.
pub(crate) fn scale(s: f64, x: &Mat<f64>) -> Mat<f64> {
    x * faer::Scale(s)
}
