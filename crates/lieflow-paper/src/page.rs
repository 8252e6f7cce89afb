//! The page of the paper's numerical section.

use crate::accuracy::{Accuracy, EPSILONS, TESTS};
use crate::energy::{EnergyRun, energy_chart};
use crate::methods::PaperMethod;
use crate::news;
use crate::printed::{self, ERRATA, TABLE3};
use crate::results::Paper;
use crate::verdicts;
use lieflow_figures::number::{DASH, or_dash, scientific, seconds};
use lieflow_figures::{Axis, Block, Chart, Column, Page, Point, Section, Table};
use lieflow_timing::machine;

pub(super) fn page(paper: &Paper) -> Page {
    Page::new(
        "Lie group methods for rigid body dynamics: the numbers again",
        "The numerical section of Celledoni & Owren (2003), computed by lieflow beside what is printed",
        vec![
            Section::new("In short", in_short(paper)),
            Section::new("Table 1: one step", table1(paper)),
            Section::new("Table 2: operations", table2(paper)),
            Section::new("Figures 3 and 4: energy", figures34(paper)),
            Section::new("Table 3: energy errors", table3(paper)),
            Section::new("Table 4 and Figure 5: cost and error", table4(paper)),
            Section::new("What is new", news::blocks(paper)),
            Section::new("Errata", errata()),
        ],
    )
}

fn in_short(paper: &Paper) -> Vec<Block> {
    let agree = TABLE3.iter().flat_map(|(row, last, mean)| {
        let run = paper.energy[2].iter().find(|run| run.method == *row);
        let pair = run.map_or([f64::NAN; 2], |run| [run.last().abs(), run.mean().abs()]);
        [(pair[0], *last), (pair[1], *mean)]
    });
    let agree = agree.filter(|(ours, printed)| as_printed(*ours, printed) == **printed).count();
    let rows =
        verdicts::all(paper).into_iter().map(|verdict| [verdict.claim.into(), verdict.answer]);
    let claims = Table::new("", Column::all(["What the paper says", "What came out"], []), rows);
    vec![
        Block::text(format!(
            "lieflow computed every table and figure of section 5 on this machine. {agree} of the 16 numbers of \
             Table 3 are as printed, to every digit.",
        )),
        Block::text(
            "The parameters are those that the printed numbers belong to (see the errata). What the paper does not \
             have is marked as ours.",
        ),
        Block::facts([
            ("Machine", machine()),
            (
                "Times",
                "CPU time of one thread. In Table 4 and Figure 5 it is the median of rounds that visit every method \
                 in turn. In Figures 3 and 4 it is that of one run, which computes the energy after each step."
                    .into(),
            ),
        ]),
        Block::fold(
            "What the paper says about speed and error, and what came out",
            vec![claims.into()],
        ),
    ]
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
        rows.push([name, vector(&a.u), gap(&a.u, &b.u)]);
        if let (Some(x), Some(y)) = (a.k, b.k) {
            rows.push([format!("k̃{}", i + 1), vector(&x), gap(&x, &y)]);
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
        Table::new(
            "Stage by stage.",
            Column::all(["Stage", "closed form"], ["general layer differs by"]),
            rows,
        )
        .into(),
    ]
}

