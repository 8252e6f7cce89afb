//! Times: equal steps over a span, the choice of steps, and the times of output.

use super::control::StepControl;
use crate::error::{Error, Plain};
use crate::methods::{EqualSteps, Step};
use crate::scalar::Real;

/// Steps of one size from t₀ to t₁, forward or backward.
///
/// Times are computed from the number of the step. So no error accumulates in t, and the last step ends exactly at t₁.
/// All steps have the same h, to the last bit. Only the last step is shorter, if h does not divide the span. A run
/// whose f does not depend on t gives the same results at any start time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeGrid {
    t0: f64,
    t1: f64,
    h: f64,
    steps: u64,
    split: bool,
}

/// Where steps are split, in their size. Six steps are symmetric, so that a symmetric method stays what it is. A torque that
/// has the same phase at the start of each step, and turns there up to twenty times within a step, has others at these points:
/// they see at least 27 % of its change, on average. For c and c' of two steps c + c'/2 is not near 1/2: then a jump between
/// them, where f has the mean of both sides, would have the error over parts that it has over steps.
const SPLITS: [f64; 6] = {
    let [a, b, c] = [0.336_432_58, 0.373_937_39, 0.467_199_79];
    [1.0 - a, c, b, 1.0 - b, 1.0 - c, a]
};

/// How the steps of a run are chosen.
#[derive(Clone, Debug, PartialEq)]
pub enum Steps {
    /// One size.
    Equal(TimeGrid),
    /// By their error.
    ByError {
        /// From when to when.
        t_span: [f64; 2],
        /// Tolerances and limits.
        control: StepControl,
    },
}

impl Steps {
    /// From when to when.
    pub fn t_span(&self) -> [f64; 2] {
        match self {
            Steps::Equal(grid) => grid.t_span(),
            Steps::ByError { t_span, .. } => *t_span,
        }
    }
}

/// The largest number of steps; more are a mistake in the input.
const STEPS_MAX: f64 = 1e15;

/// The length of a span. Its ends must not be NaN; the end may be infinite.
pub(super) fn length_of([t0, t1]: [f64; 2]) -> Result<f64, Error> {
    Error::finite("t_span[0]", t0)?;
    if t1.is_nan() {
        return Err(Error::out_of_range("t_span[1]", t1, "a number"));
    }
    let length = (t1 - t0).abs();
    match length.is_finite() || t1.is_infinite() {
        true => Ok(length),
        false => Err(Error::out_of_range("t_span", length, "a finite length")),
    }
}

impl TimeGrid {
    /// Steps of size `dt` > 0 over the span, backward if t₁ < t₀.
    ///
    /// An empty span has no steps. If `dt` does not divide the span, within a relative 1e-9, the last step is shorter.
    /// The end may be infinite.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not a number, and for a `dt` that is not finite and positive, that is
    /// so small that t + dt = t, or that makes more than 1e15 steps.
    pub fn new(t_span: [f64; 2], dt: f64) -> Result<Self, Error> {
        let length = length_of(t_span)?;
        Error::positive("dt", dt)?;
        let [t0, t1] = t_span;
        let h = dt.copysign(t1 - t0);
        let unresolved = |t: f64| {
            Error::out_of_range("dt", dt, format!("a step that changes t = {}", Plain(&t)))
        };
        if length.is_infinite() {
            return TimeGrid { t0, t1, h, steps: u64::MAX, split: false }.checked(unresolved);
        }
        let steps = (length / dt).round();
        if steps > STEPS_MAX {
            return Err(Error::out_of_range("dt", dt, "at most 1e15 steps over t_span"));
        }
        if length == 0.0 {
            return Ok(TimeGrid::divided(t_span, 0));
        }
        if steps >= 1.0 && (length / dt - steps).abs() <= 1e-9 * steps {
            return TimeGrid::divided(t_span, steps as u64).checked(unresolved);
        }
        TimeGrid { t0, t1, h, steps: (length / dt).ceil() as u64, split: false }.checked(unresolved)
    }

    /// Divides the span into this number of steps.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not finite, no steps over a span that is not empty,
    /// or so many that t + h = t.
    #[doc(alias = "linspace")]
    pub fn with_steps(t_span: [f64; 2], steps: u64) -> Result<Self, Error> {
        if length_of(t_span)? == 0.0 {
            return Ok(TimeGrid::divided(t_span, 0));
        }
        Error::finite("t_span[1]", t_span[1])?;
        if steps == 0 {
            return Err(Error::out_of_range("steps", 0.0, "at least 1"));
        }
        TimeGrid::divided(t_span, steps).checked(|_| {
            let expected = "so few that t + h differs from t";
            Error::out_of_range("steps", steps as f64, expected)
        })
    }

