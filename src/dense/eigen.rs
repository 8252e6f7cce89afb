//! Eigendecomposition of a skew-symmetric or skew-Hermitian matrix, and functions of ad_u from it.

use core::f64::consts::TAU;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::{Accum, Col, Mat, Par, c64};

use super::ops::{blocks_of_complex, complex_of_blocks};
use super::schur::{NEGLIGIBLE, ONE, ZERO};
use crate::error::StepError;
use crate::scalar::{Ops, tally};

/// Workspace for iu = Q Λ Q* with u skew-symmetric or skew-Hermitian.
pub(crate) struct SkewEigen {
    /// iu, then the coordinates of v.
    h: Mat<c64>,
    q: Mat<c64>,
    x: Mat<c64>,
    /// Λ, ascending.
    lambda: Col<c64>,
    mem: MemBuffer,
}

impl core::fmt::Debug for SkewEigen {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("SkewEigen").finish_non_exhaustive()
    }
}

impl SkewEigen {
    pub(crate) fn new(n: usize) -> Self {
        let req = self_adjoint_evd_scratch::<c64>(
            n,
            ComputeEigenvectors::Yes,
            Par::Seq,
            Default::default(),
        );
        let z = || Mat::zeros(n, n);
        SkewEigen { h: z(), q: z(), x: z(), lambda: Col::zeros(n), mem: MemBuffer::new(req) }
    }

    /// v ← φ(ad_u) v for u, v skew. `phi(θ)` is (Re, Im) of φ at the eigenvalue −iθ of ad_u.
    ///
    /// With iu = QΛQ*, (Q*vQ)_jk is the component of v at the eigenvalue −i(λ_j − λ_k) of ad_u. The
    /// component of a conjugate pair (q_k = q̄_j) is q_j* v q̄_j = 0 because v is skew. The code sets it
    /// to zero exactly, because φ may be singular there, which does not matter for so(n).
    pub(crate) fn function_of_ad(
        &mut self,
        u: &Mat<f64>,
        v: &mut Mat<f64>,
        phi: impl Fn(f64) -> Result<(f64, f64), StepError>,
    ) -> Result<(), StepError> {
        let n = u.nrows();
        fill(&mut self.h, |i, j| c64::new(0.0, u[(i, j)]));
        self.decompose()?;
        let first = n - self.conjugate_pairs();
        fill(&mut self.h, |i, j| c64::new(v[(i, j)], 0.0));
        // Eigenvalues ascend, so the conjugate of number j is number n − 1 − j.
        let is_pair = |j: usize, k: usize| j + k == n - 1 && j != k;
        self.multiply(phi, |lambda, j, k| {
            is_pair(j, k) && (j.max(k) >= first || isolated(lambda, j))
        })?;
        let h = &self.h;
        tally(|| (Ops::adds(1) + Ops::muls(1)) * (n * n.saturating_sub(1) / 2));
        for j in 0..n {
            v[(j, j)] = 0.0;
            for i in j + 1..n {
                let w = 0.5 * (h[(i, j)].re - h[(j, i)].re);
                v[(i, j)] = w;
                v[(j, i)] = -w;
            }
        }
        Ok(())
    }

    /// v ← φ(ad_u) v for u, v skew-Hermitian, as [`function_of_ad`](Self::function_of_ad). On u(n)
    /// every eigenvalue counts.
    pub(crate) fn function_of_complex_ad(
        &mut self,
        u: &Mat<c64>,
        v: &mut Mat<c64>,
        phi: impl Fn(f64) -> Result<(f64, f64), StepError>,
    ) -> Result<(), StepError> {
        self.decompose_complex(u)?;
        self.h.copy_from(&*v);
        self.multiply(phi, |_, _, _| false)?;
        let h = &self.h;
        fill(v, |i, j| 0.5 * (h[(i, j)] - h[(j, i)].conj()));
        Ok(())
    }

