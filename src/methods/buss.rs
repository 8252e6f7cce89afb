//! Buss's method of order 4 for the free rigid body, by the Taylor series of the angular velocity.
//!
//! g⁺ = exp(h ω̄) g in the space frame (the paper prints exp(ω̄)), here in the body frame:
//! g⁺ = g exp(h ω̄), m⁺ = exp(−h ω̄) m, where K = g J⁻¹ gᵀ is the diagonal J⁻¹, and
//!
//! ω̄ = ω + h/2 ω' + h²/6 ω'' + h²/12 ω'×ω + h³/24 ω''' + h³/24 ω''×ω;
//! with a = ω×m: ω = Km, ω' = −Ka, a' = ω'×m, b = ω×a − a', ω'' = ω×ω' + Kb,
//! b' = ω'×a + ω×a' − ω''×m, ω''' = ω×ω'' + ω×Kb + K(b' − ω×b).
//!
//! The derivatives are those of the angular velocity in space, in body axes. The two products ω×ω'' cancel, so 9 cross
//! products are enough (Buss has 10). Order 4. Preserves: |m|, gm and the group, but not the energy, the symplectic
//! structure or time symmetry. Cost: 9 cross products, 4 applications of K, one exp.
//! Source: S. R. Buss, J. Comput. Phys. 164 (2000); Celledoni & Owren 5.1, with the factor h restored.

use nalgebra::Vector3;

use super::simo_wong::turn_body;
use super::{Facts, MapCounts, Method, Step};
use crate::error::{Error, StepError};
use crate::groups::So3;
use crate::maps::{CoordinateMap, Exp};
use crate::problems::{FreeBody, PointOf, ScalarOf};
use crate::scalar::{Real, Trig};
use crate::so3::cross;

/// Buss's method of order 4, the B4 of the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Buss4;

/// (f(0), f(1), f(2)).
#[inline(always)]
fn map<S>(f: impl Fn(usize) -> S) -> Vector3<S> {
    Vector3::new(f(0), f(1), f(2))
}

/// h ω̄.
#[inline(always)]
fn increment<S: Real>(inverse_inertia: &Vector3<S>, h: S, m: &Vector3<S>) -> Vector3<S> {
    let (j, l) = (inverse_inertia, S::lit);
    let scale = |x: &Vector3<S>| Vector3::new(j[0] * x[0], j[1] * x[1], j[2] * x[2]);
    let w = scale(m);
    let a = cross(&w, m);
    let ka = scale(&a);
    let w1 = map(|i| -ka[i]);
    let a1 = cross(&w1, m);
    let wa = cross(&w, &a);
    let b = map(|i| wa[i] - a1[i]);
    let kb = scale(&b);
    let ww1 = cross(&w, &w1);
    let w2 = map(|i| ww1[i] + kb[i]);
    let (p, q, r) = (cross(&w1, &a), cross(&w, &a1), cross(&w2, m));
    let wb = cross(&w, &b);
    let c = scale(&map(|i| p[i] + q[i] - r[i] - wb[i])); // K(b' − ω×b)
    let wkb = cross(&w, &kb); // ω''' + ω''×ω = ω×Kb + K(b' − ω×b)
    let h2 = h * h;
    map(|i| {
        h * (w[i]
            + h * l(0.5) * w1[i]
            + h2 * (l(1.0 / 6.0) * w2[i] - l(1.0 / 12.0) * ww1[i])
            + h * h2 * l(1.0 / 24.0) * (wkb[i] + c[i]))
    })
}

impl<P: FreeBody> Method<P> for Buss4
where
    ScalarOf<P>: Trig,
{
    type Work = <Exp as CoordinateMap<So3<ScalarOf<P>>>>::At;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(4).cost(None, MapCounts { psi: 1, ..MapCounts::default() })
    }
    fn work(&self, _: &P, _: &PointOf<P>) -> Result<Self::Work, Error> {
        Exp.at(&So3::new())
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        at: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (m, frame) = problem.load(y);
        let u = increment(problem.inverse_inertia(), h, &m);
        turn_body(problem, &Exp, at, &u, m, frame, y)
    }
}
