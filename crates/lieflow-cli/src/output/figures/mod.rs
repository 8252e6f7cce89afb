//! A run as a page: how it went, how it moves, what was asked for against time, and the drifts.

mod lines;
mod motion;
mod sample;
mod swings;
mod together;
mod words;

pub use sample::{RowSample, Sample};
pub use together::{Written, together, unit_of};

use core::ops::Range;

use lieflow_figures::number::{seconds, short, sig, time_or};
use lieflow_figures::{
    self as figures, Axis, Block, Body, Cell, Chart, Column as TableColumn, Ground, Heat,
    LINE_COLOURS, Marker, Page, Path, Point, Scale, Section, Series, Space, Sphere, Table,
};
use lieflow_model::problem;
use lieflow_model::problem::{Figure, PrincipalInertia};
use lieflow_model::scene::Scene;
use lieflow_model::schema::{self, Observable, Row};

use self::lines::{Column, LINES, Shown, against_time, figure, in_rows, marked};
use self::swings::Drawn as Figured;
use crate::error::CliError;
use crate::output::{Drift, EVENTS, SUMMARY, Summary};

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
    let figure = run.scene.problem.figure(&run.scene.computed());
    let is_line = matches!(figure, Figure::Lines(_));
    let mut asked_for = asked_for(summary, run, is_line);
    let mut motion = own_figure(summary, run, figure);
    let mut charts = match asked_for.is_empty() {
        true => over_time(summary, run, is_line),
        false => Vec::new(),
    };
    let inertia = run.scene.problem.inertia();
    if let Some(body) = inertia.and_then(|inertia| motion::body(&inertia, run.rows)) {
        motion.insert(0, body.into());
    }
    // A single body, sphere or path in space has a chart beside it: the first that is narrow, and not one of many of another quantity.
    if let [Block::Sphere(_) | Block::Space(_) | Block::Body(_)] = motion[..] {
        let beside = charts.iter_mut().find_map(|(quantity, figures)| {
            let is_free = figures.len() <= 2 || quantity.name == run.figure.name;
            match figures.first() {
                Some(Figured::Narrow(_)) if is_free => Some(figures.remove(0)),
                _ => None,
            }
        });
        motion.extend(beside.map(|figure| in_rows(vec![figure])).into_iter().flatten());
    }
    let motion = if motion.len() > 1 { vec![Block::Row(motion)] } else { motion };
    let charts = in_rows(charts.into_iter().flat_map(|(_, figures)| figures).collect());
    // What is asked for first is large.
    if let Some(first) = asked_for.first_mut() {
        first.widen();
    }
    let asked_for = in_rows(asked_for);
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
        Section::new("What was asked for", asked_for),
        Section::new("The motion", motion),
        Section::new("Over time", charts),
    ];
    if !run.watched.is_empty() {
        let mut invariants = vec![drift_table(summary)];
        invariants.extend(drifts(summary, run));
        sections.push(Section::new("What the exact motion conserves", invariants));
    }
    let text = vec![Block::Code(run.scene.text.clone())];
    let scene = vec![Block::fold("The scene, to run it again or to change it", text)];
    sections.push(Section::new("The scene", scene));
    sections.retain(|section| !section.blocks.is_empty());
    let [t0, t1] = summary.t_span;
    let t1 = summary.t_end.unwrap_or(t1);
    let [from, to] = [t0, t1].map(|t| time_or(t, [t0, t1], in_digits));
    let mut links =
        vec![("The rows (CSV)", summary.trajectory), ("The numbers of this page (JSON)", SUMMARY)];
    if !summary.events.is_empty() {
        links.insert(1, ("The events (CSV)", EVENTS[usize::from(!summary.completed)]));
    }
    Page {
        title: summary.title.clone(),
        subtitle: format!(
            "{}: {}, t = {from} to {to}{}",
            summary.problem,
            summary.modelled.join(", "),
            match &*summary.time_unit() {
                "" => ", in the units of the scene".into(),
                unit => format!(" {unit}"),
            }
        ),
        links: links.into_iter().map(|(text, file)| (text.into(), file.into())).collect(),
        sections,
        footer: format!("lieflow {}", summary.lieflow),
    }
}

