//! ℝ³ and 3×3 matrices, written out for any number: the hat map (2), products, and what is finite.

use nalgebra::{Matrix3, Vector3};

use crate::scalar::Real;

/// hat(u): the skew-symmetric matrix with hat(u)·x = u × x, equation (2).
pub fn hat<S: Real>(u: &Vector3<S>) -> Matrix3<S> {
    let o = S::lit(0.0);
    Matrix3::new(o, -u[2], u[1], u[2], o, -u[0], -u[1], u[0], o)
}

/// vee(m): the vector u with hat(u) = m, the inverse of [`hat`].
///
/// It reads m₃₂, m₁₃ and m₂₁, and does not check that m is skew.
pub fn vee<S: Real>(m: &Matrix3<S>) -> Vector3<S> {
    Vector3::new(m[(2, 1)], m[(0, 2)], m[(1, 0)])
}

/// u × v.
#[inline(always)]
pub(crate) fn cross<S: Real>(u: &Vector3<S>, v: &Vector3<S>) -> Vector3<S> {
    Vector3::new(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
}

/// u·v.
#[inline(always)]
pub(crate) fn dot3<S: Real>(u: &Vector3<S>, v: &Vector3<S>) -> S {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

/// Is a square neither beyond the range of squares nor below it?
#[inline(always)]
pub(crate) fn in_range<S: Real>(square: S) -> bool {
    square.all_below(S::SQUARE_MAX) && !square.any_below(1.0 / S::SQUARE_MAX)
}

/// a + b.
#[inline(always)]
pub(crate) fn add3<S: Real>(a: &Vector3<S>, b: &Vector3<S>) -> Vector3<S> {
    Vector3::new(a[0] + b[0], a[1] + b[1], a[2] + b[2])
}

/// Are all three finite?
#[inline(always)]
pub(crate) fn all_finite<S: Real>(u: &Vector3<S>) -> bool {
    u[0].is_finite() && u[1].is_finite() && u[2].is_finite()
}

/// g·x.
#[inline(always)]
pub(crate) fn apply3<S: Real>(g: &Matrix3<S>, x: &Vector3<S>) -> Vector3<S> {
    Vector3::new(
        g[(0, 0)] * x[0] + g[(0, 1)] * x[1] + g[(0, 2)] * x[2],
        g[(1, 0)] * x[0] + g[(1, 1)] * x[1] + g[(1, 2)] * x[2],
        g[(2, 0)] * x[0] + g[(2, 1)] * x[1] + g[(2, 2)] * x[2],
    )
}

/// out ← a·b.
#[inline(always)]
pub(crate) fn compose3<S: Real>(a: &Matrix3<S>, b: &Matrix3<S>, out: &mut Matrix3<S>) {
    for j in 0..3 {
        for i in 0..3 {
            out[(i, j)] = a[(i, 0)] * b[(0, j)] + a[(i, 1)] * b[(1, j)] + a[(i, 2)] * b[(2, j)];
        }
    }
}
