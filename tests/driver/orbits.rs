//! The lengths that an action conserves stay where they are over many steps, also where the rounding of a step has a
//! preferred side, as with a constant f.

use crate::support::boxed::boxed_of_time;
use lieflow::actions::{Coadjoint, Conjugation, Lagrangian};
use lieflow::faer::{Mat, c64};
use lieflow::groups::{AlgebraMatrix, ComplexMatrix, MatrixGroup, Se23, Unitary};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::RK4;
use lieflow::methods::{Method, Rkmk};
use lieflow::nalgebra::Vector3;
use lieflow::problems::{PointOf, Problem};
use lieflow::space::Metric;
use lieflow::{Error, LieAlgebra, RunError, Solve};

const STEPS: u64 = 30_000;

/// The largest relative change of these lengths in a run, and how often the state was corrected.
fn drift<P, M>(problem: &P, method: &M, y: PointOf<P>, lengths: fn(&PointOf<P>) -> Vec<f64>) -> f64
where
    P: Problem<Group: LieAlgebra<Scalar = f64>>,
    M: Method<P>,
{
    let start = lengths(&y);
    let run = Solve::new(problem, method, [0.0, 3000.0]).steps(STEPS).run(y).expect("a run");
    assert!(run.stats.restored >= STEPS / 100 && run.stats.residual > 0.0, "{:?}", run.stats);
    let pairs = lengths(&run.y).into_iter().zip(start);
    pairs.map(|(end, start)| (end / start - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn lengths_on_duals_are_constant() {
    const MOST: f64 = 1e-14;
    let so4 = MatrixGroup::so(4).expect("a group");
    let turn = |_: f64, v: &mut AlgebraMatrix| {
        for (i, j, x) in [(0, 1, 0.7), (0, 2, -0.3), (1, 3, 0.9), (2, 3, 0.2)] {
            (v[(i, j)], v[(j, i)]) = (x, -x);
        }
    };
    let m = Mat::from_fn(4, 4, |i, j| (i as f64 - j as f64) / (1.0 + (i + j) as f64));
    let flow = boxed_of_time(so4, Coadjoint, turn);
    let length: fn(&Mat<f64>) -> Vec<f64> = |m| vec![m.norm_l2()];
    assert!(drift(&flow, &Rkmk::new(RK4, Exp), m.clone(), length) < MOST);
    assert!(drift(&flow, &Rkmk::new(RK4, Cay), m, length) < MOST);

    let u2 = Unitary::new(2).expect("a group");
    let entry = |i: usize, j: usize| match (i, j) {
        (0, 1) => c64::new(0.4, 0.5),
        (1, 0) => c64::new(-0.4, 0.5),
        _ => c64::new(0.0, 0.3 + i as f64),
    };
    let p = ComplexMatrix::from_fn(2, 2, entry);
    let field = move |_: f64, v: &mut ComplexMatrix| {
        *v = ComplexMatrix::from_fn(2, 2, |i, j| {
            entry(i, j) * c64::new(if i == j { 1.0 } else { 2.0 }, 0.0)
        });
    };
    let length: fn(&ComplexMatrix) -> Vec<f64> = |p| vec![p.size()];
    let method = Rkmk::new(RK4, Exp);
    assert!(drift(&boxed_of_time(u2, Conjugation, field), &method, p.clone(), length) < MOST);
    assert!(drift(&boxed_of_time(u2, Coadjoint, field), &method, p, length) < MOST);

    type Dual = (Vector3<f64>, (Vector3<f64>, Vector3<f64>));
    let field = |_: f64, v: &mut Dual| {
        *v = (Vector3::new(0.3, -0.8, 0.5), (Vector3::zeros(), Vector3::zeros()));
    };
    let start = (Vector3::x(), (Vector3::new(1.0, 2.0, -0.5), Vector3::new(0.1, 0.3, 0.7)));
    let lengths: fn(&Dual) -> Vec<f64> = |m| vec![m.1.0.norm(), m.1.1.norm()];
    assert!(drift(&boxed_of_time(Se23::new(), Coadjoint, field), &method, start, lengths) < MOST);
}

/// P stays symmetric under symplectic matrices alone.
#[test]
fn subspaces_need_a_symplectic_group() {
    let run = |group: MatrixGroup, m: usize| {
        let flow = boxed_of_time(group, Lagrangian, |_, _: &mut AlgebraMatrix| {});
        let p = Mat::from_fn(m, m, |i, j| if i == j { 1.0 } else { 0.0 });
        let method = Rkmk::new(RK4, Exp);
        let run = Solve::new(&flow, &method, [0.0, 1.0]).steps(1).run(p);
        run.map(drop).map_err(|failed| failed.error)
    };
    let sp = MatrixGroup::sp(4).expect("a group");
    let as_form = MatrixGroup::gm(sp.m().expect("J")).expect("a group");
    for group in [sp, as_form, MatrixGroup::u(2).expect("a group")] {
        assert!(run(group.clone(), 2).is_ok(), "{}", group.name());
    }
    for group in [MatrixGroup::gl(4), MatrixGroup::so(4), MatrixGroup::indefinite(2, 2)] {
        let refused = run(group.expect("a group"), 2);
        let is_named =
            matches!(refused, Err(RunError::Setup(Error::Unsupported { what: "Lagrangian", .. })));
        assert!(is_named, "{refused:?}");
    }
    assert!(run(MatrixGroup::gl(3).expect("a group"), 1).is_err());
}
