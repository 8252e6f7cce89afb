//! N×N matrices in registers: const-size columns padded to whole SIMD lanes.
//!
//! Everything is `inline(always)`, so that it is compiled with the instruction set of the caller. Only the products are
//! separate functions, behind [`Simd::vectorize`].

use faer::{Mat, MatRef};
use pulp::{Arch, NullaryFnOnce, Simd, WithSimd, bytemuck};

use super::taylor::Packed;

/// The largest n with a kernel.
pub(in crate::dense) const N_MAX: usize = 16;

/// An operation on matrices in registers.
pub(in crate::dense) trait Kernel {
    /// The result; the default if there is no kernel for n.
    type Output: Default;
    /// Runs with N×N matrices, N ≥ n, whose columns are K registers. Implement it `inline(always)`.
    fn call<S: Simd, const N: usize, const K: usize>(self, simd: S) -> Self::Output;
}

/// Runs `op` for n×n matrices, 0 < n ≤ [`N_MAX`], with the widest registers of the machine.
#[inline]
pub(in crate::dense) fn dispatch<Op: Kernel>(arch: Arch, n: usize, op: Op) -> Op::Output {
    macro_rules! kernels {
        ($($range:pat => $n:literal, $k8:literal, $k4:literal, $k2:literal;)*) => {
            match n {
                $($range => arch.dispatch(Sized::<$n, $k8, $k4, $k2, Op>(op)),)*
                _ => Op::Output::default(),
            }
        };
    }
    // n ⇒ kernel size, registers a column with 8, 4 and 2 lanes.
    kernels! {
        1 | 2 => 2, 1, 1, 1;
        3 => 3, 1, 1, 2;
        4 => 4, 1, 1, 2;
        5 => 5, 1, 2, 3;
        6 => 6, 1, 2, 3;
        7 => 7, 1, 2, 4;
        8 => 8, 1, 2, 4;
        9 | 10 => 10, 2, 3, 5;
        11 | 12 => 12, 2, 3, 6;
        13 | 14 => 14, 2, 4, 7;
        15 | 16 => 16, 2, 4, 8;
    }
}

/// A kernel with its N, and its K with 8, 4 and 2 lanes.
struct Sized<const N: usize, const K8: usize, const K4: usize, const K2: usize, Op>(Op);

impl<const N: usize, const K8: usize, const K4: usize, const K2: usize, Op: Kernel> WithSimd
    for Sized<N, K8, K4, K2, Op>
{
    type Output = Op::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Op::Output {
        match S::F64_LANES {
            8 => self.0.call::<S, N, K8>(simd),
            4 => self.0.call::<S, N, K4>(simd),
            2 => self.0.call::<S, N, K2>(simd),
            _ => self.0.call::<S, N, N>(simd),
        }
    }
}

/// An N×N matrix as N columns of K registers; the padding is zero.
///
/// Aligned, because a register that straddles two cache lines is loaded and stored at half speed.
#[repr(align(64))]
pub(in crate::dense) struct Cols<S: Simd, const N: usize, const K: usize>([[S::f64s; K]; N]);

/// e_16 between zeros: `UNIT[16 − j..]` begins with e_j.
const UNIT: [f64; 48] = {
    let mut unit = [0.0; 48];
    unit[16] = 1.0;
    unit
};

#[inline(always)]
fn read<S: Simd>(x: &[f64]) -> S::f64s {
    bytemuck::pod_read_unaligned(bytemuck::cast_slice(&x[..S::F64_LANES]))
}

impl<S: Simd, const N: usize, const K: usize> Clone for Cols<S, N, K> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Simd, const N: usize, const K: usize> Copy for Cols<S, N, K> {}

impl<S: Simd, const N: usize, const K: usize> Cols<S, N, K> {
    /// The distance of two columns in doubles.
    const STRIDE: usize = K * S::F64_LANES;

    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        Cols([[simd.splat_f64s(0.0); K]; N])
    }

    /// From an n×n matrix with n ≤ N, padded with zeros. Its columns or its rows are contiguous.
    #[inline(always)]
    pub(in crate::dense) fn load(simd: S, a: MatRef<'_, f64>) -> Self {
        match a.row_stride() {
            1 => Self::load_columns(simd, a),
            _ => Self::load_columns(simd, a.transpose()).transpose(simd),
        }
    }

    #[inline(always)]
    pub(in crate::dense) fn load_columns(simd: S, a: MatRef<'_, f64>) -> Self {
        let mut out = Self::zero(simd);
        let n = a.nrows().min(N);
        let flat: &mut [f64] = bytemuck::cast_slice_mut(out.0.as_flattened_mut());
        for j in 0..N {
            if j == n {
                break;
            }
            let Some(col) = a.col(j).try_as_col_major() else { continue };
            let col = col.as_slice();
            if n == N {
                flat[j * Self::STRIDE..][..N].copy_from_slice(&col[..N]);
            } else {
                flat[j * Self::STRIDE..][..n].copy_from_slice(&col[..n]);
            }
        }
        out
    }

    #[inline(always)]
    pub(in crate::dense) fn store(&self, out: &mut Mat<f64>) {
        let n = out.nrows().min(N);
        let flat = self.flat();
        if n == N {
            for j in 0..N {
                let col = &flat[j * Self::STRIDE..][..N];
                out.col_as_slice_mut(j)[..N].copy_from_slice(col);
            }
        } else {
            for j in 0..n {
                out.col_as_slice_mut(j).copy_from_slice(&flat[j * Self::STRIDE..][..n]);
            }
        }
    }

    /// The entries by columns, with the padding.
    #[inline(always)]
    pub(super) fn flat(&self) -> &[f64] {
        bytemuck::cast_slice(self.0.as_flattened())
    }

    #[inline(always)]
    pub(super) fn transpose(&self, simd: S) -> Self {
        let mut out = Self::zero(simd);
        let (from, to) = (self.flat(), bytemuck::cast_slice_mut(out.0.as_flattened_mut()));
        for j in 0..N {
            for i in 0..N {
                let x: f64 = from[j * Self::STRIDE + i];
                to[i * Self::STRIDE + j] = x;
            }
        }
        out
    }

    /// The ∞-norm, the largest row sum of moduli: no horizontal sum but the last. NaN may be lost.
    #[inline(always)]
    pub(super) fn norm(&self, simd: S) -> f64 {
        let zero = simd.splat_f64s(0.0);
        let mut sums = [zero; K];
        for j in 0..N {
            for q in 0..K {
                let x = self.0[j][q];
                // pulp's own modulus is a call that does not inline.
                sums[q] = simd.add_f64s(sums[q], simd.max_f64s(x, simd.sub_f64s(zero, x)));
            }
        }
        let mut top = sums[0];
        for q in 1..K {
            top = simd.max_f64s(top, sums[q]);
        }
        simd.reduce_max_f64s(top)
    }

    #[inline(always)]
    pub(super) fn is_finite(&self, simd: S) -> bool {
        let (mut sum, zero) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        for j in 0..N {
            for q in 0..K {
                sum = simd.mul_add_e_f64s(zero, self.0[j][q], sum);
            }
        }
        simd.reduce_sum_f64s(sum) == 0.0
    }
}

