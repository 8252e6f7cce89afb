//! Complex matrices x = re + i·im with separate real and imaginary parts.
//!
//! Every product is a few real ones. Dense kernels compute these faster than complex ones.
//!
//! | | real products |
//! |---|---|
//! | a·b | 4 |
//! | a·b, if it is skew-Hermitian | 4 halves |

use faer::{Accum, Mat, MatRef, c64};

use crate::dense::{is_finite, lower_product, mirror, mul, mul_add, norm_frobenius, norm_of};
use crate::error::Error;
use crate::scalar::{Ops, tally};
use crate::space::{LinearSpace, Metric, Numbers};

/// A complex matrix re + i·im.
///
/// ```
/// use lieflow::faer::c64;
/// use lieflow::groups::ComplexMatrix;
/// let x = ComplexMatrix::from_fn(2, 2, |i, j| c64::new(i as f64, j as f64));
/// assert_eq!(x.get(1, 0), c64::new(1.0, 0.0));
/// assert_eq!(ComplexMatrix::from(&x.to_complex()), x);
/// ```
#[derive(Debug, PartialEq)]
pub struct ComplexMatrix {
    /// The real part.
    pub re: Mat<f64>,
    /// The imaginary part, of the same size.
    pub im: Mat<f64>,
}

/// `clone_from` does not allocate where the sizes agree.
impl Clone for ComplexMatrix {
    fn clone(&self) -> Self {
        ComplexMatrix { re: self.re.clone(), im: self.im.clone() }
    }
    fn clone_from(&mut self, x: &Self) {
        self.re.copy_from(&x.re);
        self.im.copy_from(&x.im);
    }
}

impl From<&Mat<c64>> for ComplexMatrix {
    fn from(x: &Mat<c64>) -> Self {
        ComplexMatrix::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)])
    }
}

impl ComplexMatrix {
    /// 0.
    pub fn zeros(rows: usize, cols: usize) -> Self {
        ComplexMatrix { re: Mat::zeros(rows, cols), im: Mat::zeros(rows, cols) }
    }
    /// 𝟙.
    pub fn identity(n: usize) -> Self {
        ComplexMatrix { re: Mat::identity(n, n), im: Mat::zeros(n, n) }
    }
    /// The matrix of these entries.
    pub fn from_fn(rows: usize, cols: usize, mut f: impl FnMut(usize, usize) -> c64) -> Self {
        let mut x = Self::zeros(rows, cols);
        for j in 0..cols {
            for i in 0..rows {
                let z = f(i, j);
                (x.re[(i, j)], x.im[(i, j)]) = (z.re, z.im);
            }
        }
        x
    }
    /// This matrix with its real and imaginary parts together.
    pub fn to_complex(&self) -> Mat<c64> {
        Mat::from_fn(self.nrows(), self.ncols(), |i, j| self.get(i, j))
    }
    /// The entry (i, j).
    pub fn get(&self, i: usize, j: usize) -> c64 {
        c64::new(self.re[(i, j)], self.im[(i, j)])
    }
    /// The number of rows.
    pub fn nrows(&self) -> usize {
        self.re.nrows()
    }
    /// The number of columns.
    pub fn ncols(&self) -> usize {
        self.re.ncols()
    }
    /// ‖x + x†‖/‖x‖ in the Frobenius norm: 0 for a skew-Hermitian matrix.
    pub fn skew_residual(&self) -> f64 {
        let (gap, size) = (self.off_skew(), self.size());
        if size > 0.0 { gap / size } else { gap }
    }
    /// ‖x + x†‖ in the Frobenius norm.
    pub(crate) fn off_skew(&self) -> f64 {
        let [re, im] = self.parts();
        norm_of(self.ncols(), self.nrows(), |i, j| {
            (re[(i, j)] + re[(j, i)]).hypot(im[(i, j)] - im[(j, i)])
        })
    }

    /// Both parts.
    pub(crate) fn parts(&self) -> [&Mat<f64>; 2] {
        [&self.re, &self.im]
    }
    /// Both parts.
    pub(crate) fn parts_mut(&mut self) -> [&mut Mat<f64>; 2] {
        [&mut self.re, &mut self.im]
    }

    /// Checks that the matrix is rows×cols and finite.
    pub(crate) fn check(&self, arg: &'static str, rows: usize, cols: usize) -> Result<(), Error> {
        for part in self.parts() {
            let shape = (part.nrows(), part.ncols());
            if shape != (rows, cols) {
                let (expected_rows, expected_cols) = (rows, cols);
                let (rows, cols) = shape;
                return Err(Error::Shape { arg, rows, cols, expected_rows, expected_cols });
            }
            for (col, x) in part.col_iter().enumerate() {
                if let Some((row, &value)) = x.iter().enumerate().find(|(_, x)| !x.is_finite()) {
                    return Err(Error::NotFiniteEntry { arg, row, col, value });
                }
            }
        }
        Ok(())
    }
}

