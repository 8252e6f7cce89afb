//! The interface of a free rigid body for the special methods.
//!
//! A step is a rotation Ψ of the body frame: m⁺ = Ψᵀm, g⁺ = gΨ. So one formula serves all models of the body.
//!
//! | model | y | m | frame |
//! |---|---|---|---|
//! | [`RigidBody`] | m | m | none: `()` |
//! | [`RigidBodyAttitude`] | g | gᵀm_s | g |
//! | [`RigidBodyState`] | (m, g) | m | g |

use nalgebra::{Matrix3, Vector3};

use super::{BodyState, RigidBody, RigidBodyAttitude, RigidBodyState};
use crate::error::StepError;
use crate::groups::{LieGroup, So3};
use crate::problems::{LiePoisson, Orthogonal, PointOf, Problem, Projection, ScalarOf, Split};
use crate::scalar::{Real, Trig};

/// A frame fixed in the body: g, or nothing for a model of the momentum only.
pub trait Frame<S>: Copy {
    /// True if there is a frame.
    const TURNS: bool;
    /// g ← g·Ψ.
    fn turn(&mut self, psi: &Matrix3<S>);
}

impl<S> Frame<S> for () {
    const TURNS: bool = false;
    #[inline(always)]
    fn turn(&mut self, _: &Matrix3<S>) {}
}

impl<S: Real> Frame<S> for Matrix3<S> {
    const TURNS: bool = true;
    #[inline(always)]
    fn turn(&mut self, psi: &Matrix3<S>) {
        let g = *self;
        So3::new().compose(&g, psi, self);
    }
}

/// A free rigid body in ℝ³: ṁ = m × J⁻¹m, ġ = g ω̂.
pub trait FreeBody: Problem {
    /// The attitude, or `()`.
    type Frame: Frame<ScalarOf<Self>>;

    /// The diagonal of J⁻¹.
    fn inverse_inertia(&self) -> &Vector3<ScalarOf<Self>>;
    /// m and the frame at y.
    fn load(&self, y: &PointOf<Self>) -> (Vector3<ScalarOf<Self>>, Self::Frame);
    /// y ← m and the frame.
    fn store(&self, m: &Vector3<ScalarOf<Self>>, frame: &Self::Frame, y: &mut PointOf<Self>);
}

impl<S: Real> FreeBody for RigidBody<S> {
    type Frame = ();
    #[inline(always)]
    fn inverse_inertia(&self) -> &Vector3<S> {
        RigidBody::inverse_inertia(self)
    }
    #[inline(always)]
    fn load(&self, m: &Vector3<S>) -> (Vector3<S>, ()) {
        (*m, ())
    }
    #[inline(always)]
    fn store(&self, m: &Vector3<S>, _: &(), y: &mut Vector3<S>) {
        *y = *m;
    }
}

impl<S: Real> FreeBody for RigidBodyAttitude<S> {
    type Frame = Matrix3<S>;
    #[inline(always)]
    fn inverse_inertia(&self) -> &Vector3<S> {
        self.body().inverse_inertia()
    }
    #[inline(always)]
    fn load(&self, g: &Matrix3<S>) -> (Vector3<S>, Matrix3<S>) {
        (self.momentum_body(g), *g)
    }
    /// m follows from g.
    #[inline(always)]
    fn store(&self, _: &Vector3<S>, g: &Matrix3<S>, y: &mut Matrix3<S>) {
        *y = *g;
    }
}

impl<S: Real> FreeBody for RigidBodyState<S> {
    type Frame = Matrix3<S>;
    #[inline(always)]
    fn inverse_inertia(&self) -> &Vector3<S> {
        self.body().inverse_inertia()
    }
    #[inline(always)]
    fn load(&self, y: &BodyState<S>) -> (Vector3<S>, Matrix3<S>) {
        (y.m, y.g)
    }
    #[inline(always)]
    fn store(&self, m: &Vector3<S>, g: &Matrix3<S>, y: &mut BodyState<S>) {
        *y = BodyState { m: *m, g: *g };
    }
}

/// The flow of axis k: θ = t·m_k/J_k, m ← R_k(θ)ᵀ m, g ← g R_k(θ). The components i, j of m and the
/// columns i, j of g change in the same way: x_i ← x_i cos θ + x_j sin θ, x_j ← x_j cos θ − x_i sin θ.
#[inline(always)]
fn turn_pair<S: Real>((c, s): (S, S), x: &mut S, y: &mut S) {
    (*x, *y) = (c * *x + s * *y, c * *y - s * *x);
}

#[inline(always)]
fn turn_momentum<S: Real, const K: usize>(m: &mut Vector3<S>, turn: (S, S)) {
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    let (mut x, mut y) = (m[i], m[j]);
    turn_pair(turn, &mut x, &mut y);
    (m[i], m[j]) = (x, y);
}

#[inline(always)]
fn turn_frame<S: Real, const K: usize>(g: &mut Matrix3<S>, turn: (S, S)) {
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    for r in 0..3 {
        let (mut x, mut y) = (g[(r, i)], g[(r, j)]);
        turn_pair(turn, &mut x, &mut y);
        (g[(r, i)], g[(r, j)]) = (x, y);
    }
}

/// cos and sin of θ = t·m_k/J_k.
#[inline(always)]
fn angle<S: Trig>(inverse_inertia: S, t: S, m_k: S) -> (S, S) {
    let (s, c) = (t * inverse_inertia * m_k).sin_cos();
    (c, s)
}

