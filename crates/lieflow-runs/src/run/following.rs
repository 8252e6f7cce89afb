//! Where a run looks at values that are known up to a choice, such as Euler angles: often enough that no turn is lost.

use core::f64::consts::PI;
use core::ops::Range;

use lieflow::Event;

/// Points for each radian by which the values change.
const FOR_EACH_RADIAN: f64 = 2.0;
/// The least points within a long step, in which a body turns by some radians: within it the values may change faster than
/// at its ends.
const WITHIN_LONG: u32 = 3;
/// The most points within a step before its parts are halved. The values may be fast at an end of the step alone.
const WITHIN_MOST: f64 = 15.0;

/// The points in a time h, if the values change by these rates at its ends.
fn points(h: f64, [first, last]: [f64; 2]) -> f64 {
    FOR_EACH_RADIAN * h * first.max(last)
}
/// The points within a step before its parts are halved.
fn within(h: f64, rates: [f64; 2]) -> u32 {
    points(h, rates).min(WITHIN_MOST) as u32
}
/// Those within a step of a method of high order.
fn within_long(h: f64, rates: [f64; 2]) -> u32 {
    within(h, rates).max(WITHIN_LONG)
}
/// True if the values may change by half a turn and more between two neighbours: parts were not halved often enough.
fn is_lost(h: f64, rates: [f64; 2]) -> bool {
    points(h, rates) > FOR_EACH_RADIAN * PI
}
/// True if the values may change by more than half a radian in a part of a step. Longitudes about a pole change by less than
/// half a turn then: their path is shorter than the way to the pole.
fn is_halved(h: f64, rates: [f64; 2]) -> bool {
    points(h, rates) > 1.0
}

/// The end of a step.
#[derive(Clone, Copy, Debug)]
struct End {
    t: f64,
    /// A bound of how fast the values change there.
    rate: f64,
    /// The points since the values were looked at.
    points: f64,
}

impl End {
    /// The end of the step from here, and true if it is looked at.
    fn next(self, t: f64, rate: f64, within: fn(f64, [f64; 2]) -> u32) -> (End, bool) {
        let (h, rates) = ((t - self.t).abs(), [self.rate, rate]);
        let points = self.points + points(h, rates);
        let is_seen = points.is_nan() || points > 1.0 || within(h, rates) > 0;
        (End { t, rate, points: if is_seen { 0.0 } else { points } }, is_seen)
    }
}

/// An event without zeros that gives the state, and its g, to `look` where its choices are followed, before all other events
/// of a step. Its g is a bound of how fast the values change, which is > 0. `begin` is called with t and g when a step begins.
pub(super) fn following<'a, Y>(
    begin: impl Fn([f64; 2]) + 'a,
    look: impl Fn([f64; 2], &Y) + 'a,
    rate: impl Fn(f64, &Y) -> f64 + 'a,
    [is_forward, is_long]: [bool; 2],
) -> Event<'a, Y> {
    let within = if is_long { within_long } else { within };
    let nowhere = End { t: f64::NAN, rate: f64::NAN, points: f64::NAN };
    let (mut start, mut end) = (nowhere, nowhere);
    let g = move |t: f64, y: &Y| {
        let rate = Some(rate(t, y)).filter(|rate| *rate > 0.0 && rate.is_finite());
        let rate = rate.unwrap_or(f64::MIN_POSITIVE);
        if t != end.t && (end.t.is_nan() || (t > end.t) == is_forward) {
            begin([end.t, end.rate]);
            start = end;
        } else if t != end.t {
            // Within a step.
            look([t, rate], y);
            return rate;
        }
        let (next, is_seen) = start.next(t, rate, within);
        end = next;
        if is_seen {
            look([t, rate], y);
        }
        rate
    };
    Event::new("", g).points_by_halves(within, is_halved)
}

/// The rows at which choices are followed, until all of a step are there: parts of a step are halved in another order than
/// that of time. A new step allocates nothing.
#[derive(Debug)]
pub(super) struct Followed {
    is_forward: bool,
    /// t and g at the last point.
    last: [f64; 2],
    /// t and g of each row, and its place among the numbers.
    rows: Vec<([f64; 2], Range<usize>)>,
    numbers: Vec<f64>,
}

impl Followed {
    pub(super) fn new([t0, t1]: [f64; 2]) -> Self {
        Followed { is_forward: t1 > t0, last: [t0, 0.0], rows: Vec::new(), numbers: Vec::new() }
    }

    /// A step begins at this t, with this g.
    pub(super) fn begin(&mut self, at: [f64; 2]) {
        self.last = at;
    }

    /// The row at this t, with this g, which `fill` appends to the numbers.
    pub(super) fn add(&mut self, at: [f64; 2], fill: impl FnOnce(&mut Vec<f64>)) {
        let start = self.numbers.len();
        fill(&mut self.numbers);
        self.rows.push((at, start..self.numbers.len()));
    }

    /// Gives the rows so far to `follow`, the end of the step first, and then to `tell`, in the order of time, with false where
    /// turns may be lost since the one before.
    pub(super) fn take(
        &mut self,
        mut follow: impl FnMut(f64, &mut [f64]),
        mut tell: impl FnMut(f64, &[f64], bool),
    ) {
        let Followed { is_forward, last, rows, numbers } = self;
        let sign = if *is_forward { 1.0 } else { -1.0 };
        rows.sort_unstable_by(|([a, _], _), ([b, _], _)| (sign * a).total_cmp(&(sign * b)));
        if let Some((end, before)) = rows.split_last() {
            for ([t, _], place) in [end].into_iter().chain(before) {
                follow(*t, &mut numbers[place.clone()]);
            }
        }
        for (at, place) in rows.drain(..) {
            let [before, here] = [core::mem::replace(last, at), at];
            // An event that changes the state goes back within the step.
            let is_sure = !is_lost(sign * (here[0] - before[0]), [before[1], here[1]]);
            tell(at[0], &numbers[place], is_sure);
        }
        numbers.clear();
    }
}
