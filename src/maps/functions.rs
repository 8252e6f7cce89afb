//! The maps as functions: one name for each formula, on every group that has it.

use nalgebra::{Matrix3, Matrix6, SMatrix, UnitQuaternion, Vector3};

use super::{Cay, CoordinateMap, Exp};
use crate::error::Error;
use crate::groups::{LieAlgebra, LieGroup, Se3, Se23, So3, UnitQuaternions};
use crate::so3;

/// exp(u). Fresh storage.
///
/// # Errors
/// As [`CoordinateMap::eval`].
///
/// ```
/// use lieflow::groups::{MatrixGroup, So3};
/// use lieflow::maps::{dexp, dexpinv, exp, log};
/// use lieflow::nalgebra::Vector3;
/// // The same names on rotations as matrices 3×3, and on matrices n×n.
/// let so3 = So3::new();
/// let (u, v) = (Vector3::new(0.3, -1.2, 0.5), Vector3::new(1.0, 0.0, 2.0));
/// assert!((log(&so3, &exp(&so3, &u)?)? - u).norm() < 1e-15);
/// assert!((dexpinv(&so3, &u, &dexp(&so3, &u, &v)?)? - v).norm() < 1e-14);
///
/// let so5 = MatrixGroup::so(5)?;
/// let u = so5.algebra(lieflow::faer::Mat::from_fn(5, 5, |i, j| 0.1 * (i as f64 - j as f64)))?;
/// let v = so5.algebra(lieflow::faer::Mat::from_fn(5, 5, |i, j| (i as f64 - j as f64).powi(3)))?;
/// assert!((&*log(&so5, &exp(&so5, &u)?)? - &*u).norm_l2() < 1e-14);
/// assert!((&*dexpinv(&so5, &u, &dexp(&so5, &u, &v)?)? - &*v).norm_l2() < 1e-12);
/// # Ok::<(), lieflow::Error>(())
/// ```
pub fn exp<G: LieGroup>(group: &G, u: &G::Alg) -> Result<G::Elem, Error>
where
    Exp: CoordinateMap<G>,
{
    Exp.eval(group, u)
}

/// dexp_u⁻¹ v, right trivialised, to rounding at any u where it exists. Fresh storage.
///
/// [`dexpinv_truncated`](super::dexpinv_truncated) is the series of the paper, cut after q brackets.
///
/// # Errors
/// As [`CoordinateMap::eval_dpsi_inv`]: where dexp_u is singular, as next to |u| = 2π on so(3).
pub fn dexpinv<G: LieGroup>(group: &G, u: &G::Alg, v: &G::Alg) -> Result<G::Alg, Error>
where
    Exp: CoordinateMap<G>,
{
    Exp.eval_dpsi_inv(group, u, v)
}

/// cay(u) = (𝟙 − u/2)⁻¹(𝟙 + u/2). Fresh storage.
///
/// # Errors
/// As [`CoordinateMap::eval`].
pub fn cay<G: LieGroup>(group: &G, u: &G::Alg) -> Result<G::Elem, Error>
where
    Cay: CoordinateMap<G>,
{
    Cay.eval(group, u)
}

/// dcay_u⁻¹ v = (𝟙 − u/2) v (𝟙 + u/2), right trivialised. Fresh storage.
///
/// # Errors
/// As [`CoordinateMap::eval_dpsi_inv`].
pub fn dcayinv<G: LieGroup>(group: &G, u: &G::Alg, v: &G::Alg) -> Result<G::Alg, Error>
where
    Cay: CoordinateMap<G>,
{
    Cay.eval_dpsi_inv(group, u, v)
}

/// A group with a logarithm.
pub trait LogGroup: LieGroup {
    /// [`log`] on this group.
    ///
    /// # Errors
    /// As [`log`].
    fn log_of(&self, g: &Self::Elem) -> Result<Self::Alg, Error>;
}