/// The figures of the quantities of a run against time, each quantity once.
fn over_time<'a>(
    summary: &Summary,
    run: &Drawn<'a>,
    is_line: bool,
) -> Vec<(&'a Observable, Vec<Figured>)> {
    let kind = run.scene.problem.kind();
    let mut charts: Vec<(&Observable, Vec<Figured>)> = Vec::new();
    let figure = is_line.then_some(run.figure);
    for quantity in figure.into_iter().chain(run.asked.iter().copied()) {
        let figures_of = |id: &str, quantity: &Observable| {
            against_time(id, kind, quantity, run.rows, &[], summary)
        };
        let is_drawn = |name: &str| {
            charts.iter().any(|(quantity, _): &(&Observable, _)| quantity.name == name)
        };
        if is_drawn(quantity.name) {
            continue;
        }
        let id = match is_line && quantity.name == run.figure.name {
            true => "figure".into(),
            false => format!("time-{}", quantity.name.replace('_', "-")),
        };
        let mut figures = figures_of(&id, quantity);
        let drawn_as = kind.quantity(quantity.name).map_or("", |info| info.drawn_as);
        if let Ok(other) = run.rows.schema().get(drawn_as) {
            if !is_drawn(drawn_as) {
                charts.push((other, figures_of(&format!("time-{drawn_as}"), other)));
            }
            let is_one = matches!(figures[..], [Figured::Constant(..)]);
            if !is_one {
                figures = vec![Figured::Closed(words::title(kind, quantity), figures)];
            }
        }
        charts.push((quantity, figures));
    }
    charts
}

/// The figures that the scene asks for by `plot`, in their order. The first is that of the run, where its kind has none
/// of another sort.
fn asked_for(summary: &Summary, run: &Drawn<'_>, is_line: bool) -> Vec<Figured> {
    let (plot, kind) = (&run.scene.plot, run.scene.problem.kind());
    let of_name = |name: &str| -> Vec<Column<'_>> {
        if let Some(quantity) = run.asked.iter().find(|quantity| quantity.name == name) {
            return Column::all(quantity).collect();
        }
        let columns = run.asked.iter().flat_map(|quantity| Column::all(quantity));
        columns.filter(|column| column.name() == name).take(1).collect()
    };
    let names: Vec<(&str, Column<'_>)> = plot
        .iter()
        .filter(|figure| figure.is_name())
        .filter_map(|figure| Some((&figure.columns[0][..], *of_name(&figure.columns[0]).first()?)))
        .collect();
    let (mut figures, mut drawn) = (Vec::new(), Vec::new());
    for (i, asked) in plot.iter().enumerate() {
        let id = match i {
            0 if is_line => "figure".into(),
            0 => "plot".into(),
            _ => format!("plot-{}", i + 1),
        };
        let columns: Vec<Column<'_>> =
            asked.columns.iter().flat_map(|name| of_name(name)).collect();
        let Some(Column { quantity, .. }) = columns.first().copied() else { continue };
        if asked.is_name() {
            // The names of one quantity, or of one formula, are one figure, at the place of the first.
            let group = group(kind, &columns[0]);
            if !drawn.contains(&group) {
                let of_group =
                    names.iter().filter(|(_, column)| self::group(kind, column) == group);
                let wanted: Vec<String> = of_group.map(|(name, _)| (*name).into()).collect();
                drawn.push(group);
                figures.extend(against_time(&id, kind, quantity, run.rows, &wanted, summary));
            }
            continue;
        }
        let against = asked.against.iter().flat_map(|name| of_name(name)).next();
        let named: Vec<String> =
            columns.iter().map(|column| words::column(column.name())).collect();
        let unit_of = |columns: &[Column<'_>]| {
            shared_unit(kind, summary, columns.iter().map(|column| column.quantity))
        };
        let is_whole = columns.len() == quantity.columns.len()
            && columns.iter().all(|column| column.quantity.name == quantity.name);
        let title = asked.title.clone().unwrap_or_else(|| match (is_whole, against) {
            (true, None) => words::title(kind, quantity),
            (_, None) => named.join(", "),
            (_, Some(x)) => format!("{} against {}", named.join(", "), words::column(x.name())),
        });
        let x = against.map_or("t".into(), |column| words::column(column.name()));
        let units = [against.map_or(summary.time_unit(), |x| unit_of(&[x])), unit_of(&columns)];
        let named = named.join(", ");
        // A label of the scene says its unit.
        let [(x, x_unit), (y, y_unit)] =
            [(&asked.x_label, x, units[0].clone()), (&asked.y_label, named, units[1].clone())].map(
                |(asked, name, unit)| asked.clone().map_or((name, unit), |l| (l, String::new())),
            );
        let as_they_are = asked.title.is_some() || asked.y_label.is_some();
        let shown = Shown { title, axes: [x, y], units: [x_unit, y_unit], columns, as_they_are };
        figures.push(match against {
            None => figure(&id, &shown, run.rows, summary),
            Some(against) => Figured::Narrow(curves(&id, &shown, against, run.rows)),
        });
    }
    figures
}

