//! The complex Schur form u = Q T Q* of a real matrix in a reusable workspace.
//!
//! Householder reduction to Hessenberg form, then the QR iteration with Wilkinson's shift and
//! deflation (G. H. Golub, C. F. Van Loan, Matrix Computations, ch. 7). Backward stable:
//! ‖QTQ* − u‖ ≤ c(n)·ε·‖u‖. About 60 n³ operations; nothing is allocated.

use faer::{Mat, c64};

use crate::error::StepError;
use crate::scalar::{Ops, tally};

/// 0 and 1 in ℂ.
pub(super) const ZERO: c64 = c64::new(0.0, 0.0);
pub(super) const ONE: c64 = c64::new(1.0, 0.0);
/// The largest number of iterations without deflation; two or three are usual.
const SWEEPS_MAX: usize = 60;
/// Entries below this fraction of the largest entry are set to zero.
pub(crate) const NEGLIGIBLE: f64 = 1e-60;

/// Workspace for u = Q T Q*.
#[derive(Debug)]
pub(crate) struct Schur {
    /// T, upper triangular; on entry of [`factor`](Self::factor) the matrix.
    pub(crate) t: Mat<c64>,
    /// Q, unitary.
    pub(crate) q: Mat<c64>,
    reflector: Vec<c64>,
}

/// The rotation \[c s; −s̄ c\] that takes (a, b) to (r, 0).
#[derive(Clone, Copy)]
struct Rotation {
    c: f64,
    s: c64,
}

impl Rotation {
    /// Rotates a pair of numbers: each times c, plus the other times s.
    const OPS: Ops = Ops { add: 8, mul: 12, ..Ops::NONE };

    fn new(a: c64, b: c64) -> Self {
        let (size_a, size_b) = (a.norm(), b.norm());
        if size_b == 0.0 {
            return Rotation { c: 1.0, s: ZERO };
        }
        if size_a == 0.0 {
            return Rotation { c: 0.0, s: b.conj() / size_b };
        }
        let r = size_a.hypot(size_b);
        Rotation { c: size_a / r, s: (a / size_a) * (b.conj() / r) }
    }

    /// Rows k and k + 1 of `x`, columns `from`….
    fn rows(self, x: &mut Mat<c64>, k: usize, from: usize) {
        tally(|| Rotation::OPS * x.ncols().saturating_sub(from));
        for j in from..x.ncols() {
            let col = x.col_as_slice_mut(j);
            let (a, b) = (col[k], col[k + 1]);
            col[k] = a * self.c + self.s * b;
            col[k + 1] = b * self.c - self.s.conj() * a;
        }
    }

    /// Columns k and k + 1 of `x`, rows up to `to`, from the right by the adjoint.
    fn columns(self, x: &mut Mat<c64>, k: usize, to: usize) {
        tally(|| Rotation::OPS * to);
        for i in 0..to {
            let (a, b) = (x[(i, k)], x[(i, k + 1)]);
            x[(i, k)] = a * self.c + self.s.conj() * b;
            x[(i, k + 1)] = b * self.c - self.s * a;
        }
    }
}

/// 2ᵉx, by two factors, because 2ᵉ itself may overflow.
fn scaled(x: c64, e: i32) -> c64 {
    x * 2f64.powi(e / 2) * 2f64.powi(e - e / 2)
}

impl Schur {
    pub(crate) fn new(n: usize) -> Self {
        Schur { t: Mat::zeros(n, n), q: Mat::zeros(n, n), reflector: vec![ZERO; n] }
    }

    /// `t` ← T and `q` ← Q for the matrix in `t`, with the real parts of the eigenvalues in
    /// descending order (up to differences of 1/4).
    ///
    /// # Errors
    /// [`StepError::NotConverged`].
    pub(crate) fn factor(&mut self) -> Result<(), StepError> {
        let exponent = self.normalise();
        self.hessenberg();
        self.iterate()?;
        // Before they are sorted: 1/4 is meant at the size that u has.
        self.t
            .col_iter_mut()
            .for_each(|col| col.iter_mut().for_each(|x| *x = scaled(*x, exponent)));
        self.sort();
        Ok(())
    }

