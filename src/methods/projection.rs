//! Projection onto the group after each step of any method on the entries of the matrix.
//!
//! y ← π(Φ_h(y)) with π the factor Q of g = QR, or the orthogonal polar factor, the nearest
//! orthogonal matrix ([`Projection`]). Order: that of Φ, because π moves the point by at most a
//! constant times its distance from the group. Preserves: only the group, to rounding. Example: the momentum gm of a body
//! drifts. Cost: that of Φ and the projection (polar: 2 to 3 Newton–Schulz
//! steps of two products; QR: Gram–Schmidt twice).
//! Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.4; Celledoni & Owren, 1.

use super::{Embedded, Facts, Method, Step};
use crate::error::{Error, StepError};
use crate::problems::{Orthogonal, PointOf, Projection, ScalarOf};
use crate::space::Metric;
use crate::tolerance::Tolerance;

/// A method followed by a projection.
///
/// ```
/// use lieflow::methods::{ProjectionMethod, Rk, tableau::RK4};
/// use lieflow::problems::{Projection, RigidBodyAttitude};
/// use lieflow::{LieGroup, Problem, SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Matrix3;
///
/// let body = RigidBodyAttitude::<f64>::new([1.0, 2.0, 3.0], [0.2, 0.5, 3.0])?;
/// let method = ProjectionMethod::new(Rk(RK4), Projection::Polar);
/// let (grid, mut g) = (TimeGrid::new([0.0, 10.0], 0.1)?, Matrix3::identity());
/// integrate(&body, &method, &grid, &SaveAt::Ends, &mut g, |_, _| {})?;
/// assert!(body.group().defect(&g) < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectionMethod<M> {
    base: M,
    how: Projection,
}

impl<M> ProjectionMethod<M> {
    /// Makes the method.
    pub const fn new(base: M, how: Projection) -> Self {
        ProjectionMethod { base, how }
    }
}

/// The workspace of the base method, and the state.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct ProjectionWork<P: Orthogonal, M: Method<P>> {
    base: M::Work,
    z: PointOf<P>,
}

impl<P: Orthogonal, M: Method<P>> Method<P> for ProjectionMethod<M> {
    type Work = ProjectionWork<P, M>;

    fn facts(&self, problem: &P) -> Facts {
        Facts { stays_on_manifold: true, ..self.base.facts(problem) }
    }
    fn iterations(&self, work: &Self::Work) -> u64 {
        self.base.iterations(&work.base)
    }
    fn reused(&self, work: &Self::Work) -> u64 {
        self.base.reused(&work.base)
    }
    fn forget(&self, work: &mut Self::Work) {
        self.base.forget(&mut work.base);
    }
    fn each_memory(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        self.base.each_memory(&mut work.base, each);
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok(ProjectionWork { base: self.base.work(problem, like)?, z: like.clone() })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        ProjectionWork { base, z }: &mut Self::Work,
    ) -> Result<(), StepError> {
        z.assign(y);
        self.base.step(problem, step, z, base)?;
        problem.project(self.how, z)?;
        core::mem::swap(y, z);
        Ok(())
    }
    fn prepare(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        to: &PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        self.base.prepare(problem, step, from, to, &mut work.base)
    }
    fn interpolate(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        work: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.base.interpolate(problem, step, theta, from, &mut work.base, at)?;
        problem.project(self.how, at)
    }
}

/// The estimate is that of the base method before the projection. The projection moves the point by no more than that.
impl<P: Orthogonal, M: Embedded<P>> Embedded<P> for ProjectionMethod<M> {
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        let ratio =
            self.base.step_with_error(problem, step, tolerance, from, &mut work.base, to)?;
        problem.project(self.how, to)?;
        Ok(ratio)
    }
}
