//! Elements as matrices, so that a law is said in plain products of faer matrices and owes nothing
//! to the kernels under test.

use faer::{Mat, c64};
use lieflow::groups::{
    ComplexMatrix, MatrixGroup, Power, Product, Sample, Se3, Se23, So3, UnitQuaternions, Unitary,
    hat,
};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

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

    /// ‖g‖ (Frobenius) as a matrix, over ‖g‖ in the norm of `distance`.
    fn norm_ratio(&self) -> f64 {
        1.0
    }
    /// g·x of the matrices of both.
    fn applied(&self, g: &Mat<f64>, x: &Mat<f64>) -> Mat<f64> {
        g * x
    }
    /// d/dt exp(tξ)·x at t = 0, of the matrices of both.
    fn tangent_matrix(&self, xi: &Mat<f64>, x: &Mat<f64>) -> Mat<f64> {
        xi * x
    }

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

/// [a x; 0 w].
pub(crate) fn affine(a: &Mat<f64>, x: &Vector3<f64>, w: f64) -> Mat<f64> {
    Mat::from_fn(4, 4, |i, j| match (i < 3, j < 3) {
        (true, true) => a[(i, j)],
        (true, false) => x[i],
        (false, true) => 0.0,
        (false, false) => w,
    })
}
/// The last column of a 4×4 matrix, without its last entry.
fn column(x: &Mat<f64>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| x[(i, x.ncols() - 1)])
}

impl Represent for Se3 {
    fn algebra_matrix(&self, u: &(Vector3<f64>, Vector3<f64>)) -> Mat<f64> {
        affine(&faer3(&hat(&u.0)), &u.1, 0.0)
    }
    fn element_matrix(&self, g: &(Matrix3<f64>, Vector3<f64>)) -> Mat<f64> {
        affine(&faer3(&g.0), &g.1, 1.0)
    }
    /// (p, 1).
    fn vector_matrix(&self, p: &Vector3<f64>) -> Mat<f64> {
        Mat::from_fn(4, 1, |i, _| if i < 3 { p[i] } else { 1.0 })
    }
    fn nearest(&self, x: &Mat<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (So3::new().nearest(x), column(x))
    }
    fn element_of(&self, x: &Mat<f64>) -> (Matrix3<f64>, Vector3<f64>) {
        (So3::new().element_of(x), column(x))
    }
    fn vector_of(&self, x: &Mat<f64>) -> Vector3<f64> {
        column(x)
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        None
    }
}

/// [a v p; 0 w 0; 0 0 w].
fn extended(a: &Mat<f64>, (v, p): &(Vector3<f64>, Vector3<f64>), w: f64) -> Mat<f64> {
    Mat::from_fn(5, 5, |i, j| match (i < 3, j) {
        (true, 0..3) => a[(i, j)],
        (true, 3) => v[i],
        (true, _) => p[i],
        (false, _) => {
            if i == j {
                w
            } else {
                0.0
            }
        }
    })
}
/// The last two columns of a 5×5 matrix, without their last entries.
fn columns(x: &Mat<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::from_fn(|i, _| x[(i, 3)]), Vector3::from_fn(|i, _| x[(i, 4)]))
}

impl Represent for Se23 {
    fn algebra_matrix(&self, u: &Self::Alg) -> Mat<f64> {
        extended(&faer3(&hat(&u.0)), &u.1, 0.0)
    }
    fn element_matrix(&self, g: &Self::Elem) -> Mat<f64> {
        extended(&faer3(&g.0), &g.1, 1.0)
    }
    /// (x, 0, 1).
    fn vector_matrix(&self, x: &Vector3<f64>) -> Mat<f64> {
        Mat::from_fn(5, 1, |i, _| if i < 3 { x[i] } else { (i - 3) as f64 })
    }
    fn nearest(&self, x: &Mat<f64>) -> Self::Alg {
        (So3::new().nearest(x), columns(x))
    }
    fn element_of(&self, x: &Mat<f64>) -> Self::Elem {
        (So3::new().element_of(x), columns(x))
    }
    fn vector_of(&self, x: &Mat<f64>) -> Vector3<f64> {
        column(x)
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        None
    }
}

