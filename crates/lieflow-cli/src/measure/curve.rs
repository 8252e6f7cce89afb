//! A method's line in the plot of time against error.

use lieflow_timing::Fit;
use serde::{Deserialize, Serialize};

use super::journal::number;
use super::{Candidate, Size};

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkPoint {
    /// How large its steps were.
    pub size: Size,
    /// Its number of steps.
    pub steps: u64,
    /// Attempts that were rejected.
    pub rejected: u64,
    /// Its step size; the mean where each step has its own.
    #[serde(with = "number")]
    pub h: f64,
    /// Evaluations of f, where they were counted.
    pub evaluations: Option<u64>,
    /// Its operations, with those of rejected attempts. None if they cannot be counted.
    pub operations: Option<u64>,
    /// Relative distance of the final state from the reference.
    #[serde(with = "number")]
    pub error: f64,
    /// Relative change of the energy from the start to the end.
    #[serde(with = "number")]
    pub energy_error: f64,
    /// Relative change of a Casimir from the start to the end.
    #[serde(with = "number")]
    pub casimir_error: f64,
    /// Distance of the final state from its group, where it has one.
    #[serde(with = "number")]
    pub group_residual: f64,
    /// The distance of the final state from M, by what the action keeps: relative, but for a distance from a group.
    #[serde(with = "number")]
    pub off_manifold: f64,
    /// CPU time per unit of simulated time.
    #[serde(with = "number")]
    pub seconds_per_unit: f64,
    /// CPU time of the first run without output, or the second of a short one.
    #[serde(with = "number")]
    pub first_seconds: f64,
    /// CPU time of the output of a run, which is part of its time.
    #[serde(with = "number")]
    pub output_seconds: f64,
    /// Why the run stopped early, when it did.
    pub failure: Option<String>,
}

impl WorkPoint {
    /// A run of which nothing is known yet.
    pub fn new(t_span: [f64; 2], size: Size) -> Self {
        let steps = match size {
            Size::Steps(steps) => steps,
            Size::Tolerance(_) => 0,
        };
        WorkPoint {
            size,
            steps,
            rejected: 0,
            h: (t_span[1] - t_span[0]).abs() / steps as f64,
            evaluations: None,
            operations: None,
            error: f64::NAN,
            energy_error: f64::NAN,
            casimir_error: f64::NAN,
            group_residual: f64::NAN,
            off_manifold: f64::NAN,
            seconds_per_unit: f64::NAN,
            first_seconds: f64::NAN,
            output_seconds: 0.0,
            failure: None,
        }
    }

    /// CPU time of the output per unit of simulated time.
    fn output_per_unit(&self) -> f64 {
        self.output_seconds / self.length()
    }

    /// The simulated time.
    pub fn length(&self) -> f64 {
        self.h * self.steps as f64
    }
}

/// Where a method reaches an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// CPU time per unit of simulated time, without rows of output; with them where they are all that is computed.
    pub seconds: f64,
    /// CPU time of the rows of output.
    pub output: f64,
    /// The simulated time of the run.
    pub length: f64,
    /// The step.
    pub h: f64,
    /// The number of steps.
    pub steps: u64,
    /// The tolerance, of a method that chooses its steps.
    pub tolerance: Option<f64>,
    /// The energy error.
    pub energy_error: f64,
    /// The distance from M.
    pub off_manifold: f64,
}

impl Reached {
    /// The size of the steps.
    pub fn size(&self) -> Size {
        self.tolerance.map_or(Size::Steps(self.steps), Size::Tolerance)
    }

    /// CPU time of the run without rows of output, or with them where they are all that is computed.
    pub fn run_seconds(&self) -> f64 {
        self.seconds * self.length
    }

    /// CPU time of the run with its rows of output.
    pub fn seconds_with_rows(&self) -> f64 {
        (self.seconds + self.output) * self.length
    }
}

/// A run with a larger error has lost the solution.
pub(super) const OFF: f64 = 0.1;

/// A number that a person types: two digits, rounded down.
fn rounded_down(x: f64) -> f64 {
    let unit = x.log10().floor() - 1.0;
    let digits = (x / 10f64.powf(unit)).floor();
    format!("{digits}e{unit}").parse().unwrap_or(x)
}

