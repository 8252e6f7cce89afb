//! log of a matrix by its complex Schur form: inverse scaling and squaring on the triangle.

use faer::{Mat, c64};

use super::THETA;
use crate::dense::{Expm, Schur, Structure, norm1};
use crate::error::{Error, StepError};
use crate::quadrature::GAUSS_LEGENDRE7;

/// Square roots halve the logarithm; 1100 halvings take the range of doubles to rounding.
const ROOTS_MAX: u32 = 1100;

/// A computed logarithm whose exponential is this far from g, relative to g, has no digits.
pub(super) const NO_DIGITS: f64 = 1e-8;

/// Eigenvalues on the negative real axis: for them there is no principal logarithm.
pub(super) struct Negative {
    pub(super) eigenvalues: Vec<c64>,
    /// How far from the axis they may be by rounding.
    pub(super) margin: f64,
    /// True of one eigenvalue beside the axis: a computed logarithm is none of g. An eigenvalue and its conjugate are one
    /// there, up to rounding.
    pub(super) has_no_digits: bool,
}

/// The principal logarithm of a real g, if it has one.
pub(super) fn log(g: &Mat<f64>) -> Result<Result<Mat<f64>, Negative>, Error> {
    let n = g.nrows();
    let mut schur = Schur::new(n);
    (0..n).for_each(|j| (0..n).for_each(|i| schur.t[(i, j)] = c64::new(g[(i, j)], 0.0)));
    schur.factor().map_err(|_| StepError::NotConverged { what: "the Schur form of g" })?;
    let Schur { mut t, q, .. } = schur;
    let eigenvalues: Vec<c64> = (0..n).map(|i| t[(i, i)]).collect();
    let size = eigenvalues.iter().fold(0.0f64, |s, z| s.max(z.re.hypot(z.im)));
    // The Schur form is exact for a g moved by some ε‖g‖; an eigenvalue within that of the axis may
    // belong to either side.
    let margin = 4.0 * f64::EPSILON * n as f64 * size;
    let on_axis = |z: &&c64| z.re <= 0.0 && z.im.abs() <= margin;
    if eigenvalues.iter().any(|z| on_axis(&z)) {
        let eigenvalues = eigenvalues.iter().filter(on_axis).copied().collect();
        return Ok(Err(Negative { eigenvalues, margin, has_no_digits: false }));
    }
    let mut roots = 0;
    while distance_to_identity(&t) > THETA {
        if roots == ROOTS_MAX {
            return Err(StepError::NotConverged { what: "log(g)" }.into());
        }
        t = square_root(&t);
        roots += 1;
    }
    for i in 0..n {
        t[(i, i)].re -= 1.0;
    }
    let mut l = pade(&t);
    let scale = 2f64.powi(roots as i32);
    for j in 0..n {
        for i in 0..j {
            l[(i, j)] *= scale;
        }
        l[(j, j)] = eigenvalues[j].ln();
    }
    let full = &q * &l * q.adjoint();
    let u = Mat::from_fn(n, n, |i, j| full[(i, j)].re);
    if is_log(&u, g) {
        return Ok(Ok(u));
    }
    let nearest = eigenvalues.into_iter().max_by(|a, b| a.arg().abs().total_cmp(&b.arg().abs()));
    let eigenvalues = nearest.into_iter().collect();
    Ok(Err(Negative { eigenvalues, margin, has_no_digits: true }))
}

/// True if exp(u) is g, to [`NO_DIGITS`]. It is not where exp(u) has no value.
pub(super) fn is_log(u: &Mat<f64>, g: &Mat<f64>) -> bool {
    let mut found = g.clone();
    let done = Expm::new(g.nrows()).exp(u, Structure::General, &mut found);
    let far = found - g;
    done.is_ok() && norm1(far.as_ref()) <= NO_DIGITS * norm1(g.as_ref())
}

/// ‖t − 𝟙‖₁ for upper triangular t; NaN counts as near, and the result is checked for it.
fn distance_to_identity(t: &Mat<c64>) -> f64 {
    let one = c64::new(1.0, 0.0);
    (0..t.ncols()).fold(0.0, |norm: f64, j| {
        let size = |z: c64| z.re.hypot(z.im);
        norm.max((0..j).map(|i| size(t[(i, j)])).sum::<f64>() + size(t[(j, j)] - one))
    })
}

/// The principal square root of an upper triangular matrix (Björck, Hammarling).
fn square_root(t: &Mat<c64>) -> Mat<c64> {
    let n = t.nrows();
    let mut r = Mat::<c64>::zeros(n, n);
    for j in 0..n {
        r[(j, j)] = t[(j, j)].sqrt();
        for i in (0..j).rev() {
            let mut s = t[(i, j)];
            for k in i + 1..j {
                s -= r[(i, k)] * r[(k, j)];
            }
            r[(i, j)] = s / (r[(i, i)] + r[(j, j)]);
        }
    }
    r
}

/// log(𝟙 + x) ≈ Σ w_j x (𝟙 + t_j x)⁻¹ for upper triangular x.
fn pade(x: &Mat<c64>) -> Mat<c64> {
    let n = x.nrows();
    let one = c64::new(1.0, 0.0);
    let mut sum = Mat::<c64>::zeros(n, n);
    let mut y = Mat::<c64>::zeros(n, n);
    for (t, w) in GAUSS_LEGENDRE7 {
        for j in 0..n {
            for i in (0..=j).rev() {
                let mut s = x[(i, j)];
                for k in i + 1..=j {
                    s -= x[(i, k)] * y[(k, j)] * t;
                }
                y[(i, j)] = s / (one + x[(i, i)] * t);
                sum[(i, j)] += y[(i, j)] * w;
            }
        }
    }
    sum
}
