//! U(n) over complex matrices and the unit quaternions: laws, drift, order, and agreement with the
//! groups that they are other forms of.

use faer::{Mat, c64};
use lieflow::check::laws;
use lieflow::groups::{ComplexMatrix, MatrixGroup, Sample, So3, UnitQuaternions, Unitary};
use lieflow::maps::{Cay, Dexpinv, Exp};
use lieflow::methods::{
    Rkmk,
    tableau::{DOPRI5, RK4},
};
use lieflow::problems::{Exact, RigidBodyAttitude, RigidBodyQuaternion};
use lieflow::{CoordinateMap, Error, LieAlgebra, LieGroup, SaveAt, StepError, TimeGrid, integrate};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

/// [re −im; im re].
fn real_form(x: &ComplexMatrix) -> Mat<f64> {
    let n = x.nrows();
    Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) | (false, false) => x.re[(i % n, j % n)],
        (true, false) => -x.im[(i, j - n)],
        (false, true) => x.im[(i - n, j)],
    })
}

fn check_laws<G: Sample<Scalar = f64>>(group: &G, sigma: f64)
where
    Exp: CoordinateMap<G>,
    Cay: CoordinateMap<G>,
{
    let mut rng = Pcg64::seed_from_u64(1);
    let exp = laws(group, &Exp, &mut rng, 100, sigma).expect("exp");
    let cay = laws(group, &Cay, &mut rng, 100, sigma).expect("cay");
    for law in exp.into_iter().chain(cay) {
        assert!(law.holds(), "{}: {:.1} of {} at {}", law.name, law.worst, law.bound, law.at);
    }
}

#[test]
fn laws_of_both() {
    check_laws(&UnitQuaternions, 0.5);
    for n in [1, 2, 3, 5, 8] {
        check_laws(&Unitary::new(n).expect("U(n)"), 0.3 / n as f64);
    }
    assert!(Unitary::new(0).is_err());
}

#[test]
fn the_complex_maps_are_those_of_the_real_form() {
    let mut rng = Pcg64::seed_from_u64(2);
    for n in [1, 2, 4, 7] {
        let (group, real) = (Unitary::new(n).expect("U(n)"), MatrixGroup::so(2 * n).expect("SO"));
        for sigma in [1e-3, 0.2, 3.0] {
            let (u, v) =
                (group.sample_algebra(&mut rng, sigma), group.sample_algebra(&mut rng, 1.0));
            let [ur, vr] = [&u, &v].map(|x| real.algebra(real_form(x)).expect("skew"));
            let size = 1.0 + group.norm(&u);
            let mut bound = 64.0 * EPS * (n as f64) * size;
            let near = |a: &ComplexMatrix, b: &Mat<f64>, bound: f64, what: &str| {
                let far = (real_form(a) - b).norm_l2();
                assert!(far <= bound, "{what}, n = {n}, sigma = {sigma}: {far:.1e}");
            };
            let g = Exp.eval(&group, &u).expect("exp");
            near(&g, &Exp.eval(&real, &ur).expect("exp"), bound, "exp");
            assert!(group.defect(&g) <= 16.0 * EPS * n as f64);
            let c = Cay.eval(&group, &u).expect("cay");
            near(&c, &Cay.eval(&real, &ur).expect("cay"), bound, "cay");
            assert!(group.defect(&c) <= 16.0 * EPS * n as f64);
            bound *= size * group.norm(&v);
            let d = Cay.eval_dpsi_inv(&group, &u, &v).expect("dcay⁻¹");
            near(&d, &Cay.eval_dpsi_inv(&real, &ur, &vr).expect("dcay⁻¹"), bound, "dcay⁻¹");
            if sigma < 1.0 {
                let d = Exp.eval_dpsi_inv(&group, &u, &v).expect("dexp⁻¹");
                near(&d, &Exp.eval_dpsi_inv(&real, &ur, &vr).expect("dexp⁻¹"), bound, "dexp⁻¹");
            }
        }
        // Beyond the series both ways are exact: each undoes the other.
        let (u, v) = (group.sample_algebra(&mut rng, 50.0), group.sample_algebra(&mut rng, 1.0));
        let (mut at, mut w) = (Exp.at(&group).expect("exp"), v.clone());
        Exp.dpsi_inv(&group, &u, &mut at, &mut w).expect("dexp⁻¹");
        assert!(n == 1 || at.dexpinv_choice() == Dexpinv::Eigen, "{:?}", at.dexpinv_choice());
        let size = group.norm(&w);
        at.dexp(&group, &u, &mut w).expect("dexp");
        assert!(group.distance(&w, &v) <= 64.0 * EPS * group.norm(&u).max(1.0) * size);
        // And what has drifted is taken back.
        let mut g = group.sample_element(&mut rng);
        assert!(group.defect(&g) <= 16.0 * EPS * n as f64, "{}", group.defect(&g));
        g.re[(0, 0)] += 1e-5;
        let (mut a, mut b) = (group.identity(), group.identity());
        for _ in 0..3 {
            group.correct(&mut g, [&mut a, &mut b]);
        }
        assert!(group.defect(&g) <= 16.0 * EPS * n as f64);
    }
}

