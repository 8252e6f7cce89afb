//! How curves against time are drawn: as lines, as bands with a chart of the beginning, or as constants.

use lieflow_figures::number::short;
use lieflow_figures::{Axis, Chart, Series};

/// Swings that a wide chart can show, those that one beside another can, those for which it is worth to be wide, and
/// those in the chart of the beginning.
const WIDE: usize = 200;
const HALF: usize = 100;
const NARROW: usize = 30;
const FIRST: usize = 8;
/// A line of less than this part of the height of its figure looks straight, however it swings.
const FLAT: f64 = 1e-2;
/// Lines that are nearer than this part of the height of their figure look like one.
const ONE: f64 = 2e-3;
/// The places of the edge of a band, one for each pixel or two.
const PLACES: usize = 600;
/// A swing of at least this many rows has a shape.
const SHAPED: usize = 6;

/// A figure, and how much room it wants.
#[allow(clippy::large_enum_variant)] // a few for each page
#[derive(Clone, Debug)]
pub(super) enum Drawn {
    /// It may stand beside another one.
    Narrow(Chart),
    /// It stands alone.
    Wide(Chart),
    /// The beginning, and the whole run.
    Both([Chart; 2]),
    /// What stays as it is: its title and its value.
    Constant(String, String),
    /// Several in a fold with a title.
    Closed(String, Vec<Drawn>),
}

impl Drawn {
    /// The figure with its charts changed.
    pub(super) fn map(self, change: impl Fn(Chart) -> Chart) -> Self {
        match self {
            Drawn::Narrow(chart) => Drawn::Narrow(change(chart)),
            Drawn::Wide(chart) => Drawn::Wide(change(chart)),
            Drawn::Both(charts) => Drawn::Both(charts.map(change)),
            other => other,
        }
    }

    /// Lets a narrow figure stand alone.
    pub(super) fn widen(&mut self) {
        if let Drawn::Narrow(chart) = self {
            *self = Drawn::Wide(chart.clone());
        }
    }
}

/// A curve of a figure, before it is known how it is drawn.
pub(super) struct Curve {
    pub(super) name: String,
    /// The points from the start to the end, with every peak.
    pub(super) whole: Vec<(f64, f64)>,
    /// The first points, none left out.
    pub(super) first: Vec<(f64, f64)>,
    /// The size that its rounding is relative to.
    pub(super) size: f64,
}

/// Makes each curve that moves by rounding alone the constant that it is. The values of all, if they all are constants.
pub(super) fn constants(curves: &mut [Curve], rounding: f64) -> Option<Vec<String>> {
    let mut values = Vec::new();
    for Curve { whole, first, size, .. } in curves.iter_mut() {
        let Some(&(_, start)) = whole.first() else { continue };
        let is_finite = whole.iter().all(|point| point.1.is_finite());
        if is_finite && height_of(&*whole) <= rounding * *size {
            whole.iter_mut().chain(first).for_each(|point| point.1 = start);
            values.push(short(start, 6));
        }
    }
    (values.len() == curves.len()).then_some(values)
}

/// Curves against time, from `rows` rows. They are drawn as lines. If they have more swings than a figure can show, they are
/// drawn as bands beside a chart of the beginning.
pub(super) fn drawn(
    id: &str,
    title: &str,
    axes: [Axis; 2],
    curves: &[Curve],
    rows: usize,
) -> Drawn {
    let lines = lines_of(curves, |curve| curve.whole.clone());
    let most = lines.iter().map(|line| line.swings).max().unwrap_or(0);
    if most <= WIDE {
        let mut chart = Chart::new(id, title, axes, lines.iter().map(Line::series));
        if most > 1 && rows < SHAPED * most {
            let few = "rows are too few to show the shape of the swings: write more rows.";
            chart = chart.with_caption(format!("{rows} {few}"));
        }
        return if most > NARROW { Drawn::Wide(chart) } else { Drawn::Narrow(chart) };
    }
    let mut beginning = lines_of(curves, |curve| curve.first.clone());
    let start = |line: &Line| line.points.first().map_or(0.0, |point| point.0);
    let since = |line: &Line, turn: usize| (line.points[turn].0 - start(line)).abs();
    let ends = beginning
        .iter()
        .filter(|line| line.swings > FIRST)
        .filter_map(|line| turns(&line.points).get(2 * FIRST).map(|turn| since(line, *turn)));
    if let Some(end) = ends.min_by(f64::total_cmp) {
        for line in &mut beginning {
            let start = start(line);
            line.points.retain(|(t, _)| (t - start).abs() <= end);
        }
    }
    // The rows of each swing at the beginning: where they are few, the swings that are seen may be others.
    let is_shaped = |line: &Line| line.points.len() >= SHAPED * (turns(&line.points).len() / 2);
    let first = match beginning.iter().all(is_shaped) {
        true => "The first swings of many. The file of the rows has them all.",
        false => {
            "The first swings of many. The rows are too few to show their shape: write more rows."
        }
    };
    let early = Chart::new(
        format!("{id}-beginning"),
        format!("{title}, at the beginning"),
        axes.clone(),
        beginning.iter().map(Line::series),
    );
    let whole = lines.iter().map(|line| match line.swings {
        ..=HALF => line.series(),
        swings => {
            let band = band(&line.points, swings);
            Series::line(line.name.clone(), line.colour, band).with_fill()
        }
    });
    let whole = Chart::new(id, format!("{title}, the whole run"), axes, whole);
    Drawn::Both([
        early.with_caption(first),
        whole.with_caption(
            "Too many swings to draw each: a band is filled from the lowest to the highest values.",
        ),
    ])
}

