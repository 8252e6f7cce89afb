//! exp of many small matrices at once, one in each SIMD lane.

use core::ops::Range;

use faer::Mat;
use pulp::{Arch, Simd, WithSimd};

use super::lanes::{Lanes, PerLane};
use super::small::PLAIN;
use super::taylor::{
    B18, Packed, THETA_8, THETA_12, THETA_18, THETA_18_6, degree_8, degree_12, degree_18,
    half_to_the, halvings, halvings_18,
};
use super::{Exponential, NORM_MAX_SKEW, Structure};
use crate::error::StepError;

/// exp of many n×n matrices. Entry (i, j) of matrix m of `count` is at `(j·n + i)·count + m`.
///
/// For n ≤ 8 a register holds one entry of 8, 4 or 2 matrices (AVX-512, AVX2, the baseline; chosen at run time). The code
/// evaluates the Taylor polynomials of [`Exponential`], with a number of squarings for each matrix, and has the same
/// accuracy. Larger n go through [`Exponential`] one by one. So do difficult matrices: triangular ones, and general
/// ones with a norm above 16. They are copied in groups of 8, because 8 neighbours share a line of the cache.
///
/// ```
/// use lieflow::dense::{ExponentialBatch, Structure};
///
/// // Two rotations of the plane, by 0.1 and by 0.2.
/// let u = [0.0, 0.0, 0.1, 0.2, -0.1, -0.2, 0.0, 0.0];
/// let mut g = [0.0; 8];
/// ExponentialBatch::new(2).exp(&u, Structure::Skew, &mut g)?;
/// assert!((g[2] - 0.1f64.sin()).abs() < 1e-16 && (g[3] - 0.2f64.sin()).abs() < 1e-16);
/// # Ok::<(), lieflow::StepError>(())
/// ```
#[derive(Debug)]
pub struct ExponentialBatch {
    n: usize,
    arch: Arch,
    single: Exponential,
    /// Matrices that go one by one, and their exponentials.
    u: [Mat<f64>; GROUP],
    g: [Mat<f64>; GROUP],
}

/// The number of matrices that are copied together.
const GROUP: usize = 8;

impl ExponentialBatch {
    /// Makes the workspace for n×n matrices. Nothing allocates after this.
    pub fn new(n: usize) -> Self {
        ExponentialBatch {
            n,
            arch: Arch::new(),
            single: Exponential::new(n),
            u: core::array::from_fn(|_| Mat::zeros(n, n)),
            g: core::array::from_fn(|_| Mat::zeros(n, n)),
        }
    }

    /// out ← exp of every matrix of u.
    ///
    /// # Errors
    /// As [`Exponential::exp`], for the first matrix that fails; `out` is then undefined.
    /// [`StepError::Shape`] if the length of u is not k·n², or `out` has another length than u.
    pub fn exp(
        &mut self,
        u: &[f64],
        structure: Structure,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let size = self.n * self.n;
        let (count, skew) = (u.len().div_ceil(size.max(1)), structure == Structure::Skew);
        StepError::check_shape("u", (u.len(), 1), (count * size, 1))?;
        StepError::check_shape("out", (out.len(), 1), (count * size, 1))?;
        let mut first = 0;
        while first < count {
            let careful = match self.n {
                1 => self.arch.dispatch(Batch::<1> { u, skew, first, count, out }),
                2 => self.arch.dispatch(Batch::<2> { u, skew, first, count, out }),
                3 => self.arch.dispatch(Batch::<3> { u, skew, first, count, out }),
                4 => self.arch.dispatch(Batch::<4> { u, skew, first, count, out }),
                5 => self.arch.dispatch(Batch::<5> { u, skew, first, count, out }),
                6 => self.arch.dispatch(Batch::<6> { u, skew, first, count, out }),
                7 => self.arch.dispatch(Batch::<7> { u, skew, first, count, out }),
                8 => self.arch.dispatch(Batch::<8> { u, skew, first, count, out }),
                _ => first..count,
            };
            first = careful.end;
            for start in careful.clone().step_by(GROUP) {
                let group = start..careful.end.min(start + GROUP);
                self.one_by_one(u, structure, count, group, out)?;
            }
        }
        Ok(())
    }

    /// The exponentials of at most [`GROUP`] matrices.
    fn one_by_one(
        &mut self,
        u: &[f64],
        structure: Structure,
        count: usize,
        group: Range<usize>,
        out: &mut [f64],
    ) -> Result<(), StepError> {
        let n = self.n;
        for j in 0..n {
            let columns = self.u.each_mut().map(|u| &mut u.col_as_slice_mut(j)[..n]);
            let entries = u[j * n * count..].chunks_exact(count).take(n);
            for (i, entries) in entries.enumerate() {
                match entries.get(group.start..group.start + GROUP) {
                    Some(entries) if group.len() == GROUP => {
                        (0..GROUP).for_each(|m| columns[m][i] = entries[m])
                    }
                    _ => (0..group.len()).for_each(|m| columns[m][i] = entries[group.start + m]),
                }
            }
        }
        for (u, g) in self.u.iter().zip(&mut self.g).take(group.len()) {
            self.single.exp(u, structure, g)?;
        }
        for j in 0..n {
            let columns = self.g.each_ref().map(|g| &g.col_as_slice(j)[..n]);
            let entries = out[j * n * count..].chunks_exact_mut(count).take(n);
            for (i, entries) in entries.enumerate() {
                match group.len() {
                    GROUP => {
                        let entries = &mut entries[group.start..group.start + GROUP];
                        (0..GROUP).for_each(|m| entries[m] = columns[m][i]);
                    }
                    _ => (0..group.len()).for_each(|m| entries[group.start + m] = columns[m][i]),
                }
            }
        }
        Ok(())
    }
}

