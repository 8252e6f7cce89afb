//! Axes: from data to pixels, and where the ticks are.

use std::borrow::Cow;

use crate::number::{fixed, grouped, power_of_ten, seconds, seconds_short, short, sig};

/// How the values of an axis are spread over its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Equal steps for equal differences.
    Linear,
    /// Equal steps for equal ratios; only values above zero can be drawn.
    Log10,
    /// Logarithmic in both directions from zero, and about linear for values below `linear`.
    SymLog {
        /// The magnitude at which the scale changes from linear to logarithmic.
        linear: f64,
    },
}

impl Scale {
    /// Whether `value` has a place on this scale.
    pub(crate) fn accepts(self, value: f64) -> bool {
        // The bound keeps differences of two values finite.
        value.abs() < 1e300 && (self != Scale::Log10 || value > 0.0)
    }

    /// The coordinate in which this scale is linear.
    pub(crate) fn warp(self, value: f64) -> f64 {
        match self {
            Scale::Linear => value,
            Scale::Log10 => value.log10(),
            Scale::SymLog { linear } => {
                value.signum() * (value.abs() / linear.max(f64::MIN_POSITIVE)).ln_1p()
                    / std::f64::consts::LN_10
            }
        }
    }
}

/// An axis, which follows the range of the data.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The quantity: `"CPU time"`.
    pub title: String,
    /// The unit; empty where there is none, or where the scene decides.
    pub unit: Cow<'static, str>,
    /// The scale.
    pub scale: Scale,
    /// True if each label has its own unit of time, as in `20 µs`.
    durations: bool,
}

impl Axis {
    /// An axis of this title and scale.
    pub fn new(title: impl Into<String>, scale: Scale) -> Self {
        Axis { title: title.into(), unit: "".into(), scale, durations: false }
    }

    /// The axis in this unit.
    pub fn with_unit(self, unit: impl Into<Cow<'static, str>>) -> Self {
        Axis { unit: unit.into(), ..self }
    }

    /// The axis of durations in seconds. Each label has its own unit of time, as in `20 µs`.
    pub fn of_durations(self) -> Self {
        Axis { unit: "s".into(), durations: true, ..self }
    }

    /// True for an axis of durations.
    pub(crate) fn is_of_durations(&self) -> bool {
        self.durations
    }

    /// A linear axis.
    pub fn linear(title: impl Into<String>) -> Self {
        Axis::new(title, Scale::Linear)
    }

    /// A logarithmic axis.
    pub fn log(title: impl Into<String>) -> Self {
        Axis::new(title, Scale::Log10)
    }

    /// The title with the unit, as in "energy (J)".
    pub(crate) fn title_with_unit(&self) -> String {
        match &*self.unit {
            "" => self.title.clone(),
            unit => format!("{} ({unit})", self.title),
        }
    }

    /// The title beside the labels of a map: with the unit, if they do not have it, and with the offset and the power of
    /// ten that they leave out, as in "energy − 0.00515 (10⁻⁹ J)".
    pub(crate) fn title_beside(
        &self,
        &Map { offset, lo, hi, power, in_seconds, .. }: &Map,
    ) -> String {
        let unit = match (power, &*self.unit) {
            (0, "") => String::new(),
            (0, _) if in_seconds => String::new(),
            (0, unit) => format!(" ({unit})"),
            (power, "") => format!(" (×{})", power_of_ten(power)),
            (power, unit) => format!(" ({} {unit})", power_of_ten(power)),
        };
        if offset == 0.0 {
            return format!("{}{unit}", self.title);
        }
        let range = hi - lo;
        let digits = offset.abs().log10().floor() - range.log10().ceil() + 1.0;
        let value = short(offset.abs(), digits as usize);
        let sign = if offset < 0.0 { '+' } else { '−' };
        format!("{} {sign} {value}{unit}", self.title)
    }

    /// `value` of this axis for people, with its unit.
    pub(crate) fn value_text(&self, value: f64) -> String {
        match &*self.unit {
            _ if self.durations => seconds(value),
            "" => sig(value, 3),
            unit => format!("{}\u{a0}{unit}", sig(value, 3)),
        }
    }

