//! Checked constructors: a matrix of a user is in the algebra or on the group, or it is refused.

use faer::{Mat, MatRef, c64};

use super::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup};
use crate::dense::{Lu, RCOND_MIN, complex_of_blocks, is_finite, norm_frobenius, norm_of};
use crate::error::{Error, StepError};
use crate::groups::unitary::SKEW_HERMITIAN;
use crate::groups::{LieAlgebra, MEMBERSHIP, OFF_M_MAX};

/// The largest distance of a determinant from 1 that a checked constructor allows.
const DETERMINANT: f64 = 1e-10;
/// The least reciprocal condition number of a start on GL(n), its rows and its columns divided by their largest entries: the
/// pivots of a singular matrix are 0, or rounding.
const PIVOT_MIN: f64 = 1e-30;

/// From this condition number of M on, a residual relative to ‖M‖ does not see the small directions of M. Example: for
/// M = diag(1, 1, 10⁻¹¹) it does not see u₃₃.
const SCALED_FROM: f64 = 1e4;
/// The largest residual behind M⁻¹ that counts as rounding.
const ROUNDING_MAX: f64 = 0.1;

/// The rounding of M⁻¹(uᵀM + Mu), relative to u, where M is badly scaled.
pub(super) fn behind_inverse(n: usize, rcond: f64) -> Option<f64> {
    let rounding = 8.0 * n as f64 * f64::EPSILON / rcond;
    (rcond * SCALED_FROM < 1.0).then(|| rounding.min(ROUNDING_MAX))
}

/// g with rows, and then columns, whose largest entry is 1 in size. A row or a column of zeros stays.
fn balanced(g: &Mat<f64>) -> Mat<f64> {
    let n = g.nrows();
    let by = |x: f64| if x > 0.0 { x } else { 1.0 };
    let rows: Vec<f64> = (0..n).map(|i| by(g.row(i).norm_max())).collect();
    let mut x = Mat::from_fn(n, n, |i, j| g[(i, j)] / rows[i]);
    for j in 0..n {
        let largest = by(x.col(j).norm_max());
        x.col_mut(j).iter_mut().for_each(|x| *x /= largest);
    }
    x
}

pub(super) fn square(arg: &'static str, x: MatRef<'_, f64>) -> Result<(), Error> {
    match x.nrows() == x.ncols() {
        true => Ok(()),
        false => Err(Error::NotSquare { arg, rows: x.nrows(), cols: x.ncols() }),
    }
}

pub(crate) fn finite(arg: &'static str, x: MatRef<'_, f64>) -> Result<(), Error> {
    if (0..x.ncols()).all(|j| x.col(j).iter().all(|x| x.is_finite())) {
        return Ok(());
    }
    for col in 0..x.ncols() {
        for row in 0..x.nrows() {
            let value = x[(row, col)];
            if !value.is_finite() {
                return Err(Error::NotFiniteEntry { arg, row, col, value });
            }
        }
    }
    Ok(())
}

impl MatrixGroup {
    /// Is x n×n?
    pub(crate) fn fits(&self, arg: &'static str, x: &Mat<f64>) -> Result<(), StepError> {
        StepError::check_shape(arg, x.shape(), (self.n(), self.n()))
    }

    /// Is u, the argument of a map, n×n and finite? `what` names it in words.
    pub(crate) fn operand(&self, what: &'static str, u: &Mat<f64>) -> Result<(), StepError> {
        self.fits("u", u)?;
        StepError::finite(is_finite(u), what)
    }

    /// Is x, a state, n×`expected_cols` and finite?
    pub(crate) fn rows_fit(
        &self,
        arg: &'static str,
        x: &Mat<f64>,
        expected_cols: usize,
    ) -> Result<(), Error> {
        let (rows, cols, expected_rows) = (x.nrows(), x.ncols(), self.n());
        match (rows, cols) == (expected_rows, expected_cols) {
            true => finite(arg, x.as_ref()),
            false => Err(Error::Shape { arg, rows, cols, expected_rows, expected_cols }),
        }
    }

