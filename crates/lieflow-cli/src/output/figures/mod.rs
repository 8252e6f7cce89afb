//! A run as a page: how it went, how it moves, what was asked for against time, and the drifts.

mod lines;
mod motion;
mod sample;
mod words;

pub use sample::RowSample;

use lieflow_figures::number::{seconds, short, sig};
use lieflow_figures::{
    self as figures, Axis, Block, Body, Cell, Chart, Column, Ground, Heat, LINE_COLOURS, Marker,
    Page, Path, Point, Scale, Section, Series, Sphere, Table,
};
use lieflow_model::problem;
use lieflow_model::problem::{Figure, PrincipalInertia};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Observable, Row};

use self::lines::{LINES, against_time, constant, in_rows, marked};
use crate::error::CliError;
use crate::output::{EVENTS, SUMMARY, Summary};

/// Rows of a table that is open.
const MANY: usize = 10;
/// Points of a figure of points.
const POINTS: usize = 128;

/// The parts of a run that are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The rows.
    pub rows: &'a RowSample<'a>,
    /// The quantity of the figure of its kind.
    pub figure: &'a Observable,
    /// The field, where that figure is a map of one.
    pub field: &'a [Vec<f64>],
    /// The quantities of the scene.
    pub asked: &'a [&'a Observable],
    /// The invariants.
    pub watched: &'a [&'a Observable],
}

/// The page of a run.
pub fn run_page(summary: &Summary, run: &Drawn<'_>) -> Page {
    let kind = run.scene.problem.kind();
    let figure = run.scene.problem.figure(&run.scene.computed());
    let wanted = &run.scene.plot[..];
    let mut motion = own_figure(summary, run, figure);
    let mut constants = Vec::new();
    let mut charts = Vec::new();
    let is_line = matches!(figure, Figure::Lines(_));
    let wants = |quantity: &Observable| {
        wanted.iter().any(|name| *name == quantity.name || quantity.columns.contains(name))
    };
    if is_line {
        let columns = if wants(run.figure) { wanted } else { &[] };
        let lines = against_time("figure", kind, run.figure, run.rows, columns, summary);
        charts.push((run.figure, lines));
    }
    let drawn = |asked: &&&Observable| {
        let again = is_line && asked.name == run.figure.name;
        !again && (wanted.is_empty() || wants(asked))
    };
    for quantity in run.asked.iter().filter(drawn) {
        if let Some(value) = constant(quantity, run.rows) {
            constants.push((words::title(kind, quantity), value));
            continue;
        }
        let id = format!("time-{}", quantity.name.replace('_', "-"));
        let lines = against_time(&id, kind, quantity, run.rows, wanted, summary);
        charts.push((*quantity, lines));
    }
    let inertia = run.scene.problem.inertia();
    if let Some(body) = inertia.and_then(|inertia| motion::body(&inertia, run.rows)) {
        motion.insert(0, body.into());
    }
    // A single body or sphere has the first chart beside it, unless that is one of many of another quantity.
    if let ([Block::Sphere(_) | Block::Body(_)], Some((quantity, lines))) =
        (&motion[..], charts.first_mut())
        && (lines.len() <= 2 || quantity.name == run.figure.name)
        && matches!(lines.first(), Some(Block::Chart(_)))
    {
        motion.push(lines.remove(0));
    }
    let motion = if motion.len() > 1 { vec![Block::Row(motion)] } else { motion };
    let mut charts: Vec<Block> = charts.into_iter().flat_map(|(_, lines)| in_rows(lines)).collect();
    if !constants.is_empty() {
        charts.push(Block::text("These quantities stay as they are at the start:"));
        charts.push(Block::Facts(constants));
    }
    let mut result: Vec<Block> = summary.warnings.iter().cloned().map(Block::Notice).collect();
    result
        .extend(summary.failure.iter().map(|why| Block::Notice(format!("The run stopped: {why}"))));
    result.extend(summary.accuracy.as_ref().map(|accuracy| {
        let right = accuracy.rightness_in_words();
        let found = accuracy.found_in_words(summary.rows);
        let errors = accuracy.errors_in_words().replace('_', " ");
        Block::text(format!("In the worst row {right}. The error, {found}: {errors}."))
    }));
    let told = |why: &String| Block::text(format!("The error is {why}."));
    result.extend(summary.accuracy_unknown.iter().map(told));
    result.extend(summary.notes.iter().map(|note| Block::text(format!("Note: {note}."))));
    result.push(facts(summary));
    let mut sections = vec![
        Section::new("How it went", result),
        Section::new("The motion", motion),
        Section::new("Over time", charts),
    ];
    if !run.watched.is_empty() {
        let invariants =
            vec![drift_table(summary), Block::Chart(drifts(summary, run.watched, run.rows))];
        sections.push(Section::new("What the exact motion conserves", invariants));
    }
    let text = vec![Block::Code(run.scene.text.clone())];
    let scene = vec![Block::fold("The scene, to run it again or to change it", text)];
    sections.push(Section::new("The scene", scene));
    sections.retain(|section| !section.blocks.is_empty());
    let [t0, t1] = summary.t_span;
    let t1 = summary.t_end.unwrap_or(t1);
    let mut links =
        vec![("The rows (CSV)", summary.trajectory), ("The numbers of this page (JSON)", SUMMARY)];
    if !summary.events.is_empty() {
        links.insert(1, ("The events (CSV)", EVENTS[usize::from(!summary.completed)]));
    }
    Page {
        title: summary.title.clone(),
        subtitle: format!(
            "{}: {}, t = {} to {}, in the units of the scene",
            summary.problem,
            summary.modelled.join(", "),
            in_digits(t0),
            in_digits(t1)
        ),
        links: links.into_iter().map(|(text, file)| (text.into(), file.into())).collect(),
        sections,
        footer: format!("lieflow {}", summary.lieflow),
    }
}

