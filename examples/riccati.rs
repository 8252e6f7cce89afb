//! Riccati equations by Sp(2m) on Lagrangian subspaces: past poles, and the regulator of a cart with a pendulum.
//!
//! ```sh
//! cargo run --release --example riccati
//! ```

use lieflow::actions::Lagrangian;
use lieflow::faer::{Mat, mat};
use lieflow::groups::AlgebraMatrix;
use lieflow::methods::magnus::Magnus6;
use lieflow::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Ṗ = 1 + P²: P = tan t, and steps pass its poles at π/2 and 3π/2.
    let field = |_: f64, v: &mut AlgebraMatrix| (v[(1, 0)], v[(0, 1)]) = (1.0, -1.0);
    let tangent = Flow::of_time(MatrixGroup::sp(2)?, Lagrangian, field);
    let mut p = mat![[0.0]];
    let grid = TimeGrid::new([0.0, 6.0], 0.1)?;
    integrate(&tangent, &Magnus6, &grid, &SaveAt::Ends, &mut p, |_, _| {})?;
    println!("P' = 1 + P² at t = 6, past two poles: {:.12}, tan 6 = {:.12}", p[(0, 0)], 6f64.tan());
    assert!((p[(0, 0)] - 6f64.tan()).abs() < 1e-12);

    // The regulator of ẋ = Ax + Bu with the cost ∫ xᵀQx + uᵀu. Solve −Ṗ = AᵀP + PA − PBBᵀP + Q backward from P(T) = 0:
    // P tends to the solution of the algebraic equation. Here: a cart with an upright pendulum.
    let a = mat![
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 2.0, 0.0]
    ];
    let b = mat![[0.0], [1.0], [0.0], [-1.0]];
    let q = Mat::<f64>::identity(4, 4);
    let bb = &b * b.transpose();
    // Ṗ = c − aᵀP − Pa − PbP for v = [a b; c −aᵀ]; t is the time before the end.
    let field = {
        let (a, bb, q) = (a.clone(), bb.clone(), q.clone());
        move |_: f64, v: &mut AlgebraMatrix| {
            for j in 0..4 {
                for i in 0..4 {
                    (v[(i, j)], v[(i, j + 4)]) = (-a[(i, j)], bb[(i, j)]);
                    (v[(i + 4, j)], v[(i + 4, j + 4)]) = (q[(i, j)], a[(j, i)]);
                }
            }
        }
    };
    let regulator = Flow::of_time(MatrixGroup::sp(8)?, Lagrangian, field);
    let mut p = Mat::zeros(4, 4);
    let grid = TimeGrid::new([0.0, 40.0], 0.1)?;
    integrate(&regulator, &Magnus6, &grid, &SaveAt::Ends, &mut p, |_, _| {})?;
    let residual = a.transpose() * &p + &p * &a - &p * &bb * &p + &q;
    let gain = b.transpose() * &p;
    let closed = &a - &b * &gain;
    let slowest = closed.eigenvalues().map_err(|e| format!("{e:?}"))?;
    let slowest = slowest.iter().map(|z| z.re).fold(f64::NEG_INFINITY, f64::max);
    println!("a regulator: residual of the algebraic equation {:.0e}", residual.norm_max());
    println!("  the closed loop decays with the rate {:.4} or faster", -slowest);
    assert!(residual.norm_max() < 1e-9 * p.norm_max() && slowest < 0.0);
    let skew = (&p - p.transpose()).norm_max();
    assert!(skew == 0.0, "P is symmetric, bit for bit");
    Ok(())
}
