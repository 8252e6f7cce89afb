//! Checks of the start of a run and of its state: is it on M, and is f in 𝔤?

use super::stats::power_of_two_above;
use crate::actions::Action;
use crate::error::Error;
use crate::groups::{LieAlgebra, OFF_M_MAX};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::{Metric, check_within_reach};
use crate::tolerance::Tolerance;

/// max(1, ‖y‖²).
pub(super) fn square_of_size<P: Problem>(y: &PointOf<P>) -> ScalarOf<P> {
    let (one, size) = (ScalarOf::<P>::lit(1.0), y.size());
    let square = size * size;
    if square.all_below(1.0) { one } else { square }
}

/// A start whose relative residual is below this many ε is on M.
pub(super) const ON_M: f64 = 1000.0;

/// Corrects y to M. Refuses a y that is farther from M than numbers with seven digits are. Returns true if y was farther
/// from M than rounding.
pub(super) fn check_on_manifold<P: Problem>(
    problem: &P,
    y: &mut PointOf<P>,
    work: &mut <P::Action as Action<P::Group>>::Work,
) -> Result<bool, Error> {
    let Some(residual) = correct_to_manifold(problem, y, work) else { return Ok(false) };
    check_residual(problem, residual)?;
    Ok(!residual.all_below(ON_M * ScalarOf::<P>::EPSILON))
}

/// Corrects y to M. Returns how far it was from there, relative to its size, where that is known.
pub(super) fn correct_to_manifold<P: Problem>(
    problem: &P,
    y: &mut PointOf<P>,
    work: &mut <P::Action as Action<P::Group>>::Work,
) -> Option<ScalarOf<P>> {
    let (group, action) = (problem.group(), problem.action());
    let size = action.residual_size(group, y);
    Some(action.restore(group, y, work)? / size)
}

/// Refuses the relative residual of a y that is farther from M than numbers with seven digits are, and than a run on numbers
/// of this type may be by rounding.
pub(super) fn check_residual<P: Problem>(problem: &P, residual: ScalarOf<P>) -> Result<(), Error> {
    let tolerance = OFF_M_MAX.max(ON_M * ScalarOf::<P>::EPSILON);
    match residual.all_below(tolerance) {
        true => Ok(()),
        false => Err(Error::NotOnGroup {
            arg: "y",
            group: problem.group().name(),
            residual: power_of_two_above(residual),
            tolerance,
        }),
    }
}

/// Checks the start of a run, and the tolerance for it, and corrects it to M where it is off by more than rounding, as
/// numbers with few digits are. Returns the scratch of the action.
pub(super) fn checked_start<P: Problem>(
    problem: &P,
    y: &mut PointOf<P>,
    tolerance: Option<&Tolerance>,
) -> Result<<P::Action as Action<P::Group>>::Work, Error> {
    let (group, action) = (problem.group(), problem.action());
    action.check(group, y)?;
    let mut restore = action.work(group);
    let mut on = y.clone();
    if check_on_manifold(problem, &mut on, &mut restore)? {
        y.assign(&on);
    }
    action.check_member(group, y)?;
    if let Some(tolerance) = tolerance {
        let size = y.size();
        if !(size * size).all_below(f64::INFINITY) {
            let expected = "a size below 1e154, whose square is a number: take other units";
            return Err(Error::out_of_range("‖y‖", power_of_two_above(size), expected));
        }
        tolerance.check_rounding::<ScalarOf<P>>()?;
        let mut parts = tolerance.scales();
        let none = action.error_ratio(group, &group.zero(), y, &mut parts);
        tolerance.check(parts.asked(), none.any_below(f64::INFINITY))?;
        check_within_reach(tolerance, y)?;
    }
    Ok(restore)
}

/// Room for a value of f with its scratch. Checks f(t, y) at the time `at`.
pub(super) fn checked_field<P: Problem>(
    problem: &P,
    at: Option<f64>,
    y: &PointOf<P>,
) -> Result<(AlgOf<P>, P::Work), Error> {
    let group = problem.group();
    let (mut v, mut field) = (group.zero(), problem.work());
    if let Some(t) = at {
        problem.f(ScalarOf::<P>::lit(t), y, &mut v, &mut field);
        group.check("f", &v)?;
    }
    Ok((v, field))
}
