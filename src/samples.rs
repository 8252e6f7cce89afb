//! Sampled data as functions of time: a table of times and values, with interpolation between its rows.
//!
//! | interpolation | between the times | smoothness |
//! |---|---|---|
//! | [`Linear`](Interpolation::Linear) | the straight line between the two values | continuous |
//! | [`Cubic`](Interpolation::Cubic) | the cubic spline through all values | two derivatives are continuous |
//! | [`Previous`](Interpolation::Previous) | the value at the time before, which is held | jumps at the times |
//! | [`MeanRate`](Interpolation::MeanRate) | the rate whose integrals over the intervals are the values | one derivative is continuous |
//!
//! The rate is Θ′. Θ is the cubic spline through the sums of the increments. Splines are *not-a-knot*: the first two
//! pieces are one cubic, and so are the last two. They are exact for cubics. A spline through three points is the
//! parabola, through two points the line.
//!
//! Source: C. de Boor, A Practical Guide to Splines, ch. IV.

use core::fmt;
use core::hash::{Hash, Hasher};

use thiserror::Error as ThisError;

use crate::error::Error;

/// The interpolation between the rows of [`Samples`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Straight lines.
    Linear,
    /// The cubic spline, not-a-knot at its ends.
    Cubic,
    /// The value of each time is held until the next time (zero-order hold), as a command of a controller.
    Previous,
    /// The rate of increments: the value at t_k is the integral over \[t_{k−1}, t_k\], as a gyro gives it. The values at
    /// the first time belong to an interval before the table and are not used.
    MeanRate,
}

impl Interpolation {
    /// Every interpolation.
    pub const ALL: [Interpolation; 4] = [
        Interpolation::Linear,
        Interpolation::Cubic,
        Interpolation::Previous,
        Interpolation::MeanRate,
    ];

    /// The name of the interpolation: `linear`, `cubic`, `previous`, `mean-rate`.
    pub const fn name(self) -> &'static str {
        match self {
            Interpolation::Linear => "linear",
            Interpolation::Cubic => "cubic",
            Interpolation::Previous => "previous",
            Interpolation::MeanRate => "mean-rate",
        }
    }

    /// True if the values jump at the times of the samples.
    pub const fn jumps(self) -> bool {
        matches!(self, Interpolation::Previous)
    }

    /// The interpolation of that name.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn named(name: &str) -> Result<Self, Error> {
        Self::ALL.into_iter().find(|known| known.name() == name).ok_or_else(|| Error::UnknownName {
            kind: "interpolation",
            name: name.into(),
            expected: Self::ALL.map(Interpolation::name).to_vec(),
        })
    }
}

/// A time before the first row of [`Samples`], or after the last one.
#[derive(Clone, Copy, Debug, PartialEq, ThisError)]
#[error("t = {t} lies outside of the samples, which span {} to {}", .span[0], .span[1])]
pub struct Outside {
    /// The time.
    pub t: f64,
    /// The first and the last time of the samples.
    pub span: [f64; 2],
}

impl From<Outside> for Error {
    fn from(Outside { t, span: [first, last] }: Outside) -> Self {
        Error::out_of_range("t", t, format!("a time in the span of the samples, {first} to {last}"))
    }
}