    /// The map of this axis to the pixels `from..to`, with `padding` (a fraction of the length)
    /// at both ends of the data.
    pub(crate) fn map(
        &self,
        data: impl Iterator<Item = f64>,
        pixels: (f64, f64),
        padding: f64,
    ) -> Map {
        let scale = self.scale;
        let placed = data.filter(|v| scale.accepts(*v)).map(|v| scale.warp(v));
        let (lo, hi) = padded(placed, padding);
        let offset = if scale == Scale::Linear { offset(lo, hi) } else { 0.0 };
        let in_seconds = self.durations && offset == 0.0;
        let power = match scale {
            Scale::Linear if !in_seconds => power_of((lo - offset).abs().max((hi - offset).abs())),
            _ => 0,
        };
        Map { scale, lo, hi, offset, power, in_seconds, from: pixels.0, to: pixels.1 }
    }
}

/// A shorter range is none: powers of ten and ratios of such numbers would be rounded to 0.
const SHORTEST: f64 = 1e-290;

/// The range of `values` with padding; a range around the value if there is but one.
fn padded(values: impl Iterator<Item = f64>, padding: f64) -> (f64, f64) {
    let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| (r.0.min(v), r.1.max(v)));
    if lo > hi {
        return (0.0, 1.0);
    }
    let extent = hi - lo;
    if extent <= 1e-12 * lo.abs().max(hi.abs()) || extent < SHORTEST {
        let half = if lo.abs() < SHORTEST { 1.0 } else { 0.5 * lo.abs() };
        return (lo - half, hi + half);
    }
    (lo - padding * extent, hi + padding * extent)
}

/// What labels leave out where they would be long: a value in the range, in few digits.
fn offset(lo: f64, hi: f64) -> f64 {
    let extent = hi - lo;
    if extent > 1e-4 * lo.abs().max(hi.abs()) {
        return 0.0;
    }
    let unit = 10f64.powf(extent.log10().ceil());
    (0.5 * (lo + hi) / unit).round() * unit
}

/// The power of ten that labels of numbers up to this size leave out; 0 of sizes that are written plainly.
fn power_of(size: f64) -> i32 {
    if (1e-3..1e6).contains(&size) { 0 } else { size.log10().floor() as i32 }
}

/// An axis with its range, laid out over pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map {
    pub(crate) scale: Scale,
    /// The ends of the range in the warped coordinate.
    pub(crate) lo: f64,
    pub(crate) hi: f64,
    /// What is left out of the labels; 0 on most axes.
    pub(crate) offset: f64,
    /// The power of ten that is left out of the labels; 0 on most axes.
    pub(crate) power: i32,
    /// Do the labels have units of time?
    pub(crate) in_seconds: bool,
    /// The pixels of these ends.
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// A grid line, with a label if there is room for it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: Option<String>,
    pub(crate) major: bool,
    /// Its number on an even axis: where labels have no room, every second or fifth of these keeps its own.
    pub(crate) number: Option<i64>,
}

impl Map {
    /// The pixel of `value`, if it has one (also outside of the range).
    pub(crate) fn pixel(&self, value: f64) -> Option<f64> {
        self.scale.accepts(value).then(|| self.place(self.scale.warp(value)))
    }

    /// Whether a pixel is within the range.
    pub(crate) fn contains(&self, pixel: f64) -> bool {
        let (a, b) = (self.from.min(self.to), self.from.max(self.to));
        (a - 1e-6..=b + 1e-6).contains(&pixel)
    }

    fn place(&self, warped: f64) -> f64 {
        self.from + (warped - self.lo) / (self.hi - self.lo) * (self.to - self.from)
    }

    /// The grid lines within the range, with labels about `spacing` pixels or more apart.
    pub(crate) fn ticks(&self, spacing: f64) -> Vec<Tick> {
        let labels = ((self.to - self.from).abs() / spacing).max(1.0);
        let found = match self.scale {
            Scale::Linear => {
                let ends = (self.lo - self.offset, self.hi - self.offset);
                let ticks = linear_ticks(ends, labels, self.power);
                let with_offset =
                    |found: Found| Found { value: found.value + self.offset, ..found };
                ticks.into_iter().map(with_offset).collect()
            }
            Scale::Log10 => log_ticks(self.lo, self.hi, labels),
            Scale::SymLog { linear } => self.symlog_ticks(linear.max(f64::MIN_POSITIVE), labels),
        };
        let placed = found.into_iter().filter_map(|Found { value, label, major, number }| {
            let label = match label {
                Some(_) if self.in_seconds => Some(seconds_short(value)),
                label => label,
            };
            let at = self.pixel(value).filter(|at| self.contains(*at))?;
            Some(Tick { at, label, major, number })
        });
        placed.collect()
    }

