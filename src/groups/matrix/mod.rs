//! GL(n), SO(n), Sp(2m) and G_M for any n and any invertible real M, over faer.

mod ad;
mod adjoint;
mod check;
mod correct;
mod element;
mod parts;
mod project;
mod sample;

use std::sync::OnceLock;

use faer::{Mat, MatRef};

pub(crate) use check::finite;
use correct::Cosquare;
pub(crate) use correct::correct_length;
use correct::correct_product;
pub use element::{AlgebraMatrix, GroupMatrix};
use parts::{Symmetry, inverse_of, symmetry, without_rounding};
use project::Projector;

use super::{LieAlgebra, LieGroup};
use crate::dense::{self, Lu, RCOND_MIN, antisymmetrise, mul, mul_add};
use crate::error::Error;
use crate::scalar::{Ops, larger, tally};

/// The bilinear form M that the group conserves: gᵀMg = M (paper 4.3).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Form {
    /// GL(n): none.
    Free,
    /// SO(n): M = 𝟙.
    Identity,
    /// Sp(2m): M = J = \[0 𝟙; −𝟙 0\].
    Symplectic,
    /// Any invertible M.
    Bilinear {
        /// The matrix M.
        m: Mat<f64>,
        /// Its inverse.
        inverse: Mat<f64>,
    },
}

/// A group of n×n matrices: GL(n), SL(n), SO(n), Sp(2m), SO(p,q), G_M, or U(n) and SU(n) as real matrices.
///
/// | constructor | group | algebra |
/// |---|---|---|
/// | [`gl(n)`](Self::gl) | invertible g | every u |
/// | [`so(n)`](Self::so) | gᵀg = 𝟙, det g = 1 | uᵀ = −u |
/// | [`sp(2m)`](Self::sp) | gᵀJg = J | uᵀJ + Ju = 0 |
/// | [`indefinite(p, q)`](Self::indefinite) | SO(p,q): M = diag(1,…,1,−1,…,−1) | uᵀM + Mu = 0 |
/// | [`gm(M)`](Self::gm) | gᵀMg = M | uᵀM + Mu = 0 |
/// | [`sl(n)`](Self::sl) | det g = 1 | tr u = 0 |
/// | [`u(n)`](Self::u), [`su(n)`](Self::su) | X + iY unitary, det 1 on SU(n), as \[X −Y; Y X\] in SO(2n) | skew-Hermitian, trace 0 on SU(n) |
///
/// A run on SL(n), U(n) or SU(n) is one on the larger group GL(n) or SO(2n), and f keeps it in the smaller one. What the
/// smaller one asks for is checked at the start of a run: the blocks and the determinant of y, the blocks and the trace of f.
#[derive(Clone, Debug)]
pub struct MatrixGroup {
    n: usize,
    form: Form,
    /// The subgroup of the group of the form.
    subgroup: Subgroup,
    name: String,
    /// The projection onto 𝔤_M; only if M needs more than products.
    projector: OnceLock<Projector>,
    /// The relative rounding of a residual behind M⁻¹, if M is badly scaled; else the residual itself is enough.
    behind_inverse: Option<f64>,
    /// M⁻ᵀM, which decides how elements are corrected.
    cosquare: Cosquare,
    /// The [`stretch`](parts::stretch) of M.
    stretch: f64,
}

/// A subgroup of the group of the form. Runs are those of the whole group, and f keeps them in the subgroup.
#[derive(Clone, Copy, Debug, Default)]
struct Subgroup {
    /// The determinant is 1, that of X + iY where the matrices are complex.
    is_special: bool,
    /// The matrices are \[X −Y; Y X\].
    is_complex: bool,
}

/// The largest n that constructors take; a matrix of this size has 8 GiB.
const N_MAX: usize = 1 << 15;

impl MatrixGroup {
    fn new(n: usize, form: Form, name: String) -> Result<Self, Error> {
        if n == 0 || n > N_MAX {
            return Err(Error::out_of_range("n", n as f64, format!("1 ≤ n ≤ {N_MAX}")));
        }
        let cosquare = Cosquare::of(&form);
        Ok(MatrixGroup {
            n,
            form,
            subgroup: Subgroup::default(),
            name,
            projector: OnceLock::new(),
            behind_inverse: None,
            cosquare,
            stretch: 1.0,
        })
    }

