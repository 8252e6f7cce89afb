//! The page of the maps: how accurate each is and what it costs.

use lieflow_figures::number::{DASH, seconds, short, sig};
use lieflow_figures::{
    Axis, Block, Cell, Chart, Column, Marker, Page, Point, Scale, Section, Series, Table,
};

use super::{Over, Study, StudyLine};
use lieflow_figures::csv::in_full;
use lieflow_figures::fields;
use lieflow_timing::machine;

/// Every point, as rows of CSV.
pub(super) fn points(studies: &[Study]) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for study in studies {
        let (map, over) = (study.topic.key(), if angle(study) { "angle" } else { "n" });
        for line in &study.lines {
            rows.extend(line.points.iter().map(|p| {
                let (error, seconds) = (in_full(p.error), in_full(p.seconds));
                fields![map, over, line.name, in_full(p.at), p.cases, p.refused, error, seconds]
            }));
        }
    }
    rows
}

fn angle(study: &Study) -> bool {
    study.over == Over::Angle
}

/// Angles below are not drawn: nothing changes there.
const SMALL: f64 = 0.01;

/// The largest error at angles that are not drawn.
fn at_small_angles(study: &Study) -> String {
    let points = study.lines.iter().flat_map(|line| &line.points);
    let small = points.filter(|p| p.at < SMALL && !p.error.is_nan());
    match small.map(|p| p.error).reduce(f64::max) {
        Some(largest) if angle(study) => {
            format!(
                "Angles from 1e-16 to {SMALL} are not drawn: the errors there are at most {}.",
                sig(largest, 2)
            )
        }
        _ => String::new(),
    }
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
    value: fn(&super::StudyPoint) -> f64,
) -> Chart {
    let drawn = |p: &&super::StudyPoint| !value(p).is_nan() && (!angle(study) || p.at >= SMALL);
    let series = study.lines.iter().map(|line| {
        let points = line.points.iter().filter(drawn).map(|p| {
            let inputs = format!("{} inputs, {} refused", p.cases, p.refused);
            Point::new(p.at, value(p)).with_note(inputs)
        });
        Series::line(line.name, colour(line.name), points)
            .with_marker(Marker::cycle(colour(line.name)))
            .with_dash(line.name.starts_with("nalgebra"))
    });
    let (x, over) = match study.over {
        Over::Angle => (Axis::linear("angle |u|").with_unit("rad"), "angle"),
        Over::Size => (Axis::log("n"), "n"),
    };
    let id = format!("{}-{what}-{over}", study.topic.key());
    Chart::new(id, title, [x, y], series)
}

/// Error beside time.
fn charts(study: &Study) -> Block {
    let name = study.topic.name();
    let over = if angle(study) { "over the angle" } else { "over n" };
    let largest =
        study.lines.iter().filter_map(StudyLine::worst).map(|p| p.error).fold(0.0, f64::max);
    // Linear as long as that shows something of everybody.
    let scale = if largest < 30.0 { Scale::Linear } else { Scale::SymLog { linear: 1.0 } };
    let units = Axis::new("error", scale).with_unit("eps·cond");
    let time = Axis::log("CPU time of a call").of_durations();
    let timed = match study.topic.is_inverse_differential() {
        true => format!("Time of the map and {name} {over}"),
        false => format!("Time of {name} {over}"),
    };
    Block::Row(vec![
        chart(study, "error", format!("Error of {name} {over}"), units, |p| p.error)
            .with_caption(at_small_angles(study))
            .into(),
        chart(study, "time", timed, time, |p| p.seconds).into(),
    ])
}

fn table(studies: &[&Study], caption: &str, place: &str) -> Table {
    let lines = studies.iter().flat_map(|study| study.lines.iter().map(|line| (study.topic, line)));
    let rows = lines.map(|(topic, line)| {
        let refused: usize = line.points.iter().map(|p| p.refused).sum();
        let cases: usize = line.points.iter().map(|p| p.cases).sum();
        let (error, at) = line.worst().map_or((f64::NAN, f64::NAN), |p| (p.error, p.at));
        let shown = |x: f64| if x.is_nan() { DASH.into() } else { short(x, 3) };
        [
            Cell::from(topic.name()),
            line.name.into(),
            Cell::number(error, shown),
            Cell::number(at, shown),
            Cell::number(refused as f64, |_| format!("{refused} of {cases}")),
            Cell::number(line.seconds(), seconds),
        ]
    });
    let numbers = ["Largest error (eps·cond)", place, "Refused", "Median time"];
    Table::new(caption, Column::all(["Map", "By"], numbers), rows)
}

pub(super) fn page(studies: &[Study]) -> Page {
    let (over_angle, over_n): (Vec<&Study>, Vec<&Study>) =
        studies.iter().partition(|study| angle(study));
    let drawn = |studies: &[&Study]| studies.iter().map(|s| charts(s)).collect::<Vec<_>>();
    let mut angle_blocks = vec![
        Block::text(
            "The vector u has random directions and lengths from 1e-16 to 2π. log is asked up to π, where two \
             vectors begin to have one rotation. dexp⁻¹ has no value at 2π: there it refuses.",
        ),
        table(&over_angle, "On so(3), over all angles.", "at |u|").into(),
    ];
    angle_blocks.extend(drawn(&over_angle));
    let mut n_blocks = vec![
        Block::text(
            "The matrix u is random and skew, of spectral norm about 1. What is not drawn at n = 3 is in the \
             figures over the angle.",
        ),
        table(&over_n, "On so(n), over all n.", "at n").into(),
    ];
    n_blocks.extend(drawn(&over_n));
    Page::new(
        "The maps: accuracy and time",
        "Closed forms on so(3) and the general layer for any n, beside nalgebra",
        vec![
            Section::new(
                "What is measured",
                vec![
                    Block::text(
                        "A map makes a rotation from a vector u, or takes its differential. Here each is compared with \
                         values of 30 digits, which this program computes by other formulas.",
                    ),
                    Block::text(
                        "The unit of an error (eps·cond) is the error that rounding the input alone would cause. So 1 \
                         is as good as it gets. The promise is 4 on rotations in three dimensions.",
                    ),
                    Block::facts([
                        ("Machine", machine().as_str()),
                        (
                            "Times",
                            "CPU time of one thread, medians of rounds that visit everybody in turn",
                        ),
                    ]),
                ],
            ),
            Section::new("Over the angle", angle_blocks),
            Section::new("Over n", n_blocks),
        ],
    )
    .with_links([("Back to the demonstration", "index.html"), ("Every point (CSV)", "maps.csv")])
}
