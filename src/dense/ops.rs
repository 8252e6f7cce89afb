//! Products, sums and norms.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};

/// The largest n with a const-size kernel.
pub(crate) const SMALL: usize = 8;

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
