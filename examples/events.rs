//! Events: the flips of a free body until the third, an impulse at an event, and the period of a pendulum.
//!
//! ```sh
//! cargo run --release --example events
//! ```

use lieflow::nalgebra::Vector3;
use lieflow::prelude::*;
use lieflow::problems::{RigidBody, SphericalPendulum};

type V = Vector3<f64>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let method = Rkmk::new(DOPRI5, Exp);

    // A body that rotates about its middle axis flips again and again (Dzhanibekov). The third flip ends the run.
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
    let start = V::new(0.01, 3.0, 0.01);
    let run = Solve::new(&body, &method, [0.0, f64::INFINITY])
        .tolerances(1e-11, 1e-13)
        .event(Event::new("flip", |_, m: &V| m.y).stop_after(3))
        .watch_invariants()
        .run(start)?;
    println!("flips of a free body, {} steps", run.stats.accepted);
    for flip in &run.events {
        println!("  t = {:12.9}  m = {:9.6?}", flip.t, flip.y.data.0[0]);
    }
    for drift in &run.drift {
        println!("  {} moved by {:.1e}", drift.name, drift.largest);
    }

    // The same body, but at each flip a thruster removes a tenth of the momentum.
    let brake = Event::new("brake", |_, m: &V| m.y).change(|_, m| *m *= 0.9);
    let braked =
        Solve::new(&body, &method, [0.0, 90.0]).tolerances(1e-11, 1e-13).event(brake).run(start)?;
    println!("with an impulse at each of {} flips", braked.events.len());
    for pair in braked.events.windows(2) {
        println!("  {:9.6} later, |m| = {:.6}", pair[1].t - pair[0].t, pair[1].y.norm());
    }

    // A pendulum starts at a right angle. Its period is the time from one lowest point to the second after it.
    let pendulum = SphericalPendulum::new(1.0)?;
    let run = Solve::new(&pendulum, &method, [0.0, f64::INFINITY])
        .tolerances(1e-12, 1e-12)
        .event(Event::new("lowest", |_, (_, q): &(V, V)| q.y).falling().stop_after(2))
        .run(pendulum.state([0.0, 1.0, 0.0], [0.0; 3])?)?;
    // 4 K(1/√2) = Γ(1/4)²/√π.
    let exact = 7.416_298_709_205_487;
    let period = run.events[1].t - run.events[0].t;
    println!("period of a pendulum: {period:.12}, off by {:.1e}", (period - exact).abs());
    assert!((period - exact).abs() < 1e-9 && braked.events.len() > 3);
    Ok(())
}