/// out ← a·b.
pub(crate) fn mul_complex(out: &mut ComplexMatrix, a: &ComplexMatrix, b: &ComplexMatrix) {
    mul(&mut out.re, a.re.as_ref(), b.re.as_ref());
    mul_add(&mut out.re, -1.0, a.im.as_ref(), b.im.as_ref());
    mul(&mut out.im, a.re.as_ref(), b.im.as_ref());
    mul_add(&mut out.im, 1.0, a.im.as_ref(), b.re.as_ref());
}

/// out ← a†·b.
pub(crate) fn adjoint_mul_complex(out: &mut ComplexMatrix, a: &ComplexMatrix, b: &ComplexMatrix) {
    mul(&mut out.re, a.re.transpose(), b.re.as_ref());
    mul_add(&mut out.re, 1.0, a.im.transpose(), b.im.as_ref());
    mul(&mut out.im, a.re.transpose(), b.im.as_ref());
    mul_add(&mut out.im, -1.0, a.im.transpose(), b.re.as_ref());
}

/// out ← a·b†, known to be skew-Hermitian.
pub(crate) fn mul_adjoint_skew(out: &mut ComplexMatrix, a: &ComplexMatrix, b: &ComplexMatrix) {
    lower_skew(out, a, [b.re.transpose(), b.im.transpose()], -1.0);
}

/// out ← a·b, known to be skew-Hermitian.
pub(crate) fn mul_skew(out: &mut ComplexMatrix, a: &ComplexMatrix, b: &ComplexMatrix) {
    lower_skew(out, a, [b.re.as_ref(), b.im.as_ref()], 1.0);
}

/// out ← a·(re + i·sign·im), known to be skew-Hermitian.
fn lower_skew(
    out: &mut ComplexMatrix,
    a: &ComplexMatrix,
    [re, im]: [MatRef<'_, f64>; 2],
    sign: f64,
) {
    lower_product(&mut out.re, a.re.as_ref(), re, 1.0, Accum::Replace);
    lower_product(&mut out.re, a.im.as_ref(), im, -sign, Accum::Add);
    mirror(&mut out.re, -1.0);
    (0..out.nrows()).for_each(|i| out.re[(i, i)] = 0.0);
    lower_product(&mut out.im, a.im.as_ref(), re, 1.0, Accum::Replace);
    lower_product(&mut out.im, a.re.as_ref(), im, sign, Accum::Add);
    mirror(&mut out.im, 1.0);
}

/// x ← x − x†: \[a, b\] from a·b, for skew-Hermitian a and b.
pub(crate) fn minus_adjoint(x: &mut ComplexMatrix) {
    let n = x.ncols();
    tally(|| Ops::adds(n * n.saturating_sub(1)) + Ops::muls(n));
    for j in 0..x.ncols() {
        (x.re[(j, j)], x.im[(j, j)]) = (0.0, 2.0 * x.im[(j, j)]);
        for i in j + 1..x.nrows() {
            let (re, im) = (x.re[(i, j)] - x.re[(j, i)], x.im[(i, j)] + x.im[(j, i)]);
            (x.re[(i, j)], x.re[(j, i)]) = (re, -re);
            (x.im[(i, j)], x.im[(j, i)]) = (im, im);
        }
    }
}

impl Numbers for ComplexMatrix {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.re.each_number(each);
        self.im.each_number(each);
    }
}

impl Metric for ComplexMatrix {
    type Scalar = f64;
    const IS_ONE_PART: bool = true;
    fn check_sizes(&self, arg: &'static str, like: &Self) -> Result<(), Error> {
        self.re.check_sizes(arg, &like.re)?;
        self.im.check_sizes(arg, &like.im)
    }
    fn assign(&mut self, x: &Self) {
        self.re.assign(&x.re);
        self.im.assign(&x.im);
    }
    fn size(&self) -> f64 {
        norm_frobenius(&self.re).hypot(norm_frobenius(&self.im))
    }
    fn distance(&self, x: &Self) -> f64 {
        self.re.distance(&x.re).hypot(self.im.distance(&x.im))
    }
    fn is_same(&self, x: &Self) -> bool {
        self.re.is_same(&x.re) && self.im.is_same(&x.im)
    }
}

impl LinearSpace for ComplexMatrix {
    fn clear(&mut self) {
        self.re.fill(0.0);
        self.im.fill(0.0);
    }
    fn add(&mut self, a: f64, x: &Self) {
        self.re.add(a, &x.re);
        self.im.add(a, &x.im);
    }
    fn dot(&self, x: &Self) -> f64 {
        self.re.dot(&x.re) + self.im.dot(&x.im)
    }
    fn is_finite(&self) -> bool {
        is_finite(&self.re) && is_finite(&self.im)
    }
}
