//! What a run takes where its scene says nothing.

use serde::Serialize;

use crate::problem::Problem;

/// The relative error of each step of a method of this order: of order 8 the least that rounding
/// allows, by which eight digits and more are right after many thousand steps; of a lower order one that it can meet.
fn tolerance(order: Option<usize>) -> f64 {
    match order {
        Some(order @ ..8) => 1.0 / 10_f64.powi(order as i32 + 5),
        _ => 1e-14,
    }
}
/// rtol and atol of a method of this order, from a start with these numbers. atol is rtol, times the largest number where
/// that is below 1: it does not hide a body whose momentum is 1e-30 in its units.
pub fn tolerances(order: Option<usize>, start: &[f64]) -> [f64; 2] {
    let rtol = tolerance(order);
    let largest = start.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let share = if largest > 0.0 { largest.min(1.0) } else { 1.0 };
    [rtol, share * rtol]
}
/// The equal intervals of the output, where the steps are left out too.
pub(super) const INTERVALS: u64 = 1000;
/// A quantity with more columns is written only when it is asked for.
const COLUMNS: usize = 64;

/// The choices that a scene left to the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Defaults {
    /// The method.
    pub method: bool,
    /// The steps: they are chosen by their error.
    pub steps: bool,
    /// The quantities that are written.
    pub quantities: bool,
    /// The times of the rows.
    pub rows: bool,
}

/// The quantities that a user of the problem wants: the state, what is drawn, and what the exact motion conserves. One
/// with very many columns is left out.
pub(super) fn quantities(problem: &Problem) -> Vec<String> {
    let state = problem.default_state();
    let all = [state, &[problem.figure(state).quantity()], &problem.invariants(state)].concat();
    let mut wanted: Vec<String> = Vec::new();
    for name in all {
        let fits = problem.columns(name).is_ok_and(|columns| columns.len() <= COLUMNS);
        if fits && !wanted.iter().any(|other| other == name) {
            wanted.push(name.into());
        }
    }
    // A problem of large quantities alone.
    if wanted.is_empty() { state.iter().map(|&name| name.into()).collect() } else { wanted }
}
