//! The problems: orders, invariants and known solutions of each.

mod actions;
mod closures;
mod euler;
mod heavy_top;
mod isospectral;
mod lorentz;
mod lyapunov;
mod oja;
mod periodic;
mod rigid;
mod schrodinger;
mod spheres;
mod torque;

use lieflow::maps::{Cay, CoordinateMap, Exp};
use lieflow::methods::{AnyMethod, Method, Metric, Rk, Rkmk, tableau::DOP853, tableau::RK4};
use lieflow::problems::{Ambient, Invariants, Origin, PointOf, Problem, ScalarOf};
use lieflow::{LieAlgebra, SaveAt, TimeGrid, integrate};

const EPS: f64 = f64::EPSILON;

/// y at t by so many steps.
fn run<P: Problem, M: Method<P> + Clone + Send + Sync>(
    problem: &P,
    method: &M,
    t: f64,
    steps: u64,
    y: &PointOf<P>,
) -> PointOf<P> {
    // The driver is compiled once for each problem.
    let method = AnyMethod::new(method.clone());
    let (mut y, grid) = (y.clone(), TimeGrid::with_steps([0.0, t], steps).unwrap());
    integrate(problem, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {}).unwrap();
    y
}

/// The same by RKMK4 with exp.
fn flow<P: Problem>(problem: &P, t: f64, steps: u64, y: &PointOf<P>) -> PointOf<P>
where
    Exp: CoordinateMap<P::Group>,
{
    run(problem, &Rkmk::new(RK4, Exp), t, steps, y)
}

/// RKMK4 has order 4 with exp and with cay, against a classical method of order 8 on the entries:
/// that f, the action and F belong together.
fn has_order_4<P: Ambient<Group: LieAlgebra<Scalar = f64>>>(
    problem: &P,
    y: &PointOf<P>,
    t: f64,
    steps: u64,
) where
    Exp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    let exact = run(problem, &Rk(DOP853), t, 16 * steps, y);
    let check = |name: &str, far: [f64; 3]| {
        for pair in far.windows(2) {
            let slope = (pair[0] / pair[1]).log2();
            assert!((slope - 4.0).abs() < 0.25, "{name}: {far:?}");
        }
    };
    let counts = [steps, 2 * steps, 4 * steps];
    check("exp", counts.map(|n| flow(problem, t, n, y).distance(&exact)));
    let cay = Rkmk::new(RK4, Cay);
    check("cay", counts.map(|n| run(problem, &cay, t, n, y).distance(&exact)));
}

/// Over a run of so many steps, what the action keeps moves by rounding, and what the flow keeps by
/// the method's error, at most `accuracy`, and not by nothing at all, which nothing would do.
fn keeps_its_invariants<P: Invariants>(
    problem: &P,
    y: &PointOf<P>,
    t: f64,
    steps: u64,
    accuracy: f64,
) where
    P::Group: LieAlgebra<Scalar = f64>,
    Exp: CoordinateMap<P::Group>,
{
    let names = problem.invariants();
    let values = |y: &PointOf<P>| -> Vec<ScalarOf<P>> { problem.values(y) };
    let (before, after) = (values(y), values(&flow(problem, t, steps, y)));
    let terms = problem.sizes(y);
    assert_eq!([names.len(), terms.len(), after.len()], [before.len(); 3]);
    for (((name, a), b), terms) in names.iter().zip(before).zip(after).zip(terms) {
        let size = name.law.scale.size(a, terms);
        let bound = match name.law.origin {
            Origin::Action => 16.0 * EPS * (steps as f64).sqrt() * size,
            Origin::Flow => accuracy,
        };
        assert!((a - b).abs() <= bound, "{}: {a} → {b}", name.name);
    }
}
