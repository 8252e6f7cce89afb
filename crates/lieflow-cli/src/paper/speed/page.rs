//! The page of the main job.

use lieflow::groups::{LieGroup, So3};
use lieflow_figures::number::{scientific, seconds};
use lieflow_figures::{Block, Cell, Column, Page, Path, Row, Section, Sphere, Table};
use lieflow_model::model::Layer;

use super::{Outcome, Speed, candidate, rounds};
use crate::measure::Curve;
use crate::paper::energy::energy_chart;
use crate::paper::experiments::Experiment;
use crate::paper::maps::MAPS_PAGE;
use crate::paper::methods::PaperMethod;
use crate::paper::printed;
use crate::report;

impl Speed {
    pub(super) fn page(&self) -> Page {
        let hold = if self.broken() == 0 { "hold" } else { "do NOT all hold" };
        let quick = if self.quick { " (--quick: fewer rounds, less certain)" } else { "" };
        let [machine, (times, how)] = report::conditions(rounds(self.quick));
        let mut facts = vec![
            machine,
            (times, how + quick),
            (
                "General against closed".into(),
                format!(
                    "{} checks {hold}, worst {:.1} eps·cond",
                    self.findings.len(),
                    self.worst()
                ),
            ),
            ("Took".into(), format!("{:.1} s", self.took.as_secs_f64())),
        ];
        facts.extend(self.outcomes.iter().filter_map(Outcome::cost_of_the_layers));
        let mut sections = vec![Section::new(
            "In short",
            vec![
                Block::text(
                    "The free rigid body of the paper, integrated by Runge–Kutta–Munthe-Kaas of order 4 \
                     with each coordinate map — through the closed formulas on so(3) and through the \
                     general matrix layer for any n — and by classical Runge–Kutta, each compared with \
                     the exact solution in Jacobi's elliptic functions.",
                ),
                Block::Facts(facts),
            ],
        )];
        sections.extend(self.outcomes.iter().map(Outcome::section));
        sections.push(self.agreement());
        sections.push(Section::new(
            "Go on",
            vec![
                Block::Link {
                    text: "The maps one by one: accuracy and time over the angle and over n".into(),
                    href: MAPS_PAGE.into(),
                },
                Block::text(
                    "Every figure lies beside this page as an SVG file; speed.csv has every run.",
                ),
                Block::Code(
                    "lieflow scenes asymmetric-top > my.toml   # a scene to start from\n\
                     lieflow run my.toml --out results         # trajectory.csv and summary.json\n\
                     lieflow compare my.toml --out results     # speed against error for it\n\
                     lieflow methods                           # what there is to choose from"
                        .into(),
                ),
            ],
        ));
        report::page(
            "Lie group integrators: speed against error",
            "The rigid body experiments of Celledoni & Owren, section 5.2",
            sections,
        )
    }

    /// The section of the cross-checks.
    fn agreement(&self) -> Section {
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
        let mut columns = Column::all(["Check"], ["Cases", "Worst [eps·cond]", "Bound"]);
        columns.push(Column::text(""));
        Section::new(
            "General against specialised",
            vec![
                Block::text(
                    "Every map and inverse differential of the general layer at n = 3 against the closed \
                     forms, at random u from 1e-320 to 3e14; whole steps; and the laws of each group \
                     with each map. Differences are in units of ε·cond·size: 1 is what one rounding of \
                     the input already changes.",
                ),
                Table::new("Largest differences found on this machine.", columns, rows).into(),
            ],
        )
    }
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

    fn section(&self) -> Section {
        let Experiment { scene, dt, window: [from, to], .. } = self.experiment;
        let speed = report::speed_chart(&format!("speed-{scene}"), "Speed against error", &self.curves)
            .with_caption(format!(
                "Attitude and momentum integrated over t = {from} … {to}; the error is the larger relative \
                 distance of the two from the exact solution. Solid: closed forms on so(3); dashed: \
                 the general matrix layer.",
            ));
        let lines = self.runs.iter().map(|run| {
            let line = run.energy.line(1.0);
            lieflow_figures::Series { name: run.label.clone(), ..line }
        });
        let energy =
            energy_chart(&format!("energy-{scene}"), "Energy error over time", "time t", lines)
                .with_caption(format!("Closed layer, t = 0 … {}, dt = {dt}.", Experiment::END));
        let mut blocks = vec![
            speed.into(),
            report::speed_table(&self.curves).into(),
            energy.into(),
            self.energy_table().into(),
        ];
        blocks.extend(self.sphere().map(Block::from));
        Section::new(self.title.clone(), blocks)
    }

    /// The path of the momentum on its sphere, with the energy ellipsoid.
    fn sphere(&self) -> Option<Sphere> {
        let Experiment { scene, body, .. } = self.experiment;
        let m = body.momentum_body();
        let points = self.runs.first()?.energy.momentum.clone();
        Some(Sphere {
            id: format!("sphere-{scene}"),
            title: "The momentum on its sphere".into(),
            radius: m.norm(),
            inertia: body.inertia,
            energy: (0..3).map(|i| m[i].powi(2) / (2.0 * body.inertia[i])).sum(),
            paths: vec![Path { name: "body momentum m(t)".into(), colour: 0, points }],
            caption:
                "The momentum stays on the sphere |m| = const and on the ellipsoid of constant \
                      energy: it runs along their intersection."
                    .into(),
            view: (35.0, 25.0),
        })
    }

    fn energy_table(&self) -> Table {
        let Experiment { scene, body, dt, .. } = self.experiment;
        let exact = body.exact(Experiment::END);
        let printed = |row| printed::table3(row).filter(|_| scene == "high-energy");
        let rows = self.runs.iter().map(|run| {
            let end = run.energy.end;
            let error = end.zip(exact.as_ref().ok()).map(|(g, (_, exact))| (g - exact).norm());
            let mut cells = vec![run.label.clone()];
            let numbers = [
                run.energy.last(),
                run.energy.max(),
                run.energy.mean_size(),
                error.map_or(f64::NAN, |error| error / 3f64.sqrt()),
                end.map_or(f64::NAN, |g| So3::new().defect(&g)),
                run.layers_differ,
            ];
            cells.extend(numbers.map(scientific));
            cells.extend(printed(run.energy.method).into_iter().flatten().map(String::from));
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
                "layers differ",
            ],
        );
        if printed(PaperMethod::Exp).is_some() {
            columns.extend(["paper: end", "paper: mean"].map(Column::number));
        }
        let caption = format!(
            "At t = {} from t = 0, dt = {dt}. “Layers differ”: relative difference of the final momentum, \
             momentum-only model, between closed forms and general layer.",
            Experiment::END
        );
        Table::new(caption, columns, rows)
    }
}