/// Columns of values at increasing times, as functions of time.
///
/// The attitude of a body from the increments of its gyros: ġ = gω̂ with g from body to space, an equation of linear type.
/// ```
/// use lieflow::groups::{LieGroup, So3};
/// use lieflow::methods::magnus::Magnus4;
/// use lieflow::problems::Flow;
/// use lieflow::samples::{Interpolation, Samples};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
///
/// // Each row: the integral of the angular velocity in the body since the row before.
/// let times = [0.0, 0.1, 0.2, 0.3, 0.4];
/// let x = [0.0, 0.010, 0.012, 0.013, 0.012];
/// let y = [0.0, 0.050, 0.049, 0.047, 0.044];
/// let z = [0.0, 0.001, 0.004, 0.006, 0.009];
/// let gyros = Samples::new(&times, &[x, y, z], Interpolation::MeanRate)?;
/// let span = [0.0, 0.4];
/// gyros.covers(span)?;
/// let attitude = Flow::in_body(So3::<f64>::new(), |t, _, omega: &mut Vector3<f64>| {
///     // Outside of the samples ω is not a number, and the run ends there.
///     let _ = gyros.value(t, omega.as_mut_slice());
/// })
/// .linear();
/// let mut g = So3::new().identity();
/// let grid = TimeGrid::with_steps(span, 4)?;
/// integrate(&attitude, &Magnus4, &grid, &SaveAt::Ends, &mut g, |_, _| {})?;
/// assert!((g[(0, 2)] - 0.19).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
/// With a [`TryFlow`](crate::problems::TryFlow) the error of the run has the time at which it left the samples.
#[derive(Clone, PartialEq)]
pub struct Samples {
    times: Vec<f64>,
    columns: usize,
    interpolation: Interpolation,
    /// The polynomials in t − t_k, lowest power first: all columns of an interval, then the next interval.
    pieces: Vec<[f64; 4]>,
    /// Rows per time, if the times are even enough that this finds an interval or one next to it.
    pace: Option<f64>,
}

/// Of the times and of the pieces between them, by their bits.
impl Hash for Samples {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.interpolation.hash(state);
        let numbers = self.times.iter().chain(self.pieces.iter().flatten());
        numbers.for_each(|x| x.to_bits().hash(state));
    }
}

impl Samples {
    /// The samples `columns[j][k]` at `times[k]`.
    ///
    /// The cost is O(n) for a column of n values. The storage is four numbers for each value.
    ///
    /// # Errors
    /// [`Error::Length`] for fewer than 2 times, and for a column of another length than the times. [`Error::OutOfRange`],
    /// which names the entry, for: times that do not increase; a number that is not finite; values so far apart that their
    /// slope, or a coefficient of the curve, is not finite. Of all intervals whose curve is not finite, the entry is at the end
    /// of the steepest.
    pub fn new<C: AsRef<[f64]>>(
        times: &[f64],
        columns: &[C],
        interpolation: Interpolation,
    ) -> Result<Self, Error> {
        let n = times.len();
        if n < 2 {
            let expected = "at least 2".into();
            return Err(Error::Length { arg: "times".into(), found: n, expected });
        }
        Error::all_finite("times", times)?;
        for (k, &t) in times.iter().enumerate() {
            if k > 0 && t <= times[k - 1] {
                let expected = format!("more than {}, the time before it", times[k - 1]);
                return Err(Error::out_of_range(format!("times[{k}]"), t, expected));
            }
        }
        let length = times[n - 1] - times[0];
        if !length.is_finite() {
            return Err(Error::out_of_range("times", length, "times that span a finite length"));
        }
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        // A value that is held is that of the last time, too.
        let intervals = if interpolation.jumps() { n } else { n - 1 };
        let mut pieces = vec![[0.0; 4]; intervals * columns.len()];
        for (j, column) in columns.iter().enumerate() {
            let values = column.as_ref();
            if values.len() != n {
                let (arg, found) = (format!("columns[{j}]"), values.len());
                return Err(Error::Length {
                    arg,
                    found,
                    expected: format!("{n} as there are times"),
                });
            }
            Error::all_finite(&format!("columns[{j}]"), values)?;
            let means = means(&steps, values, interpolation);
            let fitted = fit(&steps, values, &means, interpolation);
            // The first one of the steepest.
            let infinite =
                (0..fitted.len()).rev().filter(|&k| fitted[k].iter().any(|x| !x.is_finite()));
            if let Some(k) = infinite.max_by(|&a, &b| means[a].abs().total_cmp(&means[b].abs())) {
                let arg = format!("columns[{j}][{}]", k + 1);
                let expected = "a value whose slope from the one before is finite, and so is the curve through it";
                return Err(Error::out_of_range(arg, values[k + 1], expected));
            }
            for (k, piece) in fitted.into_iter().enumerate() {
                pieces[k * columns.len() + j] = piece;
            }
        }
        let pace = (n - 1) as f64 / length;
        let even = |(k, t): (usize, &f64)| ((t - times[0]) * pace - k as f64).abs() < 1.0;
        let pace = times.iter().enumerate().all(even).then_some(pace);
        Ok(Samples { times: times.into(), columns: columns.len(), interpolation, pieces, pace })
    }

