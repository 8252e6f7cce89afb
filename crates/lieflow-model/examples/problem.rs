//! A problem as a value: it is built without a scene file, asked, and run from two threads at once.

use std::thread;

use lieflow::catalog::MethodSpec;
use lieflow::solve::Next;
use lieflow::{SaveAt, StepControl};
use lieflow_model::kinds;
use lieflow_model::problem::{EventPlan, Model, Plan, Steps, Watcher};
use lieflow_model::reader::Tree;
use lieflow_model::schema::Row;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A body with three moments of inertia turns about its middle axis, and flips.
    let kind = kinds::named("rigid-body")?;
    let keys = [("inertia", [1.0, 2.0, 3.0]), ("omega_body", [0.01, 1.0, 0.0])];
    let body = kind.problem(&Tree::table(keys))?;

    println!("{}: {}", kind.name, kind.equation);
    for key in kind.keys {
        println!(
            "  {:18}{:?}{}",
            key.name,
            key.shape,
            if key.optional { ", optional" } else { "" }
        );
    }
    println!("conserved: {}", body.invariants(&["attitude"]).join(", "));

    // A wrong value is a mistake with the path of its key.
    let wrong = Tree::table([("inertia", [1.0, -2.0, 3.0]), ("omega_bdy", [0.0, 1.0, 0.0])]);
    let mistakes = kind.problem(&wrong).expect_err("two mistakes");
    println!("{mistakes}");

    let model = body.model(body.layers()[0], &["omega_body", "energy"])?;
    let method: MethodSpec = "rkmk dop853 exp".parse()?;
    model.fits(&method)?;
    println!("start: {:?}", model.start(&method)?);

    // Two threads run it at once, one of them from another point.
    let ends = thread::scope(|threads| {
        let other = threads.spawn(|| flips(&model, &method, Some(vec![0.5, 2.0, 0.1])));
        [flips(&model, &method, None), other.join().expect("no panic")]
    });
    for end in ends {
        let (flips, energy) = end?;
        println!("{flips} flips, energy {energy:.12}");
        assert!(flips >= 5);
    }
    Ok(())
}

/// What a run shows: the number of its flips, and the energy of its last row.
#[derive(Default)]
struct Seen {
    flips: u64,
    energy: f64,
}

impl Watcher for Seen {
    fn row(&mut self, _: f64, row: Row<'_>) -> Next {
        self.energy = row.of("energy").map_or(f64::NAN, |energy| energy[0]);
        Next::Continue
    }
    fn event(&mut self, _: usize, _: f64, _: bool, _: Row<'_>) {
        self.flips += 1;
    }
}

/// Runs to t = 100 from a point: the number of flips, and the energy at the end.
fn flips(
    model: &Model,
    method: &MethodSpec,
    start: Option<Vec<f64>>,
) -> Result<(u64, f64), lieflow::RunError> {
    let control = StepControl::new(1e-10, 1e-10)?;
    let steps = Steps::ByError { t_span: [0.0, 100.0], control };
    let middle = model.schema().place("w2")?;
    let mut plan = Plan { start, ..Plan::new(steps, SaveAt::End) };
    let value = move |_: f64, row: Row<'_>| row.numbers()[middle];
    plan.events.push(EventPlan::new("flip", vec![middle], value));
    let mut seen = Seen::default();
    model.drive(method, plan, &mut seen)?;
    Ok((seen.flips, seen.energy))
}