    /// The smallest distance of an eigenvalue −i(λ_j − λ_k) of ad_u on u(n) to 2πik, k ≠ 0.
    pub(crate) fn distance_to_singular(&mut self, u: &Mat<c64>) -> Result<f64, StepError> {
        self.decompose_complex(u)?;
        if self.lambda.iter().any(|x| !x.re.is_finite()) {
            return Err(StepError::NotFinite { what: "an eigenvalue of u" });
        }
        // A difference of 0 is 2π away: those with j = k.
        let mut best = TAU;
        for j in 0..u.nrows() {
            for k in 0..j {
                let theta = self.lambda[j].re - self.lambda[k].re;
                best = best.min((theta - TAU * (theta / TAU).round().max(1.0)).abs());
            }
        }
        Ok(best)
    }

    fn decompose_complex(&mut self, u: &Mat<c64>) -> Result<(), StepError> {
        fill(&mut self.h, |i, j| c64::new(-u[(i, j)].im, u[(i, j)].re));
        self.decompose()
    }

    /// Makes the eigenvectors of −λ the conjugates of those of λ, if the largest λ are too close to each other for accurate
    /// eigenvectors. Returns the number of these λ.
    ///
    /// An eigenvector of such a λ is one of a cluster, and the decomposition takes any basis of the cluster of −λ. With the
    /// conjugate basis the component of each pair is 0 again, and QΛQ* is a real skew matrix, as near to u as before. Two λ
    /// below ½ have no pole at their sum; so the pairs begin at the widest gap there.
    fn conjugate_pairs(&mut self) -> usize {
        let SkewEigen { q, lambda, .. } = self;
        let n = lambda.nrows();
        let least = n - n / 2;
        let Some(start) = (least..n).find(|&j| lambda[j].re > 0.5) else { return 0 };
        if (start..n).all(|j| isolated(lambda, j)) {
            return 0;
        }
        let gap = |j: usize| lambda[j].re - if j == least { 0.0 } else { lambda[j - 1].re };
        let widest = (least..=start).max_by(|&i, &j| gap(i).total_cmp(&gap(j)));
        let first = widest.unwrap_or(start);
        for j in first..n {
            let pair = n - 1 - j;
            lambda[pair].re = -lambda[j].re;
            for i in 0..n {
                q[(i, pair)] = q[(i, j)].conj();
            }
        }
        n - first
    }

    /// h = QΛQ*.
    fn decompose(&mut self) -> Result<(), StepError> {
        let SkewEigen { h, q, x, lambda, mem } = self;
        // The eigenvectors by the usual estimate of 9n³ complex operations, a product, norms, quotients.
        let n = h.nrows();
        tally(|| Ops::complex_muladds(9 * n * n * n / 2 + n * n * n));
        tally(|| {
            Ops::muladds(4 * n * n) + Ops::muls(2 * n * n) + (Ops::divs(1) + Ops::sqrts(1)) * n
        });
        // faer's reduction fails where the square of an entry underflows beside others.
        let negligible = NEGLIGIBLE * h.norm_max();
        for z in h.col_iter_mut().flat_map(|column| column.iter_mut()) {
            let significant = |x: f64| if x.abs() < negligible { 0.0 } else { x };
            *z = c64::new(significant(z.re), significant(z.im));
        }
        self_adjoint_evd(
            h.as_ref(),
            lambda.as_diagonal_mut(),
            Some(q.as_mut()),
            Par::Seq,
            MemStack::new(mem),
            Default::default(),
        )
        .map_err(|_| StepError::NotConverged { what: "the eigendecomposition of u" })?;
        // The columns arrive orthogonal to ε but normalised to some 10ε only, and the eigenvalues
        // no better: normalise, and take Rayleigh quotients.
        for column in q.col_iter_mut() {
            let inverse = 1.0 / column.norm_l2();
            column.iter_mut().for_each(|x| *x *= inverse);
        }
        matmul(x.as_mut(), Accum::Replace, h.as_ref(), q.as_ref(), ONE, Par::Seq);
        for j in 0..h.nrows() {
            let terms = q.col(j).iter().zip(x.col(j).iter());
            lambda[j].re = terms.map(|(q, x)| q.re * x.re + q.im * x.im).sum();
        }
        Ok(())
    }

