//! A run as a page: the figure of its kind, what was asked for against time, and the drifts.

use crate::output::{EventSummary, Summary};
use lieflow_figures::number::{scientific, sig};
use lieflow_figures::{
    self as figures, Axis, Block, Cell, Chart, Column, Ground, Heat, Marker, Marks, Page, Path,
    Point, Scale, Section, Series, Sphere, Table,
};
use lieflow_model::kinds::{self, Figure};
use lieflow_model::schema::{Observable, Row, Schema};

/// Rows that are kept for figures: some for each pixel.
const KEPT: usize = 2048;
/// Numbers that are kept: a row may have many.
const NUMBERS: usize = 1 << 22;
/// Points of a figure of points.
const POINTS: usize = 128;
/// Lines of a chart that a reader can tell apart.
const LINES: usize = 8;

/// The rows of a run, at regular distances, so that a long run needs no more memory than a short one.
#[derive(Clone, Debug)]
pub struct RowSample<'a> {
    schema: &'a Schema,
    rows: Vec<(f64, Vec<f64>)>,
    last: Option<(f64, Vec<f64>)>,
    every: usize,
    seen: usize,
}

impl<'a> RowSample<'a> {
    /// No rows yet.
    pub fn new(schema: &'a Schema) -> Self {
        RowSample { schema, rows: Vec::new(), last: None, every: 1, seen: 0 }
    }

    /// The next row.
    pub fn see(&mut self, t: f64, row: Row<'_>) {
        let row = row.numbers();
        if self.seen.is_multiple_of(self.every) {
            let room = KEPT.min(NUMBERS / row.len().max(1)).max(2);
            if self.rows.len() >= room {
                let mut odd = true;
                self.rows.retain(|_| {
                    odd = !odd;
                    !odd
                });
                self.every *= 2;
            }
            if self.seen.is_multiple_of(self.every) {
                self.rows.push((t, row.into()));
            }
        }
        match &mut self.last {
            Some((time, last)) => {
                *time = t;
                last.copy_from_slice(row);
            }
            None => self.last = Some((t, row.into())),
        }
        self.seen += 1;
    }

    /// The first row, and the last.
    pub fn ends(&self) -> Option<[(f64, Row<'_>); 2]> {
        Some([self.rows.first()?, self.last.as_ref()?].map(|row| self.named(row)))
    }

    /// Those that were kept, and the last.
    fn rows(&self) -> impl Iterator<Item = (f64, Row<'_>)> {
        let kept = self.rows.last().map(|(t, _)| *t);
        let last = self.last.iter().filter(move |(t, _)| kept != Some(*t));
        self.rows.iter().chain(last).map(|row| self.named(row))
    }

    fn named<'s>(&'s self, (t, numbers): &'s (f64, Vec<f64>)) -> (f64, Row<'s>) {
        (*t, self.schema.row(numbers))
    }
}

/// The page of a run: `asked` are the quantities of the scene, `drawn` the one of its figure, with the
/// field where it is a map, and `watched` the invariants.
pub fn run_page(
    summary: &Summary,
    rows: &RowSample<'_>,
    (figure, field): (Figure, Vec<Vec<f64>>),
    drawn: &Observable,
    asked: &[&Observable],
    watched: &[&Observable],
) -> Page {
    let own = own_figure(summary, (figure, field), drawn, rows);
    let drawn_already =
        |quantity: &Observable| quantity.name == drawn.name && matches!(figure, Figure::Lines(_));
    let over_time = asked.iter().filter(|quantity| !drawn_already(quantity)).map(|quantity| {
        let id = format!("time-{}", quantity.name.replace('_', "-"));
        Block::Chart(lines(id, &quantity.name.replace('_', " "), quantity, rows, summary))
    });
    let mut sections = vec![
        Section::new("In short", vec![facts(summary)]),
        Section::new("Figure", vec![own]),
        Section::new("Over time", over_time.collect()),
    ];
    if !watched.is_empty() {
        sections.push(Section::new(
            "Invariants",
            vec![drift_table(summary), Block::Chart(drifts(summary, watched, rows))],
        ));
    }
    sections.retain(|section| !section.blocks.is_empty());
    let [t0, t1] = summary.t_span;
    let t1 = summary.t_end.unwrap_or(t1);
    Page {
        title: summary.title.clone(),
        subtitle: format!(
            "{}, {}, t = {t0} … {t1}",
            summary.modelled.join(", "),
            summary.method.label
        ),
        sections,
        footer: format!("lieflow {}", summary.lieflow),
    }
}

