//! Methods that estimate their own error, and the metric of points that some of them need.
//!
//! | method | error | length |
//! |---|---|---|
//! | [`Rkmk`](super::Rkmk) with a pair | ‖h Σ (b_j − b̂_j) k_j‖ in 𝔤 | ‖v‖ in 𝔤 |
//! | low storage, Magnus 4(3) | the difference of the last two increments in 𝔤 | Σ ‖u_i‖ in 𝔤 |
//! | commutator-free, [`Rk`](super::Rk) | the distance of both results in M | the distance gone in M |
//! | any other, by [`Doubling`](super::Doubling) | one step against two halves, in M | the same |
//!
//! In 𝔤 an error is relative to the point by nature: λ_p(v + e) ≈ Λ(Ψ(e), λ_p(v)).

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use super::{Method, Step};
use crate::dense::norm_frobenius;
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, GroupMatrix};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::{Counted, DoubleDouble, Ops, Real, tally};

/// What a step says of its own error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalError<S> {
    /// The estimated error of the step.
    pub error: S,
    /// How far the step went, in the same norm: what a relative tolerance is relative to.
    pub length: S,
}

/// A method whose steps estimate their own error.
pub trait Embedded<P: Problem>: Method<P> {
    /// The estimate behaves like h to the power `error_order + 1`.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when the tableau has no embedded row.
    fn error_order(&self, problem: &P) -> Result<usize, Error>;

    /// [`evaluations`](Method::evaluations) of a [`step_with_error`](Self::step_with_error).
    fn evaluations_with_error(&self, problem: &P) -> Option<u64>;

    /// `to` ← the approximation at t + h from the point `from` at t, with its estimated error, which
    /// is infinite when there is no estimate. On an error of the step, `to` holds nothing of use.
    ///
    /// # Errors
    /// Why the step could not be taken; a smaller one may.
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError>;
}

/// Points that can be compared: those of a linear space with a norm.
///
/// Implemented for numbers, for vectors and matrices of both layers, by the Frobenius norm, and for
/// pairs and boxed slices of them. Allocates nothing.
pub trait Metric {
    /// The reals of the norm.
    type Scalar: Real;
    /// self ← x, into the storage that there is.
    fn assign(&mut self, x: &Self);
    /// ‖self‖.
    fn size(&self) -> Self::Scalar;
    /// ‖self − x‖.
    fn distance(&self, x: &Self) -> Self::Scalar;
}

/// The error between two results in M, and the way from the start to the second of them. What
/// rounding alone may do to the difference is no error of the step: it counts as 0.
#[inline]
pub(super) fn between<S: Real, M: Metric<Scalar = S>>(error: S, from: &M, to: &M) -> LocalError<S> {
    let noise = S::lit(8.0 * S::EPSILON) * to.size();
    let error = if (error - noise).all_below(0.0) { S::lit(0.0) } else { error };
    LocalError { error, length: to.distance(from) }
}

/// What [`Embedded::error_order`] says of a tableau without an embedded row.
pub(super) fn without_pair(tableau: &'static str) -> Error {
    Error::Unsupported {
        what: "a step size of its own choice",
        with: format!("tableau `{tableau}`"),
        why: "it has no embedded row; use a pair such as `dopri5`, or step doubling",
    }
}

macro_rules! metric_of_numbers {
    ($($t:ty),*) => {$(
        impl Metric for $t {
            type Scalar = $t;
            #[inline]
            fn assign(&mut self, x: &Self) {
                *self = *x;
            }
            #[inline]
            fn size(&self) -> $t {
                Real::abs(*self)
            }
            #[inline]
            fn distance(&self, x: &Self) -> $t {
                Real::abs(*self - *x)
            }
        }
    )*};
}
metric_of_numbers!(f32, f64, Counted, DoubleDouble);

macro_rules! metric_of_small {
    ($($t:ident),*) => {$(
        impl<S: Real> Metric for $t<S> {
            type Scalar = S;
            #[inline]
            fn assign(&mut self, x: &Self) {
                *self = *x;
            }
            #[inline]
            fn size(&self) -> S {
                self.iter().fold(S::lit(0.0), |s, &x| s + x * x).sqrt()
            }
            #[inline]
            fn distance(&self, x: &Self) -> S {
                let squares = self.iter().zip(x).fold(S::lit(0.0), |s, (&a, &b)| {
                    let d = a - b;
                    s + d * d
                });
                squares.sqrt()
            }
        }
    )*};
}
metric_of_small!(Vector3, Matrix3);

impl Metric for Mat<f64> {
    type Scalar = f64;
    fn assign(&mut self, x: &Self) {
        self.copy_from(x);
    }
    fn size(&self) -> f64 {
        norm_frobenius(self)
    }
    fn distance(&self, x: &Self) -> f64 {
        tally(|| Ops::adds(2 * x.nrows() * x.ncols()) + Ops::muls(x.nrows() * x.ncols()));
        let mut s = 0.0;
        for j in 0..self.ncols() {
            for (a, b) in self.col_as_slice(j).iter().zip(x.col_as_slice(j)) {
                s += (a - b) * (a - b);
            }
        }
        s.sqrt()
    }
}

macro_rules! metric_of_element {
    ($($t:ident),*) => {$(
        impl Metric for $t {
            type Scalar = f64;
            fn assign(&mut self, x: &Self) {
                (**self).assign(x);
            }
            fn size(&self) -> f64 {
                (**self).size()
            }
            fn distance(&self, x: &Self) -> f64 {
                (**self).distance(x)
            }
        }
    )*};
}
metric_of_element!(AlgebraMatrix, GroupMatrix);

impl<A: Metric, B: Metric<Scalar = A::Scalar>> Metric for (A, B) {
    type Scalar = A::Scalar;
    #[inline]
    fn assign(&mut self, x: &Self) {
        self.0.assign(&x.0);
        self.1.assign(&x.1);
    }
    #[inline]
    fn size(&self) -> A::Scalar {
        let (a, b) = (self.0.size(), self.1.size());
        (a * a + b * b).sqrt()
    }
    #[inline]
    fn distance(&self, x: &Self) -> A::Scalar {
        let (a, b) = (self.0.distance(&x.0), self.1.distance(&x.1));
        (a * a + b * b).sqrt()
    }
}

impl<M: Metric> Metric for Box<[M]> {
    type Scalar = M::Scalar;
    #[inline]
    fn assign(&mut self, x: &Self) {
        for (y, x) in self.iter_mut().zip(x) {
            y.assign(x);
        }
    }
    fn size(&self) -> M::Scalar {
        let squares = self.iter().map(|a| a.size()).fold(M::Scalar::lit(0.0), |s, a| s + a * a);
        squares.sqrt()
    }
    fn distance(&self, x: &Self) -> M::Scalar {
        let gaps = self.iter().zip(x).map(|(a, b)| a.distance(b));
        gaps.fold(M::Scalar::lit(0.0), |s, d| s + d * d).sqrt()
    }
}
