//! Second runs, which show the error of a first one: what the command line and the Python package agree on.
//!
//! Steps that are chosen by their error can pass over a pulse of f: no stage is within it, so the error of a step shows
//! nothing. A run in short steps looks for it. Steps of one size can pass over a jump of f between their last node and their
//! end, and so does a run with each step in two parts. A run whose steps end elsewhere looks for it.

use lieflow::{Stats, TimeGrid};

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
/// Steps of a search beside steps of one size are this part of what they may be. None of them ends with a step of the run,
/// nor at a round time.
const OFF_GRID: f64 = 0.963_525_491_6;

/// The size of the steps of a search over a span of this length, beside steps of one size of up to `largest`.
pub fn search_step(length: f64, largest: f64) -> f64 {
    OFF_GRID * (length / SHORT_STEPS as f64).min(largest / 1.5)
}

/// A search this many estimated errors away has found something that both runs of the estimate have passed over.
const PASSED_OVER: f64 = 30.0;

/// Has a search, at this distance from a run, found something that the run has passed over? `known` is the estimated error.
pub fn is_elsewhere(distance: f64, known: f64) -> bool {
    distance > PASSED_OVER * known
}

/// A second search beside steps of one size has steps that are so many times shorter. The second number is for a search that
/// would take too long with the first.
const FINER: [f64; 2] = [32.0, 8.0];

/// How many times shorter the steps of a second search are, after a first one that took so many seconds. `None` if it would take
/// more than `most`.
pub fn finer(seconds: f64, most: f64) -> Option<f64> {
    FINER.into_iter().find(|times| times * seconds < most)
}

/// A finer search is at this part of the distance of the first one at least, where the run is wrong.
const STAYS: f64 = 0.25;

/// Does the distance of a run from a search stay in a [`finer`] one? Where it falls, it is mostly the error of the
/// search.
pub fn stays(finer: f64, distance: f64) -> bool {
    finer > STAYS * distance
}

/// The time in seconds that the search may take, where the run itself took less.
const SEARCH: f64 = 0.3;

/// The golden section: near no part of a step, or of a span, that others take.
pub const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// The time at which a second run ends a step, so that it sees a short pulse that a run has seen: a part of a step after the end
/// of the smallest step that followed a rejected attempt ([`Stats::after_rejection`]). A run that ended a step where the first
/// one does would have its nodes, and would be as blind to a jump at the end of that step.
pub fn stop_after_hardest(stats: &Stats, [t0, t1]: [f64; 2]) -> Option<f64> {
    let [end, size] = stats.after_rejection?;
    let stop = end + GOLDEN * size.copysign(t1 - t0);
    (if t1 > t0 { stop < t1 } else { stop > t1 }).then_some(stop)
}

/// Of more steps the times near their ends are not made: there are seven for each.
pub const GRADED_MOST: u64 = 100_000;
/// Short parts of a step.
const PARTS: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// The end of each step, and the times after its start and before its end by short parts of it. Steps that end there see a jump
/// near the end of a step. Parts that are as short as the rounding of t are left out.
pub fn near_ends(grid: &TimeGrid) -> impl Iterator<Item = f64> {
    let [t0, t1] = grid.t_span();
    let least = 100.0 * f64::EPSILON * t0.abs().max(t1.abs());
    let ends = (0..grid.steps()).map(|n| [grid.time(n), grid.time(n + 1)]);
    ends.flat_map(move |[from, to]| {
        let parts = PARTS.map(|part| part * (to - from)).into_iter();
        let parts = parts.filter(move |part| part.abs() > least);
        parts.flat_map(move |part| [from + part, to - part]).chain([to])
    })
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