/// The body of a scene as it turns, by a run of that scene.
///
/// # Errors
/// The scene does not run.
pub fn moving_body(scene: &Scene) -> Result<Option<Body>, CliError> {
    let model = scene.model()?;
    let mut rows = RowSample::new(model.schema());
    model.run(&scene.method, &scene.grid, &scene.save, &mut |t, row| rows.see(t, row))?;
    Ok(scene.problem.inertia().and_then(|inertia| motion::body(&inertia, &rows)))
}

/// A number with as many digits as a reader looks at.
pub fn in_digits(x: f64) -> String {
    short(x, 8)
}

/// The number of steps and their size.
fn steps(summary: &Summary) -> String {
    let count = summary.steps;
    match (summary.dt, &summary.adaptive) {
        (Some(dt), _) => format!("{count} of {}", in_digits(dt)),
        (None, Some(chosen)) => format!(
            "{count}, from {} to {}; {} tried again",
            sig(chosen.smallest_step, 2),
            sig(chosen.largest_step, 2),
            chosen.rejected
        ),
        (None, None) => count.to_string(),
    }
}

fn facts(summary: &Summary) -> Block {
    let mut facts = vec![
        ("Method".into(), summary.method.label.clone()),
        ("Steps".into(), steps(summary)),
        ("Time to compute".into(), seconds(summary.wall_time_s)),
        ("Rows".into(), summary.rows.to_string()),
    ];
    if let (Some(rtol), Some(atol)) = (summary.rtol, summary.atol) {
        facts.push((
            "Tolerance".into(),
            format!("relative {}, absolute {}", short(rtol, 2), short(atol, 2)),
        ));
    }
    facts.extend(
        summary.defaults_in_words.iter().map(|chosen| ("Chosen by default".into(), chosen.clone())),
    );
    facts.extend(
        summary.facts.iter().map(|(name, value)| (name.replace('_', " "), in_digits(*value))),
    );
    facts.extend(summary.events.iter().map(|event| {
        let mut text = format!("{} times", event.count);
        if let (Some(first), Some(last)) = (event.first, event.last) {
            text += &format!(", from t = {} to {}", in_digits(first), in_digits(last));
        }
        event.time_error_in_words().iter().for_each(|error| text += &format!("; {error}"));
        (format!("Event {}", event.name), text)
    }));
    if let Some(name) = &summary.ended_by {
        facts.push(("Ended by".into(), format!("event {name}")));
    }
    Block::Facts(facts)
}

