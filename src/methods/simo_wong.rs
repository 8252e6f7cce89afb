//! Simo and Wong's energy and momentum conserving method for the free rigid body.
//!
//! g⁺ = g cay(ζ), m⁺ = cay(−ζ) m, ζ = k ζ̄, ζ̄ = (h/2) J⁻¹s, s = m + m⁺, with a scalar k:
//!
//! | | k | order | converges for h\|m\|/min J |
//! |---|---|---|---|
//! | [`TAN`](SimoWong::TAN) | tan(\|ζ̄\|/2)/(\|ζ̄\|/2), for which cay(ζ) = exp(ζ̄) | 2 | ≤ 1.6 |
//! | [`ONE`](SimoWong::ONE) | 1, the midpoint rule | 2 | ≤ 4.7 |
//! | [`LEWIS_SIMO`](SimoWong::LEWIS_SIMO) | 1 − (h²/48) Σ_i c_j c_k s_i², c_i = 1/J_k − 1/J_j | 4 in m, 2 in g | ≤ 1.6 |
//!
//! The method is implicit in m⁺. Newton's iteration from x = m solves F(x) = x − m + ½ k ζ̄ × (x + m) = 0. Within the
//! limits above it converges for every direction of m. Beyond them it may fail for some m with
//! [`StepError::NewtonDidNotConverge`].
//!
//! Any k that is symmetric in m and m⁺ conserves energy and |m|. On the orbit it only changes the time, h to kh. The
//! modified equation of the midpoint rule, up to h⁴, is m' = (1 + (h²/12) Σ_i c_j c_k m_i²) m × J⁻¹m. This is a change
//! of time, too, and the third k undoes it. Lewis and Simo gain accuracy by this k; here it is derived for a body with
//! principal axes. The attitude also turns about the momentum, by an angle that a scalar k cannot correct.
//!
//! Symmetric. Preserves: the group, and energy and momentum to rounding, for any k. It does not preserve the symplectic
//! structure, since the change of time varies along the orbit. Cost: 3 to 6 Newton iterations of one 3×3 solve each (with one sine-cosine pair for the first k), one cay.
//! Source: J. C. Simo & K. K. Wong, Int. J. Numer. Methods Eng. 31 (1991); k = 1 is the midpoint
//! rule of M. A. Austin, P. S. Krishnaprasad & L.-S. Wang, J. Comput. Phys. 107 (1993); D. Lewis &
//! J. C. Simo, J. Nonlinear Sci. 4 (1994). In the paper (5.1) the norms in k are missing in print.

use nalgebra::{Matrix3, Vector3};

use super::newton::newton3;
use super::{Facts, MapCounts, Method, Step, Symmetric};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, LieGroup, So3};
use crate::maps::{Cay, CoordinateMap};
use crate::problems::{Frame, FreeBody, PointOf, ScalarOf};
use crate::scalar::{Real, Trig};
use crate::so3::cross;

/// The function k of Simo and Wong's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Factor {
    Tan,
    One,
    LewisSimo,
}

/// Simo and Wong's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimoWong(Factor);

impl SimoWong {
    /// k = tan(|ζ̄|/2)/(|ζ̄|/2), as in the paper: the increment is exp(ζ̄).
    pub const TAN: SimoWong = SimoWong(Factor::Tan);
    /// k = 1: the increment is cay(ζ̄).
    pub const ONE: SimoWong = SimoWong(Factor::One);
    /// The k for which the momentum is of order 4.
    pub const LEWIS_SIMO: SimoWong = SimoWong(Factor::LewisSimo);
}

impl Symmetric for SimoWong {}