/// A body whose flow about an axis has the axis as a constant. An index that the compiler does not know costs more than
/// the arithmetic.
trait TurnsAbout<S>: FreeBody {
    fn turn_about<const K: usize>(&self, t: S, y: &mut PointOf<Self>);
}

impl<S: Trig> TurnsAbout<S> for RigidBody<S> {
    #[inline(always)]
    fn turn_about<const K: usize>(&self, t: S, m: &mut Vector3<S>) {
        let turn = angle(RigidBody::inverse_inertia(self)[K], t, m[K]);
        turn_momentum::<S, K>(m, turn);
    }
}

impl<S: Trig> TurnsAbout<S> for RigidBodyAttitude<S> {
    /// m_k is the product of column k of g with m_s, so the whole momentum is not needed.
    #[inline(always)]
    fn turn_about<const K: usize>(&self, t: S, g: &mut Matrix3<S>) {
        let m_s = self.momentum_space();
        let m_k = g[(0, K)] * m_s[0] + g[(1, K)] * m_s[1] + g[(2, K)] * m_s[2];
        turn_frame::<S, K>(g, angle(self.body().inverse_inertia()[K], t, m_k));
    }
}

impl<S: Trig> TurnsAbout<S> for RigidBodyState<S> {
    #[inline(always)]
    fn turn_about<const K: usize>(&self, t: S, y: &mut BodyState<S>) {
        let turn = angle(self.body().inverse_inertia()[K], t, y.m[K]);
        turn_momentum::<S, K>(&mut y.m, turn);
        turn_frame::<S, K>(&mut y.g, turn);
    }
}

macro_rules! split {
    ($($body:ident),*) => {$(
        impl<S: Trig> Split for $body<S> {
            const PARTS: usize = 3;
            #[inline(always)]
            fn flow(&self, k: usize, t: S, y: &mut PointOf<Self>) {
                match k {
                    0 => self.turn_about::<0>(t, y),
                    1 => self.turn_about::<1>(t, y),
                    _ => self.turn_about::<2>(t, y),
                }
            }
        }
    )*};
}
split!(RigidBody, RigidBodyAttitude, RigidBodyState);

/// H = ½ m·J⁻¹m.
impl<S: Real> LiePoisson for RigidBody<S> {
    fn hamiltonian(&self, m: &Vector3<S>) -> S {
        self.energy(m)
    }
    #[inline]
    fn discrete_gradient(
        &self,
        a: &Vector3<S>,
        b: &Vector3<S>,
        xi: &mut Vector3<S>,
        _: (&mut Vector3<S>, &mut Vector3<S>),
        _: &mut (),
    ) {
        let mean = |i: usize| S::lit(0.5) * (a[i] + b[i]);
        *xi = self.omega(&Vector3::new(mean(0), mean(1), mean(2)));
    }
}

/// ‖g‖ (Frobenius).
fn frobenius<S: Real>(g: &Matrix3<S>) -> S {
    g.iter().fold(S::lit(0.0), |s, &x| s + x * x).sqrt()
}

impl<S: Real> Orthogonal for RigidBodyAttitude<S> {
    fn project(&self, how: Projection, g: &mut Matrix3<S>) -> Result<(), StepError> {
        orthogonalise(how, g)
    }
}

impl<S: Real> Orthogonal for RigidBodyState<S> {
    fn project(&self, how: Projection, y: &mut BodyState<S>) -> Result<(), StepError> {
        orthogonalise(how, &mut y.g)
    }
}

/// Steps of Newton–Schulz, from a defect below 1/2; it converges quadratically.
const SCHULZ_STEPS: usize = 8;

/// g ← its orthogonal factor.
///
/// Newton–Schulz g ← g − ½ g(gᵀg − 𝟙) in residual form, whose last step leaves at most the rounding of one product; or
/// Gram–Schmidt on the columns, twice.
fn orthogonalise<S: Real>(how: Projection, g: &mut Matrix3<S>) -> Result<(), StepError> {
    let group = So3::<S>::new();
    let far =
        StepError::OutsideChart { map: "projection", what: "‖gᵀg − 𝟙‖ is above 1/2" };
    if !group.defect(g).all_below(0.5) {
        return Err(far);
    }
    match how {
        Projection::Polar => {
            for _ in 0..SCHULZ_STEPS {
                let (mut gram, mut change) = (group.identity(), group.identity());
                group.compose(&g.transpose(), g, &mut gram);
                for i in 0..3 {
                    gram[(i, i)] -= S::lit(1.0);
                }
                group.compose(g, &gram, &mut change);
                for (x, d) in g.iter_mut().zip(&change) {
                    *x -= S::lit(0.5) * *d;
                }
                if frobenius(&gram).all_below(S::EPSILON.sqrt().min(1e-8)) {
                    break;
                }
            }
        }
        Projection::Qr => {
            for _ in 0..2 {
                for j in 0..3 {
                    for i in 0..j {
                        let dot = column_dot(g, i, j);
                        for r in 0..3 {
                            let q = g[(r, i)];
                            g[(r, j)] -= dot * q;
                        }
                    }
                    let scale = S::lit(1.0) / column_dot(g, j, j).sqrt();
                    for r in 0..3 {
                        g[(r, j)] = g[(r, j)] * scale;
                    }
                }
            }
        }
    }
    Ok(())
}

#[inline]
fn column_dot<S: Real>(g: &Matrix3<S>, i: usize, j: usize) -> S {
    g[(0, i)] * g[(0, j)] + g[(1, i)] * g[(1, j)] + g[(2, i)] * g[(2, j)]
}
