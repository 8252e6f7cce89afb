//! The exact motion of the free rigid body as a method: any step is exact to rounding.
//!
//! From the momentum m at the start, m⁺ = m(h) and g⁺ = g Ψ(h) by Jacobi's elliptic functions
//! ([`Exact`]). Order: unbounded, reported as `usize::MAX`. Preserves: everything, to the
//! rounding of a step, whose phase does not drift in steps of one size. Cost: the constants of one orbit and its point at
//! two times, at any h; further points from the same start, as the output times within a step, need no new constants. It
//! computes in f64 for every scalar type. To follow one orbit without a run use [`Exact`].
//! Source: C. G. J. Jacobi, J. reine angew. Math. 39 (1850); see [`Exact`].

use nalgebra::{Matrix3, Vector3};

use super::{Embedded, Facts, MapCounts, Method, Step, Symmetric};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, So3};
use crate::problems::{Exact, Frame, FreeBody, Place, PointOf, ScalarOf};
use crate::scalar::{Real, power_of_two};
use crate::space::Metric;
use crate::tolerance::Tolerance;

/// The exact motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactMotion;

impl Symmetric for ExactMotion {}

/// The moments of inertia, and the orbit of the last step.
#[derive(Clone, Debug)]
pub struct ExactWork {
    inertia: [f64; 3],
    /// The momentum at the start of that step.
    start: Vector3<f64>,
    orbit: Exact,
    /// Its place at the start, as the formulas give it.
    origin: Option<Place>,
}

impl ExactWork {
    /// The change of the momentum over a time h from this momentum, and D with the rotation 𝟙 + D over that time.
    #[inline]
    fn moved(
        &mut self,
        start: Vector3<f64>,
        h: f64,
    ) -> Result<(Vector3<f64>, Matrix3<f64>), Error> {
        if self.start != start {
            self.orbit = Exact::new(self.inertia, start.into(), Matrix3::identity())?;
            self.origin = self.orbit.place(0.0)?;
            self.start = start;
        }
        self.orbit.change(self.origin.as_ref(), h)
    }

    /// This change of `old` with the length and the energy of `old`, by a step of Newton's iteration. `old` is about 1 long.
    ///
    /// The energy is taken relative to that of a rotation about the axis of the largest component. All differences are those
    /// over the step, so that their rounding is relative to it.
    #[inline]
    fn change(&self, old: &Vector3<f64>, change: Vector3<f64>) -> Vector3<f64> {
        let new = old + change;
        let gone = -change.component_mul(&(old + new));
        let squared = new.norm_squared();
        let axis = self.inertia[new.iamax()];
        let rates = Vector3::from(self.inertia).map(|inertia| (axis - inertia) / inertia);
        let mean = rates.dot(&new.component_mul(&new)) / squared;
        let rates = rates.add_scalar(-mean);
        let across = new.component_mul(&rates);
        let steep = across.norm_squared();
        let along = new * (0.5 * gone.sum() / squared);
        let across = if steep > 0.0 { across * (0.5 * gone.dot(&rates) / steep) } else { across };
        change + (along + across)
    }
}

/// D with a rotation 𝟙 + D that takes m to m + change = (𝟙 + D)ᵀ m. Its rounding is relative to D.
#[inline]
fn corrected(d: Matrix3<f64>, m: &Vector3<f64>, change: &Vector3<f64>) -> Matrix3<f64> {
    let off = d + d.transpose() + d.tr_mul(&d);
    let d = d - (off + d * off) * 0.5;
    let gap = (d.tr_mul(m) - change).cross(&(m + change)) / m.norm_squared();
    let gap = gap.cross_matrix();
    d - (gap + d * gap)
}

impl<P: FreeBody> Method<P> for ExactMotion
where
    ScalarOf<P>: Into<f64>,
{
    type Work = ExactWork;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(usize::MAX).cost(None, MapCounts::default()).estimate("", Some(usize::MAX))
    }
    fn work(&self, problem: &P, _: &PointOf<P>) -> Result<ExactWork, Error> {
        let inertia = [0, 1, 2].map(|k| 1.0 / problem.inverse_inertia()[k].into());
        let at_rest = Vector3::zeros();
        let orbit = Exact::new(inertia, at_rest.into(), Matrix3::identity())?;
        Ok(ExactWork { inertia, start: at_rest, orbit, origin: None })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut ExactWork,
    ) -> Result<(), StepError> {
        let (m, mut frame) = problem.load(y);
        let before: Vector3<f64> = m.map(Into::into);
        let failed = StepError::NotFinite { what: "the exact motion" };
        let (change, d) = work.moved(before, h.into()).map_err(|_| failed)?;
        // Both are right to ε, but the same h rounds them the same way in every step: a step of Newton's
        // iteration each takes them back to |m| and the energy, and to the group. The rotation takes m to m⁺, as a problem
        // needs it whose state is the attitude alone.
        let size = power_of_two(before.amax());
        let (next, d) = match before / size {
            old if old.amax() == 0.0 => (before, d),
            old => {
                let change = work.change(&old, change / size);
                ((old + change) * size, corrected(d, &old, &change))
            }
        };
        let turn = Matrix3::identity() + d;
        let group = So3::<f64>::new();
        if !(group.is_finite(&next) && turn.iter().all(|x| x.is_finite())) {
            return Err(failed);
        }
        frame.turn(&turn.map(Real::lit));
        problem.store(&next.map(Real::lit), &frame, y);
        // A state that is the attitude alone has m by its rounding, and of quaternions this rounding has one sign: another turn
        // takes m to m⁺.
        let (m, mut frame) = problem.load(y);
        let m: Vector3<f64> = m.map(Into::into);
        if m != next && next.amax() > 0.0 {
            let (m, next) = (m / size, next / size);
            let turn = (next - m).cross(&m) / m.norm_squared();
            frame.turn(&(Matrix3::identity() + turn.cross_matrix()).map(Real::lit));
            problem.store(&(next * size).map(Real::lit), &frame, y);
        }
        Ok(())
    }
}

/// The error is 0 at any step size. So an adaptive run takes one step, or as many as its events need.
impl<P: FreeBody> Embedded<P> for ExactMotion
where
    ScalarOf<P>: Into<f64>,
{
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        _: &Tolerance,
        from: &PointOf<P>,
        work: &mut ExactWork,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        to.assign(from);
        self.step(problem, step, to, work)?;
        Ok(Real::lit(0.0))
    }
}
