//! Simo and Wong's energy and momentum conserving method for the free rigid body.
//!
//! g⁺ = g cay(ζ), m⁺ = cay(−ζ) m, ζ = k(ζ̄) ζ̄, ζ̄ = (h/2) J⁻¹(m + m⁺),
//! k = tan(|ζ̄|/2)/(|ζ̄|/2), for which cay(ζ) = exp(ζ̄); or k = 1.
//!
//! Implicit in m⁺: F(x) = x − m + ½ k ζ̄ × (x + m) = 0 by Newton's iteration from x = m.
//! Converges for h|m|/min J ≤ 1.6 (k = tan) and ≤ 4.7 (k = 1), whatever the direction of m; beyond
//! that not for every m. Order 2, symmetric. Preserves: energy and momentum to rounding, for any k,
//! and the group; with k = 1 also the symplectic structure. Cost: 3 to 6 Newton iterations of one
//! 3×3 solve each (with one sine-cosine pair for k = tan), one cay.
//! Source: J. C. Simo & K. K. Wong, Int. J. Numer. Methods Eng. 31 (1991); k = 1 is the midpoint
//! rule of M. A. Austin, P. S. Krishnaprasad & L.-S. Wang, J. Comput. Phys. 107 (1993). In the paper
//! (5.1) the norms in k are lost in print.

use nalgebra::{Matrix3, Vector3};

use super::newton::newton3;
use super::{Method, Step, Symmetric};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, LieGroup, So3, cross};
use crate::maps::{Cay, CoordinateMap};
use crate::problems::{Frame, FreeBody, PointOf, ScalarOf};
use crate::scalar::{Real, Trig};

/// The function k of Simo and Wong's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Factor {
    Tan,
    One,
}

/// Simo and Wong's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimoWong(Factor);

impl SimoWong {
    /// k = tan(|ζ̄|/2)/(|ζ̄|/2), as in the paper: the increment is exp(ζ̄).
    pub const TAN: SimoWong = SimoWong(Factor::Tan);
    /// k = 1: the increment is cay(ζ̄).
    pub const ONE: SimoWong = SimoWong(Factor::One);
}

impl Symmetric for SimoWong {}

impl Factor {
    /// k and dk/dζ̄ = k₁ζ̄, by |ζ̄|². k₁ stands in the Jacobian only, multiplied by |ζ̄|²: what cancels
    /// in it at small |ζ̄| does not matter.
    #[inline(always)]
    fn k<S: Trig>(self, square: S) -> (S, S) {
        let l = S::lit;
        match self {
            Factor::One => (l(1.0), l(0.0)),
            Factor::Tan => {
                let [k, k1] = square.branch(
                    1e-16,
                    || [l(1.0) + square * l(1.0 / 12.0), l(1.0 / 6.0)],
                    || {
                        let half = l(0.5) * square.sqrt();
                        let (s, c) = half.sin_cos();
                        let tan = s / c;
                        let k = tan / half;
                        [k, (l(1.0) + tan * tan - k) / square]
                    },
                );
                (k, k1)
            }
        }
    }
    fn name(self) -> &'static str {
        match self {
            Factor::Tan => "simo-wong",
            Factor::One => "simo-wong-k1",
        }
    }
}

#[inline(always)]
fn scaled<S: Real>(a: S, j: &Vector3<S>, x: &Vector3<S>) -> Vector3<S> {
    Vector3::new(a * j[0] * x[0], a * j[1] * x[1], a * j[2] * x[2])
}

