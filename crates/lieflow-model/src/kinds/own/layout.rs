//! Points and values of f as numbers by rows.

use faer::Mat;
use lieflow::Error;
use lieflow::groups::{AlgebraMatrix, MatrixGroup, Se3, So3, UnitQuaternions};
use lieflow_runs::spaces::{Field, Parts, Point, reverse};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// How points of this type and elements of the algebra of G are numbers by rows.
pub(super) trait Layout<G: lieflow::LieGroup, Y>: Copy + Send + Sync + 'static {
    /// How many numbers a point has, and a value of f.
    fn sizes(self, group: &G) -> [usize; 2];
    /// Checks numbers that a point does not have.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    fn check(self, _rows: &[f64]) -> Result<(), Error> {
        Ok(())
    }
    /// The point of these numbers.
    fn point(self, group: &G, rows: &[f64]) -> Y;
    /// rows ← the numbers of the point.
    fn show(self, y: &Y, rows: &mut [f64]);
    /// v ← the element of 𝔤 of these numbers.
    fn value(self, rows: &[f64], v: &mut G::Alg);
    /// v ← −v in the parts that have a frame: the field of a translation from the right.
    fn reverse(self, _v: &mut G::Alg) {}
}

fn vector(x: &[f64]) -> Vector3<f64> {
    Vector3::new(x[0], x[1], x[2])
}

fn show_matrix(g: &Matrix3<f64>, width: usize, rows: &mut [f64]) {
    for i in 0..3 {
        for j in 0..3 {
            rows[width * i + j] = g[(i, j)];
        }
    }
}

/// Elements of SO(3).
#[derive(Clone, Copy)]
pub(super) struct Rotations;

impl Layout<So3<f64>, Matrix3<f64>> for Rotations {
    fn sizes(self, _: &So3<f64>) -> [usize; 2] {
        [9, 3]
    }
    fn point(self, _: &So3<f64>, rows: &[f64]) -> Matrix3<f64> {
        Matrix3::from_row_slice(rows)
    }
    fn show(self, y: &Matrix3<f64>, rows: &mut [f64]) {
        show_matrix(y, 3, rows);
    }
    fn value(self, rows: &[f64], v: &mut Vector3<f64>) {
        *v = vector(rows);
    }
    fn reverse(self, v: &mut Vector3<f64>) {
        *v = -*v;
    }
}

/// Vectors under SO(3).
#[derive(Clone, Copy)]
pub(super) struct Vectors;

impl Layout<So3<f64>, Vector3<f64>> for Vectors {
    fn sizes(self, _: &So3<f64>) -> [usize; 2] {
        [3, 3]
    }
    fn point(self, _: &So3<f64>, rows: &[f64]) -> Vector3<f64> {
        vector(rows)
    }
    fn show(self, y: &Vector3<f64>, rows: &mut [f64]) {
        rows.copy_from_slice(y.as_slice());
    }
    fn value(self, rows: &[f64], v: &mut Vector3<f64>) {
        *v = vector(rows);
    }
}

type Pair = (Vector3<f64>, Vector3<f64>);

fn pair(rows: &[f64]) -> Pair {
    (vector(rows), vector(&rows[3..]))
}

/// Elements of SE(3) as 4×4 matrices.
#[derive(Clone, Copy)]
pub(super) struct Motions;