    /// t ← 2⁻ᵉt with its largest entry near 1 and entries below [`NEGLIGIBLE`] set to zero. Returns e. The iteration
    /// multiplies entries by each other, and would not end if such a product underflowed.
    fn normalise(&mut self) -> i32 {
        let entries = self.t.col_iter().flat_map(|col| col.iter());
        let largest = entries.fold(0.0, |most: f64, x| most.max(x.re.abs()).max(x.im.abs()));
        let exponent = largest.log2().clamp(-1100.0, 1100.0).floor() as i32;
        let significant = |x: f64| if x.abs() < NEGLIGIBLE { 0.0 } else { x };
        for x in self.t.col_iter_mut().flat_map(|col| col.iter_mut()) {
            let c64 { re, im } = scaled(*x, -exponent);
            *x = c64::new(significant(re), significant(im));
        }
        exponent
    }

    fn hessenberg(&mut self) {
        let Schur { t, q, reflector: w } = self;
        let n = t.nrows();
        q.fill(ZERO);
        q.diagonal_mut().fill(ONE);
        for k in 0..n.saturating_sub(2) {
            let tail = (k + 1..n).map(|i| t[(i, k)].norm()).fold(0.0f64, f64::hypot);
            let lead = t[(k + 1, k)];
            if tail == 0.0 || (k + 2..n).all(|i| t[(i, k)] == ZERO) {
                continue;
            }
            let phase = if lead == ZERO { ONE } else { lead / lead.norm() };
            // w = (x + phase·‖x‖·e₁)/‖·‖, H = 𝟙 − 2ww*.
            for i in k + 1..n {
                w[i] = t[(i, k)] / tail;
            }
            w[k + 1] += phase;
            let size = (k + 1..n).map(|i| w[i].norm()).fold(0.0f64, f64::hypot);
            w[k + 1..].iter_mut().for_each(|x| *x /= size);
            let (rows, vectors) = (n - k - 1, n - k + 2 * n);
            tally(|| Ops::muladds(4 * rows) + Ops::divs(4 * rows) + Ops::sqrts(2 * rows));
            tally(|| (Ops::complex_muladds(2 * rows) + Ops::muls(2 * rows)) * vectors);
            for j in k..n {
                let col = t.col_as_slice_mut(j);
                let mut dot = ZERO;
                for i in k + 1..n {
                    dot += w[i].conj() * col[i];
                }
                for i in k + 1..n {
                    col[i] -= w[i] * dot * 2.0;
                }
            }
            for x in [&mut *t, &mut *q] {
                for i in 0..n {
                    let mut dot = ZERO;
                    for j in k + 1..n {
                        dot += x[(i, j)] * w[j];
                    }
                    for j in k + 1..n {
                        x[(i, j)] -= dot * w[j].conj() * 2.0;
                    }
                }
            }
            for i in k + 2..n {
                t[(i, k)] = ZERO;
            }
        }
    }

