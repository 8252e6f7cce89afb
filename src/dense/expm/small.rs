//! exp of a small matrix as one kernel: load once, compute in padded local arrays, store once.

use faer::Mat;
use pulp::{Arch, Simd};

use super::cols::{self, Cols, Kernel};
use super::taylor::{
    B18, Packed, THETA_1, THETA_2, THETA_4, THETA_8, THETA_12, THETA_18, THETA_18_6, degree_8,
    degree_12, degree_18, half_to_the, halvings, halvings_18,
};
use super::{Approximant, ExpmChoice, NORM_MAX_SKEW, Structure};
use crate::scalar::{Ops, tally};

/// Up to this norm a general matrix is scaled by its norm.
pub(super) const PLAIN: f64 = 16.0;
/// Above this norm the kernel leaves a general matrix to [`general`](super::general).
const NORM_MAX: f64 = 1e3;

/// out ← exp(x) for n ≤ 16; `None` if the matrix is difficult or not finite.
pub(super) fn exp(
    arch: Arch,
    x: &Mat<f64>,
    structure: Structure,
    out: &mut Mat<f64>,
) -> Option<ExpmChoice> {
    cols::dispatch(arch, x.nrows(), Exp { x, skew: structure == Structure::Skew, out })
}

struct Exp<'a> {
    x: &'a Mat<f64>,
    skew: bool,
    out: &'a mut Mat<f64>,
}

impl Kernel for Exp<'_> {
    type Output = Option<ExpmChoice>;

    #[inline(always)]
    fn call<S: Simd, const N: usize, const K: usize>(self, simd: S) -> Option<ExpmChoice> {
        let Exp { x, skew, out } = self;
        let a = Cols::<S, N, K>::load_columns(simd, x.as_ref());
        let norm = a.norm(simd);
        let (mut g, degree, squarings) = taylor(simd, &a, norm, skew)?;
        for _ in 0..squarings {
            let h = g;
            g = Cols::mul(simd, &h, &h);
        }
        let mut corrections = 0;
        if skew && squarings > 0 {
            corrections = orthogonalise(simd, &mut g);
        }
        if !g.is_finite(simd) {
            return None;
        }
        g.store(out);
        let norms = if norm <= THETA_18 {
            1
        } else if skew {
            2
        } else {
            4
        };
        tally(|| Cost(x.nrows()).of(degree, norms, [squarings, corrections]));
        Some(ExpmChoice {
            kind: Approximant::Taylor,
            degree,
            squarings,
            corrections,
            balanced: false,
        })
    }
}

/// The operations on n×n matrices. They do not depend on the padding of the kernel.
#[derive(Clone, Copy)]
struct Cost(usize);

impl Cost {
    /// a·b.
    #[inline(always)]
    fn product(self) -> Ops {
        Ops::dots(self.0 * self.0, self.0)
    }
    /// The operations of adding a product.
    #[inline(always)]
    fn added(self) -> Ops {
        Ops::adds(self.0 * self.0)
    }
    /// Σ c_i·x_i over k matrices.
    #[inline(always)]
    fn sum(self, k: usize) -> Ops {
        Ops::dots(self.0 * self.0, k)
    }
    /// Σ c_i·x_i + d·𝟙.
    #[inline(always)]
    fn sum_and_one(self, k: usize) -> Ops {
        self.sum(k) + Ops::adds(self.0)
    }
    #[inline(always)]
    fn norm(self) -> Ops {
        Ops::adds(self.0 * (self.0 - 1))
    }
    /// The operations of exp by the polynomial of a degree, with its norms, squarings and corrections. They are reported
    /// once, because each report costs time in a kernel of a hundred instructions.
    #[inline(always)]
    fn of(self, degree: usize, norms: usize, [squarings, corrections]: [u32; 2]) -> Ops {
        let (product, added) = (self.product(), self.added());
        let polynomial = match degree {
            1 => self.sum_and_one(1),
            2 => product + self.sum_and_one(2),
            4 => product * 2 + added + self.sum_and_one(2) + self.sum_and_one(1),
            8 => {
                let sums = self.sum(2) * 2 + self.sum_and_one(3) + self.sum_and_one(2);
                product * 3 + added + sums
            }
            12 => {
                let sums = self.sum(3) * 2 + self.sum_and_one(4) + self.sum_and_one(3);
                product * 4 + added * 2 + sums
            }
            _ => {
                let sums =
                    self.sum(3) * 2 + self.sum(4) + self.sum_and_one(5) + self.sum_and_one(4);
                product * 5 + added * 2 + sums
            }
        };
        let correction = product * 2 + self.sum_and_one(1) + added + self.norm();
        polynomial
            + self.norm() * norms
            + product * squarings as usize
            + correction * corrections as usize
    }
}

