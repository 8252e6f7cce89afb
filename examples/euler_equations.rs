//! Euler's equations from a Hamiltonian: an ellipsoid in an ideal fluid on se(3)*, and two coupled bodies on
//! so(3)* × so(3)*.
//!
//! ```sh
//! cargo run --release --example euler_equations
//! ```

use lieflow::groups::Product;
use lieflow::methods::EnergyCasimir;
use lieflow::nalgebra::Vector3;
use lieflow::prelude::*;
use lieflow::problems::{Euler, Kinetic, MeanGradient};

type V = Vector3<f64>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Kirchhoff: H = ½⟨m, J⁻¹m⟩ with the inertia of the body and of the fluid that it moves.
    let inverse = |m: &(V, V), u: &mut (V, V)| {
        u.0 = m.0.component_div(&V::new(1.0, 2.0, 3.0));
        u.1 = m.1.component_div(&V::new(1.5, 1.2, 1.0));
    };
    let body = Euler::new(Se3::<f64>::new(), Kinetic(inverse));
    let start = (V::new(0.3, 0.6, 1.0), V::new(0.7, 0.4, 1.0));
    let grid = TimeGrid::new([0.0, 100.0], 0.05)?;
    println!("an ellipsoid in a fluid, t = 100: drift of the energy, of μ·π");
    let drift =
        |m: &(V, V)| (body.energy(m) - body.energy(&start), m.0.dot(&m.1) - start.0.dot(&start.1));
    let mut m = start;
    integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
    println!("  rkmk4 exp            {:8.1e} {:8.1e}", drift(&m).0, drift(&m).1);
    let mut m = start;
    integrate(&body, &EnergyCasimir::new(Cay), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
    println!("  energy and Casimir   {:8.1e} {:8.1e}", drift(&m).0, drift(&m).1);
    assert!(drift(&m).0.abs() < 1e-11 && drift(&m).1.abs() < 1e-11);

    // With g in the state the same equations give the place of the body in space.
    let both = body.with_group();
    let mut y = (Se3::<f64>::new().identity(), start);
    integrate(&both, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
    println!("  it drifted to {:.2?}", y.0.1.as_slice());

    // H may be any function with a gradient, on any group; here the coupling is not quadratic. Methods that conserve
    // the energy also need a discrete gradient: here the mean of the gradients between two momenta.
    let j = V::new(1.0, 2.0, 3.5);
    let energy = move |m: &(V, V)| {
        0.5 * (m.0.dot(&m.0.component_div(&j)) + m.1.dot(&m.1.component_div(&j)))
            + 0.3 * m.0.dot(&m.1).sin()
    };
    let gradient = move |a: &(V, V), way: Option<(&(V, V), f64)>, xi: &mut (V, V)| {
        let m = way.map_or(*a, |(b, s)| (a.0 + (b.0 - a.0) * s, a.1 + (b.1 - a.1) * s));
        let slope = 0.3 * m.0.dot(&m.1).cos();
        *xi = (m.0.component_div(&j) + slope * m.1, m.1.component_div(&j) + slope * m.0);
    };
    let pair = Euler::new(Product(So3::<f64>::new(), So3::new()), MeanGradient(energy, gradient));
    let start = (V::new(1.0, 0.2, -0.4), V::new(0.3, -0.8, 0.5));
    println!("two coupled bodies: drift of the energy, of the two lengths");
    let drift = |m: &(V, V)| {
        let lengths = (m.0.norm() - start.0.norm(), m.1.norm() - start.1.norm());
        (pair.energy(m) - pair.energy(&start), lengths.0, lengths.1)
    };
    let mut m = start;
    integrate(&pair, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
    let (h, one, two) = drift(&m);
    println!("  rkmk4 exp            {h:8.1e} {one:8.1e} {two:8.1e}");
    assert!(one.abs() < 1e-12 && two.abs() < 1e-12);
    let mut m = start;
    integrate(&pair, &EnergyCasimir::new(Cay), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
    let (h, one, two) = drift(&m);
    println!("  energy and Casimir   {h:8.1e} {one:8.1e} {two:8.1e}");
    assert!(h.abs() < 1e-12 && one.abs() < 1e-12 && two.abs() < 1e-12);
    Ok(())
}
