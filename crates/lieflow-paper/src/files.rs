//! The data as CSV.

use crate::accuracy::{EPSILONS, TESTS};
use crate::counts::Count;
use crate::energy::EnergyRun;
use crate::printed::{self, table3};
use crate::results::Paper;
use lieflow_figures::csv::{in_full, optional};
use lieflow_figures::fields;

/// The name of a file, its columns and its rows.
type Data = (&'static str, String, Vec<Vec<String>>);

/// Every file.
pub(super) fn all(paper: &Paper) -> Vec<Data> {
    let series = |name: &str, points: &[(f64, f64)]| {
        let row = |(x, y): &(f64, f64)| fields![name, in_full(*x), in_full(*y)];
        points.iter().map(row).collect::<Vec<_>>()
    };
    let drift = paper.drift.iter().flat_map(|d| series(d.method.key(), &d.points));
    let near = paper.separatrix.iter().flat_map(|s| series(s.method.key(), &s.side));
    let frames = paper.frames.iter().flat_map(|f| {
        let printed = core::iter::once(("printed", &f.printed));
        let all = printed.chain(f.random.iter().map(|x| ("random", x)));
        all.map(|(frame, x)| fields![f.example, f.method.key(), frame, in_full(*x)])
    });
    vec![
        ("table1.csv", "layer,stage,u1,u2,u3,k1,k2,k3".into(), table1_rows(paper)),
        table2(&paper.counts),
        table3_file(&paper.energy[2]),
        table4(paper),
        energy("figure3.csv", &paper.energy[0]),
        energy("figure4.csv", &paper.energy[1]),
        figure5(paper),
        ("frames.csv", "example,method,frame,energy_error".into(), frames.collect()),
        ("drift.csv", "method,h,drift".into(), drift.collect()),
        ("separatrix.csv", "method,t,side".into(), near.collect()),
    ]
}

fn table1_rows(paper: &Paper) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for (layer, trace) in ["closed", "general"].iter().zip(&paper.trace) {
        for (i, stage) in trace.stages.iter().enumerate() {
            let name = if stage.k.is_some() { (i + 1).to_string() } else { "v".into() };
            let mut row = fields![layer, name];
            row.extend(stage.u.map(in_full));
            row.extend(stage.k.map_or_else(Default::default, |k| k.map(in_full)));
            rows.push(row);
        }
    }
    rows
}

/// Printed, counted and the fewest known.
fn table2(counts: &[Count]) -> Data {
    let header = "map,part,printed_add,printed_mul,printed_sqrt,printed_trig,printed_total,\
                  printed_with_product,add,mul,div,sqrt,trig,total,optimum";
    let rows = counts.iter().map(|c| {
        // ASCII alone.
        let part = match c.part {
            "Ψ" => "psi",
            "dΨ⁻¹" => "dpsi_inv",
            other => other,
        };
        let ([a, m, s, t], fewest) = printed::table2(c.map, c.part);
        let (o, total, sum) = (c.ops, c.ops.total(), a + m + s + t);
        let applied = sum + c.product();
        fields![
            c.map, part, a, m, s, t, sum, applied, o.add, o.mul, o.div, o.sqrt, o.trig, total,
            fewest
        ]
    });
    ("table2.csv", header.into(), rows.collect())
}

/// The errors as the paper prints them, without their sign.
fn table3_file(runs: &[EnergyRun]) -> Data {
    let header =
        "method,energy_error,mean_energy_error,printed_energy_error,printed_mean_energy_error";
    let rows = runs.iter().map(|run| {
        let [last, mean] = table3(run.method).unwrap_or_default();
        fields![run.method.key(), in_full(run.last().abs()), in_full(run.mean().abs()), last, mean]
    });
    ("table3.csv", header.into(), rows.collect())
}

/// log₁₀ of operations: printed, by the paper's operations of a step, by counted ones; and the time.
fn table4(paper: &Paper) -> Data {
    let header = "test,method,epsilon,printed_log10_ops,log10_ops_paper_step,ops_of_step_paper,\
                  log10_ops_counted,ops_of_step_counted,seconds";
    let mut rows = Vec::new();
    let four = |x: Option<f64>| optional(x.map(|x| format!("{x:.4}")));
    for a in paper.accuracy.iter().flatten() {
        for (e, epsilon) in EPSILONS.into_iter().enumerate() {
            let cost = a.cost(e);
            rows.push(fields![
                TESTS[a.test].key,
                a.method.key(),
                in_full(epsilon),
                four(cost.printed),
                four(cost.ours),
                optional(a.printed_step()),
                four(cost.counted),
                optional(a.counted_step()),
                optional(cost.seconds.map(in_full)),
            ]);
        }
    }
    ("table4.csv", header.into(), rows)
}

/// t and the energy error of each method, every tenth step.
fn energy(name: &'static str, runs: &[EnergyRun]) -> Data {
    let names: Vec<&str> = runs.iter().map(|run| run.method.key()).collect();
    let steps = runs.iter().map(|run| run.error.len()).max().unwrap_or(0);
    let rows = (0..steps).step_by(10).map(|i| {
        let at = |run: &EnergyRun| run.error.get(i).copied();
        let t = runs.iter().find_map(at).map_or(f64::NAN, |(t, _)| t);
        let errors = runs.iter().map(|run| optional(at(run).map(|(_, error)| in_full(error))));
        core::iter::once(t.to_string()).chain(errors).collect()
    });
    (name, format!("t,{}", names.join(",")), rows.collect())
}

fn figure5(paper: &Paper) -> Data {
    let header = "test,method,steps,error,ops_paper_step,ops_counted,seconds";
    let mut rows = Vec::new();
    for a in paper.accuracy.iter().flatten() {
        rows.extend(a.points.iter().map(|p| {
            fields![
                TESTS[a.test].key,
                a.method.key(),
                p.steps,
                in_full(p.error),
                optional(a.printed_step().map(|ops| ops * p.steps as f64)),
                optional(a.counted_step().map(|ops| ops * p.steps)),
                in_full(p.seconds)
            ]
        }));
    }
    ("figure5.csv", header.into(), rows)
}
