//! log on SO(n) by the real Schur form, which is block diagonal for a normal matrix.

use faer::Mat;

use super::schur;
use crate::dense::{mul, scaled_sum};
use crate::error::Error;

/// The skew logarithm of an orthogonal g.
pub(super) fn log(g: &Mat<f64>) -> Result<Mat<f64>, Error> {
    let n = g.nrows();
    let (form, q) = schur::real(g)?;
    let (t, q) = polished(g, &form, q);
    let mut u = Mat::zeros(n, n);
    // u += θ (q_b q_aᵀ − q_a q_bᵀ): the turn from q_a to q_b by θ.
    let mut turn = |a: usize, b: usize, theta: f64| {
        for j in 0..n {
            for i in 0..n {
                u[(i, j)] += theta * (q[(i, b)] * q[(j, a)] - q[(i, a)] * q[(j, b)]);
            }
        }
    };
    let mut half_turn: Option<usize> = None;
    let mut k = 0;
    while k < n {
        if k + 1 < n && t[(k + 1, k)] != 0.0 {
            let sin = 0.5 * (t[(k + 1, k)] - t[(k, k + 1)]);
            let cos = 0.5 * (t[(k, k)] + t[(k + 1, k + 1)]);
            turn(k, k + 1, sin.atan2(cos));
            k += 2;
            continue;
        }
        if t[(k, k)] < 0.0 {
            half_turn = match half_turn.take() {
                Some(first) => {
                    turn(first, k, core::f64::consts::PI);
                    None
                }
                None => Some(k),
            };
        }
        k += 1;
    }
    match half_turn {
        Some(_) => Err(Error::Reflection { arg: "g" }),
        None => Ok(u),
    }
}

/// (qᵀgq, q) with q orthogonal to rounding: the iteration leaves it some 10ε off. One Newton–Schulz
/// step, and the blocks of `form` where it had them.
fn polished(g: &Mat<f64>, form: &Mat<f64>, mut q: Mat<f64>) -> (Mat<f64>, Mat<f64>) {
    let n = g.nrows();
    let [mut a, mut b] = [(); 2].map(|()| Mat::zeros(n, n));
    mul(&mut a, q.transpose(), q.as_ref());
    scaled_sum(&mut b, [-0.5], [&a], 1.5);
    mul(&mut a, q.as_ref(), b.as_ref());
    core::mem::swap(&mut a, &mut q);
    mul(&mut a, g.as_ref(), q.as_ref());
    mul(&mut b, q.transpose(), a.as_ref());
    for k in 1..n {
        if form[(k, k - 1)] == 0.0 {
            b[(k, k - 1)] = 0.0;
        }
    }
    (b, q)
}