/// A number with as many digits as a reader looks at.
pub fn in_digits(x: f64) -> String {
    sig(x, 8)
}

fn facts(summary: &Summary) -> Block {
    let mut facts = vec![
        ("Problem".into(), summary.problem.into()),
        ("Modelled".into(), summary.modelled.join(", ")),
        ("Method".into(), summary.method.label.clone()),
        ("Layer".into(), summary.layer.into()),
        ("Steps".into(), summary.steps.to_string()),
    ];
    facts.extend(
        summary.facts.iter().map(|(name, value)| (name.replace('_', " "), in_digits(*value))),
    );
    facts.extend(summary.events.iter().map(|event| {
        let mut text = format!("{} times", event.count);
        if let (Some(first), Some(last)) = (event.first, event.last) {
            text += &format!(", from t = {} to {}", in_digits(first), in_digits(last));
        }
        (format!("Event {}", event.name), text)
    }));
    if let Some(name) = &summary.ended_by {
        facts.push(("Ended by".into(), format!("event {name}")));
    }
    if let Some(failure) = &summary.failure {
        facts.push(("Stopped".into(), failure.clone()));
    }
    facts.extend(
        summary
            .error_at_end
            .iter()
            .flatten()
            .map(|(name, error)| (format!("Error of {name} at the end"), scientific(*error))),
    );
    facts.extend(summary.warnings.iter().map(|warning| ("Warning".into(), warning.clone())));
    Block::Facts(facts)
}

