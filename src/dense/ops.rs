//! Sums and norms.

use faer::{Mat, MatRef, c64};
use pulp::{Arch, NullaryFnOnce};

use crate::scalar::{Ops, tally};

/// The largest n with a const-size LU, and without a choice of wide instructions.
pub(crate) const SMALL: usize = 8;

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
    tally_sum(K, x[0], d, false);
    wide(out.nrows(), Sums { out: [out], c: [c], x, d: [d], add: false });
}

/// out ← out + Σ c_i·x_i + d·𝟙, in one pass.
pub(crate) fn add_scaled_sum<const K: usize>(
    out: &mut Mat<f64>,
    c: [f64; K],
    x: [&Mat<f64>; K],
    d: f64,
) {
    tally_sum(K, x[0], d, true);
    wide(out.nrows(), Sums { out: [out], c: [c], x, d: [d], add: true });
}

/// out_m ← Σ c_mi·x_i + d_m·𝟙 for every m, in one pass. From n = 128 on memory decides the cost of a sum.
pub(crate) fn scaled_sums<const K: usize, const M: usize>(
    out: [&mut Mat<f64>; M],
    c: [[f64; K]; M],
    x: [&Mat<f64>; K],
    d: [f64; M],
) {
    d.iter().for_each(|d| tally_sum(K, x[0], *d, false));
    wide(x[0].nrows(), Sums { out, c, x, d, add: false });
}

/// The operations of a sum of K matrices.
#[inline(always)]
fn tally_sum(k: usize, like: &Mat<f64>, d: f64, add: bool) {
    let (rows, columns) = (like.nrows(), like.ncols());
    let diagonal = if d == 0.0 { 0 } else { rows.min(columns) };
    let entries = rows * columns;
    tally(|| Ops::dots(entries, k) + Ops::adds(diagonal + if add { entries } else { 0 }));
}

/// Runs `op` with the widest instructions of the machine, if n is large enough for the choice.
pub(crate) fn wide<Op: NullaryFnOnce>(n: usize, op: Op) -> Op::Output {
    if n <= SMALL { op.call() } else { Arch::new().dispatch(op) }
}

/// The number of entries processed at once.
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
        let is_like = |m: &Mat<f64>| (m.nrows(), m.ncols()) == (rows, columns);
        if !(x.iter().all(|x| is_like(x)) && out.iter().all(|out| is_like(out))) {
            // A matrix of another size comes from a function of the caller: no number of it is used.
            return out.iter_mut().for_each(|out| out.fill(f64::NAN));
        }
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

/// Σ f(x_i), in eight sums at once.
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
    tally(|| Ops::adds(x.nrows().saturating_sub(1) * x.ncols()));
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
    tally(|| Ops::dots(y.len(), x.len()));
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
    tally(|| Ops::adds(2 * rows.len() * cols.len().saturating_sub(2)));
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
    tally(|| Ops::dots(1, x.nrows() * x.ncols()) + Ops::sqrts(1));
    let s: f64 = (0..x.ncols()).map(|j| sum(x.col_as_slice(j), |x| x * x)).sum();
    if s.is_normal() {
        s.sqrt()
    } else {
        x.norm_l2() // the squares left the range; faer scales
    }
}

/// The Frobenius norm of a matrix that is not stored.
pub(crate) fn norm_of(rows: usize, cols: usize, entry: impl Fn(usize, usize) -> f64) -> f64 {
    let sum = |term: &dyn Fn(f64) -> f64| -> f64 {
        (0..cols).map(|j| (0..rows).map(|i| term(entry(i, j))).sum::<f64>()).sum()
    };
    let square = sum(&|x| x * x);
    if square.is_normal() {
        return square.sqrt();
    }
    // The squares left the range.
    let entries = (0..cols).flat_map(|j| (0..rows).map(move |i| (i, j)));
    let top = entries.fold(0.0, |top: f64, (i, j)| top.max(entry(i, j).abs()));
    if top > 0.0 && top.is_finite() { top * sum(&|x| (x / top).powi(2)).sqrt() } else { top }
}

/// True if every entry is finite. It does not use sums of moduli, which may overflow although no entry does.
pub(crate) fn is_finite(x: &Mat<f64>) -> bool {
    (0..x.ncols()).all(|j| sum(x.col_as_slice(j), |x| 0.0 * x) == 0.0)
}

/// z ← X + iY of x = \[X −Y; Y X\], by its first columns.
pub(crate) fn complex_of_blocks(x: &Mat<f64>, z: &mut Mat<c64>) {
    let n = z.nrows();
    for j in 0..n {
        for i in 0..n {
            z[(i, j)] = c64::new(x[(i, j)], x[(n + i, j)]);
        }
    }
}

/// x ← \[X −Y; Y X\] of z = X + iY.
pub(crate) fn blocks_of_complex(z: &Mat<c64>, x: &mut Mat<f64>) {
    let n = z.nrows();
    for j in 0..n {
        for i in 0..n {
            let z = z[(i, j)];
            (x[(i, j)], x[(n + i, n + j)]) = (z.re, z.re);
            (x[(n + i, j)], x[(i, n + j)]) = (z.im, -z.im);
        }
    }
}
