//! ccsk on SO(n): Ψ(u) = ∏_c ∏_{r>c} exp(u_rc(e_r e_cᵀ − e_c e_rᵀ)).

use faer::Mat;

use crate::error::StepError;
use crate::scalar::{Ops, tally};

const GIMBAL: StepError =
    StepError::OutsideChart { map: "ccsk", what: "the cosine of a middle angle is nearly zero" };

/// Sines and cosines of the angles, and workspace.
#[derive(Debug)]
pub(super) struct SoN {
    sin: Mat<f64>,
    cos: Mat<f64>,
    w: Mat<f64>,
    /// Column r holds ρ^(r).
    rho: Mat<f64>,
}

impl SoN {
    pub(super) fn new(n: usize) -> Self {
        let z = || Mat::zeros(n, n);
        SoN { sin: z(), cos: z(), w: z(), rho: z() }
    }

    /// g ← ∏_c ∏_{r>c} G_rc(u_rc).
    pub(super) fn psi(&mut self, u: &Mat<f64>, g: &mut Mat<f64>) {
        let n = u.nrows();
        tally(|| (Ops::trigs(2) + ROTATED * n) * (n * n.saturating_sub(1) / 2));
        g.fill(0.0);
        g.diagonal_mut().fill(1.0);
        for c in 0..n {
            for r in c + 1..n {
                let angle = u[(r, c)];
                let (s, k) = angle.sin_cos();
                (self.sin[(r, c)], self.cos[(r, c)]) = (s, k);
                rotate_columns(g, r, c, s, k);
            }
        }
    }

    /// v ← dΨ_u⁻¹ v at the angles of the last [`psi`](Self::psi).
    ///
    /// Column c: W is carried into the frame after its rotations, where E_rc has become
    /// e_r ρᵀ − ρ e_rᵀ with ρ = ρ^(r) = (G_{r+1,c} … G_nc)ᵀ e_c; v_rc is read off column c and
    /// subtracted, which leaves the trailing block.
    pub(super) fn dpsi_inv(&mut self, v: &mut Mat<f64>, min_cos: f64) -> Result<(), StepError> {
        let n = v.nrows();
        let SoN { sin, cos, w, rho, .. } = self;
        w.copy_from(&*v);
        for c in 0..n {
            // Both sides of each rotation, ρ^(r), a quotient, and what is subtracted.
            let (angles, rest) = (n - c - 1, n - c);
            let carried = Ops::muls(rest) + Ops::adds(1);
            tally(|| {
                (ROTATED * (2 * n) + carried + Ops::divs(1) + Ops::muladds(2 * rest)) * angles
            });
            for r in c + 1..n {
                rotate_rows_and_columns(w, r, c, sin[(r, c)], cos[(r, c)]);
            }
            for i in c..n {
                rho[(i, c)] = if i == c { 1.0 } else { 0.0 };
            }
            // ρ^(r) for r = n … c+1, kept in columns; column c holds the running vector.
            for r in (c + 1..n).rev() {
                for i in c..n {
                    rho[(i, r)] = rho[(i, c)];
                    rho[(i, c)] *= cos[(r, c)];
                }
                rho[(r, c)] -= sin[(r, c)];
            }
            for r in c + 1..n {
                let lead = rho[(c, r)];
                if lead.abs() < min_cos || lead == 0.0 {
                    return Err(GIMBAL);
                }
                let x = w[(r, c)] / lead;
                (v[(r, c)], v[(c, r)]) = (x, -x);
            }
            for r in c + 1..n {
                let x = v[(r, c)];
                for i in c..n {
                    w[(r, i)] -= x * rho[(i, r)];
                    w[(i, r)] += x * rho[(i, r)];
                }
            }
        }
        for i in 0..n {
            v[(i, i)] = 0.0;
        }
        Ok(())
    }
}

/// A pair of numbers turned: four products, two sums.
const ROTATED: Ops = Ops { add: 2, mul: 4, ..Ops::NONE };

/// g ← g·G with G = exp(θ(e_r e_cᵀ − e_c e_rᵀ)).
fn rotate_columns(g: &mut Mat<f64>, r: usize, c: usize, sin: f64, cos: f64) {
    for i in 0..g.nrows() {
        let (x, y) = (g[(i, c)], g[(i, r)]);
        g[(i, c)] = cos * x + sin * y;
        g[(i, r)] = cos * y - sin * x;
    }
}

/// w ← Gᵀ·w·G.
fn rotate_rows_and_columns(w: &mut Mat<f64>, r: usize, c: usize, sin: f64, cos: f64) {
    rotate_columns(w, r, c, sin, cos);
    for j in 0..w.ncols() {
        let (x, y) = (w[(c, j)], w[(r, j)]);
        w[(c, j)] = cos * x + sin * y;
        w[(r, j)] = cos * y - sin * x;
    }
}