    fn symlog_ticks(&self, linear: f64, labels: f64) -> Vec<Found> {
        let first = linear.log10().ceil() as i32;
        let decades = (self.lo.abs().max(self.hi.abs()).ceil() as i32).max(1);
        let step = stride((self.hi - self.lo).ceil(), labels);
        let zero = Some("0".to_string());
        let mut ticks = vec![Found { value: 0.0, label: zero, major: true, number: Some(0) }];
        for i in 0..=decades {
            // The labels count from the largest decade in steps, and leave zero its room.
            let label = (i % step == 0 && i > 0).then(|| power_of_ten(first + i));
            let (value, major) = (10f64.powi(first + i), label.is_some());
            let minus = label.as_ref().map(|label| format!("−{label}"));
            let number = i64::from(i / step);
            ticks.push(Found { value, label, major, number: Some(number) });
            ticks.push(Found { value: -value, label: minus, major, number: Some(-number) });
        }
        ticks
    }
}

/// A grid line before it has a place.
struct Found {
    value: f64,
    label: Option<String>,
    major: bool,
    number: Option<i64>,
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten, with labels in units of a power of ten.
fn linear_ticks((lo, hi): (f64, f64), labels: f64, power: i32) -> Vec<Found> {
    let step = nice_step((hi - lo) / labels);
    let first = (lo / step - 1e-9).ceil();
    let count = (hi / step + 1e-9).floor() - first;
    let fine = (step.log10() + 1e-9).floor() as i32;
    let decimals = (power - fine).max(0) as usize;
    let text = |value: f64| match value == 0.0 {
        true => "0".into(),
        false => grouped(&fixed(value / 10f64.powi(power), decimals)),
    };
    let tick = |i: i64| {
        let number = first + i as f64;
        let value = number * step;
        Found { value, label: Some(text(value)), major: true, number: Some(number as i64) }
    };
    (0..=count.clamp(-1.0, 100.0) as i64).map(tick).collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `step`.
pub(crate) fn nice_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// Ticks at the decades and, if there is room, at their multiples. `lo` and `hi` are logarithms.
fn log_ticks(lo: f64, hi: f64, labels: f64) -> Vec<Found> {
    let decades = hi - lo;
    let ends = [lo, hi].map(|log| 10f64.powf(log));
    if decades < 0.7 && ends[1] - ends[0] >= SHORTEST {
        let power = power_of(ends[1]);
        let with_power = |label: String| match power {
            0 => label,
            power => format!("{label}×{}", power_of_ten(power)),
        };
        let ticks = linear_ticks((ends[0], ends[1]), labels, power).into_iter();
        return ticks.map(|found| Found { label: found.label.map(with_power), ..found }).collect();
    }
    let step = stride(decades, labels);
    let fine = 3.0 * decades <= labels;
    let (first, last) = (lo.floor() as i32, hi.ceil() as i32);
    let plain = first >= -3 && last <= 4;
    let mut ticks = Vec::new();
    for exponent in first..=last {
        let decade = 10f64.powi(exponent);
        let label = |multiple: i32| match (plain, multiple) {
            (true, m) => sig(f64::from(m) * decade, 1),
            (false, 1) => power_of_ten(exponent),
            (false, m) => format!("{m}×{}", power_of_ten(exponent)),
        };
        let labelled = exponent.rem_euclid(step) == 0;
        let number = Some(i64::from(exponent.div_euclid(step)));
        let own = labelled.then(|| label(1));
        ticks.push(Found { value: decade, label: own, major: labelled, number });
        if step == 1 && decades <= labels {
            ticks.extend((2..10).map(|m| {
                let label = (fine && (m == 2 || m == 5)).then(|| label(m));
                Found { value: f64::from(m) * decade, label, major: false, number: None }
            }));
        }
    }
    ticks
}

/// Every how many decades a label has room.
fn stride(decades: f64, labels: f64) -> i32 {
    let most = decades / labels;
    [1, 2, 3, 5, 10, 20, 50, 100].into_iter().find(|s| f64::from(*s) >= most).unwrap_or(200)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(scale: Scale, range: (f64, f64), pixels: (f64, f64)) -> Map {
        Axis::new("", scale).map([range.0, range.1].into_iter(), pixels, 0.0)
    }

    fn labels(map: &Map, spacing: f64) -> Vec<String> {
        map.ticks(spacing).into_iter().filter_map(|t| t.label).collect()
    }

    #[test]
    fn log_scale_is_logarithmic() {
        let m = map(Scale::Log10, (1e-4, 1e4), (0.0, 800.0));
        assert!((m.pixel(1.0).unwrap() - 400.0).abs() < 1e-9);
        assert!((m.pixel(1e-3).unwrap() - 100.0).abs() < 1e-9);
        assert!((m.pixel(2e3).unwrap() - (700.0 + 100.0 * 2f64.log10())).abs() < 1e-9);
        assert_eq!(m.pixel(0.0), None);
        assert_eq!(m.pixel(-1.0), None);
        assert_eq!(m.pixel(f64::NAN), None);
        assert_eq!(m.pixel(f64::INFINITY), None);
    }

    #[test]
    fn symlog_is_odd_and_monotone() {
        let m = map(Scale::SymLog { linear: 1e-3 }, (-10.0, 10.0), (0.0, 100.0));
        assert!((m.pixel(0.0).unwrap() - 50.0).abs() < 1e-9);
        assert!((m.pixel(1.0).unwrap() + m.pixel(-1.0).unwrap() - 100.0).abs() < 1e-9);
        assert!(m.pixel(1e-3).unwrap() < m.pixel(1e-2).unwrap());
        assert!(labels(&m, 10.0).contains(&"0".to_string()));
    }

    #[test]
    fn nice_steps() {
        for (step, nice) in [(0.11, 0.2), (0.2, 0.2), (3.0, 5.0), (7.0, 10.0), (1e-7, 1e-7)] {
            assert!((nice_step(step) / nice - 1.0).abs() < 1e-9, "{step}");
        }
    }

    #[test]
    fn linear_labels() {
        assert_eq!(
            labels(&map(Scale::Linear, (0.0, 1.0), (0.0, 500.0)), 100.0),
            ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels(&map(Scale::Linear, (-10.0, 10.0), (0.0, 300.0)), 60.0),
            ["−10", "−5", "0", "5", "10"]
        );
    }

    /// Two labels are never the same: what they share is in the title.
    #[test]
    fn labels_of_a_narrow_range_leave_out_what_they_share() {
        let axis = Axis::linear("energy").with_unit("J");
        for (lo, hi, title) in [
            (1.03 - 1e-9, 1.03 + 1e-9, "energy − 1.03 (10⁻⁹ J)"),
            (0.005151, 0.00515100004, "energy − 0.005151 (10⁻¹¹ J)"),
            (-2.0 - 3e-7, -2.0, "energy + 2 (10⁻⁷ J)"),
            (0.00515, 0.0052, "energy (J)"),
            (4e-7, 9e-7, "energy (10⁻⁷ J)"),
            (0.0, 2e6, "energy (10⁶ J)"),
        ] {
            let m = axis.map([lo, hi].into_iter(), (0.0, 500.0), 0.04);
            let found = labels(&m, 60.0);
            assert!(found.len() > 2 && found.iter().all(|l| l.chars().count() < 11), "{found:?}");
            assert!(found.windows(2).all(|pair| pair[0] != pair[1]), "{found:?}");
            assert_eq!(axis.title_beside(&m), title);
        }
    }

    #[test]
    fn large_numbers_are_plain_below_a_million() {
        let labels = |hi: f64| labels(&map(Scale::Linear, (0.0, hi), (0.0, 500.0)), 100.0);
        assert_eq!(labels(1e4), ["0", "2000", "4000", "6000", "8000", "10\u{202f}000"]);
        assert_eq!(labels(1e5)[1..3], ["20\u{202f}000", "40\u{202f}000"]);
        assert_eq!(labels(5e6), ["0", "1", "2", "3", "4", "5"]);
        let axis = Axis::linear("t");
        assert_eq!(axis.title_beside(&map(Scale::Linear, (0.0, 5e6), (0.0, 1.0))), "t (×10⁶)");
    }

    #[test]
    fn decade_labels() {
        let m = map(Scale::Log10, (1e-3, 1e2), (0.0, 500.0));
        assert_eq!(labels(&m, 60.0), ["0.001", "0.01", "0.1", "1", "10", "100"]);
        let m = map(Scale::Log10, (1e-14, 1e-1), (400.0, 0.0));
        let every_second = labels(&m, 50.0);
        assert_eq!(every_second, ["10⁻¹⁴", "10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²"]);
        assert_eq!(m.ticks(50.0).len(), 14);
    }

    #[test]
    fn times_have_units() {
        let axis = Axis::log("CPU time").of_durations();
        let m = axis.map([1e-8, 1e-3].into_iter(), (0.0, 500.0), 0.0);
        assert_eq!(labels(&m, 80.0).concat().replace('\u{a0}', ""), "10ns100ns1µs10µs100µs1ms");
        assert_eq!(axis.title_beside(&m), "CPU time");
        let axis = Axis::linear("CPU time").of_durations();
        let m = axis.map([0.0, 1.5e-3].into_iter(), (0.0, 500.0), 0.0);
        assert_eq!(labels(&m, 150.0).concat().replace('\u{a0}', ""), "0s500µs1ms1.5ms");
    }

    #[test]
    fn degenerate_ranges() {
        let axis = Axis::linear("x");
        for data in [vec![], vec![3.0], vec![0.0, 0.0], vec![-1e300, f64::NAN]] {
            let m = axis.map(data.into_iter(), (0.0, 100.0), 0.05);
            assert!(m.lo < m.hi && m.pixel(3.0).unwrap().is_finite());
        }
    }

    /// Spans at the ends of the range of numbers have ticks, and none of them is without a label of finite length.
    #[test]
    fn extreme_ranges() {
        let tiny = 5e-324;
        let spans = [
            (0.0, tiny),
            (-tiny, 0.0),
            (-tiny, tiny),
            (tiny, 3.0 * tiny),
            (0.0, 1e-310),
            (2e-310, 2e-310 + tiny),
            (0.0, f64::MIN_POSITIVE),
            (1.0, 1.0 + f64::EPSILON),
            (1e16, 1e16 + 2.0),
            (0.0, 1e299),
            (-9e299, 9e299),
            (1e299, 1.000_000_000_000_001e299),
            (tiny, 1e299),
        ];
        for (lo, hi) in spans {
            for unit in ["", "s", "rad"] {
                let linear = 1e-3 * (hi - lo);
                for scale in [Scale::Linear, Scale::Log10, Scale::SymLog { linear }] {
                    let axis = Axis::new("x", scale).with_unit(unit);
                    let m = axis.map([lo, hi].into_iter(), (0.0, 500.0), 0.04);
                    let told = format!("{lo:e} to {hi:e}, {scale:?}: {m:?}");
                    assert!(m.lo < m.hi && m.lo.is_finite() && m.hi.is_finite(), "{told}");
                    for x in [lo, hi].into_iter().filter(|x| scale.accepts(*x)) {
                        assert!(m.pixel(x).is_some_and(|at| m.contains(at)), "{told}");
                    }
                    let ticks = m.ticks(60.0);
                    assert!(ticks.iter().all(|tick| tick.at.is_finite()), "{told}");
                    let labels: Vec<_> = ticks.into_iter().filter_map(|t| t.label).collect();
                    assert!(labels.iter().all(|l| l.chars().count() < 30), "{told}: {labels:?}");
                    assert!(axis.title_beside(&m).chars().count() < 40, "{told}");
                    assert!(axis.value_text(hi).chars().count() < 40, "{told}");
                }
            }
        }
    }

    #[test]
    fn values_have_units() {
        assert_eq!(Axis::log("CPU time").of_durations().value_text(0.0125), "12.5\u{a0}ms");
        assert_eq!(Axis::linear("angle").with_unit("rad").value_text(0.5), "0.500\u{a0}rad");
        assert_eq!(Axis::log("error").value_text(0.5), "0.500");
    }
}
