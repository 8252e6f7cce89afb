//! Ψ = cay, the Cayley map (paper 4.3), on any matrix group.
//!
//! | | cay(u) | dcay_u⁻¹ v |
//! |---|---|---|
//! | any n | (𝟙 − u/2)⁻¹(𝟙 + u/2) | (𝟙 − u/2) v (𝟙 + u/2) |
//! | so(3) | 𝟙 + (u + u²/2)/(1 + α²/4) | ((1 + α²/4)𝟙 − u/2 + u²/4) v = v + ¼(u·v)u − ½ u×v |
//!
//! The factor ½ makes dcay_0 the identity. cay maps 𝔤_M into G_M for every M, since
//! r(z) = (1 + z/2)/(1 − z/2) has r(z)r(−z) = 1 (Celledoni & Iserles).

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use super::CoordinateMap;
use super::quotient::{Quotient, finite, well_conditioned};
use crate::dense::{Lu, mul, norm_frobenius, orthogonalise, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieGroup, MatrixGroup, RCOND_MIN, So3};
use crate::scalar::Real;
use crate::so3;

/// The Cayley map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cay;

impl<S: Real> CoordinateMap<So3<S>> for Cay {
    type At = ();

    fn name(&self) -> &'static str {
        "cay"
    }
    fn at(&self, _: &So3<S>) -> Result<(), Error> {
        Ok(())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        *g = so3::cay(u)?;
        Ok(())
    }
    #[inline(always)] // the largest part of a short step
    fn psi_on(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        _: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        *y = match so3::cay_on(u, x) {
            Some(y) => so3::finite(y, "cay(u)·x")?,
            None => so3::cay_huge_on(u, x)?,
        };
        Ok(())
    }
    #[inline(always)]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut (),
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        *v = so3::finite(so3::dcayinv_of(u, v), "dcay⁻¹")?;
        Ok(())
    }
}

/// The values that cay stores at u ∈ 𝔤 ⊂ gl(n): 𝟙 ± u/2, and the LU of 𝟙 − u/2.
#[derive(Debug)]
pub struct CayAt {
    quotient: Quotient,
    square: Mat<f64>,
}

impl CayAt {
    /// 𝟙 ± u/2, and the LU of 𝟙 − u/2.
    fn prepare(&mut self, group: &MatrixGroup, u: &AlgebraMatrix) -> Result<(), StepError> {
        group.operand("u in cay(u)", u)?;
        let quotient = &mut self.quotient;
        scaled_sum(&mut quotient.minus, [-0.5], [u], 1.0);
        scaled_sum(&mut quotient.plus, [0.5], [u], 1.0);
        if matches!(group.form(), Form::Identity) {
            // The eigenvalues of 𝟙 − u/2 are 1 − iα/2: never zero, however large u. Beyond 1/ε the
            // 1 is lost next to u, and with it the axis.
            if norm_frobenius(u) > NORM_MAX_SKEW {
                return Err(StepError::NormTooLarge { map: "cay" });
            }
            quotient.factor_regular();
            return Ok(());
        }
        quotient.factor("cay", "𝟙 − u/2")
    }
}

/// Above this norm of a skew u no digit of cay(u) has a meaning in the dense arithmetic.
const NORM_MAX_SKEW: f64 = 1e15;
/// Above this norm of a skew u the result is put back on SO(n).
const NORM_EXACT_SKEW: f64 = 4.0;

/// Has the solve lost more than rounding of the group?
fn is_put_back(group: &MatrixGroup, u: &AlgebraMatrix) -> bool {
    matches!(group.form(), Form::Identity) && norm_frobenius(u) > NORM_EXACT_SKEW
}

impl CoordinateMap<MatrixGroup> for Cay {
    type At = CayAt;

    fn name(&self) -> &'static str {
        "cay"
    }
    fn at(&self, group: &MatrixGroup) -> Result<CayAt, Error> {
        let n = group.n();
        Ok(CayAt { quotient: Quotient::new(n), square: Mat::zeros(n, n) })
    }
    fn psi(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CayAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.prepare(group, u)?;
        at.quotient.form("cay(u)", g)?;
        if is_put_back(group, u) {
            orthogonalise(g, [&mut at.quotient.product, &mut at.square]);
        }
        Ok(())
    }
    fn psi_on(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CayAt,
        g: &mut GroupMatrix,
        x: &Mat<f64>,
        y: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        if group.fits("u", u).is_ok() && is_put_back(group, u) {
            self.psi(group, u, at, g)?;
            mul(y, g.as_ref(), x.as_ref());
            return Ok(());
        }
        at.prepare(group, u)?;
        at.quotient.on("cay(u)·x", x, y)
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        _: &AlgebraMatrix,
        at: &mut CayAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        at.quotient.conjugate(v);
        finite(v, "dcay⁻¹")
    }
}

