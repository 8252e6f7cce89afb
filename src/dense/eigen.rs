//! Eigendecomposition of a real skew-symmetric matrix, and functions of ad_u built on it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, c64};

use crate::error::StepError;
use crate::scalar::{Ops, tally};

/// Workspace for iu = Q Λ Q* with u skew-symmetric.
pub(crate) struct SkewEigen {
    h: Mat<c64>,
    q: Mat<c64>,
    x: Mat<c64>,
    lambda: faer::Col<c64>,
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
        SkewEigen { h: z(), q: z(), x: z(), lambda: faer::Col::zeros(n), mem: MemBuffer::new(req) }
    }

    /// v ← φ(ad_u) v for u, v skew. `phi(θ)` is (Re, Im) of φ at the eigenvalue −iθ of ad_u.
    ///
    /// With iu = QΛQ*, (Q*vQ)_jk is the component of v at the eigenvalue −i(λ_j − λ_k) of ad_u. The
    /// component of a conjugate pair (q_k = q̄_j) is q_j* v q̄_j = 0 because v is skew; it is set to
    /// zero exactly, for φ may be singular there although no element of so(n) sees it.
    pub(crate) fn function_of_ad(
        &mut self,
        u: &Mat<f64>,
        v: &mut Mat<f64>,
        phi: impl Fn(f64) -> Result<(f64, f64), StepError>,
    ) -> Result<(), StepError> {
        let n = u.nrows();
        let SkewEigen { h, q, x, lambda, mem } = self;
        // The eigenvectors by the usual estimate of 9n³ complex operations; then five products, n norms,
        // n Rayleigh quotients, φ and its product for each entry, and the skew part.
        tally(Ops::complex_muladds(9 * n * n * n / 2 + 5 * n * n * n) + Ops::muladds(4 * n * n));
        tally((Ops::muls(2 * n + 1) + Ops::divs(1) + Ops::sqrts(1)) * n);
        tally((Ops::muls(6) + Ops::adds(4) + Ops::divs(1) + Ops::trigs(2)) * (n * n));
        for j in 0..n {
            for i in 0..n {
                h[(i, j)] = c64::new(0.0, u[(i, j)]);
            }
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
        for j in 0..n {
            let inverse = 1.0 / q.col(j).norm_l2();
            q.col_mut(j).iter_mut().for_each(|x| *x *= inverse);
        }
        let one = c64::new(1.0, 0.0);
        matmul(x.as_mut(), Accum::Replace, h.as_ref(), q.as_ref(), one, Par::Seq);
        for j in 0..n {
            let terms = q.col(j).iter().zip(x.col(j).iter());
            lambda[j].re = terms.map(|(q, x)| q.re * x.re + q.im * x.im).sum();
        }
        for j in 0..n {
            for i in 0..n {
                h[(i, j)] = c64::new(v[(i, j)], 0.0);
            }
        }
        matmul(x.as_mut(), Accum::Replace, h.as_ref(), q.as_ref(), one, Par::Seq);
        matmul(h.as_mut(), Accum::Replace, q.adjoint(), x.as_ref(), one, Par::Seq);
        for k in 0..n {
            for j in 0..n {
                // Eigenvalues ascend, so the conjugate of number j is number n − 1 − j.
                if j + k == n - 1 && j != k && isolated(lambda, j) {
                    h[(j, k)] = c64::new(0.0, 0.0);
                } else {
                    let (re, im) = phi(lambda[j].re - lambda[k].re)?;
                    h[(j, k)] *= c64::new(re, im);
                }
            }
        }
        matmul(x.as_mut(), Accum::Replace, q.as_ref(), h.as_ref(), one, Par::Seq);
        matmul(h.as_mut(), Accum::Replace, x.as_ref(), q.adjoint(), one, Par::Seq);
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
}

/// Is eigenvalue j far enough from its neighbours for its eigenvector to be its own?
fn isolated(lambda: &faer::Col<c64>, j: usize) -> bool {
    let n = lambda.nrows();
    let gap = 1e-6 * lambda[n - 1].re.abs().max(lambda[0].re.abs());
    (j == 0 || lambda[j].re - lambda[j - 1].re > gap)
        && (j + 1 == n || lambda[j + 1].re - lambda[j].re > gap)
}
