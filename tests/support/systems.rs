//! Quadratic Lie–Poisson systems on several algebras, and orders from errors.
#![allow(dead_code)] // each test file uses a part

use faer::{Mat, Scale};
use lieflow::groups::{AlgebraMatrix, MatrixGroup, Sample};
use lieflow::methods::{AnyMethod, Metric};
use lieflow::problems::{Euler, Kinetic, PointOf};
use lieflow::{LieAlgebra, Method, Problem, SaveAt, TimeGrid, integrate};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// The part of x in 𝔤, orthogonal to the rest where M is: (x − M⁻¹xᵀM)/2; all of it on GL(n).
fn part(form: Option<&[Mat<f64>; 2]>, x: &Mat<f64>) -> Mat<f64> {
    match form {
        Some([m, inverse]) => (x - inverse * x.transpose() * m) * Scale(0.5),
        None => x.clone(),
    }
}

/// A m = π(D ∘ π(m)), with weights D that are nothing special and π the projection on 𝔤: symmetric,
/// because π is.
pub(crate) fn quadratic(
    group: MatrixGroup,
) -> Euler<MatrixGroup, Kinetic<impl Fn(&Mat<f64>, &mut AlgebraMatrix)>> {
    let form = group.m().map(|m| [m.clone(), m.transpose().to_owned()]);
    let inverse_inertia = move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
        let weighted = part(form.as_ref(), m);
        let weighted = Mat::from_fn(m.nrows(), m.ncols(), |i, j| {
            weighted[(i, j)] * (0.4 + 0.3 * ((3 * i + 5 * j) % 7) as f64)
        });
        xi.copy_from(part(form.as_ref(), &weighted));
    };
    Euler::new(group, Kinetic(inverse_inertia))
}

/// SO(5), Sp(4), GL(3) and SO(3,1), each with a momentum.
pub(crate) fn systems() -> Vec<(MatrixGroup, Mat<f64>)> {
    let groups = [
        MatrixGroup::so(5).expect("SO(5)"),
        MatrixGroup::sp(4).expect("Sp(4)"),
        MatrixGroup::gl(3).expect("GL(3)"),
        MatrixGroup::indefinite(3, 1).expect("SO(3,1)"),
    ];
    let mut rng = Pcg64::seed_from_u64(11);
    let mut with_momentum = |group: MatrixGroup| {
        let m = group.sample_algebra(&mut rng, 1.0);
        let size = 1.0 / group.norm(&m);
        (group, m.into_mat() * Scale(size))
    };
    groups.into_iter().map(&mut with_momentum).collect()
}

/// tr m, …, tr mⁿ: the action conjugates m.
pub(crate) fn casimirs(m: &Mat<f64>) -> Vec<f64> {
    let mut power = m.clone();
    (0..m.nrows())
        .map(|_| {
            let trace = (0..m.nrows()).map(|i| power[(i, i)]).sum();
            power = &power * m;
            trace
        })
        .collect()
}

/// Four numbers of steps whose ratios are near 3/2.
pub(crate) fn grid(first: u64) -> [u64; 4] {
    [4u64, 6, 9, 13].map(|n| n * first / 4)
}

/// The last three pairwise slopes lie within 0.15 of p, on a grid fixed in advance.
pub(crate) fn assert_order(name: &str, p: f64, grid: &[u64], errors: &[f64]) {
    let slopes: Vec<f64> = grid
        .windows(2)
        .zip(errors.windows(2))
        .map(|(n, e)| (e[0] / e[1]).ln() / (n[1] as f64 / n[0] as f64).ln())
        .collect();
    println!("{name:36} errors {errors:?} slopes {slopes:.2?}");
    let last = &slopes[slopes.len() - 3..];
    assert!(last.iter().all(|s| (s - p).abs() < 0.15), "{name}: {slopes:.3?}, expected {p}");
}

/// The state at `end` after n equal steps. The driver is compiled once for each problem.
pub(crate) fn run<P, M>(p: &P, method: &M, y: &PointOf<P>, end: f64, n: u64) -> PointOf<P>
where
    P: Problem,
    M: Method<P> + Clone + Send + Sync,
    P::Group: LieAlgebra<Scalar = f64>,
    PointOf<P>: Metric<Scalar = f64>,
{
    let method = AnyMethod::new(method.clone());
    let (mut y, grid) = (y.clone(), TimeGrid::with_steps([0.0, end], n).expect("a grid"));
    integrate(p, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {}).expect("a run");
    y
}
