//! The page of the paper's numerical section.

use super::Paper;
use super::accuracy::{Accuracy, EPSILONS, TESTS};
use super::energy::EnergyRun;
use super::printed::{ERRATA, OPTIMUM, TABLE2, TABLE3, TABLE4};
use super::rows::Row as Method;
use super::{news, verdicts};
use crate::measure::machine;
use crate::report::scientific;
use lieflow_figures::page::{Block, Column, Page, Row, Section, Table};
use lieflow_figures::plot::format::seconds;
use lieflow_figures::plot::{Axis, Chart, Marker, Point, Scale, Series};

pub(super) fn page(paper: &Paper) -> Page {
    Page {
        title: "Lie group methods for rigid body dynamics: the numbers again".into(),
        subtitle: "The numerical section of Celledoni & Owren (2003), computed by lieflow beside \
                   what is printed"
            .into(),
        sections: vec![
            Section::new("In short", in_short(paper)),
            Section::new("Table 1: one step", table1(paper)),
            Section::new("Table 2: operations", table2(paper)),
            Section::new("Figures 3 and 4: energy", figures34(paper)),
            Section::new("Table 3: energy errors", table3(paper)),
            Section::new("Table 4 and Figure 5: cost and error", table4(paper)),
            Section::new("What is new", news::blocks(paper)),
            Section::new("Errata", errata()),
        ],
        footer: format!("lieflow {}", env!("CARGO_PKG_VERSION")),
    }
}

fn in_short(paper: &Paper) -> Vec<Block> {
    let agree = TABLE3.iter().flat_map(|(row, last, mean)| {
        let run = paper.energy[2].iter().find(|run| run.row == *row);
        let pair = run.map_or([f64::NAN; 2], |run| [run.last().abs(), run.mean().abs()]);
        [(pair[0], *last), (pair[1], *mean)]
    });
    let agree = agree.filter(|(ours, printed)| as_printed(*ours, printed) == **printed).count();
    let rows = verdicts::all(paper)
        .into_iter()
        .map(|verdict| Block::text(format!("{}: {}", verdict.claim, verdict.answer)));
    let mut blocks = vec![
        Block::text(
            "Every table and figure of section 5, computed by this program on this machine, with the \
             parameters that the printed numbers belong to (see the errata). What the paper does not \
             have is marked as ours.",
        ),
        Block::Facts(vec![
            ("Machine".into(), machine()),
            ("Table 3".into(), format!("{agree} of 16 numbers as printed, to every digit")),
            (
                "Times".into(),
                "CPU time of one thread, medians of rounds that visit every method in turn".into(),
            ),
        ]),
    ];
    blocks.extend(rows);
    blocks
}

