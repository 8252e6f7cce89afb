//! The columns of a quantity against time.

use lieflow_figures::number::short;
use lieflow_figures::{Axis, Block, Chart, Marks, Point, Series};
use lieflow_model::kinds::Scale;
use lieflow_model::schema::{Observable, Row};

use super::sample::RowSample;
use super::words;
use crate::output::{EventSummary, Summary};

/// Lines of a chart that a reader can tell apart; nine for a rotation.
pub(super) const LINES: usize = 9;
/// Charts of a quantity that are open; the others are in a fold.
const OPEN: usize = 3;
/// Charts of a quantity of many columns.
const CHARTS: usize = 12;
/// Relative changes below the first are rounding, and below the second are drawn as such.
const CONSTANT: f64 = 1e-12;
const NEARLY: f64 = 1e-2;
/// Swings that a chart of the whole run can show, and swings in the chart of the first of them.
const CARPET: usize = 80;
const FIRST: usize = 16;
/// Ranges of a chart that a reader can tell apart.
const BANDS: usize = 4;
/// Parts of the run in a chart of ranges.
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

/// The charts of a quantity: of the columns that the scene wants drawn, or of all.
pub(super) fn against_time(
    id: &str,
    title: &str,
    quantity: &Observable,
    rows: &RowSample<'_>,
    wanted: &[String],
    summary: &Summary,
) -> Vec<Block> {
    let [size, change] = extent(quantity, rows);
    let from_start = change < NEARLY * size;
    let parts = parts(quantity, wanted);
    let several = parts.len() > 1;
    let mut charts = Vec::new();
    for (place, Shown { name, columns: part }) in parts.into_iter().take(CHARTS).enumerate() {
        let id = if place == 0 { id.into() } else { format!("{id}-{}", place + 1) };
        let (title, axis) = match several {
            true => (format!("{title}: {name}"), name),
            false => (title.to_string(), words::on_axis(quantity)),
        };
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
        charts.extend(chart(&id, &title, &axis, lines, summary));
    }
    let closed = charts.split_off(charts.len().min(OPEN));
    if !closed.is_empty() {
        let names = format!("More of {} ({})", words::on_axis(quantity), closed.len());
        charts.push(Block::fold(names, closed));
    }
    charts
}

/// Columns of one chart.
#[derive(Debug, PartialEq)]
struct Shown {
    name: String,
    columns: Vec<usize>,
}

/// The columns that belong together: all of a few, the parts of a composed system, or those of one name; those with
/// the fewest columns first.
fn parts(quantity: &Observable, wanted: &[String]) -> Vec<Shown> {
    let names = &quantity.columns;
    let is_wanted = |i: &usize| {
        wanted.is_empty() || wanted.iter().any(|name| *name == names[*i] || name == quantity.name)
    };
    let all: Vec<usize> = (0..names.len()).filter(is_wanted).collect();
    let parts: Vec<Vec<usize>> = match quantity.parts.len() {
        _ if all.len() <= LINES => vec![all],
        1 => {
            let same = |a: &usize, b: &usize| words::stem(&names[*a]) == words::stem(&names[*b]);
            all.chunk_by(same).map(<[usize]>::to_vec).collect()
        }
        _ => {
            let parts = quantity.parts.iter().map(|part| part.columns.clone().filter(is_wanted));
            parts.map(Iterator::collect).filter(|part: &Vec<usize>| !part.is_empty()).collect()
        }
    };
    let named = |(number, columns): (usize, Vec<usize>)| -> Vec<Shown> {
        let pieces = columns.chunks(LINES).map(|columns| {
            let columns_named: Vec<String> = columns.iter().map(|i| names[*i].clone()).collect();
            let name = match &columns_named[..] {
                [first, .., last] if columns.len() > 4 => {
                    format!("{} to {}", words::column(first), words::column(last))
                }
                few => words::path(quantity, few, number),
            };
            Shown { name, columns: columns.to_vec() }
        });
        pieces.collect()
    };
    let mut numbered: Vec<_> = (1..).zip(parts).collect();
    numbered.sort_by_key(|(_, part)| part.len());
    numbered.into_iter().flat_map(named).collect()
}

/// One chart, or two of a run with many swings: the first of them, and the ranges of all.
fn chart(
    id: &str,
    title: &str,
    axis: &str,
    lines: impl Fn(bool) -> Vec<Line>,
    summary: &Summary,
) -> Vec<Block> {
    let axes = || [Axis::linear("t"), Axis::linear(axis)];
    let series = |(i, line): (usize, Line)| {
        Series::line(line.name, i, line.points.into_iter().map(Point::from)).with_dash(i >= 8)
    };
    let whole = lines(false);
    let swinging = whole.iter().max_by_key(|line| swings(&line.points).len());
    if swinging.is_none_or(|line| swings(&line.points).len() <= CARPET) {
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
        let ranges = whole
            .into_iter()
            .enumerate()
            .map(|(i, line)| series((i, Line { points: range(&line.points), ..line })).with_fill());
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

/// The highest values of a line from the start to the end, and the lowest back to the start.
fn range(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let finite: Vec<_> = points.iter().filter(|(_, x)| x.is_finite()).copied().collect();
    let parts = || finite.chunks(finite.len().div_ceil(RANGES).max(1));
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
    let told = |event: &EventSummary| match event.marks.len() as u64 {
        drawn if drawn < event.count => format!("{}, the first {drawn} of them", event.name),
        _ => event.name.clone(),
    };
    let names: Vec<String> = events.clone().map(told).collect();
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
        let band = range(&wave);
        assert_eq!(band.len(), 2 * RANGES);
        assert!(band[0].1 > 0.95 && band[2 * RANGES - 1].1 < -0.95);
        assert!(range(&[(0.0, f64::NAN)]).is_empty());
    }

    /// A scene of several kinds of parts, and one of a matrix: what is drawn in which chart.
    #[test]
    fn columns_of_one_name_are_a_part() {
        let shown = |scene: &str, quantity: &str, wanted: &[&str]| -> Vec<(String, usize)> {
            let scene = Scene::bundled(scene).unwrap();
            let model = scene.model_with(scene.layer, &[quantity]).unwrap();
            let wanted: Vec<String> = wanted.iter().map(|name| name.to_string()).collect();
            let parts = parts(model.schema().get(quantity).unwrap(), &wanted);
            parts.into_iter().map(|part| (part.name, part.columns.len())).collect()
        };
        let bodies = (1..=4).map(|i| (format!("body {i}"), 3)).collect::<Vec<_>>();
        assert_eq!(shown("many-bodies", "momentum_body", &[]), bodies);
        let matrix = [("y₁₁ to y₂₄", 9), ("y₂₅ to y₄₃", 9), ("y₄₄ to y₅₅", 7)];
        let matrix = matrix.map(|(name, count)| (name.to_string(), count));
        assert_eq!(shown("rotating-drive", "point", &[]), matrix);
        assert_eq!(shown("rotating-drive", "point", &["y11", "y55"])[0].1, 2);
        assert_eq!(shown("wing-nut", "quaternion", &[]).len(), 1);
    }
}
