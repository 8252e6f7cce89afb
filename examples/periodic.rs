//! Linear Hamiltonian systems with periodic coefficients: Mathieu's stability chart, and the tunes of a FODO cell.
//!
//! ```sh
//! cargo run --release --example periodic
//! ```

use lieflow::floquet::{Floquet, monodromy};
use lieflow::methods::magnus::Magnus6;
use lieflow::problems::beam::{Element, transfer_map, tunes};
use lieflow::problems::mathieu;
use std::f64::consts::PI;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("ẍ + (a − 2q cos 2t)x = 0: · stable, # not; a from −1 to 5, q from 0 (top) to 3");
    for row in 0..=12 {
        let q = 0.25 * f64::from(row);
        let mut line = String::new();
        for column in 0..=60 {
            let a = -1.0 + 0.1 * f64::from(column) + 0.05;
            let period = monodromy(&mathieu(a, q)?, &Magnus6, [0.0, PI], 40)?;
            line.push(if Floquet::of(&period)?.spectral_radius() < 1.0 + 1e-9 {
                '·'
            } else {
                '#'
            });
        }
        println!("  {line}");
    }

    println!("a FODO cell of quadrupoles 0.2 m long, 2 m apart:");
    for k in [0.5, 2.0, 4.0, 6.0] {
        let drift = Element::Drift { length: 2.0 };
        let quadrupole = |k| Element::Quadrupole { length: 0.2, k };
        let cell = transfer_map(&[quadrupole(k), drift, quadrupole(-k), drift])?;
        match tunes(&cell) {
            [Some(x), Some(z)] => println!("  k = {k}: tunes {x:.5} and {z:.5}"),
            _ => println!("  k = {k}: no stable motion"),
        }
    }
    Ok(())
}