/// A line of a figure.
struct Line {
    name: String,
    colour: usize,
    points: Vec<(f64, f64)>,
    /// Its swings that can be seen.
    swings: usize,
}

impl Line {
    fn series(&self) -> Series {
        Series::line(self.name.clone(), self.colour, self.points.iter().copied())
    }
}

/// The highest minus the lowest. NaN is ignored.
fn height_of<'a>(points: impl IntoIterator<Item = &'a (f64, f64)>) -> f64 {
    let values = points.into_iter().map(|point| point.1).filter(|x| x.is_finite());
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.fold(none, |(low, high), x| (low.min(x), high.max(x)));
    (high - low).max(0.0)
}

/// The lines through some points of each curve: those that look like one are one, with both names.
fn lines_of(curves: &[Curve], points: impl Fn(&Curve) -> Vec<(f64, f64)>) -> Vec<Line> {
    let all: Vec<Vec<(f64, f64)>> = curves.iter().map(points).collect();
    let height = height_of(all.iter().flatten());
    let mut lines: Vec<Line> = Vec::new();
    for (colour, (Curve { name, .. }, points)) in curves.iter().zip(all).enumerate() {
        // A NaN is near no point.
        let is_near = |(a, b): (&(f64, f64), &(f64, f64))| {
            (a.0 - b.0).abs() <= 1e-9 * b.0.abs() && (a.1 - b.1).abs() <= ONE * height
        };
        let is_one = |line: &Line| {
            line.points.len() == points.len() && line.points.iter().zip(&points).all(is_near)
        };
        if let Some(line) = lines.iter_mut().find(|line| is_one(line)) {
            line.name += &format!(", {name}");
            continue;
        }
        let is_flat = height_of(&points) < FLAT * height;
        let swings = if is_flat { 0 } else { turns(&points).len() / 2 };
        lines.push(Line { name: name.clone(), colour, points, swings });
    }
    lines
}

/// Where a line turns back, by more than a tenth of its height.
fn turns(points: &[(f64, f64)]) -> Vec<usize> {
    let gap = 0.1 * height_of(points);
    let mut found = Vec::new();
    let Some((_, mut extreme)) = points.first().copied() else { return found };
    let mut sign = 1.0;
    for (i, (_, x)) in points.iter().enumerate() {
        if sign * (x - extreme) >= 0.0 || extreme.is_nan() {
            extreme = *x;
        } else if sign * (extreme - x) > gap {
            (sign, extreme) = (-sign, *x);
            found.push(i);
        }
    }
    found
}

