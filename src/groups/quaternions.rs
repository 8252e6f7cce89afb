//! The unit quaternions S³ ≅ SU(2). q and −q are the same rotation.
//!
//! | | |
//! |---|---|
//! | u ∈ ℝ³ | the imaginary quaternion u/2, so that \[u, v\] = u × v as on so(3) |
//! | q·x | q x q̄ |
//! | correction | q/\|q\| |
//!
//! The maps of S³ are in `maps/quaternions.rs`. Quaternions are Hamilton's; text and files have the real part first.
//! nalgebra's [`UnitQuaternion`] is the container. A rotation by 2π is q = −1.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::so3::check_finite;
use super::{Adjoint, LieAlgebra, LieGroup, RESIDUAL_MAX, Sample, So3};
use crate::error::{Error, StepError};
use crate::scalar::{Ops, tally};
use crate::so3;

/// The unit quaternions S³. Their algebra is ℝ³ with the cross product.
///
/// ```
/// use lieflow::CoordinateMap;
/// use lieflow::groups::{LieGroup, UnitQuaternions};
/// use lieflow::maps::Exp;
/// use lieflow::nalgebra::Vector3;
/// // A rotation by a quarter turn about e₃.
/// let q = Exp.eval(&UnitQuaternions, &Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2))?;
/// let mut y = Vector3::zeros();
/// UnitQuaternions.apply(&q, &Vector3::x(), &mut y);
/// assert!((y - Vector3::y()).norm() < 1e-15);
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnitQuaternions;

const SO3: So3<f64> = So3::new();

/// u × v.
const CROSS: Ops = Ops { mul: 6, add: 3, ..Ops::NONE };
/// A product of quaternions.
const QUATERNION_PRODUCT: Ops = Ops { mul: 16, add: 12, ..Ops::NONE };

impl LieAlgebra for UnitQuaternions {
    type Scalar = f64;
    type Alg = Vector3<f64>;

    fn name(&self) -> String {
        "S³".into()
    }
    fn dim(&self) -> usize {
        3
    }
    #[inline]
    fn zero(&self) -> Vector3<f64> {
        SO3.zero()
    }
    #[inline]
    fn set_zero(&self, u: &mut Vector3<f64>) {
        SO3.set_zero(u);
    }
    #[inline]
    fn axpy(&self, a: f64, x: &Vector3<f64>, y: &mut Vector3<f64>) {
        tally(|| Ops::muladds(3));
        SO3.axpy(a, x, y);
    }
    #[inline]
    fn bracket(&self, u: &Vector3<f64>, v: &Vector3<f64>, out: &mut Vector3<f64>) {
        tally(|| CROSS);
        SO3.bracket(u, v, out);
    }
    #[inline]
    fn norm(&self, u: &Vector3<f64>) -> f64 {
        tally(|| Ops::dots(1, 3) + Ops::sqrts(1));
        SO3.norm(u)
    }
    #[inline]
    fn is_finite(&self, u: &Vector3<f64>) -> bool {
        SO3.is_finite(u)
    }
}

impl LieGroup for UnitQuaternions {
    type Elem = UnitQuaternion<f64>;
    /// A vector of ℝ³.
    type Vector = Vector3<f64>;