    pub(crate) fn shape(&self, arg: &'static str, x: MatRef<'_, f64>) -> Result<(), Error> {
        square(arg, x)?;
        self.size(arg, x)?;
        finite(arg, x)
    }

    fn size(&self, arg: &'static str, x: MatRef<'_, f64>) -> Result<(), Error> {
        let (n, rows, cols) = (self.n(), x.nrows(), x.ncols());
        match (rows, cols) == (n, n) {
            true => Ok(()),
            false => Err(Error::Shape { arg, rows, cols, expected_rows: n, expected_cols: n }),
        }
    }

    fn not_in_algebra(&self, arg: &'static str, residual: f64, tolerance: f64) -> Error {
        let expected = match self.form() {
            _ if self.is_complex() => SKEW_HERMITIAN,
            Form::Identity => "a skew-symmetric matrix",
            Form::Symplectic => "a matrix u with uᵀJ + Ju = 0",
            Form::Free | Form::Bilinear { .. } => "a matrix u with uᵀM + Mu = 0",
        };
        Error::NotInAlgebra { arg, group: self.name(), expected, residual, tolerance }
    }

    /// ‖uᵀM + Mu‖/(‖M‖‖u‖) is at most `tolerance`, or not a number. If M is badly scaled, ‖u + M⁻¹uᵀM‖/‖u‖ is, too, where
    /// it is more than rounding.
    fn belongs(&self, arg: &'static str, u: &Mat<f64>, tolerance: f64) -> Result<(), Error> {
        let scale = u.norm_max();
        if scale > 0.0 {
            // The residual is relative: no overflow, and 1/scale might be one.
            let v = Mat::from_fn(self.n(), self.n(), |i, j| u[(i, j)] / scale);
            let residual = self.off_form(&v) / norm_frobenius(&v);
            if residual > tolerance {
                return Err(self.not_in_algebra(arg, residual, tolerance));
            }
            if let (Form::Bilinear { m, inverse }, Some(rounding)) =
                (self.form(), self.behind_inverse)
            {
                let gap = &v + inverse * (v.transpose() * m);
                let (residual, tolerance) =
                    (norm_frobenius(&gap) / norm_frobenius(&v), tolerance.max(rounding));
                if residual > tolerance {
                    return Err(self.not_in_algebra(arg, residual, tolerance));
                }
            }
        }
        Ok(())
    }

    /// ‖uᵀM + Mu‖/‖M‖; 0 on GL(n). Runs call it. So it neither allocates nor looks behind M⁻¹.
    fn off_form(&self, u: &Mat<f64>) -> f64 {
        let n = self.n();
        match self.form() {
            Form::Free => 0.0,
            Form::Identity => norm_of(n, n, |i, j| u[(i, j)] + u[(j, i)]) / (n as f64).sqrt(),
            Form::Symplectic => {
                // (Ju)ᵀ = −uᵀJ.
                let ju =
                    |i: usize, j| if i < n / 2 { u[(i + n / 2, j)] } else { -u[(i - n / 2, j)] };
                norm_of(n, n, |i, j| ju(i, j) - ju(j, i)) / (n as f64).sqrt()
            }
            Form::Bilinear { m, .. } => {
                let term = |i, j, k| u[(k, i)] * m[(k, j)] + m[(i, k)] * u[(k, j)];
                let gap = |i, j| (0..n).map(|k| term(i, j, k)).sum::<f64>();
                norm_of(n, n, gap) / norm_frobenius(m)
            }
        }
    }

    /// [`LieAlgebra::off_algebra`].
    pub(super) fn off_form_and_subgroup(&self, u: &Mat<f64>) -> f64 {
        let trace = if self.subgroup.is_special { self.trace(u.as_ref()).abs() } else { 0.0 };
        self.off_form(u) + self.off_blocks(u) + trace
    }

