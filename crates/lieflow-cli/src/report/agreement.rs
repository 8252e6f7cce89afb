//! The two layers against each other.

use lieflow::check::Finding;

use lieflow_figures::page::{Block, Column, Row, Section, Table};

/// The section of the cross-checks.
pub fn agreement(findings: &[Finding]) -> Section {
    let rows = findings.iter().map(|f| Row {
        cells: vec![
            f.name.clone(),
            f.cases.to_string(),
            format!("{:.2}", f.worst),
            f.bound.to_string(),
            if f.holds() { "holds".into() } else { "out of bounds".into() },
        ],
        emphasised: !f.holds(),
    });
    Section::new(
        "General against specialised",
        vec![
            Block::text(
                "Every map and inverse differential of the general layer at n = 3 against the closed \
                 forms, at random u from 1e-320 to 3e14; whole steps; and the laws of each group \
                 with each map. Differences are in units of ε·cond·size: 1 is what one rounding of \
                 the input already changes.",
            ),
            Block::Table(Table {
                caption: "Largest differences found on this machine.".into(),
                columns: vec![
                    Column::text("Check"),
                    Column::number("Cases"),
                    Column::number("Worst [eps·cond]"),
                    Column::number("Bound"),
                    Column::text(""),
                ],
                rows: rows.collect(),
            }),
        ],
    )
}
