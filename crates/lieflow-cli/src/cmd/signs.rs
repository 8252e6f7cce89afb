//! The least number of zeros of events on the exact motion.

use lieflow_model::problem::{EventPlan, GOLDEN};

use super::watch::Watch;

/// The number of times at which the sign of an event is looked at.
const SIGNS: u32 = 2000;

/// The changes of sign of each event on the exact motion, between times that are no multiples of a step: it has at least so
/// many zeros. The count is 0 where a column of the event has two values there, such as one of a quaternion.
pub(super) fn changes_of_sign(
    watch: &Watch<'_>,
    [t0, end]: [f64; 2],
    events: &[EventPlan<'_>],
) -> Vec<u64> {
    let schema = watch.model.schema();
    let none = vec![0; events.len()];
    let (mut changes, mut before) = (none.clone(), vec![0.0; events.len()]);
    let mut is_single = vec![true; events.len()];
    let mut last: Option<Vec<f64>> = None;
    let looks = if events.is_empty() { 0 } else { SIGNS };
    for k in (0..looks).map(f64::from) {
        let t = t0 + (end - t0) * (k + ((k + 1.0) * GOLDEN).fract()) / f64::from(SIGNS);
        let Some(exact) = watch.exact(t) else { return none };
        let mut followed = exact.clone();
        if let Some(last) = &last {
            schema.follow(last, &mut followed);
        }
        for (i, event) in events.iter().enumerate() {
            let is_same = |&place: &usize| followed[place].to_bits() == exact[place].to_bits();
            is_single[i] &= event.places.iter().all(is_same);
            let g = (event.value)(t, schema.row(&exact));
            changes[i] += u64::from(event.direction.has_change(before[i], g));
            before[i] = g;
        }
        last = Some(exact);
    }
    changes
        .iter()
        .zip(is_single)
        .map(|(&changes, single)| if single { changes } else { 0 })
        .collect()
}