    /// The distance of x from the matrices \[X −Y; Y X\]; 0 where it need not be one.
    fn off_blocks(&self, x: &Mat<f64>) -> f64 {
        if !self.subgroup.is_complex {
            return 0.0;
        }
        norm_of(self.n(), self.n(), |i, j| x[(i, j)] - self.block(x.as_ref(), i, j))
    }

    /// [`off_blocks`](Self::off_blocks), relative to the norm of x.
    fn off_blocks_relative(&self, x: &Mat<f64>) -> f64 {
        let gap = self.off_blocks(x);
        if gap > 0.0 { gap / norm_frobenius(x) } else { 0.0 }
    }

    /// u, in the algebra of the form, is in that of the subgroup, to `tolerance` times the norm of u.
    fn check_subalgebra(
        &self,
        arg: &'static str,
        u: &Mat<f64>,
        tolerance: f64,
    ) -> Result<(), Error> {
        let residual = self.off_blocks_relative(u);
        if residual > tolerance {
            return Err(self.not_in_algebra(arg, residual, tolerance));
        }
        let distance = self.trace(u.as_ref()).abs();
        match self.subgroup.is_special && distance > tolerance * norm_frobenius(u) {
            true => Err(Error::Trace { arg, group: self.name(), distance }),
            false => Ok(()),
        }
    }

    /// g, with the form of the group, is in the subgroup, to `tolerance`; the determinant is 1 to `tolerance`, and to its
    /// rounding, which is relative to the product of the norms of the rows. No element of SO(n) is a reflection.
    pub(super) fn check_subgroup(
        &self,
        arg: &'static str,
        g: &Mat<f64>,
        tolerance: f64,
    ) -> Result<(), Error> {
        let residual = self.off_blocks_relative(g);
        if residual > tolerance {
            return Err(Error::NotOnGroup { arg, group: self.name(), residual, tolerance });
        }
        let det = match (self.subgroup.is_special, self.subgroup.is_complex) {
            (false, false) if matches!(self.form(), Form::Identity) && g.determinant() < 0.0 => {
                return Err(Error::Reflection { arg });
            }
            (false, _) => return Ok(()),
            (true, false) => c64::new(g.determinant(), 0.0),
            (true, true) => {
                let m = self.n() / 2;
                let mut x = Mat::zeros(m, m);
                complex_of_blocks(g, &mut x);
                x.determinant()
            }
        };
        let size: f64 = (0..self.n()).map(|i| g.row(i).norm_l2()).product();
        let rounding = 8.0 * self.n() as f64 * f64::EPSILON * size;
        match (det - c64::ONE).norm() > tolerance.max(DETERMINANT) + rounding {
            true => Err(Error::Determinant { arg, group: self.name(), re: det.re, im: det.im }),
            false => Ok(()),
        }
    }

    /// [`LieGroup::check_member`](crate::groups::LieGroup::check_member). On GL(n) g is refused where a pivot is 0: elements
    /// that a run has grown or damped may be singular to working accuracy.
    pub(super) fn check_start(&self, arg: &'static str, g: &Mat<f64>) -> Result<(), Error> {
        self.size(arg, g.as_ref())?;
        if matches!(self.form(), Form::Free) {
            let rcond = Lu::rcond(balanced(g).as_ref());
            if rcond < PIVOT_MIN {
                return Err(Error::Singular { arg, rcond, minimum: PIVOT_MIN });
            }
        }
        self.check_subgroup(arg, g, OFF_M_MAX)
    }

    /// [`LieAlgebra::check`] with the tolerance [`MEMBERSHIP`].
    pub(super) fn check_algebra(&self, arg: &'static str, u: &Mat<f64>) -> Result<(), Error> {
        self.size(arg, u.as_ref())?;
        self.belongs(arg, u, MEMBERSHIP)?;
        self.check_subalgebra(arg, u, MEMBERSHIP)
    }

