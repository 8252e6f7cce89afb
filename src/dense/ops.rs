//! Products, sums and norms.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as matmul_triangular};
use faer::{Accum, Mat, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};

/// The largest n with a const-size kernel.
pub(crate) const SMALL: usize = 8;
/// From this n on one triangle is cheaper than the whole product.
const HALF_FROM: usize = 48;

/// out ← a·b.
pub(crate) fn mul(out: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    product(out, a, b, 1.0, Accum::Replace);
}

/// out ← out + alpha·a·b.
pub(crate) fn mul_add(out: &mut Mat<f64>, alpha: f64, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    product(out, a, b, alpha, Accum::Add);
}

fn product(out: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, alpha: f64, accum: Accum) {
    let n = a.nrows();
    let square = a.ncols() == n && b.nrows() == n && b.ncols() == n;
    match n {
        1 if square => small::<1>(out, a, b, alpha, accum),
        2 if square => small::<2>(out, a, b, alpha, accum),
        3 if square => small::<3>(out, a, b, alpha, accum),
        4 if square => small::<4>(out, a, b, alpha, accum),
        5 if square => small::<5>(out, a, b, alpha, accum),
        6 if square => small::<6>(out, a, b, alpha, accum),
        7 if square => small::<7>(out, a, b, alpha, accum),
        SMALL if square => small::<SMALL>(out, a, b, alpha, accum),
        _ => matmul(out.as_mut(), accum, a, b, alpha, Par::Seq),
    }
}

/// out ← a·b, known to be symmetric (`sign` = 1) or skew (`sign` = −1).
pub(crate) fn half_mul(out: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, sign: f64) {
    let n = a.nrows();
    if n < HALF_FROM {
        mul(out, a, b);
        return;
    }
    let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    matmul_triangular(out.as_mut(), lower, Accum::Replace, a, full, b, full, 1.0, Par::Seq);
    mirror(out, sign);
}

/// The upper triangle ← `sign` times the lower one, in tiles that stay in the cache.
fn mirror(x: &mut Mat<f64>, sign: f64) {
    const TILE: usize = 16;
    let n = x.nrows();
    let mut tile = [[0.0; TILE]; TILE];
    for low in (0..n).step_by(TILE) {
        let high = n.min(low + TILE);
        for top in (low..n).step_by(TILE) {
            let bottom = n.min(top + TILE);
            for j in low..high {
                let col = &x.col_as_slice(j)[top..bottom];
                tile[j - low][..col.len()].copy_from_slice(col);
            }
            for i in top..bottom {
                let col = &mut x.col_as_slice_mut(i)[low..high.min(i)];
                for (j, x) in col.iter_mut().enumerate() {
                    *x = sign * tile[j][i - top];
                }
            }
        }
    }
}

/// The columns of an N×N matrix.
#[inline(always)]
pub(super) fn load<const N: usize>(a: MatRef<'_, f64>) -> [[f64; N]; N] {
    let mut cols = [[0.0; N]; N];
    for j in 0..N {
        let col = a.col(j);
        match col.try_as_col_major() {
            Some(col) => cols[j].copy_from_slice(col.as_slice()),
            None => {
                for i in 0..N {
                    cols[j][i] = col[i];
                }
            }
        }
    }
    cols
}

fn small<const N: usize>(
    out: &mut Mat<f64>,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    alpha: f64,
    accum: Accum,
) {
    let (a, b) = (load::<N>(a), load::<N>(b));
    for j in 0..N {
        let mut col = [0.0; N];
        for k in 0..N {
            for i in 0..N {
                col[i] += a[k][i] * b[j][k];
            }
        }
        let out = &mut out.col_as_slice_mut(j)[..N];
        match accum {
            Accum::Replace => {
                for i in 0..N {
                    out[i] = alpha * col[i];
                }
            }
            Accum::Add => {
                for i in 0..N {
                    out[i] += alpha * col[i];
                }
            }
        }
    }
}

/// y ← y + a·x.
pub(crate) fn axpy(a: f64, x: &Mat<f64>, y: &mut Mat<f64>) {
    for j in 0..y.ncols() {
        for (y, x) in y.col_as_slice_mut(j).iter_mut().zip(x.col_as_slice(j)) {
            *y += a * x;
        }
    }
}

