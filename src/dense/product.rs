//! Matrix products, full or of one triangle.
//!
//! | n | product |
//! |---|---|
//! | up to 6 | const size, in line |
//! | 7, 8 | const size, the widest instructions of the machine |
//! | 9 … 16 | faer's; our own kernel if the left matrix is stored by rows |
//! | larger | faer's |

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as matmul_triangular};
use faer::{Accum, Mat, MatRef, Par};
use pulp::{Arch, NullaryFnOnce, Simd};

use super::expm::cols::{Cols, Kernel, N_MAX, dispatch};
use super::expm::taylor::Packed;
use super::ops::{SMALL, axpy, norm1, scaled_sum, wide};
use crate::scalar::{Ops, tally};

/// From this n on one triangle is cheaper than the full product.
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
    if a.ncols() != b.nrows() || (out.nrows(), out.ncols()) != (n, b.ncols()) {
        // A matrix of another size comes from a function of the caller: no number of it is used.
        return out.fill(f64::NAN);
    }
    let square = a.ncols() == n && b.ncols() == n;
    let add = matches!(accum, Accum::Add);
    tally_product(n * b.ncols(), a.ncols(), alpha, add);
    match n {
        1 if square => Small::<1> { a, b, alpha, add, out }.call(),
        2 if square => Small::<2> { a, b, alpha, add, out }.call(),
        3 if square => Small::<3> { a, b, alpha, add, out }.call(),
        4 if square => Small::<4> { a, b, alpha, add, out }.call(),
        5 if square => Small::<5> { a, b, alpha, add, out }.call(),
        6 if square => Small::<6> { a, b, alpha, add, out }.call(),
        7 if square => Arch::new().dispatch(Small::<7> { a, b, alpha, add, out }),
        SMALL if square => Arch::new().dispatch(Small::<SMALL> { a, b, alpha, add, out }),
        // The library is at half its speed where a lies by rows.
        9..=N_MAX if square && a.row_stride() != 1 => {
            dispatch(Arch::new(), n, Product { a, b, alpha, add, out });
        }
        _ => matmul(out.as_mut(), accum, a, b, alpha, Par::Seq),
    }
}

/// The operations of `entries` entries of a product.
#[inline(always)]
fn tally_product(entries: usize, k: usize, alpha: f64, add: bool) {
    let scaled = if alpha.abs() == 1.0 { 0 } else { entries };
    let added = if add { entries } else { 0 };
    tally(|| Ops::dots(entries, k) + Ops::muls(scaled) + Ops::adds(added));
}

/// out ← alpha·a·b, or out ← out + alpha·a·b, of const size.
struct Small<'a, const N: usize> {
    a: MatRef<'a, f64>,
    b: MatRef<'a, f64>,
    alpha: f64,
    add: bool,
    out: &'a mut Mat<f64>,
}

impl<const N: usize> NullaryFnOnce for Small<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Small { a, b, alpha, add, out } = self;
        let (a, b) = (load::<N>(a), load::<N>(b));
        for j in 0..N {
            let mut col = [0.0; N];
            for k in 0..N {
                for i in 0..N {
                    col[i] += a[k][i] * b[j][k];
                }
            }
            let out = &mut out.col_as_slice_mut(j)[..N];
            for i in 0..N {
                out[i] = if add { out[i] + alpha * col[i] } else { alpha * col[i] };
            }
        }
    }
}

/// out ← alpha·a·b, or out ← out + alpha·a·b, for any n up to [`N_MAX`].
struct Product<'a> {
    a: MatRef<'a, f64>,
    b: MatRef<'a, f64>,
    alpha: f64,
    add: bool,
    out: &'a mut Mat<f64>,
}

