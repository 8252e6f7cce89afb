//! log on U(n) and SU(n) by the complex Schur form, which is diagonal: g = Q diag(e^{iθ}) Q†.

use core::f64::consts::TAU;

use faer::{Mat, c64};

use crate::dense::{Schur, blocks_of_complex, complex_of_blocks};
use crate::error::Error;

/// The logarithm Q diag(iθ) Q† of g = \[X −Y; Y X\], with θ in (−π, π\]. On SU(n) the angles have the sum 0: where it is
/// 2πk, the k largest ones are a turn smaller, or the smallest ones a turn larger for k < 0.
pub(super) fn log(g: &Mat<f64>, is_special: bool) -> Result<Mat<f64>, Error> {
    let n = g.nrows() / 2;
    let mut schur = Schur::new(n);
    complex_of_blocks(g, &mut schur.t);
    schur.factor()?;
    let Schur { t, q, .. } = &schur;
    let mut angles: Vec<(f64, usize)> = (0..n).map(|k| (t[(k, k)].arg(), k)).collect();
    if is_special {
        let turns = (angles.iter().map(|(angle, _)| angle).sum::<f64>() / TAU).round();
        angles.sort_by(|a, b| (turns * b.0).total_cmp(&(turns * a.0)));
        for (angle, _) in angles.iter_mut().take(turns.abs() as usize) {
            *angle -= TAU.copysign(turns);
        }
    }
    let mut u = Mat::<c64>::zeros(n, n);
    for (angle, k) in angles {
        for j in 0..n {
            for i in 0..n {
                u[(i, j)] += q[(i, k)] * q[(j, k)].conj() * c64::new(0.0, angle);
            }
        }
    }
    let mut real = Mat::zeros(2 * n, 2 * n);
    blocks_of_complex(&u, &mut real);
    Ok(real)
}