impl Layout<Se3<f64>, (Matrix3<f64>, Vector3<f64>)> for Motions {
    fn sizes(self, _: &Se3<f64>) -> [usize; 2] {
        [16, 6]
    }
    fn check(self, rows: &[f64]) -> Result<(), Error> {
        let last = [0.0, 0.0, 0.0, 1.0];
        // Seven digits are enough, as for the rotation.
        match (0..4).find(|&j| (rows[12 + j] - last[j]).abs() > 1e-6) {
            None => Ok(()),
            Some(j) => {
                let expected = format!("{}: the last row of [R x; 0 1] is [0, 0, 0, 1]", last[j]);
                Err(Error::OutOfRange { arg: format!("y[3, {j}]"), value: rows[12 + j], expected })
            }
        }
    }
    fn point(self, _: &Se3<f64>, rows: &[f64]) -> (Matrix3<f64>, Vector3<f64>) {
        let r = Matrix3::from_fn(|i, j| rows[4 * i + j]);
        (r, Vector3::from_fn(|i, _| rows[4 * i + 3]))
    }
    fn show(self, (r, x): &(Matrix3<f64>, Vector3<f64>), rows: &mut [f64]) {
        show_matrix(r, 4, rows);
        for i in 0..3 {
            rows[4 * i + 3] = x[i];
        }
        rows[12..].copy_from_slice(&[0.0, 0.0, 0.0, 1.0]);
    }
    fn value(self, rows: &[f64], v: &mut Pair) {
        *v = pair(rows);
    }
    fn reverse(self, v: &mut Pair) {
        *v = (-v.0, -v.1);
    }
}

/// Elements of se(3)*.
#[derive(Clone, Copy)]
pub(super) struct Pairs;

impl Layout<Se3<f64>, Pair> for Pairs {
    fn sizes(self, _: &Se3<f64>) -> [usize; 2] {
        [6, 6]
    }
    fn point(self, _: &Se3<f64>, rows: &[f64]) -> Pair {
        pair(rows)
    }
    fn show(self, y: &Pair, rows: &mut [f64]) {
        rows[..3].copy_from_slice(y.0.as_slice());
        rows[3..].copy_from_slice(y.1.as_slice());
    }
    fn value(self, rows: &[f64], v: &mut Pair) {
        *v = pair(rows);
    }
}

/// Unit quaternions, the real part first.
#[derive(Clone, Copy)]
pub(super) struct Quaternions;

impl Layout<UnitQuaternions, UnitQuaternion<f64>> for Quaternions {
    fn sizes(self, _: &UnitQuaternions) -> [usize; 2] {
        [4, 3]
    }
    fn point(self, _: &UnitQuaternions, rows: &[f64]) -> UnitQuaternion<f64> {
        UnitQuaternion::new_unchecked(Quaternion::new(rows[0], rows[1], rows[2], rows[3]))
    }
    fn show(self, y: &UnitQuaternion<f64>, rows: &mut [f64]) {
        rows.copy_from_slice(&[y.w, y.i, y.j, y.k]);
    }
    fn value(self, rows: &[f64], v: &mut Vector3<f64>) {
        *v = vector(rows);
    }
    fn reverse(self, v: &mut Vector3<f64>) {
        *v = -*v;
    }
}

/// Vectors, rotations and numbers, in this order.
#[derive(Clone, Copy, Debug)]
pub(super) struct InParts {
    pub(super) vectors: usize,
    pub(super) rotations: usize,
    pub(super) numbers: usize,
}

impl Layout<Parts, Point> for InParts {
    fn sizes(self, _: &Parts) -> [usize; 2] {
        let InParts { vectors, rotations, numbers } = self;
        [3 * vectors + 9 * rotations + numbers, 3 * (vectors + rotations) + numbers]
    }
    fn point(self, _: &Parts, rows: &[f64]) -> Point {
        let (vectors, rest) = rows.split_at(3 * self.vectors);
        let (rotations, numbers) = rest.split_at(9 * self.rotations);
        let rotations = rotations.chunks_exact(9).map(Matrix3::from_row_slice);
        (vectors.chunks_exact(3).map(vector).collect(), (rotations.collect(), numbers.into()))
    }
    fn show(self, (vectors, (rotations, numbers)): &Point, rows: &mut [f64]) {
        let entries = |g: &Matrix3<f64>| g.transpose().data.0.into_iter().flatten();
        let vectors = vectors.iter().flat_map(|x| x.iter().copied());
        let all = vectors.chain(rotations.iter().flat_map(entries)).chain(numbers.iter().copied());
        rows.iter_mut().zip(all).for_each(|(row, x)| *row = x);
    }
    fn value(self, rows: &[f64], (vectors, (rotations, numbers)): &mut Field) {
        let (all, last) = rows.split_at(3 * (vectors.len() + rotations.len()));
        let each = vectors.iter_mut().chain(rotations);
        each.zip(all.chunks_exact(3)).for_each(|(v, rows)| *v = vector(rows));
        numbers.copy_from_slice(last);
    }
    /// Numbers are translated, too. Vectors are not.
    fn reverse(self, (_, (rotations, numbers)): &mut Field) {
        rotations.iter_mut().for_each(|v| *v = -*v);
        numbers.iter_mut().for_each(|v| *v = -*v);
    }
}

