//! The driver: fixed steps over a time span, with output where it is asked for.

use crate::actions::Action;
use crate::error::{Error, Failure};
use crate::groups::{LieAlgebra, RESIDUAL_MAX};
use crate::methods::{EqualSteps, Method, Step};
use crate::problems::{PointOf, Problem, ScalarOf};
use crate::scalar::Real;

/// Equal steps from t₀ to t₁, forward or backward.
///
/// Times are computed from the number of the step, so that no error accumulates in t, and the last
/// step ends at t₁ exactly. Every step has the same h, to the last bit: where f does not ask for t, a
/// run is the same whenever it starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeGrid {
    t0: f64,
    t1: f64,
    steps: u64,
}

/// More steps than this count as a mistake in the input.
const STEPS_MAX: f64 = 1e15;

impl TimeGrid {
    /// Steps of size `dt` > 0 over the span; backward when t₁ < t₀. An empty span has no steps.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not finite, a `dt` that is not finite and positive,
    /// is lost in rounding next to t, or does not divide the span (to a relative 1e-9): the message
    /// names the nearest `dt` that does.
    pub fn new(t_span: [f64; 2], dt: f64) -> Result<Self, Error> {
        let [t0, t1] = t_span;
        let length = Self::check_span(t_span)?;
        if !(dt.is_finite() && dt > 0.0) {
            return Err(Error::out_of_range("dt", dt, "a finite number > 0"));
        }
        let steps = (length / dt).round();
        if steps > STEPS_MAX {
            return Err(Error::out_of_range("dt", dt, "at most 1e15 steps over t_span"));
        }
        if length > 0.0 && (steps < 1.0 || (length / dt - steps).abs() > 1e-9 * steps) {
            let count = steps.max(1.0);
            let advice = format!(
                "a step that divides the span of length {length}, such as {} ({count} steps)",
                length / count
            );
            return Err(Error::out_of_range("dt", dt, advice));
        }
        Self::with_steps([t0, t1], steps as u64)
    }

    /// The span in this number of steps.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not finite, no steps over a span that is not empty,
    /// or so many that t + h = t.
    pub fn with_steps(t_span: [f64; 2], steps: u64) -> Result<Self, Error> {
        let [t0, t1] = t_span;
        let length = Self::check_span(t_span)?;
        if length == 0.0 {
            return Ok(TimeGrid { t0, t1, steps: 0 });
        }
        if steps == 0 {
            return Err(Error::out_of_range("steps", 0.0, "at least 1"));
        }
        let grid = TimeGrid { t0, t1, steps };
        let largest = t0.abs().max(t1.abs());
        if grid.h().abs() < largest - largest.next_down() {
            return Err(Error::out_of_range(
                "dt",
                grid.h().abs(),
                format!("a step that changes t = {largest}"),
            ));
        }
        Ok(grid)
    }

    /// How many steps may be taken from step `n` on without passing `time`: at least one.
    fn last_before(&self, n: u64, time: Option<&f64>) -> Option<u64> {
        let steps = ((*time? - self.t0) / self.h()).floor();
        // One less, for rounding.
        Some((steps as u64).saturating_sub(1).max(n + 1))
    }

    fn check_span([t0, t1]: [f64; 2]) -> Result<f64, Error> {
        for (i, t) in [t0, t1].into_iter().enumerate() {
            if !t.is_finite() {
                return Err(Error::out_of_range(format!("t_span[{i}]"), t, "a finite number"));
            }
        }
        let length = (t1 - t0).abs();
        match length.is_finite() {
            true => Ok(length),
            false => Err(Error::out_of_range("t_span", length, "a finite length")),
        }
    }

    /// t₀ and t₁.
    pub fn t_span(&self) -> [f64; 2] {
        [self.t0, self.t1]
    }
    /// The number of steps.
    pub fn steps(&self) -> u64 {
        self.steps
    }
    /// The step, with its sign; 0 when there are no steps.
    pub fn h(&self) -> f64 {
        if self.steps == 0 { 0.0 } else { (self.t1 - self.t0) / self.steps as f64 }
    }
    /// The time after n steps.
    pub fn time(&self, n: u64) -> f64 {
        if n >= self.steps { self.t1 } else { self.t0 + n as f64 * self.h() }
    }
}

/// Where the observer is called. The start and the end are always among them, once each.
#[derive(Clone, Debug, PartialEq)]
pub enum SaveAt {
    /// At the start and at the end only.
    Ends,
    /// After every so many steps.
    Every(u64),
    /// At these times, in the order of the run. They need not lie on the grid: a time between two
    /// steps is reached by a shorter step of the same method from the one before, which leaves the
    /// run itself as it is.
    Times(Vec<f64>),
}

