//! The data as CSV.

use super::Paper;
use super::accuracy::{EPSILONS, TESTS};
use super::counts::Count;
use super::energy::EnergyRun;
use super::printed::{OPTIMUM, TABLE2, TABLE3, TABLE4};

/// Every file with its name.
pub(super) fn all(paper: &Paper) -> Vec<(String, String)> {
    let mut files = vec![
        ("table1.csv".into(), table1(paper)),
        ("table2.csv".into(), table2(&paper.counts)),
        ("table3.csv".into(), table3(&paper.energy[2])),
        ("table4.csv".into(), table4(paper)),
        ("figure3.csv".into(), energy(&paper.energy[0])),
        ("figure4.csv".into(), energy(&paper.energy[1])),
        ("figure5.csv".into(), figure5(paper)),
    ];
    let mut frames = String::from("example,method,frame,energy_error\n");
    for f in &paper.frames {
        let (example, key) = (f.example, f.row.key());
        frames += &format!("{example},{key},printed,{:e}\n", f.printed);
        for x in &f.random {
            frames += &format!("{example},{key},random,{x:e}\n");
        }
    }
    files.push(("frames.csv".into(), frames));
    let mut drift = String::from("method,h,drift\n");
    for d in &paper.drift {
        for (h, slope) in &d.points {
            drift += &format!("{},{h:e},{slope:e}\n", d.row.key());
        }
    }
    files.push(("drift.csv".into(), drift));
    let mut near = String::from("method,t,side\n");
    for s in &paper.separatrix {
        for (t, side) in &s.side {
            near += &format!("{},{t:e},{side:e}\n", s.row.key());
        }
    }
    files.push(("separatrix.csv".into(), near));
    files
}

fn table1(paper: &Paper) -> String {
    let mut text = String::from("layer,stage,u1,u2,u3,k1,k2,k3\n");
    for (layer, trace) in ["closed", "general"].iter().zip(&paper.trace) {
        for (i, stage) in trace.stages.iter().enumerate() {
            let name = if stage.k.is_some() { (i + 1).to_string() } else { "v".into() };
            let [a, b, c] = stage.u;
            let k = stage.k.map_or(",,".into(), |[x, y, z]| format!("{x:e},{y:e},{z:e}"));
            text += &format!("{layer},{name},{a:e},{b:e},{c:e},{k}\n");
        }
    }
    text
}

/// Printed, counted and the fewest known.
fn table2(counts: &[Count]) -> String {
    let mut text = String::from(
        "map,part,printed_add,printed_mul,printed_sqrt,printed_trig,printed_total,\
         printed_with_product,add,mul,div,sqrt,trig,total,optimum\n",
    );
    for c in counts {
        let same = |map: &str, part: &str| map == c.map && part == c.part;
        let printed = TABLE2.iter().find(|(map, part, _)| same(map, part));
        let [a, m, s, t] = printed.map_or([0; 4], |(.., numbers)| *numbers);
        let optimum = OPTIMUM.iter().find(|(map, part, _)| same(map, part)).map_or(0, |o| o.2);
        let (o, total) = (c.ops, a + m + s + t);
        text += &format!(
            "{},{},{a},{m},{s},{t},{total},{},{},{},{},{},{},{},{optimum}\n",
            c.map,
            ascii(c.part),
            total + c.product(),
            o.add,
            o.mul,
            o.div,
            o.sqrt,
            o.trig,
            o.total()
        );
    }
    text
}

/// The name of a part without signs beyond ASCII.
fn ascii(part: &str) -> &str {
    match part {
        "Ψ" => "psi",
        "dΨ⁻¹" => "dpsi_inv",
        other => other,
    }
}

/// The errors as the paper prints them, without their sign.
fn table3(runs: &[EnergyRun]) -> String {
    let mut text = String::from(
        "method,energy_error,mean_energy_error,printed_energy_error,printed_mean_energy_error\n",
    );
    for run in runs {
        let printed = TABLE3.iter().find(|(row, ..)| *row == run.row);
        let (last, mean) = printed.map_or(("", ""), |(_, last, mean)| (*last, *mean));
        let (a, b) = (number(run.last().abs()), number(run.mean().abs()));
        text += &format!("{},{a},{b},{last},{mean}\n", run.row.key());
    }
    text
}

/// A number with nine digits; nothing where there is none.
fn number(x: f64) -> String {
    if x.is_nan() { String::new() } else { format!("{x:.8e}") }
}

fn optional(x: Option<f64>) -> String {
    x.map_or_else(String::new, |x| format!("{x:.4}"))
}

/// log₁₀ of operations: printed, by the paper's operations of a step, by counted ones; and the time.
fn table4(paper: &Paper) -> String {
    let mut text = String::from(
        "test,method,epsilon,printed_log10_ops,log10_ops_paper_step,ops_of_step_paper,\
         log10_ops_counted,ops_of_step_counted,seconds\n",
    );
    for (t, test) in TESTS.iter().enumerate() {
        for a in &paper.accuracy[t] {
            let printed = TABLE4.iter().find(|p| p.row == a.row);
            for (e, epsilon) in EPSILONS.into_iter().enumerate() {
                let n = a.log_steps(epsilon);
                let step = printed.and_then(|p| p.per_step[t]);
                let counted = a.ops.map(|ops| ops.total() as f64);
                text += &format!(
                    "{},{},{epsilon:e},{},{},{},{},{},{}\n",
                    test.key,
                    a.row.key(),
                    optional(printed.map(|p| p.printed[t][e])),
                    optional(step.map(|c| n + c.log10())),
                    step.map_or(String::new(), |c| c.to_string()),
                    optional(counted.map(|c| n + c.log10())),
                    counted.map_or(String::new(), |c| c.to_string()),
                    a.seconds_to(epsilon).map_or(String::new(), |s| format!("{s:e}")),
                );
            }
        }
    }
    text
}

/// t and the energy error of each method, every tenth step.
fn energy(runs: &[EnergyRun]) -> String {
    let names: Vec<&str> = runs.iter().map(|run| run.row.key()).collect();
    let mut text = format!("t,{}\n", names.join(","));
    let steps = runs.iter().map(|run| run.error.len()).max().unwrap_or(0);
    for i in (0..steps).step_by(10) {
        let t = runs.iter().find_map(|run| run.error.get(i)).map_or(f64::NAN, |(t, _)| *t);
        text += &format!("{t}");
        for run in runs {
            text += ",";
            text += &run.error.get(i).map_or(String::new(), |(_, error)| number(*error));
        }
        text.push('\n');
    }
    text
}

fn figure5(paper: &Paper) -> String {
    let mut text = String::from("test,method,steps,error,ops_paper_step,ops_counted,seconds\n");
    for (t, test) in TESTS.iter().enumerate() {
        for a in &paper.accuracy[t] {
            let step = TABLE4.iter().find(|p| p.row == a.row).and_then(|p| p.per_step[t]);
            for p in &a.points {
                let n = p.steps as f64;
                text += &format!(
                    "{},{},{},{},{},{},{}\n",
                    test.key,
                    a.row.key(),
                    p.steps,
                    number(p.error),
                    step.map_or(String::new(), |c| (c * n).to_string()),
                    a.ops.map_or(String::new(), |ops| (ops.total() * p.steps).to_string()),
                    number(p.seconds)
                );
            }
        }
    }
    text
}