/// log(g): the u with exp(u) = g, the shortest one on rotations. Fresh storage.
///
/// Of a unit quaternion q it is the logarithm of the rotation: exp(u) is q or −q, the one whose real part is not negative.
///
/// # Errors
/// g is not in the group, or has no logarithm in the algebra: as [`so3::log`] and
/// [`MatrixGroup::log`](crate::groups::MatrixGroup::log).
pub fn log<G: LogGroup>(group: &G, g: &G::Elem) -> Result<G::Alg, Error> {
    group.log_of(g)
}

impl LogGroup for So3<f64> {
    fn log_of(&self, g: &Matrix3<f64>) -> Result<Vector3<f64>, Error> {
        so3::log(g)
    }
}
impl LogGroup for UnitQuaternions {
    fn log_of(&self, q: &UnitQuaternion<f64>) -> Result<Vector3<f64>, Error> {
        so3::log_quaternion(q)
    }
}
impl LogGroup for Se3<f64> {
    fn log_of(&self, g: &Self::Elem) -> Result<Self::Alg, Error> {
        self.log(g)
    }
}
impl LogGroup for Se23<f64> {
    fn log_of(&self, g: &Self::Elem) -> Result<Self::Alg, Error> {
        self.log(g)
    }
}

/// A group with the differential of exp: `So3<f64>`, `UnitQuaternions`, `Se3<f64>`, `Se23<f64>`, `MatrixGroup`, `Unitary`.
/// Users need it for [`dexp`] only.
pub trait DexpGroup: LieGroup {
    /// [`dexp`] on this group.
    ///
    /// # Errors
    /// As [`dexp`].
    fn dexp_of(&self, u: &Self::Alg, v: &Self::Alg) -> Result<Self::Alg, Error>;
}

/// dexp_u v = Σ ad_u^k v/(k+1)!, right trivialised: d/dε exp(u + εv)|₀ = dexp_u(v)·exp(u). To rounding at any u.
/// Fresh storage.
///
/// # Errors
/// [`Error::Shape`], [`Error::NotFiniteEntry`], [`Error::Map`] when numbers leave the range.
///
/// ```
/// use lieflow::faer::mat;
/// use lieflow::groups::MatrixGroup;
/// use lieflow::maps::dexp;
/// let sp2 = MatrixGroup::sp(2)?;
/// let u = sp2.algebra(mat![[1.0, 0.0], [0.0, -1.0]])?;
/// let v = sp2.algebra(mat![[0.0, 1.0], [0.0, 0.0]])?; // [u, v] = 2v
/// let w = dexp(&sp2, &u, &v)?;
/// assert!((w[(0, 1)] - (2f64.exp() - 1.0) / 2.0).abs() < 1e-14);
/// # Ok::<(), lieflow::Error>(())
/// ```
pub fn dexp<G: DexpGroup>(group: &G, u: &G::Alg, v: &G::Alg) -> Result<G::Alg, Error> {
    group.check_shape("u", u)?;
    group.check_shape("v", v)?;
    group.dexp_of(u, v)
}

/// The left Jacobian of SE(3) at u = (ω, v): the 6×6 matrix J with [`dexp`]_u w = J w. Rows and columns have the rotation
/// first. The right Jacobian at u is J at −u.
///
/// # Errors
/// As [`dexp`].
///
/// ```
/// use lieflow::maps::{left_jacobian_se3, left_jacobian_inv_se3};
/// use lieflow::nalgebra::{Matrix6, Vector3};
/// let u = (Vector3::new(0.3, -0.2, 0.5), Vector3::new(1.0, 2.0, 0.1));
/// let unit = left_jacobian_se3(&u)? * left_jacobian_inv_se3(&u)?;
/// assert!((unit - Matrix6::identity()).norm() < 1e-14);
/// # Ok::<(), lieflow::Error>(())
/// ```
pub fn left_jacobian_se3(u: &(Vector3<f64>, Vector3<f64>)) -> Result<Matrix6<f64>, Error> {
    of_columns(|w| dexp(&Se3::new(), u, w))
}

