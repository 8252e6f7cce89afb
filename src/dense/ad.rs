//! Exact functions of ad_u for any matrix algebra: exp(ad_u), dexp_u and dexp_u⁻¹ in Schur
//! coordinates.
//!
//! | algebra | coordinates of v | ad_u | eigenvalues of ad_u |
//! |---|---|---|---|
//! | gl(n) | Y = Q*vQΠ, u = QTQ*, Π the reversal of columns | AY + YBᵀ, A = T, B = −(ΠTΠ)ᵀ | λ_j − λ_k |
//! | uᵀM + Mu = 0, Mᵀ = M | Y = Q*MvQ̄ skew, −uᵀ = QTQ* | TY + YTᵀ | λ_j + λ_k, j < k |
//! | uᵀM + Mu = 0, Mᵀ = −M | Y = Q*MvQ̄ symmetric | TY + YTᵀ | λ_j + λ_k, j ≤ k |
//!
//! With a form M the eigenvalues are only those on 𝔤. Example: 2λ_j = 2πik is singular on gl(n), but not on SO(p,q). A
//! and B are upper triangular, and the real parts of their diagonals descend. So e^A and e^B are graded by rows, and
//! each substitution below divides by the largest coefficient of its row. No digit is lost if the real parts differ much.
//!
//! dexp_u = dexp_{u/2} ∘ ½(1 + exp(ad_{u/2})). A short series gives the result at u/2^s. Then s steps lead to u. Each is
//! Y ← ½(Y + FYGᵀ) or, for the inverse, the solution of ½(Y + FYGᵀ) = Y, with F = e^{A/2^j}, G = e^{B/2^j}, j = s … 1.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, c64};

use super::product::mul;
use super::schur::{ONE, Schur, ZERO};
use crate::error::StepError;
use crate::scalar::{Ops, tally};

/// The error that a coefficient of the substitution is zero within the given bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NearlySingular;

/// The degree of the Taylor polynomial of exp for norm ≤ 1: 1/19! is below rounding.
const TAYLOR: usize = 18;

/// The condition on the elements of the algebra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AdKind {
    /// None: gl(n).
    General,
    /// Mv is skew: M symmetric.
    Skew,
    /// Mv is symmetric: M skew.
    Symmetric,
}

/// A form M with its inverse; none for gl(n).
#[derive(Clone, Debug)]
pub(crate) struct AdForm {
    pub(crate) kind: AdKind,
    pub(crate) m: Mat<f64>,
    pub(crate) inverse: Mat<f64>,
}

/// Workspace for functions of ad_u: 12 matrices.
#[derive(Debug)]
pub(crate) struct AdSchur {
    form: Option<AdForm>,
    schur: Schur,
    a: Mat<c64>,
    b: Mat<c64>,
    f: Mat<c64>,
    g: Mat<c64>,
    y: Mat<c64>,
    x: Mat<c64>,
    real: Mat<f64>,
}

impl AdSchur {
    pub(crate) fn new(n: usize, form: Option<AdForm>) -> Self {
        let z = || Mat::zeros(n, n);
        AdSchur {
            form,
            schur: Schur::new(n),
            a: z(),
            b: z(),
            f: z(),
            g: z(),
            y: z(),
            x: z(),
            real: Mat::zeros(n, n),
        }
    }

    fn kind(&self) -> AdKind {
        self.form.as_ref().map_or(AdKind::General, |form| form.kind)
    }

    /// The Schur form for u: A and B.
    pub(crate) fn factor(&mut self, u: &Mat<f64>) -> Result<(), StepError> {
        let n = u.nrows();
        let general = self.form.is_none();
        let AdSchur { schur, a, b, .. } = self;
        for j in 0..n {
            for i in 0..n {
                let x = if general { u[(i, j)] } else { -u[(j, i)] };
                schur.t[(i, j)] = c64::new(x, 0.0);
            }
        }
        schur.factor()?;
        a.copy_from(&schur.t);
        for j in 0..n {
            for i in 0..n {
                b[(i, j)] = match general {
                    true => -schur.t[(n - 1 - j, n - 1 - i)],
                    false => schur.t[(i, j)],
                };
            }
        }
        Ok(())
    }

    /// Y ← the coordinates of v.
    fn load(&mut self, v: &Mat<f64>) {
        let AdSchur { form, schur, x, y, f, real, .. } = self;
        let n = v.nrows();
        let source = match form {
            Some(form) => {
                mul(real, form.m.as_ref(), v.as_ref());
                &*real
            }
            None => v,
        };
        for j in 0..n {
            for i in 0..n {
                f[(i, j)] = c64::new(source[(i, j)], 0.0);
            }
        }
        let q = &schur.q;
        tally(|| Ops::dots(4 * n * n, 2 * n));
        matmul(x.as_mut(), Accum::Replace, q.adjoint(), f.as_ref(), ONE, Par::Seq);
        match form {
            Some(_) => matmul(y.as_mut(), Accum::Replace, x.as_ref(), q.conjugate(), ONE, Par::Seq),
            None => {
                matmul(y.as_mut(), Accum::Replace, x.as_ref(), q.as_ref(), ONE, Par::Seq);
                reverse_columns(y);
            }
        }
    }