    /// The first and the last time.
    pub fn span(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }
    /// The number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }
    /// The interpolation between the rows.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// Checks that both times of a span lie in the samples. Call it before a run.
    ///
    /// # Errors
    /// The first time that does not.
    pub fn covers(&self, times: [f64; 2]) -> Result<(), Outside> {
        times.into_iter().try_for_each(|t| self.find(t).map(drop))
    }

    /// out ← the values of all columns at t.
    ///
    /// The cost is a search and a cubic for each column. The search is O(1) for even times, O(log n) for others.
    ///
    /// # Errors
    /// [`Outside`] for a t that is outside the span by more than rounding, 4 ulp of the larger of its ends. Then out is
    /// NaN.
    ///
    /// # Panics
    /// If `out` is longer than the number of columns. A shorter `out` gets the first columns.
    pub fn value(&self, t: f64, out: &mut [f64]) -> Result<(), Outside> {
        let found = self.find(t);
        for (j, out) in out.iter_mut().enumerate() {
            *out = found.map_or(f64::NAN, |(k, s)| polynomial(self.piece(k, j), s));
        }
        found.map(drop)
    }

    /// The value of column j at t.
    ///
    /// # Errors
    /// As [`value`](Self::value).
    ///
    /// # Panics
    /// Where there is no column j.
    pub fn column(&self, j: usize, t: f64) -> Result<f64, Outside> {
        self.derivative(j, 0, t)
    }

    /// The derivative of some order of column j at t. Where it jumps, this is the derivative after t.
    ///
    /// # Errors
    /// As [`value`](Self::value).
    ///
    /// # Panics
    /// Where there is no column j.
    pub fn derivative(&self, j: usize, order: usize, t: f64) -> Result<f64, Outside> {
        let (k, s) = self.find(t)?;
        let mut piece = self.piece(k, j);
        for _ in 0..order.min(4) {
            piece = [piece[1], 2.0 * piece[2], 3.0 * piece[3], 0.0];
        }
        Ok(polynomial(piece, s))
    }

    /// The times inside a span where the pieces do not join to one polynomial, in rising order.
    ///
    /// A step that ends at such a time has the full order of its method. For [`Interpolation::Linear`] these are all
    /// inner times, for splines all inner times but the first and the last. For [`Interpolation::Previous`] these are all
    /// times but the first, and those at the ends of the span count: the value just before such a time is another one.
    pub fn knots(&self, [from, to]: [f64; 2]) -> impl DoubleEndedIterator<Item = f64> {
        let (n, jumps) = (self.times.len(), self.interpolation.jumps());
        let knots = match self.interpolation {
            Interpolation::Linear => 1..n - 1,
            Interpolation::Cubic | Interpolation::MeanRate => 2..n - 2,
            Interpolation::Previous => 1..n,
        };
        let knots = self.times.get(knots).unwrap_or_default();
        let (low, high) = (from.min(to), from.max(to));
        let inside = move |t: &f64| low < *t && *t < high || jumps && (*t == low || *t == high);
        knots.iter().copied().filter(inside)
    }

    fn piece(&self, k: usize, j: usize) -> [f64; 4] {
        self.pieces[k * self.columns..][..self.columns][j]
    }

    /// The interval of t, and t minus the start of the interval.
    fn find(&self, t: f64) -> Result<(usize, f64), Outside> {
        let span @ [first, last] = self.span();
        let inside = t.clamp(first, last);
        let rounding = 4.0 * f64::EPSILON * first.abs().max(last.abs());
        if t.is_nan() || (t - inside).abs() > rounding {
            return Err(Outside { t, span });
        }
        // The times at which another interval begins. A value that is held has one at the last time.
        let intervals = self.times.len() - usize::from(!self.interpolation.jumps());
        let inner = &self.times[1..intervals];
        let mut k = match self.pace {
            Some(pace) => (((inside - first) * pace) as usize).min(inner.len()),
            None => inner.partition_point(|knot| *knot <= inside),
        };
        while k > 0 && inside < self.times[k] {
            k -= 1;
        }
        while k < inner.len() && inside >= inner[k] {
            k += 1;
        }
        Ok((k, inside - self.times[k]))
    }
}

