//! Functions of a real symmetric matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::{Col, Mat, Par};

use super::product::mul;
use crate::error::StepError;
use crate::scalar::{Ops, tally};

/// Workspace for a = Q Λ Qᵀ.
pub(crate) struct SymmetricEigen {
    q: Mat<f64>,
    scaled: Mat<f64>,
    lambda: Col<f64>,
    mem: MemBuffer,
}

impl core::fmt::Debug for SymmetricEigen {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("SymmetricEigen").finish_non_exhaustive()
    }
}

impl SymmetricEigen {
    pub(crate) fn new(n: usize) -> Self {
        let vectors = ComputeEigenvectors::Yes;
        let req = self_adjoint_evd_scratch::<f64>(n, vectors, Par::Seq, Default::default());
        let z = || Mat::zeros(n, n);
        SymmetricEigen { q: z(), scaled: z(), lambda: Col::zeros(n), mem: MemBuffer::new(req) }
    }

    /// out ← φ(a) = Q φ(Λ) Qᵀ, from the lower triangle of a.
    ///
    /// # Errors
    /// [`StepError::NotConverged`], and [`StepError::NotFinite`] if a value of φ is not finite.
    pub(crate) fn function(
        &mut self,
        a: &Mat<f64>,
        phi: impl Fn(f64) -> f64,
        out: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        let SymmetricEigen { q, scaled, lambda, mem } = self;
        let n = a.nrows();
        tally(|| Ops::muladds(9 * n * n * n / 2) + Ops::trigs(n) + Ops::muls(n * n));
        self_adjoint_evd(
            a.as_ref(),
            lambda.as_diagonal_mut(),
            Some(q.as_mut()),
            Par::Seq,
            MemStack::new(mem),
            Default::default(),
        )
        .map_err(|_| StepError::NotConverged { what: "the eigenvalues of a symmetric matrix" })?;
        for j in 0..q.ncols() {
            let value = phi(lambda[j]);
            StepError::finite(value.is_finite(), "a function of an eigenvalue")?;
            for (scaled, q) in scaled.col_mut(j).iter_mut().zip(q.col(j).iter()) {
                *scaled = value * q;
            }
        }
        mul(out, scaled.as_ref(), q.transpose());
        Ok(())
    }
}
