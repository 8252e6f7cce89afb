//! Columns of a run against time: which of them are in one figure, and how each is drawn.

use core::ops::Range;

use lieflow::problems::explained_by_rounding;
use lieflow_figures::number::short;
use lieflow_figures::{Axis, Block, Chart, Marks, Series};
use lieflow_model::problem::Kind;
use lieflow_model::schema::{Component, Dimension, Observable, Row, Scale, Units};

use super::sample::RowSample;
use super::words;
use crate::output::{EventSummary, Summary};

/// Lines of a chart that a reader can tell apart.
pub(super) const LINES: usize = 6;
/// Charts of a quantity that are open; the others are in a fold.
const OPEN: usize = 4;
/// Charts of a quantity of many columns.
const CHARTS: usize = 12;
/// A relative change below the first is rounding. Below the second a figure shows changes and not values.
const CONSTANT: f64 = 1e-12;
const NEARLY: f64 = 1e-2;
/// A line of less than this part of the height of its figure looks straight, however it swings.
const FLAT: f64 = 1e-2;
/// Lines that are nearer than this part of the height of their figure look like one.
const ONE: f64 = 2e-3;
/// Swings that a wide chart can show, those that one beside another can, those for which it is worth to be wide, and
/// those in the chart of the beginning.
const WIDE: usize = 200;
const HALF: usize = 100;
const NARROW: usize = 30;
const FIRST: usize = 8;
/// The places of the edge of a band, one for each pixel or two.
const PLACES: usize = 600;
/// A swing has a shape where it has so many rows.
const SHAPED: usize = 6;

/// A column of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column<'a> {
    pub(super) quantity: &'a Observable,
    pub(super) index: usize,
}

impl<'a> Column<'a> {
    /// All columns of a quantity.
    pub(super) fn all(quantity: &'a Observable) -> impl Iterator<Item = Self> {
        (0..quantity.columns.len()).map(move |index| Column { quantity, index })
    }

    pub(super) fn of(self, row: Row<'_>) -> f64 {
        row[self.quantity][self.index]
    }

    pub(super) fn name(self) -> &'a str {
        &self.quantity.columns[self.index]
    }

    /// The columns that belong together with it.
    fn part(self) -> Range<usize> {
        let part = self.quantity.parts.iter().find(|part| part.columns.contains(&self.index));
        part.map_or(self.index..self.index + 1, |part| part.columns.clone())
    }
}

/// Columns of one figure.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shown<'a> {
    pub(super) title: String,
    pub(super) axes: [String; 2],
    /// The units of both axes; empty where they are not known.
    pub(super) units: [String; 2],
    pub(super) columns: Vec<Column<'a>>,
}

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

/// The figures of a quantity: of the columns that are wanted, or of all. Those after the first few are in a fold.
pub(super) fn against_time(
    id: &str,
    kind: &Kind,
    quantity: &Observable,
    rows: &RowSample<'_>,
    wanted: &[String],
    summary: &Summary,
) -> Vec<Drawn> {
    let parts =
        parts_of(kind, quantity, wanted, &summary.unit_names).into_iter().take(CHARTS).enumerate();
    let id = |place| if place == 0 { id.into() } else { format!("{id}-{}", place + 1) };
    let mut figures: Vec<Drawn> =
        parts.map(|(place, shown)| figure(&id(place), &shown, rows, summary)).collect();
    // One quantity of several parts that all stay as they are is told in one line.
    let values = figures.iter().map(|figure| match figure {
        Drawn::Constant(_, value) => Some(value.as_str()),
        _ => None,
    });
    if let Some(values) = values.collect::<Option<Vec<_>>>() {
        return vec![Drawn::Constant(words::title(kind, quantity), values.join(", "))];
    }
    let closed = figures.split_off(figures.len().min(OPEN));
    if !closed.is_empty() {
        let name = format!("More of {} ({})", words::on_axis(quantity), closed.len());
        figures.push(Drawn::Closed(name, closed));
    }
    figures
}

