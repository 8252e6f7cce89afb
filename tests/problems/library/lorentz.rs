//! A charged particle: gyration, drift, and what its four-velocity keeps.

use super::*;
use faer::Mat;
use lieflow::dense::{multiply, norm};
use lieflow::groups::MatrixGroup;
use lieflow::problems::{ChargedParticle, four_velocity, lorentz_transformation};
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

/// The closed form is exp; and where E² = B² and E·B = 0, it is 𝟙 + tF + ½t²F² at every t, to rounding.
#[test]
fn constant_fields_in_closed_form() {
    let tensor = |e: Vector3<f64>, b: Vector3<f64>| {
        let particle = ChargedParticle::new(1.0, move |_: f64, _: &Mat<f64>| (e, b)).unwrap();
        let mut tensor = particle.group().zero();
        particle.f(0.0, &four_velocity([0.0; 3]).unwrap(), &mut tensor, &mut particle.work());
        tensor
    };
    let close = |a: &Mat<f64>, b: &Mat<f64>, bound: f64, what: &str| {
        let gap = norm((a - b).as_ref()) / norm(b.as_ref());
        assert!(gap < bound, "{what}: {gap:e}");
    };
    let group = MatrixGroup::indefinite(3, 1).unwrap();
    let fields = [
        [[0.3, -0.2, 0.9], [0.5, 1.1, -0.4]],
        [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.7, 0.4]],
        [[0.3, 0.0, 0.0], [0.7, 0.0, 0.0]],
        [[1.0, 2.0, 0.0], [0.0, 0.0, 2.0]],
        [[1.0, 0.0, 1e-3], [0.0, 1.0, 1e-3]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    ];
    for [e, b] in fields {
        let f = tensor(e.into(), b.into());
        for t in [-3.0, 1e-9, 0.1, 0.4, 0.8, 1.3, 7.0] {
            let mut scaled = group.zero();
            group.axpy(t, &f, &mut scaled);
            let exp = Exp.eval(&group, &scaled).unwrap();
            let closed = lorentz_transformation(&f, t).unwrap();
            close(&closed, &exp, 2e-13, &format!("{e:?} {b:?} {t}"));
        }
    }
    let f = tensor(Vector3::x(), Vector3::y());
    let f2 = multiply(f.as_ref(), f.as_ref());
    for t in [1.0, 30.0, 1e3, 1e6] {
        let exact = Mat::from_fn(4, 4, |i, j| {
            f64::from(u8::from(i == j)) + t * f[(i, j)] + 0.5 * t * t * f2[(i, j)]
        });
        close(&lorentz_transformation(&f, t).unwrap(), &exact, 1e-15, &format!("{t}"));
    }
    assert!(lorentz_transformation(&Mat::zeros(3, 3), 1.0).is_err());
}
