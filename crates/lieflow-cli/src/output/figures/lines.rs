//! The columns of a quantity against time.

use lieflow_figures::number::short;
use lieflow_figures::{Axis, Block, Chart, Marks, Point, Series};
use lieflow_model::problem::Kind;
use lieflow_model::schema::Scale;
use lieflow_model::schema::{Observable, Part, Row};

use super::sample::RowSample;
use super::words;
use crate::output::{EventSummary, Summary};

/// Lines of a chart that a reader can tell apart.
pub(super) const LINES: usize = 6;
/// Charts of a quantity that are open; the others are in a fold.
const OPEN: usize = 4;
/// Charts of a quantity of many columns.
const CHARTS: usize = 12;
/// Relative changes below the first are rounding, and below the second are drawn as such.
const CONSTANT: f64 = 1e-12;
const NEARLY: f64 = 1e-2;
/// Swings that a chart of the whole run can show, and one of several side by side; swings in the chart of the first
/// of them.
const CARPET: usize = 50;
const SMALL_CARPET: usize = 24;
const FIRST: usize = 16;
/// Ranges of a chart that a reader can tell apart.
const BANDS: usize = 4;
/// Swings in each part of a chart of ranges, and its parts: at least, and at most.
const EACH: usize = 4;
const LEAST: usize = 12;
const RANGES: usize = 160;

/// A column as a line.
struct Line {
    name: String,
    points: Vec<(f64, f64)>,
}

/// The largest size of the numbers of a quantity, and the farthest that one goes from its start.
fn extent(quantity: &Observable, rows: &RowSample<'_>) -> [f64; 2] {
    let Some([(_, start), _]) = rows.ends() else { return [0.0; 2] };
    rows.rows().fold([0.0, 0.0], |extent, (_, row)| {
        let pairs = row[quantity].iter().zip(&start[quantity]);
        pairs.fold(extent, |[size, change]: [f64; 2], (x, start)| {
            [size.max(x.abs()), change.max((x - start).abs())]
        })
    })
}

/// The value of a quantity that stays as it is, to rounding.
pub(super) fn constant(quantity: &Observable, rows: &RowSample<'_>) -> Option<String> {
    let [size, change] = extent(quantity, rows);
    // A distance from the group is compared with the entries of a rotation.
    let of_group = quantity.law.is_some_and(|law| law.scale == Scale::One);
    let size = if of_group { size.max(1.0) } else { size };
    let [(_, start), _] = rows.ends()?;
    let value = || start[quantity].iter().map(|x| short(*x, 6)).collect::<Vec<_>>().join(", ");
    (change <= CONSTANT * size && size.is_finite()).then(value)
}

/// The charts of a quantity: of the columns that the scene wants drawn, or of all. Those after the first few are in
/// a fold.
pub(super) fn against_time(
    id: &str,
    kind: &Kind,
    quantity: &Observable,
    rows: &RowSample<'_>,
    wanted: &[String],
    summary: &Summary,
) -> Vec<Block> {
    let [size, change] = extent(quantity, rows);
    let from_start = change < NEARLY * size;
    let unit = kind.quantity(quantity.name).map_or("", |info| info.unit);
    let parts = parts_of(kind, quantity, wanted);
    let carpet = if parts.len() > 1 { SMALL_CARPET } else { CARPET };
    let mut charts = Vec::new();
    for (place, shown) in parts.into_iter().take(CHARTS).enumerate() {
        let Shown { title, axis, columns: part } = shown;
        let id = if place == 0 { id.into() } else { format!("{id}-{}", place + 1) };
        let of = |i: usize, row: Row<'_>| row[quantity][i];
        let start = rows.ends().map(|[(_, row), _]| row);
        let value = |i: usize, row: Row<'_>| match start.filter(|_| from_start) {
            Some(start) => of(i, row) - of(i, start),
            None => of(i, row),
        };
        let (title, axis) = match (from_start, start) {
            (true, Some(start)) if part.len() == 1 => {
                let value = short(of(part[0], start), 6);
                (format!("{title}: how far it is from its start"), format!("{axis} − {value}"))
            }
            (true, _) => {
                (format!("{title}: how far it is from its start"), format!("{axis} − its start"))
            }
            (false, _) => (title, axis),
        };
        let lines = |first: bool| -> Vec<Line> {
            let line = |i: usize| {
                let name = words::column(&quantity.columns[i]);
                let point = |(t, row): (f64, Row<'_>)| (t, value(i, row));
                let points = match first {
                    true => rows.first().map(point).collect(),
                    false => rows.rows().map(point).collect(),
                };
                Line { name, points }
            };
            part.iter().copied().map(line).collect()
        };
        let axis = Axis::linear(axis).with_unit(unit);
        charts.extend(chart(&id, &title, &axis, lines, carpet, summary));
    }
    let closed = charts.split_off(charts.len().min(OPEN));
    if !closed.is_empty() {
        let names = format!("More of {} ({})", words::on_axis(quantity), closed.len());
        charts.push(Block::fold(names, in_rows(closed)));
    }
    charts
}

