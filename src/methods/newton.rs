//! Iterations of the implicit methods: Newton in ℝ³, and the stopping rule of fixed-point iterations.

use nalgebra::{Matrix3, Vector3};

use crate::error::StepError;
use crate::scalar::Real;
use crate::so3::cross;

/// The largest number of Newton iterations. Within the stated limits 3 to 6 are needed.
pub(super) const NEWTON_MAX: u32 = 20;
/// The largest number of fixed-point iterations. It is enough for a contraction by 0.8 to reach rounding.
pub(super) const FIXED_POINT_MAX: u32 = 200;

fn dot<S: Real>(a: &Vector3<S>, b: &Vector3<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Solves A x = b by Cramer's rule; the columns of A are `a`. x is not finite for a singular A.
#[inline(always)]
fn solve3<S: Real>(a: &Matrix3<S>, b: &Vector3<S>) -> Vector3<S> {
    let col = |j| Vector3::new(a[(0, j)], a[(1, j)], a[(2, j)]);
    let (p, q, r) = (col(0), col(1), col(2));
    let qr = cross(&q, &r);
    let s = S::lit(1.0) / dot(&p, &qr);
    Vector3::new(s * dot(b, &qr), s * dot(b, &cross(&r, &p)), s * dot(b, &cross(&p, &q)))
}

/// Newton's iteration for F(x) = 0 from `x`; `f` returns F and F'.
///
/// It stops after a correction below √ε times `scale`, the size of the solution. Then the error is at rounding. Its
/// iterations are added to `total`.
///
/// # Errors
/// [`StepError::NewtonDidNotConverge`] after [`NEWTON_MAX`] iterations, or if a number is not finite.
#[inline(always)]
pub(super) fn newton3<S: Real>(
    method: &'static str,
    mut x: Vector3<S>,
    scale: S,
    total: &mut u64,
    mut f: impl FnMut(&Vector3<S>) -> (Vector3<S>, Matrix3<S>),
) -> Result<Vector3<S>, StepError> {
    let near = S::EPSILON.sqrt() / 64.0;
    let mut size = S::lit(f64::INFINITY);
    let mut iterations = 0;
    while iterations < NEWTON_MAX {
        iterations += 1;
        *total += 1;
        let (residual, jacobian) = f(&x);
        let d = solve3(&jacobian, &residual);
        x = Vector3::new(x[0] - d[0], x[1] - d[1], x[2] - d[2]);
        // Next to the scale, so that squares stay in range.
        let part = d.map(|d| d / scale);
        size = dot(&part, &part).sqrt();
        if size.all_below(near) {
            return Ok(x);
        }
        if !size.is_finite() {
            break;
        }
    }
    Err(StepError::NewtonDidNotConverge { method, iterations, residual_log10: log10_above(size) })
}

/// The least integer d with x < 10^d; 308 where x is not finite.
#[cold]
fn log10_above<S: Real>(x: S) -> i32 {
    (-17..308).find(|&d| x.all_below(10f64.powi(d))).unwrap_or(308)
}

/// The stopping rule of a fixed-point iteration.
///
/// It has converged when a change is at rounding, or when the changes near rounding no longer shrink.
pub(super) struct Progress<'a, S> {
    last: S,
    last_of_parts: S,
    iterations: u32,
    /// A smaller change is rounding.
    tiny: f64,
    total: &'a mut u64,
}

impl<'a, S: Real> Progress<'a, S> {
    /// Begins an iteration. Its iterations are added to `total`.
    #[inline]
    pub(super) fn new(total: &'a mut u64) -> Self {
        let (none, tiny) = (S::lit(f64::INFINITY), 0.25 * S::EPSILON);
        Progress { last: none, last_of_parts: none, iterations: 0, tiny, total }
    }

    /// Begins an iteration that goes on until its changes no longer shrink. What is left of a slow one has the same sign from
    /// step to step, and an invariant drifts by it. Source: E. Hairer, R. McLachlan, A. Razakarivony, BIT 48 (2008).
    #[inline]
    pub(super) fn to_the_last_digit(total: &'a mut u64) -> Self {
        Progress { tiny: f64::MIN_POSITIVE, ..Self::new(total) }
    }

    /// True if the iteration is done after a change of this size, relative to the size of the solution.
    ///
    /// # Errors
    /// [`StepError::FixedPointDidNotConverge`] after [`FIXED_POINT_MAX`] iterations, or for a
    /// change that is not finite.
    #[inline]
    pub(super) fn done(&mut self, method: &'static str, change: S) -> Result<bool, StepError> {
        self.iterations += 1;
        *self.total += 1;
        let stalled = change.all_below(STALL * S::EPSILON) && !(change / self.last).all_below(0.9);
        if change.all_below(self.tiny) || stalled {
            return Ok(true);
        }
        if !change.is_finite() || self.iterations >= FIXED_POINT_MAX {
            return Err(StepError::FixedPointDidNotConverge {
                method,
                iterations: self.iterations,
                change_log10: log10_above(change),
            });
        }
        self.last = change;
        Ok(false)
    }

    /// True if an iteration that is done is done for each part of the solution, too. `change` is the last one, and
    /// `of_parts` the largest that a part has relative to its own size. A part that is small beside the others converges
    /// later than they do, and a part that has just left 0 has no size to be relative to: `of_parts` is infinite.
    #[inline]
    pub(super) fn parts_are_done(&mut self, change: S, of_parts: S) -> bool {
        // Not of NaN, where the squares of a large point have left the range.
        let is_infinite = !of_parts.is_finite() && (S::lit(1.0) / of_parts).is_finite();
        let shrinks = (of_parts / self.last_of_parts).all_below(0.9);
        self.last_of_parts = of_parts;
        !(shrinks || is_infinite)
            || (of_parts / change).all_below(1.01)
            || of_parts.all_below(0.25 * S::EPSILON)
            || self.iterations + 1 >= FIXED_POINT_MAX
    }
}

/// Changes below this many rounding units may count as stalled.
const STALL: f64 = 64.0;