/// The runs that no other run beats in both error and cost, as (curve, point), from the largest error
/// to the smallest. A run without a cost is none, nor one that is more than a tenth off.
pub fn pareto(
    curves: &[Curve],
    cost: impl Fn(&Curve, &WorkPoint) -> Option<f64>,
) -> Vec<(usize, usize)> {
    let both = |(i, j): (usize, usize)| {
        let point: &WorkPoint = &curves[i].points[j];
        (curves[i].error(point), cost(&curves[i], point).unwrap_or(f64::INFINITY))
    };
    let places = |(i, curve): (usize, &Curve)| (0..curve.points.len()).map(move |j| (i, j));
    let mut all: Vec<(usize, usize)> = curves.iter().enumerate().flat_map(places).collect();
    all.retain(|at| (0.0..=OFF).contains(&both(*at).0));
    all.sort_by(|a, b| {
        let (a, b) = (both(*a), both(*b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut least = f64::INFINITY;
    all.retain(|at| {
        let (_, cost) = both(*at);
        let kept = cost < least;
        least = least.min(cost);
        kept
    });
    all.reverse();
    all
}

/// The runs of one method, from the largest step to the smallest.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The method.
    pub candidate: Candidate,
    /// Its name in tables and figures.
    pub label: String,
    /// The order that it should have. None if it is exact.
    pub order: Option<usize>,
    /// Do its steps stay on M?
    pub stays: bool,
    /// Smaller errors are rounding.
    pub floor: f64,
    /// The runs.
    pub points: Vec<WorkPoint>,
}

/// Errors outside of this range say nothing of the order: larger ones are not yet asymptotic,
/// smaller ones are rounding.
const ASYMPTOTIC: core::ops::Range<f64> = 1e-12..1e-1;
/// An error is clear of the floor if it is larger by this factor.
const CLEAR: f64 = 10.0;
/// Larger errors that no longer fall are no rounding, unless the floor is as large.
const ROUNDING_MOST: f64 = 1e-4;
/// An error is clear of rounding that shows if it is larger by this factor.
const ABOVE: f64 = 3.0;
/// Rounding has begun where the slope falls below this part of the slope of the pair of runs before.
const STEADY: f64 = 0.7;
/// Two slopes agree if they differ by no more than this part of the larger one.
const AGREE: f64 = 0.15;
/// A run that was made is taken where the steps on the line to it are longer by at most this factor.
const NEARLY: f64 = 1.1;
/// Two step sizes have a slope if they differ by this factor.
const APART: f64 = 1.2;
/// The largest number of slopes that an order is measured with.
const SLOPES_MAX: usize = 3;

impl Curve {
    /// The error of a run, at least the floor: a smaller one cannot be measured.
    pub fn error(&self, point: &WorkPoint) -> f64 {
        if point.error < self.floor { self.floor } else { point.error }
    }

    /// CPU time of a run per unit of simulated time, without rows of output. The exact motion computes nothing else.
    pub fn seconds(&self, point: &WorkPoint) -> f64 {
        match self.order {
            Some(_) => point.seconds_per_unit - point.output_per_unit(),
            None => point.seconds_per_unit,
        }
    }

    /// CPU time of the rows of output that is not in [`seconds`](Self::seconds).
    fn output(&self, point: &WorkPoint) -> f64 {
        point.seconds_per_unit - self.seconds(point)
    }

    /// Does it leave M by a distance that is known?
    pub fn leaves(&self) -> bool {
        !self.stays && self.points.iter().any(|point| !point.off_manifold.is_nan())
    }

    /// log(error ratio)/log(step ratio) of each run and the run before it. Steps of nearly the same size have none.
    pub fn slopes(&self) -> Vec<Option<f64>> {
        let slope = |pair: &[WorkPoint]| {
            let ratio = pair[0].h / pair[1].h;
            let slope = (pair[0].error / pair[1].error).ln() / ratio.ln();
            Some(slope).filter(|slope| slope.is_finite() && ratio >= APART)
        };
        let first = self.points.first().map(|_| None);
        first.into_iter().chain(self.points.windows(2).map(slope)).collect()
    }

    /// The size of the rounding errors: the floor of the reference, or the smallest error where smaller steps no longer
    /// help. Rounding errors of many small steps are above the floor.
    pub fn rounding(&self) -> f64 {
        let finite = || self.points.iter().enumerate().filter(|(_, run)| run.error > 0.0);
        let Some((least, run)) = finite().min_by(|a, b| a.1.error.total_cmp(&b.1.error)) else {
            return self.floor;
        };
        let slopes = self.slopes();
        let last = slopes.len() - 1;
        let falls = match slopes[..].last_chunk() {
            Some([Some(before), Some(last)]) => *last >= STEADY * before,
            _ => true,
        };
        let is_floor = least == last && falls || run.error > ROUNDING_MOST;
        if is_floor { self.floor } else { run.error.max(self.floor) }
    }

    /// The measured order: the slope of the least-squares line through log h, log error. The line goes through the
    /// smallest runs that are clear of rounding and whose slopes agree. `None` if these are fewer than three.
    pub fn measured_order(&self) -> Option<f64> {
        let rounding = (CLEAR * self.floor).max(ABOVE * self.rounding());
        let is_clear = |run: &WorkPoint| ASYMPTOTIC.contains(&run.error) && run.error > rounding;
        let slopes = self.slopes();
        // The slope into a run, if both of its runs are clear.
        let clear = |i: usize| {
            let both = is_clear(&self.points[i - 1]) && is_clear(&self.points[i]);
            slopes[i].filter(|slope| both && *slope > 0.0)
        };
        // The smaller one of the slope into a run and that before it, where they agree.
        let agreed = |i: usize| {
            let (a, b) = clear(i - 1).zip(clear(i))?;
            ((a - b).abs() <= AGREE * a.max(b)).then_some(a.min(b))
        };
        // Slopes of rounding may agree by chance. They are small.
        let steepest = (2..slopes.len()).filter_map(agreed).fold(0.0, f64::max);
        let is_steep = |i: &usize| agreed(*i).is_some_and(|slope| slope >= STEADY * steepest);
        let end = (2..slopes.len()).rev().find(is_steep)?;
        let more = (2..end).rev().take(SLOPES_MAX - 2).take_while(is_steep).count();
        let used = &self.points[end - 2 - more..=end];
        used.iter().map(|run| (run.h.ln(), run.error.ln())).collect::<Fit>().slope()
    }

    /// Adds a run at its place.
    pub(super) fn insert(&mut self, point: WorkPoint) {
        let is_coarser = |p: &WorkPoint| match (p.size, point.size) {
            (Size::Steps(a), Size::Steps(b)) => a < b,
            (Size::Tolerance(a), Size::Tolerance(b)) => a > b,
            _ => true,
        };
        self.points.insert(self.points.partition_point(is_coarser), point);
    }

    /// Where this error is reached soonest, by a run or between two by the line through them in the
    /// logarithms; `None` where no run reaches it.
    pub fn reached(&self, error: f64) -> Option<Reached> {
        self.reached_where(error, |_| true)
    }

    /// Where this error is reached soonest among what passes. A run that is more accurate may pass where the
    /// soonest does not.
    pub fn reached_where(&self, error: f64, pass: impl Fn(&Reached) -> bool) -> Option<Reached> {
        let passing = self.all_that_reach(error).into_iter().filter(pass);
        passing.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }

    /// The run that reaches this error soonest; `None` where no run reaches it. Advice is a run and no point between two.
    pub fn run_to(&self, error: f64) -> Option<Reached> {
        let runs = self.all_that_reach(error).into_iter().skip(1);
        runs.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    }

    /// The runs that count.
    fn runs(&self) -> Vec<&WorkPoint> {
        self.points.iter().filter(|p| p.error >= 0.0 && p.seconds_per_unit > 0.0).collect()
    }

    /// The size of the first run that reaches this error, and the one in the middle between it and the run before.
    pub(super) fn middle(&self, error: f64) -> Option<[Size; 2]> {
        let runs = self.runs();
        let after = runs.iter().position(|p| p.error <= error)?;
        let (a, b) = (runs.get(after.checked_sub(1)?)?.size, runs[after].size);
        let middle = match (a, b) {
            (Size::Tolerance(x), Size::Tolerance(y)) => {
                Size::Tolerance(rounded_down((x * y).sqrt()))
            }
            (Size::Steps(n), Size::Steps(m)) => {
                Size::Steps((n as f64 * m as f64).sqrt().ceil() as u64)
            }
            _ => return None,
        };
        Some([b, middle])
    }

    /// The largest steps that reach this error, by a run or between two, and then the runs with smaller steps that do.
    pub(super) fn all_that_reach(&self, error: f64) -> Vec<Reached> {
        // Nobody can tell who reaches an error below the floor.
        if error < self.floor {
            return Vec::new();
        }
        let runs = self.runs();
        let log_error = |p: &WorkPoint| self.error(p).ln();
        let Some(after) = runs.iter().position(|p| p.error <= error) else { return Vec::new() };
        let b = runs[after];
        // The coarsest run may do, and one that is far off says nothing of what lies behind it.
        let before = after.checked_sub(1).map(|before| runs[before]);
        // Nor does one whose error falls faster than the step explains: where f jumps, steps that end at the
        // jumps are exact, and none between two of them is.
        let explained = |a: &WorkPoint| match (b.size, self.order) {
            (Size::Steps(_), Some(order)) => {
                // Near rounding a run may be more accurate than it should.
                let slope = (a.error / self.error(b).max(1e-12)).ln() / (a.h / b.h).ln();
                slope <= 2.0 * order as f64 + 2.0
            }
            _ => true,
        };
        let a = before.filter(|run| run.error <= OFF && explained(run)).unwrap_or(b);
        let share = match log_error(a) - log_error(b) {
            0.0 => 0.0,
            way => (log_error(a) - error.ln()) / way,
        };
        let between = |x: f64, y: f64| (x.ln() + share * (y.ln() - x.ln())).exp();
        // Where it is exactly 0 there is no line in the logarithms.
        let error_between = |x: f64, y: f64| if x.min(y) > 0.0 { between(x, y) } else { x.max(y) };
        let tolerance = match (a.size, b.size) {
            (Size::Tolerance(x), Size::Tolerance(y)) => Some(rounded_down(between(x, y))),
            _ => None,
        };
        let between = Reached {
            seconds: between(self.seconds(a), self.seconds(b)),
            output: self.output(b),
            h: between(a.h, b.h),
            // Rounding adds no step.
            steps: (between(a.steps as f64, b.steps as f64) * (1.0 - 1e-9)).ceil() as u64,
            length: b.length(),
            tolerance,
            energy_error: error_between(a.energy_error, b.energy_error),
            off_manifold: error_between(a.off_manifold, b.off_manifold),
        };
        let of_run = |p: &&WorkPoint| Reached {
            seconds: self.seconds(p),
            output: self.output(p),
            h: p.h,
            steps: p.steps,
            length: p.length(),
            tolerance: match p.size {
                Size::Tolerance(rtol) => Some(rtol),
                Size::Steps(_) => None,
            },
            energy_error: p.energy_error,
            off_manifold: p.off_manifold,
        };
        let is_run = between.size() == b.size || between.h <= NEARLY * b.h;
        let between = if is_run { of_run(&b) } else { between };
        // Where a run costs little more than its beginning, a more accurate one may be as fast.
        let measured = runs[after..].iter().filter(|p| p.error <= error).map(of_run);
        core::iter::once(between).chain(measured).collect()
    }

    /// The time per unit of simulated time at which this error is reached.
    pub fn seconds_to(&self, error: f64) -> Option<f64> {
        self.reached(error).map(|reached| reached.seconds)
    }

    /// CPU time of one step without output, at the smallest step.
    pub fn seconds_per_step(&self) -> Option<f64> {
        let last = self.points.iter().rev().find(|p| p.seconds_per_unit > 0.0)?;
        Some(self.seconds(last) * last.h)
    }
}