    /// h ← Q (φ(−i(λ_j − λ_k)) ∘ Q*hQ) Q*, with the components that are `absent` set to zero.
    fn multiply(
        &mut self,
        phi: impl Fn(f64) -> Result<(f64, f64), StepError>,
        absent: impl Fn(&Col<c64>, usize, usize) -> bool,
    ) -> Result<(), StepError> {
        let SkewEigen { h, q, x, lambda, .. } = self;
        // Four products; φ of a difference and its product for each entry.
        let n = h.nrows();
        tally(|| Ops::dots(8 * n * n, 2 * n));
        tally(|| (Ops::muls(6) + Ops::adds(3) + Ops::divs(1) + Ops::trigs(2)) * (n * n));
        matmul(x.as_mut(), Accum::Replace, h.as_ref(), q.as_ref(), ONE, Par::Seq);
        matmul(h.as_mut(), Accum::Replace, q.adjoint(), x.as_ref(), ONE, Par::Seq);
        for k in 0..h.ncols() {
            for j in 0..h.nrows() {
                if absent(lambda, j, k) {
                    h[(j, k)] = ZERO;
                } else {
                    let (re, im) = phi(lambda[j].re - lambda[k].re)?;
                    h[(j, k)] *= c64::new(re, im);
                }
            }
        }
        matmul(x.as_mut(), Accum::Replace, q.as_ref(), h.as_ref(), ONE, Par::Seq);
        matmul(h.as_mut(), Accum::Replace, x.as_ref(), q.adjoint(), ONE, Par::Seq);
        Ok(())
    }
}

fn fill(x: &mut Mat<c64>, entry: impl Fn(usize, usize) -> c64) {
    for j in 0..x.ncols() {
        for i in 0..x.nrows() {
            x[(i, j)] = entry(i, j);
        }
    }
}

/// True if eigenvalue j is far enough from its neighbours for an accurate eigenvector.
fn isolated(lambda: &Col<c64>, j: usize) -> bool {
    let n = lambda.nrows();
    let gap = 1e-6 * lambda[n - 1].re.abs().max(lambda[0].re.abs());
    (j == 0 || lambda[j].re - lambda[j - 1].re > gap)
        && (j + 1 == n || lambda[j + 1].re - lambda[j].re > gap)
}

/// Functions of ad_u for skew-Hermitian X + iY that are stored as real matrices \[X −Y; Y X\].
///
/// On so(2n) ad_u has other eigenvalues besides, at which φ may be singular.
#[derive(Debug)]
pub(crate) struct ComplexBlocks {
    eigen: SkewEigen,
    u: Mat<c64>,
    v: Mat<c64>,
}

impl ComplexBlocks {
    /// Workspace for n×n complex matrices.
    pub(crate) fn new(n: usize) -> Self {
        ComplexBlocks { eigen: SkewEigen::new(n), u: Mat::zeros(n, n), v: Mat::zeros(n, n) }
    }

    /// v ← φ(ad_u) v, as [`SkewEigen::function_of_complex_ad`].
    pub(crate) fn function_of_ad(
        &mut self,
        u: &Mat<f64>,
        v: &mut Mat<f64>,
        phi: impl Fn(f64) -> Result<(f64, f64), StepError>,
    ) -> Result<(), StepError> {
        complex_of_blocks(u, &mut self.u);
        complex_of_blocks(v, &mut self.v);
        self.eigen.function_of_complex_ad(&self.u, &mut self.v, phi)?;
        blocks_of_complex(&self.v, v);
        Ok(())
    }

    /// As [`SkewEigen::distance_to_singular`].
    pub(crate) fn distance_to_singular(&mut self, u: &Mat<f64>) -> Result<f64, StepError> {
        complex_of_blocks(u, &mut self.u);
        self.eigen.distance_to_singular(&self.u)
    }
}
