//! Ideal fluids: vortices on a sphere and a shear layer on a torus, with the invariants of each run.
//!
//! ```sh
//! cargo run --release --example fluid           # invariants
//! cargo run --release --example fluid -- DIR    # also writes pictures of the vorticity to DIR
//! ```

use std::f64::consts::PI;
use std::path::Path;

use lieflow::faer::Mat;
use lieflow::groups::ComplexMatrix;
use lieflow::methods::FluidMidpoint;
use lieflow::problems::{Invariants, Surface, Vortex, Zeitlin};
use lieflow::{SaveAt, TimeGrid, integrate};

type Anything = Box<dyn std::error::Error>;

fn main() -> Result<(), Anything> {
    let dir = std::env::args().nth(1);
    let picture = |name: &str, grid: Mat<f64>| match &dir {
        Some(dir) => save(&Path::new(dir).join(name), &grid),
        None => Ok(()),
    };

    // Five vortices. One of them rotates in the other direction.
    let sphere = Zeitlin::sphere(48)?;
    let vortices = [(0.6, -2.0), (0.7, -1.3), (-0.4, 0.5), (0.1, 1.2), (-0.8, 2.4)];
    let vortices = vortices.map(|(latitude, longitude)| Vortex {
        latitude,
        longitude,
        circulation: if longitude > 2.0 { -2.0 } else { 1.0 },
        width: 0.2,
    });
    let mut w = sphere.vortices(&vortices)?;
    picture("sphere-start.ppm", sphere.on_grid(&w, 180, 360))?;
    println!("five vortices on a sphere, N = 48, to t = 40");
    report(&sphere, FluidMidpoint::isospectral(), &mut w.clone(), 40.0, 0.02)?;
    report(&sphere, FluidMidpoint::energy(), &mut w, 40.0, 0.02)?;
    picture("sphere.ppm", sphere.on_grid(&w, 180, 360))?;

    // A jet along x amplifies a small disturbance: the instability of Kelvin and Helmholtz.
    let torus = Zeitlin::torus(49)?;
    let jet = |k: i32| ([0, k], [0.0, 0.6 * (-0.02 * f64::from(k * k)).exp()]);
    let mut modes: Vec<_> = (1..8).map(jet).collect();
    modes.push(([1, 0], [0.02, 0.0]));
    let mut w = torus.from_modes(&modes)?;
    println!("a jet on a torus, N = 49, to t = 20");
    report(&torus, FluidMidpoint::energy(), &mut w, 20.0, 0.02)?;
    picture("torus.ppm", torus.on_grid(&w, 200, 200))
}

/// Run, and print how far each invariant has moved.
fn report<S: Surface>(
    fluid: &Zeitlin<S>,
    method: FluidMidpoint,
    w: &mut ComplexMatrix,
    t: f64,
    h: f64,
) -> Result<(), Anything> {
    let (before, start) = (fluid.values(w), w.clone());
    integrate(fluid, &method, &TimeGrid::new([0.0, t], h)?, &SaveAt::Ends, w, |_, _| {})?;
    println!("  the midpoint rule {:?}:", method.rule());
    for ((what, a), b) in fluid.invariants().iter().zip(before).zip(fluid.values(w)) {
        println!("    {:18} {a:12.9}, moved by {:8.1e}", what.name, b - a);
    }
    let levels = (fluid.spectrum(&start)?, fluid.spectrum(w)?);
    let moved = levels.0.iter().zip(&levels.1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("    the values of the vorticity moved by at most {moved:.1e}");
    assert!(moved < 1e-12);
    Ok(())
}

/// The values as a picture in blue, white and red.
fn save(path: &Path, grid: &Mat<f64>) -> Result<(), Anything> {
    let largest = grid.norm_max();
    let mut bytes = format!("P6 {} {} 255\n", grid.ncols(), grid.nrows()).into_bytes();
    for i in 0..grid.nrows() {
        for j in 0..grid.ncols() {
            let x = (0.5 * PI * grid[(i, j)] / largest).sin();
            let pale = (255.0 * (1.0 - x.abs())) as u8;
            bytes.extend(if x > 0.0 { [255, pale, pale] } else { [pale, pale, 255] });
        }
    }
    Ok(std::fs::write(path, bytes)?)
}