/// [re −im; im re].
pub(crate) fn real_form(x: &ComplexMatrix) -> Mat<f64> {
    let (m, n) = (x.nrows(), x.ncols());
    let mut out = Mat::zeros(2 * m, 2 * n);
    for j in 0..n {
        for i in 0..m {
            let z = x.get(i, j);
            (out[(i, j)], out[(i + m, j + n)]) = (z.re, z.re);
            (out[(i + m, j)], out[(i, j + n)]) = (z.im, -z.im);
        }
    }
    out
}
/// re + i·im from [re −im; im re].
pub(crate) fn complex_form(x: &Mat<f64>) -> ComplexMatrix {
    let (m, n) = (x.nrows() / 2, x.ncols() / 2);
    ComplexMatrix::from_fn(m, n, |i, j| c64::new(x[(i, j)], x[(i + m, j)]))
}

impl Represent for Unitary {
    fn algebra_matrix(&self, u: &ComplexMatrix) -> Mat<f64> {
        real_form(u)
    }
    fn element_matrix(&self, g: &ComplexMatrix) -> Mat<f64> {
        real_form(g)
    }
    fn vector_matrix(&self, x: &ComplexMatrix) -> Mat<f64> {
        real_form(x)
    }
    fn nearest(&self, x: &Mat<f64>) -> ComplexMatrix {
        let n = self.n();
        let mean = |i, j| {
            let re = x[(i, j)] + x[(i + n, j + n)];
            c64::new(0.5 * re, 0.5 * (x[(i + n, j)] - x[(i, j + n)]))
        };
        ComplexMatrix::from_fn(n, n, |i, j| 0.5 * (mean(i, j) - mean(j, i).conj()))
    }
    fn element_of(&self, x: &Mat<f64>) -> ComplexMatrix {
        complex_form(x)
    }
    fn vector_of(&self, x: &Mat<f64>) -> ComplexMatrix {
        complex_form(x)
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        Some(Mat::identity(2 * self.n(), 2 * self.n()))
    }
    fn norm_ratio(&self) -> f64 {
        std::f64::consts::SQRT_2
    }
}

/// The matrix of y ↦ (w, v)·y on the quaternions ℝ⁴.
fn left(w: f64, v: &Vector3<f64>) -> Mat<f64> {
    faer::mat![
        [w, -v[0], -v[1], -v[2]],
        [v[0], w, -v[2], v[1]],
        [v[1], v[2], w, -v[0]],
        [v[2], -v[1], v[0], w],
    ]
}
/// v of the part of x that has the form of `left`.
fn imaginary(x: &Mat<f64>) -> Vector3<f64> {
    let mean =
        |i: usize, j: usize, k: usize| 0.25 * (x[(i, 0)] - x[(0, i)] + x[(k, j)] - x[(j, k)]);
    Vector3::new(mean(1, 2, 3), mean(2, 3, 1), mean(3, 1, 2))
}

/// u is the imaginary quaternion u/2, and q·x is q x q̄.
impl Represent for UnitQuaternions {
    fn algebra_matrix(&self, u: &Vector3<f64>) -> Mat<f64> {
        left(0.0, &(0.5 * u))
    }
    fn element_matrix(&self, q: &UnitQuaternion<f64>) -> Mat<f64> {
        left(q.w, &q.imag())
    }
    fn vector_matrix(&self, x: &Vector3<f64>) -> Mat<f64> {
        left(0.0, x)
    }
    fn nearest(&self, x: &Mat<f64>) -> Vector3<f64> {
        2.0 * imaginary(x)
    }
    fn element_of(&self, x: &Mat<f64>) -> UnitQuaternion<f64> {
        let [w, i, j, k] = [0, 1, 2, 3].map(|i| x[(i, 0)]);
        UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k))
    }
    fn vector_of(&self, x: &Mat<f64>) -> Vector3<f64> {
        imaginary(x)
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        Some(Mat::identity(4, 4))
    }
    fn norm_ratio(&self) -> f64 {
        2.0
    }
    fn applied(&self, q: &Mat<f64>, x: &Mat<f64>) -> Mat<f64> {
        q * x * q.transpose()
    }
    fn tangent_matrix(&self, xi: &Mat<f64>, x: &Mat<f64>) -> Mat<f64> {
        xi * x - x * xi
    }
}

/// The parts as the blocks of a block-diagonal matrix.
pub(crate) fn blocks(parts: &[Mat<f64>]) -> Mat<f64> {
    let rows = parts.iter().map(Mat::nrows).sum();
    let cols = parts.iter().map(Mat::ncols).sum();
    let (mut out, mut at) = (Mat::zeros(rows, cols), (0, 0));
    for part in parts {
        out.submatrix_mut(at.0, at.1, part.nrows(), part.ncols()).copy_from(part);
        at = (at.0 + part.nrows(), at.1 + part.ncols());
    }
    out
}

