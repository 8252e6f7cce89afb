//! Products of spheres: a wave in a chain of spins, a damped chain, and the spherical pendulum.
//!
//! ```sh
//! cargo run --release --example spheres
//! ```

use lieflow::prelude::*;
use lieflow::problems::{Invariants, SphericalPendulum, SpinChain};
use nalgebra::Vector3;
use std::f64::consts::TAU;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (n, method) = (100, Rkmk::new(RK4, Cay));

    // A spin wave of two periods on a ring: every spin turns at 2 cos θ (1 − cos k).
    let (theta, k) = (0.4f64, 2.0 * TAU / n as f64);
    let rate = 2.0 * theta.cos() * (1.0 - k.cos());
    let ring = SpinChain::new(n)?;
    let wave = |t: f64| {
        ring.spins(|i| {
            let phase = k * i as f64 + rate * t;
            Vector3::new(theta.sin() * phase.cos(), theta.sin() * phase.sin(), theta.cos())
        })
    };
    let (mut spins, grid) = (wave(0.0)?, TimeGrid::new([0.0, 100.0], 0.1)?);
    integrate(&ring, &method, &grid, &SaveAt::Ends, &mut spins, |_, _| {})?;
    let far = spins.iter().zip(&wave(100.0)?).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    println!("a wave on {n} spins: off by {far:.0e} at t = 100");
    assert!(far < 1e-5);

    // With damping and a field the energy falls to that of all spins along the field.
    let damped = SpinChain::new(n)?.with_damping(0.3)?.with_field([0.0, 0.0, 0.5])?;
    let mut spins = damped.spins(|i| Vector3::new((i as f64).sin(), (i as f64).cos(), 0.2))?;
    let grid = TimeGrid::new([0.0, 40.0], 0.1)?;
    integrate(&damped, &method, &grid, &SaveAt::Every(100), &mut spins, |t, s| {
        println!("  damped, t = {t:4}: energy per spin {:9.6}", damped.energy(s) / n as f64);
    })?;
    assert!((damped.energy(&spins) / n as f64 + 1.5).abs() < 1e-6);

    let pendulum = SphericalPendulum::new(9.81)?;
    let mut y = pendulum.state([0.8, 0.0, -0.6], [0.0, 1.5, 0.0])?;
    let (before, grid) = (pendulum.values(&y), TimeGrid::new([0.0, 60.0], 0.005)?);
    integrate(&pendulum, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
    println!("the spherical pendulum after a minute:");
    for ((what, a), b) in pendulum.invariants().iter().zip(before).zip(pendulum.values(&y)) {
        println!("  {:8} {a:9.6}, drift {:8.1e}", what.name, b - a);
    }
    Ok(())
}
