//! Stiefel and Grassmann manifolds, and the Lorentz group.
//!
//! Oja's flow finds the leading eigenvectors, a flow of subspaces finds their span. A charged particle in SO(3,1) stays
//! on its mass shell.
//!
//! ```sh
//! cargo run --release --example stiefel_and_lorentz
//! ```

use faer::{Mat, Side};
use lieflow::prelude::*;
use lieflow::problems::{ChargedParticle, Invariants, Oja, SubspaceFlow};
use nalgebra::Vector3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Two of six eigenvectors of a covariance matrix: those of the largest eigenvalues.
    let spread = |i: usize, j: usize| (1.0 + (i as f64 - j as f64).abs()).recip();
    let a = Mat::from_fn(6, 6, spread);
    let (oja, mut x) = (Oja::new(a.clone(), 2)?, Mat::zeros(6, 2));
    (x[(0, 0)], x[(1, 1)]) = (1.0, 1.0);
    let grid = TimeGrid::new([0.0, 60.0], 0.1)?;
    integrate(&oja, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut x, |_, _| {})?;
    let values = a.self_adjoint_eigenvalues(Side::Lower).map_err(|e| format!("{e:?}"))?;
    let off = (x.transpose() * &x - Mat::<f64>::identity(2, 2)).norm_l2();
    println!("Oja: tr XᵀAX = {:.10}, λ₅ + λ₆ = {:.10}", oja.trace(&x), values[4] + values[5]);
    println!("  ‖XᵀX − 𝟙‖ = {off:.0e}");
    assert!((oja.trace(&x) - values[4] - values[5]).abs() < 1e-10 && off < 1e-13);

    // The span of the same vectors, as a projector.
    let subspaces = SubspaceFlow::new(a)?;
    let mut p = subspaces.span(&Mat::from_fn(6, 2, |i, j| f64::from(u8::from(i == j))))?;
    integrate(&subspaces, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut p, |_, _| {})?;
    let (gap, off) = ((&x * x.transpose() - &p).norm_l2(), (&p * &p - &p).norm_l2());
    println!("Grassmann: ‖P − XXᵀ‖ = {gap:.0e}, ‖P² − P‖ = {off:.0e}");
    assert!(gap < 1e-6 && off < 1e-13);

    // A particle in a magnetic field and an electric wave, in proper time.
    let field = |tau: f64, _: &Mat<f64>| {
        (Vector3::new(0.3 * tau.cos(), 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0))
    };
    let particle = ChargedParticle::new(1.0, field)?;
    let start = particle.four_velocity([0.6, 0.0, 0.3])?;
    let grid = TimeGrid::new([0.0, 50.0], 0.1)?;
    let (mut u, mut w) = (start.clone(), start);
    integrate(&particle, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut u, |_, _| {})?;
    integrate(&particle, &Rk(RK4), &grid, &SaveAt::Ends, &mut w, |_, _| {})?;
    // The group is not compact: rounding errors are of size εγ².
    let off = |u: &Mat<f64>| (particle.values(u)[0] + 1.0) / u[(3, 0)].powi(2);
    println!("a charged particle at τ = 50: γ = {:.6}", u[(3, 0)]);
    println!("  (u·Mu + 1)/γ² = {:.0e} on the group, {:.0e} by the entries", off(&u), off(&w));
    assert!(off(&u).abs() < 1e-13 && off(&w).abs() > 1e-8);
    Ok(())
}