/// A number in the notation of a printed one: as many digits, with or without an exponent.
fn as_printed(x: f64, printed: &str) -> String {
    match printed.split_once('e') {
        None => format!("{x:.4}"),
        Some(_) => {
            let text = format!("{x:.4e}");
            let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
            let exponent: i32 = exponent.parse().unwrap_or(0);
            format!("{mantissa}e{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.abs())
        }
    }
}

fn table1(paper: &Paper) -> Vec<Block> {
    let [closed, general] = &paper.trace;
    let vector = |x: &[f64; 3]| x.map(|x| format!("{x:+.12}")).join(", ");
    let gap = |a: &[f64; 3], b: &[f64; 3]| {
        let gap = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        if gap == 0.0 { "0".into() } else { format!("{gap:.0e}") }
    };
    let mut rows = Vec::new();
    for (i, (a, b)) in closed.stages.iter().zip(&general.stages).enumerate() {
        let name = if a.k.is_some() { format!("u{}", i + 1) } else { "v".into() };
        rows.push(Row::new(vec![name, vector(&a.u), gap(&a.u, &b.u)]));
        if let (Some(x), Some(y)) = (a.k, b.k) {
            rows.push(Row::new(vec![format!("k̃{}", i + 1), vector(&x), gap(&x, &y)]));
        }
    }
    let end = (closed.end - general.end).norm();
    vec![
        Block::text(format!(
            "One step of RKMK4 with exp from the initial state of example 1, h = 0.05: \
             u_i = h Σ a_ij k̃_j, k̃_i = dΨ⁻¹ f(λ(u_i)), v = h Σ b_i k̃_i, g⁺ = λ(v). The closed forms \
             are shown; beside them, how far the general layer for matrices of any size is. The two \
             g⁺ differ by {end:.0e}."
        )),
        Block::Table(Table {
            caption: "Stage by stage.".into(),
            columns: vec![
                Column::text(""),
                Column::text("closed form"),
                Column::number("general layer differs by"),
            ],
            rows,
        }),
    ]
}

fn table2(paper: &Paper) -> Vec<Block> {
    let rows = paper.counts.iter().map(|c| {
        let same = |map: &str, part: &str| map == c.map && part == c.part;
        let printed = TABLE2.iter().find(|(map, part, _)| same(map, part));
        let total: u64 = printed.map_or(0, |(.., n)| n.iter().sum());
        let optimum = OPTIMUM.iter().find(|(map, part, _)| same(map, part)).map_or(0, |o| o.2);
        let o = c.ops;
        Row::new(vec![
            format!("{} {}", c.part, c.map),
            total.to_string(),
            (total + c.product()).to_string(),
            o.total().to_string(),
            o.add.to_string(),
            o.mul.to_string(),
            o.div.to_string(),
            o.sqrt.to_string(),
            o.trig.to_string(),
            optimum.to_string(),
        ])
    });
    let columns =
        ["printed", "printed, applied", "ours", "add", "mul", "div", "√", "trig", "fewest known"];
    vec![
        Block::text(
            "The library's own formulas run on a number that counts. The paper forms the matrix of \
             dΨ⁻¹ and leaves its product with a vector out of the table (15 operations, 10 for ccsk): \
             “applied” adds it. Ours apply dΨ⁻¹ to a vector and never form it; “both” is dΨ⁻¹v after \
             Ψ, which shares its terms. Some of ours are there for accuracy at every angle, and to \
             refuse what is not finite; exp as a matrix goes by the quaternion, which \
             takes more operations than (14) for half its distance from the group. Counted is exp at \
             |u| > π; up to there polynomials stand for root, sine and cosine: more operations, and less \
             time. “Fewest known” counts \
             the matrix, as the paper does.",
        ),
        Block::Table(Table {
            caption: "Operations on so(3).".into(),
            columns: core::iter::once(Column::text(""))
                .chain(columns.map(Column::number))
                .collect(),
            rows: rows.collect(),
        }),
    ]
}

/// The energy over the time of the motion, or over the CPU time that it took.
fn energy_chart(
    id: &str,
    title: &str,
    runs: &[EnergyRun],
    rows: &[Method],
    measured: bool,
) -> Chart {
    let series = rows.iter().filter_map(|row| runs.iter().find(|run| run.row == *row)).map(|run| {
        let h = run.error.get(1).map_or(1.0, |(t, _)| *t);
        let unit = if measured { run.seconds_per_step / h } else { 1.0 };
        Series {
            name: run.row.name().into(),
            colour: run.row.colour(),
            marker: Marker::None,
            dash: run.row.is_added(),
            points: run
                .error
                .iter()
                .filter(|(_, error)| *error != 0.0 && !error.is_nan())
                .map(|(t, error)| Point::new(t * unit, error.abs()))
                .collect(),
            emphasised: false,
        }
    });
    Chart {
        id: id.into(),
        title: title.into(),
        x: match measured {
            true => Axis::new("CPU time [s]", Scale::Linear),
            false => Axis::new("time t", Scale::Linear),
        },
        y: Axis::new("energy error |E(t) − E(0)|", Scale::Log10),
        series: series.collect(),
        caption: String::new(),
    }
}

fn figures34(paper: &Paper) -> Vec<Block> {
    // What the paper draws, and what it might have drawn.
    let rows = [
        Method::Mr,
        Method::Exp,
        Method::Ccsk321,
        Method::Cay,
        Method::B4,
        Method::Rk4,
        Method::S,
        Method::Rk4mg,
    ];
    let mut blocks = vec![Block::text(
        "Δt = 0.05, 8000 steps. Dashed: not in the paper's figures, or its method on other variables. \
         Classical RK4 on the momentum and g together drifts less than every Lie group method in \
         example 1, a comparison that the paper leaves out.",
    )];
    for (n, example) in [(3, 0), (4, 1)] {
        let name = ["asymmetric, J = diag(1, 2, 3)", "symmetric, J = diag(1, 1, 2)"][example];
        let chart = |id: &str, measured| {
            let title = format!("Figure {n}: {name}");
            Block::Chart(energy_chart(id, &title, &paper.energy[example], &rows, measured))
        };
        blocks.push(Block::Row(vec![
            chart(&format!("figure{n}"), false),
            chart(&format!("figure{n}-time"), true),
        ]));
    }
    blocks
}

fn table3(paper: &Paper) -> Vec<Block> {
    let rows = paper.energy[2].iter().map(|run| {
        let printed = TABLE3.iter().find(|(row, ..)| *row == run.row);
        let dash = || "–".to_string();
        let (last, mean) =
            printed.map_or((dash(), dash()), |(_, last, mean)| ((*last).into(), (*mean).into()));
        let nine = |x: f64| if x.is_nan() { dash() } else { format!("{x:.8e}") };
        Row::new(vec![
            run.row.name().into(),
            last,
            nine(run.last()),
            mean,
            nine(run.mean()),
            scientific(run.max()),
        ])
    });
    vec![
        Block::text(
            "J⁻¹ = diag(1, 4, 18), m_s = (0, 2.75, 2.75), Δt = 0.004, 100 000 steps. The paper prints \
             the size of E(400) − E(0), and of the mean of E − E(0) over all samples with the first. \
             MR2, S, DMV, RK4 on (m, g) and the energy and Casimir preserving method are ours; so are \
             the signs. A dash: the method has no step of this size here.",
        ),
        Block::Table(Table {
            caption: "Energy error at t = 400 and its mean.".into(),
            columns: vec![
                Column::text("Method"),
                Column::number("printed"),
                Column::number("ours"),
                Column::number("printed mean"),
                Column::number("our mean"),
                Column::number("largest"),
            ],
            rows: rows.collect(),
        }),
        Block::Chart(energy_chart(
            "example3",
            "Energy in example 3",
            &paper.energy[2],
            // The widest bands first, below the others.
            &[&[Method::Mr2][..], &Method::PRINTED, &Method::ADDED[1..]].concat(),
            false,
        )),
    ]
}

fn cost_chart(
    id: String,
    title: String,
    y: Axis,
    all: &[Accuracy],
    cost: impl Fn(&Accuracy, usize) -> Option<f64>,
) -> Chart {
    let series = all.iter().map(|a| {
        let point = |(i, p): (usize, &super::accuracy::Point)| {
            let note = format!("{} steps", p.steps);
            (!p.error.is_nan()).then(|| Some(Point::new(p.error, cost(a, i)?).with_note(note)))?
        };
        Series {
            name: a.row.name().into(),
            colour: a.row.colour(),
            marker: a.row.marker(),
            dash: a.row.is_added(),
            points: a.points.iter().enumerate().filter_map(point).collect(),
            emphasised: false,
        }
    });
    Chart {
        id,
        title,
        x: Axis::new("global error at t = 1", Scale::Log10),
        y,
        series: series.filter(|s| !s.points.is_empty()).collect(),
        caption: String::new(),
    }
}

fn table4(paper: &Paper) -> Vec<Block> {
    let mut blocks = vec![Block::text(
        "The spectral norm of g(1) − exact, over N steps. The paper's way to a number: the line of \
         least squares through log operations against log error of six runs, read at ε. Its operations \
         of a step are not those of its text; they are the integers that its numbers imply. “Counted” \
         is the same line with the operations of the library's step, counted as it runs. “Time” is CPU \
         time to ε, between the two runs around it. S in the second test has no “ours”: no cost of a \
         step fits its two numbers.",
    )];
    for (t, test) in TESTS.iter().enumerate() {
        let all = &paper.accuracy[t];
        let mut rows = Vec::new();
        for a in all {
            let printed = TABLE4.iter().find(|p| p.row == a.row);
            let step = printed.and_then(|p| p.per_step[t]);
            let dash = |x: Option<f64>| x.map_or("–".into(), |x| format!("{x:.4}"));
            let mut cells = vec![a.row.name().to_string()];
            for (e, epsilon) in EPSILONS.into_iter().enumerate() {
                let n = a.log_steps(epsilon);
                cells.push(dash(printed.map(|p| p.printed[t][e])));
                cells.push(dash(step.map(|c| n + c.log10())));
                cells.push(dash(a.ops.map(|ops| n + (ops.total() as f64).log10())));
                cells.push(a.seconds_to(epsilon).map_or("–".into(), seconds));
            }
            cells.push(step.map_or("–".into(), |c| c.to_string()));
            cells.push(a.ops.map_or("–".into(), |ops| ops.total().to_string()));
            rows.push(Row::new(cells));
        }
        let mut columns = vec![Column::text("Method")];
        for epsilon in ["1e-3", "1e-6"] {
            columns.push(Column::number(format!("{epsilon}: printed")));
            columns.extend(["ours", "counted", "time"].map(Column::number));
        }
        columns.extend(["a step, paper", "a step, counted"].map(Column::number));
        blocks.push(Block::Table(Table {
            caption: format!("{}: log₁₀ of operations, and time, to ε.", test.name),
            columns,
            rows,
        }));
        let step =
            |a: &Accuracy| TABLE4.iter().find(|p| p.row == a.row).and_then(|p| p.per_step[t]);
        let figure = if t == 0 { "Figure 5" } else { "The same" };
        blocks.push(Block::Row(vec![
            Block::Chart(cost_chart(
                format!("figure5-{}", test.key),
                format!("{figure}: operations, {}", test.name),
                Axis::new("operations, as the paper counts", Scale::Log10),
                all,
                |a, i| Some(step(a)? * a.points[i].steps as f64),
            )),
            Block::Chart(cost_chart(
                format!("figure5-{}-time", test.key),
                format!("{figure}: measured time, {}", test.name),
                Axis::new("CPU time [s]", Scale::Log10),
                all,
                |a, i| Some(a.points[i].seconds),
            )),
        ]));
    }
    blocks
}

fn errata() -> Vec<Block> {
    vec![
        Block::text(
            "What a user of the paper's formulas and numbers should know. Everything else there, (5), \
             (10) to (12), (14) to (16), (18) and Table 1 among it, was checked and is right as \
             printed, for the right-trivialised differential.",
        ),
        Block::Table(Table {
            caption: "Printed and right.".into(),
            columns: ["Where", "Printed", "Right"].map(Column::text).to_vec(),
            rows: ERRATA
                .iter()
                .map(|row| Row::new(row.iter().map(|cell| (*cell).into()).collect()))
                .collect(),
        }),
    ]
}
