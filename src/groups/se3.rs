//! The group SE(3) of rigid motions of space: g = (R, x) moves a point p to Rp + x. The rotation always comes first.
//!
//! | | |
//! |---|---|
//! | u = (ω, v) ∈ se(3) | the 4×4 matrix \[ω̂ v; 0 0\] |
//! | g = (R, x) | the 4×4 matrix \[R x; 0 1\] |
//! | \[(ω, v), (ω′, v′)\] | (ω × ω′, ω × v′ + v × ω′) |
//! | (R, x)(R′, x′) | (RR′, Rx′ + x) |
//! | Ad_g (ω, v) | (Rω, Rv + x × Rω) |
//! | (μ, π) ∈ se(3)*, ⟨(μ, π), (ω, v)⟩ | μ·ω + π·v |
//! | Ad*_g (μ, π) | (Rᵀ(μ + π × x), Rᵀπ) |
//! | ad*_(ω, v) (μ, π) | (μ × ω + π × v, π × ω) |
//! | log (R, x) | (ω, dexp_ω⁻¹ x), ω = log R |
//!
//! The maps of SE(3) are in `maps/se3.rs` and `maps/exp/se3.rs`. The Casimirs of se(3)* are π·π and
//! μ·π.

use core::marker::PhantomData;

use nalgebra::{Isometry3, Matrix3, Translation3, Vector3};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::so3::check_finite;
use super::{Adjoint, LieAlgebra, LieGroup, Sample, So3};
use crate::error::{Error, StepError};
use crate::scalar::{Real, larger};
use crate::so3::{self, add3, all_finite, apply3, cross, dot3};
use crate::space::{Gap, Metric};
use crate::tolerance::Scales;

/// The group SE(3). Elements of the algebra are (ω, v), of the group (R, x), of the dual (μ, π).
///
/// ω is an angular velocity and v a linear one. μ is an angular momentum and π a linear one; for a heavy top π is the
/// vertical, which points upward. [`LieGroup::apply`] moves a point of ℝ³.
///
/// ```
/// use lieflow::CoordinateMap;
/// use lieflow::groups::Se3;
/// use lieflow::maps::Exp;
/// use lieflow::nalgebra::Vector3;
/// // A screw: a quarter turn about e₃ and a move by 1 along it.
/// let screw = (Vector3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2), Vector3::new(0.0, 0.0, 1.0));
/// let g = Exp.eval(&Se3::new(), &screw)?;
/// assert!((g.0 * Vector3::x() + g.1 - Vector3::new(0.0, 1.0, 1.0)).norm() < 1e-15);
/// let (omega, v) = Se3::new().log(&g)?;
/// assert!((omega - screw.0).norm() + (v - screw.1).norm() < 1e-15);
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Se3<S = f64>(PhantomData<S>);

impl<S> Se3<S> {
    /// The group.
    pub const fn new() -> Self {
        Se3(PhantomData)
    }
}

/// A pair of vectors: (ω, v), or (μ, π).
type Pair<S> = (Vector3<S>, Vector3<S>);

/// Both vectors, or an error if they are not finite.
#[inline]
pub(crate) fn finite_pair<S: Real>(u: &Pair<S>, what: &'static str) -> Result<(), StepError> {
    StepError::finite(all_finite(&u.0) && all_finite(&u.1), what)
}

impl<S: Real> LieAlgebra for Se3<S> {
    type Scalar = S;
    type Alg = (Vector3<S>, Vector3<S>);

    fn name(&self) -> String {
        "SE(3)".into()
    }
    fn dim(&self) -> usize {
        6
    }
    #[inline]
    fn zero(&self) -> Self::Alg {
        let zero = So3::new().zero();
        (zero, zero)
    }
    #[inline]
    fn set_zero(&self, u: &mut Self::Alg) {
        *u = self.zero();
    }
    #[inline]
    fn axpy(&self, a: S, x: &Self::Alg, y: &mut Self::Alg) {
        So3::new().axpy(a, &x.0, &mut y.0);
        So3::new().axpy(a, &x.1, &mut y.1);
    }
    #[inline]
    fn bracket(&self, u: &Self::Alg, v: &Self::Alg, out: &mut Self::Alg) {
        *out = (cross(&u.0, &v.0), add3(&cross(&u.0, &v.1), &cross(&u.1, &v.0)));
    }
    /// (|ω|² + |v|²)^½. A radian counts like a length of 1.
    #[inline]
    fn norm(&self, u: &Self::Alg) -> S {
        (dot3(&u.0, &u.0) + dot3(&u.1, &u.1)).sqrt()
    }
    #[inline]
    fn is_finite(&self, u: &Self::Alg) -> bool {
        all_finite(&u.0) && all_finite(&u.1)
    }
}

