//! Points of linear spaces, so that what [`Ambient`](super::Ambient) asks for is written once.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::dense;
use crate::groups::{AlgebraMatrix, GroupMatrix};
use crate::methods::Metric;
use crate::scalar::{Counted, DoubleDouble, Ops, Real, tally};

/// A point of a linear space with a norm: numbers, vectors and matrices of both layers, pairs and
/// boxed slices of them. Allocates nothing.
pub trait LinearSpace: Metric + Clone {
    /// self ← 0.
    fn clear(&mut self);
    /// self ← self + a·x.
    fn add(&mut self, a: Self::Scalar, x: &Self);
    /// ⟨self, x⟩, the sum of the products of their numbers.
    fn dot(&self, x: &Self) -> Self::Scalar;
    /// Is every number finite?
    fn is_finite(&self) -> bool;
}

macro_rules! number {
    ($($t:ty),*) => {$(
        impl LinearSpace for $t {
            #[inline]
            fn clear(&mut self) {
                *self = <$t>::lit(0.0);
            }
            #[inline]
            fn add(&mut self, a: $t, x: &Self) {
                *self += a * *x;
            }
            #[inline]
            fn dot(&self, x: &Self) -> $t {
                *self * *x
            }
            #[inline]
            fn is_finite(&self) -> bool {
                Real::is_finite(*self)
            }
        }
    )*};
}
number!(f32, f64, Counted, DoubleDouble);

macro_rules! small {
    ($($t:ident),*) => {$(
        impl<S: Real> LinearSpace for $t<S> {
            #[inline]
            fn clear(&mut self) {
                self.iter_mut().for_each(|x| *x = S::lit(0.0));
            }
            #[inline]
            fn add(&mut self, a: S, x: &Self) {
                for (y, x) in self.iter_mut().zip(x) {
                    *y += a * *x;
                }
            }
            #[inline]
            fn dot(&self, x: &Self) -> S {
                self.iter().zip(x).fold(S::lit(0.0), |sum, (y, x)| sum + *y * *x)
            }
            #[inline]
            fn is_finite(&self) -> bool {
                self.iter().all(|x| Real::is_finite(*x))
            }
        }
    )*};
}
small!(Vector3, Matrix3);

macro_rules! dense {
    ($($t:ty),*) => {$(
        impl LinearSpace for $t {
            fn clear(&mut self) {
                self.fill(0.0);
            }
            fn add(&mut self, a: f64, x: &Self) {
                dense::axpy(a, x, self);
            }
            fn dot(&self, x: &Self) -> f64 {
                tally(|| Ops::dots(1, x.nrows() * x.ncols()));
                let column = |j| self.col_as_slice(j).iter().zip(x.col_as_slice(j));
                (0..self.ncols()).flat_map(column).map(|(y, x)| y * x).sum()
            }
            fn is_finite(&self) -> bool {
                dense::is_finite(self)
            }
        }
    )*};
}
dense!(Mat<f64>, AlgebraMatrix, GroupMatrix);

impl<A: LinearSpace, B: LinearSpace<Scalar = A::Scalar>> LinearSpace for (A, B) {
    #[inline]
    fn clear(&mut self) {
        self.0.clear();
        self.1.clear();
    }
    #[inline]
    fn add(&mut self, a: A::Scalar, x: &Self) {
        self.0.add(a, &x.0);
        self.1.add(a, &x.1);
    }
    #[inline]
    fn dot(&self, x: &Self) -> A::Scalar {
        self.0.dot(&x.0) + self.1.dot(&x.1)
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.0.is_finite() && self.1.is_finite()
    }
}

impl<A: LinearSpace> LinearSpace for Box<[A]> {
    #[inline]
    fn clear(&mut self) {
        self.iter_mut().for_each(A::clear);
    }
    #[inline]
    fn add(&mut self, a: A::Scalar, x: &Self) {
        for (y, x) in self.iter_mut().zip(x) {
            y.add(a, x);
        }
    }
    #[inline]
    fn dot(&self, x: &Self) -> A::Scalar {
        self.iter().zip(x).fold(A::Scalar::lit(0.0), |sum, (y, x)| sum + y.dot(x))
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.iter().all(A::is_finite)
    }
}

/// `copy`, `add` and `is_finite` of [`Ambient`](super::Ambient) from [`LinearSpace`].
macro_rules! linear_space {
    () => {
        #[inline]
        fn copy(
            &self,
            x: &$crate::problems::PointOf<Self>,
            y: &mut $crate::problems::PointOf<Self>,
        ) {
            $crate::methods::Metric::assign(y, x);
        }
        #[inline]
        fn add(
            &self,
            a: $crate::problems::ScalarOf<Self>,
            x: &$crate::problems::PointOf<Self>,
            y: &mut $crate::problems::PointOf<Self>,
        ) {
            $crate::problems::LinearSpace::add(y, a, x);
        }
        #[inline]
        fn is_finite(&self, y: &$crate::problems::PointOf<Self>) -> bool {
            $crate::problems::LinearSpace::is_finite(y)
        }
    };
}
pub(crate) use linear_space;