/// The edge of the band of a line: its highest values from the start to the end, and its lowest back to the start.
/// Each place of the edge sees a whole swing around it.
fn band(points: &[(f64, f64)], swings: usize) -> Vec<(f64, f64)> {
    let finite: Vec<_> = points.iter().filter(|(_, x)| x.is_finite()).copied().collect();
    let (Some(&(start, _)), Some(&(end, _))) = (finite.first(), finite.last()) else {
        return finite;
    };
    let swing = (end - start).abs() / swings.max(1) as f64;
    let reach = (0.5 * swing).max((end - start).abs() / PLACES as f64);
    let forward = (end - start).signum();
    let places = (0..=PLACES).map(|i| start + (end - start) * i as f64 / PLACES as f64);
    let mut first = 0;
    let ends = places.map(|place| {
        let before = |(t, _): &(f64, f64)| forward * (t - place) < -reach;
        first += finite[first..].iter().take_while(|point| before(point)).count();
        let near = finite[first..].iter().take_while(|(t, _)| forward * (t - place) <= reach);
        let (low, high) =
            near.fold((f64::NAN, f64::NAN), |(low, high), (_, x)| (x.min(low), x.max(high)));
        (place, low, high)
    });
    let ends: Vec<(f64, f64, f64)> = ends.filter(|(_, low, _)| low.is_finite()).collect();
    let above = ends.iter().map(|(place, _, high)| (*place, *high));
    above.chain(ends.iter().rev().map(|(place, low, _)| (*place, *low))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_is_as_high_as_its_swings_from_the_first_row_to_the_last() {
        let height = |t: f64| 1.0 + 0.5 * (0.0002 * t).sin();
        let wave = |i: i32| (f64::from(i), height(f64::from(i)) * (2.5 * f64::from(i)).sin());
        for backward in [false, true] {
            let mut points: Vec<(f64, f64)> = (0..40_000).map(wave).collect();
            if backward {
                points.reverse();
            }
            let turns = turns(&points).len();
            assert!((20_000..40_000).contains(&turns), "{turns}");
            let edge = band(&points, turns / 2);
            let (above, below) = edge.split_at(edge.len() / 2);
            assert_eq!(above.len(), PLACES + 1);
            assert_eq!([above[0].0, above[PLACES].0], [points[0].0, points[39_999].0]);
            for ((t, high), (_, low)) in above.iter().zip(below.iter().rev()) {
                assert!((high - height(*t)).abs() < 0.06, "t = {t}: {high}, {}", height(*t));
                assert!((low + height(*t)).abs() < 0.06, "t = {t}: {low}");
            }
        }
        assert!(turns(&[(0.0, 1.0); 5]).is_empty() && turns(&[]).is_empty());
        assert!(band(&[(0.0, f64::NAN)], 10).is_empty());
    }

    /// The beginning of a run has the shape of its swings where each has rows enough.
    #[test]
    fn rows_that_are_too_few_are_told_at_the_beginning() {
        let caption = |rate: f64| {
            let point = |i: i32| (f64::from(i), (rate * f64::from(i)).sin());
            let (whole, first) = ((0..4000).map(point).collect(), (0..2000).map(point).collect());
            let curves = [Curve { name: "a".into(), whole, first, size: 1.0 }];
            let axes = ["t", "a"].map(Axis::linear);
            match drawn("id", "title", axes, &curves, 4000) {
                Drawn::Both([early, _]) => early.caption,
                _ => panic!("not so many swings at {rate}"),
            }
        };
        assert!(caption(2.5).contains("The rows are too few to show their shape"));
        assert!(caption(0.6).contains("The file of the rows has them all"));
    }

    /// Two lines that a reader cannot tell apart are one line with both names, and a line that looks straight has no
    /// swings.
    #[test]
    fn every_entry_of_a_legend_is_a_line_that_can_be_seen() {
        let curve = |name: &str, value: fn(f64) -> f64| {
            let whole = (0..1000).map(|k| 0.1 * f64::from(k)).map(|t| (t, value(t))).collect();
            Curve { name: name.into(), whole, first: Vec::new(), size: 1.0 }
        };
        let mut curves = [
            curve("a", f64::sin),
            curve("b", |t| t.sin() + 1e-3),
            curve("c", |t| 1e-3 * (20.0 * t).sin() - 0.5),
            curve("d", |t| 1e-17 * (20.0 * t).sin()),
        ];
        assert_eq!(constants(&mut curves, 1e-12), None);
        let lines = lines_of(&curves, |curve| curve.whole.clone());
        let lines: Vec<_> = lines.into_iter().map(|line| (line.name, line.swings)).collect();
        let named = |name: &str, swings: usize| (name.to_string(), swings);
        assert_eq!(lines, [named("a, b", 16), named("c", 0), named("d", 0)]);
        assert_eq!(constants(&mut curves[3..], 1e-12), Some(vec!["0".into()]));
    }
}