/// The chart with the events of the run.
fn marked(chart: Chart, summary: &Summary) -> Chart {
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

fn own_figure(
    summary: &Summary,
    (figure, field): (Figure, Vec<Vec<f64>>),
    drawn: &Observable,
    rows: &RowSample<'_>,
) -> Block {
    let (id, title) = ("figure".to_string(), summary.title.as_str());
    match figure {
        Figure::Lines(_) => Block::Chart(lines(id, title, drawn, rows, summary)),
        Figure::Sphere(_) => Block::Sphere(sphere(id, title, drawn, rows)),
        Figure::Curve(_) => Block::Chart(plane(id, title, drawn, rows, false)),
        Figure::Points(_) => Block::Chart(plane(id, title, drawn, rows, true)),
        Figure::Map(_, ground) => {
            let caption = "As it is at the end.".into();
            let ground = match ground {
                kinds::Ground::Sphere => Ground::Sphere,
                kinds::Ground::Torus => Ground::Torus,
            };
            Block::Heat(Heat { id, title: title.into(), ground, values: field, caption })
        }
    }
}

fn said(name: &str, drawn: usize, all: usize) -> String {
    match drawn < all {
        true => format!("The first {drawn} of {all} parts of {name}."),
        false => String::new(),
    }
}

/// The columns of a quantity against time.
fn lines(
    id: String,
    title: &str,
    quantity: &Observable,
    rows: &RowSample<'_>,
    summary: &Summary,
) -> Chart {
    let name = quantity.name.replace('_', " ");
    let series = quantity.columns.iter().enumerate().take(LINES).map(|(i, column)| Series {
        name: column.clone(),
        colour: i,
        points: rows.rows().map(|(t, row)| Point::new(t, row[quantity][i])).collect(),
        marker: Marker::None,
        ..Series::default()
    });
    let axes = [Axis::new("time t", Scale::Linear), Axis::new(name.clone(), Scale::Linear)];
    let caption = said(&name, quantity.columns.len().min(LINES), quantity.columns.len());
    marked(Chart::new(id, title, axes, series).with_caption(caption), summary)
}

/// Pairs of columns as paths or points of a plane.
fn plane(
    id: String,
    title: &str,
    quantity: &Observable,
    rows: &RowSample<'_>,
    points: bool,
) -> Chart {
    let pairs = quantity.columns.len() / 2;
    let every = if points { rows.rows.len().div_ceil(POINTS).max(1) } else { 1 };
    let series = (0..pairs.min(LINES)).map(|k| {
        let of_row = |(_, row): (f64, Row<'_>)| {
            let values = &row[quantity];
            Point::new(values[2 * k], values[2 * k + 1])
        };
        Series {
            name: quantity.columns[2 * k..2 * k + 2].join(", "),
            colour: k,
            points: rows.rows().step_by(every).map(of_row).collect(),
            marker: if points { Marker::Dot } else { Marker::None },
            ..Series::default()
        }
    });
    let axis = |i: usize| {
        let names = quantity.columns.iter().skip(i).step_by(2).take(LINES);
        names.cloned().collect::<Vec<_>>().join(", ")
    };
    let axes = [axis(0), axis(1)].map(|name| Axis::new(name, Scale::Linear));
    let caption = said(quantity.name, pairs.min(LINES), pairs);
    Chart::new(id, title, axes, series).with_caption(caption)
}

/// Triples of columns as paths on a sphere, each in lengths of its own start.
fn sphere(id: String, title: &str, quantity: &Observable, rows: &RowSample<'_>) -> Sphere {
    let triples = quantity.columns.len() / 3;
    let path = |k: usize| {
        let at = |row: Row<'_>| -> [f64; 3] { core::array::from_fn(|i| row[quantity][3 * k + i]) };
        let length = rows
            .ends()
            .map_or(1.0, |[(_, row), _]| at(row).iter().map(|x| x * x).sum::<f64>().sqrt());
        let points = rows.rows().map(|(_, row)| at(row).map(|x| x / length));
        points.collect::<Vec<_>>()
    };
    let name = |k: usize| match triples {
        1 => quantity.name.replace('_', " "),
        _ => quantity.columns[3 * k..3 * k + 3].join(", "),
    };
    let paths: Vec<Path> = (0..triples.min(LINES))
        .map(|k| Path { name: name(k), colour: k, points: path(k) })
        .collect();
    // From the side of the equator that the paths are on.
    let height: f64 = paths.iter().flat_map(|path| &path.points).map(|x| x[2]).sum();
    Sphere {
        id,
        title: title.into(),
        radius: 1.0,
        // No ellipsoid of energy.
        inertia: [f64::NAN; 3],
        energy: f64::NAN,
        paths,
        caption: said(quantity.name, triples.min(LINES), triples),
        view: (35.0, if height < 0.0 { -25.0 } else { 25.0 }),
    }
}

fn drift_table(summary: &Summary) -> Block {
    let columns = vec![
        Column::text("Invariant"),
        Column::number("at the start"),
        Column::number("largest drift"),
        Column::number("at the end"),
        Column::number("slope"),
        Column::text("the method"),
        Column::number("rounding explains"),
    ];
    let rows = summary.drift.iter().map(|(name, drift)| {
        let promise = match (drift.promised, drift.breaks_a_promise()) {
            (true, false) => "keeps it to rounding",
            (true, true) => "promises to keep it, and did not",
            (false, _) => "promises nothing",
        };
        let cells = [
            name.as_str().into(),
            Cell::number(drift.initial, |x| format!("{x:.6e}")),
            Cell::number(drift.max, scientific),
            Cell::number(drift.at_end, scientific),
            Cell::number(drift.slope, scientific),
            promise.into(),
            Cell::number(drift.rounding, scientific),
        ];
        figures::Row::new(cells).with_emphasis(drift.breaks_a_promise())
    });
    Block::Table(Table {
        caption: format!("Drifts, at the {}.", summary.drift_computed_at),
        columns,
        rows: rows.collect(),
    })
}

/// |value − initial| of the invariants against time.
fn drifts(summary: &Summary, watched: &[&Observable], rows: &RowSample<'_>) -> Chart {
    let all = watched
        .iter()
        .flat_map(|law| law.columns.iter().enumerate().map(move |(i, column)| (law, i, column)));
    let series = all.take(LINES).enumerate().map(|(colour, (law, i, column))| {
        let initial = summary.drift.get(column).map_or(f64::NAN, |drift| drift.initial);
        let gap = |(t, row): (f64, Row<'_>)| (t, (row[law][i] - initial).abs());
        // A drift of exactly 0, as at the start, has no place on a logarithm.
        let points = rows.rows().map(gap).filter(|(_, gap)| *gap != 0.0);
        Series {
            name: column.clone(),
            colour,
            points: points.map(|(t, gap)| Point::new(t, gap)).collect(),
            marker: Marker::None,
            ..Series::default()
        }
    });
    let y = Axis::new("|value − value at the start|", Scale::Log10);
    let axes = [Axis::new("time t", Scale::Linear), y];
    let chart = Chart::new("drift", "Drifts of the invariants", axes, series);
    marked(chart.with_caption("A drift of exactly 0 has no place on the axis."), summary)
}