/// The polynomial at 2⁻ˢa, its degree, and s.
#[inline(always)]
fn taylor<S: Simd, const N: usize, const K: usize>(
    simd: S,
    a: &Cols<S, N, K>,
    norm: f64,
    skew: bool,
) -> Option<(Cols<S, N, K>, usize, u32)> {
    if norm.is_nan() || norm > if skew { NORM_MAX_SKEW } else { NORM_MAX } {
        return None;
    }
    if norm <= THETA_1 {
        return Some((Cols::sum(simd, [1.0], [a], 1.0), 1, 0));
    }
    let a2 = Cols::mul(simd, a, a);
    if norm <= THETA_2 {
        return Some((Cols::sum(simd, [1.0, 0.5], [a, &a2], 1.0), 2, 0));
    }
    if norm <= THETA_4 {
        let high = Cols::sum(simd, [1.0 / 6.0, 1.0 / 24.0], [a, &a2], 0.5);
        let mut g = Cols::sum(simd, [1.0], [a], 1.0);
        g.mul_add(simd, &a2, &high);
        return Some((g, 4, 0));
    }
    if norm <= THETA_8 {
        return Some((degree_8(simd, a, &a2), 8, 0));
    }
    let a3 = Cols::mul(simd, &a2, a);
    if norm <= THETA_12 {
        return Some((degree_12(simd, a, &a2, &a3), 12, 0));
    }
    let a6 = Cols::mul(simd, &a3, &a3);
    let mut squarings = halvings(norm, THETA_18, 1);
    if squarings > 0 {
        if skew {
            // a is normal: |a|₂⁶ = |a⁶|₂ ≤ |a⁶|_∞.
            squarings = squarings.min(halvings(a6.norm(simd), THETA_18_6, 6));
        } else {
            let n6 = a6.norm(simd);
            // ‖a⁶‖^⅙ < ‖a‖/4: the powers grow slower than the norm says. Or a trace to take out, or
            // a triangle, which is squared in a way of its own.
            let slow = norm > PLAIN && (4096.0 * n6 < pow6(norm) || mean(a).abs() > 0.5 * norm);
            if slow || triangular(a) {
                return None;
            }
            squarings = halvings_18(norm, a2.norm(simd), a3.norm(simd), n6);
        }
    }
    let f = half_to_the(squarings);
    let (f2, f3) = (f * f, f * f * f);
    let scale = [1.0, f, f2, f3, f3 * f3];
    let mut c = B18;
    for b in 0..5 {
        for i in 0..5 {
            c[b][i] *= scale[i];
        }
    }
    Some((degree_18(simd, &c, [a, &a2, &a3, &a6]), 18, squarings))
}

/// The mean of the diagonal.
#[inline(always)]
fn mean<S: Simd, const N: usize, const K: usize>(a: &Cols<S, N, K>) -> f64 {
    let (flat, mut sum) = (a.flat(), 0.0);
    for j in 0..N {
        sum += flat[j * K * S::F64_LANES + j];
    }
    sum / N as f64
}

#[inline(always)]
fn pow6(x: f64) -> f64 {
    let x3 = x * x * x;
    x3 * x3
}

/// True if one triangle is zero. For a full matrix the first entry decides.
#[inline(always)]
fn triangular<S: Simd, const N: usize, const K: usize>(a: &Cols<S, N, K>) -> bool {
    let flat = a.flat();
    let (mut below, mut above) = (false, false);
    for j in 1..N {
        for i in 0..j {
            above |= flat[j * K * S::F64_LANES + i] != 0.0;
            below |= flat[i * K * S::F64_LANES + j] != 0.0;
            if above && below {
                return false;
            }
        }
    }
    true
}

/// g ← g + g(𝟙 − gᵀg)/2 until ‖𝟙 − gᵀg‖ is at rounding level: Newton–Schulz in residual form.
#[inline(always)]
fn orthogonalise<S: Simd, const N: usize, const K: usize>(simd: S, g: &mut Cols<S, N, K>) -> u32 {
    let mut k = 0;
    while k < 6 {
        k += 1;
        let gram = Cols::mul(simd, &g.transpose(simd), g);
        let half = Cols::sum(simd, [-0.5], [&gram], 0.5);
        let h = *g;
        g.mul_add(simd, &h, &half);
        // The next defect is the square of this one.
        if half.norm(simd) <= 1e-9 {
            break;
        }
    }
    k
}