    /// GL(n).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for n = 0 or n > 32768.
    pub fn gl(n: usize) -> Result<Self, Error> {
        Self::new(n, Form::Free, format!("GL({n})"))
    }

    /// SO(n).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for n = 0 or n > 32768.
    pub fn so(n: usize) -> Result<Self, Error> {
        Self::new(n, Form::Identity, format!("SO({n})"))
    }

    /// Sp(n) for even n = 2m, with M = J = \[0 𝟙; −𝟙 0\].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for n = 0, odd n or n > 32768.
    pub fn sp(n: usize) -> Result<Self, Error> {
        if !n.is_multiple_of(2) {
            return Err(Error::out_of_range("n", n as f64, "an even number (n = 2m)"));
        }
        Self::new(n, Form::Symplectic, format!("Sp({n})"))
    }

    /// SO(p,q): M = diag(1, …, 1, −1, …, −1) with p ones. SO(3,1) is the Lorentz group.
    ///
    /// The sign of the determinant is not checked: an element of O(p,q) is taken, and a run keeps its component.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for p + q = 0 or p + q > 32768.
    pub fn indefinite(p: usize, q: usize) -> Result<Self, Error> {
        let n = p.saturating_add(q);
        Self::new(n, Form::Free, String::new())?; // checks n before anything of that size is made
        let m = Mat::from_fn(n, n, |i, j| match i == j {
            true if i < p => 1.0,
            true => -1.0,
            false => 0.0,
        });
        let form = Form::Bilinear { inverse: m.clone(), m };
        Self::new(n, form, format!("SO({p},{q})"))
    }

    /// G_M for an invertible real M.
    ///
    /// A symmetric or skew part of M that is 1e-10 of M or less is taken as rounding and left out: [`m`](Self::m) is without
    /// it. Example: M = AᵀJA is skew only to rounding. It stays if M without it is nearly singular.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::NotFiniteEntry`], [`Error::Singular`] when the reciprocal
    /// condition number of M in the 1-norm is below [`RCOND_MIN`].
    pub fn gm(m: Mat<f64>) -> Result<Self, Error> {
        check::square("M", m.as_ref())?;
        check::finite("M", m.as_ref())?;
        let n = m.nrows();
        Self::new(n, Form::Free, String::new())?;
        let m = without_rounding(m);
        let rcond = Lu::rcond(m.as_ref());
        if rcond < RCOND_MIN {
            return Err(Error::Singular { arg: "M", rcond, minimum: RCOND_MIN });
        }
        let inverse = inverse_of(&m);
        let stretch = parts::stretch(&m, &inverse);
        let group = Self::new(n, Form::Bilinear { m, inverse }, format!("G_M({n})"))?;
        Ok(MatrixGroup { behind_inverse: check::behind_inverse(n, rcond), stretch, ..group })
    }

    /// SL(n): GL(n) with determinant 1. exp stays on it; cay does not for n > 2.
    ///
    /// # Errors
    /// As [`gl`](Self::gl).
    pub fn sl(n: usize) -> Result<Self, Error> {
        let subgroup = Subgroup { is_special: true, is_complex: false };
        Ok(MatrixGroup { name: format!("SL({n})"), subgroup, ..Self::gl(n)? })
    }

    /// U(n) as the matrices \[X −Y; Y X\] of SO(2n), where X + iY is unitary. [`Unitary`](super::Unitary) has complex
    /// matrices.
    ///
    /// # Errors
    /// As [`so`](Self::so) for 2n.
    pub fn u(n: usize) -> Result<Self, Error> {
        let subgroup = Subgroup { is_special: false, is_complex: true };
        Ok(MatrixGroup { name: format!("U({n})"), subgroup, ..Self::so(n.saturating_mul(2))? })
    }

    /// SU(n): U(n), as [`u`](Self::u), with determinant 1. exp stays on it; cay does not for n > 2.
    ///
    /// # Errors
    /// As [`u`](Self::u).
    pub fn su(n: usize) -> Result<Self, Error> {
        let subgroup = Subgroup { is_special: true, is_complex: true };
        Ok(MatrixGroup { name: format!("SU({n})"), subgroup, ..Self::u(n)? })
    }