/// The figure of the kind, where it is not of lines against time.
fn own_figure(summary: &Summary, run: &Drawn<'_>, figure: Figure) -> Vec<Block> {
    let id = "figure".to_string();
    let title = words::title(run.scene.problem.kind(), run.figure);
    match figure {
        Figure::Lines(_) => Vec::new(),
        Figure::Sphere(_) => vec![sphere(id, title, run).into()],
        Figure::Curve(_) => vec![plane(id, &title, run.figure, run.rows, false).into()],
        Figure::Points(_) => vec![plane(id, &title, run.figure, run.rows, true).into()],
        Figure::Map(_, ground) => {
            let end = summary.t_end.unwrap_or(summary.t_span[1]);
            let title = format!("The field at t = {}", in_digits(end));
            let ground = match ground {
                problem::Ground::Sphere => Ground::Sphere,
                problem::Ground::Torus => Ground::Torus,
            };
            let (values, caption) = (run.field.to_vec(), String::new());
            vec![Block::Heat(Heat { id, title, ground, values, caption })]
        }
    }
}

fn said(name: &str, drawn: usize, all: usize) -> String {
    match drawn < all {
        true => format!("The first {drawn} of {all} parts of {name}."),
        false => String::new(),
    }
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
    let every = if points { rows.kept().div_ceil(POINTS).max(1) } else { 1 };
    let series = (0..pairs.min(LINE_COLOURS)).map(|k| {
        let of_row = |(_, row): (f64, Row<'_>)| {
            let values = &row[quantity];
            Point::new(values[2 * k], values[2 * k + 1])
        };
        Series {
            name: words::path(quantity, &quantity.columns[2 * k..2 * k + 2], k + 1),
            colour: k,
            points: rows.rows().step_by(every).map(of_row).collect(),
            marker: if points { Marker::Dot } else { Marker::None },
            ..Series::default()
        }
    });
    let axis = |i: usize| {
        let names = quantity.columns.iter().skip(i).step_by(2).take(LINE_COLOURS);
        names.map(|name| words::column(name)).collect::<Vec<_>>().join(", ")
    };
    let axes = [axis(0), axis(1)].map(|name| Axis::new(name, Scale::Linear));
    let caption = said(quantity.name, pairs.min(LINE_COLOURS), pairs);
    Chart::new(id, title, axes, series).with_caption(caption)
}

/// Triples of columns as paths on a sphere, each in lengths of its own start.
fn sphere(id: String, title: String, run: &Drawn<'_>) -> Sphere {
    let (quantity, rows) = (run.figure, run.rows);
    let triples = quantity.columns.len() / 3;
    let at =
        |k: usize, row: Row<'_>| -> [f64; 3] { core::array::from_fn(|i| row[quantity][3 * k + i]) };
    let length = |k: usize| {
        let squares = |row| at(k, row).iter().map(|x| x * x).sum::<f64>();
        rows.ends().map_or(1.0, |[(_, row), _]| squares(row).sqrt())
    };
    let path = |k: usize| {
        let length = length(k);
        let points = rows.rows().map(|(_, row)| at(k, row).map(|x| x / length));
        points.collect::<Vec<_>>()
    };
    let name = |k: usize| match triples {
        _ if quantity.parts.len() == triples && !quantity.parts[k].name.is_empty() => {
            quantity.parts[k].name.clone()
        }
        1 => words::on_axis(quantity),
        _ => words::path(quantity, &quantity.columns[3 * k..3 * k + 3], k + 1),
    };
    let paths: Vec<Path> = (0..triples.min(LINE_COLOURS))
        .map(|k| Path { name: name(k), colour: k, points: path(k) })
        .collect();
    // From the side of the equator that the paths are on.
    let height: f64 = paths.iter().flat_map(|path| &path.points).map(|x| x[2]).sum();
    // A free body keeps its energy: its momentum is on an ellipsoid too.
    let free =
        quantity.name == "momentum_body" && run.watched.iter().any(|law| law.name == "energy");
    let inertia = run
        .scene
        .problem
        .inertia()
        .filter(|inertia| free && *inertia == PrincipalInertia::diagonal(inertia.moments));
    let inertia = inertia.map_or([f64::NAN; 3], |inertia| inertia.moments);
    let start = paths.first().and_then(|path| path.points.first());
    let energy =
        start.map_or(f64::NAN, |m| (0..3).map(|i| m[i].powi(2) / (2.0 * inertia[i])).sum());
    let surfaces = match energy.is_finite() {
        true => {
            "The sphere is |m| = const, and the ellipsoid is energy = const. A free body keeps both."
        }
        false => "",
    };
    let scaled = match (0..triples).all(|k| (length(k) - 1.0).abs() < 1e-9) {
        true => "",
        false => "Each vector is divided by its length at the start.",
    };
    let caption =
        format!("{} {scaled} {surfaces}", said(quantity.name, triples.min(LINE_COLOURS), triples));
    Sphere {
        id,
        title,
        radius: 1.0,
        inertia,
        energy,
        paths,
        caption: caption.trim().into(),
        view: (35.0, if height < 0.0 { -25.0 } else { 25.0 }),
    }
}