impl Factor {
    /// k and its gradient by x, from s = x + m and ζ̄.
    #[inline(always)]
    fn k<S: Trig>(self, j: &Vector3<S>, h: S, s: &Vector3<S>, z: &Vector3<S>) -> (S, Vector3<S>) {
        let l = S::lit;
        match self {
            Factor::One => (l(1.0), Vector3::new(l(0.0), l(0.0), l(0.0))),
            Factor::Tan => {
                let square = z[0] * z[0] + z[1] * z[1] + z[2] * z[2];
                // dk/dζ̄ = k₁ζ̄. k₁ stands multiplied by |ζ̄|²: what cancels in it at small |ζ̄| does
                // not matter.
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
                (k, scaled(l(0.5) * h * k1, j, z))
            }
            Factor::LewisSimo => {
                let c = [j[2] - j[1], j[0] - j[2], j[1] - j[0]];
                let weights = Vector3::new(c[1] * c[2], c[2] * c[0], c[0] * c[1]);
                // h² may leave the range where hs does not.
                let hs = Vector3::new(h * s[0], h * s[1], h * s[2]);
                let slope = scaled(h * l(-1.0 / 24.0), &weights, &hs);
                let sum = slope[0] * s[0] + slope[1] * s[1] + slope[2] * s[2];
                (l(1.0) + l(0.5) * sum, slope)
            }
        }
    }
    fn name(self) -> &'static str {
        match self {
            Factor::Tan => "simo-wong",
            Factor::One => "simo-wong-k1",
            Factor::LewisSimo => "lewis-simo",
        }
    }
}

#[inline(always)]
fn scaled<S: Real>(a: S, j: &Vector3<S>, x: &Vector3<S>) -> Vector3<S> {
    Vector3::new(a * j[0] * x[0], a * j[1] * x[1], a * j[2] * x[2])
}

impl SimoWong {
    /// ζ of the step from m; Newton's iterations are added to `iterations`.
    #[inline(always)]
    fn zeta<S: Trig>(
        self,
        j: &Vector3<S>,
        h: S,
        m: &Vector3<S>,
        iterations: &mut u64,
    ) -> Result<Vector3<S>, StepError> {
        let half = S::lit(0.5);
        // Without squares, which leave the range where |m| does not.
        let size = m[0].abs() + m[1].abs() + m[2].abs();
        let scale = if size == S::lit(0.0) { S::lit(1.0) } else { size };
        let zeta_bar = |x: &Vector3<S>| {
            let sum = Vector3::new(x[0] + m[0], x[1] + m[1], x[2] + m[2]);
            (sum, scaled(half * h, j, &sum))
        };
        let x = newton3(self.0.name(), *m, scale, iterations, |x| {
            let (sum, z) = zeta_bar(x);
            let (k, slope) = self.0.k(j, h, &sum, &z);
            let turn = cross(&z, &sum);
            let half_k = half * k;
            let mut residual = *x;
            let mut jacobian = Matrix3::from_element(S::lit(0.0));
            // ∂ζ̄/∂x = (h/2)J⁻¹ = diag(d); F' = 𝟙 + ½k(ẑ − ŝ diag d) + ½(ζ̄×s)(∂k/∂x)ᵀ.
            for l in 0..3 {
                let d = half * h * j[l];
                for i in 0..3 {
                    jacobian[(i, l)] = half * turn[i] * slope[l];
                }
                let (p, q) = ((l + 1) % 3, (l + 2) % 3);
                // Column l of ẑ is z × e_l: +z_q at p, −z_p at q.
                jacobian[(l, l)] += S::lit(1.0);
                jacobian[(p, l)] += half_k * (z[q] - d * sum[q]);
                jacobian[(q, l)] -= half_k * (z[p] - d * sum[p]);
                residual[l] = (x[l] - m[l]) + half_k * turn[l];
            }
            (residual, jacobian)
        })?;
        let (sum, z) = zeta_bar(&x);
        let (k, _) = self.0.k(j, h, &sum, &z);
        Ok(Vector3::new(k * z[0], k * z[1], k * z[2]))
    }
}

impl<P: FreeBody> Method<P> for SimoWong
where
    ScalarOf<P>: Trig,
{
    /// The iterations so far.
    type Work = u64;

    fn facts(&self, _: &P) -> Facts {
        let order = if self.0 == Factor::LewisSimo && !P::Frame::TURNS { 4 } else { 2 };
        Facts::of_order(order).cost(None, MapCounts { psi: 1, ..MapCounts::default() })
    }
    fn iterations(&self, work: &u64) -> u64 {
        *work
    }
    fn work(&self, _: &P, _: &PointOf<P>) -> Result<u64, Error> {
        Ok(0)
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        iterations: &mut u64,
    ) -> Result<(), StepError> {
        let (m, frame) = problem.load(y);
        let zeta = self.zeta(problem.inverse_inertia(), h, &m, iterations)?;
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
