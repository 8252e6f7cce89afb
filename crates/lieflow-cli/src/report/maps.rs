//! The page of the maps: how accurate each is and what it costs.

use std::path::{Path, PathBuf};

use super::{duration, write_page_as};
use crate::cmd::CliError;
use crate::measure::machine;
use crate::output;
use crate::survey::{Line, Over, Study};
use lieflow_figures::page::{Block, Column, Page, Row, Section, Table};
use lieflow_figures::plot::format::sig;
use lieflow_figures::plot::{Axis, Chart, Marker, Point, Scale, Series};

/// The page.
pub const MAPS_PAGE: &str = "maps.html";

/// Write the page with its figures, and every point as maps.csv; the path of the page.
///
/// # Errors
/// A file cannot be written.
pub fn write_maps(folder: &Path, studies: &[Study]) -> Result<PathBuf, CliError> {
    output::write_file(&folder.join("maps.csv"), &csv(studies))?;
    write_page_as(folder, MAPS_PAGE, &page(studies))
}

/// Every point as CSV.
fn csv(studies: &[Study]) -> String {
    let mut text = String::from("map,over,contender,at,cases,refused,error_eps_cond,seconds\n");
    for study in studies {
        let (map, over) = (study.topic.key(), if angle(study) { "angle" } else { "n" });
        for line in &study.lines {
            for p in &line.points {
                text += &format!(
                    "{map},{over},{},{:e},{},{},{:e},{:e}\n",
                    line.name, p.at, p.cases, p.refused, p.error, p.seconds
                );
            }
        }
    }
    text
}

fn angle(study: &Study) -> bool {
    study.over == Over::Angle
}

/// The colour of a contender: the same in every figure.
fn colour(name: &str) -> usize {
    match name {
        "closed form" => 0,
        "general layer" => 1,
        "nalgebra Matrix3::exp" => 3,
        _ => 2,
    }
}

fn chart(
    study: &Study,
    what: &str,
    title: String,
    y: Axis,
    value: fn(&crate::survey::Point) -> f64,
) -> Chart {
    let series = study.lines.iter().map(|line| Series {
        name: line.name.into(),
        colour: colour(line.name),
        marker: Marker::cycle(colour(line.name)),
        dash: line.name.starts_with("nalgebra"),
        points: line
            .points
            .iter()
            .filter(|p| !value(p).is_nan())
            .map(|p| {
                let inputs = format!("{} inputs, {} refused", p.cases, p.refused);
                Point::new(p.at, value(p)).with_note(inputs)
            })
            .collect(),
        emphasised: false,
    });
    let x = match study.over {
        Over::Angle => Axis::new("angle |u| [rad]", Scale::Log10),
        Over::Size => Axis::new("n", Scale::Log10),
    };
    let over = if angle(study) { "angle" } else { "n" };
    Chart {
        id: format!("{}-{what}-{over}", study.topic.key()),
        title,
        x,
        y,
        series: series.collect(),
        caption: String::new(),
    }
}

/// Error beside time.
fn charts(study: &Study) -> Block {
    let name = study.topic.name();
    let over = if angle(study) { "over the angle" } else { "over n" };
    let largest = study.lines.iter().filter_map(Line::worst).map(|p| p.error).fold(0.0, f64::max);
    // Linear as long as that shows something of everybody.
    let scale = if largest < 30.0 { Scale::Linear } else { Scale::SymLog { linear: 1.0 } };
    let units = Axis::new("error [eps·cond]", scale);
    let time = Axis::new("CPU time of a call [s]", Scale::Log10);
    let timed = match study.topic.is_inverse_differential() {
        true => format!("Time of the map and {name} {over}"),
        false => format!("Time of {name} {over}"),
    };
    Block::Row(vec![
        Block::Chart(chart(study, "error", format!("Error of {name} {over}"), units, |p| p.error)),
        Block::Chart(chart(study, "time", timed, time, |p| p.seconds)),
    ])
}

fn table(studies: &[&Study], caption: &str, place: &str) -> Table {
    let rows = studies.iter().flat_map(|study| {
        let name = study.topic.name();
        study.lines.iter().map(move |line| Row::new(cells(name, line)))
    });
    Table {
        caption: caption.into(),
        columns: vec![
            Column::text("Map"),
            Column::text("By"),
            Column::number("Largest error [eps·cond]"),
            Column::number(place),
            Column::number("Refused"),
            Column::number("Median time"),
        ],
        rows: rows.collect(),
    }
}

fn cells(map: &str, line: &Line) -> Vec<String> {
    let refused: usize = line.points.iter().map(|p| p.refused).sum();
    let cases: usize = line.points.iter().map(|p| p.cases).sum();
    let (error, at) =
        line.worst().map_or(("–".into(), "–".into()), |p| (sig(p.error, 2), sig(p.at, 3)));
    vec![
        map.into(),
        line.name.into(),
        error,
        at,
        format!("{refused} of {cases}"),
        duration(Some(line.seconds())),
    ]
}

fn page(studies: &[Study]) -> Page {
    let (over_angle, over_n): (Vec<&Study>, Vec<&Study>) =
        studies.iter().partition(|study| angle(study));
    let drawn = |studies: &[&Study]| studies.iter().map(|s| charts(s)).collect::<Vec<_>>();
    let mut angle_blocks = vec![
        Block::text(
            "u on so(3), in random directions, from |u| = 1e-16 to 2π and close to π and 2π; g is \
             exp(u) rounded. log is asked up to π, where exp stops being one to one. dexp⁻¹ has no \
             value at 2π: there it refuses.",
        ),
        Block::Table(table(&over_angle, "On so(3), over all angles.", "at |u|")),
    ];
    angle_blocks.extend(drawn(&over_angle));
    let mut n_blocks = vec![
        Block::text(
            "u on so(n), random, of spectral norm about 1. What is not drawn at n = 3 is in the \
             figures over the angle.",
        ),
        Block::Table(table(&over_n, "On so(n), over all n.", "at n")),
    ];
    n_blocks.extend(drawn(&over_n));
    Page {
        title: "The maps: accuracy and time".into(),
        subtitle: "Closed forms on so(3) and the general layer for any n, beside nalgebra".into(),
        sections: vec![
            Section::new(
                "What is measured",
                vec![
                    Block::text(
                        "Errors are distances (Frobenius) from values of 30 digits, which this \
                         program computes in twice the working precision by other formulas: Taylor \
                         series, elimination, and iterative refinement of the forward differential. \
                         The unit ε·cond is ε times the size of the value plus what the value \
                         changes by when each number of the input moves by ε of itself; it is the \
                         same for everybody. 1 is what rounding already costs; the promise is 4 on \
                         so(3).",
                    ),
                    Block::Facts(vec![
                        ("Machine".into(), machine()),
                        (
                            "Times".into(),
                            "CPU time of one thread, medians of rounds that visit everybody in turn"
                                .into(),
                        ),
                    ]),
                    Block::Link { text: "Back to the report".into(), href: "index.html".into() },
                ],
            ),
            Section::new("Over the angle", angle_blocks),
            Section::new("Over n", n_blocks),
        ],
        footer: format!("lieflow {}", env!("CARGO_PKG_VERSION")),
    }
}
