//! Elements of matrix groups and of their algebras: a type for each, over a faer matrix.

use core::ops::{Deref, DerefMut};

use approx::{AbsDiffEq, RelativeEq};
use faer::Mat;

use crate::error::Error;
use crate::space::{LinearSpace, Metric, Numbers};

macro_rules! matrix_element {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, PartialEq)]
        pub struct $name(Mat<f64>);

        /// `clone_from` does not allocate where the sizes agree.
        impl Clone for $name {
            fn clone(&self) -> Self {
                Self(self.0.clone())
            }
            fn clone_from(&mut self, x: &Self) {
                self.0.copy_from(&x.0);
            }
        }

        impl $name {
            /// Takes the matrix without a check. A matrix outside of the set gives wrong numbers, but never undefined
            /// behaviour.
            pub fn new_unchecked(matrix: Mat<f64>) -> Self {
                Self(matrix)
            }
            /// The matrix itself.
            pub fn into_mat(self) -> Mat<f64> {
                self.0
            }
        }

        /// Gives read access to the faer matrix.
        impl Deref for $name {
            type Target = Mat<f64>;
            fn deref(&self) -> &Mat<f64> {
                &self.0
            }
        }
        /// Gives write access to the entries. Nothing checks that they stay in the set.
        impl DerefMut for $name {
            fn deref_mut(&mut self) -> &mut Mat<f64> {
                &mut self.0
            }
        }

        impl Numbers for $name {
            fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
                self.0.each_number(each);
            }
        }
        impl Metric for $name {
            type Scalar = f64;
            const IS_ONE_PART: bool = true;
            fn check_sizes(&self, arg: &'static str, like: &Self) -> Result<(), Error> {
                self.0.check_sizes(arg, like)
            }
            fn assign(&mut self, x: &Self) {
                self.0.assign(x);
            }
            fn size(&self) -> f64 {
                self.0.size()
            }
            fn distance(&self, x: &Self) -> f64 {
                self.0.distance(x)
            }
            fn is_same(&self, x: &Self) -> bool {
                self.0.is_same(x)
            }
        }
        impl LinearSpace for $name {
            fn clear(&mut self) {
                self.0.clear();
            }
            fn add(&mut self, a: f64, x: &Self) {
                self.0.add(a, x);
            }
            fn dot(&self, x: &Self) -> f64 {
                self.0.dot(x)
            }
            fn is_finite(&self) -> bool {
                self.0.is_finite()
            }
        }

        /// Entry by entry. Matrices of different sizes differ.
        impl AbsDiffEq for $name {
            type Epsilon = f64;
            fn default_epsilon() -> f64 {
                f64::EPSILON
            }
            fn abs_diff_eq(&self, other: &Self, epsilon: f64) -> bool {
                entries_agree(&self.0, &other.0, |a, b| a.abs_diff_eq(&b, epsilon))
            }
        }
        /// Entry by entry. Matrices of different sizes differ.
        impl RelativeEq for $name {
            fn default_max_relative() -> f64 {
                f64::EPSILON
            }
            fn relative_eq(&self, other: &Self, epsilon: f64, max_relative: f64) -> bool {
                entries_agree(&self.0, &other.0, |a, b| a.relative_eq(&b, epsilon, max_relative))
            }
        }
    };
}

matrix_element! {
    /// u ∈ 𝔤 ⊂ gl(n). Made by [`MatrixGroup::algebra`](super::MatrixGroup::algebra), which checks.
    AlgebraMatrix
}
matrix_element! {
    /// g ∈ G ⊂ GL(n). Made by [`MatrixGroup::element`](super::MatrixGroup::element), which checks.
    GroupMatrix
}

fn entries_agree(a: &Mat<f64>, b: &Mat<f64>, agree: impl Fn(f64, f64) -> bool) -> bool {
    (a.nrows(), a.ncols()) == (b.nrows(), b.ncols())
        && (0..a.ncols()).all(|j| (0..a.nrows()).all(|i| agree(a[(i, j)], b[(i, j)])))
}