impl Kernel for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn call<S: Simd, const N: usize, const K: usize>(self, simd: S) {
        let Product { a, b, alpha, add, out } = self;
        let a = Cols::<S, N, K>::load(simd, a);
        let mut b = Cols::<S, N, K>::load(simd, b);
        if alpha != 1.0 {
            b = Cols::sum(simd, [alpha], [&b], 0.0);
        }
        if add {
            let mut sum = Cols::<S, N, K>::load(simd, out.as_ref());
            sum.mul_add(simd, &a, &b);
            sum.store(out);
        } else {
            Cols::mul(simd, &a, &b).store(out);
        }
    }
}

/// out ← a b, of the right size. Allocates nothing for small matrices. Cost: O(n³).
pub fn multiply_into(out: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    mul(out, a, b);
}

/// out ← a·b, known to be symmetric (`sign` = 1) or skew (`sign` = −1).
pub(crate) fn half_mul(out: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>, sign: f64) {
    half_product(out, a, b, Accum::Replace, sign);
}

/// out ← out + a·b, where both are symmetric.
pub(crate) fn half_mul_add(out: &mut Mat<f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    half_product(out, a, b, Accum::Add, 1.0);
}

/// out ← g·p·gᵀ. From [`HALF_FROM`] on one triangle is enough, if p is exactly symmetric or skew.
pub(crate) fn congruence(out: &mut Mat<f64>, g: &Mat<f64>, p: &Mat<f64>, product: &mut Mat<f64>) {
    mul(product, g.as_ref(), p.as_ref());
    let n = p.nrows();
    let sign = if n < HALF_FROM { None } else { wide(n, Symmetry(p)) };
    match sign {
        Some(sign) => half_mul(out, product.as_ref(), g.transpose(), sign),
        None => mul(out, product.as_ref(), g.transpose()),
    }
}

/// out ← v·p − p·v for a skew v. It takes one product if p is exactly symmetric or skew.
pub(crate) fn skew_commutator(out: &mut Mat<f64>, v: &Mat<f64>, p: &Mat<f64>) {
    mul(out, v.as_ref(), p.as_ref());
    match wide(p.nrows(), Symmetry(p)) {
        Some(1.0) => add_transpose(out),
        Some(_) => antisymmetrise(out),
        None => mul_add(out, -1.0, p.as_ref(), v.as_ref()),
    }
}

/// x ← x + xᵀ.
fn add_transpose(x: &mut Mat<f64>) {
    tally(|| Ops::adds(x.ncols() * (x.ncols() + 1) / 2));
    for j in 0..x.ncols() {
        for i in 0..=j {
            let sum = x[(i, j)] + x[(j, i)];
            (x[(i, j)], x[(j, i)]) = (sum, sum);
        }
    }
}

/// The sign for which x = ±xᵀ, entry by entry.
struct Symmetry<'a>(&'a Mat<f64>);

impl NullaryFnOnce for Symmetry<'_> {
    type Output = Option<f64>;

    #[inline(always)]
    fn call(self) -> Option<f64> {
        let Symmetry(x) = self;
        let n = x.nrows();
        let whole = n - n % TILE;
        let (mut symmetric, mut skew) = (true, true);
        for left in (0..whole).step_by(TILE) {
            for top in (left..whole).step_by(TILE) {
                let (low, high) = (tile(x, top, left), transpose(&tile(x, left, top)));
                let (mut sum, mut difference) = (0.0, 0.0);
                for j in 0..TILE {
                    for i in 0..TILE {
                        sum += (low[j][i] + high[j][i]).abs();
                        difference += (low[j][i] - high[j][i]).abs();
                    }
                }
                symmetric &= difference == 0.0;
                skew &= sum == 0.0;
            }
            if !symmetric && !skew {
                return None;
            }
        }
        for i in whole..n {
            for j in 0..=i {
                symmetric &= x[(i, j)] == x[(j, i)];
                skew &= x[(i, j)] == -x[(j, i)];
            }
        }
        match (symmetric, skew) {
            (true, _) => Some(1.0),
            (_, true) => Some(-1.0),
            _ => None,
        }
    }
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

