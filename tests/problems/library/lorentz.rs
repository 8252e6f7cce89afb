//! A charged particle: gyration, drift, and what its four-velocity keeps.

use super::*;
use faer::Mat;
use lieflow::problems::{ChargedParticle, four_velocity};
use nalgebra::Vector3;

type V = Vector3<f64>;

fn space(u: &Mat<f64>) -> V {
    V::new(u[(0, 0)], u[(1, 0)], u[(2, 0)])
}

/// In a constant B along e₃ the velocity turns by −(q/m)Bτ, and γ stays.
#[test]
fn gyration() {
    let (ratio, b, tau) = (-1.5, 0.8, 3.0);
    let particle =
        ChargedParticle::new(ratio, |_, _: &_| (V::zeros(), V::new(0.0, 0.0, b))).unwrap();
    let start = four_velocity([0.6, 0.0, 0.3]).unwrap();
    let end = flow(&particle, tau, 3, &start);
    let (s, c) = (-ratio * b * tau).sin_cos();
    let u = space(&start);
    let expected = V::new(c * u[0], s * u[0], u[2]);
    assert!((space(&end) - expected).norm() < 1e-14);
    assert!((end[(3, 0)] - start[(3, 0)]).abs() < 1e-14);
}

/// In E ⊥ B with E < B the particle that moves at the drift velocity E × B/B² keeps it.
#[test]
fn drift() {
    let (e, b) = (V::new(0.0, 0.4, 0.0), V::new(0.0, 0.0, 1.0));
    let particle = ChargedParticle::new(2.0, move |_, _: &_| (e, b)).unwrap();
    let start = four_velocity(e.cross(&b).into()).unwrap();
    let end = flow(&particle, 10.0, 20, &start);
    assert!((&end - &start).norm_l2() < 1e-13);
}

/// Fields that depend on proper time and on the velocity.
#[test]
fn orders_and_the_mass_shell() {
    let field = |tau: f64, u: &Mat<f64>| {
        (V::new(tau.cos(), 0.2, 0.1 * u[(1, 0)]), V::new(0.3, tau.sin(), 1.0 + 0.1 * u[(0, 0)]))
    };
    let particle = ChargedParticle::new(1.0, field).unwrap();
    let start = four_velocity([0.3, -0.2, 0.5]).unwrap();
    assert!((particle.values(&start)[0] + 1.0).abs() < 4.0 * EPS);
    has_order_4(&particle, &start, 2.0, 20);
    // On a non-compact group rounding level is ε‖u‖² a step.
    let end = flow(&particle, 4.0, 1000, &start);
    let far = (particle.values(&end)[0] + 1.0).abs();
    assert!(far < 4.0 * EPS * 1000f64.sqrt() * end.squared_norm_l2(), "{far:e}");
    let classical = run(&particle, &Rk(RK4), 4.0, 100, &start);
    assert!((particle.values(&classical)[0] + 1.0).abs() > 1e-8);
    for v in [[1.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], [0.8, 0.8, 0.0]] {
        assert!(four_velocity(v).is_err());
    }
    assert!(ChargedParticle::new(f64::INFINITY, field).is_err());
}
