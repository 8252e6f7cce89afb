//! Flows that conserve eigenvalues: Toda's lattice, Brockett's double bracket and the QR flow.
//!
//! Toda's lattice sorts its momenta, and the double bracket sorts a list of numbers. The QR flow passes through the
//! iterates of the QR algorithm.
//!
//! ```sh
//! cargo run --release --example isospectral
//! ```

use faer::{Mat, Side, mat};
use lieflow::prelude::*;
use lieflow::problems::{IsospectralFlow, toda_lattice};

fn diagonal(l: &Mat<f64>) -> Vec<f64> {
    (0..l.nrows()).map(|i| l[(i, i)]).collect()
}

/// The largest change of an eigenvalue.
fn moved(a: &Mat<f64>, b: &Mat<f64>) -> Result<f64, Box<dyn std::error::Error>> {
    let values = |l: &Mat<f64>| l.self_adjoint_eigenvalues(Side::Lower);
    let (a, b) =
        (values(a).map_err(|e| format!("{e:?}"))?, values(b).map_err(|e| format!("{e:?}"))?);
    Ok(a.iter().zip(&b).fold(0.0, |worst, (a, b)| f64::max(worst, (a - b).abs())))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (cay, grid) = (Rkmk::new(RK4, Cay), TimeGrid::new([0.0, 40.0], 0.05)?);

    let start = toda_lattice(&[-1.0, 0.2, 0.9], &[0.8, -0.1, -0.7])?;
    let toda = IsospectralFlow::toda(3)?;
    let (mut on_group, mut by_entries) = (start.clone(), start.clone());
    integrate(&toda, &cay, &grid, &SaveAt::Ends, &mut on_group, |_, _| {})?;
    integrate(&toda, &Rk(RK4), &grid, &SaveAt::Ends, &mut by_entries, |_, _| {})?;
    let momenta: Vec<_> = diagonal(&on_group).iter().map(|x| -2.0 * x).collect();
    println!("Toda: momenta after the last collision {momenta:.4?}");
    println!("  eigenvalues moved by {:.0e} with a Lie group method", moved(&on_group, &start)?);
    println!(
        "  eigenvalues moved by {:.0e} with Runge–Kutta on the entries",
        moved(&by_entries, &start)?
    );
    assert!(moved(&on_group, &start)? < 1e-13);

    let list = [3.0, 1.0, 4.0, 1.5, 2.0];
    let brockett = IsospectralFlow::double_bracket(&[1.0, 2.0, 3.0, 4.0, 5.0])?;
    let mut l = Mat::from_fn(5, 5, |i, j| if i == j { list[i] } else { 1e-3 });
    integrate(&brockett, &cay, &grid, &SaveAt::Ends, &mut l, |_, _| {})?;
    println!("Brockett: {list:?} sorted is {:.4?}", diagonal(&l));
    assert!(diagonal(&l).is_sorted());

    let start = mat![[4.0, 1.0, 0.5], [1.0, 3.0, 0.2], [0.5, 0.2, 1.0]];
    let (qr, mut l) = (IsospectralFlow::qr(3)?, start.clone());
    integrate(&qr, &cay, &TimeGrid::new([0.0, 1.0], 0.01)?, &SaveAt::Ends, &mut l, |_, _| {})?;
    let factors = start.qr();
    let (q, r) = (factors.compute_Q(), factors.R());
    let q = Mat::from_fn(3, 3, |i, j| q[(i, j)] * r[(j, j)].signum());
    let step = q.transpose() * &start * &q;
    println!(
        "QR: one step of the algorithm, and the flow at t = 1: {:.0e}",
        (&l - &step).norm_l2()
    );
    assert!((&l - &step).norm_l2() < 1e-7);
    Ok(())
}
