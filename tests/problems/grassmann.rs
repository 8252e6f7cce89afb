//! The flow of subspaces: its closed form, order, what it keeps, and Oja's flow of frames beside it.

use faer::{Mat, mat};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::{
    Rkmk,
    tableau::{DOPRI5, RK4},
};
use lieflow::problems::{Invariants, Oja, SubspaceFlow};
use lieflow::{Error, SaveAt, TimeGrid, integrate};

fn a() -> Mat<f64> {
    mat![[2.0, 0.3, 0.1, 0.0], [0.3, 1.0, -0.2, 0.4], [0.1, -0.2, 0.5, 0.1], [0.0, 0.4, 0.1, -0.3]]
}

/// The span at t is that of e^{tA}X₀, whatever the frame.
fn exact(flow: &SubspaceFlow, x: &Mat<f64>, t: f64) -> Mat<f64> {
    let eigen = a().self_adjoint_eigen(faer::Side::Lower).expect("eigenvectors");
    let (u, s) = (eigen.U(), eigen.S().column_vector());
    let grown = Mat::from_fn(4, 4, |i, j| u[(i, j)] * (t * s[j]).exp());
    flow.span(&(grown * u.transpose() * x)).expect("a span")
}

#[test]
fn the_span_is_that_of_the_exponential_and_projectors_stay_projectors() {
    let flow = SubspaceFlow::new(a()).expect("a flow");
    let x = mat![[0.2, 1.0], [0.5, -0.1], [0.9, 0.3], [0.1, 0.8]];
    let start = flow.span(&x).expect("a span");
    let goal = exact(&flow, &x, 1.5);
    let errors = [10, 20, 40, 80].map(|steps| {
        let grid = TimeGrid::with_steps([0.0, 1.5], steps).expect("a grid");
        let mut p = start.clone();
        integrate(&flow, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut p, |_, _| {})
            .expect("a run");
        // P² = P: what rounding leaves.
        assert!((&p * &p - &p).norm_l2() < 1e-14 * (steps as f64), "{steps}");
        for (value, k) in flow.values(&p).into_iter().zip([2.0, 2.0]) {
            assert!((value - k).abs() < 1e-13);
        }
        assert!(flow.trace(&p) > flow.trace(&start));
        (p - &goal).norm_l2()
    });
    for pair in errors.windows(2) {
        assert!(((pair[0] / pair[1]).log2() - 4.0).abs() < 0.25, "{errors:?}");
    }
    // Oja's frames span the same.
    let oja = Oja::new(a(), 2).expect("a flow");
    let mut frame = x.qr().compute_thin_Q();
    let grid = TimeGrid::with_steps([0.0, 1.5], 200).expect("a grid");
    integrate(&oja, &Rkmk::new(DOPRI5, Exp), &grid, &SaveAt::Ends, &mut frame, |_, _| {})
        .expect("a run");
    assert!((&frame * frame.transpose() - &goal).norm_l2() < 1e-9);
}

#[test]
fn what_spans_nothing_is_refused() {
    let flow = SubspaceFlow::new(a()).expect("a flow");
    assert!(SubspaceFlow::new(mat![[0.0, 1.0], [0.0, 0.0]]).is_err());
    let refused = |x: Mat<f64>| flow.span(&x).expect_err("it spans nothing");
    assert!(matches!(refused(Mat::zeros(4, 2)), Error::Singular { arg: "x", .. }));
    assert!(matches!(refused(Mat::zeros(3, 1)), Error::Shape { arg: "x", .. }));
    assert!(matches!(refused(Mat::zeros(4, 5)), Error::Shape { arg: "x", .. }));
    let nan = Mat::from_fn(4, 1, |i, _| if i == 2 { f64::NAN } else { 1.0 });
    assert!(matches!(refused(nan), Error::NotFiniteEntry { row: 2, col: 0, .. }));
}
