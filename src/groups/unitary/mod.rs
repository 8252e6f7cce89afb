//! The group U(n) of unitary matrices: complex n×n matrices with separate parts ([`ComplexMatrix`]).
//!
//! | | |
//! |---|---|
//! | u ∈ u(n) | u† = −u: the real part is skew, the imaginary part symmetric |
//! | \[u, v\] | uv − vu = uv − (uv)† |
//! | ‖u‖ | Frobenius, tr(u†u)^½ |
//! | g ∈ U(n) | g†g = 𝟙 |
//!
//! SU(n) and su(n) act by conjugation as U(n) and u(n) do. Ad and the actions are in `adjoint.rs`, the
//! maps of U(n) in `maps/unitary.rs`.

mod adjoint;
mod matrix;

pub use matrix::ComplexMatrix;
use matrix::adjoint_mul_complex;
pub(crate) use matrix::{minus_adjoint, mul_adjoint_skew, mul_complex};

use faer::{Mat, c64};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::correct_length;
use super::{LieAlgebra, LieGroup, MEMBERSHIP, RESIDUAL_MAX, Sample};
use crate::error::{Error, StepError};
use crate::scalar::{Ops, larger, tally};
use crate::space::{LinearSpace, Metric};

/// What the elements of u(n) are, for messages.
pub(crate) const SKEW_HERMITIAN: &str = "a skew-Hermitian matrix, −iH of a Hermitian H";

/// The group U(n). Its algebra u(n) has the skew-Hermitian matrices.
///
/// ```
/// use lieflow::CoordinateMap;
/// use lieflow::groups::{ComplexMatrix, LieGroup, Unitary};
/// use lieflow::maps::Exp;
/// let group = Unitary::new(2)?;
/// // exp(iθσ_x)
/// let u = ComplexMatrix::from_fn(2, 2, |i, j| lieflow::faer::c64::new(0.0, if i == j { 0.0 } else { 0.3 }));
/// let g = Exp.eval(&group, &u)?;
/// assert!((g.re[(0, 0)] - 0.3f64.cos()).abs() < 1e-15 && group.defect(&g) < 1e-15);
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unitary {
    n: usize,
}

impl Unitary {
    /// U(n).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless 1 ≤ n ≤ 16384.
    pub fn new(n: usize) -> Result<Self, Error> {
        match n {
            1..=16384 => Ok(Unitary { n }),
            _ => Err(Error::out_of_range("n", n as f64, "1 ≤ n ≤ 16384")),
        }
    }

    /// The number n of rows.
    pub fn n(&self) -> usize {
        self.n
    }
}

impl LieAlgebra for Unitary {
    type Scalar = f64;
    type Alg = ComplexMatrix;

    fn name(&self) -> String {
        format!("U({})", self.n)
    }
    fn dim(&self) -> usize {
        self.n * self.n
    }
    fn zero(&self) -> ComplexMatrix {
        ComplexMatrix::zeros(self.n, self.n)
    }
    fn set_zero(&self, u: &mut ComplexMatrix) {
        u.clear();
    }
    fn axpy(&self, a: f64, x: &ComplexMatrix, y: &mut ComplexMatrix) {
        y.add(a, x);
    }
    /// One complex product.
    fn bracket(&self, u: &ComplexMatrix, v: &ComplexMatrix, out: &mut ComplexMatrix) {
        mul_complex(out, u, v);
        minus_adjoint(out);
    }
    fn norm(&self, u: &ComplexMatrix) -> f64 {
        u.size()
    }
    fn is_finite(&self, u: &ComplexMatrix) -> bool {
        LinearSpace::is_finite(u)
    }
    fn check_shape(&self, arg: &'static str, u: &ComplexMatrix) -> Result<(), Error> {
        self.shape(arg, u, self.n)
    }
    fn check(&self, arg: &'static str, u: &ComplexMatrix) -> Result<(), Error> {
        self.shape(arg, u, self.n)?;
        let (residual, tolerance) = (u.skew_residual(), MEMBERSHIP);
        match residual > tolerance {
            true => {
                let (group, expected) = (self.name(), SKEW_HERMITIAN);
                Err(Error::NotInAlgebra { arg, group, expected, residual, tolerance })
            }
            false => Ok(()),
        }
    }
    fn holds_more(&self) -> bool {
        true
    }
    fn off_algebra(&self, u: &ComplexMatrix) -> f64 {
        u.off_skew()
    }
}

impl Unitary {
    /// Is x, an argument of a map, n×n?
    pub(crate) fn fits(&self, arg: &'static str, x: &ComplexMatrix) -> Result<(), StepError> {
        let check = |part: &Mat<f64>| StepError::check_shape(arg, part.shape(), (self.n, self.n));
        x.parts().into_iter().try_for_each(check)
    }
    fn shape(&self, arg: &'static str, x: &ComplexMatrix, cols: usize) -> Result<(), Error> {
        for part in x.parts() {
            if (part.nrows(), part.ncols()) != (self.n, cols) {
                let (expected_rows, expected_cols) = (self.n, cols);
                let (rows, cols) = (part.nrows(), part.ncols());
                return Err(Error::Shape { arg, rows, cols, expected_rows, expected_cols });
            }
        }
        Ok(())
    }
}

