//! Oja's flow: the span of X follows exp(tA)X₀, and ends on the leading eigenvectors.

use super::*;
use faer::{Mat, Side, mat};
use lieflow::problems::Oja;

fn a() -> Mat<f64> {
    mat![[2.0, 0.5, 0.1, 0.0], [0.5, 1.0, -0.3, 0.2], [0.1, -0.3, 0.2, 0.4], [0.0, 0.2, 0.4, -1.0],]
}

/// Two orthonormal columns.
fn start() -> Mat<f64> {
    mat![[0.6, 0.0], [0.0, 1.0], [0.8, 0.0], [0.0, 0.0]]
}

/// The orthogonal projector on the span of x.
fn projector(x: &Mat<f64>) -> Mat<f64> {
    let q = x.qr().compute_thin_Q();
    &q * q.transpose()
}

#[test]
fn the_span_in_closed_form() {
    let flow_a = Oja::new(a(), 2).unwrap();
    let eigen = a().self_adjoint_eigen(Side::Lower).unwrap();
    let (u, d) = (eigen.U(), eigen.S().column_vector());
    let grown = Mat::from_fn(4, 4, |i, j| u[(i, j)] * (1.5 * d[j]).exp()) * u.transpose() * start();
    let exact = projector(&grown);
    let far = [20, 40, 80].map(|n| {
        let x = flow(&flow_a, 1.5, n, &start());
        (&x * x.transpose() - &exact).norm_l2()
    });
    assert!(far[2] < 1e-7 && ((far[1] / far[2]).log2() - 4.0).abs() < 0.3, "{far:?}");
}

#[test]
fn it_stays_on_the_stiefel_manifold_and_finds_the_eigenvalues() {
    let flow_a = Oja::new(a(), 2).unwrap();
    has_order_4(&flow_a, &start(), 1.0, 12);
    keeps_its_invariants(&flow_a, &start(), 10.0, 1000, 0.0);
    let x = flow(&flow_a, 60.0, 2000, &start());
    assert!((x.transpose() * &x - Mat::<f64>::identity(2, 2)).norm_l2() < 1e-13);
    let values = a().self_adjoint_eigenvalues(Side::Lower).unwrap();
    assert!((flow_a.trace(&x) - values[3] - values[2]).abs() < 1e-12);
    assert!(flow_a.trace(&start()) < flow_a.trace(&x));
}

/// The start says how many columns there are.
#[test]
fn a_start_of_other_columns() {
    let [expected, x] = [2, 1].map(|k| flow(&Oja::new(a(), k).unwrap(), 1.0, 20, &start()));
    assert_eq!(x, expected);
    let rk = |k| {
        let mut x = start();
        let grid = TimeGrid::new([0.0, 1.0], 0.05).unwrap();
        let flow = Oja::new(a(), k).unwrap();
        integrate(&flow, &Rk(RK4), &grid, &SaveAt::Ends, &mut x, |_, _| {}).unwrap();
        x
    };
    assert_eq!(rk(3), rk(2));
}

#[test]
fn invalid_input_is_refused() {
    assert!(Oja::new(mat![[1.0, 2.0], [0.0, 1.0]], 1).is_err());
    assert!(Oja::new(mat![[1.0, 2.0]], 1).is_err() && Oja::new(a(), 0).is_err());
    assert!(Oja::new(a(), 5).is_err() && Oja::new(mat![[f64::NAN]], 1).is_err());
}