/// The blocks of a page: figures that may stand beside others in rows of two, or three if there are just three; then
/// what stays as it is.
pub(super) fn in_rows(figures: Vec<Drawn>) -> Vec<Block> {
    let (mut blocks, mut waiting, mut constant) = (Vec::new(), Vec::new(), Vec::new());
    let narrow = |waiting: &mut Vec<Block>| -> Vec<Block> {
        let charts = core::mem::take(waiting);
        let in_row = if charts.len() == 3 { 3 } else { 2 };
        let row = |row: &[Block]| match row {
            [one] => one.clone(),
            several => Block::Row(several.to_vec()),
        };
        charts.chunks(in_row).map(row).collect()
    };
    for figure in figures {
        let block = match figure {
            Drawn::Narrow(chart) => {
                waiting.push(Block::Chart(chart));
                continue;
            }
            Drawn::Constant(title, value) => {
                constant.push((title, value));
                continue;
            }
            Drawn::Wide(chart) => Block::Chart(chart),
            Drawn::Both(charts) => Block::Row(charts.map(Block::Chart).into()),
            Drawn::Closed(title, figures) => Block::fold(title, in_rows(figures)),
        };
        blocks.append(&mut narrow(&mut waiting));
        blocks.push(block);
    }
    blocks.append(&mut narrow(&mut waiting));
    if !constant.is_empty() {
        blocks.push(Block::text("These quantities stay as they are at the start:"));
        blocks.push(Block::Facts(constant));
    }
    blocks
}

/// The columns that belong together: all of a few, the parts of a composed system, or those of one name; those with
/// the fewest columns first.
fn parts_of<'a>(
    kind: &Kind,
    quantity: &'a Observable,
    wanted: &[String],
    units: &Units,
) -> Vec<Shown<'a>> {
    let names = &quantity.columns;
    let unit = kind.quantity(quantity.name).map_or(String::new(), |info| info.unit(units));
    let shown = |title: String, axis: String, columns: &[usize]| Shown {
        title,
        axes: ["t".into(), axis],
        units: [units.of(Dimension::TIME).unwrap_or_default(), unit.clone()],
        columns: columns.iter().map(|&index| Column { quantity, index }).collect(),
    };
    let is_wanted = |i: &usize| {
        wanted.is_empty() || wanted.iter().any(|name| *name == names[*i] || name == quantity.name)
    };
    let all: Vec<usize> = (0..names.len()).filter(is_wanted).collect();
    let of_formulas = kind.quantity(quantity.name).is_err();
    let title = || words::title(kind, quantity);
    let mut parts: Vec<Shown<'a>> = if quantity.parts.len() > 1 {
        let part = |part: &Component| {
            let columns: Vec<usize> = part.columns.clone().filter(is_wanted).collect();
            shown(words::of_part(part), part.name.replace('_', " "), &columns)
        };
        quantity.parts.iter().map(part).filter(|part| !part.columns.is_empty()).collect()
    } else if of_formulas || all.len() > LINES {
        let same = |a: &usize, b: &usize| words::stem(&names[*a]) == words::stem(&names[*b]);
        let groups: Vec<&[usize]> = all.chunk_by(same).collect();
        let several = groups.len() > 1;
        let group = |(number, columns): (usize, &&[usize])| {
            let named: Vec<String> = columns.iter().map(|i| names[*i].clone()).collect();
            let name = words::path(quantity, &named, number);
            let (title, axis) = match several {
                _ if of_formulas => (name.clone(), name),
                true => (format!("{}: {name}", title()), name),
                false => (title(), words::on_axis(quantity)),
            };
            shown(title, axis, columns)
        };
        (1..).zip(&groups).map(group).collect()
    } else {
        vec![shown(title(), words::on_axis(quantity), &all)]
    };
    parts.sort_by_key(|part| part.columns.len());
    parts.into_iter().flat_map(Shown::pieces).collect()
}

impl<'a> Shown<'a> {
    /// The part in pieces of a few columns: the rows of a matrix, where its columns are entries.
    fn pieces(self) -> Vec<Shown<'a>> {
        if self.columns.len() <= LINES {
            return vec![self];
        }
        let entry =
            |column: &Column<'a>| &column.name().as_bytes()[words::stem(column.name()).len()..];
        let of_matrix = self.columns.iter().all(|column| entry(column).len() == 2);
        let same_row = |a: &Column<'a>, b: &Column<'a>| !of_matrix || entry(a)[0] == entry(b)[0];
        let rows = self.columns.chunk_by(same_row).flat_map(|row| {
            let whole = of_matrix && row.len() <= LINES;
            row.chunks(LINES).map(move |columns| (whole, columns))
        });
        let piece = |(whole, columns): (bool, &[Column<'a>])| {
            let [first, last] = [columns[0], columns[columns.len() - 1]];
            let name = match whole {
                true => format!("row {}", char::from(entry(&first)[0])),
                false => {
                    format!("{} to {}", words::column(first.name()), words::column(last.name()))
                }
            };
            let title = format!("{}: {name}", self.title);
            Shown { title, columns: columns.to_vec(), ..self.clone() }
        };
        rows.map(piece).collect()
    }
}

