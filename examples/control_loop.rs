//! A controller that owns the loop: it reads the state twenty times a second, and sets the torque until the next time.
//!
//! The satellite is on SO(3) × T(3), its attitude and its momentum in space. Between two calls of the controller the torque
//! is constant, so that no step sees a jump; the driver chooses the steps between them.
//!
//! ```sh
//! cargo run --release --example control_loop
//! ```

use std::cell::Cell;

use lieflow::prelude::*;
use lieflow::problems::{BodyMotion, BodyTorque, TorqueBody};
use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;

/// Where g would turn, times its sine: half of the skew part of g.
fn turned_away(g: &Matrix3<f64>) -> V {
    0.5 * V::new(g[(2, 1)] - g[(1, 2)], g[(0, 2)] - g[(2, 0)], g[(1, 0)] - g[(0, 1)])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let inertia = V::new(1.0, 2.0, 3.0);
    let torque = Cell::new(V::zeros());
    let satellite = TorqueBody::new(inertia.into(), BodyTorque(|_: &BodyMotion| torque.get()))?;
    let method = Rkmk::new(DOPRI5, Exp);
    // Turned by 2 about an oblique axis, and tumbling.
    let attitude = *nalgebra::Rotation3::new(V::new(1.2, -1.2, 1.0)).matrix();
    let start = (attitude, attitude * V::new(0.3, 0.8, -0.5));
    let mut run = Solve::new(&satellite, &method, [0.0, f64::INFINITY])
        .tolerances(1e-9, 1e-9)
        .integrator(start)?;

    for call in 0..600 {
        let (g, m) = run.y();
        let omega = (g.transpose() * m).component_div(&inertia);
        if call % 100 == 0 {
            println!(
                "t = {:4.1}: off by {:.6}, ω = {:.6}",
                run.t(),
                turned_away(g).norm(),
                omega.norm()
            );
        }
        // What a reaction wheel can do, at most 0.5 on each axis.
        let wanted = -turned_away(g) - 2.0 * omega;
        torque.set(wanted.map(|x| x.clamp(-0.5, 0.5)));
        run.advance_to(0.05 * f64::from(call + 1))?;
    }
    let (g, m) = run.y();
    let stats = run.stats();
    println!(
        "{} steps, {} rejected, {:?} evaluations",
        stats.accepted, stats.rejected, stats.evaluations
    );
    assert!(turned_away(g).norm() < 1e-3 && m.norm() < 1e-2);
    Ok(())
}
