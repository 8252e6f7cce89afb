//! The continuous solution of a run.

use super::integrator::Integrator;
use super::output::Kept;
use super::solution::Solution;
use super::stats::RunError;
use crate::error::Error;
use crate::methods::Method;
use crate::problems::{PointOf, Problem};

/// The continuous solution of a run: a point on M for every time of its span.
///
/// It stores the start of each step. Ask for times in order: a time within another step than the time before costs this
/// step once more. Times within one step cost only the dense output of the method.
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use lieflow::nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let method = Rkmk::new(DOPRI5, Exp);
/// let mut run = Solve::new(&body, &method, [0.0, 10.0])
///     .tolerances(1e-9, 1e-12)
///     .run_continuous(Vector3::new(0.2, 0.0, 3.0))?;
/// let m: &Vector3<f64> = run.at(std::f64::consts::PI)?;
/// assert!((m.norm() - 9.04f64.sqrt()).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct Continuous<'a, P: Problem, M: Method<P>> {
    /// The result of the run.
    pub solution: Solution<PointOf<P>>,
    steps: Vec<Kept<PointOf<P>>>,
    run: Integrator<'a, P, M>,
    /// The step that is in the workspace.
    current: Option<usize>,
    at: PointOf<P>,
}

impl<'a, P: Problem, M: Method<P>> Continuous<'a, P, M> {
    pub(super) fn new(
        solution: Solution<PointOf<P>>,
        steps: Vec<Kept<PointOf<P>>>,
        run: Integrator<'a, P, M>,
    ) -> Self {
        let at = solution.y.clone();
        Continuous { solution, steps, run, current: None, at }
    }

    /// The first and the last time of the solution.
    pub fn t_span(&self) -> [f64; 2] {
        let start = self.steps.first().map_or(self.solution.t, |([from, _], ..)| *from);
        [start, self.solution.t]
    }

    /// The point at t.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a t outside the span, [`RunError::Within`] where the point cannot be computed.
    pub fn at(&mut self, t: f64) -> Result<&PointOf<P>, RunError> {
        let [start, end] = self.t_span();
        if !(start.min(end) <= t && t <= start.max(end)) {
            let expected = format!("within [{start}, {end}]");
            return Err(Error::out_of_range("t", t, expected).into());
        }
        if t == end {
            return Ok(&self.solution.y);
        }
        let forward = end >= start;
        // The first step that ends after t.
        let index = self
            .steps
            .partition_point(|([_, end], ..)| if forward { *end <= t } else { *end >= t });
        let Some((_, step, from)) = self.steps.get(index) else { return Ok(&self.solution.y) };
        if self.current != Some(index) {
            self.run.look_at(*step, from);
            self.current = Some(index);
        }
        self.run.within(t, &mut self.at)?;
        Ok(&self.at)
    }
}
