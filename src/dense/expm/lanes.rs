//! One N×N matrix in each SIMD lane: every entry is a register.

use pulp::{NullaryFnOnce, Simd, bytemuck};

use super::taylor::Packed;

/// Column j, row i, lane l: `self.0[j][i]` at l.
#[repr(align(64))]
pub(super) struct Lanes<S: Simd, const N: usize>(pub(super) [[S::f64s; N]; N]);

/// One number for each lane; unused lanes are zero.
pub(super) type PerLane = [f64; 8];

impl<S: Simd, const N: usize> Clone for Lanes<S, N> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Simd, const N: usize> Copy for Lanes<S, N> {}

#[inline(always)]
pub(super) fn spread<S: Simd>(x: &PerLane) -> S::f64s {
    bytemuck::pod_read_unaligned(bytemuck::cast_slice(&x[..S::F64_LANES]))
}

#[inline(always)]
fn gather<S: Simd>(x: S::f64s) -> PerLane {
    let mut out = [0.0; 8];
    out[..S::F64_LANES].copy_from_slice(bytemuck::cast_slice(&[x]));
    out
}

#[inline(always)]
fn abs<S: Simd>(simd: S, x: S::f64s) -> S::f64s {
    simd.max_f64s(x, simd.sub_f64s(simd.splat_f64s(0.0), x))
}

impl<S: Simd, const N: usize> Lanes<S, N> {
    #[inline(always)]
    pub(super) fn zero(simd: S) -> Self {
        Lanes([[simd.splat_f64s(0.0); N]; N])
    }

    /// Matrices `first..first + lanes` of `count`, entry by entry; zero matrices beyond the last.
    #[inline(always)]
    pub(super) fn load(simd: S, u: &[f64], first: usize, count: usize) -> Self {
        let mut out = Self::zero(simd);
        let lanes = S::F64_LANES;
        for j in 0..N {
            for i in 0..N {
                let entry = &u[(j * N + i) * count..][..count];
                out.0[j][i] = if first + lanes <= count {
                    bytemuck::pod_read_unaligned(bytemuck::cast_slice(&entry[first..first + lanes]))
                } else {
                    let mut tail = [0.0; 8];
                    tail[..count - first].copy_from_slice(&entry[first..]);
                    spread::<S>(&tail)
                };
            }
        }
        out
    }

    #[inline(always)]
    pub(super) fn store(&self, out: &mut [f64], first: usize, count: usize) {
        let used = S::F64_LANES.min(count - first);
        for j in 0..N {
            for i in 0..N {
                let x: &[f64] = bytemuck::cast_slice(core::slice::from_ref(&self.0[j][i]));
                out[(j * N + i) * count + first..][..used].copy_from_slice(&x[..used]);
            }
        }
    }

    /// The ∞-norm of each matrix. NaN may be lost.
    #[inline(always)]
    pub(super) fn norms(&self, simd: S) -> PerLane {
        let mut top = simd.splat_f64s(0.0);
        for i in 0..N {
            let mut row = simd.splat_f64s(0.0);
            for j in 0..N {
                row = simd.add_f64s(row, abs(simd, self.0[j][i]));
            }
            top = simd.max_f64s(top, row);
        }
        gather::<S>(top)
    }

    /// Σ|a_ij| above and below the diagonal, the smaller of the two: 0 for a triangle.
    #[inline(always)]
    pub(super) fn smaller_triangle(&self, simd: S) -> PerLane {
        let (mut above, mut below) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        for j in 0..N {
            for i in 0..j {
                above = simd.add_f64s(above, abs(simd, self.0[j][i]));
                below = simd.add_f64s(below, abs(simd, self.0[i][j]));
            }
        }
        gather::<S>(simd.min_f64s(above, below))
    }

    #[inline(always)]
    pub(super) fn is_finite(&self, simd: S) -> bool {
        let (mut sum, zero) = (simd.splat_f64s(0.0), simd.splat_f64s(0.0));
        for j in 0..N {
            for i in 0..N {
                sum = simd.mul_add_e_f64s(zero, self.0[j][i], sum);
            }
        }
        simd.reduce_sum_f64s(sum) == 0.0
    }

    /// Multiplies each matrix by its own factor.
    #[inline(always)]
    pub(super) fn scale(&mut self, simd: S, factors: &PerLane) {
        let f = spread::<S>(factors);
        for j in 0..N {
            for i in 0..N {
                self.0[j][i] = simd.mul_f64s(f, self.0[j][i]);
            }
        }
    }

    /// `new` in the lanes where `left` > `done`.
    #[inline(always)]
    pub(super) fn replace_where(&mut self, simd: S, left: &PerLane, done: f64, new: &Self) {
        let mask = simd.greater_than_f64s(spread::<S>(left), simd.splat_f64s(done));
        for j in 0..N {
            for i in 0..N {
                self.0[j][i] = simd.select_f64s(mask, new.0[j][i], self.0[j][i]);
            }
        }
    }