fn drift_table(summary: &Summary) -> Block {
    let columns = vec![
        Column::text("Quantity"),
        Column::number("at the start"),
        Column::number("largest change"),
        Column::number("change at the end"),
        Column::number("change per unit of time"),
        Column::text("the method"),
        Column::number("rounding alone"),
    ];
    let rows = summary.drift.iter().map(|(name, drift)| {
        let promise = match (drift.promised, drift.breaks_a_promise()) {
            (true, false) => "keeps it to rounding",
            (true, true) => "promises to keep it, and did not",
            (false, _) => "does not keep it exactly",
        };
        let small = |x: f64| sig(x, 2);
        let cells = [
            words::column(name).into(),
            Cell::number(drift.initial, |x| short(x, 6)),
            Cell::number(drift.max, small),
            Cell::number(drift.at_end, small),
            Cell::number(drift.slope, small),
            promise.into(),
            Cell::number(drift.rounding, small),
        ];
        figures::Row::new(cells).with_emphasis(drift.breaks_a_promise())
    });
    let caption =
        "How far the computed values are from the start. The exact motion conserves each of them.";
    let table = Block::Table(Table { caption: caption.into(), columns, rows: rows.collect() });
    match summary.drift.len() {
        ..=MANY => table,
        all => Block::fold(format!("All {all} quantities as a table"), vec![table]),
    }
}

/// |value − initial| of the invariants against time.
fn drifts(summary: &Summary, watched: &[&Observable], rows: &RowSample<'_>) -> Chart {
    let all = watched
        .iter()
        .flat_map(|law| law.columns.iter().enumerate().map(move |(i, column)| (law, i, column)));
    let mut all: Vec<_> = all.collect();
    let moved = |column: &str| summary.drift.get(column).map_or(0.0, |drift| drift.max);
    all.sort_by(|(.., a), (.., b)| moved(b).total_cmp(&moved(a)));
    let told = match all.len() {
        ..=LINES => String::new(),
        count => format!(" The {LINES} that moved most, of {count}."),
    };
    let series = all.into_iter().take(LINES).enumerate().map(|(colour, (law, i, column))| {
        let initial = summary.drift.get(column).map_or(f64::NAN, |drift| drift.initial);
        let gap = |(t, row): (f64, Row<'_>)| (t, (row[law][i] - initial).abs());
        // A change of exactly 0, as at the start, has no place on a logarithm.
        let points = rows.rows().map(gap).filter(|(_, gap)| *gap != 0.0);
        Series::line(words::column(column), colour, points)
    });
    let axes = [Axis::linear("t"), Axis::log("|value − value at the start|")];
    let chart = Chart::new("drift", "Drifts of the invariants", axes, series);
    let caption = format!("A change of exactly 0 cannot be drawn on this axis.{told}");
    marked(chart.with_caption(caption), summary)
}