    /// True if M is far from a multiple of an orthogonal matrix: products with M and M⁻¹ lose digits there.
    pub(crate) fn is_stretched(&self) -> bool {
        self.stretch > parts::STRETCHED
    }
    /// True if the determinant is 1 where the form leaves it free.
    pub(crate) fn is_special(&self) -> bool {
        self.subgroup.is_special
    }
    /// True for U(n) and SU(n): the matrices are \[X −Y; Y X\].
    pub(crate) fn is_complex(&self) -> bool {
        self.subgroup.is_complex
    }

    /// The n of n×n.
    pub fn n(&self) -> usize {
        self.n
    }

    /// The form that the group conserves.
    pub fn form(&self) -> &Form {
        &self.form
    }

    /// M as a matrix; `None` for GL(n).
    pub fn m(&self) -> Option<Mat<f64>> {
        let n = self.n;
        match &self.form {
            Form::Free => None,
            Form::Identity => Some(Mat::identity(n, n)),
            Form::Symplectic => Some(Mat::from_fn(n, n, |i, j| {
                if j == i + n / 2 {
                    1.0
                } else if i == j + n / 2 {
                    -1.0
                } else {
                    0.0
                }
            })),
            Form::Bilinear { m, .. } => Some(m.clone()),
        }
    }

    /// gᵀMg − M, or nothing for GL(n). Allocates.
    fn defect_of(&self, g: MatRef<'_, f64>) -> Option<Mat<f64>> {
        let m = self.m()?;
        Some(g.transpose() * &m * g - m)
    }
}

/// p ← p − J⁻¹pᵀJ. With p = u·v and u, v ∈ sp(2m) this is \[u, v\] for one product.
fn symplectic_antisymmetrise(p: &mut Mat<f64>) {
    let m = p.nrows() / 2;
    tally(|| Ops::adds(m * m + m * (m + 1)));
    for j in 0..m {
        for i in 0..m {
            let d = p[(i, j)] - p[(j + m, i + m)];
            p[(i, j)] = d;
            p[(j + m, i + m)] = -d;
        }
        for i in 0..=j {
            for (r, c) in [(i, j + m), (i + m, j)] {
                let mirror = if r < m { (j, i + m) } else { (j + m, i) };
                let s = p[(r, c)] + p[mirror];
                p[(r, c)] = s;
                p[mirror] = s;
            }
        }
    }
}

impl LieAlgebra for MatrixGroup {
    type Scalar = f64;
    type Alg = AlgebraMatrix;

    fn name(&self) -> String {
        self.name.clone()
    }
    /// If M is neither symmetric nor skew, the first call takes O(n⁶).
    fn dim(&self) -> usize {
        let n = self.n;
        let of_form = match &self.form {
            Form::Identity if self.subgroup.is_complex => (n / 2) * (n / 2),
            Form::Free => n * n,
            Form::Identity => n * (n - 1) / 2,
            Form::Symplectic => n * (n + 1) / 2,
            Form::Bilinear { m, .. } => match symmetry(m) {
                Some(Symmetry::Symmetric) => n * (n - 1) / 2,
                Some(Symmetry::Skew) => n * (n + 1) / 2,
                None => self.projector(m).dim(),
            },
        };
        of_form - usize::from(self.subgroup.is_special)
    }
    fn zero(&self) -> AlgebraMatrix {
        AlgebraMatrix::new_unchecked(Mat::zeros(self.n, self.n))
    }
    fn set_zero(&self, u: &mut AlgebraMatrix) {
        u.fill(0.0);
    }
    fn axpy(&self, a: f64, x: &AlgebraMatrix, y: &mut AlgebraMatrix) {
        dense::axpy(a, x, y);
    }
    /// One product on so(n) and sp(2m), where (uv)♯ = vu for the adjoint ♯ of the form; else two.
    fn bracket(&self, u: &AlgebraMatrix, v: &AlgebraMatrix, out: &mut AlgebraMatrix) {
        mul(out, u.as_ref(), v.as_ref());
        match self.form {
            Form::Identity => antisymmetrise(out),
            Form::Symplectic => symplectic_antisymmetrise(out),
            _ => mul_add(out, -1.0, v.as_ref(), u.as_ref()),
        }
    }
    /// The Frobenius norm.
    fn norm(&self, u: &AlgebraMatrix) -> f64 {
        dense::norm_frobenius(u)
    }
    fn is_finite(&self, u: &AlgebraMatrix) -> bool {
        dense::is_finite(u)
    }
    fn check(&self, arg: &'static str, u: &AlgebraMatrix) -> Result<(), Error> {
        self.check_algebra(arg, u)
    }
    fn holds_more(&self) -> bool {
        !matches!(self.form, Form::Free) || self.subgroup.is_special
    }
    fn off_algebra(&self, u: &AlgebraMatrix) -> f64 {
        self.off_form_and_subgroup(u)
    }
}