    fn identity(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::identity()
    }
    #[inline]
    fn compose(
        &self,
        a: &UnitQuaternion<f64>,
        b: &UnitQuaternion<f64>,
        out: &mut UnitQuaternion<f64>,
    ) {
        tally(|| QUATERNION_PRODUCT);
        *out = UnitQuaternion::new_unchecked(a.quaternion() * b.quaternion());
    }
    #[inline]
    fn apply(&self, q: &UnitQuaternion<f64>, x: &Vector3<f64>, y: &mut Vector3<f64>) {
        let (w, v) = (q.w, q.imag());
        tally(|| CROSS * 2 + Ops::muls(6) + Ops::adds(6));
        let t = 2.0 * v.cross(x);
        *y = x + w * t + v.cross(&t);
    }
    /// (v/2)·q.
    #[inline]
    fn tangent(&self, v: &Vector3<f64>, q: &UnitQuaternion<f64>, out: &mut UnitQuaternion<f64>) {
        tally(|| Ops::muls(3) + QUATERNION_PRODUCT);
        *out = UnitQuaternion::new_unchecked(Quaternion::from_imag(0.5 * v) * q.quaternion());
    }
    #[inline]
    fn apply_algebra(&self, v: &Vector3<f64>, x: &Vector3<f64>, y: &mut Vector3<f64>) {
        self.bracket(v, x, y);
    }
    #[inline]
    fn check_elem(&self, q: &UnitQuaternion<f64>) -> Result<(), Error> {
        check_finite(q.coords.as_slice())
    }
    #[inline]
    fn check_vector(&self, x: &Vector3<f64>) -> Result<(), Error> {
        check_finite(x.as_slice())
    }
    /// |a − b|: q and −q are different elements.
    fn distance(&self, a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
        (a.coords - b.coords).norm()
    }
    /// ||q|² − 1|.
    fn defect(&self, q: &UnitQuaternion<f64>) -> f64 {
        (q.coords.norm_squared() - 1.0).abs()
    }
    #[inline]
    fn is_finite_vector(&self, x: &Vector3<f64>) -> bool {
        SO3.is_finite(x)
    }
    fn correct_vector(&self, from: &Vector3<f64>, x: &mut Vector3<f64>) -> Option<f64> {
        SO3.correct_vector(from, x)
    }
    #[inline]
    fn correct(&self, q: &mut UnitQuaternion<f64>, _: [&mut UnitQuaternion<f64>; 2]) -> f64 {
        let gap = q.coords.norm_squared() - 1.0;
        tally(|| Ops::dots(1, 4) + Ops::adds(2) + Ops::muls(5));
        if gap.abs() < RESIDUAL_MAX {
            *q = UnitQuaternion::new_unchecked(Quaternion::from(q.coords * (1.0 - 0.5 * gap)));
        }
        gap.abs()
    }
}

/// Ad, ad and their duals as on SO(3), with q instead of its rotation.
impl Adjoint for UnitQuaternions {
    type Dual = Vector3<f64>;
    type Inverting = ();

    fn inverting(&self) {}
    #[inline]
    fn invert(
        &self,
        q: &UnitQuaternion<f64>,
        (): &mut (),
        out: &mut UnitQuaternion<f64>,
    ) -> Result<(), StepError> {
        *out = q.conjugate();
        Ok(())
    }
    #[inline]
    fn tangent_in_body(
        &self,
        q: &UnitQuaternion<f64>,
        v: &Vector3<f64>,
        out: &mut UnitQuaternion<f64>,
    ) {
        tally(|| Ops::muls(3) + QUATERNION_PRODUCT);
        *out = UnitQuaternion::new_unchecked(q.quaternion() * Quaternion::from_imag(0.5 * v));
    }
    #[inline]
    fn big_ad(
        &self,
        q: &UnitQuaternion<f64>,
        u: &Vector3<f64>,
        out: &mut Vector3<f64>,
    ) -> Result<(), StepError> {
        self.apply(q, u, out);
        so3::finite(*out, "Ad").map(drop)
    }
    #[inline]
    fn coad_group(
        &self,
        q: &UnitQuaternion<f64>,
        m: &Vector3<f64>,
        out: &mut Vector3<f64>,
    ) -> Result<(), StepError> {
        self.big_ad(&q.conjugate(), m, out)
    }
    #[inline]
    fn coad(&self, u: &Vector3<f64>, m: &Vector3<f64>, out: &mut Vector3<f64>) {
        SO3.coad(u, m, out);
    }
    #[inline]
    fn pair(&self, m: &Vector3<f64>, v: &Vector3<f64>) -> f64 {
        SO3.pair(m, v)
    }
}

impl Sample for UnitQuaternions {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Vector3<f64> {
        SO3.sample_algebra(rng, sigma)
    }
    /// Haar's measure: uniform on the 3-sphere.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> UnitQuaternion<f64> {
        let [w, x, y, z] = core::array::from_fn(|_| rng.sample(StandardNormal));
        UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Vector3<f64> {
        SO3.sample_vector(rng)
    }
}