/// Matrices. f has n×n entries, or for SO(3) three.
#[derive(Clone, Copy)]
pub(super) struct Matrices {
    pub(super) rows: usize,
    pub(super) columns: usize,
}

impl Layout<MatrixGroup, Mat<f64>> for Matrices {
    fn sizes(self, group: &MatrixGroup) -> [usize; 2] {
        let n = group.n();
        let is_so3 = matches!(group.form(), lieflow::groups::Form::Identity) && n == 3;
        [self.rows * self.columns, if is_so3 { 3 } else { n * n }]
    }
    fn point(self, _: &MatrixGroup, rows: &[f64]) -> Mat<f64> {
        Mat::from_fn(self.rows, self.columns, |i, j| rows[i * self.columns + j])
    }
    fn show(self, y: &Mat<f64>, rows: &mut [f64]) {
        for i in 0..self.rows {
            for j in 0..self.columns {
                rows[i * self.columns + j] = y[(i, j)];
            }
        }
    }
    fn value(self, rows: &[f64], v: &mut AlgebraMatrix) {
        let n = v.nrows();
        if rows.len() < n * n {
            let (x, y, z) = (rows[0], rows[1], rows[2]);
            (v[(2, 1)], v[(0, 2)], v[(1, 0)]) = (x, y, z);
            (v[(1, 2)], v[(2, 0)], v[(0, 1)]) = (-x, -y, -z);
            return;
        }
        for i in 0..n {
            for j in 0..n {
                v[(i, j)] = rows[i * n + j];
            }
        }
    }
    fn reverse(self, v: &mut AlgebraMatrix) {
        reverse(v);
    }
}

/// Complex matrices X + iY as numbers Re, Im, Re, … by rows. In the run they are real: \[X −Y; Y X\] where the group acts
/// on both sides, so that U(n) is in SO(2n), and \[X; Y\] where it acts on vectors.
#[derive(Clone, Copy)]
pub(super) struct ComplexMatrices {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// True if the group acts on vectors.
    pub(super) vectors: bool,
}

/// x ← \[X −Y; Y X\] of the numbers, or its first columns.
fn realify(rows: &[f64], n: usize, columns: usize, x: &mut Mat<f64>) {
    for (i, j) in (0..n).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let at = 2 * (i * columns + j);
        let (re, im) = (rows[at], rows[at + 1]);
        (x[(i, j)], x[(n + i, j)]) = (re, im);
        if columns < x.ncols() {
            (x[(i, columns + j)], x[(n + i, columns + j)]) = (-im, re);
        }
    }
}

impl Layout<MatrixGroup, Mat<f64>> for ComplexMatrices {
    fn sizes(self, group: &MatrixGroup) -> [usize; 2] {
        let n = group.n() / 2;
        [2 * self.rows * self.columns, 2 * n * n]
    }
    fn point(self, _: &MatrixGroup, rows: &[f64]) -> Mat<f64> {
        let columns = if self.vectors { self.columns } else { 2 * self.columns };
        let mut x = Mat::zeros(2 * self.rows, columns);
        realify(rows, self.rows, self.columns, &mut x);
        x
    }
    fn show(self, y: &Mat<f64>, rows: &mut [f64]) {
        for i in 0..self.rows {
            for j in 0..self.columns {
                let at = 2 * (i * self.columns + j);
                (rows[at], rows[at + 1]) = (y[(i, j)], y[(self.rows + i, j)]);
            }
        }
    }
    fn value(self, rows: &[f64], v: &mut AlgebraMatrix) {
        let n = v.nrows() / 2;
        realify(rows, n, n, v);
    }
    fn reverse(self, v: &mut AlgebraMatrix) {
        reverse(v);
    }
}