impl LieGroup for Unitary {
    type Elem = ComplexMatrix;
    /// k complex vectors, as columns.
    type Vector = ComplexMatrix;

    fn identity(&self) -> ComplexMatrix {
        ComplexMatrix::identity(self.n)
    }
    fn compose(&self, a: &ComplexMatrix, b: &ComplexMatrix, out: &mut ComplexMatrix) {
        mul_complex(out, a, b);
    }
    fn apply(&self, g: &ComplexMatrix, x: &ComplexMatrix, y: &mut ComplexMatrix) {
        mul_complex(y, g, x);
    }
    fn tangent(&self, v: &ComplexMatrix, g: &ComplexMatrix, out: &mut ComplexMatrix) {
        mul_complex(out, v, g);
    }
    fn apply_algebra(&self, v: &ComplexMatrix, x: &ComplexMatrix, y: &mut ComplexMatrix) {
        mul_complex(y, v, x);
    }
    fn distance(&self, a: &ComplexMatrix, b: &ComplexMatrix) -> f64 {
        Metric::distance(a, b)
    }
    /// ‖g†g − 𝟙‖.
    fn defect(&self, g: &ComplexMatrix) -> f64 {
        let mut gram = self.identity();
        adjoint_mul_complex(&mut gram, g, g);
        gram.distance(&self.identity())
    }
    fn check_elem(&self, g: &ComplexMatrix) -> Result<(), Error> {
        g.check("y", self.n, self.n)
    }
    fn check_vector(&self, x: &ComplexMatrix) -> Result<(), Error> {
        x.check("y", self.n, x.re.ncols())
    }
    fn is_finite_vector(&self, x: &ComplexMatrix) -> bool {
        LinearSpace::is_finite(x)
    }
    /// Each column keeps its length; its phase is not touched.
    fn correct_vector(&self, from: &ComplexMatrix, x: &mut ComplexMatrix) -> Option<f64> {
        let column = |j: usize| {
            let from = from.parts().map(|part| part.col(j));
            correct_length(from, x.parts_mut().map(|part| part.as_mut().col_mut(j)))
        };
        Some((0..from.re.ncols()).map(column).fold(0.0, larger))
    }
    fn correct(&self, g: &mut ComplexMatrix, [gap, step]: [&mut ComplexMatrix; 2]) -> f64 {
        adjoint_mul_complex(gap, g, g);
        tally(|| Ops::adds(self.n));
        for i in 0..self.n {
            gap.re[(i, i)] -= 1.0;
        }
        let residual = gap.size();
        if residual < RESIDUAL_MAX {
            mul_complex(step, g, gap);
            g.add(-0.5, step);
        }
        residual
    }
}

impl Sample for Unitary {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> ComplexMatrix {
        let mut u = self.zero();
        let mut normal = || sigma * rng.sample::<f64, _>(StandardNormal);
        let half = core::f64::consts::FRAC_1_SQRT_2;
        for j in 0..self.n {
            u.im[(j, j)] = normal();
            for i in j + 1..self.n {
                let (re, im) = (half * normal(), half * normal());
                (u.re[(i, j)], u.re[(j, i)]) = (re, -re);
                (u.im[(i, j)], u.im[(j, i)]) = (im, im);
            }
        }
        u
    }
    /// Haar's measure: Gaussian columns, orthonormalised one after the other, twice.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> ComplexMatrix {
        let n = self.n;
        let mut g = self.sample_square(rng);
        for j in 0..n {
            for k in (0..j).chain(0..j) {
                let dot: c64 = (0..n).map(|i| g[k][i].conj() * g[j][i]).sum();
                for i in 0..n {
                    let along = g[k][i] * dot;
                    g[j][i] -= along;
                }
            }
            let norm = g[j].iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
            g[j].iter_mut().for_each(|z| *z /= norm);
        }
        ComplexMatrix::from_fn(n, n, |i, j| g[j][i])
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> ComplexMatrix {
        ComplexMatrix::from_fn(self.n, 1, |_, _| gaussian(rng))
    }
}

fn gaussian<R: Rng + ?Sized>(rng: &mut R) -> c64 {
    c64::new(rng.sample(StandardNormal), rng.sample(StandardNormal))
}

impl Unitary {
    /// n columns of Gaussian numbers.
    fn sample_square<R: Rng + ?Sized>(&self, rng: &mut R) -> Vec<Vec<c64>> {
        (0..self.n).map(|_| (0..self.n).map(|_| gaussian(rng)).collect()).collect()
    }
}