    /// The span in equal steps. An empty one has none.
    fn divided([t0, t1]: [f64; 2], steps: u64) -> Self {
        let h = if t0 == t1 { 0.0 } else { (t1 - t0) / steps as f64 };
        TimeGrid { t0, t1, h, steps, split: false }
    }

    /// The steps, if t + h differs from t at the larger end; `error` of that t otherwise.
    fn checked(self, error: impl FnOnce(f64) -> Error) -> Result<Self, Error> {
        let far = if self.t1.is_finite() { self.t1.abs() } else { 0.0 };
        let largest = self.t0.abs().max(far);
        match self.h.abs() < largest - largest.next_down() {
            true => Err(error(largest)),
            false => Ok(self),
        }
    }

    /// Splits each step in two parts of different size, for a second run that shows the error of one over whole steps.
    ///
    /// Where f jumps between two steps, it jumps between parts, too. But where each step begins at the same phase of f, the
    /// parts begin at others. Steps in two halves would not: a torque whose period divides them is the same at each of their
    /// stages. An error of order p is that of whole steps times [`split_error`](Self::split_error).
    pub fn split(self) -> Self {
        TimeGrid { split: true, ..self }
    }
    /// The error of a run over split steps by a method of order p, in that of a run over whole steps: the mean of
    /// c^(p + 1) + (1 - c)^(p + 1), for the parts c and 1 - c of each step.
    pub fn split_error(p: usize) -> f64 {
        let of_step = |c: &f64| c.powi(p as i32 + 1) + (1.0 - c).powi(p as i32 + 1);
        SPLITS.iter().map(of_step).sum::<f64>() / SPLITS.len() as f64
    }
    /// True if the steps are [split](Self::split).
    pub(super) fn is_split(&self) -> bool {
        self.split
    }
    /// The step that this part belongs to.
    fn whole(&self, n: u64) -> u64 {
        if self.split { n / 2 } else { n }
    }
    /// t₀ and t₁.
    pub fn t_span(&self) -> [f64; 2] {
        [self.t0, self.t1]
    }
    /// The number of steps, or of their parts; `u64::MAX` for a span with infinite end.
    pub fn steps(&self) -> u64 {
        if self.split { self.steps.saturating_mul(2) } else { self.steps }
    }
    /// The size of a whole step, with its sign; 0 when there are no steps.
    pub fn h(&self) -> f64 {
        self.h
    }
    /// The time after n steps, or after n parts of them.
    pub fn time(&self, n: u64) -> f64 {
        if n >= self.steps() {
            return self.t1;
        }
        let start = self.t0 + self.whole(n) as f64 * self.h;
        if self.is_second(n) { start + self.size(n - 1) } else { start }
    }
    /// True if a step is split, and this is its second part.
    fn is_second(&self, n: u64) -> bool {
        self.split && n % 2 == 1
    }
    /// The size of step number n: h, or the rest of the span for the last step; or of a part of it.
    pub(super) fn size(&self, n: u64) -> f64 {
        let divides = self.h == (self.t1 - self.t0) / self.steps as f64;
        let whole = self.whole(n);
        let size = match whole + 1 < self.steps || divides {
            true => self.h,
            false => self.t1 - self.t0 - whole as f64 * self.h,
        };
        if !self.split {
            return size;
        }
        let first = SPLITS[(whole % SPLITS.len() as u64) as usize] * size;
        if self.is_second(n) { size - first } else { first }
    }
    /// The size of a step from the time after n steps to this time. Its end is exact where that start is rounded.
    pub(super) fn size_to(&self, n: u64, time: f64) -> f64 {
        let first = if self.is_second(n) { self.size(n - 1) } else { 0.0 };
        time - self.t0 - self.whole(n) as f64 * self.h - first
    }
    /// The steps `first..end`, of which all have the same size.
    pub(super) fn equal(&self, first: u64, end: u64) -> EqualSteps {
        EqualSteps { first, end, t0: self.t0, h: self.h }
    }
    /// Calls `each` with every number of the grid, to save it.
    pub(super) fn each_part(&mut self, each: &mut dyn FnMut(&mut f64)) {
        each(&mut self.t0);
        each(&mut self.t1);
        each(&mut self.h);
        let mut steps = f64::from_bits(self.steps);
        each(&mut steps);
        self.steps = steps.to_bits();
    }
    /// Step number n.
    pub(super) fn step<S: Real>(&self, n: u64) -> Step<S> {
        Step { n, t: S::lit(self.time(n)), h: S::lit(self.size(n)) }
    }
    /// How many steps may be taken from step `n` on without passing `time`: at least one.
    pub(super) fn last_before(&self, n: u64, time: f64) -> u64 {
        let steps = ((time - self.t0) / self.h).floor();
        // One less, for rounding.
        (steps as u64).saturating_sub(1).max(n + 1)
    }
}