    #[inline(always)]
    pub(super) fn transpose(&self) -> Self {
        let mut out = *self;
        for j in 0..N {
            for i in 0..N {
                out.0[i][j] = self.0[j][i];
            }
        }
        out
    }
}

impl<S: Simd, const N: usize> Packed<S> for Lanes<S, N> {
    #[inline(always)]
    fn sum<const M: usize>(simd: S, c: [f64; M], x: [&Self; M], d: f64) -> Self {
        let mut out = Self::zero(simd);
        let (mut cc, dd) = ([simd.splat_f64s(0.0); M], simd.splat_f64s(d));
        for k in 0..M {
            cc[k] = simd.splat_f64s(c[k]);
        }
        for j in 0..N {
            for i in 0..N {
                let mut s = simd.mul_f64s(cc[0], x[0].0[j][i]);
                for k in 1..M {
                    s = simd.mul_add_e_f64s(cc[k], x[k].0[j][i], s);
                }
                out.0[j][i] = if i == j { simd.add_f64s(s, dd) } else { s };
            }
        }
        out
    }

    #[inline(always)]
    fn mul(simd: S, a: &Self, b: &Self) -> Self {
        let mut out = Self::zero(simd);
        simd.vectorize(Mul { simd, a, b, out: &mut out, add: false });
        out
    }

    #[inline(always)]
    fn mul_add(&mut self, simd: S, a: &Self, b: &Self) {
        simd.vectorize(Mul { simd, a, b, out: self, add: true });
    }
}

/// One product. It carries its own `simd`; `vectorize` compiles `call` for that instruction set.
struct Mul<'a, S: Simd, const N: usize> {
    simd: S,
    a: &'a Lanes<S, N>,
    b: &'a Lanes<S, N>,
    out: &'a mut Lanes<S, N>,
    add: bool,
}

impl<S: Simd, const N: usize> NullaryFnOnce for Mul<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Mul { simd, a, b, out, add } = self;
        // A block of four rows and four columns (two with few registers) stays in registers.
        let mut j = 0;
        while j < N {
            let width = if S::F64_LANES == 8 { 4 } else { 2 };
            let mut i = 0;
            while i < N {
                match (width.min(N - j), (N - i).min(4)) {
                    (4, 4) => block::<S, N, 4, 4>(simd, a, b, out, add, i, j),
                    (4, 3) => block::<S, N, 4, 3>(simd, a, b, out, add, i, j),
                    (4, 2) => block::<S, N, 4, 2>(simd, a, b, out, add, i, j),
                    (4, _) => block::<S, N, 4, 1>(simd, a, b, out, add, i, j),
                    (3, 4) => block::<S, N, 3, 4>(simd, a, b, out, add, i, j),
                    (3, 3) => block::<S, N, 3, 3>(simd, a, b, out, add, i, j),
                    (3, 2) => block::<S, N, 3, 2>(simd, a, b, out, add, i, j),
                    (3, _) => block::<S, N, 3, 1>(simd, a, b, out, add, i, j),
                    (2, 4) => block::<S, N, 2, 4>(simd, a, b, out, add, i, j),
                    (2, 3) => block::<S, N, 2, 3>(simd, a, b, out, add, i, j),
                    (2, 2) => block::<S, N, 2, 2>(simd, a, b, out, add, i, j),
                    (2, _) => block::<S, N, 2, 1>(simd, a, b, out, add, i, j),
                    (_, 4) => block::<S, N, 1, 4>(simd, a, b, out, add, i, j),
                    (_, 3) => block::<S, N, 1, 3>(simd, a, b, out, add, i, j),
                    (_, 2) => block::<S, N, 1, 2>(simd, a, b, out, add, i, j),
                    _ => block::<S, N, 1, 1>(simd, a, b, out, add, i, j),
                }
                i += 4;
            }
            j += width;
        }
    }
}

/// W columns from j on, H rows from i on.
#[inline(always)]
fn block<S: Simd, const N: usize, const W: usize, const H: usize>(
    simd: S,
    a: &Lanes<S, N>,
    b: &Lanes<S, N>,
    out: &mut Lanes<S, N>,
    add: bool,
    i: usize,
    j: usize,
) {
    let mut sums = [[simd.splat_f64s(0.0); H]; W];
    if add {
        for q in 0..W {
            sums[q].copy_from_slice(&out.0[j + q][i..i + H]);
        }
    }
    for k in 0..N {
        for q in 0..W {
            let s = b.0[j + q][k];
            for p in 0..H {
                sums[q][p] = simd.mul_add_e_f64s(a.0[k][i + p], s, sums[q][p]);
            }
        }
    }
    for q in 0..W {
        out.0[j + q][i..i + H].copy_from_slice(&sums[q]);
    }
}
