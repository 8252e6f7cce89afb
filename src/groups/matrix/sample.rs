//! Random elements, and the blocks of U(n) and SU(n).

use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, MatRef, Par, Side, c64};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::parts::{Symmetry, symmetry};
use super::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup};
use crate::dense::{Expm, Structure};
use crate::groups::{Sample, Unitary};

fn gaussian<R: Rng + ?Sized>(rng: &mut R, rows: usize, cols: usize, sigma: f64) -> Mat<f64> {
    Mat::from_fn(rows, cols, |_, _| sigma * rng.sample::<f64, _>(StandardNormal))
}

impl MatrixGroup {
    /// The matrix \[X −Y; Y X\] that is nearest to x.
    pub(super) fn blocks(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        Mat::from_fn(self.n, self.n, |i, j| self.block(x, i, j))
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
