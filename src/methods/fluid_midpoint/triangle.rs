//! Passes over the lower triangle of a skew-Hermitian matrix, with its diagonal.

use faer::Mat;

use crate::dense::wide;
use crate::groups::ComplexMatrix;
use crate::scalar::{Ops, tally};

/// The number of entries processed at once.
const LANES: usize = 8;

/// Column j of x on and below the diagonal.
#[inline(always)]
pub(super) fn below(x: &Mat<f64>, j: usize) -> &[f64] {
    &x.col_as_slice(j)[j..]
}
/// Column j of x on and below the diagonal.
#[inline(always)]
pub(super) fn below_mut(x: &mut Mat<f64>, j: usize) -> &mut [f64] {
    &mut x.col_as_slice_mut(j)[j..]
}

/// The numbers on and below the diagonal, of both parts.
pub(super) fn entries(x: &ComplexMatrix) -> usize {
    x.ncols() * (x.ncols() + 1)
}

/// Σ x_i².
#[inline(always)]
pub(super) fn squares(x: &[f64]) -> f64 {
    let (chunks, rest) = x.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for chunk in chunks {
        for l in 0..LANES {
            sums[l] += chunk[l] * chunk[l];
        }
    }
    sums.iter().sum::<f64>() + rest.iter().map(|x| x * x).sum::<f64>()
}

/// The norm of the triangle: Frobenius, each pair of entries counted once.
pub(super) fn norm(x: &ComplexMatrix) -> f64 {
    tally(|| Ops::dots(1, entries(x)) + Ops::sqrts(1));
    wide(x.nrows(), || {
        let part = |x: &Mat<f64>| (0..x.ncols()).map(|j| squares(below(x, j))).sum::<f64>();
        (part(&x.re) + part(&x.im)).sqrt()
    })
}

/// out ← x + a·y on the triangle.
pub(super) fn sum(out: &mut ComplexMatrix, x: &ComplexMatrix, a: f64, y: &ComplexMatrix) {
    tally(|| Ops::adds(entries(x)) + Ops::muls(if a.abs() == 1.0 { 0 } else { entries(x) }));
    wide(out.nrows(), || {
        for (out, (x, y)) in out.parts_mut().into_iter().zip(x.parts().into_iter().zip(y.parts())) {
            for j in 0..x.ncols() {
                let terms = below(x, j).iter().zip(below(y, j));
                below_mut(out, j).iter_mut().zip(terms).for_each(|(o, (x, y))| *o = x + a * y);
            }
        }
    });
}

/// d ← x + y on the triangle; returns the norm of the change of d.
pub(super) fn replace(d: &mut ComplexMatrix, x: &ComplexMatrix, y: &ComplexMatrix) -> f64 {
    tally(|| (Ops::adds(2) + Ops::muladds(1)) * entries(d) + Ops::sqrts(1));
    wide(d.nrows(), || {
        let mut total = 0.0;
        for (d, (x, y)) in d.parts_mut().into_iter().zip(x.parts().into_iter().zip(y.parts())) {
            for j in 0..x.ncols() {
                let (d, x, y) = (below_mut(d, j), below(x, j), below(y, j));
                let whole = d.len() - d.len() % LANES;
                let mut sums = [0.0; LANES];
                let mut at = 0;
                while at < whole {
                    for l in 0..LANES {
                        let new = x[at + l] + y[at + l];
                        let change = new - d[at + l];
                        sums[l] += change * change;
                        d[at + l] = new;
                    }
                    at += LANES;
                }
                for i in whole..d.len() {
                    let new = x[i] + y[i];
                    total += (new - d[i]) * (new - d[i]);
                    d[i] = new;
                }
                total += sums.iter().sum::<f64>();
            }
        }
        total.sqrt()
    })
}

/// out ← g + sign·gᵀ on the triangle, tile by tile.
pub(super) fn with_transpose(out: &mut Mat<f64>, g: &Mat<f64>, sign: f64) {
    let n = g.nrows();
    tally(|| Ops::adds(n * (n + 1) / 2));
    wide(n, || {
        for left in (0..n).step_by(LANES) {
            let width = LANES.min(n - left);
            for top in (left..n).step_by(LANES) {
                let height = LANES.min(n - top);
                let mut tile = [[0.0; LANES]; LANES];
                for i in 0..height {
                    let row = &g.col_as_slice(top + i)[left..];
                    match row.first_chunk() {
                        Some(whole) => tile[i] = *whole,
                        None => tile[i][..width].copy_from_slice(&row[..width]),
                    }
                }
                for j in 0..width {
                    let from = &g.col_as_slice(left + j)[top..top + height];
                    let to = &mut out.col_as_slice_mut(left + j)[top..top + height];
                    for i in 0..height {
                        to[i] = from[i] + sign * tile[i][j];
                    }
                }
            }
        }
    });
}