impl<S: Real> LieGroup for Se3<S> {
    type Elem = (Matrix3<S>, Vector3<S>);
    /// A point p of space. For the 4×4 matrices it is the vector (p, 1).
    type Vector = Vector3<S>;

    fn identity(&self) -> Self::Elem {
        (So3::new().identity(), So3::new().zero())
    }
    #[inline]
    fn compose(&self, a: &Self::Elem, b: &Self::Elem, out: &mut Self::Elem) {
        So3::new().compose(&a.0, &b.0, &mut out.0);
        out.1 = add3(&apply3(&a.0, &b.1), &a.1);
    }
    #[inline]
    fn apply(&self, g: &Self::Elem, x: &Vector3<S>, y: &mut Vector3<S>) {
        *y = add3(&apply3(&g.0, x), &g.1);
    }
    /// (ω̂R, ω × x + v).
    #[inline]
    fn tangent(&self, v: &Self::Alg, g: &Self::Elem, out: &mut Self::Elem) {
        So3::new().tangent(&v.0, &g.0, &mut out.0);
        self.apply_algebra(v, &g.1, &mut out.1);
    }
    /// ω × p + v.
    #[inline]
    fn apply_algebra(&self, v: &Self::Alg, p: &Vector3<S>, y: &mut Vector3<S>) {
        *y = add3(&cross(&v.0, p), &v.1);
    }
    fn check_elem(&self, g: &Self::Elem) -> Result<(), Error> {
        check_finite(g.0.as_slice())?;
        check_finite(g.1.as_slice())
    }
    fn check_vector(&self, x: &Vector3<S>) -> Result<(), Error> {
        check_finite(x.as_slice())
    }
    /// The driver looks at the state after each step.
    #[inline]
    fn is_finite_vector(&self, _: &Vector3<S>) -> bool {
        true
    }
    /// Two parts: the rotation and the translation.
    #[inline]
    fn error_ratio(
        &self,
        e: &Self::Alg,
        g: &Self::Elem,
        from_right: bool,
        scales: &mut Scales<'_>,
    ) -> S {
        let turned = scales.part().ratio(e.0.size(), S::lit(1.0));
        // exp(εe) g moves the place p by ω × p + v, and g exp(εe) by Rv.
        let moved = if from_right { apply3(&g.0, &e.1) } else { e.1 + cross(&e.0, &g.1) };
        larger(turned, g.1.error_ratio(Gap::of(&moved), scales))
    }
    #[inline]
    fn vector_error_ratio(&self, e: &Self::Alg, x: &Vector3<S>, scales: &mut Scales<'_>) -> S {
        x.error_ratio(Gap::of(&(e.1 + cross(&e.0, x))), scales)
    }
    fn distance(&self, a: &Self::Elem, b: &Self::Elem) -> S {
        let turned = So3::new().distance(&a.0, &b.0);
        let mut moved = a.1;
        So3::new().axpy(S::lit(-1.0), &b.1, &mut moved);
        (turned * turned + dot3(&moved, &moved)).sqrt()
    }
    /// ‖RᵀR − 𝟙‖.
    fn defect(&self, g: &Self::Elem) -> S {
        So3::new().defect(&g.0)
    }
    /// Only R can leave the group.
    #[inline]
    fn correct(&self, g: &mut Self::Elem, [a, b]: [&mut Self::Elem; 2]) -> S {
        So3::new().correct(&mut g.0, [&mut a.0, &mut b.0])
    }
}

impl<S: Real> Adjoint for Se3<S> {
    type Dual = (Vector3<S>, Vector3<S>);

    type Inverting = ();

