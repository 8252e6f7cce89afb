//! Linear Hamiltonian systems with periodic coefficients: stability by the monodromy matrix.
//!
//! Mathieu's stability chart, two coupled oscillators on Sp(4) with a K(t) of one's own, and the tunes of a FODO cell.
//! The monodromy matrix, the solution after one period, decides whether small motions stay small.
//!
//! ```sh
//! cargo run --release --example periodic
//! ```

use lieflow::floquet::{Floquet, monodromy};
use lieflow::groups::AlgebraMatrix;
use lieflow::methods::magnus::Magnus6;
use lieflow::prelude::*;
use lieflow::problems::beam::{Element, transfer_map, tunes};
use lieflow::problems::mathieu;
use std::f64::consts::{PI, TAU};

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

    // ẍ = −K(t)x with K(t) = diag(stiffness) + 0.1 cos t + 0.05 between the two. A drive of frequency 1 resonates with an
    // oscillator of frequency 1/2.
    for (name, stiffness) in [("off resonance", [0.49, 0.64]), ("in resonance", [0.25, 0.64])] {
        let group = MatrixGroup::sp(4)?;
        let field = move |t: f64, a: &mut AlgebraMatrix| {
            for i in 0..2 {
                a[(i, 2 + i)] = 1.0;
                a[(2 + i, i)] = -(stiffness[i] + 0.1 * t.cos());
                a[(2 + i, 1 - i)] = -0.05;
            }
        };
        let system = Flow::of_time(group.clone(), LeftTranslation, field);
        let period = monodromy(&system, &Rkmk::new(RK4, Exp), [0.0, TAU], 160)?;
        let floquet = Floquet::of(&period)?;
        println!(
            "two oscillators {name}: growth {:.4} a unit of time, |gᵀJg − J| = {:.0e}",
            floquet.growth(TAU).max(0.0),
            group.defect(&period)
        );
        assert!(group.defect(&period) < 1e-12, "g stays symplectic to rounding");
        assert_eq!(floquet.spectral_radius() < 1.0 + 1e-6, name == "off resonance");
        for z in &floquet.multipliers {
            let times = |w: &[f64; 2]| [z[0] * w[0] - z[1] * w[1] - 1.0, z[0] * w[1] + z[1] * w[0]];
            let partner = floquet.multipliers.iter().map(times).map(|[re, im]| re.hypot(im));
            assert!(partner.fold(1.0, f64::min) < 1e-9, "with λ, 1/λ is a multiplier too");
        }
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
