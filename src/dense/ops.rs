//! Products, sums and norms.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as matmul_triangular};
use faer::{Accum, Mat, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};

/// The largest n with a const-size kernel.
pub(crate) const SMALL: usize = 8;
/// From this n on one triangle is cheaper than the whole product.
pub(crate) const HALF_FROM: usize = 48;
/// From this n on faer's own triangle is faster than panels of [`PANEL`] columns.
const TRIANGLE_FROM: usize = 224;
const PANEL: usize = 16;

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
    half_product(out, a, b, Accum::Replace, sign);
}

/// out ← out + a·b, where both are symmetric.
pub(crate) fn half_mul_add(out: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    half_product(out, a, b, Accum::Add, 1.0);
}

fn half_product(
    out: &mut Mat<f64>,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    accum: Accum,
    sign: f64,
) {
    lower_product(out, a, b, 1.0, accum);
    if a.nrows() >= HALF_FROM {
        mirror(out, sign);
    }
}

/// The lower triangle of out ← a·b (or out + alpha·a·b); the upper one holds nothing of use.
pub(crate) fn lower_product(
    out: &mut Mat<f64>,
    a: MatRef<'_, f64>,
    b: MatRef<'_, f64>,
    alpha: f64,
    accum: Accum,
) {
    let n = a.nrows();
    if n < HALF_FROM {
        product(out, a, b, alpha, accum);
    } else if n < TRIANGLE_FROM {
        for j in (0..n).step_by(PANEL) {
            let width = PANEL.min(n - j);
            let panel = out.as_mut().submatrix_mut(j, j, n - j, width);
            let (a, b) = (a.subrows(j, n - j), b.subcols(j, width));
            matmul(panel, accum, a, b, alpha, Par::Seq);
        }
    } else {
        let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        matmul_triangular(out.as_mut(), lower, accum, a, full, b, full, alpha, Par::Seq);
    }
}

/// The upper triangle ← `sign` times the lower one.
pub(crate) fn mirror(x: &mut Mat<f64>, sign: f64) {
    wide(x.nrows(), Mirror { x, sign });
}

/// The upper triangle ← `sign` times the lower one, in tiles that are transposed in registers.
struct Mirror<'a> {
    x: &'a mut Mat<f64>,
    sign: f64,
}

