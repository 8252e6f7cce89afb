//! The free rigid body in three models: by its momentum on so(3)*, its attitude on SO(3), and its quaternion.
//!
//! Compares every coordinate map with the exact solution, and counts the operations of a step.
//!
//! ```sh
//! cargo run --release --example rigid_body
//! ```

use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Exp};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use lieflow::problems::{Exact, PointOf, RigidBody, RigidBodyAttitude, RigidBodyQuaternion};
use lieflow::scalar::{Counted, Real};
use lieflow::{
    CoordinateMap, LieGroup, Problem, RunError, SaveAt, TimeGrid, groups::So3, integrate,
};

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
/// The momentum in the body and in space: at the start the axes of both coincide.
const MOMENTUM: [f64; 3] = [0.2, 0.0, 3.0];

/// The state at the end of `grid`, by RKMK4 in the coordinates `psi`.
fn run<P: Problem>(
    problem: &P,
    psi: impl CoordinateMap<P::Group>,
    grid: &TimeGrid,
    mut y: PointOf<P>,
) -> Result<PointOf<P>, RunError> {
    integrate(problem, &Rkmk::new(RK4, psi), grid, &SaveAt::Ends, &mut y, |_, _| {})?;
    Ok(y)
}

/// Counts the arithmetic operations in one step of the momentum, and of the attitude.
fn operations(psi: impl CoordinateMap<So3<Counted>> + Copy) -> Result<[u64; 2], lieflow::Error> {
    let one_step = TimeGrid::new([0.0, 0.05], 0.05)?;
    let momentum = RigidBody::<Counted>::new(INERTIA)?;
    let attitude = RigidBodyAttitude::<Counted>::new(INERTIA, MOMENTUM)?;
    let m = Vector3::from(MOMENTUM.map(Counted::lit));
    let g = So3::<Counted>::new().identity();
    let (_, of_m) = Counted::count(|| run(&momentum, psi, &one_step, m));
    let (_, of_g) = Counted::count(|| run(&attitude, psi, &one_step, g));
    Ok([of_m.total(), of_g.total()])
}

fn row<Psi>(psi: Psi) -> Result<(), Box<dyn std::error::Error>>
where
    Psi: CoordinateMap<So3> + CoordinateMap<So3<Counted>> + Copy,
{
    let grid = TimeGrid::new([0.0, 20.0], 0.02)?;
    let start = Vector3::from(MOMENTUM);
    let body = RigidBody::new(INERTIA)?;
    let m = run(&body, psi, &grid, start)?;
    let attitude = RigidBodyAttitude::new(INERTIA, MOMENTUM)?;
    let g = run(&attitude, psi, &grid, Matrix3::identity())?;

    let (exact_m, exact_g) = Exact::new(INERTIA, MOMENTUM, Matrix3::identity())?.state(20.0)?;
    let (error_m, error_g) = ((m - exact_m).norm(), (g - exact_g).norm());
    let energy = body.energy(&m) - body.energy(&start);
    let length = m.norm() - start.norm();
    let defect = attitude.group().defect(&g);
    let [of_m, of_g] = operations(psi)?;
    let name = CoordinateMap::<So3>::name(&psi);
    println!(
        "{name:8} {error_m:9.1e} {energy:9.1e} {length:9.1e} {of_m:6}   {error_g:9.1e} {defect:9.1e} {of_g:6}"
    );

    assert!(error_m < 1e-5 && error_g < 1e-5, "the error of order 4 at this step");
    assert!(energy.abs() < 1e-6, "the energy drifts slowly");
    assert!(length.abs() < 1e-12, "|m| is a Casimir: conserved to rounding");
    assert!(defect < 1e-12, "the attitude stays on SO(3) to rounding");
    assert!(of_m < of_g, "the momentum alone does not pay for the attitude");
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("1000 steps of RKMK4, h = 0.02; ops: operations in one step");
    println!("         ------ momentum on so(3)* ------------   ---- attitude on SO(3) ----");
    println!("map          error    energy       |m|    ops       error   gᵀg − 𝟙    ops");
    row(Exp)?;
    row(Cay)?;
    row(CCSK123)?;
    row(CCSK321)?;
    row(CCSK)?;

    // Four numbers instead of nine. The maps exp and cay are available.
    let grid = TimeGrid::new([0.0, 20.0], 0.02)?;
    let body = RigidBodyQuaternion::new(INERTIA, MOMENTUM)?;
    let q = run(&body, Cay, &grid, UnitQuaternion::identity())?;
    let (_, exact) = Exact::new(INERTIA, MOMENTUM, Matrix3::identity())?.state(20.0)?;
    let error = (q.to_rotation_matrix().matrix() - exact).norm();
    let off = (q.coords.norm() - 1.0).abs();
    println!("by its quaternion, cay: error {error:.1e}, |q| − 1 {off:.1e}");
    assert!(error < 1e-5 && off < 1e-14);
    Ok(())
}
