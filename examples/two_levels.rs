//! A two-level atom in a light field, by a Magnus method: Rabi's oscillations, and a chirped pulse
//! that carries the population over whatever its strength.
//!
//! ```sh
//! cargo run --release --example two_levels
//! ```

use lieflow::methods::magnus::Magnus6;
use lieflow::problems::{amplitudes, populations, schrodinger};
use lieflow::{SaveAt, TimeGrid, integrate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let ground = amplitudes(&[[1.0, 0.0], [0.0, 0.0]])?;
    let (omega0, omega, drive) = (3.0, 3.4, 0.9);
    let driven = schrodinger(2, |t: f64, i, j| match (i, j) {
        (0, 0) => [0.5 * omega0, 0.0],
        (1, 1) => [-0.5 * omega0, 0.0],
        _ => [0.5 * drive * (omega * t).cos(), -0.5 * drive * (omega * t).sin()],
    })?;
    let rabi = |t: f64| {
        let general = f64::hypot(drive, omega - omega0);
        (drive / general * (0.5 * general * t).sin()).powi(2)
    };
    let (mut psi, mut worst) = (ground.clone(), 0.0f64);
    let grid = TimeGrid::new([0.0, 100.0], 0.02)?;
    integrate(&driven, &Magnus6, &grid, &SaveAt::Every(1), &mut psi, |t, psi| {
        worst = worst.max((populations(psi)[1] - rabi(t)).abs());
    })?;
    println!("off Rabi's formula by {worst:.0e}, |ψ| − 1 = {:.0e}", psi.norm_l2() - 1.0);
    assert!(worst < 1e-8 && (psi.norm_l2() - 1.0).abs() < 1e-11);

    println!("a chirped pulse of strength s leaves in the excited level:");
    for strength in [0.5, 1.0, 2.0, 3.0] {
        let pulse = schrodinger(2, move |t: f64, i, j| match (i, j) {
            (0, 0) => [0.5 * t, 0.0],
            (1, 1) => [-0.5 * t, 0.0],
            _ => [0.5 * strength, 0.0],
        })?;
        let (mut psi, grid) = (ground.clone(), TimeGrid::new([-400.0, 400.0], 0.01)?);
        integrate(&pulse, &Magnus6, &grid, &SaveAt::Ends, &mut psi, |_, _| {})?;
        // Landau and Zener: 1 − e^{−πs²/2}.
        let expected = 1.0 - (-0.5 * std::f64::consts::PI * strength * strength).exp();
        println!("  s = {strength}: {:.4}, Landau–Zener {expected:.4}", populations(&psi)[1]);
    }
    Ok(())
}
