//! Times at which a step ends, because f is not smooth there.

use crate::error::Error;
use crate::samples::Samples;

/// Times at which a step ends, in any order, and also outside the span. A list of times is one of jumps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stops {
    /// Where f jumps. No stage is at such a time: f may have the value of either side there, or another one. The ends of the
    /// span count.
    pub jumps: Vec<f64>,
    /// Where derivatives of f jump, and f does not: the knots of sampled data.
    pub kinks: Vec<f64>,
}

impl Stops {
    /// Times at which derivatives of f jump, and f does not.
    pub fn at_kinks(times: impl Into<Vec<f64>>) -> Self {
        Stops { jumps: Vec::new(), kinks: times.into() }
    }
    /// The times within a span at which samples are not smooth. Values that are held jump there.
    pub fn at_knots(samples: &Samples, t_span: [f64; 2]) -> Self {
        let knots: Vec<f64> = samples.knots(t_span).collect();
        if samples.interpolation().jumps() { knots.into() } else { Stops::at_kinks(knots) }
    }
    /// The number of times.
    pub fn len(&self) -> usize {
        self.jumps.len() + self.kinks.len()
    }
    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl From<Vec<f64>> for Stops {
    fn from(jumps: Vec<f64>) -> Self {
        Stops { jumps, kinks: Vec::new() }
    }
}
impl From<&[f64]> for Stops {
    fn from(jumps: &[f64]) -> Self {
        jumps.to_vec().into()
    }
}
impl<const N: usize> From<[f64; N]> for Stops {
    fn from(jumps: [f64; N]) -> Self {
        jumps.to_vec().into()
    }
}

/// A time at which a step ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stop {
    pub(super) t: f64,
    /// Does f jump there?
    pub(super) jumps: bool,
}

impl Stops {
    /// The stops within a span, in the order of the run.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a stop that is not a number.
    pub(super) fn in_order(self, [t0, t1]: [f64; 2]) -> Result<Vec<Stop>, Error> {
        for (name, times) in [("stops", &self.jumps), ("kinks", &self.kinks)] {
            if let Some(i) = times.iter().position(|t| t.is_nan()) {
                return Err(Error::out_of_range(format!("{name}[{i}]"), f64::NAN, "a number"));
            }
        }
        let jumps = self.jumps.into_iter().map(|t| Stop { t, jumps: true });
        let kinks = self.kinks.into_iter().map(|t| Stop { t, jumps: false });
        // f may jump at the ends, too: the first step evaluates it after the start, the last one before the end.
        let is_inside = |t: f64| t0.min(t1) <= t && t <= t0.max(t1) && t0 != t1;
        let mut all: Vec<Stop> = jumps.chain(kinks).filter(|stop| is_inside(stop.t)).collect();
        let forward = 1.0_f64.copysign(t1 - t0);
        // Of two at one time the jump is first, and counts.
        all.sort_by(|a, b| (forward * a.t).total_cmp(&(forward * b.t)).then(b.jumps.cmp(&a.jumps)));
        all.dedup_by_key(|stop| stop.t);
        Ok(all)
    }
}

/// The stages of a step to a jump of f are so many rounding units of time before it.
pub(super) const MARGIN: f64 = 4.0;

/// A rounding unit of time, in the direction from t to `end`; 0 where a step between them is almost as short as that, or the
/// unit has no half.
///
/// The times of the stages have this `epsilon`.
pub(super) fn unit([t, end]: [f64; 2], epsilon: f64) -> f64 {
    let unit = epsilon * t.abs().max(end.abs());
    let counts = (end - t).abs() > 100.0 * unit && unit >= f64::MIN_POSITIVE;
    if counts { unit.copysign(end - t) } else { 0.0 }
}
