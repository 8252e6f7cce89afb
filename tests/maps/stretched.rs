//! Groups whose M is far from a multiple of an orthogonal matrix: what is computed on G_M has the digits that the same
//! matrices have on GL(n).

use faer::{Mat, Scale, mat};
use lieflow::actions::{Coadjoint, Conjugation};
use lieflow::groups::{Adjoint, AlgebraMatrix, GroupMatrix, MatrixGroup};
use lieflow::maps::{Exp, Pade22, dexp};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::Flow;
use lieflow::{Action, CoordinateMap, LieGroup, Solve};

const CONDITIONS: [f64; 5] = [30.0, 1e3, 1e4, 1e6, 1e8];

/// G_M with M = Q diag(1, 1, c) Qᵀ, and an element of 𝔤 of this norm.
fn stretched(c: f64, norm: f64) -> (MatrixGroup, AlgebraMatrix) {
    let q = mat![[1.0, 2.0, 3.0], [0.0, 1.0, 4.0], [5.0, 6.0, 0.0]].qr().compute_thin_Q();
    let d = mat![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, c]];
    let m = &q * d * q.transpose();
    let group = MatrixGroup::gm(Mat::from_fn(3, 3, |i, j| m[(i.max(j), i.min(j))])).expect("M");
    let s = mat![[0.0, 1.0, 2.0], [-1.0, 0.0, 0.5], [-2.0, -0.5, 0.0]];
    let u = group.project_algebra(s.as_ref());
    let u = Mat::from_fn(3, 3, |i, j| u[(i, j)] * (norm / u.norm_l2()));
    let u = group.algebra(u).expect("an element");
    (group, u)
}

fn gl() -> MatrixGroup {
    MatrixGroup::gl(3).expect("GL(3)")
}

fn gap(x: &Mat<f64>, y: &Mat<f64>) -> f64 {
    (x - y).norm_l2() / y.norm_l2()
}

/// exp(u) of the constant field u on this group, by n steps.
fn by_steps(group: MatrixGroup, u: &AlgebraMatrix, n: u64, in_body: bool) -> GroupMatrix {
    let one = group.identity();
    let method = Rkmk::new(RK4, Exp);
    let copy = |v: &mut AlgebraMatrix| v.copy_from(&**u);
    macro_rules! run {
        ($flow:expr) => {
            Solve::new(&$flow, &method, [0.0, 1.0]).steps(n).run(one).expect("a run").y
        };
    }
    match in_body {
        true => run!(Flow::in_body(group, |_, _: &GroupMatrix, v: &mut _| copy(v))),
        false => {
            let space = lieflow::actions::LeftTranslation;
            run!(Flow::new(group, space, |_, _: &GroupMatrix, v: &mut _| copy(v)))
        }
    }
}

#[test]
fn runs_keep_their_digits() {
    for c in CONDITIONS {
        let (group, u) = stretched(c, 1.0);
        let right = Exp.eval(&gl(), &u).expect("exp");
        for n in [7, 8, 100, 10_000] {
            for in_body in [false, true] {
                let found = by_steps(group.clone(), &u, n, in_body);
                let away = gap(&found, &right);
                assert!(away < 1e-15 * (4.0 + n as f64), "c = {c}, {n} steps, {in_body}: {away:e}");
            }
        }
    }
}

