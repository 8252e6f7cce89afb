//! Manakov's rigid body in ℝ⁵: the momentum on so(5)*, whose eigenvalues every step conserves.
//!
//! At n = 3 the results are compared with the closed formulas on so(3).
//!
//! ```sh
//! cargo run --release --example so_n
//! ```

use faer::Mat;
use lieflow::CoordinateMap;
use lieflow::groups::{hat, vee};
use lieflow::prelude::*;
use lieflow::problems::{PointOf, RigidBody, RigidBodyN};
use nalgebra::{Matrix3, Vector3};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// The momentum at t = 2, by RKMK4 in so many steps.
fn at_two<P: Problem>(
    body: &P,
    psi: impl CoordinateMap<P::Group>,
    steps: u64,
    mut m: PointOf<P>,
) -> Outcome<PointOf<P>> {
    let grid = TimeGrid::with_steps([0.0, 2.0], steps)?;
    integrate(body, &Rkmk::new(RK4, psi), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
    Ok(m)
}

/// tr m² and tr m⁴, which determine the eigenvalues of m ∈ so(5).
fn casimirs(m: &Mat<f64>) -> [f64; 2] {
    let m2 = m * m;
    let trace = |x: &Mat<f64>| x.diagonal().column_vector().iter().sum::<f64>();
    [trace(&m2), trace(&(&m2 * &m2))]
}

fn five<Psi: CoordinateMap<lieflow::groups::MatrixGroup> + Copy>(psi: Psi) -> Outcome<()> {
    let body = RigidBodyN::manakov(&[0.5, 1.0, 1.5, 2.0, 3.0])?;
    let start = Mat::from_fn(5, 5, |i, j| 2.0 * (i as f64 - j as f64) / (1 + i + j) as f64);
    let reference = at_two(&body, psi, 1280, start.clone())?;

    println!("{}: steps, error, observed order, change of tr m², tr m⁴, energy", psi.name());
    let mut coarser = None;
    for steps in [20, 40, 80] {
        let m = at_two(&body, psi, steps, start.clone())?;
        let error = (&m - &reference).norm_l2();
        let order = coarser.map_or(f64::NAN, |coarser: f64| (coarser / error).log2());
        let (now, then) = (casimirs(&m), casimirs(&start));
        let change = [0, 1].map(|i| (now[i] - then[i]).abs() / then[i].abs());
        let energy = body.energy(&m) - body.energy(&start);
        println!(
            "{steps:6} {error:10.2e} {order:6.2} {:10.1e} {:9.1e} {energy:10.1e}",
            change[0], change[1]
        );
        assert!(change[0].max(change[1]) < 1e-13, "the eigenvalues are conserved to rounding");
        assert!(coarser.is_none() || (order - 4.0).abs() < 0.3, "order 4");
        coarser = Some(error);
    }
    Ok(())
}

/// The body in ℝ³ through matrices of any size, and through the closed formulas.
fn three() -> Outcome<()> {
    let (inertia, m) = ([1.0, 2.0, 3.0], Vector3::new(0.2, 0.5, 3.0));
    let closed = at_two(&RigidBody::new(inertia)?, Exp, 40, m)?;
    let as_matrix = hat(&m);
    let start = Mat::from_fn(3, 3, |i, j| as_matrix[(i, j)]);
    let general = at_two(&RigidBodyN::from_principal(inertia)?, Exp, 40, start)?;
    let gap = (closed - vee(&Matrix3::from_fn(|i, j| general[(i, j)]))).norm();
    println!("n = 3: the general code and the closed formulas differ by {gap:.1e} after 40 steps");
    assert!(gap < 1e-13);
    Ok(())
}

fn main() -> Outcome<()> {
    five(Exp)?;
    five(Cay)?;
    three()
}