/// The common unit of some quantities. It is empty if they have different units.
fn shared_unit<'a>(
    kind: &problem::Kind,
    summary: &Summary,
    quantities: impl Iterator<Item = &'a Observable>,
) -> String {
    let unit = |quantity: &Observable| {
        let info = kind.quantity(quantity.name);
        info.map_or(String::new(), |info| info.unit(&summary.unit_names))
    };
    let mut units = quantities.map(unit);
    let first = units.next().unwrap_or_default();
    if units.all(|unit| unit == first) { first } else { String::new() }
}

/// The columns that are one figure with this one, where they are asked for one by one.
fn group(kind: &problem::Kind, column: &Column<'_>) -> (&'static str, Range<usize>) {
    let name = column.quantity.name;
    match kind.quantity(name) {
        Ok(_) => (name, 0..column.quantity.columns.len()),
        Err(_) => (name, column.part()),
    }
}

/// Columns against another column.
fn curves(id: &str, shown: &Shown<'_>, against: Column<'_>, rows: &RowSample<'_>) -> Chart {
    let Shown { title, axes: [x, y], units: [of_x, of_y], columns, .. } = shown;
    let line = |(colour, column): (usize, &Column<'_>)| {
        let points = rows.rows().map(|(_, row)| (against.of(row), column.of(row)));
        Series::line(words::column(column.name()), colour, points)
    };
    let axes =
        [(x, of_x), (y, of_y)].map(|(name, unit)| Axis::linear(name).with_unit(unit.clone()));
    Chart::new(id, title, axes, columns.iter().enumerate().map(line))
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
        summary.facts.iter().map(|fact| (fact.name.replace('_', " "), fact.in_words(in_digits))),
    );
    facts.extend(summary.events.iter().map(|event| {
        let mut text = event.in_words(in_digits);
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
        Figure::Space(_) => vec![space(id, title, summary, run).into()],
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

fn said(name: &str, parts: usize) -> String {
    match LINE_COLOURS < parts {
        true => format!("The first {LINE_COLOURS} of {parts} parts of {name}."),
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
    let caption = said(quantity.name, pairs);
    Chart::new(id, title, axes, series).with_caption(caption)
}

/// Triples of columns as paths in space.
fn space(id: String, title: String, summary: &Summary, run: &Drawn<'_>) -> Space {
    let (quantity, rows) = (run.figure, run.rows);
    let triples = quantity.columns.len() / 3;
    let path = |k: usize| Path {
        name: words::path(quantity, &quantity.columns[3 * k..3 * k + 3], k + 1),
        colour: k,
        points: rows
            .rows()
            .map(|(_, row)| core::array::from_fn(|i| row[quantity][3 * k + i]))
            .collect(),
    };
    let unit = run.scene.problem.kind().quantity(quantity.name);
    let unit = unit.map_or(String::new(), |info| info.unit(&summary.unit_names));
    let axis = |i: usize| {
        let name = match triples {
            1 => words::column(&quantity.columns[i]),
            _ => ["x", "y", "z"][i].into(),
        };
        Axis::linear(name).with_unit(unit.clone())
    };
    let caption = format!(
        "{} From the ring to the dot; the grey line is the shadow on the floor.",
        said(quantity.name, triples)
    );
    Space {
        id,
        title,
        axes: core::array::from_fn(axis),
        paths: (0..triples.min(LINE_COLOURS)).map(path).collect(),
        caption: caption.trim().into(),
        view: (35.0, 25.0),
    }
}

/// Triples of columns as paths on a sphere, each in lengths of its own start.
fn sphere(id: String, title: String, run: &Drawn<'_>) -> Sphere {
    let (quantity, rows) = (run.figure, run.rows);
    let triples = quantity.columns.len() / 3;
    let at =
        |k: usize, row: Row<'_>| -> [f64; 3] { core::array::from_fn(|i| row[quantity][3 * k + i]) };
    let length = |k: usize| rows.ends().map_or(1.0, |[(_, row), _]| schema::length(at(k, row)));
    let paths_of = |rows: &[(f64, Row<'_>)]| -> Vec<Vec<[f64; 3]>> {
        let path = |k: usize| {
            let length = length(k);
            rows.iter().map(|(_, row)| at(k, *row).map(|x| x / length)).collect()
        };
        (0..triples.min(LINE_COLOURS)).map(path).collect()
    };
    // Of many rows some are kept, which may be far apart where the first ones are not.
    let (whole, first): (Vec<_>, Vec<_>) = (rows.rows().collect(), rows.first().collect());
    let (mut points, mut shown) = (paths_of(&whole), String::new());
    let beginning = paths_of(&first);
    let is_far_apart = |paths: &[Vec<[f64; 3]>]| paths.iter().any(|path| is_far_apart(path));
    if is_far_apart(&points) && !is_far_apart(&beginning) {
        let [start, end] = [&first[0], &first[first.len() - 1]].map(|(t, _)| short(*t, 4));
        shown = format!("Shown is t = {start} to {end}.");
        points = beginning;
    }
    let name = |k: usize| match triples {
        _ if quantity.parts.len() == triples && !quantity.parts[k].name.is_empty() => {
            quantity.parts[k].name.clone()
        }
        1 => words::on_axis(quantity),
        _ => words::path(quantity, &quantity.columns[3 * k..3 * k + 3], k + 1),
    };
    let path = |(k, points)| Path { name: name(k), colour: k, points };
    let paths: Vec<Path> = points.into_iter().enumerate().map(path).collect();
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
    let start = paths.first().and_then(|path| path.points.first());
    let ellipsoid = inertia.zip(start).map(|(inertia, m)| inertia.energy_ellipsoid(m));
    let surfaces = match ellipsoid.is_some_and(|semi| semi.iter().all(|a| a.is_finite())) {
        true => {
            "The sphere is |m| = const, and the ellipsoid is energy = const. A free body keeps both."
        }
        false => "",
    };
    let scaled = match (0..triples).all(|k| (length(k) - 1.0).abs() < 1e-9) {
        true => "",
        false => "Each vector is divided by its length at the start.",
    };
    let caption = format!("{} {shown} {scaled} {surfaces}", said(quantity.name, triples));
    Sphere {
        id,
        title,
        radius: 1.0,
        ellipsoid,
        paths,
        caption: caption.trim().into(),
        view: (35.0, if height < 0.0 { -25.0 } else { 25.0 }),
    }
}

/// Are there neighbours on a path on the unit sphere that a line cannot join?
fn is_far_apart(path: &[[f64; 3]]) -> bool {
    let square = |pair: &[[f64; 3]]| (0..3).map(|i| (pair[1][i] - pair[0][i]).powi(2)).sum::<f64>();
    path.windows(2).any(|pair| square(pair) > 1.0)
}

fn drift_table(summary: &Summary) -> Block {
    let columns = vec![
        TableColumn::text("Quantity"),
        TableColumn::number("at the start"),
        TableColumn::number("largest change"),
        TableColumn::number("change at the end"),
        TableColumn::number("change per unit of time"),
        TableColumn::text("the method"),
        TableColumn::number("rounding alone"),
    ];
    let rows = summary.drift.iter().map(|(name, drift)| {
        let promise = match (drift.promised, drift.breaks_a_promise()) {
            _ if !drift.is_known() => "not known",
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

/// |value − initial| of the invariants against time, in a fold where it is rounding alone. None where nothing changes.
fn drifts(summary: &Summary, run: &Drawn<'_>) -> Option<Block> {
    let all = run
        .watched
        .iter()
        .flat_map(|law| law.columns.iter().enumerate().map(move |(i, column)| (law, i, column)));
    let moved = |column: &str| summary.drift.get(column).map_or(0.0, |drift| drift.max);
    let (mut all, constant): (Vec<_>, Vec<_>) = all.partition(|(.., column)| moved(column) != 0.0);
    if all.is_empty() {
        return None;
    }
    all.sort_by(|(.., a), (.., b)| moved(b).total_cmp(&moved(a)));
    let told = match all.len() {
        ..=LINES => String::new(),
        count => format!(" The {LINES} that moved most, of {count}."),
    };
    all.truncate(LINES);
    let kind = run.scene.problem.kind();
    let unit = shared_unit(kind, summary, all.iter().map(|(law, ..)| **law));
    let series = all.into_iter().enumerate().map(|(colour, (law, i, column))| {
        let initial = summary.drift.get(column).map_or(f64::NAN, |drift| drift.initial);
        let gap = |(t, row): (f64, Row<'_>)| (t, (row[law][i] - initial).abs());
        // A change of exactly 0, as at the start, has no place on a logarithm.
        let points = run.rows.columns().map(gap).filter(|(_, gap)| *gap != 0.0);
        Series::line(words::column(column), colour, points)
    });
    let change = Axis::log("|value − value at the start|").with_unit(unit);
    let axes = [Axis::linear("t").with_unit(summary.time_unit()), change];
    let chart = Chart::new("drift", "Drifts of the invariants", axes, series);
    let mut caption = format!("A change of exactly 0 cannot be drawn on this axis.{told}");
    if !constant.is_empty() {
        let names: Vec<String> =
            constant.iter().map(|(.., column)| words::column(column)).collect();
        caption += &format!(" Without any change: {}.", names.join(", "));
    }
    let chart = Block::Chart(marked(chart.with_caption(caption), summary));
    Some(match summary.drift.values().all(Drift::is_rounding) {
        true => Block::fold("All changes are rounding alone: against time", vec![chart]),
        false => chart,
    })
}
