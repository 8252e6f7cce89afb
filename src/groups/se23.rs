//! The group SE₂(3) of extended poses: g = (R, (v, p)) has the attitude, the velocity and the place of a body.
//!
//! | | |
//! |---|---|
//! | u = (ω, (ν, ρ)) | the 5×5 matrix \[ω̂ ν ρ; 0 0 0; 0 0 0\] |
//! | g = (R, (v, p)) | the 5×5 matrix \[R v p; 0 1 0; 0 0 1\] |
//! | \[u, u′\] | (ω × ω′, (ω × ν′ + ν × ω′, ω × ρ′ + ρ × ω′)) |
//! | g g′ | (RR′, (Rv′ + v, Rp′ + p)) |
//! | Ad_g u | (Rω, (Rν + v × Rω, Rρ + p × Rω)) |
//! | m = (μ, (π, λ)), ⟨m, u⟩ | μ·ω + π·ν + λ·ρ |
//! | Ad*_g m | (Rᵀ(μ + π × v + λ × p), (Rᵀπ, Rᵀλ)) |
//! | ad*_u m | (μ × ω + π × ν + λ × ρ, (π × ω, λ × ω)) |
//! | log g | (ω, (dexp_ω⁻¹ v, dexp_ω⁻¹ p)), ω = log R |
//!
//! In inertial navigation ġ = (Ad_g f)·g with a gyro and an accelerometer in f, and terms of gravity and of ṗ = v beside it: they
//! are fields of t and g. Source: A. Barrau, S. Bonnabel, The invariant extended Kalman filter as a stable observer, IEEE
//! Trans. Autom. Control 62 (2017). The maps are those of SE(3) on each translation: `maps/se3.rs`, `maps/exp/se3.rs`.

use core::marker::PhantomData;

use nalgebra::{Matrix3, Vector3};
use rand::Rng;

use super::se3::finite_pair;
use super::so3::check_finite;
use super::{Adjoint, LieAlgebra, LieGroup, Sample, Se3, So3};
use crate::error::{Error, StepError};
use crate::scalar::{Real, larger};
use crate::so3::{self, add3, all_finite, apply3, cross, dot3};
use crate::space::{Gap, Metric};
use crate::tolerance::Scales;

/// The group SE₂(3). Elements of the algebra are (ω, (ν, ρ)), of the group (R, (v, p)), of the dual (μ, (π, λ)).
///
/// [`LieGroup::apply`] moves a place x of the body to Rx + p.
///
/// ```
/// use lieflow::groups::Se23;
/// use lieflow::nalgebra::{Matrix3, Vector3};
/// use lieflow::prelude::*;
///
/// // Inertial navigation: a gyro ω and an accelerometer a, both in the body, and gravity.
/// let (omega, a) = (Vector3::new(0.0, 0.0, 0.5), Vector3::new(1.0, 0.0, 9.81));
/// let gravity = Vector3::new(0.0, 0.0, -9.81);
/// type Pose = (Matrix3<f64>, (Vector3<f64>, Vector3<f64>));
/// let field = move |_: f64, (r, (v, p)): &Pose, f: &mut (Vector3<f64>, _)| {
///     // Ṙ = ŵR, v̇ = w × v + ν and ṗ = w × p + ρ with w = Rω are to be R ω̂, Ra + gravity and v.
///     let w = r * omega;
///     *f = (w, (r * a + gravity - w.cross(v), v - w.cross(p)));
/// };
/// let body = Flow::new(Se23::<f64>::new(), LeftTranslation, field);
/// let start = (Matrix3::identity(), (Vector3::zeros(), Vector3::zeros()));
/// let method = Rkmk::new(DOP853, Exp);
/// let end = Solve::new(&body, &method, [0.0, 2.0]).tolerances(1e-12, 1e-12).run(start)?.y;
/// // It turns by 1 radian, and accelerates by 1 along its own axis.
/// let speed = Vector3::new(1f64.sin(), 1.0 - 1f64.cos(), 0.0) / 0.5;
/// assert!((end.1.0 - speed).norm() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Se23<S = f64>(PhantomData<S>);

impl<S> Se23<S> {
    /// The group.
    pub const fn new() -> Self {
        Se23(PhantomData)
    }
}

/// (ω, (ν, ρ)), or (μ, (π, λ)).
type Three<S> = (Vector3<S>, (Vector3<S>, Vector3<S>));

/// Both translations, each with the rotation, as SE(3) has them.
#[inline]
fn parts<R: Copy, S: Copy>((r, (a, b)): &(R, (S, S))) -> [(R, S); 2] {
    [(*r, *a), (*r, *b)]
}

