//! Heavy tops: Lagrange's, Kovalevskaya's and a general one, with the invariants of each.
//!
//! Then the general top again, as a rigid body under the torque of gravity.
//!
//! ```sh
//! cargo run --release --example heavy_top
//! ```

use lieflow::methods::tableau::DOPRI5;
use lieflow::prelude::*;
use lieflow::problems::{BodyMotion, HeavyTop, Invariants, Origin, SpaceTorque, TorqueBody};
use nalgebra::{Matrix3, Vector3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let method = Rkmk::new(DOPRI5, Exp);
    let grid = TimeGrid::new([0.0, 50.0], 0.02)?;
    let start = (Vector3::new(0.4, -0.3, 1.5), Vector3::new(0.48, 0.6, 0.64));
    let (inertia, weight) = ([1.0, 2.0, 2.5], [0.3, -0.2, 1.0]);
    for (name, top) in [
        ("Lagrange", HeavyTop::<f64>::lagrange(1.0, 0.6, 1.3)?),
        ("Kovalevskaya", HeavyTop::kovalevskaya(0.5, 1.1)?),
        ("general", HeavyTop::new(inertia, weight)?),
    ] {
        let (top, mut y) = (top.problem(), start);
        let before = top.values(&y);
        integrate(&top, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
        println!("{name}: the vertical in the body is {:.4?}", y.1.as_slice());
        for ((what, a), b) in top.invariants().iter().zip(before).zip(top.values(&y)) {
            let by = if what.origin == Origin::Action { "Lie group methods" } else { "the motion" };
            println!("  {:24} conserved by {by:17} {a:9.6}, drift {:8.1e}", what.name, b - a);
        }
    }

    // The general top again, with its attitude and the torque of gravity in space.
    let w = Vector3::from(weight);
    let gravity = SpaceTorque(move |at: &BodyMotion| Vector3::z().cross(&(at.attitude * w)));
    let body = TorqueBody::new(inertia, gravity)?;
    let top = HeavyTop::new(inertia, weight)?.problem();
    let (mut y, mut seen) = (body.state(Matrix3::identity(), [0.4, -0.1, 0.6])?, Vec::new());
    let mut short = (y.1, Vector3::z());
    let grid = TimeGrid::new([0.0, 5.0], 0.01)?;
    integrate(&body, &method, &grid, &SaveAt::Ends, &mut y, |t, _| seen.push(t))?;
    integrate(&top, &method, &grid, &SaveAt::Ends, &mut short, |_, _| {})?;
    let gap = (y.0.tr_mul(&Vector3::z()) - short.1).norm();
    println!("as a body under a torque: the verticals differ by {gap:.0e} at t = {:?}", seen[1]);
    assert!(gap < 1e-9);
    Ok(())
}
