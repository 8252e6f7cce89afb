//! The search for short pulses. Steps that are chosen by their error can pass over a pulse of f: no stage is within it, so the
//! error of a step shows nothing. A run in short steps looks for it.

/// The number of steps of the same size that a run in short steps takes at least.
pub const SHORT_STEPS: u64 = 2000;
/// The time in seconds that the search may take, where the run itself took less.
const SEARCH: f64 = 0.3;

/// The time in seconds that the search may take, after a run of `steps` steps in `seconds` seconds. `None` if the search
/// would take longer.
pub fn time_to_search(steps: u64, seconds: f64) -> Option<f64> {
    let takes = seconds * (SHORT_STEPS + steps) as f64 / steps.max(1) as f64;
    let most = SEARCH.max(seconds);
    (takes <= most).then_some(most)
}