/// All three vectors, or an error if they are not finite.
#[inline]
pub(crate) fn finite_three<S: Real>(u: &Three<S>, what: &'static str) -> Result<(), StepError> {
    finite_pair(&u.1, what)?;
    if all_finite(&u.0) { Ok(()) } else { Err(StepError::NotFinite { what }) }
}

impl<S: Real> LieAlgebra for Se23<S> {
    type Scalar = S;
    type Alg = Three<S>;

    fn name(&self) -> String {
        "SE2(3)".into()
    }
    fn dim(&self) -> usize {
        9
    }
    #[inline]
    fn zero(&self) -> Three<S> {
        (So3::new().zero(), Se3::new().zero())
    }
    #[inline]
    fn set_zero(&self, u: &mut Three<S>) {
        *u = self.zero();
    }
    #[inline]
    fn axpy(&self, a: S, x: &Three<S>, y: &mut Three<S>) {
        So3::new().axpy(a, &x.0, &mut y.0);
        Se3::new().axpy(a, &x.1, &mut y.1);
    }
    #[inline]
    fn bracket(&self, u: &Three<S>, v: &Three<S>, out: &mut Three<S>) {
        let moved = |a: &Vector3<S>, b: &Vector3<S>| add3(&cross(&u.0, b), &cross(a, &v.0));
        *out = (cross(&u.0, &v.0), (moved(&u.1.0, &v.1.0), moved(&u.1.1, &v.1.1)));
    }
    /// (|ω|² + |ν|² + |ρ|²)^½. A radian counts like a speed and a length of 1.
    #[inline]
    fn norm(&self, u: &Three<S>) -> S {
        (dot3(&u.0, &u.0) + dot3(&u.1.0, &u.1.0) + dot3(&u.1.1, &u.1.1)).sqrt()
    }
    #[inline]
    fn is_finite(&self, u: &Three<S>) -> bool {
        finite_three(u, "").is_ok()
    }
}

impl<S: Real> LieGroup for Se23<S> {
    type Elem = (Matrix3<S>, (Vector3<S>, Vector3<S>));
    /// A place x of the body. For the 5×5 matrices it is the vector (x, 0, 1).
    type Vector = Vector3<S>;

