//! The sphere: the Laplacian of Hoppe and Yau on u(N), and its solve in O(N²).
//!
//! With the spin matrices J of spin (N − 1)/2, J₃ = diag((N−1)/2, …, −(N−1)/2),
//!
//! ΔP = −Σ_a \[J_a, \[J_a, P\]\], with the eigenvalues −l(l + 1), 0 ≤ l < N, 2l + 1 times each.
//!
//! Δ maps every diagonal r − i = m of P (row r, column i) to itself, by a tridiagonal matrix:
//!
//! (−ΔP)_ri = d P_ri − o_i P_{r−1,i−1} − o_{i+1} P_{r+1,i+1}, d = m² + q_i + q_{i+1},
//! q_i = (i(N−i) + r(N−r))/2, o_i² = i(N−i) r(N−r).
//!
//! Its pivots are p_i = q_{i+1} + s_i, with s_0 = m² + q_0 and
//! s_i = m² + ((q_i² − o_i²) + q_i s_{i−1})/(q_i + s_{i−1}), q_i² − o_i² = ((i(N−i) − r(N−r))/2)²:
//! these are sums and products of positive numbers, so every pivot has full accuracy. On the diagonal m = 0 Δ is a
//! divergence of fluxes. It is singular on the multiples of 𝟙, so tr P = 0 is chosen.
//! Source: J. Hoppe & S.-T. Yau, Comm. Math. Phys. 195 (1998).

use faer::Mat;

use super::Surface;
use crate::dense::wide;
use crate::error::Error;
use crate::groups::ComplexMatrix;
use crate::scalar::{Ops, tally};

/// The quantised sphere: 1/ħ = ½√(N² − 1).
#[derive(Clone, Debug)]
pub struct Sphere {
    n: usize,
    /// o_i/p_{i−1} at (r, i), on and below the diagonal; 0 in the first column.
    up: Mat<f64>,
    /// 1/p_i at (r, i).
    inverse: Mat<f64>,
}

/// i(N − i).
fn flux(n: usize, i: usize) -> f64 {
    (i * (n - i)) as f64
}

/// q_i and (q_i² − o_i²) and o_i of the diagonal m.
pub(super) fn entries(n: usize, m: usize, i: usize) -> (f64, f64, f64) {
    let (a, b) = (flux(n, i), flux(n, i + m));
    let half = 0.5 * (a - b);
    (0.5 * (a + b), half * half, a.sqrt() * b.sqrt())
}

impl Sphere {
    /// The sphere of N×N matrices, with the pivots of its Laplacian.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless 2 ≤ N ≤ 16384.
    pub fn new(n: usize) -> Result<Self, Error> {
        if !(2..=16384).contains(&n) {
            return Err(Error::out_of_range("N", n as f64, "2 ≤ N ≤ 16384"));
        }
        let (mut up, mut inverse) = (Mat::zeros(n, n), Mat::zeros(n, n));
        for m in 1..n {
            let square = (m * m) as f64;
            let mut s = square + entries(n, m, 0).0;
            let mut pivot = entries(n, m, 1).0 + s;
            inverse[(m, 0)] = 1.0 / pivot;
            for i in 1..n - m {
                let (q, gap, o) = entries(n, m, i);
                up[(i + m, i)] = o / pivot;
                s = square + (gap + q * s) / (q + s);
                pivot = entries(n, m, i + 1).0 + s;
                inverse[(i + m, i)] = 1.0 / pivot;
            }
        }
        Ok(Sphere { n, up, inverse })
    }

    /// x ← Δ⁻¹x for one part of a matrix, by its triangle below the diagonal; the diagonal is left.
    #[expect(clippy::disallowed_methods, reason = "no function gets two columns")]
    fn solve_below(&self, x: &mut Mat<f64>) {
        let n = self.n;
        for j in 1..n - 1 {
            let (before, after) = x.as_mut().split_at_col_mut(j);
            let rows = n - 1 - j;
            let left = slice(before.as_ref(), j - 1);
            let col = slice_mut(after, 0);
            let up = self.up.col_as_slice(j);
            let (col, left, up) = (&mut col[j + 1..], &left[j..j + rows], &up[j + 1..]);
            for ((x, l), u) in col.iter_mut().zip(left).zip(up) {
                *x += u * l;
            }
        }
        for j in (0..n - 1).rev() {
            let inverse = &self.inverse.col_as_slice(j)[j + 1..];
            if j + 1 == n - 1 {
                let col = &mut x.col_as_slice_mut(j)[j + 1..];
                col.iter_mut().zip(inverse).for_each(|(x, i)| *x *= -i);
                continue;
            }
            let (before, after) = x.as_mut().split_at_col_mut(j + 1);
            let right = &slice(after.as_ref(), 0)[j + 2..];
            let up = &self.up.col_as_slice(j + 1)[j + 2..];
            let col = &mut slice_mut(before, j)[j + 1..];
            // The last row has no right neighbour.
            let (head, last) = col.split_at_mut(right.len());
            for (((x, i), u), r) in head.iter_mut().zip(inverse).zip(up).zip(right) {
                *x = u * r - i * *x;
            }
            for (x, i) in last.iter_mut().zip(&inverse[right.len()..]) {
                *x *= -i;
            }
        }
    }