/// Charts next to each other: two in a row, or three if there are just three.
pub(super) fn in_rows(charts: Vec<Block>) -> Vec<Block> {
    charts
        .chunk_by(|a, b| matches!((a, b), (Block::Chart(_), Block::Chart(_))))
        .flat_map(|alike| alike.chunks(if alike.len() == 3 { 3 } else { 2 }))
        .map(|row| match row {
            [one] => one.clone(),
            several => Block::Row(several.to_vec()),
        })
        .collect()
}

/// Columns of one chart.
#[derive(Debug, PartialEq)]
struct Shown {
    title: String,
    axis: String,
    columns: Vec<usize>,
}

/// The columns that belong together: all of a few, the parts of a composed system, or those of one name; those with
/// the fewest columns first.
fn parts_of(kind: &Kind, quantity: &Observable, wanted: &[String]) -> Vec<Shown> {
    let names = &quantity.columns;
    let is_wanted = |i: &usize| {
        wanted.is_empty() || wanted.iter().any(|name| *name == names[*i] || name == quantity.name)
    };
    let all: Vec<usize> = (0..names.len()).filter(is_wanted).collect();
    let of_formulas = kind.quantity(quantity.name).is_err();
    let title = || words::title(kind, quantity);
    let mut parts: Vec<Shown> = if quantity.parts.len() > 1 {
        let part = |part: &Part| Shown {
            title: words::of_part(part),
            axis: part.name.replace('_', " "),
            columns: part.columns.clone().filter(is_wanted).collect(),
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
                _ if of_formulas => (words::by_formula(&name), name),
                true => (format!("{}: {name}", title()), name),
                false => (title(), words::on_axis(quantity)),
            };
            Shown { title, axis, columns: columns.to_vec() }
        };
        (1..).zip(&groups).map(group).collect()
    } else {
        vec![Shown { title: title(), axis: words::on_axis(quantity), columns: all }]
    };
    parts.sort_by_key(|part| part.columns.len());
    parts.into_iter().flat_map(|part| part.pieces(names)).collect()
}

impl Shown {
    /// The part in pieces of a few columns: the rows of a matrix, where its columns are entries.
    fn pieces(self, names: &[String]) -> Vec<Shown> {
        if self.columns.len() <= LINES {
            return vec![self];
        }
        let entry = |i: &usize| &names[*i].as_bytes()[words::stem(&names[*i]).len()..];
        let of_matrix = self.columns.iter().all(|i| entry(i).len() == 2);
        let same_row = |a: &usize, b: &usize| !of_matrix || entry(a)[0] == entry(b)[0];
        let rows = self.columns.chunk_by(same_row).flat_map(|row| {
            let whole = of_matrix && row.len() <= LINES;
            row.chunks(LINES).map(move |columns| (whole, columns))
        });
        let piece = |(whole, columns): (bool, &[usize])| {
            let [first, last] = [columns[0], columns[columns.len() - 1]].map(|i| &names[i]);
            let name = match whole {
                true => format!("row {}", char::from(entry(&columns[0])[0])),
                false => format!("{} to {}", words::column(first), words::column(last)),
            };
            let title = format!("{}: {name}", self.title);
            Shown { title, axis: self.axis.clone(), columns: columns.to_vec() }
        };
        rows.map(piece).collect()
    }
}

/// One chart, or two of a run with more swings than `carpet`: the first of them, and the ranges of all.
fn chart(
    id: &str,
    title: &str,
    axis: &Axis,
    lines: impl Fn(bool) -> Vec<Line>,
    carpet: usize,
    summary: &Summary,
) -> Vec<Block> {
    let axes = || [Axis::linear("t"), axis.clone()];
    let series = |(i, line): (usize, Line)| {
        Series::line(line.name, i, line.points.into_iter().map(Point::from))
    };
    let whole = lines(false);
    let most = whole.iter().map(|line| swings(&line.points).len()).max().unwrap_or(0);
    if most <= carpet {
        let lines = whole.into_iter().enumerate().map(series);
        return vec![marked(Chart::new(id, title, axes(), lines), summary).into()];
    }
    let mut first = lines(true);
    let ends = first.iter().filter_map(|line| {
        let swings = swings(&line.points);
        swings.get(FIRST).map(|i| line.points[*i].0)
    });
    let start = first[0].points[0].0;
    let near = |a: &f64, b: &f64| (a - start).abs().total_cmp(&(b - start).abs());
    let end = ends.min_by(near).unwrap_or(first[0].points[first[0].points.len() - 1].0);
    for line in &mut first {
        line.points.retain(|(t, _)| (t - start).abs() <= (end - start).abs());
    }
    let beginning = format!("{title}, at the beginning");
    let first = Chart::new(id, beginning, axes(), first.into_iter().enumerate().map(series));
    let first = first.with_caption("The first swings of many. The file of the rows has them all.");
    let mut charts = vec![Block::from(marked(first, summary))];
    if whole.len() <= BANDS {
        let ranges = whole.into_iter().enumerate().map(|(i, line)| {
            series((
                i,
                Line { points: range(&line.points, (most / EACH).clamp(LEAST, RANGES)), ..line },
            ))
            .with_fill()
        });
        let title = format!("{title}, the whole run");
        let ranges = Chart::new(format!("{id}-whole"), title, axes(), ranges).with_caption(
            "Too many swings to draw: each band is filled from the lowest to the highest values.",
        );
        charts.push(ranges.into());
    }
    charts
}