    fn identity(&self) -> Self::Elem {
        (So3::new().identity(), Se3::new().zero())
    }
    #[inline]
    fn compose(&self, a: &Self::Elem, b: &Self::Elem, out: &mut Self::Elem) {
        So3::new().compose(&a.0, &b.0, &mut out.0);
        let moved = |x: &Vector3<S>, y: &Vector3<S>| add3(&apply3(&a.0, y), x);
        out.1 = (moved(&a.1.0, &b.1.0), moved(&a.1.1, &b.1.1));
    }
    #[inline]
    fn apply(&self, g: &Self::Elem, x: &Vector3<S>, y: &mut Vector3<S>) {
        *y = add3(&apply3(&g.0, x), &g.1.1);
    }
    /// (ω̂R, (ω × v + ν, ω × p + ρ)).
    #[inline]
    fn tangent(&self, u: &Three<S>, g: &Self::Elem, out: &mut Self::Elem) {
        So3::new().tangent(&u.0, &g.0, &mut out.0);
        let moved = |a: &Vector3<S>, x: &Vector3<S>| add3(&cross(&u.0, x), a);
        out.1 = (moved(&u.1.0, &g.1.0), moved(&u.1.1, &g.1.1));
    }
    /// ω × x + ρ.
    #[inline]
    fn apply_algebra(&self, u: &Three<S>, x: &Vector3<S>, y: &mut Vector3<S>) {
        *y = add3(&cross(&u.0, x), &u.1.1);
    }
    fn check_elem(&self, g: &Self::Elem) -> Result<(), Error> {
        parts(g).iter().try_for_each(|part| Se3::new().check_elem(part))
    }
    fn check_vector(&self, x: &Vector3<S>) -> Result<(), Error> {
        check_finite(x.as_slice())
    }
    /// The driver looks at the state after each step.
    #[inline]
    fn is_finite_vector(&self, _: &Vector3<S>) -> bool {
        true
    }
    /// Three parts: the rotation, the velocity and the place.
    #[inline]
    fn error_ratio(
        &self,
        e: &Three<S>,
        g: &Self::Elem,
        from_right: bool,
        scales: &mut Scales<'_>,
    ) -> S {
        let turned = scales.part().ratio(e.0.size(), S::lit(1.0));
        let [first, second] = [(e.1.0, g.1.0), (e.1.1, g.1.1)].map(|(a, x)| {
            let moved = if from_right { apply3(&g.0, &a) } else { a + cross(&e.0, &x) };
            x.error_ratio(Gap::of(&moved), scales)
        });
        larger(turned, larger(first, second))
    }
    #[inline]
    fn vector_error_ratio(&self, e: &Three<S>, x: &Vector3<S>, scales: &mut Scales<'_>) -> S {
        x.error_ratio(Gap::of(&(e.1.1 + cross(&e.0, x))), scales)
    }
    fn distance(&self, a: &Self::Elem, b: &Self::Elem) -> S {
        let turned = So3::new().distance(&a.0, &b.0);
        let apart = |a: &Vector3<S>, b: &Vector3<S>| {
            let mut gap = *a;
            So3::new().axpy(S::lit(-1.0), b, &mut gap);
            dot3(&gap, &gap)
        };
        (turned * turned + apart(&a.1.0, &b.1.0) + apart(&a.1.1, &b.1.1)).sqrt()
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

impl<S: Real> Adjoint for Se23<S> {
    type Dual = Three<S>;

    type Inverting = ();

    fn inverting(&self) {}
    #[inline]
    fn invert(&self, g: &Self::Elem, (): &mut (), out: &mut Self::Elem) -> Result<(), StepError> {
        out.0 = g.0.transpose();
        let back = |x: &Vector3<S>| {
            let x = apply3(&out.0, x);
            Vector3::new(-x[0], -x[1], -x[2])
        };
        out.1 = (back(&g.1.0), back(&g.1.1));
        finite_pair(&out.1, "g⁻¹")
    }
    /// (Rω̂, (Rν, Rρ)).
    #[inline]
    fn tangent_in_body(&self, g: &Self::Elem, u: &Three<S>, out: &mut Self::Elem) {
        So3::new().tangent_in_body(&g.0, &u.0, &mut out.0);
        out.1 = (apply3(&g.0, &u.1.0), apply3(&g.0, &u.1.1));
    }
    #[inline]
    fn big_ad(&self, g: &Self::Elem, u: &Three<S>, out: &mut Three<S>) -> Result<(), StepError> {
        let omega = apply3(&g.0, &u.0);
        let moved = |a: &Vector3<S>, x: &Vector3<S>| add3(&apply3(&g.0, a), &cross(x, &omega));
        *out = (omega, (moved(&u.1.0, &g.1.0), moved(&u.1.1, &g.1.1)));
        finite_three(out, "Ad")
    }
    #[inline]
    fn coad_group(
        &self,
        g: &Self::Elem,
        m: &Three<S>,
        out: &mut Three<S>,
    ) -> Result<(), StepError> {
        let inverse = g.0.transpose();
        let arms = add3(&cross(&m.1.0, &g.1.0), &cross(&m.1.1, &g.1.1));
        let turned = (apply3(&inverse, &m.1.0), apply3(&inverse, &m.1.1));
        *out = (apply3(&inverse, &add3(&m.0, &arms)), turned);
        finite_three(out, "Ad*")
    }
    #[inline]
    fn coad(&self, u: &Three<S>, m: &Three<S>, out: &mut Three<S>) {
        let arms = add3(&cross(&m.1.0, &u.1.0), &cross(&m.1.1, &u.1.1));
        let turned = (cross(&m.1.0, &u.0), cross(&m.1.1, &u.0));
        *out = (add3(&cross(&m.0, &u.0), &arms), turned);
    }
    #[inline]
    fn pair(&self, m: &Three<S>, u: &Three<S>) -> S {
        dot3(&m.0, &u.0) + dot3(&m.1.0, &u.1.0) + dot3(&m.1.1, &u.1.1)
    }
}

impl Se23<f64> {
    /// log(g): the u with exp(u) = g and |ω| ≤ π; at |ω| = π as [`so3::log`] chooses.
    ///
    /// # Errors
    /// As [`so3::log`], and [`Error::Map`] when the result is not finite.
    pub fn log(&self, g: &<Self as LieGroup>::Elem) -> Result<Three<f64>, Error> {
        let omega = so3::log(&g.0)?;
        Ok((omega, (so3::dexpinv(&omega, &g.1.0)?, so3::dexpinv(&omega, &g.1.1)?)))
    }
}

impl Sample for Se23<f64> {
    /// Independent Gaussian components.
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Three<f64> {
        (So3::new().sample_algebra(rng, sigma), Se3::new().sample_algebra(rng, sigma))
    }
    /// R by Haar's measure, v and p Gaussian of standard deviation 1.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> <Self as LieGroup>::Elem {
        (So3::new().sample_element(rng), (self.sample_vector(rng), self.sample_vector(rng)))
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Vector3<f64> {
        Se3::new().sample_vector(rng)
    }
}
