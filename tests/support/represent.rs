//! Elements as matrices, so that a law is said in plain products of faer matrices and owes nothing
//! to the kernels under test.

use faer::Mat;
use lieflow::groups::{MatrixGroup, Sample, So3, hat};
use nalgebra::{Matrix3, Vector3};

/// A group that knows its elements as matrices. A new type of group implements it once; a new
/// [`MatrixGroup`] has it already.
pub(crate) trait Represent: Sample<Scalar = f64> {
    /// u as an n×n matrix.
    fn algebra_matrix(&self, u: &Self::Alg) -> Mat<f64>;
    /// g as an n×n matrix.
    fn element_matrix(&self, g: &Self::Elem) -> Mat<f64>;
    /// x as columns.
    fn vector_matrix(&self, x: &Self::Vector) -> Mat<f64>;
    /// The element of the algebra nearest to x.
    fn nearest(&self, x: &Mat<f64>) -> Self::Alg;
    /// The element of the group with these entries.
    fn element_of(&self, x: &Mat<f64>) -> Self::Elem;
    /// The vector with these entries.
    fn vector_of(&self, x: &Mat<f64>) -> Self::Vector;
    /// M of gᵀMg = M; nothing on GL(n).
    fn bilinear(&self) -> Option<Mat<f64>>;

    /// a·u.
    fn scaled(&self, a: f64, u: &Self::Alg) -> Self::Alg {
        let mut out = self.zero();
        self.axpy(a, u, &mut out);
        out
    }
    /// u + a·v.
    fn moved(&self, u: &Self::Alg, a: f64, v: &Self::Alg) -> Self::Alg {
        let mut out = u.clone();
        self.axpy(a, v, &mut out);
        out
    }
    /// A random direction with ‖u‖ = `size`.
    fn of_size(&self, rng: &mut rand_pcg::Pcg64, size: f64) -> Self::Alg {
        let u = self.sample_algebra(rng, 1.0);
        self.scaled(size / self.norm(&u), &u)
    }
    /// [u, v], fresh.
    fn commutator(&self, u: &Self::Alg, v: &Self::Alg) -> Self::Alg {
        let mut out = self.zero();
        self.bracket(u, v, &mut out);
        out
    }
    /// a·b, fresh.
    fn product(&self, a: &Self::Elem, b: &Self::Elem) -> Self::Elem {
        let mut out = self.identity();
        self.compose(a, b, &mut out);
        out
    }
}

/// nalgebra's 3×3 as a faer matrix.
pub(crate) fn faer3(x: &Matrix3<f64>) -> Mat<f64> {
    Mat::from_fn(3, 3, |i, j| x[(i, j)])
}

impl Represent for So3 {
    fn algebra_matrix(&self, u: &Vector3<f64>) -> Mat<f64> {
        faer3(&hat(u))
    }
    fn element_matrix(&self, g: &Matrix3<f64>) -> Mat<f64> {
        faer3(g)
    }
    fn vector_matrix(&self, x: &Vector3<f64>) -> Mat<f64> {
        Mat::from_fn(3, 1, |i, _| x[i])
    }
    fn nearest(&self, x: &Mat<f64>) -> Vector3<f64> {
        let skew = |i, j| 0.5 * (x[(i, j)] - x[(j, i)]);
        Vector3::new(skew(2, 1), skew(0, 2), skew(1, 0))
    }
    fn element_of(&self, x: &Mat<f64>) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| x[(i, j)])
    }
    fn vector_of(&self, x: &Mat<f64>) -> Vector3<f64> {
        Vector3::from_fn(|i, _| x[(i, 0)])
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        Some(Mat::identity(3, 3))
    }
}

impl Represent for MatrixGroup {
    fn algebra_matrix(&self, u: &Self::Alg) -> Mat<f64> {
        u.as_ref().to_owned()
    }
    fn element_matrix(&self, g: &Self::Elem) -> Mat<f64> {
        g.as_ref().to_owned()
    }
    fn vector_matrix(&self, x: &Mat<f64>) -> Mat<f64> {
        x.clone()
    }
    fn nearest(&self, x: &Mat<f64>) -> Self::Alg {
        self.project_algebra(x.as_ref())
    }
    fn element_of(&self, x: &Mat<f64>) -> Self::Elem {
        lieflow::groups::GroupMatrix::new_unchecked(x.clone())
    }
    fn vector_of(&self, x: &Mat<f64>) -> Mat<f64> {
        x.clone()
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        self.m()
    }
}
