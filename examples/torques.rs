//! A rigid body under your own torques: a damped satellite, and a control law for the attitude.
//!
//! The satellite loses energy and ends in rotation about its axis of largest inertia. The control law turns a body back
//! to its target.
//!
//! ```sh
//! cargo run --release --example torques
//! ```

use lieflow::groups::{LieGroup, So3, vee};
use lieflow::maps::Exp;
use lieflow::methods::{Rkmk, tableau::DOPRI5};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::problems::{BodyMotion, BodyTorque, SpaceTorque, Torque, TorqueBody, inertia};
use lieflow::{SaveAt, TimeGrid, integrate};

type State = (Matrix3<f64>, Vector3<f64>);

/// The state after the time t.
fn run<T: Torque>(
    body: &TorqueBody<T>,
    mut y: State,
    t: f64,
) -> Result<State, Box<dyn std::error::Error>> {
    let (method, grid) = (Rkmk::new(DOPRI5, Exp), TimeGrid::new([0.0, t], 0.02)?);
    integrate(body, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
    Ok(y)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let moments = inertia::cuboid(1.0, [1.0, 2.0, 3.0])?;
    let omega = |(g, m): &State| {
        let m = g.tr_mul(m);
        Vector3::from_fn(|i, _| m[i] / moments[i])
    };
    // It starts about the axis of least inertia. Without damping it would stay there.
    let start: State = (Matrix3::identity(), Vector3::new(0.01, 0.02, moments[2] * 2.0));

    // Slosh: a torque in the body that removes energy and leaves |m| constant.
    let slosh = BodyTorque(|at: &BodyMotion| {
        let m = at.attitude.tr_mul(&at.momentum_space);
        let along = at.omega_body.dot(&m) / m.norm_squared();
        -0.05 * (at.omega_body - along * m)
    });
    let end = run(&TorqueBody::new(moments, slosh)?, start, 300.0)?;
    let spin = omega(&end);
    println!(
        "a satellite with sloshing fuel ends with the angular velocity {:.3?} in the body",
        spin.as_slice()
    );
    println!("  |m| = {:.6}, at the start {:.6}", end.1.norm(), start.1.norm());
    assert!(spin[0].abs() > 10.0 * spin[1].abs().max(spin[2].abs()), "about the largest moment");
    assert!((end.1.norm() / start.1.norm() - 1.0).abs() < 1e-6);

    // A control law for the attitude error and the angular velocity; then the same with a steady wind in space.
    let law = BodyTorque(|at: &BodyMotion| {
        let away = vee(&((at.attitude - at.attitude.transpose()) * 0.5));
        -3.0 * away - 2.0 * at.omega_body
    });
    let wind = SpaceTorque(|_: &BodyMotion| Vector3::new(0.0, 0.3, 0.0));
    let away = lieflow::so3::exp(&Vector3::new(0.4, -1.9, 0.7))?;
    let calm = run(&TorqueBody::new(moments, law)?, (away, Vector3::zeros()), 40.0)?;
    let windy = run(&TorqueBody::new(moments, (law, wind))?, (away, Vector3::zeros()), 40.0)?;
    let angle = |g: &Matrix3<f64>| lieflow::so3::log(g).map(|u| u.norm());
    println!("a control law: {:.0e} radian from the target in calm air", angle(&calm.0)?);
    println!("  and {:.4} radian in wind", angle(&windy.0)?);
    assert!(angle(&calm.0)? < 1e-6);
    // 3 sin θ = 0.3.
    assert!((angle(&windy.0)? - 0.1f64.asin()).abs() < 1e-5);
    assert!(So3::new().defect(&windy.0) < 1e-13);
    Ok(())
}