/// The inverse of [`left_jacobian_se3`]: the 6×6 matrix J⁻¹ with [`dexpinv`]_u w = J⁻¹ w. The inverse of the right Jacobian
/// at u is J⁻¹ at −u.
///
/// # Errors
/// As [`dexpinv`].
pub fn left_jacobian_inv_se3(u: &(Vector3<f64>, Vector3<f64>)) -> Result<Matrix6<f64>, Error> {
    of_columns(|w| dexpinv(&Se3::new(), u, w))
}

/// The matrix of a linear function on se(3).
fn of_columns(
    f: impl Fn(&(Vector3<f64>, Vector3<f64>)) -> Result<(Vector3<f64>, Vector3<f64>), Error>,
) -> Result<Matrix6<f64>, Error> {
    matrix_of(|[a, b]| f(&(a, b)).map(|(a, b)| [a, b]))
}

/// The left Jacobian of SE₂(3) at u = (ω, (ν, ρ)): the 9×9 matrix J with [`dexp`]_u w = J w. Rows and columns have the
/// rotation first, then the velocity, then the place. The right Jacobian at u is J at −u.
///
/// # Errors
/// As [`dexp`].
pub fn left_jacobian_se23(u: &<Se23 as LieAlgebra>::Alg) -> Result<SMatrix<f64, 9, 9>, Error> {
    matrix_of(|[a, b, c]| dexp(&Se23::new(), u, &(a, (b, c))).map(|(a, (b, c))| [a, b, c]))
}

/// The inverse of [`left_jacobian_se23`]: the 9×9 matrix J⁻¹ with [`dexpinv`]_u w = J⁻¹ w.
///
/// # Errors
/// As [`dexpinv`].
pub fn left_jacobian_inv_se23(u: &<Se23 as LieAlgebra>::Alg) -> Result<SMatrix<f64, 9, 9>, Error> {
    matrix_of(|[a, b, c]| dexpinv(&Se23::new(), u, &(a, (b, c))).map(|(a, (b, c))| [a, b, c]))
}

/// The matrix of a linear function of K vectors, one after the other.
fn matrix_of<const K: usize, const N: usize>(
    f: impl Fn([Vector3<f64>; K]) -> Result<[Vector3<f64>; K], Error>,
) -> Result<SMatrix<f64, N, N>, Error> {
    let mut matrix: SMatrix<f64, N, N> = SMatrix::zeros();
    for j in 0..3 * K {
        let unit = |k: usize| Vector3::from_fn(|i, _| if 3 * k + i == j { 1.0 } else { 0.0 });
        for (k, part) in f(core::array::from_fn(unit))?.iter().enumerate() {
            matrix.fixed_view_mut::<3, 1>(3 * k, j).copy_from(part);
        }
    }
    Ok(matrix)
}

impl DexpGroup for So3<f64> {
    fn dexp_of(&self, u: &Vector3<f64>, v: &Vector3<f64>) -> Result<Vector3<f64>, Error> {
        Ok(so3::dexp(u, v)?)
    }
}
impl DexpGroup for UnitQuaternions {
    fn dexp_of(&self, u: &Vector3<f64>, v: &Vector3<f64>) -> Result<Vector3<f64>, Error> {
        Ok(so3::dexp(u, v)?)
    }
}
impl DexpGroup for Se3<f64> {
    fn dexp_of(&self, u: &Self::Alg, v: &Self::Alg) -> Result<Self::Alg, Error> {
        Ok(super::exp::se3::dexp(u, v)?)
    }
}
impl DexpGroup for Se23<f64> {
    fn dexp_of(&self, u: &Self::Alg, v: &Self::Alg) -> Result<Self::Alg, Error> {
        Ok(super::exp::se3::dexp_two(u, v)?)
    }
}