impl SaveAt {
    /// The number of the next step after `n` that is shown whatever the time.
    fn next_after(&self, n: u64) -> Option<u64> {
        match self {
            SaveAt::Every(every) => Some((n - n % every).saturating_add(*every)),
            SaveAt::Ends | SaveAt::Times(_) => None,
        }
    }

    /// Check against the grid.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for `every = 0`, and for times that are not finite, outside the span,
    /// or not in strict order.
    pub fn check(&self, grid: &TimeGrid) -> Result<(), Error> {
        match self {
            SaveAt::Ends => Ok(()),
            SaveAt::Every(0) => Err(Error::out_of_range("every", 0.0, "at least 1")),
            SaveAt::Every(_) => Ok(()),
            SaveAt::Times(times) => {
                let [t0, t1] = grid.t_span();
                let forward = if t1 >= t0 { 1.0 } else { -1.0 };
                let mut last = f64::NEG_INFINITY;
                for (i, &t) in times.iter().enumerate() {
                    let arg = || format!("times[{i}]");
                    if !(t0.min(t1) <= t && t <= t0.max(t1)) {
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

/// What a run did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Stats {
    /// Steps of the run.
    pub steps: u64,
    /// Shorter steps taken to output times between grid points.
    pub side_steps: u64,
    /// How often the state was looked at, and taken back to M where it had left it
    /// ([`Action::restore_to`]).
    pub restored: u64,
    /// How often the state was left where it was, because it was too far off
    /// ([`RESIDUAL_MAX`](crate::groups::RESIDUAL_MAX)).
    pub not_restored: u64,
    /// A power of two above every residual that was seen there, ‖M⁻¹gᵀMg − 𝟙‖ on a group,
    /// ||x|²/|x₀|² − 1| of a vector under SO(3); 0 when none was. On a compact group it stays near 1e-14. On a
    /// non-compact one rounding level is ε‖g‖²: compare with that.
    pub residual: f64,
}

/// The driver calls [`Action::restore_to`] after every so many steps at most: rounding takes g off its
/// group by some ε a step, and a hundred steps stay below 2e-14 at a hundredth of the cost of one.
pub const RESTORE_EVERY: u64 = 100;
/// The number of steps in between at first, and the least there can be.
const RESTORE_EVERY_MIN: u64 = 8;

/// When to look at the state again: twice as many steps after a residual below 4e-15, half as many
/// after one above 1e-14. What drifts at an even rate stays below the second of them.
#[derive(Clone, Copy, Debug)]
struct Cadence {
    every: u64,
    next: u64,
}

impl Cadence {
    fn new() -> Self {
        Cadence { every: RESTORE_EVERY_MIN, next: RESTORE_EVERY_MIN }
    }
    fn saw<S: Real>(&mut self, residual: S) {
        if residual.all_below(4e-15) {
            self.every = (2 * self.every).min(RESTORE_EVERY);
        } else if !residual.all_below(1e-14) {
            self.every = (self.every / 2).max(RESTORE_EVERY_MIN);
        }
        self.next += self.every;
    }
}

impl Stats {
    fn saw<S: Real>(&mut self, residual: S) {
        match residual.all_below(RESIDUAL_MAX) {
            true => self.restored += 1,
            false => self.not_restored += 1,
        }
        if !residual.all_below(self.residual) && residual.any_below(f64::INFINITY) {
            self.residual = self.residual.max(f64::EPSILON / 4.0);
            while !residual.all_below(self.residual) && self.residual < f64::MAX / 2.0 {
                self.residual *= 2.0;
            }
        }
    }
}

/// What takes the state of a run back to M.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub(crate) struct Mender<P: Problem> {
    work: <P::Action as Action<P::Group>>::Work,
    /// The start of the run: its orbit is where the state is taken back to.
    from: PointOf<P>,
    cadence: Cadence,
}

impl<P: Problem> Mender<P> {
    /// For a method that stays on M, or does not: that one is left as it is.
    pub(crate) fn new(problem: &P, from: &PointOf<P>, stays_on_manifold: bool) -> Self {
        let mut cadence = Cadence::new();
        if !stays_on_manifold {
            cadence.next = u64::MAX;
        }
        Mender { work: problem.action().work(problem.group()), from: from.clone(), cadence }
    }
    /// The number of steps after which y is looked at again.
    #[inline]
    pub(crate) fn next(&self) -> u64 {
        self.cadence.next
    }
    /// After so many steps: is it time to look at y?
    #[inline]
    pub(crate) fn after(&mut self, steps: u64, problem: &P, y: &mut PointOf<P>, stats: &mut Stats) {
        if steps == self.cadence.next {
            let (action, group) = (problem.action(), problem.group());
            match action.restore_to(group, &self.from, y, &mut self.work) {
                Some(residual) => {
                    stats.saw(residual);
                    self.cadence.saw(residual);
                }
                None => self.cadence.next = u64::MAX,
            }
        }
    }
}

/// Is f(t, y) in 𝔤? Asked once, before the first step.
pub(crate) fn check_field<P: Problem>(problem: &P, t: f64, y: &PointOf<P>) -> Result<(), Error> {
    let mut v = problem.group().zero();
    problem.f(ScalarOf::<P>::lit(t), y, &mut v, &mut problem.work());
    problem.group().check("f", &v)
}

/// Why a run ended before its time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The method does not fit the problem, the output times do not fit the grid, or the first value
    /// of f is not in 𝔤 ([`LieAlgebra::check`](crate::LieAlgebra::check)).
    #[error(transparent)]
    Setup(#[from] Error),
    /// A step failed. The state is the last accepted one; what was observed stands.
    #[error(transparent)]
    Step(#[from] Failure),
}

/// Integrate `problem` from y at the start of `grid` to its end, showing (t, y) to `observe` where
/// `save` says. On return y is the state at the end, or the last accepted one.
///
/// Every [`RESTORE_EVERY`] steps, or sooner where it drifts faster, a method that stays on M has its
/// state taken back to M and to the orbit that it started on ([`Action::restore_to`]): without it
/// rounding carries g off its group, and a vector off its sphere, by some ε a step.
///
/// Memory is allocated before the first step only.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::RigidBody;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let mut m = Vector3::new(0.2, 0.0, 3.0);
/// let start = body.energy(&m);
/// let grid = TimeGrid::new([0.0, 10.0], 0.05)?;
/// integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((body.energy(&m) - start).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RunError::Setup`] before anything is observed, [`RunError::Step`] for a step that failed.
pub fn integrate<P: Problem, Me: Method<P>>(
    problem: &P,
    method: &Me,
    grid: &TimeGrid,
    save: &SaveAt,
    y: &mut PointOf<P>,
    mut observe: impl FnMut(f64, &PointOf<P>),
) -> Result<Stats, RunError> {
    save.check(grid)?;
    problem.action().check(problem.group(), y)?;
    let mut work = method.work(problem, y)?;
    let mut aside = y.clone();
    let mut mender = Mender::new(problem, y, method.stays_on_manifold());
    if grid.steps() > 0 {
        check_field(problem, grid.t_span()[0], y)?;
    }
    let mut stats = Stats::default();
    let [t0, t1] = grid.t_span();
    let forward = t1 >= t0;
    let mut times = match save {
        SaveAt::Times(times) => times.as_slice(),
        _ => &[],
    };
    times = times.strip_prefix(&[t0]).unwrap_or(times);
    observe(t0, y);
    let equal = EqualSteps { first: 0, end: grid.steps(), t0, h: grid.h() };
    let fail = |step: u64, h, source| Failure { step, t: grid.time(step), h, source };
    let mut n = 0;
    while n < grid.steps() {
        // Output times within the step that comes next.
        while let [time, rest @ ..] = times
            && (if forward { *time < grid.time(n + 1) } else { *time > grid.time(n + 1) })
        {
            let (t, h) = (grid.time(n), *time - grid.time(n));
            let lit = ScalarOf::<P>::lit;
            problem.action().assign(problem.group(), y, &mut aside);
            method
                .step(problem, Step { n, t: lit(t), h: lit(h) }, &mut aside, &mut work)
                .map_err(|source| fail(n, h, source))?;
            stats.side_steps += 1;
            observe(*time, &aside);
            times = rest;
        }
        let end = [Some(grid.steps()), save.next_after(n), grid.last_before(n, times.first())];
        let end = end.into_iter().flatten().fold(mender.next(), u64::min);
        problem.action().assign(problem.group(), y, &mut aside);
        if let Err((step, source)) =
            method.steps(problem, EqualSteps { first: n, end, ..equal }, y, &mut work)
        {
            // The state of an error is the last accepted one.
            core::mem::swap(y, &mut aside);
            let _ =
                method.steps(problem, EqualSteps { first: n, end: step, ..equal }, y, &mut work);
            return Err(fail(step, grid.h(), source).into());
        }
        n = end;
        stats.steps = n;
        mender.after(n, problem, y, &mut stats);
        let t = grid.time(n);
        let on_grid = match save {
            SaveAt::Every(every) => n.is_multiple_of(*every),
            SaveAt::Times(_) => times.first() == Some(&t),
            SaveAt::Ends => false,
        };
        if on_grid {
            times = times.get(1..).unwrap_or_default();
        }
        if on_grid || n == grid.steps() {
            observe(t, y);
        }
    }
    Ok(stats)
}