/// diag(iπ, −iπ): a difference of eigenvalues is 2π, and dexp singular off the diagonal.
#[test]
fn dexp_is_singular_where_eigenvalues_differ_by_a_turn() {
    use std::f64::consts::PI;
    let group = Unitary::new(2).expect("U(2)");
    let diagonal = |a: f64, b: f64| {
        let z = |i, j| if i != j { 0.0 } else { [a, b][i] };
        ComplexMatrix::from_fn(2, 2, |i, j| c64::new(0.0, z(i, j)))
    };
    let across = ComplexMatrix::from_fn(2, 2, |i, j| c64::new(i as f64 - j as f64, 0.0));
    let (u, mut at) = (diagonal(PI, -PI), Exp.at(&group).expect("exp"));
    assert!(at.distance_to_singular(&u).expect("a spectrum") < 1e-15);
    let refused = Exp.eval_dpsi_inv(&group, &u, &across);
    let outside = matches!(refused, Err(Error::Map(StepError::OutsideChart { map: "exp", .. })));
    assert!(outside, "{refused:?}");
    // What commutes with u has no part there, and nearby the result is large and finite.
    assert_eq!(Exp.eval_dpsi_inv(&group, &u, &diagonal(0.3, 2.0)), Ok(diagonal(0.3, 2.0)));
    let near = diagonal(PI, -PI * (1.0 - 1e-9));
    let size = group.norm(&Exp.eval_dpsi_inv(&group, &near, &across).expect("dexp⁻¹"));
    // |φ(−iθ)| = |θ/2 / sin(θ/2)|, here π/(π·1e-9/2), twice.
    assert!((size * 1e-9 / 8f64.sqrt() - 1.0).abs() < 1e-5, "{size:e}");
    let nan = ComplexMatrix::from_fn(2, 2, |_, _| c64::new(0.0, f64::NAN));
    assert!(Exp.eval_dpsi_inv(&group, &nan, &across).is_err());
    assert!(at.distance_to_singular(&nan).is_err());
}

#[test]
fn quaternions_turn_as_rotations_do() {
    let mut rng = Pcg64::seed_from_u64(3);
    let (group, so3) = (UnitQuaternions, So3::<f64>::new());
    for sigma in [1e-9, 0.5, 3.0] {
        for _ in 0..50 {
            let u = group.sample_algebra(&mut rng, sigma);
            let rotated = |q: &UnitQuaternion<f64>| {
                let mut y = Vector3::zeros();
                group.apply(q, &Vector3::new(0.3, -0.5, 0.7), &mut y);
                y
            };
            let x = Vector3::new(0.3, -0.5, 0.7);
            let q = Exp.eval(&group, &u).expect("exp");
            assert!(
                (rotated(&q) - Exp.eval(&so3, &u).expect("exp") * x).norm()
                    < 16.0 * EPS * (1.0 + sigma)
            );
            let q = Cay.eval(&group, &u).expect("cay");
            assert!((rotated(&q) - Cay.eval(&so3, &u).expect("cay") * x).norm() < 16.0 * EPS);
        }
    }
    // Once around is −1, twice is 1.
    let around =
        Exp.eval(&group, &Vector3::new(0.0, 2.0 * std::f64::consts::PI, 0.0)).expect("exp");
    assert!((around.w + 1.0).abs() < 1e-15);
}

#[test]
fn a_body_by_its_quaternion_has_the_order_of_the_method_and_does_not_drift() {
    let (inertia, momentum) = ([1.0, 2.0, 3.0], [0.2, 0.5, 3.0]);
    let body = RigidBodyQuaternion::new(inertia, momentum).expect("a body");
    let exact = Exact::new(inertia, momentum, Matrix3::identity()).expect("a body");
    let error = |method: &dyn Fn(&TimeGrid, &mut UnitQuaternion<f64>), steps: u64| {
        let mut q = UnitQuaternion::identity();
        method(&TimeGrid::with_steps([0.0, 2.0], steps).expect("a grid"), &mut q);
        let (m, g) = exact.state(2.0).expect("a state");
        assert!((body.momentum_body(&q) - m).norm() < 1e-2);
        (q.to_rotation_matrix().matrix() - g).norm()
    };
    let rk4 = |grid: &TimeGrid, q: &mut UnitQuaternion<f64>| {
        integrate(&body, &Rkmk::new(RK4, Cay), grid, &SaveAt::Ends, q, |_, _| {}).expect("a run");
    };
    let dopri5 = |grid: &TimeGrid, q: &mut UnitQuaternion<f64>| {
        integrate(&body, &Rkmk::new(DOPRI5, Exp), grid, &SaveAt::Ends, q, |_, _| {})
            .expect("a run");
    };
    for (order, method) in [(4.0, &rk4 as &dyn Fn(&_, &mut _)), (5.0, &dopri5)] {
        let e = [40, 80, 160, 320].map(|steps| error(method, steps));
        for pair in e.windows(2) {
            let slope = (pair[0] / pair[1]).log2();
            assert!((slope - order).abs() < 0.2, "order {order}: {e:?}");
        }
    }
    // The same path as by matrices, and |q| = 1 after many steps.
    let grid = TimeGrid::with_steps([0.0, 1000.0], 100_000).expect("a grid");
    let mut q = UnitQuaternion::identity();
    integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut q, |_, q| {
        assert!((q.coords.norm() - 1.0).abs() < 1e-14);
    })
    .expect("a run");
    let grid = TimeGrid::with_steps([0.0, 10.0], 1000).expect("a grid");
    let (mut q, mut g) = (UnitQuaternion::identity(), Matrix3::identity());
    let by_matrix = RigidBodyAttitude::<f64>::new(inertia, momentum).expect("a body");
    integrate(&body, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut q, |_, _| {}).expect("a run");
    integrate(&by_matrix, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut g, |_, _| {})
        .expect("a run");
    assert!((q.to_rotation_matrix().matrix() - g).norm() < 1e-13);
}