/// Processes the matrices from `first` on. Returns the first group of lanes with a difficult matrix, or an empty range.
struct Batch<'a, const N: usize> {
    u: &'a [f64],
    skew: bool,
    first: usize,
    count: usize,
    out: &'a mut [f64],
}

impl<const N: usize> WithSimd for Batch<'_, N> {
    type Output = Range<usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Range<usize> {
        let Batch { u, skew, first, count, out } = self;
        let mut at = first;
        while at < count {
            let a = Lanes::<S, N>::load(simd, u, at, count);
            match kernel(simd, a, skew) {
                Some(g) => g.store(out, at, count),
                None => return at..count.min(at + S::F64_LANES),
            }
            at += S::F64_LANES;
        }
        count..count
    }
}

/// exp of each matrix; `None` if one of them is difficult.
#[inline(always)]
fn kernel<S: Simd, const N: usize>(simd: S, mut a: Lanes<S, N>, skew: bool) -> Option<Lanes<S, N>> {
    let norms = a.norms(simd);
    let mut top = 0.0f64;
    for norm in norms {
        top = top.max(norm);
    }
    if top > if skew { NORM_MAX_SKEW } else { PLAIN } {
        return None;
    }
    let mut a2 = Lanes::mul(simd, &a, &a);
    let mut squarings = [0; 8];
    let mut g = if top <= THETA_8 {
        degree_8(simd, &a, &a2)
    } else {
        let mut a3 = Lanes::mul(simd, &a2, &a);
        if top <= THETA_12 {
            degree_12(simd, &a, &a2, &a3)
        } else {
            let mut a6 = Lanes::mul(simd, &a3, &a3);
            if top > THETA_18 {
                squarings = match skew {
                    true => halvings_skew(&norms, &a6.norms(simd)),
                    false => halvings_general(simd, &norms, [&a, &a2, &a3, &a6])?,
                };
                for (x, power) in [(&mut a, 1), (&mut a2, 2), (&mut a3, 3), (&mut a6, 6)] {
                    let mut f = [1.0; 8];
                    for l in 0..8 {
                        f[l] = half_to_the(power * squarings[l]);
                    }
                    x.scale(simd, &f);
                }
            }
            degree_18(simd, &B18, [&a, &a2, &a3, &a6])
        }
    };
    let (mut left, mut most) = ([0.0; 8], 0);
    for l in 0..8 {
        left[l] = f64::from(squarings[l]);
        most = most.max(squarings[l]);
    }
    for done in 0..most {
        let square = Lanes::mul(simd, &g, &g);
        g.replace_where(simd, &left, f64::from(done), &square);
    }
    if skew && most > 0 {
        orthogonalise(simd, &mut g);
    }
    g.is_finite(simd).then_some(g)
}

/// a is normal: |a|₂⁶ = |a⁶|₂ ≤ |a⁶|_∞.
#[inline(always)]
fn halvings_skew(norms: &PerLane, n6: &PerLane) -> [u32; 8] {
    let mut s = [0; 8];
    for l in 0..8 {
        s[l] = halvings(norms[l], THETA_18, 1).min(halvings(n6[l], THETA_18_6, 6));
    }
    s
}

/// By the norms of the powers. `None` for a triangle, which needs special squarings.
#[inline(always)]
fn halvings_general<S: Simd, const N: usize>(
    simd: S,
    norms: &PerLane,
    [a, a2, a3, a6]: [&Lanes<S, N>; 4],
) -> Option<[u32; 8]> {
    let triangle = a.smaller_triangle(simd);
    let (n2, n3, n6) = (a2.norms(simd), a3.norms(simd), a6.norms(simd));
    let mut s = [0; 8];
    for l in 0..8 {
        if norms[l] > THETA_18 {
            if triangle[l] == 0.0 {
                return None;
            }
            s[l] = halvings_18(norms[l], n2[l], n3[l], n6[l]);
        }
    }
    Some(s)
}

/// g ← g + g(𝟙 − gᵀg)/2 until ‖𝟙 − gᵀg‖ is at rounding level in every lane.
#[inline(always)]
fn orthogonalise<S: Simd, const N: usize>(simd: S, g: &mut Lanes<S, N>) {
    for _ in 0..6 {
        let gram = Lanes::mul(simd, &g.transpose(), g);
        let half = Lanes::sum(simd, [-0.5], [&gram], 0.5);
        let h = *g;
        g.mul_add(simd, &h, &half);
        let mut top = 0.0f64;
        for defect in half.norms(simd) {
            top = top.max(defect);
        }
        // The next defect is the square of this one.
        if top <= 1e-9 {
            break;
        }
    }
}
