//! Laws of random elements: the distributions that [`Sample`](lieflow::groups::Sample) promises.

use faer::Mat;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::super::represent::Represent;
use super::{EPS, Verdict, within};

const SAMPLES: usize = 4000;
/// A mean of so many samples lies further out with a chance of 6e-7.
const SIGMAS: f64 = 5.0;

/// ‖u‖² of Gaussian coordinates in an orthonormal basis is σ²χ² with dim 𝔤 degrees of freedom: mean
/// dim·σ², variance 2·dim·σ⁴.
pub(crate) fn gaussian_algebra<G: Represent>(group: &G) -> Verdict {
    let mut rng = Pcg64::seed_from_u64(1);
    let (sigma, dim) = (0.7, group.dim() as f64);
    let mut squares = 0.0;
    for _ in 0..SAMPLES {
        squares += group.norm(&group.sample_algebra(&mut rng, sigma)).powi(2) / sigma.powi(2);
    }
    let mean = squares / SAMPLES as f64;
    let deviation = (2.0 * dim / SAMPLES as f64).sqrt();
    within("E‖u‖² = dim·σ², in standard deviations", (mean - dim).abs() / deviation, SIGMAS)
}

/// Entries of a Haar rotation have mean 0 and mean square 1/n; a product with a fixed rotation has
/// them too.
pub(crate) fn haar<G: Represent>(group: &G) -> Verdict {
    let mut rng = Pcg64::seed_from_u64(2);
    let n = group.element_matrix(&group.identity()).nrows();
    let (mut sum, mut squares) = (Mat::<f64>::zeros(n, n), Mat::<f64>::zeros(n, n));
    for _ in 0..SAMPLES {
        let g = group.element_matrix(&group.sample_element(&mut rng));
        within("det g = 1", (g.determinant() - 1.0).abs(), 64.0 * EPS)?;
        for j in 0..n {
            for i in 0..n {
                sum[(i, j)] += g[(i, j)];
                squares[(i, j)] += g[(i, j)].powi(2);
            }
        }
    }
    let (count, n) = (SAMPLES as f64, n as f64);
    // An entry has variance 1/n; its square has 3/(n(n+2)) − 1/n² (it is Beta(1/2, (n−1)/2)).
    let of_entry = (1.0 / n / count).sqrt();
    let of_square = ((3.0 / (n * (n + 2.0)) - 1.0 / (n * n)) / count).sqrt();
    let worst = |x: &Mat<f64>, mean: f64, deviation: f64| -> f64 {
        let x = x / faer::Scale(count);
        let shifted = Mat::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)] - mean);
        shifted.norm_max() / deviation
    };
    within("E g_ij = 0, in standard deviations", worst(&sum, 0.0, of_entry), SIGMAS)?;
    within("E g_ij² = 1/n, in standard deviations", worst(&squares, 1.0 / n, of_square), SIGMAS)
}
