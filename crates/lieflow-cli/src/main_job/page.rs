//! The page of the main job.

use lieflow::groups::{LieGroup, So3};
use lieflow_figures::number::{or_dash, seconds, sig};
use lieflow_figures::{Axis, Block, Cell, Chart, Column, Page, Row, Section, Series, Table};
use lieflow_model::problem::Layer;
use lieflow_paper::energy::energy_chart;
use lieflow_paper::experiments::Experiment;
use lieflow_paper::maps::MAPS_PAGE;
use lieflow_paper::methods::PaperMethod;
use lieflow_paper::printed;

use super::{Outcome, Speed, candidate, rounds};
use crate::measure::Curve;
use crate::report;

impl Speed {
    pub(super) fn page(&self) -> Page {
        let mut sections = vec![self.rotations(), go_on()];
        let mut outcomes = self.outcomes.iter();
        sections.extend(outcomes.next().map(|outcome| {
            let title = format!("Speed against error: {}", outcome.title.to_lowercase());
            Section::new(title, outcome.blocks())
        }));
        let others: Vec<Block> =
            outcomes.map(|outcome| Block::fold(outcome.title.clone(), outcome.blocks())).collect();
        sections.push(Section::new("The same for two more bodies", others));
        sections.push(self.agreement());
        Page::new(
            "Rotations that stay rotations",
            "Three bodies that turn freely, by Lie group methods and by classical Runge–Kutta",
            sections,
        )
        .with_links([
            ("How accurate and fast each map is", MAPS_PAGE),
            ("Every run (CSV)", "speed.csv"),
        ])
    }

    /// The first result: who stays on the group.
    fn rotations(&self) -> Section {
        let mut blocks = vec![Block::text(self.result())];
        let mut motion: Vec<Block> = self.body.clone().map(Block::from).into_iter().collect();
        if let Some(outcome) = self.outcomes.first() {
            let lines = outcome.runs.iter().map(|run| {
                let defect = run.energy.defect.iter().filter(|(_, defect)| *defect != 0.0);
                Series { name: run.label.clone(), ..run.energy.method.line(defect.copied()) }
            });
            let axes = [Axis::linear("t"), Axis::log("‖gᵀg − 𝟙‖")];
            let chart = Chart::new(
                "defect",
                "How far the computed attitude is from a rotation",
                axes,
                lines,
            );
            motion.push(chart.into());
        }
        blocks.push(Block::Row(motion));
        Section::new("In short", blocks)
    }

    /// The section of the cross-checks.
    fn agreement(&self) -> Section {
        let hold = if self.broken() == 0 { "hold" } else { "do NOT all hold" };
        let quick = if self.quick { " (--quick: fewer rounds, less certain)" } else { "" };
        let [machine, (times, how)] = report::conditions(rounds(self.quick));
        let mut facts = vec![
            machine,
            (times, how + quick),
            (
                "General against closed formulas".into(),
                format!("{} checks {hold}, worst {:.1} units", self.findings.len(), self.worst()),
            ),
            ("Took".into(), format!("{:.1} s", self.took.as_secs_f64())),
        ];
        facts.extend(self.outcomes.iter().filter_map(Outcome::cost_of_the_layers));
        let rows = self.findings.iter().map(|f| {
            let cells = [
                f.name.as_str().into(),
                Cell::number(f.cases as f64, |cases| cases.to_string()),
                Cell::number(f.worst, |worst| format!("{worst:.2}")),
                Cell::number(f.bound, |bound| bound.to_string()),
                if f.holds() { "holds" } else { "out of bounds" }.into(),
            ];
            Row::new(cells).with_emphasis(!f.holds())
        });
        let mut columns = Column::all(["Check"], ["Cases", "Worst (units)", "Bound"]);
        columns.push(Column::text("Result"));
        let caption = "Each map and inverse differential of the general code at n = 3 against the closed formulas, \
                       at random u from 1e-320 to 3e14; whole steps; and the laws of each group with each \
                       map. One unit is the error that rounding the input alone causes.";
        let table = Table::new(caption, columns, rows).into();
        let name = format!("All {} checks", self.findings.len());
        let title = "Two codes that agree, and how this was measured";
        Section::new(title, vec![Block::Facts(facts), Block::fold(name, vec![table])])
    }
}