/// The lower triangle of out ← a·b (or out + alpha·a·b); the upper one is undefined.
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
            tally_product((n - j) * width, n, alpha, matches!(accum, Accum::Add));
            matmul(panel, accum, a, b, alpha, Par::Seq);
        }
    } else {
        tally_product(n * (n + 1) / 2, n, alpha, matches!(accum, Accum::Add));
        let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        matmul_triangular(out.as_mut(), lower, accum, a, full, b, full, alpha, Par::Seq);
    }
}

/// The upper triangle ← `sign` times the lower one.
pub(crate) fn mirror(x: &mut Mat<f64>, sign: f64) {
    wide(x.nrows(), Mirror::<false> { x, sign });
}

/// x ← L + sign·Lᵀ above the diagonal, with L the lower triangle of x, or of x − xᵀ where DIFFERENCE:
/// in tiles that are transposed in registers.
struct Mirror<'a, const DIFFERENCE: bool> {
    x: &'a mut Mat<f64>,
    sign: f64,
}

/// The side of a tile: four rows are four registers of AVX2.
const TILE: usize = 4;
type Tile = [[f64; TILE]; TILE];

impl<const DIFFERENCE: bool> NullaryFnOnce for Mirror<'_, DIFFERENCE> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Mirror { x, sign } = self;
        let n = x.nrows();
        let whole = n - n % TILE;
        for left in (0..whole).step_by(TILE) {
            for top in (left..whole).step_by(TILE) {
                let mut low = tile(x, top, left);
                if DIFFERENCE {
                    let high = transpose(&tile(x, left, top));
                    for j in 0..TILE {
                        for i in 0..TILE {
                            low[j][i] -= high[j][i];
                        }
                    }
                    set_tile(x, top, left, &low);
                }
                let mut high = transpose(&low);
                for j in 0..TILE {
                    for i in 0..TILE {
                        high[j][i] *= sign;
                        if top == left && i >= j {
                            high[j][i] = low[j][i];
                        }
                    }
                }
                set_tile(x, left, top, &high);
            }
        }
        for i in whole..n {
            for j in 0..=i {
                if DIFFERENCE {
                    x[(i, j)] -= x[(j, i)];
                }
                if j < i {
                    x[(j, i)] = sign * x[(i, j)];
                }
            }
        }
    }
}

#[inline(always)]
fn tile(x: &Mat<f64>, top: usize, left: usize) -> Tile {
    let mut tile = [[0.0; TILE]; TILE];
    for j in 0..TILE {
        tile[j].copy_from_slice(&x.col_as_slice(left + j)[top..top + TILE]);
    }
    tile
}

#[inline(always)]
fn set_tile(x: &mut Mat<f64>, top: usize, left: usize, tile: &Tile) {
    for j in 0..TILE {
        x.col_as_slice_mut(left + j)[top..top + TILE].copy_from_slice(&tile[j]);
    }
}

#[inline(always)]
fn transpose(x: &Tile) -> Tile {
    let mut out = [[0.0; TILE]; TILE];
    for j in 0..TILE {
        for i in 0..TILE {
            out[j][i] = x[i][j];
        }
    }
    out
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

/// p ← p − pᵀ. With p = u·v and u, v skew this is \[u, v\] for one product.
pub(crate) fn antisymmetrise(p: &mut Mat<f64>) {
    tally(|| Ops::adds(p.nrows() * p.ncols().saturating_sub(1) / 2));
    if p.nrows() > N_MAX {
        return wide(p.nrows(), Mirror::<true> { x: p, sign: -1.0 });
    }
    for j in 0..p.ncols() {
        p[(j, j)] = 0.0;
        for i in j + 1..p.nrows() {
            let d = p[(i, j)] - p[(j, i)];
            p[(i, j)] = d;
            p[(j, i)] = -d;
        }
    }
}

/// g ← g + g(𝟙 − gᵀg)/2 until ‖𝟙 − gᵀg‖ is at rounding level. Returns the number of steps.
///
/// A solve or squarings amplify the error to κε. Newton–Schulz in residual form reduces it to ε.
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