impl NullaryFnOnce for Mirror<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Mirror { x, sign } = self;
        let n = x.nrows();
        for left in (0..n).step_by(CHUNK) {
            let width = CHUNK.min(n - left);
            for top in (left..n).step_by(CHUNK) {
                let height = CHUNK.min(n - top);
                let mut tile = [[0.0; CHUNK]; CHUNK];
                for j in 0..width {
                    let col = &x.col_as_slice(left + j)[top..];
                    match col.first_chunk() {
                        Some(whole) => tile[j] = *whole,
                        None => tile[j][..height].copy_from_slice(col),
                    }
                }
                for i in 0..height {
                    let mut row = [0.0; CHUNK];
                    for j in 0..CHUNK {
                        row[j] = sign * tile[j][i];
                    }
                    let above = if top == left { i } else { width };
                    let col = &mut x.col_as_slice_mut(top + i)[left..];
                    match col.first_chunk_mut() {
                        Some(whole) if above == CHUNK => *whole = row,
                        _ => col[..above].copy_from_slice(&row[..above]),
                    }
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
    add_scaled_sum(y, [a], [x], 0.0);
}

/// out ← Σ c_i·x_i + d·𝟙, in one pass.
pub(crate) fn scaled_sum<const K: usize>(
    out: &mut Mat<f64>,
    c: [f64; K],
    x: [&Mat<f64>; K],
    d: f64,
) {
    wide(out.nrows(), Sums { out: [out], c: [c], x, d: [d], add: false });
}

/// out ← out + Σ c_i·x_i + d·𝟙, in one pass.
pub(crate) fn add_scaled_sum<const K: usize>(
    out: &mut Mat<f64>,
    c: [f64; K],
    x: [&Mat<f64>; K],
    d: f64,
) {
    wide(out.nrows(), Sums { out: [out], c: [c], x, d: [d], add: true });
}

/// out_m ← Σ c_mi·x_i + d_m·𝟙 for every m, in one pass: from n = 128 on what a sum costs is the way
/// of its matrices through the caches.
pub(crate) fn scaled_sums<const K: usize, const M: usize>(
    out: [&mut Mat<f64>; M],
    c: [[f64; K]; M],
    x: [&Mat<f64>; K],
    d: [f64; M],
) {
    wide(x[0].nrows(), Sums { out, c, x, d, add: false });
}

/// `op` with the widest instructions there are, where n is worth the choice.
pub(crate) fn wide<Op: NullaryFnOnce>(n: usize, op: Op) -> Op::Output {
    if n <= SMALL { op.call() } else { Arch::new().dispatch(op) }
}

/// Entries that are treated at once.
const CHUNK: usize = 8;

/// M sums of the same K matrices, compiled for every instruction set.
struct Sums<'a, const K: usize, const M: usize> {
    out: [&'a mut Mat<f64>; M],
    c: [[f64; K]; M],
    x: [&'a Mat<f64>; K],
    d: [f64; M],
    add: bool,
}

impl<const K: usize, const M: usize> NullaryFnOnce for Sums<'_, K, M> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Sums { mut out, c, x, d, add } = self;
        let (rows, columns) = x.first().map_or((0, 0), |x| (x.nrows(), x.ncols()));
        let whole = rows - rows % CHUNK;
        for j in 0..columns {
            let mut cols: [&[f64]; K] = [&[]; K];
            for k in 0..K {
                cols[k] = &x[k].col_as_slice(j)[..rows];
            }
            let out = out.each_mut().map(|out| &mut out.col_as_slice_mut(j)[..rows]);
            for i in (0..whole).step_by(CHUNK) {
                let mut part = [[0.0; CHUNK]; K];
                for k in 0..K {
                    part[k].copy_from_slice(&cols[k][i..i + CHUNK]);
                }
                for m in 0..M {
                    let out = &mut out[m][i..i + CHUNK];
                    let mut s = [0.0; CHUNK];
                    if add {
                        s.copy_from_slice(out);
                    }
                    for k in 0..K {
                        for l in 0..CHUNK {
                            s[l] += c[m][k] * part[k][l];
                        }
                    }
                    out.copy_from_slice(&s);
                }
            }
            for m in 0..M {
                for i in whole..rows {
                    let mut s = if add { out[m][i] } else { 0.0 };
                    for k in 0..K {
                        s += c[m][k] * cols[k][i];
                    }
                    out[m][i] = s;
                }
                if let Some(o) = out[m].get_mut(j) {
                    *o += d[m];
                }
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

/// Σ f(x_i), in eight sums side by side.
#[inline(always)]
fn sum(x: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let mut sums = [0.0; CHUNK];
    let (chunks, rest) = x.as_chunks::<CHUNK>();
    for chunk in chunks {
        for k in 0..CHUNK {
            sums[k] += f(chunk[k]);
        }
    }
    let [a, b, c, d, e, g, h, i] = sums;
    let rest: f64 = rest.iter().map(|x| f(*x)).sum();
    ((a + b) + (c + d)) + ((e + g) + (h + i)) + rest
}

/// The 1-norm: the largest absolute column sum. NaN when an entry is NaN.
pub(crate) fn norm1(x: MatRef<'_, f64>) -> f64 {
    wide(x.nrows(), Norm1(x))
}

struct Norm1<'a>(MatRef<'a, f64>);

impl NullaryFnOnce for Norm1<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let mut best = 0.0;
        for j in 0..self.0.ncols() {
            let col = self.0.col(j);
            let s = match col.try_as_col_major() {
                Some(col) => sum(col.as_slice(), f64::abs),
                None => col.iter().map(|x| x.abs()).sum(),
            };
            if s > best || s.is_nan() {
                best = s;
            }
        }
        best
    }
}

/// y ← |a|ᵀx for x, y ≥ 0; returns the largest y_j.
pub(crate) fn abs_mul(a: &Mat<f64>, x: &[f64], y: &mut [f64]) -> f64 {
    wide(a.nrows(), AbsMul { a, x, y })
}

struct AbsMul<'a> {
    a: &'a Mat<f64>,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl NullaryFnOnce for AbsMul<'_> {
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let AbsMul { a, x, y } = self;
        let (chunks, rest) = x.as_chunks::<CHUNK>();
        let mut top = 0.0f64;
        for (j, y) in y.iter_mut().enumerate() {
            let (cols, tail) = a.col_as_slice(j).as_chunks::<CHUNK>();
            let mut sums = [0.0; CHUNK];
            for (a, x) in cols.iter().zip(chunks) {
                for l in 0..CHUNK {
                    sums[l] += a[l].abs() * x[l];
                }
            }
            let tail: f64 = tail.iter().zip(rest).map(|(a, x)| a.abs() * x).sum();
            *y = sum(&sums, |s| s) + tail;
            top = top.max(*y);
        }
        top
    }
}

/// The sums of moduli off the diagonal, along rows and along columns.
pub(crate) fn abs_sums(a: &Mat<f64>, rows: &mut [f64], cols: &mut [f64]) {
    rows.fill(0.0);
    for (j, c) in cols.iter_mut().enumerate() {
        let col = a.col_as_slice(j);
        for (i, (r, a)) in rows.iter_mut().zip(col).enumerate() {
            *r += if i == j { 0.0 } else { a.abs() };
        }
        *c = sum(&col[..j], f64::abs) + sum(&col[j + 1..], f64::abs);
    }
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