/// Where a line turns back, by more than a tenth of its height.
fn swings(points: &[(f64, f64)]) -> Vec<usize> {
    let (low, high) =
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, x)| {
            (low.min(*x), high.max(*x))
        });
    let gap = 0.1 * (high - low);
    let mut found = Vec::new();
    let Some((_, mut extreme)) = points.first().copied() else { return found };
    let mut sign = 1.0;
    for (i, (_, x)) in points.iter().enumerate() {
        if sign * (x - extreme) >= 0.0 {
            extreme = *x;
        } else if sign * (extreme - x) > gap {
            (sign, extreme) = (-sign, *x);
            found.push(i);
        }
    }
    found
}

/// The highest values in so many parts of a line from the start to the end, and the lowest back to the start.
fn range(points: &[(f64, f64)], count: usize) -> Vec<(f64, f64)> {
    let finite: Vec<_> = points.iter().filter(|(_, x)| x.is_finite()).copied().collect();
    let parts = || finite.chunks(finite.len().div_ceil(count).max(1));
    let middle = |part: &[(f64, f64)]| part[part.len() / 2].0;
    let of = |part: &[(f64, f64)], better: fn(f64, f64) -> f64| {
        (middle(part), part.iter().map(|(_, x)| *x).fold(f64::NAN, better))
    };
    let above = parts().map(|part| of(part, f64::max));
    above.chain(parts().rev().map(|part| of(part, f64::min))).collect()
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
    fn swings_are_counted_and_their_ranges_found() {
        let wave: Vec<(f64, f64)> =
            (0..4000).map(|i| (f64::from(i), (0.5 * f64::from(i)).sin())).collect();
        let turns = 2000.0 / core::f64::consts::PI;
        assert!((swings(&wave).len() as f64 - turns).abs() < 2.0);
        assert!(swings(&[(0.0, 1.0); 5]).is_empty() && swings(&[]).is_empty());
        let band = range(&wave, RANGES);
        assert_eq!(band.len(), 2 * RANGES);
        assert!(band[0].1 > 0.95 && band[2 * RANGES - 1].1 < -0.95);
        assert!(range(&[(0.0, f64::NAN)], RANGES).is_empty());
    }

    #[test]
    fn charts_stand_in_rows_of_two_or_three() {
        let chart =
            || Block::Chart(Chart::new("c", "", [Axis::linear("t"), Axis::linear("x")], []));
        let rows = |charts: usize| -> Vec<usize> {
            let mut blocks: Vec<Block> = (0..charts).map(|_| chart()).collect();
            blocks.push(Block::fold("more", vec![]));
            let row = |block: &Block| if let Block::Row(row) = block { row.len() } else { 1 };
            in_rows(blocks).iter().map(row).collect()
        };
        assert_eq!([1, 2, 3, 4].map(rows), [vec![1, 1], vec![2, 1], vec![3, 1], vec![2, 2, 1]]);
    }

    /// A scene of several kinds of parts, and one of a matrix: what is drawn in which chart.
    #[test]
    fn columns_of_one_name_are_a_part() {
        let shown = |scene: &str, quantity: &str, wanted: &[&str]| -> Vec<(String, usize)> {
            let scene = Scene::bundled(scene).unwrap();
            let model = scene.model_with(scene.layer, &[quantity]).unwrap();
            let wanted: Vec<String> = wanted.iter().map(|name| name.to_string()).collect();
            let quantity = model.schema().get(quantity).unwrap();
            let parts = parts_of(scene.problem.kind(), quantity, &wanted);
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
        let of_one_part = parts_of(scene.problem.kind(), state, &[]);
        assert!(of_one_part.iter().all(|part| part.axis == "g"), "{of_one_part:?}");
    }
}
