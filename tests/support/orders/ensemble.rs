//! Orders above 4. The way from the first asymptotic step to rounding is short there, and on a single
//! problem one accident of the leading error term spoils it. So the error is a mean over several
//! problems, the grid is fine, and where the leading term is small (DOPRI5 was made that way) the term
//! after it is taken out.

use faer::Mat;
use lieflow::methods::Method;
use lieflow::problems::Problem;

use super::super::points::Points;
use super::super::represent::Represent;
use super::super::scale;
use super::estimate::{Estimate, SLOPES, pairwise};
use super::flow::{Reference, run};

/// So many problems that differ in their coefficients and in where they start.
pub(crate) const MEMBERS: u64 = 8;

/// Numbers of steps from 4 on, fixed here once for every method and problem: ratios from 1.14 to 1.25,
/// and with each number its double.
fn grid() -> impl Iterator<Item = u64> {
    (0..28u64).map(|i| (4 + i % 4) << (i / 4))
}
/// n/2 stands so many places before n.
const HALF: usize = 4;

/// Errors above this are not asymptotic.
const CEILING: f64 = 1e-3;
/// Down to here they are looked at, and differences of errors to there: rounding is some 5e-15.
const FLOORS: [f64; 2] = [1e-12, 1e-13];

/// The relative error of a member, in numbers, at the end of a run with so many steps.
pub(crate) type Run<'a> = &'a dyn Fn(usize, u64) -> Result<Mat<f64>, String>;

/// Errors of one method at every step of the grid: the members', one by one.
struct Errors<'a> {
    members: usize,
    run: Run<'a>,
    steps: Vec<u64>,
    errors: Vec<Vec<Mat<f64>>>,
}

/// The geometric mean of the errors: its slope is the mean of their slopes.
fn mean(errors: &[Mat<f64>]) -> f64 {
    (errors.iter().map(|e| e.norm_l2().ln()).sum::<f64>() / errors.len() as f64).exp()
}

impl Errors<'_> {
    /// From coarse steps to fine ones, until the error falls below `floor`.
    fn follow(&mut self, floor: f64) -> Result<(), String> {
        let last = self.steps.last().copied().unwrap_or(0);
        for n in grid().filter(|n| *n > last) {
            if self.errors.last().is_some_and(|e| mean(e) < floor) {
                break;
            }
            let errors = (0..self.members).map(|i| (self.run)(i, n)).collect::<Result<Vec<_>, _>>();
            match errors {
                // Far too large a step.
                Err(_) if self.steps.is_empty() || n < 8 => {
                    self.steps.clear();
                    self.errors.clear();
                }
                errors => {
                    self.errors.push(errors?);
                    self.steps.push(n);
                }
            }
        }
        Ok(())
    }

    fn estimate(&self, order: usize, floor: f64, sizes: impl Iterator<Item = f64>) -> Estimate {
        let sizes: Vec<f64> = sizes.collect();
        let from = self.steps.len() - sizes.len();
        let points: Vec<(f64, f64)> = (self.steps[from..].iter().map(|&n| n as f64).zip(sizes))
            .filter(|(_, e)| (floor..CEILING).contains(e))
            .collect();
        Estimate::new(order, pairwise(&points[points.len().saturating_sub(SLOPES + 1)..]))
    }
}

/// The order over so many members, from errors down to `floor`: the slopes of E(h), or where those do not
/// show the order the slopes of E(h/2) − E(h)/2^(p+1), down to `low`, or with p + 2, for methods that are
/// symmetric in time. That has the leading term of E and not the one after it; a method of lower order
/// shows its own order in each.
///
/// # Errors
/// A run that failed.
pub(crate) fn order_over(
    order: usize,
    members: usize,
    [floor, low]: [f64; 2],
    run: Run,
) -> Result<Estimate, String> {
    let mut errors = Errors { members, run, steps: Vec::new(), errors: Vec::new() };
    errors.follow(floor)?;
    let plain = errors.estimate(order, floor, errors.errors.iter().map(|e| mean(e)));
    if plain.check().is_ok() {
        return Ok(plain);
    }
    errors.follow(low)?;
    for next in [1, 2] {
        let weight = 0.5f64.powi(order as i32 + next);
        let pairs = errors.errors.iter().zip(errors.errors.iter().skip(HALF));
        let differences = pairs.map(|(coarse, fine)| {
            let pairs = fine.iter().zip(coarse);
            mean(&pairs.map(|(fine, coarse)| fine - scale(weight, coarse)).collect::<Vec<_>>())
        });
        let two = errors.estimate(order, low, differences);
        if two.check().is_ok() {
            return Ok(two.of_two_terms());
        }
    }
    Ok(plain)
}

/// The relative error of a method on one of an ensemble.
fn error<P: Problem, M: Method<P>>(
    (problem, reference): &(P, Reference<P>),
    method: &M,
    steps: u64,
) -> Result<Mat<f64>, String>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    let end = reference.end();
    Ok(scale(1.0 / end.norm_l2(), &(run(problem, method, steps, reference)? - end)))
}

/// The largest relative error of a method over an ensemble.
///
/// # Errors
/// A run that failed.
pub(crate) fn largest_error<P: Problem, M: Method<P>>(
    members: &[(P, Reference<P>)],
    method: &M,
    steps: u64,
) -> Result<f64, String>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    members.iter().try_fold(0.0, |largest: f64, member| {
        let error = error(member, method, steps)?.norm_l2();
        // max() would pass over what is not a number.
        Ok(if largest.is_nan() || error <= largest { largest } else { error })
    })
}

/// The order that a method shows over an ensemble.
///
/// # Errors
/// A run that failed.
pub(crate) fn measure_over<P: Problem, M: Method<P>>(
    members: &[(P, Reference<P>)],
    method: &M,
) -> Result<Estimate, String>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    let order = method.facts(&members[0].0).order;
    order_over(order, members.len(), FLOORS, &|i, n| error(&members[i], method, n))
}
