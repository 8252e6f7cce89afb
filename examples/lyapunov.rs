//! Lyapunov exponents of your own vector field, by continuous QR on SO(n): Lorenz's attractor.
//!
//! ```sh
//! cargo run --release --example lyapunov
//! ```

use faer::{Mat, mat};
use lieflow::prelude::*;
use lieflow::problems::Lyapunov;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (sigma, rho, beta) = (10.0, 28.0, 8.0 / 3.0);
    let field = |_: f64, u: &Mat<f64>, du: &mut Mat<f64>, jacobian: &mut Mat<f64>| {
        let (x, y, z) = (u[(0, 0)], u[(1, 0)], u[(2, 0)]);
        du.copy_from(mat![[sigma * (y - x)], [x * (rho - z) - y], [x * y - beta * z]]);
        jacobian.copy_from(mat![[-sigma, sigma, 0.0], [rho - z, -1.0, -x], [y, x, -beta]]);
    };
    let lorenz = Lyapunov::new(3, field)?;
    let mut y = lorenz.state(&[1.0, 1.0, 20.0])?;
    let grid = TimeGrid::new([0.0, 400.0], 0.01)?;
    let method = Rkmk::new(RK4, Cay);
    integrate(&lorenz, &method, &grid, &SaveAt::Every(10_000), &mut y, |t, y| {
        if t > 0.0 {
            println!("t = {t:3}: {:8.4?}", lorenz.exponents(t, y));
        }
    })?;
    let sum: f64 = lorenz.exponents(400.0, &y).iter().sum();
    println!("their sum {sum:.10}, −(σ + 1 + β) = {:.10}", -(sigma + 1.0 + beta));
    assert!((sum + sigma + 1.0 + beta).abs() < 1e-9);
    Ok(())
}
