//! g back to G_M: Newton–Schulz in residual form.
//!
//! g ← g + g(𝟙 − M⁻¹gᵀMg)/2, quadratic where M is symmetric or skew; elsewhere each step halves what
//! the other part of M sees. The residual form adds a small correction to g instead of forming
//! g(3·𝟙 − M⁻¹gᵀMg)/2: it rounds the correction, not g.

use faer::Mat;

use super::{Form, GroupMatrix, MatrixGroup};
use crate::dense::{axpy, mul, norm_frobenius, scaled_sum};
use crate::groups::RESIDUAL_MAX;

/// No more steps than these.
const STEPS_MAX: usize = 6;
/// One step takes a residual below this to rounding where M is symmetric or skew.
const ONE_STEP: f64 = 1e-8;

impl MatrixGroup {
    /// [`LieGroup::correct`](crate::LieGroup::correct).
    pub(super) fn newton_schulz(&self, g: &mut GroupMatrix, [a, b]: [&mut GroupMatrix; 2]) -> f64 {
        let mut first = None;
        for _ in 0..STEPS_MAX {
            self.half_residual(g, a, b);
            let residual = 2.0 * norm_frobenius(a);
            first.get_or_insert(residual);
            let noise = f64::EPSILON * norm_frobenius(g).powi(2);
            if !(residual > noise && residual < RESIDUAL_MAX) {
                break;
            }
            mul(b, g.as_ref(), a.as_ref());
            axpy(1.0, b, g);
            if residual < ONE_STEP && self.is_quadratic() {
                break;
            }
        }
        first.unwrap_or(0.0)
    }

    /// Is M symmetric or skew?
    fn is_quadratic(&self) -> bool {
        let Form::Bilinear { m, .. } = &self.form else { return true };
        let n = self.n;
        let all = |sign: f64| (0..n).all(|j| (0..=j).all(|i| m[(i, j)] == sign * m[(j, i)]));
        all(1.0) || all(-1.0)
    }

    /// a ← (𝟙 − M⁻¹gᵀMg)/2, b scratch.
    fn half_residual(&self, g: &Mat<f64>, a: &mut Mat<f64>, b: &mut Mat<f64>) {
        match &self.form {
            Form::Free => {
                a.fill(0.0);
                return;
            }
            Form::Identity => mul(b, g.transpose(), g.as_ref()),
            Form::Symplectic => {
                times_j(g, 1.0, a);
                mul(b, g.transpose(), a.as_ref());
                times_j(b, -1.0, a);
                b.copy_from(&*a);
            }
            Form::Bilinear { m, inverse } => {
                mul(a, m.as_ref(), g.as_ref());
                mul(b, g.transpose(), a.as_ref());
                mul(a, inverse.as_ref(), b.as_ref());
                b.copy_from(&*a);
            }
        }
        scaled_sum(a, [-0.5], [b], 0.5);
    }
}

/// out ← ±J·x.
fn times_j(x: &Mat<f64>, sign: f64, out: &mut Mat<f64>) {
    let m = x.nrows() / 2;
    for j in 0..x.ncols() {
        for i in 0..m {
            out[(i, j)] = sign * x[(i + m, j)];
            out[(i + m, j)] = -sign * x[(i, j)];
        }
    }
}