    /// v ← the element with the coordinates Y.
    fn store(&mut self, v: &mut Mat<f64>) {
        let AdSchur { form, schur, x, y, f, real, .. } = self;
        let n = v.nrows();
        let q = &schur.q;
        if form.is_none() {
            reverse_columns(y);
        }
        tally(|| Ops::dots(4 * n * n, 2 * n));
        matmul(x.as_mut(), Accum::Replace, q.as_ref(), y.as_ref(), ONE, Par::Seq);
        match form {
            Some(_) => matmul(f.as_mut(), Accum::Replace, x.as_ref(), q.transpose(), ONE, Par::Seq),
            None => matmul(f.as_mut(), Accum::Replace, x.as_ref(), q.adjoint(), ONE, Par::Seq),
        }
        for j in 0..n {
            for i in 0..n {
                real[(i, j)] = match form.as_ref().map_or(AdKind::General, |form| form.kind) {
                    AdKind::General => f[(i, j)].re,
                    AdKind::Skew => 0.5 * (f[(i, j)].re - f[(j, i)].re),
                    AdKind::Symmetric => 0.5 * (f[(i, j)].re + f[(j, i)].re),
                };
            }
        }
        match form {
            Some(form) => mul(v, form.inverse.as_ref(), real.as_ref()),
            None => v.copy_from(&*real),
        }
    }

    /// v ← ∏_{j ≤ halvings} [½(1 + exp(ad_u/2^j))]^(∓1) v; with −1 dexp_u⁻¹ is this times its value
    /// at u/2^halvings, and with +1 dexp_u. `singular` is the size of 1 + e^z, relative to the size
    /// of u, at which it counts as zero. Call [`factor`](Self::factor) first.
    pub(crate) fn halvings(
        &mut self,
        halvings: u32,
        direction: Direction,
        singular: f64,
        v: &mut Mat<f64>,
    ) -> Result<(), NearlySingular> {
        self.load(v);
        let n = v.nrows();
        // gl(n): ad does not see a multiple of 𝟙, and e^A stays in range longer around zero.
        let middle = match self.kind() {
            AdKind::General => 0.5 * (self.a[(0, 0)].re + self.a[(n - 1, n - 1)].re),
            _ => 0.0,
        };
        let scale = 0.5f64.powi(halvings as i32);
        let AdSchur { a, b, f, x, .. } = self;
        exp_triangular(a, -middle, scale, f, x);
        let same = self.form.is_some();
        if !same {
            exp_triangular(b, middle, scale, &mut self.g, &mut self.x);
        }
        for j in (1..=halvings).rev() {
            let scale = 0.5f64.powi(j as i32);
            if j < halvings {
                square(&mut self.f, &mut self.x, &self.a, -middle, scale);
                if !same {
                    square(&mut self.g, &mut self.x, &self.b, middle, scale);
                }
            }
            if same {
                self.g.copy_from(&self.f);
            }
            match direction {
                Direction::Inverse => self.solve(2.0, singular)?,
                Direction::Forward => self.average(),
            }
        }
        self.store(v);
        Ok(())
    }

    /// v ← the solution x of x − uxu/12 = v. Call [`factor`](Self::factor) first.
    pub(crate) fn solve_pade22(
        &mut self,
        singular: f64,
        v: &mut Mat<f64>,
    ) -> Result<(), NearlySingular> {
        self.load(v);
        let scale = 1.0 / 12f64.sqrt();
        for (to, from) in [(&mut self.f, &self.a), (&mut self.g, &self.b)] {
            for j in 0..v.ncols() {
                for (to, from) in to.col_as_slice_mut(j).iter_mut().zip(from.col_as_slice(j)) {
                    *to = from * scale;
                }
            }
        }
        self.solve(1.0, singular)?;
        self.store(v);
        Ok(())
    }

    /// Y ← the solution X of X + FXGᵀ = weight·Y, column by column from the last.
    fn solve(&mut self, weight: f64, singular: f64) -> Result<(), NearlySingular> {
        let kind = self.kind();
        let AdSchur { f, g, y, x, .. } = self;
        let n = y.nrows();
        let w = x.col_as_slice_mut(0);
        // For column k: the sum w, the weight, F w, and the substitution with its pivots.
        let half = n * n.saturating_sub(1) / 2;
        tally(|| Ops::complex_muladds(n * half + n * (n + half) + n * half));
        tally(|| (Ops::muls(2) + Ops::muladds(8) + Ops::divs(2)) * (n * n));
        for k in (0..n).rev() {
            // w = Σ_{m>k} X_m g_km; what is left of the right-hand side is weight·Y_k − F w.
            w.fill(ZERO);
            for m in k + 1..n {
                let c = g[(k, m)];
                for (w, y) in w.iter_mut().zip(y.col_as_slice(m)) {
                    *w += c * y;
                }
            }
            let col = y.col_as_slice_mut(k);
            col.iter_mut().for_each(|y| *y *= weight);
            for l in 0..n {
                let f = f.col_as_slice(l);
                for i in 0..=l {
                    col[i] -= f[i] * w[l];
                }
            }
            for i in (0..n).rev() {
                let value = match kind {
                    AdKind::Skew if i > k => -y[(k, i)],
                    AdKind::Symmetric if i > k => y[(k, i)],
                    AdKind::Skew if i == k => ZERO,
                    _ => {
                        let pivot = ONE + f[(i, i)] * g[(k, k)];
                        if pivot.norm() <= singular {
                            return Err(NearlySingular);
                        }
                        y[(i, k)] / pivot
                    }
                };
                y[(i, k)] = value;
                let c = g[(k, k)] * value;
                let (f, col) = (f.col_as_slice(i), y.col_as_slice_mut(k));
                for l in 0..i {
                    col[l] -= c * f[l];
                }
            }
        }
        Ok(())
    }

