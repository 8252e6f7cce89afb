//! Compares the matrix code at n = 3 with the closed formulas on so(3), and checks the laws of several groups.
//!
//! It uses `lieflow::check`, which takes any group, also your own.
//!
//! ```sh
//! cargo run --release --example cross_check
//! ```

use lieflow::check::{Finding, laws, maps_agree, steps_agree};
use lieflow::groups::{MatrixGroup, So3};
use lieflow::maps::{CCSK123, Cay, Exp};
use rand::SeedableRng;
use rand_pcg::Pcg64;

fn table(title: &str, findings: &[Finding]) {
    println!("{title}\n  {:34} {:>6} {:>7} {:>6}", "", "cases", "worst", "bound");
    for f in findings {
        println!("  {:34} {:6} {:7.2} {:6}", f.name, f.cases, f.worst, f.bound);
        assert!(f.holds(), "{}: {} at {}", f.name, f.worst, f.at);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let rng = &mut Pcg64::seed_from_u64(1);
    println!("Differences in units of ε·cond·size. 1 is the change by rounding the input once.\n");
    table("Maps on both layers, |u| from 1e-320 to 3e14", &maps_agree(rng, 5000)?);
    table("One step of RKMK4 on both layers", &steps_agree(rng, 200)?);

    let so3 = So3::new();
    let lorentz = MatrixGroup::indefinite(3, 1)?;
    table("SO(3), closed", &laws(&so3, &CCSK123, rng, 100, 0.3)?);
    table("SO(6)", &laws(&MatrixGroup::so(6)?, &Exp, rng, 100, 0.3)?);
    table("Sp(4)", &laws(&MatrixGroup::sp(4)?, &Cay, rng, 100, 0.3)?);
    table("The Lorentz group", &laws(&lorentz, &Cay, rng, 100, 0.3)?);
    table("GL(4)", &laws(&MatrixGroup::gl(4)?, &Exp, rng, 100, 0.2)?);
    Ok(())
}