fn table2(paper: &Paper) -> Vec<Block> {
    let rows = paper.counts.iter().map(|c| {
        let (printed, fewest) = printed::table2(c.map, c.part);
        let (o, total) = (c.ops, printed.iter().sum::<u64>());
        let numbers =
            [total, total + c.product(), o.total(), o.add, o.mul, o.div, o.sqrt, o.trig, fewest];
        let name = format!("{} {}", c.part, c.map);
        core::iter::once(name).chain(numbers.map(|n| n.to_string())).collect::<Vec<_>>()
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
        Table::new("Operations on so(3).", Column::all(["Formula"], columns), rows).into(),
    ]
}

/// The energy over the time of the motion, or over the CPU time that it took.
fn chart(id: &str, title: &str, runs: &[EnergyRun], rows: &[PaperMethod], measured: bool) -> Chart {
    let runs = rows.iter().filter_map(|row| runs.iter().find(|run| run.method == *row));
    let lines = runs.map(|run| {
        let h = run.error.get(1).map_or(1.0, |(t, _)| *t);
        run.line(if measured { run.seconds_per_step / h } else { 1.0 })
    });
    match measured {
        true => {
            let time = Axis::linear("CPU time").of_durations();
            energy_chart(id, &format!("{title}, over the CPU time"), time, lines)
        }
        false => energy_chart(id, title, Axis::linear("time t"), lines),
    }
}

fn figures34(paper: &Paper) -> Vec<Block> {
    // What the paper draws, and what it might have drawn.
    let rows = [
        PaperMethod::Mr,
        PaperMethod::Exp,
        PaperMethod::Ccsk321,
        PaperMethod::Cay,
        PaperMethod::B4,
        PaperMethod::Rk4,
        PaperMethod::S,
        PaperMethod::Rk4mg,
    ];
    let mut blocks = vec![Block::text(
        "Δt = 0.05, 8000 steps. Dashed: not in the paper's figures, or its method on other variables. \
         Classical RK4 on the momentum and g together drifts less than every Lie group method in \
         example 1, a comparison that the paper leaves out.",
    )];
    for (n, example) in [(3, 0), (4, 1)] {
        let name = ["asymmetric, J = diag(1, 2, 3)", "symmetric, J = diag(1, 1, 2)"][example];
        let title = format!("Figure {n}: {name}");
        let over = [(format!("figure{n}"), false), (format!("figure{n}-time"), true)];
        let charts = over.map(|(id, measured)| {
            chart(&id, &title, &paper.energy[example], &rows, measured).into()
        });
        blocks.push(Block::Row(charts.into()));
    }
    blocks
}

fn table3(paper: &Paper) -> Vec<Block> {
    let rows = paper.energy[2].iter().map(|run| {
        let [last, mean] = printed::table3(run.method).unwrap_or([DASH; 2]).map(String::from);
        let nine = |x: f64| or_dash((!x.is_nan()).then_some(x), |x| format!("{x:.8e}"));
        let (ours, our_mean) = (nine(run.last()), nine(run.mean()));
        [run.method.name().into(), last, ours, mean, our_mean, scientific(run.max())]
    });
    vec![
        Block::text(
            "J⁻¹ = diag(1, 4, 18), m_s = (0, 2.75, 2.75), Δt = 0.004, 100 000 steps. The paper prints \
             the size of E(400) − E(0), and of the mean of E − E(0) over all samples with the first. \
             MR2, S, DMV, RK4 on (m, g) and the energy and Casimir preserving method are ours; so are \
             the signs. A dash in a column of the paper: it does not have the method.",
        ),
        Table::new(
            "Energy error at t = 400 and its mean.",
            Column::all(["Method"], ["printed", "ours", "printed mean", "our mean", "largest"]),
            rows,
        )
        .into(),
        chart(
            "example3",
            "Energy in example 3",
            &paper.energy[2],
            // The widest bands first, below the others.
            &[&[PaperMethod::Mr2][..], &PaperMethod::PRINTED, &PaperMethod::ADDED[1..]].concat(),
            false,
        )
        .into(),
    ]
}

/// The error over what it costs.
fn cost_chart(
    id: &str,
    title: &str,
    cost: Axis,
    all: &[Accuracy],
    of: impl Fn(&Accuracy, usize) -> Option<f64>,
) -> Block {
    let lines = all.iter().map(|a| {
        let points = a.points.iter().enumerate().filter(|(_, p)| !p.error.is_nan());
        a.method.marked_line(points.filter_map(|(i, p)| {
            Some(Point::new(p.error, of(a, i)?).with_note(format!("{} steps", p.steps)))
        }))
    });
    let axes = [Axis::log("global error at t = 1"), cost];
    Chart::new(id, title, axes, lines.filter(|line| !line.points.is_empty())).into()
}

fn table4(paper: &Paper) -> Vec<Block> {
    let mut blocks = vec![Block::text(
        "The spectral norm of g(1) − exact, over N steps. The paper's way to a number: the line of \
         least squares through log operations against log error of six runs, read at ε. Its operations \
         of a step are not those of its text; they are the integers that its numbers imply. “Counted” \
         is the same line with the operations of the library's step, counted as it runs. It leaves out \
         runs whose error is below 1e-12, near that of rounding, and has a dash where fewer than three \
         runs are left. No number of it is below that of one step. “Time” is CPU time to ε: the number of \
         steps, between the two runs around it, times the time of a step of that size in a run of at least \
         2048. A shorter run is mostly its set-up. S in the second test has no “ours”: no cost of a step fits its two numbers.",
    )];
    for (t, test) in TESTS.iter().enumerate() {
        let all = &paper.accuracy[t];
        let rows = all.iter().map(|a| {
            let four = |x: Option<f64>| or_dash(x, |x| format!("{x:.4}"));
            let mut cells = vec![a.method.name().to_string()];
            for cost in [0, 1].map(|e| a.cost(e)) {
                cells.extend([cost.printed, cost.ours, cost.counted].map(four));
                cells.push(or_dash(cost.seconds, seconds));
            }
            cells.push(or_dash(a.printed_step(), |ops| ops.to_string()));
            cells.push(or_dash(a.counted_step(), |ops| ops.to_string()));
            cells
        });
        let mut columns = vec![Column::text("Method")];
        for epsilon in EPSILONS {
            columns.push(Column::number(format!("{epsilon:e}: printed")));
            columns.extend(["ours", "counted", "time"].map(Column::number));
        }
        columns.extend(["a step, paper", "a step, counted"].map(Column::number));
        let caption = format!("{}: log₁₀ of operations, and time, to ε.", test.name);
        blocks.push(Table::new(caption, columns, rows).into());
        let figure = if t == 0 { "Figure 5" } else { "The same" };
        blocks.push(Block::Row(vec![
            cost_chart(
                &format!("figure5-{}", test.key),
                &format!("{figure}: operations, {}", test.name),
                Axis::log("operations, as the paper counts"),
                all,
                |a, i| Some(a.printed_step()? * a.points[i].steps as f64),
            ),
            cost_chart(
                &format!("figure5-{}-time", test.key),
                &format!("{figure}: measured time, {}", test.name),
                Axis::log("CPU time").of_durations(),
                all,
                |a, i| Some(a.points[i].seconds),
            ),
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
        Table::new(
            "Printed and right.",
            Column::all(["Where", "Printed", "Right"], []),
            ERRATA.map(|row| row.map(String::from)),
        )
        .into(),
    ]
}