/// Shows the size, not the numbers.
impl fmt::Debug for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (rows, columns) = (self.times.len(), self.columns);
        write!(f, "Samples({rows}×{columns} over {:?}, {:?})", self.span(), self.interpolation)
    }
}

fn polynomial([a, b, c, d]: [f64; 4], s: f64) -> f64 {
    a + s * (b + s * (c + s * d))
}

/// The mean slope of the curve in each interval; of [`Interpolation::MeanRate`] the mean rate.
fn means(steps: &[f64], values: &[f64], interpolation: Interpolation) -> Vec<f64> {
    let mean = |(k, h): (usize, &f64)| match interpolation {
        Interpolation::MeanRate => values[k + 1] / h,
        _ => (values[k + 1] - values[k]) / h,
    };
    steps.iter().enumerate().map(mean).collect()
}

/// The polynomials of a column in the time since the start of their interval. Of values that are held there is one at the
/// last time, too.
fn fit(
    steps: &[f64],
    values: &[f64],
    means: &[f64],
    interpolation: Interpolation,
) -> Vec<[f64; 4]> {
    if interpolation == Interpolation::Previous {
        return values.iter().map(|x| [*x, 0.0, 0.0, 0.0]).collect();
    }
    let slopes = spline(steps, means);
    let piece = |(k, h): (usize, &f64)| {
        let [before, after] = [slopes[k], slopes[k + 1]];
        let second = (3.0 * means[k] - 2.0 * before - after) / h;
        let third = (before + after - 2.0 * means[k]) / h / h;
        match interpolation {
            Interpolation::Linear => [values[k], means[k], 0.0, 0.0],
            Interpolation::Cubic => [values[k], before, second, third],
            Interpolation::MeanRate => [before, 2.0 * second, 3.0 * third, 0.0],
            Interpolation::Previous => [values[k], 0.0, 0.0, 0.0],
        }
    };
    steps.iter().enumerate().map(piece).collect()
}

/// The slopes at the ends of intervals of the not-a-knot spline with these mean slopes over them: the second
/// derivative is continuous at every inner end, and the third at the first and the last of them.
fn spline(steps: &[f64], means: &[f64]) -> Vec<f64> {
    let n = means.len();
    if n < 3 {
        // A line, or a parabola: its slope is linear in t.
        let (first, last) = (means[0], means[n - 1]);
        let bend = (last - first) / (steps[0] + steps[n - 1]);
        return match n {
            1 => vec![first; 2],
            _ => vec![first - bend * steps[0], first + bend * steps[0], last + bend * steps[1]],
        };
    }
    // The parts of the interval before and of the one after in the two around the end k.
    let parts = |k: usize| {
        let both = steps[k - 1] + steps[k];
        (steps[k - 1] / both, steps[k] / both)
    };
    // Elimination of a tridiagonal matrix: s_k + above_k s_{k+1} = slopes_k.
    let (mut above, mut slopes) = (vec![0.0; n], vec![0.0; n + 1]);
    let (p, q) = parts(1);
    above[0] = 1.0 / q;
    slopes[0] = (2.0 + p) * means[0] + p * p * means[1] / q;
    for k in 1..n {
        let (p, q) = parts(k);
        let pivot = 2.0 - q * above[k - 1];
        above[k] = p / pivot;
        slopes[k] = (3.0 * (q * means[k - 1] + p * means[k]) - q * slopes[k - 1]) / pivot;
    }
    let (p, q) = parts(n - 1);
    let right = (2.0 + q) * p * means[n - 1] + q * q * means[n - 2];
    slopes[n] = (right - slopes[n - 1]) / (p - above[n - 1]);
    for k in (0..n).rev() {
        slopes[k] -= above[k] * slopes[k + 1];
    }
    slopes
}
