//! Where a run looks at values that are known up to a choice, such as Euler angles: often enough that no turn is lost.

use lieflow::Event;

/// The points of a run at which choices are followed: so many that the state turns by half a radian between two of them.
#[derive(Clone, Copy, Debug)]
struct Followed {
    /// The time of the end of a step.
    t: f64,
    /// How fast the state turns there.
    rate: f64,
    /// By how much it turned since it was followed.
    turned: f64,
}

impl Followed {
    /// Points for each radian. Within a step the state may turn faster than at its ends.
    const FOR_EACH_RADIAN: f64 = 2.0;
    /// The least points within a long step, in which a body turns by some radians.
    const WITHIN_LONG: u32 = 3;

    /// By how much the state turns in a step of size h, with these rates at its ends.
    fn turn(h: f64, [first, last]: [f64; 2]) -> f64 {
        h * first.max(last)
    }
    /// The points within a step.
    fn within(h: f64, rates: [f64; 2]) -> u32 {
        (Self::FOR_EACH_RADIAN * Self::turn(h, rates)) as u32
    }
    /// The points within a step of a method of high order.
    fn within_long(h: f64, rates: [f64; 2]) -> u32 {
        Self::within(h, rates).max(Self::WITHIN_LONG)
    }

    /// The end of the step from here, and true if the state has to be followed there.
    fn next(self, t: f64, rate: f64, within: fn(f64, [f64; 2]) -> u32) -> (Followed, bool) {
        let (h, rates) = ((t - self.t).abs(), [self.rate, rate]);
        let turned = self.turned + Self::turn(h, rates);
        let is_followed =
            turned.is_nan() || within(h, rates) > 0 || Self::FOR_EACH_RADIAN * turned > 1.0;
        (Followed { t, rate, turned: if is_followed { 0.0 } else { turned } }, is_followed)
    }
}

/// An event without zeros that shows the state to `fill` where its choices are followed, before all other events of a
/// step. Its g is how fast the state turns, which is > 0.
pub(super) fn following<'a, Y>(
    fill: &'a dyn Fn(f64, &Y),
    rate: impl Fn(f64, &Y) -> f64 + 'a,
    [is_forward, is_long]: [bool; 2],
) -> Event<'a, Y> {
    let within = if is_long { Followed::within_long } else { Followed::within };
    let nowhere = Followed { t: f64::NAN, rate: f64::NAN, turned: f64::NAN };
    let (mut start, mut end) = (nowhere, nowhere);
    let g = move |t: f64, y: &Y| {
        let rate = Some(rate(t, y)).filter(|rate| *rate > 0.0 && rate.is_finite());
        let rate = rate.unwrap_or(f64::MIN_POSITIVE);
        if t != end.t && (end.t.is_nan() || (t > end.t) == is_forward) {
            start = end;
        } else if t != end.t {
            // Within a step.
            fill(t, y);
            return rate;
        }
        let (next, is_followed) = start.next(t, rate, within);
        end = next;
        if is_followed {
            fill(t, y);
        }
        rate
    };
    Event::new("", g).points_by(within)
}