impl LieGroup for MatrixGroup {
    type Elem = GroupMatrix;
    /// n×k: k vectors as columns.
    type Vector = Mat<f64>;

    fn identity(&self) -> GroupMatrix {
        GroupMatrix::new_unchecked(Mat::identity(self.n, self.n))
    }
    fn compose(&self, a: &GroupMatrix, b: &GroupMatrix, out: &mut GroupMatrix) {
        mul(out, a.as_ref(), b.as_ref());
    }
    fn apply(&self, g: &GroupMatrix, x: &Mat<f64>, y: &mut Mat<f64>) {
        mul(y, g.as_ref(), x.as_ref());
    }
    fn tangent(&self, v: &AlgebraMatrix, g: &GroupMatrix, out: &mut GroupMatrix) {
        mul(out, v.as_ref(), g.as_ref());
    }
    fn apply_algebra(&self, v: &AlgebraMatrix, x: &Mat<f64>, y: &mut Mat<f64>) {
        mul(y, v.as_ref(), x.as_ref());
    }
    /// Infinite between matrices of different sizes. Allocates.
    fn distance(&self, a: &GroupMatrix, b: &GroupMatrix) -> f64 {
        if (a.nrows(), a.ncols()) != (b.nrows(), b.ncols()) {
            return f64::INFINITY;
        }
        dense::norm_frobenius(&(a.as_ref() - b.as_ref()))
    }
    /// Infinite of a matrix of another size. Allocates.
    fn defect(&self, g: &GroupMatrix) -> f64 {
        if (g.nrows(), g.ncols()) != (self.n, self.n) {
            return f64::INFINITY;
        }
        self.defect_of(g.as_ref()).map_or(0.0, |d| dense::norm_frobenius(&d))
    }
    fn check_elem(&self, g: &GroupMatrix) -> Result<(), Error> {
        self.rows_fit("y", g, self.n)
    }
    fn check_member(&self, g: &GroupMatrix) -> Result<(), Error> {
        self.check_start("y", g)
    }
    fn is_finite_vector(&self, x: &Mat<f64>) -> bool {
        dense::is_finite(x)
    }
    fn check_vector(&self, x: &Mat<f64>) -> Result<(), Error> {
        self.rows_fit("y", x, x.ncols())
    }
    /// xᵀMx of the columns keeps its entries: on SO(n) their lengths and angles.
    fn correct_vector(&self, from: &Mat<f64>, x: &mut Mat<f64>) -> Option<f64> {
        let m = match &self.form {
            Form::Identity => None,
            Form::Bilinear { m, .. } => Some(m),
            // The entries of xᵀJx are not corrected; one column has 0.
            Form::Free | Form::Symplectic => return None,
        };
        let mut worst = 0.0;
        for (i, j) in (0..x.ncols()).flat_map(|j| (0..=j).map(move |i| (i, j))) {
            let found = match m {
                None if i == j => correct_length([from.col(j)], [x.as_mut().col_mut(j)]),
                _ => correct_product(m, from, x, [i, j]),
            };
            worst = larger(worst, found);
        }
        Some(worst)
    }
    fn residual_size(&self, g: &GroupMatrix) -> f64 {
        self.residual_size_of(g)
    }
    fn correct(&self, g: &mut GroupMatrix, scratch: [&mut GroupMatrix; 2]) -> f64 {
        self.newton_schulz(g, scratch)
    }
}
