//! Many tumbling rigid bodies, each with its own inertia, in SIMD lanes on two threads.
//!
//! Prints the energy, the momenta in space, and the mean direction of the third axes.

use lieflow::ensemble::{Ensemble, EnsembleMethod};
use lieflow::nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const BODIES: usize = 100_000;

fn main() -> Result<(), lieflow::Error> {
    let mut rng = Pcg64::seed_from_u64(1);
    let mut triple = |low: f64, high: f64| [(); 3].map(|()| rng.random_range(low..high));
    let inertia: Vec<_> = (0..BODIES).map(|_| triple(2.0, 3.0)).collect();
    let momentum: Vec<_> = (0..BODIES).map(|_| triple(-1.0, 1.0)).collect();
    let attitude = vec![Matrix3::identity(); BODIES];

    let mut cloud = Ensemble::new(&inertia, &momentum)?.with_attitudes(&attitude)?;
    let energy = |cloud: &Ensemble| (0..cloud.len()).filter_map(|i| cloud.energy(i)).sum::<f64>();
    let start = energy(&cloud);
    for k in 1..=4 {
        cloud.advance(EnsembleMethod::Rkmk4Cay, 0.05, 100, 2)?;
        let axes = (0..BODIES).filter_map(|i| cloud.attitude(i).map(|g| g.column(2).into_owned()));
        let mean = axes.sum::<Vector3<f64>>() / BODIES as f64;
        let drift = energy(&cloud) / start - 1.0;
        println!("t = {:2}: energy {drift:+.1e}, mean third axis {:.3}", 5 * k, mean.norm());
    }
    // At the start g = 𝟙: the momentum in space equals that in the body.
    let moved = |i: usize| {
        let in_space = cloud.attitude(i).zip(cloud.momentum(i)).map(|(g, m)| g * m);
        in_space.map_or(f64::NAN, |m| (m - Vector3::from(momentum[i])).norm())
    };
    println!("momenta in space moved by {:.1e}", (0..BODIES).map(moved).fold(0.0, f64::max));
    Ok(())
}