impl SimoWong {
    /// ζ of the step from m.
    #[inline(always)]
    fn zeta<S: Trig>(
        self,
        inverse_inertia: &Vector3<S>,
        h: S,
        m: &Vector3<S>,
    ) -> Result<Vector3<S>, StepError> {
        let half = S::lit(0.5);
        let norm = So3::new().norm(m);
        let scale = if norm == S::lit(0.0) { S::lit(1.0) } else { norm };
        let zeta_bar = |x: &Vector3<S>| {
            let sum = Vector3::new(x[0] + m[0], x[1] + m[1], x[2] + m[2]);
            (sum, scaled(half * h, inverse_inertia, &sum))
        };
        let square = |z: &Vector3<S>| z[0] * z[0] + z[1] * z[1] + z[2] * z[2];
        let x = newton3(self.0.name(), *m, scale, |x| {
            let (sum, z) = zeta_bar(x);
            let (k, k1) = self.0.k(square(&z));
            let turn = cross(&z, &sum);
            let half_k = half * k;
            let mut residual = *x;
            let mut jacobian = Matrix3::from_element(S::lit(0.0));
            // ∂ζ̄/∂x = (h/2)J⁻¹ = diag(d); F' = 𝟙 + ½k(ẑ − ŝ diag d) + ½k₁ (ζ̄×s)(ζ̄ᵀ diag d).
            for j in 0..3 {
                let d = half * h * inverse_inertia[j];
                for i in 0..3 {
                    jacobian[(i, j)] = half * k1 * turn[i] * z[j] * d;
                }
                let (p, q) = ((j + 1) % 3, (j + 2) % 3);
                // Column j of ẑ is z × e_j: +z_q at p, −z_p at q.
                jacobian[(j, j)] += S::lit(1.0);
                jacobian[(p, j)] += half_k * (z[q] - d * sum[q]);
                jacobian[(q, j)] -= half_k * (z[p] - d * sum[p]);
                residual[j] = (x[j] - m[j]) + half_k * turn[j];
            }
            (residual, jacobian)
        })?;
        let (_, z) = zeta_bar(&x);
        let (k, _) = self.0.k(square(&z));
        Ok(Vector3::new(k * z[0], k * z[1], k * z[2]))
    }
}

impl<P: FreeBody> Method<P> for SimoWong
where
    ScalarOf<P>: Trig,
{
    type Work = ();

    fn order(&self, _: &P) -> usize {
        2
    }
    fn work(&self, _: &P, _: &PointOf<P>) -> Result<(), Error> {
        Ok(())
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        (): &mut (),
    ) -> Result<(), StepError> {
        let (m, frame) = problem.load(y);
        let zeta = self.zeta(problem.inverse_inertia(), h, &m)?;
        turn_body(problem, &Cay, &mut (), &zeta, m, frame, y)
    }
}

/// m ← Ψ(u)ᵀm, g ← gΨ(u), into y.
#[inline(always)]
pub(super) fn turn_body<S: Real, P: FreeBody, Psi: CoordinateMap<So3<S>>>(
    problem: &P,
    psi: &Psi,
    at: &mut Psi::At,
    u: &Vector3<S>,
    m: Vector3<S>,
    mut frame: P::Frame,
    y: &mut PointOf<P>,
) -> Result<(), StepError>
where
    P::Group: LieAlgebra<Scalar = S>,
{
    let group = So3::new();
    let mut turn = group.identity();
    psi.psi(&group, u, at, &mut turn)?;
    turn_by(problem, &turn, m, &mut frame, y)
}

/// m ← Ψᵀm, g ← gΨ, into y.
#[inline(always)]
pub(super) fn turn_by<S: Real, P: FreeBody>(
    problem: &P,
    turn: &Matrix3<S>,
    m: Vector3<S>,
    frame: &mut P::Frame,
    y: &mut PointOf<P>,
) -> Result<(), StepError>
where
    P::Group: LieAlgebra<Scalar = S>,
{
    let group = So3::new();
    let mut next = m;
    group.apply(&turn.transpose(), &m, &mut next);
    if !group.is_finite(&next) {
        return Err(StepError::NotFinite { what: "the body momentum" });
    }
    frame.turn(turn);
    problem.store(&next, frame, y);
    Ok(())
}
