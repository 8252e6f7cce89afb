//! A two-level atom in a light field, by a Magnus method: Rabi's oscillations and a chirped pulse.
//!
//! A strong chirped pulse moves the population to the excited level. The last example has five levels: a spin 2 that
//! turns.
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
    println!("difference from Rabi's formula {worst:.0e}, |ψ| − 1 = {:.0e}", psi.norm_l2() - 1.0);
    assert!(worst < 1e-8 && (psi.norm_l2() - 1.0).abs() < 1e-11);

    println!("population of the excited level after a chirped pulse of strength s:");
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

    // A spin 2 in a transverse field, H = J_x, is like four spins ½. So its populations are binomial.
    let turning = schrodinger(5, |_: f64, i, j| match i.abs_diff(j) {
        1 => [0.5 * f64::sqrt(((i.min(j) + 1) * (4 - i.min(j))) as f64), 0.0],
        _ => [0.0, 0.0],
    })?;
    let mut psi = amplitudes(&[[1.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])?;
    let (angle, grid) = (1.2f64, TimeGrid::new([0.0, 1.2], 0.1)?);
    integrate(&turning, &Magnus6, &grid, &SaveAt::Ends, &mut psi, |_, _| {})?;
    let (stay, flip) = ((0.5 * angle).cos().powi(2), (0.5 * angle).sin().powi(2));
    println!("a spin 2 that has turned by {angle}:");
    for (k, ways) in [1.0, 4.0, 6.0, 4.0, 1.0].into_iter().enumerate() {
        let expected = ways * stay.powi(4 - k as i32) * flip.powi(k as i32);
        println!("  level {k}: {:.6}, binomial {expected:.6}", populations(&psi)[k]);
        assert!((populations(&psi)[k] - expected).abs() < 1e-13);
    }
    Ok(())
}