/// A group on which cay has an inverse and a differential in closed form.
pub trait CayleyGroup: LieGroup {
    /// [`cay_inv`] on this group.
    ///
    /// # Errors
    /// As [`cay_inv`].
    fn cay_inv(&self, g: &Self::Elem) -> Result<Self::Alg, Error>;
    /// [`dcay`] on this group.
    ///
    /// # Errors
    /// As [`dcay`].
    fn dcay(&self, u: &Self::Alg, v: &Self::Alg) -> Result<Self::Alg, Error>;
}

/// u with cay(u) = g: u = 2(g − 𝟙)(g + 𝟙)⁻¹. Fresh storage; O(n³).
///
/// # Errors
/// [`Error::Singular`] where −1 is an eigenvalue of g, a rotation by π: it is not in the image.
///
/// ```
/// use lieflow::CoordinateMap;
/// use lieflow::groups::So3;
/// use lieflow::maps::{Cay, cay_inv};
/// use lieflow::nalgebra::{Matrix3, Vector3};
/// let so3 = So3::new();
/// let u = Vector3::new(0.3, -0.4, 1.2);
/// assert!((cay_inv(&so3, &Cay.eval(&so3, &u)?)? - u).norm() < 1e-15);
/// assert!(cay_inv(&so3, &Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))).is_err());
/// # Ok::<(), lieflow::Error>(())
/// ```
pub fn cay_inv<G: CayleyGroup>(group: &G, g: &G::Elem) -> Result<G::Alg, Error> {
    group.cay_inv(g)
}

/// dcay_u v = (𝟙 − u/2)⁻¹ v (𝟙 + u/2)⁻¹, right trivialised: d/dε cay(u + εv)|₀ = dcay_u(v)·cay(u).
/// Fresh storage; O(n³).
///
/// # Errors
/// [`Error::Map`] where 𝟙 − u/2 or 𝟙 + u/2 is singular, and when numbers leave the range.
pub fn dcay<G: CayleyGroup>(group: &G, u: &G::Alg, v: &G::Alg) -> Result<G::Alg, Error> {
    group.dcay(u, v)
}

impl CayleyGroup for MatrixGroup {
    fn cay_inv(&self, g: &GroupMatrix) -> Result<AlgebraMatrix, Error> {
        let n = self.n();
        self.shape("g", g.as_ref())?;
        let plus = g.as_ref() + Mat::<f64>::identity(n, n);
        let rcond = Lu::rcond(plus.as_ref());
        if rcond < RCOND_MIN {
            return Err(Error::Singular { arg: "g + 𝟙", rcond, minimum: RCOND_MIN });
        }
        // (g − 𝟙)(g + 𝟙)⁻¹ = (g + 𝟙)⁻¹(g − 𝟙)
        let mut u = g.as_ref() - Mat::<f64>::identity(n, n);
        let mut lu = Lu::new(n);
        lu.a.copy_from(&plus);
        lu.factor();
        lu.solve(u.as_mut());
        for x in u.col_iter_mut() {
            x.iter_mut().for_each(|x| *x *= 2.0);
        }
        Ok(match self.form() {
            Form::Free => AlgebraMatrix::new_unchecked(u),
            _ => self.project_algebra(u.as_ref()),
        })
    }

    fn dcay(&self, u: &AlgebraMatrix, v: &AlgebraMatrix) -> Result<AlgebraMatrix, Error> {
        self.shape("u", u.as_ref())?;
        self.shape("v", v.as_ref())?;
        let (mut at, mut w) = (Cay.at(self)?, v.clone());
        at.prepare(self, u)?;
        let Quotient { plus, product, lu, .. } = &mut at.quotient;
        lu.solve(w.as_mut());
        // w ← w (𝟙 + u/2)⁻¹ by the transposed system.
        let mut transposed = w.transpose().to_owned();
        lu.a.copy_from(plus.transpose());
        well_conditioned(lu, plus, product, "cay", "𝟙 + u/2")?;
        lu.solve(transposed.as_mut());
        w.copy_from(transposed.transpose());
        finite(&w, "dcay(u, v)")?;
        Ok(w)
    }
}

impl CayleyGroup for So3<f64> {
    fn cay_inv(&self, g: &Matrix3<f64>) -> Result<Vector3<f64>, Error> {
        so3::cay_inv(g)
    }
    fn dcay(&self, u: &Vector3<f64>, v: &Vector3<f64>) -> Result<Vector3<f64>, Error> {
        Ok(so3::dcay(u, v)?)
    }
}