/// out ← Σ c_i·x_i + d·𝟙, in one pass.
pub(crate) fn scaled_sum<const K: usize>(
    out: &mut Mat<f64>,
    c: [f64; K],
    x: [&Mat<f64>; K],
    d: f64,
) {
    let op = Sum { out, c, x, d };
    if op.out.nrows() <= SMALL { op.call() } else { Arch::new().dispatch(op) }
}

/// A sum of matrices, compiled for every instruction set.
struct Sum<'a, const K: usize> {
    out: &'a mut Mat<f64>,
    c: [f64; K],
    x: [&'a Mat<f64>; K],
    d: f64,
}

impl<const K: usize> NullaryFnOnce for Sum<'_, K> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Sum { out, c, x, d } = self;
        for j in 0..out.ncols() {
            let out = out.col_as_slice_mut(j);
            let mut cols: [&[f64]; K] = [&[]; K];
            for k in 0..K {
                cols[k] = &x[k].col_as_slice(j)[..out.len()];
            }
            for i in 0..out.len() {
                let mut s = 0.0;
                for k in 0..K {
                    s += c[k] * cols[k][i];
                }
                out[i] = s;
            }
            if let Some(o) = out.get_mut(j) {
                *o += d;
            }
        }
    }
}

/// p ← p − pᵀ. With p = u·v and u, v skew this is \[u, v\] for one product.
pub(crate) fn antisymmetrise(p: &mut Mat<f64>) {
    for j in 0..p.ncols() {
        p[(j, j)] = 0.0;
        for i in j + 1..p.nrows() {
            let d = p[(i, j)] - p[(j, i)];
            p[(i, j)] = d;
            p[(j, i)] = -d;
        }
    }
}

/// Σ f(x), in eight sums side by side.
#[inline(always)]
fn sum(x: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let mut sums = [0.0; 8];
    let mut chunks = x.chunks_exact(8);
    for chunk in &mut chunks {
        for k in 0..8 {
            sums[k] += f(chunk[k]);
        }
    }
    let rest: f64 = chunks.remainder().iter().map(|x| f(*x)).sum();
    let [a, b, c, d, e, g, h, i] = sums;
    ((a + b) + (c + d)) + ((e + g) + (h + i)) + rest
}

/// The 1-norm: the largest absolute column sum. NaN when an entry is NaN.
pub(crate) fn norm1(x: MatRef<'_, f64>) -> f64 {
    let mut best = 0.0;
    for j in 0..x.ncols() {
        let s = match x.col(j).try_as_col_major() {
            Some(col) => sum(col.as_slice(), f64::abs),
            None => x.col(j).iter().map(|x| x.abs()).sum(),
        };
        if s > best || s.is_nan() {
            best = s;
        }
    }
    best
}

/// The Frobenius norm.
pub(crate) fn norm_frobenius(x: &Mat<f64>) -> f64 {
    let s: f64 = (0..x.ncols()).map(|j| sum(x.col_as_slice(j), |x| x * x)).sum();
    if s.is_normal() {
        s.sqrt()
    } else {
        x.norm_l2() // the squares left the range; faer scales
    }
}

/// Is every entry finite? Not by sums of moduli: they overflow where no entry does.
pub(crate) fn is_finite(x: &Mat<f64>) -> bool {
    (0..x.ncols()).all(|j| sum(x.col_as_slice(j), |x| 0.0 * x) == 0.0)
}

/// g ← g + g(𝟙 − gᵀg)/2 until ‖𝟙 − gᵀg‖ is at rounding level. What a solve or squarings have
/// amplified to κε, Newton–Schulz in residual form takes back to ε. Returns the number of steps.
pub(crate) fn orthogonalise(g: &mut Mat<f64>, [gap, product]: [&mut Mat<f64>; 2]) -> u32 {
    let mut last = f64::INFINITY;
    for step in 0..6 {
        half_mul(product, g.transpose(), g.as_ref(), 1.0);
        scaled_sum(gap, [-0.5], [product], 0.5);
        let residual = norm1(gap.as_ref());
        if residual <= f64::EPSILON || residual.is_nan() || residual >= 0.5 * last {
            return step; // what is left is the rounding of gᵀg itself
        }
        last = residual;
        mul(product, g.as_ref(), gap.as_ref());
        axpy(1.0, product, g);
        if residual <= 1e-9 {
            return step + 1; // the next residual is the square of this one
        }
    }
    6
}
