//! Second runs, which show the error of a first one: what the command line and the Python package agree on.
//!
//! Steps that are chosen by their error can pass over a pulse of f: no stage is within it, so the error of a step shows
//! nothing. A run in short steps looks for it.

use lieflow::Stats;

/// The relative change of the numbers of a start that shows how rounding in a run grows. A change of one digit may be lost
/// in sums.
pub const LAST_DIGITS: f64 = 64.0 * f64::EPSILON;
/// A run with a smaller tolerance is compared with one that has a larger tolerance: a tenth of it is rounding.
const SMALLEST: f64 = 1e-13;

/// The tolerance of a second run in that of the first, which has these rtol and atol: a tenth, or ten times where that is
/// rounding.
pub fn other_tolerance([rtol, atol]: [f64; 2]) -> f64 {
    if rtol.max(atol) >= SMALLEST { 0.1 } else { 10.0 }
}

/// The number of steps of the same size that a run in short steps takes at least.
pub const SHORT_STEPS: u64 = 2000;
/// The time in seconds that the search may take, where the run itself took less.
const SEARCH: f64 = 0.3;

/// The time at which a second run ends a step, so that it sees a short pulse that a run has seen: half a step after the end of
/// the smallest step that followed a rejected attempt ([`Stats::after_rejection`]). A run that ended a step there itself would
/// have the nodes of the first one, and would be as blind to a jump at the end of that step.
pub fn stop_after_hardest(stats: &Stats, [t0, t1]: [f64; 2]) -> Option<f64> {
    let [end, size] = stats.after_rejection?;
    let stop = end + 0.5 * size.copysign(t1 - t0);
    (if t1 > t0 { stop < t1 } else { stop > t1 }).then_some(stop)
}

/// The time in seconds of a run that may go to its start, and tells nothing of the time of a step.
const START: f64 = 0.002;

/// The time in seconds that a search in short steps may take, after a run of `steps` steps in `seconds` seconds. `None` if
/// the search would take longer.
pub fn time_to_search(steps: u64, seconds: f64) -> Option<f64> {
    let times = (SHORT_STEPS + steps) as f64 / steps.max(1) as f64;
    let takes = (seconds - START).max(0.0) * times;
    let most = SEARCH.max(seconds);
    (takes <= most).then_some(most)
}