impl<S: Simd, const N: usize, const K: usize> Packed<S> for Cols<S, N, K> {
    #[inline(always)]
    fn sum<const M: usize>(simd: S, c: [f64; M], x: [&Self; M], d: f64) -> Self {
        let mut out = Self::zero(simd);
        // No closures anywhere here: they would be compiled for the baseline instruction set.
        let (mut cc, dd) = ([simd.splat_f64s(0.0); M], simd.splat_f64s(d));
        for k in 0..M {
            cc[k] = simd.splat_f64s(c[k]);
        }
        for j in 0..N {
            for q in 0..K {
                let mut s = simd.mul_f64s(cc[0], x[0].0[j][q]);
                for k in 1..M {
                    s = simd.mul_add_e_f64s(cc[k], x[k].0[j][q], s);
                }
                if d != 0.0 && q == j / S::F64_LANES {
                    let unit = read::<S>(&UNIT[16 - j + q * S::F64_LANES..]);
                    s = simd.mul_add_e_f64s(dd, unit, s);
                }
                out.0[j][q] = s;
            }
        }
        out
    }

    #[inline(always)]
    fn mul(simd: S, a: &Self, b: &Self) -> Self {
        let mut out = Self::zero(simd);
        Mul { simd, a, b, out: &mut out, add: false }.run();
        out
    }

    #[inline(always)]
    fn mul_add(&mut self, simd: S, a: &Self, b: &Self) {
        Mul { simd, a, b, out: self, add: true }.run();
    }
}

/// One product. It carries its own `simd`; `vectorize` compiles `call` for that instruction set.
struct Mul<'a, S: Simd, const N: usize, const K: usize> {
    simd: S,
    a: &'a Cols<S, N, K>,
    b: &'a Cols<S, N, K>,
    out: &'a mut Cols<S, N, K>,
    add: bool,
}

impl<S: Simd, const N: usize, const K: usize> NullaryFnOnce for Mul<'_, S, N, K> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // As many columns at once as the registers hold sums: 16 of 32, or 8 of 16.
        match if S::F64_LANES == 8 { 16 / K } else { 8 / K } {
            8.. => self.blocks::<8>(),
            4..8 => self.blocks::<4>(),
            2..4 => self.blocks::<2>(),
            _ => self.blocks::<1>(),
        }
    }
}

impl<S: Simd, const N: usize, const K: usize> Mul<'_, S, N, K> {
    /// Inlined, because a call costs as much as the product.
    #[inline(always)]
    fn run(self) {
        if N <= 4 { self.call() } else { self.simd.vectorize(self) }
    }

    #[inline(always)]
    fn blocks<const W: usize>(mut self) {
        let mut j = 0;
        while j + W <= N {
            self.block::<W>(j);
            j += W;
        }
        match N % W {
            1 => self.block::<1>(j),
            2 => self.block::<2>(j),
            3 => self.block::<3>(j),
            4 => self.block::<4>(j),
            5 => self.block::<5>(j),
            6 => self.block::<6>(j),
            7 => self.block::<7>(j),
            _ => {}
        }
    }

    /// Columns `first..first + W` of the product.
    #[inline(always)]
    fn block<const W: usize>(&mut self, first: usize) {
        let Mul { simd, a, b, out, add } = self;
        let mut sums = [[simd.splat_f64s(0.0); K]; W];
        if *add {
            sums.copy_from_slice(&out.0[first..first + W]);
        }
        let b = b.flat();
        for k in 0..N {
            let col = a.0[k];
            for j in 0..W {
                let s = simd.splat_f64s(b[(first + j) * Cols::<S, N, K>::STRIDE + k]);
                for q in 0..K {
                    sums[j][q] = simd.mul_add_e_f64s(col[q], s, sums[j][q]);
                }
            }
        }
        out.0[first..first + W].copy_from_slice(&sums);
    }
}
