//! The driver in one call, which changes a state in place.

use super::grid::{SaveAt, TimeGrid};
use super::solution::Interrupted;
use super::stats::{RunError, Stats};
use super::{Solve, StepControl};
use crate::methods::{Embedded, Method};
use crate::problems::{PointOf, Problem, ScalarOf};

/// Integrates `problem` from y over `grid` with a fixed step size. It is [`Solve`] in one call.
///
/// `observe` is called with (t, y) at the points of `save`. On return y is the state at the end, or the last accepted
/// one.
///
/// Rounding errors move g off its group, and a vector off its sphere, by some ε a step. For methods that stay on M the
/// driver corrects this every [`RESTORE_EVERY`](super::RESTORE_EVERY) steps, or more often if the state drifts faster
/// ([`Action::restore_to`](crate::Action::restore_to)).
///
/// Memory is allocated only before the first step.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::RigidBody;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let mut m = Vector3::new(0.2, 0.0, 3.0);
/// let start = body.energy(&m);
/// let grid = TimeGrid::new([0.0, 10.0], 0.05)?;
/// integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((body.energy(&m) - start).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RunError::Setup`] before anything is observed; [`RunError::Step`] for a step that failed.
pub fn integrate<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    grid: &TimeGrid,
    save: &SaveAt,
    y: &mut PointOf<P>,
    observe: impl FnMut(f64, &PointOf<P>),
) -> Result<Stats, RunError> {
    in_place(Solve::new(problem, method, grid.t_span()).grid(*grid).save(save.clone()), y, observe)
}

/// Integrates `problem` from y over `t_span` with an adaptive step size. It is [`Solve`] in one call.
///
/// `control` has the tolerances. `observe` is called with (t, y) at the points of `save`. On return y is the state at the
/// end, or the last accepted one.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::DOPRI5};
/// use lieflow::problems::RigidBody;
/// use lieflow::{SaveAt, StepControl, integrate_adaptive};
/// use lieflow::nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let mut m = Vector3::new(0.2, 0.0, 3.0);
/// let start = body.energy(&m);
/// let (method, control) = (Rkmk::new(DOPRI5, Exp), StepControl::new(1e-9, 1e-12)?);
/// let stats =
///     integrate_adaptive(&body, &method, [0.0, 10.0], &control, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((body.energy(&m) - start).abs() < 1e-7);
/// assert!(stats.rejected <= stats.accepted / 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RunError::Setup`] for wrong arguments, before anything is observed. Other errors if no step succeeds within 60
/// attempts or above the smallest step, or if the attempts run out.
pub fn integrate_adaptive<P: Problem, M: Embedded<P>>(
    problem: &P,
    method: &M,
    t_span: [f64; 2],
    control: &StepControl,
    save: &SaveAt,
    y: &mut PointOf<P>,
    observe: impl FnMut(f64, &PointOf<P>),
) -> Result<Stats, RunError>
where
    ScalarOf<P>: Into<f64>,
{
    let solve = Solve::new(problem, method, t_span).control(control.clone()).save(save.clone());
    in_place(solve, y, observe)
}

fn in_place<P: Problem, M: Method<P>>(
    solve: Solve<'_, P, M>,
    y: &mut PointOf<P>,
    mut observe: impl FnMut(f64, &PointOf<P>),
) -> Result<Stats, RunError> {
    match solve.run_with(y.clone(), |t, y| observe(t, y)) {
        Ok(solution) => {
            *y = solution.y;
            Ok(solution.stats)
        }
        Err(Interrupted { error, solution }) => {
            if let Some(solution) = solution {
                *y = solution.y;
            }
            Err(error)
        }
    }
}