#[test]
fn differentials_and_inverses_keep_their_digits() {
    for c in CONDITIONS {
        let (group, u) = stretched(c, 2.0);
        let (_, v) = stretched(c, 1.0);
        let w = group
            .project_algebra(mat![[0.0, 1.0, -1.0], [0.3, 0.0, 2.0], [1.0, 0.0, 0.0]].as_ref());
        for v in [v, w] {
            let right = Exp.eval_dpsi_inv(&gl(), &u, &v).expect("dexp⁻¹");
            let found = Exp.eval_dpsi_inv(&group, &u, &v).expect("dexp⁻¹");
            assert!(gap(&found, &right) < 1e-14, "c = {c}, dexp⁻¹: {:e}", gap(&found, &right));
            let found = dexp(&group, &u, &v).expect("dexp");
            let right = dexp(&gl(), &u, &v).expect("dexp");
            assert!(gap(&found, &right) < 1e-14, "c = {c}, dexp: {:e}", gap(&found, &right));
            let right = Pade22.eval_dpsi_inv(&gl(), &u, &v).expect("pade22");
            let found = Pade22.eval_dpsi_inv(&group, &u, &v).expect("pade22");
            assert!(gap(&found, &right) < 1e-14, "c = {c}, pade22: {:e}", gap(&found, &right));
        }
        let g = Exp.eval(&group, &u).expect("exp");
        let mut inverse = group.identity();
        group.inverse(&g, &mut inverse).expect("an inverse");
        let away = (&*g * &*inverse - Mat::<f64>::identity(3, 3)).norm_l2();
        assert!(away < 2e-14, "c = {c}, inverse: {away:e}");
    }
}

#[test]
fn actions_keep_their_digits() {
    let p = mat![[1.0, 2.0, 3.0], [-1.0, 0.5, 0.2], [0.1, -2.0, 1.0]];
    let mut found = p.clone();
    let mut right = p.clone();
    for c in CONDITIONS {
        let (group, u) = stretched(c, 1.0);
        let g = Exp.eval(&group, &u).expect("exp");
        macro_rules! same {
            ($action:expr) => {
                let mut work = Action::<MatrixGroup>::work(&$action, &group);
                $action.act(&group, &g, &p, &mut found, &mut work);
                let mut work = Action::<MatrixGroup>::work(&$action, &gl());
                $action.act(&gl(), &g, &p, &mut right, &mut work);
                assert!(gap(&found, &right) < 1e-14, "c = {c}: {:e}", gap(&found, &right));
            };
        }
        same!(Coadjoint);
        same!(Conjugation);
    }
}

/// A step with a singular Ψ(u) is refused in the body, too: there is no inverse.
#[test]
fn a_singular_step_ends_a_run_in_the_body() {
    use lieflow::maps::Cay;
    use lieflow::methods::tableau::EULER;
    let singular = mat![[-2.0, 0.0], [0.0, 0.0]];
    let group = MatrixGroup::gl(2).expect("GL(2)");
    let one = group.identity();
    let flow = Flow::in_body(group, |_, _: &GroupMatrix, v: &mut AlgebraMatrix| {
        v.copy_from(&singular * Scale(-1.0));
    });
    let method = Rkmk::new(EULER, Cay);
    let refused = Solve::new(&flow, &method, [0.0, 3.0]).dt(1.0).run(one);
    assert!(refused.is_err(), "{:?}", refused.map(|run| run.y));
}

/// The linear action has any number of columns.
#[test]
fn more_columns_than_rows() {
    for (n, columns) in [(1, 9), (3, 20), (9, 40), (10, 11), (20, 64)] {
        let group = MatrixGroup::gl(n).expect("GL(n)");
        let u = Mat::from_fn(n, n, |i, j| 0.1 * ((3 * i + 5 * j) as f64).sin());
        let u = group.algebra(u).expect("an element");
        let x = Mat::from_fn(n, columns, |i, j| ((i + 2 * j) as f64).cos());
        let (mut g, mut y) = (group.identity(), Mat::zeros(n, columns));
        let check = |g: &GroupMatrix, y: &Mat<f64>| {
            assert!(gap(y, &(&**g * &x)) < 1e-14, "{n}×{columns}");
        };
        let (mut cay, mut pade) =
            (lieflow::maps::Cay.at(&group).unwrap(), Pade22.at(&group).unwrap());
        lieflow::maps::Cay.psi_on(&group, &u, &mut cay, &mut g, &x, &mut y).expect("cay");
        check(&lieflow::maps::Cay.eval(&group, &u).expect("cay"), &y);
        Pade22.psi_on(&group, &u, &mut pade, &mut g, &x, &mut y).expect("pade22");
        check(&Pade22.eval(&group, &u).expect("pade22"), &y);
    }
}
