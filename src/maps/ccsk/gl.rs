//! ccsk on GL(n): Ψ(u) = (𝟙 + U₊)·D·(𝟙 + U₋), D = diag(e^{u_ii}), U₊ and U₋ the strict upper and
//! lower triangle of u.
//!
//! With X = (𝟙 + U₊)⁻¹ w (𝟙 + U₊): dΨ_u⁻¹ w = (𝟙 + U₊)·X₊ + diag X + (D⁻¹ X₋ D)(𝟙 + U₋), since
//! δΨ·Ψ⁻¹ = δU₊ (𝟙 + U₊)⁻¹ + (𝟙 + U₊)(δD·D⁻¹ + D δU₋ (𝟙 + U₋)⁻¹ D⁻¹)(𝟙 + U₊)⁻¹.
//!
//! The reversed ordering is (𝟙 − U₋)⁻¹·D·(𝟙 − U₊)⁻¹. With X = (𝟙 − U₋) w (𝟙 − U₋)⁻¹ its dΨ_u⁻¹ w is
//! X₋·(𝟙 − U₋) + diag X + (𝟙 − U₊)(D⁻¹ X₊ D).

use faer::Mat;

use crate::scalar::{Ops, tally};

/// Workspace.
#[derive(Debug)]
pub(super) struct Gl {
    upper: Mat<f64>,
    lower: Mat<f64>,
}

impl Gl {
    pub(super) fn new(n: usize) -> Self {
        Gl { upper: Mat::zeros(n, n), lower: Mat::zeros(n, n) }
    }

    /// g ← Ψ(u).
    pub(super) fn psi(&mut self, u: &Mat<f64>, g: &mut Mat<f64>) {
        let n = u.nrows();
        tally(|| Ops::trigs(n) + Ops::muls(pairs(n)));
        for j in 0..n {
            for i in 0..n {
                let d = u[(i, i)].exp();
                g[(i, j)] = if i == j {
                    d
                } else if i > j {
                    d * u[(i, j)]
                } else {
                    0.0
                };
            }
        }
        upper_times(u, g);
    }

    /// v ← dΨ_u⁻¹ v.
    pub(super) fn dpsi_inv(&mut self, u: &Mat<f64>, v: &mut Mat<f64>) {
        upper_solve(u, v);
        times_upper(v, u);
        self.split(v, |i, j| if i > j { (u[(j, j)] - u[(i, i)]).exp() } else { 1.0 });
        self.joined(u, v);
    }

    /// v ← dΨ_u⁻¹ v of the reversed ordering, m = −u.
    pub(super) fn dpsi_inv_reversed(&mut self, m: &Mat<f64>, v: &mut Mat<f64>) {
        lower_times(m, v);
        times_lower_inverse(v, m);
        self.split(v, |i, j| if i < j { (m[(i, i)] - m[(j, j)]).exp() } else { 1.0 });
        self.joined(m, v);
    }

    /// The strict triangles of v times these factors.
    fn split(&mut self, v: &Mat<f64>, factor: impl Fn(usize, usize) -> f64) {
        let (Gl { upper, lower }, n) = (self, v.nrows());
        tally(|| (Ops::muls(1) + Ops::adds(1) + Ops::trigs(1)) * pairs(n));
        for j in 0..n {
            for i in 0..n {
                upper[(i, j)] = if i < j { v[(i, j)] * factor(i, j) } else { 0.0 };
                lower[(i, j)] = if i > j { v[(i, j)] * factor(i, j) } else { 0.0 };
            }
        }
    }

    /// The triangles of v ← (𝟙 + U₊)·upper and lower·(𝟙 + U₋).
    fn joined(&mut self, u: &Mat<f64>, v: &mut Mat<f64>) {
        let (Gl { upper, lower }, n) = (self, u.nrows());
        upper_times(u, upper);
        times_lower(lower, u);
        for j in 0..n {
            for i in 0..n {
                if i != j {
                    v[(i, j)] = if i < j { upper[(i, j)] } else { lower[(i, j)] };
                }
            }
        }
    }
}

/// g ← Ψ(u)⁻¹ = (𝟙 + U₋)⁻¹ D⁻¹ (𝟙 + U₊)⁻¹.
pub(super) fn inverse(u: &Mat<f64>, g: &mut Mat<f64>) {
    let n = u.nrows();
    g.fill(0.0);
    g.diagonal_mut().fill(1.0);
    upper_solve(u, g);
    tally(|| Ops::trigs(n) + Ops::muls(n * n) + Ops::muladds(n * pairs(n)));
    for j in 0..n {
        for i in 0..n {
            g[(i, j)] *= (-u[(i, i)]).exp();
        }
    }
    // x ← (𝟙 + U₋)⁻¹ x
    for j in 0..n {
        let x = g.col_as_slice_mut(j);
        for k in 0..n {
            for i in k + 1..n {
                x[i] -= u[(i, k)] * x[k];
            }
        }
    }
}

/// n(n − 1)/2.
fn pairs(n: usize) -> usize {
    n * n.saturating_sub(1) / 2
}

/// x ← (𝟙 + U₊)·x.
fn upper_times(u: &Mat<f64>, x: &mut Mat<f64>) {
    let n = u.nrows();
    tally(|| Ops::muladds(n * pairs(n)));
    for j in 0..n {
        let x = x.col_as_slice_mut(j);
        for k in 1..n {
            for i in 0..k {
                x[i] += u[(i, k)] * x[k];
            }
        }
    }
}

/// x ← (𝟙 + U₋)·x.
fn lower_times(u: &Mat<f64>, x: &mut Mat<f64>) {
    let n = u.nrows();
    tally(|| Ops::muladds(n * pairs(n)));
    for j in 0..n {
        let x = x.col_as_slice_mut(j);
        for k in (0..n).rev() {
            for i in k + 1..n {
                x[i] += u[(i, k)] * x[k];
            }
        }
    }
}

/// x ← (𝟙 + U₊)⁻¹·x.
fn upper_solve(u: &Mat<f64>, x: &mut Mat<f64>) {
    let n = u.nrows();
    tally(|| Ops::muladds(n * pairs(n)));
    for j in 0..n {
        let x = x.col_as_slice_mut(j);
        for k in (1..n).rev() {
            for i in 0..k {
                x[i] -= u[(i, k)] * x[k];
            }
        }
    }
}

/// x ← x·(𝟙 + U₊).
fn times_upper(x: &mut Mat<f64>, u: &Mat<f64>) {
    let n = u.nrows();
    tally(|| Ops::muladds(n * pairs(n)));
    for j in (1..n).rev() {
        for k in 0..j {
            for i in 0..n {
                x[(i, j)] += x[(i, k)] * u[(k, j)];
            }
        }
    }
}

/// x ← x·(𝟙 + U₋)⁻¹.
fn times_lower_inverse(x: &mut Mat<f64>, u: &Mat<f64>) {
    let n = u.nrows();
    tally(|| Ops::muladds(n * pairs(n)));
    for j in (0..n).rev() {
        for k in j + 1..n {
            for i in 0..n {
                x[(i, j)] -= x[(i, k)] * u[(k, j)];
            }
        }
    }
}

/// x ← x·(𝟙 + U₋).
fn times_lower(x: &mut Mat<f64>, u: &Mat<f64>) {
    let n = u.nrows();
    tally(|| Ops::muladds(n * pairs(n)));
    for j in 0..n {
        for k in j + 1..n {
            for i in 0..n {
                x[(i, j)] += x[(i, k)] * u[(k, j)];
            }
        }
    }
}