/// The points of a run that are shown to an observer, or stored.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum SaveAt {
    /// At the end only.
    #[default]
    End,
    /// At the start and at the end.
    Ends,
    /// At the start, at each multiple of this number of steps, and at the end.
    Every(u64),
    /// At these times and no others, in the order of the run. They need not be ends of steps.
    Times(Vec<f64>),
    /// At these times, at the start and at the end, also where an event ends the run.
    TimesAndEnds(Vec<f64>),
    /// At the start, at equal intervals of this length from there on, and at the end.
    Interval(f64),
}

impl SaveAt {
    /// This number of equal intervals over a span.
    pub(super) fn count(intervals: u64, [t0, t1]: [f64; 2]) -> Result<Self, Error> {
        if intervals == 0 || !t1.is_finite() {
            let expected = "at least 1, over a span with an end";
            return Err(Error::out_of_range("count", intervals as f64, expected));
        }
        Ok(match t0 == t1 {
            true => SaveAt::Ends,
            false => SaveAt::Interval((t1 - t0).abs() / intervals as f64),
        })
    }

    /// True if the start is shown.
    pub(super) fn start(&self, t0: f64) -> bool {
        match self {
            SaveAt::End => false,
            SaveAt::Ends | SaveAt::Every(_) | SaveAt::Interval(_) | SaveAt::TimesAndEnds(_) => true,
            SaveAt::Times(times) => times.first() == Some(&t0),
        }
    }

    /// True if the end is shown whatever the times.
    pub(super) fn end(&self) -> bool {
        !matches!(self, SaveAt::Times(_))
    }

    /// The times that are given.
    pub(super) fn times(&self) -> &[f64] {
        match self {
            SaveAt::Times(times) | SaveAt::TimesAndEnds(times) => times,
            _ => &[],
        }
    }

    /// The times after t₀.
    pub(super) fn times_after(&self, t0: f64) -> &[f64] {
        self.times().strip_prefix(&[t0]).unwrap_or(self.times())
    }

    /// The number of the next step after `n` that is shown.
    pub(super) fn next_after(&self, n: u64) -> u64 {
        match self {
            SaveAt::Every(every) => (n - n % every).saturating_add(*every),
            _ => u64::MAX,
        }
    }

    /// Checks the points against the span.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for `every = 0`, for an interval that t does not resolve, and for times that are not finite,
    /// outside the span, or not in strict order.
    pub fn check(&self, [t0, t1]: [f64; 2]) -> Result<(), Error> {
        match self {
            SaveAt::Every(0) => Err(Error::out_of_range("every", 0.0, "at least 1")),
            SaveAt::Interval(length) => {
                Error::positive("interval", *length)?;
                // Two times that are one number would be shown for ever.
                let differ = |t: f64| !t.is_finite() || t + length != t;
                let are_few = !t1.is_finite() || (t1 - t0).abs() / length <= STEPS_MAX;
                match differ(t0) && differ(t1) && are_few {
                    true => Ok(()),
                    false => {
                        let expected = "times that differ, and at most 1e15 of them over t_span";
                        Err(Error::out_of_range("interval", *length, expected))
                    }
                }
            }
            SaveAt::End | SaveAt::Ends | SaveAt::Every(_) => Ok(()),
            SaveAt::Times(times) | SaveAt::TimesAndEnds(times) => {
                let forward = if t1 >= t0 { 1.0 } else { -1.0 };
                let mut last = f64::NEG_INFINITY;
                for (i, &t) in times.iter().enumerate() {
                    let arg = || format!("times[{i}]");
                    if !(t0.min(t1) <= t && t <= t0.max(t1) && t.is_finite()) {
                        return Err(Error::out_of_range(arg(), t, format!("within [{t0}, {t1}]")));
                    }
                    if forward * t <= last {
                        return Err(Error::out_of_range(arg(), t, "times in order, each once"));
                    }
                    last = forward * t;
                }
                Ok(())
            }
        }
    }
}