/// The blocks of these shapes.
pub(crate) fn cut(x: &Mat<f64>, shapes: impl IntoIterator<Item = (usize, usize)>) -> Vec<Mat<f64>> {
    let mut at = (0, 0);
    let mut take = |(rows, cols)| {
        let block = x.submatrix(at.0, at.1, rows, cols).to_owned();
        at = (at.0 + rows, at.1 + cols);
        block
    };
    shapes.into_iter().map(&mut take).collect()
}

/// n of the n×n matrices of the group.
pub(crate) fn order_of<G: Represent>(group: &G) -> usize {
    group.element_matrix(&group.identity()).nrows()
}

/// The two diagonal blocks.
fn halves<A: Represent, B: Represent>(group: &Product<A, B>, x: &Mat<f64>) -> [Mat<f64>; 2] {
    let (m, n) = (order_of(&group.0), order_of(&group.1));
    [cut(x, [(m, m)]).remove(0), cut(x, [(m, m), (n, n)]).remove(1)]
}

impl<A: Represent, B: Represent> Represent for Product<A, B> {
    fn algebra_matrix(&self, u: &Self::Alg) -> Mat<f64> {
        blocks(&[self.0.algebra_matrix(&u.0), self.1.algebra_matrix(&u.1)])
    }
    fn element_matrix(&self, g: &Self::Elem) -> Mat<f64> {
        blocks(&[self.0.element_matrix(&g.0), self.1.element_matrix(&g.1)])
    }
    fn vector_matrix(&self, x: &Self::Vector) -> Mat<f64> {
        blocks(&[self.0.vector_matrix(&x.0), self.1.vector_matrix(&x.1)])
    }
    fn nearest(&self, x: &Mat<f64>) -> Self::Alg {
        let [a, b] = halves(self, x);
        (self.0.nearest(&a), self.1.nearest(&b))
    }
    fn element_of(&self, x: &Mat<f64>) -> Self::Elem {
        let [a, b] = halves(self, x);
        (self.0.element_of(&a), self.1.element_of(&b))
    }
    fn vector_of(&self, x: &Mat<f64>) -> Self::Vector {
        let (m, n) = (order_of(&self.0), order_of(&self.1));
        let parts = cut(x, [(m, 1), (n, 1)]);
        (self.0.vector_of(&parts[0]), self.1.vector_of(&parts[1]))
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        Some(blocks(&[self.0.bilinear()?, self.1.bilinear()?]))
    }
    /// Where both parts have the same.
    fn norm_ratio(&self) -> f64 {
        assert_eq!(self.0.norm_ratio(), self.1.norm_ratio());
        self.0.norm_ratio()
    }
}

/// The matrices of all copies.
fn all<T>(parts: &[T], matrix: impl Fn(&T) -> Mat<f64>) -> Mat<f64> {
    blocks(&parts.iter().map(matrix).collect::<Vec<_>>())
}

impl<G: Represent> Represent for Power<G> {
    fn algebra_matrix(&self, u: &Self::Alg) -> Mat<f64> {
        all(u, |u| self.group().algebra_matrix(u))
    }
    fn element_matrix(&self, g: &Self::Elem) -> Mat<f64> {
        all(g, |g| self.group().element_matrix(g))
    }
    fn vector_matrix(&self, x: &Self::Vector) -> Mat<f64> {
        all(x, |x| self.group().vector_matrix(x))
    }
    fn nearest(&self, x: &Mat<f64>) -> Self::Alg {
        let n = order_of(self.group());
        cut(x, vec![(n, n); self.copies()]).iter().map(|x| self.group().nearest(x)).collect()
    }
    fn element_of(&self, x: &Mat<f64>) -> Self::Elem {
        let n = order_of(self.group());
        cut(x, vec![(n, n); self.copies()]).iter().map(|x| self.group().element_of(x)).collect()
    }
    fn vector_of(&self, x: &Mat<f64>) -> Self::Vector {
        let n = order_of(self.group());
        cut(x, vec![(n, 1); self.copies()]).iter().map(|x| self.group().vector_of(x)).collect()
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        let m = self.group().bilinear()?;
        Some(blocks(&vec![m; self.copies()]))
    }
    fn norm_ratio(&self) -> f64 {
        self.group().norm_ratio()
    }
}