    /// Makes u an element of the algebra, if it is one within [`MEMBERSHIP`].
    ///
    /// ```
    /// use lieflow::faer::mat;
    /// use lieflow::groups::MatrixGroup;
    /// let so2 = MatrixGroup::so(2)?;
    /// assert!(so2.algebra(mat![[0.0, -1.0], [1.0, 0.0]]).is_ok());
    /// let refused = so2.algebra(mat![[0.0, 1.0], [1.0, 0.0]]).unwrap_err();
    /// assert!(refused.to_string().starts_with("u: not in the Lie algebra of SO(2)"));
    /// # Ok::<(), lieflow::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::Shape`], [`Error::NotFiniteEntry`], [`Error::Trace`] on SL(n) and SU(n), and
    /// [`Error::NotInAlgebra`] with the residual ‖uᵀM + Mu‖/(‖M‖‖u‖). If the condition number of M is above 1e4, it may also
    /// be ‖u + M⁻¹uᵀM‖/‖u‖, whose tolerance is at least the rounding of this number.
    pub fn algebra(&self, u: Mat<f64>) -> Result<AlgebraMatrix, Error> {
        self.algebra_within(u, MEMBERSHIP)
    }

    /// Like [`algebra`](Self::algebra), with a tolerance that you choose.
    ///
    /// # Errors
    /// As [`algebra`](Self::algebra).
    pub fn algebra_within(&self, u: Mat<f64>, tolerance: f64) -> Result<AlgebraMatrix, Error> {
        self.shape("u", u.as_ref())?;
        self.belongs("u", &u, tolerance)?;
        self.check_subalgebra("u", &u, tolerance)?;
        Ok(AlgebraMatrix::new_unchecked(u))
    }

    /// Makes g an element of the group, if it is one within [`MEMBERSHIP`].
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::Shape`], [`Error::NotFiniteEntry`], [`Error::Singular`] on
    /// GL(n), [`Error::Reflection`] on SO(n), [`Error::Determinant`] on SL(n) and SU(n), and
    /// [`Error::NotOnGroup`] with the residual ‖gᵀMg − M‖/(‖M‖ max(1, ‖g‖²)). If the condition number of M is above 1e4, it may
    /// also be ‖M⁻¹gᵀMg − 𝟙‖/max(1, ‖g‖²), whose tolerance is at least the rounding of this number.
    pub fn element(&self, g: Mat<f64>) -> Result<GroupMatrix, Error> {
        self.element_within(g, MEMBERSHIP)
    }

    /// Like [`element`](Self::element), with a tolerance that you choose.
    ///
    /// # Errors
    /// As [`element`](Self::element).
    pub fn element_within(&self, g: Mat<f64>, tolerance: f64) -> Result<GroupMatrix, Error> {
        self.shape("g", g.as_ref())?;
        match (self.m(), self.defect_of(g.as_ref())) {
            (Some(m), Some(defect)) => {
                let size = norm_frobenius(&g).powi(2).max(1.0);
                let residual = norm_frobenius(&defect) / (norm_frobenius(&m) * size);
                if residual.is_nan() || residual > tolerance {
                    let group = self.name();
                    return Err(Error::NotOnGroup { arg: "g", group, residual, tolerance });
                }
                if let (Form::Bilinear { inverse, .. }, Some(rounding)) =
                    (self.form(), self.behind_inverse)
                {
                    let residual = norm_frobenius(&(inverse * defect)) / size;
                    let tolerance = tolerance.max(rounding);
                    if residual.is_nan() || residual > tolerance {
                        let group = self.name();
                        return Err(Error::NotOnGroup { arg: "g", group, residual, tolerance });
                    }
                }
            }
            _ => {
                let rcond = Lu::rcond(g.as_ref());
                if rcond < RCOND_MIN {
                    return Err(Error::Singular { arg: "g", rcond, minimum: RCOND_MIN });
                }
            }
        }
        self.check_subgroup("g", &g, tolerance)?;
        Ok(GroupMatrix::new_unchecked(g))
    }
}
