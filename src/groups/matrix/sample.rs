//! Random elements, and the projection onto the algebra.

use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, MatRef, Par, Side, c64};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup};
use crate::dense::{Expm, Structure, norm_frobenius};
use crate::groups::{Sample, Unitary};

/// Mᵀ = ±M.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symmetry {
    Symmetric,
    Skew,
}

pub(super) fn symmetry(m: &Mat<f64>) -> Option<Symmetry> {
    if m.as_ref() == m.transpose() {
        Some(Symmetry::Symmetric)
    } else if *m == -m.transpose() {
        Some(Symmetry::Skew)
    } else {
        None
    }
}

fn gaussian<R: Rng + ?Sized>(rng: &mut R, rows: usize, cols: usize, sigma: f64) -> Mat<f64> {
    Mat::from_fn(rows, cols, |_, _| sigma * rng.sample::<f64, _>(StandardNormal))
}

impl MatrixGroup {
    /// An orthonormal basis of 𝔤_M, vectorised by columns: the null space of u ↦ uᵀM + Mu.
    /// O(n⁶), once a group.
    pub(super) fn basis(&self) -> &Mat<f64> {
        self.basis.get_or_init(|| {
            let n = self.n;
            let m = self.m().unwrap_or_else(|| Mat::zeros(n, n));
            let mut map = Mat::<f64>::zeros(n * n, n * n);
            for (col, (r, c)) in (0..n).flat_map(|c| (0..n).map(move |r| (r, c))).enumerate() {
                for k in 0..n {
                    map[(c + k * n, col)] += m[(r, k)]; // (uᵀM)_ck = u_rc m_rk
                    map[(k + c * n, col)] += m[(k, r)]; // (Mu)_kc = m_kr u_rc
                }
            }
            // M of full rank and finite: the decomposition exists; without it 𝔤 is taken as {0}.
            let Ok(svd) = map.svd() else { return Mat::zeros(n * n, 0) };
            let s = svd.S().column_vector();
            let cut = 1e-10 * s[0].max(f64::MIN_POSITIVE);
            let rank = (0..s.nrows()).filter(|&i| s[i] > cut).count();
            svd.V().subcols(rank, n * n - rank).to_owned()
        })
    }

    /// The element of 𝔤 nearest to x in the Frobenius norm. Allocates.
    pub fn project_algebra(&self, x: MatRef<'_, f64>) -> AlgebraMatrix {
        let half = faer::Scale(0.5);
        let nearest = match &self.form {
            Form::Free => x.to_owned(),
            Form::Identity => (x - x.transpose()) * half,
            // For M orthogonal and (skew-)symmetric x ↦ (x − M⁻¹xᵀM)/2 is the orthogonal projection.
            _ => match (&self.m(), &self.form) {
                (Some(m), Form::Symplectic) => (x - m.transpose() * x.transpose() * m) * half,
                (Some(m), Form::Bilinear { inverse, .. }) if is_orthogonal_symmetric(m) => {
                    (x - inverse * x.transpose() * m) * half
                }
                _ => self.project_by_basis(x),
            },
        };
        let mut nearest =
            if self.subgroup.is_complex { self.blocks(nearest.as_ref()) } else { nearest };
        if self.subgroup.is_special {
            let m = if self.subgroup.is_complex { self.n / 2 } else { 0 };
            let mean = self.trace(nearest.as_ref()) / (self.n - m) as f64;
            for i in 0..self.n - m {
                nearest[(m + i, i)] -= mean;
                if m > 0 {
                    nearest[(i, m + i)] += mean;
                }
            }
        }
        AlgebraMatrix::new_unchecked(nearest)
    }

    /// The matrix \[X −Y; Y X\] that is nearest to x.
    pub(super) fn blocks(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        Mat::from_fn(self.n, self.n, |i, j| self.block(x, i, j))
    }

    /// x ← the nearest matrix \[X −Y; Y X\] on U(n) and SU(n). Elsewhere x stays as it is.
    pub(crate) fn keep_complex(&self, x: &mut Mat<f64>) {
        if !self.is_complex() {
            return;
        }
        let m = self.n / 2;
        for j in 0..m {
            for i in 0..self.n {
                let mean = self.block(x.as_ref(), i, j);
                let (k, sign) = if i < m { (i + m, 1.0) } else { (i - m, -1.0) };
                (x[(i, j)], x[(k, j + m)]) = (mean, sign * mean);
            }
        }
    }

    /// An entry of [`blocks`](Self::blocks).
    pub(super) fn block(&self, x: MatRef<'_, f64>, i: usize, j: usize) -> f64 {
        let m = self.n / 2;
        let (k, l) = ((i + m) % self.n, (j + m) % self.n);
        let sign = if (i < m) == (j < m) { 0.5 } else { -0.5 };
        0.5 * x[(i, j)] + sign * x[(k, l)]
    }

