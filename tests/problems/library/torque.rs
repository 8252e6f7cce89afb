//! The rigid body under torques, and tensors of inertia.

use super::*;
use lieflow::groups::So3;
use lieflow::problems::inertia::{
    check_triangle, cuboid, cylinder, ellipsoid, principal_axes, violates_triangle,
};
use lieflow::problems::{BodyMotion, BodyTorque, Exact, HeavyTop, SpaceTorque, TorqueBody};
use lieflow::so3;
use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;

const INERTIA: [f64; 3] = [1.0, 2.0, 2.5];

fn attitude() -> Matrix3<f64> {
    so3::exp(&V::new(0.4, -1.1, 0.6)).unwrap()
}

#[test]
fn without_a_torque_it_is_the_free_body() {
    let body = TorqueBody::new(INERTIA, SpaceTorque(|_: &BodyMotion| V::zeros())).unwrap();
    let y = body.state(attitude(), [0.5, 0.4, -0.8]).unwrap();
    let m = attitude().tr_mul(&y.1);
    let exact = Exact::new(INERTIA, m.into(), attitude()).unwrap();
    let end = flow(&body, 3.0, 1000, &y);
    assert_eq!(end.1, y.1, "the momentum in space is constant, bit for bit");
    assert!((end.0 - exact.state(3.0).unwrap().1).norm() < 1e-10);
}

#[test]
fn a_motor_about_a_principal_axis_spins_it_up() {
    let motor = BodyTorque(|at: &BodyMotion| V::new(0.0, 0.0, 1.0 + at.t));
    let body = TorqueBody::new(INERTIA, motor).unwrap();
    let y = body.state(attitude(), [0.0, 0.0, 0.3]).unwrap();
    let (g, m) = flow(&body, 2.0, 20, &y);
    // Jω = Jω₀ + t + t²/2, and its integral; g stays a turn about e₃ of the body.
    let angle = 0.3 * 2.0 + (2.0 + 8.0 / 6.0) / INERTIA[2];
    let expected = attitude() * so3::exp(&V::new(0.0, 0.0, angle)).unwrap();
    assert!((g - expected).norm() < 1e-12);
    assert!((g.tr_mul(&m)[2] - (0.3 * INERTIA[2] + 4.0)).abs() < 1e-12);
}

/// The torque of gravity in space makes the heavy top that se(3)* knows.
#[test]
fn gravity_makes_the_heavy_top() {
    let weight = V::new(0.2, -0.1, 0.9);
    let gravity = SpaceTorque(move |at: &BodyMotion| V::z().cross(&(at.attitude * weight)));
    let body = TorqueBody::new(INERTIA, gravity).unwrap();
    let y = body.state(attitude(), [0.5, -0.4, 2.0]).unwrap();
    let top = HeavyTop::new(INERTIA, weight.into()).unwrap().problem();
    let in_body = |y: &(Matrix3<f64>, V)| (y.0.tr_mul(&y.1), y.0.tr_mul(&V::z()));
    let (one, other) = (flow(&body, 2.0, 1000, &y), flow(&top, 2.0, 1000, &in_body(&y)));
    let far = in_body(&one).distance(&other);
    assert!(far < 1e-10, "{far:e}");
    let energy = |y: &(Matrix3<f64>, V)| body.kinetic_energy(y) + (y.0 * weight)[2];
    assert!((energy(&one) - energy(&y)).abs() < 1e-9);
    assert!((one.1[2] - y.1[2]).abs() < 1e-9, "gravity has no torque about the vertical");
}

#[test]
fn orders_with_a_torque_of_every_kind() {
    let law = BodyTorque(|at: &BodyMotion| {
        V::new(at.t.sin(), 0.3, -0.5) - 0.4 * at.omega_body + 0.1 * at.attitude.tr_mul(&V::x())
    });
    let wind =
        SpaceTorque(|at: &BodyMotion| V::new(0.1, (2.0 * at.t).cos(), 0.2 * at.momentum_space[0]));
    let body = TorqueBody::new(INERTIA, (law, wind)).unwrap();
    has_order_4(&body, &body.state(attitude(), [0.5, 0.4, -0.8]).unwrap(), 2.0, 16);
}

