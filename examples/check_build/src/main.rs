//! Checks the methods of lieflow in the build of this crate: steps, points within steps, events, tolerances, resumed runs.
//!
//! ```sh
//! cargo run --release
//! ```

use std::process::ExitCode;

use lieflow::check::{MethodOn, Reference, Subject, runs_agree};
use lieflow::faer::Mat;
use lieflow::methods::commutator_free::CF4;
use lieflow::methods::tableau::{BS3, RKF45, VERNER6};
use lieflow::methods::{CommutatorFree, Doubling, GAUSS6, Gauss};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::prelude::*;
use lieflow::problems::{HeavyTop, RigidBodyN};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// Checks a problem from its start: each method of the list, and those by name. Returns the number of failures.
macro_rules! check {
    ($problem:ident, $start:expr, $span:expr; $($method:expr),* $(,)?) => {{
        let (problem, start) = (&$problem, &$start);
        let by_classical_steps = MethodOn { problem, method: &Rk(DOP853), start };
        let by_group = MethodOn { problem, method: &Rkmk::new(DOP853, Exp), start };
        let reference = Reference::new(&by_classical_steps, &by_group, [0.0, $span])?;
        let of_classical = Reference::new(&by_group, &by_classical_steps, [0.0, $span])?;
        let name = stringify!($problem);
        let mut failures = check(name, "rk dop853", &by_classical_steps, &of_classical);
        failures += check(name, "rkmk dop853 exp", &by_group, &reference);
        $(
            let method = MethodOn { problem, method: &$method, start };
            failures += check(name, stringify!($method), &method, &reference);
        )*
        failures
    }};
}

/// Prints the checks of a method that do not hold. Returns their number.
fn check(problem: &str, name: &str, method: &dyn Subject, reference: &Reference) -> usize {
    let findings = runs_agree(method, reference);
    let broken: Vec<_> = findings.iter().filter(|finding| !finding.holds()).collect();
    let verdict = if broken.is_empty() { "ok" } else { "FAILED" };
    println!("{problem:9} {name:36} {} checks  {verdict}", findings.len());
    for finding in &broken {
        println!("  {}: {}", finding.name, finding.at);
    }
    broken.len()
}

fn main() -> Outcome<ExitCode> {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
    let mut failures = check! { body, Vector3::new(0.1, 2.0, 0.3), 4.0;
        Rkmk::new(VERNER6, Exp),
        Rkmk::new(VERNER6, Cay),
        Rkmk::new(RKF45, Exp),
        Rkmk::new(DOPRI5, Cay),
        Rkmk::new(BS3, Exp),
        Doubling(CommutatorFree(CF4)),
        Doubling(Gauss(GAUSS6)),
    };

    let attitude = RigidBodyAttitude::<f64>::new([1.0, 4.0, 18.0], [0.0, 2.75, 2.75])?;
    failures += check! { attitude, Matrix3::identity(), 4.0;
        Rkmk::new(VERNER6, Cay),
        Rkmk::new(DOPRI5, Exp),
    };

    let top = HeavyTop::<f64>::lagrange(1.0, 0.6, 1.3)?.problem();
    failures += check! { top, (Vector3::new(0.4, -0.3, 1.5), Vector3::new(0.48, 0.6, 0.64)), 4.0;
        Rkmk::new(VERNER6, Exp),
        Rkmk::new(DOPRI5, Cay),
        Doubling(CommutatorFree(CF4)),
    };

    let magnet =
        Flow::new(So3::<f64>::new(), Linear, |t, x: &Vector3<f64>, f: &mut Vector3<f64>| {
            *f = Vector3::new(t.cos(), t.sin(), x[2]);
        });
    failures += check! { magnet, Vector3::x(), 8.0;
        Rkmk::new(VERNER6, Exp),
        Rkmk::new(DOPRI5, Cay),
    };

    let manakov = RigidBodyN::manakov(&[0.5, 1.0, 1.5, 2.0])?;
    let start = Mat::from_fn(4, 4, |i, j| 2.0 * (i as f64 - j as f64) / (1 + i + j) as f64);
    failures += check! { manakov, start, 4.0;
        Rkmk::new(VERNER6, Exp),
        Rkmk::new(DOPRI5, Cay),
    };

    Ok(if failures == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