    /// The trace of u; of a skew-Hermitian X + iY that of Y.
    pub(super) fn trace(&self, u: MatRef<'_, f64>) -> f64 {
        let m = if self.subgroup.is_complex { self.n / 2 } else { 0 };
        (0..self.n - m).map(|i| u[(m + i, i)]).sum()
    }

    fn project_by_basis(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let n = self.n;
        let basis = self.basis();
        let mut out = Mat::zeros(n, n);
        for b in basis.col_iter() {
            let mut c = 0.0;
            for k in 0..n * n {
                c += b[k] * x[(k % n, k / n)];
            }
            for k in 0..n * n {
                out[(k % n, k / n)] += c * b[k];
            }
        }
        out
    }
}

fn is_orthogonal_symmetric(m: &Mat<f64>) -> bool {
    let n = m.nrows();
    let gap = m.transpose() * m - Mat::<f64>::identity(n, n);
    symmetry(m).is_some() && norm_frobenius(&gap) <= 4.0 * n as f64 * f64::EPSILON
}

/// A rotation by Haar's measure: the orthogonal factor of a Gaussian matrix with the signs of R divided out (F. Mezzadri,
/// Notices AMS 54, 2007), and one column turned if it reflects.
fn rotation<R: Rng + ?Sized>(rng: &mut R, n: usize) -> Mat<f64> {
    let qr = gaussian(rng, n, n, 1.0).qr();
    let (mut q, r) = (qr.compute_thin_Q(), qr.thin_R());
    for j in 0..n {
        if r[(j, j)] < 0.0 {
            q.col_mut(j).iter_mut().for_each(|x| *x = -*x);
        }
    }
    if q.determinant() < 0.0 {
        q.col_mut(0).iter_mut().for_each(|x| *x = -*x);
    }
    q
}

/// \[X −Y; Y X\] of a unitary X + iY of m rows by Haar's measure; of SU(m), one column turned by the phase of the determinant.
fn unitary<R: Rng + ?Sized>(rng: &mut R, m: usize, is_special: bool) -> Mat<f64> {
    let g = Unitary::new(m).map(|group| group.sample_element(rng));
    // There is no U(0).
    let mut g = g.map_or_else(
        |_| Mat::zeros(0, 0),
        |g| Mat::from_fn(m, m, |i, j| c64::new(g.re[(i, j)], g.im[(i, j)])),
    );
    if is_special {
        let back = g.determinant().conj();
        g.col_mut(0).iter_mut().for_each(|z| *z *= back);
    }
    Mat::from_fn(2 * m, 2 * m, |i, j| {
        let z = g[(i % m, j % m)];
        match (i < m, j < m) {
            (true, false) => -z.im,
            (false, true) => z.im,
            _ => z.re,
        }
    })
}

impl MatrixGroup {
    /// L with LLᵀ = ±M, where M is definite and the matrices are real.
    fn factor_of_definite(&self) -> Option<Mat<f64>> {
        let Form::Bilinear { m, .. } = &self.form else { return None };
        if self.subgroup.is_complex || symmetry(m) != Some(Symmetry::Symmetric) {
            return None;
        }
        let sign = m[(0, 0)].signum();
        let llt = Mat::from_fn(self.n, self.n, |i, j| sign * m[(i, j)]).llt(Side::Lower);
        Some(llt.ok()?.L().to_owned())
    }
}

impl Sample for MatrixGroup {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> AlgebraMatrix {
        // The orthogonal projection of a Gaussian matrix is Gaussian in any orthonormal basis.
        let x = gaussian(rng, self.n, self.n, sigma);
        self.project_algebra(x.as_ref())
    }

    /// SO(n), U(n), SU(n) and G_M with a definite M: Haar's measure.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> GroupMatrix {
        let n = self.n;
        let element = match (&self.form, self.factor_of_definite()) {
            (Form::Identity, _) if self.subgroup.is_complex => {
                unitary(rng, n / 2, self.subgroup.is_special)
            }
            (Form::Identity, _) => rotation(rng, n),
            // M = LLᵀ: g = L⁻ᵀqLᵀ with a rotation q.
            (_, Some(l)) => {
                let mut g = rotation(rng, n) * l.transpose();
                solve_upper_triangular_in_place(l.transpose(), g.as_mut(), Par::Seq);
                g
            }
            _ => {
                let u = self.sample_algebra(rng, 0.5);
                let mut g = Mat::identity(n, n);
                // A Gaussian u of this size cannot overflow; 𝟙 stands for the impossible.
                if Expm::new(n).exp(&u, Structure::General, &mut g).is_err() {
                    g = Mat::identity(n, n);
                }
                g
            }
        };
        GroupMatrix::new_unchecked(element)
    }

    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Mat<f64> {
        gaussian(rng, self.n, 1, 1.0)
    }
}
