//! The Lie-series (Taylor) method of order 4 to 16 for the free rigid body.
//!
//! The body frame turns by Ψ(t), Ψ' = Ψ ω̂, Ψ(0) = 𝟙. With Ψ as the rotation of a quaternion q both fields are
//! quadratic. Their Taylor coefficients follow by recurrence:
//!
//! (k+1) m_{k+1} = Σ_j m_j × ω_{k−j}, ω_k = J⁻¹m_k, 2(k+1) q_{k+1} = Σ_j q_j ∘ ω_{k−j}.
//!
//! q(h) is cut after the power N and normalised, which changes it by less than the terms left out. So Ψ(h) is a rotation,
//! m⁺ = Ψᵀm, g⁺ = gΨ. Order N. Preserves: |m|, gm and the group to rounding; the energy, symplectic structure and
//! symmetry to the size of the terms left out. Cost: about 15N²/2 multiplications, eight at once on some machines, and
//! one division; no root and no trigonometric function.
//!
//! The last two coefficients give the step size: θ = min((tol/|q_{N−1}|)^{1/(N−1)}, (tol/|q_N|)^{1/N}).
//! [`Taylor::advance`] takes the largest step within the tolerance. It computes the step size from coefficients that it
//! needs in any case, so no step is rejected. The method is also [`Embedded`], for adaptive runs. Its series at θh is the
//! dense output, of order N at all θ. For bodies without an attitude see [`TaylorMomentum`], for other groups and fields
//! [`LieSeries`](super::LieSeries). Source: W. Gröbner, Die Lie-Reihen und ihre Anwendungen (1960); À. Jorba
//! & M. Zou, Experiment. Math. 14 (2005), for the step.

mod lanes;
mod momentum;
mod series;

use nalgebra::Vector3;

pub use lanes::Wide;
pub use momentum::TaylorMomentum;
use series::{Advance, Body, OneStep, Quaternion, Terms, error, reach, rotation, square_of};

use super::embedded::ratio_of_relative;
use super::simo_wong::turn_by;
use super::{Embedded, Facts, MapCounts, Method, Step, Within};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, So3};
use crate::problems::{Frame, FreeBody, PointOf, ScalarOf};
use crate::scalar::Real;
use crate::tolerance::Tolerance;

/// The Taylor method of order N, 4 ≤ N ≤ 16. Another N does not compile.
///
/// ```compile_fail,E0080
/// use lieflow::methods::{Method, Taylor};
/// use lieflow::problems::RigidBody;
/// use lieflow::Step;
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
/// let mut m = lieflow::nalgebra::Vector3::x();
/// let mut work = Taylor::<17>.work(&body, &m).unwrap();
/// let _ = Taylor::<17>.step(&body, Step { n: 0, t: 0.0, h: 0.1 }, &mut m, &mut work);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Taylor<const N: usize>;

impl<const N: usize> Taylor<N> {
    /// The largest step from y whose local error in the attitude is about `tolerance`; infinite for a body at rest.
    ///
    /// It is computed from the last two terms at the step `h`, which may be any guess.
    pub fn largest_step<P: FreeBody>(
        &self,
        problem: &P,
        y: &PointOf<P>,
        h: f64,
        tolerance: f64,
    ) -> f64
    where
        P::Group: LieAlgebra<Scalar = f64>,
    {
        let (body, m) = (Body::new(problem.inverse_inertia()), problem.load(y).0);
        let mut terms = [[0.0; 4]; N];
        f64::dispatch(OneStep { of: Quaternion, body: &body, h, m, terms: &mut terms });
        h * reach::<N>([terms[N - 2], terms[N - 1]].map(square_of), tolerance)
    }

    /// Advances y over the time `span`. Returns the number of steps.
    ///
    /// Each step is as long as the tolerance for its local error in the attitude allows. `h` is a first guess, and
    /// becomes the last step.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a span or a guess that is not finite, a guess of 0 or a tolerance
    /// that is not positive; [`Error::Map`] with [`StepError::NotFinite`] when the state is not
    /// finite; [`StepError::NotConverged`] when the step shrinks to zero or 10⁹ steps are not enough. y
    /// is then the last good state.
    pub fn advance<P: FreeBody>(
        &self,
        problem: &P,
        span: f64,
        tolerance: f64,
        h: &mut f64,
        y: &mut PointOf<P>,
    ) -> Result<u64, Error>
    where
        P::Group: LieAlgebra<Scalar = f64>,
    {
        Error::finite("span", span)?;
        if !(h.is_finite() && *h != 0.0) {
            return Err(Error::out_of_range("h", *h, "a finite number other than 0"));
        }
        Error::positive("tolerance", tolerance)?;
        let (m, mut frame) = problem.load(y);
        let body = Body::new(problem.inverse_inertia());
        let guess = h.abs().copysign(span);
        let reached = f64::dispatch(Advance::<N> { body: &body, span, tolerance, guess, m });
        frame.turn(&rotation(reached.q));
        problem.store(&reached.m, &frame, y);
        *h = reached.h;
        match reached.failed {
            None => Ok(reached.steps),
            Some(error) => Err(error.into()),
        }
    }
}

/// The facts of a Taylor series of order n.
fn facts_of(n: usize) -> Facts {
    let facts = Facts::of_order(n).cost(Some(n as u64), MapCounts::default());
    facts.estimate("", Some(n - 1)).dense(n, 0)
}

/// The terms of a step, for the points within it.
#[derive(Clone, Debug)]
pub struct TaylorWork<S, const N: usize>(Terms<S, Quaternion, N>);

impl<P: FreeBody, const N: usize> Method<P> for Taylor<N>
where
    ScalarOf<P>: Wide,
{
    type Work = TaylorWork<ScalarOf<P>, N>;

    fn facts(&self, _: &P) -> Facts {
        facts_of(N)
    }
    fn work(&self, _: &P, _: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok(TaylorWork(Terms::new(Quaternion)))
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (m, mut frame) = problem.load(y);
        let q = work.0.step(problem.inverse_inertia(), h, m);
        turn_by(problem, &rotation(q), m, &mut frame, y)
    }
    /// The last step has its terms. Those of another one are computed.
    fn prepare(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        _: &PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        let m = problem.load(from).0;
        if !work.0.is_of(h, &m) {
            work.0.step(problem.inverse_inertia(), h, m);
        }
        Ok(())
    }
    /// The series at θh.
    fn interpolate(
        &self,
        problem: &P,
        _: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        work: &mut Self::Work,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let (m, mut frame) = problem.load(from);
        let q = work.0.at(&m, Real::lit(theta));
        turn_by(problem, &rotation(q), m, &mut frame, y)
    }
    fn within(&self, _: &Self::Work) -> Within {
        Within::Series
    }
    fn each_term(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        work.0.each_term(each);
    }
}

/// The error of a step follows from its last two terms. It is twice that of the quaternion.
impl<P: FreeBody, const N: usize> Embedded<P> for Taylor<N>
where
    ScalarOf<P>: Wide + Into<f64>,
{
    fn step_with_error(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        let (m, mut frame) = problem.load(from);
        let j = problem.inverse_inertia();
        let q = work.0.step(j, h, m);
        turn_by(problem, &rotation(q), m, &mut frame, to)?;
        // The angle is twice that of the quaternion.
        let error = 2.0 * error(&work.0.terms, 1.0);
        let omega = Vector3::new(j[0] * m[0], j[1] * m[1], j[2] * m[2]);
        let length = h.abs() * So3::new().norm(&omega);
        Ok(ratio_of_relative(tolerance, Real::lit(error), from, length))
    }
}