    /// The diagonal of x ← Δ⁻¹x, with Σ x_ii = 0: fluxes are the sums of sources.
    fn solve_diagonal(&self, x: &mut Mat<f64>) {
        let n = self.n;
        let mean = (0..n).map(|i| x[(i, i)]).sum::<f64>() / n as f64;
        let (mut through, mut level, mut total) = (0.0, 0.0, 0.0);
        for i in 0..n {
            let source = x[(i, i)] - mean;
            if i > 0 {
                level += through / flux(n, i);
            }
            through += source;
            x[(i, i)] = level;
            total += level;
        }
        let mean = total / n as f64;
        (0..n).for_each(|i| x[(i, i)] -= mean);
    }
}

/// Column j of a matrix whose columns are contiguous.
/// Its entries below the diagonal.
fn triangle(n: usize) -> usize {
    n * n.saturating_sub(1) / 2
}

fn slice(x: faer::MatRef<'_, f64>, j: usize) -> &[f64] {
    x.col(j).try_as_col_major().map_or(&[], |c| c.as_slice())
}
fn slice_mut(x: faer::MatMut<'_, f64>, j: usize) -> &mut [f64] {
    x.col_mut(j).try_as_col_major_mut().map_or(&mut [], |c| c.as_slice_mut())
}

impl Surface for Sphere {
    fn n(&self) -> usize {
        self.n
    }
    /// 1/ħ = ½√(N² − 1).
    fn rate(&self) -> f64 {
        0.5 * (((self.n - 1) * (self.n + 1)) as f64).sqrt()
    }
    fn solve(&self, x: &mut ComplexMatrix, _: &mut [Mat<f64>; 2]) {
        // Forward below the first column; backward a product each, and one more with a neighbour.
        let (below, inner) = (triangle(self.n), triangle(self.n.saturating_sub(1)));
        tally(|| (Ops::muls(below) + Ops::muladds(2 * inner)) * 2);
        tally(|| (Ops::adds(6) + Ops::divs(1)) * self.n);
        for part in x.parts_mut() {
            wide(self.n, || self.solve_below(part));
        }
        self.solve_diagonal(&mut x.im);
        (0..self.n).for_each(|i| x.re[(i, i)] = 0.0);
    }
    fn scratch(&self) -> [Mat<f64>; 2] {
        [Mat::new(), Mat::new()]
    }
    fn momenta(&self) -> &'static [&'static str] {
        &["angular momentum x", "angular momentum y", "angular momentum z"]
    }
    fn momenta_at(&self, w: &ComplexMatrix) -> Vec<f64> {
        self.angular_momentum(w).into()
    }
}

impl Sphere {
    /// ΔP. Allocates.
    pub fn laplacian(&self, p: &ComplexMatrix) -> ComplexMatrix {
        let n = self.n;
        let mut w = ComplexMatrix::zeros(n, n);
        for (w, p) in w.parts_mut().into_iter().zip(p.parts()) {
            for c in 0..n {
                for r in 0..n {
                    let (i, m) = (r.min(c), r.abs_diff(c));
                    let ((q, _, o), (next, _, o_next)) = (entries(n, m, i), entries(n, m, i + 1));
                    let mut x = -((m * m) as f64 + q + next) * p[(r, c)];
                    if i > 0 {
                        x += o * p[(r - 1, c - 1)];
                    }
                    if i + m + 1 < n {
                        x += o_next * p[(r + 1, c + 1)];
                    }
                    w[(r, c)] = x;
                }
            }
        }
        w
    }

    /// The mean of x × u, which is that of ω x, along x, y, z: ⟨ħ iJ_a, W⟩.
    pub fn angular_momentum(&self, w: &ComplexMatrix) -> [f64; 3] {
        let scale = 1.0 / (self.rate() * self.n as f64);
        [0, 1, 2].map(|axis| {
            let j = self.spin(axis);
            let dot = |a: &Mat<f64>, b: &Mat<f64>| {
                let column =
                    |c| a.col_as_slice(c).iter().zip(b.col_as_slice(c)).map(|(a, b)| a * b);
                (0..self.n).flat_map(column).sum::<f64>()
            };
            scale * (dot(&j.re, &w.re) + dot(&j.im, &w.im))
        })
    }

    /// iJ_a, the generators of rotations in u(N): \[iJ₁, iJ₂\] = −iJ₃.
    pub fn spin(&self, axis: usize) -> ComplexMatrix {
        let n = self.n;
        let mut x = ComplexMatrix::zeros(n, n);
        for i in 0..n {
            match axis {
                2 => x.im[(i, i)] = 0.5 * (n as f64 - 1.0) - i as f64,
                _ if i == 0 => {}
                // J₊ raises: row i − 1, column i.
                0 => {
                    let j = 0.5 * flux(n, i).sqrt();
                    (x.im[(i - 1, i)], x.im[(i, i - 1)]) = (j, j);
                }
                _ => {
                    let j = 0.5 * flux(n, i).sqrt();
                    (x.re[(i - 1, i)], x.re[(i, i - 1)]) = (j, -j);
                }
            }
        }
        x
    }
}