    /// Y ← ½(Y + FYGᵀ).
    fn average(&mut self) {
        let AdSchur { f, g, y, x, .. } = self;
        let n = y.nrows();
        tally(|| Ops::dots(4 * n * n, 2 * n) + (Ops::muls(4) + Ops::adds(2)) * (n * n));
        let half = c64::new(0.5, 0.0);
        matmul(x.as_mut(), Accum::Replace, f.as_ref(), y.as_ref(), half, Par::Seq);
        for j in 0..y.ncols() {
            y.col_as_slice_mut(j).iter_mut().for_each(|y| *y *= 0.5);
        }
        matmul(y.as_mut(), Accum::Add, x.as_ref(), g.transpose(), ONE, Par::Seq);
    }

    /// The smallest distance of an eigenvalue of ad_u on 𝔤 to 2πik, k ≠ 0.
    pub(crate) fn distance_to_singular(&self) -> f64 {
        let n = self.a.nrows();
        let mut best = f64::INFINITY;
        for i in 0..n {
            let from = match self.kind() {
                AdKind::General => 0,
                AdKind::Skew => i + 1,
                AdKind::Symmetric => i,
            };
            for k in from..n {
                let z = self.a[(i, i)] + self.b[(k, k)];
                let turn = core::f64::consts::TAU;
                let nearest = turn * (z.im.abs() / turn).round().max(1.0);
                best = best.min(z.re.hypot(z.im.abs() - nearest));
            }
        }
        best
    }
}

/// dexp or its inverse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// dexp.
    Forward,
    /// dexp⁻¹.
    Inverse,
}

fn reverse_columns(y: &mut Mat<c64>) {
    let n = y.ncols();
    for j in 0..n / 2 {
        for i in 0..y.nrows() {
            let (a, b) = (y[(i, j)], y[(i, n - 1 - j)]);
            (y[(i, j)], y[(i, n - 1 - j)]) = (b, a);
        }
    }
}

/// out ← exp(scale·(t + shift)) for upper triangular t, ‖scale·t‖ ≤ 1: Horner's scheme.
fn exp_triangular(t: &Mat<c64>, shift: f64, scale: f64, out: &mut Mat<c64>, x: &mut Mat<c64>) {
    let n = t.nrows();
    out.fill(ZERO);
    out.diagonal_mut().fill(ONE);
    tally(|| (Ops::complex_muladds(triangle(n)) + Ops::muladds(n * (n + 1))) * TAYLOR);
    for degree in (1..=TAYLOR).rev() {
        // out ← 𝟙 + t·out/degree
        let c = scale / degree as f64;
        for j in 0..n {
            let col = x.col_as_slice_mut(j);
            col.fill(ZERO);
            for k in 0..=j {
                let b = out[(k, j)] * c;
                let t = t.col_as_slice(k);
                for i in 0..=k {
                    col[i] += t[i] * b;
                }
                col[k] += b * shift;
            }
            col[j] += ONE;
        }
        core::mem::swap(x, out);
    }
    exact_diagonal(out, t, shift, scale);
}

/// f ← f², with the diagonal exp(scale·(t + shift)).
fn square(f: &mut Mat<c64>, x: &mut Mat<c64>, t: &Mat<c64>, shift: f64, scale: f64) {
    let n = f.nrows();
    tally(|| Ops::complex_muladds(triangle(n)));
    for j in 0..n {
        let col = x.col_as_slice_mut(j);
        col.fill(ZERO);
        for k in 0..=j {
            let b = f[(k, j)];
            let f = f.col_as_slice(k);
            for i in 0..=k {
                col[i] += f[i] * b;
            }
        }
    }
    core::mem::swap(x, f);
    exact_diagonal(f, t, shift, scale);
}

/// The i ≤ k ≤ j < n of a product of two upper triangles.
fn triangle(n: usize) -> usize {
    n * (n + 1) * (n + 2) / 6
}

fn exact_diagonal(f: &mut Mat<c64>, t: &Mat<c64>, shift: f64, scale: f64) {
    tally(|| (Ops::adds(1) + Ops::muls(4) + Ops::trigs(3)) * t.nrows());
    for i in 0..t.nrows() {
        f[(i, i)] = ((t[(i, i)] + shift) * scale).exp();
    }
}
