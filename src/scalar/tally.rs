//! Counts the operations of matrix kernels on machine numbers, for [`Counted::count`](super::Counted::count).
//!
//! An `f64` cannot count its operations, and counting numbers would make a kernel slow. So each product, solve and sum of
//! matrices reports its operations next to its loop, from the sizes and choices of this call. Example: the number of
//! squarings of exp. `tests/core/tally.rs` runs the same formulas entry by entry on [`Counted`](super::Counted) and
//! compares.
//!
//! | counted | not counted |
//! |---|---|
//! | products, solves, sums, norms, brackets, rotations of matrices | copies, signs, comparisons, \|x\|, "is it finite?", powers of two to balance |
//! | functions of one number (exp, ln, sin, cos): each as one | operations on single numbers: h·a_ij, a bound, a ratio of norms |
//! | the eigenvectors of a symmetric matrix: 9n³, the usual estimate, because the routine is faer's | |

use core::ops::{Add, Mul};

use super::Ops;

/// Reports operations on machine numbers.
///
/// Without the feature `tally` this does nothing. With it, `ops` is called only while a count runs.
///
/// ```
/// use lieflow::scalar::{Counted, Ops, tally};
/// let ((), ops) = Counted::count(|| tally(|| Ops::muladds(3) + Ops::divs(1)));
/// assert!(ops.total() == 7 || !cfg!(feature = "tally"));
/// ```
#[inline(always)]
pub fn tally(ops: impl FnOnce() -> Ops) {
    #[cfg(feature = "tally")]
    if super::counted::is_counting() {
        aside(|| super::counted::add(ops()));
    }
    #[cfg(not(feature = "tally"))]
    let _ = ops;
}

/// Not inlined, to keep the kernels small.
#[cfg(feature = "tally")]
#[cold]
#[inline(never)]
fn aside<T>(f: impl FnOnce() -> T) -> T {
    f()
}

/// Runs `f`, a formula on numbers that count, only for its operations, and only while a count runs.
///
/// It is called next to the same formula on machine numbers, if its number of operations depends on branches.
#[inline(always)]
pub(crate) fn tally_by<T>(f: impl FnOnce() -> T) {
    #[cfg(feature = "tally")]
    if super::counted::is_counting() {
        let _ = aside(f);
    }
    #[cfg(not(feature = "tally"))]
    let _ = f;
}

impl Ops {
    /// No operation.
    pub const NONE: Ops = Ops { add: 0, mul: 0, div: 0, sqrt: 0, trig: 0 };

    /// n additions.
    #[inline(always)]
    pub const fn adds(n: usize) -> Ops {
        Ops { add: n as u64, ..Ops::NONE }
    }
    /// n multiplications.
    #[inline(always)]
    pub const fn muls(n: usize) -> Ops {
        Ops { mul: n as u64, ..Ops::NONE }
    }
    /// n divisions.
    #[inline(always)]
    pub const fn divs(n: usize) -> Ops {
        Ops { div: n as u64, ..Ops::NONE }
    }
    /// n square roots.
    #[inline(always)]
    pub const fn sqrts(n: usize) -> Ops {
        Ops { sqrt: n as u64, ..Ops::NONE }
    }
    /// n sines, cosines, exponentials or logarithms.
    #[inline(always)]
    pub const fn trigs(n: usize) -> Ops {
        Ops { trig: n as u64, ..Ops::NONE }
    }
    /// n times x ← x + a·b.
    #[inline(always)]
    pub const fn muladds(n: usize) -> Ops {
        Ops { add: n as u64, mul: n as u64, ..Ops::NONE }
    }
    /// n times z ← z + a·b in complex numbers: four products and four sums.
    #[inline(always)]
    pub const fn complex_muladds(n: usize) -> Ops {
        Ops::muladds(4 * n)
    }
    /// The operations of `entries` sums of k products each.
    #[inline(always)]
    pub const fn dots(entries: usize, k: usize) -> Ops {
        let (mul, add) = (entries * k, entries * k.saturating_sub(1));
        Ops { mul: mul as u64, add: add as u64, ..Ops::NONE }
    }
}

impl Add for Ops {
    type Output = Ops;
    #[inline(always)]
    fn add(self, other: Ops) -> Ops {
        Ops {
            add: self.add + other.add,
            mul: self.mul + other.mul,
            div: self.div + other.div,
            sqrt: self.sqrt + other.sqrt,
            trig: self.trig + other.trig,
        }
    }
}

/// The operations of `times` repetitions.
impl Mul<usize> for Ops {
    type Output = Ops;
    #[inline(always)]
    fn mul(self, times: usize) -> Ops {
        let n = times as u64;
        Ops {
            add: n * self.add,
            mul: n * self.mul,
            div: n * self.div,
            sqrt: n * self.sqrt,
            trig: n * self.trig,
        }
    }
}
