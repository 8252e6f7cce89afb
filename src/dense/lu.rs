//! LU with partial pivoting in a reusable workspace.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{Mat, MatMut, MatRef, Par};

use super::ops::SMALL;
use super::product::load;
use crate::scalar::{Ops, tally};

/// An LU factorisation that can be repeated in place.
pub(crate) struct Lu {
    /// Write the matrix here, then call [`factor`](Self::factor).
    pub(crate) a: Mat<f64>,
    perm: Vec<usize>,
    perm_inv: Vec<usize>,
    mem: MemBuffer,
}

impl core::fmt::Debug for Lu {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Lu").finish_non_exhaustive()
    }
}

/// n reciprocals of pivots, n(n − 1)/2 multipliers and a row operation for every i, j > k.
#[inline(always)]
fn factor_ops(n: usize) -> Ops {
    let below = n * n.saturating_sub(1) / 2;
    Ops::divs(n) + Ops::muls(below) + Ops::muladds(below * (2 * n).saturating_sub(1) / 3)
}

/// n reciprocals; for every column both triangles and a product with each reciprocal.
#[inline(always)]
fn solve_ops(n: usize, columns: usize) -> Ops {
    Ops::divs(n) + (Ops::muladds(n * n.saturating_sub(1)) + Ops::muls(n)) * columns
}

impl Lu {
    /// Workspace for n×n. More than n right-hand sides are solved n at a time.
    pub(crate) fn new(n: usize) -> Self {
        let req = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default())
            .or(solve::solve_in_place_scratch::<usize, f64>(n, n, Par::Seq));
        Lu { a: Mat::zeros(n, n), perm: vec![0; n], perm_inv: vec![0; n], mem: MemBuffer::new(req) }
    }

    /// Factors `a` in place. Returns min|u_ii|/max|u_ii|, a cheap measure of singularity: 0 for a singular matrix, and
    /// never NaN.
    pub(crate) fn factor(&mut self) -> f64 {
        tally(|| factor_ops(self.a.nrows()));
        match self.a.nrows() {
            2 => self.factor_small::<2>(),
            3 => self.factor_small::<3>(),
            4 => self.factor_small::<4>(),
            5 => self.factor_small::<5>(),
            6 => self.factor_small::<6>(),
            7 => self.factor_small::<7>(),
            SMALL => self.factor_small::<SMALL>(),
            _ => {
                factor::lu_in_place(
                    self.a.as_mut(),
                    &mut self.perm,
                    &mut self.perm_inv,
                    Par::Seq,
                    MemStack::new(&mut self.mem),
                    Default::default(),
                );
            }
        }
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for i in 0..self.a.nrows() {
            let pivot = self.a[(i, i)].abs();
            (low, high) = (if pivot < low { pivot } else { low }, high.max(pivot));
            if pivot.is_nan() {
                return 0.0;
            }
        }
        if high > 0.0 && high.is_finite() { low / high } else { 0.0 }
    }

    /// b ← a⁻¹b.
    pub(crate) fn solve(&mut self, mut b: MatMut<'_, f64>) {
        tally(|| solve_ops(self.a.nrows(), b.ncols()));
        match self.a.nrows() {
            2 => self.solve_small::<2>(b),
            3 => self.solve_small::<3>(b),
            4 => self.solve_small::<4>(b),
            5 => self.solve_small::<5>(b),
            6 => self.solve_small::<6>(b),
            7 => self.solve_small::<7>(b),
            SMALL => self.solve_small::<SMALL>(b),
            n => {
                for first in (0..b.ncols()).step_by(n) {
                    let columns = n.min(b.ncols() - first);
                    solve::solve_in_place(
                        self.a.as_ref(),
                        self.a.as_ref(),
                        PermRef::new_checked(&self.perm, &self.perm_inv, n),
                        b.as_mut().subcols_mut(first, columns),
                        Par::Seq,
                        MemStack::new(&mut self.mem),
                    );
                }
            }
        }
    }

    /// The factors of a small matrix, with row i of the factors being row `perm[i]` of a.
    fn factor_small<const N: usize>(&mut self) {
        let mut lu = load::<N>(self.a.as_ref());
        let mut perm: [usize; N] = core::array::from_fn(|i| i);
        for k in 0..N {
            let mut p = k;
            for i in k + 1..N {
                if lu[k][i].abs() > lu[k][p].abs() {
                    p = i;
                }
            }
            if p != k {
                perm.swap(k, p);
                for col in &mut lu {
                    col.swap(k, p);
                }
            }
            let inverse = 1.0 / lu[k][k];
            for i in k + 1..N {
                lu[k][i] *= inverse;
            }
            for j in k + 1..N {
                let x = lu[j][k];
                for i in k + 1..N {
                    lu[j][i] -= lu[k][i] * x;
                }
            }
        }
        for j in 0..N {
            self.a.col_as_slice_mut(j).copy_from_slice(&lu[j]);
        }
        self.perm.copy_from_slice(&perm);
    }

    fn solve_small<const N: usize>(&self, mut b: MatMut<'_, f64>) {
        let lu = load::<N>(self.a.as_ref());
        let inverse: [f64; N] = core::array::from_fn(|i| 1.0 / lu[i][i]);
        for j in 0..b.ncols() {
            let mut x: [f64; N] = core::array::from_fn(|i| b[(self.perm[i], j)]);
            for k in 0..N {
                for i in k + 1..N {
                    x[i] -= lu[k][i] * x[k];
                }
            }
            for k in (0..N).rev() {
                x[k] *= inverse[k];
                for i in 0..k {
                    x[i] -= lu[k][i] * x[k];
                }
            }
            for i in 0..N {
                b[(i, j)] = x[i];
            }
        }
    }

    /// The reciprocal condition number of `a` in the 1-norm, by its inverse: O(n³), allocates.
    pub(crate) fn rcond(a: MatRef<'_, f64>) -> f64 {
        let n = a.nrows();
        let mut lu = Lu::new(n);
        lu.a.copy_from(a);
        if lu.factor() == 0.0 {
            return 0.0;
        }
        let mut inverse = Mat::identity(n, n);
        lu.solve(inverse.as_mut());
        let rcond = 1.0 / (super::norm1(a) * super::norm1(inverse.as_ref()));
        if rcond.is_nan() { 0.0 } else { rcond }
    }
}
