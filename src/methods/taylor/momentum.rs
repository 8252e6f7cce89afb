//! The Taylor series of the momentum of a free rigid body, brought back to its sphere.
//!
//! (k+1) m_{k+1} = Σ_j m_j × J⁻¹m_{k−j}
//!
//! m(h) is cut after the power N, and brought to the length of m. That changes it by less than the terms left out.
//! Order N. Preserves: |m| to rounding; the energy, symplectic structure and symmetry to the size of the terms left out.
//! Cost: about 3N²/2 multiplications, four at once on some machines, one division and one root.
//!
//! [`Taylor`](super::Taylor) takes five times as many multiplications for the rotation of the body, so it serves bodies
//! with an attitude, too. Near the saddle small numbers of m decide. There errors of this method are a tenth to a hundredth of
//! those of `Taylor` at the same steps: each number of m has its own series, while `Taylor` takes small numbers as
//! differences of large ones.
//!
//! The last two coefficients give the error of a step. The series at θh, brought to the length of m, is the dense output,
//! of order N at all θ. Source: À. Jorba & M. Zou, Experiment. Math. 14 (2005), for the series and the step; Hairer, Lubich,
//! Wanner, Geometric Numerical Integration, IV.4, for the projection.

use nalgebra::Vector3;

use super::lanes::Wide;
use super::series::{Momentum, Terms, Unknown, error, square_of};
use super::{Embedded, Facts, Method, Step, Within, facts_of};
use crate::error::{Error, StepError};
use crate::methods::embedded::ratio_of_relative_step;
use crate::problems::{FreeBody, PointOf, ScalarOf};
use crate::scalar::{Real, larger};
use crate::so3::in_range;
use crate::space::Numbers;
use crate::tolerance::Tolerance;

/// The Taylor series of order N of the momentum, on its sphere, 4 ≤ N ≤ 16. Another N does not compile.
///
/// It serves free bodies without an attitude, such as [`RigidBody`](crate::problems::RigidBody).
///
/// ```
/// use lieflow::methods::TaylorMomentum;
/// use lieflow::problems::RigidBody;
/// use lieflow::Solve;
/// use lieflow::nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let solve = Solve::new(&body, &TaylorMomentum::<16>, [0.0, 100.0]).tolerances(1e-10, 1e-10);
/// let start = Vector3::new(0.1, 2.0, 0.3);
/// let end: Vector3<f64> = solve.run(start)?.y;
/// assert!((end.norm() - start.norm()).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TaylorMomentum<const N: usize>;

/// The terms of a step, for the points within it.
#[derive(Clone, Debug)]
pub struct MomentumWork<S, const N: usize> {
    /// The terms in units of `unit`.
    terms: Terms<S, Momentum, N>,
    /// The momentum at the start of that step, in units of `unit`.
    start: Vector3<S>,
    /// 1, or the largest number of a momentum so large or small that products of its numbers leave their range.
    unit: S,
}

impl<S: Wide, const N: usize> MomentumWork<S, N> {
    /// The sum of the series of a step of size h from the momentum m, in units of `unit`.
    #[inline(always)]
    fn step(&mut self, j: &Vector3<S>, h: S, m: Vector3<S>) -> [S; 4] {
        if !in_range(square_of(Momentum.start(&m))) {
            return self.step_in_units(j, h, m);
        }
        (self.start, self.unit) = (m, S::lit(1.0));
        self.terms.step(j, h, m)
    }

    /// The same with another unit.
    #[cold]
    fn step_in_units(&mut self, j: &Vector3<S>, h: S, m: Vector3<S>) -> [S; 4] {
        let unit = larger(larger(m[0].abs(), m[1].abs()), m[2].abs());
        // A body at rest has any unit.
        let unit = if unit == S::lit(0.0) { S::lit(1.0) } else { unit };
        (self.start, self.unit) = (m.map(|m| m / unit), unit);
        let sum = self.terms.step(&j.map(|j| j * unit), h, self.start);
        self.terms.of = Some((h, m));
        sum
    }

    /// x in units of `unit`, brought to the length of the momentum at the start.
    #[inline(always)]
    fn to_length(&self, x: [S; 4]) -> Vector3<S> {
        let start = square_of(Momentum.start(&self.start));
        if start == S::lit(0.0) {
            return self.start;
        }
        let factor = self.unit * (start / square_of(x)).sqrt();
        Vector3::new(factor * x[0], factor * x[1], factor * x[2])
    }

    /// y ← x in units of `unit`, brought to the length of the momentum at the start.
    #[inline(always)]
    fn store<P>(&self, problem: &P, x: [S; 4], y: &mut PointOf<P>) -> Result<(), StepError>
    where
        P: FreeBody<Frame = ()>,
        P::Group: crate::groups::LieAlgebra<Scalar = S>,
    {
        // Of a sum whose square is not finite the length is 0 or unknown.
        StepError::finite(square_of(x).is_finite(), "the body momentum")?;
        problem.store(&self.to_length(x), &(), y);
        Ok(())
    }
}

impl<P: FreeBody<Frame = ()>, const N: usize> Method<P> for TaylorMomentum<N>
where
    ScalarOf<P>: Wide,
{
    type Work = MomentumWork<ScalarOf<P>, N>;

    fn facts(&self, _: &P) -> Facts {
        facts_of(N)
    }
    fn work(&self, _: &P, _: &PointOf<P>) -> Result<Self::Work, Error> {
        let start = Vector3::from_element(Real::lit(0.0));
        Ok(MomentumWork { terms: Terms::new(Momentum), start, unit: Real::lit(1.0) })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        let m = problem.load(y).0;
        let sum = work.step(problem.inverse_inertia(), h, m);
        work.store(problem, sum, y)
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
        if !work.terms.is_of(h, &m) {
            work.step(problem.inverse_inertia(), h, m);
        }
        Ok(())
    }
    /// The series at θh.
    fn interpolate(
        &self,
        problem: &P,
        _: Step<ScalarOf<P>>,
        theta: f64,
        _: &PointOf<P>,
        work: &mut Self::Work,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let x = work.terms.at(&work.start, Real::lit(theta));
        work.store(problem, x, y)
    }
    fn within(&self, _: &Self::Work) -> Within {
        Within::Series
    }
    fn each_term(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        work.terms.each_term(each);
        work.start.iter_mut().for_each(|x| x.each_number(each));
        work.unit.each_number(each);
    }
}

/// The error of a step follows from its last two terms, relative to |m|.
impl<P: FreeBody<Frame = ()>, const N: usize> Embedded<P> for TaylorMomentum<N>
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
        let m = problem.load(from).0;
        let sum = work.step(problem.inverse_inertia(), h, m);
        work.store(problem, sum, to)?;
        let size = square_of(Momentum.start(&work.start)).into().sqrt();
        let error = if size > 0.0 { error(&work.terms.terms, size) / size } else { 0.0 };
        Ok(ratio_of_relative_step(tolerance, Real::lit(error), from, to))
    }
}