    fn inverting(&self) {}
    #[inline]
    fn invert(&self, g: &Self::Elem, (): &mut (), out: &mut Self::Elem) -> Result<(), StepError> {
        out.0 = g.0.transpose();
        let x = apply3(&out.0, &g.1);
        out.1 = Vector3::new(-x[0], -x[1], -x[2]);
        StepError::finite(all_finite(&out.1), "g⁻¹")
    }
    /// (Rω̂, Rv).
    #[inline]
    fn tangent_in_body(&self, g: &Self::Elem, v: &Self::Alg, out: &mut Self::Elem) {
        So3::new().tangent_in_body(&g.0, &v.0, &mut out.0);
        out.1 = apply3(&g.0, &v.1);
    }
    #[inline]
    fn big_ad(&self, g: &Self::Elem, u: &Self::Alg, out: &mut Self::Alg) -> Result<(), StepError> {
        let omega = apply3(&g.0, &u.0);
        *out = (omega, add3(&apply3(&g.0, &u.1), &cross(&g.1, &omega)));
        finite_pair(out, "Ad")
    }
    #[inline]
    fn coad_group(
        &self,
        g: &Self::Elem,
        m: &Self::Dual,
        out: &mut Self::Dual,
    ) -> Result<(), StepError> {
        let inverse = g.0.transpose();
        *out = (apply3(&inverse, &add3(&m.0, &cross(&m.1, &g.1))), apply3(&inverse, &m.1));
        finite_pair(out, "Ad*")
    }
    #[inline]
    fn coad(&self, u: &Self::Alg, m: &Self::Dual, out: &mut Self::Dual) {
        *out = (add3(&cross(&m.0, &u.0), &cross(&m.1, &u.1)), cross(&m.1, &u.0));
    }
    #[inline]
    fn pair(&self, m: &Self::Dual, v: &Self::Alg) -> S {
        dot3(&m.0, &v.0) + dot3(&m.1, &v.1)
    }
}

impl Se3<f64> {
    /// The element of a rigid motion of nalgebra: of an `Isometry3`, or of what can be one.
    ///
    /// ```
    /// use lieflow::groups::Se3;
    /// use lieflow::nalgebra::{Isometry3, Point3, Vector3};
    /// let pose = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.1, -0.2, 0.3));
    /// let g = Se3::from_isometry(pose);
    /// assert!((g.0 * Vector3::x() + g.1 - (pose * Point3::new(1.0, 0.0, 0.0)).coords).norm() < 1e-15);
    /// assert!((Se3::to_isometry(&g)?.to_matrix() - pose.to_matrix()).norm() < 1e-15);
    /// # Ok::<(), lieflow::Error>(())
    /// ```
    pub fn from_isometry(motion: impl Into<Isometry3<f64>>) -> (Matrix3<f64>, Vector3<f64>) {
        let motion = motion.into();
        (So3::from_rotation(motion.rotation), motion.translation.vector)
    }

    /// The `Isometry3` of an element.
    ///
    /// # Errors
    /// As [`so3::log`], for a matrix that is no rotation.
    pub fn to_isometry((r, x): &(Matrix3<f64>, Vector3<f64>)) -> Result<Isometry3<f64>, Error> {
        Ok(Isometry3::from_parts(Translation3::from(*x), So3::to_quaternion(r)?))
    }

    /// log(g): the twist u with exp(u) = g and |ω| ≤ π; at |ω| = π as [`so3::log`] chooses.
    ///
    /// # Errors
    /// As [`so3::log`], and [`Error::Map`] when the result is not finite.
    pub fn log(&self, g: &(Matrix3<f64>, Vector3<f64>)) -> Result<Pair<f64>, Error> {
        let omega = so3::log(&g.0)?;
        Ok((omega, so3::dexpinv(&omega, &g.1)?))
    }
}

impl Sample for Se3<f64> {
    /// Independent Gaussian components.
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Pair<f64> {
        (So3::new().sample_algebra(rng, sigma), So3::new().sample_algebra(rng, sigma))
    }
    /// R by Haar's measure, x Gaussian of standard deviation 1.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> (Matrix3<f64>, Vector3<f64>) {
        (So3::new().sample_element(rng), self.sample_vector(rng))
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Vector3<f64> {
        Vector3::from_fn(|_, _| rng.sample(StandardNormal))
    }
}