    fn iterate(&mut self) -> Result<(), StepError> {
        let Schur { t, q, .. } = self;
        let n = t.nrows();
        let mut high = n.saturating_sub(1);
        let mut sweeps = 0;
        while high > 0 {
            let mut low = high;
            while low > 0 {
                let beside = t[(low, low)].norm() + t[(low - 1, low - 1)].norm();
                if t[(low, low - 1)].norm() <= 0.5 * f64::EPSILON * beside.max(NEGLIGIBLE) {
                    t[(low, low - 1)] = ZERO;
                    break;
                }
                low -= 1;
            }
            if low == high {
                (high, sweeps) = (high - 1, 0);
                continue;
            }
            sweeps += 1;
            if sweeps > SWEEPS_MAX {
                return Err(StepError::NotConverged { what: "the Schur form of u" });
            }
            // Every tenth sweep an exceptional shift breaks a cycle.
            let shift = match sweeps % 10 {
                0 => t[(high, high)] + t[(high, high - 1)].norm(),
                _ => wilkinson(t, high),
            };
            let mut lead = (t[(low, low)] - shift, t[(low + 1, low)]);
            for k in low..high {
                let rotation = Rotation::new(lead.0, lead.1);
                rotation.rows(t, k, k.saturating_sub(1));
                rotation.columns(t, k, (k + 3).min(high + 1));
                rotation.columns(q, k, n);
                if k > low {
                    t[(k + 1, k - 1)] = ZERO;
                }
                if k + 2 <= high {
                    lead = (t[(k + 1, k)], t[(k + 2, k)]);
                }
            }
        }
        for j in 0..n {
            t.col_as_slice_mut(j)[j + 1..].fill(ZERO);
        }
        Ok(())
    }

    /// Exchanges neighbours until the real parts descend.
    fn sort(&mut self) {
        let Schur { t, q, .. } = self;
        let n = t.nrows();
        for last in (1..n).rev() {
            for k in 0..last {
                let (a, b) = (t[(k, k)], t[(k + 1, k + 1)]);
                if b.re - a.re > 0.25 {
                    let rotation = Rotation::new(t[(k, k + 1)], b - a);
                    rotation.rows(t, k, k);
                    rotation.columns(t, k, k + 2);
                    rotation.columns(q, k, n);
                    (t[(k, k)], t[(k + 1, k + 1)], t[(k + 1, k)]) = (b, a, ZERO);
                }
            }
        }
    }
}

/// The eigenvalue of the trailing 2×2 block that is closer to its last entry.
fn wilkinson(t: &Mat<c64>, high: usize) -> c64 {
    let (a, d) = (t[(high - 1, high - 1)], t[(high, high)]);
    let bc = t[(high - 1, high)] * t[(high, high - 1)];
    let half = (a - d) * 0.5;
    let root = (half * half + bc).sqrt();
    let far = match half.re * root.re + half.im * root.im >= 0.0 {
        true => half + root,
        false => half - root,
    };
    if far == ZERO { d } else { d - bc / far }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ‖QTQ* − a‖ and ‖Q*Q − 𝟙‖ at rounding level, and the order.
    #[test]
    fn backward_error() {
        let mut x = 0.3f64;
        for n in 1..=12usize {
            for scale in [1e-3, 1.0, 1e3] {
                for kind in 0..3 {
                    let mut draw = || {
                        x = (x * 997.13 + 0.17).fract();
                        scale * (x - 0.5)
                    };
                    let a: Mat<c64> = Mat::from_fn(n, n, |i, j| match kind {
                        0 => c64::new(draw(), 0.0),
                        1 if j == i + 1 => c64::new(scale, 0.0), // a Jordan block
                        1 => ZERO,
                        _ => c64::new(if (i + 1) % n == j { scale } else { 0.0 }, 0.0), // a cycle
                    });
                    let mut schur = Schur::new(n);
                    schur.t.copy_from(&a);
                    schur.factor().expect("a Schur form");
                    let Schur { t, q, .. } = &schur;
                    let back = (q * t * q.adjoint() - &a).norm_l2();
                    let unit = (q.adjoint() * q - Mat::<c64>::identity(n, n)).norm_l2();
                    let bound = 8.0 * n as f64 * f64::EPSILON;
                    assert!(back <= bound * a.norm_l2(), "n = {n}, kind {kind}: {back:e}");
                    assert!(unit <= bound, "n = {n}, kind {kind}: {unit:e}");
                    for k in 1..n {
                        assert!(t[(k, k)].re - t[(k - 1, k - 1)].re <= 0.25);
                    }
                }
            }
        }
    }
}
