//! A controller in its own loop: it reads the state twenty times a second and sets the torque for the next interval.
//!
//! The state of the satellite is on SO(3) × T(3): its attitude and its momentum in space. The torque is constant between
//! two calls of the controller, so it does not jump within a step. The driver chooses the steps.
//!
//! ```sh
//! cargo run --release --example control_loop
//! ```

use std::cell::Cell;

use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::prelude::*;
use lieflow::problems::{BodyMotion, BodyTorque, TorqueBody};

type V = Vector3<f64>;

/// The axis of the rotation g, times the sine of its angle: half of the skew part of g.
fn turned_away(g: &Matrix3<f64>) -> V {
    0.5 * V::new(g[(2, 1)] - g[(1, 2)], g[(0, 2)] - g[(2, 0)], g[(1, 0)] - g[(0, 1)])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let inertia = V::new(1.0, 2.0, 3.0);
    let torque = Cell::new(V::zeros());
    let satellite = TorqueBody::new(inertia.into(), BodyTorque(|_: &BodyMotion| torque.get()))?;
    let method = Rkmk::new(DOPRI5, Exp);
    // The satellite is turned by 2 radian about an oblique axis, and tumbles.
    let attitude = *lieflow::nalgebra::Rotation3::new(V::new(1.2, -1.2, 1.0)).matrix();
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
        // A reaction wheel gives at most 0.5 about each axis.
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
