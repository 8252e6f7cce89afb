//! Columns of a run against time: which of them are in one figure, and how each is drawn.

use core::ops::Range;

use lieflow::problems::explained_by_rounding;
use lieflow_figures::number::short;
use lieflow_figures::{Axis, Block, Chart, Marks};
use lieflow_model::problem::Kind;
use lieflow_model::schema::{Component, Observable, Row, Scale, Units};

use super::sample::RowSample;
use super::swings::{Curve, Drawn, constants, drawn};
use super::words;
use crate::output::{EventSummary, Summary};

/// Lines of a chart that a reader can tell apart.
pub(super) const LINES: usize = 6;
/// Charts of a quantity that are open; the others are in a fold.
const OPEN: usize = 4;
/// Charts of a quantity of many columns.
const CHARTS: usize = 12;
/// A relative change below the first is rounding. Below the second a figure shows changes and not values.
pub(super) const CONSTANT: f64 = 1e-12;
const NEARLY: f64 = 1e-2;

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
    pub(super) fn part(self) -> Range<usize> {
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
    /// True if values are drawn as they are, also where they hardly change: the scene has words for the figure.
    pub(super) as_they_are: bool,
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
    // With a word: `plot-2` is the second figure that a scene asks for.
    let id = |place| if place == 0 { id.into() } else { format!("{id}-part-{}", place + 1) };
    let mut figures: Vec<Drawn> =
        parts.map(|(place, shown)| figure(&id(place), &shown, rows, summary)).collect();
    // A quantity of several parts that are all constant has one line.
    let values = figures.iter().map(|figure| match figure {
        Drawn::Constant(_, value) => Some(value.as_str()),
        _ => None,
    });
    let is_whole = quantity.columns.iter().all(|name| is_wanted(quantity, wanted, name));
    if is_whole && let Some(values) = values.collect::<Option<Vec<_>>>() {
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

/// True if a column of a quantity is drawn: all are where none is named.
fn is_wanted(quantity: &Observable, wanted: &[String], column: &str) -> bool {
    wanted.is_empty() || wanted.iter().any(|name| name == column || name == quantity.name)
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
        units: [units.of(kind.time).unwrap_or_default(), unit.clone()],
        columns: columns.iter().map(|&index| Column { quantity, index }).collect(),
        as_they_are: false,
    };
    let is_wanted = |i: &usize| is_wanted(quantity, wanted, &names[*i]);
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
    } else if all.len() < names.len() {
        let named: Vec<String> = all.iter().map(|i| words::column(&names[*i])).collect();
        vec![shown(format!("{}: {}", title(), named.join(", ")), words::on_axis(quantity), &all)]
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

/// The size that the rounding of each column is relative to: the largest of the numbers that belong together with it, the
/// size of the terms of a sum, and 1 for a distance from a group.
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
            // Without terms it is NaN.
            let terms = row.terms(quantity);
            let values = row[quantity][part.clone()].iter().map(|x| x.abs()).chain([terms]);
            values.filter(|x| x.is_finite()).fold(size, f64::max)
        }));
    }
    sizes
}

/// Some columns of a run against time. What is less than the rounding of its figure is the constant that it is.
pub(super) fn figure(
    id: &str,
    shown: &Shown<'_>,
    rows: &RowSample<'_>,
    summary: &Summary,
) -> Drawn {
    let Shown { title, axes: [x, y], units: [of_x, of_y], columns, as_they_are } = shown;
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
        let changes = curve.whole.iter().map(|(_, x)| (x - start).abs());
        // From a start that is not finite there is no change to draw.
        if start.is_finite() { changes.fold(0.0, f64::max) } else { f64::INFINITY }
    };
    let changes = curves.iter().map(change).fold(0.0, f64::max);
    let size = sizes.iter().copied().fold(0.0, f64::max);
    let (mut title, mut y) = (title.clone(), y.clone());
    if changes < NEARLY * size && !as_they_are {
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
        let bodies = (1..=4).map(|i| (format!("The momentum of body {i}"), 3));
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