/// A control law: −k log(g) − cω brings the attitude to 𝟙 from a turn of 170 degrees.
#[test]
fn a_control_law_brings_it_home() {
    let law = BodyTorque(|at: &BodyMotion| {
        let away = so3::log(&at.attitude).unwrap_or(V::repeat(f64::NAN));
        -3.0 * away - 4.0 * at.omega_body
    });
    let body = TorqueBody::new(INERTIA, law).unwrap();
    let far = so3::exp(&(V::new(1.0, -2.0, 0.5).normalize() * 2.97)).unwrap();
    let (g, m) = flow(&body, 30.0, 3000, &body.state(far, [0.0; 3]).unwrap());
    assert!((g - Matrix3::identity()).norm() < 1e-6 && m.norm() < 1e-6);
    assert!(lieflow::LieGroup::defect(&So3::<f64>::new(), &g) < 1e-14);
}

#[test]
fn moments_of_simple_bodies() {
    let close = |a: [f64; 3], b: [f64; 3]| {
        for i in 0..3 {
            assert!((a[i] - b[i]).abs() < 4.0 * EPS * b[i], "{a:?} {b:?}");
        }
    };
    close(ellipsoid(5.0, [2.0, 2.0, 2.0]).unwrap(), [8.0; 3]); // 2/5 M R²
    close(ellipsoid(5.0, [1.0, 2.0, 3.0]).unwrap(), [13.0, 10.0, 5.0]);
    close(cuboid(12.0, [1.0, 2.0, 3.0]).unwrap(), [13.0, 10.0, 5.0]);
    close(cylinder(12.0, 1.0, 2.0).unwrap(), [7.0, 7.0, 6.0]);
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(ellipsoid(wrong, [1.0; 3]).is_err() && cuboid(1.0, [1.0, wrong, 1.0]).is_err());
        assert!(cylinder(1.0, wrong, 1.0).is_err() && cylinder(1.0, 1.0, wrong).is_err());
    }
    for moments in [ellipsoid(1.0, [1e-3, 1.0, 5.0]), cylinder(1.0, 1e4, 1e-6)] {
        assert_eq!(violates_triangle(moments.unwrap()), None);
    }
    assert!(violates_triangle([1.0, 1.0, 2.1]).is_some());
    let error = check_triangle([1.0, 5.0, 2.0]).unwrap_err();
    assert!(error.to_string().starts_with("inertia[1] = 5"), "{error}");
    assert!(check_triangle([1.0, -1.0, 2.0]).is_err());
}

#[test]
fn principal_axes_of_a_tensor() {
    let (q, j) = (attitude(), [1.0, 2.0, 2.5]);
    for scale in [1.0, 1e-200, 1e200] {
        let diagonal = Matrix3::from_diagonal(&V::from(j.map(|j| j * scale)));
        let mut tensor = q * diagonal * q.transpose();
        tensor = (tensor + tensor.transpose()) * 0.5;
        let (moments, axes) = principal_axes(&tensor).unwrap();
        for i in 0..3 {
            assert!((moments[i] - j[i] * scale).abs() < 16.0 * EPS * j[i] * scale);
        }
        let back = axes * Matrix3::from_diagonal(&V::from(moments)) * axes.transpose();
        assert!((back - tensor).amax() < 32.0 * EPS * 2.5 * scale);
        assert!((axes.determinant() - 1.0).abs() < 16.0 * EPS);
    }
    let mut crooked = Matrix3::identity();
    crooked[(0, 1)] = 0.1;
    assert!(principal_axes(&crooked).is_err());
    crooked[(0, 1)] = f64::NAN;
    assert!(principal_axes(&crooked).is_err() && principal_axes(&Matrix3::zeros()).is_err());
    assert!(principal_axes(&Matrix3::from_diagonal(&V::new(1.0, -1.0, 1.0))).is_err());
}