/// The size that the rounding of each column is relative to: the largest of the numbers that belong together with it,
/// and 1 for a distance from a group.
fn sizes(columns: &[Column<'_>], rows: &RowSample<'_>) -> Vec<f64> {
    let mut sizes: Vec<f64> = Vec::new();
    for (i, &Column { quantity, index }) in columns.iter().enumerate() {
        let part = Column { quantity, index }.part();
        let same =
            |other: &Column<'_>| core::ptr::eq(other.quantity, quantity) && other.part() == part;
        if let Some(known) = columns[..i].iter().position(same) {
            sizes.push(sizes[known]);
            continue;
        }
        let of_group = quantity.law.is_some_and(|law| law.scale == Scale::One);
        let least = if of_group { 1.0 } else { 0.0 };
        sizes.push(rows.columns().fold(least, |size, (_, row)| {
            row[quantity][part.clone()].iter().fold(size, |size: f64, x| size.max(x.abs()))
        }));
    }
    sizes
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

/// Some columns of a run against time. What is less than the rounding of its figure is the constant that it is.
pub(super) fn figure(
    id: &str,
    shown: &Shown<'_>,
    rows: &RowSample<'_>,
    summary: &Summary,
) -> Drawn {
    let Shown { title, axes: [x, y], units: [of_x, of_y], columns } = shown;
    let sizes = sizes(columns, rows);
    let curve = |(column, &size): (&Column<'_>, &f64)| {
        let point = |(t, row): (f64, Row<'_>)| (t, column.of(row));
        Curve {
            name: words::column(column.name()),
            whole: rows.columns().map(point).collect(),
            first: rows.first().map(point).collect(),
            size,
        }
    };
    let mut curves: Vec<Curve> = columns.iter().zip(&sizes).map(curve).collect();
    let rounding = CONSTANT.max(explained_by_rounding(summary.steps, 1.0));
    if let Some(values) = constants(&mut curves, rounding) {
        return Drawn::Constant(title.clone(), values.join(", "));
    }
    let start = |curve: &Curve| curve.whole.first().map_or(0.0, |point| point.1);
    let change = |curve: &Curve| {
        let start = start(curve);
        curve.whole.iter().fold(0.0, |change: f64, (_, x)| change.max((x - start).abs()))
    };
    let changes = curves.iter().map(change).fold(0.0, f64::max);
    let size = sizes.iter().copied().fold(0.0, f64::max);
    let (mut title, mut y) = (title.clone(), y.clone());
    if changes < NEARLY * size {
        title += ": how far it is from its start";
        y += &match &curves[..] {
            [only] => format!(" − {}", short(start(only), 6)),
            _ => " − its start".into(),
        };
        for curve in &mut curves {
            let start = start(curve);
            curve.whole.iter_mut().chain(&mut curve.first).for_each(|point| point.1 -= start);
        }
    }
    let axes = [Axis::linear(x).with_unit(of_x.clone()), Axis::linear(y).with_unit(of_y.clone())];
    drawn(id, &title, axes, &curves, rows.seen()).map(|chart| marked(chart, summary))
}

/// Makes each curve that moves by rounding alone the constant that it is. The values of all, if they all are constants.
pub(super) fn constants(curves: &mut [Curve], rounding: f64) -> Option<Vec<String>> {
    let mut values = Vec::new();
    for Curve { whole, first, size, .. } in curves.iter_mut() {
        let Some(&(_, start)) = whole.first() else { continue };
        if height_of(&*whole) <= rounding * *size {
            whole.iter_mut().chain(first).for_each(|point| point.1 = start);
            values.push(short(start, 6));
        }
    }
    (values.len() == curves.len()).then_some(values)
}

/// Curves against time, with so many rows: as lines, or, with more swings than a figure can show, as bands beside a
/// chart of the beginning.
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
            let few = "rows do not show the shape of so many swings: write more rows.";
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
        early.with_caption("The first swings of many. The file of the rows has them all."),
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

/// The highest minus the lowest; what is no number is passed over.
fn height_of<'a>(points: impl IntoIterator<Item = &'a (f64, f64)>) -> f64 {
    let values = points.into_iter().map(|point| point.1).filter(|x| !x.is_nan());
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
        // A point that is no number is near none.
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

/// The edge of the band of a line with so many swings: its highest values from the start to the end, and its lowest back
/// to the start. Each place of the edge sees a whole swing around it.
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

/// The chart with the events of the run.
pub(super) fn marked(chart: Chart, summary: &Summary) -> Chart {
    let events = summary.events.iter().filter(|event| event.count > 0);
    let marks = |event: &EventSummary| Marks { name: event.name.clone(), at: event.marks.clone() };
    let told = |(event, look): (&EventSummary, &&str)| match event.marks.len() as u64 {
        drawn if drawn < event.count => {
            format!("{} ({look}), the first {drawn} of them", event.name)
        }
        _ => format!("{} ({look})", event.name),
    };
    let names: Vec<String> = events.clone().zip(Marks::LOOKS.iter().cycle()).map(told).collect();
    let mut caption = chart.caption.clone();
    if !names.is_empty() {
        caption += &format!(" The vertical lines are events: {}.", names.join("; "));
    }
    let marks: Vec<Marks> = events.map(marks).collect();
    chart.with_marks(marks).with_caption(caption.trim())
}

#[cfg(test)]
mod tests {
    use lieflow_model::scene::Scene;

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

    #[test]
    fn narrow_figures_stand_in_rows_and_wide_ones_alone() {
        let chart = || Chart::new("c", "", [Axis::linear("t"), Axis::linear("x")], []);
        let row = |block: &Block| if let Block::Row(row) = block { row.len() } else { 1 };
        let rows = |figures: Vec<Drawn>| in_rows(figures).iter().map(row).collect::<Vec<_>>();
        let narrow = |count: usize| (0..count).map(|_| Drawn::Narrow(chart())).collect::<Vec<_>>();
        assert_eq!([1, 2, 3, 4].map(|n| rows(narrow(n))), [vec![1], vec![2], vec![3], vec![2, 2]]);
        let wide = [narrow(2), vec![Drawn::Wide(chart())], narrow(1)].concat();
        assert_eq!(rows(wide), [2, 1, 1]);
        assert_eq!(rows(vec![Drawn::Both([chart(), chart()])]), [2]);
        let constant = Drawn::Constant("length".into(), "1".into());
        assert_eq!(rows([narrow(1), vec![constant], narrow(1)].concat()), [2, 1, 1]);
    }

    /// A scene of several kinds of parts, and one of a matrix: what is drawn in which chart.
    #[test]
    fn columns_of_one_name_are_a_part() {
        let shown = |scene: &str, quantity: &str, wanted: &[&str]| -> Vec<(String, usize)> {
            let scene = Scene::bundled(scene).unwrap();
            let model = scene.model_with(scene.layer, &[quantity]).unwrap();
            let wanted: Vec<String> = wanted.iter().map(|name| name.to_string()).collect();
            let quantity = model.schema().get(quantity).unwrap();
            let parts = parts_of(scene.problem.kind(), quantity, &wanted, &scene.units);
            parts.into_iter().map(|part| (part.title, part.columns.len())).collect()
        };
        let named = |parts: &[(&str, usize)]| -> Vec<(String, usize)> {
            parts.iter().map(|(title, count)| (title.to_string(), *count)).collect()
        };
        let bodies = (1..=4).map(|i| (format!("Angular momenta in the bodies: body {i}"), 3));
        assert_eq!(shown("many-bodies", "momentum_body", &[]), bodies.collect::<Vec<_>>());
        let matrix = (1..=5).map(|i| (format!("The point: row {i}"), 5));
        assert_eq!(shown("rotating-drive", "point", &[]), matrix.collect::<Vec<_>>());
        assert_eq!(shown("rotating-drive", "point", &["y11", "y55"])[0].1, 2);
        assert_eq!(
            shown("wing-nut", "quaternion", &[]),
            named(&[("The attitude as a unit quaternion", 4)])
        );
        let parts = [
            ("The number h", 1),
            ("The number work", 1),
            ("The vector m", 3),
            ("The rotation g: row 1", 3),
            ("The rotation g: row 2", 3),
            ("The rotation g: row 3", 3),
        ];
        assert_eq!(shown("gyrostat", "state", &[]), named(&parts));
        let scene = Scene::bundled("gyro-record").unwrap();
        let model = scene.model_with(scene.layer, &["state"]).unwrap();
        let state = model.schema().get("state").unwrap();
        let of_one_part = parts_of(scene.problem.kind(), state, &[], &scene.units);
        assert!(of_one_part.iter().all(|part| part.axes[1] == "g"), "{of_one_part:?}");
    }
}