/// The next commands for a newcomer.
fn go_on() -> Section {
    let code = |text: &str| Block::Code(text.into());
    Section::new(
        "Go on",
        vec![
            Block::text("Simulate a body: print a scene, change its numbers, and run it."),
            code("lieflow scenes wing-nut > my.toml\nlieflow run my.toml --out results"),
            Block::text("State your own equation: its field is a list of formulas."),
            code("lieflow scenes rotating-drive > mine.toml\nlieflow run mine.toml"),
            Block::text(
                "Find the method for your problem: the fastest for the error that you need.",
            ),
            code("lieflow compare my.toml --out comparison"),
        ],
    )
}

impl Outcome {
    /// The time of a step with exp on both layers.
    fn cost_of_the_layers(&self) -> Option<(String, String)> {
        let of = |layer| {
            let exp = candidate(PaperMethod::Exp, layer);
            let curve = self.curves.iter().find(|curve| curve.candidate == exp);
            curve.and_then(Curve::seconds_per_step)
        };
        let (closed, general) = (of(Layer::Closed)?, of(Layer::General)?);
        let times = report::times(general / closed);
        Some((
            format!("{}: a step of RKMK4 exp", self.title),
            format!("{} closed, {} general ({times})", seconds(closed), seconds(general)),
        ))
    }

    /// Speed against error, and the energy over a long time.
    fn blocks(&self) -> Vec<Block> {
        let Experiment { scene, dt, window: [from, to], .. } = self.experiment;
        let speed =
            report::maps_chart(&format!("speed-{scene}"), "Speed against error", &self.curves);
        let speed = speed.map(|chart| {
            chart.with_caption(format!(
                "Attitude and momentum from t = {from} to {to}. The error is the larger relative distance of the \
                 two from the exact solution. Solid: closed formulas for rotations. Dashed: the general code for \
                 matrices of any size. {}",
                self.price()
            ))
        });
        let lines =
            self.runs.iter().map(|run| Series { name: run.label.clone(), ..run.energy.line(1.0) });
        let (id, time) = (format!("energy-{scene}"), Axis::linear("t"));
        let energy = energy_chart(&id, "How far the energy has moved", time, lines)
            .with_caption(format!("Closed formulas, steps of {dt}."));
        let table = report::speed_table(&self.curves, &report::ADVICE);
        let tables = vec![table.into(), self.energy_table().into()];
        let charts = speed.into_iter().chain([energy]).map(Block::from);
        charts.chain([Block::fold("The numbers", tables)]).collect()
    }

    fn energy_table(&self) -> Table {
        let Experiment { scene, body, dt, .. } = self.experiment;
        let exact = body.exact(Experiment::END);
        let printed = |row| printed::table3(row).filter(|_| scene == "high-energy");
        let rows = self.runs.iter().map(|run| {
            let end = run.energy.end;
            let error = end.zip(exact.as_ref().ok()).map(|(g, (_, exact))| (g - exact).norm());
            let mut cells = vec![Cell::from(run.label.as_str())];
            let numbers = [
                run.energy.last(),
                run.energy.max(),
                run.energy.mean_size(),
                error.map_or(f64::NAN, |error| error / 3f64.sqrt()),
                end.map_or(f64::NAN, |g| So3::new().defect(&g)),
                run.layers_differ,
            ];
            let shown = |x: f64| or_dash(Some(x).filter(|x| !x.is_nan()), |x| sig(x, 3));
            cells.extend(numbers.map(|x| Cell::number(x, shown)));
            cells.extend(printed(run.energy.method).into_iter().flatten().map(Cell::from));
            cells
        });
        let mut columns = Column::all(
            ["Method"],
            [
                "E(end) − E(0)",
                "max |E − E(0)|",
                "mean |E − E(0)|",
                "attitude error",
                "‖gᵀg − 𝟙‖",
                "closed − general",
            ],
        );
        if printed(PaperMethod::Exp).is_some() {
            columns.extend(["paper: end", "paper: mean"].map(Column::number));
        }
        let caption = format!(
            "At t = {} in steps of {dt}. The last column of ours: relative difference of the momentum between \
             closed formulas and the general code.",
            Experiment::END
        );
        Table::new(caption, columns, rows)
    }
}
